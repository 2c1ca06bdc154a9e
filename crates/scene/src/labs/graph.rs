//! The Graph lab: the windows of a transition, the clips of a walk, and the line that it is to
//! follow.

use crate::context::{DrawContext, GHOST_FADE_SECS, PosedResult};
use crate::{Layer, Pane, with_alpha};
use glam::Vec3;
use segue_motion::graph::Place;
use segue_session::{BuiltGraph, Walk};

/// Adds both windows of a transition at the position of the result: their first, middle and last
/// frame.
pub(crate) fn add_jump(
    shown: &PosedResult<'_>,
    [leave, enter]: [Place; 2],
    built: &BuiltGraph,
    context: &mut DrawContext<'_>,
    pane: &mut Pane,
) {
    let Some(jump) = built.jump_of(leave, enter).and_then(|index| built.whole().jumps().get(index))
    else {
        return;
    };
    let motions = built.clips().motions();
    let (Some(a), Some(b)) = (motions.get(leave.clip), motions.get(enter.clip)) else {
        return;
    };
    let last = jump.window.saturating_sub(1);
    let fps = a.clip().fps();
    let secs = |frame: usize| frame as f64 / fps;
    let middle = a.standing_at(secs(leave.frame + last / 2));
    let world_from_a = shown.standing().after(&middle.inverse());
    let world_from_b = world_from_a.after(&jump.alignment);
    for (step, clear) in [(0, 0.55), (last, 0.55), (last / 2, 1.0)] {
        for (motion, from, place, color) in [
            (a, leave.frame, &world_from_a, context.colors.a),
            (b, enter.frame, &world_from_b, context.colors.b),
        ] {
            let color = context.lone_ghost(color, clear);
            context.add_ghost(motion, secs(from + step), place, color, pane);
        }
    }
}

/// Adds the clips of a walk around a transition.
pub(crate) fn add_walk_sources(
    shown: &PosedResult<'_>,
    walk: &Walk,
    context: &mut DrawContext<'_>,
    pane: &mut Pane,
) {
    let colors = context.colors;
    let ghosts = walk.ghosts_at(shown.now, GHOST_FADE_SECS);
    for (ghost, color) in ghosts.into_iter().zip([colors.a, colors.b]) {
        let Some(ghost) = ghost else { continue };
        let color = with_alpha(color, colors.ghost_alpha * ghost.clear as f32);
        let place = shown.place.after(&ghost.world_from_clip);
        context.add_ghost(ghost.motion, ghost.secs, &place, color, pane);
    }
}

/// Adds the line that a walk is to follow.
pub(crate) fn add_asked_path(context: &DrawContext<'_>, pane: &mut Pane) {
    let points = context.session.graph_path().iter().copied();
    let points = points.map(|point| Vec3::new(point.x as f32, 0.006, point.y as f32));
    pane.add_dashed_path(points, context.colors.b, 0.12, 2.5, Layer::Ground);
}
