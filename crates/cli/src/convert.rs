//! `segue convert`: any motion file as another.

use crate::progress;
use crate::read::ReadArgs;
use crate::status::{Failure, Status};
use crate::write::{Outputs, WriteArgs};
use clap::Args;
use rayon::prelude::*;
use segue_batch::{Input, Inputs, Read, import_text, shown};
use segue_session::convert::{ConvertOptions, TargetRig, convert_to_bytes};
use segue_session::reading::{ReadClip, ReadFile, ReadReport};
use serde_json::{Value as Json, json};
use std::ffi::OsString;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

/// The part of the help behind the options.
pub(crate) const EXAMPLES: &str = "\
Examples:
  segue convert walk.bvh -o walk.glb                 by the ending of OUT
  segue convert takes -o glb --to glb                a folder with all below it, in the same folders
  segue convert walk.fbx -o walk.bvh --unit m --up z --rate 30
  segue convert mocap.zip -o out --to bvh --body hero.glb   on the skeleton of another file";

/// The number of files that are converted before their results are written, for each core.
const FILES_PER_CORE: usize = 8;

/// Arguments of `segue convert`.
#[derive(Args, Debug)]
pub(crate) struct ConvertArgs {
    /// Files, folders with all below them, zips, and patterns such as 'takes/*.bvh'
    #[arg(required = true, value_name = "IN")]
    files: Vec<OsString>,
    /// File, or folder for several clips
    #[arg(short, long, value_name = "OUT")]
    output: PathBuf,
    /// Puts every motion on the skeleton of this file's first clip, with feet and hands where they
    /// belong
    #[arg(long, value_name = "FILE")]
    body: Option<PathBuf>,
    /// Prints JSON: a list with an object for each clip
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    write: WriteArgs,
    #[command(flatten)]
    read: ReadArgs,
}

/// A clip in another format, or the reason why there is none.
struct Converted {
    /// The file that was read.
    source: String,
    /// The path of the new file in the folder, without its ending.
    relative: PathBuf,
    bytes: Result<Vec<u8>, String>,
    warnings: Vec<String>,
}

/// Converts files.
///
/// # Errors
/// [`Failure`] if there is no file, or the command line is wrong.
pub(crate) fn run(args: &ConvertArgs) -> Result<Status, Failure> {
    let inputs = Inputs::of(&args.files)?;
    let out = args.output.as_path();
    let is_file = args.write.is_file(out);
    let export = args.write.options(is_file.then_some(out))?;
    let reader = args.read.reader(&inputs.files)?;
    let rig = args.body.as_deref().map(|path| body_of(path, &args.read)).transpose()?;
    let options = ConvertOptions { export, rig };
    let mut outputs = Outputs::new(out, is_file, &inputs.files);
    let bar = progress::bar(inputs.files.len(), "converting");
    let (mut rows, mut is_unreadable) = (Vec::new(), !inputs.problems.is_empty());
    // Written in the order of the files, so that names do not depend on the number of cores; in
    // parts, so that not all of them are in memory.
    for part in inputs.files.chunks(FILES_PER_CORE * rayon::current_num_threads().max(1)) {
        let converted: Vec<Vec<Converted>> = part
            .par_iter()
            .map(|input| {
                let read = reader.read(input);
                let made = read.map_or_else(Vec::new, |read| convert(input, read, &options));
                bar.inc(1);
                made
            })
            .collect();
        for clip in converted.into_iter().flatten() {
            let Converted { source, relative, bytes, warnings } = clip;
            let written = bytes
                .and_then(|bytes| outputs.write(&relative, options.export.format.ending(), &bytes));
            is_unreadable |= written.is_err();
            rows.push((source, written, warnings));
        }
    }
    bar.finish_and_clear();
    report(args.json, &rows)?;
    for problem in &inputs.problems {
        eprintln!("segue: {problem}");
    }
    Ok(if is_unreadable { Status::Unreadable } else { Status::Fine })
}

/// Prints what became of every clip.
fn report(
    is_json: bool,
    rows: &[(String, Result<PathBuf, String>, Vec<String>)],
) -> Result<(), Failure> {
    let mut out = io::stdout().lock();
    if is_json {
        let row = |(source, written, warnings): &(String, Result<PathBuf, String>, Vec<String>)| {
            let (file, error) =
                (written.as_ref().ok().map(|path| shown(path)), written.as_ref().err());
            json!({ "source": source, "file": file, "warnings": warnings, "error": error })
        };
        writeln!(out, "{:#}", Json::Array(rows.iter().map(row).collect()))?;
        return Ok(());
    }
    for (source, written, warnings) in rows {
        match written {
            Ok(path) => writeln!(out, "{source} → {}", shown(path))?,
            Err(reason) => eprintln!("segue: {reason}"),
        }
        for warning in warnings {
            writeln!(out, "  warning: {warning}")?;
        }
    }
    Ok(())
}

/// Reads the body that motions are put on.
fn body_of(path: &Path, args: &ReadArgs) -> Result<TargetRig, Failure> {
    let name = path.file_name().unwrap_or_default();
    let input =
        Input { path: path.to_owned(), name: shown(path), relative: name.into(), is_named: true };
    let files = std::slice::from_ref(&input);
    let report = match args.reader(files)?.read(&input) {
        Some(Ok(report)) => report,
        Some(Err(reason)) => return Err(reason.into()),
        None => ReadReport::default(),
    };
    for file in report.files {
        match file.result {
            Ok(read) => {
                if let Some(clip) = read.clips.first() {
                    return Ok(TargetRig::of(&clip.motion));
                }
            }
            Err(error) => return Err(Failure::unreadable(import_text(&error))),
        }
    }
    Err(Failure::unreadable(format!("{} has no body", shown(path))))
}

/// Converts the clips of a file, or of all files of an archive.
fn convert(input: &Input, read: Read, options: &ConvertOptions) -> Vec<Converted> {
    let failed = |source: &str, reason: String| Converted {
        source: source.to_owned(),
        relative: PathBuf::new(),
        bytes: Err(reason),
        warnings: Vec::new(),
    };
    let report = match read {
        Ok(report) => report,
        Err(reason) => return vec![failed(&input.name, reason.to_string())],
    };
    let mut notes: Vec<String> = report.notes.iter().map(ToString::to_string).collect();
    let mut made = Vec::new();
    for file in report.files {
        let ReadFile { name, result, .. } = file;
        let read = match result {
            Ok(read) => read,
            Err(error) => {
                made.push(failed(&name, import_text(&error)));
                continue;
            }
        };
        let mut warnings = std::mem::take(&mut notes);
        warnings.extend(read.warnings.iter().map(ToString::to_string));
        if read.clips.is_empty() {
            let reason = if read.awaits_skeleton {
                "it needs its skeleton, an ASF file: put it beside, or name it by --skeleton"
            } else {
                "it has no motion"
            };
            made.push(failed(&name, format!("{name}: {reason}")));
        }
        let several = read.clips.len() > 1;
        for ReadClip { motion, mesh, .. } in read.clips {
            let bytes = convert_to_bytes(&motion, mesh.as_ref(), options)
                .map_err(|reason| format!("{name}: {reason}"));
            let clip = several.then(|| motion.clip().name().to_owned());
            made.push(Converted {
                source: name.clone(),
                relative: relative_path(input, &name, clip.as_deref()),
                bytes,
                warnings: std::mem::take(&mut warnings),
            });
        }
    }
    made
}

/// Returns the path of a clip in the folder of outputs, without its ending: that of its file, of an
/// archive in a folder of its name, with the clip's name where the file has several.
fn relative_path(input: &Input, name: &str, clip: Option<&str>) -> PathBuf {
    let without_ending = |path: &Path| {
        let stem = path.with_extension("");
        let is_packed = path.extension().is_some_and(|ending| ending == "gz");
        if is_packed { stem.with_extension("") } else { stem }
    };
    let mut path = without_ending(&input.relative);
    let inner = name.strip_prefix(&input.name).map(|rest| rest.trim_start_matches('/'));
    if let Some(inner) = inner.filter(|inner| !inner.is_empty()) {
        // A path in an archive must not lead out of the folder.
        let parts = Path::new(inner).components().filter_map(|part| match part {
            std::path::Component::Normal(part) => Some(part),
            _ => None,
        });
        path.push(without_ending(&parts.collect::<PathBuf>()));
    }
    match clip {
        Some(clip) => {
            let stem = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
            path.with_file_name(format!("{stem} {}", clip.replace(['/', '\\'], "_")))
        }
        None => path,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn relative_path_is_that_of_the_source() {
        let input = |name: &str, relative: &str| Input {
            path: name.into(),
            name: name.to_owned(),
            relative: relative.into(),
            is_named: true,
        };
        let path = |input: &Input, name: &str, clip: Option<&str>| {
            shown(&relative_path(input, name, clip))
        };
        let walk = input("in/a/走路.bvh", "a/走路.bvh");
        assert_eq!(path(&walk, "in/a/走路.bvh", None), "a/走路");
        assert_eq!(path(&walk, "in/a/走路.bvh", Some("x/y")), "a/走路 x_y");
        let packed = input("in/walk.bvh.gz", "walk.bvh.gz");
        assert_eq!(path(&packed, "in/walk.bvh", None), "walk");
        let zip = input("in/set.zip", "set.zip");
        assert_eq!(path(&zip, "in/set.zip/b/run.bvh", None), "set/b/run");
        assert_eq!(path(&zip, "in/set.zip/../../run.bvh", None), "set/run");
    }
}
