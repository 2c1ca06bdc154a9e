//! Reading of files on all cores, by the code that reads them in the page.

use crate::inputs::{Input, has_ending, shown};
use crate::progress;
use crate::status::Failure;
use crate::units::{parse_rate, parse_unit, parse_up};
use clap::Args;
use rayon::prelude::*;
use segue_formats::{FileKind, ImportOptions, kind_of};
use segue_motion::clip::UpAxis;
use segue_session::reading::{Companion, ReadReport, ReadSetup, read};
use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

/// How files are read, where they do not say it or say it wrongly.
#[derive(Args, Clone, Debug, Default)]
#[command(next_help_heading = "Reading")]
pub(crate) struct ReadArgs {
    /// Unit of length in the files: mm, cm, m, in, ft, or metres per unit [default: found]
    #[arg(long, value_name = "UNIT", value_parser = parse_unit)]
    from_unit: Option<f64>,
    /// Up axis in the files: y or z [default: found]
    #[arg(long, value_name = "AXIS", value_parser = parse_up)]
    from_up: Option<UpAxis>,
    /// Frames per second in the files [default: those of the file]
    #[arg(long, value_name = "FPS", value_parser = parse_rate)]
    from_rate: Option<f64>,
    /// Skeleton of AMC files (.asf), or your SMPL model for NPZ files; an ASF file in the folder of
    /// an AMC file is found by itself
    #[arg(long, value_name = "FILE")]
    skeleton: Vec<PathBuf>,
}

impl ReadArgs {
    /// Returns the options of the import.
    pub(crate) fn options(&self) -> ImportOptions {
        ImportOptions {
            metres_per_unit: self.from_unit,
            up: self.from_up,
            fps: self.from_rate,
            ..ImportOptions::default()
        }
    }

    /// Returns the skeletons that are named, with their bytes.
    pub(crate) fn skeletons(&self) -> &[PathBuf] {
        &self.skeleton
    }
}

/// A file that was read, or the reason why it was not.
pub(crate) type Read = Result<ReadReport, String>;

/// Reads files, with the skeletons that they need.
#[derive(Debug)]
pub(crate) struct Reader {
    options: ImportOptions,
    /// The skeletons that were named.
    named: Vec<Companion>,
    /// The ASF files beside AMC files, by folder.
    beside: BTreeMap<PathBuf, Vec<Companion>>,
}

impl Reader {
    /// Returns a reader of some files, after reading the skeletons.
    ///
    /// # Errors
    /// [`Failure`] if a skeleton that is named cannot be read.
    pub(crate) fn new(inputs: &[Input], args: &ReadArgs) -> Result<Self, Failure> {
        let options = args.options();
        let named = args.skeletons().iter().map(|path| named_skeleton(path, &options));
        let named = named.collect::<Result<Vec<_>, _>>().map_err(Failure::unreadable)?;
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
    pub(crate) fn bytes(&self, input: &Input) -> Option<Result<Vec<u8>, String>> {
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
    pub(crate) fn read(&self, input: &Input) -> Option<Read> {
        Some(self.bytes(input)?.map(|bytes| self.read_bytes(input, &bytes)))
    }

    /// Reads a file whose bytes are known.
    pub(crate) fn read_bytes(&self, input: &Input, bytes: &[u8]) -> ReadReport {
        let beside = self.beside.get(folder_of(input)).into_iter().flatten();
        let setup = ReadSetup {
            options: self.options,
            companions: self.named.iter().chain(beside).cloned().collect(),
            ..ReadSetup::default()
        };
        read(&input.name, bytes, &setup, &mut |_| true).unwrap_or_default()
    }
}

/// Does something with every file on all cores. The results are in the order of the files, without
/// those for which there is none.
pub(crate) fn for_each<T: Send>(
    files: &[Input],
    what: &'static str,
    work: impl Fn(&Input) -> Option<T> + Sync,
) -> Vec<T> {
    let bar = progress::bar(files.len(), what);
    let made: Vec<Option<T>> = files
        .par_iter()
        .map(|input| {
            let made = work(input);
            bar.inc(1);
            made
        })
        .collect();
    bar.finish_and_clear();
    made.into_iter().flatten().collect()
}

/// Returns the folder of a file; the empty path for the current one.
fn folder_of(input: &Input) -> &Path {
    input.path.parent().unwrap_or(Path::new(""))
}

/// Returns the bytes of a file.
///
/// # Errors
/// A sentence that names the file.
pub(crate) fn bytes_of(path: &Path, max_bytes: usize) -> Result<Vec<u8>, String> {
    let size = fs::metadata(path).map(|about| about.len());
    if let Ok(size) = size.as_ref()
        && *size > max_bytes as u64
    {
        return Err(format!(
            "{} has {} MB; files of up to {} MB are read",
            shown(path),
            size.div_ceil(1 << 20),
            max_bytes >> 20
        ));
    }
    fs::read(path).map_err(|error| format!("{} cannot be read: {error}", shown(path)))
}

/// Reads a skeleton that was named.
fn named_skeleton(path: &Path, options: &ImportOptions) -> Result<Companion, String> {
    let (name, bytes) = (shown(path), bytes_of(path, options.max_bytes)?);
    match kind_of(&name, &bytes) {
        FileKind::Asf => Ok(Companion::new(&name, &bytes)),
        _ => Companion::of_model(&name, &bytes, options).map_err(|error| error.to_string()),
    }
}

/// Returns the ASF files of a folder, sorted by name. One that cannot be read is missed when a
/// motion needs it.
fn skeletons_in(folder: &Path) -> Vec<Companion> {
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
        Some(Companion::new(&name, &fs::read(&path).ok()?))
    };
    paths.into_iter().filter_map(read).collect()
}
