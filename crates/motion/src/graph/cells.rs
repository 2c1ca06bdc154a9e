//! The cells of some rows of a matrix of distances: their places and their histogram.

/// Returns the offset of a row, from `first` on: of a clip with itself, each row begins on the
/// diagonal. `width` is the number of columns.
pub(super) fn row_start(is_itself: bool, width: usize, first: usize, row: usize) -> usize {
    let rows = row - first;
    if is_itself {
        let rows = rows.min(width.saturating_sub(first));
        rows * (width - first) - rows * rows.saturating_sub(1) / 2
    } else {
        rows * width
    }
}

/// The number of distances that are handled together.
const LANES: usize = 4;

/// A histogram of distances whose last range is open. Neighbouring distances are often in the same
/// range, and a processor waits when it increments a counter that it has just written. Four
/// neighbours therefore have separate counters, which are added at the end.
#[derive(Clone, Debug)]
pub(super) struct Histogram {
    /// Ranges per metre.
    scale: f32,
    counts: Vec<[u32; LANES]>,
}

impl Histogram {
    /// Returns an empty histogram of `bins` ranges of `bin_cm` centimetres on the reference body,
    /// `cm_per_m` of which are a metre of the distances. Each of the four counts is limited to
    /// 2³² - 1.
    pub(super) fn new(cm_per_m: f64, bin_cm: f64, bins: usize) -> Self {
        let scale = if bin_cm > 0.0 { (cm_per_m / bin_cm) as f32 } else { f32::MAX };
        Self { scale, counts: vec![[0; LANES]; bins] }
    }

    /// Counts distances, metres. A separate function, because browsers optimise a function between
    /// two of its calls.
    #[inline(never)]
    pub(super) fn count(&mut self, cells: &[f32]) {
        let Some(last) = self.counts.len().checked_sub(1) else {
            return;
        };
        let (scale, last) = (self.scale, last as i32);
        // Processors convert a float to a signed integer with one instruction, to an unsigned one
        // with several.
        let bin = |distance: f32| {
            let bin = (distance * scale) as i32;
            if bin < last { bin as usize } else { last as usize }
        };
        let (fours, rest) = cells.as_chunks::<LANES>();
        for four in fours {
            let bins = four.map(bin);
            for (lane, bin) in bins.into_iter().enumerate() {
                self.counts[bin][lane] += 1;
            }
        }
        for &distance in rest {
            self.counts[bin(distance)][0] += 1;
        }
    }

    /// Adds the counts to others, which saturate.
    pub(super) fn add_to(&self, counts: &mut [u32]) {
        for (sum, lanes) in counts.iter_mut().zip(&self.counts) {
            *sum = lanes.iter().fold(*sum, |sum, &more| sum.saturating_add(more));
        }
    }
}

/// Returns the smaller of two distances. `f32::min` also handles NaN, which takes several times as
/// long.
#[inline]
pub(super) fn smaller(a: f32, b: f32) -> f32 {
    if b < a { b } else { a }
}

/// Returns the smallest of some distances; infinity without any.
#[inline]
pub(super) fn smallest(cells: &[f32]) -> f32 {
    let (fours, rest) = cells.as_chunks::<LANES>();
    let mut lanes = [f32::INFINITY; LANES];
    for four in fours {
        for (known, &cell) in lanes.iter_mut().zip(four) {
            *known = smaller(*known, cell);
        }
    }
    lanes.into_iter().chain(rest.iter().copied()).fold(f32::INFINITY, smaller)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn histogram_counts_each_distance_in_its_range(
            cells in prop::collection::vec(0.0_f32..2.0, 0..40),
            bins in 0..30_usize,
            before in 0..3_u32,
        ) {
            let mut histogram = Histogram::new(10.0, 0.5, bins);
            histogram.count(&cells);
            let mut counts = vec![u32::MAX - before; bins];
            histogram.add_to(&mut counts);
            for (bin, &count) in counts.iter().enumerate() {
                let is_here = |cell: &&f32| ((**cell * 20.0) as usize).min(bins - 1) == bin;
                let here = cells.iter().filter(is_here).count() as u32;
                prop_assert_eq!(count, u32::MAX - before + here.min(before));
            }
        }

        #[test]
        fn smallest_of_any_number_equals_that_of_f32_min(cells in prop::collection::vec(0.0_f32..9.0, 0..40)) {
            let expected = cells.iter().copied().fold(f32::INFINITY, f32::min);
            prop_assert_eq!(smallest(&cells), expected);
        }
    }

    #[test]
    fn huge_distances_are_in_the_last_range() {
        let mut histogram = Histogram::new(1e9, 1e-9, 3);
        histogram.count(&[1e30, f32::INFINITY, 0.0, 1.0, 2.0]);
        let mut counts = [0; 3];
        histogram.add_to(&mut counts);
        assert_eq!(counts, [1, 0, 4]);
    }
}
