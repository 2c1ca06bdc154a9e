//! Answers of the platform to the app, and requests of the session to the platform.

use super::api::ApiError;
use super::converter::Converter;
use super::downloads::lesson_file;
use super::exports::Exports;
use super::{Event, Segue};
use crate::platform::{self, FileBytes, Incoming, LargeFile, ReadError, ReadEvent};
use crate::ui;
use segue_session::reading::Content;
use segue_session::{Command, Key, Level, List, Request};
use segue_text::{Message, ToMessage, msg};
use std::collections::BTreeSet;

impl Segue {
    /// Takes in an answer of the platform.
    pub(super) fn receive(&mut self, incoming: Incoming) {
        match incoming {
            // While the panel of conversions is open, files are not for the library.
            Incoming::Opening(_) if self.panels.convert.is_open => {}
            Incoming::File { name, bytes } if self.panels.convert.is_open => {
                self.converter.add_file(name, FileBytes::Here(bytes));
            }
            Incoming::Large { name, file } if self.panels.convert.is_open => {
                self.converter.add_file(name, FileBytes::Large(file));
            }
            Incoming::Opening(count) => self.session.open_together(count),
            Incoming::File { name, bytes } => self.load(&name, bytes, false),
            Incoming::Large { name, file } => {
                self.begin_reading(&name, file);
            }
            Incoming::Reading { task, event } => self.on_read_event(task, event),
            Incoming::Picture(picture) => {
                let Some(ctx) = self.inbox.ctx() else { return };
                match self.report(picture.as_deref()) {
                    Ok(report) => {
                        self.copied = ui::REPORT_COPIED;
                        platform::copy_text(report, &ctx, &self.inbox);
                    }
                    Err(reason) => {
                        let reason = reason.to_string();
                        self.session.say(
                            Level::Error,
                            msg!(
                                "The report could not be made: {reason}.",
                                reason = reason.trim_end_matches('.').to_owned()
                            ),
                        );
                    }
                }
            }
            Incoming::Copied => self.session.say(Level::Info, self.copied),
            Incoming::Failed { reason } => self.session.say(Level::Error, reason),
            Incoming::Sample { sample, result } => {
                let loaded = result.map(|packed| self.session.load_sample(sample, &packed));
                match loaded {
                    Ok(Ok(())) => {}
                    // The session has shown a notice.
                    Ok(Err(error)) => log::info!("{} was not loaded: {error}", sample.label),
                    Err(reason) => self.session.fail_sample(sample, reason),
                }
            }
            Incoming::Lesson { source, result } => {
                self.downloads.end_lesson(&source);
                let text = result.as_ref().map(|bytes| &**bytes).map_err(Message::clone);
                self.session.finish_lesson(&source, text);
            }
            Incoming::Language { tag, files } => {
                if let Some(reason) = self.languages.finish(tag, files) {
                    self.session.say(Level::Warning, reason);
                }
            }
            Incoming::Progress { address, done, total } => {
                if let Some((name, progress)) = self.downloads.progressed(&address, done, total) {
                    self.events.push(Event::Progress { name, progress });
                }
            }
            Incoming::Fetched { address, name, result } => {
                self.downloads.finished(&address, name, result);
                while let Some((name, fetched)) = self.downloads.next_ready() {
                    match fetched {
                        Ok(FileBytes::Here(bytes)) => self.load(&name, bytes, true),
                        Ok(FileBytes::Large(file)) => {
                            let (size, content) = self.keep_outside(file);
                            self.session.begin_reading_fetched(&name, content, size);
                        }
                        Err(reason) => self.session.say_of(Level::Error, &name, reason),
                    }
                }
            }
            Incoming::Stored(stored) => {
                if self.autosave.on_loaded(
                    &mut self.session,
                    &mut self.large_files,
                    stored.map(|stored| *stored),
                ) {
                    self.address.sync_from_session(&self.session);
                }
            }
            Incoming::StoredElsewhere(entries) => {
                self.autosave.on_stored_elsewhere(&self.session, entries);
            }
            Incoming::FetchedElsewhere(stored) => {
                self.autosave.on_fetched_elsewhere(
                    &mut self.session,
                    &mut self.large_files,
                    &stored,
                );
            }
            Incoming::Navigated(query) => {
                if self.address.has_changed(&query) {
                    self.dispatch(Command::OpenLink(query));
                    self.address.sync_from_session(&self.session);
                }
            }
            Incoming::DeviceLost { generation, reason } => {
                if generation == self.window.generation {
                    log::warn!("the graphics device was lost: {reason}");
                    self.events.push(Event::Lost { message: reason });
                }
            }
        }
    }

    /// Starts to read a large file in the background. Returns the task's number.
    pub(crate) fn begin_reading(&mut self, name: &str, file: LargeFile) -> u64 {
        let (size, content) = self.keep_outside(file);
        self.session.begin_reading(name, content, size)
    }

    /// Keeps a large file. Returns its size in bytes, and the key by which the document refers to
    /// it.
    fn keep_outside(&mut self, file: LargeFile) -> (u64, Content) {
        (file.len(), Content::Outside(self.large_files.insert(file)))
    }

    /// Takes in an event of a file that is being read in the background.
    fn on_read_event(&mut self, task: u64, event: ReadEvent) {
        if Exports::is_own(task) {
            return self.on_export_event(task, event);
        }
        if Converter::is_own(task) {
            return self.converter.on_read_event(task, event);
        }
        let event = match event {
            ReadEvent::Progress(done) => return self.session.progress_reading(task, done),
            ReadEvent::Bytes(bytes) => {
                self.unstored = Some((task, bytes));
                return;
            }
            event => event,
        };
        let bytes = self.unstored.take().filter(|(of, _)| *of == task).map(|(_, bytes)| bytes);
        let brings_clips = self.session.brings_clips(task);
        if let Some(key) = self.session.reading_key(task).map(str::to_owned) {
            match &event {
                ReadEvent::Done(Ok(report)) => match report.files.as_slice() {
                    [file] if file.result.is_ok() && report.is_one_file() => {
                        self.large_files.set_sha256(&key, &file.sha256);
                    }
                    _ => self.large_files.remove(&key),
                },
                // The file did not get into the library, so nothing else refers to it.
                _ if brings_clips => self.large_files.remove(&key),
                _ => {}
            }
        }
        let result = match event {
            ReadEvent::Progress(_) | ReadEvent::Bytes(_) => None,
            ReadEvent::NoRoom(needed) => self.session.refuse_for_memory(task, needed),
            ReadEvent::Done(report) => {
                self.session.finish_reading(task, report.map_err(|error| error.to_message()))
            }
        };
        let Some(result) = result else { return };
        if let (true, Ok(loaded)) = (brings_clips, &result) {
            let bytes = bytes.map(FileBytes::Large);
            self.autosave.store_clips(
                &self.session,
                &self.large_files,
                &loaded.ids,
                bytes.as_ref(),
            );
            if platform::READS_IN_BACKGROUND {
                for (sha256, bytes) in self.session.move_bytes_outside(&loaded.ids) {
                    self.large_files.insert_as(sha256, platform::outside_memory(bytes));
                }
            }
        }
        if self.read.contains_key(&task) {
            let result = result.map(|loaded| self.loaded_clips(&loaded));
            self.read.insert(task, Some(result.map_err(ApiError::Load)));
        }
    }

    /// Loads a file. An error in it becomes a notice.
    fn load(&mut self, name: &str, bytes: std::sync::Arc<[u8]>, was_fetched: bool) {
        let loaded = if was_fetched {
            self.session.load_fetched(name, bytes)
        } else {
            self.session.load(name, bytes)
        };
        match loaded {
            Ok(loaded) => {
                self.autosave.store_clips(&self.session, &self.large_files, &loaded.ids, None);
            }
            Err(error) => log::info!("{name} was not loaded: {error}"),
        }
    }

    /// Sends the session's requests to the platform, and stops fetching files that the link no
    /// longer names.
    pub(super) fn send_requests(&mut self) {
        let mut stopped = BTreeSet::new();
        for request in self.session.take_requests() {
            match request {
                Request::Sample(sample) => platform::load_sample(sample, &self.inbox),
                Request::Lesson(source) => self.downloads.start_lesson(source, &self.inbox),
                Request::Fetch(address) => self.downloads.start(address, &self.inbox),
                Request::Read(task) => {
                    if let Some(needed) = self.session.memory_lacking_for(&task) {
                        self.on_read_event(task.id, ReadEvent::NoRoom(needed));
                    } else if let Some(bytes) = self.large_files.bytes_of(&task.content) {
                        self.reader.start(task, bytes);
                    } else {
                        let lost = ReadEvent::Done(Err(ReadError::Lost));
                        self.on_read_event(task.id, lost);
                    }
                }
                Request::StopReading { task, forget } => {
                    stopped.insert(task);
                    if let Some(key) = forget {
                        self.large_files.remove(&key);
                    }
                }
            }
        }
        if !stopped.is_empty() {
            self.reader.stop(&stopped);
        }
        let wanted = self.session.params().source_addresses();
        self.downloads.keep_only(|address| wanted.iter().any(|source| source == address));
    }

    /// Stops all lessons under way. The user waits for the one opened last alone.
    pub(super) fn stop_lessons(&mut self) {
        for source in self.downloads.end_lessons() {
            let reason = msg!("Loading {name} was stopped.", name = lesson_file(&source));
            self.session.finish_lesson(&source, Err(reason));
        }
    }

    /// Stops fetching the file of that name. The addresses of a motion file are removed from the
    /// link; a lesson shows that it was stopped.
    pub(super) fn stop_fetching(&mut self, name: &str) {
        if self.stop_exports(name) {
            return;
        }
        if self.downloads.lessons_under_way().any(|lesson| lesson == name) {
            return self.stop_lessons();
        }
        let sources = self.session.params().source_addresses().iter();
        let rest = sources.filter(|address| platform::file_name_of(address) != *name);
        let rest = List::Addresses(rest.cloned().collect());
        self.dispatch(Command::Set(vec![(Key::Src, rest.into())]));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::platform::{Inbox, LargeFileStore};
    use segue_text::Table;
    use std::sync::Arc;

    #[test]
    fn notice_of_a_lost_file_is_translated_with_its_reason() {
        let mut segue = Segue::new(Inbox::default(), None, "lab=view&play=off".to_owned());
        while segue.poll() || segue.is_busy() {}
        segue.begin_reading("walk.bvh", LargeFile::new(Arc::from(&b"HIERARCHY"[..])));
        segue.large_files = LargeFileStore::default();
        segue.poll();
        let notice = segue.session.notices().list().last().expect("the file is lost");
        let table = Table::new([
            ("{name} could not be read: {reason}.", "無法讀取 {name}：{reason}。"),
            ("it is no longer available: drop it again", "請再拖入一次"),
        ]);
        assert_eq!(table.write(&notice.text), "無法讀取 walk.bvh：請再拖入一次。");
    }
}
