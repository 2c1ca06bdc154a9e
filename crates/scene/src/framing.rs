//! In what size a figure is shown, and where its camera stands.

use crate::body_cache::{shown_character, size_beside};
use crate::{Camera, Lens};
use glam::Vec3;
use segue_motion::clip::Motion;
use segue_motion::math::Planar;
use segue_session::choices;
use segue_session::{Key, Outcome, Params, Session};

/// Returns how many times as large as its motion a figure is shown: by the height that the
/// parameters give it, and by its own size where it is a character.
///
/// The figure is drawn in the size and the place of its motion. It is the world about it that is
/// shown smaller: the camera stands nearer and the cells of the grid are narrower. So its steps,
/// its path and all that is drawn along with it grow as it does, and what stands still keeps
/// standing still: foot skate is neither made nor hidden.
#[must_use]
pub fn shown_size(session: &Session, motion: &Motion) -> f32 {
    let character = shown_character(session).and_then(|character| size_beside(&character, motion));
    character.unwrap_or(1.0) * figure_height(session.params())
}

/// Returns how many times as high as by itself the parameters show a figure.
pub(crate) fn figure_height(params: &Params) -> f32 {
    (params.number(Key::FigureHeight) as f32).max(0.1)
}

/// Returns the camera that the parameters describe, around a figure that is shown `shown_size`
/// times as large as its motion (see [`shown_size`]). Its target is the default one.
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

/// Returns the point that a camera without a followed character looks at: where the motion, which
/// lies at `place`, begins. For a motion on an edited path it is where the motion began before the
/// edit: the ground must not move when the path does.
#[must_use]
pub fn resting_point(outcome: &Outcome, place: &Planar) -> Vec3 {
    let motion = outcome.path().map_or(&outcome.motion, |path| path.fitted.motion());
    resting_place(motion, place).with_y(middle_height(&outcome.motion))
}

/// Returns where a motion begins, at the height of the middle of the body.
pub(crate) fn resting_place(motion: &Motion, place: &Planar) -> Vec3 {
    let start = motion.ground_frames().first().map_or(Vec3::ZERO, Planar::origin);
    place.apply(start).with_y(middle_height(motion))
}

/// Returns the height in the middle of the picture: a little below the body's own, because the
/// panes' numbers lie over the lower edge.
pub(crate) fn middle_height(motion: &Motion) -> f32 {
    motion.roles().body_height(motion.clip().skeleton()) * 0.4
}
