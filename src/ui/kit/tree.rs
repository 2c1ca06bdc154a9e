//! A hierarchy of items, one of them chosen, such as the joints of a skeleton.

use super::assistive::describe;
use super::icon::{Icon, paint_icon};
use super::paint::{Run, faded, focus_ring, line_of, put};
use crate::ui::language::{Text, Word, say};
use crate::ui::theme::{HIT, Type, palette_of, radius, space, theme_of};
use eframe::egui::accesskit::Action;
use eframe::egui::{
    Align2, CursorIcon, EventFilter, Id, Key, Rect, Response, Role, ScrollArea, Sense, Ui,
    WidgetInfo, pos2, style::ScrollAnimation, vec2,
};
use segue_text::Message;
use std::collections::BTreeSet;

/// A hierarchy. Parents stand before their children; roots have none.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Tree<'a> {
    /// Its accessible name.
    pub(crate) label: Word,
    /// The parent of every item.
    pub(crate) parents: &'a [Option<usize>],
    /// The chosen item.
    pub(crate) chosen: Option<usize>,
    /// The height above which it scrolls, points.
    pub(crate) max_height: f32,
}

/// The content of a row.
#[derive(Clone, Debug, Default)]
pub(crate) struct TreeRow {
    /// The item's name.
    pub(crate) name: String,
    /// The word at the right end.
    pub(crate) detail: Word,
    /// The hint.
    pub(crate) hint: Message,
}

/// A row whose ancestors are unfolded.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Open {
    item: usize,
    depth: usize,
    has_children: bool,
}

/// The greatest indent: the many levels of fingers would leave no room for names.
const MAX_INDENTS: usize = 9;

/// Draws a tree as wide as the panel. Only the rows in sight are laid out, with the content that
/// `row_of` returns. Returns a new choice.
///
/// While a row has the focus, up and down choose the next one; left and right fold it, unfold it,
/// and go to its parent or first child.
pub(crate) fn tree_ui(
    tree: &Tree<'_>,
    row_of: impl Fn(usize) -> TreeRow,
    ui: &mut Ui,
) -> Option<usize> {
    let id = ui.make_persistent_id(tree.label.english());
    let mut folded: BTreeSet<usize> = ui.data_mut(|data| data.get_temp(id)).unwrap_or_default();
    let rows = open_rows(tree.parents, &folded);
    let height = (HIT * theme_of(ui).scale()).max(theme_of(ui).hit()).round();
    let focused =
        rows.iter().position(|row| ui.memory(|memory| memory.has_focus(id.with(row.item))));
    // An item that was chosen elsewhere is scrolled into sight.
    let seen: Option<Option<usize>> = ui.data(|data| data.get_temp(id.with("seen")));
    let news = tree.chosen.filter(|chosen| seen != Some(Some(*chosen)));
    ui.data_mut(|data| data.insert_temp(id.with("seen"), tree.chosen));
    let mut event = None;
    ui.scope(|ui| {
        ui.spacing_mut().item_spacing.y = 0.0;
        let area = ScrollArea::vertical()
            .id_salt(id)
            .min_scrolled_height(tree.max_height)
            .max_height(tree.max_height)
            .auto_shrink([false, true]);
        let shown = area.show_rows(ui, height, rows.len(), |ui, range| {
            let name = say(tree.label, ui);
            describe(&ui.response(), &WidgetInfo::labeled(Role::Tree, true, name));
            let (_, space) =
                ui.allocate_space(vec2(ui.available_width(), height * range.len() as f32));
            let place = |index: usize| {
                let top = space.top() + (index as f32 - range.start as f32) * height;
                Rect::from_min_size(pos2(space.left(), top), vec2(space.width(), height))
            };
            // The row with the focus stays, even scrolled out of sight.
            let out_of_sight = focused.filter(|index| !range.contains(index));
            for index in range.clone().chain(out_of_sight) {
                let row = rows[index];
                let is_chosen = tree.chosen == Some(row.item);
                let response = row_ui(
                    row,
                    &row_of(row.item),
                    is_chosen,
                    folded.contains(&row.item),
                    place(index),
                    id,
                    ui,
                );
                event = event_of(&rows, index, &folded, &response, place(index), ui).or(event);
            }
            let goal = match event {
                Some(Event::Choose(item)) => Some(item),
                _ => news,
            };
            if let Some(index) = goal.and_then(|item| rows.iter().position(|row| row.item == item))
            {
                ui.scroll_to_rect_animation(place(index), None, ScrollAnimation::none());
            }
        });
        if matches!(event, Some(Event::Choose(_))) {
            // The panel around it scrolls as well.
            ui.scroll_to_rect_animation(shown.inner_rect, None, ScrollAnimation::none());
        }
    });
    match event? {
        Event::Fold(item) => {
            if !folded.remove(&item) {
                folded.insert(item);
            }
            ui.data_mut(|data| data.insert_temp(id, folded));
            None
        }
        Event::Choose(item) => {
            ui.memory_mut(|memory| memory.request_focus(id.with(item)));
            ui.data_mut(|data| data.insert_temp(id.with("seen"), Some(item)));
            Some(item).filter(|_| tree.chosen != Some(item))
        }
    }
}

#[derive(Clone, Copy, Debug)]
enum Event {
    Choose(usize),
    /// Folds an unfolded item, and unfolds a folded one.
    Fold(usize),
}

/// Returns the rows whose ancestors are all unfolded, each parent followed by its descendants. It
/// does not recurse: files may nest to any depth.
fn open_rows(parents: &[Option<usize>], folded: &BTreeSet<usize>) -> Vec<Open> {
    let mut children: Vec<Vec<usize>> = vec![Vec::new(); parents.len()];
    let mut waiting = Vec::new();
    for (item, parent) in parents.iter().enumerate() {
        match parent.and_then(|parent| children.get_mut(parent)) {
            Some(siblings) => siblings.push(item),
            None => waiting.push((item, 0)),
        }
    }
    waiting.reverse();
    let mut rows = Vec::with_capacity(parents.len());
    while let Some((item, depth)) = waiting.pop() {
        rows.push(Open { item, depth, has_children: !children[item].is_empty() });
        if !folded.contains(&item) {
            waiting.extend(children[item].iter().rev().map(|&child| (child, depth + 1)));
        }
    }
    rows
}

fn event_of(
    rows: &[Open],
    index: usize,
    folded: &BTreeSet<usize>,
    response: &Response,
    rect: Rect,
    ui: &Ui,
) -> Option<Event> {
    let row = rows[index];
    let is_folded = folded.contains(&row.item);
    if response.clicked() {
        let pointer = response.interact_pointer_pos();
        let on_chevron = row.has_children
            && pointer.is_some_and(|at| at.x < chevron_of(row, rect).right() + 2.0);
        return Some(if on_chevron { Event::Fold(row.item) } else { Event::Choose(row.item) });
    }
    let asked = |action| ui.input(|input| input.has_accesskit_action_request(response.id, action));
    if row.has_children
        && (asked(Action::Expand) && is_folded || asked(Action::Collapse) && !is_folded)
    {
        return Some(Event::Fold(row.item));
    }
    if !response.has_focus() {
        return None;
    }
    let filter =
        EventFilter { horizontal_arrows: true, vertical_arrows: true, ..EventFilter::default() };
    ui.memory_mut(|memory| memory.set_focus_lock_filter(response.id, filter));
    let pressed = |key| ui.input(|input| input.key_pressed(key));
    let at = |index: Option<usize>| {
        index.and_then(|index| rows.get(index)).map(|row| Event::Choose(row.item))
    };
    let unfolded = row.has_children && !is_folded;
    if pressed(Key::ArrowDown) {
        at(Some(index + 1))
    } else if pressed(Key::ArrowUp) {
        at(index.checked_sub(1))
    } else if pressed(Key::Home) {
        at(Some(0))
    } else if pressed(Key::End) {
        at(rows.len().checked_sub(1))
    } else if pressed(Key::ArrowRight) && row.has_children {
        if unfolded { at(Some(index + 1)) } else { Some(Event::Fold(row.item)) }
    } else if pressed(Key::ArrowLeft) {
        let parent = || rows[..index].iter().rposition(|above| above.depth < row.depth);
        if unfolded { Some(Event::Fold(row.item)) } else { at(parent()) }
    } else {
        None
    }
}

/// Returns the place of the sign that folds a row.
fn chevron_of(row: Open, rect: Rect) -> Rect {
    let step = rect.height() * 0.42;
    let left = rect.left() + space::XS + step * row.depth.min(MAX_INDENTS) as f32;
    Rect::from_min_size(pos2(left, rect.top()), vec2(rect.height() * 0.6, rect.height()))
}

fn row_ui(
    row: Open,
    says: &TreeRow,
    is_chosen: bool,
    is_folded: bool,
    rect: Rect,
    id: Id,
    ui: &Ui,
) -> Response {
    let palette = palette_of(ui);
    let enabled = ui.is_enabled();
    let response = ui
        .interact(rect, id.with(row.item), Sense::click())
        .on_hover_cursor(CursorIcon::PointingHand);
    let hot = response.hovered() || response.has_focus();
    if is_chosen {
        ui.painter().rect_filled(rect, radius::S, palette.accent_wash);
    } else if hot {
        ui.painter().rect_filled(rect, radius::S, palette.hover);
    }
    let chevron = chevron_of(row, rect);
    if row.has_children {
        let sign = if is_folded { Icon::ChevronRight } else { Icon::ChevronDown };
        let size = (rect.height() * 0.5).round();
        let at = Rect::from_center_size(chevron.center(), vec2(size, size));
        paint_icon(
            sign,
            at,
            faded(if hot { palette.text } else { palette.muted }, enabled),
            ui.painter(),
        );
    }
    let detail = line_of(
        &[Run::new(says.detail, Type::Small, faded(palette.muted, enabled))],
        rect.width() * 0.5,
        ui,
    );
    let right = put(
        ui.painter(),
        pos2(rect.right() - space::S, rect.center().y),
        Align2::RIGHT_CENTER,
        detail,
    );
    let (step, ink) =
        if is_chosen { (Type::Strong, palette.accent_ink) } else { (Type::Body, palette.text) };
    let left = chevron.right() + 2.0;
    let name = line_of(
        &[Run::new(Text::Data(&says.name), step, faded(ink, enabled))],
        right.left() - space::S - left,
        ui,
    );
    put(ui.painter(), pos2(left, rect.center().y), Align2::LEFT_CENTER, name);
    focus_ring(rect.shrink(2.0), radius::S, &response, ui);
    let said = if says.detail.is_empty() {
        says.name.clone()
    } else {
        format!("{}, {}", says.name, say(says.detail, ui))
    };
    describe(&response, &WidgetInfo::labeled(Role::TreeItem, enabled, said));
    response.ctx.accesskit_node_builder(response.id, |node| {
        node.set_selected(is_chosen);
        node.set_level(row.depth + 1);
        if row.has_children {
            node.set_expanded(!is_folded);
            node.add_action(if is_folded { Action::Expand } else { Action::Collapse });
        }
    });
    if says.hint.is_empty() { response } else { response.on_hover_text(say(&says.hint, ui)) }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Parents first, but not each followed by its own: 0 > (1 > 3, 2 > 4 > 5).
    const PARENTS: [Option<usize>; 6] = [None, Some(0), Some(0), Some(1), Some(2), Some(4)];

    #[test]
    fn every_parent_is_followed_by_all_below_it() {
        let rows = |folded: &[usize]| -> Vec<(usize, usize)> {
            let open = open_rows(&PARENTS, &folded.iter().copied().collect());
            open.iter().map(|row| (row.item, row.depth)).collect()
        };
        assert_eq!(rows(&[]), [(0, 0), (1, 1), (3, 2), (2, 1), (4, 2), (5, 3)]);
        assert_eq!(rows(&[1, 4]), [(0, 0), (1, 1), (2, 1), (4, 2)]);
        assert_eq!(rows(&[0]), [(0, 0)]);
        // A parent that is not there makes a root; deep chains need no stack.
        assert_eq!(open_rows(&[None, Some(9)], &BTreeSet::new()).len(), 2);
        let chain: Vec<Option<usize>> =
            (0..100_000).map(|item: usize| item.checked_sub(1)).collect();
        assert_eq!(open_rows(&chain, &BTreeSet::new()).last().map(|row| row.depth), Some(99_999));
    }
}
