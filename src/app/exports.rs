//! Exports of long motions: the reader of files writes them in the background.

use super::Segue;
use super::api::{ApiError, ExportedFile};
use crate::platform::{self, LargeFile, ReadError, ReadEvent};
use segue_session::Level;
use segue_session::export::ExportOptions;
use segue_session::reading::ReadTask;
use segue_text::{Message, ToMessage as _, msg};
use std::collections::BTreeMap;

/// The number of the first task of an export; those of the session and of conversions are lower.
pub(super) const FIRST_TASK: u64 = 1 << 41;

/// The exports under way, and those that the page's API has yet to take, by their tasks.
#[derive(Debug, Default)]
pub(super) struct Exports {
    tasks: u64,
    all: BTreeMap<u64, Export>,
}

/// An export in the background.
#[derive(Debug)]
struct Export {
    name: String,
    mime: &'static str,
    which: String,
    how: ExportOptions,
    /// The session's revision at its beginning.
    revision: u64,
    /// Whether the page's API takes the file; otherwise it is saved.
    is_taken: bool,
    /// The bytes of the file, once they have arrived.
    file: Option<LargeFile>,
    result: Option<Result<LargeFile, Message>>,
}

/// An export that was begun.
pub(crate) enum BegunExport {
    /// Its file is there.
    Done(ExportedFile),
    /// It is under way, as a task of this number.
    UnderWay(u64),
}

impl Exports {
    /// Returns whether a task of the reader is an export.
    pub(super) fn is_own(task: u64) -> bool {
        task >= FIRST_TASK
    }

    /// Returns the names of the files that are being written.
    pub(super) fn under_way(&self) -> impl Iterator<Item = &str> {
        let all = self.all.values().filter(|export| export.result.is_none());
        all.map(|export| &*export.name)
    }
}

impl Segue {
    /// Writes a motion as a file, or begins to write it in the background where that takes long.
    /// `which` is as in [`Self::pose`]. A file that is written in the background is then saved for
    /// the user, or kept for [`Self::take_export`] where it `is_taken` by that.
    pub(crate) fn begin_export(
        &mut self,
        which: &str,
        how: &ExportOptions,
        is_taken: bool,
    ) -> Result<BegunExport, ApiError> {
        let Some((name, size, packed)) = self.long_export(which, how)? else {
            return Ok(BegunExport::Done(self.export_as(which, how)?));
        };
        self.exports.tasks += 1;
        let id = FIRST_TASK + self.exports.tasks;
        let task = ReadTask::of_packed_motion(id, &name, size);
        let export = Export {
            name,
            mime: how.format.mime(),
            which: which.to_owned(),
            how: *how,
            revision: self.session.revision(),
            is_taken,
            file: None,
            result: None,
        };
        self.exports.all.insert(id, export);
        self.reader.start(task, packed);
        // A call of the API causes no frame, and the library lists the export.
        self.inbox.wake();
        Ok(BegunExport::UnderWay(id))
    }

    /// Returns the result of an export, once it has ended; `None` while it is under way.
    pub(crate) fn take_export(&mut self, task: u64) -> Option<Result<LargeFile, Message>> {
        let Some(export) = self.exports.all.get(&task) else {
            return Some(Err(stopped()));
        };
        export.result.as_ref()?;
        self.exports.all.remove(&task)?.result
    }

    /// Stops the exports of files of this name. Returns whether there were any.
    pub(super) fn stop_exports(&mut self, name: &str) -> bool {
        let is_it = |export: &Export| export.name == name && export.result.is_none();
        let all = self.exports.all.iter().filter(|(_, export)| is_it(export));
        let tasks = all.map(|(task, _)| *task).collect();
        self.reader.stop(&tasks);
        self.exports.all.retain(|task, _| !tasks.contains(task));
        self.inbox.wake();
        !tasks.is_empty()
    }

    /// Takes in an event of an export.
    pub(super) fn on_export_event(&mut self, task: u64, event: ReadEvent) {
        let Some(export) = self.exports.all.get_mut(&task) else { return };
        let made = match event {
            ReadEvent::Progress(_) => return,
            ReadEvent::Bytes(file) => {
                export.file = Some(file);
                return;
            }
            ReadEvent::NoRoom(_) => Err(ReadError::NoRoom),
            ReadEvent::Done(report) => {
                report.and_then(|_| export.file.take().ok_or(ReadError::NoReport))
            }
        };
        let is_as_before = export.revision == self.session.revision();
        let (which, how) = (export.which.clone(), export.how);
        let result = match made {
            Ok(file) => Ok(file),
            Err(ReadError::Refused(reason)) => Err(reason),
            // The writer cannot be fetched, or its memory is used up: then the page writes.
            Err(_) if is_as_before => match self.export_as(&which, &how) {
                Ok(file) => Ok(LargeFile::written(&file.bytes)),
                Err(reason) => Err(Message::data(reason.to_string())),
            },
            Err(reason) => Err(reason.to_message()),
        };
        let Some(export) = self.exports.all.get_mut(&task) else { return };
        if export.is_taken {
            export.result = Some(result);
            return;
        }
        let (name, mime) = (std::mem::take(&mut export.name), export.mime);
        self.exports.all.remove(&task);
        match result {
            Ok(file) => platform::download_file(&name, mime, &file, &self.inbox),
            Err(reason) => self.say_not_saved(&reason.to_string()),
        }
    }

    /// Saves a motion as a file for the user.
    pub(super) fn save_motion(&mut self, which: &str, how: &ExportOptions) {
        match self.begin_export(which, how, false) {
            Ok(BegunExport::Done(file)) => {
                platform::download(&file.name, file.mime, &file.bytes, &self.inbox);
            }
            Ok(BegunExport::UnderWay(_)) => {}
            Err(reason) => self.say_not_saved(&reason.to_string()),
        }
    }

    fn say_not_saved(&mut self, reason: &str) {
        let reason = reason.trim_end_matches('.').to_owned();
        self.session.say(Level::Error, msg!("The file could not be saved: {reason}.", reason));
    }
}

/// The reason of an export that the user has stopped.
fn stopped() -> Message {
    msg!("it was stopped")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::platform::{FileBytes, Inbox};
    use segue_formats::bvh::{WriteOptions, write};
    use segue_motion::synth::{Action, Params, synthesize};
    use segue_session::export::{ExportBody, ExportFormat};
    use segue_session::{Command, Key, Value};
    use std::sync::Arc;

    /// Opens a page with a clip of a minute. Returns its id.
    fn open() -> (Segue, String) {
        let params = Params { duration_secs: 60.0, ..Params::new(Action::Walk) };
        let clip = synthesize(&params).expect("natural parameters").clip;
        let text = write(&clip, &WriteOptions::default());
        let mut segue = Segue::new(Inbox::default(), None, "lab=view&play=off".into());
        while segue.poll() || segue.is_busy() {}
        let bytes = FileBytes::Here(Arc::from(text.into_bytes()));
        let task = segue.load_in_background("long.bvh", bytes);
        while segue.is_reading(task) {
            segue.poll();
        }
        segue.read_result(task).expect("a result").expect("a clip");
        let own = segue.clips().into_iter().find(|clip| clip.id.starts_with("long"));
        let id = own.expect("the clip").id;
        (segue, id)
    }

    fn begin(which: &str, how: &ExportOptions, segue: &mut Segue) -> u64 {
        match segue.begin_export(which, how, true) {
            Ok(BegunExport::UnderWay(task)) => task,
            Ok(BegunExport::Done(file)) => panic!("{} was written at once", file.name),
            Err(reason) => panic!("{reason}"),
        }
    }

    fn end(task: u64, segue: &mut Segue) -> Result<LargeFile, Message> {
        loop {
            segue.poll();
            if let Some(result) = segue.take_export(task) {
                return result;
            }
        }
    }

    #[test]
    fn long_motion_is_written_in_the_background_as_at_once() {
        let (mut segue, id) = open();
        for format in [ExportFormat::Bvh, ExportFormat::Csv, ExportFormat::Glb] {
            let how = ExportOptions { format, ..ExportOptions::default() };
            let task = begin(&id, &how, &mut segue);
            let name = format!("long.{}", format.ending());
            assert_eq!(segue.exports.under_way().collect::<Vec<_>>(), [&*name]);
            let expected = segue.export_as(&id, &how).unwrap();
            let made = end(task, &mut segue).unwrap();
            assert!(made == LargeFile::written(&expected.bytes), "{name}");
            assert_eq!(segue.exports.under_way().count(), 0);
        }
        let short = segue.begin_export("walk", &ExportOptions::default(), true).unwrap();
        assert!(matches!(short, BegunExport::Done(_)));
    }

    #[test]
    fn character_goes_to_the_writer_with_the_motion() {
        let (mut segue, id) = open();
        let glb = ExportOptions { format: ExportFormat::Glb, ..ExportOptions::default() };
        let mut figure = segue.export_as("walk", &glb).unwrap().bytes;
        // The bodies of files of Segue's own are left out.
        let author = figure.windows(6).position(|found| found == b"Segue ").expect("an author");
        figure[author..author + 5].copy_from_slice(b"Other");
        let task = segue.load_in_background("figure.glb", FileBytes::Here(Arc::from(figure)));
        while segue.is_reading(task) {
            segue.poll();
        }
        segue.read_result(task).expect("a result").expect("a clip");
        let own = segue.clips().into_iter().find(|clip| clip.id.starts_with("figure"));
        let character = Value::Text(own.expect("the clip").id);
        segue.dispatch(Command::Set(vec![(Key::Character, character)]));
        assert!(segue.session.character().is_some());
        let task = begin(&id, &glb, &mut segue);
        let expected = segue.export_as(&id, &glb).unwrap();
        assert!(end(task, &mut segue).unwrap() == LargeFile::written(&expected.bytes));
        let plain = ExportOptions { body: ExportBody::Plain, ..glb };
        assert!(segue.export_as(&id, &plain).unwrap().bytes != expected.bytes);
    }

    #[test]
    fn refusal_of_a_format_is_that_of_an_export_at_once() {
        let (mut segue, id) = open();
        let how = ExportOptions { format: ExportFormat::G1Csv, ..ExportOptions::default() };
        let expected = segue.export_as(&id, &how).unwrap_err().to_string();
        let task = begin(&id, &how, &mut segue);
        assert_eq!(end(task, &mut segue).unwrap_err().to_string(), expected);
        segue.save_motion(&id, &how);
        while segue.exports.under_way().count() > 0 {
            segue.poll();
        }
        let notices = segue.session.notices().list();
        let told = notices.last().expect("a notice").text.to_string();
        assert_eq!(
            told,
            format!("The file could not be saved: {}.", expected.trim_end_matches('.'))
        );
    }

    #[test]
    fn export_that_is_stopped_says_so() {
        let (mut segue, id) = open();
        let task = begin(&id, &ExportOptions::default(), &mut segue);
        segue.stop("long.bvh").unwrap();
        assert_eq!(end(task, &mut segue).unwrap_err().to_string(), "it was stopped");
        assert!(segue.stop("long.bvh").is_err(), "nothing is under way");
    }

    #[test]
    fn page_writes_where_no_worker_can() {
        let (mut segue, id) = open();
        let how = ExportOptions::default();
        let expected = segue.export_as(&id, &how).unwrap();
        let task = begin(&id, &how, &mut segue);
        segue.on_export_event(task, ReadEvent::Done(Err(ReadError::NotStarted)));
        let made = segue.take_export(task).expect("a result").unwrap();
        assert!(made == LargeFile::written(&expected.bytes));
    }
}
