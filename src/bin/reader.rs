//! The worker that reads files for the page. It contains the readers of segue-formats, and nothing
//! of the app. `web/js/reader.js` calls it.

#[cfg(target_arch = "wasm32")]
mod worker {
    use js_sys::{Function, Uint8Array};
    use segue_session::reading::{Parcel, ReadSetup, read};
    use wasm_bindgen::JsValue;
    use wasm_bindgen::prelude::wasm_bindgen;

    /// Reads a file and hands over its report, first the head, then the pieces. `sha256` is that of
    /// the browser, where it has one. `progress` gets the number of bytes read; an exception in it
    /// stops the reading.
    #[wasm_bindgen(js_name = readFile)]
    #[expect(unreachable_pub, reason = "called from JavaScript")]
    pub fn read_file(
        name: &str,
        bytes: Vec<u8>,
        setup: &str,
        sha256: Option<String>,
        progress: &Function,
        head: &Function,
        piece: &Function,
    ) -> Result<(), JsValue> {
        let mut setup: ReadSetup =
            serde_json::from_str(setup).map_err(|error| error.to_string())?;
        setup.sha256 = setup.sha256.or(sha256);
        let report = read(name, &bytes, &setup, &mut |done| {
            progress.call1(&JsValue::NULL, &JsValue::from(done as f64)).is_ok()
        });
        drop(bytes);
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
}

/// Natively, files are read on threads of the app itself.
fn main() {}
