//! Help texts: a sign behind the label of a row, which tells the text to the pointer, and shows it
//! below the row when it is pressed.

use super::assistive::describe;
use super::icon::{Icon, paint_icon};
use super::paint::{focus_ring, keyboard_in_use};
use super::words;
use crate::ui::language::{Text, Word, say};
use crate::ui::theme::{HIT, Type, palette_of, radius, space, theme_of};
use eframe::egui::{
    Context, CursorIcon, Id, Label, Pos2, Rect, RichText, Role, Sense, Tooltip, Ui, WidgetInfo,
    pos2, vec2,
};

/// The side of the sign, points.
const SIGN: f32 = 13.0;

/// Whether all help texts stand open, and the number of times that this was changed: a row that was
/// opened or closed by itself follows the next change.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
struct AllHelp {
    open: bool,
    changes: u64,
}

fn all_help(ctx: &Context) -> AllHelp {
    ctx.data(|data| data.get_temp(Id::unique("all help"))).unwrap_or_default()
}

/// Opens all help texts, or closes them, whenever `open` changes.
pub(crate) fn set_all_help(open: bool, ctx: &Context) {
    let known = all_help(ctx);
    if known.open != open {
        let changed = AllHelp { open, changes: known.changes + 1 };
        ctx.data_mut(|data| data.insert_temp(Id::unique("all help"), changed));
    }
}

/// The help of a row.
#[derive(Clone, Copy, Debug)]
pub(super) struct Help<'a> {
    /// The label of the row.
    pub(super) label: Text<'a>,
    /// The text; empty for none.
    pub(super) text: Text<'a>,
    /// The identity of the row.
    pub(super) id: Id,
}

impl Help<'_> {
    /// Returns the room that the sign takes behind a label, points.
    pub(super) fn sign_width(self, ui: &Ui) -> f32 {
        if self.text.is_empty() { 0.0 } else { side(ui) + space::XS }
    }

    /// Gives the text to assistive technology, as the description of a widget.
    pub(super) fn describe(self, widget: Id, ui: &Ui) {
        if !self.text.is_empty() {
            let text = say(self.text, ui);
            ui.ctx().accesskit_node_builder(widget, |node| node.set_description(text));
        }
    }

    fn open_id(self) -> Id {
        self.id.with("help_open")
    }

    /// Returns whether the text stands open below the row.
    pub(super) fn is_open(self, ui: &Ui) -> bool {
        let all = all_help(ui.ctx());
        let own: Option<(u64, bool)> = ui.data(|data| data.get_temp(self.open_id()));
        own.filter(|(changes, _)| *changes == all.changes).map_or(all.open, |(_, open)| open)
    }

    /// Draws the sign at the right of a label, whose right end is `after`. A press opens the text,
    /// or closes it.
    pub(super) fn sign_ui(self, after: Pos2, ui: &Ui) {
        if self.text.is_empty() {
            return;
        }
        let palette = palette_of(ui);
        let side = side(ui);
        let at = Rect::from_center_size(
            pos2(after.x + space::XS + side / 2.0, after.y),
            vec2(1.0, 1.0) * side,
        );
        let hit = Rect::from_center_size(at.center(), vec2(HIT, theme_of(ui).hit()));
        let response = ui
            .interact(hit, self.id.with("help"), Sense::click())
            .on_hover_cursor(CursorIcon::PointingHand);
        let was_open = self.is_open(ui);
        let open = was_open != response.clicked();
        if open != was_open {
            let changes = all_help(ui.ctx()).changes;
            ui.data_mut(|data| data.insert_temp(self.open_id(), (changes, open)));
        }
        let ink = if open {
            palette.accent_ink
        } else if response.hovered() || response.has_focus() {
            palette.text
        } else {
            palette.muted
        };
        paint_icon(Icon::Info, at, ink, ui.painter());
        focus_ring(at, radius::S, &response, ui);
        let name = format!("{}: {}", say(self.label, ui), say(words::HELP, ui));
        describe(&response, &WidgetInfo::labeled(Role::Button, ui.is_enabled(), name));
        ui.ctx().accesskit_node_builder(response.id, |node| node.set_expanded(open));
        if open {
            return;
        }
        // The keyboard has no pointer to rest on the sign.
        if response.has_focus() && keyboard_in_use(ui) {
            Tooltip::for_widget(&response).show(|ui| self.tip_ui(ui));
        } else {
            response.on_hover_ui(|ui| self.tip_ui(ui));
        }
    }

    /// Draws the text in a hint.
    pub(super) fn tip_ui(self, ui: &mut Ui) {
        if !self.text.is_empty() {
            ui.set_max_width(ui.spacing().tooltip_width);
            ui.label(say(self.text, ui));
        }
    }

    /// Draws the text below the row while it stands open.
    pub(super) fn line_ui(self, ui: &mut Ui) {
        if self.text.is_empty() || !self.is_open(ui) {
            return;
        }
        let font = theme_of(ui).font(Type::Small);
        let words = RichText::new(say(self.text, ui)).font(font).color(palette_of(ui).muted);
        ui.add(Label::new(words).selectable(true));
        ui.add_space(space::XS);
    }
}

fn side(ui: &Ui) -> f32 {
    (SIGN * theme_of(ui).scale()).round()
}

/// Draws a short text, and behind it the sign of a longer one, which a press shows below it.
pub(crate) fn about_ui<'a>(label: impl Into<Text<'a>>, about: Word, more: Word, ui: &mut Ui) {
    let label = label.into();
    let help =
        Help { label, text: more.into(), id: ui.make_persistent_id(("about", label.english())) };
    let (theme, muted) = (theme_of(ui), palette_of(ui).muted);
    let words = RichText::new(say(about, ui)).font(theme.font(Type::Small)).color(muted);
    let shown = ui
        .scope(|ui| {
            ui.set_max_width(ui.available_width() - theme.row_height());
            ui.add(Label::new(words).selectable(true))
        })
        .inner;
    // The sign stands in a column of its own, beside the first line.
    let right = ui.max_rect().right() - 0.5 * (theme.row_height() + side(ui)) - space::XS;
    let first_line = 0.5 * (theme.font(Type::Small).size * 1.36).round();
    help.sign_ui(pos2(right, shown.rect.top() + first_line), ui);
    help.line_ui(ui);
    ui.add_space(space::XS);
}
