//! The parameters of the lab that is open, and below them those of the stage.

use super::break_it::break_it_ui;
use super::clip_panel::clip_panel_ui;
use super::cycle_panels::{loop_ui, speed_ui};
use super::drive::drive_ui;
use super::graph::{graph_ui, seed_detail};
use super::kit::{self, Button, Icon};
use super::language::tr;
use super::layers_rows::layers_ui;
use super::out::Out;
use super::param_row::{Detail, compare_choice_ui, param_row_ui};
use super::path_panel::path_ui;
use super::register_panel::register_ui;
use super::save_rows::save_rows_ui;
use super::state::UiState;
use super::text;
use super::theme::{Type, palette_of, space, theme_of};
use super::top_bar::{made_number, toggle_compare};
use eframe::egui::{self, Ui};
use segue_motion::math::spring;
use segue_motion::transition::has_legs;
use segue_session::LabId;
use segue_session::choices::{self, TransitionMethod};
use segue_session::{Command, Group, Key, NoResult, PARAMS, Session, Slot, Value, split_reference};

/// The right panel: one section for the lab, two that fold for stage and camera.
pub(crate) fn lab_panel_ui(session: &Session, state: &mut UiState, out: &mut Out, ui: &mut Ui) {
    let params = session.params();
    match params.lab() {
        LabId::Make => make_ui(session, state, out, ui),
        LabId::Blend => blend_ui(session, state, out, ui),
        LabId::Transition => transition_ui(session, state, out, ui),
        LabId::Speed => speed_ui(session, state, out, ui),
        LabId::Loop => loop_ui(session, state, out, ui),
        LabId::Layers => layers_ui(session, state, out, ui),
        LabId::Register => register_ui(session, state, out, ui),
        LabId::Path => path_ui(session, state, out, ui),
        LabId::Graph => graph_ui(session, state, out, ui),
        LabId::Match => drive_ui(session, state, out, ui),
        LabId::View => view_ui(session, state, out, ui),
    }
    ui.add_space(space::S);
    compare_choice_ui(session, out, ui);
    ui.add_space(space::L);
    group_ui(text::STAGE, Group::Stage, session, out, ui);
    group_ui(text::CAMERA, Group::Camera, session, out, ui);
}

fn view_ui(session: &Session, state: &mut UiState, out: &mut Out, ui: &mut Ui) {
    kit::section_header_ui(&lab_label(session), ui);
    compared_clips_ui(session, out, ui);
    foot_rows_ui(session, out, ui);
    for key in [Key::RootMotion, Key::PlaceX, Key::PlaceZ, Key::PlaceHeading] {
        param_row_ui(key, &Detail::default(), session, out, ui);
    }
    let is_made = session.view_is_changed();
    if is_made {
        keep_ui(0, session, out, ui);
    }
    if let Some(entry) = session.slot(Slot::A) {
        let saved = if is_made { "result:0" } else { entry.id.as_str() };
        ui.push_id(&entry.id, |ui| clip_panel_ui(entry, saved, session, state, out, ui));
    }
}

/// The clip, or those that stand side by side.
fn compared_clips_ui(session: &Session, out: &mut Out, ui: &mut Ui) {
    let compare = session.compare().filter(|compare| compare.key == Key::A);
    let label = if let Some(compare) = compare {
        for (pane, value) in compare.values.iter().enumerate() {
            let label = format!("{} {}", text::CLIP, pane + 1);
            if let Some(id) = clip_choice_ui(&label, compare.key.param().format(value).as_str(), session, ui) {
                let mut compare = compare.clone();
                compare.values[pane] = Value::Text(id);
                out.set_once(Key::Compare, Value::Text(compare.to_string()));
            }
        }
        text::COMPARE_OFF
    } else {
        slot_row_ui(Slot::A, session, out, ui);
        text::COMPARE_CLIPS
    };
    if kit::button_ui(Button::new(label).hint(text::COMPARE_CLIPS_HELP), ui).clicked() {
        toggle_compare(session, out);
    }
}

fn make_ui(session: &Session, state: &mut UiState, out: &mut Out, ui: &mut Ui) {
    kit::section_header_ui(&lab_label(session), ui);
    for param in PARAMS.iter().filter(|param| param.group == Group::Make) {
        // What the chosen motion does not have is not offered.
        if session.made_motion_has(param.key) {
            param_row_ui(param.key, &Detail::default(), session, out, ui);
        }
        if param.key == made_number(session) {
            compare_ui(param.key, session, out, ui);
        }
    }
    foot_rows_ui(session, out, ui);
    ui.add_space(space::S);
    save_result_ui(session, state, out, ui);
}

fn blend_ui(session: &Session, state: &mut UiState, out: &mut Out, ui: &mut Ui) {
    kit::section_header_ui(&lab_label(session), ui);
    let fps = pair_ui(session, out, ui);
    let duration = |slot| Some(session.slot(slot)?.motion.as_ref()?.clip.duration_secs());
    let window = session.params().number(Key::BlendWindow);
    let shortest = [Slot::A, Slot::B].into_iter().filter_map(duration).fold(f64::INFINITY, f64::min);
    let longest_window = if shortest.is_finite() {
        Some((shortest * fps).floor())
    } else {
        None
    };
    param_row_ui(
        Key::BlendWindow,
        &Detail {
            fps: Some(fps),
            max: longest_window.map(|max| max.max(window)),
            ..Detail::default()
        },
        session,
        out,
        ui,
    );
    compare_ui(Key::BlendWindow, session, out, ui);
    place_rows_ui([Key::LeaveA, Key::EnterB], session, out, ui);
    param_row_ui(Key::WeightLaw, &Detail::default(), session, out, ui);
    ui.add_space(space::XS);
    param_row_ui(Key::Align, &Detail::default(), session, out, ui);
    param_row_ui(Key::AlignBy, &Detail::default(), session, out, ui);
    param_row_ui(Key::RootBlend, &Detail::default(), session, out, ui);
    foot_rows_ui(session, out, ui);
    ui.add_space(space::S);
    save_result_ui(session, state, out, ui);
}

/// The foot lock, how feet are read where they are held, and why they are not.
pub(super) fn foot_rows_ui(session: &Session, out: &mut Out, ui: &mut Ui) {
    param_row_ui(Key::FootLock, &Detail::default(), session, out, ui);
    if session.params().is_on(Key::FootLock)
        && let Some(outcome) = session.main_outcome()
        && !has_legs(outcome.motion.clip.skeleton(), &outcome.motion.roles)
    {
        let words = egui::RichText::new(tr(text::NO_LEGS, ui)).font(theme_of(ui).font(Type::Small));
        ui.label(words.color(palette_of(ui).warning));
    }
    kit::folded_ui(text::FEET, ui, |ui| {
        if session.params().is_on(Key::FootLock) {
            for key in [Key::LockBlend, Key::LockReach, Key::LockClearance] {
                param_row_ui(key, &Detail::default(), session, out, ui);
            }
        }
        for key in [Key::Ground, Key::ContactHeight, Key::ContactSpeed] {
            param_row_ui(key, &Detail::default(), session, out, ui);
        }
    });
}

/// Keeps the result, or saves it; which one, where several stand side by side.
pub(super) fn save_result_ui(session: &Session, state: &mut UiState, out: &mut Out, ui: &mut Ui) {
    let panes = session.panes();
    state.saved_pane = state.saved_pane.min(panes.len().saturating_sub(1));
    let names: Vec<String> = panes.iter().map(|pane| session.variant_name(pane).unwrap_or_default()).collect();
    if panes.len() > 1 {
        let options: Vec<(usize, &str)> = names.iter().map(String::as_str).enumerate().collect();
        if let Some(pane) = kit::choice_row_ui(text::SAVED_PANE, state.saved_pane, &options, ui) {
            state.saved_pane = pane;
        }
    }
    keep_ui(state.saved_pane, session, out, ui);
    ui.add_space(space::S);
    let has_result = panes.get(state.saved_pane).is_some_and(|pane| pane.result().is_ok());
    ui.add_enabled_ui(has_result, |ui| {
        save_rows_ui(&format!("result:{}", state.saved_pane), state, out, ui);
    });
}

/// Keeps the result of a pane. Where there is none, it says why.
pub(super) fn keep_ui(pane: usize, session: &Session, out: &mut Out, ui: &mut Ui) {
    let missing = session.panes().get(pane).and_then(|pane| pane.result().err());
    let button = Button::new(text::KEEP).icon(Icon::Plus).outlined();
    let kept = ui.add_enabled_ui(missing.is_none(), |ui| kit::button_ui(button, ui).clicked());
    if kept.inner {
        out.commands.push(Command::Keep(pane));
    }
    match missing {
        // The sentence stands on the stage.
        Some(NoResult::Refused(_)) => kit::note_ui(text::NOTHING_TO_KEEP, palette_of(ui).muted, ui),
        Some(NoResult::Awaited) => kit::note_ui(text::STILL_COMPUTED, palette_of(ui).muted, ui),
        None => {}
    }
}

/// The two clips, and what is done to B where it moves another skeleton. Returns the frame rate of what is made of them.
pub(super) fn pair_ui(session: &Session, out: &mut Out, ui: &mut Ui) -> f64 {
    slot_row_ui(Slot::A, session, out, ui);
    slot_row_ui(Slot::B, session, out, ui);
    let outcome = session.main_outcome();
    if let Some(retargeted) = outcome.and_then(|outcome| outcome.retargeted.as_ref()) {
        let words = egui::RichText::new(tr(&text::retargeted(retargeted), ui)).font(theme_of(ui).font(Type::Small));
        let line = ui.label(words.color(palette_of(ui).muted));
        if !retargeted.unmatched.is_empty() {
            line.on_hover_text(tr(&retargeted.unmatched.join(", "), ui));
        }
    }
    let rate = |slot| Some(session.slot(slot)?.motion.as_ref()?.clip.fps());
    if let (Some(a), Some(b)) = (rate(Slot::A), rate(Slot::B))
        && (a - b).abs() > 1e-4 * a
    {
        let words = egui::RichText::new(tr(&text::resampled(b, a), ui)).font(theme_of(ui).font(Type::Small));
        ui.label(words.color(palette_of(ui).muted));
    }
    ui.add_space(space::S);
    outcome.map_or(60.0, |outcome| outcome.motion.clip.fps())
}

/// What the methods of the lab have to set, and what they share.
fn transition_ui(session: &Session, state: &mut UiState, out: &mut Out, ui: &mut Ui) {
    kit::section_header_ui(&lab_label(session), ui);
    let fps = pair_ui(session, out, ui);
    let params = session.params();
    param_row_ui(Key::Method, &Detail::default(), session, out, ui);
    // With several methods side by side, what each of them has to set is there.
    let methods: Vec<TransitionMethod> = session.choices();
    let any = |of: &[TransitionMethod]| methods.iter().any(|method| of.contains(method));
    if any(&[TransitionMethod::Inertialize]) {
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
        let detail = Detail {
            fps: Some(fps),
            ..Detail::default()
        };
        param_row_ui(Key::BlendWindow, &detail, session, out, ui);
    }
    let shoot_out = session.compare().is_some_and(|compare| compare.key == Key::Method);
    if kit::button_ui(Button::new(text::SHOOT_OUT).selected(shoot_out), ui).clicked() {
        let query = if shoot_out { "" } else { text::SHOOT_OUT_QUERY };
        out.set_once(Key::Compare, Value::Text(query.to_owned()));
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
    ui.add_space(space::S);
    save_result_ui(session, state, out, ui);
}

/// How long a half-life really lasts, and the dissolve that feels alike.
fn half_life_ruler_ui(half_life_secs: f64, fps: f64, ui: &mut Ui) {
    for (label, share) in [(text::HALF_LEFT, 0.5), (text::TENTH_LEFT, 0.1), (text::HUNDREDTH_LEFT, 0.01)] {
        let secs = spring::secs_until(half_life_secs, share);
        kit::value_row_ui(label, &format!("{secs:.2}"), "s", ui);
    }
    let alike = spring::alike_window_secs(half_life_secs) * fps;
    kit::value_row_ui(text::ALIKE_WINDOW, &format!("{alike:.0}"), "frames", ui);
}

/// Where A is left and B entered, in seconds or in frames of each clip. How that was found is one thing for both: it is said once, below the second
/// row, or below the one that is left to Segue.
fn place_rows_ui(keys: [Key; 2], session: &Session, out: &mut Out, ui: &mut Ui) {
    let automatic = keys.map(|key| session.params().optional(key).is_none());
    let said_below = usize::from(automatic != [true, false]);
    let transition = session.main_outcome().and_then(|outcome| outcome.transition);
    let search = transition.and_then(|transition| transition.search);
    for (index, (key, slot)) in keys.into_iter().zip([Slot::A, Slot::B]).enumerate() {
        let motion = session.slot(slot).and_then(|entry| entry.motion.as_ref());
        let latest_secs = motion.map(|motion| {
            let end = motion.clip.duration_secs();
            search.map_or(end, |search| search.latest_secs[index].min(end))
        });
        let in_frames = |secs: f64| motion.map_or(secs, |motion| (secs * motion.clip.fps()).round());
        let max = latest_secs.map(|secs| if key.param().unit == "s" { secs } else { in_frames(secs) });
        let help = match (said_below == index, automatic[index]) {
            (true, _) => found_sentence(session, automatic),
            (false, true) => String::new(),
            (false, false) => text::BY_HAND.to_owned(),
        };
        let detail = Detail {
            max,
            used: max.filter(|&max| session.params().optional(key).is_some_and(|given| given > max)),
            help: Some(help),
            ..Detail::default()
        };
        param_row_ui(key, &detail, session, out, ui);
    }
}

/// How the place was found, with its distance where that is known.
fn found_sentence(session: &Session, automatic: [bool; 2]) -> String {
    if session.jobs().iter().any(|job| job.task.is_none()) {
        return format!("{}…", text::MATCHING);
    }
    match session.main_outcome().and_then(|outcome| outcome.transition) {
        Some(transition) => text::place_found(&transition, automatic),
        None => format!("{}.", text::FOUND),
    }
}

/// Which clip is in a slot, to be chosen anew.
pub(super) fn slot_row_ui(slot: Slot, session: &Session, out: &mut Out, ui: &mut Ui) {
    let chosen = session.params().text(slot.key());
    if let Some(id) = clip_choice_ui(slot.label(), chosen, session, ui) {
        out.commands.push(Command::Assign(slot, id));
    }
}

/// A clip of the library to choose; the id of the one that was.
pub(super) fn clip_choice_ui(label: &str, chosen: &str, session: &Session, ui: &mut Ui) -> Option<String> {
    let entries = session.library().entries();
    let found = session.library().find(chosen);
    let found = found.and_then(|entry| entries.iter().position(|other| other.id == entry.id));
    let missing = (found.is_none() && !chosen.is_empty()).then(|| text::missing(split_reference(chosen).0));
    // The one that is not here cannot be chosen, only seen.
    let options: Vec<(usize, &str)> = (entries.iter().map(|entry| entry.name.as_str()).enumerate())
        .chain(missing.as_deref().map(|words| (usize::MAX, words)))
        .collect();
    let picked = ui
        .push_id(label, |ui| kit::choice_row_ui(label, found.unwrap_or(usize::MAX), &options, ui))
        .inner;
    Some(entries.get(picked?)?.id.clone())
}

/// The experiment of the course. The rows of what is compared have the way back.
pub(super) fn compare_ui(key: Key, session: &Session, out: &mut Out, ui: &mut Ui) {
    let on = session.compare().is_some_and(|compare| compare.key == key);
    if !on && kit::button_ui(Button::new(text::FULL_HALF_THIRD).hint(text::COMPARE_HELP), ui).clicked() {
        out.commands.push(Command::Compare(key));
    }
}

fn group_ui(title: &str, group: Group, session: &Session, out: &mut Out, ui: &mut Ui) {
    kit::folded_ui(title, ui, |ui| {
        for param in PARAMS
            .iter()
            .filter(|param| param.group == group && !is_handled_elsewhere(param.key))
        {
            param_row_ui(param.key, &Detail::default(), session, out, ui);
        }
    });
}

/// What only the pointer on the stage sets.
fn is_handled_elsewhere(key: Key) -> bool {
    matches!(key, Key::PanX | Key::PanY | Key::PanZ)
}

/// The name of the lab that is open.
pub(super) fn lab_label(session: &Session) -> String {
    Key::Lab.param().spoken(session.params().get(Key::Lab))
}

/// The parameters that an embedding page wants its readers to try: those that its link names, whatever they are by now, and those of the lab that were
/// changed since. Looking around and playing have controls of their own.
fn named_params(session: &Session) -> impl Iterator<Item = Key> + '_ {
    let compared = session.compare().map(|compare| compare.key);
    PARAMS.iter().map(|param| param.key).filter(move |&key| {
        let (group, named) = (key.param().group, session.names(key));
        let changed = group.is_of_lab() && session.params().get(key) != &key.param().default_value();
        changed
            || compared == Some(key)
            || (named && (group.is_of_lab() || matches!(group, Group::Stage) || matches!(key, Key::A | Key::B)))
    })
}

/// Whether the link names a parameter of the lab.
pub(crate) fn has_named_params(session: &Session) -> bool {
    named_params(session).next().is_some()
}

/// Their rows.
pub(crate) fn named_params_ui(session: &Session, out: &mut Out, ui: &mut Ui) {
    for key in named_params(session) {
        match key {
            Key::A => slot_row_ui(Slot::A, session, out, ui),
            Key::B => slot_row_ui(Slot::B, session, out, ui),
            Key::Seed => param_row_ui(key, &seed_detail(session), session, out, ui),
            _ => param_row_ui(key, &Detail::default(), session, out, ui),
        }
    }
}
