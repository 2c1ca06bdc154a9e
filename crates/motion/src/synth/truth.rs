//! Ground truth of synthesised motions.

use crate::clip::Clip;

/// The parts of a foot that stand still on the ground in a frame.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub struct FootContact {
    /// The heel ([`super::heel_in_foot`]) stands still.
    pub heel: bool,
    /// The joint of the toes stands still.
    pub toe: bool,
}

impl FootContact {
    /// Returns whether any part of the foot is on the ground.
    #[must_use]
    pub const fn any(&self) -> bool {
        self.heel || self.toe
    }

    /// Returns whether the foot is flat on the ground and at rest.
    #[must_use]
    pub const fn flat(&self) -> bool {
        self.heel && self.toe
    }
}

/// The known properties of a synthesised motion.
#[derive(Clone, Debug, PartialEq)]
pub struct Truth {
    /// Speed over the ground at full gait, metres per second; 0 where the action has none.
    pub speed_mps: f32,
    /// Turn rate of the path at full gait, degrees per second, positive to the left.
    pub turn_rate_dps: f32,
    /// Duration of one cycle (two steps) at full gait, seconds; 0 where there is none.
    pub cycle_secs: f32,
    /// Steps per minute at full gait; 0 where there are none.
    pub cadence_spm: f32,
    /// Length of two steps along the path at full gait, metres.
    pub stride_m: f32,
    /// One per frame: 0 at the left heel strike, rising to 1 at the next; constant while the body
    /// stands.
    pub phase: Vec<f32>,
    /// One per frame: left and right foot.
    pub contacts: Vec<[FootContact; 2]>,
}

/// A synthesised motion with its known properties.
#[derive(Clone, Debug, PartialEq)]
pub struct Synthesized {
    /// The motion.
    pub clip: Clip,
    /// Its known properties.
    pub truth: Truth,
}
