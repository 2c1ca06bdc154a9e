//! The left panel: the library of clips.

use super::clip_panel::clip_panel_ui;
use super::kit::{self, Button, ClipRow, Icon, MenuItem, Part};
use super::labs::compare_clips;
use super::language::{Text, Word, say};
use super::out::{Action, Out};
use super::state::{Typing, UiState};
use super::text;
use super::theme::{Type, palette_of, space, theme_of};
use eframe::egui::accesskit::Role;
use eframe::egui::{self, Frame, Id, Key as Keyboard, Margin, Panel, RichText, ScrollArea, Ui};
use segue_session::export::{ExportFormat, ExportOptions};
use segue_session::{Command, Entry, FileCommand, Key, Origin, Session, Slot};
use segue_text::{Message, msg};

/// The share of the memory in use from which on it is shown.
const MEMORY_SHOWN_FROM: f32 = 0.25;

/// Draws the panel: the list, and below it, always in sight, the drop zone.
pub(crate) fn library_panel_ui(session: &Session, state: &mut UiState, out: &mut Out, ui: &mut Ui) {
    let frame = Frame::new().inner_margin(Margin { top: space::S as i8, ..Margin::ZERO });
    Panel::bottom("drop files here")
        .frame(frame)
        .show_separator_line(false)
        .show(ui, |ui| drop_ui(session, state, out, ui));
    ScrollArea::vertical()
        .auto_shrink(false)
        .show(ui, |ui| library_list_ui(session, state, out, ui));
}

/// Draws the list of clips: first the user's, then the built-in ones.
pub(crate) fn library_list_ui(session: &Session, state: &mut UiState, out: &mut Out, ui: &mut Ui) {
    let header = kit::section_header_ui(text::LIBRARY, ui);
    if let Some(stored) = state.stored {
        kit::section_mark_ui(text::stored(stored), header, ui);
    }
    ui.spacing_mut().item_spacing.y = 1.0;
    let entries = session.library().entries();
    let is_built_in = |entry: &Entry| matches!(entry.origin, Origin::Preset);
    let ordered = entries
        .iter()
        .filter(|entry| !is_built_in(entry))
        .chain(entries.iter().filter(|entry| is_built_in(entry)));
    // The newest clip is scrolled into sight once.
    let newest = entries
        .iter()
        .rfind(|entry| !is_built_in(entry) && entry.motion.is_some())
        .map(|entry| entry.id.clone());
    let seen_id = Id::unique("newest clip seen");
    let seen: Option<Option<String>> = ui.data(|data| data.get_temp(seen_id));
    let arrived = newest.clone().filter(|_| seen.is_some_and(|seen| seen != newest));
    ui.data_mut(|data| data.insert_temp(seen_id, newest));
    ui.scope(|ui| {
        kit::set_role(Role::List, text::LIBRARY, ui);
        for entry in ordered {
            let row = ui.push_id(&entry.id, |ui| {
                kit::set_role(Role::ListItem, Word::default(), ui);
                entry_ui(entry, session, state, out, ui);
            });
            if arrived.as_ref() == Some(&entry.id) {
                row.response.scroll_to_me(None);
            }
        }
    });
}

/// Draws the tasks under way, the bundled takes and the drop zone.
pub(crate) fn drop_ui(session: &Session, state: &mut UiState, out: &mut Out, ui: &mut Ui) {
    let memory = session.memory().filter(|memory| memory.share() > MEMORY_SHOWN_FROM);
    // A panel has the size of its contents in the last frame: when they grow, the frame is laid out
    // again before it is shown.
    let rows = (
        state.fetching.len(),
        session.jobs().iter().filter(|job| job.size.is_some()).count(),
        session.samples_progress().is_some(),
        state.samples_open,
        memory.is_some(),
    );
    let rows_id = Id::unique("rows of the drop zone");
    if ui.data_mut(|data| std::mem::replace(data.get_temp_mut_or_default(rows_id), rows)) != rows {
        ui.ctx().request_discard("drop_zone");
    }
    for (name, done) in &state.fetching {
        let detail = done.map_or_else(String::new, |done| format!("{:.0} %", done * 100.0));
        if kit::progress_row_ui(
            Text::Data(name),
            done.map(|done| done as f32),
            Text::Data(&detail),
            ui,
        ) {
            out.actions.push(Action::StopFetching(name.clone()));
        }
    }
    for job in session.jobs() {
        let (Some(task), Some(size)) = (job.task, job.size) else {
            continue;
        };
        let megabytes = size as f64 / 1e6;
        let detail =
            msg!("{done:.0} of {all:.0} MB", done = job.progress * megabytes, all = megabytes);
        let name = Text::Data(job.kind.name());
        if kit::progress_row_ui(name, Some(job.progress as f32), &detail, ui) {
            out.commands.push(Command::File(FileCommand::StopReading(task)));
        }
    }
    if let Some((come, asked)) = session.samples_progress() {
        let detail = format!("{come} / {asked}");
        let share = come as f32 / asked as f32;
        kit::brief_progress_ui(text::LOADING_SAMPLES, share, Text::Data(&detail), ui);
    }
    if let Some(memory) = memory {
        kit::brief_progress_ui(text::MEMORY, memory.share(), &text::memory(memory), ui);
    }
    if state.samples_open {
        samples_ui(session, out, ui);
        ui.add_space(space::S);
    }
    let hot = ui.input(|input| !input.raw.hovered_files.is_empty());
    match kit::drop_zone_ui(text::DROP_HERE, &[text::OPEN_FILES, text::SAMPLES], hot, ui) {
        Some(0) => out.actions.push(Action::OpenFiles),
        Some(_) => state.samples_open = !state.samples_open,
        None => {}
    }
}

fn samples_ui(session: &Session, out: &mut Out, ui: &mut Ui) {
    let (theme, palette) = (theme_of(ui), palette_of(ui));
    for set in Session::sample_sets() {
        let text = Word::new(set.label).into();
        let item = MenuItem { text, icon: Some(Icon::Download), ..MenuItem::default() };
        if kit::menu_item_ui(item, ui).clicked() {
            out.commands.push(Command::File(FileCommand::LoadSamples(set)));
        }
    }
    for sample in Session::samples() {
        let text = Word::new(sample.label).into();
        let item = MenuItem { text, icon: Some(Icon::Download), ..MenuItem::default() };
        if kit::menu_item_ui(item, ui).clicked() {
            out.commands.push(Command::Assign(free_slot(session), sample.id.to_owned()));
        }
    }
    ui.add_space(space::XS);
    ui.label(
        RichText::new(say(Word::new(segue_session::SAMPLES_CREDIT), ui))
            .font(theme.font(Type::Small))
            .color(palette.muted),
    );
}

/// Returns the slot for a new clip: A, or B where A has a clip of the user's and B has none.
fn free_slot(session: &Session) -> Slot {
    let built_in =
        |slot| session.slot(slot).is_none_or(|entry| matches!(entry.origin, Origin::Preset));
    if !session.uses(Slot::B) || built_in(Slot::A) || !built_in(Slot::B) {
        Slot::A
    } else {
        Slot::B
    }
}

fn part_of(session: &Session, entry: &Entry) -> Part {
    let holds = |slot| session.slot(slot).is_some_and(|held| held.id == entry.id);
    if holds(Slot::A) && session.uses(Slot::A) {
        Part::A
    } else if holds(Slot::B) && session.uses(Slot::B) {
        Part::B
    } else {
        Part::None
    }
}

/// Returns the facts below the name of a clip: `3.9 s · 468 frames · 30 joints`.
fn facts(entry: &Entry) -> Message {
    match &entry.motion {
        Some(motion) => {
            let clip = motion.clip();
            msg!(
                "{secs:.1} s · {frames} frames · {joints} joints",
                secs = clip.duration_secs(),
                frames = clip.frames(),
                joints = clip.skeleton().len()
            )
        }
        None => text::status(entry).into(),
    }
}

fn entry_ui(entry: &Entry, session: &Session, state: &mut UiState, out: &mut Out, ui: &mut Ui) {
    if let Some(renaming) = state.renaming.as_mut().filter(|renaming| renaming.id == entry.id) {
        let field =
            kit::text_field_ui(text::RENAME, Text::Data(&entry.name), &mut renaming.text, ui);
        field.response.request_focus();
        if field.committed {
            out.commands.push(Command::Rename(entry.id.clone(), renaming.text.clone()));
        }
        if field.committed || ui.input(|input| input.key_pressed(Keyboard::Escape)) {
            state.renaming = None;
        }
        return;
    }
    let part = part_of(session, entry);
    let open = state.details.as_ref() == Some(&entry.id);
    let blending = session.uses(Slot::B);
    let warnings: Vec<String> = entry.warnings.iter().map(|warning| say(warning, ui)).collect();
    let warning = warnings.join("\n");
    let actions =
        [(Icon::Sliders, text::DETAILS), (Icon::Pencil, text::RENAME), (Icon::Trash, text::REMOVE)];
    let (name, facts) = (entry.title(), facts(entry));
    let row = ClipRow {
        name: (&name).into(),
        detail: (&facts).into(),
        part,
        warning: Text::Data(&warning),
        selected: open,
        actions: &actions,
    };
    let response = kit::clip_row_ui(row, ui);
    match response.action {
        Some(0) => state.details = if open { None } else { Some(entry.id.clone()) },
        Some(1) => {
            state.renaming = Some(Typing { id: entry.id.clone(), text: entry.name.clone() });
        }
        Some(_) => out.commands.push(Command::Remove(entry.id.clone())),
        None if response.clicked || response.badge_clicked => {
            // With two slots, a click assigns the clip to A, or to B if it is in A.
            let slot = if blending && part == Part::A { Slot::B } else { Slot::A };
            out.commands.push(Command::Assign(slot, entry.id.clone()));
        }
        None => {}
    }
    let menu = egui::Popup::context_menu(&response.response);
    menu.show(|ui| {
        for slot in [Slot::A, Slot::B] {
            let words = if slot == Slot::A { text::USE_AS_A } else { text::USE_AS_B };
            if kit::menu_item_ui(MenuItem { text: words.into(), ..MenuItem::default() }, ui)
                .clicked()
            {
                out.commands.push(Command::Assign(slot, entry.id.clone()));
            }
        }
        let text = text::COMPARE_WITH_A.into();
        let compare = MenuItem { text, icon: Some(Icon::Swap), ..MenuItem::default() };
        if part != Part::A && kit::menu_item_ui(compare, ui).clicked() {
            compare_clips(session.params().text(Key::A), &entry.id, out);
        }
        for format in ExportFormat::ALL {
            let words = msg!("Save as {format}", format = text::format(format));
            let text = Text::from(&words);
            let save = MenuItem { text, icon: Some(Icon::Download), ..MenuItem::default() };
            if kit::menu_item_ui(save, ui).clicked() {
                let how = ExportOptions { format, ..state.export };
                out.actions.push(Action::Save { which: entry.id.clone(), how });
            }
        }
    });
    if open {
        let card = Frame::new().inner_margin(Margin { left: 10, right: 4, top: 6, bottom: 10 });
        card.show(ui, |ui| {
            ui.spacing_mut().item_spacing.y = space::XS;
            clip_panel_ui(entry, Some(&entry.id), session, state, out, ui);
        });
    }
}

/// Draws the button that opens the library where it is a drawer.
pub(crate) fn library_button_ui(state: &mut UiState, ui: &mut Ui) {
    if kit::button_ui(
        Button::new(text::LIBRARY).icon(Icon::Folder).selected(state.library_open),
        ui,
    )
    .clicked()
    {
        state.library_open = !state.library_open;
    }
}
