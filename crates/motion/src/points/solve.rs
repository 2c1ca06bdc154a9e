//! The solver: rotations of one joint after the other, from the root outwards.

use super::body::{Body, Members, Node};
use super::gaps::{Gaps, Track, fill_between};
use super::rest::{Anatomy, Cluster, median_length, rest_direction};
use super::twist::{Twist, about, settle};
use super::{FitError, PointFit, PointSet, PointsError};
use crate::clip::UpAxis;
use crate::math::quat;
use crate::skeleton::{Joint, Skeleton};
use glam::{Quat, Vec3};

/// The joints that are solved, by index: parents before children.
#[derive(Default)]
pub(super) struct Solved {
    pub(super) positions: Vec<Vec<Vec3>>,
    /// World rotations.
    pub(super) rotations: Vec<Vec<Quat>>,
}

/// Returns the skeleton and motion that fit points best: constant bone lengths, rotations by
/// direction, limb plane and cluster.
///
/// # Errors
/// [`PointsError`] when the points are no tree, or no frame shows any of them.
pub fn skeleton_from_points(set: &PointSet<'_>) -> Result<PointFit, PointsError> {
    let mut gaps = Gaps::default();
    let body = Body::of(set, &mut gaps)?;
    let names = |node: &Node| set.points[node.point].name.clone();
    let mut joints: Vec<Joint> = body
        .nodes
        .iter()
        .map(|node| Joint {
            name: names(node),
            parent: node.parent,
            offset: Vec3::ZERO,
            end_site: None,
            channels: Vec::new(),
        })
        .collect();
    let anatomy = Anatomy::of(&Skeleton::new(joints.clone())?);
    let mut solved = Solved::default();
    for index in 0..body.nodes.len() {
        let positions = match body.nodes[index].parent {
            None => body.nodes[index].track.complete(),
            Some(parent) => (0..body.frames)
                .map(|frame| {
                    solved.positions[parent][frame]
                        + solved.rotations[parent][frame] * joints[index].offset
                })
                .collect(),
        };
        solved.positions.push(positions);
        let (rotations, offsets) = body.rotations(index, &solved, &anatomy);
        for (child, offset) in body.nodes[index].children.iter().zip(offsets) {
            joints[*child].offset = offset;
        }
        solved.rotations.push(rotations);
    }
    let error = body.error(&solved);
    let mut fit = PointFit {
        sources: body.nodes.iter().map(|node| node.point).collect(),
        rotations: body.local(&solved),
        root_translations: solved.positions.swap_remove(0),
        joints,
        gaps,
        error,
    };
    if let (Some(root), Some(first)) = (fit.joints.first_mut(), fit.root_translations.first()) {
        root.offset = *first;
    }
    if set.up == UpAxis::Z {
        fit.turn_to_z_up();
    }
    Ok(fit)
}

impl PointFit {
    fn turn_to_z_up(&mut self) {
        let z_up = |v: Vec3| Vec3::new(v.x, -v.z, v.y);
        self.joints.iter_mut().for_each(|joint| joint.offset = z_up(joint.offset));
        self.root_translations.iter_mut().for_each(|v| *v = z_up(*v));
        for q in &mut self.rotations {
            let v = z_up(q.xyz());
            *q = Quat::from_xyzw(v.x, v.y, v.z, q.w);
        }
    }
}

impl Body {
    /// Returns the world rotations of a joint, and the rest offsets of its children.
    fn rotations(
        &self,
        joint: usize,
        solved: &Solved,
        anatomy: &Anatomy,
    ) -> (Vec<Quat>, Vec<Vec3>) {
        let members = self.members(joint);
        let above = self.above(joint, solved);
        match (members.joints, members.tracks.len()) {
            (_, 0) => (above, Vec::new()),
            (1, _) | (0, 1) => self.aim(joint, &members, &above, solved, anatomy),
            _ => {
                let node = &self.nodes[joint];
                match Cluster::of(&node.track, &members.tracks, self.frames) {
                    Some(cluster) => {
                        let rest = anatomy.cluster_rest(joint, &cluster, self);
                        let rest = rest.unwrap_or_else(|| cluster.mean_in(&above, node.parent));
                        let mut rotations: Vec<Quat> = cluster
                            .rotations
                            .iter()
                            .map(|turn| quat::renormalize(*turn * rest.conjugate()))
                            .collect();
                        bridge(&cluster.known, &mut rotations, &above);
                        let offsets =
                            cluster.shape.iter().take(members.joints).map(|v| rest * *v).collect();
                        (rotations, offsets)
                    }
                    // All on one line, or never seen together: the direction of the first decides.
                    None => self.aim(joint, &members, &above, solved, anatomy),
                }
            }
        }
    }

    /// Returns the world rotations of a joint's parent; for the root the identity.
    fn above(&self, joint: usize, solved: &Solved) -> Vec<Quat> {
        match self.nodes[joint].parent {
            Some(parent) => solved.rotations[parent].clone(),
            None => vec![Quat::IDENTITY; self.frames],
        }
    }

    /// Returns the rotations that point a joint at its first member, with the twist that helpers,
    /// limb plane or trunk show.
    fn aim(
        &self,
        joint: usize,
        members: &Members<'_>,
        above: &[Quat],
        solved: &Solved,
        anatomy: &Anatomy,
    ) -> (Vec<Quat>, Vec<Vec3>) {
        let node = &self.nodes[joint];
        let target = members.tracks[0];
        let from = &solved.positions[joint];
        let direction =
            |frame: usize| target.get(frame).and_then(|at| (at - from[frame]).try_normalize());
        let rest = rest_direction(joint, &direction, above, self, anatomy);
        let length = median_length(&node.track, target);
        let mut known = vec![false; self.frames];
        let mut rotations = Vec::with_capacity(self.frames);
        for frame in 0..self.frames {
            // A root has no parent to start from: it takes up the frame before.
            let before = match (node.parent, rotations.last()) {
                (None, Some(last)) => *last,
                _ => above[frame],
            };
            rotations.push(match direction(frame) {
                Some(direction) => {
                    known[frame] = true;
                    let swing = quat::between_directions(before * rest, direction);
                    quat::renormalize(swing * before)
                }
                None => before,
            });
        }
        let twists: Vec<Twist> = (0..self.frames)
            .map(|frame| match direction(frame) {
                Some(bone) => self.twist(joint, frame, bone, rotations[frame], solved, anatomy),
                None => Twist::default(),
            })
            .collect();
        let angles = settle(&twists, self.fps);
        for (rotation, angle) in rotations.iter_mut().zip(angles).filter(|(_, angle)| *angle != 0.0)
        {
            *rotation = quat::renormalize(about(*rotation * rest, angle) * *rotation);
        }
        bridge(&known, &mut rotations, above);
        let offset = |(index, track): (usize, &&Track)| {
            if index == 0 {
                return rest * length;
            }
            let (mut sum, mut count) = (Vec3::ZERO, 0.0);
            for (frame, turn) in rotations.iter().enumerate() {
                if let (Some(own), Some(at)) = (node.track.get(frame), track.get(frame)) {
                    sum += turn.conjugate() * (at - own);
                    count += 1.0;
                }
            }
            if count > 0.0 { sum / count } else { Vec3::ZERO }
        };
        let offsets = members.tracks.iter().enumerate().take(members.joints).map(offset).collect();
        (rotations, offsets)
    }

    /// Returns the twist of a bone in a frame, beyond its rotation by swing alone.
    fn twist(
        &self,
        joint: usize,
        frame: usize,
        bone: Vec3,
        swung: Quat,
        solved: &Solved,
        anatomy: &Anatomy,
    ) -> Twist {
        let node = &self.nodes[joint];
        let from = solved.positions[joint][frame];
        let target = node.children.first().map(|&child| &self.nodes[child]);
        let to = target.and_then(|node| node.track.get(frame));
        let length = to.map_or(0.0, |to| to.distance(from));
        let helped = node
            .helpers
            .iter()
            .filter(|(_, beside)| *beside != Vec3::ZERO)
            .filter_map(|(track, beside)| {
                let offset = track.get(frame)? - from;
                Some(Twist::of_helper(bone, length, swung * *beside, offset))
            })
            .max_by(|a, b| a.weight.total_cmp(&b.weight));
        if let Some(twist) = helped.filter(|twist| twist.weight > 0.0) {
            return twist;
        }
        if let Some((across, share)) = anatomy.across_trunk(joint, frame, self) {
            let own = swung * Vec3::X;
            let hips = anatomy.hips.and_then(|hips| solved.rotations.get(hips));
            let hips = hips.map_or(own, |rotations| rotations[frame] * Vec3::X);
            let mixed = hips.lerp(across, share);
            return Twist::between(bone, own, mixed, 1.0);
        }
        let next = target.and_then(|node| self.nodes[*node.children.first()?].track.get(frame));
        match (anatomy.hinge(joint), to, next) {
            (Some(hinge), Some(to), Some(next)) => {
                let twist = Twist::of_plane(bone, swung * hinge.axis, next - to);
                // A knee that seems to bend forward by a little is a straight one.
                if hinge.is_knee && twist.angle.abs() > std::f32::consts::FRAC_PI_2 {
                    return Twist::default();
                }
                twist
            }
            _ => Twist::default(),
        }
    }

    fn error(&self, solved: &Solved) -> FitError {
        let (mut sum, mut count, mut greatest) = (0.0_f64, 0_usize, 0.0_f32);
        for (node, positions) in self.nodes.iter().zip(&solved.positions) {
            for (frame, position) in positions.iter().enumerate() {
                if let Some(at) = node.track.get(frame) {
                    let distance = at.distance(*position);
                    sum += f64::from(distance);
                    count += 1;
                    greatest = greatest.max(distance);
                }
            }
        }
        FitError { mean: (sum / count.max(1) as f64) as f32, greatest }
    }

    /// Returns the rotations relative to the parents, frame by frame.
    fn local(&self, solved: &Solved) -> Vec<Quat> {
        let mut local = Vec::with_capacity(self.frames * self.nodes.len());
        for frame in 0..self.frames {
            for (node, own) in self.nodes.iter().zip(&solved.rotations) {
                let own = own[frame];
                local.push(match node.parent {
                    Some(parent) => {
                        quat::renormalize(solved.rotations[parent][frame].conjugate() * own)
                    }
                    None => own,
                });
            }
        }
        local
    }
}

/// Interpolates rotations that are not known: those in the parent's frame.
fn bridge(known: &[bool], rotations: &mut [Quat], above: &[Quat]) {
    if known.iter().all(|known| *known) {
        return;
    }
    let mut local: Vec<Quat> =
        rotations.iter().zip(above).map(|(own, above)| above.conjugate() * *own).collect();
    if known.contains(&true) {
        fill_between(known, &mut local, |a, b, t| quat::slerp(*a, *b, t));
    } else {
        local.fill(Quat::IDENTITY);
    }
    for ((own, above), local) in rotations.iter_mut().zip(above).zip(local) {
        *own = quat::renormalize(*above * local);
    }
}
