//! The Layers lab: each joint in the colour of the clip that moves it.

use crate::color::{CLAY_SHARE, mixed};
use crate::{Color, Colors, Look};
use segue_session::LayerFacts;

/// Returns the colour of a joint by B's share in it, from A's colour to B's, mixed with the body
/// colour.
pub(crate) fn share_color(layer: &LayerFacts, joint: usize, look: &Look, colors: &Colors) -> Color {
    let share = layer.shares.get(joint).copied().unwrap_or(0.0);
    mixed(mixed(colors.a, colors.b, share), look.clay, CLAY_SHARE)
}
