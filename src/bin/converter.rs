//! The program that converts files and clips for the page, and writes the files of long motions:
//! the readers and writers of segue-formats, and nothing of the app. `web/js/reader.js` fetches it
//! for the first file that is converted or written.

#[cfg(target_arch = "wasm32")]
#[path = "file_worker/report.rs"]
mod report;

#[cfg(target_arch = "wasm32")]
mod worker {
    use super::report::{Receiver, answer};
    use js_sys::Uint8Array;
    use segue_session::convert::ConvertOptions;
    use segue_session::packed::{self, PackedError};
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

    /// Writes the file of a packed motion, and returns its bytes; or a string where it is refused:
    /// the reason as the JSON of a message.
    #[wasm_bindgen(js_name = writePacked)]
    #[expect(unreachable_pub, reason = "called from JavaScript")]
    pub fn write_packed(packed: &[u8]) -> Result<JsValue, JsValue> {
        match packed::write(packed) {
            Ok(file) => Ok(Uint8Array::from(&file[..]).into()),
            Err(PackedError::Damaged) => Err(PackedError::Damaged.to_string().into()),
            Err(PackedError::Refused(reason)) => serde_json::to_string(&reason)
                .map(JsValue::from)
                .map_err(|error| error.to_string().into()),
        }
    }
}

/// Natively, files are converted on threads of the app itself.
fn main() {}
