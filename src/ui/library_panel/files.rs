//! The way of files into the library: tasks under way, the bundled takes, and the drop zone.

use crate::ui::kit::{self, DropButton, Icon, MenuItem};
use crate::ui::language::{Text, Word, say};
use crate::ui::out::{Action, Out};
use crate::ui::state::{Layout, UiState};
use crate::ui::text;
use crate::ui::theme::{Type, palette_of, space, theme_of};
use eframe::egui::{Id, RichText, Ui};
use segue_session::{Command, FileCommand, JobKind, Origin, Session, Slot};
use segue_text::msg;

/// The share of the memory in use from which on it is shown.
const MEMORY_SHOWN_FROM: f32 = 0.25;

/// Draws the tasks under way, the bundled takes and the drop zone.
pub(super) fn files_ui(session: &Session, state: &mut UiState, out: &mut Out, ui: &mut Ui) {
    let memory = session.memory().filter(|memory| memory.share() > MEMORY_SHOWN_FROM);
    // A panel has the size of its contents in the last frame: when they grow, the frame is laid out
    // again before it is shown.
    let rows = (
        state.fetching.len(),
        session.jobs().iter().filter(|job| job.size.is_some()).count(),
        session.samples_progress().is_some(),
        state.samples_open,
        state.library.picked.is_empty(),
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
        let Some(size) = job.size else {
            continue;
        };
        let megabytes = size as f64 / 1e6;
        let detail =
            msg!("{done:.0} of {all:.0} MB", done = job.progress * megabytes, all = megabytes);
        let many = match job.kind {
            JobKind::ReadingFiles { done, all } => Some(text::files_read(done, all)),
            _ => None,
        };
        let name = many.as_ref().map_or(Text::Data(job.kind.name()), Text::from);
        if kit::progress_row_ui(name, Some(job.progress as f32), &detail, ui) {
            let stop = job.task.map_or(FileCommand::StopReadingNew, FileCommand::StopReading);
            out.commands.push(Command::File(stop));
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
        let width = ui.available_width();
        samples_ui(session, out, ui);
        ui.add_space(space::S);
        // A long line of the list makes room for itself beyond the panel.
        ui.set_max_width(width);
    }
    // Selected clips have a main action of their own.
    let is_main = state.library.picked.is_empty();
    let buttons = [
        DropButton { text: text::OPEN_FILES, is_main, is_open: false },
        DropButton { text: text::SAMPLES, is_main: false, is_open: state.samples_open },
        DropButton { text: text::CORPUS, is_main: false, is_open: false },
    ];
    let (files, corpora) = buttons.split_at(2);
    let corpora = if state.shows_corpora { corpora } else { &[] };
    // Nothing can be dropped on a phone.
    let pressed = if state.layout == Layout::Phone {
        let shown = files.len() + corpora.len();
        ui.horizontal(|ui| kit::drop_buttons_ui(&buttons[..shown], ui)).inner
    } else {
        let hot = ui.input(|input| !input.raw.hovered_files.is_empty());
        let rows: &[_] = if corpora.is_empty() { &[files] } else { &[files, corpora] };
        kit::drop_zone_ui(text::DROP_HERE, rows, hot, ui)
    };
    match pressed {
        Some(0) => out.actions.push(Action::OpenFiles),
        Some(1) => state.samples_open = !state.samples_open,
        Some(_) => out.actions.push(Action::ChooseCorpus),
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
