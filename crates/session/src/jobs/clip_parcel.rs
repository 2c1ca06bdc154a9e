//! Clips without their skeleton, as parts of parcels.

use super::parcel::{ArrayReader, split_floats};
use super::{Parcel, ParcelError};
use glam::Vec3;
use segue_motion::clip::{Clip, JointTranslations, Provenance};
use segue_motion::skeleton::Skeleton;
use serde::{Deserialize, Serialize};
use std::borrow::Cow;
use std::sync::Arc;

/// A clip without its skeleton and its arrays.
#[derive(Debug, Serialize, Deserialize)]
pub(super) struct ClipHead<'a> {
    name: Cow<'a, str>,
    fps: f64,
    pub(super) frames: usize,
    provenance: Provenance,
    /// The joints that have translations.
    moving: Vec<usize>,
}

impl<'a> ClipHead<'a> {
    pub(super) fn of(clip: &'a Clip) -> Self {
        Self {
            name: Cow::Borrowed(clip.name()),
            fps: clip.fps(),
            frames: clip.frames(),
            provenance: clip.provenance(),
            moving: clip.translations().iter().map(|track| track.joint).collect(),
        }
    }

    /// Takes the arrays of the clip, and returns it.
    pub(super) fn take(
        self,
        skeleton: &Arc<Skeleton>,
        arrays: &mut ArrayReader<'_>,
    ) -> Result<Clip, ParcelError> {
        let count = self.frames.checked_mul(skeleton.len()).ok_or(ParcelError::Arrays)?;
        let rotations = arrays.take_rotations(count)?;
        let mut values = || -> Result<Vec<Vec3>, ParcelError> {
            let all = split_floats(&mut arrays.floats, self.frames, 3)?;
            Ok(all.chunks_exact(3).map(Vec3::from_slice).collect())
        };
        let root = values()?;
        let mut tracks = Vec::new();
        for joint in self.moving {
            tracks.push(JointTranslations { joint, values: values()? });
        }
        let skeleton = Arc::clone(skeleton);
        let clip = Clip::new(self.name, skeleton, self.fps, rotations, root)
            .and_then(|clip| clip.with_translations(tracks))
            .map_err(|_| ParcelError::Arrays)?;
        Ok(clip.with_provenance(self.provenance))
    }
}

/// Returns the arrays of a clip, in their order on the way to a worker.
pub(crate) fn arrays_of(clip: &Clip) -> impl Iterator<Item = &[f32]> {
    std::iter::once(bytemuck::cast_slice(clip.all_rotations())).chain(translations_of(clip))
}

fn translations_of(clip: &Clip) -> impl Iterator<Item = &[f32]> {
    let tracks = clip.translations().iter().map(|track| &track.values[..]);
    std::iter::once(clip.root_translations()).chain(tracks).map(bytemuck::cast_slice)
}

/// Appends the arrays of a clip to an answer.
pub(super) fn put_clip(parcel: &mut Parcel, clip: &Clip) {
    parcel.rotations.push(clip.all_rotations().to_vec());
    parcel.floats.reserve(translations_of(clip).map(<[f32]>::len).sum());
    translations_of(clip).for_each(|array| parcel.floats.extend_from_slice(array));
}
