//! Clips that [`super::write_npz`] wrote, and files of others with a skeleton of their own: names,
//! parents, offsets and rotations.

use super::array::Array;
use super::bundle::Bundle;
use super::take::vectors;
use super::turns::{self, Form};
use super::wrong_shape;
use crate::ImportOptions;
use crate::error::Fault;
use crate::raw::RawMotion;
use crate::warning::Tally;
use glam::{Quat, Vec3};
use segue_motion::clip::{Provenance, UpAxis};
use segue_motion::math::quat;
use segue_motion::skeleton::Joint;
use segue_text::msg;

/// A clip with a skeleton of its own.
#[derive(Debug)]
pub(super) struct OwnClip {
    pub(super) raw: RawMotion,
    pub(super) fps: Option<f64>,
    /// The unit and up axis of the file from which the clip was made.
    pub(super) provenance: Option<Provenance>,
}

/// Returns whether a file has a skeleton of its own.
pub(super) fn is_own(bundle: &Bundle<'_>) -> bool {
    ["parents", "offsets", "rotations"].iter().all(|name| bundle.get(name).is_some())
}

/// Returns the clip.
pub(super) fn read(bundle: &Bundle<'_>, tally: &mut Tally) -> Result<OwnClip, Fault> {
    let needed = |name: &'static str| {
        bundle.get(name).ok_or_else(|| {
            Fault::new(0, bundle.description(), msg!("the array {name}", name = name.to_owned()))
        })
    };
    let (parents, rotations) = (needed("parents")?.view(), needed("rotations")?.view());
    let parents = parents.numbers(tally)?;
    let count = parents.len();
    let offsets = vectors(&needed("offsets")?.view(), count, tally)?;
    let names = bundle.first(&["names", "joint_names"]).map(Array::texts).unwrap_or_default();
    let ends = match bundle.get("ends") {
        // Most of them may be missing: they are no faults.
        Some(array) if array.shape() == [count, 3] => array.vectors_with_gaps(),
        _ => vec![None; count],
    };
    let mut joints = Vec::with_capacity(count);
    for (index, (parent, offset)) in parents.iter().zip(offsets).enumerate() {
        let before = *parent >= 0.0 && (*parent as usize) < index;
        if !before && (index > 0 || *parent >= 0.0) {
            let found = msg!("the parent {parent} of joint {index}", parent, index);
            return Err(Fault::new(0, found, "parents before their children, −1 for the root"));
        }
        joints.push(Joint {
            name: names.get(index).cloned().unwrap_or_else(|| format!("joint_{index}")),
            parent: before.then_some(*parent as usize),
            offset,
            end_site: ends.get(index).copied().flatten(),
            channels: Vec::new(),
        });
    }
    let (frames, form) = match *rotations.shape() {
        [frames, own, 4] if own == count => (frames, Form::Quaternion),
        [frames, own, 3, 3] if own == count => (frames, Form::Matrix),
        [frames, own, 3] if own == count => (frames, Form::AxisAngle),
        ref shape => return Err(wrong_shape(shape, &format!("(frames,{count},4)"))),
    };
    // This file says which component of its quaternions is the scalar: the first one.
    let turns = if form == Form::Quaternion && bundle.get("ends").is_some() {
        scalar_first(&rotations.numbers(tally)?)
    } else {
        turns::read(&rotations, form, tally)?
    };
    let root = match bundle.first(&["root", "root_positions", "trans"]) {
        Some(array) => vectors(&array.view(), frames, tally)?,
        None => vec![joints.first().map_or(Vec3::ZERO, |root| root.offset); frames],
    };
    let raw = RawMotion {
        joints,
        rotations: turns,
        root_translations: root,
        tracks: tracks(bundle, count, frames, tally)?,
        ..RawMotion::default()
    };
    let provenance = bundle.number(&["metres_per_unit"]).filter(|unit| *unit > 0.0);
    let z_up = bundle.number(&["z_up"]).is_some_and(|flag| flag != 0.0);
    let up = if z_up { UpAxis::Z } else { UpAxis::Y };
    Ok(OwnClip {
        raw,
        fps: bundle.number(&["fps", "frame_rate"]).filter(|fps| *fps > 0.0),
        provenance: provenance.map(|metres_per_unit| Provenance { metres_per_unit, up }),
    })
}

/// Returns the options with which the clip is assembled: those of a user come first.
pub(super) fn options_as_written(options: &ImportOptions) -> ImportOptions {
    ImportOptions {
        up: options.up.or(Some(UpAxis::Y)),
        metres_per_unit: options.metres_per_unit.or(Some(1.0)),
        // The first pose of a clip belongs to it.
        drop_t_pose: false,
        ..*options
    }
}

fn scalar_first(values: &[f32]) -> Vec<Quat> {
    let turn = |q: &[f32]| Quat::from_xyzw(q[1], q[2], q[3], q[0]);
    let unit = |q: Quat| if q.is_normalized() { q } else { quat::renormalize(q) };
    values.chunks_exact(4).map(|q| unit(turn(q))).collect()
}

/// Returns the joints that move in their parents, with their places.
fn tracks(
    bundle: &Bundle<'_>,
    joints: usize,
    frames: usize,
    tally: &mut Tally,
) -> Result<Vec<(usize, Vec<Vec3>)>, Fault> {
    let (Some(moving), Some(moves)) = (bundle.get("moving"), bundle.get("moves")) else {
        return Ok(Vec::new());
    };
    let moving = moving.view().numbers(tally)?;
    let mut tracks: Vec<(usize, Vec<Vec3>)> = Vec::new();
    for (index, joint) in moving.into_iter().enumerate() {
        let joint = joint as usize;
        if joint == 0 || joint >= joints || tracks.iter().any(|(own, _)| *own == joint) {
            continue;
        }
        tracks.push((joint, vectors(&moves.view().at(0, index), frames, tally)?));
    }
    tracks.sort_by_key(|(joint, _)| *joint);
    Ok(tracks)
}
