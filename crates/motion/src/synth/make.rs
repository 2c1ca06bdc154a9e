//! Conversion of a plan to frames.

use super::arms::arm;
use super::balance::hips;
use super::body::{Body, humanoid, joint};
use super::foot::Foot;
use super::height::{MAX_SWING_LENGTH_SHARE, least_flexion};
use super::leg::leg;
use super::params::{Action, Params, SynthError};
use super::plan::Plan;
use super::planner::plan;
use super::posture::{Posture, Trunk};
use super::track::ramp;
use super::truth::{FootContact, Synthesized, Truth};
use crate::clip::{Clip, ClipError};
use crate::math::curve::soft_limit;
use crate::math::quat::{exp, log, renormalize};
use glam::{Quat, Vec3};

/// Synthesises the motion of `params`.
///
/// The clip begins at the origin, facing +Z, with a left heel strike if it walks or runs. Walks and
/// runs consist of whole cycles and end in the pose in which they began. The same parameters give
/// the same clip.
///
/// # Errors
/// [`SynthError::OutOfRange`] names the first parameter outside its range.
pub fn synthesize(params: &Params) -> Result<Synthesized, SynthError> {
    params.validate()?;
    let skeleton = humanoid(params.height_m)?;
    let body = Body::new(params.height_m);
    let plan = plan(params, &body);
    let posture = Posture::new(&plan, params);
    let missing = ClipError::Length { what: "footholds", found: 0, expected: 2 };
    let moved = hips(&plan, &posture, params, &body).ok_or(missing)?;
    let mut rotations = Vec::with_capacity(plan.frames * joint::COUNT);
    let mut roots = Vec::with_capacity(plan.frames);
    let mut contacts = Vec::with_capacity(plan.frames);
    let mut phase = Vec::with_capacity(plan.frames);
    for frame in 0..plan.frames {
        let step = plan.step_of(frame);
        let secs = plan.secs(step);
        let mut local = [Quat::IDENTITY; joint::COUNT];
        let trunk = posture.trunk(&plan, secs);
        pose_trunk(&trunk, &mut local);
        for side in 0..2 {
            let foot = &moved.feet[step][side];
            let hip = moved.positions[step] + trunk.pelvis * body.hip_in_hips[side];
            let ankle = reachable_ankle(&body, foot, hip, plan.gait.running);
            // The knee points between the directions of hips and toes.
            let hinge = trunk.pelvis * Vec3::X * 0.45
                + Quat::from_rotation_y(foot.yaw as f32) * Vec3::X * 0.55;
            let (thigh, shank) = leg(hip, ankle, body.thigh, body.shank, hinge);
            local[joint::UP_LEG[side]] = trunk.pelvis.conjugate() * thigh;
            local[joint::LEG[side]] = thigh.conjugate() * shank;
            local[joint::FOOT[side]] =
                bent_ankle(shank.conjugate() * foot.rotation, foot, body.ankle_height());
            local[joint::TOE[side]] = Quat::from_rotation_x(foot.toe_bend as f32);
            let arm = arm(&plan, &posture, params, side, secs);
            local[joint::SHOULDER[side]] = shoulder(arm.flexion, posture.breath(secs), side);
            let clavicle = trunk.chest * local[joint::SHOULDER[side]];
            local[joint::ARM[side]] = clavicle.conjugate() * trunk.arms * arm.upper(side);
            local[joint::FORE_ARM[side]] = arm.fore(side);
            local[joint::HAND[side]] = arm.hand(side);
        }
        rotations.extend(local.map(renormalize));
        roots.push(moved.positions[step]);
        contacts.push([0, 1].map(|side| FootContact {
            heel: moved.feet[step][side].heel_down,
            toe: moved.feet[step][side].toe_down,
        }));
        phase.push(plan.cycles(secs).rem_euclid(1.0) as f32);
    }
    let clip = Clip::new(name(params), skeleton, f64::from(params.fps), rotations, roots)?;
    Ok(Synthesized { clip, truth: truth(&plan, params, phase, contacts) })
}

fn truth(plan: &Plan, params: &Params, phase: Vec<f32>, contacts: Vec<[FootContact; 2]>) -> Truth {
    let strides =
        matches!(params.action, Action::Walk | Action::Run | Action::Start | Action::Stop);
    let cycle_secs = plan.gait.cycle_secs;
    let speed = if Params::speed_range(params.action).is_some() {
        f64::from(params.speed_mps)
    } else {
        0.0
    };
    Truth {
        speed_mps: speed as f32,
        turn_rate_dps: if strides { params.turn_rate_dps } else { 0.0 },
        cycle_secs: if strides { cycle_secs as f32 } else { 0.0 },
        cadence_spm: if strides { plan.gait.cadence() as f32 } else { 0.0 },
        stride_m: if strides { (speed * cycle_secs) as f32 } else { 0.0 },
        phase,
        contacts,
    }
}

fn name(params: &Params) -> &'static str {
    match params.action {
        Action::Walk => "Walk",
        Action::Run => "Run",
        Action::Idle => "Stand",
        Action::Start => "Start walking",
        Action::Stop => "Stop walking",
        Action::Spin => "Turn around",
        Action::Jump => "Jump",
    }
}

/// Returns the share `t` of a rotation.
fn share(rotation: Quat, t: f32) -> Quat {
    exp(log(rotation) * t)
}

fn pose_trunk(trunk: &Trunk, local: &mut [Quat; joint::COUNT]) {
    local[joint::HIPS] = trunk.pelvis;
    let bend = trunk.pelvis.conjugate() * trunk.chest;
    // The lumbar spine bends most, the chest least.
    for (index, part) in joint::SPINE.into_iter().zip([0.40, 0.35, 0.25]) {
        local[index] = share(bend, part);
    }
    let look = trunk.chest.conjugate() * trunk.head;
    local[joint::NECK] = share(look, 0.45);
    local[joint::HEAD] = share(look, 0.55);
}

/// Returns the rotation of the collar bone: slightly with the arm, and up with the breath.
fn shoulder(flexion: f64, breath: f64, side: usize) -> Quat {
    let mirror = if side == 0 { 1.0 } else { -1.0 };
    let raised = 0.10 * (flexion - 0.9).max(0.0) + 0.008 * breath;
    Quat::from_rotation_y((-mirror * 0.12 * flexion) as f32)
        * Quat::from_rotation_z((mirror * (raised - 0.05)) as f32)
}

/// Returns the rotation of a foot relative to its shank, limited to the range of an ankle while the
/// foot is well above the ground.
fn bent_ankle(rotation: Quat, foot: &Foot, ankle_height: f32) -> Quat {
    if foot.planted() {
        return rotation;
    }
    let turn = log(rotation);
    let angle = turn.length();
    let high = ramp(f64::from(foot.ankle.y / ankle_height), 2.5, 4.5);
    let free =
        (high * ramp(foot.progress, 0.0, 0.25) * (1.0 - ramp(foot.progress, 0.65, 0.95))) as f32;
    exp(turn * (1.0 + free * (soft_limit(angle, 0.5, 0.9) / angle.max(1e-6) - 1.0)))
}

/// Returns the position of the ankle that a leg can reach: in the air the foot deviates from the
/// plan before the knee is fully straight, close to the ground it does not.
fn reachable_ankle(body: &Body, foot: &Foot, hip: Vec3, running: bool) -> Vec3 {
    if foot.planted() {
        return foot.ankle;
    }
    let line = foot.ankle - hip;
    let length = line.length();
    let (from, to) = if running { (0.955, 0.993) } else { (0.985, MAX_SWING_LENGTH_SHARE) };
    let limited = soft_limit(length, from * body.leg(), to * body.leg());
    let share = ramp(foot.progress, 0.0, 0.14) * (1.0 - ramp(foot.progress, 0.84, 0.98));
    let given = length + (limited - length) * share as f32;
    // Planted legs are never longer than the range that this second limit leaves unchanged, so that
    // nothing jumps when the foot touches the ground.
    let longest = soft_limit(
        given,
        body.reach_at_flexion(least_flexion(running)),
        body.reach_at_flexion(0.02),
    );
    foot.ankle + line * (longest / length.max(1e-6) - 1.0)
}
