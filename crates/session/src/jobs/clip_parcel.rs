//! Clips without their skeleton, as parts of parcels.

use super::ParcelError;
use super::parcel::split_floats;
use glam::{Quat, Vec3};
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

    /// Moves the arrays of the clip from the front of `floats`, and returns the clip.
    pub(super) fn take(
        self,
        skeleton: &Arc<Skeleton>,
        floats: &mut &[f32],
    ) -> Result<Clip, ParcelError> {
        let rotations = split_floats(floats, self.frames, 4 * skeleton.len())?;
        let rotations = rotations.chunks_exact(4).map(|q| Quat::from_xyzw(q[0], q[1], q[2], q[3]));
        let mut values = || -> Result<Vec<Vec3>, ParcelError> {
            let all = split_floats(floats, self.frames, 3)?;
            Ok(all.chunks_exact(3).map(Vec3::from_slice).collect())
        };
        let root = values()?;
        let mut tracks = Vec::new();
        for joint in self.moving {
            tracks.push(JointTranslations { joint, values: values()? });
        }
        let skeleton = Arc::clone(skeleton);
        let clip = Clip::new(self.name, skeleton, self.fps, rotations.collect(), root)
            .and_then(|clip| clip.with_translations(tracks))
            .map_err(|_| ParcelError::Arrays)?;
        Ok(clip.with_provenance(self.provenance))
    }
}

/// Returns the arrays of a clip, in their order in a parcel.
pub(crate) fn arrays_of(clip: &Clip) -> impl Iterator<Item = &[f32]> {
    let tracks = clip.translations().iter().map(|track| &track.values[..]);
    let translations = std::iter::once(clip.root_translations()).chain(tracks);
    std::iter::once(bytemuck::cast_slice(clip.all_rotations()))
        .chain(translations.map(bytemuck::cast_slice))
}

/// Appends the arrays of a clip.
pub(super) fn put_clip(floats: &mut Vec<f32>, clip: &Clip) {
    floats.reserve(arrays_of(clip).map(<[f32]>::len).sum());
    arrays_of(clip).for_each(|array| floats.extend_from_slice(array));
}
