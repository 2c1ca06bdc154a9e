//! Units, axes and rates in words.

use segue_motion::clip::UpAxis;
use segue_session::export::ExportRoot;

/// The units of length by their names, in metres.
const UNITS: [(&str, f64); 5] =
    [("mm", 0.001), ("cm", 0.01), ("m", 1.0), ("in", 0.0254), ("ft", 0.3048)];

/// Reads a unit of length: a name, or metres per unit.
///
/// # Errors
/// A sentence that says which are known.
pub fn parse_unit(text: &str) -> Result<f64, String> {
    if let Some((_, metres)) = UNITS.iter().find(|(name, _)| *name == text) {
        return Ok(*metres);
    }
    match text.parse::<f64>() {
        Ok(metres) if metres.is_finite() && metres > 0.0 => Ok(metres),
        _ => Err("expected mm, cm, m, in, ft, or metres per unit, as in 0.01".to_owned()),
    }
}

/// Reads an up axis.
///
/// # Errors
/// A sentence that says which are known.
pub fn parse_up(text: &str) -> Result<UpAxis, String> {
    match text {
        "y" | "Y" => Ok(UpAxis::Y),
        "z" | "Z" => Ok(UpAxis::Z),
        _ => Err("expected y or z".to_owned()),
    }
}

/// Reads the joint that has the motion over the ground.
///
/// # Errors
/// A sentence that says which are known.
pub fn parse_root(text: &str) -> Result<ExportRoot, String> {
    ExportRoot::from_name(text).ok_or_else(|| {
        format!("expected one of {}", ExportRoot::ALL.map(ExportRoot::name).join(", "))
    })
}

/// Reads frames per second.
///
/// # Errors
/// A sentence that says what is possible.
pub fn parse_rate(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(fps) if (1.0..=1_000.0).contains(&fps) => Ok(fps),
        _ => Err("expected 1 to 1000 frames per second".to_owned()),
    }
}

/// Returns the name of a unit of length, or metres per unit.
#[must_use]
pub fn unit_name(metres_per_unit: f64) -> String {
    let known = UNITS.iter().find(|(_, metres)| (metres / metres_per_unit - 1.0).abs() < 1e-6);
    known.map_or_else(|| format!("{metres_per_unit} m"), |(name, _)| (*name).to_owned())
}

/// Returns the name of an up axis.
#[must_use]
pub const fn up_name(up: UpAxis) -> &'static str {
    match up {
        UpAxis::Y => "y",
        UpAxis::Z => "z",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_are_read_and_named() {
        for (name, metres) in UNITS {
            assert_eq!((parse_unit(name), unit_name(metres)), (Ok(metres), name.to_owned()));
        }
        assert_eq!(parse_unit("0.05"), Ok(0.05));
        assert_eq!(unit_name(0.05), "0.05 m");
        for bad in ["", "km", "-1", "0", "NaN", "inf"] {
            assert!(parse_unit(bad).is_err(), "{bad}");
        }
        assert!(parse_rate("0").is_err() && parse_rate("30") == Ok(30.0));
        assert!(parse_up("x").is_err() && parse_up("Z") == Ok(UpAxis::Z));
    }
}
