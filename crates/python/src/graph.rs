//! Motion graphs, and the distances that they are built from.

use crate::arrays::{array, fixed_array};
use crate::clip::Clip;
use crate::cores::detached;
use crate::errors::lab_error;
use crate::labs::{LabResult, Recipe, collect, values_of};
use crate::words::lab_of;
use numpy::{PyArray1, PyArray2};
use pyo3::prelude::*;
use rayon::prelude::*;
use segue_batch::Driven;
use segue_motion::graph::{DistanceTile, FrameDistances, FrameSet, GraphOptions, TileComputer};
use segue_session::reading::ReadFile;
use segue_session::{BuiltGraph, Command};
use std::sync::{Arc, Mutex, PoisonError};

/// The memory of intermediate products of one core, bytes.
const PRODUCT_BYTES: usize = 64 << 20;

/// The number of groups of tiles for each core.
const TILE_GROUPS: usize = 4;

/// The most frames of a matrix of distances: 1.6 GB.
const MAX_FRAMES: usize = 20_000;

/// Returns a session of the Graph lab with some clips.
fn graph_recipe(clips: &[PyRef<'_, Clip>], values: &[(String, String)]) -> PyResult<Recipe> {
    let lab = lab_of("graph")?;
    let values = values_of(lab, values)?;
    let clips = clips.iter().map(|clip| clip.origin()).collect();
    Ok(Recipe { lab, link: None, clips, body: None, values })
}

/// Returns the frames of the graph's clips, on one skeleton.
fn frame_set(driven: &mut Driven) -> PyResult<Arc<FrameSet>> {
    loop {
        if let Some(clips) = driven.session.graph_clips() {
            return Ok(Arc::clone(clips.set()));
        }
        if !driven.session.work() {
            let reason = driven.session.first_result().err();
            return Err(lab_error(reason.map_or_else(
                || "these clips have no distances".to_owned(),
                |reason| reason.to_string(),
            )));
        }
    }
}

/// Computes the distances of all windows, tile by tile on all cores.
fn distances_of(set: &Arc<FrameSet>, window: usize) -> PyResult<FrameDistances> {
    let options = GraphOptions { blend_window: window, ..GraphOptions::default() };
    let failed = |error: segue_motion::graph::GraphError| lab_error(error.to_string());
    options.check(set).map_err(failed)?;
    let tiles = DistanceTile::all(set, window);
    // Neighbouring tiles share products, and each computation its points.
    let together = (tiles.len() / (TILE_GROUPS * rayon::current_num_threads().max(1))).max(1);
    let computed: Result<Vec<_>, _> = tiles
        .into_par_iter()
        .with_min_len(together)
        .map_init(
            || TileComputer::new(Arc::clone(set), PRODUCT_BYTES),
            |computer, tile| {
                let computer = computer.as_mut().map_err(|error| error.clone())?;
                let found = computer.compute(&tile, &options)?;
                Ok((tile, found.rms_m))
            },
        )
        .collect();
    Ok(FrameDistances::of_tiles(set, window, computed.map_err(failed)?))
}

/// Returns the matrix of the distances of all windows, with the first frame of each clip in it.
#[pyfunction]
pub(crate) fn distance_matrix<'py>(
    py: Python<'py>,
    clips: Vec<PyRef<'py, Clip>>,
    window: usize,
) -> PyResult<(Bound<'py, PyArray2<f32>>, Vec<usize>)> {
    let recipe = graph_recipe(&clips, &[])?;
    let (values, frames, starts) = detached(py, || {
        let set = frame_set(&mut recipe.driven()?)?;
        let frames = set.frames();
        if frames > MAX_FRAMES {
            return Err(lab_error(format!(
                "a matrix of {frames} × {frames} distances is too large: use up to {MAX_FRAMES} frames, or segue.graph, which needs no matrix"
            )));
        }
        let distances = distances_of(&set, window)?;
        let rows: Vec<Vec<f32>> = (0..frames)
            .into_par_iter()
            .map(|row| distances.picture(row..row + 1, 0..frames, 1))
            .collect();
        let starts = (0..set.clips().len()).scan(0, |next, clip| {
            let start = *next;
            *next += set.frames_of(clip);
            Some(start)
        });
        Ok((rows.concat(), frames, starts.collect::<Vec<usize>>()))
    })?;
    Ok((array(py, values, [frames, frames])?, starts))
}

/// A motion graph of some clips.
#[pyclass(module = "segue", frozen)]
pub(crate) struct Graph {
    driven: Mutex<Driven>,
    built: Arc<BuiltGraph>,
    files: Vec<Arc<ReadFile>>,
}

/// Builds a motion graph.
#[pyfunction]
pub(crate) fn graph(
    py: Python<'_>,
    clips: Vec<PyRef<'_, Clip>>,
    values: Vec<(String, String)>,
) -> PyResult<Graph> {
    let recipe = graph_recipe(&clips, &values)?;
    detached(py, || {
        let mut driven = recipe.driven()?;
        driven.settle();
        let problem = driven.session.first_result().err();
        let built = driven.session.graph_built().cloned();
        let built = built.ok_or_else(|| {
            lab_error(problem.map_or_else(
                || "these clips give no graph".to_owned(),
                |problem| problem.to_string(),
            ))
        })?;
        Ok(Graph { driven: Mutex::new(driven), built, files: recipe.files() })
    })
}

#[pymethods]
impl Graph {
    /// Takes a walk.
    fn walk(&self, py: Python<'_>, values: Vec<(String, String)>) -> PyResult<Py<LabResult>> {
        let values = values_of(lab_of("graph")?, &values)?;
        let made = detached(py, || {
            let mut driven = self.driven.lock().unwrap_or_else(PoisonError::into_inner);
            let set = Command::Set(values);
            driven.session.apply(set).map_err(|error| lab_error(error.to_string()))?;
            driven.settle();
            collect(&driven, &self.files)
        })?;
        let first = made.into_iter().next();
        first.ok_or_else(|| lab_error("there is no walk"))?.into_object(py)
    }

    /// Returns the names of the clips, in their order.
    #[getter]
    fn clips(&self) -> Vec<String> {
        self.built.clips().names().to_vec()
    }

    /// Returns the nodes: clip, first frame, one past the last frame.
    #[getter]
    fn stretches(&self, py: Python<'_>) -> PyResult<Py<PyArray2<i64>>> {
        let graph = self.built.graph().graph();
        let rows: Vec<i64> = graph
            .node_weights()
            .flat_map(|node| [node.clip, node.start, node.end].map(|number| number as i64))
            .collect();
        fixed_array(py, rows, [graph.node_count(), 3])
    }

    /// Returns the transitions: clip and frame that are left, clip and frame that are entered.
    #[getter]
    fn jumps(&self, py: Python<'_>) -> PyResult<Py<PyArray2<i64>>> {
        let jumps = self.built.graph().jumps();
        let rows: Vec<i64> = jumps
            .iter()
            .flat_map(|jump| [jump.leave.clip, jump.leave.frame, jump.enter.clip, jump.enter.frame])
            .map(|number| number as i64)
            .collect();
        fixed_array(py, rows, [jumps.len(), 4])
    }

    /// Returns the distances of the transitions, centimetres.
    #[getter]
    fn jump_distances(&self, py: Python<'_>) -> PyResult<Py<PyArray1<f64>>> {
        let jumps = self.built.graph().jumps();
        fixed_array(py, jumps.iter().map(|jump| jump.distance_cm).collect(), jumps.len())
    }

    fn __repr__(&self) -> String {
        let graph = self.built.graph();
        format!(
            "<segue.Graph of {} clips: {} stretches, {} transitions>",
            self.built.clips().names().len(),
            graph.graph().node_count(),
            graph.jumps().len()
        )
    }
}
