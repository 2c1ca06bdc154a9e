//! Writing of GLB files.

mod file;
mod surface;

pub(super) use file::File;

use super::bones::Bones;
use crate::takes::unique_names;
use glam::{Mat4, Quat, Vec3};
use segue_motion::clip::{Clip, Interpolation, resample};
use segue_motion::skeleton::{Joint, Roles, Skeleton};
use segue_motion::skin::{RigidTransform, SkinnedMesh};
use serde_json::{Value, json};
use std::borrow::Cow;
use surface::{material, primitive, surfaces};

/// The beginning of the generator's name in files that Segue wrote.
pub(super) const GENERATOR: &str = "Segue ";
/// The name of the mesh that Segue generates around a skeleton. A reader that finds it can leave
/// the mesh out, because it generates the same one.
pub(super) const MADE_BODY: &str = "Body";
/// The name of a character's own mesh.
const CHARACTER: &str = "Character";
/// The number of joints that 16-bit indices can address.
const MAX_JOINTS: usize = 1 << 16;

/// Options of writing a `.glb` file.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct GlbOptions {
    /// Frames per second; the clip's own where `None` or not accepted by [`resample`].
    pub fps: Option<f64>,
    /// Whether the file contains the smooth body of [`SkinnedMesh::around_clip`] instead of simple
    /// bones: about half a megabyte.
    #[serde(default)]
    pub smooth: bool,
}

/// The reason why a clip cannot be written as a `.glb` file.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error, segue_text::ToMessage)]
pub enum GlbError {
    /// The format stores sizes in 32 bits.
    #[error(
        "{0} bytes are more than the 4 GiB that a .glb file can hold: cut the motion into parts"
    )]
    TooLarge(u64),
    /// The format stores joint indices of a skin in 16 bits.
    #[error("{0} joints are more than the 65,536 that a .glb file can hold")]
    TooManyJoints(usize),
    /// Clips of one file share a skin.
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

/// Writes a clip as a `.glb` file: a node for each joint and each end site (`…_end`), a skin over
/// all joints with a body, and an animation with the rotations of all joints and the translations
/// of the root and of joints that move. Joints that the clip's source has above the one that
/// carries the body are written again ([`Clip::unfolded`]).
///
/// At rest, joints have no rotation and the root is at its offset. Metres, +Y up. The same clip
/// gives the same bytes. Read back, positions (metres) and rotations (radians) are the same to
/// 1e-5.
///
/// # Errors
/// [`GlbError`] when the clip is too large for the format.
pub fn write_glb(clip: &Clip, options: &GlbOptions) -> Result<Vec<u8>, GlbError> {
    write_clips_glb(&[clip], None, options)
}

/// Writes a motion of a character as a `.glb` file, as [`write_glb`] does, with the character's own
/// mesh. `clip` is on the skeleton that `mesh` is bound to. Each texture of the mesh becomes a
/// material, with its image as it is, and so does each colour, unless there are very many.
///
/// # Errors
/// [`GlbError`] when the clip is too large for the format.
pub fn write_character_glb(
    clip: &Clip,
    mesh: &SkinnedMesh,
    options: &GlbOptions,
) -> Result<Vec<u8>, GlbError> {
    write_clips_glb(&[clip], Some(mesh), options)
}

/// Writes clips of one skeleton as a `.glb` file, as [`write_glb`] does: one skin, and an animation
/// for each clip that has frames. Where several clips have one name, those behind the first are
/// numbered. The file has the rest pose of the first one; a joint whose distance from its parent
/// differs in another clip is moved there. `mesh` is bound to the skeleton of the first clip;
/// `None` for a body that is generated around its joints.
///
/// # Errors
/// [`GlbError`] when the clips are too large for the format or of different skeletons
/// ([`Skeleton::has_joints_of`]), or when there are none.
pub fn write_clips_glb(
    clips: &[&Clip],
    mesh: Option<&SkinnedMesh>,
    options: &GlbOptions,
) -> Result<Vec<u8>, GlbError> {
    let first = *clips.first().ok_or(GlbError::NoClips)?;
    let skeleton = first.skeleton();
    if skeleton.len() > MAX_JOINTS {
        return Err(GlbError::TooManyJoints(skeleton.len()));
    }
    let (mesh, name) = match mesh {
        Some(mesh) => (mesh.clone(), CHARACTER),
        // The body is generated around the joints that carry it, not around those above them in
        // the file.
        None if options.smooth => {
            (SkinnedMesh::around_clip(first, &Roles::detect(skeleton), 1.0), MADE_BODY)
        }
        None => {
            let positions = standing_rest(skeleton);
            (Bones::around(skeleton, &positions).into_mesh(&positions), MADE_BODY)
        }
    };
    let mut file = File::default();
    let unfolded = first.unfolded();
    let rest: &Skeleton = unfolded.as_ref().unwrap_or(first).skeleton();
    let mut root = scene(&mut file, (skeleton, rest), mesh, name)?;
    let names = unique_names(clips.iter().map(|clip| clip.name().to_owned()));
    let mut animations = Vec::new();
    for (clip, name) in clips.iter().zip(names).filter(|(clip, _)| clip.frames() > 0) {
        let resampled =
            options.fps.and_then(|fps| resample(clip, fps, Interpolation::default()).ok());
        let clip: Cow<'_, Clip> = resampled.map_or(Cow::Borrowed(*clip), Cow::Owned);
        let clip: Cow<'_, Clip> = clip.unfolded().map_or(clip, Cow::Owned);
        if !clip.skeleton().has_joints_of(rest) {
            let [clip, first] = [&clip, first].map(|clip| clip.name().to_owned());
            return Err(GlbError::OtherSkeleton { clip, first });
        }
        animations.push(animation(&mut file, &name, &clip, rest));
    }
    if !animations.is_empty() {
        root["animations"] = Value::Array(animations);
    }
    file.finish(root)
}

/// Returns the document without animations: the nodes of a skeleton and a mesh on a skin. `body` is
/// the skeleton that the mesh is bound to, and `rest` the same with the joints above it.
fn scene(
    file: &mut File,
    (body, rest): (&Skeleton, &Skeleton),
    mut mesh: SkinnedMesh,
    name: &str,
) -> Result<Value, GlbError> {
    if rest.len() > MAX_JOINTS {
        return Err(GlbError::TooManyJoints(rest.len()));
    }
    let mut nodes = nodes(rest);
    let body_node = nodes.len();
    nodes.push(json!({ "name": name, "mesh": 0, "skin": 0 }));
    if let Some(above) = body.folded_chain() {
        let mut bind: Vec<RigidTransform> = (standing_rest(rest).iter())
            .map(|&position| RigidTransform { rotation: Quat::IDENTITY, translation: -position })
            .collect();
        for (&file, own) in above.file_index().iter().zip(&mesh.bind) {
            if let Some(bind) = bind.get_mut(file) {
                *bind = *own;
            }
        }
        mesh.rebind(above.file_index(), bind);
    }
    let inverse_bind: Vec<f32> = (mesh.bind.iter())
        .flat_map(|bind| {
            Mat4::from_rotation_translation(bind.rotation, bind.translation).to_cols_array()
        })
        .collect();
    let inverse_bind = file.floats(&inverse_bind, "MAT4", None);
    let (mut primitives, mut materials) = (Vec::new(), Vec::new());
    for surface in surfaces(&mesh) {
        primitives.push(primitive(file, &surface, rest.len(), materials.len()));
        materials.push(material(file, &surface, name, materials.len()));
    }
    Ok(json!({
        "asset": { "version": "2.0", "generator": format!("{GENERATOR}{}", env!("CARGO_PKG_VERSION")) },
        "scene": 0,
        "scenes": [{ "nodes": [0, body_node] }],
        "nodes": nodes,
        "skins": [{ "joints": (0..rest.len()).collect::<Vec<_>>(), "skeleton": 0, "inverseBindMatrices": inverse_bind }],
        "meshes": [{ "name": name, "primitives": primitives }],
        "materials": materials,
    }))
}

/// Returns the positions of the joints at rest, with the root at its offset, metres.
fn standing_rest(skeleton: &Skeleton) -> Vec<Vec3> {
    let root = skeleton.joints().first().map_or(Vec3::ZERO, |root| root.offset);
    skeleton.rest_positions().into_iter().map(|position| position + root).collect()
}

/// Returns a node for each joint, at the joint's index, then one for each end site.
pub(super) fn nodes(skeleton: &Skeleton) -> Vec<Value> {
    let joints = skeleton.joints();
    let mut children: Vec<Vec<usize>> = vec![Vec::new(); joints.len()];
    let mut ends = Vec::new();
    for (index, joint) in joints.iter().enumerate() {
        if let Some(parent) = joint.parent {
            children[parent].push(index);
        }
        if let Some(end) = joint.end_site {
            children[index].push(joints.len() + ends.len());
            ends.push(
                json!({ "name": format!("{}_end", joint.name), "translation": end.to_array() }),
            );
        }
    }
    let node = |(joint, children): (&Joint, Vec<usize>)| {
        let mut node = json!({ "name": joint.name, "translation": joint.offset.to_array() });
        // An empty list is not valid.
        if !children.is_empty() {
            node["children"] = json!(children);
        }
        node
    };
    joints.iter().zip(children).map(node).chain(ends).collect()
}

/// Returns the animation of a clip. Joints are moved to where the clip's skeleton has them, if that
/// is not where `rest`, the skeleton of the file, has them.
pub(super) fn animation(file: &mut File, name: &str, clip: &Clip, rest: &Skeleton) -> Value {
    let mut times: Vec<f32> = Vec::with_capacity(clip.frames());
    for frame in 0..clip.frames() {
        let time = clip.time_of(frame) as f32;
        // Times must increase; late in a very long clip, single precision cannot tell frames apart.
        times.push(times.last().map_or(time, |last| time.max(last.next_up())));
    }
    let ends = (times.first().copied().unwrap_or(0.0), times.last().copied().unwrap_or(0.0));
    let input = file.floats(&times, "SCALAR", Some((&[ends.0], &[ends.1])));
    let (mut samplers, mut channels) = (Vec::new(), Vec::new());
    let mut add = |node: usize, path: &str, output: usize| {
        channels
            .push(json!({ "sampler": samplers.len(), "target": { "node": node, "path": path } }));
        samplers.push(json!({ "input": input, "output": output, "interpolation": "LINEAR" }));
    };
    for joint in 0..clip.skeleton().len() {
        let turns =
            (0..clip.frames()).flat_map(|frame| unit(clip.rotations(frame)[joint]).to_array());
        add(joint, "rotation", file.floats(&turns.collect::<Vec<f32>>(), "VEC4", None));
    }
    let moving = clip.translations().iter().map(|track| (track.joint, track.values.as_slice()));
    for (joint, values) in std::iter::once((0, clip.root_translations())).chain(moving) {
        let values: Vec<f32> = values.iter().flat_map(Vec3::to_array).collect();
        add(joint, "translation", file.floats(&values, "VEC3", None));
    }
    let joints = clip.skeleton().joints().iter().zip(rest.joints()).enumerate().skip(1);
    for (joint, (own, at)) in joints {
        let is_moving = clip.translations().iter().any(|track| track.joint == joint);
        if own.offset != at.offset && !is_moving {
            let values = own.offset.to_array().repeat(clip.frames());
            add(joint, "translation", file.floats(&values, "VEC3", None));
        }
    }
    json!({ "name": name, "channels": channels, "samplers": samplers })
}

/// Returns a quaternion as near to unit length as single precision allows.
fn unit(q: Quat) -> Quat {
    let q = q.as_dquat();
    let length = q.length();
    if length.is_finite() && length > 1e-6 {
        (q * length.recip()).as_quat()
    } else {
        Quat::IDENTITY
    }
}
