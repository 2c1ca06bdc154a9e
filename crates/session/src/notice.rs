//! Notices: messages to the user that stay until they are read or outdated.

use super::outside::short;
use segue_motion::math::sort::sort_by_key;
use segue_text::{Message, msg};

/// The severity of a notice.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Level {
    /// Information; disappears by itself.
    Info,
    /// A deviation from what was asked for; stays until dismissed.
    Warning,
    /// A failure; stays until dismissed.
    Error,
}

/// A message to the user.
#[derive(Clone, Debug, PartialEq)]
pub struct Notice {
    /// Its number, by which it is dismissed.
    pub id: u64,
    /// The severity.
    pub level: Level,
    /// The event and the remedy, in a sentence or two.
    pub text: Message,
    /// The subject in a word: a file, a key. It replaces the text where a row has no room for more.
    pub about: String,
    /// Ids of the clips that can be read better:
    /// [`FileCommand::Correct`](super::FileCommand::Correct) does it.
    pub corrections: Vec<String>,
    /// The missing clip that it asks for.
    awaits: Option<String>,
    age_secs: f64,
}

impl Notice {
    /// Returns whether it was added only a moment ago.
    #[must_use]
    pub fn is_fresh(&self) -> bool {
        self.age_secs < FRESH_SECS
    }
}

/// A number of clips that joined the library.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct AddedClips {
    /// All of them.
    pub clips: usize,
    /// Those with warnings about their file.
    pub with_notes: usize,
}

/// The clips that were added lately, shortly one after the other.
#[derive(Clone, Debug, Default)]
struct Lately {
    added: AddedClips,
    /// The files that one notice names or counts.
    files: Vec<String>,
    /// The number of that notice.
    notice: Option<u64>,
    age_secs: f64,
}

/// The notices on screen, oldest first.
#[derive(Clone, Debug, Default)]
pub struct Notices {
    list: Vec<Notice>,
    /// Errors for which there was no room. One entry of the list summarises them.
    more: Vec<Notice>,
    /// The number of that entry.
    sum: Option<u64>,
    lately: Option<Lately>,
    next_id: u64,
}

/// The duration of an [`Level::Info`], and the time for which any notice is new, seconds.
const FRESH_SECS: f64 = 4.0;
/// The greatest number of notices at once.
const MAX_NOTICES: usize = 6;
/// The greatest number of notices that stay until dismissed: there is always room for an
/// [`Level::Info`].
const MAX_LASTING: usize = MAX_NOTICES - 1;
/// The greatest number of errors among them, including the summary of the rest.
const MAX_ERRORS: usize = MAX_LASTING - 1;
/// The greatest number of failures that the summary names.
const MAX_NAMED: usize = 24;

impl Notices {
    /// Adds a notice. A repeated text moves to the end instead of appearing twice.
    pub fn say(&mut self, level: Level, text: impl Into<Message>) {
        let text = text.into();
        let about = text.subject().map_or_else(|| text.to_string(), str::to_owned);
        self.put(level, text, &about, None);
    }

    /// Adds a notice about a file or key.
    pub fn say_of(&mut self, level: Level, about: &str, text: impl Into<Message>) {
        self.put(level, text.into(), about, None);
    }

    /// Counts clips that joined the library. Those of several files that arrive one after the other
    /// are counted together.
    pub fn count_added(&mut self, more: AddedClips) {
        let lately = self.lately.get_or_insert_default();
        lately.added.clips += more.clips;
        lately.added.with_notes += more.with_notes;
        lately.age_secs = 0.0;
    }

    /// Returns how many clips were added lately; `None` if that is some time ago.
    #[must_use]
    pub fn added(&self) -> Option<AddedClips> {
        self.lately.as_ref().map(|lately| lately.added).filter(|added| added.clips > 0)
    }

    /// Adds the notice that files are in the library. One notice names or counts all that arrive
    /// one after the other.
    pub fn say_added(&mut self, mut names: Vec<String>) {
        let mut lately = self.lately.take().unwrap_or_default();
        if let Some(before) = lately.notice.take() {
            self.list.retain(|notice| notice.id != before);
        }
        lately.files.append(&mut names);
        lately.age_secs = 0.0;
        if let Some(text) = in_the_library(&lately.files) {
            lately.notice = Some(self.next_id);
            self.say(Level::Info, text);
        }
        self.lately = Some(lately);
    }

    /// Adds a warning about clips, by id, that another import can fix.
    pub fn offer(&mut self, text: impl Into<Message>, clips: Vec<String>) {
        let about = clips.first().cloned().unwrap_or_default();
        self.put(Level::Warning, text.into(), &about, None);
        if let Some(notice) = self.list.last_mut() {
            notice.corrections = clips;
        }
    }

    /// Removes the notice that offers to fix clips, and returns their ids.
    pub fn take_offer(&mut self) -> Vec<String> {
        let at = self.list.iter().position(|notice| !notice.corrections.is_empty());
        at.map(|at| self.list.remove(at).corrections).unwrap_or_default()
    }

    /// Adds a notice that a clip is missing. It stays until [`Notices::keep_missing`] finds the
    /// clip.
    pub fn say_missing(&mut self, reference: &str, text: impl Into<Message>) {
        self.put(Level::Warning, text.into(), reference, Some(reference.to_owned()));
    }

    /// Returns the missing clips.
    pub fn awaited(&self) -> impl Iterator<Item = &str> {
        self.list.iter().filter_map(|notice| notice.awaits.as_deref())
    }

    /// Removes notices about clips that have arrived or are no longer needed.
    pub fn keep_missing(&mut self, is_missing: impl Fn(&str) -> bool) {
        self.list.retain(|notice| notice.awaits.as_deref().is_none_or(&is_missing));
    }

    fn put(&mut self, level: Level, text: Message, about: &str, awaits: Option<String>) {
        self.list.retain(|notice| notice.text != text);
        self.more.retain(|notice| notice.text != text);
        let notice = Notice {
            id: self.next_id,
            level,
            text,
            about: short(about),
            corrections: Vec::new(),
            awaits,
            age_secs: 0.0,
        };
        self.next_id += 1;
        if level == Level::Error && self.count(Level::Error) >= MAX_ERRORS {
            self.sum_up(notice);
            return;
        }
        self.list.push(notice);
        self.make_room();
    }

    fn count(&self, level: Level) -> usize {
        self.list.iter().filter(|notice| notice.level == level).count()
    }

    /// Removes infos first, then warnings, the oldest of each; never an error.
    fn make_room(&mut self) {
        let lasting = self.list.len() - self.count(Level::Info);
        if lasting > MAX_LASTING {
            self.drop_oldest(Level::Warning);
        }
        while self.list.len() > MAX_NOTICES && self.drop_oldest(Level::Info) {}
    }

    fn drop_oldest(&mut self, level: Level) -> bool {
        let of_level = |notice: &Notice| notice.level == level;
        // Notices with a fix stay longest within their level.
        let plain =
            self.list.iter().position(|notice| of_level(notice) && notice.corrections.is_empty());
        let at = plain.or_else(|| self.list.iter().position(of_level));
        at.map(|at| self.list.remove(at)).is_some()
    }

    /// Adds an error for which there is no room to the summary, which replaces the last error with
    /// an entry of its own.
    fn sum_up(&mut self, error: Notice) {
        let last = match self.sum {
            Some(sum) => self.list.iter().position(|notice| notice.id == sum),
            None => self.list.iter().rposition(|notice| notice.level == Level::Error),
        };
        let last = last.map(|at| self.list.remove(at));
        self.more.extend(last.filter(|notice| Some(notice.id) != self.sum));
        self.more.push(error);
        let mut named: Vec<String> =
            self.more.iter().take(MAX_NAMED).map(|notice| notice.about.clone()).collect();
        if self.more.len() > MAX_NAMED {
            named.push("…".to_owned());
        }
        let text = msg!("{count} more failed: {named}.", count = self.more.len(), named);
        self.sum = Some(self.next_id);
        self.list.push(Notice {
            id: self.next_id,
            level: Level::Error,
            text,
            about: String::new(),
            corrections: Vec::new(),
            awaits: None,
            age_secs: 0.0,
        });
        self.next_id += 1;
    }

    /// Removes a notice.
    pub fn dismiss(&mut self, id: u64) {
        self.list.retain(|notice| notice.id != id);
        if self.sum == Some(id) {
            self.sum = None;
            self.more.clear();
        }
    }

    /// Returns all errors since the one with that number, including the summarised ones, in order
    /// of arrival.
    #[must_use]
    pub fn errors_since(&self, id: u64) -> Vec<&Notice> {
        let of_list = self.list.iter().filter(|notice| Some(notice.id) != self.sum);
        let errors = of_list.chain(&self.more);
        let mut errors: Vec<&Notice> =
            errors.filter(|notice| notice.level == Level::Error && notice.id >= id).collect();
        sort_by_key(&mut errors, |notice| notice.id);
        errors
    }

    /// Advances the time; returns whether a notice disappeared or is new no longer.
    pub fn tick(&mut self, dt_secs: f64) -> bool {
        let fresh = |notices: &Self| {
            let list = notices.list.iter().filter(|notice| notice.is_fresh()).count();
            list + usize::from(notices.lately.is_some())
        };
        let before = fresh(self);
        for notice in &mut self.list {
            notice.age_secs += dt_secs;
        }
        self.list.retain(|notice| notice.level != Level::Info || notice.is_fresh());
        self.lately = self.lately.take().and_then(|lately| {
            let age_secs = lately.age_secs + dt_secs;
            (age_secs < FRESH_SECS).then_some(Lately { age_secs, ..lately })
        });
        fresh(self) < before
    }

    /// Returns the seconds until the next notice disappears by itself, or is new no longer.
    #[must_use]
    pub fn next_change_secs(&self) -> Option<f64> {
        let ages = self.list.iter().map(|notice| notice.age_secs);
        let ages = ages.chain(self.lately.as_ref().map(|lately| lately.age_secs));
        let waits = ages.map(|age| FRESH_SECS - age).filter(|wait| *wait > 0.0);
        waits.min_by(f64::total_cmp)
    }

    /// Returns the notices, oldest first.
    #[must_use]
    pub fn list(&self) -> &[Notice] {
        &self.list
    }
}

/// Returns "walk.bvh is in the library."; `None` without a name.
pub(crate) fn in_the_library(names: &[String]) -> Option<Message> {
    match names {
        [] => None,
        [name] => Some(msg!("Added to the library: {name}.")),
        several => Some(msg!("Added {count} files to the library.", count = several.len())),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn texts(notices: &Notices) -> Vec<String> {
        notices.list().iter().map(|notice| notice.text.to_string()).collect()
    }

    #[test]
    fn notices_without_room_drop_infos_then_warnings() {
        let mut notices = Notices::default();
        for (level, text) in [
            (Level::Error, "e1"),
            (Level::Warning, "w1"),
            (Level::Warning, "w2"),
            (Level::Info, "i1"),
            (Level::Info, "i2"),
            (Level::Info, "i3"),
        ] {
            notices.say(level, text);
        }
        notices.say(Level::Info, "i4");
        assert_eq!(texts(&notices), ["e1", "w1", "w2", "i2", "i3", "i4"]);
        for text in ["e2", "e3"] {
            notices.say(Level::Error, text);
        }
        assert_eq!(texts(&notices), ["e1", "w1", "w2", "i4", "e2", "e3"]);
        notices.say(Level::Info, "i5");
        assert_eq!(texts(&notices), ["e1", "w1", "w2", "e2", "e3", "i5"]);
        notices.say(Level::Warning, "w3");
        assert_eq!(texts(&notices), ["e1", "w2", "e2", "e3", "i5", "w3"]);
    }

    #[test]
    fn notices_keep_every_error() {
        let mut notices = Notices::default();
        let errors: Vec<Message> = (0..40)
            .map(|n| msg!("{file}:1:2: found `x`, expected `y`", file = format!("f{n}.bvh")))
            .collect();
        for (n, error) in errors.iter().enumerate() {
            notices.say(Level::Error, error.clone());
            notices.say(Level::Info, format!("info {n}"));
            if n == 5 {
                assert_eq!(
                    texts(&notices)[..3],
                    [0, 1, 2].map(|n| errors[n].to_string()),
                    "the first ones stand there as they are"
                );
                assert!(
                    texts(&notices).contains(&"3 more failed: f3.bvh, f4.bvh, f5.bvh.".to_owned())
                );
            }
        }
        assert!(notices.list().len() <= MAX_NOTICES);
        let sum = notices
            .list()
            .iter()
            .find(|notice| notice.text.to_string().starts_with("37 more"))
            .unwrap();
        assert!(sum.text.to_string().ends_with("f26.bvh, …."), "{}", sum.text);
        // Listeners receive each error once.
        let heard: Vec<&Message> =
            notices.errors_since(0).iter().map(|notice| &notice.text).collect();
        assert_eq!(heard, errors.iter().collect::<Vec<_>>());
        let last = notices.errors_since(0).last().unwrap().id;
        assert_eq!(notices.errors_since(last + 1).len(), 0);
        let id = sum.id;
        notices.dismiss(id);
        notices.say_of(Level::Error, "x.bvh", "x.bvh could not be read: gone.");
        assert_eq!(notices.errors_since(0).len(), 4);
        notices.say_of(Level::Error, "y.bvh", "y.bvh: gone.");
        assert!(texts(&notices).contains(&"2 more failed: x.bvh, y.bvh.".to_owned()));
    }

    #[test]
    fn summary_names_files_and_keys() {
        let mut notices = Notices::default();
        for text in ["1", "2", "3", "4"] {
            notices.say(Level::Error, text);
        }
        notices.say_of(
            Level::Error,
            "walk.bvh",
            "There is no file at https://a.org/walk.bvh (answer 404).",
        );
        let file = "a/b.bvh".to_owned();
        notices.say(Level::Error, msg!("{file}:12:3: found `x`, expected a number"));
        let inner = msg!("`{file}`: gone", file = "y".repeat(500));
        notices.say(Level::Error, msg!("No result: {inner}."));
        let sum = texts(&notices).pop().unwrap();
        let long = short(&"y".repeat(500));
        assert_eq!(sum, format!("4 more failed: 4, walk.bvh, a/b.bvh, {long}."));
    }

    #[test]
    fn notices_with_a_fix_outlast_other_warnings() {
        let mut notices = Notices::default();
        notices.offer("too tall", vec!["x~12".to_owned()]);
        for n in 0..10 {
            notices.say(Level::Warning, format!("{n}"));
        }
        assert_eq!(texts(&notices), ["too tall", "6", "7", "8", "9"]);
        assert_eq!(notices.take_offer(), ["x~12"]);
        assert_eq!((notices.list().len(), notices.take_offer().len()), (4, 0));
    }

    #[test]
    fn notices_of_missing_clips_stay_until_they_arrive() {
        let mut notices = Notices::default();
        notices.say_missing("walk~1234", "drop walk");
        notices.say_missing("run~5678", "drop run");
        notices.say(Level::Warning, "odd");
        notices.keep_missing(|reference| reference == "run~5678");
        let left: Vec<String> =
            notices.list().iter().map(|notice| notice.text.to_string()).collect();
        assert_eq!(left, ["drop run", "odd"]);
    }

    #[test]
    fn files_that_arrive_one_after_the_other_have_one_notice() {
        let mut notices = Notices::default();
        for n in 0..12 {
            notices.count_added(AddedClips { clips: 2, with_notes: usize::from(n == 3) });
            notices.say_added(vec![format!("{n}.bvh")]);
            notices.tick(FRESH_SECS * 0.9);
        }
        assert_eq!(texts(&notices), ["Added 12 files to the library."]);
        assert_eq!(notices.added(), Some(AddedClips { clips: 24, with_notes: 1 }));
        assert!(notices.next_change_secs().is_some_and(|secs| secs < FRESH_SECS * 0.2));
        assert!(notices.tick(FRESH_SECS));
        assert_eq!((notices.added(), notices.list().len()), (None, 0));
        notices.say_added(vec!["13.bvh".to_owned()]);
        assert_eq!(texts(&notices), ["Added to the library: 13.bvh."]);
    }

    #[test]
    fn warning_is_new_for_a_moment_and_stays() {
        let mut notices = Notices::default();
        notices.say(Level::Warning, "odd");
        assert!(notices.list()[0].is_fresh() && notices.next_change_secs().is_some());
        assert!(notices.tick(FRESH_SECS));
        assert!(!notices.list()[0].is_fresh() && notices.next_change_secs().is_none());
        assert!(!notices.tick(FRESH_SECS));
        assert_eq!(texts(&notices), ["odd"]);
    }

    #[test]
    fn tick_removes_infos_and_keeps_errors() {
        let mut notices = Notices::default();
        notices.say(Level::Info, "loaded");
        notices.say(Level::Error, "broken");
        notices.say(Level::Error, "broken");
        assert_eq!(notices.list().len(), 2);
        assert!(notices.tick(FRESH_SECS + 1.0));
        assert_eq!(notices.list().len(), 1);
        assert_eq!(notices.next_change_secs(), None);
        notices.dismiss(notices.list()[0].id);
        assert!(notices.list().is_empty());
    }
}
