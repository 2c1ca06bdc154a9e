//! Arrays without names, which are recognised by their shapes.

use super::array::{Array, View};
use super::body;
use super::bundle::Bundle;
use super::features::{self, HUMANML, HUMANML_FPS, LATER};
use super::model::SmplModel;
use super::points;
use super::take::{Take, vectors};
use super::turns::{self, Form};
use super::wrong_shape;
use crate::error::Fault;
use crate::warning::Tally;
use glam::Quat;
use segue_text::Message;

/// The names that the motion of a file with several arrays may have.
const NAMES: [&str; 9] = [
    "",
    "motion",
    "joints",
    "positions",
    "joint_positions",
    "joints3d",
    "rotations",
    "data",
    "arr_0",
];

/// A row of the SMPL parameters of `HumanML3D`'s tools: rotations of 24 joints, translation, betas.
const ROW_OF_SMPL: usize = 85;
/// A row of Motion-X (Lin et al. 2023): rotations of the root, 21 joints, 30 of the hands and the
/// jaw, 150 values of the face, translation, betas.
const ROW_OF_MOTION_X: usize = 322;

/// Returns the motion of a file without known names.
fn motion_of<'b, 'a>(bundle: &'b Bundle<'a>) -> Option<&'b Array<'a>> {
    let is_motion = |array: &&Array<'_>| array.is_number() && array.shape().len() >= 2;
    bundle.first(&NAMES).filter(is_motion).or_else(|| {
        let mut all = bundle.arrays().map(|(_, array)| array).filter(is_motion);
        let first = all.next()?;
        all.next().is_none().then_some(first)
    })
}

/// Returns the motions of a file without known names: one for each sample in it.
pub(super) fn read(
    bundle: &Bundle<'_>,
    models: &[&SmplModel],
    tally: &mut Tally,
) -> Result<Vec<(Take, Option<usize>)>, Fault> {
    let Some(array) = motion_of(bundle) else {
        let is_row = |array: &Array<'_>| matches!(array.shape(), [HUMANML | LATER]);
        if bundle.arrays().any(|(_, array)| is_row(array)) {
            let found = "the mean or the standard deviation of a data set";
            return Err(Fault::new(0, found, "a motion file"));
        }
        return Err(unknown(bundle.description()));
    };
    let lengths = match bundle.get("lengths") {
        Some(array) if array.is_number() => array.view().numbers(tally)?,
        _ => Vec::new(),
    };
    let samples = samples(&array.view());
    let mut takes = Vec::new();
    for (index, sample) in samples.iter().enumerate() {
        let frames = lengths.get(index).filter(|_| lengths.len() == samples.len());
        let sample = match frames {
            Some(frames) if *frames >= 1.0 => sample.part(0, 0..*frames as usize),
            _ => sample.clone(),
        };
        let (take, model) = take(&sample, models, tally)?;
        takes.push((take.with_rate_of(bundle), model));
    }
    if takes.is_empty() {
        return Err(unknown(bundle.description()));
    }
    Ok(takes)
}

/// Splits a batch into its samples, each with its frames first.
fn samples<'a>(view: &View<'a>) -> Vec<View<'a>> {
    let split = |view: &View<'a>| (0..view.shape()[0]).map(|i| view.at(0, i)).collect();
    match *view.shape() {
        // Matrices.
        [_, joints, 3, 3] if body::is_known(joints) => vec![view.clone()],
        // MDM: samples, joints, 3, frames; samples, 263, 1, frames.
        [_, joints, 3, frames] if body::is_known(joints) && !body::is_known(frames) => {
            split(&view.reordered(&[0, 3, 1, 2]))
        }
        [_, HUMANML, 1, _] => split(&view.reordered(&[0, 3, 1, 2]).at(3, 0)),
        [_, _, joints, 3] if body::is_known(joints) => split(view),
        [_, _, HUMANML | LATER] => split(view),
        [joints, 3, frames] if body::is_known(joints) && !body::is_known(frames) => {
            vec![view.reordered(&[2, 0, 1])]
        }
        _ => vec![view.clone()],
    }
}

/// Returns the motion of an array with its frames first.
fn take(
    view: &View<'_>,
    models: &[&SmplModel],
    tally: &mut Tally,
) -> Result<(Take, Option<usize>), Fault> {
    match *view.shape() {
        [_, HUMANML] => return Ok((features::read_humanml(view, tally)?.into_take(tally)?, None)),
        [_, LATER] => return Ok((features::read_later(view, tally)?, None)),
        [frames, ROW_OF_SMPL] => {
            let poses = turns::read(&view.part(1, 0..72), Form::AxisAngle, tally)?;
            let path = vectors(&view.part(1, 72..75), frames, tally)?;
            let betas = betas(&view.part(1, 75..85), tally)?;
            return Ok(of_smpl(24, poses, Some(path), models, &betas, tally));
        }
        [frames, ROW_OF_MOTION_X] => {
            let mut parts = Vec::new();
            for range in [0..66, 156..159, 66..156] {
                parts.push(turns::read(&view.part(1, range), Form::AxisAngle, tally)?);
            }
            let (eyes, [body, jaw, hands]) =
                (Quat::IDENTITY, [22, 1, 30].map(|joints| move |frame| frame * joints));
            let widths = [22, 1, 30];
            let mut poses = Vec::with_capacity(frames * 55);
            for frame in 0..frames {
                let of = |part: usize, from: usize| {
                    parts[part].get(from..from + widths[part]).unwrap_or_default()
                };
                poses.extend(of(0, body(frame)));
                poses.extend(of(1, jaw(frame)));
                poses.extend([eyes; 2]);
                poses.extend(of(2, hands(frame)));
            }
            let path = vectors(&view.part(1, 309..312), frames, tally)?;
            let betas = betas(&view.part(1, 312..322), tally)?;
            return Ok(of_smpl(55, poses, Some(path), models, &betas, tally));
        }
        _ => {}
    }
    if let Some(points) = points::read(view, Some(HUMANML_FPS), tally)? {
        return Ok((points.into_take(tally)?, None));
    }
    let (joints, form) = match *view.shape() {
        [_, joints, 3] => (joints, Form::AxisAngle),
        [_, joints, 4] => (joints, Form::Quaternion),
        [_, joints, 6] => (joints, Form::SixNumbers { rows: true }),
        [_, joints, 3, 3] => (joints, Form::Matrix),
        [_, width] if width % 3 == 0 => (width / 3, Form::AxisAngle),
        ref shape => return Err(unknown(super::array_of(shape))),
    };
    if !body::is_known(joints) {
        return Err(unknown(super::array_of(view.shape())));
    }
    let rotations = turns::read(view, form, tally)?;
    if rotations.is_empty() {
        return Err(wrong_shape(view.shape(), "(frames,joints,3)"));
    }
    Ok(of_smpl(joints, rotations, None, models, &[], tally))
}

fn of_smpl(
    joints: usize,
    rotations: Vec<Quat>,
    path: Option<Vec<glam::Vec3>>,
    models: &[&SmplModel],
    betas: &[f64],
    tally: &mut Tally,
) -> (Take, Option<usize>) {
    let used = SmplModel::best(models, joints, None);
    let model = used.and_then(|index| models.get(index)).map(|model| (*model, betas));
    (Take::of_smpl(joints, rotations, path, model, tally), used)
}

fn betas(view: &View<'_>, tally: &mut Tally) -> Result<Vec<f64>, Fault> {
    Ok(view.at(0, 0).numbers(tally)?.into_iter().map(f64::from).collect())
}

fn unknown(found: Message) -> Fault {
    Fault::new(
        0,
        found,
        "`poses` and `trans` (AMASS, SMPL), `posed_joints` and `global_rot_mats` (Kimodo), or an array of 263 or 272 values or of 22, 24, 52 or 55 joints in each frame",
    )
    .with_hint("save the motion under these names with numpy.savez, or as BVH")
}
