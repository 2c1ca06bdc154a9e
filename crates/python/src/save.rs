//! Writing of clips.

use crate::errors::write_error;
use crate::words::unit_of;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use segue_batch::{parse_rate, parse_root, parse_up};
use segue_motion::clip::Motion;
use segue_motion::skin::Character;
use segue_session::export::{ExportBody, ExportFormat, ExportOptions, export};
use std::path::Path;

/// The keywords of writing a file.
pub(crate) struct SaveOptions<'py> {
    pub(crate) format: Option<String>,
    pub(crate) unit: Option<Bound<'py, PyAny>>,
    pub(crate) up: Option<String>,
    pub(crate) fps: Option<f64>,
    pub(crate) root: Option<String>,
    pub(crate) body: Option<String>,
}

impl SaveOptions<'_> {
    /// Returns the options of the export, to a path whose ending says the format where no keyword
    /// does.
    ///
    /// # Errors
    /// `ValueError` that says which values are known.
    pub(crate) fn read(&self, path: Option<&Path>) -> PyResult<ExportOptions> {
        let named = |name: &str, reason: String| PyValueError::new_err(format!("{name}: {reason}"));
        let ending = || ExportFormat::from_ending(path?.extension()?.to_str()?);
        let formats = || ExportFormat::ALL.map(ExportFormat::name).join(", ");
        let format = match &self.format {
            Some(name) => ExportFormat::from_name(name).ok_or_else(|| {
                named("format", format!("found {name:?}, expected {}", formats()))
            })?,
            None => ending().ok_or_else(|| {
                let how = "end the path in it, as in out.glb, or name it by format=";
                named("format", format!("it is not known: {how} ({})", formats()))
            })?,
        };
        let body = self.body.as_ref().map_or(Ok(ExportBody::default()), |name| {
            ExportBody::from_name(name).ok_or_else(|| {
                named("body", format!("found {name:?}, expected character or plain"))
            })
        })?;
        let up = self.up.as_deref().map(parse_up).transpose();
        let fps = self.fps.map(|fps| parse_rate(&fps.to_string())).transpose();
        let root = self.root.as_deref().map(parse_root).transpose();
        Ok(ExportOptions {
            format,
            metres_per_unit: self.unit.as_ref().map(|unit| unit_of(unit)).transpose()?,
            up: up.map_err(|reason| named("up", reason))?,
            rotation_order: None,
            fps: fps.map_err(|reason| named("fps", reason))?,
            body,
            root: root.map_err(|reason| named("root", reason))?.unwrap_or_default(),
        })
    }
}

/// Returns the bytes of a motion's file, with the character of its own.
///
/// # Errors
/// `segue.WriteError` if the format cannot hold the motion.
pub(crate) fn bytes_of(
    motion: &Motion,
    character: Option<&Character>,
    options: &ExportOptions,
) -> PyResult<Vec<u8>> {
    if motion.clip().frames() == 0 {
        return Err(write_error("it has no frames"));
    }
    export(motion, character, &[], options).map_err(|error| write_error(error.to_string()))
}
