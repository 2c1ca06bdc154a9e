//! Motions of the SMPL family: AMASS (Mahmood et al., "AMASS: Archive of Motion Capture as Surface
//! Shapes", 2019) and the files of programs that fit these bodies.
//!
//! Rotations are relative to the parent and mostly axis times angle. AMASS has them in `poses`, one
//! row for each frame, or in parts: `root_orient`, `pose_body`, `pose_hand`, `pose_jaw` and
//! `pose_eye`; other programs write `global_orient` and `body_pose`. The root turns about the
//! pelvis, and `trans` moves the model as a whole: the pelvis is at `trans` plus its place at rest.
//! The world of AMASS has Z up.

use super::array::{Array, View};
use super::body;
use super::bundle::Bundle;
use super::model::SmplModel;
use super::take::{Take, vectors};
use super::turns::{self, Form};
use crate::error::Fault;
use crate::warning::Tally;
use glam::{Quat, Vec3};
use segue_motion::clip::UpAxis;

const WHOLE: [&str; 6] = ["poses", "smpl_poses", "fullpose", "full_pose", "pose", "thetas"];
const ROOT: [&str; 2] = ["root_orient", "global_orient"];
const BODY: [&str; 2] = ["pose_body", "body_pose"];
const PATHS: [&str; 7] = [
    "trans",
    "transl",
    "smpl_trans",
    "root_translation",
    "translation",
    "root_trans",
    "root_positions",
];

/// Returns whether a file has the rotations of such a body.
pub(super) fn is_smpl(bundle: &Bundle<'_>) -> bool {
    let has = |names: &[&str]| bundle.first(names).is_some_and(Array::is_number);
    has(&WHOLE) || has(&ROOT) && has(&BODY)
}

/// Returns the motion, and the index of the model whose bones it has.
pub(super) fn read(
    bundle: &Bundle<'_>,
    models: &[&SmplModel],
    tally: &mut Tally,
) -> Result<(Take, Option<usize>), Fault> {
    let (count, rotations) = rotations(bundle, tally)?;
    let frames = rotations.len() / count.max(1);
    let path = match bundle.first(&PATHS) {
        Some(array) => Some(path(&array.view(), frames, bundle, tally)?),
        None => None,
    };
    let betas = match bundle.first(&["betas", "shape", "smpl_betas"]) {
        Some(array) if array.is_number() => betas(&array.view(), tally)?,
        _ => Vec::new(),
    };
    let gender = bundle.get("gender").and_then(|array| array.texts().into_iter().next());
    let used = SmplModel::best(models, count, gender.as_deref());
    let model = used.and_then(|index| models.get(index)).map(|model| (*model, betas.as_slice()));
    let mut take = Take::of_smpl(count, rotations, path, model, tally).with_rate_of(bundle);
    take.default_up = if is_amass(bundle) { UpAxis::Z } else { UpAxis::Y };
    if bundle.get("smpl_poses").is_some() {
        // AIST++ has no rate in its files, and 60 frames per second in its paper.
        take.default_fps = 60.0;
    }
    Ok((take, used))
}

/// Returns whether the names are those of AMASS.
fn is_amass(bundle: &Bundle<'_>) -> bool {
    let names =
        ["mocap_framerate", "mocap_frame_rate", "mocap_time_length", "dmpls", "root_orient"];
    bundle.first(&names).is_some() || bundle.get("poses").is_some() && bundle.get("trans").is_some()
}

/// Returns the number of joints and their rotations, frame by frame.
fn rotations(bundle: &Bundle<'_>, tally: &mut Tally) -> Result<(usize, Vec<Quat>), Fault> {
    if let Some(array) = bundle.first(&WHOLE) {
        let view = squeezed(array.view());
        // The motions of MDM's meshes: joints, six numbers, frames; with the frames last.
        let view = match *view.shape() {
            [_, 6, _] => view.reordered(&[2, 0, 1]),
            _ => view,
        };
        let part = Part::read(&view, tally)?;
        return match part.joints {
            joints if body::is_known(joints) => Ok((joints, part.turns)),
            _ => Err(unknown_shape(array.shape())),
        };
    }
    let part = |names: &[&str], tally: &mut Tally| match bundle.first(names) {
        Some(array) if array.is_number() => Part::read(&squeezed(array.view()), tally).map(Some),
        _ => Ok(None),
    };
    let (Some(root), Some(own)) = (part(&ROOT, tally)?, part(&BODY, tally)?) else {
        return Err(Fault::new(0, bundle.description(), "rotations of the root and the body"));
    };
    let frames = own.turns.len() / own.joints.max(1);
    if root.joints != 1 || root.turns.len() != frames || !matches!(own.joints, 21 | 23) {
        let shape = bundle.first(&BODY).map_or(&[][..], Array::shape);
        return Err(unknown_shape(shape));
    }
    let both = part(&["pose_hand"], tally)?;
    let left = part(&["left_hand_pose"], tally)?;
    let right = part(&["right_hand_pose"], tally)?;
    let jaw = part(&["pose_jaw", "jaw_pose"], tally)?;
    let eyes = part(&["pose_eye"], tally)?;
    let eye = [part(&["leye_pose"], tally)?, part(&["reye_pose"], tally)?];
    let fits = |part: &Option<Part>, joints: usize| {
        part.as_ref().is_some_and(|part| part.joints == joints && part.frames() == frames)
    };
    let has_hands = fits(&both, 30) || fits(&left, 15) || fits(&right, 15);
    let (count, body_joints) = match own.joints {
        23 => (24, 23),
        _ if fits(&jaw, 1) => (55, 21),
        _ if has_hands => (52, 21),
        _ => (22, 21),
    };
    let mut all = vec![Quat::IDENTITY; frames * count];
    let mut place = |first: usize, part: &Option<Part>, joints: usize| {
        let Some(part) = part.as_ref().filter(|_| fits(part, joints)) else { return };
        for (frame, turns) in part.turns.chunks_exact(joints).enumerate() {
            let from = frame * count + first;
            if let Some(own) = all.get_mut(from..from + joints) {
                own.copy_from_slice(turns);
            }
        }
    };
    place(0, &Some(root), 1);
    place(1, &Some(own), body_joints);
    if count == 55 {
        place(22, &jaw, 1);
        place(23, &eyes, 2);
        place(23, &eye[0], 1);
        place(24, &eye[1], 1);
    }
    if count >= 52 {
        place(count - 30, &both, 30);
        place(count - 30, &left, 15);
        place(count - 15, &right, 15);
    }
    Ok((count, all))
}

/// The rotations of several joints, frame by frame.
struct Part {
    joints: usize,
    turns: Vec<Quat>,
}

impl Part {
    fn frames(&self) -> usize {
        self.turns.len() / self.joints.max(1)
    }

    /// Reads an array of shape (frames, 3·joints), (frames, joints, 3), (frames, joints, 6) or
    /// (frames, joints, 3, 3).
    fn read(view: &View<'_>, tally: &mut Tally) -> Result<Self, Fault> {
        let (joints, form) = match *view.shape() {
            [_, width] if width > 0 && width % 3 == 0 => (width / 3, Form::AxisAngle),
            [_, joints, 3] => (joints, Form::AxisAngle),
            [_, joints, 6] => (joints, Form::SixNumbers { rows: true }),
            [_, joints, 3, 3] => (joints, Form::Matrix),
            ref shape => return Err(unknown_shape(shape)),
        };
        Ok(Self { joints, turns: turns::read(view, form, tally)? })
    }
}

/// Returns an array without a leading axis of one element, as batches of one motion have it.
fn squeezed(view: View<'_>) -> View<'_> {
    match *view.shape() {
        [1, _, width] if width > 9 && width % 3 == 0 => view.at(0, 0),
        [1, _, _, 3] | [1, _, _, 3, 3] => view.at(0, 0),
        _ => view,
    }
}

/// Returns the translations of the model, metres.
fn path(
    view: &View<'_>,
    frames: usize,
    bundle: &Bundle<'_>,
    tally: &mut Tally,
) -> Result<Vec<Vec3>, Fault> {
    let view = match *view.shape() {
        [1, _, 3] => view.at(0, 0),
        [3, columns] if columns == frames && columns != 3 => view.reordered(&[1, 0]),
        _ => view.clone(),
    };
    let places = vectors(&view, frames, tally)?;
    let scale = bundle.number(&["smpl_scaling"]).filter(|scale| *scale > 0.0).unwrap_or(1.0);
    Ok(places.into_iter().map(|place| place / scale as f32).collect())
}

/// Returns the shape of a body: that of the first frame where every frame has one.
fn betas(view: &View<'_>, tally: &mut Tally) -> Result<Vec<f64>, Fault> {
    let view = if view.shape().len() > 1 { view.at(0, 0) } else { view.clone() };
    Ok(view.numbers(tally)?.into_iter().map(f64::from).collect())
}

fn unknown_shape(shape: &[usize]) -> Fault {
    Fault::new(0, super::array_of(shape), "rotations of 22, 24, 52 or 55 joints")
}
