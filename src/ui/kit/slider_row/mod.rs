//! One number of a lab: what it is called, what it is now and in which unit, and a track to drag.

mod head;
mod track;

use self::head::head_ui;
use self::track::{assistive, drag, keys, paint_track};
use super::paint::{faded, full_width, paragraph, put};
use crate::ui::language::tr;
use crate::ui::theme::{self, Type, palette_of, space, theme_of};
use eframe::egui::{
    Align2, Color32, Rect, Response, Sense, Ui, WidgetInfo, accesskit::Action, pos2,
};
use std::ops::RangeInclusive;

/// Who decides the value.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum Source {
    /// Always the user.
    #[default]
    Manual,
    /// The user now; the app could be asked to (a reset asks it).
    ManualOverAuto,
    /// The app found the value. Dragging takes it over.
    Auto,
}

/// A small mark on the track, such as the value of a neighbouring pane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Mark {
    /// Where, in the unit of the value.
    pub(crate) value: f64,
    /// In which colour.
    pub(crate) color: Color32,
}

/// A parameter as the row shows it.
#[derive(Clone, Debug)]
pub(crate) struct SliderRow<'a> {
    label: &'a str,
    unit: &'a str,
    secondary: &'a str,
    help: &'a str,
    range: RangeInclusive<f64>,
    step: f64,
    fine: f64,
    default: f64,
    decimals: usize,
    log: bool,
    source: Source,
    marks: &'a [Mark],
}

impl<'a> SliderRow<'a> {
    /// A row for values of `range`, which must rise. One step is a hundredth of it until
    /// [`Self::step`] says otherwise.
    pub(crate) fn new(label: &'a str, range: RangeInclusive<f64>, default: f64) -> Self {
        let step = (range.end() - range.start()).abs() / 100.0;
        Self {
            label,
            unit: "",
            secondary: "",
            help: "",
            range,
            step,
            fine: step / 10.0,
            default,
            decimals: 2,
            log: false,
            source: Source::Manual,
            marks: &[],
        }
    }

    /// The same row with another label.
    pub(crate) fn label(mut self, label: &'a str) -> Self {
        self.label = label;
        self
    }

    /// The unit behind the number, in the quiet colour.
    pub(crate) fn unit(mut self, unit: &'a str) -> Self {
        self.unit = unit;
        self
    }

    /// The same value said in another way, behind a dot: `0.50 s` after `30 frames`.
    pub(crate) fn secondary(mut self, secondary: &'a str) -> Self {
        self.secondary = secondary;
        self
    }

    /// One sentence below the track.
    pub(crate) fn help(mut self, help: &'a str) -> Self {
        self.help = help;
        self
    }

    /// How much an arrow key changes the value; dragging lands on multiples of it too. The fine
    /// step (shift) is a tenth.
    pub(crate) fn step(mut self, step: f64) -> Self {
        self.step = step;
        self.fine = step / 10.0;
        self
    }

    /// Only whole numbers: no decimals, steps of one, shift included.
    pub(crate) fn whole(mut self) -> Self {
        self.step = 1.0;
        self.fine = 1.0;
        self.decimals = 0;
        self
    }

    /// How many digits stand after the point. Two until said.
    pub(crate) fn decimals(mut self, decimals: usize) -> Self {
        self.decimals = decimals;
        self
    }

    /// Every tenfold takes the same length of track. Both ends of the range must be positive.
    pub(crate) fn log(mut self) -> Self {
        self.log = *self.range.start() > 0.0 && *self.range.end() > 0.0;
        self
    }

    /// Who decides the value now.
    pub(crate) fn source(mut self, source: Source) -> Self {
        self.source = source;
        self
    }

    /// Marks on the track.
    pub(crate) fn marks(mut self, marks: &'a [Mark]) -> Self {
        self.marks = marks;
        self
    }

    /// Where on the track a value lies, 0..=1.
    fn position(&self, value: f64) -> f64 {
        let (low, high) = (*self.range.start(), *self.range.end());
        let position = if self.log {
            (value.max(low).ln() - low.ln()) / (high.ln() - low.ln())
        } else {
            (value - low) / (high - low)
        };
        if position.is_finite() { position.clamp(0.0, 1.0) } else { 0.0 }
    }

    /// The value at a position on the track, on a multiple of `step`.
    fn value_at(&self, position: f64, step: f64) -> f64 {
        let (low, high) = (*self.range.start(), *self.range.end());
        let position = position.clamp(0.0, 1.0);
        // The ends are the ends, whether or not they are multiples of the step.
        if position <= 0.0 {
            return low;
        }
        if position >= 1.0 {
            return high;
        }
        let value = if self.log {
            (low.ln() + position * (high.ln() - low.ln())).exp()
        } else {
            low + position * (high - low)
        };
        self.snapped(value, step)
    }

    fn snapped(&self, value: f64, step: f64) -> f64 {
        // Where the steps of a logarithmic track are wide compared to the value they would swallow
        // it.
        let step =
            if self.log { step.min(value.abs() / 50.0).max(f64::MIN_POSITIVE) } else { step };
        let value = if step > 0.0 { (value / step).round() * step } else { value };
        value.clamp(*self.range.start(), *self.range.end())
    }

    fn written(&self, value: f64) -> String {
        format!("{value:.*}", self.decimals).replace('-', "−")
    }
}

/// What was done to a [`SliderRow`].
#[derive(Debug)]
pub(crate) struct SliderResponse {
    /// The value asked for, if it differs from the one shown. In the row's range.
    pub(crate) changed: Option<f64>,
    /// The default was asked for; for a value the app can find, that it find it. `changed` has the
    /// default as well.
    pub(crate) reset: bool,
    /// A drag began: what follows until [`Self::drag_ended`] is one thing to undo.
    pub(crate) drag_started: bool,
    /// The drag is over.
    pub(crate) drag_ended: bool,
    /// The track.
    pub(crate) response: Response,
}

/// A parameter: label, value and unit on one line, the track below, and a sentence of help where
/// there is one.
///
/// Drag the track, hold shift for a tenth of the speed. Arrow keys step (shift: finely), page keys
/// step tenfold, home and end go to the ends. Click the number to type one; Enter takes it, Esc
/// does not. A double click on label or track resets.
pub(crate) fn slider_row_ui(value: f64, row: &SliderRow<'_>, ui: &mut Ui) -> SliderResponse {
    let theme = theme_of(ui);
    let scale = theme.scale();
    let enabled = ui.is_enabled();
    let id = ui.make_persistent_id(row.label);
    let previous_spacing = std::mem::replace(&mut ui.spacing_mut().item_spacing.y, 0.0);

    let head = full_width((20.0 * scale).round(), ui);
    // The hit target is taller than what is seen, and reaches up under the label.
    let track_area = full_width((18.0 * scale).round(), ui);
    let track_hit = Rect::from_min_max(
        pos2(track_area.left(), track_area.bottom() - (theme::HIT * scale).round()),
        track_area.max,
    );

    let mut out = SliderResponse {
        changed: None,
        reset: false,
        drag_started: false,
        drag_ended: false,
        response: ui.interact(track_hit, id, Sense::click_and_drag()),
    };
    drag(value, row, track_hit, &mut out, ui);
    keys(value, row, &mut out, ui);
    assistive(value, row, &mut out, ui);
    let label = head_ui(value, row, head, id, &mut out, ui);
    if label.double_clicked() || out.response.double_clicked() {
        out.reset = true;
    }
    if out.reset {
        out.changed = Some(row.default.clamp(*row.range.start(), *row.range.end()));
    }
    out.changed =
        out.changed.filter(|&changed| changed != value || row.source == Source::Auto || out.reset);

    let shown = out.changed.unwrap_or(value);
    paint_track(shown, row, track_area, &out.response, ui);
    out.response.widget_info(|| WidgetInfo::slider(enabled, shown, row.label));
    let spoken = spoken(shown, row, ui);
    out.response.ctx.accesskit_node_builder(id, |node| {
        node.set_min_numeric_value(*row.range.start());
        node.set_max_numeric_value(*row.range.end());
        node.set_numeric_value_step(row.step);
        node.set_value(spoken);
        node.add_action(Action::SetValue);
        node.add_action(Action::Increment);
        node.add_action(Action::Decrement);
    });

    if !row.help.is_empty() {
        let galley = paragraph(
            row.help,
            Type::Small,
            faded(palette_of(ui).muted, enabled),
            ui.available_width(),
            ui,
        );
        let rect = full_width(galley.size().y + space::XS, ui);
        put(ui.painter(), rect.left_top(), Align2::LEFT_TOP, galley);
    }
    ui.spacing_mut().item_spacing.y = previous_spacing;
    ui.add_space(space::XS);
    out
}

fn spoken(value: f64, row: &SliderRow<'_>, ui: &Ui) -> String {
    let mut said = row.written(value);
    for part in [row.unit, row.secondary] {
        if !part.is_empty() {
            said.push(' ');
            said.push_str(&tr(part, ui));
        }
    }
    said
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row() -> SliderRow<'static> {
        SliderRow::new("Half-life", 0.01..=10.0, 0.25).step(0.01)
    }

    #[test]
    fn positions_and_values_are_inverse() {
        for row in [row(), row().log()] {
            for value in [0.01, 0.1, 0.5, 3.0, 10.0] {
                let back = row.value_at(row.position(value), 0.0);
                assert!(
                    (back - value).abs() < 1e-9 * value.max(1.0),
                    "{value} came back as {back}"
                );
            }
        }
        // A logarithmic track gives every tenfold a third of its length.
        assert!((row().log().position(0.1) - 1.0 / 3.0).abs() < 1e-12);
    }

    #[test]
    fn values_land_on_steps_and_stay_in_range() {
        let row = SliderRow::new("Window", 1.0..=60.0, 15.0).whole();
        assert_eq!(row.value_at(0.5, row.step), 31.0);
        assert_eq!(row.value_at(-3.0, row.step), 1.0);
        assert_eq!(row.value_at(7.0, row.step), 60.0);
        // The ends can be reached although they are no multiples of the step.
        let uneven = SliderRow::new("x", 0.05..=1.97, 0.5).step(0.1);
        assert_eq!((uneven.value_at(0.0, 0.1), uneven.value_at(1.0, 0.1)), (0.05, 1.97));
    }

    #[test]
    fn a_range_of_no_width_is_no_trap() {
        let row = SliderRow::new("x", 2.0..=2.0, 2.0);
        assert_eq!(row.position(2.0), 0.0);
        assert_eq!(row.value_at(0.5, row.step), 2.0);
    }
}
