//! The platform of a desktop window.

mod files;
mod film;
mod frame_pacer;
mod gamepad;
mod pool;
mod reader;
mod storage;

pub(crate) use files::{download, download_file, open_files, read_arguments, read_dropped};
pub(crate) use film::{Film, can_film, can_take_pictures, save_picture, take_picture};
pub(crate) use frame_pacer::FramePacer;
pub(crate) use gamepad::gamepad;
pub(crate) use pool::{Pool, set_answer_listener};
pub(crate) use reader::{LargeFile, Reader, outside_memory, packed_file, update_memory};
pub(crate) use storage::Storage;

use super::{Inbox, Incoming, address};
use eframe::egui;
use segue_session::Sample;
use segue_session::lesson::Source;
use segue_text::{Message, msg};
use std::sync::{Arc, LazyLock};
use std::time::Instant;

/// Returns the milliseconds since a fixed moment, by a monotonic clock.
pub(crate) fn now_ms() -> f64 {
    static START: LazyLock<Instant> = LazyLock::new(Instant::now);
    START.elapsed().as_secs_f64() * 1e3
}

/// Returns the query that the command line names, as in `segue "lab=blend&blend_window=24"`.
pub(crate) fn location_query() -> String {
    std::env::args()
        .skip(1)
        .find(|argument| files::is_query(argument))
        .map_or_else(String::new, |query| address::state_of(&query))
}

/// Whether [`between_frames`] runs work.
pub(crate) const WORKS_BETWEEN_FRAMES: bool = false;

/// Whether all files are read in the background. A window reads small files at once, and only
/// large ones on threads.
pub(crate) const READS_IN_BACKGROUND: bool = false;

/// Does nothing: the frames of a window are regular, so that work can wait for the next one.
pub(crate) fn between_frames(_work: impl FnMut() -> bool + 'static) {}

/// Returns `false`, because desktops do not tell a window.
pub(crate) fn prefers_reduced_motion() -> bool {
    false
}

/// Returns `false`, because a window has a mouse.
pub(crate) fn has_coarse_pointer() -> bool {
    false
}

/// Shows the window on the whole screen, or as a window again.
pub(crate) fn set_fullscreen(whole: bool, ctx: &egui::Context) {
    ctx.send_viewport_cmd(egui::ViewportCommand::Fullscreen(whole));
}

/// Returns whether the window is shown on the whole screen.
pub(crate) fn is_fullscreen(ctx: &egui::Context) -> bool {
    ctx.input(|input| input.viewport().fullscreen == Some(true))
}

/// Returns the tags of the user's languages, the preferred one first.
pub(crate) fn languages() -> Vec<String> {
    ["LC_ALL", "LC_MESSAGES", "LANG"]
        .into_iter()
        .filter_map(|key| std::env::var(key).ok())
        .collect()
}

/// Puts a text into the clipboard, and confirms it by [`Incoming::Copied`].
pub(crate) fn copy_text(text: String, ctx: &egui::Context, inbox: &Inbox) {
    ctx.copy_text(text);
    inbox.push(Incoming::Copied);
}

/// Opens a web page in the user's browser.
#[expect(clippy::disallowed_methods, reason = "the browser gets no handle to this window")]
pub(crate) fn open_page(address: &str, ctx: &egui::Context) {
    ctx.open_url(egui::OpenUrl::new_tab(address));
}

/// Returns `false`, because no page frames a window.
pub(crate) fn is_framed() -> bool {
    false
}

/// Does nothing, because a window has no address.
pub(crate) fn replace_query(_query: &str) {}

/// Returns the query that restores a state, for the end of a page's address or for the command
/// line.
pub(crate) fn full_link(query: &str) -> String {
    format!("?{query}")
}

/// Does nothing, because a window has no history.
pub(crate) fn watch_navigation(_inbox: &Inbox) {}

/// Whether corpora can be shown.
pub(crate) const SHOWS_CORPORA: bool = false;

/// Refuses to show a corpus, because pages alone do.
pub(crate) fn show_corpus(address: &str, inbox: &Inbox) {
    if !address.is_empty() {
        let reason = msg!("This window does not read corpora. Open the link in a browser.");
        inbox.push(Incoming::Failed { reason });
    }
}

/// Does nothing, because no button of a window asks for it.
pub(crate) fn choose_corpus(_inbox: &Inbox) {}

/// A request under way. A window makes none, so it has no fields.
#[derive(Debug)]
pub(crate) struct Fetch;

/// Refuses to fetch a file, because a window does not use the network.
pub(crate) fn fetch(address: &str, inbox: &Inbox) -> Fetch {
    let reason = if address::corpus_clip_of(address).is_some() {
        msg!("This window does not read corpora. Open the link in a browser.")
    } else {
        msg!(
            "This window does not load files over the network. Download {address} and drop the file here.",
            address = address.to_owned()
        )
    };
    let address = address.to_owned();
    inbox.push(Incoming::Fetched { address, name: None, result: Err(reason) });
    Fetch
}

/// Reads a bundled take. The answer is [`Incoming::Sample`].
pub(crate) fn load_sample(sample: &'static Sample, inbox: &Inbox) {
    let result = read_bundled("samples", sample.file);
    inbox.push(Incoming::Sample { sample, result });
}

/// Reads the files of a language. The answer is [`Incoming::Language`].
pub(crate) fn load_language(tag: &'static str, inbox: &Inbox) {
    let read = |ending| read_bundled("lang", &format!("{tag}.{ending}"));
    let files = read("json").and_then(|texts| Ok([texts, read("otf")?]));
    inbox.push(Incoming::Language { tag, files });
}

/// Does nothing, because no page frames a window.
pub(crate) fn set_page_language(_tag: &str) {}

/// Reads the text of a lesson. The answer is [`Incoming::Lesson`].
pub(crate) fn load_lesson(source: &Source, inbox: &Inbox) -> Fetch {
    let result = match source {
        Source::BuiltIn(file) => read_bundled("lessons", file).map_err(|reason| {
            msg!("{file} could not be loaded: {reason}.", file = file.clone(), reason)
        }),
        Source::Web(address) => Err(msg!(
            "This window does not load lessons over the network: {address} opens in a browser.",
            address = address.clone()
        )),
    };
    let source = source.clone();
    inbox.push(Incoming::Lesson { source, result });
    Fetch
}

/// Reads a bundled file from a folder beside the program, or from the project's own folder.
fn read_bundled(folder: &str, file: &str) -> Result<Arc<[u8]>, Message> {
    let beside =
        std::env::current_exe().ok().and_then(|program| Some(program.parent()?.join(folder)));
    let in_project = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("assets").join(folder);
    let paths: Vec<_> =
        beside.into_iter().chain([in_project]).map(|folder| folder.join(file)).collect();
    let read = paths.iter().find(|path| path.is_file()).map(std::fs::read);
    match read {
        Some(read) => read.map(Arc::from).map_err(|error| Message::data(error.to_string())),
        None => Err(msg!(
            "{file} is not in the folder `{folder}` beside the program",
            file = file.to_owned(),
            folder = folder.to_owned()
        )),
    }
}
