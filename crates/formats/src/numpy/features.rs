//! The features of `HumanML3D` (Guo et al., "Generating Diverse and Natural 3D Human Motions from
//! Text", 2022) and their later form.
//!
//! Both describe 22 joints of SMPL relative to the heading of the body, with Y up. The 263 values
//! of a frame are the change of the heading, the velocity of the root over the ground, its height,
//! the places of the other joints, and rotations, velocities and contacts, which are not read: the
//! rotations have been solved from the places. The 272 values are the velocity of the root, the
//! change of the heading (six numbers), the places, the velocities and the rotations of SMPL (six
//! numbers each).

use super::array::View;
use super::body::{self, BODY_JOINTS};
use super::points::JointPoints;
use super::posed::{in_the_world, offsets};
use super::rigs::{self, RigJoint};
use super::take::Take;
use super::turns::{self, Form};
use super::wrong_shape;
use crate::error::Fault;
use crate::warning::Tally;
use glam::{DVec2, DVec3, Quat, Vec3};
use segue_motion::clip::UpAxis;
use segue_motion::math::quat;

/// The number of values of a frame of `HumanML3D`.
pub(super) const HUMANML: usize = 263;
/// The number of values of a frame of the later form.
pub(super) const LATER: usize = 272;
/// The frame rate of `HumanML3D`, frames per second.
pub(super) const HUMANML_FPS: f64 = 20.0;

/// The first value of the places and of the rotations in the later form.
const PLACES: usize = 8;
const ROTATIONS: usize = PLACES + 6 * BODY_JOINTS;

/// Returns the places of the joints of a view of shape (frames, 263).
pub(super) fn read_humanml(view: &View<'_>, tally: &mut Tally) -> Result<JointPoints, Fault> {
    let values = view.numbers(tally)?;
    let rows = values.chunks_exact(HUMANML);
    // Six numbers for each joint but the root: unit vectors, unless the values are normalised.
    let rotations = 4 + 3 * (BODY_JOINTS - 1);
    let sixes: Vec<f32> = rows
        .clone()
        .flat_map(|row| row[rotations..rotations + 6 * (BODY_JOINTS - 1)].iter().copied())
        .collect();
    turns::from_numbers(&sixes, Form::SixNumbers { rows: false }, tally)?;
    let mut positions = Vec::with_capacity(rows.len() * BODY_JOINTS);
    let (mut half_heading, mut ground) = (0.0_f64, DVec2::ZERO);
    let mut before: Option<&[f32]> = None;
    for row in rows {
        if let Some(before) = before {
            half_heading += f64::from(before[0]);
        }
        // The first value is half the angle, that of a quaternion about Y from the world.
        let world_from_body = glam::DQuat::from_rotation_y(-2.0 * half_heading);
        if let Some(before) = before {
            let step = DVec3::new(f64::from(before[1]), 0.0, f64::from(before[2]));
            let step = world_from_body * step;
            ground += DVec2::new(step.x, step.z);
        }
        positions.push(DVec3::new(ground.x, f64::from(row[3]), ground.y).as_vec3());
        for place in row[4..rotations].chunks_exact(3) {
            let place = world_from_body * Vec3::from_slice(place).as_dvec3();
            positions.push((place + DVec3::new(ground.x, 0.0, ground.y)).as_vec3());
        }
        before = Some(row);
    }
    Ok(JointPoints::of_body(positions, Some(HUMANML_FPS), UpAxis::Y))
}

/// Returns the motion of a view of shape (frames, 272).
pub(super) fn read_later(view: &View<'_>, tally: &mut Tally) -> Result<Take, Fault> {
    let values = view.numbers(tally)?;
    let six = |from: usize, count: usize| -> Vec<f32> {
        let rows = values.chunks_exact(LATER);
        rows.flat_map(|row| row[from..from + 6 * count].iter().copied()).collect()
    };
    let form = Form::SixNumbers { rows: true };
    let heading_steps = turns::from_numbers(&six(2, 1), form, tally)?;
    let local = turns::from_numbers(&six(ROTATIONS, BODY_JOINTS), form, tally)?;
    let places: Vec<Vec3> = values
        .chunks_exact(LATER)
        .flat_map(|row| row[PLACES..PLACES + 3 * BODY_JOINTS].chunks_exact(3))
        .map(Vec3::from_slice)
        .collect();
    let Some(rig) = rigs::of(BODY_JOINTS) else {
        return Err(wrong_shape(view.shape(), "(frames,272)"));
    };
    // Places and rotations are both without the heading, so that the bones follow from them.
    let joints = with_offsets(&offsets(&places, &in_the_world(&local, &rig), &rig), &rig);
    let mut rotations = local;
    let (mut body_from_world, mut ground) = (Quat::IDENTITY, DVec3::ZERO);
    let mut root = Vec::with_capacity(heading_steps.len());
    for (frame, step) in heading_steps.into_iter().enumerate() {
        let Some(row) = values.get(frame * LATER..(frame + 1) * LATER) else { break };
        // The velocity is that of the step to this frame, in the heading of the frame before.
        let velocity = DVec3::new(f64::from(row[0]), 0.0, f64::from(row[1]));
        ground +=
            if frame == 0 { velocity } else { body_from_world.conjugate().as_dquat() * velocity };
        body_from_world = quat::renormalize(step * body_from_world);
        if let Some(turn) = rotations.get_mut(frame * BODY_JOINTS) {
            *turn = body_from_world.conjugate() * *turn;
        }
        let height = f64::from(row[PLACES + 1]);
        root.push(DVec3::new(ground.x, height, ground.z).as_vec3());
    }
    let mut take = Take::new(joints, rotations, root);
    take.up = Some(UpAxis::Y);
    Ok(take)
}

/// Returns the joints of a body with the offsets of a file.
fn with_offsets(offsets: &[Vec3], rig: &[RigJoint]) -> Vec<segue_motion::skeleton::Joint> {
    let mut joints = body::joints(rig.len());
    for (joint, offset) in joints.iter_mut().zip(offsets) {
        joint.offset = *offset;
    }
    joints
}
