use super::{Clip, ClipError, Interpolation, JointTranslations};

/// The highest frame rate that a clip is resampled to, frames per second; guards the memory against a slip of the keyboard.
const MAX_FPS: f64 = 1000.0;

/// The clip at another frame rate, read from itself by `interpolation`.
///
/// The first and the last frame stay what they are. Where the duration is no whole number of new frames it is rounded to the nearest one: the
/// clip then plays by up to half a frame longer or shorter. At its own frame rate the clip comes back unchanged.
///
/// # Errors
/// [`ClipError::FrameRate`] when `fps` is not a positive number, or is above both 1000 and the clip's own rate.
pub fn resample(clip: &Clip, fps: f64, interpolation: Interpolation) -> Result<Clip, ClipError> {
    if !(fps > 0.0 && fps <= MAX_FPS.max(clip.fps())) {
        return Err(ClipError::FrameRate(fps));
    }
    if fps == clip.fps() || clip.frames() == 0 {
        // An empty clip has no poses, but it does have a rate.
        let same = Clip::new(clip.name(), clip.skeleton().clone(), fps, Vec::new(), Vec::new());
        return if clip.frames() == 0 {
            Ok(same?.with_provenance(clip.provenance()))
        } else {
            Ok(clip.clone())
        };
    }
    let duration_secs = clip.duration_secs();
    let steps = if duration_secs > 0.0 {
        ((duration_secs * fps).round() as usize).max(1)
    } else {
        0
    };
    let mut rotations = Vec::with_capacity((steps + 1) * clip.skeleton().len());
    let mut root_translations = Vec::with_capacity(steps + 1);
    let mut tracks: Vec<JointTranslations> = clip
        .translations()
        .iter()
        .map(|track| JointTranslations {
            joint: track.joint,
            values: Vec::with_capacity(steps + 1),
        })
        .collect();
    for step in 0..=steps {
        let time_secs = duration_secs * step as f64 / steps.max(1) as f64;
        let Some(pose) = clip.sample(time_secs, interpolation) else {
            continue;
        };
        root_translations.push(pose.root_translation);
        rotations.extend_from_slice(&pose.rotations);
        for (track, (_, value)) in tracks.iter_mut().zip(pose.translations) {
            track.values.push(value);
        }
    }
    let resampled = Clip::new(clip.name(), clip.skeleton().clone(), fps, rotations, root_translations)?;
    Ok(resampled.with_translations(tracks)?.with_provenance(clip.provenance()))
}
