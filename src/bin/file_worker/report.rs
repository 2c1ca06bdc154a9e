//! Messages of the programs that read and that convert files: the options of a task, its progress,
//! and its report.

use js_sys::{Function, Uint8Array};
use segue_session::reading::{Parcel, ReadReport, ReadSetup};
use wasm_bindgen::JsValue;

/// Returns the options of reading a file, from their JSON. `sha256` is that of the browser, where
/// it has one.
pub(crate) fn setup(json: &str, sha256: Option<String>) -> Result<ReadSetup, JsValue> {
    let setup: ReadSetup = serde_json::from_str(json).map_err(|error| error.to_string())?;
    Ok(ReadSetup { sha256: setup.sha256.or(sha256), ..setup })
}

/// Calls `progress` with the number of bytes read, and returns whether to continue: an exception
/// stops the reading.
pub(crate) fn goes_on(progress: &Function, done: usize) -> bool {
    progress.call1(&JsValue::NULL, &JsValue::from(done as f64)).is_ok()
}

/// Hands over a report, first the head, then the pieces; `None` is one that was stopped.
pub(crate) fn hand_over(
    report: Option<ReadReport>,
    head: &Function,
    piece: &Function,
) -> Result<(), JsValue> {
    let Some(report) = report else {
        return Err("stopped".into());
    };
    let parcel = Parcel::new(report).map_err(|error| error.to_string())?;
    head.call1(&JsValue::NULL, &JsValue::from(parcel.head()))?;
    let mut failed = Ok(());
    parcel.pieces(|bytes| {
        if failed.is_ok() {
            failed = piece.call1(&JsValue::NULL, &Uint8Array::from(bytes)).map(|_| ());
        }
    });
    failed
}
