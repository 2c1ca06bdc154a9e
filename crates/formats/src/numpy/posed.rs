//! Joints and rotations in the world: the files of Kimodo ("Output formats" in its documentation):
//! `posed_joints` (frames, joints, 3), `global_rot_mats` (frames, joints, 3, 3), in newer ones also
//! `local_rot_mats`; metres, Y up, 30 frames per second.
//!
//! The files have no skeleton. Names and parents follow from the number of joints, the offsets from
//! the motion itself: a joint stands still in the frame of its parent.

use super::array::View;
use super::bundle::Bundle;
use super::rigs;
use super::take::Take;
use super::turns::{self, Form};
use super::wrong_shape;
use crate::error::Fault;
use crate::warning::Tally;
use glam::{DVec3, Quat, Vec3};
use segue_motion::clip::UpAxis;
use segue_motion::math::quat;
use segue_motion::skeleton::Joint;
use segue_text::msg;

/// Returns whether a file has world positions and rotations of joints.
pub(super) fn is_posed(bundle: &Bundle<'_>) -> bool {
    bundle.get("posed_joints").is_some()
        && bundle.first(&["global_rot_mats", "local_rot_mats"]).is_some()
}

/// Returns the motion.
pub(super) fn read(bundle: &Bundle<'_>, tally: &mut Tally) -> Result<Take, Fault> {
    let (Some(places), Some(matrices)) =
        (bundle.get("posed_joints"), bundle.first(&["global_rot_mats", "local_rot_mats"]))
    else {
        return Err(Fault::new(0, bundle.description(), "posed joints and their rotations"));
    };
    let (places, matrices) = (unbatched(places.view(), 3), unbatched(matrices.view(), 4));
    let [frames, count, 3] = *places.shape() else {
        return Err(wrong_shape(places.shape(), "(frames,joints,3)"));
    };
    if *matrices.shape() != [frames, count, 3, 3] {
        return Err(wrong_shape(matrices.shape(), &format!("({frames},{count},3,3)")));
    }
    let Some(rig) = rigs::of(count) else {
        let found = msg!("a skeleton of {count} joints that the file does not name", count);
        return Err(Fault::new(0, found, "a skeleton of 22, 30, 34 or 77 joints"));
    };
    let places: Vec<Vec3> = places.numbers(tally)?.chunks_exact(3).map(Vec3::from_slice).collect();
    let given = turns::read(&matrices, Form::Matrix, tally)?;
    let world =
        if bundle.get("global_rot_mats").is_some() { given } else { in_the_world(&given, &rig) };
    let offsets = offsets(&places, &world, &rig);
    let joints = rig.iter().zip(offsets).map(|(joint, offset)| Joint {
        name: joint.name.clone(),
        parent: joint.parent,
        offset,
        end_site: None,
        channels: Vec::new(),
    });
    let joints = joints.collect();
    let root = places.iter().step_by(count).copied().collect();
    let mut take = Take::new(joints, in_their_parents(&world, &rig), root);
    take.up = Some(UpAxis::Y);
    Ok(take.with_rate_of(bundle))
}

/// Returns an array without the batch axis, if the batch is a single motion.
fn unbatched(view: View<'_>, axes: usize) -> View<'_> {
    if view.shape().len() == axes + 1 && view.shape().first() == Some(&1) {
        view.at(0, 0)
    } else {
        view
    }
}

/// Converts local rotations to world rotations.
pub(super) fn in_the_world(local: &[Quat], rig: &[rigs::RigJoint]) -> Vec<Quat> {
    let mut world: Vec<Quat> = Vec::with_capacity(local.len());
    for (index, turn) in local.iter().enumerate() {
        let joint = index % rig.len();
        let above = rig[joint].parent.and_then(|parent| world.get(index - joint + parent));
        world.push(above.map_or(*turn, |above| quat::renormalize(*above * *turn)));
    }
    world
}

/// Converts world rotations to local rotations.
fn in_their_parents(world: &[Quat], rig: &[rigs::RigJoint]) -> Vec<Quat> {
    let local = world.iter().enumerate().map(|(index, turn)| {
        let joint = index % rig.len();
        let above = rig[joint].parent.and_then(|parent| world.get(index - joint + parent));
        above.map_or(*turn, |above| quat::renormalize(above.conjugate() * *turn))
    });
    local.collect()
}

/// Returns the offset of each joint: its mean position in its parent's frame; for the root, its
/// height above the ground in the first frame.
pub(super) fn offsets(places: &[Vec3], world: &[Quat], rig: &[rigs::RigJoint]) -> Vec<Vec3> {
    let mut sums = vec![DVec3::ZERO; rig.len()];
    let frames = places.len() / rig.len().max(1);
    for (places, world) in places.chunks_exact(rig.len()).zip(world.chunks_exact(rig.len())) {
        for (joint, own) in rig.iter().enumerate() {
            let Some(parent) = own.parent else { continue };
            let in_parent = world[parent].conjugate() * (places[joint] - places[parent]);
            sums[joint] += in_parent.as_dvec3();
        }
    }
    let mut offsets: Vec<Vec3> =
        sums.into_iter().map(|sum| (sum / frames.max(1) as f64).as_vec3()).collect();
    if let (Some(offset), Some(first)) = (offsets.first_mut(), places.first()) {
        *offset = Vec3::new(0.0, first.y, 0.0);
    }
    offsets
}
