//! What Segue has to say, until it is read.

/// A note, `the rest pose was taken`, as a sentence: `The rest pose was taken.`
#[must_use]
pub fn sentence(note: &str) -> String {
    let mut letters = note.chars();
    let first = letters.next().map_or_else(String::new, |first| first.to_uppercase().to_string());
    let stop = if note.ends_with('.') || note.is_empty() { "" } else { "." };
    format!("{first}{}{stop}", letters.as_str())
}

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
    pub text: String,
    /// The clip that it asks for.
    awaits: Option<String>,
    age_secs: f64,
}

/// The messages that are on screen, oldest first.
#[derive(Clone, Debug, Default)]
pub struct Notices {
    list: Vec<Notice>,
    next_id: u64,
}

/// How long an [`Level::Info`] stays, seconds: long enough to read two lines.
const INFO_SECS: f64 = 6.0;
/// More than that many at once is no longer read; the oldest give way.
const MOST: usize = 6;

impl Notices {
    /// Says something. The same text again moves to the end instead of standing there twice.
    pub fn say(&mut self, level: Level, text: impl Into<String>) {
        self.put(level, text.into(), None);
    }

    /// Says that a clip is missing. It stays until [`Notices::keep_missing`] finds that it is not.
    pub fn miss(&mut self, reference: &str, text: impl Into<String>) {
        self.put(Level::Warning, text.into(), Some(reference.to_owned()));
    }

    /// Takes away what asks for clips that are there by now, or that nobody wants any more.
    pub fn keep_missing(&mut self, is_missing: impl Fn(&str) -> bool) {
        self.list.retain(|notice| notice.awaits.as_deref().is_none_or(&is_missing));
    }

    fn put(&mut self, level: Level, text: String, awaits: Option<String>) {
        self.list.retain(|notice| notice.text != text);
        if self.list.len() >= MOST {
            self.list.remove(0);
        }
        self.list.push(Notice {
            id: self.next_id,
            level,
            text,
            awaits,
            age_secs: 0.0,
        });
        self.next_id += 1;
    }

    /// Takes a message away.
    pub fn dismiss(&mut self, id: u64) {
        self.list.retain(|notice| notice.id != id);
    }

    /// Lets time pass; says whether a message went away.
    pub fn tick(&mut self, dt_secs: f64) -> bool {
        let before = self.list.len();
        for notice in &mut self.list {
            notice.age_secs += dt_secs;
        }
        self.list
            .retain(|notice| notice.level != Level::Info || notice.age_secs < INFO_SECS);
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

    #[test]
    fn what_is_missed_is_said_until_it_comes() {
        let mut notices = Notices::default();
        notices.miss("walk~1234", "drop walk");
        notices.miss("run~5678", "drop run");
        notices.say(Level::Warning, "odd");
        notices.keep_missing(|reference| reference == "run~5678");
        let left: Vec<&str> = notices.list().iter().map(|notice| notice.text.as_str()).collect();
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
