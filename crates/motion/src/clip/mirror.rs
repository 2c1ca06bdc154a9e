//! Mirroring of clips.

use super::{Clip, ClipError};
use crate::math::quat;
use crate::skeleton::{Mirror, NoCounterparts, Roles, rest_is_plausible};

/// The greatest number of frames from which a joint's usual rotation is computed.
const MAX_SAMPLES: usize = 240;

/// Error mirroring a clip.
#[derive(Clone, Debug, PartialEq, thiserror::Error, segue_text::ToMessage)]
pub enum MirrorError {
    /// Left and right are unknown.
    #[error(transparent)]
    NoCounterparts(#[from] NoCounterparts),
    /// The result is not a valid clip.
    #[error(transparent)]
    Clip(#[from] ClipError),
}

/// Mirrors a clip in the plane x = 0 of the world: a left turn becomes a right turn, and the right
/// hand makes the motion of the left.
///
/// The skeleton stays the same, with its own bone lengths on either side. Mirroring twice gives the
/// original back to within 3e-5. [`Mirror`] describes the method.
///
/// # Errors
/// [`MirrorError::NoCounterparts`] when neither roles nor names distinguish left from right.
pub fn mirror(clip: &Clip, roles: &Roles) -> Result<Clip, MirrorError> {
    let mirror = mirror_of(clip, roles)?;
    let poses = (0..clip.frames()).map(|frame| mirror.pose(&clip.pose(frame)));
    let mirrored = Clip::from_poses(clip.name(), clip.skeleton().clone(), clip.fps(), poses)?;
    Ok(mirrored.with_provenance(clip.provenance()))
}

/// Returns the mirror of a clip's skeleton: by its rest pose where that is plausible, otherwise by
/// the motion.
fn mirror_of(clip: &Clip, roles: &Roles) -> Result<Mirror, NoCounterparts> {
    let skeleton = clip.skeleton();
    if rest_is_plausible(skeleton, roles) != Some(false) {
        return Mirror::of(skeleton, roles);
    }
    let step = clip.frames().div_ceil(MAX_SAMPLES).max(1);
    let usual = (0..skeleton.len()).map(|joint| {
        let frames = (0..clip.frames()).step_by(step);
        quat::mean(frames.filter_map(|frame| clip.rotations(frame).get(joint).copied()))
    });
    Mirror::of_motion(skeleton, roles, &usual.collect::<Vec<_>>())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::clip::JointTranslations;
    use crate::clip::fixtures::{largest_distance, wander, wander_by};
    use crate::skeleton::{Joint, Pose, Role, Skeleton, fixtures};
    use crate::synth::{Action, Params, synthesize};
    use glam::{Quat, Vec3};
    use proptest::prelude::*;
    use std::sync::Arc;

    fn reflected(p: Vec3) -> Vec3 {
        p * Vec3::new(-1.0, 1.0, 1.0)
    }

    /// Returns the largest distance between the reflected positions of `clip` and those of its
    /// mirror image.
    fn largest_error(clip: &Clip, mirrored: &Clip, roles: &Roles) -> f32 {
        let pairs = Mirror::of(clip.skeleton(), roles).unwrap();
        let mut worst = 0.0f32;
        for frame in 0..clip.frames() {
            let (original, image) = (clip.world_pose(frame), mirrored.world_pose(frame));
            for joint in 0..clip.skeleton().len() {
                let other = pairs.counterpart(joint).expect("these rigs are symmetric");
                worst = worst
                    .max(image.positions[joint].distance(reflected(original.positions[other])));
            }
        }
        worst
    }

    #[test]
    fn mirror_of_a_symmetric_rig_reflects_every_joint() {
        for (rig, skeleton, _) in fixtures::all() {
            let (roles, clip) = (fixtures::roles(&skeleton), wander(&skeleton, 9, 5));
            let error = largest_error(&clip, &mirror(&clip, &roles).unwrap(), &roles);
            assert!(error < 1e-5, "{rig}: {error} m");
        }
    }

    /// The axes of joints do not matter, only their positions.
    #[test]
    fn mirror_does_not_depend_on_joint_axes() {
        for (rig, skeleton, _) in fixtures::all() {
            let (roles, clip) = (fixtures::roles(&skeleton), wander(&skeleton, 4, 9));
            let axes: Vec<Quat> = (0..skeleton.len())
                .map(|joint| {
                    Quat::from_scaled_axis(Vec3::new(1.0, -0.4, 0.7) * (1.0 + joint as f32))
                })
                .collect();
            let above =
                |joint: usize| skeleton.parent(joint).map_or(Quat::IDENTITY, |parent| axes[parent]);
            let joints = skeleton.joints().iter().enumerate().map(|(index, joint)| Joint {
                offset: above(index).conjugate() * joint.offset,
                end_site: joint.end_site.map(|end| axes[index].conjugate() * end),
                ..joint.clone()
            });
            let turned = Arc::new(Skeleton::new(joints.collect()).unwrap());
            let rotations = (0..clip.frames()).flat_map(|frame| {
                let turn = |(joint, q): (usize, &Quat)| above(joint).conjugate() * *q * axes[joint];
                clip.rotations(frame).iter().enumerate().map(turn).collect::<Vec<_>>()
            });
            let rewritten = Clip::new(
                "turned",
                turned,
                clip.fps(),
                rotations.collect(),
                clip.root_translations().to_vec(),
            )
            .unwrap();
            let (plain, other) =
                (mirror(&clip, &roles).unwrap(), mirror(&rewritten, &roles).unwrap());
            let (p, q) = (plain.world_positions(0..4), other.world_positions(0..4));
            let far = p.iter().zip(&q).map(|(p, q)| p.distance(*q)).fold(0.0, f32::max);
            assert!(far < 1e-3, "{rig}: {far} m");
        }
    }

    /// An implausible rest pose does not determine rotations about bones; a spine must not come out
    /// rotated by half a turn.
    #[test]
    fn mirror_with_implausible_rest_pose_keeps_usual_rotations() {
        let clip = synthesize(&Params::new(Action::Walk)).unwrap().clip;
        let roles = Roles::detect(clip.skeleton());
        for seed in 0..4 {
            let (turned, turns) = fixtures::turned(clip.skeleton(), seed);
            let poses: Vec<Pose> = (0..clip.frames())
                .map(|frame| fixtures::turned_pose(clip.skeleton(), &turns, &clip.pose(frame)))
                .collect();
            let rewritten = Clip::from_poses("turned", turned, clip.fps(), poses).unwrap();
            let image = mirror(&rewritten, &roles).unwrap();
            let mean = |clip: &Clip, joint: usize| {
                quat::mean((0..clip.frames()).map(|frame| clip.rotations(frame)[joint]))
            };
            for joint in 1..clip.skeleton().len() {
                let apart =
                    quat::angle_between(mean(&rewritten, joint), mean(&image, joint)).to_degrees();
                assert!(apart < 8.0, "{seed}: {} {apart}°", clip.skeleton().joints()[joint].name);
            }
            assert!(largest_distance(&rewritten, &mirror(&image, &roles).unwrap()) < 1e-3);
        }
    }

    #[test]
    fn mirror_of_a_left_turn_is_a_right_turn() {
        let skeleton = fixtures::lafan();
        let roles = fixtures::roles(&skeleton);
        let clip =
            wander_by(&skeleton, 2, 1, 0.1).transformed(&crate::math::Planar::new(0.7, 1.0, 2.0));
        let facing = |clip: &Clip| crate::clip::facing(&clip.world_pose(0), &roles).unwrap();
        let (original, image) = (facing(&clip), facing(&mirror(&clip, &roles).unwrap()));
        assert!(
            original.x > 0.5 && (image - reflected(original)).length() < 1e-5,
            "{original} {image}"
        );
    }

    /// The plane of symmetry at rest need not be x = 0: in some rigs every bone lies along +X at
    /// rest.
    #[test]
    fn mirror_with_another_plane_of_symmetry_reflects_every_joint() {
        let upright = fixtures::mixamo();
        let lie =
            Quat::from_axis_angle(Vec3::ONE.normalize_or(Vec3::X), std::f32::consts::TAU / 3.0);
        for (turn, tolerance) in
            [(lie, 1e-5), (Quat::from_rotation_y(0.6), 1e-5), (Quat::from_rotation_y(0.1), 2.0)]
        {
            let joints = upright.joints().iter().map(|joint| Joint {
                offset: turn * joint.offset,
                end_site: joint.end_site.map(|end| turn * end),
                ..joint.clone()
            });
            let skeleton = Arc::new(Skeleton::new(joints.collect()).unwrap());
            let (roles, clip) = (fixtures::roles(&upright), wander(&skeleton, 5, 2));
            let mirrored = mirror(&clip, &roles).unwrap();
            assert!(largest_error(&clip, &mirrored, &roles) < tolerance);
            assert!(largest_distance(&clip, &mirror(&mirrored, &roles).unwrap()) < 1e-5);
        }
    }

    #[test]
    fn mirror_of_an_uneven_rig_reflects_bone_directions() {
        let skeleton = fixtures::uneven(&fixtures::cmu_bvh(), 1.0, 0.1, 0.1, 4);
        let roles = fixtures::roles(&skeleton);
        let clip = wander(&skeleton, 6, 8);
        let mirrored = mirror(&clip, &roles).unwrap();
        for frame in 0..clip.frames() {
            let (original, image) = (clip.world_pose(frame), mirrored.world_pose(frame));
            for (role, next) in
                Role::ALL.into_iter().zip(Role::ALL.into_iter().skip(1)).filter(|(role, next)| {
                    role.side().is_some()
                        && role.side() == next.side()
                        && ![Role::LeftToe, Role::RightToe].contains(role)
                })
            {
                let bone = |world: &crate::skeleton::WorldPose, a, b| {
                    (world.positions[roles.get(b).unwrap()]
                        - world.positions[roles.get(a).unwrap()])
                    .normalize_or_zero()
                };
                let wanted = reflected(bone(&original, role.mirrored(), next.mirrored()));
                assert!(bone(&image, role, next).distance(wanted) < 1e-4, "{role:?}");
            }
        }
    }

    #[test]
    fn mirror_of_joint_translations_reflects_them() {
        let skeleton = fixtures::bandai();
        let roles = fixtures::roles(&skeleton);
        let (hips, hand) = (roles.get(Role::Hips).unwrap(), roles.get(Role::LeftHand).unwrap());
        let way =
            |base: Vec3| (0..6).map(|i| base + Vec3::new(0.1, 0.02, 0.05) * i as f32).collect();
        let tracks = vec![
            JointTranslations { joint: hips, values: way(Vec3::new(0.2, 0.95, 0.0)) },
            JointTranslations { joint: hand, values: way(skeleton.joints()[hand].offset) },
        ];
        let clip = wander(&skeleton, 6, 1).with_translations(tracks).unwrap();
        let mirrored = mirror(&clip, &roles).unwrap();
        assert!(largest_error(&clip, &mirrored, &roles) < 1e-5);
        assert_eq!(mirrored.translations()[1].joint, roles.get(Role::RightHand).unwrap());
        assert!(largest_distance(&clip, &mirror(&mirrored, &roles).unwrap()) < 1e-5);
    }

    #[test]
    fn mirror_without_sides_is_refused() {
        let clip = wander(&fixtures::nameless(&fixtures::lafan()), 2, 0);
        assert_eq!(
            mirror(&clip, &Roles::default()),
            Err(MirrorError::NoCounterparts(NoCounterparts))
        );
        let named = wander(&fixtures::lafan(), 2, 0);
        assert!(
            largest_error(&named, &mirror(&named, &Roles::default()).unwrap(), &Roles::default())
                < 1e-5
        );
    }

    /// The collars and the neck of this rig start at one joint and lie nearly on one line.
    #[test]
    fn mirror_of_bones_on_one_line_is_an_involution() {
        for (seed, radians) in [(9, 0.026_989_816), (385, 0.017_760_007), (532, 0.033_390_578)] {
            let (_, skeleton, _) = fixtures::all().swap_remove(1);
            assert_involution(&fixtures::uneven(&skeleton, 1.0, radians, 0.2, seed), seed);
        }
    }

    fn assert_involution(skeleton: &Arc<Skeleton>, seed: u64) {
        let (skeleton, _) = fixtures::shuffled(skeleton, seed);
        let (roles, clip) = (fixtures::roles(&skeleton), wander(&skeleton, 4, seed));
        let twice = mirror(&mirror(&clip, &roles).unwrap(), &roles).unwrap();
        let distance = largest_distance(&clip, &twice);
        assert!(distance < 1e-5, "{distance} m");
        for frame in 0..clip.frames() {
            for (a, b) in clip.rotations(frame).iter().zip(twice.rotations(frame)) {
                assert!(crate::math::quat::angle_between(*a, *b) < 1e-5);
            }
        }
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(24))]
        #[test]
        fn mirror_twice_is_the_original(
            rig in 0usize..11,
            seed in 0u64..1000,
            radians in 0.0f32..0.3,
        ) {
            let (_, skeleton, _) = fixtures::all().swap_remove(rig);
            assert_involution(&fixtures::uneven(&skeleton, 1.0, radians, 0.2, seed), seed);
        }
    }
}
