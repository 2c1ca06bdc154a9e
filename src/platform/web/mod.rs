//! The page.

mod fetch;
mod files;
mod film;
mod folders;
mod gamepad;
mod pace;
mod page;
mod reader;
mod snapshot;
mod storage;

pub(crate) use super::address::file_name_of;
pub(crate) use fetch::{Fetch, fetch, load_language, load_lesson, load_sample};
pub(crate) use files::{copy_text, download, open_files, read_dropped};
pub(crate) use film::{Film, can_film, can_take_pictures, save_picture, take_picture};
pub(crate) use folders::watch_folders;
pub(crate) use gamepad::gamepad;
pub(crate) use pace::Pace;
pub(crate) use page::{
    READS_ELSEWHERE, WORKS_BETWEEN_FRAMES, ask_before_leaving_while, between_frames, full_link,
    is_framed, languages, listen, location_query, next_frame, now_ms, open_page, prefers_stillness,
    replace_query, sleep, tell_language, turn, wanted_backend, watch_hiding, watch_navigation,
};
pub(crate) use reader::{LargeFile, Reader, follow_memory, page_bytes, workers_are_made_by};
pub(crate) use snapshot::{Area, area_of, inline_picture, snapshot};
pub(crate) use storage::Storage;

use wasm_bindgen::{JsCast as _, JsValue};

/// Returns the message of a JavaScript error.
pub(crate) fn words_of(error: &JsValue) -> String {
    match error.dyn_ref::<js_sys::Error>() {
        Some(error) => String::from(error.message()),
        None => error.as_string().unwrap_or_else(|| format!("{error:?}")),
    }
}
