//! The panels of the Speed and the Loop lab: results that go round.

use super::clip_sets::clip_sets_ui;
use super::kit::{self, Button, Mark, Part};
use super::lab_panel::{compare_ui, foot_rows_ui, lab_label, pair_ui, save_result_ui, slot_row_ui};
use super::out::Out;
use super::param_row::{Detail, param_row_ui};
use super::state::UiState;
use super::text;
use super::theme::{palette_of, space};
use eframe::egui::Ui;
use segue_session::choices::LoopMethod;
use segue_session::{Cycle, CycleMade, Key, Session, Slot, Value};

/// The upper end of the slider before the clips are known, metres per second.
const SLIDER_MPS: f64 = 6.0;
/// And how far it goes beyond the faster clip.
const SLIDER_BEYOND: f64 = 1.6;

/// Ends that are farther apart than this hardly repeat each other, centimetres: as the default threshold of the motion graph.
const POOR_ENDS_CM: f64 = 8.0;

/// Two gaits at a speed.
pub(super) fn speed_ui(session: &Session, state: &mut UiState, out: &mut Out, ui: &mut Ui) {
    kit::section_header_ui(&lab_label(session), ui);
    kit::note_ui(text::SPEED_ABOUT, palette_of(ui).muted, ui);
    clip_sets_ui(session, out, ui);
    pair_ui(session, out, ui);
    let palette = palette_of(ui);
    let made = session.main_outcome().and_then(|outcome| outcome.cycle).map(|cycle| cycle.made);
    let mut detail = Detail {
        max: Some(SLIDER_MPS),
        ..Detail::default()
    };
    let mut warning = None;
    if let Some(CycleMade::Gait {
        facts,
        clips_mps,
        cuts_secs,
        ..
    }) = made
    {
        let mark = |part: Part, value| Mark {
            value,
            color: part.fill(palette).0,
        };
        detail.marks = vec![mark(Part::A, clips_mps[0]), mark(Part::B, clips_mps[1])];
        detail.help = Some(text::gaits(clips_mps, cuts_secs));
        let most = clips_mps[0].max(clips_mps[1]);
        detail.max = Some((SLIDER_BEYOND * most).max(session.params().number(Key::Speed)));
        warning = text::beyond_gaits(&facts, clips_mps);
    }
    param_row_ui(Key::Speed, &detail, session, out, ui);
    if let (Some(warning), None) = (warning, session.compare()) {
        kit::note_ui(&warning, palette.warning, ui);
    }
    let on = session.compare().is_some_and(|compare| compare.key == Key::Speed);
    // The rows of what is compared have the way back.
    if !on && kit::button_ui(Button::new(text::THREE_SPEEDS), ui).clicked() {
        compare_speeds(session, out);
    }
    ui.add_space(space::S);
    param_row_ui(Key::PhaseAlign, &Detail::default(), session, out, ui);
    kit::note_ui(Key::PhaseAlign.param().help, palette.muted, ui);
    foot_rows_ui(session, out, ui);
    ui.add_space(space::S);
    save_result_ui(session, state, out, ui);
}

/// The speed of A, that of B, and the one between them side by side, or back to one pane.
pub(super) fn compare_speeds(session: &Session, out: &mut Out) {
    let on = session.compare().is_some_and(|compare| compare.key == Key::Speed);
    let made = session.main_outcome().and_then(|outcome| outcome.cycle).map(|cycle| cycle.made);
    let query = match made {
        Some(CycleMade::Gait { clips_mps: [a, b], .. }) if !on => {
            let words = [a, 0.5 * (a + b), b].map(|speed| Key::Speed.param().check(Value::Number(speed)).ok());
            let words: Vec<String> = words.iter().flatten().map(|speed| Key::Speed.param().format(speed)).collect();
            format!("{}:{}", Key::Speed.param().name, words.join(","))
        }
        _ => String::new(),
    };
    out.set_once(Key::Compare, Value::Text(query));
}

/// A clip that becomes a cycle.
pub(super) fn loop_ui(session: &Session, state: &mut UiState, out: &mut Out, ui: &mut Ui) {
    kit::section_header_ui(&lab_label(session), ui);
    kit::note_ui(text::LOOP_ABOUT, palette_of(ui).muted, ui);
    clip_sets_ui(session, out, ui);
    slot_row_ui(Slot::A, session, out, ui);
    ui.add_space(space::S);
    let params = session.params();
    let cycle = session.main_outcome().and_then(|outcome| outcome.cycle);
    let duration = session
        .slot(Slot::A)
        .and_then(|entry| entry.motion.as_ref())
        .map(|motion| motion.clip.duration_secs());
    let automatic = |key| params.optional(key).is_none();
    let distance_cm = cycle.and_then(|cycle| match cycle.made {
        CycleMade::Cut { distance_cm, .. } => Some(distance_cm),
        CycleMade::Gait { .. } => None,
    });
    let poor = distance_cm.is_some_and(|distance_cm| distance_cm > POOR_ENDS_CM);
    let place = |key, said_below: bool| Detail {
        max: duration,
        help: Some(match (automatic(key), said_below) {
            (false, _) => text::BY_HAND.to_owned(),
            (true, true) => String::new(),
            // Said in a warning below.
            (true, false) if poor && automatic(Key::LoopFrom) => String::new(),
            (true, false) => found_sentence(cycle),
        }),
        ..Detail::default()
    };
    param_row_ui(Key::LoopFrom, &place(Key::LoopFrom, automatic(Key::LoopTo)), session, out, ui);
    param_row_ui(Key::LoopTo, &place(Key::LoopTo, false), session, out, ui);
    if let Some(distance_cm) = distance_cm.filter(|_| poor && automatic(Key::LoopFrom) && automatic(Key::LoopTo)) {
        kit::note_ui(&text::poor_ends(distance_cm), palette_of(ui).warning, ui);
    }
    param_row_ui(Key::LoopMethod, &Detail::default(), session, out, ui);
    // With several methods side by side, what any of them has to set is there.
    let methods: Vec<LoopMethod> = session.choices();
    if let [method] = methods.as_slice() {
        kit::note_ui(text::loop_method(*method), palette_of(ui).muted, ui);
    }
    if !methods
        .iter()
        .all(|method| matches!(method, LoopMethod::Linear | LoopMethod::Cubic))
    {
        let detail = Detail {
            help: Some(text::LOOP_HALF_LIFE.to_owned()),
            ..Detail::default()
        };
        param_row_ui(Key::HalfLife, &detail, session, out, ui);
        compare_ui(Key::HalfLife, session, out, ui);
    }
    if !methods.iter().all(|method| matches!(method, LoopMethod::Start | LoopMethod::End)) {
        param_row_ui(Key::LoopRatio, &Detail::default(), session, out, ui);
    }
    let shoot_out = methods.len() > 1;
    if kit::button_ui(Button::new(text::LOOP_SHOOT_OUT).selected(shoot_out), ui).clicked() {
        compare_loops(session, out);
    }
    ui.add_space(space::S);
    foot_rows_ui(session, out, ui);
    ui.add_space(space::S);
    save_result_ui(session, state, out, ui);
}

/// Several methods side by side, or back to one pane.
pub(super) fn compare_loops(session: &Session, out: &mut Out) {
    let on = session.compare().is_some_and(|compare| compare.key == Key::LoopMethod);
    let query = if on { "" } else { text::LOOP_SHOOT_OUT_QUERY };
    out.set_once(Key::Compare, Value::Text(query.to_owned()));
}

/// How the ends were found, and how well they fit.
fn found_sentence(cycle: Option<Cycle>) -> String {
    match cycle.map(|cycle| cycle.made) {
        Some(CycleMade::Cut { distance_cm, .. }) => text::ends_found(distance_cm),
        _ => format!("{}.", text::FOUND),
    }
}
