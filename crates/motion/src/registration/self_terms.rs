//! Pair terms of a clip with itself.

use super::sweep::{PausedSweep, Sweep, packed_start};
use super::{Alignment, PairTerms, PointClouds, Progress, RegistrationError};

/// The terms of all pairs of frames of one clip with itself: like [`PairTerms`] at half the time
/// and half the memory, since the distance of two windows is symmetric.
///
/// Only pairs (i, j) with j ≥ i, on and above the diagonal, are stored; so are all pairs that a
/// window adds to them: (i + 1, j + 1) and on.
#[derive(Clone, Debug)]
pub(crate) struct SelfTerms(PairTerms);

impl SelfTerms {
    /// Prepares the comparison. Nothing is compared yet: call [`advance`](Self::advance). Memory: 6
    /// bytes per pair (i, j) of samples.
    ///
    /// # Errors
    /// [`RegistrationError::TooManyPairs`] above 11,500 samples.
    pub(crate) fn new(clouds: &PointClouds) -> Result<Self, RegistrationError> {
        Ok(Self(PairTerms::of_itself(clouds)?))
    }

    /// Compares at least `rows` more frames with the following ones (in groups of four rows), and
    /// returns the progress. Rows get shorter and shorter.
    pub(crate) fn advance(&mut self, rows: usize) -> Progress {
        self.0.advance(rows)
    }

    /// Returns the progress.
    #[must_use]
    pub(crate) fn progress(&self) -> Progress {
        self.0.progress()
    }

    /// Returns the computation of the distances between all windows of `window` frames, in slices;
    /// there are none where the window is longer than the compared part.
    ///
    /// # Errors
    /// [`RegistrationError::Unfinished`] before all rows are compared.
    pub(crate) fn sweep(&self, window: usize) -> Result<SelfSweep<'_>, RegistrationError> {
        let all = 0..usize::MAX;
        let rows = self.0.source.starts(&all, window.max(1), self.0.stride()).len();
        Ok(SelfSweep { sweep: self.0.sweep(window, &all, &all)?, rows })
    }

    /// Returns the alignment of the windows of `window` frames that start at the samples next to
    /// frame `source` and frame `target`: `source_from_target`. O(window).
    ///
    /// # Errors
    /// [`RegistrationError`] before the rows of the windows are compared, or when a window crosses
    /// the end of the compared part.
    pub(crate) fn alignment(
        &self,
        source: usize,
        target: usize,
        window: usize,
        fallback_yaw: f64,
    ) -> Result<Alignment, RegistrationError> {
        if source <= target {
            return self.0.alignment(source, target, window, fallback_yaw);
        }
        let found = self.0.alignment(target, source, window, -fallback_yaw)?;
        Ok(Alignment { transform: found.transform.inverse(), ..found })
    }
}

/// A [`Sweep`] of a clip with itself.
#[derive(Clone, Debug)]
pub(crate) struct SelfSweep<'a> {
    sweep: Sweep<'a>,
    rows: usize,
}

/// A [`SelfSweep`] that does not borrow the terms until it is resumed.
#[derive(Clone, Debug)]
pub(crate) struct PausedSelfSweep {
    sweep: PausedSweep,
    rows: usize,
}

impl PausedSelfSweep {
    /// Resumes the sweep. `terms` are those from which it was made.
    #[must_use]
    pub(crate) fn resume(self, terms: &SelfTerms) -> SelfSweep<'_> {
        SelfSweep { sweep: self.sweep.resume(&terms.0), rows: self.rows }
    }
}

impl SelfSweep<'_> {
    /// Stops borrowing the terms, so that the rest can be computed later.
    #[must_use]
    pub(crate) fn pause(self) -> PausedSelfSweep {
        PausedSelfSweep { sweep: self.sweep.pause(), rows: self.rows }
    }

    /// Computes up to `rows` more rows, and returns the progress.
    pub(crate) fn advance(&mut self, rows: usize) -> Progress {
        self.sweep.advance(rows)
    }

    /// Computes the remaining rows and returns the distances.
    #[must_use]
    pub(crate) fn finish(self) -> SymmetricDistances {
        SymmetricDistances { rows: self.rows, rms_m: self.sweep.finish_packed() }
    }
}

/// Distances between windows of a clip and windows of the same clip; only those on and above the
/// diagonal are stored.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct SymmetricDistances {
    rows: usize,
    rms_m: Vec<f32>,
}

impl SymmetricDistances {
    /// Returns the number of rows, which is that of columns.
    #[must_use]
    pub(crate) fn rows(&self) -> usize {
        self.rows
    }

    /// Returns one root-mean-square distance per point, metres, the same for (a, b) and (b, a);
    /// `None` outside the matrix.
    #[must_use]
    pub(crate) fn get(&self, a: usize, b: usize) -> Option<f32> {
        self.row(a.min(b)).get(a.abs_diff(b)).copied()
    }

    /// Returns the distances of one row from its own column on, metres; empty outside the matrix.
    #[must_use]
    pub(crate) fn row(&self, row: usize) -> &[f32] {
        if row >= self.rows {
            return &[];
        }
        let start = packed_start(self.rows, row);
        self.rms_m.get(start..start + self.rows - row).unwrap_or_default()
    }
}

#[cfg(test)]
mod tests {
    use super::super::fixtures::Walk;
    use super::super::{limb_weights, rms_cm};
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(24))]
        #[test]
        fn self_terms_agree_with_pair_terms(
            frames in 1usize..60,
            window in 1usize..25,
            turning in -1.0f32..1.0,
            slice in 1usize..20,
        ) {
            let clip = Walk { frames, turning, ..Walk::default() }.clip();
            let weights = limb_weights(clip.skeleton());
            let level = PointClouds::level_m(&clip, &weights).unwrap();
            let clouds = PointClouds::new(&clip, 0..frames, &weights, 1, level).unwrap();
            let mut half = SelfTerms::new(&clouds).unwrap();
            if frames > 4 {
                prop_assert!(half.sweep(window).is_err());
            }
            while !half.advance(slice).is_complete() {}
            let mut whole =
                PairTerms::new(&clip, 0..frames, &clip, 0..frames, &weights, 1).unwrap();
            whole.finish();
            let all = 0..frames;
            let (packed, full) = (
                half.sweep(window).unwrap().finish(),
                whole.distances(window, &all, &all).unwrap(),
            );
            prop_assert_eq!(packed.rows(), full.rows());
            for row in 0..full.rows() {
                for column in 0..full.columns() {
                    let (found, wanted) =
                        (packed.get(row, column).unwrap(), full.get(row, column).unwrap());
                    prop_assert!(
                        (found * found - wanted * wanted).abs() < 3e-7,
                        "{} {} {} {}",
                        row,
                        column,
                        found,
                        wanted
                    );
                    if row <= column {
                        prop_assert_eq!(found, wanted);
                    }
                    let (a, b) = (
                        half.alignment(row, column, window, 0.0).unwrap(),
                        whole.alignment(row, column, window, 0.0).unwrap(),
                    );
                    prop_assert!(
                        (a.distance - b.distance).abs() < 1e-5
                            && (a.transform.yaw - b.transform.yaw).abs() < 1e-3
                    );
                    prop_assert!((a.transform.shift - b.transform.shift).length() < 1e-3);
                    let direct = rms_cm(a.distance, a.weight, 1.75) / 100.0;
                    prop_assert!((direct * direct - f64::from(found * found)).abs() < 3e-7);
                }
            }
            prop_assert_eq!(packed.get(full.rows(), 0), None);
        }
    }
}
