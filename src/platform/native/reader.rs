//! Large files are read on threads of their own.

use crate::platform::{FileBytes, Inbox, Incoming, ReadNews};
use segue_session::Session;
use segue_session::reading::{ReadTask, read};
use std::fmt;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// A file that is too large to be read between two frames.
#[derive(Clone, PartialEq)]
pub(crate) struct LargeFile(Arc<[u8]>);

impl LargeFile {
    /// A file of these bytes.
    pub(crate) fn new(bytes: Arc<[u8]>) -> Self {
        Self(bytes)
    }

    /// How many bytes it has.
    pub(crate) fn len(&self) -> u64 {
        self.0.len() as u64
    }

    /// Its bytes.
    pub(super) fn bytes(&self) -> &Arc<[u8]> {
        &self.0
    }
}

impl fmt::Debug for LargeFile {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "LargeFile({} bytes)", self.0.len())
    }
}

/// A window has as much memory as the system gives.
pub(crate) fn follow_memory(_reader: &mut Reader, _session: &mut Session) {}

/// Reads files elsewhere.
#[derive(Debug)]
pub(crate) struct Reader {
    inbox: Inbox,
    running: Vec<(u64, Arc<AtomicBool>)>,
}

impl Reader {
    /// One that tells `inbox` of what it reads.
    pub(crate) fn new(inbox: &Inbox) -> Self {
        Self { inbox: inbox.clone(), running: Vec::new() }
    }

    /// Begins to read a file.
    pub(crate) fn start(&mut self, task: ReadTask, bytes: FileBytes) {
        let stopped = Arc::new(AtomicBool::new(false));
        self.running.push((task.id, Arc::clone(&stopped)));
        let inbox = self.inbox.clone();
        std::thread::spawn(move || {
            let tell = |news| inbox.push(Incoming::Reading { task: task.id, news });
            let bytes = match &bytes {
                FileBytes::Here(bytes) => bytes,
                FileBytes::Large(file) => file.bytes(),
            };
            let report = read(&task.name, bytes, &task.setup, &mut |done| {
                tell(ReadNews::Progress(done as u64));
                !stopped.load(Ordering::Relaxed)
            });
            if let Some(report) = report {
                tell(ReadNews::Done(Ok(report)));
            }
        });
    }

    /// Nobody waits for this task any longer.
    pub(crate) fn stop(&mut self, task: u64) {
        self.running.retain(|(id, stopped)| {
            if *id == task {
                stopped.store(true, Ordering::Relaxed);
            }
            *id != task
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use segue_session::reading::Content;
    use segue_text::Message;
    use std::time::Duration;

    #[test]
    fn a_file_is_read_on_another_thread() {
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
            let news = inbox.take().into_iter().find_map(|incoming| match incoming {
                Incoming::Reading { news: ReadNews::Done(done), .. } => Some(done),
                _ => None,
            });
            match news {
                Some(report) => break report,
                None => std::thread::sleep(Duration::from_millis(1)),
            }
        };
        let loaded = session.finish_reading(id, report.map_err(Message::data)).unwrap().unwrap();
        assert_eq!(loaded.ids.len(), 1);
    }
}
