//! Reading of files into clips.

use crate::clip::{Clip, Origin};
use crate::errors::{batch_error, file_error, read_error, unusable};
use pyo3::exceptions::{PyFileNotFoundError, PyValueError};
use pyo3::prelude::*;
use segue_batch::{Input, Inputs, Reader, for_each, parse_rate, parse_unit, parse_up, shown};
use segue_formats::ImportOptions;
use segue_motion::skin::Character;
use segue_session::file_id;
use segue_session::reading::{ReadFile, ReadReport, ReadSetup, read};
use std::ffi::OsString;
use std::path::PathBuf;
use std::sync::Arc;

/// Returns a unit of length in metres: a name such as "cm", or a number.
pub(crate) fn unit_of(unit: &Bound<'_, PyAny>) -> PyResult<f64> {
    let text = unit.str()?.to_string();
    parse_unit(&text).map_err(|reason| PyValueError::new_err(format!("unit: {reason}")))
}

/// Returns the options of reading.
fn options_of(
    unit: Option<&Bound<'_, PyAny>>,
    up: Option<&str>,
    fps: Option<f64>,
) -> PyResult<ImportOptions> {
    let named =
        |name: &'static str| move |reason| PyValueError::new_err(format!("{name}: {reason}"));
    let fps = fps.map(|fps| parse_rate(&fps.to_string())).transpose();
    Ok(ImportOptions {
        metres_per_unit: unit.map(unit_of).transpose()?,
        up: up.map(parse_up).transpose().map_err(named("up"))?,
        fps: fps.map_err(named("fps"))?,
        ..ImportOptions::default()
    })
}

/// The clips of a file, or the reason why there are none.
type Loaded = Result<Vec<Clip>, PyErr>;

/// Reads files on all cores. Returns for each, in their order, a list of its clips or the exception
/// why there are none.
#[pyfunction]
#[pyo3(signature = (paths, *, unit=None, up=None, fps=None, skeletons=Vec::new()))]
pub(crate) fn load_each<'py>(
    py: Python<'py>,
    paths: Vec<PathBuf>,
    unit: Option<Bound<'py, PyAny>>,
    up: Option<String>,
    fps: Option<f64>,
    skeletons: Vec<PathBuf>,
) -> PyResult<Vec<Bound<'py, PyAny>>> {
    let options = options_of(unit.as_ref(), up.as_deref(), fps)?;
    let input = |path: PathBuf| {
        let relative = PathBuf::from(path.file_name().unwrap_or_default());
        // Links name a file by its own name, wherever it lies.
        Input { name: shown(&relative), path, relative, is_named: true }
    };
    let inputs: Vec<Input> = paths.into_iter().map(input).collect();
    let loaded = py
        .detach(|| {
            let reader = Reader::new(&inputs, options, &skeletons)?;
            Ok(for_each(&inputs, |input| Some(clips_of(&reader, input)), || ()))
        })
        .map_err(batch_error)?;
    let as_object = |loaded: Loaded| match loaded {
        Ok(clips) => clips.into_pyobject(py).map(Bound::into_any),
        Err(error) => Ok(error.into_value(py).into_bound(py).into_any()),
    };
    loaded.into_iter().map(as_object).collect()
}

/// Returns the files that some paths, folders and patterns name.
#[pyfunction]
pub(crate) fn find_files(words: Vec<PathBuf>) -> PyResult<Vec<PathBuf>> {
    let words: Vec<OsString> = words.into_iter().map(PathBuf::into_os_string).collect();
    let found =
        Inputs::of(&words).map_err(|error| PyFileNotFoundError::new_err(error.to_string()))?;
    match found.problems.as_slice() {
        [] => Ok(found.files.into_iter().map(|input| input.path).collect()),
        problems => Err(PyFileNotFoundError::new_err(problems.join("\n"))),
    }
}

/// Reads a file from memory.
#[pyfunction]
#[pyo3(signature = (data, name, *, unit=None, up=None, fps=None))]
pub(crate) fn read_bytes(
    py: Python<'_>,
    data: &[u8],
    name: &str,
    unit: Option<Bound<'_, PyAny>>,
    up: Option<String>,
    fps: Option<f64>,
) -> PyResult<Vec<Clip>> {
    let options = options_of(unit.as_ref(), up.as_deref(), fps)?;
    py.detach(|| clips_of_bytes(name, data, options))
}

/// Reads the clips of a file from memory.
pub(crate) fn clips_of_bytes(name: &str, bytes: &[u8], options: ImportOptions) -> Loaded {
    let setup = ReadSetup { options, ..ReadSetup::default() };
    let report = read(name, bytes, &setup, &mut |_| true).unwrap_or_default();
    clips_of_report(name, report)
}

/// Reads the clips of a file from disk.
fn clips_of(reader: &Reader, input: &Input) -> Loaded {
    match reader.read(input) {
        Some(Ok(report)) => clips_of_report(&input.name, report),
        Some(Err(error)) => Err(file_error(error)),
        None => Ok(Vec::new()),
    }
}

/// Returns the clips of a report; an archive's clips in its order.
fn clips_of_report(name: &str, report: ReadReport) -> Loaded {
    let mut clips = Vec::new();
    for file in report.files {
        match &file.result {
            Err(error) => return Err(read_error(error)),
            Ok(read) if read.awaits_skeleton => {
                let how = "put it beside, or name it by skeleton=";
                let reason = format!("{}: it needs its skeleton, an ASF file: {how}", file.name);
                return Err(unusable(&file.name, reason));
            }
            Ok(_) => clips.extend(clips_of_file(file)),
        }
    }
    if clips.is_empty() {
        return Err(unusable(name, format!("{name}: it has no motion")));
    }
    Ok(clips)
}

/// Returns the clips of a file that was read.
fn clips_of_file(mut file: ReadFile) -> Vec<Clip> {
    file.unpacked = None;
    let file = Arc::new(file);
    let Ok(read) = &file.result else {
        return Vec::new();
    };
    let warnings: Vec<String> = read.warnings.iter().map(ToString::to_string).collect();
    let clips = read.clips.iter().enumerate().map(|(index, own)| {
        let character = own.mesh.as_ref().map(|mesh| {
            Arc::new(Character {
                skeleton: own.motion.clip().skeleton().clone(),
                roles: own.motion.roles().clone(),
                mesh: mesh.clone(),
            })
        });
        let id = Some(file_id(&file.name, &file.sha256, index));
        let origin = Origin { id, files: vec![Arc::clone(&file)] };
        Clip::new(Arc::new(own.motion.clone()), character, origin, warnings.clone())
    });
    clips.collect()
}
