//! The editor of body parts: a picture of the body with a slot for each part, and the bones to
//! choose from.

mod bones;
mod figure;
mod slots;

use super::kit::paint::{PointerKind, pointer_in_use};
use super::kit::{self, Button, Icon};
use super::language::{Word, say};
use super::out::{Action, Out};
use super::text;
use super::theme::{Type, palette_of, space, theme_of};
use bones::{BoneDrag, BoneEvent, bones_ui};
use eframe::egui::{DragAndDrop, Id, RichText, Ui, vec2};
use figure::{FigureEvent, figure_ui, sign_of};
use segue_motion::clip::Motion;
use segue_motion::skeleton::{Role, RoleSource};
use segue_session::bone_map::{BoneMap, role_changes};
use segue_session::{Command, Entry, FileCommand, Key, Session, Value};
use segue_text::Message;

/// The state of the editor between frames.
#[derive(Clone, Debug, Default)]
pub(crate) struct BoneMapState {
    /// The clip that it was used for last, by its id.
    clip: String,
    /// The search in the list of bones.
    search: String,
    /// The search in the list of a slot.
    slot_search: String,
    /// Whether a choice on one side leaves the other side alone.
    one_side: bool,
}

/// Draws the editor of a clip's body parts.
pub(crate) fn bone_map_ui(
    entry: &Entry,
    motion: &Motion,
    session: &Session,
    state: &mut BoneMapState,
    out: &mut Out,
    ui: &mut Ui,
) {
    if state.clip != entry.id {
        *state = BoneMapState {
            clip: entry.id.clone(),
            one_side: state.one_side,
            ..BoneMapState::default()
        };
    }
    kit::note_ui(text::BODY_PARTS_HELP, palette_of(ui).muted, ui);
    let mut lights = None;
    match figure_ui(motion, &mut state.slot_search, ui) {
        Some(FigureEvent::Open(role)) => {
            lights = Some(role).filter(|&role| motion.roles().get(role).is_some());
        }
        Some(FigureEvent::Set(role, joint)) => {
            let changes = role_changes(motion, role, joint, !state.one_side);
            out.commands.push(Command::File(FileCommand::SetRoles(entry.id.clone(), changes)));
        }
        None => {}
    }
    if motion.roles().is_quadruped() {
        kit::note_ui(text::ON_FOUR_LEGS, palette_of(ui).muted, ui);
    }
    sources_ui(motion, ui);
    missing_ui(motion, ui);
    if let Some(both) = kit::helped_switch_row_ui(
        text::BOTH_SIDES,
        text::BOTH_SIDES_HELP.into(),
        !state.one_side,
        ui,
    ) {
        state.one_side = !both;
    }
    // A finger has the lists of the slots: it would scroll this one, not drag from it.
    if pointer_in_use(ui) != PointerKind::Finger && !theme_of(ui).touch {
        ui.add_space(space::S);
        match bones_ui(motion, None, &mut state.search, false, ui) {
            Some(BoneEvent::Choose(joint)) => {
                lights = joint.and_then(|joint| motion.roles().role_of(joint));
            }
            Some(BoneEvent::Drag(joint)) => DragAndDrop::set_payload(ui.ctx(), BoneDrag(joint)),
            None => {}
        }
    }
    if let Some(role) = lights {
        out.set_once(Key::Joint, Value::Text(role.name().to_owned()));
    }
    kit::note_ui(&text::clips_of_rig(clips_of_rig(entry, session, ui)), palette_of(ui).muted, ui);
    ui.horizontal(|ui| {
        ui.spacing_mut().item_spacing = vec2(space::S, space::XS);
        let save = Button::new(text::SAVE_BONES).icon(Icon::Download).hint(text::SAVE_BONES_HINT);
        if kit::button_ui(save, ui).clicked() {
            let map = BoneMap::of(motion.clip().skeleton(), motion.roles());
            out.actions.push(Action::SaveText {
                name: "bone-map.json",
                mime: "application/json",
                text: map.to_json(),
            });
        }
        let reset = Button::new(text::RESET_BONES).icon(Icon::Undo).hint(text::RESET_BONES_HINT);
        let is_changed = entry.roles_by_hand.is_some();
        if ui.add_enabled_ui(is_changed, |ui| kit::button_ui(reset, ui)).inner.clicked() {
            out.commands.push(Command::File(FileCommand::ResetRoles(entry.id.clone())));
        }
    });
}

/// Draws the number of parts by source, each with its sign: the legend of the slots.
fn sources_ui(motion: &Motion, ui: &mut Ui) {
    let palette = palette_of(ui);
    let font = theme_of(ui).font(Type::Small);
    let side = (13.0 * theme_of(ui).scale()).round();
    ui.horizontal_wrapped(|ui| {
        ui.spacing_mut().item_spacing = vec2(space::XS, space::XS);
        for source in
            [RoleSource::ByName, RoleSource::ByShape, RoleSource::ByFile, RoleSource::ByHand]
        {
            let has = |&role: &Role| motion.roles().source(role) == Some(source);
            let count = Role::ALL.into_iter().filter(has).count();
            if count == 0 {
                continue;
            }
            let (icon, words) = sign_of(source);
            let (_, at) = ui.allocate_space(vec2(side, side));
            kit::paint_icon(icon, at, figure::source_color(source, palette), ui.painter());
            let words = text::parts_of_source(count, words);
            ui.label(RichText::new(say(&words, ui)).font(font.clone()).color(palette.muted));
            ui.add_space(space::S);
        }
    });
}

/// Names the parts that feet need and that have no bone.
fn missing_ui(motion: &Motion, ui: &mut Ui) {
    let plan = motion.roles().body_plan();
    let missing: Vec<Message> = motion
        .roles()
        .missing()
        .filter(|&role| slots::is_needed(role, plan))
        .map(|role| Word::new(role.name_in(plan)).into())
        .collect();
    if !missing.is_empty() {
        kit::note_ui(&text::missing_parts(missing), palette_of(ui).warning, ui);
    }
}

/// Returns the number of clips of the rig, which is counted when the library has changed.
fn clips_of_rig(entry: &Entry, session: &Session, ui: &Ui) -> usize {
    let id = Id::unique("clips of the rig");
    let now = (entry.id.clone(), session.library_revision());
    if let Some((then, count)) = ui.data(|data| data.get_temp::<((String, u64), usize)>(id))
        && then == now
    {
        return count;
    }
    let count = session.clips_of_rig(&entry.id);
    ui.data_mut(|data| data.insert_temp(id, (now, count)));
    count
}
