//! The platform: everything that a page and a desktop window do differently, such as files,
//! addresses, storage and time. `web` and `native` have the same names.
//!
//! Answers that take time come through an [`Inbox`], which the app empties before each frame.

mod address;
#[cfg(any(test, target_arch = "wasm32"))]
mod begun;
mod bundle;
mod file_bytes;
mod gamepad;
#[cfg_attr(
    not(target_arch = "wasm32"),
    expect(dead_code, reason = "some things happen to a page only")
)]
mod inbox;
mod motion_files;
mod pool_size;
mod read_event;
#[cfg_attr(
    not(any(test, target_arch = "wasm32")),
    expect(dead_code, reason = "a folder needs no rows and no windows that leave")
)]
mod records;
mod work;

#[cfg(not(target_arch = "wasm32"))]
mod native;
#[cfg(target_arch = "wasm32")]
mod web;

#[cfg(not(target_arch = "wasm32"))]
pub(crate) use native::*;
#[cfg(target_arch = "wasm32")]
pub(crate) use web::*;

#[cfg(target_arch = "wasm32")]
pub(crate) use address::corpus_clip_of;
pub(crate) use address::file_name_of;
pub(crate) use file_bytes::{FileBytes, LargeFileStore, StoredFiles};
pub(crate) use inbox::{Inbox, Incoming};
pub(crate) use pool_size::PoolStats;
pub(crate) use read_event::{ReadError, ReadEvent};
pub(crate) use work::{NewClip, StoredWork, Work};
