//! Places of joints without rotations: a skeleton is laid through them
//! ([`skeleton_from_points`]).

use super::array::View;
use super::body::{self, BODY_JOINTS};
use super::take::{DEFAULT_FPS, Take};
use crate::error::Fault;
use crate::raw::Y_UP_FROM_Z_UP;
use crate::warning::{Tally, WarningKind};
use glam::{DVec3, Quat, Vec3};
use segue_motion::clip::UpAxis;
use segue_motion::points::{PointSet, joint_points, skeleton_from_points};
use segue_text::ToMessage;

/// The greatest spread of a bone's length, as a share of its mean, up to which points are joints of
/// one body. Joints of generated motion are not quite rigid.
const MAX_SPREAD: f64 = 0.25;
/// The mean distance of joints from their places up to which nothing is said, millimetres.
const MAX_ERROR_MM: f64 = 2.0;
/// The distance from ankles to head that is taken for metres, and that of a person.
const LIKELY_METRES: std::ops::Range<f64> = 0.5..2.5;
const USUAL_METRES: f64 = 1.5;
/// The least mean length of a bone, metres or any larger unit.
const MIN_BONE: f64 = 0.005;

/// The places of the joints of a body in the world.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct JointPoints {
    /// The names of the joints.
    pub(super) names: Vec<String>,
    /// The parent of each joint, before it; `None` for the root.
    pub(super) parents: Vec<Option<usize>>,
    /// Frame by frame, in the unit and world of the file.
    pub(super) positions: Vec<Vec3>,
    /// The frame rate of the format.
    pub(super) fps: Option<f64>,
    /// The up axis of the world.
    pub(super) up: UpAxis,
}

impl JointPoints {
    /// Returns points of the shared joints of the SMPL family.
    pub(super) fn of_body(positions: Vec<Vec3>, fps: Option<f64>, up: UpAxis) -> Self {
        Self::of(BODY_JOINTS, positions, fps, up)
    }

    /// Returns points of the joints of one of the bodies of the SMPL family.
    pub(super) fn of(joints: usize, positions: Vec<Vec3>, fps: Option<f64>, up: UpAxis) -> Self {
        let (names, parents) =
            body::joints(joints).into_iter().map(|joint| (joint.name, joint.parent)).unzip();
        Self { names, parents, positions, fps, up }
    }

    /// Returns the motion of a skeleton through the points.
    ///
    /// # Errors
    /// [`Fault`] when no skeleton goes through them, as without frames.
    pub(super) fn into_take(self, tally: &mut Tally) -> Result<Take, Fault> {
        let upward = self.upward();
        let up = up_axis(upward, self.up);
        let y_up_from_file = if up == UpAxis::Z { Y_UP_FROM_Z_UP } else { Quat::IDENTITY };
        let positions: Vec<Vec3> =
            self.positions.iter().map(|place| y_up_from_file * *place).collect();
        let points = joint_points(&self.names, &self.parents);
        let fps = self.fps.unwrap_or(DEFAULT_FPS);
        let set = PointSet { points: &points, positions: &positions, fps, up: UpAxis::Y };
        let fit = skeleton_from_points(&set)
            .map_err(|error| Fault::new(0, error.to_message(), "places of joints"))?;
        // In files of other units the body is as tall as in those of metres.
        let tall = upward.length();
        let metres_per_unit =
            if LIKELY_METRES.contains(&tall) { 1.0 } else { USUAL_METRES / tall.max(1e-9) };
        let error_mm = 1000.0 * metres_per_unit * f64::from(fit.error.mean);
        if error_mm > MAX_ERROR_MM {
            tally.add(WarningKind::ChangingBones { error_mm }, None);
        }
        let (mut rotations, mut root) = (fit.rotations, fit.root_translations);
        let file_from_y_up = y_up_from_file.conjugate();
        let roots = rotations.iter_mut().step_by(fit.joints.len().max(1));
        roots.for_each(|turn| *turn = file_from_y_up * *turn);
        for place in &mut root {
            *place = file_from_y_up * *place;
        }
        let mut take = Take::new(fit.joints, rotations, root);
        take.default_fps = fps;
        take.up = Some(up);
        Ok(take)
    }

    /// Returns the way from the ankles to the head, on average; zero without them.
    fn upward(&self) -> DVec3 {
        let joint = |name: &str| self.names.iter().position(|own| own == name);
        let (Some(head), Some(left), Some(right)) =
            (joint("head"), joint("left_ankle"), joint("right_ankle"))
        else {
            return DVec3::ZERO;
        };
        let upward = |frame: &[Vec3]| (frame[head] - (frame[left] + frame[right]) / 2.0).as_dvec3();
        let frames = self.positions.chunks_exact(self.names.len().max(1));
        let count = frames.len().max(1) as f64;
        frames.map(upward).sum::<DVec3>() / count
    }
}

/// Returns the axis along which a body is upright, if that is clear.
fn up_axis(upward: DVec3, default: UpAxis) -> UpAxis {
    match default {
        UpAxis::Y if upward.z.abs() > 2.0 * upward.y.abs() => UpAxis::Z,
        up => up,
    }
}

/// Returns the points of a view of shape (frames, joints, 3) if the bones between them keep their
/// lengths; otherwise its values are not places.
pub(super) fn read(
    view: &View<'_>,
    fps: Option<f64>,
    tally: &mut Tally,
) -> Result<Option<JointPoints>, Fault> {
    let [_, joints, 3] = *view.shape() else { return Ok(None) };
    if !body::is_known(joints) {
        return Ok(None);
    }
    let positions: Vec<Vec3> = view.numbers(tally)?.chunks_exact(3).map(Vec3::from_slice).collect();
    let points = JointPoints::of(joints, positions, fps, UpAxis::Y);
    Ok(is_rigid(&points).then_some(points))
}

/// Returns whether the bones of the limbs keep their lengths, and both sides have the same.
fn is_rigid(points: &JointPoints) -> bool {
    let joints = points.parents.len();
    // Knees, ankles, elbows and wrists, left before right.
    let limbs = [4, 5, 7, 8, 18, 19, 20, 21];
    let mut means = Vec::with_capacity(limbs.len());
    for joint in limbs {
        let Some(Some(parent)) = points.parents.get(joint) else { return false };
        let (mut sum, mut squares, mut count) = (0.0, 0.0, 0.0);
        for frame in points.positions.chunks_exact(joints) {
            let length = f64::from(frame[joint].distance(frame[*parent]));
            sum += length;
            squares += length * length;
            count += 1.0;
        }
        let mean = sum / f64::max(count, 1.0);
        let spread = (squares / f64::max(count, 1.0) - mean * mean).max(0.0).sqrt();
        if mean < MIN_BONE || spread > MAX_SPREAD * mean {
            return false;
        }
        means.push(mean);
    }
    // Thighs are about as long as shins, and upper arms as forearms.
    let alike = |a: f64, b: f64| (0.5..2.0).contains(&(a / b));
    means.chunks_exact(2).all(|pair| (pair[0] - pair[1]).abs() < MAX_SPREAD * pair[0])
        && means.chunks_exact(4).all(|limb| alike(limb[0], limb[2]))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::numpy::array::Array;
    use crate::numpy::features::{HUMANML, read_humanml};
    use crate::numpy::header::Dtype;
    use std::borrow::Cow;

    fn array(shape: &[usize], values: impl Iterator<Item = f32>) -> Array<'static> {
        let data: Vec<u8> = values.flat_map(f32::to_le_bytes).collect();
        let dtype = Dtype::parse("<f4").unwrap();
        Array::new(dtype, shape.to_vec(), false, Cow::Owned(data)).unwrap()
    }

    /// Returns a body that walks and turns, by the places of its 22 joints.
    fn walk(frames: usize) -> Vec<Vec3> {
        let joints = body::joints(BODY_JOINTS);
        let mut all = Vec::new();
        for frame in 0..frames {
            let t = frame as f32;
            let mut world: Vec<(Vec3, Quat)> = Vec::new();
            for (index, joint) in joints.iter().enumerate() {
                let turn = Quat::from_rotation_x(0.4 * (0.3 * t + index as f32).sin());
                world.push(if let Some(parent) = joint.parent {
                    let (at, above) = world[parent];
                    (at + above * joint.offset, above * turn)
                } else {
                    let root = Vec3::new(0.1 * t.sin(), 0.93, 0.05 * t);
                    (root, Quat::from_rotation_y(0.1 * t))
                });
            }
            all.extend(world.into_iter().map(|(at, _)| at));
        }
        all
    }

    #[test]
    fn places_are_told_from_rotation_vectors() {
        let places = walk(30);
        let shape = [30, BODY_JOINTS, 3];
        let read_array = |values: Vec<f32>| {
            let array = array(&shape, values.into_iter());
            read(&array.view(), None, &mut Tally::default()).unwrap()
        };
        let found = read_array(places.iter().flat_map(Vec3::to_array).collect());
        assert_eq!(found.unwrap().positions, places);
        let vectors = (0..30 * BODY_JOINTS * 3).map(|i| (0.37 * i as f32).sin() * 0.4);
        assert_eq!(read_array(vectors.collect()), None);
    }

    /// The features by their definition: heading and velocity of the root, then the other joints
    /// relative to the ground below the root, seen along the heading.
    #[test]
    fn humanml_features_are_the_places_again() {
        let frames = 24;
        let places = walk(frames);
        // Half the angle from the world to the heading, growing at a rate that changes.
        let half = |frame: usize| 0.02 * frame as f32 + 0.3 * (0.2 * frame as f32).sin();
        let mut values = Vec::new();
        for frame in 0..frames {
            let row_places = &places[frame * BODY_JOINTS..(frame + 1) * BODY_JOINTS];
            let next = places.get((frame + 1) * BODY_JOINTS).copied().unwrap_or(row_places[0]);
            let (root, turn) =
                (row_places[0], |frame| Quat::from_rotation_y(2.0 * (half(frame) - half(0))));
            let step = turn(frame + 1) * (next - root);
            values.extend([half(frame + 1) - half(frame), step.x, step.z, root.y]);
            for place in &row_places[1..] {
                let over_origin = *place - Vec3::new(root.x, 0.0, root.z);
                values.extend((turn(frame) * over_origin).to_array());
            }
            values.extend([1.0, 0.0, 0.0, 0.0, 1.0, 0.0].repeat(BODY_JOINTS - 1));
            values.extend([0.0; 3 * BODY_JOINTS + 4]);
        }
        let array = array(&[frames, HUMANML], values.into_iter());
        let found = read_humanml(&array.view(), &mut Tally::default()).unwrap();
        assert_eq!((found.fps, found.positions.len()), (Some(20.0), places.len()));
        for (found, expected) in found.positions.iter().zip(&places) {
            // The path starts over the origin.
            let expected = *expected - Vec3::new(places[0].x, 0.0, places[0].z);
            assert!(found.distance(expected) < 1e-5, "{found} {expected}");
        }
    }
}
