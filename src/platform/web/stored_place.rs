//! The places of files in the browser's storage.

use js_sys::{Object, Reflect};
use wasm_bindgen::JsValue;

/// The name of the database.
pub(super) const DATABASE: &str = "segue";
/// The name of its store of files, by their SHA-256.
pub(super) const FILES: &str = "files";

/// Returns where workers find a file in the storage: `{ database, store, key }`.
pub(super) fn stored_place(sha256: &str) -> Result<JsValue, JsValue> {
    let place = Object::new();
    for (name, value) in [("database", DATABASE), ("store", FILES), ("key", sha256)] {
        Reflect::set(&place, &JsValue::from(name), &JsValue::from(value))?;
    }
    Ok(place.into())
}
