//! Shows the interface in the language that is asked for, as soon as its files are here.

use crate::platform::{self, Inbox};
use crate::ui::{Language, LanguagePack, PackError, activate_english};
use eframe::egui::Context;
use segue_session::Session;
use segue_text::{Message, msg};
use std::collections::BTreeMap;
use std::sync::Arc;

/// The texts and the font of a language, or why they are not here.
pub(crate) type PackFiles = Result<[Arc<[u8]>; 2], Message>;

/// The language of a window. A new window begins in English, without the fonts of any other.
#[derive(Debug, Default)]
pub(super) struct WindowLanguage {
    shown: Language,
    /// The language whose letters the window has.
    fonts: Option<Language>,
    /// What the page around it was told.
    told: Option<Language>,
}

/// How far the files of a language are.
#[derive(Debug, Default)]
enum PackState {
    /// They were not asked for.
    #[default]
    NotRequested,
    /// They were asked for.
    Loading,
    /// They are here.
    Loaded(LanguagePack),
    /// They did not come, or cannot be used. They are asked for again after another language was
    /// shown.
    Failed,
}

/// Loads the files of languages when they are first asked for.
#[derive(Debug)]
pub(super) struct LanguageLoader {
    preferred: Language,
    /// By the tag of the language.
    packs: BTreeMap<&'static str, PackState>,
}

impl LanguageLoader {
    /// Returns a loader for a reader of the languages of this system.
    pub(super) fn new() -> Self {
        Self {
            preferred: Language::preferred(platform::languages().iter().map(String::as_str)),
            packs: BTreeMap::new(),
        }
    }

    /// Takes the files of a language, which have come or have not. Returns what to tell the user.
    pub(super) fn finish(&mut self, tag: &'static str, files: PackFiles) -> Option<Message> {
        let read = match files {
            Ok([texts, font]) => LanguagePack::read(&texts, font),
            Err(reason) => Err(PackError::NotLoaded(reason)),
        };
        let (state, told) = match read {
            Ok(pack) => (PackState::Loaded(pack), None),
            Err(error) => {
                let language = Language::of_tag(tag).unwrap_or_default().name();
                let told = msg!(
                    "The interface could not be shown in {language}: {error}.",
                    language,
                    error
                );
                (PackState::Failed, Some(told))
            }
        };
        self.packs.insert(tag, state);
        told
    }

    /// Asks for the language that is wanted, or shows it in a window, before a frame. Returns the
    /// one that is shown.
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
        if window.told.replace(window.shown) != Some(window.shown) {
            platform::tell_language(window.shown.tag());
        }
        window.shown
    }
}
