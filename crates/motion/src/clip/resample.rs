//! Resampling of clips to another frame rate.

use super::{Clip, ClipError, Interpolation};

/// The highest frame rate of a resampled clip, frames per second; it protects the memory against
/// typing errors.
const MAX_FPS: f64 = 1000.0;

/// Resamples a clip to another frame rate by `interpolation`.
///
/// The first and the last frame stay the same. Where the duration is not a whole number of new
/// frames it is rounded to the nearest one: the clip then plays by up to half a frame longer or
/// shorter. At its own frame rate the clip is returned unchanged.
///
/// ```
/// use glam::{Quat, Vec3};
/// use segue_motion::clip::{Clip, Interpolation, resample};
/// use segue_motion::skeleton::{Joint, Skeleton};
///
/// let name = "ball".into();
/// let joint = Joint { name, parent: None, offset: Vec3::ZERO, end_site: None, channels: vec![] };
/// let ball = Skeleton::new(vec![joint])?;
/// let rolls = (0..=30).map(|i| Vec3::X * i as f32).collect();
/// let clip = Clip::new("ball", ball.into(), 30.0, vec![Quat::IDENTITY; 31], rolls)?;
/// let finer = resample(&clip, 120.0, Interpolation::Linear)?;
/// assert_eq!((finer.frames(), finer.duration_secs()), (121, 1.0));
/// assert_eq!(finer.root_translations()[1], Vec3::X * 0.25);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`ClipError::FrameRate`] when `fps` is not a positive number, or is above both 1000 and the
/// clip's own rate.
pub fn resample(clip: &Clip, fps: f64, interpolation: Interpolation) -> Result<Clip, ClipError> {
    if !(fps > 0.0 && fps <= MAX_FPS.max(clip.fps())) {
        return Err(ClipError::FrameRate(fps));
    }
    if fps == clip.fps() {
        return Ok(clip.clone());
    }
    let duration_secs = clip.duration_secs();
    // At least one step where there is a duration, so that neither end is lost.
    let steps =
        if duration_secs > 0.0 { ((duration_secs * fps).round() as usize).max(1) } else { 0 };
    let times = (0..steps).map(|step| duration_secs * step as f64 / steps as f64);
    // The last frame is copied: its time times the rate need not be an integer in floating point.
    let last = clip.frames().checked_sub(1).map(|last| clip.pose(last));
    let poses = times.filter_map(|time_secs| clip.sample(time_secs, interpolation)).chain(last);
    Ok(Clip::from_poses(clip.name(), clip.skeleton().clone(), fps, poses)?
        .with_provenance(clip.provenance()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::clip::JointTranslations;
    use crate::clip::fixtures::{largest_distance, wander};
    use crate::skeleton::fixtures;
    use glam::{Quat, Vec3};
    use proptest::prelude::*;
    use std::sync::Arc;

    const ALL: [Interpolation; 3] =
        [Interpolation::Nearest, Interpolation::Linear, Interpolation::Cubic];

    proptest! {
        #[test]
        fn resample_at_the_same_rate_is_the_clip(frames in 0usize..9, seed in 0u64..100) {
            let clip = wander(&fixtures::lafan(), frames, seed);
            for how in ALL {
                prop_assert_eq!(resample(&clip, clip.fps(), how), Ok(clip.clone()));
            }
        }

        #[test]
        fn resample_keeps_both_ends(frames in 1usize..40, fps in 5.0f64..240.0, seed in 0u64..100) {
            let clip = wander(&fixtures::lafan(), frames, seed);
            for how in ALL {
                let other = resample(&clip, fps, how).unwrap();
                prop_assert_eq!(other.fps(), fps);
                prop_assert_eq!(other.pose(0), clip.pose(0));
                prop_assert_eq!(other.pose(other.frames() - 1), clip.pose(clip.frames() - 1));
                // The duration changes by half a frame at most, but a clip with a duration keeps
                // one.
                let change = (other.duration_secs() - clip.duration_secs()).abs();
                prop_assert!(change <= 0.5 / fps + 1e-9 || other.frames() == 2);
            }
        }

        /// A multiple of the rate keeps every frame, and resampling back gives the clip again.
        #[test]
        fn resample_to_a_multiple_and_back_is_the_clip(
            frames in 1usize..20,
            times in 2u32..5,
            seed in 0u64..100,
        ) {
            let clip = wander(&fixtures::lafan(), frames, seed);
            for how in ALL {
                let finer = resample(&clip, clip.fps() * f64::from(times), how).unwrap();
                prop_assert_eq!(finer.frames(), (frames - 1) * times as usize + 1);
                let back = resample(&finer, clip.fps(), how).unwrap();
                prop_assert!(largest_distance(&clip, &back) < 1e-5);
            }
        }
    }

    /// Even motion stays even at every rate, and cubic interpolation follows a turn at constant
    /// speed.
    #[test]
    fn resample_of_even_motion_is_even() {
        let skeleton = fixtures::bandai();
        let (joints, frames) = (skeleton.len(), 13);
        let turn = |i: usize| Quat::from_rotation_y(0.2 * i as f32);
        let rotations = (0..frames)
            .flat_map(|i| (0..joints).map(move |j| if j == 0 { turn(i) } else { Quat::IDENTITY }))
            .collect();
        let roots = (0..frames).map(|i| Vec3::Z * 0.1 * i as f32).collect();
        let values = (0..frames).map(|i| Vec3::new(0.0, 0.9, 0.05 * i as f32)).collect();
        let clip = Clip::new("even", Arc::clone(&skeleton), 30.0, rotations, roots).unwrap();
        let clip = clip.with_translations(vec![JointTranslations { joint: 1, values }]).unwrap();
        for how in [Interpolation::Linear, Interpolation::Cubic] {
            let finer = resample(&clip, 75.0, how).unwrap();
            assert_eq!(finer.frames(), 31);
            for frame in 0..finer.frames() {
                let at = frame as f32 * 0.4;
                let inner = how == Interpolation::Linear || (1.0..11.0).contains(&at);
                let tolerance = if inner { 1e-5 } else { 0.05 };
                let wanted = Quat::from_rotation_y(0.2 * at);
                assert!(
                    crate::math::quat::angle_between(finer.rotations(frame)[0], wanted) < tolerance,
                    "{how:?} {frame}"
                );
                assert!(
                    (finer.root_translations()[frame] - Vec3::Z * 0.1 * at).length() < tolerance
                );
                assert!((finer.translations()[0].values[frame].z - 0.05 * at).abs() < tolerance);
            }
        }
    }

    #[test]
    fn resample_at_an_invalid_rate_is_refused() {
        let clip = wander(&fixtures::lafan(), 5, 0);
        for fps in [0.0, -1.0, f64::NAN, f64::INFINITY, 1e300, 1000.1] {
            assert!(
                matches!(resample(&clip, fps, Interpolation::Linear), Err(ClipError::FrameRate(_))),
                "{fps}"
            );
        }
        let empty = wander(&fixtures::lafan(), 0, 0);
        let empty = resample(&empty, 60.0, Interpolation::Cubic).unwrap();
        assert_eq!((empty.frames(), empty.fps()), (0, 60.0));
    }
}
