//! The Blend lab: the window, its place and its weight.

use crate::ui::labs::lab_ui::{Compares, Edge, LabUi, Shown, Title};
use crate::ui::language::Word;
use crate::ui::out::Out;
use crate::ui::rows::{
    Detail, KeepOffer, blend_window_ui, compare_ui, foot_rows_ui, pair_ui, param_row_ui,
    place_rows_ui,
};
use crate::ui::state::UiState;
use crate::ui::text;
use crate::ui::theme::space;
use eframe::egui::Ui;
use segue_session::{Key, LabId, Outcome, Session};
use segue_text::msg;

/// The lab's part of the page.
pub(super) const LAB: LabUi = LabUi {
    panel_ui: blend_ui,
    about: [text::BLEND_ABOUT, text::BLEND_DETAILS],
    kept: |_, pane| KeepOffer::result(pane),
    compares: Compares::Key(Key::BlendWindow),
    title,
    hint: welcome,
    take_line: None,
};

fn title(shown: &Shown<'_>) -> Title {
    Title {
        strong: shown.name(Key::A),
        text: msg!("→ {clip}", clip = shown.name(Key::B)),
        secondary: msg!(
            "{count, plural, one {# frame} other {# frames}}",
            count = shown.params.number(Key::BlendWindow) as i64
        ),
    }
}

/// Returns the hint for first visitors while it applies to the stage.
pub(crate) fn welcome(session: &Session) -> Option<Word> {
    is_welcome(session).then_some(text::WELCOME_HINT)
}

/// Returns whether the hint for first visitors applies: the stage compares windows of the built-in
/// walk and run.
fn is_welcome(session: &Session) -> bool {
    let shown = |key, id| session.params().text(key) == id;
    session.params().lab() == LabId::Blend
        && shown(Key::A, "walk")
        && shown(Key::B, "run")
        && session.compare().is_some_and(|compare| compare.key == Key::BlendWindow)
}

/// Returns the value that dragging an end of the transition to a time sets.
pub(super) fn edge_value(edge: Edge, secs: f64, outcome: &Outcome) -> (Key, f64) {
    match edge {
        // The result runs on A's time up to the window.
        Edge::Start => (Key::LeaveA, secs.max(0.0)),
        Edge::End => {
            let start = outcome.transition.map_or(0.0, |found| found.start_secs);
            (Key::BlendWindow, (secs - start) * outcome.motion.clip().fps())
        }
    }
}

pub(super) fn blend_ui(session: &Session, _: &mut UiState, out: &mut Out, ui: &mut Ui) {
    pair_ui(session, out, ui);
    blend_window_ui(session, out, ui);
    compare_ui(Key::BlendWindow, session, out, ui);
    place_rows_ui([Key::LeaveA, Key::EnterB], session, out, ui);
    param_row_ui(Key::WeightLaw, &Detail::default(), session, out, ui);
    ui.add_space(space::XS);
    param_row_ui(Key::Align, &Detail::default(), session, out, ui);
    param_row_ui(Key::AlignBy, &Detail::default(), session, out, ui);
    param_row_ui(Key::RootBlend, &Detail::default(), session, out, ui);
    foot_rows_ui(session, out, ui);
}
