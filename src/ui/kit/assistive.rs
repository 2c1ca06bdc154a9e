//! Descriptions for assistive technology: names of widgets, parts and groups of the page, the
//! values of sliders, and painted text.

use crate::ui::language::{Word, say};
use eframe::egui::accesskit::{Action, ActionData, Role};
use eframe::egui::{Id, Rect, Response, Sense, Ui, WidgetInfo};
use std::ops::RangeInclusive;

/// Describes a widget. All of `info` is written before: egui holds its context while it asks for
/// it, and writing a text in the language of the interface needs the context.
#[expect(clippy::disallowed_methods, reason = "the closure needs no context")]
pub(crate) fn describe(response: &Response, info: &WidgetInfo) {
    response.widget_info(|| info.clone());
}

/// Gives a part of the page, which `ui` draws, a role and a name (empty for none): a landmark, a
/// list, or a group.
pub(crate) fn set_role(role: Role, name: Word, ui: &Ui) {
    let name = say(name, ui);
    ui.ctx().accesskit_node_builder(ui.unique_id(), |node| {
        node.set_role(role);
        if !name.is_empty() {
            node.set_label(name);
        }
    });
}

/// Makes painted text readable: a galley alone is no widget.
pub(super) fn readable_ui(text: &str, rect: Rect, id: Id, ui: &Ui) -> Response {
    let response = ui.interact(rect, id, Sense::hover());
    describe(&response, &WidgetInfo::labeled(Role::Label, true, text));
    response
}

/// A number that assistive technology can read and set.
pub(super) struct Adjustable {
    /// The name.
    pub(super) name: String,
    /// The number.
    pub(super) value: f64,
    /// Its smallest and greatest value.
    pub(super) range: RangeInclusive<f64>,
    /// Its step.
    pub(super) step: f64,
    /// The number with its unit.
    pub(super) said: String,
    /// A sentence about it; empty for none.
    pub(super) help: String,
}

impl Adjustable {
    /// Describes the widget as a slider.
    pub(super) fn describe(self, response: &Response, ui: &Ui) {
        describe(response, &WidgetInfo::slider(ui.is_enabled(), self.value, self.name));
        ui.ctx().accesskit_node_builder(response.id, |node| {
            node.set_min_numeric_value(*self.range.start());
            node.set_max_numeric_value(*self.range.end());
            node.set_numeric_value_step(self.step);
            node.set_value(self.said);
            if !self.help.is_empty() {
                node.set_description(self.help);
            }
            node.add_action(Action::SetValue);
            node.add_action(Action::Increment);
            node.add_action(Action::Decrement);
        });
    }
}

/// Returns the number that assistive technology has asked a slider for, within `range`: so many
/// steps from `value`, or a value of its own.
pub(super) fn requested(
    id: Id,
    value: f64,
    range: &RangeInclusive<f64>,
    step: f64,
    ui: &Ui,
) -> Option<f64> {
    ui.input(|input| {
        let up = input.num_accesskit_action_requests(id, Action::Increment) as f64;
        let down = input.num_accesskit_action_requests(id, Action::Decrement) as f64;
        let stepped = (up != down).then_some(value + (up - down) * step);
        let set = input.accesskit_action_requests(id, Action::SetValue);
        let set = set.filter_map(|request| match request.data {
            Some(ActionData::NumericValue(asked)) if asked.is_finite() => Some(asked),
            _ => None,
        });
        let asked = set.last().or(stepped)?;
        Some(asked.max(*range.start()).min(*range.end()))
    })
}
