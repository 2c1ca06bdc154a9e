//! Recipes: the ids of results, from which they are made again.

use super::lab::can_change_result;
use super::lab_set::lab_of;
use super::outcome::Outcome;
use crate::contact_edits::with_own_edits;
use crate::params::{Key, Kind, PARAMS, Param, Params, Value, escaped, is_recipe, parts};
use crate::{LabId, Selected};
use percent_encoding::percent_decode_str;
use segue_motion::synth;
use segue_text::Message;

/// Returns the parameters that a lab's result is made from, clips included.
pub(crate) fn recipe_ingredients(lab: LabId) -> impl Iterator<Item = Key> {
    PARAMS.iter().filter(move |param| param.is_ingredient_of(lab)).map(|param| param.key)
}

/// Returns the id of the result of the parameters: `run(turn_rate:20)` of a synthesised motion,
/// `transition(a:walk,b:run,half_life:0.3)` of another result. `None` for a clip as it is.
///
/// The id contains the values that Segue found, so that the same result is made again, without a
/// search. `fps` are the clips' own frame rates.
pub(crate) fn recipe_id(params: &Params, outcome: &Outcome, fps: [f64; 2]) -> Option<String> {
    let lab = params.lab();
    let facts = lab_of(lab);
    let params = &with_own_edits(params);
    if facts.is_clip_as_it_is(params) {
        return None;
    }
    if let Some(id) = facts.own_id(params) {
        return Some(id);
    }
    let mut params = params.clone();
    for (key, value) in facts.length_parameters(outcome) {
        params.set(key, value).ok()?;
    }
    for (key, value) in facts.found(outcome, fps) {
        if *params.get(key) == Value::Auto {
            params.set(key, Value::Number(value)).ok()?;
        }
    }
    let ingredients = PARAMS
        .iter()
        .filter(|param| param.is_ingredient_of(lab) && can_change_result(&params, param.key));
    let ingredients = ingredients.filter(|param| {
        let named = matches!(param.kind, Kind::Clip);
        named || params.is_changed(param.key)
    });
    let list: Vec<String> = ingredients
        .map(|param| format!("{}:{}", param.name, encoded_value(param, params.get(param.key))))
        .collect();
    Some(format!("{}({})", lab.word(), list.join(",")))
}

/// Returns the parameters of an id; `None` if it is not the id of a result.
pub(crate) fn recipe_params(id: &str) -> Option<Params> {
    let (word, list) = id.strip_suffix(')')?.split_once('(')?;
    let mut params = Params::default();
    let has_own_ids = |lab: LabId| lab_of(lab).own_id(&params).is_some();
    let lab = LabId::from_word(word).filter(|lab| !has_own_ids(*lab));
    let named = || LabId::ALL.iter().find_map(|lab| Some((*lab, lab_of(*lab).values_of_id(word)?)));
    let (lab, values) = lab.map(|lab| (lab, Vec::new())).or_else(named)?;
    params.set(Key::Lab, lab.into()).ok()?;
    for (key, value) in values {
        params.set(key, value).ok()?;
    }
    let mut set = |key: Key, text: &str| params.set(key, key.param().parse(text).ok()?).ok();
    for pair in parts(list)? {
        let (name, value) = pair.split_once(':')?;
        let key = Key::from_name(name)?;
        let value = if is_text(key.param()) && !value.ends_with(')') {
            percent_decode_str(value).decode_utf8().ok()?
        } else {
            value.into()
        };
        set(Some(key).filter(|key| key.param().is_ingredient_of(lab))?, &value)?;
    }
    // An unchanged clip has its own id.
    (!lab_of(lab).is_clip_as_it_is(&params)).then_some(params)
}

/// Returns the name on screen of the result of the parameters.
pub(crate) fn recipe_name(params: &Params) -> Message {
    let [a, b] = [Key::A, Key::B].map(|key| match recipe_params(params.text(key)) {
        Some(kept) => recipe_name(&kept),
        None => reference_name(params.text(key)),
    });
    lab_of(params.lab()).result_name(params, a, b)
}

/// Returns the name on screen of a clip of a reference, which may be missing.
fn reference_name(reference: &str) -> Message {
    match synth::presets().into_iter().find(|preset| preset.id == reference) {
        Some(preset) => preset.id.into(),
        None => Message::data(reference.split('~').next().unwrap_or_default()),
    }
}

/// Returns the name of a file with the result of the parameters, without its ending.
#[must_use]
pub fn file_stem(params: &Params) -> String {
    lab_of(params.lab()).file_stem(params)
}

/// Encodes a value inside an id. The id of a kept clip stays unchanged, because its brackets close.
fn encoded_value(param: &Param, value: &Value) -> String {
    let text = param.format(value);
    if is_text(param) && !is_recipe(&text) { escaped(&text) } else { text }
}

/// Returns whether a value may contain the delimiters of ids.
fn is_text(param: &Param) -> bool {
    matches!(param.kind, Kind::Clip | Kind::Joint | Kind::Character | Kind::Text | Kind::List(_))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::labs::lab::LabInputs;
    use crate::params::List;
    use proptest::prelude::*;

    fn named(a: &str, b: &str) -> Option<Params> {
        let mut params = Params::default();
        params.set(Key::Lab, LabId::Transition.into()).ok()?;
        params.set(Key::A, Value::Text(a.to_owned())).ok()?;
        params.set(Key::B, Value::Text(b.to_owned())).ok()?;
        Some(params)
    }

    fn id_of(params: &Params) -> String {
        let outcome = super::super::make::MakeInputs::of(&Params::default()).run().expect("a walk");
        recipe_id(params, &outcome, [60.0; 2]).expect("a recipe")
    }

    #[test]
    fn invalid_ids_have_no_parameters() {
        for id in [
            "blend(a:walk",
            "blend(a:walk))",
            "blend(gait:run)",
            "loop(a:walk,b:run)",
            "view(a:walk)",
            "view(a:walk,lock_blend:0.5)",
            "view(a:walk,b:run,foot_lock:on)",
            "make(gait:run)",
            "blend(a:walk,blend_window:0)",
            "blend((((((((((())))))))))))",
        ] {
            assert_eq!(recipe_params(id), None, "{id}");
        }
    }

    #[test]
    fn lists_in_an_id_stay_whole() {
        let mut params = Params::default();
        params.set(Key::Lab, LabId::Register.into()).expect("a lab");
        params.set(Key::Pins, List::Pins(vec![(12, 30), (50, 71)]).into()).expect("pins");
        assert_eq!(recipe_params(&id_of(&params)), Some(params));
    }

    proptest! {
        #[test]
        fn any_name_of_a_file_reads_back_from_an_id(a in ".{0,24}", b in "[a-z(),:%~ ]{0,16}") {
            let params = named(&a, &b).expect("texts");
            prop_assert_eq!(recipe_params(&id_of(&params)), Some(params.clone()));
            // And inside another id.
            let outer = named(&id_of(&params), &b).expect("texts");
            prop_assert_eq!(recipe_params(&id_of(&outer)), Some(outer));
        }
    }
}
