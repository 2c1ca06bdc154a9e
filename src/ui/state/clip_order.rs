//! The order of the clips in the list.

/// The order of the clips in the list.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum ClipOrder {
    /// In the order in which they were added.
    #[default]
    Added,
    /// By name.
    Name,
    /// By length, the shortest first.
    Length,
    /// By mean speed over the ground, the slowest first.
    Speed,
}
