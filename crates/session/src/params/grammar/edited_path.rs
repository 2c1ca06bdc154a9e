//! An edited path: its control points, rounded to 1 cm, in a short word.

use super::Misread;
use segue_motion::path::GroundSpline;

pub(super) fn read(text: &str) -> Result<Option<GroundSpline>, Misread> {
    if text.is_empty() {
        return Ok(None);
    }
    Ok(Some(GroundSpline::from_code(text)?))
}

#[expect(clippy::ref_option, reason = "writers of all lists take a reference to their value")]
pub(super) fn write(path: &Option<GroundSpline>) -> String {
    path.as_ref().map_or_else(String::new, GroundSpline::to_code)
}
