//! The language of the interface: loading of its files, and its activation in a window.

use crate::platform::{self, Inbox};
use crate::ui::{Language, LanguagePack, PackError, activate_english};
use eframe::egui::Context;
use segue_session::Session;
use segue_text::{Message, msg};
use std::collections::BTreeMap;
use std::sync::Arc;

/// The texts and the font of a language, or the reason why they were not loaded.
pub(crate) type PackFiles = Result<[Arc<[u8]>; 2], Message>;

/// The language of a window. A new window begins in English, without the fonts of any other.
#[derive(Debug, Default)]
pub(super) struct WindowLanguage {
    shown: Language,
    /// The language whose font is installed.
    fonts: Option<Language>,
    /// The language that is set on the page's document.
    of_page: Option<Language>,
}

/// The state of the files of a language.
#[derive(Debug, Default)]
enum PackState {
    /// They were not requested.
    #[default]
    NotRequested,
    /// They were requested.
    Loading,
    /// They are loaded.
    Loaded(LanguagePack),
    /// They were not loaded, or cannot be used. They are requested again after another language
    /// was shown.
    Failed,
}

/// A loader that requests the files of a language when it is first selected.
#[derive(Debug)]
pub(super) struct LanguageLoader {
    /// The language of a user who has selected none.
    preferred: Language,
    /// By the tag of the language.
    packs: BTreeMap<&'static str, PackState>,
}

impl LanguageLoader {
    /// Returns a loader that prefers the languages of this system.
    pub(super) fn new() -> Self {
        Self {
            preferred: Language::preferred(platform::languages().iter().map(String::as_str)),
            packs: BTreeMap::new(),
        }
    }

    /// Takes in the files of a language, or the reason why they were not loaded. Returns a notice
    /// where they cannot be used.
    pub(super) fn finish(&mut self, tag: &'static str, files: PackFiles) -> Option<Message> {
        let read = match files {
            Ok([texts, font]) => LanguagePack::read(&texts, font),
            Err(reason) => Err(PackError::NotLoaded(reason)),
        };
        let (state, notice) = match read {
            Ok(pack) => (PackState::Loaded(pack), None),
            Err(error) => {
                let language = Language::of_tag(tag).unwrap_or_default().name();
                let notice = msg!(
                    "The interface could not be shown in {language}: {error}.",
                    language,
                    error
                );
                (PackState::Failed, Some(notice))
            }
        };
        self.packs.insert(tag, state);
        notice
    }

    /// Requests the selected language, or activates it in a window, before a frame. Returns the
    /// language that is shown.
    pub(super) fn update(
        &mut self,
        session: &Session,
        window: &mut WindowLanguage,
        inbox: &Inbox,
        ctx: &Context,
    ) -> Language {
        let wanted = Language::of(session, self.preferred);
        self.packs.retain(|tag, state| *tag == wanted.tag() || !matches!(state, PackState::Failed));
        if wanted.is_built_in() {
            if window.shown != wanted {
                activate_english(ctx);
                window.shown = wanted;
            }
        } else {
            let state = self.packs.entry(wanted.tag()).or_default();
            match state {
                PackState::NotRequested => {
                    *state = PackState::Loading;
                    platform::load_language(wanted.tag(), inbox);
                }
                PackState::Loading | PackState::Failed => {}
                PackState::Loaded(pack) => {
                    if window.fonts != Some(wanted) {
                        pack.install_fonts(ctx);
                        window.fonts = Some(wanted);
                        ctx.request_repaint();
                    } else if window.shown != wanted {
                        pack.activate(ctx);
                        window.shown = wanted;
                    }
                }
            }
        }
        if window.of_page.replace(window.shown) != Some(window.shown) {
            platform::set_page_language(window.shown.tag());
        }
        window.shown
    }
}
