//! Opening and saving of the user's files, and the clipboard.

use super::js_error_text;
use super::page::{document, listen, window};
use super::reader::LargeFile;
use crate::platform::bundle::Bundle;
use crate::platform::motion_files::{MAX_FILE_BYTES, too_large};
use crate::platform::{Inbox, Incoming};
use eframe::egui::{self, DroppedFileHandle};
use js_sys::{Array, Reflect, Uint8Array};
use segue_formats::{Crc, ZipIndex};
use segue_session::reading::LARGE_BYTES;
use segue_text::{Message, msg};
use std::sync::Arc;
use wasm_bindgen::{JsCast as _, JsValue};
use wasm_bindgen_futures::{JsFuture, spawn_local};
use web_sys::{Blob, BlobPropertyBag, Clipboard, HtmlAnchorElement, HtmlInputElement, Url};

/// The longest text that is shown in a notice, bytes.
const MAX_NOTICE_BYTES: usize = 2_000;
/// The number of bytes of a file whose checksum is computed at once.
const CHECKED_AT_ONCE_BYTES: f64 = 1_048_576.0;
/// The name of the file in which a longer text is saved.
const TEXT_FILE: &str = "segue.md";

/// Opens a dialogue for files, and reads the chosen ones.
///
/// Browsers ignore it outside a user's gesture. There is no filter by ending, because phones then
/// disable every file of a type that they do not know.
pub(crate) fn open_files(inbox: &Inbox) {
    let asked = (|| -> Result<(), JsValue> {
        let document = document().ok_or("no document")?;
        let input: HtmlInputElement = document.create_element("input")?.dyn_into()?;
        input.set_type("file");
        input.set_multiple(true);
        input.set_hidden(true);
        // Safari drops an input that is not in the document.
        document.body().ok_or("no body")?.append_child(&input)?;
        let (chosen, inbox) = (input.clone(), inbox.clone());
        listen(Some(&input), "change", move |_| {
            let files = chosen.files().map(|list| {
                (0..list.length())
                    .filter_map(|index| list.get(index))
                    .map(|file| (file.name(), file.into()))
                    .collect()
            });
            chosen.remove();
            spawn_local(read(files.unwrap_or_default(), inbox.clone()));
        });
        let cancelled = input.clone();
        listen(Some(&input), "cancel", move |_| cancelled.remove());
        input.click();
        Ok(())
    })();
    if let Err(error) = asked {
        log::error!("no file dialog: {}", js_error_text(&error));
    }
}

/// Reads files, each with its name, one after the other, so that their answers are in order.
pub(super) async fn read(mut files: Vec<(String, Blob)>, inbox: Inbox) {
    if let Some(bundle) = Bundle::of(&files, |file| file.size() as u64) {
        match archive_of(&bundle, &files).await {
            Ok(archive) => files = bundle.replace(files, archive),
            // The model without its images.
            Err(error) => log::warn!("{}: {}", bundle.name, js_error_text(&error)),
        }
    }
    inbox.push(Incoming::Opening(files.len()));
    for (name, file) in files {
        let size = file.size() as u64;
        if let Some(reason) = too_large(&name, size, MAX_FILE_BYTES) {
            inbox.push(Incoming::Failed { reason });
        } else if is_read_here(&name, size) {
            match bytes_of(&file).await {
                Ok(bytes) => inbox.push(Incoming::File { name, bytes: Arc::from(bytes) }),
                Err(error) => refuse(&name, &js_error_text(&error), &inbox),
            }
        } else {
            inbox.push(Incoming::Large { name, file: LargeFile::new(file) });
        }
    }
}

/// Returns the archive of a bundle of these files. The browser joins them: the app reads them for
/// their checksums alone, in parts that take a few milliseconds.
async fn archive_of(bundle: &Bundle, files: &[(String, Blob)]) -> Result<Blob, JsValue> {
    let (mut zip, pieces) = (ZipIndex::default(), Array::new());
    for (index, path) in &bundle.members {
        let Some((_, file)) = files.get(*index) else { continue };
        let (mut checksum, mut at) = (Crc::new(), 0.0);
        while at < file.size() {
            let end = at + CHECKED_AT_ONCE_BYTES;
            checksum.update(&bytes_of(&file.slice_with_f64_and_f64(at, end)?).await?);
            at = end;
        }
        if let Some(header) = zip.store(path, &checksum).map_err(|full| full.to_string())? {
            pieces.push(&Uint8Array::from(&header[..]));
            pieces.push(file);
        }
    }
    pieces.push(&Uint8Array::from(&zip.finish()[..]));
    Blob::new_with_blob_sequence(&pieces)
}

async fn bytes_of(file: &Blob) -> Result<Vec<u8>, JsValue> {
    let buffer = file.array_buffer().await?;
    Ok(Uint8Array::new(&buffer).to_vec())
}

/// Returns whether the app itself needs the bytes of a file: those of a bone map, and of a skeleton
/// that others depend on. The browser holds all others, which workers read.
fn is_read_here(name: &str, size: u64) -> bool {
    let ending = name.rsplit_once('.').map_or("", |(_, ending)| ending);
    let is_needed = ["json", "asf"].iter().any(|own| ending.eq_ignore_ascii_case(own));
    is_needed && size <= LARGE_BYTES
}

/// Reports a file that the browser cannot read. The log gets the reason in the browser's words.
fn refuse(name: &str, reason: &str, inbox: &Inbox) {
    log::warn!("{name}: {reason}");
    inbox.push(Incoming::Failed {
        reason: msg!(
            "{name} cannot be read. If it is a folder, drop the files in it.",
            name = name.to_owned()
        ),
    });
}

/// Reads the files dropped on the page, in order.
pub(crate) fn read_dropped(files: &[DroppedFileHandle], inbox: &Inbox) {
    let named = |file: &DroppedFileHandle| {
        let file = file.web_file()?;
        Some((file.name(), file.clone().into()))
    };
    spawn_local(read(files.iter().filter_map(named).collect(), inbox.clone()));
}

/// Saves a file for the user.
pub(crate) fn download(file_name: &str, mime: &str, bytes: &[u8], inbox: &Inbox) {
    save_array(file_name, mime, &Uint8Array::from(bytes), inbox);
}

/// Saves a file that was written in the background.
pub(crate) fn download_file(file_name: &str, mime: &str, file: &LargeFile, inbox: &Inbox) {
    if let Some(bytes) = file.array() {
        save_array(file_name, mime, &bytes, inbox);
    }
}

fn save_array(file_name: &str, mime: &str, bytes: &Uint8Array, inbox: &Inbox) {
    let options = BlobPropertyBag::new();
    options.set_type(mime);
    let blob = Blob::new_with_u8_array_sequence_and_options(&Array::of1(bytes), &options);
    if let Err(error) = blob.and_then(|blob| save_blob(file_name, &blob)) {
        inbox.push(Incoming::Failed {
            reason: msg!(
                "{file} could not be saved: {error}.",
                file = file_name.to_owned(),
                error = js_error_text(&error)
            ),
        });
    }
}

/// Makes the browser save a blob under that name.
pub(super) fn save_blob(file_name: &str, blob: &Blob) -> Result<(), JsValue> {
    let document = document().ok_or("no document")?;
    let url = Url::create_object_url_with_blob(blob)?;
    let anchor: HtmlAnchorElement = document.create_element("a")?.dyn_into()?;
    anchor.set_href(&url);
    anchor.set_download(file_name);
    anchor.set_hidden(true);
    document.body().ok_or("no body")?.append_child(&anchor)?;
    anchor.click();
    anchor.remove();
    // The browser reads the blob after the click; a minute is more than it needs.
    spawn_local(async move {
        super::page::sleep(60_000).await;
        Url::revoke_object_url(&url).ok();
    });
    Ok(())
}

/// Puts a text into the clipboard, and confirms it by [`Incoming::Copied`]. Where the browser
/// refuses, a notice shows the text.
pub(crate) fn copy_text(text: String, _ctx: &egui::Context, inbox: &Inbox) {
    // Undefined on an insecure address, although its type is not optional.
    let clipboard = window()
        .map(|window| window.navigator())
        .and_then(|navigator| Reflect::get(&navigator, &"clipboard".into()).ok());
    let clipboard = clipboard.and_then(|clipboard| clipboard.dyn_into::<Clipboard>().ok());
    // Called here and not in the task, because Safari allows it only within the user's gesture.
    let written = clipboard.map(|clipboard| JsFuture::from(clipboard.write_text(&text)));
    let inbox = inbox.clone();
    spawn_local(async move {
        let done = match written {
            Some(written) => written.await.is_ok(),
            None => false,
        };
        inbox.push(if done {
            Incoming::Copied
        } else {
            Incoming::Failed { reason: copy_by_hand(&text, &inbox) }
        });
    });
}

/// Returns the notice for a browser that closes the clipboard to pages. A short text is in the
/// notice; a long one is saved as a file.
fn copy_by_hand(text: &str, inbox: &Inbox) -> Message {
    if text.len() < MAX_NOTICE_BYTES {
        let text = text.to_owned();
        return msg!(
            "This browser does not let the page use the clipboard. Copy it by hand: {text}",
            text
        );
    }
    download(TEXT_FILE, "text/markdown", text.as_bytes(), inbox);
    msg!(
        "This browser does not let the page use the clipboard. It is saved as {file} instead.",
        file = TEXT_FILE.to_owned()
    )
}
