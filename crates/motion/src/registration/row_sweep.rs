//! Distances of windows row by row, with few rows of terms in memory.

use super::sweep::Sums;
use super::{Alignment, DistanceMatrix, PairTerms, PointClouds, RegistrationError};
use std::ops::Range;

/// The comparison of two clouds and the distances of their windows, row by row from the first to
/// the last: those of [`PairTerms::distances`] for the same ranges, to the last bit. Only the terms
/// of the last rows are in memory. They fit into a second-level cache, even where those of all rows
/// do not.
#[derive(Clone, Debug)]
pub(crate) struct RowSweep {
    terms: PairTerms,
    sums: Sums,
    window: usize,
    rows: Range<usize>,
    columns: usize,
}

impl RowSweep {
    /// Prepares the distances of all windows of `window` frames that start in `sources` and
    /// `targets` (frames of the clips; clamped to the clouds). Both clouds must have the same
    /// skeleton, weights, stride and level. Nothing is computed yet.
    pub(crate) fn new(
        [source, target]: [&PointClouds; 2],
        window: usize,
        [sources, targets]: [&Range<usize>; 2],
    ) -> Self {
        let window = window.max(1);
        let starts = |clouds: &PointClouds, of: &Range<usize>| {
            clouds.cloud.starts(of, window, clouds.stride)
        };
        let (rows, columns) = (starts(source, sources), starts(target, targets));
        let samples = (window - 1) / source.stride + 1;
        let compared = |of: &Range<usize>| of.start..of.end + samples - 1;
        // A row of distances needs the terms of its windows, and of the frame before them.
        let terms = PairTerms::with_ring(
            source,
            target,
            &compared(&rows),
            &compared(&columns),
            samples + 1,
        );
        Self {
            sums: Sums::new(&terms, window, rows.clone(), columns.clone()),
            terms,
            window,
            rows,
            columns: columns.len(),
        }
    }

    /// Computes the rows before `end`, as far as there are any.
    pub(crate) fn advance(&mut self, end: usize) {
        if self.columns == 0 {
            return;
        }
        let samples = self.terms.samples_in(self.window);
        for row in self.sums.done()..end.min(self.rows.len()) {
            self.terms.advance_to(self.rows.start + row + samples);
            self.sums.advance(&self.terms);
        }
    }

    /// Returns the distances of a row, metres; none before it is computed.
    pub(crate) fn row(&self, row: usize) -> &[f32] {
        let start = row.saturating_mul(self.columns);
        self.sums.rms_m.get(start..start.saturating_add(self.columns)).unwrap_or_default()
    }

    /// Returns the alignment of two windows, as [`PairTerms::alignment`] does, of one of the last
    /// two computed rows.
    ///
    /// # Errors
    /// [`RegistrationError`] where their terms are not in memory: not yet, or not any more.
    pub(crate) fn alignment(
        &self,
        source: usize,
        target: usize,
        fallback_yaw: f64,
    ) -> Result<Alignment, RegistrationError> {
        self.terms.alignment(source, target, self.window, fallback_yaw)
    }

    /// Computes the remaining rows and returns all distances.
    pub(crate) fn finish(mut self) -> DistanceMatrix {
        self.advance(usize::MAX);
        self.sums.into_matrix(&self.terms)
    }
}

#[cfg(test)]
mod tests {
    use super::super::cloud::LANES;
    use super::super::fixtures::Walk;
    use super::super::limb_weights;
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(24))]
        #[test]
        fn rows_equal_those_of_all_terms(
            frames in [60usize..700, 40usize..200],
            window in 1usize..39,
            stride in 1usize..3,
            parts in [0.0..0.8_f64, 0.0..0.8_f64],
            piece in 1usize..9,
        ) {
            let clips = [0, 1].map(|k| {
                let walk = Walk { frames: frames[k], turning: 0.4, ..Walk::default() };
                Walk { cadence: walk.cadence + 0.1 * k as f32, ..walk }.clip()
            });
            let weights = limb_weights(clips[0].skeleton());
            let level = PointClouds::level_m(&clips[0], &weights).unwrap();
            let [source, target] = [&clips[0], &clips[1]].map(|clip| {
                PointClouds::new(clip, 0..clip.frames(), &weights, stride, level).unwrap()
            });
            let [sources, targets] = [0, 1].map(|k| {
                let first = (parts[k] * frames[k] as f64) as usize;
                first..first + frames[k] / 2
            });
            let mut all = PairTerms::of_clouds(&source, &target).unwrap();
            all.finish();
            let wanted = all.distances(window, &sources, &targets).unwrap();
            let mut sweep = RowSweep::new([&source, &target], window, [&sources, &targets]);
            for end in (0..=wanted.rows()).step_by(piece).skip(1) {
                prop_assert!(sweep.row(end).is_empty());
                sweep.advance(end);
                for row in end.saturating_sub(piece)..end {
                    prop_assert_eq!(sweep.row(row), wanted.row(row));
                }
                for row in end.saturating_sub(2)..end {
                    for column in [0, wanted.columns().saturating_sub(1)] {
                        if wanted.columns() > 0 {
                            let (a, b) = wanted.frames(row, column);
                            let there = all.alignment(a, b, window, 0.1).unwrap();
                            prop_assert_eq!(sweep.alignment(a, b, 0.1).unwrap(), there);
                        }
                    }
                }
            }
            // Windows outside, and those whose terms are not in memory any more.
            let (first, _) = wanted.frames(0, 0);
            if wanted.rows() > 40 && wanted.columns() > 0 {
                sweep.advance(wanted.rows());
                prop_assert!(sweep.alignment(first, targets.start, 0.1).is_err());
            }
            let last = wanted.frames(wanted.rows(), 0).0;
            prop_assert!(sweep.alignment(last + 40 * stride, targets.start, 0.1).is_err());
            prop_assert_eq!(sweep.finish(), wanted);
        }
    }

    fn sweep(
        frames: [usize; 2],
        window: usize,
        sources: &Range<usize>,
        targets: &Range<usize>,
    ) -> RowSweep {
        let clips = frames.map(|frames| Walk { frames, ..Walk::default() }.clip());
        let weights = limb_weights(clips[0].skeleton());
        let level = PointClouds::level_m(&clips[0], &weights).unwrap();
        let clouds = clips
            .each_ref()
            .map(|clip| PointClouds::new(clip, 0..clip.frames(), &weights, 1, level).unwrap());
        RowSweep::new(clouds.each_ref(), window, [sources, targets])
    }

    #[test]
    fn no_windows_have_no_distances() {
        let all = 0..usize::MAX;
        for (frames, window, sources, targets, size) in [
            ([1, 1], 1, &all, &all, (1, 1)),
            ([1, 30], 1, &all, &all, (1, 30)),
            ([9, 30], 10, &all, &all, (0, 21)),
            ([30, 9], 10, &all, &all, (21, 0)),
            ([9, 9], 10, &all, &all, (0, 0)),
            ([30, 40], 10, &(5..5), &all, (0, 31)),
            ([30, 40], 10, &all, &(50..60), (21, 0)),
        ] {
            let mut sweep = sweep(frames, window, sources, targets);
            sweep.advance(3);
            assert_eq!(sweep.row(0).len(), if size.0 > 0 { size.1 } else { 0 });
            let found = sweep.finish();
            assert_eq!((found.rows(), found.columns()), size);
            assert_eq!(found.rms_m().len(), size.0 * size.1);
        }
    }

    #[test]
    fn windows_outside_the_columns_have_no_alignment() {
        let mut sweep = sweep([60, 90], 5, &(0..20), &(40..50));
        sweep.advance(10);
        for target in [0, 20, 39 - LANES, 50 + LANES, 80] {
            assert!(sweep.alignment(8, target, 0.0).is_err(), "{target}");
        }
        for target in [40, 49] {
            assert!(sweep.alignment(8, target, 0.0).is_ok());
        }
    }
}
