//! Reading of files into clips.

use crate::clip::{Clip, Loaded};
use crate::cores::detached;
use crate::errors::{batch_error, file_error};
use crate::words::unit_of;
use pyo3::exceptions::{PyFileNotFoundError, PyValueError};
use pyo3::prelude::*;
use segue_batch::{Input, Inputs, Reader, for_each, parse_rate, parse_up, shown};
use segue_formats::ImportOptions;
use std::ffi::OsString;
use std::path::PathBuf;

/// Files from this size on have their SHA-256 computed after they are read, bytes.
const HASHED_LATER_BYTES: usize = 1 << 18;

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
    let loaded = detached(py, || {
        let reader = Reader::new(&inputs, options, &skeletons)?;
        if let [input] = inputs.as_slice() {
            return Ok(vec![clips_of_one(&reader, input)]);
        }
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
    detached(py, || Clip::read_all(name, data, options))
}

/// Reads the clips of a file from disk on all cores.
fn clips_of_one(reader: &Reader, input: &Input) -> Loaded {
    match reader.bytes(input) {
        Some(Ok(bytes)) if bytes.len() >= HASHED_LATER_BYTES => {
            let report = reader.read_unhashed(input, &bytes);
            Clip::of_report(&input.name, report, Some(bytes))
        }
        Some(Ok(bytes)) => Clip::of_report(&input.name, reader.read_bytes(input, &bytes), None),
        Some(Err(error)) => Err(file_error(error)),
        None => Ok(Vec::new()),
    }
}

/// Reads the clips of a file from disk, one of many.
fn clips_of(reader: &Reader, input: &Input) -> Loaded {
    match reader.read(input) {
        Some(Ok(report)) => Clip::of_report(&input.name, report, None),
        Some(Err(error)) => Err(file_error(error)),
        None => Ok(Vec::new()),
    }
}
