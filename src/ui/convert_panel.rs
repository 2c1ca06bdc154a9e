//! The panel in which many files are converted at once.

use super::kit::{self, Button, Icon};
use super::language::{Text, say};
use super::out::{Action, ConvertAction, Out};
use super::rows::format_rows_ui;
use super::state::{ConvertState, UiState};
use super::text;
use super::theme::{Type, palette_of, space, theme_of};
use eframe::egui::{self, RichText, Ui};
use segue_session::conversion::ConversionRow;
use segue_session::{Session, Slot};

/// The width of the panel, points.
const WIDTH: f32 = 460.0;
/// The lines of the table that are shown; the archive has them all.
const MAX_LINES: usize = 200;

/// Draws the panel, if it is open.
pub(super) fn convert_ui(session: &Session, state: &mut UiState, out: &mut Out, ui: &mut Ui) {
    if !state.convert.is_open {
        return;
    }
    let width = WIDTH * theme_of(ui).scale();
    let contents = |ui: &mut Ui| content_ui(session, &mut state.convert, out, ui);
    let open = kit::dialog_ui(text::CONVERT_TITLE, width, contents, ui);
    state.convert.is_open &= open;
}

fn content_ui(session: &Session, state: &mut ConvertState, out: &mut Out, ui: &mut Ui) {
    let palette = palette_of(ui);
    kit::note_ui(text::CONVERT_HELP, palette.muted, ui);
    ui.add_space(space::S);
    if let Some((share, done, all)) = state.shown.progress {
        let detail = text::files_done(done, all);
        if kit::progress_row_ui(text::CONVERTING, Some(share), &detail, ui) {
            out.actions.push(Action::Convert(ConvertAction::Stop));
        }
    } else {
        start_ui(session, state, out, ui);
    }
    table_ui(&state.shown.rows, ui);
}

/// Draws the options, and the buttons that add files and begin.
fn start_ui(session: &Session, state: &mut ConvertState, out: &mut Out, ui: &mut Ui) {
    format_rows_ui(&mut state.export, ui);
    let bodies = [(false, text::BODY_OWN), (true, text::BODY_OF_A)];
    let has_a = session.slot(Slot::A).is_some_and(|entry| entry.motion.is_some());
    state.onto_a &= has_a;
    if has_a && let Some(onto_a) = kit::choice_row_ui(text::CONVERT_BODY, state.onto_a, &bodies, ui)
    {
        state.onto_a = onto_a;
    }
    let files = [(false, text::FILE_FOR_EACH), (true, text::ONE_FILE)];
    let holds_several = state.export.format.holds_several();
    if holds_several
        && let Some(one) = kit::choice_row_ui(text::CONVERT_FILE, state.in_one_file, &files, ui)
    {
        state.in_one_file = one;
    }
    let in_one_file = state.in_one_file && holds_several;
    if in_one_file {
        kit::note_ui(text::ONE_FILE_HELP, palette_of(ui).muted, ui);
    }
    ui.add_space(space::S);
    let waiting = state.shown.waiting;
    if waiting > 0 {
        kit::note_ui(&text::files_waiting(waiting), palette_of(ui).text, ui);
    }
    ui.horizontal_wrapped(|ui| {
        let choose = Button::new(text::CHOOSE_FILES).icon(Icon::Folder);
        let choose = if waiting == 0 { choose.primary() } else { choose };
        if kit::button_ui(choose, ui).clicked() {
            out.actions.push(Action::OpenFiles);
        }
        let convert = Button::new(text::CONVERT).primary();
        if waiting > 0 && kit::button_ui(convert, ui).clicked() {
            let (how, onto_a) = (state.export, state.onto_a);
            out.actions.push(Action::Convert(ConvertAction::Start { how, onto_a, in_one_file }));
        }
        let can_clear = waiting > 0 || !state.shown.rows.is_empty();
        if can_clear && kit::button_ui(Button::new(text::CLEAR_FILES), ui).clicked() {
            out.actions.push(Action::Convert(ConvertAction::Clear));
        }
    });
}

/// Draws the results of the files: first those that failed, then those with warnings.
fn table_ui(rows: &[ConversionRow], ui: &mut Ui) {
    if rows.is_empty() {
        return;
    }
    let (theme, palette) = (theme_of(ui), palette_of(ui));
    let failed = rows.iter().filter(|row| row.output.is_err()).count();
    let odd = rows.iter().filter(|row| row.output.is_ok() && !row.odd.is_empty()).count();
    ui.add_space(space::S);
    let result = text::conversion_result(rows.len() - failed, odd, failed);
    kit::note_ui(&result, palette.text, ui);
    let rank = |row: &&ConversionRow| match (&row.output, row.odd.is_empty()) {
        (Err(_), _) => 0,
        (Ok(_), false) => 1,
        (Ok(_), true) => 2,
    };
    let mut ordered: Vec<&ConversionRow> = rows.iter().collect();
    ordered.sort_by_key(rank);
    for row in ordered.iter().take(MAX_LINES) {
        ui.add_space(space::XS);
        let name = match &row.output {
            Ok(path) => format!("{} → {path}", row.source),
            Err(_) => row.source.clone(),
        };
        let name = RichText::new(say(Text::Data(&name), ui)).font(theme.font(Type::Small));
        ui.add(egui::Label::new(name.color(palette.text)).wrap());
        if let Err(reason) = &row.output {
            kit::note_ui(reason, palette.bad, ui);
        }
        for sentence in &row.odd {
            kit::note_ui(sentence, palette.warning, ui);
        }
    }
    if rows.len() > MAX_LINES {
        kit::note_ui(&text::lines_left_out(rows.len() - MAX_LINES), palette.muted, ui);
    }
}
