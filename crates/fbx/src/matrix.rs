//! Transforms of ufbx as arrays.

/// Returns the columns of a transform, the last one its translation.
pub(crate) fn columns(m: &ufbx::Matrix) -> [[f64; 3]; 4] {
    [[m.m00, m.m10, m.m20], [m.m01, m.m11, m.m21], [m.m02, m.m12, m.m22], [m.m03, m.m13, m.m23]]
}
