//! Deviation of a clip from another, by parts of the body.

use crate::blend::{BodyPart, mask};
use crate::clip::Clip;
use crate::math::quat;
use crate::skeleton::Roles;

/// The joints of the arms.
const ARMS: &[BodyPart] = &[BodyPart::LeftArm, BodyPart::RightArm];

/// The deviation of a clip's joints from those of another clip of the same skeleton, by parts of
/// the body: degrees, the mean over the joints of the part and over the frames that both have.
/// Joints are compared relative to their parents, the root in the world. `None` for a part without
/// known roles.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Deviations {
    /// The deviation of both arms.
    pub arms_deg: Option<f64>,
    /// The deviation of the spine.
    pub spine_deg: Option<f64>,
    /// The deviation of neck and head.
    pub head_deg: Option<f64>,
    /// The deviation of hips and legs.
    pub legs_deg: Option<f64>,
}

impl Deviations {
    /// Measures the angles between the joints of `result` and those of `base`.
    #[must_use]
    pub fn measure(result: &Clip, base: &Clip, roles: &Roles) -> Self {
        let frames = result.frames().min(base.frames());
        let joints = result.skeleton().len().min(base.skeleton().len());
        let mut turned = vec![0.0_f64; joints];
        for frame in 0..frames {
            let pairs = result.rotations(frame).iter().zip(base.rotations(frame));
            for (sum, (&here, &there)) in turned.iter_mut().zip(pairs) {
                // Frames that are equal bit for bit are skipped.
                if here != there {
                    *sum += f64::from(quat::angle_between(here, there));
                }
            }
        }
        let mean_deg = |parts: &[BodyPart]| {
            let weights = mask(result.skeleton(), roles, parts, 0);
            let (mut sum, mut count) = (0.0, 0.0);
            for (&turned, &weight) in turned.iter().zip(&weights) {
                sum += turned * f64::from(weight);
                count += f64::from(weight);
            }
            (count > 0.0 && frames > 0).then(|| (sum / count / frames as f64).to_degrees())
        };
        Self {
            arms_deg: mean_deg(ARMS),
            spine_deg: mean_deg(&[BodyPart::Spine]),
            head_deg: mean_deg(&[BodyPart::Head]),
            legs_deg: mean_deg(&[BodyPart::LowerBody]),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::skeleton::Role;
    use crate::synth::{Action, Params, synthesize};
    use glam::Quat;

    #[test]
    fn deviations_of_a_turned_arm_are_those_of_the_arm() {
        let clip = synthesize(&Params::new(Action::Idle)).unwrap().clip;
        let roles = Roles::detect(clip.skeleton());
        let arm = roles.get(Role::LeftUpperArm).unwrap();
        let joints = clip.skeleton().len();
        let mut rotations: Vec<Quat> =
            (0..clip.frames()).flat_map(|frame| clip.rotations(frame).to_vec()).collect();
        for pose in rotations.chunks_mut(joints) {
            pose[arm] = Quat::from_rotation_x(0.5) * pose[arm];
        }
        let turned = Clip::new(
            "turned",
            clip.skeleton().clone(),
            clip.fps(),
            rotations,
            clip.root_translations().to_vec(),
        )
        .unwrap();
        let found = Deviations::measure(&turned, &clip, &roles);
        let in_arms = mask(clip.skeleton(), &roles, ARMS, 0).iter().sum::<f32>();
        let arms_deg = found.arms_deg.unwrap();
        assert!((arms_deg - f64::from(0.5_f32.to_degrees() / in_arms)).abs() < 1e-3, "{found:?}");
        let rest = [found.spine_deg, found.head_deg, found.legs_deg];
        assert_eq!(rest, [Some(0.0); 3]);
        let nobody = Deviations::measure(&turned, &clip, &Roles::default());
        assert!(nobody.arms_deg.is_none() && nobody.head_deg.is_none());
    }
}
