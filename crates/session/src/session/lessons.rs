//! The open lesson.

use super::Session;
use crate::command::CommandError;
use crate::lesson::{Lesson, Source};
use crate::link;
use crate::params::Key;
use crate::playback;
use segue_text::Message;

impl Session {
    /// Returns the open lesson; `None` if there is none.
    #[must_use]
    pub fn lesson(&self) -> Option<Lesson<'_>> {
        self.lessons.lesson(&self.document.params)
    }

    /// Returns whether a link of the open page sets the parameters as they are, apart from camera
    /// and time.
    #[must_use]
    pub fn is_tried(&self, query: &str) -> bool {
        self.lessons.is_tried(&self.document.params, query)
    }

    /// Stores the text of a lesson, or the reason why it did not arrive. A text that is not shown
    /// is kept.
    pub fn finish_lesson(&mut self, source: &Source, text: Result<&[u8], Message>) {
        self.lessons.finish(source, text);
        if self.set_up_lesson() {
            self.refresh();
            playback::restart(&mut self.panes.list);
        }
        self.revision += 1;
    }

    /// Chooses the language of the bundled lessons, by their folder: `en` or `zh-Hant`.
    pub fn set_lesson_language(&mut self, language: &'static str) {
        if self.lessons.set_language(language) {
            self.lessons.request_text(&self.document.params);
            self.revision += 1;
        }
    }

    /// Records that parameters were set together. If the open lesson is among them and the lab is
    /// not, the lesson sets all others.
    pub(super) fn note_lesson(&mut self, named: &[Key]) {
        self.lessons.note_set(&self.document.params, named);
        self.set_up_lesson();
    }

    /// Sets the parameters of the open page, if they are about to be set and its text is available.
    /// Returns whether it did.
    fn set_up_lesson(&mut self) -> bool {
        let new = self.lessons.set_up(&self.document.params);
        new.map(|new| self.replace_params(new)).is_some()
    }

    /// Opens a link of the open page, as one step for undo.
    pub(super) fn try_link(&mut self, query: &str) -> Result<(), CommandError> {
        let link = link::read(query);
        if let Some(lesson) = link.values.iter().find(|(key, _)| *key == Key::Lesson) {
            if self.document.params.get(Key::Lesson) == &lesson.1 {
                // It is open already: a text that failed is requested again.
                self.document.remember(None);
                self.note_lesson(&[Key::Lesson]);
            }
            return self.set_as_step(vec![lesson.clone()]);
        }
        let new = (self.lessons.try_params(&self.document.params, link))
            .ok_or(CommandError::NotPossible("no lesson is open"))?;
        self.document.remember(None);
        self.replace_params(new);
        Ok(())
    }
}
