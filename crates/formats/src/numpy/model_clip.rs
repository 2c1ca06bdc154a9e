//! The clip of a body model that was opened without a motion.

use super::body;
use super::model::SmplModel;
use super::take::{DEFAULT_FPS, Take};
use crate::error::ImportError;
use crate::warning::{Tally, WarningKind};
use crate::{ImportOptions, ImportedFile};
use segue_motion::clip::UpAxis;

/// Returns the mean body of a model as a clip without frames.
///
/// # Errors
/// Those of [`super::read_model`].
pub fn model_clip(model: &SmplModel, options: &ImportOptions) -> Result<ImportedFile, ImportError> {
    let mut joints = body::joints(model.joints());
    model.shape(&mut joints, &[]);
    let mut tally = Tally::default();
    tally.add(WarningKind::NoFrames, None);
    let mut take = Take::new(joints, Vec::new(), Vec::new());
    take.fps = Some(DEFAULT_FPS);
    take.up = Some(UpAxis::Y);
    let clip = take
        .into_clip(&model.file, options, &mut tally)
        .map_err(|fault| fault.locate(&model.file, b""))?;
    Ok(ImportedFile { clips: vec![clip], warnings: tally.into_warnings(b"") })
}
