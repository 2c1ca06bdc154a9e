//! The database of motion matching.

use crate::arrays::{array, fixed_array};
use crate::clip::Clip;
use crate::cores::detached;
use crate::errors::lab_error;
use numpy::{PyArray1, PyArray2, PyReadonlyArray2, PyUntypedArrayMethods as _};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::sync::PyOnceLock;
use rayon::prelude::*;
use segue_motion::clip::Motion;
use segue_motion::matching::search::{Hit, Query, scan_nearest};
use segue_motion::matching::{
    Block, Database, DatabaseOptions, FeatureOptions, RATE, TagFilter, Weights,
};
use std::sync::Arc;

/// The frames of clips with their features.
#[pyclass(module = "segue", frozen)]
pub(crate) struct Matches {
    database: Database,
    features: PyOnceLock<Py<PyArray2<f32>>>,
}

/// Builds a database.
#[pyfunction]
#[pyo3(signature = (clips, mirrored, trajectory))]
pub(crate) fn match_database(
    py: Python<'_>,
    clips: Vec<PyRef<'_, Clip>>,
    mirrored: bool,
    trajectory: Option<Vec<f64>>,
) -> PyResult<Matches> {
    let motions: Vec<Arc<Motion>> = clips.iter().map(|clip| Arc::clone(&clip.motion)).collect();
    let features = match trajectory {
        Some(trajectory_secs) => FeatureOptions { trajectory_secs, ..FeatureOptions::default() },
        None => FeatureOptions::default(),
    };
    let options = DatabaseOptions { features, mirrored, ..DatabaseOptions::default() };
    let database = detached(py, || Database::new(motions, &options))
        .map_err(|error| lab_error(error.to_string()))?;
    Ok(Matches { database, features: PyOnceLock::new() })
}

/// Frames and costs of the hits of some queries: clips, frames, mirrored, costs.
type Hits<'py> = (
    Bound<'py, PyArray2<i64>>,
    Bound<'py, PyArray2<i64>>,
    Bound<'py, PyArray2<i64>>,
    Bound<'py, PyArray2<f32>>,
);

#[pymethods]
impl Matches {
    /// Returns the features of all frames, normalised.
    #[getter]
    fn features<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f32>>> {
        let made = self.features.get_or_try_init(py, || {
            let features = self.database.features();
            let rows = (0..features.len()).filter_map(|row| features.row(row)).flatten().copied();
            fixed_array(py, rows.collect(), [features.len(), features.layout().dims()])
        })?;
        Ok(made.bind(py).clone())
    }

    /// Returns the mean of every dimension.
    #[getter]
    fn means(&self, py: Python<'_>) -> PyResult<Py<PyArray1<f32>>> {
        let means = self.database.features().means();
        fixed_array(py, means.to_vec(), means.len())
    }

    /// Returns the scale of every dimension.
    #[getter]
    fn scales(&self, py: Python<'_>) -> PyResult<Py<PyArray1<f32>>> {
        let scales = self.database.features().scales();
        fixed_array(py, scales.to_vec(), scales.len())
    }

    /// Returns for every frame its clip, its frame there, and whether it is mirrored.
    #[getter]
    fn places<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<i64>>> {
        let frames = self.database.frames();
        let rows = (0..frames).flat_map(|frame| self.place(frame)).collect();
        array(py, rows, [frames, 3])
    }

    /// Returns the numbers of the frames that a search may find.
    #[getter]
    fn valid(&self, py: Python<'_>) -> PyResult<Py<PyArray1<i64>>> {
        let valid = self.database.valid();
        fixed_array(py, valid.iter().map(|frame| i64::from(*frame)).collect(), valid.len())
    }

    /// Returns the names of the blocks of dimensions, with their first and one past their last.
    #[getter]
    fn blocks(&self) -> Vec<(String, usize, usize)> {
        let layout = self.database.features().layout();
        let named = |block: Block| {
            let range = layout.range(block);
            (format!("{block:?}"), range.start, range.end)
        };
        Block::ALL.into_iter().map(named).collect()
    }

    /// Returns the frames per second of the database.
    #[classattr]
    const fn fps() -> usize {
        RATE
    }

    fn __len__(&self) -> usize {
        self.database.frames()
    }

    /// Returns rows in their own units, normalised.
    fn normalise<'py>(
        &self,
        py: Python<'py>,
        rows: PyReadonlyArray2<'py, f32>,
    ) -> PyResult<Bound<'py, PyArray2<f32>>> {
        let shape = self.checked(&rows)?;
        let mut values: Vec<f32> = rows.as_array().iter().copied().collect();
        for row in values.chunks_exact_mut(shape[1]) {
            self.database.features().normalise_row(row);
        }
        array(py, values, shape)
    }

    /// Returns the frames nearest to queries of normalised features.
    fn search<'py>(
        &self,
        py: Python<'py>,
        queries: PyReadonlyArray2<'py, f32>,
        k: usize,
        weights: Option<[f32; Block::COUNT]>,
    ) -> PyResult<Hits<'py>> {
        let [count, dims] = self.checked(&queries)?;
        let weights = weights.map_or_else(Weights::default, Weights);
        weights.validate().map_err(|error| lab_error(error.to_string()))?;
        let k = k.min(self.database.valid().len());
        let rows: Vec<f32> = queries.as_array().iter().copied().collect();
        if rows.iter().any(|value| !value.is_finite()) {
            return Err(PyValueError::new_err("queries: expected finite numbers"));
        }
        let hits: Vec<Hit> = detached(py, || {
            let weights = weights.spread(self.database.features().layout());
            let candidates = self.database.candidates();
            let nearest = |row: &[f32]| {
                let query = Query { row, weights: &weights, filter: TagFilter::default() };
                scan_nearest(&candidates, &query, k)
            };
            rows.par_chunks_exact(dims).flat_map_iter(nearest).collect()
        });
        let k = hits.len() / count.max(1);
        let places: Vec<[i64; 3]> = hits.iter().map(|hit| self.place(hit.frame)).collect();
        let column =
            |at: usize| array(py, places.iter().map(|place| place[at]).collect(), [count, k]);
        let costs = array(py, hits.iter().map(|hit| hit.cost).collect(), [count, k])?;
        Ok((column(0)?, column(1)?, column(2)?, costs))
    }
}

impl Matches {
    /// Returns the shape of rows of features.
    fn checked(&self, rows: &PyReadonlyArray2<'_, f32>) -> PyResult<[usize; 2]> {
        let (dims, shape) = (self.database.features().layout().dims(), rows.shape());
        match shape {
            [count, own] if *own == dims => Ok([*count, dims]),
            _ => Err(PyValueError::new_err(format!(
                "queries: found shape {shape:?}, expected (queries, {dims})"
            ))),
        }
    }

    /// Returns the clip of a frame of the database, the frame there, and 1 if it is mirrored.
    fn place(&self, frame: usize) -> [i64; 3] {
        let place = self.database.place(frame);
        let motion = place.and_then(|place| Some((self.database.motion(place.motion)?, place)));
        motion.map_or([-1, -1, 0], |(motion, place)| {
            [motion.source() as i64, place.frame as i64, i64::from(motion.is_mirrored())]
        })
    }
}
