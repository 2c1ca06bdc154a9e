//! Incoming answers of the platform, in order of arrival.

use super::{FileBytes, LargeFile, ReadNews, Stored};
use eframe::egui;
use segue_session::lesson::Source;
use segue_session::{Sample, SavedEntry};
use segue_text::Message;
use std::collections::VecDeque;
use std::fmt;
use std::sync::{Arc, Mutex, PoisonError};

/// What comes in from outside, in the order in which it came.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Incoming {
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
        /// Where it is.
        file: LargeFile,
    },
    /// News of a file that is read elsewhere.
    Reading {
        /// The task's number.
        task: u64,
        /// What is new.
        news: ReadNews,
    },
    /// Something outside did not work.
    Failed {
        /// What happened and what to do, in a sentence or two.
        reason: Message,
    },
    /// The text that was to be copied is in the clipboard.
    Copied,
    /// The picture that was asked for, as an address that is the picture itself; `None` where none
    /// could be taken.
    Picture(Option<String>),
    /// A bundled take.
    Sample {
        /// Which.
        sample: &'static Sample,
        /// Its packed bytes, or why they are not there.
        result: Result<Arc<[u8]>, Message>,
    },
    /// The text of a lesson.
    Lesson {
        /// Which.
        source: Source,
        /// Its bytes, or why they are not there.
        result: Result<Arc<[u8]>, Message>,
    },
    /// The files of a language that was asked for.
    Language {
        /// Its tag.
        tag: &'static str,
        /// Its texts and its font, or why they are not here.
        files: Result<[Arc<[u8]>; 2], Message>,
    },
    /// A part of a file has come over the network.
    Progress {
        /// The file's address.
        address: String,
        /// Bytes so far.
        done: u64,
        /// Bytes in all, where that is known.
        total: Option<u64>,
    },
    /// A file has come over the network.
    Fetched {
        /// The file's address.
        address: String,
        /// Its bytes, or why they did not come.
        result: Result<FileBytes, Message>,
    },
    /// Storage was read; `None` where there was nothing in it, or no storage.
    Stored(Option<Box<Stored>>),
    /// Another window has stored clips.
    StoredElsewhere(Vec<SavedEntry>),
    /// Clips of another window that were asked for.
    Joined(Box<Stored>),
    /// The user went back or forward; the query that the page's address now has.
    Navigated(String),
    /// The graphics device is gone.
    DeviceLost {
        /// Which one, counted from the app's start: one that was given up on purpose is nothing to
        /// tell.
        generation: u64,
        /// What the driver says.
        reason: String,
    },
}

/// Where answers wait until the app takes them. Clones share one box; a push wakes the app.
#[derive(Clone, Default)]
pub(crate) struct Inbox(Arc<Mutex<Inner>>);

#[derive(Default)]
struct Inner {
    queue: VecDeque<Incoming>,
    ctx: Option<egui::Context>,
}

impl fmt::Debug for Inbox {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_list().entries(&self.inner().queue).finish()
    }
}

impl Inbox {
    fn inner(&self) -> std::sync::MutexGuard<'_, Inner> {
        // A push cannot be left half-done, so what a panicking thread leaves behind is whole.
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Puts something in and wakes the app.
    pub(crate) fn push(&self, incoming: Incoming) {
        self.inner().queue.push_back(incoming);
        self.wake();
    }

    /// Takes everything out.
    pub(crate) fn take(&self) -> VecDeque<Incoming> {
        std::mem::take(&mut self.inner().queue)
    }

    /// From now on this context is woken.
    pub(crate) fn wakes(&self, ctx: &egui::Context) {
        self.inner().ctx = Some(ctx.clone());
    }

    /// The context that is woken; none before the app has started.
    pub(crate) fn ctx(&self) -> Option<egui::Context> {
        self.inner().ctx.clone()
    }

    /// Has the app drawn again.
    pub(crate) fn wake(&self) {
        // Not while locked: waking may call back.
        if let Some(ctx) = self.ctx() {
            ctx.request_repaint();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keeps_the_order_and_wakes_the_app() {
        let inbox = Inbox::default();
        let ctx = egui::Context::default();
        inbox.wakes(&ctx);
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
    }
}
