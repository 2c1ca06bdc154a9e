//! Reading of files on all cores, by the code that reads them in the page.

use crate::error::{BatchError, FileError};
use crate::inputs::{Input, has_ending, shown};
use rayon::prelude::*;
use segue_formats::{FileKind, ImportOptions, kind_of};
use segue_session::reading::{ReadReport, ReadSetup, SkeletonFile, read_beside};
use std::collections::BTreeMap;
use std::fs;
use std::io::{self, Read as _, Seek as _, SeekFrom};
use std::path::{Component, Path, PathBuf};
use std::sync::Arc;

/// Files from this size on are read from disk on all cores, bytes: with smaller ones, one core is
/// done before the others have begun.
const LARGE_BYTES: u64 = 1 << 24;

/// The size of the parts in which the cores read a large file from disk, bytes.
const PART_BYTES: usize = 1 << 18;

/// A file that was read, or the reason why it was not.
pub type Read = Result<ReadReport, FileError>;

/// Reads files, with the skeletons that they need, and with the files beside them that they refer
/// to: buffers of glTF files and images of textures.
#[derive(Debug)]
pub struct Reader {
    options: ImportOptions,
    /// The skeletons that were named.
    named: Vec<SkeletonFile>,
    /// The ASF files beside AMC files, by folder.
    beside: BTreeMap<PathBuf, Vec<SkeletonFile>>,
}

impl Reader {
    /// Returns a reader of some files, after reading the skeletons that are named: ASF files of AMC
    /// files, and SMPL models of NPZ files. ASF files in the folder of an AMC file are found by
    /// themselves.
    ///
    /// # Errors
    /// [`BatchError`] if a skeleton that is named cannot be read.
    pub fn new(
        inputs: &[Input],
        options: ImportOptions,
        skeletons: &[PathBuf],
    ) -> Result<Self, BatchError> {
        let named = skeletons.iter().map(|path| named_skeleton(path, &options));
        let named = named.collect::<Result<Vec<_>, _>>()?;
        let mut beside = BTreeMap::new();
        for input in inputs {
            let folder = folder_of(input);
            if has_ending(&input.path, |own| own.eq_ignore_ascii_case("amc"))
                && !beside.contains_key(folder)
            {
                beside.insert(folder.to_owned(), skeletons_in(folder));
            }
        }
        Ok(Self { options, named, beside })
    }

    /// Returns the bytes of a file, or the reason why there are none. `None` for a file of a folder
    /// that is left out: a skeleton of others, or no motion at all.
    #[must_use]
    pub fn bytes(&self, input: &Input) -> Option<Result<Vec<u8>, FileError>> {
        let is_asf = has_ending(&input.path, |own| own.eq_ignore_ascii_case("asf"));
        if !input.is_named && is_asf && self.beside.contains_key(folder_of(input)) {
            return None;
        }
        let bytes = bytes_of(&input.path, self.options.max_bytes);
        let is_motion =
            |bytes: &[u8]| input.is_named || kind_of(&input.name, bytes) != FileKind::Unknown;
        bytes.as_ref().map_or(true, |bytes| is_motion(bytes)).then_some(bytes)
    }

    /// Reads a file, or all motion files of an archive; `None` as for [`bytes`](Self::bytes).
    #[must_use]
    pub fn read(&self, input: &Input) -> Option<Read> {
        Some(self.bytes(input)?.map(|bytes| self.read_bytes(input, &bytes)))
    }

    /// Reads a file whose bytes are known.
    #[must_use]
    pub fn read_bytes(&self, input: &Input, bytes: &[u8]) -> ReadReport {
        self.read_hashed(input, bytes, None)
    }

    /// Reads a file whose bytes are known, but not its SHA-256, which is left empty: for a large
    /// file, it takes as long as reading. Files of archives have theirs, and so have skeletons.
    #[must_use]
    pub fn read_unhashed(&self, input: &Input, bytes: &[u8]) -> ReadReport {
        let is_skeleton = kind_of(&input.name, bytes).is_skeleton();
        self.read_hashed(input, bytes, (!is_skeleton).then(String::new))
    }

    fn read_hashed(&self, input: &Input, bytes: &[u8], sha256: Option<String>) -> ReadReport {
        let beside = self.beside.get(folder_of(input)).into_iter().flatten();
        let setup = ReadSetup {
            options: self.options,
            skeleton_files: self.named.iter().chain(beside).cloned().collect(),
            sha256,
            ..ReadSetup::default()
        };
        let beside = |path: &str| file_beside(folder_of(input), path, self.options.max_bytes);
        read_beside(&input.name, bytes, &setup, &beside, &mut |_| true).unwrap_or_default()
    }
}

/// Does something with every file on all cores, and calls `done` after each. The results are in the
/// order of the files, without those for which there is none.
pub fn for_each<T: Send>(
    files: &[Input],
    work: impl Fn(&Input) -> Option<T> + Sync,
    done: impl Fn() + Sync,
) -> Vec<T> {
    let made: Vec<Option<T>> = files
        .par_iter()
        .map(|input| {
            let made = work(input);
            done();
            made
        })
        .collect();
    made.into_iter().flatten().collect()
}

/// Returns the folder of a file; the empty path for the current one.
fn folder_of(input: &Input) -> &Path {
    input.path.parent().unwrap_or(Path::new(""))
}

/// Returns a file below a folder, by its path from there, of at most `max_bytes`. A path that leads
/// elsewhere is not followed.
fn file_beside(folder: &Path, path: &str, max_bytes: usize) -> Option<Arc<[u8]>> {
    let is_below = Path::new(path).components().all(|part| matches!(part, Component::Normal(_)));
    let path = is_below.then(|| folder.join(path))?;
    let about = fs::metadata(&path).ok()?;
    let is_read = about.is_file() && about.len() <= max_bytes as u64;
    is_read.then(|| fs::read(&path).ok()).flatten().map(Arc::from)
}

/// Returns the bytes of a file of at most `max_bytes`.
///
/// # Errors
/// [`FileError`] with the file's name.
pub fn bytes_of(path: &Path, max_bytes: usize) -> Result<Vec<u8>, FileError> {
    let size = fs::metadata(path).map(|about| about.len());
    if let Ok(size) = size.as_ref()
        && *size > max_bytes as u64
    {
        return Err(FileError::TooLarge { name: shown(path), bytes: *size, max_bytes });
    }
    let failed = |error| FileError::System { name: shown(path), path: path.to_owned(), error };
    match size {
        // On a thread of the pool, this file is one of many.
        Ok(size) if size >= LARGE_BYTES && rayon::current_thread_index().is_none() => {
            in_parts(path, size as usize)
        }
        _ => fs::read(path),
    }
    .map_err(failed)
}

/// Returns the bytes of a file of a known size. All cores read: most of the time goes into handing
/// out memory.
fn in_parts(path: &Path, size: usize) -> io::Result<Vec<u8>> {
    let mut bytes = vec![0; size];
    bytes.par_chunks_mut(PART_BYTES).enumerate().try_for_each_init(
        || fs::File::open(path),
        |file, (index, part)| {
            let file = file.as_mut().map_err(|error| io::Error::from(error.kind()))?;
            file.seek(SeekFrom::Start((index * PART_BYTES) as u64))?;
            file.read_exact(part)
        },
    )?;
    Ok(bytes)
}

/// Reads a skeleton that was named.
fn named_skeleton(path: &Path, options: &ImportOptions) -> Result<SkeletonFile, BatchError> {
    let (name, bytes) = (shown(path), bytes_of(path, options.max_bytes)?);
    match kind_of(&name, &bytes) {
        FileKind::Asf => Ok(SkeletonFile::new(&name, &bytes)),
        _ => Ok(SkeletonFile::of_model(&name, &bytes, options)?),
    }
}

/// Returns the ASF files of a folder, sorted by name. One that cannot be read is missed when a
/// motion needs it.
fn skeletons_in(folder: &Path) -> Vec<SkeletonFile> {
    let here = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
    let mut paths: Vec<PathBuf> = fs::read_dir(here)
        .into_iter()
        .flatten()
        .filter_map(|entry| Some(entry.ok()?.path()))
        .filter(|path| has_ending(path, |own| own.eq_ignore_ascii_case("asf")))
        .collect();
    paths.sort();
    let read = |path: PathBuf| {
        let name = path.file_name()?.to_string_lossy().into_owned();
        Some(SkeletonFile::new(&name, &fs::read(&path).ok()?))
    };
    paths.into_iter().filter_map(read).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn large_files_are_read_whole() {
        let path = std::env::temp_dir().join(format!("segue-batch-{}-large", std::process::id()));
        let size = LARGE_BYTES as usize + 12_345;
        let written: Vec<u8> =
            (0..size as u32).map(|at| (at.wrapping_mul(2_654_435_761) >> 24) as u8).collect();
        fs::write(&path, &written).unwrap();
        let read = bytes_of(&path, usize::MAX);
        fs::remove_file(&path).unwrap();
        assert!(read.unwrap() == written);
    }
}
