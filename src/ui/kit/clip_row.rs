//! The row of a clip in the library.

use super::assistive::describe;
use super::chip::Part;
use super::icon::{Icon, paint_icon};
use super::paint::{
    PointerKind, Run, focus_ring, full_width, line_of, name_line, paragraph, pointer_in_use, put,
};
use super::words;
use crate::ui::language::{Text, Word, say};
use crate::ui::theme::{HIT, Type, palette_of, radius, space, theme_of};
use eframe::egui::{
    Align2, Color32, CursorIcon, Id, Key, Memory, Modifiers, Pos2, Rect, Response, Role, Sense,
    Stroke, StrokeKind, Ui, Vec2, WidgetInfo, pos2, vec2,
};

/// The least side of a target for a finger, points.
const FINGER: f32 = 44.0;

/// A letter of a row: a slot that the clip can take.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SlotLetter<'a> {
    /// The slot.
    pub(crate) part: Part,
    /// Whether the clip is in it.
    pub(crate) held: bool,
    /// Its accessible name: `Walk as A`.
    pub(crate) name: Text<'a>,
}

/// A clip as its row shows it.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct ClipRow<'a> {
    /// Its name.
    pub(crate) name: Text<'a>,
    /// Its length: `3.9 s · 468 frames`.
    pub(crate) detail: Text<'a>,
    /// More about it, for its hint: `30 joints`; empty for nothing.
    pub(crate) more: Text<'a>,
    /// The slots that it can take.
    pub(crate) letters: &'a [SlotLetter<'a>],
    /// The warnings about its file, for the hint of the sign; empty for none.
    pub(crate) warning: Text<'a>,
    /// Whether its details are open.
    pub(crate) open: bool,
    /// Whether it is one of the clips that were selected.
    pub(crate) picked: bool,
    /// The icons of its actions, shown while the pointer or the focus is on the row, with their
    /// names. A finger has a menu instead.
    pub(crate) actions: &'a [(Icon, Word)],
}

/// The user's input to a row of the library.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum ClipRowEvent {
    /// The row was chosen.
    Chosen,
    /// The letter of that index was pressed.
    Letter(usize),
    /// The action of that index was pressed.
    Action(usize),
    /// Its menu was requested by the pointer or the keyboard.
    Menu {
        /// Whether the pointer requested it.
        by_pointer: bool,
    },
    /// It was pressed long by a finger.
    Held,
}

/// The user's input to a row of the library.
#[derive(Debug)]
pub(crate) struct ClipRowResponse {
    /// The user's input, if there was any.
    pub(crate) event: Option<ClipRowEvent>,
    /// The row, which a mouse can drag; give it a payload with `dnd_set_drag_payload`.
    pub(crate) response: Response,
    /// Whether the row or a part of it has the focus.
    pub(crate) has_focus: bool,
}

/// The widths of the parts of a row, points.
#[derive(Clone, Copy, Debug)]
struct Widths {
    /// The side of a letter.
    badge: f32,
    /// The target around a letter.
    letter: f32,
    /// From the left edge of the row to the first letter.
    before: f32,
    /// From the left edge of the row to the text.
    text_left: f32,
    /// The text between the letters and the signs.
    text: f32,
    /// The button of the menu, which only a finger has.
    menu: f32,
}

impl Widths {
    fn of(row: &ClipRow<'_>, by_finger: bool, width: f32, scale: f32) -> Self {
        let badge = (20.0 * scale).round();
        let (letter, before) = if by_finger { (FINGER, 0.0) } else { (badge + 4.0, space::XS) };
        let gap = if row.letters.is_empty() { space::S } else { space::S - 2.0 };
        let text_left = before + row.letters.len() as f32 * letter + gap;
        let menu = if by_finger && !row.actions.is_empty() { FINGER } else { 0.0 };
        let signs = usize::from(!row.warning.is_empty()) + usize::from(row.picked);
        let text = width - space::XS - menu - signs as f32 * HIT - text_left - 2.0;
        Self { badge, letter, before, text_left, text, menu }
    }
}

/// Draws the row of a clip: a letter for each slot, name and facts, a sign if there are warnings,
/// and the actions.
pub(crate) fn clip_row_ui(row: ClipRow<'_>, ui: &mut Ui) -> ClipRowResponse {
    let (theme, palette) = (theme_of(ui), palette_of(ui));
    let pointer = pointer_in_use(ui);
    let by_finger = pointer == PointerKind::Finger;
    let widths = Widths::of(&row, by_finger, ui.available_width(), theme.scale());
    let name_height = (18.0 * theme.scale()).round();
    let detail = paragraph(row.detail, Type::Small, palette.muted, widths.text, ui);
    let text_height = name_height + detail.size().y;
    let height = (text_height + 12.0).max(if by_finger { FINGER } else { 0.0 });
    let rect = full_width(height.round(), ui);
    let id = ui.make_persistent_id(("clip", row.name.english()));
    // A finger scrolls the list with the same movement.
    let drags = pointer == PointerKind::Mouse;
    let sense = if drags { Sense::click_and_drag() } else { Sense::click() };
    let response = ui.interact(rect, id, sense).on_hover_cursor(CursorIcon::PointingHand);

    // The pointer may be on a button inside the row: the row is hovered then as well.
    let hovered = !by_finger && response.contains_pointer();
    let ground = match (row.picked, row.open, hovered) {
        (true, ..) => palette.accent_wash,
        (false, true, _) => palette.pressed,
        (false, false, true) => palette.hover,
        (false, false, false) => Color32::TRANSPARENT,
    };
    ui.painter().rect_filled(rect, radius::M, ground);
    let name = name_line(row.name, Type::Strong, palette.text, widths.text, ui);
    let corner = pos2(rect.left() + widths.text_left, rect.center().y - text_height / 2.0);
    let name_at = corner + vec2(0.0, name_height / 2.0);
    put(ui.painter(), name_at, Align2::LEFT_CENTER, name);
    put(ui.painter(), corner + vec2(0.0, name_height), Align2::LEFT_TOP, detail);
    focus_ring(rect.shrink(2.0), radius::M, &response, ui);
    let (name, detail) = (say(row.name, ui), say(row.detail, ui));
    let is_on = row.open || row.picked;
    let said = format!("{name}, {detail}");
    describe(&response, &WidgetInfo::selected(Role::Button, ui.is_enabled(), is_on, said));

    let mut event = row_event(&response, ui);
    for (index, letter) in row.letters.iter().enumerate() {
        let left = rect.left() + widths.before + index as f32 * widths.letter;
        let hit = Rect::from_x_y_ranges(left..=left + widths.letter, rect.y_range());
        let place = Rect::from_center_size(hit.center(), Vec2::splat(widths.badge));
        if letter_ui(*letter, inner_id(id, LETTER, index), hit, place, ui).clicked() {
            event = Some(ClipRowEvent::Letter(index));
        }
    }
    let has_focus = response.has_focus() || has_inner_focus(id, &row, ui);
    let pressed = if by_finger {
        menu_button_ui(id, rect, widths.menu, ui)
    } else if hovered || has_focus {
        // They lie over the facts, so that the name stays whole.
        let line = rect.with_min_y(corner.y + name_height).with_max_y(corner.y + text_height);
        let ground = if ground == Color32::TRANSPARENT { palette.panel } else { ground };
        actions_ui(id, row.actions, line, ground, ui)
    } else {
        None
    };
    let signs_right = rect.right() - space::XS - widths.menu;
    signs_ui(&row, id, pos2(signs_right, name_at.y), ui);
    let event = pressed.or(event);
    if !hovered || ui.ctx().any_popup_open() {
        return ClipRowResponse { event, response, has_focus };
    }
    let more = say(row.more, ui);
    let dot = if more.is_empty() { "" } else { " · " };
    let hint = format!("{name}\n{detail}{dot}{more}");
    let response = response.on_hover_text(say(Text::Data(&hint), ui));
    ClipRowResponse { event, response, has_focus }
}

/// The kinds of widgets in a row, which their ids contain.
const LETTER: &str = "letter";
const ACTION: &str = "action";

fn inner_id(row: Id, kind: &str, index: usize) -> Id {
    row.with((kind, index))
}

/// Returns whether a letter or an action of the row has the focus.
fn has_inner_focus(id: Id, row: &ClipRow<'_>, ui: &Ui) -> bool {
    let Some(focused) = ui.memory(Memory::focused) else {
        return false;
    };
    let letters = (0..row.letters.len()).map(|index| inner_id(id, LETTER, index));
    let actions = (0..row.actions.len()).map(|index| inner_id(id, ACTION, index));
    letters.chain(actions).any(|inner| inner == focused)
}

/// Draws the button that opens the menu of the row.
fn menu_button_ui(id: Id, row: Rect, width: f32, ui: &Ui) -> Option<ClipRowEvent> {
    if width == 0.0 {
        return None;
    }
    let at = row.with_max_x(row.right() - space::XS).with_min_x(row.right() - space::XS - width);
    let ground = Color32::TRANSPARENT;
    let more = small_icon_ui(Icon::More, words::MORE, id.with("more"), at, ground, ui);
    more.clicked().then_some(ClipRowEvent::Menu { by_pointer: false })
}

/// Draws the actions at the right end of a line.
fn actions_ui(
    id: Id,
    actions: &[(Icon, Word)],
    line: Rect,
    ground: Color32,
    ui: &Ui,
) -> Option<ClipRowEvent> {
    let mut pressed = None;
    let left = line.right() - space::XS - actions.len() as f32 * HIT;
    for (index, &(icon, hint)) in actions.iter().enumerate() {
        let center = pos2(left + (index as f32 + 0.5) * HIT, line.center().y + 2.0);
        let at = Rect::from_center_size(center, Vec2::splat(HIT));
        if small_icon_ui(icon, hint, inner_id(id, ACTION, index), at, ground, ui).clicked() {
            pressed = Some(ClipRowEvent::Action(index));
        }
    }
    pressed
}

/// Draws the signs of a selected clip and of warnings, the last one ending at `right`.
fn signs_ui(row: &ClipRow<'_>, id: Id, right: Pos2, ui: &Ui) {
    let palette = palette_of(ui);
    let mut center = right - vec2(HIT / 2.0, 0.0);
    if row.picked {
        let at = Rect::from_center_size(center, Vec2::splat(HIT));
        paint_icon(Icon::Check, at.shrink(4.5), palette.accent_ink, ui.painter());
        center.x -= HIT;
    }
    if !row.warning.is_empty() {
        let at = Rect::from_center_size(center, Vec2::splat(HIT));
        let sign = ui.interact(at, id.with("warning"), Sense::hover());
        paint_icon(Icon::Warning, at.shrink(4.5), palette.warning, ui.painter());
        describe(&sign, &WidgetInfo::labeled(Role::Label, true, say(row.warning, ui)));
        sign.on_hover_text(say(row.warning, ui));
    }
}

/// Returns the input to the row itself.
fn row_event(response: &Response, ui: &Ui) -> Option<ClipRowEvent> {
    let asks_by_key = response.has_focus()
        && ui.input_mut(|input| {
            input.consume_key(Modifiers::NONE, Key::Menu)
                || input.consume_key(Modifiers::SHIFT, Key::F10)
        });
    if asks_by_key {
        Some(ClipRowEvent::Menu { by_pointer: false })
    } else if response.long_touched() {
        Some(ClipRowEvent::Held)
    } else if response.secondary_clicked() {
        Some(ClipRowEvent::Menu { by_pointer: true })
    } else {
        response.clicked().then_some(ClipRowEvent::Chosen)
    }
}

/// Draws a letter, filled with the colour of its slot where the clip is in it.
fn letter_ui(letter: SlotLetter<'_>, id: Id, hit: Rect, place: Rect, ui: &Ui) -> Response {
    let palette = palette_of(ui);
    let response = ui.interact(hit, id, Sense::click()).on_hover_cursor(CursorIcon::PointingHand);
    let hot = response.hovered() || response.has_focus();
    let (fill, on_fill) = letter.part.fill(palette);
    let ink = match (letter.held, hot) {
        (true, _) => on_fill,
        (false, true) => letter.part.ink(palette),
        (false, false) => palette.muted,
    };
    if letter.held {
        ui.painter().rect_filled(place, radius::S + 1, fill);
    } else {
        let line = if hot { letter.part.ink(palette) } else { palette.line_strong };
        let stroke = Stroke::new(theme_of(ui).hairline(), line);
        ui.painter().rect_stroke(place, radius::S + 1, stroke, StrokeKind::Inside);
    }
    let run = Run::new(Text::Data(letter.part.letter()), Type::SmallStrong, ink);
    put(ui.painter(), place.center(), Align2::CENTER_CENTER, line_of(&[run], f32::INFINITY, ui));
    focus_ring(place, radius::S, &response, ui);
    let name = say(letter.name, ui);
    let info = WidgetInfo::selected(Role::Button, ui.is_enabled(), letter.held, name.as_str());
    describe(&response, &info);
    response.on_hover_text(say(letter.name, ui))
}

/// Draws an icon inside another widget, as a button of its own.
pub(super) fn small_icon_ui(
    icon: Icon,
    name: Word,
    id: Id,
    rect: Rect,
    ground: Color32,
    ui: &Ui,
) -> Response {
    let palette = palette_of(ui);
    let response = ui.interact(rect, id, Sense::click()).on_hover_cursor(CursorIcon::PointingHand);
    let hot = response.hovered() || response.has_focus();
    if hot {
        ui.painter().rect_filled(rect.shrink(1.0), radius::S, palette.pressed);
    } else {
        // A name that is longer than the row shows through otherwise.
        ui.painter().rect_filled(rect.shrink(1.0), radius::S, ground);
    }
    let sign = Rect::from_center_size(rect.center(), Vec2::splat(rect.height().min(HIT) - 10.0));
    paint_icon(icon, sign, if hot { palette.text } else { palette.muted }, ui.painter());
    focus_ring(rect, radius::S, &response, ui);
    describe(&response, &WidgetInfo::labeled(Role::Button, ui.is_enabled(), say(name, ui)));
    response.on_hover_text(say(name, ui))
}

/// Draws the head row of a group of clips, which folds it. `count` is the number of its clips,
/// where the title does not say it.
pub(crate) fn group_head_ui(
    title: Text<'_>,
    count: Option<usize>,
    open: bool,
    ui: &mut Ui,
) -> Response {
    let (theme, palette) = (theme_of(ui), palette_of(ui));
    let by_finger = pointer_in_use(ui) == PointerKind::Finger;
    let height = if by_finger { FINGER } else { theme.row_height() };
    let rect = full_width(height, ui);
    let id = ui.make_persistent_id(("group", title.english()));
    let response = ui.interact(rect, id, Sense::click()).on_hover_cursor(CursorIcon::PointingHand);
    if response.hovered() {
        ui.painter().rect_filled(rect, radius::M, palette.hover);
    }
    let side = (14.0 * theme.scale()).round();
    let sign = if open { Icon::ChevronDown } else { Icon::ChevronRight };
    let at = Rect::from_center_size(
        pos2(rect.left() + space::S + side / 2.0, rect.center().y),
        Vec2::splat(side),
    );
    paint_icon(sign, at, palette.muted, ui.painter());
    let number = count.map_or_else(String::new, |count| count.to_string());
    let run = Run::new(Text::Data(&number), Type::Small, palette.muted);
    let number_at = put(
        ui.painter(),
        pos2(rect.right() - space::S, rect.center().y),
        Align2::RIGHT_CENTER,
        line_of(&[run], f32::INFINITY, ui),
    );
    let left = at.right() + space::S;
    let name = name_line(title, Type::Label, palette.muted, number_at.left() - left - space::S, ui);
    put(ui.painter(), pos2(left, rect.center().y), Align2::LEFT_CENTER, name);
    focus_ring(rect.shrink(2.0), radius::M, &response, ui);
    let title = say(title, ui);
    let said = if count.is_some() { format!("{title}, {number}") } else { title };
    describe(&response, &WidgetInfo::labeled(Role::DisclosureTriangle, ui.is_enabled(), said));
    ui.ctx().accesskit_node_builder(response.id, |node| node.set_expanded(open));
    response
}
