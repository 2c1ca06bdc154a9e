use super::super::desired::Steering;
use super::super::{MatchError, Weights};
use crate::math::Decay;
use crate::transition::Inertialization;

/// What keeps the controller from jumping at every search that finds something a little better.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub enum Hysteresis {
    /// Nothing: the best frame is taken.
    None,
    /// The frame that is playing counts as this much better than it is: a share of its cost from 0
    /// to 1, and a constant.
    ContinuingBias {
        /// The share of its cost.
        share: f32,
        /// Cost that is forgiven in any case.
        constant: f32,
    },
    /// No jump sooner than this after another, seconds.
    MinimumTime {
        /// Seconds.
        secs: f64,
    },
    /// A jump needs three searches in a row that want one.
    ThreeVotes,
    /// A jump into another clip needs three searches in a row that want one; within its clip it
    /// jumps at once.
    ThreeVotesForAnotherClip,
}

/// Which search is asked. All find the same frame.
#[derive(
    Clone, Copy, Debug, Default, PartialEq, Eq, Hash, serde::Serialize, serde::Deserialize,
)]
pub enum SearchMethod {
    /// Boxes ([`crate::matching::search::BoxIndex`]).
    #[default]
    Boxes,
    /// The k-d tree of the crate `kiddo`, rebuilt for new weights or another filter.
    Tree,
    /// All frames.
    Scan,
}

/// How the character is held to the simulation object.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Following {
    /// Half-life with which the character is drawn to the simulation object, seconds.
    pub half_life_secs: f64,
    /// Of its own speed, the most that it is drawn by; so that who stands is not pushed along.
    pub most_share: f64,
    /// The farthest it may be away, metres.
    pub most_m: f64,
    /// The farthest it may be turned away, radians.
    pub most_radians: f64,
}

/// How feet are planted while playing.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct FootPlanting {
    /// Half-life with which a foot that was lifted comes back to its own way, seconds.
    pub half_life_secs: f64,
    /// The farthest that a foot is held from its own way, metres, for a body of 1.75 m; then it is
    /// let go.
    pub most_shift_m: f32,
}

/// How a controller searches, goes over, and follows.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct ControllerOptions {
    /// How much each block of features counts.
    pub weights: Weights,
    /// Seconds between searches.
    pub search_interval_secs: f64,
    /// Which search.
    pub method: SearchMethod,
    /// What keeps it from jumping too often.
    pub hysteresis: Hysteresis,
    /// While the input stays as it is, one clip is preferred: a frame of another clip must be
    /// cheaper by this share of the cost, from 0 (no matter) to 1.
    pub prefer_current: f32,
    /// Which clip that is, by its number among those that the database was built from; `None`
    /// prefers the clip that is playing.
    pub prefer_source: Option<usize>,
    /// How a jump is hidden.
    pub transition: Inertialization,
    /// How the simulation object is steered.
    pub steering: Steering,
    /// How the character follows it; `None` lets it go where its clips lead.
    pub following: Option<Following>,
    /// How feet are planted; `None` leaves them as they are.
    pub planting: Option<FootPlanting>,
    /// Of how many candidates each search keeps a record, at most 32. More than one costs a scan.
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
            following: Some(Following {
                half_life_secs: 0.1,
                most_share: 0.5,
                most_m: 0.35,
                most_radians: 1.0,
            }),
            planting: Some(FootPlanting { half_life_secs: 0.08, most_shift_m: 0.3 }),
            candidates: 1,
        }
    }
}

impl ControllerOptions {
    /// Whether every number lies in its range.
    ///
    /// # Errors
    /// [`MatchError::Setting`] for the first that does not.
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
            check("an adjustment share", following.most_share, 0.0, 10.0)?;
            check("a largest distance (m)", following.most_m, 0.0, 100.0)?;
            check("a largest turn (rad)", following.most_radians, 0.0, 4.0)?;
        }
        if let Some(planting) = &self.planting {
            check("a foot half-life (s)", planting.half_life_secs, 0.0, 10.0)?;
            check("a largest foot shift (m)", f64::from(planting.most_shift_m), 0.0, 10.0)?;
        }
        check("a number of candidates", self.candidates as f64, 0.0, 32.0)
    }
}
