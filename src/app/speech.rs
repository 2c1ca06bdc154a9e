//! Has the interface speak the language that is asked for, as soon as it is here.

use crate::platform::{self, Inbox};
use crate::ui::{Language, Tongue, speak_english};
use eframe::egui::Context;
use segue_session::Session;
use std::sync::Arc;

/// The language of a window: a new one begins in English, without the letters of any other.
#[derive(Debug, Default)]
pub(super) struct Spoken {
    language: Language,
    has_letters: bool,
    /// What the page around it was told.
    told: Option<Language>,
}

#[derive(Debug)]
enum Lesson {
    /// Nobody asked for it.
    NotBegun,
    UnderWay,
    Learned(Tongue),
    /// It is not tried again before another language was spoken.
    Failed,
}

/// See the module.
#[derive(Debug)]
pub(super) struct Speech {
    preferred: Language,
    chinese: Lesson,
}

impl Speech {
    /// For somebody who reads the languages of this system.
    pub(super) fn new() -> Self {
        Self {
            preferred: Language::preferred(platform::languages().iter().map(String::as_str)),
            chinese: Lesson::NotBegun,
        }
    }

    /// The two files of the language have come, or have not. Says what to tell the user.
    pub(super) fn arrived(&mut self, files: Result<[Arc<[u8]>; 2], String>) -> Option<String> {
        let read = files.and_then(|[catalogue, face]| Tongue::read(&catalogue, face));
        match read {
            Ok(tongue) => {
                self.chinese = Lesson::Learned(tongue);
                None
            }
            Err(reason) => {
                self.chinese = Lesson::Failed;
                Some(format!("The interface could not be had in Chinese: {reason}."))
            }
        }
    }

    /// Before a frame: asks for the language that is wanted, or speaks it. Returns the one that is
    /// spoken.
    pub(super) fn tend(
        &mut self,
        session: &Session,
        spoken: &mut Spoken,
        inbox: &Inbox,
        ctx: &Context,
    ) -> Language {
        let wanted = Language::of(session, self.preferred);
        match (wanted, &self.chinese) {
            (Language::English, Lesson::Failed) => self.chinese = Lesson::NotBegun,
            (Language::English, _) => {
                if spoken.language != wanted {
                    speak_english(ctx);
                    spoken.language = wanted;
                }
            }
            (Language::Chinese, Lesson::NotBegun) => {
                self.chinese = Lesson::UnderWay;
                platform::load_language(wanted.tag(), inbox);
            }
            (Language::Chinese, Lesson::UnderWay | Lesson::Failed) => {}
            (Language::Chinese, Lesson::Learned(tongue)) => {
                if !spoken.has_letters {
                    tongue.teach(ctx);
                    spoken.has_letters = true;
                    ctx.request_repaint();
                } else if spoken.language != wanted {
                    tongue.speak(ctx);
                    spoken.language = wanted;
                }
            }
        }
        if spoken.told.replace(spoken.language) != Some(spoken.language) {
            platform::tell_language(spoken.language.tag());
        }
        spoken.language
    }
}
