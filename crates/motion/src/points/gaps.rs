//! Tracks of single points, with their gaps.

use crate::math::curve::hermite;
use glam::Vec3;

/// Gaps up to this long are filled in the position of the point, seconds: within a quarter of a
/// second a limb does not turn back.
const SHORT_SECS: f64 = 0.25;

/// The gaps in a set of points.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Gaps {
    /// The number of points with a gap in some frame.
    pub points: usize,
    /// Missing positions that were filled between the frames before and after.
    pub filled: usize,
    /// Missing positions in longer gaps, where the pose between was interpolated, and at the ends,
    /// where it was held.
    pub held: usize,
    /// The longest gap, frames.
    pub longest: usize,
    /// The names of points that are never seen: left out.
    pub unseen: Vec<String>,
}

impl Gaps {
    /// Returns the positions of a point with all gaps filled, and counts them: by a cubic in short
    /// ones, linearly in long ones, held at the ends. `None` if the point is never seen.
    pub fn fill(&mut self, values: impl Iterator<Item = Vec3>, fps: f64) -> Option<Vec<Vec3>> {
        Some(Track::of(values, fps, self)?.complete())
    }
}

/// The positions of a point.
#[derive(Clone, Debug)]
pub(super) struct Track {
    /// Zero where the position is not known.
    pub(super) at: Vec<Vec3>,
    pub(super) known: Vec<bool>,
}

impl Track {
    /// Returns the positions of one point, short gaps filled; `None` if it is never seen.
    pub(super) fn of(
        values: impl Iterator<Item = Vec3>,
        fps: f64,
        gaps: &mut Gaps,
    ) -> Option<Self> {
        let mut track = Self { at: Vec::new(), known: Vec::new() };
        for value in values {
            let known = value.is_finite();
            track.known.push(known);
            track.at.push(if known { value } else { Vec3::ZERO });
        }
        if !track.known.contains(&true) {
            return None;
        }
        track.fill_short((SHORT_SECS * fps).round() as usize, gaps);
        Some(track)
    }

    pub(super) fn get(&self, frame: usize) -> Option<Vec3> {
        self.known.get(frame).is_some_and(|known| *known).then(|| self.at[frame])
    }

    fn fill_short(&mut self, short: usize, gaps: &mut Gaps) {
        let frames = self.at.len();
        let mut has_gap = false;
        let mut frame = 0;
        while frame < frames {
            if self.known[frame] {
                frame += 1;
                continue;
            }
            has_gap = true;
            let end = (frame..frames).find(|&next| self.known[next]).unwrap_or(frames);
            let length = end - frame;
            gaps.longest = gaps.longest.max(length);
            if frame > 0 && end < frames && length <= short {
                self.fill(frame, end);
                gaps.filled += length;
            } else {
                gaps.held += length;
            }
            frame = end;
        }
        gaps.points += usize::from(has_gap);
    }

    /// Fills the gap from `start` until `end` by a cubic with the velocities at both ends.
    fn fill(&mut self, start: usize, end: usize) {
        let (from, to) = (self.at[start - 1], self.at[end]);
        let length = (end - start + 1) as f32;
        let slope = |other: Option<usize>, here: usize, sign: f32| {
            other
                .filter(|&other| self.known.get(other).is_some_and(|known| *known))
                .map_or((to - from) / length, |other| (self.at[here] - self.at[other]) * sign)
        };
        let leave = slope((start - 1).checked_sub(1), start - 1, 1.0) * length;
        let arrive = slope(Some(end + 1), end, -1.0) * length;
        for frame in start..end {
            let t = (frame + 1 - start) as f32 / length;
            self.at[frame] = hermite(from, leave, to, arrive, t);
        }
        self.known[start..end].fill(true);
    }

    /// Returns a position for every frame: between known ones linear, at the ends held.
    pub(super) fn complete(&self) -> Vec<Vec3> {
        let mut complete = self.at.clone();
        fill_between(&self.known, &mut complete, |a, b, t| a.lerp(*b, t));
        complete
    }
}

/// Replaces unknown values between known ones by `between`, and those at the ends by the nearest
/// known one. Nothing changes without a known value.
pub(super) fn fill_between<T: Clone>(
    known: &[bool],
    values: &mut [T],
    between: impl Fn(&T, &T, f32) -> T,
) {
    let frames = known.len().min(values.len());
    let mut before: Option<usize> = None;
    let mut frame = 0;
    while frame < frames {
        if known[frame] {
            before = Some(frame);
            frame += 1;
            continue;
        }
        let after = (frame..frames).find(|&next| known[next]);
        let end = after.unwrap_or(frames);
        for gap in frame..end {
            values[gap] = match (before, after) {
                (Some(a), Some(b)) => {
                    let t = (gap - a) as f32 / (b - a) as f32;
                    between(&values[a], &values[b], t)
                }
                (Some(one), None) | (None, Some(one)) => values[one].clone(),
                (None, None) => values[gap].clone(),
            };
        }
        frame = end;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn short_gap_follows_the_curve_and_long_gap_stays_open() {
        let curve = |frame: usize| {
            let x = frame as f32 * 0.1;
            Vec3::new(x, (2.0 * x).sin(), 0.0)
        };
        let mut gaps = Gaps::default();
        let is_gap = |frame: usize| (10..14).contains(&frame) || (40..60).contains(&frame);
        let values = (0..80).map(|frame| if is_gap(frame) { Vec3::NAN } else { curve(frame) });
        let track = Track::of(values, 30.0, &mut gaps).unwrap();
        for frame in 10..14 {
            assert!(track.get(frame).unwrap().distance(curve(frame)) < 0.03, "{frame}");
        }
        assert!((40..60).all(|frame| track.get(frame).is_none()));
        assert_eq!((gaps.points, gaps.filled, gaps.held, gaps.longest), (1, 4, 20, 20));
        let complete = track.complete();
        assert!(complete[49].distance(curve(39).lerp(curve(60), 10.0 / 21.0)) < 1e-5);
    }

    #[test]
    fn point_that_is_never_seen_has_no_track() {
        let mut gaps = Gaps::default();
        assert!(Track::of([Vec3::NAN; 3].into_iter(), 30.0, &mut gaps).is_none());
        assert!(Track::of(std::iter::empty(), 30.0, &mut gaps).is_none());
        let seen_late = [Vec3::NAN, Vec3::NAN, Vec3::X].into_iter();
        let track = Track::of(seen_late, 30.0, &mut gaps).unwrap();
        assert_eq!(track.complete(), [Vec3::X; 3]);
        assert_eq!(gaps.held, 2);
    }
}
