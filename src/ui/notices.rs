//! The chip with the notices, in the head row of a panel: never over the stage.

use super::kit::{self, Mood, Notice, NoticeChip, NoticeEvent};
use super::language::Word;
use super::out::Out;
use super::state::UiState;
use super::text;
use eframe::egui::Ui;
use segue_session::{Command, FileCommand, Level, Notices, Session};
use segue_text::Message;

/// The text of the chip.
#[derive(Clone, Debug, Default, PartialEq)]
struct Summary {
    text: Message,
    mood: Mood,
    /// The full text of the new notices.
    news: Message,
    is_alert: bool,
}

/// Draws the chip of the notices, and the list of them where it is open.
pub(crate) fn notices_ui(session: &Session, state: &mut UiState, out: &mut Out, ui: &mut Ui) {
    let notices = session.notices();
    let (Some(place), Some(summary)) =
        (state.notice_place, summary_of(notices, state.seen_notices))
    else {
        return;
    };
    let list = notices.list();
    let shown: Vec<Notice<'_>> = list
        .iter()
        .map(|notice| Notice {
            text: &notice.text,
            mood: mood_of(notice.level),
            action: match notice.corrections.len() {
                0 => Word::default(),
                1 => text::CORRECT,
                _ => text::CORRECT_ALL,
            },
        })
        .collect();
    let chip = NoticeChip {
        text: &summary.text,
        mood: summary.mood,
        news: &summary.news,
        is_alert: summary.is_alert,
        row: place.row,
        heading_end: place.heading_end,
    };
    let heard = kit::notices_ui(&chip, &shown, ui);
    if heard.is_open {
        let newest = list.iter().map(|notice| notice.id + 1).max();
        state.seen_notices = newest.unwrap_or_default().max(state.seen_notices);
    }
    if let Some((index, event)) = heard.event
        && let Some(notice) = list.get(index)
    {
        out.commands.push(match event {
            NoticeEvent::Acted => Command::File(FileCommand::Correct(notice.id)),
            NoticeEvent::Dismissed => Command::Dismiss(notice.id),
        });
    }
    if heard.dismissed_all {
        out.commands.extend(list.iter().map(|notice| Command::Dismiss(notice.id)));
    }
}

fn mood_of(level: Level) -> Mood {
    match level {
        Level::Info => Mood::Plain,
        Level::Warning => Mood::Warning,
        Level::Error => Mood::Bad,
    }
}

/// Returns the text of the chip: failures until they were seen, new notices for a moment, and then
/// the number of open notices. `seen` is the number of the first notice that was not in the open
/// list.
fn summary_of(notices: &Notices, seen: u64) -> Option<Summary> {
    let list = notices.list();
    let failures: Vec<_> =
        list.iter().filter(|notice| notice.level == Level::Error && notice.id >= seen).collect();
    let new = list.iter().rev().find(|notice| notice.is_fresh());
    let (text, mood) = match (notices.added(), failures.as_slice(), new) {
        (Some(added), [], _) => {
            let mood = if added.with_notes > 0 { Mood::Warning } else { Mood::Good };
            (text::added(added, 0), mood)
        }
        (Some(added), failures, _) => (text::added(added, failures.len()), Mood::Bad),
        (None, [failure], _) => (failure.text.clone(), Mood::Bad),
        (None, [_, _, ..], _) => (text::errors(failures.len()), Mood::Bad),
        (None, [], Some(new)) => (new.text.clone(), mood_of(new.level)),
        (None, [], None) if list.is_empty() => return None,
        (None, [], None) => {
            let is_unseen = list.iter().any(|notice| notice.id >= seen);
            let mood = if is_unseen { Mood::Warning } else { Mood::Plain };
            (text::notes(list.len()), mood)
        }
    };
    let news = new.map_or_else(|| text.clone(), |new| new.text.clone());
    let is_alert = new.is_some_and(|new| new.level != Level::Info);
    Some(Summary { text, mood, news, is_alert })
}

#[cfg(test)]
mod tests {
    use super::*;
    use segue_session::AddedClips;

    fn says(notices: &Notices, seen: u64) -> (String, Mood) {
        let summary = summary_of(notices, seen).expect("there are notices");
        (summary.text.to_string(), summary.mood)
    }

    #[test]
    fn chip_counts_clips_then_notes() {
        let mut notices = Notices::default();
        assert_eq!(summary_of(&notices, 0), None);
        notices.count_added(AddedClips { clips: 11, with_notes: 2 });
        notices.say(Level::Warning, "one is odd");
        notices.say(Level::Warning, "one has no unit");
        notices.count_added(AddedClips { clips: 1, with_notes: 0 });
        assert_eq!(says(&notices, 0), ("12 clips added · 2 with notes".into(), Mood::Warning));
        assert_eq!(
            summary_of(&notices, 0).map(|summary| (summary.news.to_string(), summary.is_alert)),
            Some(("one has no unit".into(), true)),
            "a screen reader hears all of it"
        );
        notices.tick(5.0);
        assert_eq!(says(&notices, 0), ("2 notes".into(), Mood::Warning));
        assert_eq!(says(&notices, 2), ("2 notes".into(), Mood::Plain), "they were seen");
        notices.say(Level::Info, "Link copied.");
        assert_eq!(says(&notices, 0), ("Link copied.".into(), Mood::Plain));
    }

    #[test]
    fn chip_keeps_failures_until_they_were_seen() {
        let mut notices = Notices::default();
        notices.count_added(AddedClips { clips: 1, with_notes: 0 });
        notices.say(Level::Error, "x.bvh is empty");
        assert_eq!(says(&notices, 0), ("1 clip added · 1 error".into(), Mood::Bad));
        notices.tick(60.0);
        assert_eq!(says(&notices, 0), ("x.bvh is empty".into(), Mood::Bad));
        let seen = notices.list()[0].id + 1;
        assert_eq!(says(&notices, seen), ("1 note".into(), Mood::Plain));
        for n in 0..3 {
            notices.say(Level::Error, format!("{n}.bvh is empty"));
        }
        notices.tick(60.0);
        assert_eq!(says(&notices, seen), ("3 errors".into(), Mood::Bad));
    }
}
