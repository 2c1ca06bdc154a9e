//! The Match lab: the recorded and the desired trajectory, the trajectory of the frame that plays,
//! and the crowd.

use crate::context::{DrawContext, PosedResult};
use crate::extra_characters::add_character;
use crate::{Body, Color, Colors, Layer, Pane, Ring, with_alpha};
use segue_motion::math::Planar;
use segue_motion::skeleton::{WorldPose, world_pose, world_pose_into};
use segue_session::{DriveHistory, DriveMoment, Key};

/// Number of segments of a trajectory.
const SEGMENTS: usize = 20;
/// The greatest number of points of the recorded trajectory.
const MAX_RECORDED_POINTS: usize = 600;
/// Height of the recorded trajectory above the ground, metres; the lowest of the three.
const RECORDED_HEIGHT_M: f32 = 0.003;
/// Height of the trajectory of the frame that plays above the ground, metres.
const MATCHED_HEIGHT_M: f32 = 0.006;
/// Height of the desired trajectory above the ground, metres.
const DESIRED_HEIGHT_M: f32 = 0.009;
/// Length of the line that shows a facing, metres.
const FACING_M: f32 = 0.22;
/// Share of its own colour in the body colour of a character of the crowd.
const CROWD_SHARE: f32 = 0.3;

/// Adds the driven character's trajectories and the candidate under the pointer.
pub(crate) fn add_driven(
    driven: &DriveHistory,
    now_secs: f64,
    body: &Body,
    context: &DrawContext<'_>,
    pane: &mut Pane,
) {
    let Some(moment) = driven.at(now_secs) else {
        return;
    };
    if context.params.is_on(Key::Trail) {
        add_trajectories(driven, moment, context.colors, pane);
    }
    if let Some(candidate) = context.highlights.candidate
        && let Some(pose) = driven.database.pose(candidate, &moment.root)
    {
        let ghost = world_pose(driven.database.skeleton(), &pose);
        pane.add_ghost(body, &body.drawn_pose(ghost), context.lone_ghost(context.colors.b, 1.0));
    }
}

/// Adds the characters of the crowd around the driven one.
pub(crate) fn add_crowd(shown: &PosedResult<'_>, context: &mut DrawContext<'_>, pane: &mut Pane) {
    let Some((database, poses)) = context.session.crowd() else {
        return;
    };
    let motion = &shown.outcome.motion;
    let skeleton = database.skeleton();
    if motion.clip().skeleton() != skeleton {
        return;
    }
    let body = context.bodies.body(motion);
    let others = &context.colors.others;
    let mut world = WorldPose::default();
    for (index, pose) in poses.into_iter().enumerate() {
        let color = others[index % others.len()];
        let moved = pose.translations.iter().copied();
        world_pose_into(skeleton, pose.root_translation, &pose.rotations, moved, &mut world);
        add_character(
            motion,
            &body.drawn_pose(world.clone()),
            &body,
            (color, CROWD_SHARE),
            context,
            pane,
        );
    }
}

/// Adds trajectories on the ground: desired ones in A's colour, that of the frame that plays in
/// B's.
fn add_trajectories(driven: &DriveHistory, moment: &DriveMoment, colors: &Colors, pane: &mut Pane) {
    let stride = driven.moments.len().div_ceil(MAX_RECORDED_POINTS).max(1);
    let recorded = driven.moments.iter().step_by(stride);
    pane.add_dashed_path(
        recorded.map(|moment| moment.simulation.place().origin().with_y(RECORDED_HEIGHT_M)),
        with_alpha(colors.a, 0.4),
        0.05,
        1.5,
        Layer::Ground,
    );
    let trajectories = [
        (driven.matched_path(moment, SEGMENTS), colors.b, MATCHED_HEIGHT_M),
        (driven.requested_path(moment, SEGMENTS), colors.a, DESIRED_HEIGHT_M),
    ];
    for (trajectory, color, height) in trajectories {
        add_trajectory(driven, &trajectory, color, height, pane);
    }
    add_simulation(moment, colors, pane);
}

/// Adds a trajectory with the facings at the trajectory times.
fn add_trajectory(
    driven: &DriveHistory,
    trajectory: &[Planar],
    color: Color,
    height: f32,
    pane: &mut Pane,
) {
    pane.add_path(
        trajectory.iter().map(|place| (place.origin().with_y(height), color)),
        2.5,
        Layer::Ground,
    );
    let layout = driven.database.features().layout();
    let horizon = layout.horizon().max(1);
    for ahead in layout.ahead() {
        if let Some(place) = trajectory.get(ahead * (trajectory.len().saturating_sub(1)) / horizon)
        {
            let from = place.origin().with_y(height);
            pane.add_line(from, from + place.forward() * FACING_M, color, 2.0, Layer::Ground);
            // A line so short that only its round ends are visible.
            pane.add_line(from, from + place.forward() * 1e-3, color, 7.0, Layer::Ground);
        }
    }
}

/// Adds the simulation object: a ring with a line in the direction of its facing.
fn add_simulation(moment: &DriveMoment, colors: &Colors, pane: &mut Pane) {
    let place = moment.simulation.place();
    let radius = 0.2;
    pane.rings.push(Ring {
        center: place.origin(),
        radius,
        width: 0.014,
        color: with_alpha(colors.a, 0.9),
        fill: 0.06,
    });
    let rim = place.origin().with_y(DESIRED_HEIGHT_M) + place.forward() * radius;
    pane.add_line(rim, rim + place.forward() * (0.5 * FACING_M), colors.a, 3.0, Layer::Ground);
}
