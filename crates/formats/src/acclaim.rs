//! ASF and AMC: skeleton and motion in two text files (Acclaim, "Acclaim Skeleton File Definition
//! V1.10", 1994), as the CMU motion capture database has them.
//!
//! An ASF file lists bones with direction and length in the world's axes at rest, the axes about
//! which each turns, and its degrees of freedom; an AMC file has one line per bone and frame with a
//! value for each of them. With C = Rz·Ry·Rx of a bone's `axis` (about fixed axes, in the order
//! that it gives) and M the product of its turns (about fixed axes, in the order of `dof`), the
//! world rotation R of a bone is that of its parent · C · M · C⁻¹, and the bone ends at its start +
//! R · (direction × length). `tx ty tz` move its start along its own axes, `l` makes it longer. The
//! root's `position` and `orientation` are the frame of reference of the whole motion. Commas and
//! parentheses are white space, `#` begins a comment, limits are not applied.
//!
//! The files have no frame rate and no reliable unit of length; [`read_motion`] describes how both
//! are determined.

mod amc;
mod asf;
mod convert;
mod lexer;
mod pairing;
mod read;
mod skeleton;

pub use pairing::{best_skeleton, bone_names, check_motion, goes_by_name, matching_bones};
pub(super) use pairing::{starts_like_amc, starts_like_asf};
pub use read::{DEFAULT_FPS, read_motion, read_motion_with_progress, skeleton_clip};
pub use skeleton::{AcclaimSkeleton, read_skeleton};
