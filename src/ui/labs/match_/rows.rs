//! The parameters of the Match lab.

use super::present::shown;
use super::tags::tags_ui;
use super::why::why_ui;
use crate::ui::kit::{self, Button, Icon};
use crate::ui::language::{Word, say};
use crate::ui::out::Out;
use crate::ui::rows::{
    Detail, KeepOffer, add_clip_ui, clip_list_ui, clip_sets_ui, param_row_ui, retarget_rows_ui,
};
use crate::ui::state::UiState;
use crate::ui::text;
use crate::ui::theme::{Type, palette_of, space, theme_of};
use eframe::egui::{RichText, Ui, vec2};
use segue_motion::clip::Motion;
use segue_motion::matching::RATE;
use segue_session::choices;
use segue_session::{Command, Compare, DriveCommand, Key, List, Selected, Session, Value};
use segue_text::{Message, ToMessage};
use std::sync::Arc;

/// Draws the rows of the lab.
pub(crate) fn drive_ui(session: &Session, state: &mut UiState, out: &mut Out, ui: &mut Ui) {
    clip_sets_ui(session, out, ui);
    ui.add_space(space::XS);
    row(Key::Scenario, session, out, ui);
    input_ui(session, out, ui);
    if session.is_driven() {
        row(Key::WalkSpeed, session, out, ui);
        row(Key::RunSpeed, session, out, ui);
        row(Key::Strafe, session, out, ui);
    }
    ui.add_space(space::S);
    why_ui(session, state, out, ui);
    ui.add_space(space::S);
    heading_ui(text::WEIGHTS, ui);
    for key in [
        Key::WeightPath,
        Key::WeightFacing,
        Key::WeightFeet,
        Key::WeightFootSpeed,
        Key::WeightHipSpeed,
    ] {
        row(key, session, out, ui);
    }
    ui.add_space(space::S);
    heading_ui(text::HYSTERESIS, ui);
    hysteresis_ui(session, out, ui);
    ui.add_space(space::S);
    kit::folded_ui(text::SEARCHING, ui, |ui| {
        for key in [
            Key::SearchInterval,
            Key::SearchBy,
            Key::AheadNear,
            Key::AheadMiddle,
            Key::AheadFar,
            Key::Normalisation,
        ] {
            row(key, session, out, ui);
        }
    });
    kit::folded_ui(text::TAGS, ui, |ui| tags_ui(session, state, out, ui));
    kit::folded_ui(text::GOING_OVER, ui, |ui| going_over_ui(session, out, ui));
    kit::folded_ui(text::MATCH_CLIPS, ui, |ui| clips_ui(session, out, ui));
}

/// Returns the recorded drive; a live one is kept, and saved when it is replayed.
pub(super) fn kept(session: &Session, pane: usize) -> KeepOffer {
    let save_refused = if session.is_driven() { text::LIVE_NOT_SAVED } else { Word::default() };
    KeepOffer { save_refused, ..KeepOffer::result(pane) }
}

fn row(key: Key, session: &Session, out: &mut Out, ui: &mut Ui) {
    param_row_ui(key, &Detail::default(), session, out, ui);
}

fn heading_ui(words: Word, ui: &mut Ui) {
    ui.label(RichText::new(say(words, ui)).font(theme_of(ui).font(Type::Strong)));
}

/// Draws the buttons that start over, replay, and take control.
fn input_ui(session: &Session, out: &mut Out, ui: &mut Ui) {
    let muted = palette_of(ui).muted;
    if session.is_driven() {
        let secs = session.recording().ticks() as f64 / RATE as f64;
        kit::note_ui(&text::driven_for(secs), muted, ui);
        ui.horizontal_wrapped(|ui| {
            ui.spacing_mut().item_spacing = vec2(space::XS, space::XS);
            let replay = Button::new(text::REPLAY).icon(Icon::Loop).hint(text::REPLAY_HELP);
            if kit::button_ui(replay, ui).clicked() {
                out.commands.push(Command::Drive(DriveCommand::Replay));
            }
            if kit::button_ui(Button::new(text::START_OVER).hint(text::START_OVER_HELP), ui)
                .clicked()
            {
                out.commands.push(Command::Drive(DriveCommand::Restart));
            }
        });
    } else if session.params().choice::<choices::Scenario>() != choices::Scenario::Own
        || session.params().recording().is_some()
    {
        kit::note_ui(text::RECORDED, muted, ui);
        if kit::button_ui(Button::new(text::DRIVE_YOURSELF).icon(Icon::Play).outlined(), ui)
            .clicked()
        {
            out.commands.push(Command::Set(vec![
                (Key::Scenario, choices::Scenario::Own.into()),
                (Key::Drive, List::Recording(None).into()),
                (Key::Play, Value::Switch(true)),
            ]));
            out.commands.push(Command::Settle);
        }
    }
}

/// Returns whether the only pane, or one of several, has this choice.
fn any_pane_has<C: Selected>(choice: C, session: &Session) -> bool {
    match session.compare().filter(|compare| compare.key == C::KEY) {
        Some(compare) => compare.values.iter().any(|value| value.choice() == Some(choice)),
        None => session.params().choice::<C>() == choice,
    }
}

fn hysteresis_ui(session: &Session, out: &mut Out, ui: &mut Ui) {
    let more = text::hysteresis(session.params().choice()).into();
    let detail = Detail { more: Some(more), ..Detail::default() };
    param_row_ui(Key::Hysteresis, &detail, session, out, ui);
    if any_pane_has(choices::Hysteresis::Bias, session) {
        row(Key::BiasShare, session, out, ui);
        row(Key::BiasConstant, session, out, ui);
    }
    if any_pane_has(choices::Hysteresis::Time, session) {
        row(Key::MinimumTime, session, out, ui);
    }
    row(Key::PreferCurrent, session, out, ui);
    preferred_ui(session, out, ui);
    let on = session.compare().is_some_and(|compare| compare.key == Key::Hysteresis);
    let label = if on { text::COMPARE_OFF } else { text::HYSTERESES };
    if kit::button_ui(Button::new(label).selected(on), ui).clicked() {
        compare_hysteresis(session, out);
    }
}

/// Draws the choice of the clip that is preferred while the input is constant.
fn preferred_ui(session: &Session, out: &mut Out, ui: &mut Ui) {
    let Some((driven, _)) = shown(session) else {
        return;
    };
    let ids = session.params().clip_ids(Key::MatchClips);
    let originals = driven.database.motions().iter().filter(|motion| !motion.is_mirrored());
    let words: Vec<&str> =
        std::iter::once("")
            .chain(originals.map(|motion| {
                ids.get(motion.source()).map_or(motion.clip().name(), String::as_str)
            }))
            .collect();
    let label = |word: &str| -> Message {
        match session.library().find(word) {
            _ if word.is_empty() => text::THE_CLIP_THAT_PLAYS.into(),
            Some(entry) => entry.title(),
            None => session.clip_title(word),
        }
    };
    let labels: Vec<Message> = words.iter().map(|word| label(word)).collect();
    let options: Vec<(usize, &Message)> = labels.iter().enumerate().collect();
    let asked = session.params().text(Key::PreferClip);
    let chosen = words.iter().position(|word| *word == asked).unwrap_or(usize::MAX);
    let label = Word::new(Key::PreferClip.param().label);
    let picked = kit::choice_row_ui(label, chosen, &options, ui);
    if let Some(word) = picked.and_then(|index| words.get(index)) {
        out.set_once(Key::PreferClip, Value::Text((*word).to_owned()));
    }
}

/// Opens kinds of hysteresis side by side, or goes back to one pane.
pub(crate) fn compare_hysteresis(session: &Session, out: &mut Out) {
    let on = session.compare().is_some_and(|compare| compare.key == Key::Hysteresis);
    let query = if on { "" } else { text::HYSTERESES_QUERY };
    out.compare(Compare::parse(query).ok());
}

fn going_over_ui(session: &Session, out: &mut Out, ui: &mut Ui) {
    row(Key::JumpMethod, session, out, ui);
    if any_pane_has(choices::JumpMethod::Inertialize, session) {
        row(Key::JumpHalfLife, session, out, ui);
    }
    if any_pane_has(choices::JumpMethod::Dead, session) {
        row(Key::BlendTime, session, out, ui);
        row(Key::ExtrapolationHalfLife, session, out, ui);
    }
    row(Key::VelocityHalfLife, session, out, ui);
    row(Key::FacingHalfLife, session, out, ui);
    row(Key::Adjust, session, out, ui);
    if session.params().is_on(Key::Adjust) {
        for key in [Key::AdjustHalfLife, Key::AdjustShare, Key::ClampDistance, Key::ClampTurn] {
            row(key, session, out, ui);
        }
    }
    row(Key::PlantFeet, session, out, ui);
    if shown(session).is_some_and(|(driven, _)| driven.database.roles().is_quadruped()) {
        kit::note_ui(text::HIND_FEET_ALONE, palette_of(ui).muted, ui);
    }
}

/// Draws the clips of the database, and the number of characters.
fn clips_ui(session: &Session, out: &mut Out, ui: &mut Ui) {
    let (theme, palette) = (theme_of(ui), palette_of(ui));
    let ids = session.params().clip_ids(Key::MatchClips);
    if ids.is_empty() {
        kit::note_ui(text::MADE_SET, palette.muted, ui);
    }
    let set = |ids: Vec<String>, out: &mut Out| {
        out.set_once(Key::MatchClips, List::ClipIds(ids).into());
    };
    let mut added = None;
    let dropped = clip_list_ui(session, ui, |ui| {
        for (index, id) in ids.iter().enumerate() {
            ui.push_id(("clip", index), |ui| {
                ui.horizontal(|ui| {
                    let entry = session.library().find(id);
                    let name = entry.map_or_else(|| Message::data(&**id), |entry| entry.title());
                    let leave_out = text::leave_clip_out(name.clone());
                    if kit::icon_button_ui(Icon::Close, &leave_out, ui).clicked() {
                        let mut rest = ids.to_vec();
                        rest.remove(index);
                        set(rest, out);
                    }
                    ui.label(RichText::new(say(&name, ui)).font(theme.font(Type::Body)));
                });
            });
        }
        added = add_clip_ui(session, |_| true, ui);
    });
    if let Some(id) = added.or(dropped) {
        let mut more = ids.to_vec();
        more.push(id);
        set(more, out);
    }
    if let Some((driven, _)) = shown(session) {
        let skipped = driven.database.skipped();
        kit::note_ui(&text::database(&driven.database), palette.muted, ui);
        for error in skipped.iter().take(3) {
            kit::note_ui(&error.to_sentence(), palette.warning, ui);
        }
    }
    row(Key::Mirrored, session, out, ui);
    row(Key::MatchCycles, session, out, ui);
    let motions = || {
        let entries = ids.iter().filter_map(|id| session.library().find(id));
        entries.filter_map(|entry| entry.motion.as_ref())
    };
    let skeleton = |motion: &Arc<Motion>| Arc::clone(motion.clip().skeleton());
    let built = shown(session).map(|(driven, _)| driven.database.retargeted());
    let moved: Vec<_> = (built.into_iter().flatten())
        .map(|(name, errors)| (Some(session.clip_title(name)), errors))
        .collect();
    if !moved.is_empty() {
        retarget_rows_ui(&moved, session, out, ui);
    } else if motions()
        .skip(1)
        .any(|motion| Some(skeleton(motion)) != motions().next().map(skeleton))
    {
        for key in
            [Key::RetargetFeet, Key::RetargetRightFoot, Key::RetargetHands, Key::RetargetRightHand]
        {
            row(key, session, out, ui);
        }
    }
    if session.is_driven() {
        row(Key::Crowd, session, out, ui);
    }
}
