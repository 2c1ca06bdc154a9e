//! Menus behind a button, and a choice among many.

use super::assistive::describe;
use super::help::Help;
use super::icon::{Icon, paint_icon};
use super::paint::{Run, faded, focus_ring, full_width, line_of, put};
use crate::ui::language::{Text, say};
use crate::ui::theme::{Type, palette_of, radius, space, theme_of};
use eframe::egui::{
    Align2, CursorIcon, Id, InnerResponse, Popup, PopupCloseBehavior, Rect, RectAlign, Response,
    Role, Sense, Stroke, StrokeKind, Ui, WidgetInfo, pos2, vec2,
};

/// One line of a menu.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct MenuItem<'a> {
    /// Its label.
    pub(crate) text: Text<'a>,
    /// The icon before it.
    pub(crate) icon: Option<Icon>,
    /// The keys of the same command, at the right.
    pub(crate) shortcut: Text<'a>,
    /// For one of several choices: whether it is the current one, which has a tick. `None` for a
    /// command.
    pub(crate) chosen: Option<bool>,
}

/// Draws a menu that opens below (or above, where there is no room) `opener` when that is clicked,
/// and closes after a choice.
pub(crate) fn menu_ui<R>(
    opener: &Response,
    align: RectAlign,
    content: impl FnOnce(&mut Ui) -> R,
) -> Option<InnerResponse<R>> {
    popup_ui(opener, align, PopupCloseBehavior::CloseOnClick, content)
}

/// Draws a menu as [`menu_ui`] does, of switches: it stays open until the user clicks beside it.
pub(crate) fn switches_menu_ui<R>(
    opener: &Response,
    align: RectAlign,
    content: impl FnOnce(&mut Ui) -> R,
) -> Option<InnerResponse<R>> {
    popup_ui(opener, align, PopupCloseBehavior::CloseOnClickOutside, content)
}

fn popup_ui<R>(
    opener: &Response,
    align: RectAlign,
    closes: PopupCloseBehavior,
    content: impl FnOnce(&mut Ui) -> R,
) -> Option<InnerResponse<R>> {
    let menu = Popup::menu(opener).align(align).gap(space::XS).close_behavior(closes);
    let content = |ui: &mut Ui| {
        ui.spacing_mut().item_spacing.y = 1.0;
        ui.set_min_width(opener.rect.width().max(150.0 * theme_of(ui).scale()));
        if closes == PopupCloseBehavior::CloseOnClick {
            until_choice(content, ui)
        } else {
            content(ui)
        }
    };
    popup_returning_keyboard_ui(opener, menu, content)
}

/// Shows a popup of a widget. When keys have closed it, they go on at the widget.
pub(crate) fn popup_returning_keyboard_ui<R>(
    opener: &Response,
    popup: Popup<'_>,
    content: impl FnOnce(&mut Ui) -> R,
) -> Option<InnerResponse<R>> {
    let id = Popup::default_response_id(opener);
    let was_open = Popup::is_id_open(&opener.ctx, id);
    let shown = popup.show(content);
    let is_closed = was_open && !Popup::is_id_open(&opener.ctx, id);
    if is_closed && !opener.ctx.input(|input| input.pointer.any_click()) {
        opener.request_focus();
    }
    shown
}

/// Draws the contents of a menu, and closes it once one of its lines is chosen. egui closes it for
/// clicks of a pointer only, and not for keys and screen readers.
pub(crate) fn until_choice<R>(content: impl FnOnce(&mut Ui) -> R, ui: &mut Ui) -> R {
    let before = choices(ui);
    let result = content(ui);
    if choices(ui) != before {
        ui.close();
    }
    result
}

/// Returns how many lines of menus have been chosen.
fn choices(ui: &Ui) -> u64 {
    ui.data(|data| data.get_temp(choices_id())).unwrap_or(0)
}

fn choices_id() -> Id {
    Id::unique("segue choices in menus")
}

/// Draws a menu that opens at the pointer when `widget` is clicked with the second button, or
/// pressed for long by a finger, and closes after a choice.
pub(crate) fn context_menu_ui<R>(
    widget: &Response,
    content: impl FnOnce(&mut Ui) -> R,
) -> Option<InnerResponse<R>> {
    Popup::context_menu(widget).close_behavior(PopupCloseBehavior::CloseOnClick).show(|ui| {
        ui.spacing_mut().item_spacing.y = 1.0;
        ui.set_min_width(150.0 * theme_of(ui).scale());
        until_choice(content, ui)
    })
}

/// Draws one line of a menu, as wide as the menu.
pub(crate) fn menu_item_ui(item: MenuItem<'_>, ui: &mut Ui) -> Response {
    let (theme, palette) = (theme_of(ui), palette_of(ui));
    let enabled = ui.is_enabled();
    let text = line_of(
        &[Run::new(item.text, Type::Body, faded(palette.text, enabled))],
        f32::INFINITY,
        ui,
    );
    let shortcut = line_of(
        &[Run::new(item.shortcut, Type::Small, faded(palette.muted, enabled))],
        f32::INFINITY,
        ui,
    );
    let icon_size = (15.0 * theme.scale()).round();
    let indent = space::S + icon_size + space::S;
    let gap = if item.shortcut.is_empty() { 0.0 } else { 28.0 };
    let needed = indent + text.size().x + gap + shortcut.size().x + space::M;
    // While the menu is being measured it is as wide as its widest line; then every line is as wide
    // as the menu.
    let width = if ui.is_sizing_pass() { needed } else { needed.max(ui.available_width()) };
    let (rect, response) = ui.allocate_exact_size(vec2(width, theme.row_height()), Sense::click());
    let response = response.on_hover_cursor(CursorIcon::PointingHand);
    if enabled && (response.hovered() || response.has_focus()) {
        ui.painter().rect_filled(rect, radius::M, palette.pressed);
    }
    let is_chosen = item.chosen == Some(true);
    let sign = if is_chosen { Some(Icon::Check) } else { item.icon };
    if let Some(sign) = sign {
        let at = Align2::LEFT_CENTER
            .anchor_size(pos2(rect.left() + space::S, rect.center().y), vec2(icon_size, icon_size));
        let tone = if is_chosen { palette.accent_ink } else { palette.muted };
        paint_icon(sign, at, faded(tone, enabled), ui.painter());
    }
    put(ui.painter(), pos2(rect.left() + indent, rect.center().y), Align2::LEFT_CENTER, text);
    put(
        ui.painter(),
        pos2(rect.right() - space::S, rect.center().y),
        Align2::RIGHT_CENTER,
        shortcut,
    );
    focus_ring(rect.shrink(2.0), radius::M, &response, ui);
    let name = say(item.text, ui);
    let mut info = WidgetInfo::labeled(Role::MenuItem, enabled, name);
    info.selected = item.chosen;
    describe(&response, &info);
    if response.clicked() {
        ui.data_mut(|data| *data.get_temp_mut_or_default::<u64>(choices_id()) += 1);
    }
    response
}

/// Draws a hairline between groups of a menu.
pub(crate) fn menu_line_ui(ui: &mut Ui) {
    let width = if ui.is_sizing_pass() { 0.0 } else { ui.available_width() };
    let (_, rect) = ui.allocate_space(vec2(width, 9.0));
    let stroke = Stroke::new(theme_of(ui).hairline(), palette_of(ui).line);
    ui.painter().hline(rect.x_range(), rect.center().y, stroke);
}

/// Draws a parameter with many possible values: the label at the left, the chosen value at the
/// right, the others in a menu. Returns a new choice.
pub(crate) fn choice_row_ui<'a, T: Copy + PartialEq>(
    label: impl Into<Text<'a>>,
    chosen: T,
    options: &[(T, impl Into<Text<'a>> + Copy)],
    ui: &mut Ui,
) -> Option<T> {
    let options: Vec<(T, Text<'_>)> =
        options.iter().map(|&(value, text)| (value, text.into())).collect();
    helped_choice_row_ui(label.into(), Text::EMPTY, chosen, &options, ui)
}

/// Draws a choice as [`choice_row_ui`] does, with a help text.
pub(crate) fn helped_choice_row_ui<T: Copy + PartialEq>(
    label: Text<'_>,
    help: Text<'_>,
    chosen: T,
    options: &[(T, Text<'_>)],
    ui: &mut Ui,
) -> Option<T> {
    let (theme, palette) = (theme_of(ui), palette_of(ui));
    let enabled = ui.is_enabled();
    let id = ui.make_persistent_id(label.english());
    let help = Help { label, text: help, id };
    let row = full_width(theme.row_height(), ui);
    let response = ui.interact(row, id, Sense::click()).on_hover_cursor(CursorIcon::PointingHand);
    let current =
        options.iter().find(|option| option.0 == chosen).map_or(Text::EMPTY, |option| option.1);

    let chevron = (14.0 * theme.scale()).round();
    let name = line_of(
        &[Run::new(current, Type::Strong, faded(palette.text, enabled))],
        row.width() * 0.6,
        ui,
    );
    let field_width = name.size().x + chevron + 2.0 * space::S + 2.0;
    let field = Rect::from_min_max(
        pos2(row.right() - field_width, row.top() + 1.0),
        pos2(row.right(), row.bottom() - 1.0),
    );
    let (fill, line) = if response.hovered() || response.has_focus() {
        (palette.hover, palette.line_strong)
    } else {
        (palette.panel_raised, palette.line)
    };
    ui.painter().rect(
        field,
        radius::M,
        fill,
        Stroke::new(theme.hairline(), line),
        StrokeKind::Inside,
    );
    put(ui.painter(), pos2(field.left() + space::S, row.center().y), Align2::LEFT_CENTER, name);
    let at = Align2::RIGHT_CENTER
        .anchor_size(pos2(field.right() - space::S + 2.0, row.center().y), vec2(chevron, chevron));
    paint_icon(Icon::ChevronDown, at, faded(palette.muted, enabled), ui.painter());
    let label_galley = line_of(
        &[Run::new(label, Type::Label, faded(palette.text, enabled))],
        field.left() - row.left() - space::S - help.sign_width(ui),
        ui,
    );
    let label_rect = put(ui.painter(), row.left_center(), Align2::LEFT_CENTER, label_galley);
    focus_ring(field, radius::M, &response, ui);
    let mut info = WidgetInfo::labeled(Role::ComboBox, enabled, say(label, ui));
    info.current_text_value = Some(say(current, ui));
    describe(&response, &info);
    help.describe(response.id, ui);
    let response = response.on_hover_ui(|ui| help.tip_ui(ui));
    help.sign_ui(label_rect.right_center(), ui);

    let picked = menu_ui(&response.with_new_rect(field), RectAlign::BOTTOM_END, |ui| {
        let mut picked = None;
        for &(value, text) in options {
            if menu_item_ui(
                MenuItem { text, chosen: Some(value == chosen), ..MenuItem::default() },
                ui,
            )
            .clicked()
            {
                picked = Some(value);
            }
        }
        picked
    });
    help.line_ui(ui);
    picked.and_then(|shown| shown.inner).filter(|&value| value != chosen)
}
