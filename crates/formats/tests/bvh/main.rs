//! Oddities of real BVH files, one test for each kind, on synthetic files.

#![expect(clippy::unwrap_used, reason = "helpers of tests: what fails here fails the test")]

#[path = "../common/mod.rs"]
mod common;
mod frames;
mod hierarchy;
mod text;

use common::{CHAIN, chain, one, read, row};
use glam::{Quat, Vec3};
use segue_formats::{ImportError, ImportOptions, import};
use segue_motion::clip::{Clip, UpAxis};

/// Returns the motion of [`chain`] with four frames.
fn plain() -> Clip {
    let (found, warnings) = one(chain(4));
    assert_eq!(warnings, [""; 0]);
    assert_eq!((found.clip.frames(), found.clip.fps()), (4, 100.0));
    found.clip
}

/// Asserts that a file has the content of [`plain`] and returns its warnings.
fn same(text: impl AsRef<[u8]>) -> Vec<String> {
    let (found, warnings) = one(text.as_ref());
    assert_eq!(found.clip, plain(), "{}", String::from_utf8_lossy(text.as_ref()));
    warnings
}

fn refused(text: impl AsRef<[u8]>) -> ImportError {
    read(text).unwrap_err()
}
