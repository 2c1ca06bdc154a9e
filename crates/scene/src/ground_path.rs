//! The trajectory of a result over the ground.

use crate::context::PosedResult;
use crate::{Color, Colors, Layer, Pane};
use segue_session::Outcome;

/// The greatest number of points of a trajectory. It is as long as its clip, and no screen shows
/// more.
pub(crate) const MAX_PATH_POINTS: usize = 600;
/// Duration of the part of a walk's trajectory that is drawn, before and after the present,
/// seconds.
const WALK_PATH_SECS: f64 = 30.0;
/// Height of a trajectory above the ground, metres.
pub(crate) const PATH_HEIGHT_M: f32 = 0.004;

/// Returns the colour of a result at a time: A's where A plays, B's where B does, and the result's
/// between them and where there is no transition.
pub(crate) fn color_at(outcome: &Outcome, secs: f64, colors: &Colors) -> Color {
    match outcome.transition {
        Some(transition) if secs < transition.start_secs => colors.a,
        Some(transition) if secs > transition.end_secs => colors.b,
        _ => colors.result,
    }
}

/// Adds the trajectory of a result, in the colours of the clips that play.
pub(crate) fn add_ground_path(shown: &PosedResult<'_>, colors: &Colors, pane: &mut Pane) {
    let PosedResult { outcome, now, place, .. } = shown;
    let now = *now;
    let frames = outcome.motion.ground_frames();
    let fps = outcome.motion.clip().fps();
    // Only the part of a long walk around the present is drawn.
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
        // The part ahead is fainter than the part behind.
        color[3] *= if outcome.walk().is_some() && secs > now { 0.45 } else { 1.0 };
        Some((place.apply(frames.get(frame)?.origin()).with_y(PATH_HEIGHT_M), color))
    });
    pane.add_path(points, 2.0, Layer::Ground);
}
