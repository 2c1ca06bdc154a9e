//! A result: its figure, ghosts of earlier and later frames, and annotations.

use crate::annotations::{add_axes, add_bones, add_contacts, add_joint_trail};
use crate::context::{DrawContext, PosedResult};
use crate::ground_path::{add_ground_path, color_at};
use crate::hinges::{hinge_color, hinge_states, limb_color};
use crate::posing::twisted;
use crate::{Pane, labs, sources, with_alpha};
use segue_session::choices::Look;
use segue_session::{Key, joint_of};

/// Opacity of a body whose bones are shown.
const GLASS_ALPHA: f32 = 0.5;

/// Adds a result in its current pose, with everything that the parameters show of it.
pub(crate) fn add_result(shown: &PosedResult<'_>, context: &mut DrawContext<'_>, pane: &mut Pane) {
    let PosedResult { outcome, now, body, .. } = shown;
    let (params, look, colors) = (context.params, context.look, context.colors);
    let motion = &outcome.motion;
    let rig = body.drawn_rig((motion.clip().skeleton(), motion.roles()));
    let twisted = twisted(rig, &shown.world, params.number(Key::Twist));
    let world = twisted.as_ref().unwrap_or(&shown.world);
    let figure = params.choice::<Look>();
    let hinges = hinge_states(motion, *now);
    match (figure, outcome.layer().filter(|_| params.is_on(Key::MaskColors))) {
        (Look::Bones, _) => {}
        (Look::Both, _) => pane.add_glass(body, world, with_alpha(look.clay, GLASS_ALPHA)),
        (_, Some(layer)) => pane.add_colored_body(body, world, |joint| {
            labs::layers::share_color(layer, joint, look, colors)
        }),
        (_, None) if hinges.is_empty() => pane.add_body(body, world, look.clay),
        (_, None) => {
            pane.add_colored_body(body, world, |joint| limb_color(&hinges, joint, look, colors));
        }
    }
    if matches!(figure, Look::Bones | Look::Both) {
        let color_of = |joint| hinge_color(&hinges, joint, colors).unwrap_or(colors.result);
        add_bones(body, motion, world, color_of, pane);
    }
    if params.is_on(Key::Axes) {
        add_axes(world, colors, pane);
    }
    if params.is_on(Key::Sources) {
        sources::add_sources(shown, context, pane);
    }
    add_onion_skin(shown, context, pane);
    if let Some(path) = outcome.path() {
        labs::path::add_path(path, &context.highlights.path, look, colors, pane);
    } else if params.is_on(Key::Trail) {
        add_ground_path(shown, colors, pane);
    }
    if let Some(driven) = outcome.driven() {
        labs::match_::add_driven(driven, *now, body, context, pane);
    }
    if params.is_on(Key::JointTrail)
        && let Some(joint) = joint_of(motion, params.text(Key::Joint))
    {
        add_joint_trail(shown, joint, context, pane);
    }
    if params.is_on(Key::Contacts) {
        add_contacts(shown, context, pane);
    }
}

/// Adds the ghosts of the result at some earlier and later times.
fn add_onion_skin(shown: &PosedResult<'_>, context: &mut DrawContext<'_>, pane: &mut Pane) {
    let PosedResult { outcome, now, place, .. } = shown;
    let (params, colors) = (context.params, context.colors);
    let count = params.number(Key::Ghosts) as i32;
    for step in (-count..=count).filter(|&step| step != 0) {
        let at = now + f64::from(step) * params.number(Key::GhostStep);
        if (0.0..=outcome.duration_secs()).contains(&at) {
            let fade = 1.0 - (step.abs() - 1) as f32 / count as f32;
            let color = with_alpha(color_at(outcome, at, colors), colors.ghost_alpha * 0.7 * fade);
            context.add_ghost(&outcome.motion, at, place, color, pane);
        }
    }
}
