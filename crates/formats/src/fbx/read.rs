//! Reading of FBX files.

use super::joints::{moving, rest_nodes, skeletons};
use super::mesh::mesh;
use super::sample::Sampler;
use super::texture::{PaintedMesh, Textures};
use super::timing::frames;
use crate::gltf::characters::{Character, characters};
use crate::gltf::node::Nodes;
use crate::gltf::rate::Rate;
use crate::gltf::read::folded;
use crate::gltf::skin::MAX_VERTICES;
use crate::measure::{Measure, measure};
use crate::raw::{RawMotion, Y_UP_FROM_Z_UP};
use crate::t_pose::first_frame_is_t_pose;
use crate::warning::{Tally, WarningKind};
use crate::{ImportError, ImportOptions, ImportedClip, ImportedFile, Resolve, check_size, stem};
use glam::{DQuat, Quat, Vec3};
use segue_fbx::{Movement, OpenError, OpenOptions, Scene, is_fbx};
use segue_motion::clip::{Provenance, UpAxis};
use segue_motion::skin::SkinnedMesh;
use segue_text::{Message, ToMessage, msg};
use std::sync::Arc;

/// The memory that a file's content may take, as a multiple of its size: compressed keys unfold.
const MEMORY_RATIO: usize = 32;
/// The memory that the content of a file may take whatever its size, bytes.
const MIN_MEMORY: usize = 64 << 20;
/// The size of a file as a multiple of the memory that its keys may take at once.
const KEY_MEMORY_SHARE: usize = 3;
/// The memory that the keys of a file may take at once whatever its size, bytes.
const MIN_KEY_MEMORY: usize = 4 << 20;
/// Heights of a body with which the unit of a file is believed, metres: from a mouse to a giant.
const BELIEVED_METRES: std::ops::Range<f64> = 0.05..20.0;

/// Reads an FBX file: one clip for each take of each character, in metres and Y up. A character
/// without motion is a clip of one frame, its rest pose.
///
/// `name` is the file's name: for errors, and for the clip of a file with one take. A take is
/// sampled at the file's frame rate, or at that of its keys where they lie between its frames;
/// `options.fps` overrides both and does not change the duration. Keys outside of the span of their
/// take are left out.
///
/// Images of textures are those in the file. [`read_with_progress`] also reads those beside it.
///
/// # Errors
/// [`ImportError`] when the file is not FBX, is truncated or broken, contains neither a
/// skeleton nor an animation, or needs more memory than `options.max_bytes`.
pub fn read(
    name: &str,
    bytes: &[u8],
    options: &ImportOptions,
) -> Result<ImportedFile, ImportError> {
    Ok(read_with_progress(name, bytes, &|_| None, options, &mut |_| true)?.unwrap_or_default())
}

/// Reads an FBX file as [`read`] does, reports the bytes read so far, and stops with `None` when
/// `progress` returns `false`.
///
/// `resolve` returns the bytes of a file beside this one, an image, by its path: the one in the
/// file, with `/` between folders, and then others under which programs look for it.
///
/// # Errors
/// The same as for [`read`].
pub fn read_with_progress(
    name: &str,
    bytes: &[u8],
    resolve: Resolve<'_>,
    options: &ImportOptions,
    progress: &mut dyn FnMut(usize) -> bool,
) -> Result<Option<ImportedFile>, ImportError> {
    check_size(name, bytes, options)?;
    let mut scene = match Scene::open(bytes, limits(bytes.len(), options), progress) {
        Ok(scene) => scene,
        Err(OpenError::Stopped) => return Ok(None),
        // Too short for the head of a file, so that it seems cut off.
        Err(OpenError::Truncated) if !is_fbx(bytes) => {
            return Err(refusal(name, &OpenError::NotFbx));
        }
        Err(error) => return Err(refusal(name, &error)),
    };
    // Returns whether to go on.
    let mut drop_meshes = |scene: &mut Scene<'_>| match scene.drop_meshes(progress) {
        Ok(()) => Ok(true),
        Err(OpenError::Stopped) => Ok(false),
        Err(error) => Err(refusal(name, &error)),
    };
    let mut tally = Tally::default();
    let (meshes, left_out) = scene.meshes(MAX_VERTICES as usize);
    for _ in 0..left_out {
        let why = Message::word("more than two million vertices");
        tally.add(WarningKind::BrokenMesh { why }, None);
    }
    let mut materials = meshes.iter().flat_map(|mesh| &mesh.materials);
    if materials.all(|material| material.texture.is_none()) && !drop_meshes(&mut scene)? {
        return Ok(None);
    }
    let mut textures = Textures::new(name, &scene, resolve, options.max_bytes);
    let meshes: Vec<PaintedMesh> = meshes.into_iter().map(|mesh| textures.painted(mesh)).collect();
    drop(textures);
    // Images are not needed any more.
    if !drop_meshes(&mut scene)? {
        return Ok(None);
    }
    for _ in 0..scene.constraints() {
        tally.add(WarningKind::Constraints, None);
    }
    let stated_up = match scene.up() {
        segue_fbx::UpAxis::Z => UpAxis::Z,
        _ => UpAxis::Y,
    };
    let upright = match stated_up {
        UpAxis::Y => DQuat::IDENTITY,
        UpAxis::Z => Y_UP_FROM_Z_UP.as_dquat().inverse(),
    };
    let nodes = rest_nodes(name, &scene, upright)?;
    let moves = moving(&scene).map_err(|error| refusal(name, &error))?;
    let skins: Vec<Vec<usize>> = meshes
        .iter()
        .map(|painted| painted.mesh.clusters.iter().map(|cluster| cluster.node).collect())
        .collect();
    let sets = skeletons(&scene, &skins, &moves, &mut tally);
    let characters = characters(&nodes, &sets, None, &moves);
    if characters.is_empty() {
        return Err(ImportError::whole_file(
            name,
            "a file without skeleton and without animation",
            "a character or an animation",
        )
        .with_hint("export the skeleton and its animations, too"));
    }
    let mut reader = Reader {
        name,
        scene: &scene,
        nodes: &nodes,
        meshes,
        options,
        upright,
        up: options.up.unwrap_or(stated_up),
        several: characters.len() > 1,
        left: options.max_bytes.min(max_memory(bytes.len())),
        tally,
        clips: Vec::new(),
    };
    for (index, character) in characters.iter().enumerate() {
        let is_last = index + 1 == characters.len();
        let Some(()) = reader.character(character, is_last, &mut || progress(bytes.len()))? else {
            return Ok(None);
        };
    }
    let warnings = reader.tally.into_warnings(b"");
    Ok(Some(ImportedFile { clips: reader.clips, warnings }))
}

/// Returns the memory that the content of a file may take, bytes.
fn max_memory(size: usize) -> usize {
    size.saturating_mul(MEMORY_RATIO).max(MIN_MEMORY)
}

/// Returns the limits of opening a file of a size in bytes.
fn limits(size: usize, options: &ImportOptions) -> OpenOptions {
    OpenOptions {
        max_memory: max_memory(size).min(options.max_bytes.saturating_mul(4)),
        meshes: true,
        max_key_memory: (size / KEY_MEMORY_SHARE).max(MIN_KEY_MEMORY),
    }
}

/// Returns the sentence about a file that cannot be opened.
fn refusal(name: &str, error: &OpenError) -> ImportError {
    const AGAIN: &str = "export or download it again";
    let (found, expected, hint): (Message, &'static str, &'static str) = match error {
        OpenError::Stopped | OpenError::NotFbx => (
            "a file that is not FBX".into(),
            "an FBX file, binary or text",
            "convert it to BVH, or rename it if it is one",
        ),
        OpenError::Truncated => ("an incomplete FBX file".into(), "a complete one", AGAIN),
        OpenError::Version => (
            "an FBX file of a version that is not read".into(),
            "a version from 6.1 to 7.7",
            "export it as FBX 2013 or later",
        ),
        OpenError::Memory => (
            "more content than fits into the memory that a file may take".into(),
            "a smaller scene",
            "export fewer takes at once, or without meshes",
        ),
        OpenError::Keys => (
            "more motion than fits into the memory that a file may take".into(),
            "a shorter or a sparser animation",
            "export a part of the animation, or at a lower frame rate",
        ),
        OpenError::Depth => {
            ("nodes nested too deep".into(), "a skeleton", "export the skeleton alone")
        }
        OpenError::Broken(why) => (
            msg!("an FBX file that cannot be read: {why}", why = why.clone()),
            "a valid FBX file",
            AGAIN,
        ),
    };
    ImportError::whole_file(name, found, expected).with_hint(hint)
}

/// A motion with its size, in the unit and the axes of the file.
struct MeasuredMotion {
    raw: RawMotion,
    t_pose_first_row: bool,
    t_pose_dropped: bool,
    measure: Measure,
}

struct Reader<'a> {
    name: &'a str,
    scene: &'a Scene<'a>,
    nodes: &'a Nodes,
    meshes: Vec<PaintedMesh>,
    options: &'a ImportOptions,
    /// Turns the world from Y up to the file's up axis.
    upright: DQuat,
    up: UpAxis,
    /// Whether the file holds more than one character.
    several: bool,
    /// The memory that clips may still take, bytes.
    left: usize,
    tally: Tally,
    clips: Vec<ImportedClip>,
}

impl Reader<'_> {
    /// Adds the clips of a character, the last one of the file or another; `None` if `progress`
    /// returned `false`.
    fn character(
        &mut self,
        character: &Character,
        is_last: bool,
        progress: &mut dyn FnMut() -> bool,
    ) -> Result<Option<()>, ImportError> {
        let rest = RawMotion {
            joints: character.joints.clone(),
            rotations: vec![Quat::IDENTITY; character.joints.len()],
            root_translations: character.joints.iter().take(1).map(|root| root.offset).collect(),
            ..RawMotion::default()
        };
        let takes = self.takes(character);
        let given_fps = self.options.fps.filter(|fps| fps.is_finite() && *fps > 0.0);
        let mut mesh = mesh(&mut self.meshes, is_last, self.nodes, character, &mut self.tally);
        // The unit is that of the whole character, found by its first motion where it has one: some
        // files have no plausible rest pose.
        let mut unit: Option<f64> = None;
        let mut skin: Option<Arc<SkinnedMesh>> = None;
        for &(take, is_only) in &takes {
            let found = &self.scene.takes()[take];
            let (rate, outside) = frames(found, self.scene.fps(), given_fps);
            if outside > 0.0 {
                self.tally.add(WarningKind::OutsideTake { secs: outside }, None);
            }
            if !rate.holds_keys && given_fps.is_none() {
                self.tally.add(WarningKind::Resampled { fps: rate.fps }, None);
            }
            self.spend(&rate, character.joints.len())?;
            let sampler =
                Sampler { scene: self.scene, nodes: self.nodes, character, upright: self.upright };
            let sampled = sampler.motion(take, &rate, &mut self.tally, progress);
            let Some(raw) = sampled.map_err(|error| refusal(self.name, &error))? else {
                return Ok(None);
            };
            let name = if is_only { stem(self.name).to_owned() } else { take_name(&found.name) };
            let motion = self.measured(raw);
            let unit = match unit {
                Some(unit) => unit,
                None => *unit.insert(self.unit(&motion.measure)),
            };
            if let Some(found) = mesh.take() {
                skin = Some(Arc::new(self.fitted(found, &rest, unit)));
            }
            let clip = self.clip(motion, name, rate.fps, unit)?;
            self.clips.push(clip.with_mesh(skin.as_ref()));
        }
        if takes.is_empty() {
            self.tally.add(WarningKind::NoFrames, None);
            let motion = self.measured(rest);
            let unit = self.unit(&motion.measure);
            let skin = mesh.take().map(|found| Arc::new(self.fitted(found, &motion.raw, unit)));
            let fps = given_fps.unwrap_or(self.scene.fps());
            let clip = self.clip(motion, stem(self.name).to_owned(), fps, unit)?;
            self.clips.push(clip.with_mesh(skin.as_ref()));
        }
        Ok(Some(()))
    }

    /// Returns the takes of a character, and whether each is the file's only one: those that move
    /// it, or else those that only pose it.
    fn takes(&self, character: &Character) -> Vec<(usize, bool)> {
        let with = |least: Movement| -> Vec<usize> {
            let part = |take: &segue_fbx::Take| {
                let of = |node: &usize| take.movements.get(*node).copied();
                character.nodes.iter().filter_map(of).max().unwrap_or(Movement::Still)
            };
            let takes = self.scene.takes().iter().enumerate();
            takes.filter(|(_, take)| part(take) >= least).map(|(index, _)| index).collect()
        };
        let mut found = with(Movement::Moves);
        if found.is_empty() {
            found = with(Movement::Held);
        }
        let is_only = found.len() == 1;
        found.into_iter().map(|take| (take, is_only)).collect()
    }

    /// Counts the memory of a motion before it is allocated.
    fn spend(&mut self, rate: &Rate, joints: usize) -> Result<(), ImportError> {
        let bytes = rate.frames * joints as f64 * (size_of::<Quat>() + size_of::<Vec3>()) as f64;
        if bytes > self.left as f64 {
            return Err(ImportError::whole_file(
                self.name,
                "more motion than fits into the memory that a file may take",
                "a shorter or a sparser animation",
            )
            .with_hint("export a part of the animation, or at a lower frame rate"));
        }
        self.left -= bytes as usize;
        Ok(())
    }

    /// Drops the first row where it is a T-pose that is not wanted, and measures the motion: once,
    /// because that takes its world positions in many frames.
    fn measured(&mut self, mut raw: RawMotion) -> MeasuredMotion {
        let t_pose_first_row = raw.frames() > 1 && first_frame_is_t_pose(&raw);
        let t_pose_dropped = t_pose_first_row && self.options.drop_t_pose;
        if t_pose_first_row {
            self.tally.add(WarningKind::TPose { dropped: t_pose_dropped }, None);
        }
        if t_pose_dropped {
            raw.drop_first_frame();
        }
        let measure = measure(&raw, self.options.metres_per_unit, Some(self.up));
        MeasuredMotion { raw, t_pose_first_row, t_pose_dropped, measure }
    }

    /// Returns the metres per unit: as given, as the file states it, or, where that makes the body
    /// smaller than a mouse or taller than a house, by the height.
    fn unit(&mut self, found: &Measure) -> f64 {
        let inferred = found.provenance.metres_per_unit;
        if !found.unit_detected {
            return inferred;
        }
        let stated = self.scene.metres_per_unit();
        let metres = found.height_units * stated;
        if BELIEVED_METRES.contains(&metres) || !(metres.is_finite() && metres > 0.0) {
            return if stated.is_finite() && stated > 0.0 { stated } else { inferred };
        }
        self.tally.add(WarningKind::UnitOfFile { metres, metres_per_unit: inferred }, None);
        inferred
    }

    /// Returns a mesh in metres and Y up, on the joints of the clips.
    fn fitted(&self, mut mesh: SkinnedMesh, rest: &RawMotion, metres_per_unit: f64) -> SkinnedMesh {
        mesh.scale(metres_per_unit as f32);
        if self.up == UpAxis::Z {
            mesh.turn(Y_UP_FROM_Z_UP);
        }
        folded(mesh, rest, &[])
    }

    fn clip(
        &mut self,
        motion: MeasuredMotion,
        name: String,
        fps: f64,
        metres_per_unit: f64,
    ) -> Result<ImportedClip, ImportError> {
        let MeasuredMotion { mut raw, t_pose_first_row, t_pose_dropped, measure } = motion;
        let is_given = self.options.metres_per_unit.is_some();
        let measure = Measure {
            provenance: Provenance { metres_per_unit, up: self.up },
            unit_detected: !is_given,
            unit_unknown: false,
            ..measure
        };
        let mendable = raw.warn_of_unlikely(&measure, self.options, &mut self.tally);
        let name = match raw.joints.first() {
            Some(root) if self.several => format!("{name} ({})", root.name),
            _ => name,
        };
        let clip = raw.into_clip(name, fps, measure.provenance).map_err(|error| {
            ImportError::whole_file(self.name, error.to_message(), "a skeleton with a motion")
        })?;
        Ok(ImportedClip {
            clip,
            t_pose_first_row,
            t_pose_dropped,
            measure,
            mendable,
            mesh: None,
            roles: None,
        })
    }
}

/// Returns the name of a take without what Blender puts in front of it: `Armature|Walk`, or
/// `Armature|Walk|BaseLayer`.
fn take_name(name: &str) -> String {
    let mut parts = name.rsplit('|').filter(|part| !part.is_empty() && *part != "BaseLayer");
    parts.next().unwrap_or(name).to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fbx::{FbxOptions, write_fbx};
    use segue_motion::clip::fixtures::wander_by;
    use segue_motion::skeleton::fixtures::mixamo;

    /// The memory of a key while it is read, bytes.
    const KEY_BYTES: usize = 40;

    #[test]
    fn files_of_all_sizes_are_in_parts_if_their_keys_take_much() {
        let rig = mixamo();
        let mut in_parts = Vec::new();
        for frames in [1, 30, 300, 1000, 3000, 10_000] {
            let clip = wander_by(&rig, frames, 3, 0.5);
            let bytes = write_fbx(&[&clip], &FbxOptions::default()).unwrap();
            let limits = limits(bytes.len(), &ImportOptions::default());
            // All joints turn about all axes; the root also moves.
            let keys = frames * 3 * rig.len();
            let scene = Scene::open(&bytes, limits, &mut |_| true).unwrap();
            let takes_much = KEY_BYTES * keys > limits.max_key_memory;
            assert_eq!(scene.is_in_parts(), takes_much, "{frames} frames, {} bytes", bytes.len());
            in_parts.push(takes_much);
        }
        assert!(in_parts.is_sorted() && in_parts.contains(&false) && in_parts.contains(&true));
    }
}
