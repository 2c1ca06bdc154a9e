//! The worker that reads files for the page. It contains the readers of segue-formats, and nothing
//! of the app. `web/js/reader.js` calls it.

#[cfg(target_arch = "wasm32")]
#[path = "file_worker/report.rs"]
mod report;

#[cfg(target_arch = "wasm32")]
mod worker {
    use super::report::{Receiver, answer};
    use segue_session::reading::read;
    use wasm_bindgen::JsValue;
    use wasm_bindgen::prelude::wasm_bindgen;

    /// Reads a file and hands its report to the receiver. `setup` has the options as JSON; `sha256`
    /// is that of the browser, where it has one.
    #[wasm_bindgen(js_name = readFile)]
    #[expect(unreachable_pub, reason = "called from JavaScript")]
    pub fn read_file(
        receiver: &Receiver,
        name: &str,
        bytes: Vec<u8>,
        setup: &str,
        sha256: Option<String>,
    ) -> Result<(), JsValue> {
        answer(receiver, setup, sha256, move |setup, progress| read(name, &bytes, setup, progress))
    }
}

/// Natively, files are read on threads of the app itself.
fn main() {}
