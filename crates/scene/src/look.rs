//! Colours and light of the empty stage.

use crate::color::{Color, rgb};

/// Colours and light of the empty stage.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Look {
    /// Background at the top of a pane.
    pub background_top: Color,
    /// Background at the bottom of a pane.
    pub background_bottom: Color,
    /// The lit part of the ground.
    pub floor: Color,
    /// Radius of the lit part of the ground, metres.
    pub floor_radius: f32,
    /// Lines of the grid, one metre apart. The alpha is their opacity.
    pub grid: Color,
    /// Darkness of the ground under a body, 0–1.
    pub shadow: f32,
    /// Share of the light on the ground that comes from the main light, which casts the shadow of
    /// the whole body, 0–1.
    pub key_shadow: f32,
    /// The neutral colour of the bodies of results.
    pub clay: Color,
    /// Outlines where a limb is in front of another. The alpha is their opacity.
    pub edge: Color,
    /// Width of outlines, points.
    pub edge_width: f32,
    /// Darkening of limbs towards their silhouette, 0–1.
    pub rim: f32,
    /// Strength of the light from behind on a silhouette.
    pub rim_light: f32,
    /// Whether bodies have two tones with a line between them, and hard shadows: for print.
    pub flat: bool,
}

impl Look {
    /// The look of the dark theme.
    pub const DARK: Self = Self {
        background_top: rgb(0x0f_11_15),
        background_bottom: rgb(0x0c_0d_11),
        floor: rgb(0x20_24_2d),
        floor_radius: 3.6,
        grid: [0.55, 0.6, 0.7, 0.26],
        shadow: 0.82,
        key_shadow: 0.6,
        clay: rgb(0xd2_d6_e2),
        edge: [0.04, 0.045, 0.06, 0.85],
        edge_width: 1.1,
        rim: 0.62,
        rim_light: 0.5,
        flat: false,
    };

    /// The look of the light theme.
    pub const LIGHT: Self = Self {
        background_top: rgb(0xee_f0_f4),
        background_bottom: rgb(0xe4_e7_ee),
        floor: rgb(0xfb_fc_fe),
        floor_radius: 4.2,
        grid: [0.42, 0.48, 0.6, 0.3],
        shadow: 0.5,
        key_shadow: 0.5,
        clay: rgb(0xae_b4_c4),
        edge: [0.16, 0.19, 0.26, 0.8],
        edge_width: 1.1,
        rim: 0.45,
        rim_light: 0.2,
        flat: false,
    };

    /// The look for print and for bright lecture halls: black lines and two flat tones on white.
    pub const PAPER: Self = Self {
        background_top: rgb(0xff_ff_ff),
        background_bottom: rgb(0xff_ff_ff),
        floor: rgb(0xff_ff_ff),
        floor_radius: 5.0,
        grid: [0.0, 0.0, 0.0, 0.28],
        shadow: 0.3,
        key_shadow: 0.85,
        clay: rgb(0xf4_f4_f4),
        edge: [0.0, 0.0, 0.0, 1.0],
        edge_width: 2.0,
        rim: 0.0,
        rim_light: 0.0,
        flat: true,
    };
}
