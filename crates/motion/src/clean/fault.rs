//! Faults as data: what is wrong, where, and how sure that is.

use super::tracks::Tracks;
use crate::math::sort::sort_by_key;
use crate::skeleton::Foot;
use std::ops::Range;

/// The kinds of faults, in the order in which they are mended.
#[derive(
    Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, serde::Serialize, serde::Deserialize,
)]
pub enum FaultKind {
    /// Left and right are exchanged.
    Swap,
    /// A limb or the whole body holds still while it ought to move.
    Gap,
    /// A joint leaves its trajectory for a few frames, or flips and flips back.
    Spike,
    /// A joint trembles.
    Jitter,
    /// The body drifts or turns while its feet are planted.
    Drift,
    /// The feet stand above or below the ground.
    Ground,
    /// Frames at an end that do not belong to the motion.
    Ends,
    /// Planted feet slide.
    Skating,
    /// The motion plays at a wrong speed.
    Rate,
}

impl FaultKind {
    /// All kinds, in the order in which they are mended.
    pub const ALL: [Self; 9] = [
        Self::Swap,
        Self::Gap,
        Self::Spike,
        Self::Jitter,
        Self::Drift,
        Self::Ground,
        Self::Ends,
        Self::Skating,
        Self::Rate,
    ];

    /// Returns the word in reports.
    #[must_use]
    pub const fn word(self) -> &'static str {
        match self {
            Self::Swap => "swap",
            Self::Gap => "gap",
            Self::Spike => "spike",
            Self::Jitter => "jitter",
            Self::Drift => "drift",
            Self::Ground => "ground",
            Self::Ends => "ends",
            Self::Skating => "skating",
            Self::Rate => "rate",
        }
    }
}

/// How a fault is mended, with the numbers that the mend needs.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub(super) enum Form {
    /// A few frames between good ones, which are drawn anew.
    Run,
    /// A joint that turns over and back: its own motion stays, and the turn is taken out. The
    /// first vector is the rotation by which it turned over, radians.
    Flip(glam::Vec3),
    /// The track of the counterpart on the other side, with which it is exchanged.
    Exchange(usize),
    /// Noise with this standard deviation for each axis, radians or metres.
    Noise(f32),
    /// Ground that rises, metres per second, from this height, metres.
    Level {
        /// The height at the first frame, metres.
        from_m: f32,
        /// The slope, metres per second.
        rise_mps: f32,
    },
    /// A drift over the ground, (x, z) in metres per second, and about the vertical, radians per
    /// second.
    Drift {
        /// The velocity, metres per second.
        velocity_mps: glam::DVec2,
        /// The turn rate, radians per second.
        turn_rps: f64,
    },
    /// Frames before the motion begins, or after it ends.
    Outside,
    /// A foot that slides in a stance.
    Slide(Foot),
    /// The frame rate at which the motion would look right, frames per second.
    Rate(f64),
}

/// A fault of one track: a joint's rotation, or a translation.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub(super) struct TrackFault {
    /// The index among all tracks.
    pub(super) track: usize,
    pub(super) frames: Range<usize>,
    pub(super) form: Form,
    /// Degrees or centimetres.
    pub(super) size: f32,
    pub(super) confidence: f32,
}

/// A fault that was found.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Fault {
    /// The kind.
    pub kind: FaultKind,
    /// The frames of the take that are wrong.
    pub frames: Range<usize>,
    /// The faults of single tracks; empty for a fault of the whole body.
    pub(super) tracks: Vec<TrackFault>,
    /// The form of a fault of the whole body; `None` for a fault of single tracks.
    pub(super) whole: Option<Form>,
    /// The joints that are wrong, in their order; empty for a fault of the whole body.
    pub joints: Vec<usize>,
    /// How large it is, in the unit of [`unit`](Self::unit).
    pub size: f32,
    /// The unit of the size.
    pub unit: SizeUnit,
    /// How sure it is, from 0 to 1.
    pub confidence: f32,
}

/// The unit of a fault's size.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub enum SizeUnit {
    /// Degrees.
    Degrees,
    /// Centimetres.
    Centimetres,
    /// Frames.
    Frames,
    /// Degrees per second.
    DegreesPerSecond,
    /// Centimetres per second.
    CentimetresPerSecond,
    /// Frames per second.
    FramesPerSecond,
}

impl SizeUnit {
    /// Returns the unit as it is written after a number.
    #[must_use]
    pub const fn text(self) -> &'static str {
        match self {
            Self::Degrees => "°",
            Self::Centimetres => "cm",
            Self::Frames => "frames",
            Self::DegreesPerSecond => "°/s",
            Self::CentimetresPerSecond => "cm/s",
            Self::FramesPerSecond => "fps",
        }
    }
}

impl Fault {
    /// Returns a fault of some tracks, which takes its size from the largest.
    pub(super) fn of_tracks(kind: FaultKind, mut parts: Vec<TrackFault>, tracks: &Tracks) -> Self {
        sort_by_key(&mut parts, |part| part.track);
        let frames = parts.iter().map(|part| part.frames.start).min().unwrap_or(0)
            ..parts.iter().map(|part| part.frames.end).max().unwrap_or(0);
        let mut joints: Vec<usize> = parts.iter().map(|part| tracks.joint_of[part.track]).collect();
        joints.sort_unstable();
        joints.dedup();
        // Rotations say more than shifts; a shift alone is told in its own unit.
        let turns = parts.iter().any(|part| tracks.all[part.track].is_turn());
        let told = parts.iter().filter(|part| tracks.all[part.track].is_turn() == turns);
        Self {
            kind,
            frames,
            size: told.map(|part| part.size).fold(0.0, f32::max),
            unit: if turns { SizeUnit::Degrees } else { SizeUnit::Centimetres },
            confidence: parts.iter().map(|part| part.confidence).fold(0.0, f32::max),
            tracks: parts,
            whole: None,
            joints,
        }
    }

    /// Returns a fault of the whole body.
    pub(super) fn of_body(
        kind: FaultKind,
        frames: Range<usize>,
        form: Form,
        (size, unit): (f32, SizeUnit),
        confidence: f32,
    ) -> Self {
        let (tracks, joints) = (Vec::new(), Vec::new());
        Self { kind, frames, tracks, whole: Some(form), joints, size, unit, confidence }
    }

    /// The confidence from which on a fault is sure enough to be mended unasked.
    pub const SURE: f32 = 0.5;

    /// Returns whether it is sure enough to be mended unasked.
    #[must_use]
    pub fn is_sure(&self) -> bool {
        self.confidence >= Self::SURE
    }

    /// Returns the frame rate at which the motion would look right, frames per second; `None` for
    /// other faults.
    #[must_use]
    pub fn likely_fps(&self) -> Option<f64> {
        match self.whole {
            Some(Form::Rate(fps)) => Some(fps),
            _ => None,
        }
    }

    /// Returns whether it is a fault of single joints for some frames, not of the whole body.
    #[must_use]
    pub fn is_in_tracks(&self) -> bool {
        !self.tracks.is_empty()
    }

    /// Returns whether it shares frames and a joint with another fault's.
    #[must_use]
    pub fn overlaps(&self, frames: &Range<usize>, joints: &[usize]) -> bool {
        self.frames.start < frames.end
            && frames.start < self.frames.end
            && (self.joints.is_empty() || joints.iter().any(|joint| self.joints.contains(joint)))
    }
}

/// Returns a confidence of one half where `score` is `half`, which approaches 1 above it.
pub(super) fn confidence(score: f32, half: f32) -> f32 {
    let ratio = (score / half).max(0.0);
    (ratio * ratio / (1.0 + ratio * ratio)).clamp(0.0, 1.0)
}
