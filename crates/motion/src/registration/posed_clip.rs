//! What two frames are compared by as single poses: positions, rotations and velocities.

use crate::clip::{Clip, RecentPoses, SingleJolts};
use crate::math::Planar;
use glam::{Quat, Vec3};
use std::sync::Arc;

/// A clip whose frames are posed on demand.
#[derive(Clone, Debug)]
pub(super) struct PosedClip {
    clip: Arc<Clip>,
    /// The character's frame in each frame.
    places: Vec<Planar>,
    jolts: SingleJolts,
}

impl PosedClip {
    /// Returns a clip with the character's frames; frames without one are left out.
    pub(super) fn new((clip, places): (&Arc<Clip>, &[Planar])) -> Self {
        let frames = clip.frames().min(places.len());
        Self {
            clip: Arc::clone(clip),
            places: places[..frames].to_vec(),
            jolts: SingleJolts::new(clip),
        }
    }

    pub(super) fn frames(&self) -> usize {
        self.places.len()
    }

    /// Returns the jolt of a frame ([`crate::clip::jolts`]).
    pub(super) fn jolt(&self, frame: usize) -> f32 {
        self.jolts.at(&self.clip, frame)
    }

    pub(super) fn is_finite(&self) -> bool {
        let tracks = self.clip.translations().iter().flat_map(|track| &track.values);
        self.clip.root_translations().iter().chain(tracks).all(|v| v.is_finite())
            && self.clip.all_rotations().iter().all(|q| q.is_finite())
            && self.places.iter().all(|place| place.yaw.is_finite() && place.shift.is_finite())
    }

    /// Poses some frames, which must exist.
    pub(super) fn posed(&self, frames: impl IntoIterator<Item = usize>) -> PosedFrames {
        let clip = &*self.clip;
        let joints = clip.skeleton().len();
        let mut posed = PosedFrames { joints, ..PosedFrames::default() };
        let mut recent = RecentPoses::of((0..joints).collect());
        for frame in frames {
            let to_here = self.places[frame].inverse();
            let (before, after) = (frame.saturating_sub(1), (frame + 1).min(self.frames() - 1));
            for frame in [before, frame, after] {
                recent.ensure(clip, frame);
            }
            let [last, now, next] =
                [before, frame, after].map(|frame| &recent.get(frame).positions);
            let rate = clip.fps() as f32 / (after - before).max(1) as f32;
            posed.positions.extend(now.iter().map(|&p| to_here.apply(p)));
            let moves = last.iter().zip(next);
            posed
                .velocities
                .extend(moves.map(|(&from, &to)| to_here.apply_vector((to - from) * rate)));
            let root = posed.rotations.len();
            posed.rotations.extend_from_slice(clip.rotations(frame));
            if let Some(root) = posed.rotations.get_mut(root) {
                *root = to_here.rotation() * *root;
            }
        }
        posed
    }
}

/// Posed frames of a clip, frame-major.
#[derive(Clone, Debug, Default)]
pub(super) struct PosedFrames {
    joints: usize,
    positions: Vec<Vec3>,
    rotations: Vec<Quat>,
    velocities: Vec<Vec3>,
}

impl PosedFrames {
    pub(super) fn rows(&self) -> usize {
        self.rotations.len() / self.joints.max(1)
    }

    /// Returns one frame, by its place among those that were posed.
    pub(super) fn row(&self, index: usize) -> PosedFrame<'_> {
        let of = index * self.joints..(index + 1) * self.joints;
        PosedFrame {
            positions: &self.positions[of.clone()],
            rotations: &self.rotations[of.clone()],
            velocities: &self.velocities[of],
        }
    }
}

/// One posed frame, joint by joint, in the character's own frame.
#[derive(Debug)]
pub(super) struct PosedFrame<'a> {
    positions: &'a [Vec3],
    /// Relative to the parents; of the root in the character's frame.
    rotations: &'a [Quat],
    velocities: &'a [Vec3],
}

impl PosedFrame<'_> {
    /// Returns the weighted mean squares of the differences to another frame: of positions (m²),
    /// rotations (rad²) and velocities (m²/s²). The weights of the joints sum to 1.
    pub(super) fn mean_squares(&self, other: &PosedFrame<'_>, weights: &[f32]) -> [f32; 3] {
        let vectors = |p: &[Vec3], q: &[Vec3]| {
            let squares =
                p.iter().zip(q).zip(weights).map(|((p, q), w)| w * p.distance_squared(*q));
            squares.sum::<f32>()
        };
        // 4 sin²(θ/2) = 4 (1 - (p·q)²): θ² for small angles, and the same for q and -q.
        let rotations = self.rotations.iter().zip(other.rotations).zip(weights);
        let rotation = rotations.map(|((p, q), w)| {
            let cosine = p.dot(*q);
            w * 4.0 * (1.0 - cosine * cosine).max(0.0)
        });
        [
            vectors(self.positions, other.positions),
            rotation.sum(),
            vectors(self.velocities, other.velocities),
        ]
    }
}
