//! The worker that reads files for the page. It contains the readers of segue-formats, and nothing
//! of the app. `web/js/reader.js` calls it.

#[cfg(target_arch = "wasm32")]
#[path = "file_worker/report.rs"]
mod report;

#[cfg(target_arch = "wasm32")]
mod worker {
    use super::report;
    use js_sys::Function;
    use segue_session::reading::read;
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
        let setup = report::setup(setup, sha256)?;
        let report = read(name, &bytes, &setup, &mut |done| report::goes_on(progress, done));
        drop(bytes);
        report::hand_over(report, head, piece)
    }
}

/// Natively, files are read on threads of the app itself.
fn main() {}
