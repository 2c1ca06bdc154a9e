//! The way of a result over the ground.

use crate::context::Shown;
use crate::{Color, Colors, Layer, Pane};
use segue_session::Outcome;

/// Points of a path, at most. A path is as long as its clip, and no screen shows more.
pub(crate) const MAX_PATH_POINTS: usize = 600;
/// Length of the part of a walk's path that is drawn, behind it and before it, seconds.
const WALK_PATH_SECS: f64 = 30.0;
/// Height of a path above the ground, metres.
pub(crate) const PATH_HEIGHT_M: f32 = 0.004;

/// Returns the colour of a result at a time: warm where A plays, cool where B does, the accent
/// between them and where there is no transition.
pub(crate) fn color_at(outcome: &Outcome, secs: f64, colors: &Colors) -> Color {
    match outcome.transition {
        Some(transition) if secs < transition.start_secs => colors.a,
        Some(transition) if secs > transition.end_secs => colors.b,
        _ => colors.result,
    }
}

/// Adds the way of a result, in the colours of what plays.
pub(crate) fn add_ground_path(shown: &Shown<'_>, colors: &Colors, pane: &mut Pane) {
    let Shown { outcome, now, place, .. } = shown;
    let now = *now;
    let frames = outcome.motion.ground_frames();
    let fps = outcome.motion.clip().fps();
    // Of a long walk only the part around the present.
    let near = match outcome.walk() {
        Some(walk) if !walk.is_jump && walk.followed.is_none() => {
            let frame = |secs: f64| ((secs.max(0.0) * fps) as usize).min(frames.len());
            frame(now - WALK_PATH_SECS)..frame(now + WALK_PATH_SECS)
        }
        _ => 0..frames.len(),
    };
    let stride = near.len().div_ceil(MAX_PATH_POINTS).max(1);
    let points = near.step_by(stride).filter_map(|frame| {
        let secs = frame as f64 / fps;
        let mut color = color_at(outcome, secs, colors);
        // The way ahead is fainter than the way behind.
        color[3] *= if outcome.walk().is_some() && secs > now { 0.45 } else { 1.0 };
        Some((place.apply(frames.get(frame)?.origin()).with_y(PATH_HEIGHT_M), color))
    });
    pane.add_path(points, 2.0, Layer::Ground);
}
