//! The Speed lab: two cycles blended to a speed.

use crate::ui::kit::{self, Button, Mark, Part};
use crate::ui::labs::lab_ui::{Compares, LabUi, Shown, Title};
use crate::ui::out::Out;
use crate::ui::rows::clip_sets_ui;
use crate::ui::rows::{Detail, KeepOffer, param_row_ui};
use crate::ui::rows::{foot_rows_ui, pair_ui};
use crate::ui::state::UiState;
use crate::ui::text;
use crate::ui::theme::{palette_of, space};
use eframe::egui::Ui;
use segue_session::metrics::MetricId;
use segue_session::{Compare, CycleMade, Key, Session, Value};
use segue_text::{Message, msg};

/// The lab's part of the page.
pub(super) const LAB: LabUi = LabUi {
    panel_ui: speed_ui,
    about: [text::SPEED_ABOUT, text::SPEED_DETAILS],
    kept: |_, pane| KeepOffer::result(pane),
    compares: Compares::Own(compare_speeds),
    title,
    hint: |_| None,
    take_line: None,
};

fn title(shown: &Shown<'_>) -> Title {
    // The speed of the result, as in the metrics: a cycle of whole frames does not always have the
    // requested speed.
    let outcome = shown.pane.outcome.as_ref();
    let reached = outcome.and_then(|outcome| outcome.metric(MetricId::Speed)?.value);
    Title {
        strong: shown.name(Key::A),
        text: msg!("~ {clip}", clip = shown.name(Key::B)),
        secondary: reached.map_or_else(Message::default, |mps| msg!("{mps:.2} m/s", mps)),
    }
}

/// The upper end of the slider before the clips are known, metres per second.
const SLIDER_MPS: f64 = 6.0;
/// The upper end of the slider as a multiple of the faster clip's speed.
const SLIDER_BEYOND: f64 = 1.6;

/// Draws the rows of the lab.
pub(super) fn speed_ui(session: &Session, _: &mut UiState, out: &mut Out, ui: &mut Ui) {
    clip_sets_ui(session, out, ui);
    pair_ui(session, out, ui);
    let palette = palette_of(ui);
    let made = session.main_outcome().and_then(|outcome| outcome.cycle).map(|cycle| cycle.made);
    let mut detail = Detail { max: Some(SLIDER_MPS), ..Detail::default() };
    let mut warning = None;
    if let Some(CycleMade::Gait { facts, clips_mps, cuts_secs, .. }) = made {
        let mark = |part: Part, value| Mark { value, color: part.fill(palette).0 };
        detail.marks = vec![mark(Part::A, clips_mps[0]), mark(Part::B, clips_mps[1])];
        detail.more = Some(text::gaits(clips_mps, cuts_secs));
        detail.note = Some(text::gait_speeds(clips_mps));
        let most = clips_mps[0].max(clips_mps[1]);
        detail.max = Some((SLIDER_BEYOND * most).max(session.params().number(Key::Speed)));
        warning = text::beyond_gaits(&facts, clips_mps);
    }
    param_row_ui(Key::Speed, &detail, session, out, ui);
    if let (Some(warning), None) = (warning, session.compare()) {
        kit::note_ui(&warning, palette.warning, ui);
    }
    let on = session.compare().is_some_and(|compare| compare.key == Key::Speed);
    // The rows of the compared values have the way back.
    if !on && kit::button_ui(Button::new(text::THREE_SPEEDS), ui).clicked() {
        compare_speeds(session, out);
    }
    ui.add_space(space::S);
    param_row_ui(Key::PhaseAlign, &Detail::default(), session, out, ui);
    foot_rows_ui(session, out, ui);
}

/// Opens the speed of A, that of B and the one between them side by side, or goes back to one pane.
pub(super) fn compare_speeds(session: &Session, out: &mut Out) {
    let on = session.compare().is_some_and(|compare| compare.key == Key::Speed);
    let made = session.main_outcome().and_then(|outcome| outcome.cycle).map(|cycle| cycle.made);
    let query = match made {
        Some(CycleMade::Gait { clips_mps: [a, b], .. }) if !on => {
            let words = [a, 0.5 * (a + b), b]
                .map(|speed| Key::Speed.param().check(Value::Number(speed)).ok());
            let words: Vec<String> =
                words.iter().flatten().map(|speed| Key::Speed.param().format(speed)).collect();
            format!("{}:{}", Key::Speed.param().name, words.join(","))
        }
        _ => String::new(),
    };
    out.compare(Compare::parse(&query).ok());
}
