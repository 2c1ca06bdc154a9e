//! Distances of windows as running sums along diagonals.

use super::terms::{PairTerms, Progress, TermRow, centre_product};
use super::{DistanceMatrix, RegistrationError};
use glam::DVec2;
use std::ops::Range;

/// The number of rows after which the running sums begin anew.
///
/// They begin at the fixed multiples of it, so that some rows alone, beginning with such a one,
/// have the same bits as among all rows: they can be computed anywhere.
pub(crate) const ROWS_PER_SUM: usize = 512;

impl PairTerms {
    /// Returns the computation of the distances between all windows of `window` frames that start
    /// in `sources` and `targets` (frames of the clips; clamped to the compared part), in slices.
    /// Windows that would cross an end are left out: the matrix may be empty.
    ///
    /// # Errors
    /// [`RegistrationError::Unfinished`] before all rows are compared.
    pub fn sweep(
        &self,
        window: usize,
        sources: &Range<usize>,
        targets: &Range<usize>,
    ) -> Result<Sweep<'_>, RegistrationError> {
        self.complete()?;
        let window = window.max(1);
        let [rows, columns] = self.starts(window, sources, targets);
        Ok(Sweep::new(self, window, rows, columns))
    }

    /// Returns the distances of the windows that start at the samples `rows` of the source, which
    /// begin at a multiple of [`ROWS_PER_SUM`], row by row; of a clip with itself, each row has the
    /// cells from the diagonal on.
    ///
    /// # Errors
    /// [`RegistrationError::Unfinished`] where their pairs are not compared.
    pub(super) fn packed_rows(
        &self,
        window: usize,
        rows: &Range<usize>,
    ) -> Result<Vec<f32>, RegistrationError> {
        let window = window.max(1);
        let [all, columns] = self.starts(window, &(0..usize::MAX), &(0..usize::MAX));
        let rows = rows.start.min(all.end)..rows.end.min(all.end);
        if rows.is_empty() || columns.is_empty() {
            return Ok(Vec::new());
        }
        if !self.holds(&(rows.start..rows.end + self.samples_in(window) - 1)) {
            let Progress { done, total } = self.progress();
            return Err(RegistrationError::Unfinished { done, total });
        }
        Ok(Sweep::new(self, window, rows, columns).finish_packed())
    }

    /// Computes [`Self::sweep`] in one call.
    ///
    /// # Errors
    /// [`RegistrationError::Unfinished`] before all rows are compared.
    pub fn distances(
        &self,
        window: usize,
        sources: &Range<usize>,
        targets: &Range<usize>,
    ) -> Result<DistanceMatrix, RegistrationError> {
        Ok(self.sweep(window, sources, targets)?.finish())
    }
}

/// The computation of the distances of all windows of one length, by running sums along the
/// diagonals, row by row.
///
/// Each row's sums are those of the row above, one column to the left, plus the pair that enters
/// the window, minus the pair that leaves it; every [`ROWS_PER_SUM`] rows they begin anew. The sums
/// are `f64` over `f32` terms, so that the error after additions and subtractions is at most 1e-12
/// of the spread.
#[derive(Clone, Debug)]
pub struct Sweep<'a> {
    terms: &'a PairTerms,
    sums: Sums,
}

/// A [`Sweep`] that does not borrow the terms until it is resumed.
#[derive(Clone, Debug)]
pub struct PausedSweep(Sums);

impl PausedSweep {
    /// Resumes the sweep. `terms` are those from which it was made.
    #[must_use]
    pub fn resume(self, terms: &PairTerms) -> Sweep<'_> {
        Sweep { terms, sums: self.0 }
    }

    /// Returns the progress.
    #[must_use]
    pub fn progress(&self) -> Progress {
        self.0.progress()
    }

    /// Returns the number of frames of the windows.
    #[must_use]
    pub fn window(&self) -> usize {
        self.0.window
    }
}

/// The data of a sweep besides the terms. Every call must be given the terms of the first one.
#[derive(Clone, Debug)]
pub(super) struct Sums {
    window: usize,
    rows: Range<usize>,
    columns: Range<usize>,
    done: usize,
    /// Sums of the last computed row, one entry per diagonal: column c of row r at c + (rows - 1 -
    /// r), so that no values are moved.
    dot: Vec<f64>,
    cross: Vec<f64>,
    height: Vec<f64>,
    source: Moments,
    target: Moments,
    pub(super) rms_m: Vec<f32>,
}

/// Contributions of each window's own frames: the sum of the centres, and the spread about their
/// mean.
#[derive(Clone, Debug, Default)]
struct Moments {
    x: Vec<f64>,
    z: Vec<f64>,
    spread: Vec<f64>,
}

impl Moments {
    /// Computes the moments of all windows of `samples` that start in `starts`.
    fn new(cloud: &super::cloud::Cloud, starts: &Range<usize>, samples: usize) -> Self {
        let mut sums = Self::default();
        let (mut centre, mut square) = (DVec2::ZERO, 0.0);
        let of = |sample: usize| {
            (cloud.centre(sample), cloud.square[sample] + cloud.centre(sample).length_squared())
        };
        for start in starts.clone() {
            if start == starts.start || start.is_multiple_of(ROWS_PER_SUM) {
                (centre, square) = (DVec2::ZERO, 0.0);
                for sample in start..start + samples {
                    centre += of(sample).0;
                    square += of(sample).1;
                }
            } else {
                centre += of(start + samples - 1).0 - of(start - 1).0;
                square += of(start + samples - 1).1 - of(start - 1).1;
            }
            sums.x.push(centre.x);
            sums.z.push(centre.y);
            sums.spread.push(square - centre.length_squared() / samples as f64);
        }
        sums
    }
}

impl<'a> Sweep<'a> {
    pub(super) fn new(
        terms: &'a PairTerms,
        window: usize,
        rows: Range<usize>,
        columns: Range<usize>,
    ) -> Self {
        Self { terms, sums: Sums::new(terms, window, rows, columns) }
    }

    /// Computes up to `rows` more rows, and returns the progress.
    pub fn advance(&mut self, rows: usize) -> Progress {
        for _ in 0..rows {
            if !self.sums.advance(self.terms) {
                break;
            }
        }
        self.sums.progress()
    }

    /// Stops borrowing the terms, so that the rest can be computed later.
    #[must_use]
    pub fn pause(self) -> PausedSweep {
        PausedSweep(self.sums)
    }

    /// Computes the remaining rows and returns the matrix.
    #[must_use]
    pub fn finish(mut self) -> DistanceMatrix {
        self.advance(usize::MAX);
        self.sums.into_matrix(self.terms)
    }

    /// Computes the remaining rows of a clip compared with itself, and returns them one after the
    /// other: each has the cells from the diagonal to the end.
    pub(super) fn finish_packed(mut self) -> Vec<f32> {
        self.advance(usize::MAX);
        self.sums.rms_m
    }
}

impl Sums {
    /// Begins the sweep of the windows that start at the samples `rows` and `columns`.
    pub(super) fn new(
        terms: &PairTerms,
        window: usize,
        rows: Range<usize>,
        columns: Range<usize>,
    ) -> Self {
        let samples = terms.samples_in(window);
        let diagonals = rows.len() + columns.len();
        let mut sums = Self {
            window,
            done: 0,
            dot: vec![0.0; diagonals],
            cross: vec![0.0; diagonals],
            height: vec![0.0; diagonals],
            source: Moments::new(&terms.source, &rows, samples),
            target: Moments::new(&terms.target, &columns, samples),
            // Filled row by row, as the terms are.
            rms_m: Vec::new(),
            rows,
            columns,
        };
        let cells = sums.row_start(terms, sums.rows.len());
        sums.rms_m.reserve_exact(cells);
        sums
    }

    /// Computes the next row; returns `false` when there is none.
    pub(super) fn advance(&mut self, terms: &PairTerms) -> bool {
        let Progress { done, total } = self.progress();
        if done < total {
            let samples = terms.samples_in(self.window);
            self.enter_row(terms, done, samples);
            self.distances(terms, done, samples);
            self.done = done + 1;
        }
        done < total
    }

    /// Returns the computed rows as a matrix.
    pub(super) fn into_matrix(self, terms: &PairTerms) -> DistanceMatrix {
        let stride = terms.stride();
        DistanceMatrix {
            stride,
            window: self.window,
            source_start: terms.source.start + self.rows.start * stride,
            target_start: terms.target.start + self.columns.start * stride,
            rows: self.rows.len(),
            columns: self.columns.len(),
            rms_m: self.rms_m,
        }
    }

    /// Returns the first column of a row that is summed: of a clip with itself, that on the
    /// diagonal.
    fn first_column(&self, terms: &PairTerms, row: usize) -> usize {
        if terms.is_triangle() { self.rows.start + row - self.columns.start } else { 0 }
    }

    /// Returns the offset of a row's distances.
    fn row_start(&self, terms: &PairTerms, row: usize) -> usize {
        let columns = self.columns.len() - self.first_column(terms, 0).min(self.columns.len());
        if terms.is_triangle() { packed_start(columns, row) } else { row * columns }
    }

    /// Returns the number of computed rows.
    pub(super) fn done(&self) -> usize {
        self.done
    }

    fn progress(&self) -> Progress {
        Progress {
            done: self.done,
            total: if self.columns.is_empty() { 0 } else { self.rows.len() },
        }
    }

    /// Updates the sums to `row` (counted from the first row that is swept). A separate function,
    /// because browsers optimise a function between two of its calls.
    #[inline(never)]
    fn enter_row(&mut self, terms: &PairTerms, row: usize, samples: usize) {
        let (first, shift) = (self.rows.start + row, self.rows.len() - 1 - row);
        let columns = self.columns.len();
        if row == 0 || first.is_multiple_of(ROWS_PER_SUM) {
            let from = self.first_column(terms, row);
            let n = columns - from;
            for sums in [&mut self.dot, &mut self.cross, &mut self.height] {
                sums[shift + from..][..n].fill(0.0);
            }
            for k in 0..samples {
                let centre = terms.source.centre(first + k);
                let (row, column) = (terms.row(first + k), self.columns.start + from + k);
                let entering = TermSlice::new(terms, row, column, n);
                let sums = self.dot[shift + from..]
                    .iter_mut()
                    .zip(&mut self.cross[shift + from..])
                    .zip(&mut self.height[shift + from..]);
                for (c, ((dot, cross), height)) in sums.take(n).enumerate() {
                    let (d, x) = centre_product(centre, DVec2::new(entering.x[c], entering.z[c]));
                    *dot += f64::from(entering.terms.dot[c]) + d;
                    *cross += f64::from(entering.terms.cross[c]) + x;
                    *height += f64::from(entering.terms.height[c]);
                }
            }
            return;
        }
        if !terms.is_triangle() {
            self.enter_first_column(terms, first, shift, samples);
        }
        // Below the diagonal there are no sums, so that the first column has preceding windows,
        // too.
        let from = self.first_column(terms, row).max(1);
        let n = columns - from;
        let (p, q) = (terms.source.centre(first + samples - 1), terms.source.centre(first - 1));
        let new = TermSlice::new(
            terms,
            terms.row(first + samples - 1),
            self.columns.start + from + samples - 1,
            n,
        );
        let old = TermSlice::new(terms, terms.row(first - 1), self.columns.start + from - 1, n);
        let dot = &mut self.dot[shift + from..][..n];
        let cross = &mut self.cross[shift + from..][..n];
        let height = &mut self.height[shift + from..][..n];
        for c in 0..n {
            dot[c] += f64::from(new.terms.dot[c]) - f64::from(old.terms.dot[c])
                + ((p.x * new.x[c] + p.y * new.z[c]) - (q.x * old.x[c] + q.y * old.z[c]));
            cross[c] += f64::from(new.terms.cross[c]) - f64::from(old.terms.cross[c])
                + ((p.x * new.z[c] - p.y * new.x[c]) - (q.x * old.z[c] - q.y * old.x[c]));
            height[c] += f64::from(new.terms.height[c]) - f64::from(old.terms.height[c]);
        }
    }

    /// Computes the sums of the first column, whose windows have no predecessors.
    fn enter_first_column(
        &mut self,
        terms: &PairTerms,
        first: usize,
        shift: usize,
        samples: usize,
    ) {
        let (mut dot, mut cross, mut height) = (0.0, 0.0, 0.0);
        for k in 0..samples {
            let entering = TermSlice::new(terms, terms.row(first + k), self.columns.start + k, 1);
            let (d, x) = centre_product(
                terms.source.centre(first + k),
                DVec2::new(entering.x[0], entering.z[0]),
            );
            dot += f64::from(entering.terms.dot[0]) + d;
            cross += f64::from(entering.terms.cross[0]) + x;
            height += f64::from(entering.terms.height[0]);
        }
        (self.dot[shift], self.cross[shift], self.height[shift]) = (dot, cross, height);
    }

    /// Computes the distances of `row` from its sums.
    #[inline(never)]
    fn distances(&mut self, terms: &PairTerms, row: usize, samples: usize) {
        let from = self.first_column(terms, row);
        let n = self.columns.len() - from;
        let shift = self.rows.len() - 1 - row + from;
        let inverse = (samples as f64).recip();
        let (x, z, spread) =
            (self.source.x[row] * inverse, self.source.z[row] * inverse, self.source.spread[row]);
        let start = self.row_start(terms, row);
        self.rms_m.resize(start + n, 0.0);
        let out = &mut self.rms_m[start..][..n];
        let (dot, cross, height) =
            (&self.dot[shift..][..n], &self.cross[shift..][..n], &self.height[shift..][..n]);
        let target = &self.target;
        let (tx, tz, ts) =
            (&target.x[from..][..n], &target.z[from..][..n], &target.spread[from..][..n]);
        for c in 0..n {
            let a = cross[c] - (x * tz[c] - z * tx[c]);
            let b = dot[c] - (x * tx[c] + z * tz[c]);
            let left = spread + ts[c] - 2.0 * ((a * a + b * b).sqrt() + height[c]);
            // Rounding makes the result slightly negative where windows are equal. `max` would be
            // slower, because it handles NaN.
            let mean = (left * inverse) as f32;
            out[c] = if mean > 0.0 { mean } else { 0.0 }.sqrt();
        }
    }
}

/// Returns the offset of row `row` in a packed triangle of `rows` rows.
pub(super) fn packed_start(rows: usize, row: usize) -> usize {
    row * rows - row * row.saturating_sub(1) / 2
}

/// A part of a row of terms, with the centres of its columns.
struct TermSlice<'a> {
    terms: TermRow<'a>,
    x: &'a [f64],
    z: &'a [f64],
}

impl<'a> TermSlice<'a> {
    fn new(terms: &'a PairTerms, row: TermRow<'a>, from: usize, n: usize) -> Self {
        let part = |of: &'a [f32]| &of[from - row.first..][..n];
        Self {
            terms: TermRow {
                first: from,
                dot: part(row.dot),
                cross: part(row.cross),
                height: part(row.height),
            },
            x: &terms.target.x[from..][..n],
            z: &terms.target.z[from..][..n],
        }
    }
}
