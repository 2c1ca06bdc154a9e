//! The rows that panels of several labs share.

mod clip_sets;
mod footer;
mod param;
mod remedies;
mod retarget;
mod retarget_errors;
mod save;

pub(crate) use clip_sets::clip_sets_ui;
pub(crate) use footer::{KeepOffer, footer_ui};
pub(crate) use param::{Detail, compare_choice_ui, param_row_ui};
pub(crate) use remedies::{body_parts_asked_for, remedy_buttons_ui};
pub(crate) use retarget::retarget_rows_ui;
pub(crate) use save::{format_rows_ui, save_rows_ui};

use super::clip_drag::clip_dropped_on;
use super::kit::{self, Button};
use super::language::{Text, Word, say};
use super::out::Out;
use super::text;
use super::theme::{Type, palette_of, space, theme_of};
use eframe::egui::{self, Ui};
use segue_motion::transition::has_legs;
use segue_session::outside::short;
use segue_session::{Command, Entry, Key, Mark, PARAMS, Session, Slot, split_reference};
use segue_text::{Message, msg};
/// Draws the rows of the foot lock, those about reading contacts, and why the feet cannot be
/// locked.
pub(crate) fn foot_rows_ui(session: &Session, out: &mut Out, ui: &mut Ui) {
    param_row_ui(Key::FootLock, &Detail::default(), session, out, ui);
    if session.params().is_on(Key::FootLock)
        && let Some(outcome) = session.main_outcome()
        && !has_legs(outcome.motion.clip().skeleton(), outcome.motion.roles())
    {
        let words =
            egui::RichText::new(say(text::NO_LEGS, ui)).font(theme_of(ui).font(Type::Small));
        ui.label(words.color(palette_of(ui).warning));
    }
    kit::folded_ui(text::FEET, ui, |ui| {
        let mut rows_ui = |mark: Mark| {
            for param in PARAMS.iter().filter(|param| param.has(mark) && param.key != Key::FootLock)
            {
                param_row_ui(param.key, &Detail::default(), session, out, ui);
            }
        };
        if session.params().is_on(Key::FootLock) {
            rows_ui(Mark::Lock);
        }
        rows_ui(Mark::Feet);
    });
}

/// Draws the choices of both clips, with notes where B was retargeted or resampled. Returns the
/// frame rate of the result.
pub(crate) fn pair_ui(session: &Session, out: &mut Out, ui: &mut Ui) -> f64 {
    slot_row_ui(Slot::A, session, out, ui);
    slot_row_ui(Slot::B, session, out, ui);
    let outcome = session.main_outcome();
    if let Some(retargeted) = outcome.and_then(|outcome| outcome.retargeted.as_ref()) {
        let words = egui::RichText::new(say(&text::retargeted(retargeted), ui))
            .font(theme_of(ui).font(Type::Small));
        let line = ui.label(words.color(palette_of(ui).muted));
        if !retargeted.unmatched.is_empty() {
            let names = msg!("{names}", names = retargeted.unmatched.clone());
            line.on_hover_text(say(&names, ui));
        }
        let errors: Vec<_> = retargeted.errors.iter().map(|errors| (None, errors)).collect();
        retarget_rows_ui(&errors, session, out, ui);
    }
    let rate = |slot| Some(session.slot(slot)?.motion.as_ref()?.clip().fps());
    if let (Some(a), Some(b)) = (rate(Slot::A), rate(Slot::B))
        && (a - b).abs() > 1e-4 * a
    {
        let words = egui::RichText::new(say(&text::resampled(b, a), ui))
            .font(theme_of(ui).font(Type::Small));
        ui.label(words.color(palette_of(ui).muted));
    }
    ui.add_space(space::S);
    outcome.map_or(60.0, |outcome| outcome.motion.clip().fps())
}

/// Draws the rows of where A is left and B entered, in seconds or in frames of each clip. The help
/// says how they were found.
pub(crate) fn place_rows_ui(keys: [Key; 2], session: &Session, out: &mut Out, ui: &mut Ui) {
    let automatic = keys.map(|key| session.params().optional(key).is_none());
    // Both were found together, so that this is said once.
    let said_at = usize::from(automatic == [false, true]);
    let transition = session.main_outcome().and_then(|outcome| outcome.transition);
    let search = transition.and_then(|transition| transition.search);
    for (index, (key, slot)) in keys.into_iter().zip([Slot::A, Slot::B]).enumerate() {
        let motion = session.slot(slot).and_then(|entry| entry.motion.as_ref());
        let latest_secs = motion.map(|motion| {
            let end = motion.clip().duration_secs();
            search.map_or(end, |search| search.latest_secs[index].min(end))
        });
        let in_frames =
            |secs: f64| motion.map_or(secs, |motion| (secs * motion.clip().fps()).round());
        let max =
            latest_secs.map(|secs| if key.param().unit == "s" { secs } else { in_frames(secs) });
        let more = match (said_at == index, automatic[index]) {
            (true, _) => found_sentence(session, automatic),
            (false, true) => Message::default(),
            (false, false) => text::BY_HAND.into(),
        };
        let detail = Detail {
            max,
            used: max
                .filter(|&max| session.params().optional(key).is_some_and(|given| given > max)),
            more: Some(more),
            ..Detail::default()
        };
        param_row_ui(key, &detail, session, out, ui);
    }
}

/// Returns how the place was found, with its distance where that is known.
fn found_sentence(session: &Session, automatic: [bool; 2]) -> Message {
    if session.jobs().iter().any(segue_session::Job::is_computed) {
        return "Finding the best match…".into();
    }
    match session.main_outcome().and_then(|outcome| outcome.transition) {
        Some(transition) => text::place_found(&transition, automatic),
        None => Message::from(text::FOUND).sentence(),
    }
}

/// Draws the choice of the clip in a slot.
pub(crate) fn slot_row_ui(slot: Slot, session: &Session, out: &mut Out, ui: &mut Ui) {
    let chosen = session.params().text(slot.key());
    let row = ui.scope(|ui| clip_choice_ui(Word::new(slot.label()), chosen, session, ui));
    let what = |clip| text::use_as(clip, slot);
    let dropped = clip_dropped_on(row.response.rect, session, what, ui);
    if let Some(id) = row.inner.or(dropped) {
        out.commands.push(Command::Assign(slot, id));
    }
}

/// Draws a list of clips. Returns the id of a clip that was dropped on it.
pub(crate) fn clip_list_ui(
    session: &Session,
    ui: &mut Ui,
    content: impl FnOnce(&mut Ui),
) -> Option<String> {
    let list = ui.scope(content);
    clip_dropped_on(list.response.rect, session, text::add_to_list, ui)
}

/// Draws a choice of the library's clips. Returns the id of a new choice.
pub(crate) fn clip_choice_ui<'a>(
    label: impl Into<Text<'a>>,
    chosen: &str,
    session: &Session,
    ui: &mut Ui,
) -> Option<String> {
    let entries = session.library().entries();
    let found = session.library().find(chosen);
    let found = found.and_then(|entry| entries.iter().position(|other| other.id == entry.id));
    let missing = (found.is_none() && !chosen.is_empty())
        .then(|| (usize::MAX, text::missing(&short(split_reference(chosen).0))));
    // A clip that is missing is shown, but cannot be chosen.
    let named: Vec<(usize, Message)> =
        entries.iter().map(|entry| entry.title()).enumerate().chain(missing).collect();
    let options: Vec<(usize, &Message)> =
        named.iter().map(|(index, name)| (*index, name)).collect();
    let (label, chosen) = (label.into(), found.unwrap_or(usize::MAX));
    let picked =
        ui.push_id(label.english(), |ui| kit::choice_row_ui(label, chosen, &options, ui)).inner;
    Some(entries.get(picked?)?.id.clone())
}

/// Shows a menu of the clips that may be added. Returns the id of the one that was picked.
pub(crate) fn add_clip_ui(
    session: &Session,
    may_be_added: impl Fn(&Entry) -> bool,
    ui: &mut Ui,
) -> Option<String> {
    let entries = session.library().entries().iter();
    let entries: Vec<&Entry> =
        entries.map(|entry| &**entry).filter(|entry| may_be_added(entry)).collect();
    let titles: Vec<Message> = entries.iter().map(|entry| entry.title()).collect();
    let options: Vec<(Option<usize>, Text<'_>)> = std::iter::once((None, text::CHOOSE_CLIP.into()))
        .chain(titles.iter().enumerate().map(|(index, title)| (Some(index), title.into())))
        .collect();
    let picked = kit::choice_row_ui(text::ADD_CLIP, None, &options, ui).flatten();
    Some(entries.get(picked?)?.id.clone())
}

/// Draws the button that compares the full value, a half and a third of it. The rows of the
/// compared values have the way back.
pub(crate) fn compare_ui(key: Key, session: &Session, out: &mut Out, ui: &mut Ui) {
    let on = session.compare().is_some_and(|compare| compare.key == key);
    if !on
        && kit::button_ui(Button::new(text::FULL_HALF_THIRD).hint(text::COMPARE_HELP), ui).clicked()
    {
        out.commands.push(Command::Compare(key));
    }
}

/// Returns the number of frames that both clips have, at A's rate: no window is longer. `None`
/// while neither clip is there.
pub(crate) fn frames_of_both(session: &Session) -> Option<f64> {
    let clips = [Slot::A, Slot::B]
        .into_iter()
        .filter_map(|slot| Some(session.slot(slot)?.motion.as_ref()?.clip()));
    let clips: Vec<_> = clips.collect();
    let fps = clips.first()?.fps();
    // B is resampled to A's rate, and keeps both ends.
    let frames = clips.iter().map(|clip| (clip.duration_secs() * fps).round() + 1.0);
    frames.min_by(f64::total_cmp)
}

/// Draws the slider of the blend window. A window that is longer than a clip is shown as long as
/// the result has it.
pub(crate) fn blend_window_ui(session: &Session, out: &mut Out, ui: &mut Ui) {
    let max = frames_of_both(session);
    let window = session.params().number(Key::BlendWindow);
    let detail = Detail { max, used: max.filter(|max| window > *max), ..Detail::default() };
    param_row_ui(Key::BlendWindow, &detail, session, out, ui);
}

/// Returns the name of the lab that is open.
pub(crate) fn lab_label(session: &Session) -> Word {
    Word::new(session.params().lab().label())
}
