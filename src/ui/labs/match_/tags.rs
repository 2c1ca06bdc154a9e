//! Tags that are set by hand on stretches of clips, and the tags of the search.

use super::present::shown;
use super::strip::strip_place;
use crate::ui::kit::{self, Button, Chosen, Icon, SliderRow};
use crate::ui::language::Word;
use crate::ui::out::Out;
use crate::ui::state::UiState;
use crate::ui::text;
use crate::ui::theme::{palette_of, space};
use eframe::egui::{Ui, vec2};
use segue_motion::matching::{Database, DatabaseClip, RATE, Tag};
use segue_session::{HandTag, Key, List, Session, Value, own_words};
use segue_text::Message;

/// The reach of "Select what is playing" to either side, frames.
const AROUND: usize = 15;

/// Draws the rows of the section.
pub(crate) fn tags_ui(session: &Session, state: &mut UiState, out: &mut Out, ui: &mut Ui) {
    let muted = palette_of(ui).muted;
    let tags = session.params().tags();
    for (key, word) in [(Key::AskTag, "any"), (Key::ForbidTag, "nothing")] {
        wanted_ui(key, word, tags, session, out, ui);
    }
    kit::note_ui(text::TAGS_HELP, muted, ui);
    for (index, tag) in tags.iter().enumerate() {
        ui.horizontal(|ui| {
            ui.push_id(("tag", index), |ui| {
                if kit::icon_button_ui(Icon::Close, text::TAKE_TAG_AWAY, ui).clicked() {
                    let mut rest = tags.to_vec();
                    rest.remove(index);
                    set(rest, out);
                }
            });
            let name = match session.library().find(&tag.clip) {
                Some(entry) => entry.title(),
                None => session.clip_title(&tag.clip),
            };
            kit::note_ui(&text::hand_tag(name, tag), palette_of(ui).text, ui);
        });
    }
    let Some((driven, moment)) = shown(session) else {
        return;
    };
    if kit::button_ui(Button::new(text::TAG_WHAT_PLAYS), ui).clicked() {
        state.labs.match_.stretch = strip_place(&driven.database, moment.place).map(|at| Chosen {
            bar: at.bar,
            frames: at.frame.saturating_sub(AROUND)..at.frame + AROUND,
        });
    }
    let Some(stretch) = &mut state.labs.match_.stretch else {
        return;
    };
    let Some(motion) = motion_of(&driven.database, stretch.bar) else {
        state.labs.match_.stretch = None;
        return;
    };
    let ids = session.params().clip_ids(Key::MatchClips);
    let clip = ids.get(motion.source()).map_or(motion.clip().name(), String::as_str);
    let frames = motion.frames();
    let secs = |frame: usize| frame as f64 / RATE as f64;
    for (label, end) in [
        (text::STRETCH_FROM, &mut stretch.frames.start),
        (text::STRETCH_TO, &mut stretch.frames.end),
    ] {
        let row = SliderRow::new(label, 0.0..=secs(frames).max(0.1), 0.0)
            .unit(Word::new("s"))
            .step(1.0 / RATE as f64)
            .decimals(2);
        let response = kit::slider_row_ui(secs((*end).min(frames)), &row, ui);
        if let Some(value) = response.changed {
            *end = (value * RATE as f64).round() as usize;
        }
    }
    let (from, to) = (
        stretch.frames.start.min(stretch.frames.end),
        stretch.frames.end.max(stretch.frames.start).min(frames),
    );
    if from >= to {
        return;
    }
    let add = |word: &str, takes_away: bool, out: &mut Out| {
        let tag = HandTag {
            clip: clip.to_owned(),
            // Rounded to hundredths, as in the rows.
            secs: [from, to].map(|frame| (secs(frame) * 100.0).round() / 100.0),
            word: word.to_owned(),
            takes_away,
        };
        set(tags.iter().cloned().chain([tag]).collect(), out);
    };
    ui.horizontal_wrapped(|ui| {
        ui.spacing_mut().item_spacing = vec2(space::XS, space::XS);
        let has = |tag: Tag| {
            let mut ranges = motion.tags().iter();
            ranges
                .any(|range| range.tag == tag && range.frames.start < to && from < range.frames.end)
        };
        for tag in Tag::FIXED {
            // The button toggles the tag.
            let takes_away = has(tag);
            if kit::button_ui(Button::new(&text::tag_as(tag.name(), takes_away)), ui).clicked() {
                add(tag.name(), takes_away, out);
            }
        }
        for word in own_words(tags) {
            if kit::button_ui(Button::new(&text::tag_as(word, false)), ui).clicked() {
                add(word, false, out);
            }
        }
    });
    let field =
        kit::text_field_ui(text::OWN_WORD, text::TYPE_A_WORD, &mut state.labs.match_.word, ui);
    if field.committed && !state.labs.match_.word.trim().is_empty() {
        add(std::mem::take(&mut state.labs.match_.word).trim(), false, out);
    }
}

fn set(tags: Vec<HandTag>, out: &mut Out) {
    out.set_once(Key::Tags, List::Tags(tags).into());
}

/// Returns the clip of a bar in the strip.
fn motion_of(database: &Database, bar: usize) -> Option<&DatabaseClip> {
    let originals = database.motions().iter().filter(|motion| !motion.is_mirrored());
    originals.map(|motion| &**motion).nth(bar)
}

/// Draws the choice of a tag that is required, or forbidden.
fn wanted_ui(
    key: Key,
    none: &'static str,
    tags: &[HandTag],
    session: &Session,
    out: &mut Out,
    ui: &mut Ui,
) {
    let searched =
        Tag::FIXED.into_iter().filter(|tag| *tag != Tag::Exclude).map(|tag| -> &str { tag.name() });
    let words: Vec<&str> = std::iter::once(none).chain(searched).chain(own_words(tags)).collect();
    let names: Vec<Message> = std::iter::once(none.into())
        .chain(words.iter().skip(1).map(|word| text::tag_name(word)))
        .collect();
    let options: Vec<(usize, &Message)> = names.iter().enumerate().collect();
    let asked = session.params().text(key);
    let chosen = words.iter().position(|word| *word == asked).unwrap_or(usize::MAX);
    let picked = kit::choice_row_ui(Word::new(key.param().label), chosen, &options, ui);
    if let Some(word) = picked.and_then(|index| words.get(index)) {
        out.set_once(key, Value::Text((*word).to_owned()));
    }
}
