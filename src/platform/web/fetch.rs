//! Fetching of files, lessons and bundled data.

use super::corpora::read_corpus_clip;
use super::js_error_text;
use super::page::window;
use crate::platform::motion_files::{MAX_FILE_BYTES, too_large};
use crate::platform::{FileBytes, Inbox, Incoming, LargeFile, corpus_clip_of, file_name_of};
use js_sys::{Array, Reflect, Uint8Array};
use segue_session::Sample;
use segue_session::lesson::{MAX_BYTES, Source, host_of};
use segue_session::outside::{self, short};
use segue_session::reading::LARGE_BYTES;
use segue_text::{Message, msg};
use std::cell::{Cell, OnceCell};
use std::rc::Rc;
use std::sync::Arc;
use wasm_bindgen::prelude::Closure;
use wasm_bindgen::{JsCast as _, JsValue};
use wasm_bindgen_futures::{JsFuture, spawn_local};
use web_sys::{
    AbortController, AbortSignal, ReadableStreamDefaultReader, RequestCredentials, RequestInit,
    RequestMode, Response,
};

/// The time without any data after which a request is stopped, milliseconds.
const TIMEOUT_MS: i32 = 20_000;

/// A request under way. Dropping it stops it.
#[derive(Debug)]
pub(crate) struct Fetch(Call);

impl Drop for Fetch {
    fn drop(&mut self) {
        self.0.stop();
    }
}

/// A shared handle of a request. It is stopped on demand, and when no data arrives for
/// [`TIMEOUT_MS`].
#[derive(Clone, Debug)]
struct Call(Rc<CallInner>);

#[derive(Debug)]
struct CallInner {
    controller: Option<AbortController>,
    has_timed_out: Cell<bool>,
    timer: Cell<Option<i32>>,
    on_timeout: OnceCell<Closure<dyn FnMut()>>,
}

impl Call {
    fn new() -> Self {
        let call = Self(Rc::new(CallInner {
            controller: AbortController::new().ok(),
            has_timed_out: Cell::new(false),
            timer: Cell::new(None),
            on_timeout: OnceCell::new(),
        }));
        let weak = Rc::downgrade(&call.0);
        let on_timeout = Closure::new(move || {
            if let Some(inner) = weak.upgrade() {
                inner.has_timed_out.set(true);
                inner.abort();
            }
        });
        let is_first = call.0.on_timeout.set(on_timeout);
        debug_assert!(is_first.is_ok(), "it is set once");
        call.restart_timeout();
        call
    }

    fn signal(&self) -> Option<AbortSignal> {
        self.0.controller.as_ref().map(AbortController::signal)
    }

    fn stop(&self) {
        self.0.abort();
    }

    fn is_stopped(&self) -> bool {
        self.signal().is_some_and(|signal| signal.aborted())
    }

    /// Restarts the timeout, when data has arrived.
    fn restart_timeout(&self) {
        self.0.clear_timeout();
        let (Some(window), Some(on_timeout)) = (window(), self.0.on_timeout.get()) else {
            return;
        };
        let set = window.set_timeout_with_callback_and_timeout_and_arguments_0(
            on_timeout.as_ref().unchecked_ref(),
            TIMEOUT_MS,
        );
        self.0.timer.set(set.ok());
    }

    /// Returns the notice about the timeout of the file `name`; `None` where there was none.
    fn timeout_notice(&self, address: &str, name: &str) -> Option<Message> {
        let notice = || {
            msg!(
                "{host} has sent nothing for {secs} s, so loading {name} was stopped. Try again later.",
                host = host_of(address).to_owned(),
                secs = TIMEOUT_MS / 1000,
                name = name.to_owned()
            )
        };
        self.0.has_timed_out.get().then(notice)
    }
}

impl CallInner {
    fn abort(&self) {
        if let Some(controller) = &self.controller {
            controller.abort();
        }
    }

    fn clear_timeout(&self) {
        if let (Some(window), Some(timer)) = (window(), self.timer.take()) {
            window.clear_timeout_with_handle(timer);
        }
    }
}

impl Drop for CallInner {
    fn drop(&mut self) {
        self.clear_timeout();
    }
}

/// Fetches the file at an address. The answers are [`Incoming::Progress`] and finally
/// [`Incoming::Fetched`]. There are no more answers once the returned value is dropped.
pub(crate) fn fetch(address: &str, inbox: &Inbox) -> Fetch {
    let call = Call::new();
    let fetch = Fetch(call.clone());
    let (address, inbox) = (address.to_owned(), inbox.clone());
    spawn_local(async move {
        let (name, result) = if corpus_clip_of(&address).is_some() {
            clip_of_corpus(&address, &call).await
        } else {
            (None, get(&address, &MOTION, &call, &inbox).await)
        };
        if call.is_stopped() && !call.0.has_timed_out.get() {
            return;
        }
        let shown = name.clone().unwrap_or_else(|| file_name_of(&address));
        let result = result.and_then(|pieces| pieces.into_file(&shown));
        inbox.push(Incoming::Fetched { address, name, result });
    });
    fetch
}

/// Reads a clip of a corpus. Returns the name of its file, and its data.
async fn clip_of_corpus(address: &str, call: &Call) -> (Option<String>, Result<Pieces, Message>) {
    // The page's modules have the time limit: a clip takes several requests.
    call.0.clear_timeout();
    match read_corpus_clip(address, call.signal().as_ref()).await {
        Ok((name, bytes)) => {
            let mut pieces = Pieces::new();
            pieces.push(&bytes);
            (Some(outside::file_name(&name)), Ok(pieces))
        }
        // A sentence in the language of the page.
        Err(error) => (None, Err(Message::data(js_error_text(&error)))),
    }
}

/// Fetches a bundled take. The answer is [`Incoming::Sample`].
pub(crate) fn load_sample(sample: &'static Sample, inbox: &Inbox) {
    let inbox = inbox.clone();
    spawn_local(async move {
        let result = bundled(&format!("samples/{}", sample.file), &Call::new(), &inbox).await;
        inbox.push(Incoming::Sample { sample, result });
    });
}

/// Fetches the text of a lesson. The answer is [`Incoming::Lesson`], unless the returned value is
/// dropped before.
pub(crate) fn load_lesson(source: &Source, inbox: &Inbox) -> Fetch {
    let call = Call::new();
    let fetch = Fetch(call.clone());
    let (source, inbox) = (source.clone(), inbox.clone());
    spawn_local(async move {
        let result = match &source {
            Source::BuiltIn(file) => {
                bundled(&format!("lessons/{file}"), &call, &inbox).await.map_err(|reason| {
                    let file = file.clone();
                    msg!("{file} could not be loaded: {reason}.", file, reason)
                })
            }
            Source::Web(address) => {
                get(address, &LESSON, &call, &inbox).await.map(|pieces| pieces.to_bytes())
            }
        };
        if call.is_stopped() && !call.0.has_timed_out.get() {
            return;
        }
        inbox.push(Incoming::Lesson { source, result });
    });
    fetch
}

/// Fetches the files of a language. The answer is [`Incoming::Language`].
pub(crate) fn load_language(tag: &'static str, inbox: &Inbox) {
    let inbox = inbox.clone();
    spawn_local(async move {
        let part =
            async |ending| bundled(&format!("lang/{tag}.{ending}"), &Call::new(), &inbox).await;
        let files = async { Ok([part("json").await?, part("otf").await?]) };
        let files = files.await;
        inbox.push(Incoming::Language { tag, files });
    });
}

/// Fetches a file of the page's own server.
async fn bundled(address: &str, call: &Call, inbox: &Inbox) -> Result<Arc<[u8]>, Message> {
    let refused = || {
        let late = call.0.has_timed_out.get().then_some("its server does not answer");
        Message::word(late.unwrap_or("the connection may have been interrupted"))
    };
    let response = request(address, RequestMode::SameOrigin, call).await.map_err(|_| refused())?;
    if !response.ok() {
        return Err(msg!("its server answered {status}", status = response.status()));
    }
    let bytes = read(&response, address, None, MAX_FILE_BYTES, call, inbox).await;
    bytes.map(|pieces| pieces.to_bytes()).map_err(|_| refused())
}

/// The kind of file that is expected at an address.
struct ExpectedFile {
    /// The name of the kind, with its article.
    what: &'static str,
    /// The greatest size that is read, bytes.
    max_bytes: u64,
    /// The advice for a file whose server refuses other pages.
    advice: &'static str,
}

const MOTION: ExpectedFile = ExpectedFile {
    what: "a motion file",
    max_bytes: MAX_FILE_BYTES,
    advice: "Download the file and drop it here.",
};

const LESSON: ExpectedFile = ExpectedFile {
    what: "a Markdown file",
    max_bytes: MAX_BYTES as u64,
    advice: "Put the lesson on a server that does, such as GitHub.",
};

/// Sends a request, and waits for the head of the answer.
async fn request(address: &str, mode: RequestMode, call: &Call) -> Result<Response, JsValue> {
    let window = window().ok_or("no window")?;
    let init = RequestInit::new();
    init.set_mode(mode);
    init.set_credentials(RequestCredentials::Omit);
    init.set_signal(call.signal().as_ref());
    JsFuture::from(window.fetch_with_str_and_init(address, &init)).await?.dyn_into()
}

/// Fetches a file of another server. Returns its data, or a notice.
async fn get(
    address: &str,
    expected: &ExpectedFile,
    call: &Call,
    inbox: &Inbox,
) -> Result<Pieces, Message> {
    let name = file_name_of(address);
    let Ok(response) = request(address, RequestMode::Cors, call).await else {
        return Err(match call.timeout_notice(address, &name) {
            Some(notice) => notice,
            None => refusal(address, expected).await,
        });
    };
    call.restart_timeout();
    match response.status() {
        200..=299 => {}
        404 | 410 => {
            return Err(msg!(
                "There is no file at {address} (status {status}).",
                address = short(address),
                status = response.status()
            ));
        }
        401 | 403 => {
            return Err(msg!(
                "{host} does not allow everyone to load {name} (status {status}).",
                host = host_of(address).to_owned(),
                name = name.to_string(),
                status = response.status()
            ));
        }
        status => {
            return Err(msg!(
                "{host} answered with status {status} instead of {name}. Try again later.",
                host = host_of(address).to_owned(),
                status,
                name = name.to_string()
            ));
        }
    }
    let header = |key| response.headers().get(key).ok().flatten();
    if header("content-type").is_some_and(|kind| kind.starts_with("text/html")) {
        return Err(msg!(
            "{address} is a web page, not {what}. Use the address of the file itself (on GitHub: Raw).",
            address = short(address),
            what = expected.what
        ));
    }
    let total = header("content-length").and_then(|length| length.parse::<u64>().ok());
    if let Some(reason) = total.and_then(|bytes| too_large(&name, bytes, expected.max_bytes)) {
        return Err(reason);
    }
    read(&response, address, total, expected.max_bytes, call, inbox).await.map_err(|error| {
        match error {
            BodyError::TooLarge(reason) => reason,
            BodyError::Broken(error) => call.timeout_notice(address, &name).unwrap_or_else(|| {
                msg!(
                    "The connection broke while {name} was loading: {error}.",
                    name = name.to_string(),
                    error = js_error_text(&error)
                )
            }),
        }
    })
}

/// The data of an answer, held by the browser until it is complete. The app's memory never shrinks,
/// so a file that is refused must not enter it.
struct Pieces {
    parts: Array,
    bytes: u64,
}

impl Pieces {
    fn new() -> Self {
        Self { parts: Array::new(), bytes: 0 }
    }

    fn push(&mut self, piece: &Uint8Array) {
        self.bytes += u64::from(piece.length());
        self.parts.push(piece);
    }

    /// Returns a copy of all data in the app's memory.
    fn to_bytes(&self) -> Arc<[u8]> {
        let mut bytes = Vec::with_capacity(self.bytes as usize);
        for part in self.parts.iter() {
            bytes.extend(part.unchecked_into::<Uint8Array>().to_vec());
        }
        Arc::from(bytes)
    }

    /// Returns the data as a file, which is in the app's memory only where it is small.
    fn into_file(self, name: &str) -> Result<FileBytes, Message> {
        if self.bytes <= LARGE_BYTES {
            return Ok(FileBytes::Here(self.to_bytes()));
        }
        let file = LargeFile::of_pieces(&self.parts).map(FileBytes::Large);
        file.ok_or_else(|| msg!("This browser has no room for {name}.", name = name.to_owned()))
    }
}

/// The reason why the body of an answer was not read.
enum BodyError {
    TooLarge(Message),
    Broken(JsValue),
}

impl From<JsValue> for BodyError {
    fn from(error: JsValue) -> Self {
        Self::Broken(error)
    }
}

/// Reads an answer in pieces, up to `max_bytes`. The bytes are counted, because an answer without a
/// length may be endless.
async fn read(
    response: &Response,
    address: &str,
    total: Option<u64>,
    max_bytes: u64,
    call: &Call,
    inbox: &Inbox,
) -> Result<Pieces, BodyError> {
    let mut pieces = Pieces::new();
    let Some(stream) = response.body() else {
        return Ok(pieces);
    };
    let reader: ReadableStreamDefaultReader =
        stream.get_reader().dyn_into().map_err(JsValue::from)?;
    loop {
        let chunk = JsFuture::from(reader.read()).await?;
        call.restart_timeout();
        if Reflect::get(&chunk, &"done".into())?.is_truthy() {
            return Ok(pieces);
        }
        let piece: Uint8Array = Reflect::get(&chunk, &"value".into())?.dyn_into()?;
        let done = pieces.bytes + u64::from(piece.length());
        if done > max_bytes {
            JsFuture::from(reader.cancel()).await.ok();
            return Err(BodyError::TooLarge(
                too_large(&file_name_of(address), done, max_bytes).unwrap_or_default(),
            ));
        }
        pieces.push(&piece);
        // The stated length is that of the compressed data. Once more bytes have arrived, the
        // progress is unknown.
        let total = total.filter(|&total| done <= total);
        inbox.push(Incoming::Progress { address: address.to_owned(), done, total });
    }
}

/// Returns the notice about a request that the browser refused without a reason. A second request,
/// whose answer is not read, tells an unreachable server from one that refuses other pages (CORS).
async fn refusal(address: &str, expected: &ExpectedFile) -> Message {
    let host = host_of(address).to_owned();
    let Some(window) = window() else {
        return Message::default();
    };
    if !window.navigator().on_line() {
        return msg!(
            "There is no connection to the internet, so {name} was not loaded.",
            name = file_name_of(address).to_string()
        );
    }
    if address.starts_with("http://")
        && window.is_secure_context()
        && window.location().protocol().is_ok_and(|p| p == "https:")
    {
        return msg!(
            "Browsers do not let a secure page load from {address}. Use an address that starts with https://.",
            address = short(address)
        );
    }
    let call = Call::new();
    let there = request(address, RequestMode::NoCors, &call).await.is_ok();
    call.stop();
    if there {
        let what = expected.advice;
        msg!("{host} does not allow other pages to read its files (CORS). {what}", host, what)
    } else {
        msg!(
            "{host} cannot be reached. Check the address: {address}",
            host,
            address = short(address)
        )
    }
}
