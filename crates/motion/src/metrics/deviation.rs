//! Deviation of a clip from another, by parts of the body.

use super::Metric;
use crate::blend::{BodyPart, mask};
use crate::clip::Clip;
use crate::math::quat;
use crate::skeleton::Roles;

/// The parts that are distinguished: key, label, parts of the body, and help text.
const PARTS: [(&str, &str, &[BodyPart], &str); 4] = [
    (
        "off_arms_deg",
        "Arms off A",
        &[BodyPart::LeftArm, BodyPart::RightArm],
        "How far the joints of the arms are turned from A's, against their parents: the mean over joints and frames.",
    ),
    (
        "off_spine_deg",
        "Spine off A",
        &[BodyPart::Spine],
        "How far the joints of the spine are turned from A's, against their parents: the mean over joints and frames.",
    ),
    (
        "off_head_deg",
        "Head off A",
        &[BodyPart::Head],
        "How far neck and head are turned from A's, against their parents: the mean over joints and frames.",
    ),
    (
        "off_legs_deg",
        "Legs off A",
        &[BodyPart::LowerBody],
        "How far hips and legs are turned from A's, against their parents: the mean over joints and frames.",
    ),
];

/// Returns how far a clip's joints are turned from those of another clip of the same skeleton, for
/// each part: degrees, the mean over the joints of the part and over the frames that both have.
/// Joints are compared relative to their parents, the root in the world. `None` for a part without
/// known roles.
#[must_use]
pub fn deviations(result: &Clip, base: &Clip, roles: &Roles) -> [Metric; 4] {
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
    PARTS.map(|(id, label, parts, help)| {
        let weights = mask(result.skeleton(), roles, parts, 0);
        let (mut sum, mut count) = (0.0, 0.0);
        for (&turned, &weight) in turned.iter().zip(&weights) {
            sum += turned * f64::from(weight);
            count += f64::from(weight);
        }
        let value = (count > 0.0 && frames > 0).then(|| (sum / count / frames as f64).to_degrees());
        Metric::fact(id, label, value, "°", help)
    })
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
        let [arms, rest @ ..] = deviations(&turned, &clip, &roles);
        let in_arms = mask(clip.skeleton(), &roles, PARTS[0].2, 0).iter().sum::<f32>();
        assert!(
            (arms.value.unwrap() - f64::from(0.5_f32.to_degrees() / in_arms)).abs() < 1e-3,
            "{arms:?}"
        );
        assert!(rest.iter().all(|metric| metric.value == Some(0.0)), "{rest:?}");
        let nobody = deviations(&turned, &clip, &Roles::default());
        assert!(nobody[0].value.is_none() && nobody[2].value.is_none());
    }
}
