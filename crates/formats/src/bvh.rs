//! BVH: a text format for skeletons and motions (Biovision, 1990s). There is no standard beyond the
//! practice of programs.
//!
//! A HIERARCHY section lists joints with their OFFSET from the parent and their CHANNELS; a MOTION
//! section has one number per channel and frame. Rotations are degrees about the joint's own axes,
//! multiplied in the order of the channels: `Zrotation Xrotation Yrotation` is `Rz · Rx · Ry`.
//! Position channels replace the OFFSET. Names are the rest of their line, and case does not matter
//! in keywords.
//!
//! The unit of length and the up axis are not in the file; they are inferred ([`super::Measure`]).

mod convert;
mod decimal;
mod euler;
mod header;
mod hierarchy;
mod lexer;
mod motion;
mod number;
#[cfg(feature = "parallel")]
mod parallel;
mod read;
mod row_sink;
mod turns;
mod write;

// Limits and readers shared by all text formats.
pub(super) use convert::{FIRST_ROWS, MEMORY_FLOOR, MEMORY_PER_BYTE};
pub(super) use hierarchy::MAX_DEPTH;
pub(super) use number::{Scan, scan};

pub use read::{read, read_with_progress};
pub use write::{RotationOrder, WriteOptions, write};

/// Returns whether the first word is one with which BVH files start.
pub(super) fn starts_like_bvh(text: &[u8]) -> bool {
    let token = lexer::Lexer::new(text, false).peek();
    token.eq_ignore_ascii_case(b"HIERARCHY") || token.eq_ignore_ascii_case(b"ROOT")
}
