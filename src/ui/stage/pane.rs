//! The title of a pane, and the reason why it has no result.

use super::verdicts::Verdicts;
use crate::ui::kit::{self, Mood, PaneTitle};
use crate::ui::labs::{Shown, Title, on_stage, title};
use crate::ui::language::{Word, say};
use crate::ui::out::Out;
use crate::ui::rows::remedy_buttons_ui;
use crate::ui::text;
use crate::ui::theme::{Type, palette_of, radius, space, theme_of};
use eframe::egui::{self, Align2, Frame, Rect, Ui, UiBuilder};
use segue_session::{Kind, LabError, Pane, Session, Value};
use segue_text::{Message, ToMessage, msg};

/// Draws the title of a pane, and, where no figure stands, why.
pub(super) fn pane_ui(
    pane: &Pane,
    index: usize,
    verdicts: Verdicts,
    session: &Session,
    rect: Rect,
    out: &mut Out,
    ui: &mut Ui,
) {
    let palette = palette_of(ui);
    let Title { strong, text, secondary } = pane_words(pane, session);
    if pane.is_outdated() {
        // The picture is outdated.
        ui.painter().rect_filled(rect, 0.0, palette.stage.sky.gamma_multiply(0.55));
    }
    let (chip, mood) = if pane.is_outdated() {
        (text::OUTDATED, Mood::Warning)
    } else if verdicts.best == Some(index) {
        (text::SMOOTHEST, Mood::Good)
    } else if verdicts.worst == Some(index) {
        (text::ROUGHEST, Mood::Bad)
    } else if let Some(warning) = on_stage::warning(session, pane) {
        (warning, Mood::Warning)
    } else {
        (Word::default(), Mood::default())
    };
    let title = PaneTitle { strong: &strong, text: &text, secondary: &secondary, chip, mood };
    kit::pane_header_ui(&title, rect, ui);
    if let Some(problem) = pane.problem.as_ref().filter(|_| problem_below(pane).is_none()) {
        problem_plate_ui(problem, pane, session, rect, out, ui);
    } else if pane.problem.is_none() && pane.outcome.is_none() {
        let jobs = session.jobs();
        let words = jobs.first().map_or(text::EMPTY_PANE.into(), text::under_way);
        let galley = kit::paint::line_of(
            &[kit::paint::Run::new(&words, Type::Body, palette.muted)],
            rect.width(),
            ui,
        );
        kit::paint::put(ui.painter(), rect.center(), Align2::CENTER_CENTER, galley);
    }
}

/// Returns why a pane has no result, if that is said below it: where the clips stand from which it
/// would be made, no sentence may cover them.
pub(super) fn problem_below(pane: &Pane) -> Option<&LabError> {
    pane.problem.as_ref().filter(|_| !pane.sources.is_empty())
}

/// Draws why a pane has no result on a plate in the middle of it.
fn problem_plate_ui(
    problem: &LabError,
    pane: &Pane,
    session: &Session,
    rect: Rect,
    out: &mut Out,
    ui: &mut Ui,
) {
    let width = (rect.width() - 2.0 * space::L).min(420.0 * theme_of(ui).scale());
    let place = Rect::from_center_size(rect.center(), egui::vec2(width, rect.height() * 0.6));
    let builder = UiBuilder::new()
        .id_salt(("problem", rect.min.x.to_bits()))
        .max_rect(place)
        .layout(egui::Layout::centered_and_justified(egui::Direction::TopDown));
    let plate = Frame::new()
        .fill(palette_of(ui).panel_raised)
        .corner_radius(radius::L)
        .inner_margin(space::M);
    ui.scope_builder(builder, |ui| {
        ui.vertical_centered(|ui| plate.show(ui, |ui| problem_ui(problem, pane, session, out, ui)));
    });
}

/// Returns the least height of [`problem_ui`] in a width.
pub(super) fn problem_height(problem: &LabError, width: f32, ui: &Ui) -> f32 {
    let ink = palette_of(ui).warning;
    kit::paint::paragraph(&problem.to_sentence(), Type::Body, ink, width, ui).size().y
}

/// Draws why there is no result, and the buttons that help.
pub(super) fn problem_ui(
    problem: &LabError,
    pane: &Pane,
    session: &Session,
    out: &mut Out,
    ui: &mut Ui,
) {
    let (font, ink) = (theme_of(ui).font(Type::Body), palette_of(ui).warning);
    let words = egui::RichText::new(say(&problem.to_sentence(), ui)).font(font);
    ui.add(egui::Label::new(words.color(ink)).wrap());
    remedy_buttons_ui(pane, session, out, ui);
}

/// Returns the title of a pane: the value in which it differs, or the title of its lab.
fn pane_words(pane: &Pane, session: &Session) -> Title {
    let fps = pane.outcome.as_ref().map_or(60.0, |outcome| outcome.motion.clip().fps());
    // The parameters of the result on the stage, which may be earlier ones; else the present ones.
    let params = pane.made_from().unwrap_or(session.params());
    if let Some((key, value)) = pane.compared() {
        let param = key.param();
        if matches!(param.kind, Kind::Clip) {
            let strong = session.variant_name(pane).unwrap_or_default();
            return Title { strong, ..Title::default() };
        }
        let secondary = match value {
            Value::Number(frames) if param.unit == "frames" => {
                msg!("{secs:.2} s", secs = frames / fps)
            }
            // A bare number needs its label.
            Value::Number(_) if param.unit.is_empty() => param.label.into(),
            _ => Message::default(),
        };
        return Title { strong: param.spoken(value), text: param.unit.into(), secondary };
    }
    title(&Shown { pane, params, session })
}
