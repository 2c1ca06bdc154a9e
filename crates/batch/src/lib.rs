//! Motion files on disk, and sessions without a screen: what the command line and the Python
//! package have in common.
//!
//! # The idea
//!
//! `segue-session` is pure: it asks for files, and is handed their content. Programs outside the
//! page answer it from disk, on all cores, and wait for results instead of drawing frames.
//!
//! ```text
//! words → Inputs (files, folders, patterns) → Reader (on all cores) → clips
//! link or lab, clips, values → Driven (a session, all requests answered, all work done) → results
//! ```
//!
//! # What it does not do
//!
//! It fetches nothing from the network, prints nothing, and writes no files. The session's results
//! are those of the page, bit for bit: nothing here computes motion.

mod clips;
mod drive;
mod error;
mod inputs;
mod read;
mod samples;
mod units;
mod values;

pub use clips::Clips;
pub use drive::{
    Clip, ClipFile, Driven, Ingredients, known_clip, lab_of_link, page_link, query_of,
};
pub use error::{BatchError, FileError, import_text};
pub use inputs::{Input, Inputs, has_ending, shown};
pub use read::{Read, Reader, bytes_of, for_each};
pub use units::{parse_rate, parse_root, parse_unit, parse_up, unit_name, up_name};
pub use values::value_of;

/// The address of the page in links, where nobody names another: that of `segue open` and
/// `cargo xtask serve`.
pub const PAGE: &str = "http://127.0.0.1:8080/";
