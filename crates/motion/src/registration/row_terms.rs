//! Pair terms of some rows, for tiles of a matrix.

use super::{Alignment, PairTerms, PointClouds, RegistrationError};
use std::ops::Range;

/// The terms of some frames of a clip with all frames of another clip or of the same one: a part of
/// [`PairTerms`] that is computed by itself, with the same bits.
#[derive(Clone, Debug)]
pub(crate) struct RowTerms(PairTerms);

impl RowTerms {
    /// Compares the samples `rows` of the source, clamped to it, with the target. With `is_itself`
    /// both clouds are those of one clip, and only the pairs on and above the diagonal are
    /// compared. Memory: 12 bytes per pair.
    ///
    /// # Errors
    /// [`RegistrationError::TooManyPairs`] when there are more than 67 million pairs.
    pub(crate) fn new(
        source: &PointClouds,
        target: &PointClouds,
        is_itself: bool,
        rows: &Range<usize>,
    ) -> Result<Self, RegistrationError> {
        let mut terms = PairTerms::of_rows(source, target, is_itself, rows)?;
        terms.finish();
        Ok(Self(terms))
    }

    /// Compares the further samples before `end`, too, as far as there are any.
    ///
    /// # Errors
    /// [`RegistrationError::TooManyPairs`] when there are more than 67 million pairs.
    pub(crate) fn extend(&mut self, end: usize) -> Result<(), RegistrationError> {
        self.0.extend_rows(end)?;
        self.0.finish();
        Ok(())
    }

    /// Returns the distances of all windows of `window` frames that start at the samples `rows` of
    /// the source, row by row; of a clip with itself, each row has the cells from the diagonal on.
    /// `rows` begin at a multiple of [`ROWS_PER_SUM`](super::ROWS_PER_SUM).
    ///
    /// # Errors
    /// [`RegistrationError::Unfinished`] where their samples are not compared.
    pub(crate) fn distances(
        &self,
        window: usize,
        rows: &Range<usize>,
    ) -> Result<Vec<f32>, RegistrationError> {
        self.0.packed_rows(window, rows)
    }

    /// Returns the alignment of two windows, as [`PairTerms::alignment`] does.
    ///
    /// # Errors
    /// [`RegistrationError`] where their samples are not compared.
    pub(crate) fn alignment(
        &self,
        source: usize,
        target: usize,
        window: usize,
        fallback_yaw: f64,
    ) -> Result<Alignment, RegistrationError> {
        self.0.alignment(source, target, window, fallback_yaw)
    }

    /// Returns the number of bytes in memory.
    #[must_use]
    pub(crate) fn bytes(&self) -> usize {
        self.0.bytes()
    }
}

#[cfg(test)]
mod tests {
    use super::super::fixtures::Walk;
    use super::super::sweep::packed_start;
    use super::super::{ROWS_PER_SUM, limb_weights};
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(12))]
        #[test]
        fn rows_computed_alone_have_the_bits_of_the_whole_matrix(
            frames in [530usize..1_300, 40usize..560],
            window in [1usize..40, 1usize..40],
            piece in 1usize..700,
            is_itself: bool,
        ) {
            let clips = [0, 1].map(|k| {
                let walk = Walk { frames: frames[k], turning: 0.4, ..Walk::default() };
                Walk { cadence: walk.cadence + 0.1 * k as f32, ..walk }.clip()
            });
            let weights = limb_weights(clips[0].skeleton());
            let level = PointClouds::level_m(&clips[0], &weights).unwrap();
            let [source, other] = [&clips[0], &clips[1]].map(|clip| {
                PointClouds::new(clip, 0..clip.frames(), &weights, 1, level).unwrap()
            });
            let target = if is_itself { &source } else { &other };
            let mut whole = PairTerms::of_rows(&source, target, is_itself, &(0..usize::MAX)).unwrap();
            while !whole.advance(piece).is_complete() {}
            let columns = (target.samples() + 1).saturating_sub(window[0]);
            let all = 0..source.samples() + 1 - window[0];
            let wanted = whole.packed_rows(window[0], &all).unwrap();
            let start = |row: usize| if is_itself { packed_start(columns, row) } else { row * columns };
            for first in all.clone().step_by(ROWS_PER_SUM) {
                let rows = first..(first + piece.max(3)).min(all.end);
                // First the rows of another window, then what this one needs besides.
                let mut terms =
                    RowTerms::new(&source, target, is_itself, &(first..rows.end + window[1])).unwrap();
                terms.extend(rows.end + window[0] - 1).unwrap();
                // Not more memory than for the rows that are compared, in whole groups of four.
                let end = (rows.end + window[1].max(window[0] - 1)).next_multiple_of(4);
                let rows_held = end.min(source.samples()) - first;
                prop_assert!(terms.bytes() <= 12 * rows_held * target.samples().next_multiple_of(4));
                let found = terms.distances(window[0], &rows).unwrap();
                prop_assert!(found == wanted[start(rows.start)..start(rows.end)], "row {}", first);
                for (row, column) in [(first, 0), (rows.end - 1, columns.saturating_sub(1))] {
                    if columns > 0 && (!is_itself || row <= column) {
                        let [here, there] = [&terms.0, &whole].map(|terms| {
                            terms.alignment(row, column, window[0], 0.1).unwrap()
                        });
                        prop_assert_eq!(here, there);
                    }
                }
                prop_assert!(terms.alignment(first + piece + 600, 0, 1, 0.0).is_err());
            }
        }
    }
}
