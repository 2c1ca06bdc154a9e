//! The size of figures, and the view of them.

use crate::body_cache::{shown_character, size_beside};
use crate::{Camera, Lens};
use glam::Vec3;
use segue_motion::clip::Motion;
use segue_motion::math::Planar;
use segue_session::choices;
use segue_session::{Key, Outcome, Params, Session};

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

/// Returns the ratio of the height set in the parameters to the figure's own.
pub(crate) fn figure_height(params: &Params) -> f32 {
    (params.number(Key::FigureHeight) as f32).max(0.1)
}

/// Returns the camera that the parameters describe for a figure of this [`shown_size`]. Its target
/// is the default one.
#[must_use]
pub fn camera_of(params: &Params, shown_size: f32) -> Camera {
    let from_above = params.choice::<choices::Camera>() == choices::Camera::Top;
    Camera {
        yaw: params.number(Key::CameraYaw).to_radians() as f32,
        pitch: if from_above {
            std::f32::consts::FRAC_PI_2
        } else {
            params.number(Key::CameraPitch).to_radians() as f32
        },
        distance: params.number(Key::CameraDistance) as f32 / shown_size,
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
    motion.roles().body_height(motion.clip().skeleton()) * 0.4
}
