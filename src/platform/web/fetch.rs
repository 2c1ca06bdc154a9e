//! Files over the network.

use super::page::window;
use super::words_of;
use crate::platform::{
    FileBytes, Inbox, Incoming, LargeFile, MAX_FILE_BYTES, file_name_of, too_large,
};
use js_sys::{Array, Reflect, Uint8Array};
use segue_session::Sample;
use segue_session::lesson::{MAX_BYTES, Source, host_of};
use segue_session::outside::short;
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

/// A server that sends nothing for so long has been waited for long enough, milliseconds.
const PATIENCE_MS: i32 = 20_000;

/// Something that is under way. Dropping it stops it.
#[derive(Debug)]
pub(crate) struct Fetch(Call);

impl Drop for Fetch {
    fn drop(&mut self) {
        self.0.stop();
    }
}

/// What several hold on to who wait for one answer: it can be ended, and is ended when nothing
/// comes for [`PATIENCE_MS`].
#[derive(Clone, Debug)]
struct Call(Rc<CallInner>);

#[derive(Debug)]
struct CallInner {
    controller: Option<AbortController>,
    is_late: Cell<bool>,
    timer: Cell<Option<i32>>,
    ring: OnceCell<Closure<dyn FnMut()>>,
}

impl Call {
    fn new() -> Self {
        let call = Self(Rc::new(CallInner {
            controller: AbortController::new().ok(),
            is_late: Cell::new(false),
            timer: Cell::new(None),
            ring: OnceCell::new(),
        }));
        let weak = Rc::downgrade(&call.0);
        let ring = Closure::new(move || {
            if let Some(inner) = weak.upgrade() {
                inner.is_late.set(true);
                inner.abort();
            }
        });
        let is_first = call.0.ring.set(ring);
        debug_assert!(is_first.is_ok(), "it is set once");
        call.goes_on();
        call
    }

    fn signal(&self) -> Option<AbortSignal> {
        self.0.controller.as_ref().map(AbortController::signal)
    }

    fn stop(&self) {
        self.0.abort();
    }

    fn is_over(&self) -> bool {
        self.signal().is_some_and(|signal| signal.aborted())
    }

    /// Something has come: the patience begins anew.
    fn goes_on(&self) {
        self.0.clear();
        let (Some(window), Some(ring)) = (window(), self.0.ring.get()) else {
            return;
        };
        let set = window.set_timeout_with_callback_and_timeout_and_arguments_0(
            ring.as_ref().unchecked_ref(),
            PATIENCE_MS,
        );
        self.0.timer.set(set.ok());
    }

    /// What is said where the patience has ended: of the file `name` at an address.
    fn lateness(&self, address: &str, name: &str) -> Option<Message> {
        let said = || {
            msg!(
                "{host} has sent nothing for {secs} s, so loading {name} was stopped. Try again later.",
                host = host_of(address).to_owned(),
                secs = PATIENCE_MS / 1000,
                name = name.to_owned()
            )
        };
        self.0.is_late.get().then(said)
    }
}

impl CallInner {
    fn abort(&self) {
        if let Some(controller) = &self.controller {
            controller.abort();
        }
    }

    fn clear(&self) {
        if let (Some(window), Some(timer)) = (window(), self.timer.take()) {
            window.clear_timeout_with_handle(timer);
        }
    }
}

impl Drop for CallInner {
    fn drop(&mut self) {
        self.clear();
    }
}

/// Asks for the file at an address. [`Incoming::Progress`] tells how it goes on,
/// [`Incoming::Fetched`] how it ended; nothing comes any more once the result of this function is
/// dropped.
pub(crate) fn fetch(address: &str, inbox: &Inbox) -> Fetch {
    let call = Call::new();
    let fetch = Fetch(call.clone());
    let (address, inbox) = (address.to_owned(), inbox.clone());
    spawn_local(async move {
        let result = get(&address, &MOTION, &call, &inbox).await;
        if call.is_over() && !call.0.is_late.get() {
            return;
        }
        let result = result.and_then(|pieces| pieces.into_file(&file_name_of(&address)));
        inbox.push(Incoming::Fetched { address, result });
    });
    fetch
}

/// Asks for a bundled take; [`Incoming::Sample`] brings it.
pub(crate) fn load_sample(sample: &'static Sample, inbox: &Inbox) {
    let inbox = inbox.clone();
    spawn_local(async move {
        let result = bundled(&format!("samples/{}", sample.file), &Call::new(), &inbox).await;
        inbox.push(Incoming::Sample { sample, result });
    });
}

/// Asks for the text of a lesson; [`Incoming::Lesson`] brings it, unless the result of this
/// function is dropped before.
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
        if call.is_over() && !call.0.is_late.get() {
            return;
        }
        inbox.push(Incoming::Lesson { source, result });
    });
    fetch
}

/// Asks for the files of a language; [`Incoming::Language`] brings them.
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

/// A file that lies beside the page.
async fn bundled(address: &str, call: &Call, inbox: &Inbox) -> Result<Arc<[u8]>, Message> {
    let refused = || {
        let late = call.0.is_late.get().then_some("its server does not answer");
        Message::word(late.unwrap_or("the connection may have been interrupted"))
    };
    let response = request(address, RequestMode::SameOrigin, call).await.map_err(|_| refused())?;
    if !response.ok() {
        return Err(msg!("its server answered {status}", status = response.status()));
    }
    let bytes = read(&response, address, None, MAX_FILE_BYTES, call, inbox).await;
    bytes.map(|pieces| pieces.to_bytes()).map_err(|_| refused())
}

/// What is asked for at an address.
struct Wanted {
    /// What it is.
    what: &'static str,
    /// The most bytes that are read.
    most_bytes: u64,
    /// What to do with a file that its server gives to nobody's page.
    otherwise: &'static str,
}

const MOTION: Wanted = Wanted {
    what: "a motion file",
    most_bytes: MAX_FILE_BYTES,
    otherwise: "Download the file and drop it here.",
};

const LESSON: Wanted = Wanted {
    what: "a Markdown file",
    most_bytes: MAX_BYTES as u64,
    otherwise: "Put the lesson on a server that does, such as GitHub.",
};

async fn request(address: &str, mode: RequestMode, call: &Call) -> Result<Response, JsValue> {
    let window = window().ok_or("no window")?;
    let init = RequestInit::new();
    init.set_mode(mode);
    init.set_credentials(RequestCredentials::Omit);
    init.set_signal(call.signal().as_ref());
    JsFuture::from(window.fetch_with_str_and_init(address, &init)).await?.dyn_into()
}

async fn get(
    address: &str,
    wanted: &Wanted,
    call: &Call,
    inbox: &Inbox,
) -> Result<Pieces, Message> {
    let name = file_name_of(address);
    let Ok(response) = request(address, RequestMode::Cors, call).await else {
        return Err(match call.lateness(address, &name) {
            Some(late) => late,
            None => why_refused(address, wanted).await,
        });
    };
    call.goes_on();
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
            what = wanted.what
        ));
    }
    let total = header("content-length").and_then(|length| length.parse::<u64>().ok());
    if let Some(reason) = total.and_then(|bytes| too_large(&name, bytes, wanted.most_bytes)) {
        return Err(reason);
    }
    read(&response, address, total, wanted.most_bytes, call, inbox).await.map_err(|error| {
        match error {
            Unread::TooLarge(reason) => reason,
            Unread::Broken(error) => call.lateness(address, &name).unwrap_or_else(|| {
                msg!(
                    "The connection broke while {name} was loading: {error}.",
                    name = name.to_string(),
                    error = words_of(&error)
                )
            }),
        }
    })
}

/// What came of an answer. It stays with the browser until all of it is there: the page's own
/// memory would keep the size of a file that is refused.
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

    /// All of it in the page's memory.
    fn to_bytes(&self) -> Arc<[u8]> {
        let mut bytes = Vec::with_capacity(self.bytes as usize);
        for part in self.parts.iter() {
            bytes.extend(part.unchecked_into::<Uint8Array>().to_vec());
        }
        Arc::from(bytes)
    }

    /// The file `name`: in the page's memory only where it is small.
    fn into_file(self, name: &str) -> Result<FileBytes, Message> {
        if self.bytes <= LARGE_BYTES {
            return Ok(FileBytes::Here(self.to_bytes()));
        }
        let file = LargeFile::of_pieces(&self.parts).map(FileBytes::Large);
        file.ok_or_else(|| msg!("This browser has no room for {name}.", name = name.to_owned()))
    }
}

enum Unread {
    TooLarge(Message),
    Broken(JsValue),
}

impl From<JsValue> for Unread {
    fn from(error: JsValue) -> Self {
        Self::Broken(error)
    }
}

/// Reads an answer piece by piece. An answer without a length may be endless, so it is counted, not
/// trusted.
async fn read(
    response: &Response,
    address: &str,
    total: Option<u64>,
    most_bytes: u64,
    call: &Call,
    inbox: &Inbox,
) -> Result<Pieces, Unread> {
    let mut pieces = Pieces::new();
    let Some(stream) = response.body() else {
        return Ok(pieces);
    };
    let reader: ReadableStreamDefaultReader =
        stream.get_reader().dyn_into().map_err(JsValue::from)?;
    loop {
        let chunk = JsFuture::from(reader.read()).await?;
        call.goes_on();
        if Reflect::get(&chunk, &"done".into())?.is_truthy() {
            return Ok(pieces);
        }
        let piece: Uint8Array = Reflect::get(&chunk, &"value".into())?.dyn_into()?;
        let done = pieces.bytes + u64::from(piece.length());
        if done > most_bytes {
            JsFuture::from(reader.cancel()).await.ok();
            return Err(Unread::TooLarge(
                too_large(&file_name_of(address), done, most_bytes).unwrap_or_default(),
            ));
        }
        pieces.push(&piece);
        // The length is that of what travels, packed; once there is more than that, it says
        // nothing.
        let total = total.filter(|&total| done <= total);
        inbox.push(Incoming::Progress { address: address.to_owned(), done, total });
    }
}

/// A browser does not say why it refused. Asking again without wanting to read the answer tells
/// apart a server that is not there from one that does not let other pages read.
async fn why_refused(address: &str, wanted: &Wanted) -> Message {
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
        let what = wanted.otherwise;
        msg!("{host} does not allow other pages to read its files (CORS). {what}", host, what)
    } else {
        msg!(
            "{host} cannot be reached. Check the address: {address}",
            host,
            address = short(address)
        )
    }
}
