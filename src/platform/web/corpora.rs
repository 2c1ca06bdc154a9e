//! Corpora of many clips, which modules of the page show and read: `web/js/corpus/`. The app's own
//! WebAssembly has no code for them, because most visits need none.

use super::js_error_text;
use crate::platform::{Inbox, Incoming};
use js_sys::{Array, Function, Promise, Uint8Array};
use segue_text::msg;
use std::cell::RefCell;
use wasm_bindgen::{JsCast as _, JsValue};
use wasm_bindgen_futures::{JsFuture, spawn_local};
use web_sys::{AbortSignal, FileSystemEntry};

thread_local! {
    /// A function of the page's modules that calls one of those for corpora, by its name.
    static CORPORA: RefCell<Option<Function>> = const { RefCell::new(None) };
}

/// Whether corpora can be shown.
pub(crate) const SHOWS_CORPORA: bool = true;

/// Sets the function that calls the page's modules for corpora: `call(name, …)`.
pub(crate) fn set_corpora(call: Function) {
    CORPORA.with(|slot| slot.replace(Some(call)));
}

/// Calls a function of the modules. They are loaded with the first call.
fn call(name: &str, args: &Array) -> Result<Promise, JsValue> {
    let corpora = CORPORA.with_borrow(Clone::clone).ok_or("corpora")?;
    args.unshift(&JsValue::from_str(name));
    corpora.apply(&JsValue::NULL, args)?.dyn_into()
}

/// Calls a function without an answer. It tells the user of its failures itself, unless it cannot
/// be loaded.
fn tell(name: &'static str, args: Array, inbox: &Inbox) {
    let inbox = inbox.clone();
    spawn_local(async move {
        let done = async { JsFuture::from(call(name, &args)?).await };
        if let Err(error) = done.await {
            let error = js_error_text(&error);
            inbox.push(Incoming::Failed {
                reason: msg!("The corpus could not be shown: {error}.", error),
            });
        }
    });
}

/// Shows the corpus at an address beside the stage; none if the address is empty.
pub(crate) fn show_corpus(address: &str, inbox: &Inbox) {
    tell("show", Array::of1(&JsValue::from_str(address)), inbox);
}

/// Lets the user choose a corpus: an address, or a folder.
pub(crate) fn choose_corpus(inbox: &Inbox) {
    tell("choose", Array::new(), inbox);
}

/// Shows the corpus in a folder that was dropped on the page.
pub(super) fn show_corpus_folder(folder: &FileSystemEntry, inbox: &Inbox) {
    tell("showFolder", Array::of1(folder), inbox);
}

/// Reads the clip at an address in a corpus. Returns the name of its file, and its bytes as NPZ.
///
/// # Errors
/// A sentence in the language of the page.
pub(super) async fn read_corpus_clip(
    address: &str,
    signal: Option<&AbortSignal>,
) -> Result<(String, Uint8Array), JsValue> {
    let signal = signal.map_or(JsValue::UNDEFINED, JsValue::from);
    let answer = call("read", &Array::of2(&JsValue::from_str(address), &signal))?;
    let answer: Array = JsFuture::from(answer).await?.dyn_into()?;
    let name = answer.get(0).as_string().unwrap_or_default();
    Ok((name, answer.get(1).dyn_into()?))
}
