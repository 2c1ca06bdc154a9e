//! Alignment of one clip with another over the ground.

use crate::clip::Clip;
use crate::math::Planar;
use crate::registration::{Alignment, RegistrationError, align};

/// Aligns clip `b` with clip `a` over a window: `A[frame_a..frame_a + window)` and
/// `B[frame_b..frame_b + window)`, at least one frame. The alignment's transform is
/// `a_world_from_b_world`.
///
/// `weights` has one weight per joint ([`crate::registration::limb_weights`]); `fallback_yaw` is
/// the yaw where every yaw fits equally well (the difference of the facings is a good one).
///
/// # Errors
/// [`RegistrationError`] when a window crosses the end of its clip, or the skeletons or weights do
/// not have the same number of joints.
pub fn align_onto(
    a: &Clip,
    frame_a: usize,
    b: &Clip,
    frame_b: usize,
    window: usize,
    weights: &[f64],
    fallback_yaw: f64,
) -> Result<Alignment, RegistrationError> {
    let window = window.max(1);
    let (source_joints, target_joints) = (a.skeleton().len(), b.skeleton().len());
    if source_joints != target_joints {
        return Err(RegistrationError::Skeletons { source_joints, target_joints });
    }
    for (which, clip, frame) in [("outgoing", a, frame_a), ("incoming", b, frame_b)] {
        let frames = clip.frames().saturating_sub(frame);
        if window > frames {
            return Err(RegistrationError::TooShort { which, frames, window });
        }
    }
    align(
        &a.world_positions(frame_a..frame_a + window),
        &b.world_positions(frame_b..frame_b + window),
        weights,
        fallback_yaw,
    )
}

/// Returns the transform of ground frame `b` to ground frame `a`: same position, same facing. It
/// depends on one frame only, whereas [`align_onto`] uses the whole body over a window.
#[must_use]
pub fn align_facing(a: &Planar, b: &Planar) -> Planar {
    a.after(&b.inverse())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::clip::character_frames;
    use crate::registration::fixtures::Walk;
    use crate::registration::limb_weights;
    use crate::skeleton::Roles;
    use proptest::prelude::*;

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(32))]
        #[test]
        fn align_facing_keeps_joint_distances(
            yaw in -3.2f64..3.2,
            x in -20.0f64..20.0,
            z in -20.0f64..20.0,
            f in 0usize..60,
            g in 0usize..60,
        ) {
            let clip = Walk { frames: 60, turning: 0.8, ..Walk::default() }.clip();
            let moved = clip.transformed(&Planar::new(yaw, x, z));
            let (p, q) = (clip.world_positions(f..f + 1), clip.world_positions(g..g + 1));
            let (mp, mq) = (moved.world_positions(f..f + 1), moved.world_positions(g..g + 1));
            for i in 0..p.len() {
                prop_assert!((p[i].y - mp[i].y).abs() < 1e-5);
                for j in 0..q.len() {
                    prop_assert!((p[i].distance(q[j]) - mp[i].distance(mq[j])).abs() < 1e-5);
                }
            }
        }

        #[test]
        fn alignment_of_a_moved_clip_is_the_inverse_transform(
            yaw in -3.1f64..3.1,
            x in -9.0f64..9.0,
            z in -9.0f64..9.0,
        ) {
            let clip = Walk { frames: 40, turning: 0.8, ..Walk::default() }.clip();
            let there = Planar::new(yaw, x, z);
            let moved = clip.transformed(&there);
            let weights = limb_weights(clip.skeleton());
            let roles = Roles::detect(clip.skeleton());
            let windowed = align_onto(&clip, 7, &moved, 7, 12, &weights, 0.0).unwrap().transform;
            let facing = align_facing(
                &character_frames(&clip, &roles)[7],
                &character_frames(&moved, &roles)[7],
            );
            for found in [windowed, facing] {
                let still = found.after(&there);
                prop_assert!(still.yaw.abs() < 1e-4 && still.shift.length() < 1e-3, "{still:?}");
            }
        }
    }

    #[test]
    fn align_onto_beyond_the_clip_is_refused() {
        let clip = Walk { frames: 10, ..Walk::default() }.clip();
        let weights = limb_weights(clip.skeleton());
        assert!(align_onto(&clip, 6, &clip, 0, 4, &weights, 0.0).is_ok());
        let error = align_onto(&clip, 0, &clip, 7, 4, &weights, 0.0).unwrap_err();
        assert_eq!(error, RegistrationError::TooShort { which: "incoming", frames: 3, window: 4 });
        assert!(align_onto(&clip, 99, &clip, 0, 0, &weights, 0.0).is_err());
    }
}
