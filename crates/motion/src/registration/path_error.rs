//! Errors of the search for a path.

use super::RegistrationError;
use super::path::MAX_SLOPE_LIMIT;
use segue_text::{Message, msg};

/// Error finding a path through a distance matrix. Pairs of frames are (first clip, second clip).
#[derive(Clone, Debug, PartialEq, thiserror::Error, segue_text::ToMessage)]
pub enum PathError {
    /// A clip is shorter than the window.
    #[error(
        "a clip is shorter than the window of {window} frames, so that there is nothing to register: lower the window or use a longer clip"
    )]
    TooShort {
        /// Frames of the window.
        window: usize,
    },
    /// A slope limit out of range.
    #[error(
        "a slope limit of {slope_limit} cannot be used: give a number from 1 to {MAX_SLOPE_LIMIT}"
    )]
    SlopeLimit {
        /// The limit given.
        slope_limit: usize,
    },
    /// A pin outside of the matrix.
    #[error(
        "the pin in row {row}, column {column} lies outside the matrix of {rows} rows and {columns} columns: move it inside or remove it"
    )]
    PinOutside {
        /// Row of the pin.
        row: usize,
        /// Column of the pin.
        column: usize,
        /// Rows of the matrix.
        rows: usize,
        /// Columns of the matrix.
        columns: usize,
    },
    /// Two pins of which the later one in the first clip is not later in the second.
    #[error(
        "the pins at frames {a} | {b} and {later_a} | {later_b} exclude each other, because both clips only play forward: remove one, or move the later one on in both clips",
        a = first.0, b = first.1, later_a = second.0, later_b = second.1
    )]
    Pins {
        /// Frames of the pin that comes first in the first clip.
        first: (usize, usize),
        /// Frames of the other.
        second: (usize, usize),
    },
    /// A pin that excludes the corner at which the path must begin or end.
    #[error(
        "the pin at frames {a} | {b} excludes the path's {end}: free the {end}, or move the pin inwards",
        a = pin.0,
        b = pin.1
    )]
    PinAtEnd {
        /// Frames of the pin.
        pin: (usize, usize),
        /// "start" or "end".
        end: &'static str,
    },
    /// One clip is so much longer than the other that the limit leaves no path.
    #[error(
        "no path with a slope limit of {slope_limit} goes from {start} to {end}: raise the slope limit to {needed} or more, free the ends, or move the pins",
        start = place(*from, "the start"), end = place(*to, "the end")
    )]
    NoPath {
        /// Frames at which the part without a path begins; `None` for a free start.
        from: Option<(usize, usize)>,
        /// Frames at which it ends; `None` for a free end.
        to: Option<(usize, usize)>,
        /// The limit given.
        slope_limit: usize,
        /// The least limit that may suffice.
        needed: usize,
    },
    /// The clips cannot be compared along the path.
    #[error(transparent)]
    Registration(#[from] RegistrationError),
    /// The distances are not finite.
    #[error("a distance is not a finite number: trim that part of the clips off")]
    NotFinite,
}

fn place(frames: Option<(usize, usize)>, free: &'static str) -> Message {
    frames.map_or(Message::word(free), |(i, j)| msg!("frames {i} | {j}", i, j))
}
