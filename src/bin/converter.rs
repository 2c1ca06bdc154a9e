//! The worker that converts files for the page: the readers and writers of segue-formats, and
//! nothing of the app. `web/js/reader.js` fetches it for the first file that is converted.

#[cfg(target_arch = "wasm32")]
#[path = "file_worker/report.rs"]
mod report;

#[cfg(target_arch = "wasm32")]
mod worker {
    use super::report;
    use js_sys::Function;
    use segue_session::convert::ConvertOptions;
    use segue_session::reading::read_and_convert;
    use wasm_bindgen::JsValue;
    use wasm_bindgen::prelude::wasm_bindgen;

    /// Converts a file by `options` and hands over the report on it as the reader does
    /// (`readFile`).
    #[wasm_bindgen(js_name = convertFile)]
    #[expect(unreachable_pub, reason = "called from JavaScript")]
    #[expect(clippy::too_many_arguments, reason = "those of readFile, and the options")]
    pub fn convert_file(
        name: &str,
        bytes: Vec<u8>,
        setup: &str,
        options: &str,
        sha256: Option<String>,
        progress: &Function,
        head: &Function,
        piece: &Function,
    ) -> Result<(), JsValue> {
        let setup = report::setup(setup, sha256)?;
        let options: ConvertOptions =
            serde_json::from_str(options).map_err(|error| error.to_string())?;
        let mut goes_on = |done| report::goes_on(progress, done);
        let report = read_and_convert(name, &bytes, &setup, &options, &mut goes_on);
        drop(bytes);
        report::hand_over(report, head, piece)
    }
}

/// Natively, files are converted on threads of the app itself.
fn main() {}
