//! Quantities that are plotted below the first: `height,angle`.

use super::{Misread, between_commas, entries, joined};
use crate::params::choices::{Curve, Selected};

/// The greatest number of curves below the first.
pub const MAX_MORE_CURVES: usize = 3;

pub(super) fn read(text: &str) -> Result<Vec<Curve>, Misread> {
    let expected = "speed, height, distance, angle or turn";
    entries(between_commas(text), MAX_MORE_CURVES, expected, Curve::from_word)
}

pub(super) fn write(curves: &[Curve]) -> String {
    joined(curves, |curve| curve.word().to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn curves_read_back_as_written() {
        for text in ["height,angle", "turn,distance,speed", ""] {
            assert_eq!(write(&read(text).unwrap()), text);
        }
        assert_eq!(read(" angle , height,"), Ok(vec![Curve::Angle, Curve::Height]));
    }

    #[test]
    fn invalid_curve_is_named() {
        let error = read("height,heigth").unwrap_err().to_string();
        let wanted = "entry 2: found `heigth`, expected speed, height, distance, angle or turn";
        assert_eq!(error, wanted);
        assert!(read("height,angle,turn,speed").unwrap_err().to_string().contains("3 at most"));
    }
}
