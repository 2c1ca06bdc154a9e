//! The greatest speeds of motions.

use super::features::RATE;
use crate::clip::Clip;
use crate::math::{Planar, quat, stats, wrap_angle};

/// The percentile that counts as rare.
const RARE_PERCENTILE: f32 = 0.999;
/// The number of steps from which it is computed: enough for the percentile, and bounded for long
/// clips.
const SAMPLES: usize = 4_000;
/// The least value for a joint, radians per second: 60° per second.
const MIN_JOINT_RADPS: f32 = std::f32::consts::FRAC_PI_3;

/// The greatest usual speeds of the motions of a database: a transition or a pull towards the
/// simulation object should not exceed them by much.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Pace {
    /// Per joint: the 99.9th percentile of its angular speed relative to its parent, radians per
    /// second; at least 60° per second.
    pub joints_radps: Vec<f32>,
    /// The highest speed of the simulation root over the ground, metres per second.
    pub travel_mps: f64,
    /// The highest yaw rate, radians per second.
    pub turn_radps: f64,
}

impl Pace {
    /// Measures a clip at [`RATE`] with its simulation roots. O(frames × joints).
    pub(super) fn of(clip: &Clip, roots: &[Planar]) -> Self {
        let rate = RATE as f64;
        let stride = clip.frames().div_ceil(SAMPLES).max(1);
        let usual = |joint: usize| {
            let turns = (1..clip.frames()).step_by(stride).map(|frame| {
                let [from, to] = [frame - 1, frame].map(|frame| clip.rotations(frame)[joint]);
                quat::angle_between(from, to) * RATE as f32
            });
            let turns: Vec<f32> = turns.collect();
            stats::percentile(&turns, RARE_PERCENTILE).unwrap_or(0.0).max(MIN_JOINT_RADPS)
        };
        let steps = || roots.windows(2).map(|pair| (pair[0], pair[1]));
        Self {
            joints_radps: (0..clip.skeleton().len()).map(usual).collect(),
            travel_mps: steps()
                .map(|(from, to)| from.shift.distance(to.shift) * rate)
                .fold(0.0, f64::max),
            turn_radps: steps()
                .map(|(from, to)| wrap_angle(to.yaw - from.yaw).abs() * rate)
                .fold(0.0, f64::max),
        }
    }

    /// Returns the greatest of each.
    pub(super) fn of_all<'a>(paces: impl IntoIterator<Item = &'a Self>) -> Self {
        let mut all = Self::default();
        for pace in paces {
            all.joints_radps
                .resize(all.joints_radps.len().max(pace.joints_radps.len()), MIN_JOINT_RADPS);
            for (most, own) in all.joints_radps.iter_mut().zip(&pace.joints_radps) {
                *most = most.max(*own);
            }
            all.travel_mps = all.travel_mps.max(pace.travel_mps);
            all.turn_radps = all.turn_radps.max(pace.turn_radps);
        }
        all
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::clip::character_frames;
    use crate::matching::simulation_roots;
    use crate::skeleton::Roles;
    use crate::synth::{Action, Params, synthesize};

    #[test]
    fn pace_of_a_set_is_that_of_its_fastest() {
        let pace = |action: Action| {
            let clip = synthesize(&Params::new(action)).unwrap().clip;
            let roles = Roles::detect(clip.skeleton());
            Pace::of(&clip, &simulation_roots(&character_frames(&clip, &roles)))
        };
        let (walk, run) = (pace(Action::Walk), pace(Action::Run));
        assert!((walk.travel_mps - 1.4).abs() < 0.2, "{walk:?}");
        assert!(run.travel_mps > 2.0 * walk.travel_mps && walk.turn_radps < 0.3);
        let both = Pace::of_all([&walk, &run]);
        assert_eq!(both.travel_mps, run.travel_mps);
        assert!(
            (0..both.joints_radps.len())
                .all(|joint| both.joints_radps[joint] >= walk.joints_radps[joint])
        );
        assert!(both.joints_radps.iter().all(|speed| *speed >= MIN_JOINT_RADPS));
    }
}
