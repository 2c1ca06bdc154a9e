//! Features of a corpus in one scale, in which Euclidean distances are costs of matching.

use crate::standard::row_at;
use crate::{CorpusError, PlaceError, StandardBody};
use segue_motion::clip::Motion;
use segue_motion::matching::{Layout, Normalisation, Weights};
use serde::{Deserialize, Serialize};

/// The scaling of features: `(value - mean) * factor`, where the factor is the weight of the
/// dimension's block divided by its scale.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Scaling {
    /// The mean of each dimension.
    pub means: Vec<f32>,
    /// The factor of each dimension.
    pub factors: Vec<f32>,
}

impl Scaling {
    /// Returns the scaling of raw rows, block by block as in motion matching.
    pub(crate) fn of<'a>(layout: &Layout, rows: impl Iterator<Item = &'a [f32]> + Clone) -> Self {
        let dims = layout.dims();
        let (mut sums, mut squares, mut count) = (vec![0.0f64; dims], vec![0.0f64; dims], 0usize);
        for row in rows.clone() {
            count += 1;
            for (sum, value) in sums.iter_mut().zip(row) {
                *sum += f64::from(*value);
            }
        }
        let count = count.max(1) as f64;
        let means: Vec<f64> = sums.iter().map(|sum| sum / count).collect();
        for row in rows {
            for ((square, mean), value) in squares.iter_mut().zip(&means).zip(row) {
                *square += (f64::from(*value) - mean) * (f64::from(*value) - mean);
            }
        }
        let deviations: Vec<f64> = squares.iter().map(|square| (square / count).sqrt()).collect();
        let scales = layout.scales(Normalisation::Block, &deviations);
        let weights = Weights::default().spread(layout);
        Self {
            means: means.into_iter().map(|mean| mean as f32).collect(),
            factors: weights.iter().zip(&scales).map(|(weight, scale)| weight / scale).collect(),
        }
    }

    /// Scales a raw row in place.
    pub fn apply(&self, row: &mut [f32]) {
        for ((value, mean), factor) in row.iter_mut().zip(&self.means).zip(&self.factors) {
            *value = (*value - mean) * factor;
        }
    }

    /// Returns the query for "more like this": the scaled features of a moment of any motion. The
    /// nearest row is taken; `None` if the motion is shorter than the trajectory of features.
    ///
    /// # Errors
    /// [`PlaceError`] if the motion cannot be put on the standard body.
    pub fn query(
        &self,
        body: &StandardBody,
        motion: &Motion,
        secs: f64,
    ) -> Result<Option<Vec<f32>>, PlaceError> {
        let features = body.place(motion)?.features;
        let dims = body.layout().dims();
        let rows = features.len() / dims;
        let row = row_at(secs).min(rows.saturating_sub(1));
        Ok(features.chunks_exact(dims).nth(row).map(|row| {
            let mut row = row.to_vec();
            self.apply(&mut row);
            row
        }))
    }

    /// Checks that there is a mean and a factor for each dimension.
    ///
    /// # Errors
    /// [`CorpusError::Mismatch`].
    pub fn check(&self, layout: &Layout) -> Result<(), CorpusError> {
        let expected = layout.dims();
        for found in [self.means.len(), self.factors.len()] {
            if found != expected {
                return Err(CorpusError::Mismatch { what: "dimensions", found, expected });
            }
        }
        Ok(())
    }
}
