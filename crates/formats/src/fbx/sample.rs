//! The motion of a character in a take, frame by frame.

use crate::gltf::characters::Character;
use crate::gltf::node::{Nodes, World};
use crate::gltf::rate::Rate;
use crate::raw::RawMotion;
use crate::warning::{Tally, WarningKind};
use glam::{DQuat, DVec3, Vec3};
use segue_fbx::{Movement, OpenError, Poses, Scene, Transform};
use segue_motion::math::quat;

/// The distance from its place at rest, as a share of the skeleton's size, up to which a joint
/// counts as fixed to its parent: hundredths of a millimetre.
const FIXED: f64 = 5e-6;
/// The number of frames between two reports of progress.
const PROGRESS_FRAMES: usize = 64;

/// A transform from a node's axes to its parent's.
#[derive(Clone, Copy)]
pub(super) struct Local {
    pub(super) translation: DVec3,
    pub(super) rotation: DQuat,
    pub(super) scale: DVec3,
}

/// Returns a transform of the file; `upright` turns the nodes at the top.
pub(super) fn local(transform: Transform, parent: Option<usize>, upright: DQuat) -> Local {
    let (translation, rotation) =
        (DVec3::from_array(transform.translation), DQuat::from_array(transform.rotation));
    let length = rotation.length();
    let rotation = if length.is_finite() && length > 1e-6 {
        rotation * length.recip()
    } else {
        DQuat::IDENTITY
    };
    let scale = DVec3::from_array(transform.scale);
    let scale = if scale.is_finite() { scale } else { DVec3::ONE };
    let translation = if translation.is_finite() { translation } else { DVec3::ZERO };
    match parent {
        Some(_) => Local { translation, rotation, scale },
        None => Local { translation: upright * translation, rotation: upright * rotation, scale },
    }
}

/// A character in a take.
pub(super) struct Sampler<'a> {
    pub(super) scene: &'a Scene<'a>,
    pub(super) nodes: &'a Nodes,
    pub(super) character: &'a Character,
    pub(super) upright: DQuat,
}

impl Sampler<'_> {
    /// Samples a take; `None` if `progress` returned `false`.
    ///
    /// With `R` for rotations in the world, of which `R₀` are those at rest, a joint is turned from
    /// rest by `Q = R · R₀⁻¹` in the world, and by `Q(parent)⁻¹ · Q` against its parent. Its
    /// translation is the way from its parent in the parent's axes, `Q(parent)⁻¹ · (p −
    /// p(parent))`.
    pub(super) fn motion(
        &self,
        take: usize,
        rate: &Rate,
        tally: &mut Tally,
        progress: &mut dyn FnMut() -> bool,
    ) -> Result<Option<RawMotion>, OpenError> {
        let mut poses = self.scene.poses();
        let joints = &self.character.joints;
        // Saturates; the caller has checked that there is memory for as many.
        let frames = rate.frames as usize;
        let own: Vec<DQuat> = self
            .character
            .nodes
            .iter()
            .map(|&node| self.nodes.all[node].world.rotation.inverse())
            .collect();
        let nodes = self.character.nodes.iter();
        let held = nodes.map(|&node| self.held(&mut poses, take, node, rate.start_secs));
        let held = held.collect::<Result<Vec<Option<Local>>, OpenError>>()?;
        let tolerance = FIXED * self.size();
        let mut raw = RawMotion {
            joints: joints.clone(),
            rotations: Vec::with_capacity(frames * joints.len()),
            root_translations: Vec::with_capacity(frames),
            ..RawMotion::default()
        };
        let mut tracks: Vec<Option<Vec<Vec3>>> = vec![None; joints.len()];
        let above = self.above(&mut poses, take, rate.start_secs)?;
        let mut world = vec![World::IDENTITY; joints.len()];
        let mut turned = vec![DQuat::IDENTITY; joints.len()];
        for frame in 0..frames {
            if frame % PROGRESS_FRAMES == 0 && !progress() {
                return Ok(None);
            }
            let secs = rate.start_secs + frame as f64 / rate.fps;
            for (joint, &node) in self.character.nodes.iter().enumerate() {
                let parent = joints[joint].parent;
                let base = parent.map_or(above, |parent| world[parent]);
                let Local { translation, rotation, scale } = match held[joint] {
                    Some(held) => held,
                    None => self.local(&mut poses, take, node, secs)?,
                };
                let here = base.then(translation, rotation, scale);
                if here.is_plausible() {
                    world[joint] = here;
                } else {
                    // The last good place is held.
                    tally.add(WarningKind::NotFinite, None);
                }
                let turn = world[joint].rotation * own[joint];
                turned[joint] = turn;
                let (at, turn) = match parent {
                    None => (world[joint].position, turn),
                    Some(parent) => {
                        let back = turned[parent].inverse();
                        (back * (world[joint].position - world[parent].position), back * turn)
                    }
                };
                raw.rotations.push(quat::renormalize(turn.as_quat()));
                if parent.is_none() {
                    raw.root_translations.push(at.as_vec3());
                    continue;
                }
                let rest = joints[joint].offset;
                let track = &mut tracks[joint];
                if track.is_none() && at.distance(rest.as_dvec3()) > tolerance {
                    let mut values = Vec::with_capacity(frames);
                    values.resize(frame, rest);
                    *track = Some(values);
                }
                if let Some(values) = track {
                    values.push(at.as_vec3());
                }
            }
        }
        raw.tracks = tracks
            .into_iter()
            .enumerate()
            .filter_map(|(joint, track)| Some((joint, track?)))
            .collect();
        Ok(Some(raw))
    }

    fn local(
        &self,
        poses: &mut Poses<'_>,
        take: usize,
        node: usize,
        secs: f64,
    ) -> Result<Local, OpenError> {
        let parent = self.scene.nodes().get(node).and_then(|node| node.parent);
        Ok(local(poses.transform(take, node, secs)?, parent, self.upright))
    }

    /// Returns the transform of a node that does not move in a take.
    fn held(
        &self,
        poses: &mut Poses<'_>,
        take: usize,
        node: usize,
        secs: f64,
    ) -> Result<Option<Local>, OpenError> {
        let found = self.scene.takes().get(take).and_then(|take| take.movements.get(node));
        match found {
            None | Some(Movement::Moves) => Ok(None),
            Some(_) => self.local(poses, take, node, secs).map(Some),
        }
    }

    /// Returns the transform of the node above the root in a take, through which nothing moves.
    fn above(&self, poses: &mut Poses<'_>, take: usize, secs: f64) -> Result<World, OpenError> {
        let mut path: Vec<usize> = self
            .character
            .nodes
            .first()
            .map(|&root| self.nodes.upwards(root).skip(1).collect())
            .unwrap_or_default();
        path.reverse();
        path.into_iter().try_fold(World::IDENTITY, |above, node| {
            let Local { translation, rotation, scale } = self.local(poses, take, node, secs)?;
            Ok(above.then(translation, rotation, scale))
        })
    }

    /// Returns the greatest distance of a joint from the root at rest.
    fn size(&self) -> f64 {
        let at = |node: &usize| self.nodes.all[*node].world.position;
        let root = self.character.nodes.first().map(at).unwrap_or_default();
        self.character.nodes.iter().map(|node| at(node).distance(root)).fold(0.0, f64::max)
    }
}
