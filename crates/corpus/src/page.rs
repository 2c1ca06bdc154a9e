//! A corpus as a page reads it: `corpus.json` and `columns.bin` at once, everything else by ranges.
//!
//! The page's scripts fetch bytes; this decodes them and answers queries about the table, the
//! features of a moment and similar moments, as numbers and JSON.

#[cfg(test)]
mod tests;

use crate::manifest::Counts;
use crate::table::Table;
use crate::{
    CorpusError, FEATURE_STEP, FORMAT, Filter, Index, ListPlace, POSE_FPS, PlaceError, Scaling,
    StandardBody, decode_poses,
};
use segue_formats::numpy::{self, write_npz};
use segue_formats::{ImportError, ImportOptions};
use segue_motion::clip::{ClipError, Motion};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Seconds before and after a moment of a file that are put on the body: features depend on less.
const BEFORE_SECS: f64 = 2.0;
const AFTER_SECS: f64 = 4.0;
/// The number of seconds that the features of a moment look ahead.
const AHEAD_SECS: f64 = 1.0;

/// The reason why a page cannot have what it asks for.
#[derive(Debug, thiserror::Error)]
pub enum PageError {
    /// A corpus of an older format.
    #[error("this corpus was built by an older Segue: build it again")]
    Older,
    /// A corpus of a newer format.
    #[error("this corpus was built by a newer Segue: reload the page, or update Segue")]
    Newer,
    /// `corpus.json` does not describe a corpus.
    #[error("corpus.json does not describe a corpus: {0}")]
    Manifest(serde_json::Error),
    /// Text that is no filter.
    #[error("the filter cannot be read: {0}")]
    Filter(serde_json::Error),
    /// A row that the table does not have.
    #[error("row {row} is out of range: the table has {rows} rows")]
    NoRow {
        /// The row.
        row: u32,
        /// The number of rows.
        rows: usize,
    },
    /// A clip without a moment.
    #[error("the clip is too short: the features of a moment look 1 s ahead")]
    TooShort,
    /// A file without a clip.
    #[error("the file has no clip")]
    NoClip,
    /// A search before the centroids are there.
    #[error("index/centroids.bin is not loaded yet")]
    NoIndex,
    /// A search in a list that is not there.
    #[error("list {0} of the index is not loaded yet")]
    NoList(usize),
    /// Bytes of the corpus that cannot be read.
    #[error(transparent)]
    Corpus(#[from] CorpusError),
    /// A motion that cannot be put on the standard body.
    #[error(transparent)]
    Place(#[from] PlaceError),
    /// A file that cannot be read.
    #[error(transparent)]
    Read(#[from] ImportError),
    /// A clip that cannot be cut.
    #[error(transparent)]
    Clip(#[from] ClipError),
}

impl PageError {
    /// Returns the word by which the page's scripts know the sentence in the user's language;
    /// `None` for errors of damaged bytes and of the page itself, which have no sentence of their
    /// own.
    #[must_use]
    pub fn word(&self) -> Option<&'static str> {
        match self {
            Self::Older => Some("olderCorpus"),
            Self::Newer => Some("newerCorpus"),
            Self::TooShort | Self::Place(PlaceError::Empty) => Some("tooShort"),
            Self::NoClip => Some("noMotion"),
            Self::Place(PlaceError::FourLegs) => Some("fourLegs"),
            _ => None,
        }
    }
}

/// The part of `corpus.json` that is read.
#[derive(Debug, Deserialize)]
struct Manifest {
    counts: Counts,
    features: Features,
    index: IndexFacts,
}

#[derive(Debug, Deserialize)]
struct Features {
    scaling: Scaling,
}

#[derive(Debug, Deserialize)]
struct IndexFacts {
    probes: usize,
}

/// The version of the format, which is read first: other versions may have other fields.
#[derive(Deserialize)]
struct Head {
    format: u32,
}

/// A moment that a search has found.
#[derive(Serialize)]
struct Found {
    row: u32,
    seconds: f64,
    distance: f32,
}

/// A corpus in a page.
#[derive(Debug)]
pub struct CorpusPage {
    manifest: Manifest,
    table: Table,
    body: StandardBody,
    index: Option<Index>,
    lists: BTreeMap<usize, Vec<u8>>,
}

impl CorpusPage {
    /// Returns the corpus of a `corpus.json` and its `columns.bin`.
    ///
    /// # Errors
    /// [`PageError::Older`], [`PageError::Newer`] for another format; [`PageError::Manifest`],
    /// [`PageError::Corpus`] if these are not the files of a corpus.
    pub fn new(manifest: &str, columns: &[u8]) -> Result<Self, PageError> {
        let Head { format } = serde_json::from_str(manifest).map_err(PageError::Manifest)?;
        match format {
            FORMAT => {}
            older if older < FORMAT => return Err(PageError::Older),
            _ => return Err(PageError::Newer),
        }
        let manifest: Manifest = serde_json::from_str(manifest).map_err(PageError::Manifest)?;
        let body = StandardBody::new()?;
        manifest.features.scaling.check(body.layout())?;
        let table = Table::read(columns)?;
        let (found, expected) = (table.rows(), manifest.counts.rows);
        if found != expected {
            return Err(
                CorpusError::Mismatch { what: "rows of columns.bin", found, expected }.into()
            );
        }
        Ok(Self { manifest, table, body, index: None, lists: BTreeMap::new() })
    }

    /// Returns the table.
    #[must_use]
    pub fn table(&self) -> &Table {
        &self.table
    }

    /// Returns the counts in `corpus.json`, as JSON.
    ///
    /// # Errors
    /// [`CorpusError::Json`].
    pub fn counts(&self) -> Result<String, PageError> {
        Ok(json_text(&self.manifest.counts)?)
    }

    /// Returns the columns of the table, as JSON.
    ///
    /// # Errors
    /// [`CorpusError::Json`].
    pub fn columns(&self) -> Result<String, PageError> {
        Ok(json_text(&self.table.columns())?)
    }

    /// Returns the rows of a filter, which is JSON, in its order.
    ///
    /// # Errors
    /// [`PageError::Filter`]; [`CorpusError::NoColumn`].
    pub fn select(&self, filter: &str) -> Result<Vec<u32>, PageError> {
        Ok(self.table.select(&filter_of(filter)?)?)
    }

    /// Returns how many of the rows of a filter have which value of a column
    /// ([`Table::histogram`]).
    ///
    /// # Errors
    /// [`PageError::Filter`]; [`CorpusError::NoColumn`].
    pub fn histogram(
        &self,
        column: &str,
        filter: &str,
        bins: usize,
    ) -> Result<Vec<u32>, PageError> {
        Ok(self.table.histogram(column, &filter_of(filter)?, bins)?)
    }

    /// Returns what the table shows of some rows, as JSON.
    ///
    /// # Errors
    /// [`PageError::NoRow`].
    pub fn cells(&self, rows: &[u32]) -> Result<String, PageError> {
        let no_row = |row| PageError::NoRow { row, rows: self.table.rows() };
        let cells: Vec<_> = rows
            .iter()
            .map(|row| self.table.cells(*row).ok_or_else(|| no_row(*row)))
            .collect::<Result<_, _>>()?;
        Ok(json_text(&cells)?)
    }

    /// Takes in `index/centroids.bin`.
    ///
    /// # Errors
    /// [`PageError::Corpus`] if these are not its bytes, or those of other features.
    pub fn set_index(&mut self, centroids: &[u8]) -> Result<(), PageError> {
        let index = Index::read(centroids)?;
        let (found, expected) = (index.dims(), self.body.layout().dims());
        if found != expected {
            return Err(CorpusError::Mismatch { what: "dimensions", found, expected }.into());
        }
        self.index = Some(index);
        self.lists.clear();
        Ok(())
    }

    /// Returns the query of a moment of a clip of the corpus: its scaled features.
    ///
    /// # Errors
    /// [`PageError::TooShort`] for a clip of less than a second; [`PageError::Corpus`] if these are
    /// not the bytes of poses.
    pub fn query_of_poses(&self, poses: &[u8], secs: f64) -> Result<Vec<f32>, PageError> {
        let read = decode_poses("", poses, self.body.skeleton())?;
        let mut row = self.body.moment(&read.clip, secs)?.ok_or(PageError::TooShort)?;
        self.manifest.features.scaling.apply(&mut row);
        Ok(row)
    }

    /// Returns the query of a moment of a motion on any body: the first clip of an NPZ file.
    ///
    /// # Errors
    /// [`PageError::TooShort`] for a clip of less than a second; [`PageError::Read`],
    /// [`PageError::Place`] if the file cannot be read or its clip not be put on the body.
    pub fn query_of_file(
        &self,
        name: &str,
        bytes: &[u8],
        secs: f64,
    ) -> Result<Vec<f32>, PageError> {
        let read = numpy::read(name, bytes, &ImportOptions::default())?;
        let clip = read.clips.into_iter().next().ok_or(PageError::NoClip)?.clip;
        let (frames, fps) = (clip.frames(), clip.fps());
        // The last moment looks ahead to the end of the clip.
        let secs = secs.min(clip.duration_secs() - AHEAD_SECS).max(0.0);
        let at = |secs: f64| ((secs * fps).round().max(0.0) as usize).min(frames);
        let (start, end) = (at(secs - BEFORE_SECS), at(secs + AFTER_SECS));
        let motion = Motion::analyze(clip.crop(start..end)?);
        let query =
            self.manifest.features.scaling.query(&self.body, &motion, secs - start as f64 / fps)?;
        query.ok_or(PageError::TooShort)
    }

    /// Returns the lists that a search reads, and their places, the nearest first. 0 probes are as
    /// many as the corpus asks for.
    ///
    /// # Errors
    /// [`PageError::NoIndex`]; [`PageError::Corpus`] for a query of other dimensions.
    pub fn nearest_lists(
        &self,
        query: &[f32],
        probes: usize,
    ) -> Result<Vec<(usize, ListPlace)>, PageError> {
        let index = self.index.as_ref().ok_or(PageError::NoIndex)?;
        let probes = if probes == 0 { self.manifest.index.probes } else { probes };
        let lists = index.nearest_lists(query, probes)?;
        Ok(lists.into_iter().filter_map(|list| Some((list, index.place(list)?))).collect())
    }

    /// Takes in the bytes of a list, which are kept.
    ///
    /// # Errors
    /// [`PageError::NoIndex`]; [`PageError::Corpus`] if the list has another number of bytes.
    pub fn take_list(&mut self, list: usize, bytes: Vec<u8>) -> Result<(), PageError> {
        let index = self.index.as_ref().ok_or(PageError::NoIndex)?;
        let place = index.place(list).ok_or(PageError::NoList(list))?;
        if bytes.len() != place.length {
            let (found, expected) = (bytes.len(), place.length);
            return Err(CorpusError::Mismatch { what: "bytes of a list", found, expected }.into());
        }
        self.lists.insert(list, bytes);
        Ok(())
    }

    /// Returns the nearest moment of each clip in some lists, as JSON: up to `count`, the nearest
    /// first.
    ///
    /// # Errors
    /// [`PageError::NoIndex`], [`PageError::NoList`]; [`PageError::Corpus`] for a query of other
    /// dimensions.
    pub fn search(
        &self,
        query: &[f32],
        lists: &[usize],
        count: usize,
    ) -> Result<String, PageError> {
        let index = self.index.as_ref().ok_or(PageError::NoIndex)?;
        let bytes = |list: &usize| match self.lists.get(list) {
            Some(bytes) => Ok((*list, bytes.as_slice())),
            None => Err(PageError::NoList(*list)),
        };
        let lists: Vec<(usize, &[u8])> = lists.iter().map(bytes).collect::<Result<_, _>>()?;
        let hits = index.search_clips(query, &lists, count)?;
        let found: Vec<Found> = hits
            .iter()
            .filter(|hit| (hit.clip as usize) < self.table.rows())
            .map(|hit| Found {
                row: hit.clip,
                seconds: f64::from(hit.moment) * FEATURE_STEP as f64 / POSE_FPS as f64,
                distance: hit.distance,
            })
            .collect();
        Ok(json_text(&found)?)
    }

    /// Returns a clip of the corpus, or the part from one time to another, as an NPZ file.
    ///
    /// # Errors
    /// [`PageError::Corpus`] if these are not the bytes of poses.
    pub fn npz(
        &self,
        name: &str,
        poses: &[u8],
        from_secs: Option<f64>,
        to_secs: Option<f64>,
    ) -> Result<Vec<u8>, PageError> {
        let clip = decode_poses(name, poses, self.body.skeleton())?.clip;
        let Some(last) = clip.frames().checked_sub(1) else { return Err(PageError::NoClip) };
        let frame = |secs: f64| (secs * POSE_FPS as f64).round().max(0.0).min(last as f64) as usize;
        let start = from_secs.map_or(0, frame);
        let end = to_secs.map_or(last, frame).max(start);
        Ok(write_npz(&clip.crop(start..end + 1)?))
    }
}

fn filter_of(text: &str) -> Result<Filter, PageError> {
    if text.is_empty() {
        return Ok(Filter::default());
    }
    serde_json::from_str(text).map_err(PageError::Filter)
}

fn json_text(value: &impl Serialize) -> Result<String, CorpusError> {
    Ok(serde_json::to_string(value)?)
}
