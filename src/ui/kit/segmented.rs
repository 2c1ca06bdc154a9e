//! A choice among a few options, all of them visible: cut | dissolve | inertialize.

use super::assistive::{describe, set_role};
use super::help::Help;
use super::paint::{Run, faded, focus_ring, full_width, line_of, put};
use super::words;
use crate::ui::language::{Text, Word, say};
use crate::ui::theme::{Type, palette_of, radius, theme_of};
use eframe::egui::{
    Align2, Color32, CursorIcon, EventFilter, Id, Key, Label, Rect, RichText, Role, Sense, Stroke,
    StrokeKind, Ui, WidgetInfo, pos2, vec2,
};

/// Draws a choice among a few options as [`segmented_ui`] does, below its label, with a help text.
/// Returns a new choice, and whether a double click on the label asks for the default.
pub(crate) fn labelled_segmented_ui<T: Copy + PartialEq>(
    label: Word,
    help: Text<'_>,
    chosen: T,
    options: &[(T, Word)],
    ui: &mut Ui,
) -> (Option<T>, bool) {
    let id = ui.make_persistent_id(label.english());
    let help = Help { label: label.into(), text: help, id };
    let words = RichText::new(say(label, ui)).font(theme_of(ui).font(Type::Label));
    let title = ui.add(Label::new(words).selectable(false).sense(Sense::CLICK));
    help.sign_ui(title.rect.right_center(), ui);
    let title = title.on_hover_ui(|ui| {
        help.tip_ui(ui);
        let reset = RichText::new(say(words::RESET_HINT, ui)).color(palette_of(ui).muted);
        ui.label(reset);
    });
    let picked = ui
        .scope(|ui| {
            set_role(Role::RadioGroup, label, ui);
            help.describe(ui.unique_id(), ui);
            segments_ui(id, chosen, options, ui)
        })
        .inner;
    help.line_ui(ui);
    (picked.filter(|&value| value != chosen), title.double_clicked())
}

/// Draws a choice among a few options, as wide as the panel. `label` is its accessible name.
/// Returns a new choice.
///
/// While it has the focus, the arrow keys go from one option to the next.
pub(crate) fn segmented_ui<T: Copy + PartialEq>(
    label: Word,
    chosen: T,
    options: &[(T, Word)],
    ui: &mut Ui,
) -> Option<T> {
    if options.is_empty() {
        return None;
    }
    let id = ui.make_persistent_id(label.english());
    let picked = ui.scope(|ui| {
        set_role(Role::RadioGroup, label, ui);
        segments_ui(id, chosen, options, ui)
    });
    picked.inner.filter(|&value| value != chosen)
}

fn segments_ui<T: Copy + PartialEq>(
    id: Id,
    chosen: T,
    options: &[(T, Word)],
    ui: &mut Ui,
) -> Option<T> {
    let (theme, palette) = (theme_of(ui), palette_of(ui));
    let enabled = ui.is_enabled();
    let well = full_width((30.0 * theme.scale()).max(theme.hit()).round(), ui);
    let line = Stroke::new(theme.hairline(), palette.line);
    ui.painter().rect(well, radius::M, palette.panel_raised, line, StrokeKind::Inside);

    let inner = well.shrink(3.0);
    let width = inner.width() / options.len() as f32;
    let cell = |index: usize| {
        Rect::from_min_size(
            pos2(inner.left() + index as f32 * width, inner.top()),
            vec2(width, inner.height()),
        )
    };
    let current = options.iter().position(|&(value, _)| value == chosen);
    let mut picked = None;

    // The ground of the chosen option slides to its place.
    if let Some(current) = current {
        let secs = ui.style().animation_time;
        let left = ui.ctx().animate_value_with_time(id.with("thumb"), current as f32, secs);
        let thumb = Rect::from_min_size(
            pos2(inner.left() + left * width, inner.top()),
            vec2(width, inner.height()),
        );
        ui.painter().rect_filled(
            thumb.translate(vec2(0.0, 1.0)),
            radius::S + 1,
            palette.shadow.gamma_multiply(0.5),
        );
        ui.painter().rect_filled(thumb, radius::S + 1, palette.pressed);
    }
    for (index, &(value, name)) in options.iter().enumerate() {
        let rect = cell(index);
        // Fingers may miss by the margin of the well.
        let hit = rect.expand2(vec2(0.0, 3.0));
        let response = ui
            .interact(hit, id.with(index), Sense::click())
            .on_hover_cursor(CursorIcon::PointingHand);
        let is_chosen = current == Some(index);
        if response.clicked() {
            picked = Some(value);
        }
        if response.has_focus() {
            let filter = EventFilter { horizontal_arrows: true, ..EventFilter::default() };
            ui.memory_mut(|memory| memory.set_focus_lock_filter(response.id, filter));
            let step = ui.input(|input| {
                i32::from(input.key_pressed(Key::ArrowRight))
                    - i32::from(input.key_pressed(Key::ArrowLeft))
            });
            if let Some(next) = index
                .checked_add_signed(step as isize)
                .filter(|&next| step != 0 && next < options.len())
            {
                picked = Some(options[next].0);
                ui.memory_mut(|memory| memory.request_focus(id.with(next)));
            }
        }
        let color = if is_chosen || response.hovered() { palette.text } else { palette.muted };
        let step = if is_chosen { Type::Strong } else { Type::Body };
        let galley =
            line_of(&[Run::new(name, step, faded(color, enabled))], rect.width() - 6.0, ui);
        put(ui.painter(), rect.center(), Align2::CENTER_CENTER, galley);
        focus_ring(rect, radius::S, &response, ui);
        let name = say(name, ui);
        describe(&response, &WidgetInfo::selected(Role::RadioButton, enabled, is_chosen, name));
        // A hairline between two options that are not chosen.
        if index > 0 && !is_chosen && current != Some(index - 1) {
            let tone = if enabled { palette.line } else { Color32::TRANSPARENT };
            ui.painter().vline(
                rect.left(),
                rect.shrink2(vec2(0.0, 6.0)).y_range(),
                Stroke::new(theme.hairline(), tone),
            );
        }
    }
    picked
}
