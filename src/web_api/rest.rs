//! The rest of the program, which comes behind the first frames.
//!
//! As deployed, the module of the app is divided in two (`tools/bindgen/src/split.rs`). The page
//! draws its first frames with the first part, and holds input back until the rest is there. A
//! function of the rest that is called before that has it fetched in the middle of the call.

use super::SegueHandle;
use wasm_bindgen::JsValue;
use wasm_bindgen::prelude::wasm_bindgen;

#[wasm_bindgen]
extern "C" {
    /// Fetches the rest while the page stands still; see `web/js/rest.js`. Throws where that fails.
    #[wasm_bindgen(js_name = segueFetchRest)]
    fn fetch_from_page();
}

#[wasm_bindgen]
impl SegueHandle {
    /// Fetches the rest at once. The functions of the first part that stand for those of the rest
    /// call it.
    #[wasm_bindgen(js_name = fetchRest)]
    pub fn fetch_rest() {
        fetch_from_page();
    }

    /// Tells that the whole program is there, and has the next frames answer the input until now.
    #[wasm_bindgen(js_name = setComplete)]
    pub fn set_complete(&self) -> Result<(), JsValue> {
        self.borrow_mut()?.release_input();
        Ok(())
    }
}
