//! Reading of files by a worker with a WebAssembly of its own, `src/bin/reader.rs`, which
//! `web/js/reader.js` starts.

use super::js_error_text;
use super::page::{listen, window};
use crate::platform::{FileBytes, Inbox, Incoming, ReadError, ReadEvent};
use js_sys::{Array, Function, Object, Reflect, Uint8Array};
use segue_session::reading::{LARGE_BYTES, ReadTask, Unpacker, WireError};
use segue_session::{MemoryUse, PageMemory, Session};
use segue_text::ToMessage as _;
use std::cell::RefCell;
use std::collections::VecDeque;
use std::fmt;
use std::rc::Rc;
use std::sync::Arc;
use wasm_bindgen::{JsCast as _, JsValue};
use web_sys::{Blob, MessageEvent, Worker};

/// A file that is too large to be read between two frames. The browser holds it, so that the app's
/// memory has no copy of its bytes.
#[derive(Clone, PartialEq)]
pub(crate) struct LargeFile(Blob);

impl LargeFile {
    /// Returns a file that the user chose, or that was stored.
    pub(crate) fn new(blob: Blob) -> Self {
        Self(blob)
    }

    /// Returns a file of these bytes; `None` when the browser has no room for it.
    pub(crate) fn of_bytes(bytes: &Uint8Array) -> Option<Self> {
        Self::of_pieces(&Array::of1(bytes))
    }

    /// Returns a file of these pieces, each a `Uint8Array`; `None` when the browser has no room for
    /// it.
    pub(super) fn of_pieces(pieces: &Array) -> Option<Self> {
        Blob::new_with_u8_array_sequence(pieces).ok().map(Self)
    }

    /// Returns its size, bytes.
    pub(crate) fn len(&self) -> u64 {
        self.0.size() as u64
    }

    /// Returns the browser's handle of it.
    pub(super) fn blob(&self) -> &Blob {
        &self.0
    }
}

impl FileBytes {
    /// Returns the number of bytes.
    pub(super) fn len(&self) -> u64 {
        match self {
            Self::Here(bytes) => bytes.len() as u64,
            Self::Large(file) => file.len(),
        }
    }
}

impl fmt::Debug for LargeFile {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "LargeFile({} bytes)", self.len())
    }
}

/// Hands a small file to the browser, so that the app's memory has no copy of its bytes, if the
/// browser has room for it.
pub(crate) fn outside_memory(bytes: Arc<[u8]>) -> FileBytes {
    let file = LargeFile::of_bytes(&Uint8Array::from(&bytes[..]));
    file.map_or(FileBytes::Here(bytes), FileBytes::Large)
}

thread_local! {
    /// A function of the page's modules that makes a worker.
    static NEW_WORKER: RefCell<Option<Function>> = const { RefCell::new(None) };
}

/// Sets the function that makes a worker.
pub(crate) fn set_worker_factory(make: Function) {
    NEW_WORKER.with(|slot| slot.replace(Some(make)));
}

/// The largest file after which a worker is kept, bytes. After a larger one it is ended, because
/// the memory of a WebAssembly never shrinks.
const MAX_KEPT_BYTES: u64 = 16 << 20;

/// The length of a page of WebAssembly's memory, bytes.
const PAGE_BYTES: u64 = 65536;

/// Returns the size of the app's WebAssembly memory, bytes.
pub(crate) fn wasm_memory_bytes() -> u64 {
    core::arch::wasm32::memory_size(0) as u64 * PAGE_BYTES
}

/// Hands the session the size of the page's memory, and the reader the size of what is left of it.
pub(crate) fn update_memory(reader: &mut Reader, session: &mut Session) {
    // Some browsers do not have this property.
    let navigator = window().map(|window| window.navigator());
    let device_gib = navigator
        .and_then(|navigator| Reflect::get(&navigator, &"deviceMemory".into()).ok()?.as_f64());
    let states = [&reader.large, &reader.small];
    session.note_memory(PageMemory {
        bytes: wasm_memory_bytes(),
        limit: PageMemory::limit_of(device_gib),
        coming: states.map(|state| state.borrow().incoming_bytes()).iter().sum(),
    });
    let left = session.memory().map_or(u64::MAX, MemoryUse::left);
    for state in states {
        state.borrow_mut().room = left;
    }
}

/// A reader of files in workers: one for large files, one after the other, and one for small
/// files.
pub(crate) struct Reader {
    large: Rc<RefCell<State>>,
    small: Rc<RefCell<State>>,
}

/// A worker and its queue.
struct State {
    inbox: Inbox,
    worker: Option<Worker>,
    waiting: VecDeque<(ReadTask, FileBytes)>,
    current: Option<CurrentTask>,
    /// The memory that is left for reports, bytes.
    room: u64,
}

/// The task that the worker is at.
struct CurrentTask {
    task: u64,
    size: u64,
    /// The report so far; `None` before its head has arrived.
    unpacker: Option<Unpacker>,
}

impl fmt::Debug for Reader {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Reader").finish_non_exhaustive()
    }
}

impl Reader {
    /// Returns a reader that reports to `inbox`.
    pub(crate) fn new(inbox: &Inbox) -> Self {
        let state = || {
            Rc::new(RefCell::new(State {
                inbox: inbox.clone(),
                worker: None,
                waiting: VecDeque::new(),
                current: None,
                room: u64::MAX,
            }))
        };
        Self { large: state(), small: state() }
    }

    /// Queues a file to read.
    pub(crate) fn start(&mut self, task: ReadTask, bytes: FileBytes) {
        let state = if bytes.len() > LARGE_BYTES { &self.large } else { &self.small };
        state.borrow_mut().waiting.push_back((task, bytes));
        start_next(state);
    }

    /// Stops a task, if it is running or waits.
    pub(crate) fn stop(&mut self, task: u64) {
        for state in [&self.large, &self.small] {
            state.borrow_mut().remove(task);
            start_next(state);
        }
    }
}

impl State {
    /// Removes a task, and ends the worker that runs it.
    fn remove(&mut self, task: u64) {
        self.waiting.retain(|(waiting, _)| waiting.id != task);
        if self.current.as_ref().is_some_and(|current| current.task == task) {
            self.current = None;
            self.end_worker();
        }
    }

    fn end_worker(&mut self) {
        if let Some(worker) = self.worker.take() {
            worker.terminate();
        }
    }

    /// Reports an event of a task to the app.
    fn report(&self, task: u64, event: ReadEvent) {
        self.inbox.push(Incoming::Reading { task, event });
    }

    /// Returns the memory that is reserved for the report under way, bytes.
    fn incoming_bytes(&self) -> u64 {
        let unpacker = self.current.as_ref().and_then(|current| current.unpacker.as_ref());
        unpacker.map_or(0, Unpacker::bytes)
    }

    /// Ends the current task and the worker, for that reason.
    fn fail(&mut self, reason: ReadError) {
        self.abandon(ReadEvent::Done(Err(reason)));
    }

    /// Ends the current task and the worker, and reports the event.
    fn abandon(&mut self, event: ReadEvent) {
        if let Some(current) = self.current.take() {
            self.report(current.task, event);
        }
        self.end_worker();
    }

    /// Reports the end of the current task.
    fn finish(&mut self) {
        let Some(current) = self.current.take() else {
            return;
        };
        let report = match current.unpacker {
            Some(unpacker) => {
                unpacker.finish().map_err(|error| ReadError::InvalidReport(error.to_message()))
            }
            None => Err(ReadError::NoReport),
        };
        self.report(current.task, ReadEvent::Done(report));
        if current.size > MAX_KEPT_BYTES {
            self.end_worker();
        }
    }

    /// Takes in a message of the worker.
    fn on_message(&mut self, data: &JsValue) {
        let part =
            |name: &str| Reflect::get(data, &JsValue::from(name)).unwrap_or(JsValue::UNDEFINED);
        let Some(current) = &mut self.current else {
            return;
        };
        if part("task").as_f64() != Some(current.task as f64) {
            return;
        }
        if let Some(done) = part("progress").as_f64() {
            let task = current.task;
            self.report(task, ReadEvent::Progress(done as u64));
        } else if let Some(head) = part("head").as_string() {
            match Unpacker::new(&head, self.room) {
                Ok(unpacker) => {
                    self.room = self.room.saturating_sub(unpacker.bytes());
                    current.unpacker = Some(unpacker);
                }
                Err(WireError::NoRoom { bytes }) => self.abandon(ReadEvent::NoRoom(bytes as u64)),
                Err(error) => self.fail(ReadError::InvalidReport(error.to_message())),
            }
        } else if let (Ok(piece), Some(unpacker)) =
            (part("piece").dyn_into::<Uint8Array>(), &mut current.unpacker)
        {
            unpacker.push(&piece.to_vec());
        } else if let Some(reason) = part("failed").as_string() {
            self.fail(ReadError::Failed(reason));
        } else if part("end").is_truthy() {
            self.finish();
        }
    }
}

/// Posts the next task to the worker, when it is free and a task waits.
fn start_next(state: &Rc<RefCell<State>>) {
    let (task, bytes) = {
        let mut state = state.borrow_mut();
        if state.current.is_some() {
            return;
        }
        let Some((task, bytes)) = state.waiting.pop_front() else {
            return;
        };
        state.current = Some(CurrentTask { task: task.id, size: bytes.len(), unpacker: None });
        (task, bytes)
    };
    if let Err(error) = post(state, &task, &bytes) {
        state.borrow_mut().fail(error);
        start_next(state);
    }
}

impl From<JsValue> for ReadError {
    fn from(error: JsValue) -> Self {
        Self::Failed(js_error_text(&error))
    }
}

/// Posts a task to the worker, which is made where there is none.
fn post(state: &Rc<RefCell<State>>, task: &ReadTask, bytes: &FileBytes) -> Result<(), ReadError> {
    let worker = match state.borrow().worker.clone() {
        Some(worker) => worker,
        None => new_worker(state)?,
    };
    state.borrow_mut().worker = Some(worker.clone());
    let setup =
        serde_json::to_string(&task.setup).map_err(|error| ReadError::Failed(error.to_string()))?;
    let file = match bytes {
        FileBytes::Here(bytes) => {
            LargeFile::of_bytes(&Uint8Array::from(&bytes[..])).ok_or(ReadError::NoRoom)?.0
        }
        FileBytes::Large(file) => file.blob().clone(),
    };
    let message = Object::new();
    for (key, value) in [
        ("task", JsValue::from(task.id as f64)),
        ("name", JsValue::from(&task.name)),
        ("setup", JsValue::from(setup)),
        ("file", JsValue::from(file)),
    ] {
        Reflect::set(&message, &JsValue::from(key), &value)?;
    }
    Ok(worker.post_message(&message)?)
}

/// Makes a worker that reports to `state`.
fn new_worker(state: &Rc<RefCell<State>>) -> Result<Worker, ReadError> {
    let make = NEW_WORKER.with(|make| make.borrow().clone()).ok_or(ReadError::NoWorkers)?;
    let worker: Worker = make.call0(&JsValue::NULL)?.dyn_into()?;
    let weak = Rc::downgrade(state);
    listen(Some(&worker), "message", move |event| {
        let (Some(state), Some(event)) = (weak.upgrade(), event.dyn_ref::<MessageEvent>()) else {
            return;
        };
        state.borrow_mut().on_message(&event.data());
        start_next(&state);
    });
    let weak = Rc::downgrade(state);
    listen(Some(&worker), "error", move |event| {
        event.prevent_default();
        let Some(state) = weak.upgrade() else { return };
        let message =
            Reflect::get(&event, &"message".into()).ok().and_then(|text| text.as_string());
        state.borrow_mut().fail(message.map_or(ReadError::NotStarted, ReadError::Failed));
        start_next(&state);
    });
    Ok(worker)
}
