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

/// Adds distances, metres, to the counts of a histogram whose last range is open.
pub(super) fn count_cells(cells: &[f32], cm_per_m: f64, bin_cm: f64, counts: &mut [u32]) {
    let Some(last) = counts.len().checked_sub(1) else {
        return;
    };
    let scale = if bin_cm > 0.0 { (cm_per_m / bin_cm) as f32 } else { f32::MAX };
    for &distance in cells {
        counts[((distance * scale) as usize).min(last)] += 1;
    }
}
