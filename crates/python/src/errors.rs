//! Errors of the core as exceptions of `segue`.

use pyo3::exceptions::PyOSError;
use pyo3::prelude::*;
use segue_batch::{BatchError, FileError, import_text};
use segue_formats::ImportError;

mod python {
    //! The exceptions, which are defined in Python.

    pyo3::import_exception!(segue._errors, ReadError);
    pyo3::import_exception!(segue._errors, LabError);
    pyo3::import_exception!(segue._errors, WriteError);
}

/// Returns the exception for a file that cannot be read.
pub(crate) fn read_error(error: &ImportError) -> PyErr {
    let hint = error.hint.as_ref().map(ToString::to_string);
    let (found, expected) = (error.found.to_string(), error.expected.to_string());
    let place = (error.file.clone(), error.line, error.column);
    python::ReadError::new_err((
        import_text(error),
        place.0,
        place.1,
        place.2,
        found,
        expected,
        hint,
    ))
}

/// Returns the exception for a file that was read, and cannot be used.
pub(crate) fn unusable(file: &str, text: impl Into<String>) -> PyErr {
    let none = None::<String>;
    python::ReadError::new_err((
        text.into(),
        file.to_owned(),
        1,
        1,
        none.clone(),
        none.clone(),
        none,
    ))
}

/// Returns the exception for a file without bytes: that of the system, as `open` has it.
pub(crate) fn file_error(error: FileError) -> PyErr {
    let text = error.to_string();
    match error {
        FileError::System { path, error, .. } => match error.raw_os_error() {
            Some(code) => {
                let path = path.to_string_lossy().into_owned();
                // Chooses `FileNotFoundError` and its like by the code.
                PyOSError::new_err((code, os_text(&error), path))
            }
            None => PyOSError::new_err(text),
        },
        FileError::TooLarge { name, .. } => unusable(&name, text),
    }
}

/// Returns what the system says, without the code that Rust adds.
fn os_text(error: &std::io::Error) -> String {
    let text = error.to_string();
    text.split(" (os error").next().unwrap_or_default().to_owned()
}

/// Returns the exception for what gives no result.
pub(crate) fn batch_error(error: BatchError) -> PyErr {
    match error {
        BatchError::File(error) => file_error(error),
        BatchError::Import(error) => read_error(&error),
        other => lab_error(other.to_string()),
    }
}

/// Returns the exception for a lab without a result.
pub(crate) fn lab_error(text: impl Into<String>) -> PyErr {
    python::LabError::new_err(text.into())
}

/// Returns the exception for a motion that a format cannot hold.
pub(crate) fn write_error(text: impl Into<String>) -> PyErr {
    python::WriteError::new_err(text.into())
}
