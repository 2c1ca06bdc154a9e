//! What Segue has to say, until it is read.

use super::outside::short;
use segue_text::{Message, msg};

/// How much it matters.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Level {
    /// Good to know; goes away by itself.
    Info,
    /// Something was read or done otherwise than asked; stays until dismissed.
    Warning,
    /// Something did not work; stays until dismissed.
    Error,
}

/// One message.
#[derive(Clone, Debug, PartialEq)]
pub struct Notice {
    /// Its number; dismissing names it.
    pub id: u64,
    /// How much it matters.
    pub level: Level,
    /// What happened and what to do, in a sentence or two.
    pub text: Message,
    /// What it is about, in a word: a file, a key. Where a row has no room for more, this stands
    /// for it.
    pub about: String,
    /// Ids of the clips that can be read better: [`FileCommand::Mend`](super::FileCommand::Mend) does it.
    pub mends: Vec<String>,
    /// The clip that it asks for.
    awaits: Option<String>,
    age_secs: f64,
}

/// The messages that are on screen, oldest first.
#[derive(Clone, Debug, Default)]
pub struct Notices {
    list: Vec<Notice>,
    /// Errors for which there was no room. One of the list sums them up.
    more: Vec<Notice>,
    /// The number of that one.
    sum: Option<u64>,
    next_id: u64,
}

/// How long an [`Level::Info`] stays, seconds: long enough to read two lines.
const INFO_SECS: f64 = 6.0;
/// More than that many at once is no longer read.
const MOST: usize = 6;
/// Of these so many may stay until they are dismissed: there is always room for an [`Level::Info`].
const MOST_LASTING: usize = MOST - 1;
/// And of those so many may be errors, with the one that sums up the rest.
const MOST_ERRORS: usize = MOST_LASTING - 1;
/// More of what failed is counted and not named.
const MOST_NAMED: usize = 24;

impl Notices {
    /// Says something. The same text again moves to the end instead of standing there twice.
    pub fn say(&mut self, level: Level, text: impl Into<Message>) {
        let text = text.into();
        let about = text.subject().map_or_else(|| text.to_string(), str::to_owned);
        self.put(level, text, &about, None);
    }

    /// Says something of a file or key.
    pub fn say_of(&mut self, level: Level, about: &str, text: impl Into<Message>) {
        self.put(level, text.into(), about, None);
    }

    /// Warns of clips, by their ids, that can be read better.
    pub fn offer(&mut self, text: impl Into<Message>, clips: Vec<String>) {
        let about = clips.first().cloned().unwrap_or_default();
        self.put(Level::Warning, text.into(), &about, None);
        if let Some(notice) = self.list.last_mut() {
            notice.mends = clips;
        }
    }

    /// Takes away the message that offers to read clips better, and returns their ids.
    pub fn take_offer(&mut self) -> Vec<String> {
        let at = self.list.iter().position(|notice| !notice.mends.is_empty());
        at.map(|at| self.list.remove(at).mends).unwrap_or_default()
    }

    /// Says that a clip is missing. It stays until [`Notices::keep_missing`] finds that it is not.
    pub fn miss(&mut self, reference: &str, text: impl Into<Message>) {
        self.put(Level::Warning, text.into(), reference, Some(reference.to_owned()));
    }

    /// The clips that are asked for.
    pub fn awaited(&self) -> impl Iterator<Item = &str> {
        self.list.iter().filter_map(|notice| notice.awaits.as_deref())
    }

    /// Takes away what asks for clips that are there by now, or that nobody wants any more.
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
            mends: Vec::new(),
            awaits,
            age_secs: 0.0,
        };
        self.next_id += 1;
        if level == Level::Error && self.count(Level::Error) >= MOST_ERRORS {
            self.sum_up(notice);
            return;
        }
        self.list.push(notice);
        self.make_room();
    }

    fn count(&self, level: Level) -> usize {
        self.list.iter().filter(|notice| notice.level == level).count()
    }

    /// Infos give way first, then warnings, the oldest of each; an error never does.
    fn make_room(&mut self) {
        let lasting = self.list.len() - self.count(Level::Info);
        if lasting > MOST_LASTING {
            self.drop_oldest(Level::Warning);
        }
        while self.list.len() > MOST && self.drop_oldest(Level::Info) {}
    }

    fn drop_oldest(&mut self, level: Level) -> bool {
        let of_level = |notice: &Notice| notice.level == level;
        // What can be mended at a press stays longest of its level.
        let plain = self.list.iter().position(|notice| of_level(notice) && notice.mends.is_empty());
        let at = plain.or_else(|| self.list.iter().position(of_level));
        at.map(|at| self.list.remove(at)).is_some()
    }

    /// An error for which there is no room: it and the last one that has a row, or those that are
    /// summed up already, are one row from now on.
    fn sum_up(&mut self, error: Notice) {
        let last = match self.sum {
            Some(sum) => self.list.iter().position(|notice| notice.id == sum),
            None => self.list.iter().rposition(|notice| notice.level == Level::Error),
        };
        let last = last.map(|at| self.list.remove(at));
        self.more.extend(last.filter(|notice| Some(notice.id) != self.sum));
        self.more.push(error);
        let mut named: Vec<String> =
            self.more.iter().take(MOST_NAMED).map(|notice| notice.about.clone()).collect();
        if self.more.len() > MOST_NAMED {
            named.push("…".to_owned());
        }
        let text = msg!("{count} more did not work: {named}.", count = self.more.len(), named);
        self.sum = Some(self.next_id);
        self.list.push(Notice {
            id: self.next_id,
            level: Level::Error,
            text,
            about: String::new(),
            mends: Vec::new(),
            awaits: None,
            age_secs: 0.0,
        });
        self.next_id += 1;
    }

    /// Takes a message away.
    pub fn dismiss(&mut self, id: u64) {
        self.list.retain(|notice| notice.id != id);
        if self.sum == Some(id) {
            self.sum = None;
            self.more.clear();
        }
    }

    /// Every error since the one of that number, with those for which there was no room, in the
    /// order in which they came.
    #[must_use]
    pub fn errors_since(&self, id: u64) -> Vec<&Notice> {
        let of_list = self.list.iter().filter(|notice| Some(notice.id) != self.sum);
        let errors = of_list.chain(&self.more);
        let mut errors: Vec<&Notice> =
            errors.filter(|notice| notice.level == Level::Error && notice.id >= id).collect();
        errors.sort_by_key(|notice| notice.id);
        errors
    }

    /// Lets time pass; says whether a message went away.
    pub fn tick(&mut self, dt_secs: f64) -> bool {
        let before = self.list.len();
        for notice in &mut self.list {
            notice.age_secs += dt_secs;
        }
        self.list.retain(|notice| notice.level != Level::Info || notice.age_secs < INFO_SECS);
        self.list.len() < before
    }

    /// Seconds until the next message goes away by itself.
    #[must_use]
    pub fn next_change_secs(&self) -> Option<f64> {
        let infos = self.list.iter().filter(|notice| notice.level == Level::Info);
        infos.map(|notice| (INFO_SECS - notice.age_secs).max(0.0)).min_by(f64::total_cmp)
    }

    /// The messages, oldest first.
    #[must_use]
    pub fn list(&self) -> &[Notice] {
        &self.list
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn texts(notices: &Notices) -> Vec<String> {
        notices.list().iter().map(|notice| notice.text.to_string()).collect()
    }

    #[test]
    fn infos_give_way_first_then_warnings() {
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
    fn no_error_is_lost() {
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
                    texts(&notices)
                        .contains(&"3 more did not work: f3.bvh, f4.bvh, f5.bvh.".to_owned())
                );
            }
        }
        assert!(notices.list().len() <= MOST);
        let sum = notices
            .list()
            .iter()
            .find(|notice| notice.text.to_string().starts_with("37 more"))
            .unwrap();
        assert!(sum.text.to_string().ends_with("f26.bvh, …."), "{}", sum.text);
        // Listeners hear of each, once.
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
        assert!(texts(&notices).contains(&"2 more did not work: x.bvh, y.bvh.".to_owned()));
    }

    #[test]
    fn what_has_no_room_is_called_by_its_file_or_key() {
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
        assert_eq!(sum, format!("4 more did not work: 4, walk.bvh, a/b.bvh, {long}."));
    }

    #[test]
    fn what_can_be_mended_outlasts_other_warnings() {
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
    fn what_is_missed_is_said_until_it_comes() {
        let mut notices = Notices::default();
        notices.miss("walk~1234", "drop walk");
        notices.miss("run~5678", "drop run");
        notices.say(Level::Warning, "odd");
        notices.keep_missing(|reference| reference == "run~5678");
        let left: Vec<String> =
            notices.list().iter().map(|notice| notice.text.to_string()).collect();
        assert_eq!(left, ["drop run", "odd"]);
    }

    #[test]
    fn infos_go_and_errors_stay() {
        let mut notices = Notices::default();
        notices.say(Level::Info, "loaded");
        notices.say(Level::Error, "broken");
        notices.say(Level::Error, "broken");
        assert_eq!(notices.list().len(), 2);
        assert!(notices.tick(INFO_SECS + 1.0));
        assert_eq!(notices.list().len(), 1);
        assert_eq!(notices.next_change_secs(), None);
        notices.dismiss(notices.list()[0].id);
        assert!(notices.list().is_empty());
    }
}
