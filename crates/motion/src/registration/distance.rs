//! Matrices of window distances.

use super::REFERENCE_HEIGHT_M;

/// Distances between windows of two clips: one row per source frame, one column per target frame,
/// every `stride` frames.
#[derive(Clone, Debug, PartialEq)]
pub struct DistanceMatrix {
    pub(super) stride: usize,
    pub(super) window: usize,
    pub(super) source_start: usize,
    pub(super) target_start: usize,
    pub(super) rows: usize,
    pub(super) columns: usize,
    pub(super) rms_m: Vec<f32>,
}

impl DistanceMatrix {
    /// Returns the matrix of these distances, metres, row by row, with `columns` in each row.
    /// `first` are the frames of the first windows, source and target, and `stride` is the number
    /// of frames from one row or column to the next. `None` where the last row is not whole.
    #[must_use]
    pub fn of_rows(
        window: usize,
        stride: usize,
        first: (usize, usize),
        columns: usize,
        rms_m: Vec<f32>,
    ) -> Option<Self> {
        let (source_start, target_start) = first;
        let rows = rms_m.len().checked_div(columns).unwrap_or(0);
        (rms_m.len() == rows * columns).then_some(Self {
            stride,
            window,
            source_start,
            target_start,
            rows,
            columns,
            rms_m,
        })
    }

    /// Returns the number of rows: source windows.
    #[must_use]
    pub fn rows(&self) -> usize {
        self.rows
    }

    /// Returns the number of columns: target windows.
    #[must_use]
    pub fn columns(&self) -> usize {
        self.columns
    }

    /// Returns the number of frames between rows or columns.
    #[must_use]
    pub fn stride(&self) -> usize {
        self.stride
    }

    /// Returns the number of frames of each window.
    #[must_use]
    pub fn window(&self) -> usize {
        self.window
    }

    /// Returns the first frames of the windows of a cell: (source, target).
    #[must_use]
    pub fn frames(&self, row: usize, column: usize) -> (usize, usize) {
        (self.source_start + row * self.stride, self.target_start + column * self.stride)
    }

    /// Returns all root-mean-square distances per point, row-major, metres of the clips' own body
    /// (see [`Self::cm_scale`]).
    #[must_use]
    pub fn rms_m(&self) -> &[f32] {
        &self.rms_m
    }

    /// Returns the distances as [`rms_m`](Self::rms_m), without a copy.
    #[must_use]
    pub fn into_rms_m(self) -> Vec<f32> {
        self.rms_m
    }

    /// Returns one distance, metres; `None` outside the matrix.
    #[must_use]
    pub fn get(&self, row: usize, column: usize) -> Option<f32> {
        if row < self.rows && column < self.columns {
            self.rms_m.get(row * self.columns + column).copied()
        } else {
            None
        }
    }

    /// Returns the distances of one row, metres; empty outside the matrix.
    #[must_use]
    pub fn row(&self, row: usize) -> &[f32] {
        let start = row.saturating_mul(self.columns);
        self.rms_m.get(start..start.saturating_add(self.columns)).unwrap_or_default()
    }

    /// Returns the means of all blocks of `factor` × `factor` cells, smaller at the far borders:
    /// the same picture with fewer cells.
    #[must_use]
    pub fn pooled(&self, factor: usize) -> Self {
        let factor = factor.max(1);
        let (rows, columns) = (self.rows.div_ceil(factor), self.columns.div_ceil(factor));
        let mut rms_m = Vec::with_capacity(rows * columns);
        // Rows are added first, column by column: these additions are contiguous and can use SIMD.
        let mut sums = vec![0.0_f32; self.columns];
        for first in (0..self.rows).step_by(factor) {
            let block = first..(first + factor).min(self.rows);
            sums.fill(0.0);
            for row in block.clone() {
                for (sum, cell) in sums.iter_mut().zip(self.row(row)) {
                    *sum += cell;
                }
            }
            let mean =
                |cells: &[f32]| cells.iter().sum::<f32>() / (cells.len() * block.len()) as f32;
            rms_m.extend(sums.chunks(factor).map(mean));
        }
        Self { stride: self.stride * factor, rows, columns, rms_m, ..*self }
    }

    /// Returns the factor from [`rms_m`](Self::rms_m) to centimetres on the reference body.
    #[must_use]
    pub fn cm_scale(body_height: f64) -> f64 {
        100.0 * REFERENCE_HEIGHT_M / body_height
    }

    /// Returns the cell of the smallest distance, the first of equal ones; `None` for an empty
    /// matrix.
    #[must_use]
    pub fn minimum(&self) -> Option<(usize, usize)> {
        let (at, _) = self.rms_m.iter().enumerate().min_by(|a, b| a.1.total_cmp(b.1))?;
        Some((at / self.columns, at % self.columns))
    }

    /// Returns the cells that are no larger than their eight neighbours, smallest first. Of a
    /// plateau its first cell is returned; cells on the border count.
    #[must_use]
    pub fn local_minima(&self) -> Vec<(usize, usize)> {
        let mut minima = Vec::new();
        for row in 0..self.rows {
            for column in 0..self.columns {
                if self.is_minimum(row, column) {
                    minima.push((row, column));
                }
            }
        }
        minima.sort_by(|a, b| {
            self.rms_m[a.0 * self.columns + a.1].total_cmp(&self.rms_m[b.0 * self.columns + b.1])
        });
        minima
    }

    fn is_minimum(&self, row: usize, column: usize) -> bool {
        let here = self.rms_m[row * self.columns + column];
        for r in row.saturating_sub(1)..(row + 2).min(self.rows) {
            for c in column.saturating_sub(1)..(column + 2).min(self.columns) {
                let there = self.rms_m[r * self.columns + c];
                // Strictly smaller than previous cells, so that a plateau is counted once.
                if there < here || (there == here && (r, c) < (row, column)) {
                    return false;
                }
            }
        }
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn local_minima_are_sorted_and_unique_on_a_plateau() {
        let matrix = DistanceMatrix {
            stride: 1,
            window: 1,
            source_start: 0,
            target_start: 0,
            rows: 3,
            columns: 4,
            rms_m: vec![5.0, 9.0, 2.0, 2.0, 9.0, 9.0, 2.0, 9.0, 1.0, 9.0, 9.0, 9.0],
        };
        assert_eq!(matrix.local_minima(), [(2, 0), (0, 2), (0, 0)]);
        assert_eq!(matrix.minimum(), Some((2, 0)));
        assert_eq!(matrix.get(0, 4), None);
        let pooled = matrix.pooled(3);
        assert_eq!((pooled.rows(), pooled.columns(), pooled.frames(0, 1)), (1, 2, (0, 3)));
        assert!(
            (pooled.rms_m()[0] - 55.0 / 9.0).abs() < 1e-6
                && (pooled.rms_m()[1] - 20.0 / 3.0).abs() < 1e-6
        );
    }
}
