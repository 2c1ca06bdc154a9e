//! Assembly of clips from the motions of a file in its own units.

use super::error::Fault;
use super::measure::{UpSource, measure};
use super::raw::RawMotion;
use super::t_pose::first_frame_is_t_pose;
use super::warning::{Tally, WarningKind};
use super::{ImportOptions, ImportedClip, stem};
use segue_text::ToMessage;

/// Returns one clip for each character of a file: in metres and Y up, without a leading T-pose.
///
/// `unit_of_file` is the unit that the file itself states, metres; `first_row_at` the place of its
/// first row.
pub(super) fn assemble(
    name: &str,
    mut motions: Vec<RawMotion>,
    fps: f64,
    options: &ImportOptions,
    unit_of_file: Option<f64>,
    tally: &mut Tally,
    first_row_at: usize,
) -> Result<Vec<ImportedClip>, Fault> {
    let mut rest_from_first_row = false;
    for motion in &mut motions {
        rest_from_first_row |= motion.rest_from_first_frame();
    }
    if rest_from_first_row {
        tally.add(WarningKind::RestFromFirstRow, None);
    }
    let t_poses: Vec<bool> = motions.iter().map(first_frame_is_t_pose).collect();
    // Characters of one file stay in step: the row is dropped only if it is a T-pose for all of
    // them.
    let dropped = options.drop_t_pose && t_poses.iter().all(|&is_t_pose| is_t_pose);
    if t_poses.contains(&true) {
        tally.add(WarningKind::TPose { dropped }, Some(first_row_at));
    }
    let several = motions.len() > 1;
    let mut clips = Vec::with_capacity(motions.len());
    for (mut raw, t_pose_first_row) in motions.into_iter().zip(t_poses) {
        if dropped {
            raw.drop_first_frame();
        }
        let measure =
            measure(&raw, options.metres_per_unit, options.up).with_unit_of_file(unit_of_file);
        if measure.unit_unknown {
            tally.add(WarningKind::UnknownUnit, None);
        }
        if measure.up_source == UpSource::Uncertain {
            tally.add(WarningKind::UncertainUp { up: measure.provenance.up }, None);
        }
        let mendable = raw.warn_of_unlikely(&measure, options, tally);
        let clip_name = match raw.joints.first() {
            Some(root) if several => format!("{} ({})", stem(name), root.name),
            _ => stem(name).to_owned(),
        };
        let clip = raw
            .into_clip(clip_name, fps, measure.provenance)
            .map_err(|error| Fault::new(0, error.to_message(), "a skeleton with a motion"))?;
        clips.push(ImportedClip {
            clip,
            t_pose_first_row,
            t_pose_dropped: dropped,
            measure,
            mendable,
            mesh: None,
            roles: None,
        });
    }
    Ok(clips)
}
