//! The page.

mod fetch;
mod files;
mod film;
mod folders;
mod gamepad;
mod handle;
mod pace;
mod page;
mod reader;
mod snapshot;
mod storage;

pub(crate) use super::address::file_name_of;
pub(crate) use fetch::{Fetch, fetch, load_language, load_lesson, load_sample};
pub(crate) use files::{copy_text, download, open_files, read_dropped};
pub(crate) use film::{Film, can_film, can_take_pictures, save_picture, take_picture};
pub(crate) use gamepad::gamepad;
pub(crate) use pace::Pace;
pub(crate) use page::{
    READS_ELSEWHERE, WORKS_BETWEEN_FRAMES, announce, between_frames, full_link, is_framed,
    languages, location_query, now_ms, open_page, prefers_stillness, replace_query, tell_language,
    watch_navigation,
};
pub(crate) use reader::{LargeFile, Reader, follow_memory};
pub(crate) use storage::Storage;

use wasm_bindgen::{JsCast as _, JsValue};

/// What a JavaScript error says.
fn words_of(error: &JsValue) -> String {
    match error.dyn_ref::<js_sys::Error>() {
        Some(error) => String::from(error.message()),
        None => error.as_string().unwrap_or_else(|| format!("{error:?}")),
    }
}
