//! Clips: a motion with where it comes from, as arrays.

use crate::arrays::{array, components, fixed_array, wxyz};
use crate::save::SaveOptions;
use numpy::{PyArray1, PyArray2, PyArray3};
use pyo3::prelude::*;
use pyo3::sync::PyOnceLock;
use pyo3::types::PyDict;
use rayon::prelude::*;
use segue_batch::{unit_name, up_name};
use segue_motion::clip::Motion;
use segue_motion::skeleton::{Role, Side, WorldPose};
use segue_motion::skin::Character;
use segue_session::reading::ReadFile;
use std::path::PathBuf;
use std::sync::Arc;

/// The number of frames whose kinematics one core computes at a time.
const FRAMES_PER_PART: usize = 256;

/// The origin of a clip: what a session needs to have it.
#[derive(Clone, Debug, Default)]
pub(crate) struct Origin {
    /// Its id in links; `None` if no link can say it.
    pub(crate) id: Option<String>,
    /// The files that the id names.
    pub(crate) files: Vec<Arc<ReadFile>>,
}

/// A motion on a skeleton.
#[pyclass(module = "segue", frozen, subclass)]
pub(crate) struct Clip {
    pub(crate) motion: Arc<Motion>,
    /// The character whose mesh a GLB file gets.
    pub(crate) character: Option<Arc<Character>>,
    pub(crate) origin: Origin,
    /// What was odd about the file, one sentence each.
    warnings: Vec<String>,
    offsets: PyOnceLock<Py<PyArray2<f32>>>,
    parents: PyOnceLock<Py<PyArray1<i32>>>,
    root: PyOnceLock<Py<PyArray2<f32>>>,
    rotations: PyOnceLock<Py<PyArray3<f32>>>,
}

impl Clip {
    /// Returns a clip.
    pub(crate) fn new(
        motion: Arc<Motion>,
        character: Option<Arc<Character>>,
        origin: Origin,
        warnings: Vec<String>,
    ) -> Self {
        Self {
            motion,
            character,
            origin,
            warnings,
            offsets: PyOnceLock::new(),
            parents: PyOnceLock::new(),
            root: PyOnceLock::new(),
            rotations: PyOnceLock::new(),
        }
    }

    /// Returns the world pose of every frame, converted by `take` into a part of `out` that is
    /// `joints × width` long.
    fn world<T: Send + Copy + Default>(
        &self,
        take: impl Fn(&WorldPose, &mut [T]) + Sync,
    ) -> Vec<T> {
        let clip = self.motion.clip();
        let joints = clip.skeleton().len();
        let mut out = vec![T::default(); clip.frames() * joints];
        let parts = out.par_chunks_mut((FRAMES_PER_PART * joints).max(1)).enumerate();
        parts.for_each(|(part, out)| {
            let mut pose = WorldPose::default();
            for (frame, out) in (part * FRAMES_PER_PART..).zip(out.chunks_mut(joints)) {
                clip.world_pose_into(frame, &mut pose);
                take(&pose, out);
            }
        });
        out
    }
}

#[pymethods]
impl Clip {
    #[getter]
    fn name(&self) -> &str {
        self.motion.clip().name()
    }

    #[getter]
    fn fps(&self) -> f64 {
        self.motion.clip().fps()
    }

    #[getter]
    fn frames(&self) -> usize {
        self.motion.clip().frames()
    }

    #[getter]
    fn duration(&self) -> f64 {
        self.motion.clip().duration_secs()
    }

    #[getter]
    fn names(&self) -> Vec<&str> {
        let joints = self.motion.clip().skeleton().joints();
        joints.iter().map(|joint| joint.name.as_str()).collect()
    }

    #[getter]
    fn parents<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<i32>>> {
        let made = self.parents.get_or_try_init(py, || {
            let joints = self.motion.clip().skeleton().joints();
            let parents =
                joints.iter().map(|joint| joint.parent.map_or(-1, |parent| parent as i32));
            fixed_array(py, parents.collect(), joints.len())
        })?;
        Ok(made.bind(py).clone())
    }

    #[getter]
    fn offsets<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f32>>> {
        let made = self.offsets.get_or_try_init(py, || {
            let joints = self.motion.clip().skeleton().joints();
            let offsets = joints.iter().map(|joint| joint.offset).collect();
            fixed_array(py, components(offsets), [joints.len(), 3])
        })?;
        Ok(made.bind(py).clone())
    }

    #[getter]
    fn root<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f32>>> {
        let made = self.root.get_or_try_init(py, || {
            let root = self.motion.clip().root_translations().to_vec();
            let frames = root.len();
            fixed_array(py, components(root), [frames, 3])
        })?;
        Ok(made.bind(py).clone())
    }

    #[getter]
    fn rotations<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray3<f32>>> {
        let made = self.rotations.get_or_try_init(py, || {
            let clip = self.motion.clip();
            let values =
                py.detach(|| wxyz((0..clip.frames()).flat_map(|frame| clip.rotations(frame))));
            fixed_array(py, values, [clip.frames(), clip.skeleton().len(), 4])
        })?;
        Ok(made.bind(py).clone())
    }

    /// Returns the translations of joints that move in their parents, by their index.
    #[getter]
    fn translations<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let tracks = PyDict::new(py);
        for track in self.motion.clip().translations() {
            let frames = track.values.len();
            tracks.set_item(
                track.joint,
                fixed_array(py, components(track.values.clone()), [frames, 3])?,
            )?;
        }
        Ok(tracks)
    }

    fn global_positions<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray3<f32>>> {
        let clip = self.motion.clip();
        let positions = py.detach(|| self.world(|pose, out| out.copy_from_slice(&pose.positions)));
        array(py, components(positions), [clip.frames(), clip.skeleton().len(), 3])
    }

    fn global_rotations<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray3<f32>>> {
        let clip = self.motion.clip();
        let rotations =
            py.detach(|| wxyz(self.world(|pose, out| out.copy_from_slice(&pose.rotations)).iter()));
        array(py, rotations, [clip.frames(), clip.skeleton().len(), 4])
    }

    /// Returns the names of the joints that have a function in the body, by that function.
    #[getter]
    fn roles<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let roles = PyDict::new(py);
        let joints = self.motion.clip().skeleton().joints();
        for role in Role::ALL {
            let joint = self.motion.roles().get(role).and_then(|joint| joints.get(joint));
            if let Some(joint) = joint {
                roles.set_item(role.name(), &joint.name)?;
            }
        }
        Ok(roles)
    }

    fn contacts<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<bool>>> {
        let frames = self.motion.clip().frames();
        let planted = py.detach(|| {
            let contacts = self.motion.contacts();
            let of_frame = |frame: usize| Side::BOTH.map(|side| contacts.planted(side, frame));
            (0..frames).flat_map(of_frame).collect::<Vec<bool>>()
        });
        array(py, planted, [frames, 2])
    }

    #[getter]
    fn body_height(&self) -> f32 {
        self.motion.body_height()
    }

    #[getter]
    fn has_mesh(&self) -> bool {
        self.character.is_some()
    }

    #[getter]
    fn unit(&self) -> String {
        unit_name(self.motion.clip().provenance().metres_per_unit)
    }

    #[getter]
    fn up(&self) -> &'static str {
        up_name(self.motion.clip().provenance().up)
    }

    #[getter]
    fn id(&self) -> Option<&str> {
        self.origin.id.as_deref()
    }

    #[getter]
    fn warnings(&self) -> Vec<String> {
        self.warnings.clone()
    }

    #[pyo3(signature = (path, *, format=None, unit=None, up=None, fps=None, root=None, body=None))]
    #[expect(clippy::too_many_arguments, reason = "keywords in Python")]
    fn save(
        &self,
        py: Python<'_>,
        path: PathBuf,
        format: Option<String>,
        unit: Option<Bound<'_, PyAny>>,
        up: Option<String>,
        fps: Option<f64>,
        root: Option<String>,
        body: Option<String>,
    ) -> PyResult<PathBuf> {
        let options = SaveOptions { format, unit, up, fps, root, body }.read(Some(&path))?;
        let bytes = py.detach(|| crate::save::bytes_of(self, &options))?;
        py.detach(|| std::fs::write(&path, bytes))?;
        Ok(path)
    }

    #[pyo3(signature = (format, *, unit=None, up=None, fps=None, root=None, body=None))]
    #[expect(clippy::too_many_arguments, reason = "keywords in Python")]
    fn to_bytes(
        &self,
        py: Python<'_>,
        format: String,
        unit: Option<Bound<'_, PyAny>>,
        up: Option<String>,
        fps: Option<f64>,
        root: Option<String>,
        body: Option<String>,
    ) -> PyResult<Vec<u8>> {
        let options = SaveOptions { format: Some(format), unit, up, fps, root, body }.read(None)?;
        py.detach(|| crate::save::bytes_of(self, &options))
    }

    fn __len__(&self) -> usize {
        self.motion.clip().frames()
    }

    fn __repr__(&self) -> String {
        let clip = self.motion.clip();
        format!(
            "<segue.Clip {:?}: {} frames at {} fps, {} joints>",
            clip.name(),
            clip.frames(),
            clip.fps(),
            clip.skeleton().len()
        )
    }
}
