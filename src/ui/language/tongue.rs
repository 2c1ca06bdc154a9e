//! The language that a context speaks, as [`theme_of`](crate::ui::theme::theme_of) is its theme.

use super::catalogue::Catalogue;
use eframe::egui::output::OutputEvent;
use eframe::egui::{Context, FontData, FullOutput, Id, Plugin, Role, Ui};
use segue_text::Message;
use std::borrow::Cow;
use std::sync::Arc;

/// What a language is told with: its catalogue, and the face with its letters.
#[derive(Clone, Debug)]
pub(crate) struct Tongue {
    catalogue: Arc<Catalogue>,
    face: Arc<[u8]>,
}

impl Tongue {
    /// Reads the two files of a language.
    ///
    /// # Errors
    /// What is wrong with them, in a few words.
    pub(crate) fn read(catalogue: &[u8], face: Arc<[u8]>) -> Result<Self, String> {
        let signs = [&b"OTTO"[..], &[0, 1, 0, 0]];
        if !signs.iter().any(|sign| face.starts_with(sign)) {
            return Err("its font is none".to_owned());
        }
        let catalogue = Arc::new(Catalogue::read(catalogue)?);
        Ok(Self { catalogue, face })
    }

    /// What was asked of it so far, with what was found.
    #[cfg(all(test, feature = "ui-tests"))]
    pub(crate) fn asked(&self) -> Vec<(String, Option<Arc<str>>)> {
        self.catalogue.asked()
    }

    /// Gives a context the letters. They can be written with from the next frame on.
    pub(crate) fn teach(&self, ctx: &Context) {
        crate::ui::theme::add_face("Noto Sans TC", FontData::from_owned(self.face.to_vec()), ctx);
    }

    /// From now on, what this context shows is translated.
    pub(crate) fn speak(&self, ctx: &Context) {
        ctx.add_plugin(Spoken);
        ctx.data_mut(|data| data.insert_temp(tongue_id(), Some(self.catalogue.clone())));
    }
}

/// From now on, what this context shows is shown as it is written: in English.
pub(crate) fn speak_english(ctx: &Context) {
    ctx.data_mut(|data| data.insert_temp(tongue_id(), None::<Arc<Catalogue>>));
}

fn tongue_id() -> Id {
    Id::unique("segue tongue")
}

fn catalogue_of(ctx: &Context) -> Option<Arc<Catalogue>> {
    ctx.data(|data| data.get_temp::<Option<Arc<Catalogue>>>(tongue_id())).flatten()
}

/// A text in the language of the interface. The widgets of the kit ask this themselves, for all
/// that they are given.
pub(crate) fn tr<'a>(text: &'a str, ui: &Ui) -> Cow<'a, str> {
    match catalogue_of(ui.ctx()).and_then(|catalogue| catalogue.find(text)) {
        Some(found) => Cow::Owned(found.to_string()),
        None => Cow::Borrowed(text),
    }
}

/// A message in the language of the interface.
pub(crate) fn say(message: &Message, ui: &Ui) -> String {
    match catalogue_of(ui.ctx()) {
        Some(catalogue) => catalogue.say(message),
        None => message.to_string(),
    }
}

/// Translates what screen readers are told, which no widget has to think of.
struct Spoken;

impl Plugin for Spoken {
    fn debug_name(&self) -> &'static str {
        "segue tongue"
    }

    fn output_hook(&mut self, ctx: &Context, output: &mut FullOutput) {
        let Some(catalogue) = catalogue_of(ctx) else {
            return;
        };
        if let Some(update) = &mut output.platform_output.accesskit_update {
            for (_, node) in &mut update.nodes {
                if let Some(label) = node.label().and_then(|label| catalogue.find(label)) {
                    node.set_label(label.to_string());
                }
                // A text that is edited is the user's.
                if !matches!(
                    node.role(),
                    Role::TextInput | Role::MultilineTextInput | Role::TextRun
                ) && let Some(value) = node.value().and_then(|value| catalogue.find(value))
                {
                    node.set_value(value.to_string());
                }
            }
        }
        for event in &mut output.platform_output.events {
            let (OutputEvent::Clicked(info)
            | OutputEvent::DoubleClicked(info)
            | OutputEvent::TripleClicked(info)
            | OutputEvent::FocusGained(info)
            | OutputEvent::TextSelectionChanged(info)
            | OutputEvent::ValueChanged(info)) = event;
            if let Some(label) = info.label.as_deref().and_then(|label| catalogue.find(label)) {
                info.label = Some(label.to_string());
            }
        }
    }
}
