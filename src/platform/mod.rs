//! Everything that a page and a desktop window do differently: files, addresses, storage, time. The same names on both sides.
//!
//! What takes time answers through an [`Inbox`]; the app takes the answers when it is drawn next.

mod address;
#[cfg_attr(not(target_arch = "wasm32"), expect(dead_code, reason = "some things happen to a page only"))]
mod inbox;
mod vault;

#[cfg(not(target_arch = "wasm32"))]
mod native;
#[cfg(target_arch = "wasm32")]
mod web;

#[cfg(not(target_arch = "wasm32"))]
pub(crate) use native::*;
#[cfg(target_arch = "wasm32")]
pub(crate) use web::*;

pub(crate) use inbox::{Inbox, Incoming};
pub(crate) use vault::Vault;

use segue::session::Saved;
use segue::session::reading::ReadReport;
use std::collections::BTreeMap;
use std::sync::Arc;

/// The largest file that is read. A motion file of that size holds days; more would only fill the memory.
pub(crate) const MAX_FILE_BYTES: u64 = 512 * 1024 * 1024;

/// The bytes of a file.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum FileBytes {
    /// Here.
    Here(Arc<[u8]>),
    /// A large file: where the platform has it.
    Large(LargeFile),
}

/// The files of stored work, by the SHA-256 of their bytes in hexadecimal.
pub(crate) type StoredFiles = BTreeMap<String, FileBytes>;

/// What a thread or worker that reads a file tells.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum ReadNews {
    /// So many bytes are read.
    Progress(u64),
    /// It is done, or cannot be done.
    Done(Result<ReadReport, String>),
}

/// Work that was stored on an earlier visit.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Stored {
    /// The library and the parameters.
    pub(crate) saved: Saved,
    /// The bytes of the library's files.
    pub(crate) files: StoredFiles,
}

/// Work to be stored.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Work {
    /// [`Saved`] as JSON.
    pub(crate) record: String,
    /// The bytes of the library's files. Stored files that are not among them are deleted.
    pub(crate) files: StoredFiles,
}

/// Why a file of that size is not read; `None` when it is.
fn too_large(name: &str, bytes: u64) -> Option<String> {
    (bytes > MAX_FILE_BYTES).then(|| {
        let megabytes = |bytes: u64| bytes.div_ceil(1024 * 1024);
        format!(
            "{name} has {} MB; files of up to {} MB are read.",
            megabytes(bytes),
            megabytes(MAX_FILE_BYTES)
        )
    })
}

/// The name of a file without the folders before it.
fn last_part(path: &str) -> &str {
    path.rsplit(['/', '\\']).find(|part| !part.is_empty()).unwrap_or(path)
}
