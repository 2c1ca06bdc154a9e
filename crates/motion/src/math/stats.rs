//! Order statistics and means.

/// Returns the value below which the share `p` (0 to 1) of `values` lies, with linear interpolation
/// between neighbours (the "linear" definition that `NumPy` uses). `None` for an empty list; NaN
/// sorts last.
#[must_use]
pub fn percentile(values: &[f32], p: f32) -> Option<f32> {
    let mut values = values.to_vec();
    let last = values.len().checked_sub(1)?;
    let at = p.clamp(0.0, 1.0) * last as f32;
    // Only these two values need sorting: `select_nth` puts greater ones after them and smaller
    // ones before.
    let (_, &mut below, rest) =
        values.select_nth_unstable_by((at.floor() as usize).min(last), f32::total_cmp);
    let above = rest.iter().copied().min_by(f32::total_cmp).unwrap_or(below);
    Some(below + (above - below) * at.fract())
}

/// Returns the median, with the mean of the middle two of an even number of values. `None` for an
/// empty list; NaN sorts last.
#[must_use]
pub fn median(values: &[f64]) -> Option<f64> {
    let mut values = values.to_vec();
    let middle = values.len() / 2;
    let is_odd = values.len() % 2 == 1;
    if values.is_empty() {
        return None;
    }
    let (below, &mut upper, _) = values.select_nth_unstable_by(middle, f64::total_cmp);
    let lower = below.iter().copied().max_by(f64::total_cmp).filter(|_| !is_odd);
    Some((lower.unwrap_or(upper) + upper) * 0.5)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn median_of_an_even_number_is_the_mean_of_the_middle_two() {
        assert_eq!(median(&[]), None);
        assert_eq!(median(&[7.0]), Some(7.0));
        assert_eq!(median(&[9.0, 1.0, 4.0]), Some(4.0));
        assert_eq!(median(&[9.0, 1.0, 4.0, 2.0]), Some(3.0));
    }

    #[test]
    fn percentile_interpolates_linearly() {
        assert_eq!(percentile(&[], 0.5), None);
        assert_eq!(percentile(&[4.0], 0.99), Some(4.0));
        assert_eq!(percentile(&[3.0, 1.0, 2.0], 0.5), Some(2.0));
        assert_eq!(percentile(&[0.0, 10.0], 0.25), Some(2.5));
        let values: Vec<f32> = (0..101).map(|i| ((i * 37) % 101) as f32).collect();
        for p in 0..=100 {
            assert!((percentile(&values, p as f32 / 100.0).unwrap() - p as f32).abs() < 1e-4);
        }
    }
}
