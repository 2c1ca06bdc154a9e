//! The camera that shows everything.

use crate::ui::out::Out;
use crate::ui::state::UiState;
use glam::Vec3;
use segue_motion::math::Planar;
use segue_scene::{Bounds, camera_of, resting_point, shown_size, view_size};
use segue_session::choices::Follow;
use segue_session::{Command, Key, Session, Value};

/// Stops following and shows the whole way of every pane.
pub(crate) fn frame_everything(session: &Session, state: &UiState, out: &mut Out) {
    out.commands.extend(framing(session, state, None).map(Command::Set));
}

/// Returns the values of the camera that shows the whole way of all characters, at the given pitch
/// (degrees) or at the present one; `None` where there is nothing to see.
pub(crate) fn framing(
    session: &Session,
    state: &UiState,
    pitch: Option<f64>,
) -> Option<Vec<(Key, Value)>> {
    let outcomes = || session.panes().iter().filter_map(|pane| pane.shown_at(0.0));
    let places = outcomes().flat_map(|shown| {
        let frames = shown.outcome.motion.ground_frames();
        frames.iter().map(move |frame| shown.place.after(frame).origin())
    });
    let extra = session.extra_characters().iter().filter_map(|extra| extra.motion.as_ref().ok());
    let extra = extra.flat_map(|motion| motion.ground_frames().iter().map(Planar::origin));
    let paths = session.panes().iter().filter_map(|pane| pane.outcome.as_ref()?.path());
    let points = paths.flat_map(|path| path.curve.spline().points());
    let points = points.map(|point| Vec3::new(point.x as f32, 0.0, point.y as f32));
    let all = places.chain(extra).chain(points);
    let (low, high) =
        all.fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(low, high), p| (low.min(p), high.max(p)));
    let first = outcomes().next().filter(|_| low.is_finite())?;
    let motion = &first.outcome.motion;
    let height = motion.body_height();
    let mut bounds = Bounds::default();
    bounds.include(low - Vec3::new(0.4, 0.0, 0.4));
    bounds.include(high + Vec3::new(0.4, height, 0.4));
    let mut params = session.params().clone();
    let pitch = pitch.map(|pitch| (Key::CameraPitch, Value::Number(pitch)));
    if let Some((key, value)) = &pitch {
        params.set(*key, value.clone()).ok()?;
    }
    let scale = view_size(session, motion) / shown_size(session, motion);
    let mut camera = camera_of(&params, scale);
    let pane_width = state.stage.width() / session.panes().len().max(1) as f32;
    camera.frame(&bounds, pane_width / state.stage.height().max(1.0));
    let pan = (camera.target - resting_point(first.outcome, &first.place)) / scale;
    let mut values = vec![
        (Key::Follow, Follow::Off.into()),
        (Key::CameraDistance, Value::Number(f64::from(camera.distance / scale).clamp(0.5, 60.0))),
    ];
    values.extend(pitch);
    for (key, value) in [(Key::PanX, pan.x), (Key::PanY, pan.y), (Key::PanZ, pan.z)] {
        values.push((key, Value::Number(f64::from(value).clamp(-100.0, 100.0))));
    }
    Some(values)
}
