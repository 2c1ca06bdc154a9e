//! The map of a corpus: clips that move alike lie near each other.
//!
//! A clip's place is the mean of its scaled features, seen along the two directions in which the
//! means of all clips differ most: their principal components (Pearson 1901). The components are
//! found by Jacobi's rotations of the covariance (Golub and Van Loan, "Matrix Computations",
//! section 8.5), with additions, products and square roots alone, in a fixed order: the same clips
//! have the same bits on every machine.
//!
//! Each axis is stretched by itself, so that 96 % of the clips lie within 0.9 of the middle of
//! their range; what lies beyond comes ever closer to 1. Ranks would fill the map more evenly, and
//! would close the gaps between groups of clips, which are what a map is for.

use crate::index::MomentRows;

/// The share of clips that lie beyond 0.9, to either side.
const BEYOND: f64 = 0.02;
/// The coordinate beyond which outliers are compressed.
const KNEE: f64 = 0.9;
/// Rounds over all pairs of dimensions; a dozen are plenty for 27.
const SWEEPS: usize = 30;

/// Returns the place of each clip, x and y from -1 to 1; `None` for a clip without moments. `rows`
/// has the scaled features of all moments, `dims` numbers each, in the order of the clips.
pub(crate) fn places(rows: &[f32], dims: usize, clips: &[MomentRows]) -> Vec<Option<[f32; 2]>> {
    let means = means(rows, dims, clips);
    let known: Vec<&[f64]> = means.iter().flatten().map(Vec::as_slice).collect();
    let axes = principal_axes(&known, dims);
    let along = |axis: &[f64]| -> Vec<Option<f64>> {
        let along = |mean: &Vec<f64>| mean.iter().zip(axis).map(|(own, axis)| own * axis).sum();
        means.iter().map(|mean| mean.as_ref().map(along)).collect()
    };
    let [x, y] = axes.map(|axis| stretched(&along(&axis)));
    x.into_iter().zip(y).map(|(x, y)| Some([x? as f32, y? as f32])).collect()
}

/// Returns the mean features of each clip.
fn means(rows: &[f32], dims: usize, clips: &[MomentRows]) -> Vec<Option<Vec<f64>>> {
    let mut rows = rows.chunks_exact(dims);
    let mean = |clip: &MomentRows| {
        let mut sums = vec![0.0f64; dims];
        for row in rows.by_ref().take(clip.count) {
            for (sum, value) in sums.iter_mut().zip(row) {
                *sum += f64::from(*value);
            }
        }
        let count = clip.count as f64;
        (clip.count > 0).then(|| sums.into_iter().map(|sum| sum / count).collect())
    };
    clips.iter().map(mean).collect()
}

/// Returns the two directions in which points differ most, each of length 1; its component of the
/// greatest size is positive.
fn principal_axes(points: &[&[f64]], dims: usize) -> [Vec<f64>; 2] {
    let count = points.len().max(1) as f64;
    let mut middle = vec![0.0; dims];
    for point in points {
        for (sum, value) in middle.iter_mut().zip(*point) {
            *sum += value / count;
        }
    }
    let mut covariance = vec![vec![0.0; dims]; dims];
    for point in points {
        let apart: Vec<f64> = point.iter().zip(&middle).map(|(own, middle)| own - middle).collect();
        for (row, own) in covariance.iter_mut().zip(&apart) {
            for (sum, other) in row.iter_mut().zip(&apart) {
                *sum += own * other / count;
            }
        }
    }
    let axes = eigenvectors(&mut covariance);
    let mut order: Vec<usize> = (0..dims).collect();
    order.sort_by(|a, b| covariance[*b][*b].total_cmp(&covariance[*a][*a]));
    [0, 1].map(|place| {
        let column = order.get(place).copied().unwrap_or(0);
        let axis: Vec<f64> = axes.iter().filter_map(|row| row.get(column).copied()).collect();
        let largest = axis.iter().fold(0.0f64, |a, b| if b.abs() > a.abs() { *b } else { a });
        let sign = if largest < 0.0 { -1.0 } else { 1.0 };
        axis.into_iter().map(|own| sign * own).collect()
    })
}

/// Returns the eigenvectors of a symmetric matrix, as columns; the matrix becomes diagonal.
fn eigenvectors(matrix: &mut [Vec<f64>]) -> Vec<Vec<f64>> {
    let dims = matrix.len();
    let unit = |row: usize| (0..dims).map(|column| f64::from(u8::from(row == column))).collect();
    let mut vectors: Vec<Vec<f64>> = (0..dims).map(unit).collect();
    for _ in 0..SWEEPS {
        let mut is_done = true;
        for p in 0..dims {
            for q in p + 1..dims {
                let off = matrix[p][q];
                // Negligible beside both diagonal entries.
                if off.abs() <= 1e-18 * (matrix[p][p].abs() + matrix[q][q].abs()) {
                    continue;
                }
                is_done = false;
                let theta = (matrix[q][q] - matrix[p][p]) / (2.0 * off);
                let sign = if theta < 0.0 { -1.0 } else { 1.0 };
                let tangent = sign / (theta.abs() + (theta * theta + 1.0).sqrt());
                let cosine = 1.0 / (tangent * tangent + 1.0).sqrt();
                let turn = Turn { p, q, cosine, sine: tangent * cosine };
                for row in matrix.iter_mut().chain(&mut vectors) {
                    turn.apply(row);
                }
                // Rows p and q are rotated alike; the split gives access to both.
                let (above, below) = matrix.split_at_mut(q);
                for (p, q) in above[p].iter_mut().zip(&mut below[0]) {
                    (*p, *q) = (cosine * *p - turn.sine * *q, turn.sine * *p + cosine * *q);
                }
            }
        }
        if is_done {
            break;
        }
    }
    vectors
}

/// A rotation in the plane of two dimensions.
struct Turn {
    p: usize,
    q: usize,
    cosine: f64,
    sine: f64,
}

impl Turn {
    fn apply(&self, row: &mut [f64]) {
        let (a, b) = (row[self.p], row[self.q]);
        row[self.p] = self.cosine * a - self.sine * b;
        row[self.q] = self.sine * a + self.cosine * b;
    }
}

/// Returns values stretched to fill -1 to 1.
fn stretched(values: &[Option<f64>]) -> Vec<Option<f64>> {
    let mut known: Vec<f64> = values.iter().flatten().copied().collect();
    known.sort_by(f64::total_cmp);
    let Some(last) = known.len().checked_sub(1) else { return vec![None; values.len()] };
    let beyond = (last as f64 * BEYOND) as usize;
    let (low, high) = (known[beyond], known[last - beyond]);
    let (middle, half) = (0.5 * (low + high), 0.5 * (high - low));
    let place = |value: f64| {
        let place = if half > 0.0 { (value - middle) / half * KNEE } else { 0.0 };
        let over = (place.abs() - KNEE) / (1.0 - KNEE);
        let sign = if place < 0.0 { -1.0 } else { 1.0 };
        if over > 0.0 { sign * (KNEE + (1.0 - KNEE) * over / (1.0 + over)) } else { place }
    };
    values.iter().map(|value| value.map(place)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns clips of one moment each.
    fn single(points: &[[f32; 3]]) -> Vec<Option<[f32; 2]>> {
        let clips: Vec<MomentRows> =
            (0..points.len()).map(|clip| MomentRows { clip, count: 1 }).collect();
        places(points.as_flattened(), 3, &clips)
    }

    #[test]
    fn axes_are_those_in_which_clips_differ_most() {
        // Most along (0, 3, 4) / 5, then along x, not at all across both.
        let points: Vec<[f32; 3]> = (0..50u16)
            .map(|at| {
                let (far, near) = (f32::from(at) - 25.0, f32::from(at * 7 % 11) - 5.0);
                [near, 0.6 * far, 0.8 * far]
            })
            .collect();
        let places = single(&points);
        for (point, place) in points.iter().zip(&places) {
            let [x, y] = place.unwrap();
            let (far, near) = (point[1] / 0.6 + 0.5, point[0]);
            assert!((x - 0.9 * far / 24.5).abs() < 0.05, "{x} {far}");
            assert!((y - 0.9 * near / 5.0).abs() < 0.15, "{y} {near}");
        }
    }

    #[test]
    fn eigenvectors_make_the_matrix_diagonal() {
        let entry = |a: usize, b: usize| ((a * b * 7 + a + b) % 13) as f64 - 6.0;
        let dims = 27;
        let matrix: Vec<Vec<f64>> =
            (0..dims).map(|a| (0..dims).map(|b| entry(a.min(b), a.max(b))).collect()).collect();
        let mut diagonal = matrix.clone();
        let vectors = eigenvectors(&mut diagonal);
        for column in 0..dims {
            let vector: Vec<f64> = vectors.iter().map(|row| row[column]).collect();
            let length: f64 = vector.iter().map(|own| own * own).sum();
            assert!((length - 1.0).abs() < 1e-12);
            for (row, own) in matrix.iter().zip(&vector) {
                let product: f64 = row.iter().zip(&vector).map(|(a, b)| a * b).sum();
                assert!((product - diagonal[column][column] * own).abs() < 1e-9, "{column}");
            }
        }
    }

    #[test]
    fn clips_without_moments_have_no_place_and_equal_ones_are_in_the_middle() {
        let clips = [0, 2, 0, 1].map(|count| MomentRows { clip: 0, count });
        assert_eq!(
            places(&[1.0, 2.0, 3.0, 4.0, 2.0, 3.0], 2, &clips),
            [None, Some([0.0, 0.0]), None, Some([0.0, 0.0])]
        );
        assert_eq!(places(&[], 2, &clips[..1]), [None]);
    }

    #[test]
    fn clips_far_from_all_others_stay_on_the_map() {
        let mut values: Vec<Option<f64>> = (0..200).map(|at| Some(f64::from(at))).collect();
        values.extend([Some(1e9), Some(-1e9), None]);
        let places = stretched(&values);
        let known: Vec<f64> = places.iter().flatten().copied().collect();
        assert!(known.iter().all(|place| place.abs() <= 1.0) && places[202].is_none());
        assert!(known[200] > 0.99 && known[201] < -0.99);
        let inside = known.iter().filter(|place| place.abs() <= 0.9).count();
        assert!((190..=196).contains(&inside), "{inside}");
        assert!(known[..200].windows(2).all(|pair| pair[0] < pair[1]));
    }
}
