//! The left panel: the library of clips.

pub(in crate::ui) mod arrange;
mod files;
mod row;
mod selection;

use self::arrange::{Arranged, ArrangedFor, Row, Section, arrange};
use self::files::files_ui;
use self::row::entry_ui;
use self::selection::selection_ui;
use super::commands::{UiCommand, command_icon_ui};
use super::kit::{self, Button, Icon, MenuItem};
use super::language::{Text, Word, say};
use super::out::Out;
use super::state::{ClipOrder, NoticePlace, UiState};
use super::text;
use super::theme::{palette_of, space, theme_of};
use eframe::egui::accesskit::Role;
use eframe::egui::style::ScrollAnimation;
use eframe::egui::{
    Align, Frame, Id, Layout as Flow, Margin, Panel, Rect, RectAlign, ScrollArea, Ui, UiBuilder,
    pos2, vec2,
};
use segue_session::{Entry, Origin, Session, Slot, StorageState};
use std::sync::Arc;

/// The number of clips from which on they can be searched and sorted.
const SEARCHED_FROM: usize = 9;

/// Draws the panel: its head, the list, and below it, always in sight, the selection and the drop
/// zone.
pub(crate) fn library_panel_ui(session: &Session, state: &mut UiState, out: &mut Out, ui: &mut Ui) {
    let frame = Frame::new().inner_margin(Margin { top: space::S as i8, ..Margin::ZERO });
    Panel::bottom("drop files here").frame(frame).show_separator_line(false).show(ui, |ui| {
        selection_ui(session, state, out, ui);
        files_ui(session, state, out, ui);
    });
    head_ui(session, false, state, out, ui);
    ScrollArea::vertical()
        .auto_shrink(false)
        .show(ui, |ui| library_list_ui(session, state, out, ui));
}

/// Draws the library of a phone, which takes the place of the parameters. `frame` is that of what
/// scrolls.
pub(crate) fn library_drawer_ui(
    session: &Session,
    frame: Frame,
    state: &mut UiState,
    out: &mut Out,
    ui: &mut Ui,
) {
    let is_new = !state.library.was_shown;
    if !state.library.picked.is_empty() {
        let frame = Frame::new().inner_margin(Margin::symmetric(0, space::S as i8));
        Panel::bottom("selected clips")
            .frame(frame)
            .show(ui, |ui| selection_ui(session, state, out, ui));
    }
    frame.show(ui, |ui| head_ui(session, true, state, out, ui));
    ScrollArea::vertical().id_salt("library").auto_shrink(false).show(ui, |ui| {
        if is_new {
            ui.scroll_to_cursor_animation(Some(Align::TOP), ScrollAnimation::none());
        }
        frame.show(ui, |ui| {
            files_ui(session, state, out, ui);
            ui.add_space(space::S);
            library_list_ui(session, state, out, ui);
        });
    });
}

/// Draws the heading with what concerns the whole library, and the row of the search.
fn head_ui(session: &Session, closes: bool, state: &mut UiState, out: &mut Out, ui: &mut Ui) {
    state.library.is_shown = true;
    let row = ui.available_rect_before_wrap();
    let header = kit::section_header_ui(text::LIBRARY, ui);
    let row = Rect::from_min_max(row.min, pos2(row.right(), header.bottom()));
    let side = theme_of(ui).row_height();
    let swaps = session.uses(Slot::A) && session.uses(Slot::B);
    let buttons = usize::from(swaps) + usize::from(closes);
    let mut inner = ui.new_child(
        UiBuilder::new()
            .id_salt("library head")
            .max_rect(Rect::from_center_size(row.center(), vec2(row.width(), side)))
            .layout(Flow::right_to_left(Align::Center)),
    );
    inner.spacing_mut().item_spacing.x = 0.0;
    if closes && kit::icon_button_ui(Icon::Close, text::CLOSE, &mut inner).clicked() {
        state.library_open = false;
    }
    if swaps {
        command_icon_ui(UiCommand::SwapClips, session, state, out, &mut inner);
    }
    let free = row.with_max_x(row.right() - buttons as f32 * side - space::XS);
    let has_notices = !session.notices().list().is_empty() || session.notices().added().is_some();
    // The chip of the notices takes the row, unless the work is at risk.
    if let Some(stored) =
        state.stored.filter(|stored| !has_notices || *stored == StorageState::Incomplete)
    {
        kit::section_mark_ui(text::stored(stored), free, ui);
    }
    let heading_end = free.left() + kit::section_header_width(text::LIBRARY, ui);
    state.notice_place = Some(NoticePlace { row: free, heading_end });
    if session.library().entries().len() >= SEARCHED_FROM {
        search_ui(state, ui);
        ui.add_space(space::XS);
    } else {
        state.library.search.clear();
    }
}

/// Draws the field of the search, and the menu of orders.
fn search_ui(state: &mut UiState, ui: &mut Ui) {
    let row = kit::paint::full_width(theme_of(ui).row_height(), ui);
    let side = row.height();
    let field = row.with_max_x(row.right() - side - space::XS);
    ui.scope_builder(UiBuilder::new().id_salt("search").max_rect(field), |ui| {
        kit::search_field_ui(text::SEARCH_CLIPS, &mut state.library.search, ui);
    });
    let place = row.with_min_x(row.right() - side);
    let mut inner = ui.new_child(UiBuilder::new().id_salt("sort").max_rect(place));
    let order = state.library.order;
    let button = Button::icon_only(Icon::Sort, text::SORT).selected(order != ClipOrder::Added);
    let opener = kit::button_ui(button, &mut inner);
    kit::menu_ui(&opener, RectAlign::BOTTOM_END, |ui| {
        for (known, words) in [
            (ClipOrder::Added, text::ORDER_ADDED),
            (ClipOrder::Name, text::ORDER_NAME),
            (ClipOrder::Length, text::ORDER_LENGTH),
            (ClipOrder::Speed, text::ORDER_SPEED),
        ] {
            let item = MenuItem {
                text: words.into(),
                chosen: Some(known == order),
                ..MenuItem::default()
            };
            if kit::menu_item_ui(item, ui).clicked() {
                state.library.order = known;
            }
        }
    });
}

/// The number of rows up to which all are drawn: a screen reader then has the whole list. Of a
/// longer list only the rows in sight are laid out.
const MAX_DRAWN_WHOLE: usize = 100;
/// The rows beyond either edge that are drawn of a long list, so that the focus finds the next one.
const ROWS_BEYOND: f32 = 3.0;

/// Draws the list of clips: first the user's, then the built-in ones.
fn library_list_ui(session: &Session, state: &mut UiState, out: &mut Out, ui: &mut Ui) {
    ui.spacing_mut().item_spacing.y = 1.0;
    let entries = session.library().entries();
    state.library.picked.retain(|id| session.library().get(id).is_some());
    let list = arranged(session, state, ui);
    let search = state.library.search.clone();
    if list.sections.is_empty() && !search.is_empty() {
        kit::note_ui(text::NO_SUCH_CLIP, palette_of(ui).muted, ui);
    }
    // A search looks into folded groups as well.
    let is_open = |section: &Section, state: &UiState| {
        let folded = &state.library.folded;
        !search.is_empty() || section.head.as_ref().is_none_or(|(key, _)| !folded.contains(key))
    };
    let arrived = arrived_clip(entries.iter().map(|entry| &**entry), ui);
    let mut rows = Vec::new();
    for section in &list.sections {
        if section.head.is_some() {
            rows.push(Row::Head(section));
        }
        let own = section.entries.iter().filter(|_| is_open(section, state));
        rows.extend(own.filter_map(|&index| entries.get(index)).map(|entry| Row::Clip(entry)));
    }
    let shown: Vec<&str> = rows.iter().filter_map(Row::clip).map(|entry| &*entry.id).collect();
    ui.scope(|ui| {
        kit::set_role(Role::List, text::LIBRARY, ui);
        let sight = ui.clip_rect().expand(ROWS_BEYOND * state.library.heights.clip);
        let draws_all = rows.len() <= MAX_DRAWN_WHOLE;
        // The height of the rows since the last one that was drawn.
        let mut left_out = 0.0;
        for row in &rows {
            let height = state.library.heights.of(row) + ui.spacing().item_spacing.y;
            let top = ui.cursor().top() + left_out;
            let is_in_sight = top <= sight.bottom() && top + height >= sight.top();
            let id = row.clip().map(|entry| entry.id.as_str());
            let is_needed = id.is_some_and(|id| {
                arrived.as_deref() == Some(id)
                    || state.library.focused.as_deref() == Some(id)
                    || state.renaming.as_ref().is_some_and(|renaming| renaming.id == id)
            });
            if !(draws_all || is_in_sight || is_needed) {
                left_out += height;
                continue;
            }
            ui.add_space(std::mem::take(&mut left_out));
            let drawn = match row {
                Row::Head(section) => {
                    head_of_section_ui(section, is_open(section, state), entries, state, ui)
                }
                Row::Clip(entry) => {
                    let row = ui.push_id(&entry.id, |ui| {
                        kit::set_role(Role::ListItem, Word::default(), ui);
                        entry_ui(entry, &shown, session, state, out, ui);
                    });
                    if arrived.as_ref() == Some(&entry.id) {
                        row.response.scroll_to_me(None);
                    }
                    row.response.rect.height()
                }
            };
            let is_plain =
                id.is_some_and(|id| state.details.as_deref() != Some(id)) && row.is_known();
            state.library.heights.note(row, is_plain, drawn);
        }
        ui.add_space(left_out);
    });
}

/// Returns the sections of the list, which are arranged again only where something has changed.
fn arranged(session: &Session, state: &mut UiState, ui: &Ui) -> Arc<Arranged> {
    let library = &state.library;
    let key = ArrangedFor {
        revision: session.revision(),
        language: state.language.tag(),
        order: library.order,
        search: library.search.clone(),
    };
    if let Some(known) = library.arranged.as_ref().filter(|known| known.key == key) {
        return Arc::clone(known);
    }
    let entries = session.library().entries();
    let sections =
        arrange(entries, library.order, &library.search, |entry| say(&entry.title(), ui));
    let list = Arc::new(Arranged { key, sections });
    state.library.arranged = Some(Arc::clone(&list));
    list
}

/// Returns the newest clip in the frame in which it arrives: it is scrolled into sight once.
fn arrived_clip<'a>(
    entries: impl DoubleEndedIterator<Item = &'a Entry>,
    ui: &Ui,
) -> Option<String> {
    let is_own = |entry: &&Entry| !matches!(entry.origin, Origin::Preset) && entry.is_known();
    let newest = entries.rev().find(is_own).map(|entry| entry.id.clone());
    let seen_id = Id::unique("newest clip seen");
    let seen: Option<Option<String>> = ui.data(|data| data.get_temp(seen_id));
    let arrived = newest.clone().filter(|_| seen.is_some_and(|seen| seen != newest));
    ui.data_mut(|data| data.insert_temp(seen_id, newest));
    arrived
}

/// Draws the head row of a group: a click folds it, with Ctrl or Cmd it selects its clips. Returns
/// its height.
fn head_of_section_ui(
    section: &Section,
    open: bool,
    entries: &[Arc<Entry>],
    state: &mut UiState,
    ui: &mut Ui,
) -> f32 {
    let Some((key, title)) = &section.head else {
        return 0.0;
    };
    let count = (!section.is_counted).then_some(section.entries.len());
    let head = ui.push_id(key, |ui| kit::group_head_ui(Text::from(title), count, open, ui));
    let height = head.response.rect.height();
    if !head.inner.clicked() {
        return height;
    }
    let library = &mut state.library;
    if ui.input(|input| input.modifiers.command) {
        let own = section.entries.iter().filter_map(|&index| entries.get(index));
        library.picked.extend(own.map(|entry| entry.id.clone()));
    } else if open {
        library.folded.insert(key.clone());
    } else {
        library.folded.remove(key);
    }
    height
}

/// Draws the button that opens the library where it is a drawer. The notices stand beside it.
pub(crate) fn library_button_ui(state: &mut UiState, ui: &mut Ui) {
    let button = Button::new(text::LIBRARY).icon(Icon::Folder).selected(state.library_open);
    let response = kit::button_ui(button, ui);
    let row = response.rect.with_max_x(ui.max_rect().right() - space::L);
    let row = row.with_min_x(response.rect.right() + space::S);
    state.notice_place.get_or_insert(NoticePlace { row, heading_end: row.left() });
    if response.clicked() {
        state.library_open = !state.library_open;
    }
}
