//! Marks on a figure: bones, axes, contacts, the chosen joint and its trail.

use crate::context::{DrawContext, PosedResult};
use crate::{Body, Color, Colors, Layer, Lens, Pane, with_alpha};
use glam::Vec3;
use segue_motion::clip::Motion;
use segue_motion::skeleton::WorldPose;
use segue_session::{Key, joint_of};

/// Speed over the ground above which a planted foot is shown as sliding, metres per second.
const SLIDE_MPS: f32 = 0.08;
/// Radius of the ring around the chosen joint, as a share of its distance from the camera: its size
/// on the screen is constant.
const MARK_RADIUS: f32 = 0.011;

/// Marks the chosen joint of a result. Called after the pane has its camera.
pub(crate) fn add_joint_mark(shown: &PosedResult<'_>, context: &DrawContext<'_>, pane: &mut Pane) {
    let motion = &shown.outcome.motion;
    let Some(joint) = joint_of(motion, context.params.text(Key::Joint)) else {
        return;
    };
    if let Some(&at) = shown.world.positions.get(shown.body.drawn_joint(joint)) {
        add_mark(at, context.colors.result, context.look.edge, pane);
    }
}

/// Adds the trajectory of a joint of the figure around the present.
pub(crate) fn add_joint_trail(
    shown: &PosedResult<'_>,
    joint: usize,
    context: &DrawContext<'_>,
    pane: &mut Pane,
) {
    /// Time before and after the present that is shown, seconds.
    const REACH_SECS: f64 = 1.0;
    const STEPS: i32 = 60;
    let motion = &shown.outcome.motion;
    let joint = shown.body.drawn_joint(joint);
    let color = context.colors.result;
    let points = (-STEPS..=STEPS).filter_map(|step| {
        let part = f64::from(step) / f64::from(STEPS);
        let at = shown.now + part * REACH_SECS;
        let inside = (0.0..=motion.clip().duration_secs()).contains(&at);
        let world = inside.then(|| shown.world_at(at, context.session)).flatten()?;
        let position = *world.positions.get(joint)?;
        Some((position, with_alpha(color, 1.0 - 0.85 * part.abs() as f32)))
    });
    pane.add_path(points, 1.75, Layer::Space);
}

/// Adds a dot in a ring on top of everything, facing the camera. Both have an outline that
/// separates them from the body.
fn add_mark(at: Vec3, color: Color, edge: Color, pane: &mut Pane) {
    const CORNERS: u16 = 28;
    let [right, up, _] = pane.camera.axes();
    let seen_from = match pane.camera.lens {
        Lens::Perspective => (at - pane.camera.eye()).length(),
        Lens::Orthographic => pane.camera.distance,
    };
    let radius = MARK_RADIUS * seen_from;
    let corner = |index: u16| {
        let angle = std::f32::consts::TAU * f32::from(index) / f32::from(CORNERS);
        at + (right * angle.cos() + up * angle.sin()) * radius
    };
    for (color, wider) in [(edge, 1.5), (color, 0.0)] {
        // The dot is a line so short that only its round ends are visible.
        pane.add_line(at, at + right * (radius * 1e-3), color, 4.5 + wider, Layer::Over);
        pane.add_path((0..=CORNERS).map(|index| (corner(index), color)), 2.0 + wider, Layer::Over);
    }
}

/// Adds the bones of the figure of `motion` in its pose, each in the colour of the joint of the
/// motion that moves it.
pub(crate) fn add_bones(
    body: &Body,
    motion: &Motion,
    world: &WorldPose,
    color_of: impl Fn(usize) -> Color,
    pane: &mut Pane,
) {
    let color_of = |joint: usize| color_of(body.color_joint(joint));
    if motion.clip().is_of_points() {
        for (joint, &at) in world.positions.iter().enumerate().skip(1) {
            // A line so short that only its round ends are visible.
            pane.add_line(at, at + Vec3::Y * 1e-4, color_of(joint), 4.0, Layer::Over);
        }
        return;
    }
    let (skeleton, _) = body.drawn_rig((motion.clip().skeleton(), motion.roles()));
    for (index, joint) in skeleton.joints().iter().enumerate() {
        if let Some(parent) = joint.parent {
            let (from, to) = (world.positions[parent], world.positions[index]);
            pane.add_line(from, to, color_of(parent), 2.0, Layer::Over);
        }
        if let Some(end) = joint.end_site {
            pane.add_line(
                world.positions[index],
                world.point(index, end),
                with_alpha(color_of(index), 0.6),
                2.0,
                Layer::Over,
            );
        }
    }
}

/// Adds the three axes of every joint.
pub(crate) fn add_axes(world: &WorldPose, colors: &Colors, pane: &mut Pane) {
    const LENGTH_M: f32 = 0.07;
    for (&position, &rotation) in world.positions.iter().zip(&world.rotations) {
        for (axis, color) in [(Vec3::X, colors.bad), (Vec3::Y, colors.result), (Vec3::Z, colors.b)]
        {
            pane.add_line(position, position + rotation * axis * LENGTH_M, color, 1.5, Layer::Over);
        }
    }
}

/// Adds a ring under each planted foot of the figure, in the colour of an error where it slides.
pub(crate) fn add_contacts(shown: &PosedResult<'_>, context: &DrawContext<'_>, pane: &mut Pane) {
    let PosedResult { outcome, now, world, body, .. } = shown;
    let (motion, colors) = (&outcome.motion, context.colors);
    let frame = segue_session::frame_at(motion, *now);
    let dt = motion.clip().dt_secs();
    let contacts = motion.contacts();
    if !contacts.feet().iter().any(|&foot| contacts.planted(foot, frame)) {
        return;
    }
    let (skeleton, roles) = body.drawn_rig((motion.clip().skeleton(), motion.roles()));
    let earlier = shown.world_at(now - f64::from(dt), context.session);
    for &foot in contacts.feet() {
        if !contacts.planted(foot, frame) {
            continue;
        }
        let [_, _, end] = foot.leg();
        let (Some(joint), Some(foot)) = (roles.ball_or_ankle(skeleton, foot), roles.get(end))
        else {
            continue;
        };
        let (Some(&toe), Some(&ankle)) = (world.positions.get(joint), world.positions.get(foot))
        else {
            continue;
        };
        let before =
            earlier.as_ref().and_then(|world| world.positions.get(joint).copied()).unwrap_or(toe);
        let slides = (toe - before).with_y(0.0).length() / dt > SLIDE_MPS;
        let middle = toe.lerp(ankle, 0.35).with_y(0.0);
        pane.add_contact(middle, if slides { colors.bad } else { colors.result }, slides);
    }
}
