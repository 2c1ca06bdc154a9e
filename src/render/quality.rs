//! The quality of a picture.

/// The time at which a stage that is drawn coarsely while it changes is drawn finely.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum Refinement {
    /// This frame: a picture is taken of it.
    Now,
    /// After some time without a change.
    #[default]
    AtRest,
    /// Later: something that the stage shows is still being prepared.
    Later,
}

/// The quality of a picture's lighting.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Quality {
    /// Limbs blend into each other and shade each other, and the main light casts shadows.
    Full,
    /// Every limb is lit on its own. For machines without a graphics card.
    Plain,
}
