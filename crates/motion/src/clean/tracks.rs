//! A clip by columns: one track for each joint's rotation, and one for each translation.

use crate::clip::{Clip, ClipError, JointTranslations};
use crate::math::{curve::hermite, quat};
use crate::skeleton::Skeleton;
use glam::{Quat, Vec3};
use std::f32::consts::TAU;
use std::ops::Range;
use std::sync::Arc;

/// One quantity of a body over all frames.
#[derive(Clone, Debug)]
pub(super) enum Track {
    /// Local rotations of a joint, each in the hemisphere of the one before.
    Turn(Vec<Quat>),
    /// Translations of the root or of a joint, metres.
    Place(Vec<Vec3>),
}

impl Track {
    pub(super) fn len(&self) -> usize {
        match self {
            Self::Turn(values) => values.len(),
            Self::Place(values) => values.len(),
        }
    }

    pub(super) fn is_turn(&self) -> bool {
        matches!(self, Self::Turn(_))
    }

    /// Returns the way from one frame to another: a rotation vector in the parent's frame, radians,
    /// or a shift, metres.
    pub(super) fn way(&self, from: usize, to: usize) -> Vec3 {
        match self {
            Self::Turn(values) => quat::log(values[to] * values[from].conjugate()),
            Self::Place(values) => values[to] - values[from],
        }
    }

    /// Returns the way from one frame to another that is nearer to `wanted`: a fast turn may take
    /// the longer way round.
    pub(super) fn way_like(&self, from: usize, to: usize, wanted: Vec3) -> Vec3 {
        let short = self.way(from, to);
        let angle = short.length();
        if !self.is_turn() || angle < 1e-3 {
            return short;
        }
        let long = short * ((angle - TAU) / angle);
        if long.distance_squared(wanted) < short.distance_squared(wanted) { long } else { short }
    }

    /// Returns the steps from each frame to the next: one fewer than there are frames.
    pub(super) fn steps(&self) -> Vec<Vec3> {
        (1..self.len()).map(|frame| self.way(frame - 1, frame)).collect()
    }

    /// Returns the velocity per frame over a range of frames: the median of its steps.
    pub(super) fn velocity(&self, first: usize, last: usize) -> Vec3 {
        let last = last.min(self.len().saturating_sub(1));
        let steps: Vec<Vec3> = (first..last).map(|frame| self.way(frame, frame + 1)).collect();
        median(&steps)
    }

    /// Returns the velocity per frame at the end of a range of frames, or at its start: that of the
    /// line through its steps (least squares), as far as it does not leave their spread.
    pub(super) fn velocity_at(&self, first: usize, last: usize, at_end: bool) -> Vec3 {
        let last = last.min(self.len().saturating_sub(1));
        let steps: Vec<Vec3> = (first..last).map(|frame| self.way(frame, frame + 1)).collect();
        let usual = median(&steps);
        if steps.len() < 3 {
            return usual;
        }
        let middle = (steps.len() - 1) as f32 * 0.5;
        let mean = steps.iter().sum::<Vec3>() / steps.len() as f32;
        let (mut slope, mut norm) = (Vec3::ZERO, 0.0);
        for (at, step) in steps.iter().enumerate() {
            let x = at as f32 - middle;
            slope += (*step - mean) * x;
            norm += x * x;
        }
        let x = if at_end { middle + 0.5 } else { -middle - 0.5 };
        let spread = steps.iter().map(|step| step.distance(usual)).fold(0.0, f32::max);
        usual + (mean + slope / norm * x - usual).clamp_length_max(spread * 0.7)
    }

    /// Returns the distance of a frame from a value of another track of the same kind.
    pub(super) fn distance(&self, frame: usize, other: &Self, other_frame: usize) -> f32 {
        match (self, other) {
            (Self::Turn(a), Self::Turn(b)) => quat::angle_between(a[frame], b[other_frame]),
            (Self::Place(a), Self::Place(b)) => a[frame].distance(b[other_frame]),
            _ => f32::INFINITY,
        }
    }

    /// Returns the frames between `from` and `to`, both excluded, on the cubic with these
    /// velocities per frame at both ends.
    pub(super) fn bridge(&self, from: usize, to: usize, leave: Vec3, arrive: Vec3) -> Self {
        let length = (to - from) as f32;
        let end = self.way_like(from, to, (leave + arrive) * 0.5 * length);
        let at = |frame: usize| {
            let t = (frame - from) as f32 / length;
            hermite(Vec3::ZERO, leave * length, end, arrive * length, t)
        };
        match self {
            Self::Turn(values) => Self::Turn(
                (from + 1..to)
                    .map(|frame| quat::renormalize(quat::exp(at(frame)) * values[from]))
                    .collect(),
            ),
            Self::Place(values) => {
                Self::Place((from + 1..to).map(|frame| values[from] + at(frame)).collect())
            }
        }
    }

    /// Returns the frames of a range.
    pub(super) fn part(&self, frames: &Range<usize>) -> Self {
        match self {
            Self::Turn(values) => Self::Turn(values[frames.clone()].to_vec()),
            Self::Place(values) => Self::Place(values[frames.clone()].to_vec()),
        }
    }

    /// Overwrites frames from `start` on.
    pub(super) fn put(&mut self, start: usize, part: &Self) {
        match (self, part) {
            (Self::Turn(values), Self::Turn(part)) => {
                values[start..start + part.len()].copy_from_slice(part);
            }
            (Self::Place(values), Self::Place(part)) => {
                values[start..start + part.len()].copy_from_slice(part);
            }
            _ => {}
        }
    }

    /// Brings every rotation from `start` on into the hemisphere of the one before.
    pub(super) fn align_signs(&mut self) {
        if let Self::Turn(values) = self {
            for frame in 1..values.len() {
                values[frame] = quat::in_hemisphere_of(values[frame], values[frame - 1]);
            }
        }
    }
}

/// All tracks of a clip: the rotations of its joints in their order, the translation of the root,
/// then those of the joints that move relative to their parent.
#[derive(Clone, Debug)]
pub(super) struct Tracks {
    pub(super) fps: f64,
    pub(super) frames: usize,
    pub(super) joints: usize,
    pub(super) all: Vec<Track>,
    /// The joint of each track.
    pub(super) joint_of: Vec<usize>,
    /// The parent of each joint.
    pub(super) parents: Vec<Option<usize>>,
}

impl Tracks {
    pub(super) fn of(clip: &Clip) -> Self {
        let (frames, joints) = (clip.frames(), clip.skeleton().len());
        let mut all: Vec<Track> = (0..joints)
            .map(|joint| Track::Turn((0..frames).map(|f| clip.rotations(f)[joint]).collect()))
            .collect();
        all.iter_mut().for_each(Track::align_signs);
        all.push(Track::Place(clip.root_translations().to_vec()));
        all.extend(clip.translations().iter().map(|track| Track::Place(track.values.clone())));
        let moved = clip.translations().iter().map(|track| track.joint);
        let joint_of = (0..joints).chain([0]).chain(moved).collect();
        let parents = clip.skeleton().joints().iter().map(|joint| joint.parent).collect();
        Self { fps: clip.fps(), frames, joints, all, joint_of, parents }
    }

    /// Returns the clip of these tracks, with the name and the units of `like`.
    ///
    /// # Errors
    /// [`ClipError`] if the tracks do not fit the skeleton.
    pub(super) fn clip(&self, like: &Clip) -> Result<Clip, ClipError> {
        let mut rotations = vec![Quat::IDENTITY; self.frames * self.joints];
        let (mut root, mut moved) = (Vec::new(), Vec::new());
        for (index, track) in self.all.iter().enumerate() {
            match track {
                Track::Turn(values) => {
                    let cells = rotations.iter_mut().skip(index).step_by(self.joints);
                    cells.zip(values).for_each(|(cell, value)| *cell = *value);
                }
                Track::Place(values) if index == self.joints => root.clone_from(values),
                Track::Place(values) => moved.push(JointTranslations {
                    joint: self.joint_of[index],
                    values: values.clone(),
                }),
            }
        }
        let skeleton = Arc::<Skeleton>::clone(like.skeleton());
        let clip = Clip::new(like.name(), skeleton, self.fps, rotations, root)?;
        Ok(clip.with_translations(moved)?.with_provenance(like.provenance()))
    }

    /// Returns an angle or a shift of a track in degrees or centimetres.
    pub(super) fn size(&self, track: usize, value: f32) -> f32 {
        if self.all[track].is_turn() { value.to_degrees() } else { value * 100.0 }
    }

    /// Returns a number of frames for a duration, at least `least`.
    pub(super) fn frames_of(&self, secs: f64, least: usize) -> usize {
        ((secs * self.fps).round() as usize).max(least)
    }
}

/// Returns the median of each component.
pub(super) fn median(vectors: &[Vec3]) -> Vec3 {
    if vectors.is_empty() {
        return Vec3::ZERO;
    }
    let middle = vectors.len() / 2;
    let of = |component: fn(&Vec3) -> f32| {
        let mut values: Vec<f32> = vectors.iter().map(component).collect();
        let (below, &mut at, _) = values.select_nth_unstable_by(middle, f32::total_cmp);
        if vectors.len() % 2 == 1 {
            return at;
        }
        let under = below.iter().copied().max_by(f32::total_cmp).unwrap_or(at);
        (at + under) * 0.5
    };
    Vec3::new(of(|v| v.x), of(|v| v.y), of(|v| v.z))
}
