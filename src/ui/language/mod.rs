//! Which language the interface speaks.
//!
//! The parameter `lang` is `auto` until somebody chooses by hand, as the theme is. Three rules
//! follow from that one: a link carries a language only when its sender chose one; a link that
//! names none leaves every reader their own; and what was chosen by hand is stored with the work
//! and is there again on the next visit.
//!
//! Everything is written in English, in the place where it is used, and translated where it is set
//! as text: [`tr`] asks the context's [`Tongue`], and the widgets of the kit ask it for all that
//! they are given. So the core knows no language, what a link or a file carries stays English, and
//! a new panel is translated by a row in `assets/lang`. Catalogue and letters are fetched when a
//! language is first asked for; until they are here, everything is in English.

mod catalogue;
mod tongue;

pub(crate) use tongue::{Tongue, say, speak_english, tr};

use segue_session::Session;
use segue_session::choices;

/// A language of the interface.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum Language {
    /// What everything is written in.
    #[default]
    English,
    /// Traditional Chinese as it is written in Taiwan.
    Chinese,
}

impl Language {
    /// What the parameters ask for, for somebody who reads `preferred`.
    pub(crate) fn of(session: &Session, preferred: Self) -> Self {
        match session.params().choice::<choices::PageLanguage>() {
            choices::PageLanguage::En => Self::English,
            choices::PageLanguage::ZhHant => Self::Chinese,
            choices::PageLanguage::Auto => preferred,
        }
    }

    /// The first of a reader's languages, best first, that there is; English where there is none of
    /// them.
    pub(crate) fn preferred<'a>(tags: impl IntoIterator<Item = &'a str>) -> Self {
        tags.into_iter().find_map(Self::from_tag).unwrap_or_default()
    }

    /// The language of a tag such as `en-GB`, `zh-TW` or `zh_TW.UTF-8`. Simplified Chinese is
    /// another one.
    fn from_tag(tag: &str) -> Option<Self> {
        let tag = tag.split('.').next().unwrap_or(tag).to_ascii_lowercase().replace('_', "-");
        let mut parts = tag.split('-');
        match parts.next()? {
            "en" => Some(Self::English),
            "zh" if parts.any(|part| matches!(part, "hant" | "tw" | "hk" | "mo")) => {
                Some(Self::Chinese)
            }
            _ => None,
        }
    }

    /// Its tag: the word in the link, and what its files are called by.
    pub(crate) fn tag(self) -> &'static str {
        match self {
            Self::English => "en",
            Self::Chinese => "zh-Hant",
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use segue_session::{Command, Key, Saved, Value};

    #[test]
    fn the_first_language_that_there_is_is_taken() {
        for (tags, expected) in [
            (&["zh-TW", "zh", "en-US"][..], Language::Chinese),
            (&["zh-Hant-HK"], Language::Chinese),
            (&["zh_TW.UTF-8"], Language::Chinese),
            (&["ja", "zh-Hant", "en"], Language::Chinese),
            (&["en-US", "zh-TW"], Language::English),
            (&["zh-CN", "zh-Hans-TW"][..1], Language::English),
            (&["fr", "C"], Language::English),
            (&[], Language::English),
        ] {
            assert_eq!(Language::preferred(tags.iter().copied()), expected, "{tags:?}");
        }
    }

    #[test]
    fn a_link_names_a_language_only_after_it_was_chosen_by_hand() {
        let mut session = Session::new();
        assert_eq!(Language::of(&session, Language::Chinese), Language::Chinese);
        assert!(!session.query().contains("lang"), "{}", session.query());
        session
            .apply(Command::Set(vec![(Key::Lang, Value::Choice(Language::English.tag()))]))
            .unwrap();
        assert_eq!(Language::of(&session, Language::Chinese), Language::English);
        assert!(session.query().contains("lang=en"), "{}", session.query());
    }

    #[test]
    fn a_link_without_a_language_leaves_the_readers() {
        let mut session = Session::new();
        let open = |session: &mut Session, link: &str| {
            session.apply(Command::OpenLink(link.to_owned())).unwrap();
        };
        open(&mut session, "lang=zh-Hant");
        open(&mut session, "lab=make");
        assert_eq!(Language::of(&session, Language::English), Language::Chinese);
        open(&mut session, "lab=make&lang=auto");
        assert_eq!(Language::of(&session, Language::English), Language::English);
    }

    #[test]
    fn what_was_chosen_on_the_last_visit_is_there_again() {
        let saved = |query: &str| Saved { query: query.into(), ..Session::new().saved() };
        for (stored, link, expected) in [
            ("lang=zh-Hant", None, Language::Chinese),
            ("lang=zh-Hant", Some("lab=make"), Language::Chinese),
            ("lang=zh-Hant", Some("lab=make&lang=en"), Language::English),
            ("lab=make", Some("lab=blend"), Language::English),
        ] {
            let mut session = Session::new();
            session.restore(&saved(stored), |_| None, link);
            assert_eq!(Language::of(&session, Language::English), expected, "{stored}, {link:?}");
        }
    }
}
