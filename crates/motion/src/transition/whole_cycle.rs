//! Clips that are a single cycle, or most of one.

use super::moving::{View, travel, with_travel};
use super::{Loop, LoopError, LoopOptions, close_loop};
use crate::blend::{Assembly, moving_joints};
use crate::clip::Motion;
use crate::math::quat;
use crate::registration::limb_weights;
use crate::skeleton::WorldPose;
use glam::{Quat, Vec3};
use std::ops::Range;

/// A clip that is one cycle, or most of one: its end leads into its beginning.
///
/// Captured cycles rarely contain the frame that corresponds to the first one. The time from the
/// last frame to the first one is chosen to match the velocities of both ends best: with the
/// difference of the poses `D` and the mean of the velocities `v`, both in the character's frame
/// and over all joints, it would be `(D · v)/|v|²` for steady motion; along a sine of the cycle's
/// period, whose chord is shorter than its tangents, it is `t = (T/π) atan(π/T · (D · v)/|v|²)`.
/// Frames for that time are added: the clip is extrapolated with its last velocity, which changes
/// to the first frame's. The remaining difference between the ends is left to [`close_loop`].
#[derive(Clone, Debug)]
pub struct WholeCycle {
    source: Motion,
    /// The frames that play; the end corresponds to the first frame. It lies after the clip's last
    /// frame where frames were added.
    pub frames: Range<usize>,
    /// Number of frames added after the clip's last one, including the one that corresponds to the
    /// first frame.
    pub added_frames: usize,
    /// Root mean square distance between the joints of both ends, which [`close_loop`] has to
    /// bridge, centimetres.
    pub gap_cm: f64,
    /// The distance between both ends as a share of the greatest distance of any frame of the clip
    /// to its first one. Small for a cycle; 1 where the clip leads away.
    pub gap_share: f64,
}

/// The greatest share of a cycle that may be missing.
const MAX_MISSING: f64 = 0.25;
/// The least speed of the joints at the ends of a cycle, as a share of their mean speed: a motion
/// that comes to rest there happens only once.
const MIN_SPEED: f64 = 0.3;
/// The time over which the velocities of the ends are measured, seconds.
const VELOCITY_SECS: f64 = 1.0 / 30.0;
/// The least share of the clip over which the velocity changes in added frames: over fewer frames
/// it would be a jerk.
const MIN_CHANGE_SHARE: f64 = 0.15;
/// The greatest distance between the ends of a cycle, as a share of the greatest distance of any of
/// its poses to the first.
const MAX_GAP_SHARE: f64 = 0.5;
/// The greatest difference of the velocities over the ground at both ends is this share of the mean
/// speed, plus [`MAX_SPEED_DIFFERENCE_MPS`].
const MAX_SPEED_DIFFERENCE_SHARE: f64 = 0.5;
/// The constant part of the greatest difference of the velocities at both ends, metres per second.
const MAX_SPEED_DIFFERENCE_MPS: f64 = 0.2;

impl WholeCycle {
    /// Analyses a clip as a cycle. `None` for a clip that is not one: of fewer than eight frames;
    /// with ends that are more than half as far apart as any two of its poses; one that is much
    /// faster at one end than at the other, as a start or a stop; or one that rests at an end, as a
    /// turn on the spot. Nothing is asked of a declared cycle ([`Motion::is_cycle`]) but three
    /// frames.
    #[must_use]
    pub fn of(source: &Motion) -> Option<Self> {
        let clip = source.clip();
        let (frames, fps) = (clip.frames(), clip.fps());
        if source.is_cycle() && frames > 2 {
            let source = source.clone();
            let (added_frames, gap_cm, gap_share) = (0, 0.0, 0.0);
            return Some(Self { source, frames: 0..frames - 1, added_frames, gap_cm, gap_share });
        }
        if frames < 8 {
            return None;
        }
        let last = frames - 1;
        let reach = ((VELOCITY_SECS * fps).round() as usize).clamp(1, last / 4);
        if !keeps_its_speed(source, reach) {
            return None;
        }
        let weights = limb_weights(clip.skeleton());
        let mut world = WorldPose::default();
        let mut cloud = |frame: usize| -> Vec<Vec3> {
            clip.world_pose_into(frame, &mut world);
            let here = source.ground_frames()[frame].inverse();
            world.positions.iter().map(|&position| here.apply(position)).collect()
        };
        let [first, second, before, end] = [0, reach, last - reach, last].map(&mut cloud);
        let rate = 0.5 / reach as f32;
        let ends = || first.iter().zip(&second).zip(before.iter().zip(&end)).zip(&weights);
        // Differences from the last frame to the first, and mean velocities per frame.
        let pairs = || {
            ends().map(|(((&first, &second), (&before, &end)), &weight)| {
                (first - end, (second - first + end - before) * rate, weight)
            })
        };
        let sum = |of: &dyn Fn(Vec3, Vec3) -> f32| -> f64 {
            pairs().map(|(d, v, weight)| weight * f64::from(of(d, v))).sum()
        };
        let along = sum(&|d, v| d.dot(v));
        let square = sum(&|_, v| v.length_squared());
        let most = MAX_MISSING / (1.0 - MAX_MISSING) * last as f64;
        let steady = if square > 0.0 { (along / square).max(0.0) } else { 0.0 };
        // The period is not known before; a few rounds of iteration suffice.
        let sine = |missing: f64| {
            let rate = std::f64::consts::PI / (last as f64 + missing);
            libm::atan(rate * steady) / rate
        };
        let added_frames =
            (0..8).fold(steady, |missing, _| sine(missing)).min(most).round() as usize;
        let total: f64 = weights.iter().sum();
        let rms = |square: f64| (square / total.max(f64::MIN_POSITIVE)).sqrt();
        let apart = rms(sum(&|d, v| (d - v * added_frames as f32).length_squared()));
        let between = |a: &[Vec3], b: &[Vec3]| {
            let squares = a.iter().zip(b).zip(&weights);
            rms(squares.map(|((a, b), &weight)| weight * f64::from(a.distance_squared(*b))).sum())
        };
        let (mut farthest, mut way, mut earlier) = (0.0f64, 0.0, first.clone());
        for frame in 1..frames {
            let here = cloud(frame);
            farthest = farthest.max(between(&first, &here));
            way += between(&earlier, &here);
            earlier = here;
        }
        let least = MIN_SPEED * way / last as f64 * reach as f64;
        if between(&first, &second) < least || between(&before, &end) < least {
            return None;
        }
        let share = if farthest > 0.0 { apart / farthest } else { 1.0 };
        if share.is_nan() || share > MAX_GAP_SHARE {
            return None;
        }
        Some(Self {
            source: if added_frames > 0 {
                with_added_frames(source, added_frames)?
            } else {
                source.clone()
            },
            frames: 0..last + added_frames,
            added_frames,
            gap_cm: 100.0 * apart,
            gap_share: share,
        })
    }

    /// Closes the cycle ([`close_loop`]).
    ///
    /// # Errors
    /// The same as for [`close_loop`].
    pub fn close(&self, options: &LoopOptions) -> Result<Loop, LoopError> {
        close_loop(&self.source, self.frames.clone(), options)
    }
}

/// Returns whether the body is about as fast at the end as at the beginning, each over `reach`
/// frames.
fn keeps_its_speed(source: &Motion, reach: usize) -> bool {
    let stands = source.ground_frames();
    let fps = source.clip().fps();
    let last = stands.len() - 1;
    let velocity = |from: usize, to: usize| {
        stands[from].inverse().after(&stands[to]).shift * (fps / (to - from) as f64)
    };
    let way: f64 = stands.windows(2).map(|pair| pair[0].shift.distance(pair[1].shift)).sum();
    let mean = way * fps / last as f64;
    velocity(0, reach).distance(velocity(last - reach, last))
        <= MAX_SPEED_DIFFERENCE_SHARE * mean + MAX_SPEED_DIFFERENCE_MPS
}

/// Extrapolates a clip after its end until it moves as at its beginning: `added_frames`, and one
/// more to give the velocity there. `None` when the result is not a valid clip.
fn with_added_frames(source: &Motion, added_frames: usize) -> Option<Motion> {
    let clip = source.clip();
    let (frames, fps) = (clip.frames(), clip.fps());
    let last = frames - 1;
    let moving = moving_joints(clip, clip);
    let view = View { source, moving: &moving, fixed: None };
    let poses = [0, 1, last - 1, last].map(|frame| view.pose(frame));
    let [first, second, before, end] = &poses;
    let over = (added_frames as f64).max(MIN_CHANGE_SHARE * last as f64) as f32;
    // From the velocity at the end to that at the beginning, evenly over `over` frames; all per
    // frame.
    let extrapolated = |from: Vec3, to: Vec3, frame: f32| {
        from * frame + (to - from) * (0.5 * frame * frame / over)
    };
    let turn = |from: Quat, to: Quat| quat::log(to * from.conjugate());
    let turns: Vec<(Vec3, Vec3)> = (0..end.0.len())
        .map(|joint| (turn(before.0[joint], end.0[joint]), turn(first.0[joint], second.0[joint])))
        .collect();
    let shifts: Vec<(Vec3, Vec3)> = (0..end.1.len())
        .map(|slot| (end.1[slot] - before.1[slot], second.1[slot] - first.1[slot]))
        .collect();
    let steps = [last, 1].map(|into| travel(&source.step_into(into), fps));

    let mut made_clip = Assembly::new(clip, clip, frames + added_frames + 1);
    made_clip.play(clip, 0..frames);
    let mut stands = source.ground_frames().to_vec();
    let mut here = *stands.last()?;
    for frame in 1..=added_frames + 1 {
        let at = frame as f32;
        let step = steps[0] + (steps[1] - steps[0]) * ((at - 0.5) / over);
        here = here.after(&with_travel(&crate::math::Planar::IDENTITY, step, fps.recip()));
        let mut rotations: Vec<Quat> = (end.0.iter().zip(&turns))
            .map(|(&rotation, &(from, to))| {
                quat::renormalize(quat::exp(extrapolated(from, to, at)) * rotation)
            })
            .collect();
        if let Some(root) = rotations.first_mut() {
            *root = quat::renormalize(here.rotation() * *root);
        }
        let translations: Vec<Vec3> = (end.1.iter().zip(&shifts))
            .map(|(&translation, &(from, to))| translation + extrapolated(from, to, at))
            .collect();
        let root = here.apply(translations[0]);
        made_clip.push(root, &rotations, &translations[1..]);
        stands.push(here);
    }
    let extended = made_clip.finish(clip.name().to_owned()).ok()?;
    Some(source.same_body(extended, stands))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::registration::fixtures::Walk;

    fn source_of(walk: &Walk) -> Motion {
        Motion::analyze(walk.clip())
    }

    /// Returns a walk whose stride takes 60 frames, cut to `frames`.
    fn walk(frames: usize, turning: f32) -> Motion {
        source_of(&Walk { frames, cadence: 1.0, turning, phase: 0.15, ..Walk::default() })
    }

    #[test]
    fn whole_cycle_with_missing_frames_adds_them() {
        let whole = walk(200, 0.5);
        // With the first frame again, without it, and without a tenth and a fifth of the cycle.
        for (frames, within) in [(61, 0), (60, 0), (58, 1), (54, 1), (48, 3)] {
            let cycle = WholeCycle::of(&walk(frames, 0.5)).unwrap();
            assert!(cycle.frames.len().abs_diff(60) <= within, "{frames}: {:?}", cycle.frames);
            assert_eq!(cycle.added_frames, cycle.frames.end + 1 - frames);
            assert!(cycle.gap_share < 0.2, "{frames}: {} cm, {}", cycle.gap_cm, cycle.gap_share);
            let looped = cycle.close(&LoopOptions::default()).unwrap();
            assert!(looped.seam.turn_deg < 1e-3 && looped.seam.turn_dps < 0.1, "{:?}", looped.seam);
            // The cycle follows the walk, after three rounds as well.
            let round = whole.ground_frames()[0].inverse().after(&whole.ground_frames()[60]);
            let found = looped.frames[0].inverse().after(&looped.cycle.after(&looped.frames[0]));
            let off = found.shift.distance(round.shift) / round.shift.length();
            assert!(
                off < 0.02 * (1 + 2 * within) as f64 && (found.yaw - round.yaw).abs() < 0.03,
                "{frames}: {found:?} {round:?}"
            );
        }
    }

    #[test]
    fn whole_cycle_adds_the_frames_of_the_walk() {
        let (whole, cut) = (walk(61, 0.0), walk(54, 0.0));
        let cycle = WholeCycle::of(&cut).unwrap();
        let positions = |source: &Motion, frame: usize| source.clip().world_pose(frame).positions;
        for frame in 54..59 {
            let apart = positions(&whole, frame)
                .iter()
                .zip(&positions(&cycle.source, frame))
                .map(|(a, b)| a.distance(*b))
                .fold(0.0, f32::max);
            assert!(apart < 0.05, "{frame}: {apart}");
        }
    }

    #[test]
    fn whole_cycle_of_a_motion_that_rests_is_none() {
        use crate::synth::{Action, Params, synthesize};
        for action in [Action::Spin, Action::Start, Action::Stop, Action::Jump] {
            let clip = synthesize(&Params::new(action)).unwrap().clip;
            assert!(WholeCycle::of(&Motion::analyze(clip)).is_none(), "{action:?}");
        }
    }

    #[test]
    fn whole_cycle_of_a_motion_that_leads_away_is_none() {
        for frames in [2, 7, 20, 32, 95, 150] {
            assert!(WholeCycle::of(&walk(frames, 0.0)).is_none(), "{frames}");
        }
        // Two and three strides are cycles, too.
        for frames in [121, 181] {
            assert_eq!(WholeCycle::of(&walk(frames, 0.0)).unwrap().frames, 0..frames - 1);
        }
    }
}
