//! Zero-phase low-pass filter.

use std::f64::consts::{PI, SQRT_2};

/// The cut-off of two passes of a second-order Butterworth filter lies at this share of that of a
/// single pass, in the frequencies of the bilinear transform: `(√2 - 1)^(1/4)`.
const TWO_PASSES: f64 = 0.802;

/// A second-order Butterworth low-pass that is run over a signal forward and backward, so that
/// nothing is delayed: the fourth-order zero-lag filter of biomechanics.
///
/// The cut-off is that of both passes together, at which the amplitude is 0.707 of the original
/// (Winter, "Biomechanics and Motor Control of Human Movement", 4th ed., section 3.4.4.2). Before
/// and after the signal it is continued by its point reflection, so that a constant and a straight
/// line stay as they are.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LowPass {
    forward: [f64; 3],
    back: [f64; 2],
    padding: usize,
}

impl LowPass {
    /// Returns a filter for signals of a sample rate, both in hertz. A cut-off of 45 % of the rate
    /// or more leaves the signal as it is: `None`, as for numbers that are not above 0.
    #[must_use]
    pub fn new(cutoff_hz: f64, rate_hz: f64) -> Option<Self> {
        if !(cutoff_hz > 0.0 && rate_hz > 0.0 && cutoff_hz < 0.45 * rate_hz) {
            return None;
        }
        let k = libm::tan(PI * cutoff_hz / rate_hz) / TWO_PASSES;
        let norm = 1.0 / (1.0 + SQRT_2 * k + k * k);
        let gain = k * k * norm;
        Some(Self {
            forward: [gain, 2.0 * gain, gain],
            back: [2.0 * (k * k - 1.0) * norm, (1.0 - SQRT_2 * k + k * k) * norm],
            padding: ((1.2 * rate_hz / cutoff_hz).ceil() as usize).clamp(9, 4_096),
        })
    }

    /// Filters a signal in place.
    pub fn apply(&self, signal: &mut [f64]) {
        let Some((&first, &last)) = signal.first().zip(signal.last()) else {
            return;
        };
        let padding = self.padding.min(signal.len() - 1);
        let mut padded = Vec::with_capacity(signal.len() + 2 * padding);
        padded.extend((1..=padding).rev().map(|at| 2.0 * first - signal[at]));
        padded.extend_from_slice(signal);
        let end = signal.len() - 1;
        padded.extend((1..=padding).map(|at| 2.0 * last - signal[end - at]));
        self.pass(&mut padded);
        padded.reverse();
        self.pass(&mut padded);
        padded.reverse();
        signal.copy_from_slice(&padded[padding..padding + signal.len()]);
    }

    /// Runs over the signal once, from the steady state of its first value.
    fn pass(&self, signal: &mut [f64]) {
        let first = signal.first().copied().unwrap_or(0.0);
        let ([b0, b1, b2], [a1, a2]) = (self.forward, self.back);
        let (mut x1, mut x2, mut y1, mut y2) = (first, first, first, first);
        for value in signal {
            let x0 = *value;
            let y0 = b0 * x0 + b1 * x1 + b2 * x2 - a1 * y1 - a2 * y2;
            (x2, x1, y2, y1) = (x1, x0, y1, y0);
            *value = y0;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn low_pass_of_a_straight_line_is_the_line() {
        let line: Vec<f64> = (0..200).map(|at| 3.0 - 0.25 * f64::from(at)).collect();
        let mut filtered = line.clone();
        LowPass::new(6.0, 120.0).unwrap().apply(&mut filtered);
        assert!(line.iter().zip(&filtered).all(|(a, b)| (a - b).abs() < 0.02));
    }

    #[test]
    fn low_pass_at_its_cutoff_halves_the_power_without_delay() {
        for cutoff in [4.0, 8.0, 15.0] {
            let wave = |at: usize| (2.0 * PI * cutoff * at as f64 / 120.0 + 0.3).sin();
            let mut filtered: Vec<f64> = (0..2_400).map(wave).collect();
            LowPass::new(cutoff, 120.0).unwrap().apply(&mut filtered);
            let middle = 600..1_800;
            let (mut along, mut own, mut across) = (0.0, 0.0, 0.0);
            for at in middle {
                along += filtered[at] * wave(at);
                own += wave(at) * wave(at);
                across += filtered[at] * (2.0 * PI * cutoff * at as f64 / 120.0 + 0.3).cos();
            }
            assert!((along / own - 0.5_f64.sqrt()).abs() < 0.01, "{cutoff}: {}", along / own);
            assert!((across / own).abs() < 1e-3, "{cutoff}: delayed");
        }
    }

    #[derive(serde::Deserialize)]
    struct Case {
        rate: f64,
        cutoff: f64,
        signal: Vec<f64>,
        filtered: Vec<f64>,
    }

    #[test]
    fn low_pass_agrees_with_scipy() {
        let text = include_str!("../../tests/oracles/lowpass.json");
        let cases: Vec<Case> = serde_json::from_str(text).unwrap();
        assert!(cases.len() > 4);
        for Case { rate, cutoff, mut signal, filtered } in cases {
            LowPass::new(cutoff, rate).unwrap().apply(&mut signal);
            for (own, wanted) in signal.iter().zip(&filtered) {
                assert!((own - wanted).abs() < 1e-9, "{cutoff} Hz of {rate}: {own} {wanted}");
            }
        }
    }

    #[test]
    fn low_pass_near_the_sample_rate_is_none() {
        for (cutoff, rate) in
            [(0.0, 30.0), (-1.0, 30.0), (14.0, 30.0), (f64::NAN, 30.0), (6.0, 0.0)]
        {
            assert_eq!(LowPass::new(cutoff, rate), None, "{cutoff} {rate}");
        }
        let mut short = [1.0];
        LowPass::new(6.0, 30.0).unwrap().apply(&mut short);
        assert_eq!(short, [1.0]);
    }
}
