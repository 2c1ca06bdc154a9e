//! Records of files: for each clip its row of the table, poses, thumbnail and features.

use crate::CorpusError;
use crate::bytes::{Reader, f32s, i32s, push_f32s, push_u32};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// The first bytes of a record.
const MARK: [u8; 4] = *b"SGRE";
/// The version of records. It rises with every change of what a file's record contains.
pub(crate) const VERSION: u32 = 1;

/// The state of a row.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Status {
    /// The clip is in the corpus.
    Ok,
    /// The clip was read and measured, and cannot be put on the standard body.
    Unplaced,
    /// The file cannot be read.
    Unreadable,
}

impl Status {
    /// Returns the name in the table.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Ok => "ok",
            Self::Unplaced => "unplaced",
            Self::Unreadable => "unreadable",
        }
    }
}

/// A row of the table: a clip, or a file that cannot be read.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ClipRow {
    /// Its state.
    pub status: Status,
    /// The reason of a state that is not [`Status::Ok`].
    pub message: Option<String>,
    /// The line of a fault, from 1.
    pub line: Option<usize>,
    /// The column of a fault, from 1.
    pub column: Option<usize>,
    /// The path of the file in an archive.
    pub inner: Option<String>,
    /// The name of the clip, where the file has one.
    pub name: Option<String>,
    /// The format of the file.
    pub format: String,
    /// Duration, seconds.
    pub seconds: Option<f64>,
    /// The number of frames in the file.
    pub frames: Option<usize>,
    /// Frames per second in the file.
    pub fps: Option<f64>,
    /// The number of joints.
    pub joints: Option<usize>,
    /// Digits that depend on the names of joints and their parents.
    pub rig: Option<String>,
    /// The number of body parts that were found.
    pub body_parts: Option<usize>,
    /// The height of the body, metres.
    pub height_m: Option<f64>,
    /// The number of faults that were mended.
    pub mended: usize,
    /// The oddities of the file, a sentence each.
    pub warnings: Vec<String>,
    /// The artefacts and other numbers of the clip as it was, by the names of metrics.
    pub metrics: BTreeMap<String, Option<f64>>,
}

impl ClipRow {
    /// Returns the row of a file that cannot be read.
    #[must_use]
    pub fn unreadable(message: impl Into<String>) -> Self {
        Self { message: Some(message.into()), ..Self::of_file(Status::Unreadable) }
    }

    /// Returns a row of which only the state is known.
    pub(crate) fn of_file(status: Status) -> Self {
        Self {
            status,
            message: None,
            line: None,
            column: None,
            inner: None,
            name: None,
            format: String::new(),
            seconds: None,
            frames: None,
            fps: None,
            joints: None,
            rig: None,
            body_parts: None,
            height_m: None,
            mended: 0,
            warnings: Vec::new(),
            metrics: BTreeMap::new(),
        }
    }
}

/// A clip of a record. All but the row is empty if the clip is not in the corpus.
#[derive(Clone, Debug, PartialEq)]
pub struct ClipRecord {
    /// Its row.
    pub row: ClipRow,
    /// Its poses ([`encode_poses`](crate::encode_poses)).
    pub poses: Vec<u8>,
    /// Its thumbnail, a PNG.
    pub thumbnail: Vec<u8>,
    /// Its raw features.
    pub features: Vec<f32>,
    /// The numbers of its [`Signature`](crate::Signature).
    pub signature: Vec<i32>,
}

impl ClipRecord {
    /// Returns the record of a clip that is not in the corpus.
    #[must_use]
    pub fn of_row(row: ClipRow) -> Self {
        let (poses, thumbnail) = (Vec::new(), Vec::new());
        Self { row, poses, thumbnail, features: Vec::new(), signature: Vec::new() }
    }
}

/// The record of a file.
#[derive(Clone, Debug, PartialEq)]
pub struct FileRecord {
    /// Its clips, in the order of the file.
    pub clips: Vec<ClipRecord>,
}

/// The head of a clip's record: its row, and the lengths of what follows.
#[derive(Serialize, Deserialize)]
struct Head<R> {
    row: R,
    poses: usize,
    thumbnail: usize,
    features: usize,
    signature: usize,
}

impl<'a> Head<&'a ClipRow> {
    fn of(clip: &'a ClipRecord) -> Self {
        let ClipRecord { row, poses, thumbnail, features, signature } = clip;
        Self {
            row,
            poses: poses.len(),
            thumbnail: thumbnail.len(),
            features: features.len(),
            signature: signature.len(),
        }
    }
}

impl FileRecord {
    /// Returns the record of a file that cannot be read.
    #[must_use]
    pub fn unreadable(message: impl Into<String>) -> Self {
        Self { clips: vec![ClipRecord::of_row(ClipRow::unreadable(message))] }
    }

    /// Returns the record as bytes: `SGRE`, the version, the length of a JSON text, the text, and
    /// for each clip poses, thumbnail, features and signature.
    ///
    /// # Errors
    /// [`CorpusError::TooLarge`], [`CorpusError::Json`].
    pub fn to_bytes(&self) -> Result<Vec<u8>, CorpusError> {
        let heads: Vec<Head<&ClipRow>> = self.clips.iter().map(Head::of).collect();
        let text = serde_json::to_vec(&heads)?;
        let mut out = MARK.to_vec();
        push_u32(&mut out, VERSION as usize)?;
        push_u32(&mut out, text.len())?;
        out.extend(text);
        for clip in &self.clips {
            out.extend(&clip.poses);
            out.extend(&clip.thumbnail);
            push_f32s(&mut out, clip.features.iter().copied());
            out.extend(clip.signature.iter().flat_map(|number| number.to_le_bytes()));
        }
        Ok(out)
    }

    /// Reads a record.
    ///
    /// # Errors
    /// [`CorpusError`] if these are not the bytes of one record of this version.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, CorpusError> {
        let what = "a record";
        let mut reader = Reader::new(bytes, what);
        reader.mark(MARK)?;
        match reader.u32()? {
            VERSION => {}
            found => return Err(CorpusError::Version { what, found, expected: VERSION }),
        }
        let length = reader.u32()? as usize;
        let heads: Vec<Head<ClipRow>> = serde_json::from_slice(reader.take(length)?)?;
        let mut clips = Vec::new();
        for head in heads {
            clips.push(ClipRecord {
                row: head.row,
                poses: reader.take(head.poses)?.to_vec(),
                thumbnail: reader.take(head.thumbnail)?.to_vec(),
                features: f32s(reader.take_items(head.features, 4)?).collect(),
                signature: i32s(reader.take_items(head.signature, 4)?).collect(),
            });
        }
        reader.end()?;
        Ok(Self { clips })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn record() -> FileRecord {
        let row = ClipRow {
            metrics: [("pose_jump_deg".to_owned(), Some(0.1)), ("slide_cm".to_owned(), None)]
                .into(),
            seconds: Some(1.0 / 3.0),
            ..ClipRow::of_file(Status::Ok)
        };
        let clip = ClipRecord {
            row,
            poses: vec![1, 2, 3],
            thumbnail: vec![4],
            features: vec![0.1, -2.5],
            signature: vec![-1, 7],
        };
        FileRecord { clips: vec![clip, ClipRecord::of_row(ClipRow::unreadable("no"))] }
    }

    #[test]
    fn record_is_read_back() {
        let bytes = record().to_bytes().unwrap();
        assert_eq!(FileRecord::from_bytes(&bytes).unwrap(), record());
    }

    #[test]
    fn record_that_is_damaged_is_refused() {
        let bytes = record().to_bytes().unwrap();
        for end in 0..bytes.len() {
            assert!(FileRecord::from_bytes(&bytes[..end]).is_err(), "{end}");
        }
        assert!(FileRecord::from_bytes(&[bytes.as_slice(), &[0]].concat()).is_err());
        let mut other = bytes;
        other[4] = 9;
        let error = FileRecord::from_bytes(&other).unwrap_err();
        assert!(matches!(error, CorpusError::Version { found: 9, .. }), "{error}");
    }
}
