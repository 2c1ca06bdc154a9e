//! The numbers of motions, and the tables of what there is.

use crate::clip::Clip;
use crate::cores::detached;
use crate::words::lab_of;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use rayon::prelude::*;
use segue_motion::clip::Motion;
use segue_session::metrics::{METRICS, Metric};
use segue_session::{Kind, PARAMS, Param, metrics_of_clip};
use std::sync::Arc;

/// A number of a motion.
#[derive(Clone, Copy, Debug)]
pub(crate) struct MetricValue {
    name: &'static str,
    value: Option<f64>,
}

impl MetricValue {
    /// Returns the value of a metric.
    pub(crate) fn of(metric: &Metric) -> Self {
        Self { name: metric.id.row().name, value: metric.value }
    }

    /// Returns values by their names.
    pub(crate) fn as_dict<'py>(py: Python<'py>, values: &[Self]) -> PyResult<Bound<'py, PyDict>> {
        let dict = PyDict::new(py);
        for own in values {
            dict.set_item(own.name, own.value)?;
        }
        Ok(dict)
    }
}

/// Measures clips on all cores.
#[pyfunction]
pub(crate) fn metrics_of<'py>(
    py: Python<'py>,
    clips: Vec<PyRef<'py, Clip>>,
) -> PyResult<Vec<Bound<'py, PyDict>>> {
    let motions: Vec<Arc<Motion>> = clips.iter().map(|clip| Arc::clone(&clip.motion)).collect();
    let measured: Vec<Vec<MetricValue>> = detached(py, || {
        let of_motion =
            |motion: &Arc<Motion>| metrics_of_clip(motion).iter().map(MetricValue::of).collect();
        motions.par_iter().map(of_motion).collect()
    });
    measured.iter().map(|values| MetricValue::as_dict(py, values)).collect()
}

/// Returns the table of metrics: name, label, unit, better, help, good.
#[pyfunction]
pub(crate) fn metric_rows() -> Vec<[&'static str; 6]> {
    let row = |row: &segue_session::metrics::MetricRow| {
        [row.name, row.label, row.unit.text(), row.better.name(), row.help, row.good]
    };
    METRICS.iter().map(row).collect()
}

/// Returns the parameters of a lab's result, a dictionary each.
#[pyfunction]
pub(crate) fn parameter_rows<'py>(py: Python<'py>, lab: &str) -> PyResult<Vec<Bound<'py, PyDict>>> {
    let lab = lab_of(lab)?;
    let of_param = |param: &Param| {
        let dict = PyDict::new(py);
        dict.set_item("name", param.name)?;
        dict.set_item("label", param.label)?;
        dict.set_item("kind", param.kind.name())?;
        dict.set_item("unit", param.unit)?;
        dict.set_item("default", param.format(&param.default_value()))?;
        dict.set_item("help", param.help)?;
        match param.kind {
            Kind::Number { min, max, step, auto, .. } => {
                dict.set_item("range", (min, max))?;
                dict.set_item("step", step)?;
                dict.set_item("auto", auto)?;
            }
            Kind::Choice(choices) => {
                let words: Vec<&str> = choices.iter().map(|choice| choice.key).collect();
                dict.set_item("choices", words)?;
            }
            _ => {}
        }
        Ok(dict)
    };
    PARAMS.iter().filter(|param| param.is_ingredient_of(lab)).map(of_param).collect()
}
