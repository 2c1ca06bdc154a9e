//! The Register lab: a pair of frames, and both sources beside the result.

use crate::context::{DrawContext, GHOST_FADE_SECS, PosedResult};
use crate::ground_path::add_ground_path;
use crate::{Pane, with_alpha};
use segue_motion::math::Planar;
use segue_session::{DistanceMap, Key, Slot};

/// Distance to the left and right of a registered result at which its sources are shown, metres.
const BESIDE_METRES: f64 = 0.8;

/// Adds a frame of A and a frame of B aligned with it, at the position of the result.
pub(crate) fn add_pair(
    shown: &PosedResult<'_>,
    frames: [f64; 2],
    map: &DistanceMap,
    context: &mut DrawContext<'_>,
    pane: &mut Pane,
) {
    let colors = context.colors;
    let [a, b] = map.motions();
    let secs = frames.map(|frame| frame / map.fps());
    let world_from_a = shown.standing().after(&a.standing_at(secs[0]).inverse());
    let world_from_b = world_from_a.after(&map.b_on_a(frames).unwrap_or(Planar::IDENTITY));
    for (motion, secs, place, color) in
        [(a, secs[0], world_from_a, colors.a), (b, secs[1], world_from_b, colors.b)]
    {
        let color = context.lone_ghost(color, 1.0);
        context.add_ghost(motion, secs, &place, color, pane);
    }
    if context.params.is_on(Key::Trail) {
        add_ground_path(shown, colors, pane);
    }
}

/// Adds both sources beside a registered result near the transition, in the frames that it mixes.
pub(crate) fn add_sources_beside(
    shown: &PosedResult<'_>,
    context: &mut DrawContext<'_>,
    pane: &mut Pane,
) {
    let PosedResult { outcome, now, place, .. } = shown;
    let away = outcome.transition.map_or(0.0, |transition| {
        (transition.start_secs - now).max(now - transition.end_secs).max(0.0) / GHOST_FADE_SECS
    });
    let visible = (1.0 - away).max(0.0) as f32;
    if visible <= 0.02 {
        return;
    }
    for source in &outcome.sources {
        let side = match source.slot {
            Slot::A => BESIDE_METRES,
            Slot::B => -BESIDE_METRES,
        };
        let Some((at, world_from_clip)) = outcome.source_at(source, *now) else {
            continue;
        };
        let aside = Planar::new(0.0, side, 0.0);
        let stands = outcome.motion.standing_at(*now);
        let beside =
            place.after(&stands).after(&aside).after(&stands.inverse()).after(&world_from_clip);
        let color = context.colors.of_slot(source.slot);
        let color = with_alpha(color, context.colors.ghost_alpha * visible);
        context.add_ghost(&source.motion, at, &beside, color, pane);
    }
}
