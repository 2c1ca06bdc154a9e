//! Writing of FBX files: binary, version 7.4.
//!
//! ```text
//! Model (LimbNode)      one for each joint and each end of a bone, below its parent
//! └ NodeAttribute       says that it is a part of a skeleton
//! AnimationStack        one for each clip, a "take"
//! └ AnimationLayer
//!   └ AnimationCurveNode   `Lcl Rotation` of all joints, `Lcl Translation` of those that move
//!     └ AnimationCurve     one for each axis: a key for each frame
//! ```
//!
//! A joint's transform is its translation, then its rotation by Euler angles, X first; there are no
//! pivots and no rotations before or after. Angles go on beyond half a turn, because programs
//! interpolate them one by one.

mod records;
mod scene;
#[cfg(test)]
mod tests;

use crate::bvh::RotationOrder;
use crate::takes::unique_names;
use glam::{Quat, Vec3};
use segue_motion::clip::{Clip, Interpolation, UpAxis, resample};
use segue_motion::skeleton::Skeleton;
use std::borrow::Cow;

/// The length of a second in the unit of time.
const TICKS_PER_SECOND: f64 = 46_186_158_000.0;
/// The centimetres of a metre: the format states its unit in centimetres.
const CM_PER_M: f64 = 100.0;
/// The unit of most programs that write FBX, metres.
const CENTIMETRE: f64 = 0.01;
/// The number of the first object; smaller ones are left to the programs.
const FIRST_ID: i64 = 1_000_000;
/// The number of bytes of a key: its time and its value.
const KEY_BYTES: u64 = 12;
/// The number of bytes that a joint needs at most beside its keys and its name.
const JOINT_BYTES: u64 = 4096;
/// Options of writing an FBX file.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct FbxOptions {
    /// Metres per unit of the file; a centimetre where `None` or not a length.
    pub metres_per_unit: Option<f64>,
    /// The file's up axis; Y where `None`.
    pub up: Option<UpAxis>,
    /// Frames per second; those of each clip where `None` or not accepted by [`resample`].
    pub fps: Option<f64>,
}

/// The reason why clips cannot be written as an FBX file.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error, segue_text::ToMessage)]
pub enum FbxWriteError {
    /// The format stores places in 32 bits.
    #[error(
        "the motion needs more than the 4 GiB that an .fbx file can hold: cut it into parts, or save it at a lower frame rate"
    )]
    TooLarge,
    /// Clips of one file share a skeleton.
    #[error("the joints of `{clip}` are not those of `{first}`: save it in a file of its own")]
    OtherSkeleton {
        /// The name of the clip that does not fit.
        clip: String,
        /// The name of the first clip.
        first: String,
    },
    /// There is nothing to write.
    #[error("there is no clip to save: choose one")]
    NoClips,
}

/// Writes clips of one skeleton as an FBX file, each as a take; where several have one name, those
/// behind the first are numbered. The file has the rest pose of the
/// first one; a joint whose distance from its parent differs in another clip is moved there.
///
/// Joints are bones (`LimbNode`) without rotation at rest; ends of bones are bones of their own
/// (`…_end`). Joints that the clip's source has above the one that carries the body are written
/// again ([`Clip::unfolded`]). The same clips give the same bytes. Read back, positions (metres)
/// are the same to 1e-5, in files of a few hundred metres.
///
/// # Errors
/// [`FbxWriteError`] when the clips are too large for the format or of different skeletons, or when
/// there are none.
pub fn write_fbx(clips: &[&Clip], options: &FbxOptions) -> Result<Vec<u8>, FbxWriteError> {
    let takes: Vec<Cow<'_, Clip>> = clips.iter().map(|clip| prepared(clip, options)).collect();
    let Some(first) = takes.first() else {
        return Err(FbxWriteError::NoClips);
    };
    for take in &takes {
        if !take.skeleton().has_joints_of(first.skeleton()) {
            let [clip, first] = [take, first].map(|clip| clip.name().to_owned());
            return Err(FbxWriteError::OtherSkeleton { clip, first });
        }
    }
    let most: u64 = takes.iter().map(|take| most_bytes(take)).sum();
    if most > u64::from(u32::MAX) {
        return Err(FbxWriteError::TooLarge);
    }
    let unit = options.metres_per_unit.filter(|unit| unit.is_finite() && *unit > 0.0);
    let axes = FileAxes {
        units_per_metre: unit.unwrap_or(CENTIMETRE).recip(),
        up: options.up.unwrap_or_default(),
    };
    let scene = Scene::new(first.skeleton(), &takes, axes);
    scene.write().ok_or(FbxWriteError::TooLarge)
}

/// Returns a clip at the rate and with the joints of the file.
fn prepared<'a>(clip: &'a Clip, options: &FbxOptions) -> Cow<'a, Clip> {
    let resampled = options.fps.and_then(|fps| resample(clip, fps, Interpolation::default()).ok());
    let unfolded = resampled.as_ref().unwrap_or(clip).unfolded();
    unfolded.or(resampled).map_or(Cow::Borrowed(clip), Cow::Owned)
}

/// Returns a bound of the bytes that a take needs.
fn most_bytes(clip: &Clip) -> u64 {
    let joints = clip.skeleton().len() as u64;
    let names: u64 = clip.skeleton().joints().iter().map(|joint| joint.name.len() as u64).sum();
    let keys = (6 * joints).saturating_mul(clip.frames() as u64);
    keys.saturating_mul(KEY_BYTES).saturating_add(joints * JOINT_BYTES + 8 * names)
}

/// The unit and axes of the file.
#[derive(Clone, Copy)]
struct FileAxes {
    units_per_metre: f64,
    up: UpAxis,
}

impl FileAxes {
    /// Returns a direction in the file's axes.
    fn direction(self, v: Vec3) -> Vec3 {
        match self.up {
            UpAxis::Y => v,
            // The inverse of the rotation of the import: −90° about X.
            UpAxis::Z => Vec3::new(v.x, -v.z, v.y),
        }
    }

    /// Returns a position in the file's axes and unit.
    fn position(self, metres: Vec3) -> [f64; 3] {
        self.direction(metres).to_array().map(|value| f64::from(value) * self.units_per_metre)
    }

    fn rotation(self, q: Quat) -> Quat {
        let v = self.direction(Vec3::new(q.x, q.y, q.z));
        Quat::from_xyzw(v.x, v.y, v.z, q.w)
    }
}

/// A model of the file: a joint, or the end of a bone.
struct Model {
    name: String,
    /// The index of the model above.
    parent: Option<usize>,
    place: [f64; 3],
}

/// The curves of one property of one model in one take: a value for each frame and axis, or one
/// for all frames.
struct Channel {
    model: usize,
    /// `Lcl Translation` or `Lcl Rotation`.
    property: &'static str,
    values: [Vec<f32>; 3],
}

/// A clip as a take.
struct Take {
    name: String,
    /// The times of the frames, ticks.
    times: Vec<i64>,
    channels: Vec<Channel>,
}

/// The content of the file.
struct Scene {
    models: Vec<Model>,
    takes: Vec<Take>,
    axes: FileAxes,
    fps: f64,
}

impl Scene {
    fn new(skeleton: &Skeleton, clips: &[Cow<'_, Clip>], axes: FileAxes) -> Self {
        let joints = skeleton.joints();
        let mut models: Vec<Model> = joints
            .iter()
            .map(|joint| Model {
                name: plain(&joint.name),
                parent: joint.parent,
                place: axes.position(joint.offset),
            })
            .collect();
        for (index, joint) in joints.iter().enumerate() {
            if let Some(end) = joint.end_site {
                let name = format!("{}_end", plain(&joint.name));
                models.push(Model { name, parent: Some(index), place: axes.position(end) });
            }
        }
        let names = unique_names(clips.iter().map(|clip| plain(clip.name())));
        let takes = clips.iter().zip(names);
        let takes = takes.map(|(clip, name)| Take::new(name, clip, skeleton, axes)).collect();
        Self { models, takes, axes, fps: clips.first().map_or(30.0, |clip| clip.fps()) }
    }
}

impl Take {
    fn new(name: String, clip: &Clip, rest: &Skeleton, axes: FileAxes) -> Self {
        let frames = clip.frames();
        let ticks = |frame: usize| (frame as f64 / clip.fps() * TICKS_PER_SECOND).round() as i64;
        let mut channels = Vec::new();
        for (joint, own) in clip.skeleton().joints().iter().enumerate() {
            let track = clip.translations().iter().find(|track| track.joint == joint);
            let places = match (joint, track) {
                (0, _) => Some(clip.root_translations()),
                (_, Some(track)) => Some(track.values.as_slice()),
                (_, None) => None,
            };
            let is_elsewhere = rest.joints().get(joint).is_some_and(|at| at.offset != own.offset);
            let held = [own.offset];
            let places = places.or(is_elsewhere.then_some(held.as_slice()));
            if let Some(places) = places {
                let at = |axis: usize| -> Vec<f32> {
                    places.iter().map(|place| axes.position(*place)[axis] as f32).collect()
                };
                channels.push(Channel {
                    model: joint,
                    property: TRANSLATION,
                    values: [0, 1, 2].map(at),
                });
            }
            let mut values = [0, 1, 2].map(|_| Vec::with_capacity(frames));
            // X is applied first, which makes it the innermost one.
            let mut angles = [0.0; 3];
            for frame in 0..frames {
                let turn = axes.rotation(clip.rotations(frame)[joint]);
                angles = RotationOrder::Zyx.angles(turn, angles);
                for (values, angle) in values.iter_mut().zip(angles.iter().rev()) {
                    values.push(angle.to_degrees() as f32);
                }
            }
            channels.push(Channel { model: joint, property: ROTATION, values });
        }
        for values in channels.iter_mut().flat_map(|channel| &mut channel.values) {
            // A value that is held needs no further keys.
            if values.iter().all(|value| Some(value) == values.first()) {
                values.truncate(1);
            }
        }
        let is_held = |channel: &Channel| channel.values.iter().all(|values| values.len() < 2);
        if channels.iter().all(is_held)
            && let Some(Channel { values: [x, ..], .. }) = channels.first_mut()
            && let Some(&place) = x.first()
        {
            // The keys say how long a take is.
            x.resize(frames, place);
        }
        Self { name, times: (0..frames).map(ticks).collect(), channels }
    }

    /// Returns the time of the last frame.
    fn end(&self) -> i64 {
        self.times.last().copied().unwrap_or(0)
    }
}

/// Returns a name without the characters that separate names in the format.
fn plain(name: &str) -> String {
    let name = name.trim();
    let shown = |c: char| if c.is_control() { ' ' } else { c };
    if name.is_empty() { "unnamed".to_owned() } else { name.chars().map(shown).collect() }
}

const TRANSLATION: &str = "Lcl Translation";
const ROTATION: &str = "Lcl Rotation";
const AXES: [&str; 3] = ["d|X", "d|Y", "d|Z"];
