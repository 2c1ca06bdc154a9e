//! BVH: a text format for skeletons and motions (Biovision, 1990s), for which there is no standard
//! but what files do.
//!
//! A HIERARCHY section lists joints with their OFFSET from the parent and their CHANNELS; a MOTION
//! section has one number per channel and frame. Rotations are degrees about the joint's own axes,
//! multiplied in the order of the channels: `Zrotation Xrotation Yrotation` is `Rz · Rx · Ry`.
//! Position channels replace the OFFSET. Names are the rest of their line, and case does not matter
//! in keywords.
//!
//! What is not in the file (the unit of length and the up axis) is found by [`super::Measure`].

mod convert;
mod decimal;
mod euler;
mod header;
mod hierarchy;
mod lexer;
mod motion;
mod number;
mod read;
mod turns;
mod write;

// Limits and readers shared by all text formats.
pub(super) use convert::{FIRST_ROWS, MEMORY_FLOOR, MEMORY_PER_BYTE};
pub(super) use hierarchy::MAX_DEPTH;
pub(super) use number::{Scan, scan};

pub use read::{read, read_with_progress};
pub use write::{RotationOrder, WriteOptions, write};

/// Whether the first word is one that BVH files start with.
pub(super) fn starts_like_bvh(text: &[u8]) -> bool {
    let token = lexer::Lexer::new(text, false).peek();
    token.eq_ignore_ascii_case(b"HIERARCHY") || token.eq_ignore_ascii_case(b"ROOT")
}
