//! The record of one file: its clips, read, measured and put on the standard body.

use crate::record::VERSION;
use crate::{
    ClipRecord, ClipRow, FileRecord, PlaceError, Signature, StandardBody, Status, encode_poses,
    thumbnail,
};
use segue_formats::ImportError;
use segue_motion::clip::Motion;
use segue_motion::skeleton::Role;
use segue_session::bone_map::rig_of;
use segue_session::reading::{ReadClip, ReadFile, ReadSetup, SkeletonFile, read};
use segue_session::{cleaned, hex, metrics_of_clip};
use serde::{Deserialize, Serialize};
use sha2::{Digest as _, Sha256};
use std::sync::Arc;

/// The name under which files are read instead of their own: records do not depend on names.
const NEUTRAL: &str = "clip";
/// The bytes of a key.
const KEY_BYTES: usize = 16;

/// Options of a corpus.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Options {
    /// Whether the faults of takes are mended before they are placed.
    pub clean: bool,
}

/// Returns the key of a file's record, 32 hexadecimal digits: a hash of the content, of that of the
/// skeletons beside it, of the options, and of the version of records. The name only tells the
/// format; where a file is paired with another by its name, it is a part of the key.
#[must_use]
pub fn work_key(
    name: &str,
    bytes: &[u8],
    skeleton_files: &[SkeletonFile],
    options: &Options,
) -> String {
    let mut digest = Sha256::new();
    let mut part = |bytes: &[u8]| {
        // Lengths keep the parts apart.
        digest.update((bytes.len() as u64).to_le_bytes());
        digest.update(bytes);
    };
    part(b"segue-corpus");
    part(&VERSION.to_le_bytes());
    part(env!("CARGO_PKG_VERSION").as_bytes());
    part(&[u8::from(options.clean)]);
    part(neutral_name(name, skeleton_files).as_bytes());
    for own in skeleton_files {
        part(own.name.as_bytes());
        part(own.sha256.as_bytes());
    }
    part(bytes);
    digest.finalize().get(..KEY_BYTES).map(hex).unwrap_or_default()
}

/// Reads a file, and makes all that a corpus has of it. `skeleton_files` are the skeletons beside
/// it: the ASF files of an AMC file.
///
/// A pure function that does not fail: a file that cannot be read, and a clip that cannot be
/// placed, are rows that say why. A skeleton by itself has no row.
#[must_use]
pub fn process_file(
    name: &str,
    bytes: &[u8],
    skeleton_files: &[SkeletonFile],
    options: &Options,
) -> FileRecord {
    let body = match StandardBody::new() {
        Ok(body) => body,
        Err(error) => return FileRecord::unreadable(error.to_string()),
    };
    let name = neutral_name(name, skeleton_files);
    let setup = ReadSetup { skeleton_files: skeleton_files.to_vec(), ..ReadSetup::default() };
    let report = read(&name, bytes, &setup, &mut |_| true).unwrap_or_default();
    let is_archive = !report.is_one_file();
    let files = report.files.into_iter();
    FileRecord { clips: files.flat_map(|file| of_file(file, is_archive, &body, options)).collect() }
}

/// Returns the name under which a file is read: `clip` and its ending, so that files of the same
/// content have the same record.
fn neutral_name(name: &str, skeleton_files: &[SkeletonFile]) -> String {
    let own = name.rsplit(['/', '\\']).next().unwrap_or(name);
    if !skeleton_files.is_empty() {
        return own.to_owned();
    }
    let lower = own.to_lowercase();
    let stem = lower.strip_suffix(".gz").unwrap_or(&lower);
    let start = stem.rfind('.').unwrap_or(stem.len());
    format!("{NEUTRAL}{}", &lower[start..])
}

fn of_file(
    file: ReadFile,
    is_archive: bool,
    body: &StandardBody,
    options: &Options,
) -> Vec<ClipRecord> {
    let inner = if is_archive { file.name.split_once('/').map(|(_, path)| path) } else { None };
    let of_file = |status| ClipRow {
        inner: inner.map(str::to_owned),
        format: file.kind.name().to_owned(),
        ..ClipRow::of_file(status)
    };
    let read = match file.result {
        Ok(read) => read,
        Err(error) => {
            let row = ClipRow {
                message: Some(message_of(&error)),
                line: Some(error.line),
                column: Some(error.column),
                ..of_file(Status::Unreadable)
            };
            return vec![ClipRecord::of_row(row)];
        }
    };
    if file.kind.is_skeleton() {
        return Vec::new();
    }
    if read.awaits_skeleton {
        let message = Some("it needs its skeleton, an ASF file beside it".to_owned());
        return vec![ClipRecord::of_row(ClipRow { message, ..of_file(Status::Unreadable) })];
    }
    let mut warnings: Vec<String> = read.warnings.iter().map(ToString::to_string).collect();
    warnings.sort();
    let row = ClipRow { warnings, ..of_file(Status::Ok) };
    read.clips.into_iter().map(|clip| of_clip(clip, &row, body, options)).collect()
}

/// Returns an error without the file's name.
fn message_of(error: &ImportError) -> String {
    let text = format!("found {}, expected {}", error.found, error.expected);
    match &error.hint {
        Some(hint) => format!("{text} ({hint})"),
        None => text,
    }
}

fn of_clip(
    clip: ReadClip,
    of_file: &ClipRow,
    body: &StandardBody,
    options: &Options,
) -> ClipRecord {
    let motion = Arc::new(clip.motion);
    let (own, roles) = (motion.clip(), motion.roles());
    let skeleton = own.skeleton();
    let metrics = metrics_of_clip(&motion);
    let finite = |value: f64| Some(value).filter(|value| value.is_finite());
    let mut row = ClipRow {
        name: Some(own.name().to_owned()).filter(|name| !name.is_empty() && name != NEUTRAL),
        seconds: finite(own.duration_secs()),
        frames: Some(own.frames()),
        fps: finite(own.fps()),
        joints: Some(skeleton.len()),
        rig: Some(rig_of(skeleton)),
        body_parts: Some(Role::ALL.iter().filter(|role| roles.get(**role).is_some()).count()),
        height_m: finite(f64::from(roles.body_height(skeleton))),
        metrics: (metrics.iter())
            .map(|metric| (metric.id.name().to_owned(), metric.value.and_then(finite)))
            .collect(),
        ..of_file.clone()
    };
    match placed(&motion, body, options) {
        Ok((mended, record)) => {
            row.mended = mended;
            ClipRecord { row, ..record }
        }
        Err(reason) => {
            row.status = Status::Unplaced;
            row.message = Some(reason);
            ClipRecord::of_row(row)
        }
    }
}

/// Returns the number of faults that were mended, and a clip on the standard body, still without
/// its row.
fn placed(
    motion: &Arc<Motion>,
    body: &StandardBody,
    options: &Options,
) -> Result<(usize, ClipRecord), String> {
    let (motion, mended) = if options.clean {
        cleaned(motion).map_err(|error| error.to_string())?
    } else {
        (Arc::clone(motion), 0)
    };
    let make = || -> Result<ClipRecord, PlaceError> {
        let placed = body.place(&motion)?;
        let signature = Signature::of(&placed.clip, body.roles());
        Ok(ClipRecord {
            row: ClipRow::of_file(Status::Ok),
            poses: encode_poses(&placed.clip, &placed.contacts)?,
            thumbnail: thumbnail(&placed.clip, body.roles())?,
            features: placed.features,
            signature: signature.map_or_else(Vec::new, |own| own.numbers().to_vec()),
        })
    };
    make().map(|record| (mended, record)).map_err(|error| error.to_string())
}
