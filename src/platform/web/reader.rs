//! Files are read by a worker, which has a WebAssembly of its own: `src/bin/reader.rs`.
//! `web/js/reader.js` starts it.

use super::page::{listen, window};
use super::words_of;
use crate::platform::{FileBytes, Inbox, Incoming, ReadNews};
use js_sys::{Array, Function, Object, Reflect, Uint8Array};
use segue_session::reading::{LARGE_BYTES, ReadTask, Unpacker, WireError};
use segue_session::{MemoryUse, PageMemory, Session};
use std::cell::RefCell;
use std::collections::VecDeque;
use std::fmt;
use std::rc::Rc;
use wasm_bindgen::{JsCast as _, JsValue};
use web_sys::{Blob, MessageEvent, Worker};

/// A file that is too large to be read between two frames: it stays with the browser, and none of
/// its bytes is copied here.
#[derive(Clone, PartialEq)]
pub(crate) struct LargeFile(Blob);

impl LargeFile {
    /// A file that the user chose, or that storage had.
    pub(crate) fn new(blob: Blob) -> Self {
        Self(blob)
    }

    /// A file of these bytes; none when the browser has no room for it.
    pub(crate) fn of_bytes(bytes: &Uint8Array) -> Option<Self> {
        Self::of_pieces(&Array::of1(bytes))
    }

    /// A file of these pieces, each a `Uint8Array`; none when the browser has no room for it.
    pub(super) fn of_pieces(pieces: &Array) -> Option<Self> {
        Blob::new_with_u8_array_sequence(pieces).ok().map(Self)
    }

    /// How many bytes it has.
    pub(crate) fn len(&self) -> u64 {
        self.0.size() as u64
    }

    /// The browser's handle of it.
    pub(super) fn blob(&self) -> &Blob {
        &self.0
    }
}

impl FileBytes {
    /// How many there are.
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

thread_local! {
    /// Makes a worker that is about to start; the page's modules know from where.
    static NEW_WORKER: RefCell<Option<Function>> = const { RefCell::new(None) };
}

/// The page tells how workers are made.
pub(crate) fn workers_are_made_by(make: Function) {
    NEW_WORKER.with(|slot| slot.replace(Some(make)));
}

/// A worker that has read more than this is ended, for its memory never shrinks, bytes.
const KEPT_UP_TO: u64 = 16 << 20;

/// The length of a page of WebAssembly's memory, bytes.
const PAGE_BYTES: u64 = 65536;

/// How large the page's memory is by now, bytes.
pub(crate) fn page_bytes() -> u64 {
    core::arch::wasm32::memory_size(0) as u64 * PAGE_BYTES
}

/// Tells the session how much memory the page has, and the reader how much of it is left.
pub(crate) fn follow_memory(reader: &mut Reader, session: &mut Session) {
    // Not every browser tells.
    let navigator = window().map(|window| window.navigator());
    let device_gib = navigator
        .and_then(|navigator| Reflect::get(&navigator, &"deviceMemory".into()).ok()?.as_f64());
    let states = [&reader.large, &reader.small];
    session.note_memory(PageMemory {
        bytes: page_bytes(),
        limit: PageMemory::limit_of(device_gib),
        coming: states.map(|state| state.borrow().coming()).iter().sum(),
    });
    let left = session.memory().map_or(u64::MAX, MemoryUse::left);
    for state in states {
        state.borrow_mut().room = left;
    }
}

/// Reads files elsewhere: large ones one after the other, and small ones beside them.
pub(crate) struct Reader {
    large: Rc<RefCell<State>>,
    small: Rc<RefCell<State>>,
}

struct State {
    inbox: Inbox,
    worker: Option<Worker>,
    waiting: VecDeque<(ReadTask, FileBytes)>,
    current: Option<Current>,
    /// How much memory there is for what is read, bytes.
    room: u64,
}

struct Current {
    task: u64,
    size: u64,
    unpacker: Option<Unpacker>,
}

impl fmt::Debug for Reader {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Reader").finish_non_exhaustive()
    }
}

impl Reader {
    /// One that tells `inbox` of what it reads.
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

    /// Reads a file when those before it are read.
    pub(crate) fn start(&mut self, task: ReadTask, bytes: FileBytes) {
        let state = if bytes.len() > LARGE_BYTES { &self.large } else { &self.small };
        state.borrow_mut().waiting.push_back((task, bytes));
        next(state);
    }

    /// Nobody waits for this task any longer.
    pub(crate) fn stop(&mut self, task: u64) {
        for state in [&self.large, &self.small] {
            state.borrow_mut().forget(task);
            next(state);
        }
    }
}

impl State {
    fn forget(&mut self, task: u64) {
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

    fn tell(&self, task: u64, news: ReadNews) {
        self.inbox.push(Incoming::Reading { task, news });
    }

    /// How much memory is set aside for what is on its way, bytes.
    fn coming(&self) -> u64 {
        let unpacker = self.current.as_ref().and_then(|current| current.unpacker.as_ref());
        unpacker.map_or(0, Unpacker::bytes)
    }

    /// Gives the current task up, for that reason.
    fn fail(&mut self, reason: String) {
        self.give_up(ReadNews::Done(Err(reason)));
    }

    /// Gives the current task up, and tells so.
    fn give_up(&mut self, news: ReadNews) {
        if let Some(current) = self.current.take() {
            self.tell(current.task, news);
        }
        self.end_worker();
    }

    fn done(&mut self) {
        let Some(current) = self.current.take() else {
            return;
        };
        let report = match current.unpacker {
            Some(unpacker) => unpacker.finish().map_err(|error| error.to_string()),
            None => Err("the worker sent nothing".to_owned()),
        };
        self.tell(current.task, ReadNews::Done(report));
        if current.size > KEPT_UP_TO {
            self.end_worker();
        }
    }

    /// Takes what the worker says.
    fn hear(&mut self, data: &JsValue) {
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
            self.tell(task, ReadNews::Progress(done as u64));
        } else if let Some(head) = part("head").as_string() {
            match Unpacker::new(&head, self.room) {
                Ok(unpacker) => {
                    self.room = self.room.saturating_sub(unpacker.bytes());
                    current.unpacker = Some(unpacker);
                }
                Err(WireError::NoRoom { bytes }) => self.give_up(ReadNews::NoRoom(bytes as u64)),
                Err(error) => self.fail(error.to_string()),
            }
        } else if let (Ok(piece), Some(unpacker)) =
            (part("piece").dyn_into::<Uint8Array>(), &mut current.unpacker)
        {
            unpacker.push(&piece.to_vec());
        } else if let Some(reason) = part("failed").as_string() {
            self.fail(reason);
        } else if part("end").is_truthy() {
            self.done();
        }
    }
}

/// Gives the worker the next task, when it is free and there is one.
fn next(state: &Rc<RefCell<State>>) {
    let (task, bytes) = {
        let mut state = state.borrow_mut();
        if state.current.is_some() {
            return;
        }
        let Some((task, bytes)) = state.waiting.pop_front() else {
            return;
        };
        state.current = Some(Current { task: task.id, size: bytes.len(), unpacker: None });
        (task, bytes)
    };
    if let Err(error) = give(state, &task, &bytes) {
        state.borrow_mut().fail(words_of(&error));
        next(state);
    }
}

fn give(state: &Rc<RefCell<State>>, task: &ReadTask, bytes: &FileBytes) -> Result<(), JsValue> {
    let worker = match state.borrow().worker.clone() {
        Some(worker) => worker,
        None => new_worker(state)?,
    };
    state.borrow_mut().worker = Some(worker.clone());
    let setup = serde_json::to_string(&task.setup).map_err(|error| error.to_string())?;
    let file = match bytes {
        FileBytes::Here(bytes) => {
            LargeFile::of_bytes(&Uint8Array::from(&bytes[..]))
                .ok_or("there is no room for the file")?
                .0
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
    worker.post_message(&message)
}

fn new_worker(state: &Rc<RefCell<State>>) -> Result<Worker, JsValue> {
    let make = NEW_WORKER.with(|make| make.borrow().clone()).ok_or("the page makes no workers")?;
    let worker: Worker = make.call0(&JsValue::NULL)?.dyn_into()?;
    let weak = Rc::downgrade(state);
    listen(Some(&worker), "message", move |event| {
        let (Some(state), Some(event)) = (weak.upgrade(), event.dyn_ref::<MessageEvent>()) else {
            return;
        };
        state.borrow_mut().hear(&event.data());
        next(&state);
    });
    let weak = Rc::downgrade(state);
    listen(Some(&worker), "error", move |event| {
        event.prevent_default();
        let Some(state) = weak.upgrade() else { return };
        let message =
            Reflect::get(&event, &"message".into()).ok().and_then(|text| text.as_string());
        state
            .borrow_mut()
            .fail(message.unwrap_or_else(|| "the worker could not be started".to_owned()));
        next(&state);
    });
    Ok(worker)
}
