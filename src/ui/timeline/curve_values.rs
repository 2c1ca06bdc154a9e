//! The values of a curve: points for its line, and single values on demand.

use crate::ui::kit;
use segue_motion::clip::{CurveKind, Motion, joint_values};
use std::ops::Range;
use std::sync::Arc;

/// The greatest number of points of a curve, besides the ends of [`Extremes`]: no screen shows
/// more.
const MAX_POINTS: usize = 900;

/// The values of a joint, frame by frame of a result.
#[derive(Debug)]
pub(super) struct CurveValues {
    motion: Arc<Motion>,
    joint: usize,
    kind: CurveKind,
    /// The frame rate of the result, and the time of the first frame, seconds.
    fps: f64,
    starts_at_secs: f64,
    /// For each frame of the result the frame of the motion that it shows, if any. Without this,
    /// the frames are the same.
    motion_frames: Option<Vec<Option<usize>>>,
    /// The frames that belong to the curve.
    frames: Range<usize>,
}

impl CurveValues {
    /// Returns the values of a motion that begins at a time of the result, seconds.
    pub(super) fn of_motion(
        motion: &Arc<Motion>,
        joint: usize,
        kind: CurveKind,
        starts_at_secs: f64,
    ) -> Self {
        Self {
            joint,
            kind,
            fps: motion.clip().fps(),
            starts_at_secs,
            motion_frames: None,
            frames: 0..motion.clip().frames(),
            motion: Arc::clone(motion),
        }
    }

    /// Returns the values in these frames of the motion: that of each frame of a result, if it
    /// shows one, at the frame rate of the result.
    pub(super) fn of_frames(
        motion: &Arc<Motion>,
        joint: usize,
        kind: CurveKind,
        fps: f64,
        motion_frames: Vec<Option<usize>>,
    ) -> Self {
        let frames = 0..motion_frames.len();
        Self {
            motion: Arc::clone(motion),
            joint,
            kind,
            fps,
            starts_at_secs: 0.0,
            motion_frames: Some(motion_frames),
            frames,
        }
    }

    /// Keeps the frames from the first to the last whose time, seconds, is inside.
    pub(super) fn within(self, is_inside: impl Fn(f64) -> bool) -> Self {
        let mut inside = self.frames.clone().filter(|&frame| is_inside(self.secs(frame)));
        let frames = inside.next().map_or(0..0, |first| first..inside.last().unwrap_or(first) + 1);
        Self { frames, ..self }
    }

    /// Returns the time of a frame, seconds.
    fn secs(&self, frame: usize) -> f64 {
        self.starts_at_secs + frame as f64 / self.fps
    }

    /// Returns the points of those of these frames that have a value.
    fn points(&self, frames: impl Iterator<Item = usize>) -> Vec<[f64; 2]> {
        let clip = self.motion.clip();
        let motion_frame = |frame: usize| {
            let shown = match &self.motion_frames {
                Some(motion_frames) => motion_frames.get(frame).copied().flatten(),
                None => Some(frame),
            };
            shown.filter(|shown| *shown < clip.frames())
        };
        let (frames, shown): (Vec<_>, Vec<_>) =
            frames.filter_map(|frame| Some((frame, motion_frame(frame)?))).unzip();
        let values = joint_values(clip, self.joint, self.kind, shown);
        let points = frames.into_iter().zip(values);
        points.map(|(frame, value)| [self.secs(frame), f64::from(value)]).collect()
    }

    /// Returns points of frames at equal distances: all of them, if they are not too many.
    pub(super) fn sampled(&self) -> Vec<[f64; 2]> {
        let stride = self.frames.len().div_ceil(MAX_POINTS).max(1);
        self.points(self.frames.clone().step_by(stride))
    }

    /// Returns whether [`Self::sampled`] leaves frames out.
    pub(super) fn is_long(&self) -> bool {
        self.frames.len() > MAX_POINTS
    }

    /// Begins the computation of the least and the greatest value of each of many parts of the
    /// curve, so that no peak is missing: call [`Extremes::advance`].
    pub(super) fn extremes(&self) -> Extremes {
        Extremes { points: Vec::new(), last: None, next: self.frames.start }
    }
}

impl kit::SeriesValues for CurveValues {
    fn value_at(&self, secs: f64) -> Option<f64> {
        /// Rounding of times, frames.
        const NEAR: f64 = 1e-6;
        let at = (secs - self.starts_at_secs) * self.fps;
        let (nearest, before) = (at.round(), at.floor());
        let [from, to] =
            if (at - nearest).abs() < NEAR { [nearest; 2] } else { [before, before + 1.0] };
        let is_inside = from >= self.frames.start as f64 && to < self.frames.end as f64;
        let frames = is_inside.then_some([from as usize, to as usize])?;
        match self.points(frames.into_iter())[..] {
            [from, to] => Some(from[1] + (at - before) * (to[1] - from[1])),
            _ => None,
        }
        .filter(|value| value.is_finite())
    }
}

/// The points of [`CurveValues::extremes`], as far as they are computed.
#[derive(Debug)]
pub(super) struct Extremes {
    points: Vec<[f64; 2]>,
    /// The last point of the curve so far.
    last: Option<[f64; 2]>,
    /// The first frame of the next part.
    next: usize,
}

impl Extremes {
    /// Computes parts of about `frames` more frames; returns all points once the last part is done.
    pub(super) fn advance(&mut self, of: &CurveValues, frames: usize) -> Option<Vec<[f64; 2]>> {
        // Two points for each.
        let part = of.frames.len().div_ceil(MAX_POINTS / 2).max(1);
        let until = self.next.saturating_add(frames);
        while self.next < of.frames.end {
            if self.next >= until {
                return None;
            }
            let end = (self.next + part).min(of.frames.end);
            let points = of.points(self.next..end);
            let by_value = |a: &&[f64; 2], b: &&[f64; 2]| a[1].total_cmp(&b[1]);
            if let (Some(&low), Some(&high)) =
                (points.iter().min_by(by_value), points.iter().max_by(by_value))
            {
                let in_time = if low[0] < high[0] { [low, high] } else { [high, low] };
                // The line begins and ends where the curve does.
                let first = points.first().copied().filter(|_| self.points.is_empty());
                self.points.extend(first.into_iter().chain(in_time));
            }
            self.last = points.last().copied().or(self.last);
            self.next = end;
        }
        self.points.extend(self.last);
        self.points.dedup_by(|a, b| a[0] == b[0]);
        Some(std::mem::take(&mut self.points))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ui::kit::SeriesValues as _;
    use segue_motion::clip::{Clip, joint_curve};
    use segue_motion::synth::{Action, Params, synthesize};

    /// Returns a minute of walking in which one frame is a spike.
    fn with_spike(at: usize) -> Arc<Motion> {
        let clip = synthesize(&Params { duration_secs: 60.0, ..Params::new(Action::Walk) })
            .expect("natural parameters")
            .clip;
        let mut roots = clip.root_translations().to_vec();
        roots[at].y += 3.0;
        let rotations = clip.all_rotations().to_vec();
        let skeleton = Arc::clone(clip.skeleton());
        Arc::new(Motion::analyze(
            Clip::new("spike", skeleton, clip.fps(), rotations, roots).expect("lengths fit"),
        ))
    }

    fn refined(values: &CurveValues, frames: usize) -> Vec<[f64; 2]> {
        let mut extremes = values.extremes();
        loop {
            if let Some(points) = extremes.advance(values, frames) {
                return points;
            }
        }
    }

    #[test]
    fn long_curve_shows_a_spike_of_one_frame() {
        let motion = with_spike(1_843);
        let (clip, fps) = (motion.clip(), motion.clip().fps());
        let values = CurveValues::of_motion(&motion, 0, CurveKind::Height, 2.0);
        let all = joint_curve(clip, 0, CurveKind::Height);
        let is_spike = |point: &[f64; 2]| point[1] > 3.0;
        assert!(values.is_long() && !values.sampled().iter().any(is_spike));
        let points = refined(&values, 1_000);
        assert_eq!(points, refined(&values, 7));
        assert!(points.len() <= MAX_POINTS + 2, "{}", points.len());
        assert!(points.windows(2).all(|pair| pair[0][0] < pair[1][0]));
        let spike = points.iter().find(|point| is_spike(point)).unwrap();
        assert_eq!(*spike, [2.0 + 1_843.0 / fps, f64::from(all[1_843])]);
        let ends =
            [0, all.len() - 1].map(|frame| [2.0 + frame as f64 / fps, f64::from(all[frame])]);
        assert_eq!([points[0], points[points.len() - 1]], ends);
        // Each point is one of the curve.
        for [secs, value] in points {
            assert_eq!(value, f64::from(all[((secs - 2.0) * fps).round() as usize]));
        }
    }

    #[test]
    fn value_at_a_time_is_that_of_its_frame() {
        let motion = with_spike(1_843);
        let (clip, fps) = (motion.clip(), motion.clip().fps());
        for kind in [CurveKind::Height, CurveKind::Speed, CurveKind::AngularSpeed] {
            let values = CurveValues::of_motion(&motion, 3, kind, 0.5);
            let all = joint_curve(clip, 3, kind);
            for (frame, value) in all.iter().enumerate() {
                assert_eq!(values.value_at(0.5 + frame as f64 / fps), Some(f64::from(*value)));
            }
            let between = values.value_at(0.5 + 1_842.25 / fps).unwrap();
            let expected = 0.75 * f64::from(all[1_842]) + 0.25 * f64::from(all[1_843]);
            assert!((between - expected).abs() < 1e-6, "{between} {expected}");
            let end = 0.5 + (all.len() - 1) as f64 / fps;
            assert_eq!([values.value_at(0.4), values.value_at(end + 0.01)], [None, None]);
            let part = values.within(|secs| (1.0..2.0).contains(&secs));
            assert_eq!(
                (part.value_at(0.9), part.value_at(1.0).is_some(), part.value_at(2.0)),
                (None, true, None)
            );
            assert!(!part.is_long() && part.sampled().len() == fps as usize);
        }
    }

    #[test]
    fn values_of_chosen_frames_have_gaps() {
        let motion = with_spike(3);
        let own = [None, Some(1), Some(3), Some(90_000), Some(5)];
        let values = CurveValues::of_frames(&motion, 0, CurveKind::Height, 10.0, own.to_vec());
        let height = |frame: usize| f64::from(motion.clip().root_translations()[frame].y);
        let points = [[0.1, height(1)], [0.2, height(3)], [0.4, height(5)]];
        assert_eq!(values.sampled(), points);
        assert_eq!(refined(&values, 1), points);
        assert_eq!([values.value_at(0.0), values.value_at(0.25), values.value_at(0.3)], [None; 3]);
        assert_eq!(
            [values.value_at(0.1), values.value_at(0.4)],
            [Some(height(1)), Some(height(5))]
        );
    }
}
