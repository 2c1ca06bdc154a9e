//! The Make lab: motion synthesised from parameters.

use super::Outcome;
use super::feet::{Lock, slide, slide_before, with_feet};
use super::lab::{Inputs, Lab, LabClips, LabInputs, can_change_result};
use crate::labs::LabError;
use crate::motion::foot_options;
use crate::outside::short;
use crate::params::{Key, Kind, Params, Value};
use crate::{LabId, choices};
use segue_motion::clip::Motion;
use segue_motion::metrics::worst_foot_slide;
use segue_motion::synth::{self, Action};
use segue_text::Message;
use std::sync::Arc;

/// The Make lab: a motion synthesised from parameters.
pub(super) struct MakeLab;

impl<S> Lab<S> for MakeLab {
    fn result_name(&self, params: &Params, _a: Message, _b: Message) -> Message {
        made_id(params).into()
    }

    fn file_stem(&self, params: &Params) -> String {
        params.choice::<choices::MadeAction>().word().to_owned()
    }

    fn own_id(&self, params: &Params) -> Option<String> {
        Some(made_id(params))
    }

    fn values_of_id(&self, name: &str) -> Option<Vec<(Key, Value)>> {
        Some(vec![(Key::Gait, Key::Gait.param().parse(name).ok()?)])
    }

    fn is_synthetic(&self) -> bool {
        true
    }

    fn inputs(
        &self,
        _labs: &mut S,
        _clips: LabClips,
        params: &Params,
        _match_window: usize,
    ) -> Result<Option<Inputs>, LabError> {
        Ok(Some(Inputs::new(MakeInputs::of(params))))
    }
}

/// Returns the chosen action of the Make lab.
pub(crate) fn synth_action(params: &Params) -> Action {
    match params.choice::<choices::MadeAction>() {
        choices::MadeAction::Run => Action::Run,
        choices::MadeAction::Idle => Action::Idle,
        choices::MadeAction::Start => Action::Start,
        choices::MadeAction::Stop => Action::Stop,
        choices::MadeAction::Spin => Action::Spin,
        choices::MadeAction::Jump => Action::Jump,
        choices::MadeAction::Walk => Action::Walk,
    }
}

/// Returns whether the chosen action has a parameter: standing has no speed, for instance.
pub(crate) fn has(params: &Params, key: Key) -> bool {
    let lacks = match key {
        Key::GaitSpeed => matches!(
            params.choice::<choices::MadeAction>(),
            choices::MadeAction::Idle | choices::MadeAction::Spin
        ),
        Key::TurnRate => matches!(
            params.choice::<choices::MadeAction>(),
            choices::MadeAction::Idle
                | choices::MadeAction::Spin
                | choices::MadeAction::Jump
                | choices::MadeAction::Start
                | choices::MadeAction::Stop
        ),
        _ => false,
    };
    !lacks
}

/// Returns the part of a number's range that the chosen action supports, if that is not all of it.
pub(crate) fn range_of(params: &Params, key: Key) -> Option<(f64, f64)> {
    let (own, table) = match (key, key.param().kind) {
        (Key::GaitSpeed, Kind::Number { min, max, .. }) => {
            (synth::Params::speed_range(synth_action(params))?, (min, max))
        }
        (Key::MakeSeconds, Kind::Number { min, max, .. }) => {
            (synth::Params::duration_range(synth_action(params)), (min, max))
        }
        _ => return None,
    };
    // Rounded to the decimals as written: 0.4 of an f32 is a little more than 0.4.
    let own = [own.0, own.1].map(|end| (f64::from(end) * 1e3).round() / 1e3);
    Some((own[0].max(table.0), own[1].min(table.1)))
}

fn synth_params(params: &Params) -> synth::Params {
    let of = |key| params.number(key) as f32;
    // A number that was set for another action is clamped to the range of this one.
    let within = |key, value: f32| match range_of(params, key) {
        Some((min, max)) => value.clamp(min as f32, max as f32),
        None => value,
    };
    let natural = synth::Params::new(synth_action(params));
    synth::Params {
        speed_mps: within(
            Key::GaitSpeed,
            params.optional(Key::GaitSpeed).map_or(natural.speed_mps, |speed| speed as f32),
        ),
        turn_rate_dps: of(Key::TurnRate),
        height_m: of(Key::BodyHeight),
        style: synth::Style {
            bounce: of(Key::Bounce),
            arm_swing: of(Key::ArmSwing),
            lean: of(Key::Lean),
            ..natural.style
        },
        seed: of(Key::Seed) as u32,
        duration_secs: within(Key::MakeSeconds, of(Key::MakeSeconds)),
        ..natural
    }
}

/// Synthesises the motion of the Make lab's parameters.
fn make(params: &Params) -> Result<Outcome, LabError> {
    let made = synth::synthesize(&synth_params(params))?;
    let mut motion =
        Motion::analyze(made.clip.with_name(made_id(params))).with_feet(foot_options(params));
    let slid = |motion: &Motion| worst_foot_slide(motion.clip(), motion.roles(), motion.contacts());
    let free = slid(&motion);
    let lock = Lock::of(params);
    let clip =
        with_feet(motion.clip(), motion.roles(), motion.contacts(), motion.ground_m(), lock)?;
    motion = motion.with_clip(clip, motion.ground_frames().to_vec());
    let fps = motion.clip().fps();
    let metrics = if lock.is_some() {
        vec![slide(slid(&motion), fps), slide_before(free)]
    } else {
        vec![slide(free, fps)]
    };
    Ok(Outcome { metrics, ..Outcome::plain(Arc::new(motion)) })
}

/// Returns a built-in motion by its id.
pub(crate) fn preset_motion(id: &str) -> Result<Motion, LabError> {
    let preset = synth::presets()
        .into_iter()
        .find(|preset| preset.id == id)
        .ok_or_else(|| LabError::NoPreset { id: short(id) })?;
    let made = synth::synthesize(&preset.params)?;
    Ok(Motion::analyze(made.clip.with_name(preset.title)))
}

/// Returns the id of a synthesised clip: its action and the parameters that differ from their
/// defaults, `run(turn_rate:20,seed:9)`. It is sufficient to make the clip again.
pub(crate) fn made_id(params: &Params) -> String {
    let changed = params
        .changed()
        .filter(|(param, _)| param.is_used_by(LabId::Make) && param.key != Key::Gait)
        .filter(|(param, _)| has(params, param.key) && can_change_result(params, param.key));
    let list: Vec<String> = changed
        .map(|(param, value)| match (value, range_of(params, param.key)) {
            // The value in use, not one that was set for another action.
            (Value::Number(number), Some((min, max))) => {
                (param, Value::Number(number.clamp(min, max)))
            }
            _ => (param, value.clone()),
        })
        .map(|(param, value)| format!("{}:{}", param.name, param.format(&value)))
        .collect();
    format!("{}({})", params.choice::<choices::MadeAction>().word(), list.join(","))
}

/// The inputs of a synthesised motion.
#[derive(Clone, Debug)]
pub(crate) struct MakeInputs {
    params: Arc<Params>,
    id: String,
}

impl MakeInputs {
    pub(crate) fn of(params: &Params) -> Self {
        Self { params: Arc::new(params.clone()), id: made_id(params) }
    }
}

impl LabInputs for MakeInputs {
    fn run(&self) -> Result<Outcome, LabError> {
        make(&self.params)
    }
}

/// The id contains everything that the motion depends on.
impl PartialEq for MakeInputs {
    fn eq(&self, other: &Self) -> bool {
        self.id == other.id
    }
}

#[cfg(test)]
mod tests {
    use super::super::recipe_params;
    use super::*;

    #[test]
    fn made_id_is_sufficient_to_make_the_clip() {
        let mut params = Params::default();
        params.set(Key::Gait, Value::Choice("run")).unwrap();
        params.set(Key::TurnRate, Value::Number(-20.0)).unwrap();
        params.set(Key::GaitSpeed, Value::Number(3.05)).unwrap();
        let id = made_id(&params);
        assert_eq!(id, "run(gait_speed:3.05,turn_rate:-20)");
        params.set(Key::Lab, Value::Choice("make")).unwrap();
        assert_eq!(recipe_params(&id), Some(params.clone()));
        params.set(Key::Gait, Value::Choice("walk")).unwrap();
        assert_eq!(made_id(&params), "walk(gait_speed:2.2,turn_rate:-20)", "no walk is as fast");
        for id in [
            "walk",
            "walk)",
            "fly()",
            "walk(blend_window:3)",
            "walk(turn_rate:900)",
            "walk(turn_rate)",
        ] {
            assert_eq!(recipe_params(id), None, "{id}");
        }
    }
}
