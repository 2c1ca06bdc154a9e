//! What Segue has to say, until it is read.

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
        let text = text.into();
        self.list.retain(|notice| notice.text != text);
        if self.list.len() >= MOST {
            self.list.remove(0);
        }
        self.list.push(Notice {
            id: self.next_id,
            level,
            text,
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
