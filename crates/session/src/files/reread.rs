//! Files of the library that are read again: with other options, with other roles, or with better
//! options that a notice offers.

use super::admission::refill;
use super::corrections::corrected_options;
use super::intake::FileIntake;
use super::setup::setup_of;
use crate::command::CommandError;
use crate::document::Document;
use crate::library::{Arrival, Origin, SourceFile};
use crate::notice::{Level, Notices};
use crate::reading::Content;
use segue_formats::{ImportError, ImportOptions};
use segue_text::ToMessage;
use std::sync::Arc;

impl FileIntake {
    /// Reads a file of the library again, as its entries say: at once, or elsewhere. Returns
    /// whether it was read. An error changes nothing.
    pub(crate) fn read_anew(
        &mut self,
        document: &mut Document,
        file: &SourceFile,
        arrival: Option<Arrival>,
    ) -> Result<bool, ImportError> {
        let (Content::Here(bytes), Some(read)) =
            (&file.content, self.reads.filter(|_| !file.is_large()))
        else {
            self.read_again(document, file.clone(), arrival);
            return Ok(false);
        };
        let setup = setup_of(&document.library, file);
        let report = read(&file.name, bytes, &setup, &mut |_| true).unwrap_or_default();
        refill(document, report, &file.options).map(|_| true)
    }

    /// Reads a clip's file again with other options, as a step for undo.
    pub(crate) fn reimport(
        &mut self,
        document: &mut Document,
        id: &str,
        options: &ImportOptions,
    ) -> Result<(), CommandError> {
        let library = document.library.clone();
        self.reread(document, id, options)?;
        document.remember_library(&library);
        Ok(())
    }

    /// Reads a clip's file again with other options. An error changes nothing.
    fn reread(
        &mut self,
        document: &mut Document,
        id: &str,
        options: &ImportOptions,
    ) -> Result<(), CommandError> {
        let entry = Arc::clone(document.clip(id)?);
        let Origin::File(file) = &entry.origin else {
            return Err(CommandError::NotPossible(
                "only a clip that came from a file can be read again",
            ));
        };
        let file = SourceFile { options: *options, ..file.clone() };
        let library = document.library.clone();
        // Recorded at once, wherever the file is read: further options add to these, and after undo
        // the report is ignored.
        for entry in library.entries().iter().filter(|entry| entry.sha256() == Some(&file.sha256)) {
            document.library.change(&entry.id, |entry| {
                if let Origin::File(file) = &mut entry.origin {
                    file.options = *options;
                }
            });
        }
        if let Err(error) = self.read_anew(document, &file, None) {
            document.library = library;
            return Err(error.into());
        }
        Ok(())
    }

    /// Reads the clips of a notice again with better options, as one step for undo. Reports those
    /// that cannot be read; they stay as they are.
    pub(crate) fn correct(&mut self, document: &mut Document, notices: &mut Notices, notice: u64) {
        let found = notices.list().iter().find(|found| found.id == notice);
        let clips = found.map(|found| found.corrections.clone()).unwrap_or_default();
        let library = document.library.clone();
        for (id, options) in clips
            .iter()
            .filter_map(|id| Some((id, corrected_options(&document.library, id)?)))
            .collect::<Vec<_>>()
        {
            if let Err(error) = self.reread(document, id, &options) {
                notices.say(Level::Error, error.to_message());
            }
        }
        document.remember_library(&library);
        notices.dismiss(notice);
    }
}
