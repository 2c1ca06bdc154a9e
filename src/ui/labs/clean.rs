//! The Clean lab: the faults of a take, each with its place and a switch.

use crate::ui::kit::{self, Button, Icon, Moment};
use crate::ui::labs::lab_ui::{Compares, LabUi, Shown, Title};
use crate::ui::out::Out;
use crate::ui::rows::{Detail, KeepOffer, clip_sets_ui, param_row_ui, slot_row_ui};
use crate::ui::state::UiState;
use crate::ui::text;
use crate::ui::theme::{palette_of, space};
use eframe::egui::{Color32, Ui};
use segue_motion::clean::FaultKind;
use segue_motion::skeleton::Roles;
use segue_session::choices::Mending;
use segue_session::{
    CleanFacts, Command, Compare, FoundFault, Key, LabId, List, Outcome, PlaybackCommand, Session,
    Slot, Value,
};
use segue_text::Message;

/// The lab's part of the page.
pub(super) const LAB: LabUi = LabUi {
    panel_ui: clean_ui,
    about: [text::CLEAN_ABOUT, text::CLEAN_DETAILS],
    kept: |_, pane| KeepOffer::result(pane),
    compares: Compares::Own(compare_mends),
    title,
    hint: |_| None,
    take_line: None,
};

/// The most faults of a kind that are listed.
const MAX_LISTED: usize = 12;

fn title(shown: &Shown<'_>) -> Title {
    let is_on = shown.params.choice::<Mending>() == Mending::Mended;
    let facts = shown.pane.outcome.as_ref().and_then(|outcome| outcome.cleaned());
    let mended = facts.map(|facts| facts.faults.iter().filter(|found| found.is_chosen).count());
    let secondary = match mended {
        Some(count) if is_on && count > 0 => text::mended(count),
        Some(_) if is_on => text::NOTHING_MENDED.into(),
        None if is_on => text::CLEANED.into(),
        _ => text::AS_RECORDED.into(),
    };
    Title { strong: shown.name(Key::A), secondary, ..Title::default() }
}

/// Draws the rows of the lab.
fn clean_ui(session: &Session, _: &mut UiState, out: &mut Out, ui: &mut Ui) {
    let row = |key: Key, out: &mut Out, ui: &mut Ui| {
        param_row_ui(key, &Detail::default(), session, out, ui);
    };
    clip_sets_ui(session, out, ui);
    slot_row_ui(Slot::A, session, out, ui);
    ui.add_space(space::S);
    row(Key::CleanMend, out, ui);
    row(Key::CleanSure, out, ui);
    ui.add_space(space::S);
    faults_ui(session, out, ui);
    ui.add_space(space::S);
    for key in FaultKind::ALL.map(CleanFacts::switch_of) {
        row(key, out, ui);
        if key == Key::CleanJitter && session.params().is_on(key) {
            row(Key::CleanCutoff, out, ui);
        }
    }
    ui.add_space(space::S);
    kit::folded_ui(text::INJECT_FAULTS, ui, |ui| {
        row(Key::CleanFaults, out, ui);
        row(Key::CleanSeed, out, ui);
    });
}

/// Draws the faults by kind, each with its place, a button that shows it and one that mends it.
fn faults_ui(session: &Session, out: &mut Out, ui: &mut Ui) {
    kit::section_header_ui(text::FAULTS, ui);
    let muted = palette_of(ui).muted;
    let Some((outcome, facts)) = main_facts(session) else {
        return kit::note_ui(text::LOOKING_FOR_FAULTS, muted, ui);
    };
    if facts.injected > 0 {
        kit::note_ui(&text::injected(facts.injected), muted, ui);
    }
    if facts.faults.is_empty() {
        return kit::note_ui(text::NO_FAULTS, muted, ui);
    }
    if facts.faults.iter().any(|found| !found.is_chosen) {
        let button = Button::new(text::CLEAN_ALL).hint(text::CLEAN_ALL_HINT);
        if kit::button_ui(button, ui).clicked() {
            clean_all(out);
        }
    }
    for (kind, numbers) in facts.kinds() {
        let of_kind = || numbers.iter().filter_map(|&number| facts.faults.get(number));
        let mended = of_kind().filter(|found| facts.mends && found.is_chosen).count();
        ui.add_space(space::XS);
        kit::note_ui(&text::faults_of_kind(kind, numbers.len(), mended), palette_of(ui).text, ui);
        for (index, found) in of_kind().take(MAX_LISTED).enumerate() {
            ui.push_id((kind, index), |ui| fault_ui(found, facts, outcome, session, out, ui));
        }
        if numbers.len() > MAX_LISTED {
            kit::note_ui(&text::more_faults(numbers.len() - MAX_LISTED), muted, ui);
        }
    }
}

/// Draws a fault: the button that mends it or leaves it alone, and its place, which shows it.
fn fault_ui(
    found: &FoundFault,
    facts: &CleanFacts,
    outcome: &Outcome,
    session: &Session,
    out: &mut Out,
    ui: &mut Ui,
) {
    let fault = &found.fault;
    let clip = outcome.motion.clip();
    let line =
        text::fault_line(fault, clip.time_of(fault.frames.start), joint_name(found, outcome));
    ui.horizontal(|ui| {
        ui.spacing_mut().item_spacing.x = space::XS;
        let name = text::mend_this(line.clone());
        let icon = Button::icon_only(Icon::Check, text::MEND_THIS).name(&name);
        if kit::button_ui(icon.selected(found.is_chosen), ui).clicked() {
            toggle(found, session, out);
        }
        let hint = text::confidence(fault);
        if kit::button_ui(Button::new(&line).quiet().hint(&hint), ui).clicked() {
            let frame = facts.frame_in_result(fault.frames.start);
            out.commands.push(Command::Set(vec![(Key::Play, Value::Switch(false))]));
            out.commands.push(Command::Playback(PlaybackCommand::Seek(clip.time_of(frame))));
        }
    });
}

/// Leaves a fault alone, or mends it after all: its kind is switched on, and the confidence that is
/// asked for lowered to its own.
fn toggle(found: &FoundFault, session: &Session, out: &mut Out) {
    let params = session.params();
    let place = (found.fault.kind, found.fault.frames.start);
    let mut left: Vec<_> = params.faults_left_alone().to_vec();
    left.retain(|known| *known != place);
    let mut values = Vec::new();
    if found.is_chosen {
        left.push(place);
    } else {
        values.push((CleanFacts::switch_of(found.fault.kind), Value::Switch(true)));
        if !found.is_sure {
            let percent = f64::from(found.fault.confidence) * 100.0;
            values.push((Key::CleanSure, Value::Number((percent / 5.0).floor() * 5.0)));
        }
    }
    values.push((Key::CleanSkip, List::FaultPlaces(left).into()));
    out.commands.push(Command::Set(values));
    out.commands.push(Command::Settle);
}

/// Switches every mend on.
fn clean_all(out: &mut Out) {
    let switches = FaultKind::ALL.map(CleanFacts::switch_of);
    let mut values: Vec<_> = switches.map(|key| (key, Value::Switch(true))).into();
    values.push((Key::CleanMend, Mending::Mended.into()));
    values.push((Key::CleanSure, Value::Number(0.0)));
    values.push((Key::CleanSkip, List::FaultPlaces(Vec::new()).into()));
    out.commands.push(Command::Set(values));
    out.commands.push(Command::Settle);
}

/// Returns the joints of a fault in words; `None` for the whole body.
fn joint_name(found: &FoundFault, outcome: &Outcome) -> Option<Message> {
    let joints = &found.fault.joints;
    let roles: &Roles = outcome.motion.roles();
    // A body part says more than a joint between two of them.
    let first = joints
        .iter()
        .find(|&&joint| roles.role_of(joint).is_some())
        .or_else(|| joints.first())
        .copied()?;
    let name = match roles.role_of(first) {
        Some(role) => role.name_in(roles.body_plan()).into(),
        None => Message::data(outcome.motion.clip().skeleton().joints().get(first)?.name.as_str()),
    };
    Some(text::joints(name, joints.len() - 1))
}

/// Returns the result whose faults are listed: of the first pane that mends them, or the first one.
fn main_facts(session: &Session) -> Option<(&Outcome, &CleanFacts)> {
    let outcomes = || session.panes().iter().filter_map(|pane| pane.outcome.as_deref());
    let facts = || outcomes().filter_map(|outcome| Some((outcome, &**outcome.cleaned()?)));
    facts().find(|(_, facts)| facts.mends).or_else(|| facts().next())
}

/// Returns the marks of faults on the timeline: where they are, or were.
pub(super) fn moments(session: &Session, colors: [Color32; 2]) -> Vec<Moment> {
    let is_open = session.params().lab() == LabId::Clean;
    let Some((outcome, facts)) = main_facts(session).filter(|_| is_open) else {
        return Vec::new();
    };
    let clip = outcome.motion.clip();
    let last = clip.frames().saturating_sub(1);
    facts
        .faults
        .iter()
        // A fault of the whole take has no place of its own.
        .filter(|found| found.fault.frames.len() < facts.take_frames)
        .map(|found| Moment {
            time: clip.time_of(facts.frame_in_result(found.fault.frames.start).min(last)),
            color: colors[usize::from(!(facts.mends && found.is_chosen))],
            name: text::FAULT,
        })
        .collect()
}

/// Opens the mended take, which is the one that is kept, beside the recorded one, or goes back to
/// one pane.
fn compare_mends(session: &Session, out: &mut Out) {
    let on = session.compare().is_some_and(|compare| compare.key == Key::CleanMend);
    let query = if on { "" } else { "clean_mend:on,off" };
    out.compare(Compare::parse(query).ok());
}
