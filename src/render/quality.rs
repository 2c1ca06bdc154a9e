//! How much is spent on a picture.

/// How much light is worth its time.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Quality {
    /// Limbs melt into each other and shade each other.
    Full,
    /// Every limb is lit on its own: for machines without a graphics card.
    Plain,
}
