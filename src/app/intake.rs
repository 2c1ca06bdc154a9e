//! What comes in from outside, and what is asked of it: files, takes, answers.

use super::downloads::lesson_file;
use super::{Event, Segue};
use crate::platform::{self, FileBytes, Incoming, LargeFile, ReadNews};
use crate::ui;
use segue_session::reading::Content;
use segue_session::{Command, Key, Level, List, Request};
use segue_text::{Message, msg};

impl Segue {
    pub(super) fn receive(&mut self, incoming: Incoming) {
        match incoming {
            Incoming::File { name, bytes } => self.load(&name, bytes, false),
            Incoming::Large { name, file } => {
                self.begin_reading(&name, file);
            }
            Incoming::Reading { task, news } => self.hear_of_reading(task, news),
            Incoming::Picture(picture) => {
                let Some(ctx) = self.inbox.ctx() else { return };
                match self.report(picture.as_deref()) {
                    Ok(report) => {
                        self.copied = ui::REPORT_COPIED;
                        platform::copy_text(report, &ctx, &self.inbox);
                    }
                    Err(reason) => {
                        let reason = reason.trim_end_matches('.');
                        self.session.say(
                            Level::Error,
                            msg!(
                                "The report could not be made: {reason}.",
                                reason = reason.to_owned()
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
                    // It was said.
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
            Incoming::Fetched { address, result } => {
                self.downloads.finished(&address, result);
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
                if self.keeper.arrived(
                    &mut self.session,
                    &mut self.vault,
                    stored.map(|stored| *stored),
                ) {
                    self.address.is_right(&self.session);
                }
            }
            Incoming::StoredElsewhere(entries) => self.keeper.hear_of(&self.session, entries),
            Incoming::Joined(stored) => {
                self.keeper.join(&mut self.session, &mut self.vault, &stored);
            }
            Incoming::Navigated(query) => {
                if self.address.is_news(&query) {
                    self.obey(Command::OpenLink(query));
                    self.address.is_right(&self.session);
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

    /// Has a large file read elsewhere. Returns the task's number.
    pub(crate) fn begin_reading(&mut self, name: &str, file: LargeFile) -> u64 {
        let (size, content) = self.keep_outside(file);
        self.session.begin_reading(name, content, size)
    }

    /// Keeps a large file. Returns how many bytes it has, and what the document knows of it.
    fn keep_outside(&mut self, file: LargeFile) -> (u64, Content) {
        (file.len(), Content::Outside(self.vault.take(file)))
    }

    fn hear_of_reading(&mut self, task: u64, news: ReadNews) {
        if let ReadNews::Progress(done) = news {
            return self.session.progress_reading(task, done);
        }
        let brings_clips = self.session.brings_clips(task);
        if let Some(key) = self.session.reading_key(task).map(str::to_owned) {
            match &news {
                ReadNews::Done(Ok(report)) => match report.files.as_slice() {
                    [file] if file.result.is_ok() && report.is_one_file() => {
                        self.vault.name(&key, &file.sha256);
                    }
                    _ => self.vault.drop_file(&key),
                },
                // A file that is not in the library yet will not be: nobody else has it.
                _ if brings_clips => self.vault.drop_file(&key),
                _ => {}
            }
        }
        let result = match news {
            ReadNews::Progress(_) => None,
            ReadNews::NoRoom(needed) => self.session.refuse_for_memory(task, needed),
            ReadNews::Done(report) => {
                self.session.finish_reading(task, report.map_err(Message::data))
            }
        };
        let Some(result) = result else { return };
        if let (true, Ok(loaded)) = (brings_clips, &result) {
            self.keeper.store_clips(&self.session, &self.vault, &loaded.ids);
        }
        if self.read.contains_key(&task) {
            let result = result.map(|loaded| self.loaded_clips(&loaded));
            let result = result.map_err(|reason| reason.to_string());
            self.read.insert(task, Some(result));
        }
    }

    /// Loads a file. What is wrong with it stands in a notice.
    fn load(&mut self, name: &str, bytes: std::sync::Arc<[u8]>, was_fetched: bool) {
        let loaded = if was_fetched {
            self.session.load_fetched(name, bytes)
        } else {
            self.session.load(name, bytes)
        };
        match loaded {
            Ok(loaded) => self.keeper.store_clips(&self.session, &self.vault, &loaded.ids),
            Err(error) => log::info!("{name} was not loaded: {error}"),
        }
    }

    pub(super) fn send_requests(&mut self) {
        for request in self.session.take_requests() {
            match request {
                Request::Sample(sample) => platform::load_sample(sample, &self.inbox),
                Request::Lesson(source) => self.downloads.start_lesson(source, &self.inbox),
                Request::Fetch(address) => self.downloads.start(address, &self.inbox),
                Request::Read(task) => {
                    if let Some(needed) = self.session.memory_lacking_for(&task) {
                        self.hear_of_reading(task.id, ReadNews::NoRoom(needed));
                    } else if let Some(bytes) = self.vault.bytes_of(&task.content) {
                        self.reader.start(task, bytes);
                    } else {
                        let gone = Err("it is no longer available: drop it again".to_owned());
                        self.hear_of_reading(task.id, ReadNews::Done(gone));
                    }
                }
                Request::StopReading { task, forget } => {
                    self.reader.stop(task);
                    if let Some(key) = forget {
                        self.vault.drop_file(&key);
                    }
                }
            }
        }
        let wanted = self.session.params().source_addresses();
        self.downloads.keep_only(|address| wanted.iter().any(|source| source == address));
    }

    /// Stops waiting for lessons: whoever opens one waits for that one alone.
    pub(super) fn stop_lessons(&mut self) {
        for source in self.downloads.end_lessons() {
            let reason = msg!("Loading {name} was stopped.", name = lesson_file(&source));
            self.session.finish_lesson(&source, Err(reason));
        }
    }

    /// Stops what comes over the network in a file of that name. The addresses of a motion file go
    /// out of the link; a lesson says that it was stopped.
    pub(super) fn stop_fetching(&mut self, name: &str) {
        if self.downloads.lessons_under_way().any(|lesson| lesson == name) {
            return self.stop_lessons();
        }
        let sources = self.session.params().source_addresses().iter();
        let rest = sources.filter(|address| platform::file_name_of(address) != *name);
        let rest = List::Addresses(rest.cloned().collect());
        self.obey(Command::Set(vec![(Key::Src, rest.into())]));
    }
}
