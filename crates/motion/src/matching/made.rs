//! Databases of synthesised motions.

use super::MatchError;
use super::features::RATE;
use crate::clip::{Clip, Motion};
use crate::skeleton::Roles;
use crate::synth::{Action, Params, synthesize};
use segue_text::{Message, msg};
use std::sync::Arc;

/// Returns parameters of synthesised motions that are sufficient to steer a character: standing,
/// walks and runs at several speeds, straight and along curves to the left, starts, stops, and
/// turns on the spot, some of them hasty. Curves to the right are their mirror images.
#[must_use]
pub fn made_params() -> Vec<Params> {
    let of = |action, speed_mps: f32, turn_rate_dps: f32, duration_secs: f32| Params {
        speed_mps,
        turn_rate_dps,
        duration_secs,
        ..Params::new(action)
    };
    let mut all = vec![of(Action::Idle, 0.0, 0.0, 5.0)];
    for speed in [0.5, 0.9, 1.4, 1.9] {
        for turn in [0.0, 30.0, 60.0, 90.0, 120.0] {
            all.push(of(Action::Walk, speed, turn, 6.0));
        }
    }
    for speed in [2.4, 3.2, 4.2] {
        for turn in [0.0, 45.0, 90.0] {
            all.push(of(Action::Run, speed, turn, 5.0));
        }
    }
    for speed in [0.8, 1.4, 2.0] {
        all.push(of(Action::Start, speed, 0.0, 3.6));
        all.push(of(Action::Stop, speed, 0.0, 4.2));
    }
    for turn in [40.0, 80.0] {
        all.push(of(Action::Start, 1.4, turn, 3.6));
        all.push(of(Action::Stop, 1.4, turn, 4.2));
    }
    for spin_degrees in [45.0, 90.0, 135.0, 180.0] {
        all.push(Params { spin_degrees, duration_secs: 4.0, ..Params::new(Action::Spin) });
    }
    // Hasty turns are synthesised at two thirds of the playback rate.
    for spin_degrees in [60.0, 90.0, 135.0, 180.0] {
        all.push(Params {
            spin_degrees,
            duration_secs: 5.0,
            fps: HASTY_RATE * RATE as f32,
            ..Params::new(Action::Spin)
        });
    }
    all
}

/// The rate at which hasty motions are synthesised, as a share of the database's rate.
const HASTY_RATE: f32 = 2.0 / 3.0;

/// Synthesises the motions of [`made_params`] for a body of this height, metres.
///
/// # Errors
/// [`MatchError::Synth`] for a height out of range.
pub fn made_clips(height_m: f32) -> Result<Vec<Arc<Motion>>, MatchError> {
    let mut clips: Vec<Arc<Motion>> = Vec::new();
    for params in made_params() {
        let roles = clips.first().map(|first| first.roles().clone());
        clips.push(Arc::new(made_clip(&Params { height_m, ..params }, roles)?));
    }
    Ok(clips)
}

/// Synthesises one of them; `roles` are those of another one with the same joints, so that they
/// need not be detected again.
///
/// # Errors
/// [`MatchError::Synth`] for parameters out of range.
pub fn made_clip(params: &Params, roles: Option<Roles>) -> Result<Motion, MatchError> {
    let made = synthesize(params)?;
    let roles = roles.unwrap_or_else(|| Roles::detect(made.clip.skeleton()));
    let clip = at_database_rate(&made.clip)?.with_name(made_name(params).to_string());
    Ok(Motion::with_roles(clip, &roles))
}

/// Returns the name on screen of a synthesised clip: `walk 1.4 m/s, 30°/s`.
#[must_use]
pub fn made_name(params: &Params) -> Message {
    let going = |what: &'static str| {
        let (mps, dps) = (params.speed_mps, params.turn_rate_dps);
        if dps == 0.0 {
            msg!("{what} {mps} m/s", what, mps)
        } else {
            msg!("{what} {mps} m/s, {dps}°/s", what, mps, dps)
        }
    };
    let degrees = params.spin_degrees;
    match params.action {
        Action::Idle => "stand".into(),
        Action::Spin if params.fps < RATE as f32 => msg!("quick turn by {degrees}°", degrees),
        Action::Spin => msg!("turn by {degrees}°", degrees),
        Action::Walk => going("walk"),
        Action::Run => going("run"),
        Action::Start => going("start to"),
        Action::Stop => going("stop from"),
        Action::Jump => "jump".into(),
    }
}

/// Plays a clip that was synthesised at a lower rate at the database's rate: faster.
fn at_database_rate(clip: &Clip) -> Result<Clip, MatchError> {
    if clip.fps() >= RATE as f64 {
        return Ok(clip.clone());
    }
    let poses = (0..clip.frames()).map(|frame| clip.pose(frame));
    Ok(Clip::from_poses(clip.name(), Arc::clone(clip.skeleton()), RATE as f64, poses)?)
}
