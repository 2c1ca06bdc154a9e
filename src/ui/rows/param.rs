//! One parameter of the table as a row of a panel.

use super::retarget_errors::character_errors_ui;
use crate::ui::kit::{self, Button, Icon, Mark, SliderResponse, SliderRow, Source};
use crate::ui::language::{Text, Word};
use crate::ui::out::Out;
use crate::ui::text;
use crate::ui::theme::palette_of;
use eframe::egui::Ui;
use segue_motion::skeleton::Role;
use segue_session::Mark::{InSeconds, PlaceInA, PlaceInB};
use segue_session::{Command, Compare, Key, Kind, Session, Slot, Value, decimals_of};
use segue_text::{Message, msg};

/// Details of a parameter's row beyond the table.
#[derive(Clone, Debug, Default)]
pub(crate) struct Detail {
    /// A lower upper end, where the clips allow no more.
    pub(crate) max: Option<f64>,
    /// The value that is used in place of the one that is set, where the clips allow no more.
    pub(crate) used: Option<f64>,
    /// A help text in place of the table's.
    pub(crate) help: Option<Message>,
    /// A sentence after the help text, such as how an automatic value was found.
    pub(crate) more: Option<Message>,
    /// A sentence below the row, always in sight.
    pub(crate) note: Option<Message>,
    /// Marks on the track, besides those of a comparison.
    pub(crate) marks: Vec<Mark>,
}

/// Draws the row of a parameter: a slider, a switch or a choice, by its kind.
pub(crate) fn param_row_ui(
    key: Key,
    detail: &Detail,
    session: &Session,
    out: &mut Out,
    ui: &mut Ui,
) {
    let param = key.param();
    if param.is_comparable() {
        out.rows.push(key);
    }
    let help = detail.help.as_ref().map_or(Word::new(param.help).into(), Text::from);
    let more = detail.more.as_ref().filter(|more| !more.is_empty());
    let whole = more.map(|more| Message::joined(vec![help.to_message(), more.clone()], " "));
    let help = whole.as_ref().map_or(help, Text::from);
    ui.push_id(param.name, |ui| match param.kind {
        Kind::Number { .. } => number_ui(key, detail, help, session, out, ui),
        Kind::Switch => {
            let (label, on) = (Word::new(param.label), session.params().is_on(key));
            if let Some(on) = kit::helped_switch_row_ui(label, help, on, ui) {
                out.set_once(key, Value::Switch(on));
            }
        }
        Kind::Choice(choices) => {
            let label = Word::new(param.label);
            let options: Vec<(&'static str, Word)> =
                choices.iter().map(|choice| (choice.key, Word::new(choice.label))).collect();
            if let Some(compare) = session.compare().filter(|compare| compare.key == key) {
                return compared_choices_ui(compare, help, &options, out, ui);
            }
            let chosen = session.params().word(key);
            let picked = if choices.len() <= 4 {
                let (picked, resets) =
                    kit::labelled_segmented_ui(label, help, chosen, &options, ui);
                if resets {
                    out.commands.push(Command::Reset(key));
                }
                picked
            } else {
                helped_choice_ui(label, help, chosen, &options, ui)
            };
            if let Some(word) = picked {
                out.set_once(key, Value::Choice(word));
            }
        }
        Kind::Joint => joint_ui(key, help, session, out, ui),
        Kind::Character => character_ui(key, help, session, out, ui),
        Kind::Clip | Kind::Text | Kind::List(_) | Kind::Compare => {}
    });
    if let Some(note) = &detail.note {
        kit::note_ui(note, palette_of(ui).muted, ui);
    }
}

/// Draws a choice among many, with a help text. Returns a new choice.
fn helped_choice_ui<'a, T: Copy + PartialEq>(
    label: impl Into<Text<'a>>,
    help: Text<'_>,
    chosen: T,
    options: &[(T, Word)],
    ui: &mut Ui,
) -> Option<T> {
    let options: Vec<(T, Text<'_>)> =
        options.iter().map(|&(value, word)| (value, word.into())).collect();
    kit::helped_choice_row_ui(label.into(), help, chosen, &options, ui)
}

/// Draws a choice of body parts. A joint that the link names and that is no body part stays an
/// option until another is chosen.
fn joint_ui(key: Key, help: Text<'_>, session: &Session, out: &mut Out, ui: &mut Ui) {
    let chosen = session.params().text(key);
    let mut options: Vec<(&str, Text<'_>)> =
        Role::ALL.iter().map(|role| (role.name(), Word::new(role.name()).into())).collect();
    if !options.iter().any(|(name, _)| *name == chosen) {
        options.insert(0, (chosen, Text::Data(chosen)));
    }
    let label = Word::new(key.param().label).into();
    if let Some(name) = kit::helped_choice_row_ui(label, help, chosen, &options, ui) {
        out.set_once(key, Value::Text(name.to_owned()));
    }
}

/// Draws a choice of the characters of files and of the body around the bones; nothing where no
/// file has a character.
fn character_ui(key: Key, help: Text<'_>, session: &Session, out: &mut Out, ui: &mut Ui) {
    let brought = session.library().entries().iter().filter(|entry| entry.has_mesh());
    let brought: Vec<(&str, Message)> =
        brought.map(|entry| (entry.id.as_str(), entry.title())).collect();
    let options: Vec<(&str, Text<'_>)> = std::iter::once(("", text::MADE_BODY.into()))
        .chain(brought.iter().map(|(id, title)| (*id, title.into())))
        .collect();
    if options.len() < 2 {
        return;
    }
    let chosen =
        session.library().find(session.params().text(key)).filter(|entry| entry.has_mesh());
    let chosen = chosen.map_or("", |entry| entry.id.as_str());
    let label = Word::new(key.param().label).into();
    if let Some(id) = kit::helped_choice_row_ui(label, help, chosen, &options, ui) {
        out.set_once(key, Value::Text(id.to_owned()));
    }
    character_errors_ui(session, ui);
}

fn number_ui(
    key: Key,
    detail: &Detail,
    help: Text<'_>,
    session: &Session,
    out: &mut Out,
    ui: &mut Ui,
) {
    let param = key.param();
    let Kind::Number { min, max, step, auto, logarithmic } = param.kind else {
        return;
    };
    let given = session.params().optional(key);
    let default = match param.default_value() {
        Value::Number(number) => number,
        _ => session.automatic_value(key).unwrap_or(min),
    };
    let (min, max) = session.range_of(key).unwrap_or((min, max));
    let end = detail.max.or_else(|| end_of_clip(key, session));
    let max = end.map_or(max, |limit| limit.clamp(min + step, max));
    let compare = session.compare().filter(|compare| compare.key == key);
    let color = palette_of(ui).muted;
    let values =
        |compare: &Compare| -> Vec<f64> { compare.values.iter().filter_map(number_of).collect() };
    let marks: Vec<Mark> = (compare.into_iter().flat_map(values))
        .map(|value| Mark { value, color })
        .chain(detail.marks.iter().copied())
        .collect();
    let mut row = SliderRow::new(Word::new(param.label), min..=max, default)
        .unit(Word::new(param.unit))
        .step(step)
        .marks(&marks);
    row = if step == 1.0 { row.whole() } else { row.decimals(decimals_of(step).min(2)) };
    if logarithmic {
        row = row.log();
    }
    let fps = param.has(InSeconds).then(|| frame_rate(session));
    let in_seconds =
        |value: f64| fps.map_or_else(String::new, |fps| format!("{:.2} s", value / fps));
    if let Some(compare) = compare {
        return compared_ui(compare, session.range_of(key), &row, &in_seconds, help, out, ui);
    }
    // A value that was set for another motion is clamped to the range of this one.
    let value = given.or_else(|| session.automatic_value(key)).unwrap_or(default);
    let value = session.range_of(key).map_or(value, |(min, max)| value.clamp(min, max));
    let value = detail.used.unwrap_or(value);
    let secondary = in_seconds(value);
    row = row.secondary(&secondary).help(help).source(match (auto, given) {
        (false, _) => Source::Manual,
        (true, Some(_)) => Source::ManualOverAuto,
        (true, None) => Source::Auto,
    });
    let response = kit::slider_row_ui(value, &row, ui);
    if response.reset {
        out.commands.push(Command::Reset(key));
    } else if let Some(value) = response.changed {
        out.set(key, Value::Number(value));
    }
    settle(&response, out);
}

/// Returns the end of the clip that a parameter is a place in, in its unit: of the shorter one
/// where it is a place in both.
fn end_of_clip(key: Key, session: &Session) -> Option<f64> {
    let param = key.param();
    let slots = [(Slot::A, PlaceInA), (Slot::B, PlaceInB)].into_iter();
    let clips = slots
        .filter(|(_, mark)| param.has(*mark))
        .filter_map(|(slot, _)| Some(session.slot(slot)?.motion.as_ref()?.clip()));
    let ends = clips.map(|clip| {
        if param.unit == "s" { clip.duration_secs() } else { clip.frames() as f64 - 1.0 }
    });
    ends.min_by(f64::total_cmp)
}

/// Returns the frame rate of the result, or of the clips for it.
fn frame_rate(session: &Session) -> f64 {
    let shown = session.main_outcome().map(|outcome| outcome.motion.clip().fps());
    let of_graph = || session.graph_clips().map(|graph_clips| graph_clips.set().fps());
    let of_map = || session.distance_map().map(|map| map.fps());
    shown.or_else(of_graph).or_else(of_map).unwrap_or(60.0)
}

/// Ends the step of undo when a drag ends, or after any other change.
fn settle(response: &SliderResponse, out: &mut Out) {
    if response.drag_ended || (response.changed.is_some() && !response.response.dragged()) {
        out.commands.push(Command::Settle);
    }
}

fn number_of(value: &Value) -> Option<f64> {
    match value {
        Value::Number(number) => Some(*number),
        _ => None,
    }
}

/// Draws a number that differs from pane to pane: a slider for each pane.
fn compared_ui(
    compare: &Compare,
    range: Option<(f64, f64)>,
    row: &SliderRow<'_>,
    in_seconds: &dyn Fn(f64) -> String,
    help: Text<'_>,
    out: &mut Out,
    ui: &mut Ui,
) {
    let param = compare.key.param();
    let mut panes = compare.clone();
    for (pane, value) in compare.values.iter().enumerate() {
        let Some(value) = number_of(value) else {
            continue;
        };
        let (label, secondary) = (label_of(param.label, pane), in_seconds(value));
        let row = row.clone().label(&label).secondary(&secondary);
        let response =
            kit::slider_row_ui(value, &row.help(if pane == 0 { help } else { Text::EMPTY }), ui);
        if let Some(value) = response.changed {
            panes.values[pane] = Value::Number(value);
            out.set(Key::Compare, Value::Compare(Some(panes.clone())));
        }
        settle(&response, out);
    }
    panes_ui(compare, range, out, ui);
}

/// Returns the label of a parameter's row for one of several panes.
fn label_of(label: &'static str, pane: usize) -> Message {
    msg!("{label} · {number}", label, number = pane + 1)
}

/// Draws a choice that differs from pane to pane: a row for each pane.
fn compared_choices_ui(
    compare: &Compare,
    help: Text<'_>,
    options: &[(&'static str, Word)],
    out: &mut Out,
    ui: &mut Ui,
) {
    let label = compare.key.param().label;
    for (pane, value) in compare.values.iter().enumerate() {
        let Value::Choice(chosen) = value else {
            continue;
        };
        let label = label_of(label, pane);
        let help = if pane == 0 { help } else { Text::EMPTY };
        let picked =
            ui.push_id(pane, |ui| helped_choice_ui(&label, help, *chosen, options, ui)).inner;
        if let Some(word) = picked {
            let mut panes = compare.clone();
            panes.values[pane] = Value::Choice(word);
            out.compare(Some(panes));
        }
    }
    panes_ui(compare, None, out, ui);
}

/// Draws the buttons that add a pane, remove one, and go back to one pane.
fn panes_ui(compare: &Compare, range: Option<(f64, f64)>, out: &mut Out, ui: &mut Ui) {
    let mut panes = compare.clone();
    ui.horizontal(|ui| {
        let more = Button::icon_only(Icon::Plus, text::PANE_MORE);
        let has_room = compare.with_one_more(range) != *compare;
        // A disabled button keeps its place: the next one must not come under the pointer.
        if ui.add_enabled_ui(has_room, |ui| kit::button_ui(more, ui)).inner.clicked() {
            out.compare(Some(compare.with_one_more(range)));
        }
        if kit::button_ui(Button::icon_only(Icon::Minus, text::PANE_LESS), ui).clicked() {
            panes.values.pop();
            match panes.values.as_slice() {
                [_] => keep_first(&panes, out),
                _ => out.set(Key::Compare, Value::Compare(Some(panes.clone()))),
            }
            out.commands.push(Command::Settle);
        }
        if kit::button_ui(Button::new(text::COMPARE_OFF).quiet(), ui).clicked() {
            keep_first(&panes, out);
            out.commands.push(Command::Settle);
        }
    });
}

/// Goes back to one pane, with the value of the first one.
fn keep_first(compare: &Compare, out: &mut Out) {
    let own = compare.values.first().map(|value| (compare.key, value.clone()));
    let alone = (Key::Compare, Value::Compare(None));
    out.commands.push(Command::Set(own.into_iter().chain([alone]).collect()));
}

/// Draws the choice of the parameter that is compared, among those with a row.
pub(crate) fn compare_choice_ui(session: &Session, out: &mut Out, ui: &mut Ui) {
    let compared = session.compare().map(|compare| compare.key);
    let mut keys = std::mem::take(&mut out.rows);
    keys.extend(compared.filter(|key| !keys.contains(key)));
    let options: Vec<(Option<Key>, Word)> = std::iter::once((None, text::COMPARE_NOTHING))
        .chain(keys.iter().map(|&key| (Some(key), Word::new(key.param().label))))
        .collect();
    match kit::choice_row_ui(text::SIDE_BY_SIDE, compared, &options, ui) {
        Some(Some(key)) => out.commands.push(Command::Compare(key)),
        Some(None) => out.compare(None),
        None => {}
    }
}
