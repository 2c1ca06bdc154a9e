//! Reading of glTF files.

use super::characters::{Character, characters};
use super::curve::{Curve, Kind, SAME_FRAME, rotation};
use super::document::Document;
use super::humanoid::Humanoid;
use super::node::Nodes;
use super::rate::{Rate, rate};
use super::skin::mesh;
use super::write::{GENERATOR, MADE_BODY};
use crate::measure::measure;
use crate::raw::{RawMotion, Y_UP_FROM_Z_UP};
use crate::t_pose::first_frame_is_t_pose;
use crate::texture::Images;
use crate::warning::{Tally, WarningKind};
use crate::{ImportError, ImportOptions, ImportedClip, ImportedFile, Resolve, check_size, stem};
use glam::{DMat3, DVec3, Quat, Vec3};
use gltf::json::Index;
use gltf::json::accessor::{Accessor, Type};
use gltf::json::animation::{Animation, Property, Sampler};
use gltf::json::validation::Checked;
use segue_motion::clip::UpAxis;
use segue_motion::math::quat;
use segue_motion::skeleton::Role;
use segue_motion::skin::SkinnedMesh;
use segue_text::{ToMessage, msg};
use std::collections::BTreeMap;
use std::sync::Arc;

/// Reads a glTF 2.0 file, `.glb` or `.gltf`: one clip for each animation of each character, in
/// metres and Y up. A character without animation is a clip of one frame, its rest pose.
///
/// `name` is the file's name: for errors, and for clips whose animation has no name. `resolve`
/// returns the bytes of a file beside this one (the `.bin` of a `.gltf`) by the name in its JSON.
///
/// Keys are sampled at the lowest rate at which each is a frame, or at 30 frames per second if
/// there is none; `options.fps` overrides that rate and does not change the duration of an
/// animation. Lengths are metres. If a character would be taller than ten metres, they are taken as
/// centimetres, and above a thousand metres as millimetres.
///
/// # Errors
/// [`ImportError`] when the file is not glTF 2.0, is truncated, contains neither a skeleton nor an
/// animation, or needs more memory than `options.max_bytes`.
pub fn read(
    name: &str,
    bytes: &[u8],
    resolve: Resolve<'_>,
    options: &ImportOptions,
) -> Result<ImportedFile, ImportError> {
    check_size(name, bytes, options)?;
    let document = Document::open(name, bytes, resolve, options.max_bytes)?;
    let nodes = Nodes::of(&document)?;
    let mut tally = Tally::default();
    if let Some(error) = &document.broken_humanoid {
        tally.add(WarningKind::BrokenBoneMap { why: error.to_string() }, None);
    }
    let mut motions = Vec::with_capacity(document.root.animations.len());
    let mut moves = vec![false; nodes.all.len()];
    for (index, animation) in document.root.animations.iter().enumerate() {
        let own = animation.name.clone().filter(|name| !name.is_empty());
        let motion = Motion {
            name: own.unwrap_or_else(|| match document.root.animations.len() {
                1 => stem(name).to_owned(),
                _ => format!("{} {}", stem(name), index + 1),
            }),
            ..Motion::read(&document, &nodes, animation, options, &mut tally)?
        };
        for &node in motion.turns.keys().chain(motion.places.keys()) {
            moves[node] = true;
        }
        motions.push(motion);
    }
    let humanoid = document.humanoid.as_ref().map(|humanoid| &humanoid.nodes[..]);
    let characters = characters(&nodes, &skins(&document, &nodes)?, humanoid, &moves);
    if characters.is_empty() {
        return Err(document
            .error("a file without skeleton and without animation", "a character or an animation")
            .with_hint("export the skeleton and its animations, too"));
    }
    let mut imported = ImportedFile::default();
    let mut images = Images::new(options.max_bytes);
    for character in &characters {
        let context =
            Context { document: &document, nodes: &nodes, options, several: characters.len() > 1 };
        context.clips(character, &motions, &mut images, &mut imported.clips, &mut tally)?;
    }
    imported.warnings = tally.into_warnings(b"");
    Ok(imported)
}

/// One animation of the file.
struct Motion {
    name: String,
    /// Curves by node.
    turns: BTreeMap<usize, Curve>,
    places: BTreeMap<usize, Curve>,
    rate: Rate,
}

impl Motion {
    fn read(
        document: &Document<'_>,
        nodes: &Nodes,
        animation: &Animation,
        options: &ImportOptions,
        tally: &mut Tally,
    ) -> Result<Self, ImportError> {
        let (mut turns, mut places) = (BTreeMap::new(), BTreeMap::new());
        // Most channels share their times.
        let mut all_times: BTreeMap<usize, Arc<[f32]>> = BTreeMap::new();
        let mut held = 0;
        for channel in &animation.channels {
            let (node, Checked::Valid(path)) = (channel.target.node.value(), channel.target.path)
            else {
                continue;
            };
            if document.humanoid.as_ref().is_some_and(|humanoid| humanoid.is_face(node)) {
                tally.add(WarningKind::FaceAnimation, None);
                continue;
            }
            let Some(moved) = nodes.all.get(node) else {
                return Err(document.error(
                    msg!("an animation of node {node}, which is not there"),
                    "a valid glTF 2.0 file",
                ));
            };
            let Some(sampler): Option<&Sampler> = animation.samplers.get(channel.sampler.value())
            else {
                return Err(
                    document.error("an animation without its keys", "a valid glTF 2.0 file")
                );
            };
            let kind = match path {
                Property::Rotation => Kind::Rotation,
                Property::Translation | Property::Scale => Kind::Vector,
                Property::MorphTargetWeights => continue,
            };
            let times = match all_times.get(&sampler.input.value()) {
                Some(times) => Arc::clone(times),
                None => key_times(document, sampler.input)?,
            };
            let Some(curve) = Curve::read(document, sampler, Arc::clone(&times), kind, &mut held)?
            else {
                continue;
            };
            match path {
                Property::Scale if curve.differs_from(moved.scale.as_vec3().extend(0.0)) => {
                    tally.add(WarningKind::ScaleAnimation, None);
                }
                Property::Rotation => drop(turns.insert(node, curve)),
                Property::Translation => drop(places.insert(node, curve)),
                _ => continue,
            }
            all_times.insert(sampler.input.value(), times);
        }
        for _ in 0..held {
            tally.add(WarningKind::NotFinite, None);
        }
        let keys = all_times.values().flat_map(|times| times.iter().map(|&time| f64::from(time)));
        let rate = rate(keys.collect(), given_fps(options));
        if !rate.holds_keys && given_fps(options).is_none() {
            tally.add(WarningKind::Resampled { fps: rate.fps }, None);
        }
        Ok(Self { name: String::new(), turns, places, rate })
    }
}

/// Returns the joints of each skin.
fn skins(document: &Document<'_>, nodes: &Nodes) -> Result<Vec<Vec<usize>>, ImportError> {
    let joints = |skin: &gltf::json::Skin| {
        let joints: Vec<usize> = skin.joints.iter().map(Index::value).collect();
        match joints.iter().find(|&&joint| joint >= nodes.all.len()) {
            Some(missing) => Err(document.error(
                msg!("node {missing} in a skin, which is not there"),
                "a valid glTF 2.0 file",
            )),
            None => Ok(joints),
        }
    };
    document.root.skins.iter().map(joints).collect()
}

fn given_fps(options: &ImportOptions) -> Option<f64> {
    options.fps.filter(|fps| fps.is_finite() && *fps > 0.0)
}

fn key_times(document: &Document<'_>, input: Index<Accessor>) -> Result<Arc<[f32]>, ImportError> {
    let times = document.floats(input, Type::Scalar)?;
    // For the list of all keys, in double precision.
    document.spend(times.len(), size_of::<f64>())?;
    if times.iter().all(|time| time.is_finite()) && times.is_sorted() {
        Ok(times.into())
    } else {
        Err(document.error(
            msg!("times of keys that do not rise (accessor {index})", index = input.value()),
            "rising times",
        ))
    }
}

/// The way in which a clip is made of a motion.
struct How<'a> {
    fps: f64,
    metres_per_unit: f64,
    /// The roles of joints that the file states.
    stated: &'a [(Role, usize)],
}

struct Context<'a> {
    document: &'a Document<'a>,
    nodes: &'a Nodes,
    options: &'a ImportOptions,
    /// Whether the file holds more than one character.
    several: bool,
}

impl Context<'_> {
    fn clips(
        &self,
        character: &Character,
        motions: &[Motion],
        images: &mut Images,
        clips: &mut Vec<ImportedClip>,
        tally: &mut Tally,
    ) -> Result<(), ImportError> {
        // The nodes of a humanoid animation may carry a body to look at; it is no character.
        let is_animation = self.document.humanoid.as_ref().is_some_and(Humanoid::is_animation);
        let mut skin = if self.is_own() || is_animation {
            None
        } else {
            mesh(self.document, self.nodes, character, images, tally)
        };
        for _ in 0..character.uneven {
            tally.add(WarningKind::UnevenScale, None);
        }
        let rest = RawMotion {
            joints: character.joints.clone(),
            rotations: vec![Quat::IDENTITY; character.joints.len()],
            root_translations: character
                .joints
                .first()
                .map(|root| root.offset)
                .into_iter()
                .collect(),
            ..RawMotion::default()
        };
        let metres_per_unit = self.unit(&rest, tally);
        if let Some(mesh) = &mut skin {
            mesh.scale(metres_per_unit as f32);
            if self.options.up == Some(UpAxis::Z) {
                mesh.turn(Y_UP_FROM_Z_UP);
            }
        }
        let stated = self.stated_roles(character);
        let skin = skin.map(|mesh| Arc::new(folded(mesh, &rest, &stated)));
        let is_moved = |motion: &&Motion| {
            let moves =
                |node: &usize| motion.turns.contains_key(node) || motion.places.contains_key(node);
            character.nodes.iter().any(moves)
        };
        let before = clips.len();
        for motion in motions.iter().filter(is_moved) {
            let raw = self.sampled(character, motion)?;
            let how = How { fps: motion.rate.fps, metres_per_unit, stated: &stated };
            clips.push(self.clip(raw, &motion.name, &how, tally)?.with_mesh(skin.as_ref()));
        }
        if clips.len() == before {
            tally.add(WarningKind::NoFrames, None);
            let Rate { fps, .. } = rate(Vec::new(), given_fps(self.options));
            let how = How { fps, metres_per_unit, stated: &stated };
            let name = stem(self.document.name());
            clips.push(self.clip(rest, name, &how, tally)?.with_mesh(skin.as_ref()));
        }
        Ok(())
    }

    /// Returns the roles of a character's joints by the file's bone map.
    fn stated_roles(&self, character: &Character) -> Vec<(Role, usize)> {
        let bones = self.document.humanoid.iter().flat_map(|humanoid| &humanoid.roles);
        let joint = |wanted: usize| character.nodes.iter().position(|&node| node == wanted);
        bones.filter_map(|&(role, node)| Some((role, joint(node)?))).collect()
    }

    /// Returns whether Segue wrote the file, so that the mesh is the one that Segue generates
    /// around the skeleton.
    fn is_own(&self) -> bool {
        let root = &self.document.root;
        let is_made = |mesh: &gltf::json::Mesh| mesh.name.as_deref() == Some(MADE_BODY);
        let generator = root.asset.generator.as_deref();
        generator.is_some_and(|generator| generator.starts_with(GENERATOR))
            && root.meshes.iter().all(is_made)
    }

    /// Returns the metres per unit. The format prescribes metres, but not every exporter follows
    /// it: characters of a hundred metres are in centimetres.
    fn unit(&self, rest: &RawMotion, tally: &mut Tally) -> f64 {
        /// The greatest plausible height, for each unit.
        const MAX_HEIGHTS: [(f64, f64); 2] = [(10.0, 1.0), (1000.0, 0.01)];
        let found = measure(rest, self.options.metres_per_unit, Some(UpAxis::Y));
        if !found.unit_detected {
            return found.provenance.metres_per_unit;
        }
        let unit = MAX_HEIGHTS.iter().find(|(highest, _)| found.height_units <= *highest);
        let metres_per_unit = unit.map_or(0.001, |(_, unit)| *unit);
        if metres_per_unit != 1.0 {
            tally.add(WarningKind::NotMetres { metres_per_unit }, None);
        }
        metres_per_unit
    }

    /// Samples an animation frame by frame. With `G` for rotations in the world at rest, a joint
    /// rotates by `G(parent) · local · G(joint)⁻¹`, and a translation is mapped to the parent's new
    /// axes by the parent's rotation and scale at rest.
    fn sampled(&self, character: &Character, motion: &Motion) -> Result<RawMotion, ImportError> {
        let Rate { fps, start_secs, frames, .. } = motion.rate;
        let joints = character.joints.len();
        // Saturates: `spend` refuses the number of bytes that follows from it.
        let frames = frames as usize;
        self.document
            .spend(frames.saturating_mul(joints), size_of::<Quat>() + size_of::<Vec3>())?;
        let mut raw = RawMotion {
            joints: character.joints.clone(),
            rotations: vec![Quat::IDENTITY; frames * joints],
            root_translations: vec![
                character.joints.first().map_or(Vec3::ZERO, |root| root.offset);
                frames
            ],
            ..RawMotion::default()
        };
        let (secs, same_secs) = (|frame: usize| start_secs + frame as f64 / fps, SAME_FRAME / fps);
        for (joint, &node) in character.nodes.iter().enumerate() {
            let above = match character.joints[joint].parent {
                None => character.above,
                Some(_) => self.nodes.all[node]
                    .parent
                    .map_or(character.above, |parent| self.nodes.all[parent].world),
            };
            if let Some(curve) = motion.turns.get(&node) {
                let (parent, own) = (
                    above.rotation.as_quat(),
                    self.nodes.all[node].world.rotation.as_quat().conjugate(),
                );
                let mut key = 0;
                for (frame, turn) in
                    raw.rotations.iter_mut().skip(joint).step_by(joints).enumerate()
                {
                    let local = rotation(curve.at(secs(frame), same_secs, &mut key));
                    *turn = quat::renormalize(parent * local * own);
                }
            }
            if let Some(curve) = motion.places.get(&node) {
                let mut key = 0;
                let (at, axes): (DVec3, DMat3) = match joint {
                    0 => (above.position, above.linear),
                    _ => (DVec3::ZERO, above.linear),
                };
                let mut good = character.joints[joint].offset;
                let values = (0..frames).map(|frame| {
                    let local = curve.at(secs(frame), same_secs, &mut key).truncate();
                    let place = (at + axes * local.as_dvec3()).as_vec3();
                    // Between finite keys, a spline with steep tangents may still overflow.
                    if place.is_finite() {
                        good = place;
                    }
                    good
                });
                match joint {
                    0 => raw.root_translations = values.collect(),
                    _ => raw.tracks.push((joint, values.collect())),
                }
            }
        }
        Ok(raw)
    }

    fn clip(
        &self,
        mut raw: RawMotion,
        name: &str,
        how: &How<'_>,
        tally: &mut Tally,
    ) -> Result<ImportedClip, ImportError> {
        let t_pose_first_row = first_frame_is_t_pose(&raw);
        let t_pose_dropped = t_pose_first_row && self.options.drop_t_pose;
        if t_pose_first_row {
            tally.add(WarningKind::TPose { dropped: t_pose_dropped }, None);
        }
        if t_pose_dropped {
            raw.drop_first_frame();
        }
        let measure =
            measure(&raw, Some(how.metres_per_unit), Some(self.options.up.unwrap_or_default()));
        let mendable = raw.warn_of_unlikely(&measure, self.options, tally);
        let name = match raw.joints.first() {
            Some(root) if self.several => format!("{name} ({})", root.name),
            _ => name.to_owned(),
        };
        let (clip, roles) = raw
            .into_clip_with_roles(name, how.fps, measure.provenance, how.stated)
            .map_err(|error| self.document.error(error.to_message(), "a skeleton with a motion"))?;
        Ok(ImportedClip {
            clip,
            t_pose_first_row,
            t_pose_dropped,
            measure,
            mendable,
            mesh: None,
            roles: (!how.stated.is_empty()).then_some(roles),
        })
    }
}

/// Moves the mesh to the joints of its clips ([`segue_motion::clip::Clip::folded`]): vertices
/// of a joint above the carrier follow the carrier.
pub(crate) fn folded(
    mut mesh: SkinnedMesh,
    rest: &RawMotion,
    stated: &[(Role, usize)],
) -> SkinnedMesh {
    let measure = measure(rest, Some(1.0), Some(UpAxis::Y));
    let clip = rest.clone().into_clip_with_roles(String::new(), 1.0, measure.provenance, stated);
    if let Ok((clip, _)) = clip
        && let Some(above) = clip.skeleton().folded_chain()
    {
        let bind =
            above.file_index().iter().filter_map(|&file| mesh.bind.get(file).copied()).collect();
        mesh.rebind(&above.from_file(), bind);
    }
    mesh
}
