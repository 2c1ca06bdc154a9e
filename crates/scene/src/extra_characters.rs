//! Characters that play beside the result.

use crate::annotations::add_bones;
use crate::color::mixed;
use crate::context::DrawContext;
use crate::ground_path::{MAX_PATH_POINTS, PATH_HEIGHT_M};
use crate::{Body, Color, Layer, Pane};
use segue_motion::clip::Motion;
use segue_motion::math::Planar;
use segue_motion::skeleton::WorldPose;
use segue_session::Key;
use segue_session::choices::Look;

/// Share of its own colour in the body colour of an extra character.
const COLOR_SHARE: f32 = 0.55;

/// Adds the extra characters, each on its own trajectory.
pub(crate) fn add_extra_characters(context: &mut DrawContext<'_>, pane: &mut Pane) {
    let (session, colors) = (context.session, context.colors);
    for (index, character) in session.extra_characters().iter().enumerate() {
        let Ok(motion) = &character.motion else {
            continue;
        };
        let color = colors.others[index % colors.others.len()];
        let figure = context.figure(motion, session.now_secs(), &Planar::IDENTITY);
        let Some((body, world)) = figure else {
            continue;
        };
        add_character(motion, &world, &body, (color, COLOR_SHARE), context, pane);
        if context.params.is_on(Key::Trail) {
            let frames = motion.ground_frames();
            let stride = frames.len().div_ceil(MAX_PATH_POINTS).max(1);
            let points = frames.iter().step_by(stride);
            pane.add_path(
                points.map(|place| (place.origin().with_y(PATH_HEIGHT_M), color)),
                2.0,
                Layer::Ground,
            );
        }
    }
}

/// Adds a character whose body colour is tinted with a colour of its own.
pub(crate) fn add_character(
    motion: &Motion,
    world: &WorldPose,
    body: &Body,
    (color, share): (Color, f32),
    context: &DrawContext<'_>,
    pane: &mut Pane,
) {
    if context.params.choice::<Look>() == Look::Bones {
        add_bones(body, motion, world, |_| color, pane);
    } else {
        pane.add_body(body, world, mixed(context.look.clay, color, share));
    }
}
