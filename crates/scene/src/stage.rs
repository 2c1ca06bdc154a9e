//! The whole picture: panes, colours and light.

use crate::{Look, Pane};

/// Everything that is drawn in one rectangle of the page.
#[derive(Clone, Debug, PartialEq)]
pub struct Stage {
    /// The views, drawn in order.
    pub panes: Vec<Pane>,
    /// Colours and light.
    pub look: Look,
    /// Physical pixels per point. Line widths are in points.
    pub pixels_per_point: f32,
    /// Width of a cell of the grid on the ground, metres of the scene.
    pub grid_metres: f32,
}

impl Default for Stage {
    fn default() -> Self {
        Self { panes: Vec::new(), look: Look::DARK, pixels_per_point: 1.0, grid_metres: 1.0 }
    }
}
