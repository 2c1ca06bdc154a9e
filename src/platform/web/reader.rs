//! Reading of files by workers with a WebAssembly of their own, `src/bin/reader.rs`, which
//! `web/js/reader.js` starts.

use super::js_error_text;
use super::page::{listen, window};
use super::stored_place::stored_place;
use crate::platform::begun::Begun;
use crate::platform::{FileBytes, Inbox, Incoming, ReadError, ReadEvent};
use js_sys::{Array, Function, Object, Reflect, Uint8Array};
use segue_session::packed::Packed;
use segue_session::reading::{LARGE_BYTES, Product, ReadReport, ReadTask, Unpacker, WireError};
use segue_session::{MemoryUse, PageMemory, Session};
use segue_text::ToMessage as _;
use std::cell::RefCell;
use std::collections::{BTreeSet, VecDeque};
use std::fmt;
use std::rc::Rc;
use std::sync::Arc;
use wasm_bindgen::{JsCast as _, JsValue};
use web_sys::{Blob, MessageEvent, Worker};

/// A file that the browser holds, so that the app's memory has no copy of its bytes.
#[derive(Clone, PartialEq)]
pub(crate) struct LargeFile(Held);

/// The way in which the browser holds a file.
#[derive(Clone)]
enum Held {
    /// By a handle.
    Blob(Blob),
    /// As an array.
    Bytes(Uint8Array),
    /// In the storage, under this SHA-256.
    Stored(String),
}

impl PartialEq for Held {
    fn eq(&self, other: &Self) -> bool {
        match (self, other) {
            (Self::Blob(one), Self::Blob(other)) => one == other,
            (Self::Bytes(one), Self::Bytes(other)) => {
                AsRef::<JsValue>::as_ref(one) == AsRef::<JsValue>::as_ref(other)
            }
            (Self::Stored(one), Self::Stored(other)) => one == other,
            _ => false,
        }
    }
}

impl LargeFile {
    /// Returns a file that the user chose.
    pub(crate) fn new(blob: Blob) -> Self {
        Self(Held::Blob(blob))
    }

    /// Returns a file that was written.
    pub(crate) fn written(bytes: &[u8]) -> Self {
        Self(Held::Bytes(Uint8Array::from(bytes)))
    }

    /// Returns a file in the storage, by its SHA-256.
    pub(super) fn stored(sha256: &str) -> Self {
        Self(Held::Stored(sha256.to_owned()))
    }

    /// Returns a file of these bytes; `None` when the browser has no room for it.
    pub(crate) fn of_bytes(bytes: &Uint8Array) -> Option<Self> {
        Self::of_pieces(&Array::of1(bytes))
    }

    /// Returns a file of these pieces, each a `Uint8Array`; `None` when the browser has no room for
    /// it.
    pub(super) fn of_pieces(pieces: &Array) -> Option<Self> {
        Blob::new_with_u8_array_sequence(pieces).ok().map(Self::new)
    }

    /// Returns the size, bytes; 0 for a file in the storage, because its clips record the size.
    pub(crate) fn len(&self) -> u64 {
        match &self.0 {
            Held::Blob(blob) => blob.size() as u64,
            Held::Bytes(bytes) => u64::from(bytes.length()),
            Held::Stored(_) => 0,
        }
    }

    /// Returns whether it is one in the storage.
    pub(crate) fn is_stored(&self) -> bool {
        matches!(self.0, Held::Stored(_))
    }

    /// Returns the value to store; `None` for a file that is in the storage already.
    pub(super) fn value(&self) -> Option<&JsValue> {
        match &self.0 {
            Held::Blob(blob) => Some(blob.as_ref()),
            Held::Bytes(bytes) => Some(bytes.as_ref()),
            Held::Stored(_) => None,
        }
    }

    /// Returns the bytes where the browser holds them as an array, as those of written files.
    pub(crate) fn array(&self) -> Option<Uint8Array> {
        match &self.0 {
            Held::Bytes(bytes) => Some(bytes.clone()),
            Held::Blob(_) | Held::Stored(_) => None,
        }
    }

    /// Returns a copy of the bytes of a written file; `None` for other files.
    pub(crate) fn to_vec(&self) -> Option<Vec<u8>> {
        self.array().map(|bytes| bytes.to_vec())
    }

    /// Returns the browser's handle of the file; `None` for a file in the storage, and when the
    /// browser has no room for it.
    fn to_blob(&self) -> Option<Blob> {
        match &self.0 {
            Held::Blob(blob) => Some(blob.clone()),
            Held::Bytes(bytes) => Blob::new_with_u8_array_sequence(&Array::of1(bytes)).ok(),
            Held::Stored(_) => None,
        }
    }
}

impl fmt::Debug for LargeFile {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "LargeFile({} bytes)", self.len())
    }
}

/// Hands a file to the browser, so that the app's memory has no copy of its bytes, if the browser
/// has room for it.
pub(crate) fn outside_memory(bytes: impl AsRef<[u8]> + Into<Arc<[u8]>>) -> FileBytes {
    let file = LargeFile::of_bytes(&Uint8Array::from(bytes.as_ref()));
    file.map_or_else(|| FileBytes::Here(bytes.into()), FileBytes::Large)
}

/// Returns a packed motion as the file of a task, outside the app's memory.
pub(crate) fn packed_file(packed: &Packed<'_>) -> FileBytes {
    let all = Uint8Array::new_with_length(packed.size() as u32);
    let mut at = 0;
    for piece in packed.pieces() {
        let end = at + piece.len() as u32;
        all.subarray(at, end).copy_from(piece);
        at = end;
    }
    FileBytes::Large(LargeFile(Held::Bytes(all)))
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

/// A reader of files in workers: one for large files, one after the other, and several for small
/// files.
pub(crate) struct Reader {
    large: Rc<RefCell<State>>,
    small: Rc<RefCell<State>>,
}

/// The most workers for small files.
const MAX_SMALL_WORKERS: usize = 4;
/// The most tasks that are begun before the first of them is done: their reports wait for it, so
/// that files join the library in the order in which they were opened.
const MAX_BEGUN: usize = 16;

/// Workers and their queue.
struct State {
    inbox: Inbox,
    slots: Vec<Slot>,
    waiting: VecDeque<(ReadTask, FileBytes)>,
    begun: Begun<ReadEvent>,
    /// The memory that is left for reports, bytes.
    room: u64,
}

/// A worker, or room for one.
#[derive(Default)]
struct Slot {
    worker: Option<Worker>,
    current: Option<CurrentTask>,
}

/// The current task of a worker.
struct CurrentTask {
    task: u64,
    size: u64,
    /// Whether a file is written, so that there is no report.
    is_packed: bool,
    /// The report so far; `None` before its head has arrived.
    unpacker: Option<Unpacker>,
}

/// Returns the number of workers for small files: one for each processor but the one of the page.
fn small_workers() -> usize {
    let processors = window().map_or(1.0, |window| window.navigator().hardware_concurrency());
    (processors as usize).saturating_sub(1).clamp(1, MAX_SMALL_WORKERS)
}

impl fmt::Debug for Reader {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Reader").finish_non_exhaustive()
    }
}

impl Reader {
    /// Returns a reader that reports to `inbox`.
    pub(crate) fn new(inbox: &Inbox) -> Self {
        let state = |workers: usize| {
            Rc::new(RefCell::new(State {
                inbox: inbox.clone(),
                slots: (0..workers).map(|_| Slot::default()).collect(),
                waiting: VecDeque::new(),
                begun: Begun::default(),
                room: u64::MAX,
            }))
        };
        Self { large: state(1), small: state(small_workers()) }
    }

    /// Queues a file to read.
    pub(crate) fn start(&mut self, task: ReadTask, bytes: FileBytes) {
        let state = if task.size > LARGE_BYTES { &self.large } else { &self.small };
        state.borrow_mut().waiting.push_back((task, bytes));
        start_next(state);
    }

    /// Stops tasks, whether they run or wait.
    pub(crate) fn stop(&mut self, tasks: &BTreeSet<u64>) {
        for state in [&self.large, &self.small] {
            state.borrow_mut().remove(tasks);
            start_next(state);
        }
    }
}

impl State {
    /// Removes tasks, and ends the workers that run them.
    fn remove(&mut self, tasks: &BTreeSet<u64>) {
        self.waiting.retain(|(waiting, _)| !tasks.contains(&waiting.id));
        let is_stopped = |slot: &&mut Slot| slot.task().is_some_and(|task| tasks.contains(&task));
        for slot in self.slots.iter_mut().filter(is_stopped) {
            slot.current = None;
            slot.end_worker();
        }
        self.begun.remove(tasks);
        self.deliver();
    }

    /// Reports an event of a task to the app, once the tasks before it are done.
    fn report(&mut self, task: u64, event: ReadEvent, is_last: bool) {
        self.begun.add(task, event, is_last);
        self.deliver();
    }

    fn deliver(&mut self) {
        for (task, event) in self.begun.take_ready() {
            self.inbox.push(Incoming::Reading { task, event });
        }
    }

    /// Returns the memory that is reserved for the reports under way, bytes.
    fn incoming_bytes(&self) -> u64 {
        let current = self.slots.iter().filter_map(|slot| slot.current.as_ref());
        current.filter_map(|current| current.unpacker.as_ref()).map(Unpacker::bytes).sum()
    }

    /// Ends the task of a slot and its worker, and reports the event.
    fn abandon(&mut self, slot: usize, event: ReadEvent) {
        let Some(slot) = self.slots.get_mut(slot) else { return };
        let current = slot.current.take();
        slot.end_worker();
        if let Some(current) = current {
            self.report(current.task, event, true);
        }
    }

    /// Ends the task of a slot and its worker, for that reason.
    fn fail(&mut self, slot: usize, reason: ReadError) {
        self.abandon(slot, ReadEvent::Done(Err(reason)));
    }

    /// Reports the end of the task of a slot. `bytes` are those of its file, if the worker has
    /// handed them over.
    fn finish(&mut self, index: usize, bytes: Option<Uint8Array>) {
        let Some(slot) = self.slots.get_mut(index) else { return };
        let Some(current) = slot.current.take() else { return };
        if current.size > MAX_KEPT_BYTES {
            slot.end_worker();
        }
        let report = match current.unpacker {
            Some(unpacker) => {
                unpacker.finish().map_err(|error| ReadError::InvalidReport(error.to_message()))
            }
            None if current.is_packed => Ok(ReadReport::default()),
            None => Err(ReadError::NoReport),
        };
        if let Some(bytes) = bytes {
            self.report(current.task, ReadEvent::Bytes(LargeFile(Held::Bytes(bytes))), false);
        }
        self.report(current.task, ReadEvent::Done(report), true);
    }

    /// Takes in a message of the worker in a slot.
    fn on_message(&mut self, index: usize, data: &JsValue) {
        let part =
            |name: &str| Reflect::get(data, &JsValue::from(name)).unwrap_or(JsValue::UNDEFINED);
        let Some(current) = self.slots.get_mut(index).and_then(|slot| slot.current.as_mut()) else {
            return;
        };
        if part("task").as_f64() != Some(current.task as f64) {
            return;
        }
        if let Some(done) = part("progress").as_f64() {
            let task = current.task;
            self.inbox.push(Incoming::Reading { task, event: ReadEvent::Progress(done as u64) });
        } else if let Some(head) = part("head").as_string() {
            match Unpacker::new(&head, self.room) {
                Ok(unpacker) => {
                    self.room = self.room.saturating_sub(unpacker.bytes());
                    current.unpacker = Some(unpacker);
                }
                Err(WireError::NoRoom { bytes }) => {
                    self.abandon(index, ReadEvent::NoRoom(bytes as u64));
                }
                Err(error) => self.fail(index, ReadError::InvalidReport(error.to_message())),
            }
        } else if let (Ok(piece), Some(unpacker)) =
            (part("piece").dyn_into::<Uint8Array>(), &mut current.unpacker)
        {
            unpacker.push(&piece.to_vec());
        } else if let Some(reason) = part("refused").as_string() {
            let reason = serde_json::from_str(&reason);
            self.fail(index, reason.map_or(ReadError::NoReport, ReadError::Refused));
        } else if let Some(reason) = part("failed").as_string() {
            self.fail(index, ReadError::Failed(reason));
        } else if part("lost").is_truthy() {
            self.fail(index, ReadError::Lost);
        } else if part("end").is_truthy() {
            self.finish(index, part("bytes").dyn_into().ok());
        }
    }
}

impl Slot {
    fn task(&self) -> Option<u64> {
        self.current.as_ref().map(|current| current.task)
    }

    fn end_worker(&mut self) {
        if let Some(worker) = self.worker.take() {
            worker.terminate();
        }
    }
}

/// Posts the next tasks to the workers, as long as one is free and a task waits.
fn start_next(state: &Rc<RefCell<State>>) {
    loop {
        let (slot, task, bytes) = {
            let mut state = state.borrow_mut();
            if state.begun.len() >= MAX_BEGUN {
                return;
            }
            // Idle workers are preferred, because starting another one takes time.
            let free = |with_worker: bool| {
                let is_free =
                    |slot: &Slot| slot.current.is_none() && slot.worker.is_some() == with_worker;
                state.slots.iter().position(is_free)
            };
            let Some(slot) = free(true).or_else(|| free(false)) else {
                return;
            };
            let Some((task, bytes)) = state.waiting.pop_front() else {
                return;
            };
            state.begun.begin(task.id);
            let is_packed = task.product == Product::PackedMotion;
            let current = CurrentTask { task: task.id, size: task.size, is_packed, unpacker: None };
            if let Some(slot) = state.slots.get_mut(slot) {
                slot.current = Some(current);
            }
            (slot, task, bytes)
        };
        if let Err(error) = post(state, slot, &task, &bytes) {
            state.borrow_mut().fail(slot, error);
        }
    }
}

impl From<JsValue> for ReadError {
    fn from(error: JsValue) -> Self {
        Self::Failed(js_error_text(&error))
    }
}

/// Posts a task to the worker in a slot, which is made where there is none.
fn post(
    state: &Rc<RefCell<State>>,
    slot: usize,
    task: &ReadTask,
    bytes: &FileBytes,
) -> Result<(), ReadError> {
    let known = state.borrow().slots.get(slot).and_then(|slot| slot.worker.clone());
    let worker = match known {
        Some(worker) => worker,
        None => new_worker(state, slot)?,
    };
    if let Some(slot) = state.borrow_mut().slots.get_mut(slot) {
        slot.worker = Some(worker.clone());
    }
    let json_error = |error: serde_json::Error| ReadError::Failed(error.to_string());
    let setup = serde_json::to_string(&task.setup).map_err(json_error)?;
    let convert = match &task.product {
        Product::Convert(options) => {
            serde_json::to_string(options.as_ref()).map_err(json_error)?.into()
        }
        Product::Clips | Product::PackedMotion => JsValue::UNDEFINED,
    };
    let file = match bytes {
        FileBytes::Here(bytes) => LargeFile::of_bytes(&Uint8Array::from(&bytes[..])),
        FileBytes::Large(file) => Some(file.clone()),
    };
    let file = file.ok_or(ReadError::NoRoom)?;
    // The user may have changed or deleted the file since, but the storage still has its bytes.
    let stored = match (&file.0, &task.setup.sha256) {
        (Held::Stored(sha256), _) | (_, Some(sha256)) => stored_place(sha256)?,
        _ => JsValue::UNDEFINED,
    };
    // The worker returns the bytes of a small new file, so that they can be stored.
    let is_new = task.setup.sha256.is_none() && task.product == Product::Clips;
    let (message, moved) = (Object::new(), Array::new());
    // A packed motion is the worker's alone: a Blob would copy it.
    let file = match file.array().filter(|_| task.product == Product::PackedMotion) {
        Some(array) => {
            moved.push(&array.buffer());
            array.buffer().into()
        }
        None => file.to_blob().map_or(JsValue::UNDEFINED, JsValue::from),
    };
    for (key, value) in [
        ("task", JsValue::from(task.id as f64)),
        ("name", JsValue::from(&task.name)),
        ("setup", JsValue::from(setup)),
        ("convert", convert),
        ("isPacked", JsValue::from(task.product == Product::PackedMotion)),
        ("file", file),
        ("stored", stored),
        ("returnsBytes", JsValue::from(is_new && task.size <= LARGE_BYTES)),
    ] {
        Reflect::set(&message, &JsValue::from(key), &value)?;
    }
    Ok(worker.post_message_with_transfer(&message, &moved)?)
}

/// Makes a worker that reports to a slot of `state`.
fn new_worker(state: &Rc<RefCell<State>>, slot: usize) -> Result<Worker, ReadError> {
    let make = NEW_WORKER.with(|make| make.borrow().clone()).ok_or(ReadError::NoWorkers)?;
    let worker: Worker = make.call0(&JsValue::NULL)?.dyn_into()?;
    let weak = Rc::downgrade(state);
    listen(Some(&worker), "message", move |event| {
        let (Some(state), Some(event)) = (weak.upgrade(), event.dyn_ref::<MessageEvent>()) else {
            return;
        };
        state.borrow_mut().on_message(slot, &event.data());
        start_next(&state);
    });
    let weak = Rc::downgrade(state);
    listen(Some(&worker), "error", move |event| {
        event.prevent_default();
        let Some(state) = weak.upgrade() else { return };
        let message =
            Reflect::get(&event, &"message".into()).ok().and_then(|text| text.as_string());
        state.borrow_mut().fail(slot, message.map_or(ReadError::NotStarted, ReadError::Failed));
        start_next(&state);
    });
    Ok(worker)
}
