//! The source clips of a result, as ghosts.

use crate::context::{DrawContext, GHOST_FADE_SECS, PosedResult};
use crate::{Pane, labs, with_alpha};
use segue_session::Slot;

/// Adds both sources around the transition, with an opacity by their difference from the result: A
/// fades in as its weight falls, B fades out as its weight rises.
pub(crate) fn add_sources(shown: &PosedResult<'_>, context: &mut DrawContext<'_>, pane: &mut Pane) {
    let PosedResult { outcome, now, place, .. } = shown;
    let ghost_alpha = context.colors.ghost_alpha;
    if let Some(walk) = outcome.walk().filter(|walk| !walk.is_jump) {
        labs::graph::add_walk_sources(shown, walk, context, pane);
        return;
    }
    if outcome.registered().is_some() {
        labs::register::add_sources_beside(shown, context, pane);
        return;
    }
    let Some(transition) = outcome.transition else {
        return;
    };
    let length = transition.end_secs - transition.start_secs;
    let inside = ((now - transition.start_secs) / length.max(1e-6)).clamp(0.0, 1.0);
    let before = ((transition.start_secs - now) / GHOST_FADE_SECS).max(0.0);
    let behind = ((now - transition.end_secs) / GHOST_FADE_SECS).max(0.0);
    for source in &outcome.sources {
        let at = now - source.starts_at_secs;
        let share = match source.slot {
            Slot::A => inside * (1.0 - behind),
            Slot::B => (1.0 - inside) * (1.0 - before),
        };
        // A ghost is fully opaque from halfway on: it must be invisible only where it coincides
        // with the result.
        let share = (2.0 * share).clamp(0.0, 1.0) as f32;
        if share < 0.02 || !(0.0..=source.motion.clip().duration_secs()).contains(&at) {
            continue;
        }
        let color = with_alpha(context.colors.of_slot(source.slot), ghost_alpha * share);
        context.add_ghost(&source.motion, at, &place.after(&source.world_from_clip), color, pane);
    }
}

/// Adds the source clips of a refused result in its place.
pub(crate) fn add_stand_ins(
    refused: &segue_session::Pane,
    now: f64,
    context: &mut DrawContext<'_>,
    pane: &mut Pane,
) {
    for source in &refused.sources {
        let color = context.colors.of_slot(source.slot);
        let color = with_alpha(color, context.colors.ghost_alpha);
        let at = now.min(source.motion.clip().duration_secs());
        context.add_ghost(&source.motion, at, &source.world_from_clip, color, pane);
    }
}
