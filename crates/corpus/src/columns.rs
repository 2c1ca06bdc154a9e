//! `columns.bin`: all that a page shows of a corpus at once, in a few bytes a clip.
//!
//! The table of a large corpus is tens of megabytes, and a page wants its rows sorted, filtered,
//! searched and drawn on a map as soon as it is open. This file has the columns for that, each
//! by itself and compressed: texts by what they share with the one before, numbers in one byte
//! ([`levels`]), and of the hashes as many digits as tell the clips apart.
//!
//! Clips are in the order of their paths, in which neighbours are alike. The order of the table,
//! on which index and shards rely, is that of the ids.

mod levels;
mod read;
#[cfg(test)]
mod tests;
mod write;

pub(crate) use levels::rounded;
pub(crate) use read::read;
pub use write::{RowTexts, write_columns};

use crate::packed::Texts;
use crate::pose::poses_bytes;
use crate::{CorpusError, POSE_FPS, Slot, Status};
use levels::Levels;
use segue_motion::matching::RATE;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// The first bytes of the file.
const MARK: [u8; 4] = *b"SGCO";
/// The version of the file.
const VERSION: u32 = 1;
/// The name of the bytes in errors.
const WHAT: &str = "columns.bin";
/// The least number of digits of a hash in ids.
pub(crate) const DIGITS: usize = 8;
/// The number of joints of most clips' poses.
const USUAL_JOINTS: usize = 22;
/// The greatest number of frames of a clip at the rate of matching.
const MAX_STEPS: f64 = 1e7;
/// The codes of a place on an axis of the map, from -1 to 1. Code 0 is no place.
const MAP_CODES: f32 = 254.0;

/// The lists to which the columns refer, as JSON.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
struct Facts {
    /// Formats of files, sorted.
    formats: Vec<String>,
    /// Rigs, sorted.
    rigs: Vec<String>,
    /// Frame rates, sorted.
    rates: Vec<f64>,
    /// The number of labels.
    labels: usize,
    /// The labels that clips have together; the first set is empty.
    label_sets: Vec<Vec<u32>>,
    /// Reasons of states.
    messages: Vec<String>,
    /// More digits of the hash, for clips that eight digits do not tell apart, by their place.
    longer: Vec<(u32, String)>,
    /// Columns of numbers.
    numbers: Vec<NumberFacts>,
}

/// A column of numbers.
#[derive(Clone, Debug, Serialize, Deserialize)]
struct NumberFacts {
    name: String,
    label: String,
    unit: String,
    help: String,
    levels: Levels,
}

/// The bits of a clip.
mod flags {
    /// The state.
    pub(super) const STATUS: u8 = 3;
    /// Its name is not that of its file.
    pub(super) const NAMED: u8 = 4;
    /// It is a copy of another clip.
    pub(super) const COPY: u8 = 8;
    /// It is a mirrored copy.
    pub(super) const MIRRORED: u8 = 16;
    /// All bits.
    pub(super) const ALL: u8 = 31;
}

/// The columns of a table, in the order of its rows.
#[derive(Clone, Debug)]
pub(crate) struct Columns {
    pub(crate) ids: Ids,
    /// In the order of paths.
    pub(crate) paths: Texts,
    /// The names that are not those of files.
    pub(crate) names: Texts,
    /// The number of the name of each row, or [`NOT_NAMED`].
    pub(crate) named: Vec<u32>,
    pub(crate) lists: Lists,
    pub(crate) formats: Vec<u32>,
    /// The index in the list plus 1; 0 where there is none. So are rates and messages.
    pub(crate) rigs: Vec<u32>,
    pub(crate) rates: Vec<u32>,
    pub(crate) label_sets: Vec<u32>,
    pub(crate) messages: Vec<u32>,
    /// The number of frames plus 1; 0 where it is unknown.
    pub(crate) frames: Vec<u32>,
    pub(crate) states: Vec<Status>,
    pub(crate) poses: Vec<Option<Slot>>,
    pub(crate) thumbnails: Vec<Option<Slot>>,
    /// Places from -1 to 1; NaN is none.
    pub(crate) map: Vec<[f32; 2]>,
    pub(crate) originals: Vec<Option<Original>>,
    pub(crate) coded: Vec<Coded>,
    /// The row of each place in the order of paths.
    pub(crate) row_of: Vec<u32>,
    /// The place of each row in the order of paths.
    pub(crate) place_of: Vec<u32>,
}

/// The name of a row is that of its file.
pub(crate) const NOT_NAMED: u32 = u32::MAX;

/// The ids of clips: the beginning of a hash, and the number of the clip in its file.
#[derive(Clone, Debug, Default)]
pub(crate) struct Ids {
    /// The first eight digits of the hash.
    pub(crate) digits: Vec<u32>,
    pub(crate) numbers: Vec<u32>,
    /// More digits, where eight are not enough.
    pub(crate) longer: BTreeMap<u32, String>,
}

impl Ids {
    /// Returns the sort key of an id.
    fn key(&self, at: u32) -> (u32, &str, u32) {
        let number = |all: &[u32]| all.get(at as usize).copied().unwrap_or(0);
        let longer = self.longer.get(&at).map_or("", String::as_str);
        (number(&self.digits), longer, number(&self.numbers))
    }

    /// Returns the digits of an id, and the number of its clip.
    pub(crate) fn parts(&self, at: u32) -> (String, u32) {
        let (digits, longer, number) = self.key(at);
        (format!("{digits:08x}{longer}"), number)
    }
}

/// The original of a copy.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Original {
    pub(crate) row: u32,
    pub(crate) is_mirrored: bool,
}

/// A column of numbers in one byte.
#[derive(Clone, Debug)]
pub(crate) struct Coded {
    pub(crate) name: String,
    pub(crate) label: String,
    pub(crate) unit: String,
    pub(crate) help: String,
    /// The value of each code.
    pub(crate) values: Vec<Option<f64>>,
    pub(crate) codes: Vec<u8>,
}

impl Coded {
    /// Returns its values in ascending order, and how many rows have each.
    pub(crate) fn levels(&self) -> Vec<(f64, usize)> {
        let mut counts = [0; 1 << u8::BITS];
        for code in &self.codes {
            counts[usize::from(*code)] += 1;
        }
        let counted = self.values.iter().zip(counts).filter(|(_, count)| *count > 0);
        let mut levels: Vec<(f64, usize)> =
            counted.filter_map(|(value, count)| Some(((*value)?, count))).collect();
        levels.sort_by(|a, b| a.0.total_cmp(&b.0));
        levels
    }
}

/// The distinct values of columns.
#[derive(Clone, Debug)]
pub(crate) struct Lists {
    pub(crate) formats: Vec<String>,
    pub(crate) rigs: Vec<String>,
    pub(crate) rates: Vec<f64>,
    pub(crate) labels: Texts,
    pub(crate) label_sets: Vec<Vec<u32>>,
    pub(crate) messages: Vec<String>,
}

impl Lists {
    /// Checks that rates are positive, and that all labels are there.
    fn check(&self) -> Result<(), CorpusError> {
        let is_rate = |rate: &f64| rate.is_finite() && *rate > 0.0;
        let is_label = |label: &u32| (*label as usize) < self.labels.len();
        let are_labels = self.label_sets.iter().flatten().all(is_label);
        if self.rates.iter().all(is_rate) && are_labels {
            Ok(())
        } else {
            Err(CorpusError::Damaged { what: WHAT })
        }
    }

    /// Returns a frame rate by its number from 1.
    pub(crate) fn rate(&self, number: u32) -> Option<f64> {
        self.rates.get((number as usize).checked_sub(1)?).copied()
    }

    /// Returns a duration, seconds, given the number of frames and 1, and that of the rate.
    pub(crate) fn secs(&self, frames: u32, rate: u32) -> Option<f64> {
        Some(duration_secs(frames.checked_sub(1)?, self.rate(rate)?))
    }
}

/// The states, by their number.
const STATES: [Status; 3] = [Status::Ok, Status::Unplaced, Status::Unreadable];

/// Returns the duration of a clip, seconds.
fn duration_secs(frames: u32, fps: f64) -> f64 {
    f64::from(frames.saturating_sub(1)) / fps
}

/// Returns the number of bytes that the poses of a clip usually have: the file has the difference.
fn usual_poses_bytes(secs: f64) -> usize {
    let steps = (secs * RATE as f64).round().clamp(1.0, MAX_STEPS) as usize;
    poses_bytes(steps / (RATE / POSE_FPS) + 1, USUAL_JOINTS)
}

/// Returns a file's name without its ending.
pub(crate) fn stem(path: &str) -> &str {
    let name = path.rsplit('/').next().unwrap_or(path);
    let name = match name.len().checked_sub(3).and_then(|at| name.split_at_checked(at)) {
        Some((stem, ending)) if ending.eq_ignore_ascii_case(".gz") => stem,
        _ => name,
    };
    match name.rfind('.') {
        Some(at) if at > 0 => &name[..at],
        _ => name,
    }
}
