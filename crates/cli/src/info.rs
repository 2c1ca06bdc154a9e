//! `segue info`: what files contain.

use crate::numbers;
use crate::read::{ReadArgs, for_each};
use crate::status::{Failure, Status};
use clap::Args;
use segue_batch::{Inputs, Read, import_text, unit_name, up_name};
use segue_formats::ImportError;
use segue_motion::skeleton::Role;
use segue_session::bone_map::rig_of;
use segue_session::metrics::Metric;
use segue_session::metrics_of_clip;
use segue_session::reading::{ReadClip, ReadFile};
use serde_json::{Value as Json, json};
use std::ffi::OsString;
use std::io::{self, Write};
use std::sync::Arc;

/// The part of the help behind the options.
pub(crate) const EXAMPLES: &str = "\
Examples:
  segue info walk.bvh                  kind, rig, frames, unit, up axis and artefacts
  segue info 'takes/**/*.fbx' --json   the same of many files, for other programs
  segue info dataset.zip --no-numbers  without measuring, which is quicker";

/// Arguments of `segue info`.
#[derive(Args, Debug)]
pub(crate) struct InfoArgs {
    /// Files, folders with all below them, zips, and patterns such as 'takes/*.bvh'
    #[arg(required = true, value_name = "FILE")]
    files: Vec<OsString>,
    /// Leaves out the artefact numbers
    #[arg(long)]
    no_numbers: bool,
    /// Prints JSON: a list with an object for each file
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    read: ReadArgs,
}

/// A file, as it is described.
struct Described {
    json: Json,
    text: String,
    is_unreadable: bool,
}

/// Describes files.
///
/// # Errors
/// [`Failure`] if there is no file, or the output cannot be written.
pub(crate) fn run(args: &InfoArgs) -> Result<Status, Failure> {
    let inputs = Inputs::of(&args.files)?;
    let reader = args.read.reader(&inputs.files)?;
    let described = for_each(&inputs.files, "reading", |input| {
        Some(describe(&input.name, reader.read(input)?, !args.no_numbers))
    });
    let mut is_unreadable = !inputs.problems.is_empty();
    let mut out = io::stdout().lock();
    let mut all = Vec::new();
    for (place, file) in described.into_iter().flatten().enumerate() {
        is_unreadable |= file.is_unreadable;
        if args.json {
            all.push(file.json);
        } else {
            writeln!(out, "{}{}", if place == 0 { "" } else { "\n" }, file.text)?;
        }
    }
    if args.json {
        writeln!(out, "{:#}", Json::Array(all))?;
    }
    out.flush()?;
    for problem in &inputs.problems {
        eprintln!("segue: {problem}");
    }
    Ok(if is_unreadable { Status::Unreadable } else { Status::Fine })
}

/// Describes the files in a file: one, or those of an archive.
fn describe(name: &str, read: Read, measures: bool) -> Vec<Described> {
    let report = match read {
        Ok(report) => report,
        Err(reason) => {
            let json = json!({ "file": name, "error": { "text": reason.to_string() } });
            return vec![Described { json, text: reason.to_string(), is_unreadable: true }];
        }
    };
    let notes = report.notes.iter().map(|note| Described {
        json: json!({ "file": name, "warnings": [note.to_string()] }),
        text: format!("{name}\n  warning   {note}"),
        is_unreadable: false,
    });
    let files = report.files.into_iter().map(|file| describe_file(file, measures));
    files.chain(notes).collect()
}

fn describe_file(file: ReadFile, measures: bool) -> Described {
    let ReadFile { name, sha256, size, kind, result, .. } = file;
    let mut json = json!({ "file": name, "kind": kind.name(), "bytes": size, "sha256": sha256 });
    let read = match result {
        Ok(read) => read,
        Err(error) => {
            json["error"] = error_as_json(&error);
            return Described { json, text: import_text(&error), is_unreadable: true };
        }
    };
    let mut lines = vec![name.clone(), format!("  kind      {}, {}", kind.name(), in_words(size))];
    if let Some(skeleton) = &read.skeleton_file {
        json["skeleton"] = Json::from(skeleton.name.clone());
        lines.push(format!("  skeleton  {}", skeleton.name));
    }
    let mut clips = Vec::new();
    for clip in read.clips {
        let (clip_json, clip_lines) = describe_clip(clip, measures);
        clips.push(clip_json);
        lines.extend(clip_lines);
    }
    json["clips"] = Json::Array(clips);
    let mut warnings: Vec<String> = read.warnings.iter().map(ToString::to_string).collect();
    if read.awaits_skeleton {
        warnings.push(
            "it needs its skeleton, an ASF file: put it beside, or name it by --skeleton".into(),
        );
    }
    lines.extend(warnings.iter().map(|warning| format!("  warning   {warning}")));
    json["warnings"] = Json::from(warnings);
    Described { json, text: lines.join("\n"), is_unreadable: read.awaits_skeleton }
}

fn describe_clip(clip: ReadClip, measures: bool) -> (Json, Vec<String>) {
    let ReadClip { motion, about, mesh } = clip;
    let motion = Arc::new(motion);
    let (own, roles) = (motion.clip(), motion.roles());
    let (skeleton, source) = (own.skeleton(), own.provenance());
    let parts = Role::ALL.iter().filter(|role| roles.get(**role).is_some()).count();
    let rig = rig_of(skeleton);
    let height_m = roles.body_height(skeleton);
    let metrics: Vec<Metric> = if measures { metrics_of_clip(&motion) } else { Vec::new() };
    let json = json!({
        "name": own.name(),
        "rig": rig,
        "joints": skeleton.len(),
        "body_parts": parts,
        "frames": own.frames(),
        "fps": own.fps(),
        "seconds": own.duration_secs(),
        "height_m": height_m,
        "unit": unit_name(source.metres_per_unit),
        "metres_per_unit": source.metres_per_unit,
        "up": up_name(source.up),
        "measure": about.measure.to_string(),
        "has_mesh": mesh.is_some(),
        "t_pose_dropped": about.t_pose_dropped,
        "metrics": numbers::as_json(&metrics),
    });
    let mut lines = vec![
        format!("  clip      {}", own.name()),
        format!(
            "  rig       {rig}: {} joints, {parts} of {} body parts found{}",
            skeleton.len(),
            Role::COUNT,
            if mesh.is_some() { ", with a mesh" } else { "" }
        ),
        format!(
            "  motion    {} frames at {} fps, {:.2} s",
            own.frames(),
            rounded(own.fps()),
            own.duration_secs()
        ),
        format!("  measure   {}", about.measure),
    ];
    if !metrics.is_empty() {
        lines.push(format!("  numbers   {}", numbers::on_one_line(&metrics)));
    }
    (json, lines)
}

/// Returns an error with its place as JSON.
pub(crate) fn error_as_json(error: &ImportError) -> Json {
    json!({
        "text": error.to_string(),
        "line": error.line,
        "column": error.column,
        "found": error.found.to_string(),
        "expected": error.expected.to_string(),
        "hint": error.hint.as_ref().map(ToString::to_string),
    })
}

/// Returns a number with at most three decimals.
pub(crate) fn rounded(number: f64) -> String {
    let text = format!("{number:.3}");
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}

fn in_words(bytes: u64) -> String {
    match bytes.div_ceil(1024) {
        size @ ..10_240 => format!("{size} KB"),
        size => format!("{} MB", size.div_ceil(1024)),
    }
}
