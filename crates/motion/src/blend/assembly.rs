//! Assembly of clips from frames of other clips.

use crate::clip::{Clip, ClipError, JointTranslations, Provenance};
use crate::math::{Planar, quat};
use crate::skeleton::Skeleton;
use glam::{Quat, Vec3};
use std::ops::Range;
use std::sync::Arc;

/// A clip under construction from frames of other clips. A joint that moves relative to its parent
/// in any of them has translations in the result, at its rest offset where its clip does not move
/// it.
#[derive(Debug)]
pub(crate) struct Assembly {
    skeleton: Arc<Skeleton>,
    fps: f64,
    provenance: Provenance,
    rotations: Vec<Quat>,
    roots: Vec<Vec3>,
    tracks: Vec<JointTranslations>,
}

impl Assembly {
    /// Returns an empty clip on the skeleton and at the rate of `first`, with capacity for
    /// `frames`, for frames of two clips.
    pub(crate) fn new(first: &Clip, second: &Clip, frames: usize) -> Self {
        Self::of(first, [first, second], frames)
    }

    /// Returns an empty clip on the skeleton and at the rate of `first`, with capacity for
    /// `frames`, for frames of any number of clips.
    pub(crate) fn of<'a>(
        first: &Clip,
        clips: impl IntoIterator<Item = &'a Clip>,
        frames: usize,
    ) -> Self {
        let tracks = moving_joints_of(clips)
            .into_iter()
            .map(|joint| JointTranslations { joint, values: Vec::with_capacity(frames) });
        Self {
            skeleton: Arc::clone(first.skeleton()),
            fps: first.fps(),
            provenance: first.provenance(),
            rotations: Vec::with_capacity(frames * first.skeleton().len()),
            roots: Vec::with_capacity(frames),
            tracks: tracks.collect(),
        }
    }

    /// Appends frames of a clip unchanged.
    pub(crate) fn play(&mut self, clip: &Clip, frames: Range<usize>) {
        for frame in frames.clone() {
            self.rotations.extend_from_slice(clip.rotations(frame));
        }
        self.roots.extend_from_slice(&clip.root_translations()[frames.clone()]);
        self.play_tracks(clip, frames);
    }

    /// Appends frames of a clip, moved over the ground.
    pub(crate) fn play_moved(
        &mut self,
        clip: &Clip,
        frames: Range<usize>,
        world_from_clip: &Planar,
    ) {
        let turn = world_from_clip.rotation();
        for frame in frames.clone() {
            let first = self.rotations.len();
            self.rotations.extend_from_slice(clip.rotations(frame));
            if let Some(root) = self.rotations.get_mut(first) {
                *root = quat::renormalize(turn * *root);
            }
        }
        self.roots.extend(
            clip.root_translations()[frames.clone()].iter().map(|&p| world_from_clip.apply(p)),
        );
        self.play_tracks(clip, frames);
    }

    fn play_tracks(&mut self, clip: &Clip, frames: Range<usize>) {
        for track in &mut self.tracks {
            if let Some(of) = clip.translations().iter().find(|of| of.joint == track.joint) {
                track.values.extend_from_slice(&of.values[frames.clone()]);
            } else {
                let rest = clip.skeleton().joints()[track.joint].offset;
                track.values.extend(std::iter::repeat_n(rest, frames.len()));
            }
        }
    }

    /// Appends one frame. `translations` has one value for each of [`moving_joints`].
    pub(crate) fn push(&mut self, root: Vec3, rotations: &[Quat], translations: &[Vec3]) {
        for (track, &value) in self.tracks.iter_mut().zip(translations) {
            track.values.push(value);
        }
        self.rotations.extend_from_slice(rotations);
        self.roots.push(root);
    }

    /// Returns the clip.
    pub(crate) fn finish(self, name: String) -> Result<Clip, ClipError> {
        let clip = Clip::new(name, self.skeleton, self.fps, self.rotations, self.roots)?;
        Ok(clip.with_translations(self.tracks)?.with_provenance(self.provenance))
    }
}

/// Returns the joints other than the root that move relative to their parent in either clip, in
/// order.
pub(crate) fn moving_joints(a: &Clip, b: &Clip) -> Vec<usize> {
    moving_joints_of([a, b])
}

/// Returns the joints other than the root that move relative to their parent in any of the clips,
/// in order.
pub(crate) fn moving_joints_of<'a>(clips: impl IntoIterator<Item = &'a Clip>) -> Vec<usize> {
    let tracks = clips.into_iter().flat_map(Clip::translations);
    let mut joints: Vec<usize> = tracks.map(|track| track.joint).collect();
    joints.sort_unstable();
    joints.dedup();
    joints
}

/// Returns the local translation of a joint in a frame, metres: its track or its rest offset.
pub(crate) fn translation_of(clip: &Clip, joint: usize, frame: usize) -> Vec3 {
    let track = clip.translations().iter().find(|track| track.joint == joint);
    track.map_or(clip.skeleton().joints()[joint].offset, |track| track.values[frame])
}
