//! The files that arrays come in: `.npz`, `.npy` and pickles.

use super::array::Array;
use super::bundle::Bundle;
use super::header::{Header, is_npy};
use super::pickle;
use crate::archive::{UnpackFailure, open, unpack_entry};
use crate::error::Fault;
use segue_text::msg;
use std::borrow::Cow;

/// Returns the paths of the files in a zip archive; empty if it cannot be read.
pub(super) fn entry_paths(bytes: &[u8]) -> Vec<String> {
    let Ok(archive) = open(bytes) else { return Vec::new() };
    let paths = archive.entries().map_while(Result::ok).filter(|entry| !entry.is_dir());
    paths.map(|entry| crate::text::name(entry.file_path().as_bytes()).0).collect()
}

/// Reads those arrays of a `.npz` file whose names are `wanted`, up to `most` bytes in all. Arrays
/// of types without a use here (complex numbers, records) are left out.
pub(super) fn read_npz<'a>(
    bytes: &[u8],
    most: usize,
    wanted: &dyn Fn(&str) -> bool,
) -> Result<Bundle<'a>, Fault> {
    let archive = open(bytes).map_err(|why| Fault::new(0, why, "a zip archive of NumPy arrays"))?;
    let mut left = most;
    let mut arrays = Vec::new();
    let mut unreadable = None;
    for entry in archive.entries() {
        let entry = entry.map_err(|error| {
            let found = msg!("a damaged zip archive ({error})", error = error.to_string());
            Fault::new(0, found, "a list of its files")
        })?;
        let path = crate::text::name(entry.file_path().as_bytes()).0;
        let Some(name) = path.strip_suffix(".npy").filter(|name| wanted(name)) else { continue };
        let unpacked = match unpack_entry(&archive, &entry, left) {
            Ok(unpacked) => unpacked,
            Err(UnpackFailure::Unreadable(why)) => {
                let name = crate::text::short(path.as_bytes());
                return Err(Fault::new(0, msg!("the array {name}: {why}", name, why), "an array"));
            }
            Err(UnpackFailure::TooMuch) => {
                let found = msg!("more than {mb} MB after unpacking", mb = most >> 20);
                return Err(Fault::new(0, found, "a smaller file"));
            }
            Err(UnpackFailure::NoMemory) => {
                let found = "more than there is memory for after unpacking";
                return Err(Fault::new(0, found, "a smaller file"));
            }
        };
        left -= unpacked.len().min(left);
        match Array::read(Cow::Owned(unpacked)) {
            Ok(array) => arrays.push((name.to_owned(), array)),
            Err(fault) => unreadable = unreadable.or(Some(fault)),
        }
    }
    match unreadable {
        Some(fault) if arrays.is_empty() => Err(fault),
        _ => Ok(Bundle::new(arrays)),
    }
}

/// Reads a `.npy` file, or one of pickled objects: one bundle for each dictionary in it. The name
/// of an array that has none is empty.
pub(super) fn read_npy(bytes: &[u8]) -> Result<Vec<Bundle<'_>>, Fault> {
    if !is_npy(bytes) {
        return pickle::read(bytes);
    }
    let array = Array::read(Cow::Borrowed(bytes))?;
    match array.pickled() {
        Some(_) => {
            let at = Header::read(bytes)?.data_at;
            pickle::read(bytes.get(at..).unwrap_or_default())
        }
        None => Ok(vec![Bundle::new(vec![(String::new(), array)])]),
    }
}
