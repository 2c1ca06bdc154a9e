//! Colours, and the colours of the parts of a motion.

use segue_session::Slot;

/// Red, green, blue, alpha, each 0–1; sRGB-encoded as in a palette, with straight alpha.
pub type Color = [f32; 4];

/// Returns an opaque colour from its hexadecimal form: `rgb(0x0f1115)`.
#[must_use]
pub const fn rgb(hex: u32) -> Color {
    [
        (hex >> 16 & 0xff) as f32 / 255.0,
        (hex >> 8 & 0xff) as f32 / 255.0,
        (hex & 0xff) as f32 / 255.0,
        1.0,
    ]
}

/// Returns the colour with another alpha.
#[must_use]
pub const fn with_alpha(color: Color, alpha: f32) -> Color {
    [color[0], color[1], color[2], alpha]
}

/// Share of the body colour in the colour of a limb that has its own.
pub(crate) const CLAY_SHARE: f32 = 0.3;

/// Returns the opaque colour between two at `share`.
pub(crate) fn mixed(from: Color, to: Color, share: f32) -> Color {
    let between = |channel: usize| from[channel] + (to[channel] - from[channel]) * share;
    [between(0), between(1), between(2), 1.0]
}

/// The colours of A, B and results in the theme of the page.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Colors {
    /// The ghost and the path of A.
    pub a: Color,
    /// The ghost and the path of B.
    pub b: Color,
    /// The path of the result, and the ring of a planted foot.
    pub result: Color,
    /// The ring of a foot that slides, and a hinge beyond its limit.
    pub bad: Color,
    /// The parts of a path that turn faster than the motion on it can, and a hinge at its limit.
    pub warning: Color,
    /// Extra characters and those of a crowd, in turn.
    pub others: [Color; 4],
    /// The opacity of a ghost, 0 to 1.
    pub ghost_alpha: f32,
}

impl Colors {
    /// Returns the colour of the clip in a slot.
    pub(crate) fn of_slot(&self, slot: Slot) -> Color {
        match slot {
            Slot::A => self.a,
            Slot::B => self.b,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rgb_of_a_hexadecimal_number_is_exact() {
        assert_eq!(rgb(0x0f_11_15), [15.0 / 255.0, 17.0 / 255.0, 21.0 / 255.0, 1.0]);
    }
}
