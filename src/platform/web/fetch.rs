//! Files over the network.

use super::page::window;
use super::words_of;
use crate::platform::{Inbox, Incoming, MAX_FILE_BYTES, file_name_of, too_large};
use js_sys::{Reflect, Uint8Array};
use segue::session::Sample;
use segue::session::lesson::{MOST_BYTES, Source};
use std::sync::Arc;
use wasm_bindgen::{JsCast as _, JsValue};
use wasm_bindgen_futures::{JsFuture, spawn_local};
use web_sys::{AbortController, AbortSignal, ReadableStreamDefaultReader, RequestCredentials, RequestInit, RequestMode, Response};

/// A file that is under way. Dropping it stops it.
#[derive(Debug)]
pub(crate) struct Fetch(Option<AbortController>);

impl Drop for Fetch {
    fn drop(&mut self) {
        if let Some(controller) = &self.0 {
            controller.abort();
        }
    }
}

/// Asks for the file at an address. [`Incoming::Progress`] tells how it goes on, [`Incoming::Fetched`] how it ended; nothing comes
/// any more once the result of this function is dropped.
pub(crate) fn fetch(address: &str, inbox: &Inbox) -> Fetch {
    let controller = AbortController::new().ok();
    let signal = controller.as_ref().map(AbortController::signal);
    let (address, inbox) = (address.to_owned(), inbox.clone());
    spawn_local(async move {
        let result = get(&address, &MOTION, signal.as_ref(), &inbox).await;
        if signal.is_some_and(|signal| signal.aborted()) {
            return;
        }
        let result = result.map(|bytes| (file_name_of(&address), Arc::from(bytes)));
        inbox.push(Incoming::Fetched { address, result });
    });
    Fetch(controller)
}

/// Asks for a bundled take; [`Incoming::Sample`] brings it.
pub(crate) fn load_sample(sample: &'static Sample, inbox: &Inbox) {
    let inbox = inbox.clone();
    spawn_local(async move {
        let result = bundled(&format!("samples/{}", sample.file)).await;
        inbox.push(Incoming::Sample { sample, result });
    });
}

/// Asks for the text of a lesson; [`Incoming::Lesson`] brings it.
pub(crate) fn load_lesson(source: &Source, inbox: &Inbox) {
    let (source, inbox) = (source.clone(), inbox.clone());
    spawn_local(async move {
        let result = match &source {
            Source::BuiltIn(file) => bundled(&format!("lessons/{file}"))
                .await
                .map_err(|reason| format!("{file} could not be loaded: {reason}.")),
            Source::Web(address) => get(address, &LESSON, None, &inbox).await.map(Arc::from),
        };
        inbox.push(Incoming::Lesson { source, result });
    });
}

/// Asks for what it takes to speak a language; [`Incoming::Language`] brings it.
pub(crate) fn load_language(tag: &'static str, inbox: &Inbox) {
    let inbox = inbox.clone();
    spawn_local(async move {
        let files = async {
            let catalogue = bundled(&format!("lang/{tag}.json")).await?;
            Ok([catalogue, bundled(&format!("lang/{tag}.otf")).await?])
        };
        inbox.push(Incoming::Language(files.await));
    });
}

/// A file that lies beside the page.
async fn bundled(address: &str) -> Result<Arc<[u8]>, String> {
    match request(address, RequestMode::SameOrigin, None).await {
        Err(_) => Err("the connection may have been interrupted".to_owned()),
        Ok(response) if !response.ok() => Err(format!("its server answered {}", response.status())),
        Ok(response) => whole(&response).await.map(Arc::from).map_err(|error| words_of(&error)),
    }
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
    most_bytes: MOST_BYTES as u64,
    otherwise: "Put the lesson on a server that does, such as GitHub.",
};

async fn whole(response: &Response) -> Result<Vec<u8>, JsValue> {
    let buffer = JsFuture::from(response.array_buffer()?).await?;
    Ok(Uint8Array::new(&buffer).to_vec())
}

async fn request(address: &str, mode: RequestMode, signal: Option<&AbortSignal>) -> Result<Response, JsValue> {
    let window = window().ok_or("no window")?;
    let init = RequestInit::new();
    init.set_mode(mode);
    init.set_credentials(RequestCredentials::Omit);
    init.set_signal(signal);
    JsFuture::from(window.fetch_with_str_and_init(address, &init)).await?.dyn_into()
}

async fn get(address: &str, wanted: &Wanted, signal: Option<&AbortSignal>, inbox: &Inbox) -> Result<Vec<u8>, String> {
    let name = file_name_of(address);
    let Ok(response) = request(address, RequestMode::Cors, signal).await else {
        return Err(why_refused(address, wanted).await);
    };
    match response.status() {
        200..=299 => {}
        404 | 410 => return Err(format!("There is no file at {address} (answer {}).", response.status())),
        401 | 403 => {
            return Err(format!(
                "{} does not give {name} to everybody (answer {}).",
                host_of(address),
                response.status()
            ));
        }
        status => {
            return Err(format!(
                "{} answered {status} instead of {name}. Try again later.",
                host_of(address)
            ));
        }
    }
    let header = |key| response.headers().get(key).ok().flatten();
    if header("content-type").is_some_and(|kind| kind.starts_with("text/html")) {
        return Err(format!(
            "{address} is a web page, not {}. Use the address of the file itself (on GitHub: Raw).",
            wanted.what
        ));
    }
    let total = header("content-length").and_then(|length| length.parse::<u64>().ok());
    if let Some(reason) = total.and_then(|bytes| too_large(&name, bytes, wanted.most_bytes)) {
        return Err(reason);
    }
    read(&response, address, total, wanted.most_bytes, inbox)
        .await
        .map_err(|error| match error {
            Unread::TooLarge(reason) => reason,
            Unread::Broken(error) => format!("The connection broke while {name} was loading: {}.", words_of(&error)),
        })
}

enum Unread {
    TooLarge(String),
    Broken(JsValue),
}

impl From<JsValue> for Unread {
    fn from(error: JsValue) -> Self {
        Self::Broken(error)
    }
}

/// Reads an answer piece by piece. An answer without a length may be endless, so it is counted, not trusted.
async fn read(response: &Response, address: &str, total: Option<u64>, most_bytes: u64, inbox: &Inbox) -> Result<Vec<u8>, Unread> {
    let Some(stream) = response.body() else {
        return Ok(Vec::new());
    };
    let reader: ReadableStreamDefaultReader = stream.get_reader().dyn_into().map_err(JsValue::from)?;
    let mut bytes = Vec::new();
    loop {
        let chunk = JsFuture::from(reader.read()).await?;
        if Reflect::get(&chunk, &"done".into())?.is_truthy() {
            return Ok(bytes);
        }
        let piece: Uint8Array = Reflect::get(&chunk, &"value".into())?.dyn_into()?;
        let done = bytes.len() as u64 + u64::from(piece.length());
        if done > most_bytes {
            JsFuture::from(reader.cancel()).await.ok();
            return Err(Unread::TooLarge(
                too_large(&file_name_of(address), done, most_bytes).unwrap_or_default(),
            ));
        }
        bytes.extend(piece.to_vec());
        // The length is that of what travels, packed; once there is more than that, it says nothing.
        let total = total.filter(|&total| done <= total);
        inbox.push(Incoming::Progress {
            address: address.to_owned(),
            done,
            total,
        });
    }
}

/// A browser does not say why it refused. Asking again without wanting to read the answer tells apart a server that is not there from
/// one that does not let other pages read.
async fn why_refused(address: &str, wanted: &Wanted) -> String {
    let host = host_of(address);
    let Some(window) = window() else { return String::new() };
    if !window.navigator().on_line() {
        return format!(
            "There is no connection to the internet, so {} was not loaded.",
            file_name_of(address)
        );
    }
    if address.starts_with("http://") && window.is_secure_context() && window.location().protocol().is_ok_and(|p| p == "https:") {
        return format!("Browsers do not let a secure page load from {address}. Use an address that starts with https://.");
    }
    let controller = AbortController::new().ok();
    let signal = controller.as_ref().map(AbortController::signal);
    let there = request(address, RequestMode::NoCors, signal.as_ref()).await.is_ok();
    if let Some(controller) = controller {
        controller.abort();
    }
    if there {
        format!("{host} does not allow other pages to read its files (CORS). {}", wanted.otherwise)
    } else {
        format!("{host} cannot be reached. Check the address: {address}")
    }
}

fn host_of(address: &str) -> String {
    let host = web_sys::Url::new(address).map(|url| url.host()).unwrap_or_default();
    if host.is_empty() { address.to_owned() } else { host }
}
