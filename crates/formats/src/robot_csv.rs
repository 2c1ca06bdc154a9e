//! Tables of a humanoid robot's hinges: the Unitree G1 with 29 hinges, as retargeting programs
//! write them.
//!
//! | | without header | with header |
//! |---|---|---|
//! | columns | 36: place, quaternion, 29 angles | by name: `root_translateX` …, `root_rotateX` …, `left_knee_joint_dof` … |
//! | place of the pelvis | metres | centimetres |
//! | its rotation | quaternion, x y z w (retargeted sets) or w x y z (`qpos` of `MuJoCo`) | degrees about the fixed axes X, Y, Z, in this order |
//! | angles | radians | degrees |
//! | frames per second | 30 assumed | 120 assumed |
//!
//! Z is up, and X ahead. Which quaternion it is follows from the robot standing upright; facing
//! ahead or back, both stand, and then the direction of travel decides, with a warning.
//!
//! The clip's joints are the pelvis and the bodies behind each hinge, at rest with all angles 0.
//! Angles beyond the limits of a hinge are kept, with a warning. [`HingeLimits`] finds the hinges
//! that are at their limits in a pose.

mod g1;
mod limits;
mod read;
mod robot;
#[cfg(test)]
mod tests;
mod write;

pub use limits::{HingeLimits, HingeState};
pub use read::read;
pub use write::{RobotCsvError, write_robot_csv};

use super::text::is_space;

/// The columns of a table without header.
const COLUMNS: usize = 7 + g1::HINGES.len();

/// Returns whether a table begins with a row of so many numbers, or with the names of columns.
pub(super) fn starts_like_robot_csv(head: &[u8]) -> bool {
    let start = head.iter().position(|b| !is_space(*b)).unwrap_or(head.len());
    let line = head[start..].split(|b| matches!(b, b'\n' | b'\r')).next().unwrap_or_default();
    read::is_header(line)
        || (line.contains(&b',')
            && read::cells(line).count() == COLUMNS
            && read::cells(line).all(|cell| read::number(cell).is_some()))
}
