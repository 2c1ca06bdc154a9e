//! The Loop lab: a cycle, and the method that closes it.

use crate::ui::kit::{self, Button};
use crate::ui::labs::lab_ui::{Compares, LabUi, Shown, Title};
use crate::ui::out::Out;
use crate::ui::rows::clip_sets_ui;
use crate::ui::rows::{Detail, KeepOffer, param_row_ui};
use crate::ui::rows::{compare_ui, foot_rows_ui, slot_row_ui};
use crate::ui::state::UiState;
use crate::ui::text;
use crate::ui::theme::{palette_of, space};
use eframe::egui::Ui;
use segue_session::choices::LoopMethod;
use segue_session::{Compare, Cycle, CycleMade, Key, LabId, Session, Slot};
use segue_text::Message;

/// The lab's part of the page.
pub(super) const LAB: LabUi = LabUi {
    panel_ui: loop_ui,
    about: [text::LOOP_ABOUT, text::LOOP_DETAILS],
    kept: |_, pane| KeepOffer::result(pane),
    compares: Compares::Own(compare_loops),
    title,
    hint: |_| None,
    take_line: None,
};

fn title(shown: &Shown<'_>) -> Title {
    Title {
        strong: shown.name(Key::A),
        secondary: shown.spoken(Key::LoopMethod),
        ..Title::default()
    }
}

/// The distance above which the ends of a cycle hardly match, centimetres: the default threshold of
/// the motion graph.
const POOR_ENDS_CM: f64 = 8.0;

/// Returns the parameters of the ends of the cycle, while this lab is open.
pub(super) fn part_keys(session: &Session) -> Option<[Key; 2]> {
    let is_open = session.params().lab() == LabId::Loop;
    is_open.then_some([Key::LoopFrom, Key::LoopTo])
}

/// Draws the rows of the lab.
pub(super) fn loop_ui(session: &Session, _: &mut UiState, out: &mut Out, ui: &mut Ui) {
    clip_sets_ui(session, out, ui);
    slot_row_ui(Slot::A, session, out, ui);
    ui.add_space(space::S);
    let params = session.params();
    let cycle = session.main_outcome().and_then(|outcome| outcome.cycle);
    let automatic = |key| params.optional(key).is_none();
    let distance_cm = cycle.and_then(|cycle| match cycle.made {
        CycleMade::Cut { distance_cm, .. } => Some(distance_cm),
        CycleMade::Gait { .. } => None,
    });
    let poor = distance_cm.is_some_and(|distance_cm| distance_cm > POOR_ENDS_CM);
    let place = |key| Detail {
        more: Some(match (automatic(key), key) {
            (false, _) => text::BY_HAND.into(),
            // Both were found together, so that this is said once.
            (true, Key::LoopTo) if automatic(Key::LoopFrom) => Message::default(),
            (true, _) => found_sentence(cycle),
        }),
        ..Detail::default()
    };
    param_row_ui(Key::LoopFrom, &place(Key::LoopFrom), session, out, ui);
    param_row_ui(Key::LoopTo, &place(Key::LoopTo), session, out, ui);
    if let Some(distance_cm) =
        distance_cm.filter(|_| poor && automatic(Key::LoopFrom) && automatic(Key::LoopTo))
    {
        kit::note_ui(&text::poor_ends(distance_cm), palette_of(ui).warning, ui);
    }
    // With several methods side by side, the parameters of all of them are shown.
    let methods: Vec<LoopMethod> = session.choices();
    let more = methods.iter().map(|&method| text::loop_method(method).into()).collect();
    let detail = Detail { more: Some(Message::joined(more, " ")), ..Detail::default() };
    param_row_ui(Key::LoopMethod, &detail, session, out, ui);
    if !methods.iter().all(|method| matches!(method, LoopMethod::Linear | LoopMethod::Cubic)) {
        let detail = Detail { help: Some(text::LOOP_HALF_LIFE.into()), ..Detail::default() };
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
}

/// Opens several methods side by side, or goes back to one pane.
pub(super) fn compare_loops(session: &Session, out: &mut Out) {
    let on = session.compare().is_some_and(|compare| compare.key == Key::LoopMethod);
    let query = if on { "" } else { text::LOOP_SHOOT_OUT_QUERY };
    out.compare(Compare::parse(query).ok());
}

/// Returns how the ends were found, and their distance.
fn found_sentence(cycle: Option<Cycle>) -> Message {
    match cycle.map(|cycle| cycle.made) {
        Some(CycleMade::Cut { distance_cm, .. }) => text::ends_found(distance_cm),
        _ => Message::from(text::FOUND).sentence(),
    }
}
