//! The Match lab: where the character was asked to be, where it is asked to go, where the frame
//! that plays would lead, and the crowd around it.

use crate::context::{DrawContext, Shown};
use crate::extra_characters::add_character;
use crate::{Body, Color, Colors, Layer, Pane, Ring, with_alpha};
use segue_motion::math::Planar;
use segue_motion::skeleton::{WorldPose, world_pose, world_pose_into};
use segue_session::{DriveMoment, Driven, Key};

/// Pieces of a trajectory.
const STEPS: usize = 20;
/// Points of the way that was asked for, at most.
const MAX_WAY_POINTS: usize = 600;
/// Height above the ground of the way that was asked for, metres; the other lines lie above it.
const LOWEST: f32 = 0.003;
/// Height above the ground of the way that the frame leads, metres.
const MIDDLE: f32 = 0.006;
/// Height above the ground of the way that is asked for, metres.
const HIGHEST: f32 = 0.009;
/// Length of the line that says what is faced, metres.
const FACING_M: f32 = 0.22;
/// Share of its own colour in the clay of a character of the crowd.
const CROWD_SHARE: f32 = 0.3;

/// Adds what is driven: the ways on the ground, and the candidate under the pointer.
pub(crate) fn add_driven(
    driven: &Driven,
    now_secs: f64,
    body: &Body,
    context: &DrawContext<'_>,
    pane: &mut Pane,
) {
    let Some(moment) = driven.at(now_secs) else {
        return;
    };
    if context.params.is_on(Key::Trail) {
        add_ways(driven, moment, context.colors, pane);
    }
    if let Some(candidate) = context.highlights.candidate
        && let Some(pose) = driven.database.pose(candidate, &moment.root)
    {
        let ghost = world_pose(driven.database.skeleton(), &pose);
        pane.add_ghost(body, &ghost, context.lone_ghost(context.colors.b, 1.0));
    }
}

/// Adds the characters that walk around the one that is driven.
pub(crate) fn add_crowd(shown: &Shown<'_>, context: &mut DrawContext<'_>, pane: &mut Pane) {
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
        add_character(motion, &world, &body, (color, CROWD_SHARE), context, pane);
    }
}

/// Adds the ways on the ground: what is asked for in A's colour, what the frame leads to in B's.
fn add_ways(driven: &Driven, moment: &DriveMoment, colors: &Colors, pane: &mut Pane) {
    let stride = driven.moments.len().div_ceil(MAX_WAY_POINTS).max(1);
    let asked = driven.moments.iter().step_by(stride);
    pane.add_dashed_path(
        asked.map(|moment| moment.simulation.place().origin().with_y(LOWEST)),
        with_alpha(colors.a, 0.4),
        0.05,
        1.5,
        Layer::Ground,
    );
    let ways = [
        (driven.matched_way(moment, STEPS), colors.b, MIDDLE),
        (driven.asked_way(moment, STEPS), colors.a, HIGHEST),
    ];
    for (way, color, height) in ways {
        add_way(driven, &way, color, height, pane);
    }
    add_simulation(moment, colors, pane);
}

/// Adds a trajectory, with what is faced at the times that are compared.
fn add_way(driven: &Driven, way: &[Planar], color: Color, height: f32, pane: &mut Pane) {
    pane.add_path(
        way.iter().map(|place| (place.origin().with_y(height), color)),
        2.5,
        Layer::Ground,
    );
    let layout = driven.database.features().layout();
    let horizon = layout.horizon().max(1);
    for ahead in layout.ahead() {
        if let Some(place) = way.get(ahead * (way.len().saturating_sub(1)) / horizon) {
            let from = place.origin().with_y(height);
            pane.add_line(from, from + place.forward() * FACING_M, color, 2.0, Layer::Ground);
            // A line so short that only its round ends are seen.
            pane.add_line(from, from + place.forward() * 1e-3, color, 7.0, Layer::Ground);
        }
    }
}

/// Adds the simulation object: a ring that looks ahead.
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
    let rim = place.origin().with_y(HIGHEST) + place.forward() * radius;
    pane.add_line(rim, rim + place.forward() * (0.5 * FACING_M), colors.a, 3.0, Layer::Ground);
}
