//! Clips: a motion with where it comes from, as arrays.

use crate::arrays::{
    array, components, expect_shape, fixed_array, unit_quaternions, vectors, wxyz,
};
use crate::cores::detached;
use crate::errors::{read_error, unusable, write_error};
use crate::origin::{Origin, Source, SourceFile};
use crate::save::{SaveOptions, bytes_of};
use glam::{Quat, Vec3};
use numpy::{
    PyArray1, PyArray2, PyArray3, PyReadonlyArray2, PyReadonlyArray3, PyUntypedArrayMethods as _,
};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::sync::PyOnceLock;
use pyo3::types::{PyBytes, PyDict};
use rayon::prelude::*;
use segue_batch::{unit_name, up_name};
use segue_formats::ImportOptions;
use segue_formats::numpy::write_npz;
use segue_motion::clip::Motion;
use segue_motion::skeleton::{Joint, Role, Skeleton, WorldPose};
use segue_motion::skin::Character;
use segue_session::reading::{ReadFile, ReadReport, ReadSetup, read};
use std::path::PathBuf;
use std::sync::Arc;

/// The number of frames whose kinematics one core computes at a time.
const FRAMES_PER_PART: usize = 256;

/// The least number of rotations that one core converts at a time.
const ROTATIONS_PER_PART: usize = 1 << 13;

/// The clips of a file, or the reason why there are none.
pub(crate) type Loaded = Result<Vec<Clip>, PyErr>;

/// A motion on a skeleton: rotations of joints, and the way of the first joint, frame by frame.
///
/// Units are metres and seconds. The world is right-handed with Y up; quaternions are in the order
/// w x y z. Arrays of attributes are read-only, and made once; `copy()` them to change them.
#[pyclass(module = "segue", frozen, subclass)]
pub(crate) struct Clip {
    pub(crate) motion: Arc<Motion>,
    /// The character whose mesh a GLB file gets.
    pub(crate) character: Option<Arc<Character>>,
    source: Source,
    /// The warnings of the reader, one sentence each.
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
        Self::of_source(motion, character, Source::Known(origin), warnings)
    }

    fn of_source(
        motion: Arc<Motion>,
        character: Option<Arc<Character>>,
        source: Source,
        warnings: Vec<String>,
    ) -> Self {
        Self {
            motion,
            character,
            source,
            warnings,
            offsets: PyOnceLock::new(),
            parents: PyOnceLock::new(),
            root: PyOnceLock::new(),
            rotations: PyOnceLock::new(),
        }
    }

    /// Returns the origin of the clip.
    pub(crate) fn origin(&self) -> Origin {
        self.source.origin()
    }

    /// Returns `N` components of each joint in each frame, by a function that sets those of one
    /// frame, with a buffer for it. All cores compute.
    fn by_frame<B: Default, const N: usize>(
        &self,
        set: impl Fn(&segue_motion::clip::Clip, usize, &mut B, &mut [[f32; N]]) + Sync,
    ) -> Vec<f32> {
        let clip = self.motion.clip();
        let joints = clip.skeleton().len();
        let mut out = vec![[0.0; N]; clip.frames() * joints];
        let parts = out.par_chunks_mut((FRAMES_PER_PART * joints).max(1)).enumerate();
        parts.for_each(|(part, out)| {
            let mut buffer = B::default();
            for (frame, out) in (part * FRAMES_PER_PART..).zip(out.chunks_mut(joints)) {
                set(clip, frame, &mut buffer, out);
            }
        });
        out.into_flattened()
    }

    /// Returns the rotation of each joint in its parent in each frame.
    fn rotations_by(&self, components: impl Fn(&Quat) -> [f32; 4] + Sync + Send) -> Vec<f32> {
        let rotations = self.motion.clip().all_rotations().par_iter();
        let of_all: Vec<[f32; 4]> =
            rotations.with_min_len(ROTATIONS_PER_PART).map(components).collect();
        of_all.into_flattened()
    }
}

/// Sets the components of some values.
fn set_each<T, const N: usize>(
    out: &mut [[f32; N]],
    values: &[T],
    components: impl Fn(&T) -> [f32; N],
) {
    out.iter_mut().zip(values).for_each(|(out, value)| *out = components(value));
}

impl Clip {
    /// Returns the clip of an NPZ file that is in memory alone, and holds this clip: links name it
    /// by that file, and `save` writes the same.
    fn of_npz(clip: &segue_motion::clip::Clip) -> PyResult<Self> {
        let name = format!("{}.npz", clip.name());
        let mut clips = Self::read_all(&name, &write_npz(clip), ImportOptions::default())?;
        clips.pop().ok_or_else(|| write_error("it has no frames"))
    }

    /// Reads the clips of a file from memory.
    pub(crate) fn read_all(name: &str, bytes: &[u8], options: ImportOptions) -> Loaded {
        let setup = ReadSetup { options, ..ReadSetup::default() };
        let report = read(name, bytes, &setup, &mut |_| true).unwrap_or_default();
        Self::of_report(name, report, None)
    }

    /// Returns the clips of a report; an archive's clips in its order. `unhashed` are the bytes of
    /// a file whose SHA-256 is not known.
    pub(crate) fn of_report(
        name: &str,
        report: ReadReport,
        mut unhashed: Option<Vec<u8>>,
    ) -> Loaded {
        let mut clips = Vec::new();
        for file in report.files {
            match &file.result {
                Err(error) => return Err(read_error(error)),
                Ok(read) if read.awaits_skeleton => {
                    let how = "put it beside, or name it by skeleton=";
                    let reason =
                        format!("{}: it needs its skeleton, an ASF file: {how}", file.name);
                    return Err(unusable(&file.name, reason));
                }
                Ok(_) => {
                    let bytes = unhashed.take_if(|_| file.sha256.is_empty());
                    clips.extend(Self::of_file(file, bytes));
                }
            }
        }
        if clips.is_empty() {
            return Err(unusable(name, format!("{name}: it has no motion")));
        }
        Ok(clips)
    }

    /// Returns the clips of a file that was read, which has these bytes if its SHA-256 is not
    /// known.
    fn of_file(mut file: ReadFile, unhashed: Option<Vec<u8>>) -> Vec<Self> {
        file.unpacked = None;
        let file = match unhashed {
            Some(bytes) => SourceFile::of_bytes(file, bytes),
            None => Arc::new(SourceFile::hashed(file)),
        };
        let Ok(read) = &file.read().result else {
            return Vec::new();
        };
        let warnings: Vec<String> = read.warnings.iter().map(ToString::to_string).collect();
        let clips = read.clips.iter().enumerate().map(|(index, own)| {
            let character = own.mesh.as_ref().map(|mesh| {
                Arc::new(Character {
                    skeleton: own.motion.clip().skeleton().clone(),
                    roles: own.motion.roles().clone(),
                    mesh: mesh.clone(),
                })
            });
            let source = Source::File(Arc::clone(&file), index);
            Self::of_source(Arc::new(own.motion.clone()), character, source, warnings.clone())
        });
        clips.collect()
    }
}

#[pymethods]
impl Clip {
    /// The name of the clip.
    #[getter]
    fn name(&self) -> &str {
        self.motion.clip().name()
    }

    /// Frames per second.
    #[getter]
    fn fps(&self) -> f64 {
        self.motion.clip().fps()
    }

    /// The number of frames; `len(clip)` is the same.
    #[getter]
    fn frames(&self) -> usize {
        self.motion.clip().frames()
    }

    /// The time from the first frame to the last, seconds.
    #[getter]
    fn duration(&self) -> f64 {
        self.motion.clip().duration_secs()
    }

    /// The names of the joints, parents before children. Joints of the file above the hips are
    /// folded into the first one.
    #[getter]
    fn names(&self) -> Vec<&str> {
        let joints = self.motion.clip().skeleton().joints();
        joints.iter().map(|joint| joint.name.as_str()).collect()
    }

    /// The index of each joint's parent, -1 for the first: int32, shape (joints,).
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

    /// The place of each joint in its parent at rest, metres: float32, shape (joints, 3).
    #[getter]
    fn offsets<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f32>>> {
        let made = self.offsets.get_or_try_init(py, || {
            let joints = self.motion.clip().skeleton().joints();
            let offsets = joints.iter().map(|joint| joint.offset).collect();
            fixed_array(py, components(offsets), [joints.len(), 3])
        })?;
        Ok(made.bind(py).clone())
    }

    /// The place of the first joint in the world, metres, Y up: float32, shape (frames, 3).
    #[getter]
    fn root<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f32>>> {
        let made = self.root.get_or_try_init(py, || {
            let root = self.motion.clip().root_translations().to_vec();
            let frames = root.len();
            fixed_array(py, components(root), [frames, 3])
        })?;
        Ok(made.bind(py).clone())
    }

    /// The rotation of each joint in its parent, quaternions w x y z: float32, shape (frames,
    /// joints, 4).
    #[getter]
    fn rotations<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray3<f32>>> {
        let made = self.rotations.get_or_try_init(py, || {
            let clip = self.motion.clip();
            let values = detached(py, || self.rotations_by(wxyz));
            fixed_array(py, values, [clip.frames(), clip.skeleton().len(), 4])
        })?;
        Ok(made.bind(py).clone())
    }

    /// The places of joints that move in their parents, by the joint's index: a dictionary of
    /// float32, shape (frames, 3), metres. All other joints stay at their offsets.
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

    /// Return the places of all joints in the world.
    ///
    /// Returns
    /// -------
    /// ndarray of float32, shape (frames, joints, 3)
    ///     Metres, Y up. Computed on all cores, without the interpreter's lock.
    fn global_positions<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray3<f32>>> {
        let clip = self.motion.clip();
        let positions = detached(py, || {
            self.by_frame(|clip, frame, pose: &mut WorldPose, out| {
                clip.world_pose_into(frame, pose);
                set_each(out, &pose.positions, Vec3::to_array);
            })
        });
        array(py, positions, [clip.frames(), clip.skeleton().len(), 3])
    }

    /// Return the rotations of all joints in the world.
    ///
    /// Returns
    /// -------
    /// ndarray of float32, shape (frames, joints, 4)
    ///     Quaternions w x y z.
    fn global_rotations<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray3<f32>>> {
        let clip = self.motion.clip();
        let rotations = detached(py, || {
            self.by_frame(|clip, frame, pose: &mut WorldPose, out| {
                clip.world_pose_into(frame, pose);
                set_each(out, &pose.rotations, wxyz);
            })
        });
        array(py, rotations, [clip.frames(), clip.skeleton().len(), 4])
    }

    /// The names of the joints that have a function in the body, by that function: "hips", "spine",
    /// "head", "left thigh", "left shin", "left foot" and so on.
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

    /// Return the frames in which each foot is on the ground.
    ///
    /// Returns
    /// -------
    /// ndarray of bool, shape (frames, 2) or (frames, 4)
    ///     Left foot, right foot; of a body on four legs the hind feet, then the left and the right
    ///     forefoot.
    fn contacts<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<bool>>> {
        let frames = self.motion.clip().frames();
        let (planted, feet) = detached(py, || {
            let contacts = self.motion.contacts();
            let feet = contacts.feet();
            let of_frame = |frame: usize| feet.iter().map(move |foot| (*foot, frame));
            let planted = (0..frames).flat_map(of_frame);
            let planted = planted.map(|(foot, frame)| contacts.planted(foot, frame));
            (planted.collect::<Vec<bool>>(), feet.len())
        });
        array(py, planted, [frames, feet])
    }

    /// The height of the body at rest, metres.
    #[getter]
    fn body_height(&self) -> f32 {
        self.motion.body_height()
    }

    /// Whether its file has a mesh on its skeleton.
    #[getter]
    fn has_mesh(&self) -> bool {
        self.character.is_some()
    }

    /// The unit of length of its file: "mm", "cm", "m", "in", "ft", or metres per unit.
    #[getter]
    fn unit(&self) -> String {
        unit_name(self.motion.clip().provenance().metres_per_unit)
    }

    /// The up axis of its file: "y" or "z".
    #[getter]
    fn up(&self) -> &'static str {
        up_name(self.motion.clip().provenance().up)
    }

    /// The name of the clip in links; None where no link can say how it was made.
    #[getter]
    fn id(&self, py: Python<'_>) -> Option<String> {
        detached(py, || self.origin().id)
    }

    /// The warnings of the reader, one sentence each.
    #[getter]
    fn warnings(&self) -> Vec<String> {
        self.warnings.clone()
    }

    /// Write the clip as a file.
    ///
    /// Parameters
    /// ----------
    /// path : path
    ///     Its ending says the format, if nothing else does.
    /// format : {"bvh", "fbx", "glb", "vrma", "npz", "csv", "g1"}, optional
    /// unit : {"mm", "cm", "m", "in", "ft"} or float, optional
    ///     The unit of length in BVH and FBX, or metres per unit. That of the clip's file where it
    ///     is not given, centimetres in FBX.
    /// up : {"y", "z"}, optional
    ///     The up axis in BVH and FBX. That of the clip's file where it is not given, Y in FBX.
    /// fps : float, optional
    ///     Frames per second; the motion is interpolated.
    /// root : {"as-is", "ground", "in-place"}, optional
    ///     Which joint has the motion over the ground: that of the file, a root bone on the ground,
    ///     or none.
    /// body : {"character", "plain"}, optional
    ///     The mesh in a GLB file: that of the clip's own file, or a plain body.
    ///
    /// Returns
    /// -------
    /// pathlib.Path
    ///     The path.
    ///
    /// Raises
    /// ------
    /// `WriteError`
    ///     The format cannot hold the motion.
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
        let bytes = detached(py, || bytes_of(&self.motion, self.character.as_deref(), &options))?;
        detached(py, || std::fs::write(&path, bytes))?;
        Ok(path)
    }

    /// Return the bytes of the file that `save` writes.
    ///
    /// Parameters
    /// ----------
    /// format : {"bvh", "fbx", "glb", "vrma", "npz", "csv", "g1"}
    /// unit, up, fps, root, body
    ///     As in `save`.
    ///
    /// Returns
    /// -------
    /// bytes
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
    ) -> PyResult<Py<PyBytes>> {
        let options = SaveOptions { format: Some(format), unit, up, fps, root, body }.read(None)?;
        let bytes = detached(py, || bytes_of(&self.motion, self.character.as_deref(), &options))?;
        Ok(PyBytes::new(py, &bytes).unbind())
    }

    /// Return the rotations as those of `SciPy`.
    ///
    /// Returns
    /// -------
    /// scipy.spatial.transform.Rotation
    ///     frames × joints rotations in the parent, one after the other: those of frame f are
    ///     `[f * joints : (f + 1) * joints]`.
    fn as_scipy<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let clip = self.motion.clip();
        let count = clip.frames() * clip.skeleton().len();
        let quats = array(py, detached(py, || self.rotations_by(Quat::to_array)), [count, 4])?;
        let class = py.import("scipy.spatial.transform")?.getattr("Rotation")?;
        class.call_method1("from_quat", (quats,))
    }

    /// Return the clip as that of an NPZ file, which links name in place of how it was made.
    ///
    /// Parameters
    /// ----------
    /// name : str, optional
    ///     The file's name without its ending. That of the clip where none is given.
    ///
    /// Returns
    /// -------
    /// Clip
    ///     The same motion. Its link names the file that `save(f"{name}.npz")` writes.
    #[pyo3(signature = (name=None))]
    fn as_file(&self, py: Python<'_>, name: Option<String>) -> PyResult<Self> {
        let name = name.unwrap_or_else(|| self.motion.clip().name().to_owned());
        detached(py, || Self::of_npz(&self.motion.clip().as_ref().clone().with_name(name)))
    }

    /// Return a clip of arrays; see `segue.from_arrays`.
    #[staticmethod]
    #[pyo3(name = "_of_arrays", signature = (names, parents, offsets, rotations, root, fps, name))]
    fn of_arrays(
        names: Vec<String>,
        parents: Vec<i64>,
        offsets: PyReadonlyArray2<'_, f32>,
        rotations: PyReadonlyArray3<'_, f32>,
        root: PyReadonlyArray2<'_, f32>,
        fps: f64,
        name: &str,
    ) -> PyResult<Self> {
        let joints = names.len();
        let frames = root.shape().first().copied().unwrap_or_default();
        expect_shape("parents", &[parents.len()], &[joints])?;
        expect_shape("offsets", offsets.shape(), &[joints, 3])?;
        expect_shape("root", root.shape(), &[frames, 3])?;
        expect_shape("rotations", rotations.shape(), &[frames, joints, 4])?;
        let offsets = vectors("offsets", offsets.as_array().iter().copied())?;
        let root = vectors("root", root.as_array().iter().copied())?;
        let rotations = unit_quaternions(rotations.as_array().iter().copied())?;
        let joints = names.into_iter().zip(parents).zip(offsets).map(|((name, parent), offset)| {
            let parent = usize::try_from(parent).ok();
            Joint { name, parent, offset, end_site: None, channels: Vec::new() }
        });
        let invalid = |reason: String| PyValueError::new_err(reason);
        let skeleton = Skeleton::new(joints.collect()).map_err(|no| invalid(no.to_string()))?;
        let clip = segue_motion::clip::Clip::new(name, Arc::new(skeleton), fps, rotations, root);
        Self::of_npz(&clip.map_err(|no| invalid(no.to_string()))?)
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
