//! One parameter of the table as a row of a panel.

use super::kit::{self, Mark, SliderRow, Source};
use super::out::Out;
use super::text;
use super::theme::palette_of;
use eframe::egui::Ui;
use segue::session::{Command, Key, Kind, Session, Value, decimals_of};
use segue::skeleton::Role;

/// What a panel knows about a parameter beyond the table.
#[derive(Clone, Debug, Default)]
pub(crate) struct Detail {
    /// A narrower upper end, where the clips allow no more.
    pub(crate) max: Option<f64>,
    /// The same value said in another way: seconds behind frames.
    pub(crate) secondary: String,
    /// A sentence in place of the table's.
    pub(crate) help: Option<String>,
    /// Marks on the track, besides those of a comparison.
    pub(crate) marks: Vec<Mark>,
}

/// The row of a parameter: a slider, a switch or a choice, as the table has it.
pub(crate) fn param_row_ui(key: Key, detail: &Detail, session: &Session, out: &mut Out, ui: &mut Ui) {
    let param = key.param();
    ui.push_id(param.name, |ui| match param.kind {
        Kind::Number { .. } => number_ui(key, detail, session, out, ui),
        Kind::Switch => {
            if let Some(on) = kit::switch_row_ui(param.label, session.params().is_on(key), ui) {
                out.set_once(key, Value::Switch(on));
            }
        }
        Kind::Choice(choices) => {
            let options: Vec<(&'static str, &str)> = choices.iter().map(|choice| (choice.key, choice.label)).collect();
            let chosen = choices
                .iter()
                .find(|choice| choice.key == session.params().text(key))
                .map_or("", |choice| choice.key);
            let picked = if choices.len() <= 4 {
                kit::segmented_ui(param.label, chosen, &options, ui)
            } else {
                kit::choice_row_ui(param.label, chosen, &options, ui)
            };
            if let Some(word) = picked {
                out.set_once(key, Value::Choice(word));
            }
        }
        Kind::Text if matches!(key, Key::Joint | Key::FollowJoint) => joint_ui(key, session, out, ui),
        Kind::Text if key == Key::Character => character_ui(key, session, out, ui),
        Kind::Clip | Kind::Text | Kind::Compare => {}
    });
}

/// A body part to choose. A joint that is named in the link and is no body part keeps its place until another is chosen.
fn joint_ui(key: Key, session: &Session, out: &mut Out, ui: &mut Ui) {
    let chosen = session.params().text(key);
    let mut options: Vec<(&str, &str)> = Role::ALL.iter().map(|role| (role.name(), role.name())).collect();
    if !options.iter().any(|(name, _)| *name == chosen) {
        options.insert(0, (chosen, chosen));
    }
    if let Some(name) = kit::choice_row_ui(key.param().label, chosen, &options, ui) {
        out.set_once(key, Value::Text(name.to_owned()));
    }
}

/// The characters that files brought, and the body that is made around the bones. Nothing where no file brought one.
fn character_ui(key: Key, session: &Session, out: &mut Out, ui: &mut Ui) {
    let brought = session.library().entries().iter().filter(|entry| entry.mesh.is_some());
    let options: Vec<(&str, &str)> = std::iter::once(("", text::MADE_BODY))
        .chain(brought.map(|entry| (entry.id.as_str(), entry.name.as_str())))
        .collect();
    if options.len() < 2 {
        return;
    }
    let chosen = session
        .library()
        .find(session.params().text(key))
        .filter(|entry| entry.mesh.is_some());
    let chosen = chosen.map_or("", |entry| entry.id.as_str());
    if let Some(id) = kit::choice_row_ui(key.param().label, chosen, &options, ui) {
        out.set_once(key, Value::Text(id.to_owned()));
    }
}

fn number_ui(key: Key, detail: &Detail, session: &Session, out: &mut Out, ui: &mut Ui) {
    let param = key.param();
    let Kind::Number {
        min,
        max,
        step,
        auto,
        logarithmic,
    } = param.kind
    else {
        return;
    };
    let given = session.params().optional(key);
    let default = match param.default_value() {
        Value::Number(number) => number,
        _ => session.automatic_value(key).unwrap_or(min),
    };
    let max = detail.max.map_or(max, |limit| limit.clamp(min + step, max));
    let compare = session.compare().filter(|compare| compare.key == key);
    let color = palette_of(ui).muted;
    let marks: Vec<Mark> = compare
        .iter()
        .flat_map(|compare| &compare.values)
        .filter_map(|value| match value {
            Value::Number(value) => Some(Mark { value: *value, color }),
            _ => None,
        })
        .chain(detail.marks.iter().copied())
        .collect();
    let help = detail.help.as_deref().unwrap_or(param.help);
    let mut row = SliderRow::new(param.label, min..=max, default)
        .unit(param.unit)
        .secondary(&detail.secondary)
        .help(help)
        .step(step)
        .marks(&marks);
    row = if step == 1.0 {
        row.whole()
    } else {
        row.decimals(decimals_of(step).min(2))
    };
    if logarithmic {
        row = row.log();
    }
    row = row.source(match (auto, given) {
        (false, _) => Source::Manual,
        (true, Some(_)) => Source::ManualOverAuto,
        (true, None) => Source::Auto,
    });
    let response = kit::slider_row_ui(given.or_else(|| session.automatic_value(key)).unwrap_or(default), &row, ui);
    if response.reset {
        out.commands.push(Command::Reset(key));
    } else if let Some(value) = response.changed {
        out.set(key, Value::Number(value));
    }
    if response.drag_ended || (response.changed.is_some() && !response.response.dragged()) {
        out.commands.push(Command::Settle);
    }
}
