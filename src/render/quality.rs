//! The quality of a picture.

/// The quality of a picture's lighting.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Quality {
    /// Limbs blend into each other and shade each other, and the main light casts shadows.
    Full,
    /// Every limb is lit on its own. For machines without a graphics card.
    Plain,
}
