//! Writing of tables of the robot's hinges.

use super::g1::HINGES;
use super::robot::{Robot, angle_about, direction, is_robot, z_up};
use glam::DQuat;
use segue_motion::clip::{Clip, Interpolation, resample};
use std::f64::consts::TAU;
use std::fmt::Write as _;

/// Frames per second that programs assume: a table states none.
const FPS: f64 = 30.0;
/// A joint that turns about other axes than that of its hinge by more than this cannot be written,
/// radians (2°).
const MAX_OFF_AXIS: f64 = 0.035;

/// The reason why a clip cannot be written as a table of the robot's hinges.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error, segue_text::ToMessage)]
pub enum RobotCsvError {
    /// The clip is not on the robot's skeleton.
    #[error(
        "its joints are not those of a Unitree G1: open a table of that robot, and save it or what a lab makes of it"
    )]
    OtherSkeleton,
    /// A joint turns as its hinge cannot.
    #[error(
        "`{joint}` is turned {degrees}° off the axis of its hinge in frame {frame}: save the motion as BVH, or a motion of the robot's own"
    )]
    OffAxis {
        /// The joint that turns farthest from its axis.
        joint: String,
        /// The angle to the nearest rotation about the axis.
        degrees: u32,
        /// The frame.
        frame: usize,
    },
}

/// Writes a motion of the robot as a table without a header: 36 columns, place of the pelvis
/// (metres, Z up), its quaternion x y z w, and the angles of the hinges (radians), one row for each
/// frame at `fps`, or at 30 frames per second, which programs assume, where it is `None` or not
/// accepted by [`resample`].
///
/// Angles go on beyond half a turn. Angles beyond the limits of a hinge are kept.
///
/// # Errors
/// [`RobotCsvError`] when the clip has other joints than the robot, or joints that turn about other
/// axes than their hinges.
pub fn write_robot_csv(clip: &Clip, fps: Option<f64>) -> Result<String, RobotCsvError> {
    let robot = Robot::new();
    if !is_robot(clip.skeleton(), &robot) {
        return Err(RobotCsvError::OtherSkeleton);
    }
    let rate = |fps: f64| resample(clip, fps, Interpolation::default()).ok();
    let resampled = fps.and_then(rate).or_else(|| rate(FPS));
    let clip = resampled.as_ref().unwrap_or(clip);
    let mut out = String::with_capacity(clip.frames() * 300);
    let mut angles = [0.0_f64; HINGES.len()];
    let mut last = DQuat::IDENTITY;
    let mut worst: Option<(usize, f64, usize)> = None;
    for (frame, place) in clip.root_translations().iter().enumerate() {
        let rotations = clip.rotations(frame);
        let pelvis = rotations.first().map_or(DQuat::IDENTITY, |turn| z_up(*turn));
        // In the hemisphere of the one before, so that programs may interpolate.
        let pelvis = if pelvis.dot(last) < 0.0 { -pelvis } else { pelvis };
        last = pelvis;
        let place = direction(*place);
        write_row(&mut out, place.to_array().into_iter().chain(pelvis.to_array()));
        for (hinge, (turn, axis)) in rotations.iter().skip(1).zip(robot.axes()).enumerate() {
            let turn = z_up(*turn);
            let along = turn.xyz().dot(*axis);
            let twist = libm::hypot(along, turn.w);
            let off = 2.0 * libm::acos(twist.min(1.0));
            if off > worst.map_or(MAX_OFF_AXIS, |(_, most, _)| most) {
                worst = Some((hinge, off, frame));
            }
            let angle = angle_about(turn, *axis);
            angles[hinge] = angle + TAU * ((angles[hinge] - angle) / TAU).round();
        }
        out.push(',');
        write_row(&mut out, angles.into_iter());
        out.push('\n');
    }
    match worst {
        None => Ok(out),
        Some((hinge, off, frame)) => Err(RobotCsvError::OffAxis {
            joint: HINGES[hinge].name.to_owned(),
            degrees: off.to_degrees().round() as u32,
            frame,
        }),
    }
}

fn write_row(out: &mut String, values: impl Iterator<Item = f64>) {
    for (index, value) in values.enumerate() {
        let comma = if index > 0 { "," } else { "" };
        // Writing to a string cannot fail.
        write!(out, "{comma}{}", value as f32).ok();
    }
}
