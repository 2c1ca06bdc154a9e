//! The Path lab: the original trajectory, the path that was fitted to it, the edited path, and its
//! control points.

use crate::{Color, Colors, Layer, Look, Pane, PathMarks, with_alpha};
use glam::{DVec2, Vec3};
use segue_motion::path::{ArcLengthPath, Waypoint};
use segue_session::PathFacts;

/// Number of points of a curve per control point.
const POINTS_PER_CONTROL_POINT: usize = 24;
/// Time between two of the lines that show the residual of the fit, seconds.
const RESIDUAL_SECS: f64 = 0.1;
/// The greatest number of lines that show the residual of the fit.
const MAX_RESIDUALS: usize = 400;
/// Height of the original trajectory above the ground, metres; the lowest of the three.
const ORIGINAL_HEIGHT_M: f32 = 0.003;
/// Height of the fitted path above the ground, metres.
const FITTED_HEIGHT_M: f32 = 0.005;
/// Height of the edited path above the ground, metres.
const EDITED_HEIGHT_M: f32 = 0.007;
/// Radius of a control point, points.
const HANDLE_RADIUS: f32 = 6.0;

/// Adds the trajectories and paths to a pane whose camera is set later. Control points are lines in
/// the ground plane on top of everything.
pub(crate) fn add_path(
    path: &PathFacts,
    marks: &PathMarks,
    look: &Look,
    colors: &Colors,
    pane: &mut Pane,
) {
    add_original(path, colors, pane);
    add_edited(path, colors, pane);
    if marks.handles {
        let points = path.curve.spline().points();
        pane.add_dashed_path(
            points.iter().map(|&point| on_ground(point, FITTED_HEIGHT_M)),
            with_alpha(look.clay, 0.45),
            0.06,
            1.0,
            Layer::Ground,
        );
        for (index, &point) in points.iter().enumerate() {
            let (chosen, hovered) = (marks.chosen == Some(index), marks.hovered == Some(index));
            let radius = if chosen || hovered { HANDLE_RADIUS + 1.5 } else { HANDLE_RADIUS };
            let inside = if chosen || hovered { colors.result } else { look.background_top };
            add_dot(point, radius, if chosen { contrast(look) } else { colors.result }, pane);
            add_dot(point, radius - 2.0, inside, pane);
        }
        if let Some(place) = marks.place {
            add_dot(place, HANDLE_RADIUS - 1.0, with_alpha(colors.result, 0.7), pane);
        }
    }
}

/// Adds the curve that is being drawn.
pub(crate) fn add_drawn(marks: &PathMarks, colors: &Colors, pane: &mut Pane) {
    let drawn = marks.drawn.iter().map(|&point| (on_ground(point, EDITED_HEIGHT_M), colors.result));
    pane.add_path(drawn, 3.0, Layer::Over);
}

/// Adds the trajectory of the hips in A's colour, the path fitted to it, and short lines between
/// both: the residual.
fn add_original(path: &PathFacts, colors: &Colors, pane: &mut Pane) {
    let (motion, places) = (path.fitted.motion(), path.fitted.places());
    let strength = if path.is_edited { 0.6 } else { 1.0 };
    let trajectory = motion.ground_frames().iter();
    let stride = motion.ground_frames().len().div_ceil(1200).max(1);
    let faint = with_alpha(colors.a, 0.45 * strength);
    pane.add_path(
        trajectory
            .clone()
            .step_by(stride)
            .map(|place| (place.origin().with_y(ORIGINAL_HEIGHT_M), faint)),
        1.5,
        Layer::Ground,
    );
    if path.is_edited {
        let fitted = places_along(path.fitted.curve())
            .into_iter()
            .map(|place| on_ground(place.frame.shift, FITTED_HEIGHT_M));
        pane.add_dashed_path(fitted, with_alpha(colors.a, 0.8), 0.08, 1.5, Layer::Ground);
    }
    let apart = (motion.clip().fps() * RESIDUAL_SECS)
        .max(places.len() as f64 / MAX_RESIDUALS as f64)
        .max(1.0) as usize;
    for (place, character) in places.iter().zip(trajectory).step_by(apart) {
        let from = on_ground(place.frame.shift, ORIGINAL_HEIGHT_M);
        pane.add_line(
            from,
            character.origin().with_y(ORIGINAL_HEIGHT_M),
            with_alpha(colors.a, 0.8 * strength),
            1.0,
            Layer::Ground,
        );
    }
}

/// Adds the edited path, in the colour of a warning where it turns too sharply.
fn add_edited(path: &PathFacts, colors: &Colors, pane: &mut Pane) {
    let places = places_along(&path.curve);
    pane.add_path(
        places.iter().map(|place| (on_ground(place.frame.shift, EDITED_HEIGHT_M), colors.result)),
        2.5,
        Layer::Ground,
    );
    for turn in &path.hard_turns {
        let Some(frames) = path.places.get(turn.frames.start.saturating_sub(1)..turn.frames.end)
        else {
            continue;
        };
        let hard = frames
            .iter()
            .map(|place| (on_ground(place.frame.shift, EDITED_HEIGHT_M + 0.002), colors.warning));
        pane.add_path(hard, 6.0, Layer::Ground);
    }
    // An arrow head shows its direction.
    if let Some(end) = places.last() {
        let tip = on_ground(end.frame.shift, EDITED_HEIGHT_M);
        let ahead = end.frame.forward();
        let left = Vec3::new(ahead.z, 0.0, -ahead.x);
        for side in [-1.0, 1.0] {
            pane.add_line(
                tip,
                tip - ahead * 0.16 + left * (0.09 * side),
                colors.result,
                2.5,
                Layer::Ground,
            );
        }
    }
}

/// Returns a colour that contrasts with the ground.
fn contrast(look: &Look) -> Color {
    let is_light = look.background_top[1] > 0.5;
    with_alpha(if is_light { look.edge } else { look.clay }, 1.0)
}

/// Returns evenly spaced points of a path.
fn places_along(curve: &ArcLengthPath) -> Vec<Waypoint> {
    curve.evenly(curve.spline().points().len() * POINTS_PER_CONTROL_POINT)
}

fn on_ground(point: DVec2, height: f32) -> Vec3 {
    Vec3::new(point.x as f32, height, point.y as f32)
}

/// Adds a dot: a line so short that only its round ends are visible.
fn add_dot(point: DVec2, radius: f32, color: Color, pane: &mut Pane) {
    let at = on_ground(point, EDITED_HEIGHT_M);
    pane.add_line(at, at + Vec3::X * 1e-4, color, 2.0 * radius, Layer::Over);
}
