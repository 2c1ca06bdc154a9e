//! Distances between the frames of two clips.

use crate::labs::pair::Pair;
use segue_motion::clip::Motion;
use segue_motion::math::Planar;
use segue_motion::registration::{DistanceMatrix, align, limb_weights};
use std::sync::{Arc, OnceLock};

/// The greatest number of cells along a side of a picture: a map on screen has no more points.
const PICTURE_CELLS: usize = 512;

/// The distances between the frames of two clips, with the clips.
///
/// A *pair* is a frame of A and a frame of B, both counted at A's rate; a cell of the matrix
/// represents the middle frames of its windows.
#[derive(Clone, Debug)]
pub struct DistanceMap {
    matrix: DistanceMatrix,
    picture: OnceLock<DistanceMatrix>,
    motions: [Arc<Motion>; 2],
    weights: Vec<f64>,
    cm_scale: f64,
}

impl DistanceMap {
    pub(super) fn new(matrix: DistanceMatrix, pair: &Pair) -> Self {
        Self::of_motions(matrix, [Arc::clone(&pair.a), Arc::clone(&pair.incoming)])
    }

    /// Returns the distances of A, and of B on the skeleton and at the rate of A.
    pub(crate) fn of_motions(matrix: DistanceMatrix, motions: [Arc<Motion>; 2]) -> Self {
        let skeleton = motions[0].clip().skeleton();
        let height = motions[0].roles().body_height(skeleton);
        Self {
            matrix,
            picture: OnceLock::new(),
            weights: limb_weights(skeleton),
            cm_scale: DistanceMatrix::cm_scale(height.into()),
            motions,
        }
    }

    /// Returns the distances: A's windows in rows, B's in columns.
    #[must_use]
    pub fn matrix(&self) -> &DistanceMatrix {
        &self.matrix
    }

    /// Returns the distances, metres, in at most 512 cells along a side, each the mean of a square
    /// of cells. If the picture is not made yet, this takes about as long as reading all distances.
    #[must_use]
    pub fn picture(&self) -> &DistanceMatrix {
        self.picture.get_or_init(|| self.pooled())
    }

    /// Makes the picture; returns `false` if it was made before.
    pub(super) fn make_picture(&self) -> bool {
        let is_new = self.picture.get().is_none();
        self.picture.get_or_init(|| self.pooled());
        is_new
    }

    fn pooled(&self) -> DistanceMatrix {
        let longest = self.matrix.rows().max(self.matrix.columns());
        self.matrix.pooled(longest.div_ceil(PICTURE_CELLS))
    }

    /// Returns A, and B on the skeleton and at the rate of A.
    #[must_use]
    pub fn motions(&self) -> &[Arc<Motion>; 2] {
        &self.motions
    }

    /// Returns the frame rate of both, frames per second.
    #[must_use]
    pub fn fps(&self) -> f64 {
        self.motions[0].clip().fps()
    }

    /// Returns the factor from metres of the matrix to centimetres per joint on a body of 1.75 m.
    #[must_use]
    pub fn cm_scale(&self) -> f64 {
        self.cm_scale
    }

    /// Returns the offset from the first frame of a window to the one that it represents.
    pub(super) fn middle(&self) -> usize {
        (self.matrix.window().max(1) - 1) / 2
    }

    /// Returns the cell that is nearest to a pair; `None` if the pair is outside the clips, or no
    /// window fits.
    #[must_use]
    pub fn cell_of(&self, frames: [f64; 2]) -> Option<(usize, usize)> {
        let sizes = [self.matrix.rows(), self.matrix.columns()];
        let cell = |clip: usize| {
            let (frame, frames) = (frames[clip], self.motions[clip].clip().frames() as f64);
            let inside = frame >= -0.5 && frame <= frames - 0.5;
            let cell = ((frame - self.middle() as f64) / self.matrix.stride() as f64)
                .round()
                .max(0.0) as usize;
            inside.then(|| sizes[clip].checked_sub(1).map(|last| cell.min(last))).flatten()
        };
        cell(0).zip(cell(1))
    }

    /// Returns the pair that a cell represents.
    #[must_use]
    pub fn pair_of(&self, (row, column): (usize, usize)) -> [f64; 2] {
        let (a, b) = self.matrix.frames(row, column);
        let half = (self.matrix.window().max(1) - 1) as f64 / 2.0;
        [a as f64 + half, b as f64 + half]
    }

    /// Returns the distance of a pair: root mean square per joint over the windows, centimetres on
    /// a body of 1.75 m.
    #[must_use]
    pub fn cm_at(&self, frames: [f64; 2]) -> Option<f64> {
        let (row, column) = self.cell_of(frames)?;
        Some(f64::from(self.matrix.get(row, column)?) * self.cm_scale)
    }

    /// Returns the best alignment of B with A around a pair: `a_world_from_b_world`.
    #[must_use]
    pub fn b_on_a(&self, frames: [f64; 2]) -> Option<Planar> {
        let (row, column) = self.cell_of(frames)?;
        let (i, j) = self.matrix.frames(row, column);
        let window = self.matrix.window();
        let [a, b] = [(0, i), (1, j)]
            .map(|(clip, from)| self.motions[clip].clip().world_positions(from..from + window));
        Some(align(&a, &b, &self.weights, 0.0).ok()?.transform)
    }
}
