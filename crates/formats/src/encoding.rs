//! The `sRGB` encoding of colours (IEC 61966-2-1).

/// Encodes a channel of a linear colour; what is out of range, or no number, becomes the nearest
/// end, or 1.
pub(super) fn encoded(linear: f32) -> f32 {
    if !linear.is_finite() || linear >= 1.0 {
        1.0
    } else if linear <= 0.003_130_8 {
        let linear = linear.max(0.0);
        linear * 12.92
    } else {
        1.055 * libm::powf(linear, 1.0 / 2.4) - 0.055
    }
}

/// Decodes a channel, 0 to 1, to linear light: the inverse of [`encoded`].
pub(super) fn linear(encoded: f32) -> f32 {
    if encoded <= 0.040_45 { encoded / 12.92 } else { libm::powf((encoded + 0.055) / 1.055, 2.4) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn linear_is_the_inverse_of_encoded() {
        for value in (0..=255).map(|byte| byte as f32 / 255.0) {
            assert!((encoded(linear(value)) - value).abs() < 1e-5, "{value}");
        }
        assert!((linear(0.5) - 0.214).abs() < 1e-3);
        assert_eq!((encoded(f32::NAN), encoded(-1.0), encoded(2.0)), (1.0, 0.0, 1.0));
    }
}
