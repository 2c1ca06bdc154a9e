//! Options of the controller.

use super::super::desired::Steering;
use super::super::{MatchError, Weights};
use crate::math::Decay;
use crate::transition::Inertialization;

/// The conditions that suppress jumps to frames that are only a little better.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub enum Hysteresis {
    /// No condition: the best frame is always taken.
    None,
    /// The cost of the frame that is playing is reduced by a share from 0 to 1, and by a constant.
    ContinuingBias {
        /// The share of its cost.
        share: f32,
        /// The constant.
        constant: f32,
    },
    /// The least time between two jumps, seconds.
    MinimumTime {
        /// Seconds.
        secs: f64,
    },
    /// A jump needs three consecutive searches in favour of one.
    ThreeVotes,
    /// A jump into another clip needs three consecutive searches in favour of one; within its clip
    /// the character jumps at once.
    ThreeVotesForAnotherClip,
}

/// The search algorithm. All find the same frame.
#[derive(
    Clone, Copy, Debug, Default, PartialEq, Eq, Hash, serde::Serialize, serde::Deserialize,
)]
pub enum SearchMethod {
    /// Boxes ([`crate::matching::search::BoxIndex`]).
    #[default]
    Boxes,
    /// The k-d tree of the crate `kiddo`, rebuilt for new weights or another filter.
    Tree,
    /// A scan of all frames.
    Scan,
}

/// Options of the pull of the character towards the simulation object.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct FollowOptions {
    /// Half-life with which the character is pulled towards the simulation object, seconds.
    pub half_life_secs: f64,
    /// The greatest speed of the pull as a share of the character's own speed, so that a standing
    /// character is not pushed along.
    pub max_share: f64,
    /// The greatest distance, metres.
    pub max_distance_m: f64,
    /// The greatest difference of yaw, radians.
    pub max_angle_radians: f64,
}

/// Options of foot planting during playback.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct FootPlanting {
    /// Half-life with which a lifted foot returns to its animated position, seconds.
    pub half_life_secs: f64,
    /// The greatest distance of a planted foot from its animated position, metres, for a body of
    /// 1.75 m; beyond it the foot is released.
    pub max_shift_m: f32,
}

/// Options of a controller: search, transitions, and following.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct ControllerOptions {
    /// The weight of each block of features.
    pub weights: Weights,
    /// Seconds between searches.
    pub search_interval_secs: f64,
    /// The search algorithm.
    pub method: SearchMethod,
    /// The suppression of jumps.
    pub hysteresis: Hysteresis,
    /// While the input is constant, one clip is preferred: a frame of another clip must be cheaper
    /// by this share of the cost, from 0 (no preference) to 1.
    pub prefer_current: f32,
    /// The preferred clip, by its number among those from which the database was built; `None`
    /// prefers the clip that is playing.
    pub prefer_source: Option<usize>,
    /// The transition at a jump.
    pub transition: Inertialization,
    /// The steering of the simulation object.
    pub steering: Steering,
    /// The pull towards the simulation object; `None` leaves root motion to the clips.
    pub following: Option<FollowOptions>,
    /// Foot planting; `None` leaves feet unchanged.
    pub planting: Option<FootPlanting>,
    /// The number of candidates in the record of each search, at most 32. More than one costs a
    /// scan.
    pub candidates: usize,
}

impl Default for ControllerOptions {
    fn default() -> Self {
        Self {
            weights: Weights::default(),
            search_interval_secs: 0.1,
            method: SearchMethod::default(),
            hysteresis: Hysteresis::ContinuingBias { share: 0.15, constant: 0.2 },
            prefer_current: 0.2,
            prefer_source: None,
            transition: Inertialization::Offset(Decay::Spring { half_life_secs: 0.1 }),
            steering: Steering { velocity_half_life_secs: 0.28, facing_half_life_secs: 0.3 },
            following: Some(FollowOptions {
                half_life_secs: 0.1,
                max_share: 0.5,
                max_distance_m: 0.35,
                max_angle_radians: 1.0,
            }),
            planting: Some(FootPlanting { half_life_secs: 0.08, max_shift_m: 0.3 }),
            candidates: 1,
        }
    }
}

impl ControllerOptions {
    /// Checks that every number is in its range.
    ///
    /// # Errors
    /// [`MatchError::Setting`] with the first number that is not.
    pub fn validate(&self) -> Result<(), MatchError> {
        let check = |what, value: f64, least: f64, most: f64| {
            if (least..=most).contains(&value) {
                Ok(())
            } else {
                Err(MatchError::Setting { what, value, least, most })
            }
        };
        self.weights.validate()?;
        check("a search interval (s)", self.search_interval_secs, 0.0, 10.0)?;
        match self.hysteresis {
            Hysteresis::ContinuingBias { share, constant } => {
                check("a continuing bias", f64::from(share), 0.0, 1.0)?;
                check("a continuing bias", f64::from(constant), 0.0, 1e3)?;
            }
            Hysteresis::MinimumTime { secs } => check("a minimum time (s)", secs, 0.0, 10.0)?,
            Hysteresis::None | Hysteresis::ThreeVotes | Hysteresis::ThreeVotesForAnotherClip => {}
        }
        check("a preference for a clip", f64::from(self.prefer_current), 0.0, 1.0)?;
        let times = match self.transition {
            Inertialization::Offset(Decay::Spring { half_life_secs }) => [half_life_secs; 2],
            Inertialization::Offset(
                Decay::Cubic { blend_secs } | Decay::Quintic { blend_secs },
            ) => [blend_secs; 2],
            Inertialization::DeadBlend { blend_secs, extrapolation_half_life_secs } => {
                [blend_secs, extrapolation_half_life_secs]
            }
        };
        for secs in times {
            check("a transition time (s)", secs, 0.0, 10.0)?;
        }
        check("a velocity half-life (s)", self.steering.velocity_half_life_secs, 0.0, 10.0)?;
        check("a facing half-life (s)", self.steering.facing_half_life_secs, 0.0, 10.0)?;
        if let Some(following) = &self.following {
            check("an adjustment half-life (s)", following.half_life_secs, 0.0, 10.0)?;
            check("an adjustment share", following.max_share, 0.0, 10.0)?;
            check("a largest distance (m)", following.max_distance_m, 0.0, 100.0)?;
            check("a largest turn (rad)", following.max_angle_radians, 0.0, 4.0)?;
        }
        if let Some(planting) = &self.planting {
            check("a foot half-life (s)", planting.half_life_secs, 0.0, 10.0)?;
            check("a largest foot shift (m)", f64::from(planting.max_shift_m), 0.0, 10.0)?;
        }
        check("a number of candidates", self.candidates as f64, 0.0, 32.0)
    }
}
