//! The simulation root: the ground frame of the character without the sway of the stride.

use super::cycle::cycle_frame;
use super::features::RATE;
use crate::math::{Planar, wrap_angle};
use glam::DVec2;

/// Time over which positions and directions are smoothed, seconds.
const POSITION_SECS: f64 = 1.0;
const DIRECTION_SECS: f64 = 1.6;

/// Returns the simulation root of each frame of a clip at [`RATE`] frames per second,
/// `world_from_simulation`, from `frames` ([`crate::clip::character_frames`]).
///
/// Positions of the hips over the ground are smoothed by a Savitzky-Golay filter of third degree
/// over a second, and facing directions, as vectors, over 1.6 s (Holden et al., "Learned Motion
/// Matching", 2020, section 3, and his notes on the simulation bone). Unlike a mean it does not cut
/// corners. The windows are longer than his (0.5 s and 1 s), which let the sway of a stride of a
/// second pass: with the sway, every other half stride of a straight walk would match a little
/// better than the one that is playing. At the ends of the clip the polynomial of the first or last
/// window is extrapolated; clips shorter than a window are smoothed over their whole length.
#[must_use]
pub fn simulation_roots(frames: &[Planar]) -> Vec<Planar> {
    let positions: Vec<DVec2> = frames.iter().map(|frame| frame.shift).collect();
    let directions: Vec<DVec2> =
        frames.iter().map(|frame| DVec2::new(libm::sin(frame.yaw), libm::cos(frame.yaw))).collect();
    let half = |secs: f64| (0.5 * secs * RATE as f64).round() as usize;
    let positions = savitzky_golay(&positions, half(POSITION_SECS));
    let directions = savitzky_golay(&directions, half(DIRECTION_SECS));
    let mut yaw_before = None;
    (positions.into_iter().zip(directions).zip(frames))
        .map(|((shift, direction), frame)| {
            // A body that turns by half a turn within the window may have a mean direction of 0;
            // the previous one is then kept.
            let yaw = if direction.length() > 0.05 {
                libm::atan2(direction.x, direction.y)
            } else {
                yaw_before.unwrap_or(frame.yaw)
            };
            yaw_before = Some(yaw);
            Planar { yaw: wrap_angle(yaw), shift }
        })
        .collect()
}

/// Returns the simulation roots of a cycle, whose frame after the last is the first, moved by
/// `cycle`: smoothed over the neighbouring repetitions.
pub(super) fn simulation_roots_of_cycle(frames: &[Planar], cycle: &Planar) -> Vec<Planar> {
    // The number of frames to either side that are read.
    let around = (0.5 * POSITION_SECS.max(DIRECTION_SECS) * RATE as f64).round() as isize;
    let whole: Vec<Planar> = (-around..frames.len() as isize + around)
        .map(|frame| cycle_frame(frames, cycle, frame))
        .collect();
    let roots = simulation_roots(&whole);
    roots.into_iter().skip(around as usize).take(frames.len()).collect()
}

/// Replaces each value by that of the cubic that best fits it and `half` neighbours to either side
/// (Savitzky and Golay 1964). Near the ends the cubic of the outermost window is evaluated off its
/// middle. O(values × half).
fn savitzky_golay(values: &[DVec2], half: usize) -> Vec<DVec2> {
    let half = half.min(values.len().saturating_sub(1) / 2);
    // A cubic passes through four values: fewer than five cannot be smoothed.
    if half < 2 {
        return values.to_vec();
    }
    let window = 2 * half + 1;
    let last = values.len() - window;
    let m = half as f64;
    let middle: Vec<f64> = (0..window)
        .map(|i| {
            let i = i as f64 - m;
            3.0 * (3.0 * m * m + 3.0 * m - 1.0 - 5.0 * i * i)
                / ((2.0 * m + 3.0) * (2.0 * m + 1.0) * (2.0 * m - 1.0))
        })
        .collect();
    let ends = [0, last].map(|start| Cubic::fit(&values[start..start + window], m));
    (0..values.len())
        .map(|index| {
            if index < half {
                ends[0].at(index as f64 - m)
            } else if index - half > last {
                ends[1].at((index - last) as f64 - m)
            } else {
                let start = index - half;
                values[start..start + window]
                    .iter()
                    .zip(&middle)
                    .map(|(value, share)| *value * *share)
                    .sum()
            }
        })
        .collect()
}

/// A cubic in Gram polynomials, which are orthogonal over `-m..=m`.
struct Cubic {
    m: f64,
    shares: [DVec2; 4],
}

impl Cubic {
    fn basis(m: f64, i: f64) -> [f64; 4] {
        [1.0, i, i * i - m * (m + 1.0) / 3.0, i * (i * i - (3.0 * m * m + 3.0 * m - 1.0) / 5.0)]
    }

    fn fit(values: &[DVec2], m: f64) -> Self {
        let (mut shares, mut norms) = ([DVec2::ZERO; 4], [0.0; 4]);
        for (index, &value) in values.iter().enumerate() {
            for ((share, norm), basis) in
                shares.iter_mut().zip(&mut norms).zip(Self::basis(m, index as f64 - m))
            {
                *share += value * basis;
                *norm += basis * basis;
            }
        }
        for (share, norm) in shares.iter_mut().zip(norms) {
            *share /= norm;
        }
        Self { m, shares }
    }

    fn at(&self, i: f64) -> DVec2 {
        self.shares.iter().zip(Self::basis(self.m, i)).map(|(share, basis)| *share * basis).sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn savitzky_golay_keeps_cubics_and_removes_sway() {
        let cubic = |i: usize| {
            let t = i as f64 / 20.0;
            DVec2::new(1.0 + t - 0.3 * t * t, 0.1 * t * t * t)
        };
        for frames in [1, 4, 5, 20, 90] {
            let values: Vec<DVec2> = (0..frames).map(cubic).collect();
            for (smoothed, value) in savitzky_golay(&values, 15).iter().zip(&values) {
                assert!(smoothed.distance(*value) < 1e-9, "{frames}");
            }
        }
        let walk: Vec<Planar> = (0..300)
            .map(|i| {
                let t = f64::from(i) / 60.0;
                Planar::new(0.1 * libm::sin(11.0 * t), 0.02 * libm::sin(11.0 * t), 1.4 * t)
            })
            .collect();
        let roots = simulation_roots(&walk);
        let most = |value: fn(&Planar) -> f64, frames: &[Planar]| {
            frames.iter().map(|f| value(f).abs()).fold(0.0, f64::max)
        };
        assert!(most(|f| f.yaw, &roots[40..260]) < 0.4 * most(|f| f.yaw, &walk));
        assert_eq!(simulation_roots(&[]), []);
    }
}
