//! The texts and the font of a language, and the context that shows them.

use super::text::Text;
use crate::ui::text;
use eframe::egui::{Context, FontData, Id, Ui};
use segue_text::{Message, Table, ToMessage};
use std::collections::BTreeMap;
use std::sync::Arc;
#[cfg(all(test, feature = "ui-tests"))]
use std::sync::{Mutex, PoisonError};

/// The texts of a language, and a font with its letters.
#[derive(Clone, Debug)]
pub(crate) struct LanguagePack {
    texts: Arc<Texts>,
    font: Arc<[u8]>,
}

/// The reason why a language pack cannot be used.
#[derive(Debug, thiserror::Error, ToMessage)]
pub(crate) enum PackError {
    /// One of its files is not here.
    #[error("{0}")]
    NotLoaded(Message),
    /// The texts are not JSON, or have another structure.
    #[error("its texts cannot be read")]
    Texts,
    /// The font has no known format.
    #[error("its font cannot be read")]
    Font,
}

#[derive(Debug)]
struct Texts {
    table: Table,
    /// The templates that were shown, with their translations.
    #[cfg(all(test, feature = "ui-tests"))]
    shown: Mutex<BTreeMap<String, Option<String>>>,
}

impl LanguagePack {
    /// Reads the two files of a language: sections of texts by their English, and a font.
    ///
    /// # Errors [`PackError`] if one of them has another format.
    pub(crate) fn read(texts: &[u8], font: Arc<[u8]>) -> Result<Self, PackError> {
        let signatures = [&b"OTTO"[..], &[0, 1, 0, 0]];
        if !signatures.iter().any(|signature| font.starts_with(signature)) {
            return Err(PackError::Font);
        }
        let sections: BTreeMap<String, BTreeMap<String, String>> =
            serde_json::from_slice(texts).map_err(|_| PackError::Texts)?;
        let texts = Texts {
            table: Table::new(sections.into_values().flatten()),
            #[cfg(all(test, feature = "ui-tests"))]
            shown: Mutex::default(),
        };
        Ok(Self { texts: Arc::new(texts), font })
    }

    /// Returns the templates that were shown so far, with their translations.
    #[cfg(all(test, feature = "ui-tests"))]
    pub(crate) fn shown(&self) -> Vec<(String, Option<String>)> {
        let shown = self.texts.shown.lock().unwrap_or_else(PoisonError::into_inner);
        shown.iter().map(|(text, own)| (text.clone(), own.clone())).collect()
    }

    /// Adds the font to a context. Its letters can be drawn from the next frame on.
    pub(crate) fn install_fonts(&self, ctx: &Context) {
        crate::ui::theme::add_face("Noto Sans TC", FontData::from_owned(self.font.to_vec()), ctx);
    }

    /// Shows the texts of a context in this language from now on.
    pub(crate) fn activate(&self, ctx: &Context) {
        ctx.data_mut(|data| data.insert_temp(texts_id(), Some(self.texts.clone())));
    }
}

/// Returns the words of the link to the parameters that is the first element of the page.
pub(crate) fn skip_words(ctx: &Context) -> String {
    written(text::SKIP_TO_PARAMETERS.into(), ctx)
}

/// Shows the texts of a context in English from now on.
pub(crate) fn activate_english(ctx: &Context) {
    ctx.data_mut(|data| data.insert_temp(texts_id(), None::<Arc<Texts>>));
}

impl Texts {
    fn find<'a>(&'a self, english: &'a str) -> &'a str {
        self.record(english);
        self.table.row(english).unwrap_or(english)
    }

    fn write(&self, message: &Message) -> String {
        for template in message.templates() {
            self.record(template);
        }
        self.table.write(message)
    }

    #[cfg(all(test, feature = "ui-tests"))]
    fn record(&self, template: &str) {
        let mut shown = self.shown.lock().unwrap_or_else(PoisonError::into_inner);
        shown.insert(template.to_owned(), self.table.row(template).map(str::to_owned));
    }

    #[cfg(not(all(test, feature = "ui-tests")))]
    #[expect(clippy::unused_self, reason = "tests record what was shown")]
    fn record(&self, _template: &str) {}
}

fn texts_id() -> Id {
    Id::unique("segue language pack")
}

fn texts_of(ctx: &Context) -> Option<Arc<Texts>> {
    ctx.data(|data| data.get_temp::<Option<Arc<Texts>>>(texts_id())).flatten()
}

/// Returns a text in the language of the interface. Not to be called while egui holds its context,
/// as in a closure for `Ui::data`.
pub(crate) fn say<'a>(text: impl Into<Text<'a>>, ui: &Ui) -> String {
    written(text.into(), ui.ctx())
}

fn written(text: Text<'_>, ctx: &Context) -> String {
    match text {
        Text::Word(word) => match texts_of(ctx) {
            Some(texts) => texts.find(word.english()).to_owned(),
            None => word.english().to_owned(),
        },
        Text::Message(message) => match texts_of(ctx) {
            Some(texts) => texts.write(message),
            None => message.to_string(),
        },
        Text::Data(data) => data.to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(texts: &[u8], font: &[u8]) -> Result<LanguagePack, PackError> {
        LanguagePack::read(texts, Arc::from(font))
    }

    #[test]
    fn language_pack_of_other_files_is_refused() {
        assert!(read(br#"{"words": {"left": "right"}}"#, b"OTTO").is_ok());
        assert!(matches!(read(b"<!doctype html>", b"OTTO"), Err(PackError::Texts)));
        assert!(matches!(read(br#"{"a": "b"}"#, b"OTTO"), Err(PackError::Texts)));
        assert!(matches!(read(b"{}", b"<!doctype html>"), Err(PackError::Font)));
    }
}
