//! The Layers lab: each joint in the colour of what moves it.

use crate::color::mixed;
use crate::{Color, Colors, Look};
use segue_session::LayerFacts;

/// Share of clay in the colour of a limb.
const CLAY_SHARE: f32 = 0.3;

/// Returns the colour of a joint: A's where nothing of B is in it, B's where nothing else is,
/// softened by the clay of the body.
pub(crate) fn share_color(layer: &LayerFacts, joint: usize, look: &Look, colors: &Colors) -> Color {
    let share = layer.shares.get(joint).copied().unwrap_or(0.0);
    mixed(mixed(colors.a, colors.b, share), look.clay, CLAY_SHARE)
}
