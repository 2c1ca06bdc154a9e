//! Smoothing and upper envelopes of sampled curves.

/// Returns means over `reach` values to either side with the weights of a raised cosine; at the
/// ends over the existing ones.
pub(crate) fn smoothed(values: &[f32], reach: usize) -> Vec<f32> {
    let weight =
        |off: isize| 1.0 + libm::cosf(std::f32::consts::PI * off as f32 / (reach + 1) as f32);
    let weights: Vec<f32> = (-(reach as isize)..=reach as isize).map(weight).collect();
    let mean = |at: usize| {
        let first = at.saturating_sub(reach);
        let around = &values[first..(at + reach + 1).min(values.len())];
        if around.iter().all(|&value| value == 0.0) {
            return 0.0;
        }
        let weights = &weights[first + reach - at..];
        let sum: f32 = around.iter().zip(weights).map(|(value, weight)| value * weight).sum();
        sum / weights[..around.len()].iter().sum::<f32>()
    };
    (0..values.len()).map(mean).collect()
}

/// Returns the largest of the values within `reach`; 0 where none is positive.
pub(crate) fn largest_around(values: &[f32], reach: usize) -> Vec<f32> {
    let around = |at: usize| &values[at.saturating_sub(reach)..(at + reach + 1).min(values.len())];
    (0..values.len()).map(|at| largest(around(at).iter().copied())).collect()
}

/// Returns the largest value; 0 where none is positive.
pub(crate) fn largest(values: impl Iterator<Item = f32>) -> f32 {
    // A comparison: `f32::max` is a call in WebAssembly.
    values.fold(0.0, |most, value| if value > most { value } else { most })
}
