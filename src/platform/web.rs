//! The platform of a page in a browser.

mod corpora;
mod fetch;
mod files;
mod film;
mod folders;
mod frame_pacer;
mod gamepad;
mod page;
mod pool;
mod reader;
mod snapshot;
mod storage;
mod stored_place;

pub(crate) use corpora::{SHOWS_CORPORA, choose_corpus, set_corpora, show_corpus};
pub(crate) use fetch::{Fetch, fetch, load_language, load_lesson, load_sample};
pub(crate) use files::{copy_text, download, download_file, open_files, read_dropped};
pub(crate) use film::{Film, can_film, can_take_pictures, save_picture, take_picture};
pub(crate) use folders::watch_folders;
pub(crate) use frame_pacer::FramePacer;
pub(crate) use gamepad::gamepad;
#[cfg(feature = "webgl2")]
pub(crate) use page::listen;
pub(crate) use page::{
    READS_IN_BACKGROUND, WORKS_BETWEEN_FRAMES, between_frames, confirm_leaving_while, full_link,
    has_coarse_pointer, is_framed, is_fullscreen, languages, location_query, next_frame, next_turn,
    now_ms, open_page, prefers_reduced_motion, replace_query, requested_backend, set_fullscreen,
    set_page_language, sleep, watch_hiding, watch_navigation,
};
pub(crate) use pool::{Pool, set_answer_listener, set_computer_factory};
pub(crate) use reader::{
    LargeFile, Reader, outside_memory, packed_file, set_worker_factory, update_memory,
    wasm_memory_bytes,
};
pub(crate) use snapshot::{Area, area_of, inline_picture, snapshot};
pub(crate) use storage::Storage;

use wasm_bindgen::{JsCast as _, JsValue};

/// Returns the message of a JavaScript error.
pub(crate) fn js_error_text(error: &JsValue) -> String {
    match error.dyn_ref::<js_sys::Error>() {
        Some(error) => String::from(error.message()),
        None => error.as_string().unwrap_or_else(|| format!("{error:?}")),
    }
}
