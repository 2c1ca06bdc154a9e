//! Words from Python: units and labs.

use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use segue_batch::parse_unit;
use segue_session::choices::{LabId, Selected as _};

/// Returns a unit of length in metres: a name such as "cm", or a number.
pub(crate) fn unit_of(unit: &Bound<'_, PyAny>) -> PyResult<f64> {
    let text = unit.str()?.to_string();
    parse_unit(&text).map_err(|reason| PyValueError::new_err(format!("unit: {reason}")))
}

/// Returns the lab of a word in links.
pub(crate) fn lab_of(word: &str) -> PyResult<LabId> {
    LabId::from_word(word).ok_or_else(|| {
        let known: Vec<&str> = LabId::ALL.iter().map(|lab| lab.word()).collect();
        PyValueError::new_err(format!("there is no lab {word:?}, only {}", known.join(", ")))
    })
}
