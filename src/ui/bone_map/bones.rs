//! The list of a skeleton's bones, with a search.

use crate::ui::kit::paint::{PointerKind, pointer_in_use};
use crate::ui::kit::{self, MenuItem, menu_item_ui, search_field_ui, section_header_ui, set_role};
use crate::ui::language::{Text, Word, say};
use crate::ui::text;
use crate::ui::theme::{Type, palette_of, theme_of};
use eframe::egui::accesskit;
use eframe::egui::{Key, RichText, ScrollArea, Sense, Ui};
use segue_motion::clip::Motion;
use segue_motion::skeleton::Role;

/// An input to the list.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum BoneEvent {
    /// A bone was chosen, by its joint; `None` for none.
    Choose(Option<usize>),
    /// A bone is being dragged out of the list.
    Drag(usize),
}

/// A bone that is dragged from the list, by the index of its joint.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct BoneDrag(pub(super) usize);

/// The height above which the list scrolls, points.
const HEIGHT: f32 = 196.0;
/// The most bones that are listed; a search finds the others.
const MAX_LISTED: usize = 200;

/// Draws the bones, of which one has the part `chosen`. With `takes_focus`, the search gets the
/// focus.
pub(super) fn bones_ui(
    motion: &Motion,
    chosen: Option<Role>,
    search: &mut String,
    takes_focus: bool,
    ui: &mut Ui,
) -> Option<BoneEvent> {
    let mut event = None;
    match chosen {
        Some(role) => {
            let heading = text::bone_of(Word::new(role.name_in(motion.roles().body_plan())));
            let font = theme_of(ui).font(Type::Strong);
            ui.label(RichText::new(say(&heading, ui)).font(font));
        }
        None => {
            section_header_ui(text::BONES, ui);
        }
    }
    let field = search_field_ui(text::FIND_BONE, search, ui);
    if takes_focus {
        field.request_focus();
    }
    let wanted = search.trim().to_lowercase();
    let joints = motion.clip().skeleton().joints();
    let mut found =
        (0..joints.len()).filter(|&joint| joints[joint].name.to_lowercase().contains(&wanted));
    let listed: Vec<usize> = found.by_ref().take(MAX_LISTED).collect();
    let more = found.count();
    // Enter takes the first bone that the search has found.
    if field.lost_focus()
        && ui.input(|input| input.key_pressed(Key::Enter))
        && !wanted.is_empty()
        && let Some(&first) = listed.first()
    {
        event = Some(BoneEvent::Choose(Some(first)));
        search.clear();
    }
    let current = chosen.and_then(|role| motion.roles().get(role));
    let height = HEIGHT * theme_of(ui).scale();
    let area = ScrollArea::vertical().id_salt("bones").max_height(height);
    area.min_scrolled_height(height).auto_shrink([false, true]).show(ui, |ui| {
        set_role(accesskit::Role::List, text::BONES, ui);
        ui.spacing_mut().item_spacing.y = 1.0;
        if chosen.is_some() && wanted.is_empty() {
            let none = MenuItem {
                text: text::NO_BONE.into(),
                chosen: Some(current.is_none()),
                ..MenuItem::default()
            };
            if menu_item_ui(none, ui).clicked() && current.is_some() {
                event = Some(BoneEvent::Choose(None));
            }
        }
        for &joint in &listed {
            let role = motion.roles().role_of(joint);
            let plan = motion.roles().body_plan();
            let item = MenuItem {
                text: Text::Data(&joints[joint].name),
                shortcut: role.map_or(Text::EMPTY, |role| Word::new(role.name_in(plan)).into()),
                chosen: Some(current == Some(joint)),
                ..MenuItem::default()
            };
            let row = ui.push_id(joint, |ui| menu_item_ui(item, ui)).inner;
            // A finger that moves scrolls the list, and the list of a slot hides the other slots.
            let can_drag = chosen.is_none() && pointer_in_use(ui) != PointerKind::Finger;
            let row = if can_drag { row.interact(Sense::drag()) } else { row };
            if row.clicked() && (chosen.is_none() || current != Some(joint)) {
                event = Some(BoneEvent::Choose(Some(joint)));
            }
            if row.drag_started() {
                event = Some(BoneEvent::Drag(joint));
            }
        }
        if listed.is_empty() {
            kit::note_ui(text::NO_BONE_FOUND, palette_of(ui).muted, ui);
        }
        if more > 0 {
            kit::note_ui(&text::more_bones(more), palette_of(ui).muted, ui);
        }
    });
    event
}
