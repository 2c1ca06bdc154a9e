//! The desktop window.

mod files;
mod film;
mod gamepad;
mod pace;
mod reader;
mod storage;

pub(crate) use files::{download, open_files, read_arguments, read_dropped};
pub(crate) use film::{Film, can_film, can_take_pictures, save_picture, take_picture};
pub(crate) use gamepad::gamepad;
pub(crate) use pace::Pace;
pub(crate) use reader::{LargeFile, Reader, follow_memory};
pub(crate) use storage::Storage;

use super::{Inbox, Incoming, address};
use eframe::egui;
use segue_session::Sample;
use segue_session::lesson::Source;
use segue_text::{Message, msg};
use std::sync::{Arc, LazyLock};
use std::time::Instant;

pub(crate) use super::address::file_name_of;

/// Milliseconds since some fixed moment; never goes back.
pub(crate) fn now_ms() -> f64 {
    static START: LazyLock<Instant> = LazyLock::new(Instant::now);
    START.elapsed().as_secs_f64() * 1e3
}

/// The state that the command line describes: `segue "lab=blend&blend_window=24"`.
pub(crate) fn location_query() -> String {
    std::env::args()
        .skip(1)
        .find(|argument| files::is_query(argument))
        .map_or_else(String::new, |query| address::state_of(&query))
}

/// Whether [`between_frames`] does anything.
pub(crate) const WORKS_BETWEEN_FRAMES: bool = false;

/// Small files are read at once, large ones on threads.
pub(crate) const READS_ELSEWHERE: bool = false;

/// A window's frames come at a steady pace: what they leave over waits for the next.
pub(crate) fn between_frames(_work: impl FnMut() -> bool + 'static) {}

/// Desktops tell a window nothing of the kind.
pub(crate) fn prefers_stillness() -> bool {
    false
}

/// The user's languages, best first, as their tags.
pub(crate) fn languages() -> Vec<String> {
    ["LC_ALL", "LC_MESSAGES", "LANG"]
        .into_iter()
        .filter_map(|key| std::env::var(key).ok())
        .collect()
}

/// Puts a text into the clipboard. [`Incoming::Copied`] tells that it is there.
pub(crate) fn copy_text(text: String, ctx: &egui::Context, inbox: &Inbox) {
    ctx.copy_text(text);
    inbox.push(Incoming::Copied);
}

/// Opens a page of the web in the user's browser.
#[expect(clippy::disallowed_methods, reason = "a browser of its own knows nothing of this window")]
pub(crate) fn open_page(address: &str, ctx: &egui::Context) {
    ctx.open_url(egui::OpenUrl::new_tab(address));
}

/// A window stands in no page.
pub(crate) fn is_framed() -> bool {
    false
}

/// A window has no address.
pub(crate) fn replace_query(_query: &str) {}

/// The query that restores a state, for the end of a page's address or for the command line.
pub(crate) fn full_link(query: &str) -> String {
    format!("?{query}")
}

/// Nobody goes back or forward in a window.
pub(crate) fn watch_navigation(_inbox: &Inbox) {}

/// Something that is under way.
#[derive(Debug)]
pub(crate) struct Fetch;

/// A window loads nothing over the network, and says so.
pub(crate) fn fetch(address: &str, inbox: &Inbox) -> Fetch {
    let reason = msg!(
        "This window does not load files over the network. Download {address} and drop the file here.",
        address = address.to_owned()
    );
    inbox.push(Incoming::Fetched { address: address.to_owned(), result: Err(reason) });
    Fetch
}

/// Reads a bundled take; [`Incoming::Sample`] brings it.
pub(crate) fn load_sample(sample: &'static Sample, inbox: &Inbox) {
    let result = read_bundled("samples", sample.file);
    inbox.push(Incoming::Sample { sample, result });
}

/// Reads the files of a language; [`Incoming::Language`] brings them.
pub(crate) fn load_language(tag: &'static str, inbox: &Inbox) {
    let read = |ending| read_bundled("lang", &format!("{tag}.{ending}"));
    let files = read("json").and_then(|texts| Ok([texts, read("otf")?]));
    inbox.push(Incoming::Language { tag, files });
}

/// A window has no page around it that would have a language.
pub(crate) fn tell_language(_tag: &str) {}

/// Reads the text of a lesson; [`Incoming::Lesson`] brings it.
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

/// What lies in a folder beside the program, or in the project's own.
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
