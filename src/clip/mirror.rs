use super::{Clip, ClipError};
use crate::skeleton::{Mirror, NoSides, Roles};

/// Why a clip has no mirror image.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum MirrorError {
    /// Left and right are not known.
    #[error(transparent)]
    NoSides(#[from] NoSides),
    /// The result is no clip.
    #[error(transparent)]
    Clip(#[from] ClipError),
}

/// The clip in a mirror that stands on the plane x = 0 of the world: a left turn becomes a right turn, what the left hand did does the right.
///
/// The skeleton stays, with its own bone lengths on either side. Twice is the original again, to within 1e-5. See [`Mirror`] for the way.
///
/// # Errors
/// [`MirrorError::NoSides`] when neither roles nor names tell left from right.
pub fn mirror(clip: &Clip, roles: &Roles) -> Result<Clip, MirrorError> {
    let mirror = Mirror::of(clip.skeleton(), roles)?;
    let poses = (0..clip.frames()).map(|frame| mirror.pose(&clip.pose(frame)));
    let mirrored = Clip::from_poses(clip.name(), clip.skeleton().clone(), clip.fps(), poses)?;
    Ok(mirrored.with_provenance(clip.provenance()))
}
