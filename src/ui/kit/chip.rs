//! Chips: short texts on a coloured ground.

use super::assistive::describe;
use super::icon::Icon;
use super::paint::{Run, line_of, put};
use crate::ui::language::{Text, Word, say};
use crate::ui::theme::{Palette, Type, palette_of, theme_of};
use eframe::egui::{
    Align2, Color32, Painter, Pos2, Rect, Role, Sense, Stroke, StrokeKind, Ui, Vec2, WidgetInfo,
    vec2,
};

/// The meaning of a coloured text. The text says it as well as the colour.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum Mood {
    /// Neither good nor bad.
    #[default]
    Plain,
    /// The best one, or a success.
    Good,
    /// The worst one, or a failure.
    Bad,
    /// A warning.
    Warning,
}

impl Mood {
    /// Returns the colour of its text, and that of the ground.
    pub(crate) fn colors(self, p: &Palette) -> (Color32, Color32) {
        match self {
            Self::Plain => (p.muted, p.panel_raised),
            Self::Good => (p.good, p.accent_wash),
            Self::Bad => (p.bad, p.bad_wash),
            Self::Warning => (p.warning, p.warning_wash),
        }
    }

    /// Returns the sign beside a longer text of this mood.
    pub(crate) fn icon(self) -> Icon {
        match self {
            Self::Plain => Icon::Info,
            Self::Good => Icon::Check,
            Self::Bad | Self::Warning => Icon::Warning,
        }
    }
}

/// The part that a clip has in the result.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum Part {
    /// The clip that is left; warm colours.
    A,
    /// The clip that is entered; cool colours.
    B,
    /// The result of both.
    Result,
    /// No part at the moment.
    #[default]
    None,
}

impl Part {
    /// Returns its fill, and the colour of text on that fill.
    pub(crate) fn fill(self, p: &Palette) -> (Color32, Color32) {
        match self {
            Self::A => (p.a, p.on_a),
            Self::B => (p.b, p.on_b),
            Self::Result => (p.accent_fill, p.accent_text),
            Self::None => (p.pressed, p.muted),
        }
    }

    /// Returns its colour as text on a panel.
    pub(crate) fn ink(self, p: &Palette) -> Color32 {
        match self {
            Self::A => p.a_ink,
            Self::B => p.b_ink,
            Self::Result => p.accent_ink,
            Self::None => p.muted,
        }
    }

    /// Returns the letter on its badge.
    pub(crate) fn letter(self) -> &'static str {
        match self {
            Self::A => "A",
            Self::B => "B",
            Self::Result => "R",
            Self::None => "·",
        }
    }
}

/// Returns the size of a chip.
pub(crate) fn chip_size(text: Text<'_>, ui: &Ui) -> Vec2 {
    line_of(&[Run::new(text, Type::SmallStrong, Color32::PLACEHOLDER)], f32::INFINITY, ui).size()
        + vec2(16.0, 6.0)
}

/// Draws a chip whose right end is at `right_center`. Returns its rectangle.
pub(crate) fn paint_chip(text: Text<'_>, mood: Mood, right_center: Pos2, ui: &Ui) -> Rect {
    let (ink, ground) = mood.colors(palette_of(ui));
    let galley = line_of(&[Run::new(text, Type::SmallStrong, ink)], f32::INFINITY, ui);
    let rect = Align2::RIGHT_CENTER.anchor_size(right_center, galley.size() + vec2(16.0, 6.0));
    ui.painter().rect_filled(rect, rect.height() / 2.0, ground);
    put(ui.painter(), rect.center(), Align2::CENTER_CENTER, galley);
    rect
}

/// Draws a red dot and the length of the recording so far, `0:07`, left of `right_center`.
pub(crate) fn recording_ui(name: Word, secs: f64, right_center: Pos2, ui: &mut Ui) -> Rect {
    let palette = palette_of(ui);
    let scale = theme_of(ui).scale();
    let whole = secs.max(0.0) as u64;
    let time = format!("{}:{:02}", whole / 60, whole % 60);
    let galley =
        line_of(&[Run::new(Text::Data(&time), Type::SmallStrong, palette.text)], f32::INFINITY, ui);
    let height = (24.0 * scale).round();
    let size = vec2(galley.size().x + 32.0 * scale, height);
    let rect = Align2::RIGHT_CENTER.anchor_size(right_center, size);
    let line = Stroke::new(theme_of(ui).hairline(), palette.line);
    ui.painter().rect(rect, height / 2.0, palette.panel_raised, line, StrokeKind::Inside);
    dot(rect.left_center() + vec2(13.0 * scale, 0.0), palette.bad, 4.5 * scale, ui.painter());
    put(ui.painter(), rect.right_center() - vec2(10.0 * scale, 0.0), Align2::RIGHT_CENTER, galley);
    let response =
        ui.interact(rect, ui.make_persistent_id(("recording", name.english())), Sense::hover());
    let said = format!("{}, {time}", say(name, ui));
    describe(&response, &WidgetInfo::labeled(Role::Label, true, said));
    rect
}

fn dot(center: Pos2, color: Color32, size: f32, painter: &Painter) {
    painter.circle_filled(center, size, color);
}
