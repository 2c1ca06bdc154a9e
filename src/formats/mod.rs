//! stub
use crate::clip::{Clip, UpAxis};
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{file}:{line}:{column}: found {found}, expected {expected}")]
pub struct ImportError {
    pub file: String,
    pub line: usize,
    pub column: usize,
    pub found: String,
    pub expected: String,
}
#[derive(Clone, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct ImportOptions {
    pub metres_per_unit: Option<f64>,
    pub up: Option<UpAxis>,
    pub fps: Option<f64>,
}
pub struct ImportedClip {
    pub clip: Clip,
}
pub struct Imported {
    pub clips: Vec<ImportedClip>,
    pub warnings: Vec<String>,
}
pub fn import(_: &str, _: &[u8], _: &ImportOptions) -> Result<Imported, ImportError> {
    Ok(Imported {
        clips: vec![],
        warnings: vec![],
    })
}
pub fn unpack_gzip(_: &str, _: &[u8]) -> Result<Vec<u8>, ImportError> {
    Ok(vec![])
}
