//! The gathering of records: shards, copies, scaled features, the index and the table of a corpus.

use crate::index::{self, MomentRows};
use crate::manifest::{Counts, Layout, manifest};
use crate::map;
use crate::pack::{Packer, Piece, Slot};
use crate::signature::MAX_SECS_APART;
use crate::{
    ClipRow, CorpusError, FileRecord, MAX_DISTANCE_CM, Options, Scaling, Signature, StandardBody,
    Status,
};
use serde_json::Value as Json;
use std::collections::BTreeMap;

/// Digits of a key in the ids of clips.
const ID_DIGITS: usize = 16;

/// Gathers records. The order in which they come does not matter.
#[derive(Debug)]
pub struct Gatherer {
    body: StandardBody,
    options: Options,
    records: BTreeMap<String, Vec<GatheredClip>>,
}

/// A clip of a record. Of poses and thumbnail only the numbers of bytes are held.
#[derive(Debug)]
struct GatheredClip {
    row: ClipRow,
    poses: usize,
    thumbnail: usize,
    features: Vec<f32>,
    signature: Option<Signature>,
}

/// A row of the table, with the places of its bytes.
#[derive(Clone, Debug)]
pub struct CorpusRow {
    /// The id of the clip: digits of the key, and the number of the clip in its file.
    pub id: String,
    /// The key of its record.
    pub key: String,
    /// The number of the clip in its record.
    pub clip: usize,
    /// The row of the clip itself.
    pub row: ClipRow,
    /// The place of its poses in the shards.
    pub poses: Option<Slot>,
    /// The place of its thumbnail in the shards of thumbnails.
    pub thumbnail: Option<Slot>,
    /// The number of its moments in the index.
    pub moments: usize,
    /// Its place on the map, x and y from -1 to 1; `None` without moments.
    pub map: Option<[f32; 2]>,
    /// The id of the clip of which it is a copy: an earlier row.
    pub copy_of: Option<String>,
    /// Whether it is a mirrored copy.
    pub is_mirrored: bool,
}

/// A finished corpus. The bytes of its shards are read from the records.
#[derive(Debug)]
pub struct Gathered {
    /// The rows of the table, by key.
    pub rows: Vec<CorpusRow>,
    /// The clips of each shard of poses.
    pub pose_shards: Vec<Vec<Piece>>,
    /// The clips of each shard of thumbnails.
    pub thumbnail_shards: Vec<Vec<Piece>>,
    /// The content of `index/centroids.bin`.
    pub centroids: Vec<u8>,
    /// The contents of `index/lists-00000.bin` and so on.
    pub lists: Vec<Vec<u8>>,
    /// The content of `corpus.json`.
    pub manifest: Json,
}

impl Gatherer {
    /// Returns a gatherer without records. The records must have been made with these options.
    ///
    /// # Errors
    /// [`CorpusError`] if there is no standard body.
    pub fn new(options: Options) -> Result<Self, CorpusError> {
        Ok(Self { body: StandardBody::new()?, options, records: BTreeMap::new() })
    }

    /// Adds the record of a key ([`work_key`](crate::work_key)). A key that is known already is
    /// replaced.
    ///
    /// # Errors
    /// [`CorpusError::Mismatch`] if features or signature have another number of numbers.
    pub fn add(&mut self, key: &str, record: &FileRecord) -> Result<(), CorpusError> {
        let dims = self.body.layout().dims();
        let mut clips = Vec::with_capacity(record.clips.len());
        for clip in &record.clips {
            let found = clip.features.len() % dims;
            if found != 0 {
                return Err(CorpusError::Mismatch { what: "features", found, expected: 0 });
            }
            let signature = Signature::from_numbers(clip.signature.clone());
            if signature.is_none() && !clip.signature.is_empty() {
                let (found, expected) = (clip.signature.len(), Signature::LEN);
                return Err(CorpusError::Mismatch { what: "a signature", found, expected });
            }
            clips.push(GatheredClip {
                row: clip.row.clone(),
                poses: clip.poses.len(),
                thumbnail: clip.thumbnail.len(),
                features: clip.features.clone(),
                signature,
            });
        }
        self.records.insert(key.to_owned(), clips);
        Ok(())
    }

    /// Makes the corpus.
    ///
    /// # Errors
    /// [`CorpusError::TooLarge`].
    pub fn finish(self) -> Result<Gathered, CorpusError> {
        let dims = self.body.layout().dims();
        let (mut poses, mut thumbnails) = (Packer::default(), Packer::default());
        let (mut rows, mut moments, mut signatures) = (Vec::new(), Vec::new(), Vec::new());
        let mut features: Vec<Vec<f32>> = Vec::new();
        for (key, clips) in self.records {
            for (number, clip) in clips.into_iter().enumerate() {
                let piece = || Piece { key: key.clone(), clip: number };
                let count = clip.features.len() / dims;
                moments.push(MomentRows { clip: rows.len(), count });
                features.push(clip.features);
                signatures.push((clip.row.seconds.unwrap_or(0.0), clip.signature));
                rows.push(CorpusRow {
                    id: format!("{}-{number}", key.get(..ID_DIGITS).unwrap_or(&key)),
                    key: key.clone(),
                    clip: number,
                    poses: poses.add(piece(), clip.poses),
                    thumbnail: thumbnails.add(piece(), clip.thumbnail),
                    moments: count,
                    map: None,
                    copy_of: None,
                    is_mirrored: false,
                    row: clip.row,
                });
            }
        }
        for (row, copy) in copies(&signatures).into_iter().enumerate() {
            if let Some((of, is_mirrored)) = copy {
                rows[row].copy_of = Some(rows[of].id.clone());
                rows[row].is_mirrored = is_mirrored;
            }
        }
        let all = features.iter().flat_map(|own| own.chunks_exact(dims));
        let scaling = Scaling::of(self.body.layout(), all);
        let mut scaled = Vec::with_capacity(features.iter().map(Vec::len).sum());
        // One after the other, so that all of them are not in memory twice.
        for own in features {
            scaled.extend(own);
        }
        scaled.chunks_exact_mut(dims).for_each(|row| scaling.apply(row));
        for (row, place) in rows.iter_mut().zip(map::places(&scaled, dims, &moments)) {
            row.map = place;
        }
        let index = index::build(&scaled, dims, &moments)?;
        let (pose_shards, thumbnail_shards) = (poses.finish(), thumbnails.finish());
        let with = |status| rows.iter().filter(|row| row.row.status == status).count();
        let counts = Counts {
            rows: rows.len(),
            clips: with(Status::Ok),
            unplaced: with(Status::Unplaced),
            unreadable: with(Status::Unreadable),
            copies: rows.iter().filter(|row| row.copy_of.is_some()).count(),
            seconds: (rows.iter().filter(|row| row.poses.is_some()))
                .filter_map(|row| row.row.seconds)
                .sum(),
            moments: scaled.len() / dims,
        };
        let layout = Layout {
            lists: index.count,
            probes: index.probes,
            pose_shards: pose_shards.len(),
            thumbnail_shards: thumbnail_shards.len(),
            list_files: index.lists.len(),
        };
        let manifest = manifest(&self.body, &self.options, &scaling, &counts, &layout);
        Ok(Gathered {
            rows,
            pose_shards,
            thumbnail_shards,
            centroids: index.centroids,
            lists: index.lists,
            manifest,
        })
    }
}

/// Returns for each clip, given as its duration and signature, the clip of which it is a copy, and
/// whether it is mirrored.
///
/// A clip is compared with all earlier ones that are no copies themselves, so that a chain of small
/// differences never joins clips that are far apart. Only those of about its duration are looked
/// at, and a pair is left at the first moment in which it differs: O(clips × clips of that
/// duration).
fn copies(clips: &[(f64, Option<Signature>)]) -> Vec<Option<(usize, bool)>> {
    let mut by_duration: Vec<usize> = (0..clips.len()).collect();
    by_duration.sort_by(|a, b| clips[*a].0.total_cmp(&clips[*b].0));
    let mut found = vec![None; clips.len()];
    for row in 0..clips.len() {
        let (secs, Some(own)) = &clips[row] else { continue };
        let mirrored = own.mirrored();
        let from = by_duration.partition_point(|other| clips[*other].0 < secs - MAX_SECS_APART);
        let near = by_duration[from..].iter().take_while(|other| {
            let (other, _) = &clips[**other];
            *other <= secs + MAX_SECS_APART
        });
        let mut best: Option<(f32, usize, bool)> = None;
        for &other in near.filter(|other| **other < row) {
            let Some(signature) = clips[other].1.as_ref().filter(|_| found[other].is_none()) else {
                continue;
            };
            for (candidate, is_mirrored) in [(own, false), (&mirrored, true)] {
                let distance = candidate.distance_cm(signature, MAX_DISTANCE_CM);
                let Some(distance) = distance else { continue };
                let is_better = best.is_none_or(|(least, of, _)| {
                    distance < least || distance == least && other < of
                });
                if is_better {
                    best = Some((distance, other, is_mirrored));
                }
            }
        }
        found[row] = best.map(|(_, of, is_mirrored)| (of, is_mirrored));
    }
    found
}

#[cfg(test)]
mod tests;
