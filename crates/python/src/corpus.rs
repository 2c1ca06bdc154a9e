//! Corpora: the record of a file, the gathering of records, and the search.
//!
//! Python drives: it finds files, hands their bytes to [`corpus_record`] on as many workers as
//! there are, keeps the records, and writes the files of a corpus.

use crate::clip::Clip;
use crate::cores::{detached, on_one_core};
use crate::origin::Origin;
use numpy::PyReadonlyArray1;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict};
use segue_corpus::{
    COLUMNS, CorpusError, CorpusRow, FORMAT, FileRecord, Gatherer, Index, Options, Piece, RowTexts,
    Scaling, Slot, StandardBody, decode_poses, process_file, work_key, write_columns,
};
use segue_formats::{ARCHIVE_ENDINGS, ImportOptions, MOTION_ENDINGS};
use segue_motion::clip::Motion;
use segue_session::reading::SkeletonFile;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

fn value_error(error: impl ToString) -> PyErr {
    PyValueError::new_err(error.to_string())
}

/// Names and contents of the skeletons beside a file.
type Beside = Vec<(String, Vec<u8>)>;

fn skeleton_files(beside: &[(String, Vec<u8>)]) -> Vec<SkeletonFile> {
    beside.iter().map(|(name, bytes)| SkeletonFile::new(name, bytes)).collect()
}

/// Returns the endings of motion files, those of archives, and the greatest size of a file, bytes.
#[pyfunction]
pub(crate) fn corpus_endings() -> (Vec<&'static str>, Vec<&'static str>, usize) {
    let most = ImportOptions::default().max_bytes;
    (MOTION_ENDINGS.to_vec(), ARCHIVE_ENDINGS.to_vec(), most)
}

/// Returns the key of a file's record.
#[pyfunction]
pub(crate) fn corpus_key(
    py: Python<'_>,
    name: &str,
    data: &[u8],
    beside: Beside,
    clean: bool,
) -> String {
    detached(py, || work_key(name, data, &skeleton_files(&beside), &Options { clean }))
}

/// Returns the record of a file. It never fails: what goes wrong is a row.
#[pyfunction]
pub(crate) fn corpus_record<'py>(
    py: Python<'py>,
    name: &str,
    data: &[u8],
    beside: Beside,
    clean: bool,
) -> PyResult<Bound<'py, PyBytes>> {
    let made = on_one_core(py, || {
        let process = || process_file(name, data, &skeleton_files(&beside), &Options { clean });
        // A panic on one file must not end the work on the others.
        let record = catch_unwind(AssertUnwindSafe(process))
            .unwrap_or_else(|_| FileRecord::unreadable("reading it has failed: an error of Segue"));
        record.to_bytes()
    });
    Ok(PyBytes::new(py, &made.map_err(value_error)?))
}

/// Returns the record of a file that has no bytes.
#[pyfunction]
pub(crate) fn corpus_failure(py: Python<'_>, message: String) -> PyResult<Bound<'_, PyBytes>> {
    let record = FileRecord::unreadable(message).to_bytes().map_err(value_error)?;
    Ok(PyBytes::new(py, &record))
}

/// Returns poses and thumbnail of every clip of a record.
#[pyfunction]
pub(crate) fn corpus_parts<'py>(
    py: Python<'py>,
    record: &[u8],
) -> PyResult<Vec<(Bound<'py, PyBytes>, Bound<'py, PyBytes>)>> {
    let record = FileRecord::from_bytes(record).map_err(value_error)?;
    let bytes = |part: &[u8]| PyBytes::new(py, part);
    Ok(record.clips.iter().map(|clip| (bytes(&clip.poses), bytes(&clip.thumbnail))).collect())
}

/// Returns the version of the format, and the name of the file with the columns for a page.
#[pyfunction]
pub(crate) fn corpus_format() -> (u32, &'static str) {
    (FORMAT, COLUMNS)
}

/// Returns the columns of the table that are metrics: name, label, unit, help.
#[pyfunction]
pub(crate) fn corpus_columns() -> Vec<[&'static str; 4]> {
    segue_corpus::column_rows()
}

/// Gathers records.
#[pyclass(module = "segue", frozen)]
pub(crate) struct CorpusGatherer {
    gatherer: Mutex<Option<Gatherer>>,
    /// The rows of the corpus, when it is made.
    rows: Mutex<Vec<CorpusRow>>,
}

#[pymethods]
impl CorpusGatherer {
    #[new]
    fn new(clean: bool) -> PyResult<Self> {
        let gatherer = Gatherer::new(Options { clean }).map_err(value_error)?;
        Ok(Self { gatherer: Mutex::new(Some(gatherer)), rows: Mutex::default() })
    }

    /// Adds a record.
    fn add(&self, py: Python<'_>, key: &str, record: &[u8]) -> PyResult<()> {
        detached(py, || {
            let record = FileRecord::from_bytes(record)?;
            match locked(&self.gatherer).as_mut() {
                Some(gatherer) => gatherer.add(key, &record),
                None => Ok(()),
            }
        })
        .map_err(value_error)
    }

    /// Makes the corpus. A gatherer is used up by that.
    fn finish<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let taken = locked(&self.gatherer).take();
        let gatherer = taken.ok_or_else(|| value_error("this corpus is made already"))?;
        let made = detached(py, || gatherer.finish()).map_err(value_error)?;
        let dict = PyDict::new(py);
        let rows =
            made.rows.iter().map(|row| row_as_dict(py, row)).collect::<PyResult<Vec<_>>>()?;
        let pieces = |shards: &[Vec<Piece>]| -> Vec<Vec<(String, usize)>> {
            let of_shard = |own: &Vec<Piece>| {
                own.iter().map(|piece| (piece.key.clone(), piece.clip)).collect()
            };
            shards.iter().map(of_shard).collect()
        };
        dict.set_item("rows", rows)?;
        dict.set_item("poses", pieces(&made.pose_shards))?;
        dict.set_item("thumbnails", pieces(&made.thumbnail_shards))?;
        dict.set_item("centroids", PyBytes::new(py, &made.centroids))?;
        let lists: Vec<_> = made.lists.iter().map(|list| PyBytes::new(py, list)).collect();
        dict.set_item("lists", lists)?;
        dict.set_item("manifest", format!("{:#}\n", made.manifest))?;
        *locked(&self.rows) = made.rows;
        Ok(dict)
    }

    /// Returns the columns for a page, given path, name and labels of each row of the corpus that
    /// was made.
    fn columns<'py>(
        &self,
        py: Python<'py>,
        texts: Vec<(String, String, Vec<String>)>,
    ) -> PyResult<Bound<'py, PyBytes>> {
        let made = detached(py, || {
            let of_row = |(path, name, labels)| RowTexts { path, name, labels };
            let texts: Vec<RowTexts> = texts.into_iter().map(of_row).collect();
            write_columns(&locked(&self.rows), &texts)
        });
        Ok(PyBytes::new(py, &made.map_err(value_error)?))
    }
}

fn locked<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Returns a row of the table by its columns; metrics lie in a dictionary of their own.
fn row_as_dict<'py>(py: Python<'py>, row: &CorpusRow) -> PyResult<Bound<'py, PyDict>> {
    let dict = PyDict::new(py);
    let own = &row.row;
    let status = serde_json::to_value(own.status).map_err(value_error)?;
    dict.set_item("id", &row.id)?;
    dict.set_item("key", &row.key)?;
    dict.set_item("status", status.as_str())?;
    dict.set_item("message", &own.message)?;
    dict.set_item("line", own.line)?;
    dict.set_item("column", own.column)?;
    dict.set_item("inner", &own.inner)?;
    dict.set_item("name", &own.name)?;
    dict.set_item("format", &own.format)?;
    dict.set_item("seconds", own.seconds)?;
    dict.set_item("frames", own.frames)?;
    dict.set_item("fps", own.fps)?;
    dict.set_item("joints", own.joints)?;
    dict.set_item("rig", &own.rig)?;
    dict.set_item("body_parts", own.body_parts)?;
    dict.set_item("height_m", own.height_m)?;
    dict.set_item("mended", own.mended)?;
    dict.set_item("warnings", &own.warnings)?;
    dict.set_item("moments", row.moments)?;
    dict.set_item("map_x", row.map.map(|place| place[0]))?;
    dict.set_item("map_y", row.map.map(|place| place[1]))?;
    dict.set_item("copy_of", &row.copy_of)?;
    dict.set_item("is_mirrored", row.is_mirrored)?;
    let place = |slot: Option<Slot>| slot.map(|slot| (slot.shard, slot.offset, slot.length));
    dict.set_item("poses", place(row.poses))?;
    dict.set_item("thumbnail", place(row.thumbnail))?;
    dict.set_item("metrics", &own.metrics)?;
    Ok(dict)
}

/// Returns the clip of a range of a shard.
#[pyfunction]
pub(crate) fn corpus_clip(py: Python<'_>, name: &str, data: &[u8]) -> PyResult<Clip> {
    let motion = detached(py, || -> Result<Motion, CorpusError> {
        let body = StandardBody::new()?;
        let read = decode_poses(name, data, body.skeleton())?;
        Ok(Motion::with_roles(read.clip, body.roles()).with_contacts(read.contacts))
    });
    let motion = Arc::new(motion.map_err(value_error)?);
    Ok(Clip::new(motion, None, Origin { id: None, files: Vec::new() }, Vec::new()))
}

/// Returns the scaled features of a moment of any clip; `None` if it is too short.
#[pyfunction]
pub(crate) fn corpus_query(
    py: Python<'_>,
    clip: PyRef<'_, Clip>,
    seconds: f64,
    means: Vec<f32>,
    factors: Vec<f32>,
) -> PyResult<Option<Vec<f32>>> {
    let motion = Arc::clone(&clip.motion);
    detached(py, || {
        let scaling = Scaling { means, factors };
        let body = StandardBody::new().map_err(|error| error.to_string())?;
        scaling.check(body.layout()).map_err(|error| error.to_string())?;
        scaling.query(&body, &motion, seconds).map_err(|error| error.to_string())
    })
    .map_err(value_error)
}

/// The centroids of an index, and the places of its lists.
#[pyclass(module = "segue", frozen)]
pub(crate) struct CorpusIndex(Index);

#[pymethods]
impl CorpusIndex {
    #[new]
    fn new(centroids: &[u8]) -> PyResult<Self> {
        Index::read(centroids).map(Self).map_err(value_error)
    }

    /// Returns the lists nearest to a query, each with its file, first byte, and number of bytes.
    fn nearest_lists(
        &self,
        query: PyReadonlyArray1<'_, f32>,
        probes: usize,
    ) -> PyResult<Vec<(usize, usize, usize, usize)>> {
        let query = query.as_slice().map_err(value_error)?;
        let lists = self.0.nearest_lists(query, probes).map_err(value_error)?;
        let with_place = |list| {
            let place = self.0.place(list)?;
            Some((list, place.file, place.offset, place.length))
        };
        Ok(lists.into_iter().filter_map(with_place).collect())
    }

    /// Returns the nearest moments in some lists: row, moment and distance of each; `by_clip`
    /// leaves the nearest of each clip.
    fn search(
        &self,
        query: PyReadonlyArray1<'_, f32>,
        lists: Vec<(usize, Vec<u8>)>,
        count: usize,
        by_clip: bool,
    ) -> PyResult<Vec<(u32, u32, f32)>> {
        let query = query.as_slice().map_err(value_error)?;
        let lists: Vec<(usize, &[u8])> =
            lists.iter().map(|(list, bytes)| (*list, bytes.as_slice())).collect();
        let hits = if by_clip {
            self.0.search_clips(query, &lists, count)
        } else {
            self.0.search(query, &lists, count)
        };
        let hits = hits.map_err(value_error)?;
        Ok(hits.iter().map(|hit| (hit.clip, hit.moment, hit.distance)).collect())
    }

    /// The number of moments.
    #[getter]
    fn moments(&self) -> usize {
        self.0.moments()
    }

    fn __len__(&self) -> usize {
        self.0.lists()
    }
}
