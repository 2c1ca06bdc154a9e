//! Motion data as arrays of `NumPy`.

use glam::{Quat, Vec3};
use numpy::ndarray::{Array, IntoDimension};
use numpy::{Element, PyArray, PyArrayMethods as _};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

/// Returns an array that takes over the values.
///
/// # Errors
/// `ValueError` if the shape has another number of elements.
pub(crate) fn array<T: Element, D: IntoDimension>(
    py: Python<'_>,
    values: Vec<T>,
    shape: D,
) -> PyResult<Bound<'_, PyArray<T, D::Dim>>> {
    let array = Array::from_shape_vec(shape, values)
        .map_err(|error| PyValueError::new_err(error.to_string()))?;
    Ok(PyArray::from_owned_array(py, array))
}

/// Returns an array that takes over the values, and that Python cannot write to.
///
/// # Errors
/// `ValueError` if the shape has another number of elements.
pub(crate) fn fixed_array<T: Element, D: IntoDimension>(
    py: Python<'_>,
    values: Vec<T>,
    shape: D,
) -> PyResult<Py<PyArray<T, D::Dim>>> {
    let array = array(py, values, shape)?;
    array.readwrite().make_nonwriteable();
    Ok(array.unbind())
}

/// Returns the components of vectors, without a copy.
pub(crate) fn components(vectors: Vec<Vec3>) -> Vec<f32> {
    // A vector whose capacity is no multiple would be copied; those here have none to spare.
    bytemuck::allocation::try_cast_vec(vectors)
        .unwrap_or_else(|(_, vectors)| vectors.iter().flat_map(Vec3::to_array).collect())
}

/// Returns the components of quaternions in the order w x y z.
pub(crate) fn wxyz<'a>(quats: impl Iterator<Item = &'a Quat>) -> Vec<f32> {
    quats.flat_map(|quat| [quat.w, quat.x, quat.y, quat.z]).collect()
}
