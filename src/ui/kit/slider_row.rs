//! A number with its label, value and unit, and a track to drag.

mod head;
mod row;
mod track;

pub(crate) use self::row::{Mark, SliderResponse, SliderRow, Source};

use self::head::head_ui;
use self::track::{drag, keys, paint_track};
use super::assistive::{Adjustable, requested};
use super::help::Help;
use super::paint::full_width;
use crate::ui::language::say;
use crate::ui::theme::{self, space, theme_of};
use eframe::egui::{Rect, Sense, Ui, pos2};

/// Draws a parameter: label, value and unit on one line, and the track below. A help text has a
/// sign behind the label.
///
/// Drag the track; hold Shift for a tenth of the speed. Arrow keys step (shift: finely), page keys
/// step tenfold, home and end go to the ends. Click the number to type one; Enter takes it, Esc
/// does not. A double click on label or track resets.
pub(crate) fn slider_row_ui(value: f64, row: &SliderRow<'_>, ui: &mut Ui) -> SliderResponse {
    let theme = theme_of(ui);
    let scale = theme.scale();
    let id = ui.make_persistent_id(row.label.english());
    let previous_spacing = std::mem::replace(&mut ui.spacing_mut().item_spacing.y, 0.0);

    let touch = theme_of(ui).touch;
    let head = full_width(((if touch { 26.0 } else { 20.0 }) * scale).round(), ui);
    // The hit target is taller than the track, and reaches up under the label.
    let track_area = full_width(((if touch { 32.0 } else { 18.0 }) * scale).round(), ui);
    let hit = theme_of(ui).hit().max((theme::HIT * scale).round());
    let track_hit =
        Rect::from_min_max(pos2(track_area.left(), track_area.bottom() - hit), track_area.max);

    let mut out = SliderResponse {
        changed: None,
        reset: false,
        drag_started: false,
        drag_ended: false,
        response: ui.interact(track_hit, id, Sense::click_and_drag()),
    };
    drag(value, row, track_hit, &mut out, ui);
    keys(value, row, &mut out, ui);
    if let Some(asked) = requested(id, value, &row.range, row.step, ui) {
        out.changed = Some(row.snapped(asked, row.fine));
    }
    let help = Help { label: row.label, text: row.help, id };
    let label = head_ui(value, row, help, head, id, &mut out, ui);
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
    let adjustable = Adjustable {
        name: say(row.label, ui),
        value: shown,
        range: row.range.clone(),
        step: row.step,
        said: spoken(shown, row, ui),
        help: say(row.help, ui),
    };
    adjustable.describe(&out.response, ui);

    help.line_ui(ui);
    ui.spacing_mut().item_spacing.y = previous_spacing;
    ui.add_space(space::XS);
    out
}

fn spoken(value: f64, row: &SliderRow<'_>, ui: &Ui) -> String {
    let mut said = row.written(value);
    for part in [say(row.unit, ui).as_str(), row.secondary] {
        if !part.is_empty() {
            said.push(' ');
            said.push_str(part);
        }
    }
    said
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ui::language::Word;

    fn row() -> SliderRow<'static> {
        SliderRow::new(Word::new("Half-life"), 0.01..=10.0, 0.25).step(0.01)
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
        let row = SliderRow::new(Word::new("Window"), 1.0..=60.0, 15.0).whole();
        assert_eq!(row.value_at(0.5, row.step), 31.0);
        assert_eq!(row.value_at(-3.0, row.step), 1.0);
        assert_eq!(row.value_at(7.0, row.step), 60.0);
        // The ends can be reached although they are no multiples of the step.
        let uneven = SliderRow::new(Word::new("x"), 0.05..=1.97, 0.5).step(0.1);
        assert_eq!((uneven.value_at(0.0, 0.1), uneven.value_at(1.0, 0.1)), (0.05, 1.97));
    }

    #[test]
    fn range_of_no_width_keeps_its_value() {
        let row = SliderRow::new(Word::new("x"), 2.0..=2.0, 2.0);
        assert_eq!(row.position(2.0), 0.0);
        assert_eq!(row.value_at(0.5, row.step), 2.0);
    }
}
