//! Reading of large files on threads of their own.

use crate::platform::{FileBytes, Inbox, Incoming, ReadError, ReadEvent};
use segue_session::Session;
use segue_session::packed::{self, Packed, PackedError};
use segue_session::reading::{Product, ReadReport, ReadTask, read, read_and_convert};
use std::collections::BTreeSet;
use std::fmt;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// A file that is too large to be read between two frames.
#[derive(Clone, PartialEq)]
pub(crate) struct LargeFile(Arc<[u8]>);

impl LargeFile {
    /// Returns a file of these bytes.
    pub(crate) fn new(bytes: Arc<[u8]>) -> Self {
        Self(bytes)
    }

    /// Returns a file that was written.
    pub(crate) fn written(bytes: &[u8]) -> Self {
        Self(bytes.into())
    }

    /// Returns its size, bytes.
    pub(crate) fn len(&self) -> u64 {
        self.0.len() as u64
    }

    /// Returns `false`: a window has the bytes of its files.
    #[expect(clippy::unused_self, reason = "a page has files that are only in its storage")]
    pub(crate) fn is_stored(&self) -> bool {
        false
    }

    /// Returns a copy of its bytes.
    #[expect(clippy::unnecessary_wraps, reason = "a page has files that are only in its storage")]
    pub(crate) fn to_vec(&self) -> Option<Vec<u8>> {
        Some(self.0.to_vec())
    }

    /// Returns its bytes.
    pub(super) fn bytes(&self) -> &Arc<[u8]> {
        &self.0
    }
}

impl fmt::Debug for LargeFile {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "LargeFile({} bytes)", self.0.len())
    }
}

/// Returns a file as it is: a window has room for it.
pub(crate) fn outside_memory(bytes: impl Into<Arc<[u8]>>) -> FileBytes {
    FileBytes::Here(bytes.into())
}

/// Returns a packed motion as the file of a task.
pub(crate) fn packed_file(packed: &Packed<'_>) -> FileBytes {
    FileBytes::Here(packed.to_vec().into())
}

/// Does nothing, because only the system limits the memory of a window.
pub(crate) fn update_memory(_reader: &mut Reader, _session: &mut Session) {}

/// A reader of files in the background.
#[derive(Debug)]
pub(crate) struct Reader {
    inbox: Inbox,
    /// The running tasks, and the flags that stop them.
    running: Vec<(u64, Arc<AtomicBool>)>,
}

impl Reader {
    /// Returns a reader that reports to `inbox`.
    pub(crate) fn new(inbox: &Inbox) -> Self {
        Self { inbox: inbox.clone(), running: Vec::new() }
    }

    /// Starts to read a file on a thread of its own.
    pub(crate) fn start(&mut self, task: ReadTask, bytes: FileBytes) {
        let stopped = Arc::new(AtomicBool::new(false));
        self.running.push((task.id, Arc::clone(&stopped)));
        let inbox = self.inbox.clone();
        std::thread::spawn(move || {
            let report_event = |event| inbox.push(Incoming::Reading { task: task.id, event });
            let bytes = match &bytes {
                FileBytes::Here(bytes) => bytes,
                FileBytes::Large(file) => file.bytes(),
            };
            let progress = &mut |done| {
                report_event(ReadEvent::Progress(done as u64));
                !stopped.load(Ordering::Relaxed)
            };
            let report = match &task.product {
                Product::Clips => read(&task.name, bytes, &task.setup, progress).map(Ok),
                Product::Convert(options) => {
                    read_and_convert(&task.name, bytes, &task.setup, options, progress).map(Ok)
                }
                Product::PackedMotion => Some(packed::write(bytes).map_or_else(
                    |error| match error {
                        PackedError::Damaged => Err(ReadError::Failed(error.to_string())),
                        PackedError::Refused(reason) => Err(ReadError::Refused(reason)),
                    },
                    |made| {
                        report_event(ReadEvent::Bytes(LargeFile::new(made.into())));
                        Ok(ReadReport::default())
                    },
                )),
            };
            if let Some(report) = report {
                report_event(ReadEvent::Done(report));
            }
        });
    }

    /// Stops those tasks that are running.
    pub(crate) fn stop(&mut self, tasks: &BTreeSet<u64>) {
        self.running.retain(|(id, stopped)| {
            if tasks.contains(id) {
                stopped.store(true, Ordering::Relaxed);
            }
            !tasks.contains(id)
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use segue_session::reading::Content;
    use segue_text::ToMessage as _;
    use std::time::Duration;

    #[test]
    fn file_read_on_a_thread_gives_its_clips() {
        let text: Arc<[u8]> =
            Arc::from(&b"HIERARCHY ROOT Hips { OFFSET 0 1 0 CHANNELS 1 Yrotation } MOTION Frames: 2 Frame Time: .1\n1\n2"[..]);
        let inbox = Inbox::default();
        let mut reader = Reader::new(&inbox);
        let mut session = Session::new();
        let id = session.begin_reading(
            "small.bvh",
            Content::Outside("file 1".into()),
            text.len() as u64,
        );
        let task = session.take_requests().into_iter().find_map(|request| match request {
            segue_session::Request::Read(task) => Some(task),
            _ => None,
        });
        reader.start(task.unwrap(), FileBytes::Large(LargeFile::new(text)));
        let report = loop {
            let done = inbox.take().into_iter().find_map(|incoming| match incoming {
                Incoming::Reading { event: ReadEvent::Done(done), .. } => Some(done),
                _ => None,
            });
            match done {
                Some(report) => break report,
                None => std::thread::sleep(Duration::from_millis(1)),
            }
        };
        let loaded = session
            .finish_reading(id, report.map_err(|error| error.to_message()))
            .unwrap()
            .unwrap();
        assert_eq!(loaded.ids.len(), 1);
    }
}
