//! Buttons, from the primary one to those that show only under the pointer.

use super::assistive::describe;
use super::icon::{Icon, paint_icon};
use super::paint::{Run, faded, focus_ring, line_of};
use crate::ui::language::{Text, say};
use crate::ui::theme::{Palette, Type, palette_of, radius, space, theme_of};
use eframe::egui::{
    Align2, Color32, CursorIcon, Response, Role, Sense, Stroke, StrokeKind, Ui, WidgetInfo, pos2,
    vec2,
};

/// The prominence of a button.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum Tone {
    /// The main action; at most one in sight.
    Primary,
    /// Outlined.
    #[default]
    Secondary,
    /// Without a ground until the pointer is on it.
    Quiet,
}

/// A button: an icon, a word, or both.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Button<'a> {
    text: Text<'a>,
    name: Text<'a>,
    icon: Option<Icon>,
    trailing: Option<Icon>,
    tone: Tone,
    selected: bool,
    hint: Text<'a>,
}

impl<'a> Button<'a> {
    /// Returns a button with a text.
    pub(crate) fn new(text: impl Into<Text<'a>>) -> Self {
        let text = text.into();
        Self {
            text,
            name: text,
            icon: None,
            trailing: None,
            tone: Tone::Secondary,
            selected: false,
            hint: Text::EMPTY,
        }
    }

    /// Returns a button with an icon alone. `name` is its accessible name, and its hint until
    /// another is given.
    pub(crate) fn icon_only(icon: Icon, name: impl Into<Text<'a>>) -> Self {
        let name = name.into();
        Self { name, icon: Some(icon), hint: name, tone: Tone::Quiet, ..Self::new(Text::EMPTY) }
    }

    /// Makes it the main action.
    pub(crate) fn primary(mut self) -> Self {
        self.tone = Tone::Primary;
        self
    }

    /// Makes it quiet: it has no ground until the pointer is on it.
    pub(crate) fn quiet(mut self) -> Self {
        self.tone = Tone::Quiet;
        self
    }

    /// Outlines it: an icon alone would be taken for a sign.
    pub(crate) fn outlined(mut self) -> Self {
        self.tone = Tone::Secondary;
        self
    }

    /// Sets an icon before the text.
    pub(crate) fn icon(mut self, icon: Icon) -> Self {
        self.icon = Some(icon);
        self
    }

    /// Sets a small icon behind the text, such as a chevron.
    pub(crate) fn trailing(mut self, icon: Icon) -> Self {
        self.trailing = Some(icon);
        self
    }

    /// Shows it as chosen, or switched on.
    pub(crate) fn selected(mut self, selected: bool) -> Self {
        self.selected = selected;
        self
    }

    /// Sets the hint.
    pub(crate) fn hint(mut self, hint: impl Into<Text<'a>>) -> Self {
        self.hint = hint.into();
        self
    }

    /// Sets the accessible name, where it is not the text.
    pub(crate) fn name(mut self, name: impl Into<Text<'a>>) -> Self {
        self.name = name.into();
        self
    }

    fn colors(self, hovered: bool, down: bool, p: &Palette) -> (Color32, Color32, Color32) {
        let raised = if down || self.selected {
            p.pressed
        } else if hovered {
            p.hover
        } else {
            p.panel_raised
        };
        match self.tone {
            Tone::Primary => {
                let fill = if down {
                    p.accent_fill.lerp_to_gamma(p.accent_text, 0.16)
                } else if hovered {
                    p.accent_fill.lerp_to_gamma(p.handle, 0.12)
                } else {
                    p.accent_fill
                };
                (fill, Color32::TRANSPARENT, p.accent_text)
            }
            Tone::Secondary => (raised, if hovered { p.line_strong } else { p.line }, p.text),
            Tone::Quiet if self.selected => (p.pressed, Color32::TRANSPARENT, p.text),
            Tone::Quiet if hovered || down => (raised, Color32::TRANSPARENT, p.text),
            Tone::Quiet => (Color32::TRANSPARENT, Color32::TRANSPARENT, p.muted),
        }
    }
}

/// Draws a button. [`Response::clicked`] is true when it is pressed, by pointer or by keyboard.
pub(crate) fn button_ui(button: Button<'_>, ui: &mut Ui) -> Response {
    let (theme, palette) = (theme_of(ui), palette_of(ui));
    let scale = theme.scale();
    let enabled = ui.is_enabled();
    let height = theme.row_height();
    let icon_size = (16.0 * scale).round();
    let step = if button.tone == Tone::Primary { Type::Strong } else { Type::Body };
    // The text is measured first: the colours depend on the response, which needs the size.
    let width_limit = ui.available_width() - 2.0 * space::M;
    let text_width = if button.text.is_empty() {
        0.0
    } else {
        line_of(&[Run::new(button.text, step, palette.text)], width_limit.max(40.0), ui).size().x
    };
    let mut content = text_width;
    let icons = [button.icon, button.trailing].into_iter().flatten().count() as f32;
    content += icons * icon_size;
    if !button.text.is_empty() {
        content += icons * 6.0;
    }
    let padding = if button.text.is_empty() { (height - icon_size) / 2.0 } else { space::M };
    let size = vec2((content + 2.0 * padding).max(theme.hit()), height);
    let (rect, response) = ui.allocate_exact_size(size, Sense::click());
    let response = response.on_hover_cursor(CursorIcon::PointingHand);

    if ui.is_rect_visible(rect) {
        let hovered = response.hovered() || response.has_focus();
        let (fill, line, ink) =
            button.colors(hovered, response.is_pointer_button_down_on(), palette);
        let ink = faded(ink, enabled);
        let stroke = Stroke::new(theme.hairline(), line);
        ui.painter().rect(rect, radius::M, faded(fill, enabled), stroke, StrokeKind::Inside);
        let mut x = rect.center().x - content / 2.0;
        if let Some(icon) = button.icon {
            let at = Align2::LEFT_CENTER
                .anchor_size(pos2(x, rect.center().y), vec2(icon_size, icon_size));
            paint_icon(icon, at, ink, ui.painter());
            x += icon_size + 6.0;
        }
        if !button.text.is_empty() {
            let galley = line_of(&[Run::new(button.text, step, ink)], width_limit.max(40.0), ui);
            let at = super::paint::put(
                ui.painter(),
                pos2(x, rect.center().y),
                Align2::LEFT_CENTER,
                galley,
            );
            x = at.right() + 6.0;
        }
        if let Some(icon) = button.trailing {
            let at = Align2::LEFT_CENTER
                .anchor_size(pos2(x, rect.center().y), vec2(icon_size, icon_size));
            paint_icon(
                icon,
                at.shrink(1.0),
                faded(palette.muted, enabled).lerp_to_gamma(ink, 0.3),
                ui.painter(),
            );
        }
    }
    focus_ring(rect, radius::M, &response, ui);
    let mut info = WidgetInfo::labeled(Role::Button, enabled, say(button.name, ui));
    info.selected = button.selected.then_some(true);
    describe(&response, &info);
    if button.hint.is_empty() { response } else { response.on_hover_text(say(button.hint, ui)) }
}

/// Draws a small square button with an icon alone.
pub(crate) fn icon_button_ui<'a>(icon: Icon, name: impl Into<Text<'a>>, ui: &mut Ui) -> Response {
    button_ui(Button::icon_only(icon, name), ui)
}
