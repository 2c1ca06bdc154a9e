//! The size of figures, and the view of them.

use crate::body_cache::{shown_character, size_beside};
use crate::{Camera, Lens};
use glam::Vec3;
use segue_motion::clip::Motion;
use segue_motion::math::Planar;
use segue_motion::skin::SkinnedMesh;
use segue_session::choices;
use segue_session::{Key, Outcome, Params, Session};
use std::ops::RangeInclusive;

/// Returns the ratio of a figure's visible size to that of its motion: the height set in the
/// parameters, times the own size of a character.
///
/// The figure is drawn in the size and at the position of its motion, and the world around it is
/// scaled instead: the camera is nearer, and the cells of the grid are smaller. Steps, path and
/// everything drawn with the figure therefore scale with it, and planted feet stay planted: foot
/// skating is neither added nor hidden.
#[must_use]
pub fn shown_size(session: &Session, motion: &Motion) -> f32 {
    let character = shown_character(session).and_then(|character| size_beside(&character, motion));
    character.unwrap_or(1.0) * figure_height(session.params())
}

/// The heights of figures that the distance of the parameters is meant for, metres: people.
const USUAL_HEIGHTS: RangeInclusive<f32> = 1.1..=2.2;
/// The share of a standing figure's height that is above the picture's centre.
const SHARE_ABOVE: f32 = 0.6;

/// Returns the ratio by which the camera is farther from a figure than the parameters say, so that
/// a giant stands whole in the picture and a mouse can be seen: 1 for the heights of people.
/// `height` is the figure's, metres.
pub(crate) fn farther(height: f32) -> f32 {
    let usual = height.clamp(*USUAL_HEIGHTS.start(), *USUAL_HEIGHTS.end());
    if height.is_finite() && height > 0.0 { height / usual } else { 1.0 }
}

/// Returns the ratio by which the camera is farther from the figure of a motion than the
/// parameters say ([`shown_size`] has the ratio by which the figure is larger).
#[must_use]
pub fn view_size(session: &Session, motion: &Motion) -> f32 {
    let character = shown_character(session)
        .and_then(|character| Some((size_beside(&character, motion)?, reach_of(&character.mesh))));
    let (size, reach) = character.unwrap_or((1.0, 0.0));
    farther(height_in_view(motion, reach / size) * size)
}

/// Returns the height of the picture that a figure needs, metres in the size of its motion. `reach`
/// is that of its mesh, 0 without one.
pub(crate) fn height_in_view(motion: &Motion, reach: f32) -> f32 {
    let height = motion.body_height();
    height.max((reach - middle_height(motion)) / SHARE_ABOVE)
}

/// Returns how far a mesh reaches above the ground, or to a side where that is farther, metres. It
/// is bound in a pose that stands.
pub(crate) fn reach_of(mesh: &SkinnedMesh) -> f32 {
    let reach = |at: &Vec3| at.y.max(at.x.abs()).max(at.z.abs());
    mesh.positions.iter().map(reach).fold(0.0, f32::max)
}

/// Returns the ratio of the height set in the parameters to the figure's own.
pub(crate) fn figure_height(params: &Params) -> f32 {
    (params.number(Key::FigureHeight) as f32).max(0.1)
}

/// Returns the camera that the parameters describe. Its distance is multiplied by `scale`, which is
/// [`view_size`] over [`shown_size`] for a figure. Its target is the default one.
#[must_use]
pub fn camera_of(params: &Params, scale: f32) -> Camera {
    let from_above = params.choice::<choices::Camera>() == choices::Camera::Top;
    Camera {
        yaw: params.number(Key::CameraYaw).to_radians() as f32,
        pitch: if from_above {
            std::f32::consts::FRAC_PI_2
        } else {
            params.number(Key::CameraPitch).to_radians() as f32
        },
        distance: params.number(Key::CameraDistance) as f32 * scale,
        lens: if from_above { Lens::Orthographic } else { Lens::Perspective },
        ..Camera::default()
    }
}

/// Returns the target of a camera that follows no character: the beginning of the motion, which is
/// placed by `place`. For a motion on an edited path it is the beginning before the edit, so that
/// the ground does not move with the path.
#[must_use]
pub fn resting_point(outcome: &Outcome, place: &Planar) -> Vec3 {
    let motion = outcome.path().map_or(&outcome.motion, |path| path.fitted.motion());
    resting_place(motion, place).with_y(middle_height(&outcome.motion))
}

/// Returns the beginning of a motion, at half the height of the body.
pub(crate) fn resting_place(motion: &Motion, place: &Planar) -> Vec3 {
    let start = motion.ground_frames().first().map_or(Vec3::ZERO, Planar::origin);
    place.apply(start).with_y(middle_height(motion))
}

/// Returns the height of the picture's centre: a little below half the body's, because the metrics
/// of a pane cover its lower edge.
pub(crate) fn middle_height(motion: &Motion) -> f32 {
    motion.body_height() * (1.0 - SHARE_ABOVE)
}
