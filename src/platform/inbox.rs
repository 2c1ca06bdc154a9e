//! Answers of the platform, in order of arrival.

use super::LargeFile;
use super::file_bytes::FileBytes;
use super::read_event::ReadEvent;
use super::work::StoredWork;
use eframe::egui;
use segue_session::lesson::Source;
use segue_session::{Sample, SavedEntry};
use segue_text::Message;
use std::collections::VecDeque;
use std::fmt;
use std::sync::{Arc, Mutex, PoisonError};

/// An answer of the platform, or an event from outside the app.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Incoming {
    /// The number of files that were opened or dropped together, before the first of them.
    Opening(usize),
    /// A file that was opened or dropped.
    File {
        /// Its name.
        name: String,
        /// Its bytes.
        bytes: Arc<[u8]>,
    },
    /// A large file that was opened or dropped.
    Large {
        /// Its name.
        name: String,
        /// The platform's handle of it.
        file: LargeFile,
    },
    /// An event of a file that is read in the background.
    Reading {
        /// The task's number.
        task: u64,
        /// The event.
        event: ReadEvent,
    },
    /// A failure outside the app.
    Failed {
        /// A sentence or two that say what happened and what to do.
        reason: Message,
    },
    /// A text to copy is now in the clipboard.
    Copied,
    /// A requested picture as a `data:` URL; `None` where none could be taken.
    Picture(Option<String>),
    /// A bundled take.
    Sample {
        /// The take.
        sample: &'static Sample,
        /// Its packed bytes, or the reason why they were not loaded.
        result: Result<Arc<[u8]>, Message>,
    },
    /// The text of a lesson.
    Lesson {
        /// The lesson.
        source: Source,
        /// Its bytes, or the reason why they were not loaded.
        result: Result<Arc<[u8]>, Message>,
    },
    /// The files of a requested language.
    Language {
        /// Its tag.
        tag: &'static str,
        /// Its texts and its font, or the reason why they were not loaded.
        files: Result<[Arc<[u8]>; 2], Message>,
    },
    /// The progress of a file that is being fetched.
    Progress {
        /// The file's address.
        address: String,
        /// The bytes received so far.
        done: u64,
        /// The bytes in all, where that is known.
        total: Option<u64>,
    },
    /// The end of fetching a file.
    Fetched {
        /// The file's address.
        address: String,
        /// Its name, where the address has another one.
        name: Option<String>,
        /// Its bytes, or the reason why it was not fetched.
        result: Result<FileBytes, Message>,
    },
    /// The work in storage; `None` where there is none, or no storage.
    Stored(Option<Box<StoredWork>>),
    /// Clips that another window has just stored.
    StoredElsewhere(Vec<SavedEntry>),
    /// Requested clips of another window.
    FetchedElsewhere(Box<StoredWork>),
    /// The query of the page's address after the user went back or forward.
    Navigated(String),
    /// The loss of a graphics device.
    DeviceLost {
        /// The number of the window since the app's start. The loss of a detached window's device
        /// is ignored.
        generation: u64,
        /// The reason that the driver gives.
        reason: String,
    },
}

/// A queue of answers for the app. Clones share one queue; a push wakes the app.
#[derive(Clone, Default)]
pub(crate) struct Inbox(Arc<Mutex<Inner>>);

#[derive(Default)]
struct Inner {
    queue: VecDeque<Incoming>,
    ctx: Option<egui::Context>,
    /// Whether the next frame is for a picture.
    is_for_picture: bool,
}

impl fmt::Debug for Inbox {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_list().entries(&self.inner().queue).finish()
    }
}

impl Inbox {
    fn inner(&self) -> std::sync::MutexGuard<'_, Inner> {
        // A push cannot be left half-done, so the queue of a panicked thread is intact.
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Adds an answer, and wakes the app.
    pub(crate) fn push(&self, incoming: Incoming) {
        self.inner().queue.push_back(incoming);
        self.wake();
    }

    /// Returns whether there are no answers.
    pub(crate) fn is_empty(&self) -> bool {
        self.inner().queue.is_empty()
    }

    /// Takes out the first answer.
    pub(crate) fn pop(&self) -> Option<Incoming> {
        self.inner().queue.pop_front()
    }

    /// Takes out all answers, in order of arrival.
    #[cfg(test)]
    pub(crate) fn take(&self) -> VecDeque<Incoming> {
        std::mem::take(&mut self.inner().queue)
    }

    /// Sets the context to wake.
    pub(crate) fn set_context(&self, ctx: &egui::Context) {
        self.inner().ctx = Some(ctx.clone());
    }

    /// Returns the context to wake; `None` before the app has started.
    pub(crate) fn ctx(&self) -> Option<egui::Context> {
        self.inner().ctx.clone()
    }

    /// Requests a frame of the app of which a picture is taken, so that it is drawn finely.
    #[cfg(any(test, target_arch = "wasm32"))]
    pub(crate) fn wake_for_picture(&self) {
        self.inner().is_for_picture = true;
        self.wake();
    }

    /// Returns whether a picture is taken of this frame. It is not of the next one, unless that is
    /// requested again.
    pub(crate) fn take_for_picture(&self) -> bool {
        std::mem::take(&mut self.inner().is_for_picture)
    }

    /// Requests a frame of the app.
    pub(crate) fn wake(&self) {
        // Outside the lock, because waking may call back.
        if let Some(ctx) = self.ctx() {
            ctx.request_repaint();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn inbox_keeps_the_order_and_wakes_the_app() {
        let inbox = Inbox::default();
        let ctx = egui::Context::default();
        inbox.set_context(&ctx);
        let asked = Arc::new(Mutex::new(0));
        ctx.set_request_repaint_callback({
            let asked = Arc::clone(&asked);
            move |_| *asked.lock().unwrap() += 1
        });
        let other_end = inbox.clone();
        for name in ["1.bvh", "2.bvh"] {
            other_end.push(Incoming::File { name: name.into(), bytes: Arc::from([]) });
        }
        let names: Vec<String> = (inbox.take().into_iter())
            .map(
                |incoming| {
                    if let Incoming::File { name, .. } = incoming { name } else { String::new() }
                },
            )
            .collect();
        assert_eq!(names, ["1.bvh", "2.bvh"]);
        assert!(inbox.take().is_empty());
        assert!(*asked.lock().unwrap() > 0);
        assert!(!inbox.take_for_picture());
        other_end.wake_for_picture();
        assert_eq!((inbox.take_for_picture(), inbox.take_for_picture()), (true, false));
    }
}
