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

/// Returns the components of a quaternion in the order w x y z.
pub(crate) fn wxyz(quat: &Quat) -> [f32; 4] {
    [quat.w, quat.x, quat.y, quat.z]
}

/// Checks the shape of an array.
pub(crate) fn expect_shape(name: &str, found: &[usize], expected: &[usize]) -> PyResult<()> {
    if found == expected {
        return Ok(());
    }
    Err(PyValueError::new_err(format!("{name}: found shape {found:?}, expected {expected:?}")))
}

/// Returns vectors of three finite numbers each.
pub(crate) fn vectors(name: &str, values: impl Iterator<Item = f32>) -> PyResult<Vec<Vec3>> {
    let values: Vec<f32> = values.collect();
    if values.iter().any(|value| !value.is_finite()) {
        return Err(PyValueError::new_err(format!("{name}: expected finite numbers")));
    }
    Ok(values.chunks_exact(3).map(Vec3::from_slice).collect())
}

/// Returns unit quaternions of numbers in the order w x y z.
pub(crate) fn unit_quaternions(values: impl Iterator<Item = f32>) -> PyResult<Vec<Quat>> {
    let values: Vec<f32> = values.collect();
    let of_four = |four: &[f32]| {
        let [w, x, y, z] = *four else {
            return Quat::IDENTITY;
        };
        Quat::from_xyzw(x, y, z, w)
    };
    let quats: Vec<Quat> = values.chunks_exact(4).map(of_four).collect();
    // Single precision keeps a length to 1e-6; a length that is off by more is another thing.
    if !quats.iter().all(|quat| (quat.length() - 1.0).abs() < 1e-3) {
        return Err(PyValueError::new_err("rotations: expected unit quaternions, w x y z"));
    }
    Ok(quats.into_iter().map(|quat| quat / quat.length()).collect())
}
