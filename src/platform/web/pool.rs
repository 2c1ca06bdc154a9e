//! A pool of workers that compute, each with a WebAssembly of its own, `src/bin/compute.rs`, which
//! `web/js/compute.js` starts. They share nothing with the page: clips and answers are messages.

use super::js_error_text;
use super::page::{is_hidden, listen, now_ms, requested_pool, window};
use crate::platform::Inbox;
use crate::platform::pool_size::{PoolSize, PoolStats, pool_size};
use glam::Quat;
use js_sys::{Array, ArrayBuffer, Float32Array, Function, Object, Reflect, Uint8Array};
use segue_session::Session;
use segue_session::jobs::{ANSWER_PIECE_BYTES, Answer, Job, Parcel};
use std::cell::RefCell;
use std::collections::{BTreeMap, BTreeSet, VecDeque};
use std::fmt;
use std::rc::Rc;
use wasm_bindgen::{JsCast as _, JsValue};
use web_sys::{MessageEvent, Worker};

thread_local! {
    /// A function of the page's modules that makes a worker; it takes the memory that the worker
    /// may keep, bytes.
    static NEW_COMPUTER: RefCell<Option<Function>> = const { RefCell::new(None) };
    /// The function that is called when an answer has arrived.
    static LISTENER: RefCell<Option<Box<dyn Fn()>>> = const { RefCell::new(None) };
}

/// Sets the function that makes a worker that computes.
pub(crate) fn set_computer_factory(make: Function) {
    NEW_COMPUTER.with(|slot| slot.replace(Some(make)));
}

/// Sets the function that is called when an answer has arrived, so that the app takes it between
/// frames.
pub(crate) fn set_answer_listener(listener: impl Fn() + 'static) {
    LISTENER.with(|slot| slot.replace(Some(Box::new(listener))));
}

/// The number of jobs that a worker has at once: the next one does not wait for the page.
const JOBS_AT_ONCE: usize = 2;
/// The greatest number of buffers of answers that are kept for a worker, 2 MB each.
const MAX_SPARES: usize = 4;
/// The number of floats of a clip that are sent at once: about a millisecond.
const PIECE_FLOATS: usize = 1 << 18;
/// The time after which a job counts as lost with its worker, milliseconds: one that the browser
/// has ended says nothing.
const MAX_JOB_MS: f64 = 30_000.0;
/// The number of workers that a job may take down. Then the page does its work.
const MAX_TRIES: u8 = 2;
/// The number of workers in a row that end without an answer before the page does without.
const MAX_DEATHS: usize = 4;
/// The time without jobs after which the workers are ended, because their memory never shrinks,
/// milliseconds.
const MAX_IDLE_MS: f64 = 60_000.0;
/// The memory that all workers together may keep of intermediate results, bytes.
const MAX_KEPT_BYTES: f64 = 640e6;

/// A pool of workers. They begin with the first job.
pub(crate) struct Pool(Rc<RefCell<State>>);

struct State {
    inbox: Inbox,
    /// The number of workers; 0 where the page does without.
    size: usize,
    slots: Vec<Slot>,
    /// The jobs that have ended, with the seconds that they took.
    finished: VecDeque<(u64, Option<Answer>, f64)>,
    /// Workers that were replaced, of which the session is still to be told.
    replaced: Vec<usize>,
    /// The number of workers that have ended since the last answer.
    deaths: usize,
    /// The time of the last job, milliseconds.
    used_ms: f64,
    stats: PoolStats,
}

/// A place for a worker.
#[derive(Default)]
struct Slot {
    worker: Option<Worker>,
    /// The number of workers that were here before.
    generation: u64,
    /// Whether the worker has its WebAssembly.
    is_ready: bool,
    /// The clips that it has.
    clips: BTreeSet<u32>,
    /// The clips of which it has a part: the number of their floats.
    begun: BTreeMap<u32, usize>,
    /// Its jobs, the one that runs first.
    jobs: VecDeque<Posted>,
    /// A job whose clips are still to be sent, or one of a worker that has ended.
    next: VecDeque<(Job, u8)>,
    /// Buffers of the worker's past answers. They are sent back with its next job, so that it need
    /// not allocate new ones.
    spares: Vec<ArrayBuffer>,
}

/// A job that a worker has.
struct Posted {
    job: Job,
    /// The arrays of its answer, as far as they have arrived.
    arrived: Parcel,
    /// The number of workers that ended while they ran it.
    tries: u8,
    /// The time at which it became the first, milliseconds.
    since_ms: f64,
}

impl fmt::Debug for Pool {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Pool").finish_non_exhaustive()
    }
}

impl Pool {
    /// Returns the pool of the page; empty where its address says so.
    pub(crate) fn new(inbox: &Inbox) -> Self {
        let cores = window().map_or(1.0, |window| window.navigator().hardware_concurrency());
        let size = match pool_size(requested_pool().as_deref()) {
            PoolSize::Off => 0,
            PoolSize::Workers(workers) => workers,
            PoolSize::OfCores => PoolSize::for_cores(cores as usize),
        };
        Self(Rc::new(RefCell::new(State {
            inbox: inbox.clone(),
            size,
            slots: Vec::new(),
            finished: VecDeque::new(),
            replaced: Vec::new(),
            deaths: 0,
            used_ms: 0.0,
            stats: PoolStats::default(),
        })))
    }

    /// Returns the number of workers; 0 where there are none to be had.
    pub(crate) fn size(&self) -> usize {
        self.0.borrow().size
    }

    /// Returns what the workers have done.
    pub(crate) fn stats(&self) -> PoolStats {
        let state = self.0.borrow();
        let running = state.slots.iter().filter(|slot| slot.worker.is_some()).count();
        PoolStats { running, ..state.stats }
    }

    /// Returns whether workers are at jobs.
    pub(crate) fn is_busy(&self) -> bool {
        self.0.borrow().slots.iter().any(|slot| !slot.is_idle())
    }

    /// Hands the session the answers that have arrived.
    pub(crate) fn receive(&mut self, session: &mut Session) {
        let mut state = self.0.borrow_mut();
        state.end_lost(now_ms());
        for (number, answer, secs) in std::mem::take(&mut state.finished) {
            session.finish_job(number, answer, secs);
        }
        for worker in std::mem::take(&mut state.replaced) {
            session.forget_worker(worker);
        }
    }

    /// Hands the session's jobs to workers, until a time on the page's clock or a little later.
    /// Workers are not made before the page `has_begun`. Returns whether there is more to send.
    pub(crate) fn send(&mut self, session: &mut Session, has_begun: bool, until_ms: f64) -> bool {
        let now_ms = now_ms();
        let mut state = self.0.borrow_mut();
        if state.size == 0 {
            session.set_workers(0);
            return false;
        }
        for clip in session.take_dropped_clips() {
            state.drop_clip(clip);
        }
        let is_idle = state.slots.iter().all(Slot::is_idle) && !session.has_waiting_jobs();
        if is_idle {
            if !state.slots.is_empty() && now_ms - state.used_ms > MAX_IDLE_MS {
                for worker in 0..state.slots.len() {
                    session.forget_worker(worker);
                }
                state.end_all();
            }
            return false;
        }
        if !has_begun && !is_hidden() {
            return false;
        }
        state.used_ms = now_ms;
        let size = state.size;
        state.slots.resize_with(size, Slot::default);
        drop(state);
        self.feed(session, until_ms)
    }

    /// Gives every worker jobs, one after the other, until a time. Returns whether there is more.
    fn feed(&self, session: &mut Session, until_ms: f64) -> bool {
        for queued in 1..=JOBS_AT_ONCE {
            for at in 0..self.size() {
                loop {
                    let mut state = self.0.borrow_mut();
                    let Some(slot) = state.slots.get_mut(at) else { break };
                    slot.next.retain(|(job, _)| session.is_job_wanted(job.number));
                    if slot.jobs.len() >= queued {
                        break;
                    }
                    if slot.next.is_empty() {
                        slot.next.extend(session.take_job(at).map(|job| (job, 0)));
                    }
                    if slot.next.is_empty() {
                        break;
                    }
                    drop(state);
                    if let Err(error) = self.send_next(at, until_ms) {
                        log::warn!("no worker: {}", js_error_text(&error));
                        self.0.borrow_mut().close();
                        return true;
                    }
                    if now_ms() >= until_ms {
                        return true;
                    }
                }
            }
        }
        false
    }

    /// Sends a worker its next job, after the clips that it needs, as far as time allows.
    fn send_next(&self, at: usize, until_ms: f64) -> Result<(), JsValue> {
        let is_missing = self.0.borrow().slots.get(at).is_some_and(|slot| slot.worker.is_none());
        if is_missing {
            let worker = new_worker(&self.0, at)?;
            if let Some(slot) = self.0.borrow_mut().slots.get_mut(at) {
                slot.worker = Some(worker);
            }
        }
        let mut state = self.0.borrow_mut();
        let Some(slot) = state.slots.get_mut(at) else { return Ok(()) };
        let (Some(worker), Some((job, _))) = (slot.worker.clone(), slot.next.front()) else {
            return Ok(());
        };
        for clip in &job.clips {
            if slot.clips.contains(&clip.number) {
                continue;
            }
            let number = JsValue::from(clip.number);
            let mut sent = slot.begun.get(&clip.number).copied();
            while sent != Some(clip.floats()) {
                if now_ms() >= until_ms {
                    return Ok(());
                }
                let Some(at) = sent else {
                    let parcel = clip.parcel_without_floats().map_err(|error| error.to_string())?;
                    let length = JsValue::from(clip.floats() as f64);
                    post(&worker, &[("clip", number.clone()), ("length", length)], Some(&parcel))?;
                    slot.begun.insert(clip.number, 0);
                    sent = Some(0);
                    continue;
                };
                let piece = clip.piece(at, PIECE_FLOATS);
                let properties = [("clip", number.clone()), ("at", JsValue::from(at as f64))];
                post_piece(&worker, &properties, piece)?;
                sent = Some(at + piece.len());
                slot.begun.insert(clip.number, at + piece.len());
            }
            slot.begun.remove(&clip.number);
            slot.clips.insert(clip.number);
        }
        let message = job.message().map_err(|error| error.to_string())?;
        let number = JsValue::from(job.number as f64);
        let properties = [("job", number), ("message", message.into())];
        post_job(&worker, &properties, &slot.spares.drain(..).collect())?;
        if let Some((job, tries)) = slot.next.pop_front() {
            slot.jobs.push_back(Posted {
                job,
                arrived: Parcel::default(),
                tries,
                since_ms: now_ms(),
            });
        }
        Ok(())
    }
}

impl Slot {
    fn is_idle(&self) -> bool {
        self.jobs.is_empty() && self.next.is_empty()
    }

    /// Ends the worker, and forgets what it had.
    fn end(&mut self) {
        if let Some(worker) = self.worker.take() {
            worker.terminate();
        }
        self.generation += 1;
        self.is_ready = false;
        self.clips.clear();
        self.begun.clear();
        self.spares.clear();
    }
}

impl State {
    /// Ends the workers whose job takes too long to be still running.
    fn end_lost(&mut self, now_ms: f64) {
        for at in 0..self.slots.len() {
            let first = self.slots[at].jobs.front().filter(|_| self.slots[at].is_ready);
            if first.is_some_and(|first| now_ms - first.since_ms > MAX_JOB_MS) {
                self.replace(at, "it did not answer");
            }
        }
    }

    /// Ends a worker that runs no more; another one takes its jobs over, except one that has taken
    /// down several.
    fn replace(&mut self, at: usize, reason: &str) {
        self.deaths += 1;
        self.stats.replaced += 1;
        let deaths = self.deaths;
        let Some(slot) = self.slots.get_mut(at) else { return };
        log::warn!("a worker has ended: {reason}");
        slot.end();
        for (place, Posted { job, tries, .. }) in
            std::mem::take(&mut slot.jobs).into_iter().enumerate()
        {
            // Only the first one was running.
            let tries = tries + u8::from(place == 0);
            if tries < MAX_TRIES {
                slot.next.push_back((job, tries));
            } else {
                log::warn!("a job has ended {tries} workers; the page does it");
                self.finished.push_back((job.number, None, 0.0));
            }
        }
        self.replaced.push(at);
        if deaths >= MAX_DEATHS {
            self.close();
        }
    }

    /// Ends all workers for good.
    fn close(&mut self) {
        self.end_all();
        self.size = 0;
    }

    fn end_all(&mut self) {
        for mut slot in std::mem::take(&mut self.slots) {
            slot.end();
        }
    }

    fn drop_clip(&mut self, number: u32) {
        for slot in &mut self.slots {
            let has_part = slot.begun.remove(&number).is_some();
            if (slot.clips.remove(&number) || has_part)
                && let Some(worker) = &slot.worker
                && let Err(error) = post(worker, &[("drop", number.into())], None)
            {
                log::warn!("a clip was not dropped: {}", js_error_text(&error));
            }
        }
    }

    /// Takes in a message of a worker. Returns whether the app has something to do about it.
    fn on_message(&mut self, at: usize, data: &JsValue) -> bool {
        let part =
            |name: &str| Reflect::get(data, &JsValue::from(name)).unwrap_or(JsValue::UNDEFINED);
        if let Some(reason) = part("unusable").as_string() {
            log::warn!("no workers: {reason}");
            self.close();
            return true;
        }
        if part("trapped").is_truthy() {
            self.replace(at, &part("failed").as_string().unwrap_or_default());
            return true;
        }
        let Some(slot) = self.slots.get_mut(at) else { return false };
        if part("ready").is_truthy() {
            slot.is_ready = true;
            if let Some(first) = slot.jobs.front_mut() {
                first.since_ms = now_ms();
            }
            return true;
        }
        let Some(number) = part("job").as_f64() else { return false };
        let is_it = |posted: &Posted| posted.job.number as f64 == number;
        let Some(place) = slot.jobs.iter().position(is_it) else { return false };
        if let (Some(posted), Ok(piece)) = (slot.jobs.get_mut(place), part("piece").dyn_into()) {
            let number = |name: &str| part(name).as_f64().unwrap_or(0.0) as usize;
            append_piece(&mut posted.arrived, number("array"), number("length"), &piece);
            let buffer = piece.buffer();
            let is_reused = buffer.byte_length() as usize == ANSWER_PIECE_BYTES;
            if is_reused && slot.spares.len() < MAX_SPARES {
                slot.spares.push(buffer);
            }
            return false;
        }
        let Some(mut posted) = slot.jobs.remove(place) else { return false };
        if let Some(next) = slot.jobs.front_mut() {
            next.since_ms = now_ms();
        }
        self.deaths = 0;
        let answer = answer_of(&posted.job, std::mem::take(&mut posted.arrived), &part);
        self.stats.jobs += u64::from(answer.is_some());
        if answer.is_none() {
            let reason = part("failed").as_string().unwrap_or_default();
            log::info!("a job has no answer: {reason}");
        }
        let secs = part("secs").as_f64().unwrap_or(0.0);
        self.finished.push_back((posted.job.number, answer, secs));
        true
    }
}

/// Appends a piece of an array of an answer. Array 0 holds the floats, array n the rotations of the
/// clip n - 1, four floats each. `length` is that of the whole array, floats.
fn append_piece(arrived: &mut Parcel, array: usize, length: usize, piece: &Float32Array) {
    let more = piece.length() as usize;
    let Some(clip) = array.checked_sub(1) else {
        let floats = &mut arrived.floats;
        if more == length {
            // All of it: memory that is to be filled need not be cleared.
            *floats = piece.to_vec();
            return;
        }
        floats.reserve_exact(length - floats.len().min(length));
        let start = floats.len();
        floats.resize(start + more, 0.0);
        piece.copy_to(&mut floats[start..]);
        return;
    };
    if arrived.rotations.len() == clip {
        arrived.rotations.push(Vec::with_capacity(length / 4));
    }
    if let Some(rotations) = arrived.rotations.get_mut(clip) {
        let start = rotations.len();
        rotations.resize(start + more / 4, Quat::from_array([0.0; 4]));
        piece.copy_to(bytemuck::cast_slice_mut(&mut rotations[start..]));
    }
}

/// Returns the answer in the last message of a job, before which its arrays have arrived; `None`
/// where it has none.
fn answer_of(job: &Job, arrived: Parcel, part: &impl Fn(&str) -> JsValue) -> Option<Answer> {
    let bytes: Uint8Array = part("bytes").dyn_into().ok()?;
    let head = part("head").as_string()?;
    job.answer(Parcel { head, bytes: bytes.to_vec(), ..arrived }).ok()
}

/// Posts a message with these properties, and with the head and bytes of a parcel, which are moved.
fn post(
    worker: &Worker,
    properties: &[(&str, JsValue)],
    parcel: Option<&Parcel>,
) -> Result<(), JsValue> {
    let message = message_of(properties)?;
    let Some(Parcel { head, bytes, .. }) = parcel else {
        return worker.post_message(&message);
    };
    let bytes = Uint8Array::from(&bytes[..]);
    Reflect::set(&message, &JsValue::from("head"), &JsValue::from(head))?;
    Reflect::set(&message, &JsValue::from("bytes"), &bytes)?;
    worker.post_message_with_transfer(&message, &Array::of1(&bytes.buffer()))
}

/// Posts a message with these properties and floats, which are moved.
fn post_piece(
    worker: &Worker,
    properties: &[(&str, JsValue)],
    piece: &[f32],
) -> Result<(), JsValue> {
    let message = message_of(properties)?;
    let piece = Float32Array::from(piece);
    Reflect::set(&message, &JsValue::from("piece"), &piece)?;
    worker.post_message_with_transfer(&message, &Array::of1(&piece.buffer()))
}

/// Posts a job with these properties, and buffers of earlier answers, which are moved.
fn post_job(
    worker: &Worker,
    properties: &[(&str, JsValue)],
    spares: &Array,
) -> Result<(), JsValue> {
    let message = message_of(properties)?;
    Reflect::set(&message, &JsValue::from("spares"), spares)?;
    worker.post_message_with_transfer(&message, spares)
}

fn message_of(properties: &[(&str, JsValue)]) -> Result<Object, JsValue> {
    let message = Object::new();
    for (key, value) in properties {
        Reflect::set(&message, &JsValue::from(*key), value)?;
    }
    Ok(message)
}

/// Makes a worker for a place of the pool.
fn new_worker(state: &Rc<RefCell<State>>, at: usize) -> Result<Worker, JsValue> {
    let make = NEW_COMPUTER.with(|make| make.borrow().clone());
    let make = make.ok_or_else(|| JsValue::from("this page makes none"))?;
    let (size, generation) = {
        let state = state.borrow();
        (state.size, state.slots.get(at).map_or(0, |slot| slot.generation))
    };
    let max_bytes = MAX_KEPT_BYTES / size.max(1) as f64;
    let worker: Worker = make.call1(&JsValue::NULL, &JsValue::from(max_bytes))?.dyn_into()?;
    for event in ["message", "error", "messageerror"] {
        let weak = Rc::downgrade(state);
        listen(Some(&worker), event, move |event| {
            let Some(state) = weak.upgrade() else { return };
            let is_present = |slot: &Slot| slot.generation == generation;
            if !state.borrow().slots.get(at).is_some_and(is_present) {
                return;
            }
            if let Some(event) =
                event.dyn_ref::<MessageEvent>().filter(|event| event.type_() == "message")
            {
                let is_due = state.borrow_mut().on_message(at, &event.data());
                if !is_due {
                    return;
                }
            } else {
                event.prevent_default();
                let message = Reflect::get(&event, &"message".into()).ok();
                let message = message.and_then(|text| text.as_string()).unwrap_or_default();
                state.borrow_mut().replace(at, &message);
            }
            LISTENER.with(|listener| match &*listener.borrow() {
                Some(listener) => listener(),
                None => state.borrow().inbox.wake(),
            });
        });
    }
    Ok(worker)
}
