//! The title of a pane, over the stage.

use super::assistive::describe;
use super::chip::{Mood, chip_size, paint_chip};
use super::paint::{Run, line_of, put};
use crate::ui::language::{Text, Word, say};
use crate::ui::theme::{Type, palette_of, space, theme_of};
use eframe::egui::{Align2, Direction, Rect, Role, Sense, Shape, Ui, WidgetInfo, pos2, vec2};
use segue_text::Message;

/// The title of a pane.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PaneTitle<'a> {
    /// The value in which this pane differs from the others: `30`.
    pub(crate) strong: &'a Message,
    /// The unit: `frames`.
    pub(crate) text: &'a Message,
    /// The same value in another unit: `0.50 s`.
    pub(crate) secondary: &'a Message,
    /// The verdict on a chip; empty for none.
    pub(crate) chip: Word,
    /// The colour of the verdict.
    pub(crate) mood: Mood,
}

/// Returns the height of the strip at the top of a pane.
pub(crate) fn pane_header_height(ui: &Ui) -> f32 {
    (40.0 * theme_of(ui).scale()).round()
}

/// Draws the title over the top of `pane`. The picture stays visible through it. Returns the strip.
pub(crate) fn pane_header_ui(title: &PaneTitle<'_>, pane: Rect, ui: &mut Ui) -> Rect {
    let palette = palette_of(ui);
    let strip = Rect::from_min_size(pane.min, vec2(pane.width(), pane_header_height(ui)));
    scrim(strip, Direction::TopDown, ui);
    let mut right = strip.right() - space::M;
    let left = strip.left() + space::M;
    let mut runs = vec![Run::new(title.strong, Type::Title, palette.text)];
    if !title.text.is_empty() {
        runs.push(Run::new(title.text, Type::Body, palette.text).after(space::XS + 1.0));
    }
    let essential = runs.len();
    if !title.secondary.is_empty() {
        runs.push(Run::new(Text::Data("·"), Type::Body, palette.muted).after(space::XS + 1.0));
        runs.push(Run::new(title.secondary, Type::Body, palette.muted).after(space::XS + 1.0));
    }
    if !title.chip.is_empty() {
        let chip = chip_size(title.chip.into(), ui);
        let needed = line_of(&runs[..essential], f32::INFINITY, ui).size().x + space::S + chip.x;
        if needed <= right - left {
            let at = pos2(right, strip.center().y);
            right = paint_chip(title.chip.into(), title.mood, at, ui).left() - space::S;
        } else {
            // Below a title that needs all the room: a value without its unit says nothing.
            let at = pos2(left + chip.x, strip.bottom() + 0.5 * chip.y);
            paint_chip(title.chip.into(), title.mood, at, ui);
        }
    }
    // Where there is little room, the second form of the value is left out before anything is cut.
    let fits = line_of(&runs, f32::INFINITY, ui).size().x <= right - left;
    let galley = line_of(if fits { &runs } else { &runs[..essential] }, right - left, ui);
    put(ui.painter(), pos2(left, strip.center().y), Align2::LEFT_CENTER, galley);
    let response = ui.interact(
        strip,
        ui.make_persistent_id(("pane", pane.min.x.to_bits(), title.strong.to_string())),
        Sense::hover(),
    );
    let words = [title.strong, title.text, title.secondary].map(Text::from);
    let said = words.into_iter().chain([title.chip.into()]).map(|part| say(part, ui));
    let said = said.collect::<Vec<_>>().join(" ");
    describe(&response, &WidgetInfo::labeled(Role::Heading, true, said));
    strip
}

/// Draws the colour of the ground, fading into the picture, so that text stays legible over bodies.
fn scrim(rect: Rect, direction: Direction, ui: &Ui) {
    let ground = palette_of(ui).stage.sky;
    ui.painter().add(Shape::gradient_rect(
        rect,
        direction,
        [ground.gamma_multiply(0.82), ground.gamma_multiply(0.0)],
    ));
}
