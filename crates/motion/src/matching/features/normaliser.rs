//! The normalisation of features in slices.

use super::{Features, Layout, Normalisation};
use std::sync::Arc;

/// The normalisation of rows to [`Features`], in slices.
#[derive(Clone, Debug)]
pub(in crate::matching) struct Normaliser {
    /// The features, whose rows are raw before the last pass.
    features: Features,
    normalisation: Normalisation,
    counted: Arc<Vec<u32>>,
    /// The sums of the dimensions; their means after the first pass.
    means: Vec<f64>,
    /// The sums of the squared differences from the means.
    squares: Vec<f64>,
    pass: Pass,
    /// The number of rows that the pass has processed.
    done: usize,
}

#[derive(Clone, Copy, Debug)]
enum Pass {
    Means,
    Squares,
    Rows,
}

impl Normaliser {
    /// Prepares the normalisation of raw rows (row-major, [`Layout::dims`] numbers each; an
    /// incomplete last row is left out). Means and scales are those of the rows whose indices are
    /// in `counted`; each must be the index of a row.
    pub(in crate::matching) fn new(
        layout: Layout,
        normalisation: Normalisation,
        mut rows: Vec<f32>,
        counted: Arc<Vec<u32>>,
    ) -> Self {
        let dims = layout.dims();
        rows.truncate(rows.len() / dims * dims);
        Self {
            features: Features { layout, rows, means: Vec::new(), scales: Vec::new() },
            normalisation,
            counted,
            means: vec![0.0; dims],
            squares: vec![0.0; dims],
            pass: Pass::Means,
            done: 0,
        }
    }

    /// Processes up to `count` more rows in one of three passes. Returns `false` when nothing is
    /// left to do.
    pub(in crate::matching) fn advance(&mut self, count: usize) -> bool {
        let all =
            if matches!(self.pass, Pass::Rows) { self.features.len() } else { self.counted.len() };
        let slice = self.done..self.done.saturating_add(count).min(all);
        self.done = slice.end;
        let counted = self.counted.get(slice.clone()).unwrap_or_default().iter();
        let counted = counted.filter_map(|&row| self.features.row(row as usize));
        match self.pass {
            Pass::Means => {
                for row in counted {
                    for (sum, &value) in self.means.iter_mut().zip(row) {
                        *sum += f64::from(value);
                    }
                }
            }
            Pass::Squares => {
                for row in counted {
                    for ((square, mean), &value) in
                        self.squares.iter_mut().zip(&self.means).zip(row)
                    {
                        *square += (f64::from(value) - mean) * (f64::from(value) - mean);
                    }
                }
            }
            Pass::Rows => {
                let dims = self.features.layout.dims();
                let mut rows = std::mem::take(&mut self.features.rows);
                for row in rows.chunks_exact_mut(dims).take(slice.end).skip(slice.start) {
                    self.features.normalise_row(row);
                }
                self.features.rows = rows;
                return slice.end < all;
            }
        }
        if slice.end == all {
            self.begin_next_pass();
        }
        true
    }

    fn begin_next_pass(&mut self) {
        self.done = 0;
        let number = self.counted.len().max(1) as f64;
        if matches!(self.pass, Pass::Means) {
            self.means.iter_mut().for_each(|mean| *mean /= number);
            self.pass = Pass::Squares;
            return;
        }
        let deviations: Vec<f64> =
            self.squares.iter().map(|square| (square / number).sqrt()).collect();
        self.features.scales = self.features.layout.scales(self.normalisation, &deviations);
        self.features.means = self.means.iter().map(|&mean| mean as f32).collect();
        self.pass = Pass::Rows;
    }

    /// Processes the remaining rows, and returns the features.
    pub(in crate::matching) fn finish(mut self) -> Features {
        while self.advance(usize::MAX) {}
        self.features
    }
}
