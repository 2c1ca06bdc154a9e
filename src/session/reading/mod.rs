//! Reading files apart from the document: a pure function of names and bytes, so that a large file can be read by another thread or worker and
//! handed over when it is done.

mod wire;

pub use wire::{Parcel, Unpacker, WireError};

use super::motion::Motion;
use crate::formats::{ImportError, ImportOptions, ImportedClip, import_with_progress};
use crate::skeleton::Roles;
use serde::{Deserialize, Serialize};
use sha2::{Digest as _, Sha256};
use std::collections::BTreeMap;
use std::sync::Arc;

/// Files above this size are not read between two frames, bytes.
pub const LARGE_BYTES: u64 = 1 << 20;

/// Where the bytes of a file are.
#[derive(Clone, Debug, PartialEq)]
pub enum Content {
    /// In the document.
    Here(Arc<[u8]>),
    /// With the platform, under this key: too large to be copied about. Once the file was read, the key is its SHA-256.
    Outside(String),
}

/// What is to be read, and how.
#[derive(Clone, Debug, PartialEq)]
pub struct ReadTask {
    /// Its number.
    pub id: u64,
    /// The file's name.
    pub name: String,
    /// Its bytes.
    pub content: Content,
    /// How many there are.
    pub size: u64,
    /// How to read them.
    pub setup: ReadSetup,
}

/// How a file is to be read.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ReadSetup {
    /// What the user says about units, axes and the frame rate.
    pub options: ImportOptions,
    /// Roles that were set by hand, by the number of the clip in the file.
    pub roles: BTreeMap<usize, Roles>,
    /// Files that this one may lean on: skeletons for the motion of another file.
    pub companions: Vec<Companion>,
}

/// A small file that others lean on: the skeleton of a motion.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Companion {
    /// The file's name.
    pub name: String,
    /// SHA-256 of its bytes, lower-case hexadecimal.
    pub sha256: String,
    /// Its bytes.
    pub bytes: Arc<[u8]>,
}

/// What reading a file gave: one part for a motion file, several for an archive.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ReadReport {
    /// The motion files.
    pub files: Vec<ReadFile>,
    /// What is to be said of the whole, one sentence each.
    pub notes: Vec<String>,
}

/// One motion file.
#[derive(Clone, Debug, PartialEq)]
pub struct ReadFile {
    /// The file's name.
    pub name: String,
    /// SHA-256 of its bytes, lower-case hexadecimal.
    pub sha256: String,
    /// How many bytes it has.
    pub size: u64,
    /// Its bytes, where it came out of an archive: nobody else has them.
    pub unpacked: Option<Vec<u8>>,
    /// Its clips, or why there are none.
    pub result: Result<ReadClips, ImportError>,
}

/// The clips of a file.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ReadClips {
    /// One for each character.
    pub clips: Vec<ReadClip>,
    /// What was odd, one sentence each.
    pub warnings: Vec<String>,
    /// The skeleton file that the motion was read with.
    pub companion: Option<Companion>,
    /// Whether there are no clips because the skeleton file is not here.
    pub awaits_skeleton: bool,
}

/// A clip, with all that is derived from it.
#[derive(Clone, Debug, PartialEq)]
pub struct ReadClip {
    /// The clip.
    pub motion: Motion,
    /// How it was read.
    pub about: About,
}

/// How a clip was read: what the clip panel tells.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct About {
    /// Unit, height and up axis, in words.
    pub measure: String,
    /// Whether the file's first row is a T-pose that the motion does not start from.
    pub t_pose_first_row: bool,
    /// Whether that row was left out.
    pub t_pose_dropped: bool,
}

/// Reads a file. `progress` hears how much of it is done, in bytes, and says whether to go on; `None` when it said no.
pub fn read(name: &str, bytes: &[u8], setup: &ReadSetup, progress: &mut dyn FnMut(usize) -> bool) -> Option<ReadReport> {
    Some(ReadReport {
        files: vec![read_file(name, bytes, setup, progress)?],
        notes: Vec::new(),
    })
}

fn read_file(name: &str, bytes: &[u8], setup: &ReadSetup, progress: &mut dyn FnMut(usize) -> bool) -> Option<ReadFile> {
    let result = match import_with_progress(name, bytes, &setup.options, progress) {
        Ok(None) => return None,
        Ok(Some(imported)) => Ok(ReadClips {
            warnings: imported.warnings.iter().map(ToString::to_string).collect(),
            clips: (imported.clips.into_iter().enumerate())
                .map(|(index, clip)| ReadClip::new(clip, setup.roles.get(&index).cloned()))
                .collect(),
            ..ReadClips::default()
        }),
        Err(error) => Err(error),
    };
    Some(ReadFile {
        name: name.to_owned(),
        sha256: sha256_hex(bytes),
        size: bytes.len() as u64,
        unpacked: None,
        result,
    })
}

impl ReadClip {
    fn new(imported: ImportedClip, roles: Option<Roles>) -> Self {
        let about = About {
            measure: imported.measure.to_string(),
            t_pose_first_row: imported.t_pose_first_row,
            t_pose_dropped: imported.t_pose_dropped,
        };
        Self {
            motion: Motion::analyze(imported.clip, roles),
            about,
        }
    }
}

/// SHA-256 in lower-case hexadecimal.
fn sha256_hex(bytes: &[u8]) -> String {
    use std::fmt::Write as _;
    Sha256::digest(bytes).iter().fold(String::with_capacity(64), |mut hex, byte| {
        // Writing to a string cannot fail.
        write!(hex, "{byte:02x}").ok();
        hex
    })
}
