//! The language of the interface.
//!
//! The parameter `lang` is `auto` until a language is chosen by hand, as with the theme. A link
//! therefore has a language only if its sender chose one; with any other link every reader keeps
//! their own. A language that was chosen by hand is stored with the work and restored on the next
//! visit.
//!
//! Texts are English where they are used, as [`Word`]s or as [`segue_text::Message`]s, and [`say`]
//! writes them in the language of the interface where they are drawn. The widgets of the kit take a
//! [`Text`] and call it themselves. The session knows no language, and links and files stay
//! English. A language is a row of [`LANGUAGES`] and its files in `assets/lang`, which are fetched
//! when it is first asked for.

mod pack;
mod text;

pub(crate) use pack::{LanguagePack, PackError, activate_english, say, skip_words};
pub(crate) use text::{Text, Word};

use segue_session::Session;
use segue_session::choices::PageLanguage;
use std::fmt;

/// A language of the interface.
struct LanguageRow {
    /// The tag: the word in the link, and the name of its files.
    tag: &'static str,
    /// The readers' tags that it serves: a language, and scripts or regions of it; none to serve
    /// all of them.
    readers: (&'static str, &'static [&'static str]),
    /// The name, in English.
    name: &'static str,
    /// The name of the button that switches to it.
    switch: Word,
    /// Whether the program is written in it, so that it has no files.
    is_built_in: bool,
}

/// The languages of the interface. The texts of the program are written in the first one.
static LANGUAGES: [LanguageRow; 2] = [
    LanguageRow {
        tag: PageLanguage::En.word(),
        readers: ("en", &[]),
        name: "English",
        switch: Word::new("Interface in English"),
        is_built_in: true,
    },
    // Traditional Chinese as written in Taiwan; not Simplified Chinese.
    LanguageRow {
        tag: PageLanguage::ZhHant.word(),
        readers: ("zh", &["hant", "tw", "hk", "mo"]),
        name: "Chinese",
        switch: Word::new("Interface in Chinese"),
        is_built_in: false,
    },
];

/// A row of [`LANGUAGES`]. The default is English.
#[derive(Clone, Copy, Default, PartialEq, Eq)]
pub(crate) struct Language(usize);

impl fmt::Debug for Language {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(self.tag())
    }
}

impl Language {
    /// Returns the language that the parameters ask for, for a reader of `preferred`.
    pub(crate) fn of(session: &Session, preferred: Self) -> Self {
        Self::of_tag(session.params().choice::<PageLanguage>().word()).unwrap_or(preferred)
    }

    /// Returns the language of a tag in a link.
    pub(crate) fn of_tag(tag: &str) -> Option<Self> {
        LANGUAGES.iter().position(|row| row.tag == tag).map(Self)
    }

    /// Returns the first of a reader's languages, best first, that has a row; English if none has.
    pub(crate) fn preferred<'a>(tags: impl IntoIterator<Item = &'a str>) -> Self {
        tags.into_iter().find_map(Self::of_reader).unwrap_or_default()
    }

    /// Returns the language for a reader of a tag such as `en-GB`, `zh-TW` or `zh_TW.UTF-8`.
    fn of_reader(tag: &str) -> Option<Self> {
        let tag = tag.split('.').next().unwrap_or(tag).to_ascii_lowercase().replace('_', "-");
        let parts: Vec<&str> = tag.split('-').collect();
        let is_for = |row: &LanguageRow| {
            let (language, regions) = row.readers;
            parts.first() == Some(&language)
                && (regions.is_empty() || parts.iter().any(|part| regions.contains(part)))
        };
        LANGUAGES.iter().position(is_for).map(Self)
    }

    fn row(self) -> &'static LanguageRow {
        LANGUAGES.get(self.0).unwrap_or(&LANGUAGES[0])
    }

    /// Returns its tag: the word in the link, and the name of its files.
    pub(crate) fn tag(self) -> &'static str {
        self.row().tag
    }

    /// Returns its name, in English.
    pub(crate) fn name(self) -> &'static str {
        self.row().name
    }

    /// Returns the name of the button that switches to it.
    pub(crate) fn switch(self) -> Word {
        self.row().switch
    }

    /// Returns whether texts are written in it, so that there is nothing to load.
    pub(crate) fn is_built_in(self) -> bool {
        self.row().is_built_in
    }

    /// Returns the next one in the list, and the first after the last.
    pub(crate) fn next(self) -> Self {
        Self((self.0 + 1) % LANGUAGES.len())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use segue_session::{Command, Key, Saved, Selected as _, Value};

    fn chinese() -> Language {
        Language::of_tag("zh-Hant").expect("a row of the table")
    }

    #[test]
    fn every_language_of_the_parameter_has_a_row() {
        let tags: Vec<&str> = PageLanguage::ALL.iter().map(|choice| choice.word()).collect();
        assert_eq!(tags[0], PageLanguage::Auto.word());
        assert_eq!(tags[1..], LANGUAGES.each_ref().map(|row| row.tag));
    }

    #[test]
    fn preferred_language_is_the_first_with_a_row() {
        for (tags, expected) in [
            (&["zh-TW", "zh", "en-US"][..], chinese()),
            (&["zh-Hant-HK"], chinese()),
            (&["zh_TW.UTF-8"], chinese()),
            (&["ja", "zh-Hant", "en"], chinese()),
            (&["en-US", "zh-TW"], Language::default()),
            (&["zh-CN", "zh-Hans-TW"][..1], Language::default()),
            (&["fr", "C"], Language::default()),
            (&[], Language::default()),
        ] {
            assert_eq!(Language::preferred(tags.iter().copied()), expected, "{tags:?}");
        }
    }

    #[test]
    fn link_has_a_language_only_after_a_choice() {
        let mut session = Session::new();
        assert_eq!(Language::of(&session, chinese()), chinese());
        assert!(!session.query().contains("lang"), "{}", session.query());
        session
            .apply(Command::Set(vec![(Key::Lang, Value::Choice(Language::default().tag()))]))
            .unwrap();
        assert_eq!(Language::of(&session, chinese()), Language::default());
        assert!(session.query().contains("lang=en"), "{}", session.query());
    }

    #[test]
    fn link_without_a_language_keeps_the_readers() {
        let mut session = Session::new();
        let open = |session: &mut Session, link: &str| {
            session.apply(Command::OpenLink(link.to_owned())).unwrap();
        };
        open(&mut session, "lang=zh-Hant");
        open(&mut session, "lab=make");
        assert_eq!(Language::of(&session, Language::default()), chinese());
        open(&mut session, "lab=make&lang=auto");
        assert_eq!(Language::of(&session, Language::default()), Language::default());
    }

    #[test]
    fn language_chosen_on_the_last_visit_is_restored() {
        let saved = |query: &str| Saved { query: query.into(), ..Session::new().saved() };
        for (stored, link, expected) in [
            ("lang=zh-Hant", None, chinese()),
            ("lang=zh-Hant", Some("lab=make"), chinese()),
            ("lang=zh-Hant", Some("lab=make&lang=en"), Language::default()),
            ("lab=make", Some("lab=blend"), Language::default()),
        ] {
            let mut session = Session::new();
            session.restore(&saved(stored), |_| None, link);
            assert_eq!(Language::of(&session, Language::default()), expected, "{stored}, {link:?}");
        }
    }
}
