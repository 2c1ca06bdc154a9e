//! The program that converts files for the page: the readers and writers of segue-formats, and
//! nothing of the app. `web/js/reader.js` fetches it for the first file that is converted.

#[cfg(target_arch = "wasm32")]
#[path = "file_worker/report.rs"]
mod report;

#[cfg(target_arch = "wasm32")]
mod worker {
    use super::report::{Receiver, answer};
    use segue_session::convert::ConvertOptions;
    use segue_session::reading::read_and_convert;
    use wasm_bindgen::JsValue;
    use wasm_bindgen::prelude::wasm_bindgen;

    /// Converts a file by `options`, JSON, and hands the report on it to the receiver as `readFile`
    /// does.
    #[wasm_bindgen(js_name = convertFile)]
    #[expect(unreachable_pub, reason = "called from JavaScript")]
    pub fn convert_file(
        receiver: &Receiver,
        name: &str,
        bytes: Vec<u8>,
        setup: &str,
        options: &str,
        sha256: Option<String>,
    ) -> Result<(), JsValue> {
        let options: ConvertOptions =
            serde_json::from_str(options).map_err(|error| error.to_string())?;
        answer(receiver, setup, sha256, move |setup, progress| {
            read_and_convert(name, &bytes, setup, &options, progress)
        })
    }
}

/// Natively, files are converted on threads of the app itself.
fn main() {}
