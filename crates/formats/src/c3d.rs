//! C3D: the points of optical motion capture, with their labels, and analogue channels (skipped).
//!
//! A file is a sequence of blocks of 512 bytes: a header, a parameter section, and the frames. It
//! was written by one of three processors (Intel, DEC, MIPS), as integers with a scale or as
//! floats. Parameters win over the header, since many programs leave the header's numbers of frames
//! and points wrong; the bytes that are there win over both.
//!
//! Read are `POINT:LABELS` (and `LABELS2`, …), `UNITS`, `SCALE`, `RATE`, `FRAMES`, `X_SCREEN`,
//! `Y_SCREEN`, `DATA_START`; `TRIAL:ACTUAL_START_FIELD` and `ACTUAL_END_FIELD` for takes of more
//! than 65,535 frames; `ANALOG:USED` and `RATE` for the size of a frame. A point whose residual is
//! negative is a gap. Results of models, which are points by name only (`POINT:ANGLES`, `FORCES`,
//! `MOMENTS`, `POWERS`, `SCALARS`), are left out.
//!
//! Source: Motion Lab Systems, "The C3D File Format User Guide", 2008, chapters "The Header
//! Section", "The Parameter Section", "3D Point and Analog Data".

mod numbers;
mod parameters;
mod read;
#[cfg(test)]
mod tests;

pub use read::read;

/// The size of a block.
const BLOCK: usize = 512;
/// The second byte of a header.
const KEY: u8 = 0x50;

/// Returns whether a file begins with the header of a C3D file, and has a parameter section of a
/// known processor where the header says.
pub(super) fn is_c3d(bytes: &[u8]) -> bool {
    match bytes {
        [first, KEY, ..] if *first > 0 => {
            let at = (usize::from(*first) - 1) * BLOCK;
            let processor = bytes.get(at + 3).copied().unwrap_or(0);
            bytes.len() > BLOCK && numbers::Processor::of(processor).is_some()
        }
        _ => false,
    }
}
