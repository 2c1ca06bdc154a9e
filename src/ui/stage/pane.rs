//! The title of a pane, and its numbers or the reason why there are none.

use super::verdicts::{Verdicts, ranking};
use crate::ui::kit::{self, Metric, Mood, PaneTitle, Rank};
use crate::ui::labs::{Shown, Title, on_stage, title};
use crate::ui::language::{Word, say};
use crate::ui::out::Out;
use crate::ui::rows::remedy_buttons_ui;
use crate::ui::text;
use crate::ui::theme::{Type, palette_of, radius, space, theme_of};
use eframe::egui::{self, Align2, Frame, Rect, Ui, UiBuilder, pos2};
use segue_session::metrics::{METRICS, MetricRow, Unit};
use segue_session::{Kind, Pane, Session, Value};
use segue_text::{Message, ToMessage, msg};

/// Draws the title and the numbers of a pane. Returns the top of its numbers on the page.
pub(super) fn pane_ui(
    pane: &Pane,
    index: usize,
    verdicts: &Verdicts,
    session: &Session,
    rect: Rect,
    out: &mut Out,
    ui: &mut Ui,
) -> f32 {
    let (theme, palette) = (theme_of(ui), palette_of(ui));
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
    if let Some(problem) = &pane.problem {
        return problem_ui(&problem.to_sentence(), pane, session, rect, out, ui);
    } else if pane.outcome.is_none() {
        let jobs = session.jobs();
        let words = jobs.first().map_or(text::EMPTY_PANE.into(), text::under_way);
        let galley = kit::paint::line_of(
            &[kit::paint::Run::new(&words, Type::Body, palette.muted)],
            rect.width(),
            ui,
        );
        kit::paint::put(ui.painter(), rect.center(), Align2::CENTER_CENTER, galley);
    }
    let Some(outcome) = pane.outcome.as_deref() else {
        return rect.bottom();
    };
    let panes = session.panes();
    let room = if rect.width() < 280.0 * theme.scale() { 6 } else { METRICS.len() };
    let shown = METRICS
        .iter()
        .filter_map(|row| Some((row, outcome.metric(row.id)?, row.short?)))
        .take(room);
    let numbers: Vec<(String, Word, Rank, Word)> = shown
        .map(|(row, metric, label)| {
            let ranks = ranking(panes, row.id);
            let rank = if ranks.best == Some(index) {
                Rank::Best
            } else if ranks.worst == Some(index) {
                Rank::Worst
            } else {
                Rank::Middle
            };
            (written(row, metric.value), Word::new(label), rank, Word::new(row.help))
        })
        .collect();
    let strip: Vec<Metric<'_>> = numbers
        .iter()
        .map(|(value, label, rank, hint)| Metric { value, label: *label, rank: *rank, hint: *hint })
        .collect();
    kit::pane_footer_ui(&strip, rect, ui).top()
}

/// Draws why a pane has no result, and the buttons that help, on a plate in the place of its
/// numbers, so that the clips above it stay visible. Returns its top.
fn problem_ui(
    problem: &Message,
    pane: &Pane,
    session: &Session,
    rect: Rect,
    out: &mut Out,
    ui: &mut Ui,
) -> f32 {
    let (theme, palette) = (theme_of(ui), palette_of(ui));
    let width = (rect.width() - 2.0 * space::L).min(420.0 * theme.scale());
    let place = Rect::from_min_max(
        pos2(rect.center().x - 0.5 * width, rect.top()),
        pos2(rect.center().x + 0.5 * width, rect.bottom() - space::L),
    );
    let builder = UiBuilder::new()
        .id_salt(("problem", rect.min.x.to_bits()))
        .max_rect(place)
        .layout(egui::Layout::bottom_up(egui::Align::Center));
    let plate =
        Frame::new().fill(palette.panel_raised).corner_radius(radius::L).inner_margin(space::M);
    let shown = ui.scope_builder(builder, |ui| {
        plate.show(ui, |ui| {
            let words = egui::RichText::new(say(problem, ui)).font(theme.font(Type::Body));
            // Laid out from the bottom up.
            remedy_buttons_ui(pane, session, out, ui);
            ui.add(egui::Label::new(words.color(palette.warning)).wrap());
        })
    });
    shown.inner.response.rect.top()
}

/// Returns the value of a metric as short text.
fn written(row: &MetricRow, value: Option<f64>) -> String {
    let Some(value) = value else {
        return "–".to_owned();
    };
    let decimals = row.unit.decimals(value);
    let degree = if row.unit == Unit::Degrees { "°" } else { "" };
    let digits = format!("{value:.decimals$}");
    // A number that rounds to zero has no sign.
    let is_zero = digits.bytes().all(|byte| matches!(byte, b'-' | b'0' | b'.'));
    let digits = if is_zero { digits.trim_start_matches('-') } else { &digits };
    format!("{}{degree}", digits.replace('-', "−"))
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
