//! Messages of the programs that read and that convert files: the options of a task, and the
//! receiver of its progress and its report.

use js_sys::Uint8Array;
use segue_session::reading::{Parcel, ReadReport, ReadSetup};
use wasm_bindgen::JsValue;
use wasm_bindgen::prelude::wasm_bindgen;

#[wasm_bindgen]
extern "C" {
    /// An object of `web/js/reader.js` that gets what comes of a task.
    pub(crate) type Receiver;

    /// Gets the number of bytes read. An exception stops the reading.
    #[wasm_bindgen(method, catch)]
    fn progress(this: &Receiver, done: f64) -> Result<(), JsValue>;

    /// Gets everything of the report but its arrays, as JSON.
    #[wasm_bindgen(method, catch)]
    fn head(this: &Receiver, json: &str) -> Result<(), JsValue>;

    /// Gets the next piece of the arrays.
    #[wasm_bindgen(method, catch)]
    fn piece(this: &Receiver, bytes: &Uint8Array) -> Result<(), JsValue>;
}

/// Reads a file by a function, and hands its report over, first the head, then the pieces. `setup`
/// has the options of reading it as JSON; `sha256` is that of the browser, where it has one. The
/// function owns the file's bytes, so that there is room for the report.
pub(crate) fn answer(
    receiver: &Receiver,
    setup: &str,
    sha256: Option<String>,
    read: impl FnOnce(&ReadSetup, &mut dyn FnMut(usize) -> bool) -> Option<ReadReport>,
) -> Result<(), JsValue> {
    let mut setup: ReadSetup = serde_json::from_str(setup).map_err(|error| error.to_string())?;
    setup.sha256 = setup.sha256.or(sha256);
    let report = read(&setup, &mut |done| receiver.progress(done as f64).is_ok());
    let Some(report) = report else {
        return Err("stopped".into());
    };
    let parcel = Parcel::new(report).map_err(|error| error.to_string())?;
    receiver.head(parcel.head())?;
    let mut sent = Ok(());
    parcel.pieces(|bytes| {
        if sent.is_ok() {
            sent = receiver.piece(&Uint8Array::from(bytes));
        }
    });
    sent
}
