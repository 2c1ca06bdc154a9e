//! The Transition lab: the methods and their parameters.

use super::break_it::break_it_ui;
use crate::ui::kit::{self, Button};
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
use segue_motion::math::spring;
use segue_session::choices::{self, TransitionMethod};
use segue_session::{Compare, Key, LabId, Outcome, Session};
use segue_text::msg;

/// The lab's part of the page.
pub(super) const LAB: LabUi = LabUi {
    panel_ui: transition_ui,
    about: [text::TRANSITION_ABOUT, text::TRANSITION_DETAILS],
    kept: |_, pane| KeepOffer::result(pane),
    compares: Compares::Key(Key::HalfLife),
    title,
    hint: |_| None,
    take_line: None,
};

fn title(shown: &Shown<'_>) -> Title {
    Title {
        strong: shown.name(Key::A),
        text: msg!("→ {clip}", clip = shown.name(Key::B)),
        secondary: shown.spoken(Key::Method),
    }
}

/// Returns whether the lab is open.
pub(crate) fn is_open(session: &Session) -> bool {
    session.params().lab() == LabId::Transition
}

/// Returns the value that dragging an end of the transition to a time sets; `None` for a cut, which
/// has no length.
pub(super) fn edge_value(
    edge: Edge,
    secs: f64,
    session: &Session,
    outcome: &Outcome,
) -> Option<(Key, f64)> {
    let (params, fps) = (session.params(), outcome.motion.clip().fps());
    if edge == Edge::Start {
        return Some((Key::MixFrameA, (secs * fps).round().max(0.0)));
    }
    let (start, end) =
        outcome.transition.map_or((0.0, 0.0), |found| (found.start_secs, found.end_secs));
    let wanted = secs - start;
    // The parameter that sets the length depends on the method.
    Some(match params.choice::<TransitionMethod>() {
        TransitionMethod::Cubic | TransitionMethod::Quintic | TransitionMethod::Dead => {
            (Key::BlendTime, wanted)
        }
        TransitionMethod::Inertialize => {
            let share = wanted / (end - start).max(1.0 / fps);
            (Key::HalfLife, params.number(Key::HalfLife) * share)
        }
        TransitionMethod::Cut => return None,
        TransitionMethod::Smooth | TransitionMethod::Linear => (Key::BlendWindow, wanted * fps),
    })
}

/// Draws the parameters of the methods, and those that they share.
pub(super) fn transition_ui(session: &Session, _: &mut UiState, out: &mut Out, ui: &mut Ui) {
    let fps = pair_ui(session, out, ui);
    let params = session.params();
    param_row_ui(Key::Method, &Detail::default(), session, out, ui);
    // With several methods side by side, the parameters of all of them are shown.
    let methods: Vec<TransitionMethod> = session.choices();
    let any = |of: &[TransitionMethod]| methods.iter().any(|method| of.contains(method));
    if has_ruler(session) {
        param_row_ui(Key::HalfLife, &Detail::default(), session, out, ui);
        half_life_ruler_ui(params.number(Key::HalfLife), fps, ui);
        compare_ui(Key::HalfLife, session, out, ui);
    }
    if any(&[TransitionMethod::Cubic, TransitionMethod::Quintic, TransitionMethod::Dead]) {
        param_row_ui(Key::BlendTime, &Detail::default(), session, out, ui);
    }
    if any(&[TransitionMethod::Dead]) {
        param_row_ui(Key::ExtrapolationHalfLife, &Detail::default(), session, out, ui);
    }
    if any(&[TransitionMethod::Smooth, TransitionMethod::Linear]) {
        blend_window_ui(session, out, ui);
    }
    let shoot_out = session.compare().is_some_and(|compare| compare.key == Key::Method);
    if kit::button_ui(Button::new(text::SHOOT_OUT).selected(shoot_out), ui).clicked() {
        let query = if shoot_out { "" } else { text::SHOOT_OUT_QUERY };
        out.compare(Compare::parse(query).ok());
    }
    break_it_ui(session, out, ui);
    ui.add_space(space::S);
    place_rows_ui([Key::MixFrameA, Key::MixFrameB], session, out, ui);
    param_row_ui(Key::MatchBy, &Detail::default(), session, out, ui);
    if params.choice::<choices::MatchBy>() == choices::MatchBy::Pose {
        for key in [Key::MatchPosition, Key::MatchRotation, Key::MatchVelocity] {
            param_row_ui(key, &Detail::default(), session, out, ui);
        }
    }
    ui.add_space(space::XS);
    param_row_ui(Key::Align, &Detail::default(), session, out, ui);
    param_row_ui(Key::AlignBy, &Detail::default(), session, out, ui);
    param_row_ui(Key::RootBlend, &Detail::default(), session, out, ui);
    foot_rows_ui(session, out, ui);
}

/// Returns whether a pane inertializes, and so has a half-life.
pub(super) fn has_ruler(session: &Session) -> bool {
    session.choices::<TransitionMethod>().contains(&TransitionMethod::Inertialize)
}

/// Draws the ruler of the half-life.
pub(super) fn ruler_ui(session: &Session, ui: &mut Ui) {
    let fps = session.main_outcome().map_or(60.0, |outcome| outcome.motion.clip().fps());
    half_life_ruler_ui(session.params().number(Key::HalfLife), fps, ui);
}

/// Draws the times after which shares of the offset remain, and the equivalent dissolve.
fn half_life_ruler_ui(half_life_secs: f64, fps: f64, ui: &mut Ui) {
    for (label, share) in
        [(text::HALF_LEFT, 0.5), (text::TENTH_LEFT, 0.1), (text::HUNDREDTH_LEFT, 0.01)]
    {
        let secs = spring::secs_until(half_life_secs, share);
        kit::value_row_ui(label, &format!("{secs:.2}"), Word::new("s"), ui);
    }
    let alike = spring::equivalent_window_secs(half_life_secs) * fps;
    kit::value_row_ui(text::ALIKE_WINDOW, &format!("{alike:.0}"), Word::new("frames"), ui);
}
