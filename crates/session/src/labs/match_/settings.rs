//! Conversion of parameters to options of the controller.

use super::tagging::clip_name;
use crate::choices;
use crate::labs::LabError;
use crate::outside::short;
use crate::params::{Key, Params};
use segue_motion::matching::{
    ControllerOptions, Database, FollowOptions, FootPlanting, Hysteresis, Recording, Scenario,
    SearchMethod, Steering, Weights,
};
use segue_motion::math::Decay;
use segue_motion::transition::Inertialization;

/// Returns the options of search, transitions and following.
pub(crate) fn options_of(params: &Params) -> ControllerOptions {
    let number = |key| params.number(key);
    let usual = ControllerOptions::default();
    let blocks = [
        Key::WeightPath,
        Key::WeightFacing,
        Key::WeightFeet,
        Key::WeightFootSpeed,
        Key::WeightHipSpeed,
    ];
    ControllerOptions {
        weights: Weights(blocks.map(|key| number(key) as f32)),
        search_interval_secs: number(Key::SearchInterval),
        method: match params.choice::<choices::SearchBy>() {
            choices::SearchBy::Tree => SearchMethod::Tree,
            choices::SearchBy::Scan => SearchMethod::Scan,
            choices::SearchBy::Boxes => SearchMethod::Boxes,
        },
        hysteresis: match params.choice::<choices::Hysteresis>() {
            choices::Hysteresis::None => Hysteresis::None,
            choices::Hysteresis::Time => Hysteresis::MinimumTime { secs: number(Key::MinimumTime) },
            choices::Hysteresis::Votes => Hysteresis::ThreeVotes,
            choices::Hysteresis::ClipVotes => Hysteresis::ThreeVotesForAnotherClip,
            choices::Hysteresis::Bias => Hysteresis::ContinuingBias {
                share: number(Key::BiasShare) as f32,
                constant: number(Key::BiasConstant) as f32,
            },
        },
        prefer_current: number(Key::PreferCurrent) as f32,
        prefer_source: None,
        transition: match params.choice::<choices::JumpMethod>() {
            choices::JumpMethod::Dead => Inertialization::DeadBlend {
                blend_secs: number(Key::BlendTime),
                extrapolation_half_life_secs: number(Key::ExtrapolationHalfLife),
            },
            choices::JumpMethod::Inertialize => {
                Inertialization::Offset(Decay::Spring { half_life_secs: number(Key::JumpHalfLife) })
            }
        },
        steering: Steering {
            velocity_half_life_secs: number(Key::VelocityHalfLife),
            facing_half_life_secs: number(Key::FacingHalfLife),
        },
        following: params.is_on(Key::Adjust).then(|| FollowOptions {
            half_life_secs: number(Key::AdjustHalfLife),
            max_share: number(Key::AdjustShare),
            max_distance_m: number(Key::ClampDistance),
            max_angle_radians: number(Key::ClampTurn).to_radians(),
        }),
        planting: usual.planting.filter(|_: &FootPlanting| params.is_on(Key::PlantFeet)),
        candidates: number(Key::ShownCandidates) as usize,
    }
}

/// Returns the options with the clip of a database that is preferred while there is no input.
pub(crate) fn options_in(
    database: &Database,
    params: &Params,
) -> Result<ControllerOptions, LabError> {
    let options = options_of(params);
    let name = params.text(Key::PreferClip);
    if name.is_empty() {
        return Ok(options);
    }
    let ids = params.clip_ids(Key::MatchClips);
    let named = database.motions().iter().find(|motion| clip_name(motion, ids) == name);
    let source = named
        .map(|motion| motion.source())
        .ok_or_else(|| LabError::NoPreferredClip { name: short(name) })?;
    Ok(ControllerOptions { prefer_source: Some(source), ..options })
}

/// Returns the recorded input; `None` if the user drives.
pub(crate) fn recording_of(params: &Params) -> Option<Recording> {
    match Scenario::find(params.choice::<choices::Scenario>().word()) {
        Some(scenario) => Some(scenario.recording()),
        None => params.recording().cloned(),
    }
}
