//! Features of frames, and their normalisation.

use super::MatchError;
use std::ops::Range;

mod normaliser;

pub(super) use normaliser::Normaliser;

/// Frame rate of every database, frames per second: clips are resampled to it, and controllers
/// advance by its frames.
pub const RATE: usize = 60;
/// Number of features of the body: two feet's positions and velocities, and the hips' velocity.
pub(super) const BODY: usize = 15;
/// The greatest number of trajectory times.
pub(super) const MAX_TIMES: usize = 6;
/// The greatest number of dimensions: four for each time, and the body.
pub(super) const MAX_DIMS: usize = 4 * MAX_TIMES + BODY;
/// The farthest trajectory time, seconds.
const MAX_SECS: f64 = 3.0;

/// A block of features that is normalised together, and has one weight.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, serde::Serialize, serde::Deserialize)]
pub enum Block {
    /// Positions of the character (sideways, forward) at each trajectory time, metres.
    TrajectoryPosition,
    /// Facing of the character, as a unit vector (sideways, forward), at each trajectory time.
    TrajectoryDirection,
    /// Positions of left and right foot, metres.
    FootPosition,
    /// Velocities of left and right foot, metres per second.
    FootVelocity,
    /// Velocity of the hips, metres per second.
    HipVelocity,
}

impl Block {
    /// The number of blocks.
    pub const COUNT: usize = 5;

    /// All blocks, in the order of a row of features.
    pub const ALL: [Self; Self::COUNT] = [
        Self::TrajectoryPosition,
        Self::TrajectoryDirection,
        Self::FootPosition,
        Self::FootVelocity,
        Self::HipVelocity,
    ];

    /// Returns the name on screen.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::TrajectoryPosition => "trajectory positions",
            Self::TrajectoryDirection => "trajectory directions",
            Self::FootPosition => "foot positions",
            Self::FootVelocity => "foot velocities",
            Self::HipVelocity => "hip velocity",
        }
    }
}

/// The dimensions that share one scale.
#[derive(
    Clone, Copy, Debug, Default, PartialEq, Eq, Hash, serde::Serialize, serde::Deserialize,
)]
pub enum Normalisation {
    /// Those of each [`Block`]: sideways positions that hardly vary have a small part in the cost.
    #[default]
    Block,
    /// Each dimension on its own, so that all vary by the same amount (the standard score).
    Dimension,
}

/// Options of the features.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct FeatureOptions {
    /// The trajectory times, seconds ahead, rising. Three times give 27 dimensions.
    pub trajectory_secs: Vec<f64>,
    /// The dimensions that share one scale.
    pub normalisation: Normalisation,
}

impl Default for FeatureOptions {
    /// A third, two thirds and one second ahead.
    fn default() -> Self {
        Self {
            trajectory_secs: vec![1.0 / 3.0, 2.0 / 3.0, 1.0],
            normalisation: Normalisation::default(),
        }
    }
}

/// The layout of a row of features.
///
/// All features are in the character's frame: the simulation root ([`super::simulation_roots`]), +Z
/// forward, +X to the left. For T trajectory times a row holds 2T numbers of positions (x, z), 2T
/// of directions (x, z), and 15 of the body: left and right foot's position, left and right foot's
/// velocity, hip velocity.
#[derive(Clone, Debug, PartialEq)]
pub struct Layout {
    /// The trajectory times in frames at [`RATE`], rising.
    ahead: Vec<usize>,
}

impl Layout {
    /// Returns the layout for these times, each rounded to a frame.
    ///
    /// # Errors
    /// [`MatchError::Times`] when there are none or more than six, or they do not rise from at
    /// least one frame to 3 s.
    pub fn new(options: &FeatureOptions) -> Result<Self, MatchError> {
        let wrong = MatchError::Times { most_secs: MAX_SECS, most: MAX_TIMES };
        if !(1..=MAX_TIMES).contains(&options.trajectory_secs.len()) {
            return Err(wrong);
        }
        let mut ahead = Vec::with_capacity(options.trajectory_secs.len());
        for &secs in &options.trajectory_secs {
            if !(0.0..=MAX_SECS).contains(&secs) {
                return Err(wrong);
            }
            let frames = (secs * RATE as f64).round() as usize;
            if frames <= ahead.last().copied().unwrap_or(0) {
                return Err(wrong);
            }
            ahead.push(frames);
        }
        Ok(Self { ahead })
    }

    /// Returns the trajectory times in frames at [`RATE`].
    #[must_use]
    pub fn ahead(&self) -> &[usize] {
        &self.ahead
    }

    /// Returns the farthest trajectory time.
    #[must_use]
    pub fn horizon(&self) -> usize {
        self.ahead.last().copied().unwrap_or(0)
    }

    /// Returns the number of dimensions.
    #[must_use]
    pub fn dims(&self) -> usize {
        4 * self.ahead.len() + BODY
    }

    /// Returns the dimensions of a block.
    #[must_use]
    pub fn range(&self, block: Block) -> Range<usize> {
        let times = self.ahead.len();
        match block {
            Block::TrajectoryPosition => 0..2 * times,
            Block::TrajectoryDirection => 2 * times..4 * times,
            Block::FootPosition => 4 * times..4 * times + 6,
            Block::FootVelocity => 4 * times + 6..4 * times + 12,
            Block::HipVelocity => 4 * times + 12..4 * times + BODY,
        }
    }

    /// Returns the scale of each dimension for these standard deviations, one for each: the value
    /// by which its differences from the mean are divided. Constant dimensions have the scale 1.
    #[must_use]
    pub fn scales(&self, normalisation: Normalisation, deviations: &[f64]) -> Vec<f32> {
        let scale_of = |dims: Range<usize>| {
            let own = deviations.get(dims.clone()).unwrap_or_default();
            match (own.iter().sum::<f64>() / dims.len() as f64) as f32 {
                still if still <= 1e-6 || !still.is_finite() => 1.0,
                // In clips that all walk straight on, noise of the heading must not dominate the
                // cost.
                scale => scale.max(MIN_SCALE),
            }
        };
        match normalisation {
            Normalisation::Dimension => {
                (0..self.dims()).map(|dim| scale_of(dim..dim + 1)).collect()
            }
            Normalisation::Block => {
                let of_block = |block| {
                    let range = self.range(block);
                    std::iter::repeat_n(scale_of(range.clone()), range.len())
                };
                Block::ALL.into_iter().flat_map(of_block).collect()
            }
        }
    }

    /// Returns the first dimension of the body.
    pub(super) fn body(&self) -> usize {
        4 * self.ahead.len()
    }
}

/// The weight of each block: the factor of its normalised differences, so that its part of the cost
/// grows with the square.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Weights(pub [f32; Block::COUNT]);

impl Default for Weights {
    fn default() -> Self {
        Self([1.0, 1.25, 0.75, 1.0, 1.0])
    }
}

impl Weights {
    /// Returns the weight of a block.
    #[must_use]
    pub const fn of(&self, block: Block) -> f32 {
        self.0[block as usize]
    }

    /// Checks that every weight is a number from 0 to 100.
    ///
    /// # Errors
    /// [`MatchError::Setting`] with the first weight that is not.
    pub fn validate(&self) -> Result<(), MatchError> {
        match self.0.iter().find(|weight| !(0.0..=100.0).contains(*weight)) {
            None => Ok(()),
            Some(&value) => Err(MatchError::Setting {
                what: "a feature weight",
                value: f64::from(value),
                least: 0.0,
                most: 100.0,
            }),
        }
    }

    /// Returns one factor for each dimension.
    #[must_use]
    pub fn spread(&self, layout: &Layout) -> Vec<f32> {
        let mut spread = vec![0.0; layout.dims()];
        for block in Block::ALL {
            spread[layout.range(block)].fill(self.of(block));
        }
        spread
    }
}

/// Normalised features are rounded to this grid, so that choices hardly ever depend on the last
/// digits, in which machines' trigonometry differs.
const GRID: f32 = 4096.0;

/// The least scale of a block: metres, metres per second, or the sine of an angle. The noise of a
/// capture is of about this size.
const MIN_SCALE: f32 = 0.02;

/// Normalised features of frames, row by row, and their normalisation.
///
/// `(value - mean of its dimension) / scale of its block`; a block's scale is the mean of its
/// dimensions' standard deviations (Clavet, "Motion Matching and The Road to Next-Gen Animation",
/// GDC 2016; Holden et al., "Learned Motion Matching", 2020, section 3). With
/// [`Normalisation::Dimension`] each dimension has a scale of its own. Constant dimensions have the
/// scale 1. Rounded to 1/4096.
#[derive(Clone, Debug, PartialEq)]
pub struct Features {
    layout: Layout,
    rows: Vec<f32>,
    means: Vec<f32>,
    /// One for each dimension.
    scales: Vec<f32>,
}

impl Features {
    /// Normalises one raw row in place.
    pub fn normalise_row(&self, row: &mut [f32]) {
        for ((value, mean), scale) in row.iter_mut().zip(&self.means).zip(&self.scales) {
            // Ties to even: one instruction in WebAssembly. `round` is a call there, half of the
            // time of this loop.
            *value = ((*value - mean) / scale * GRID).round_ties_even() / GRID;
        }
    }

    /// Returns the layout of a row.
    #[must_use]
    pub fn layout(&self) -> &Layout {
        &self.layout
    }

    /// Returns the number of rows.
    #[must_use]
    pub fn len(&self) -> usize {
        self.rows.len() / self.layout.dims()
    }

    /// Returns whether there are no rows.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.rows.is_empty()
    }

    /// Returns one row; `None` where there is none.
    #[must_use]
    pub fn row(&self, row: usize) -> Option<&[f32]> {
        let dims = self.layout.dims();
        self.rows.get(row.checked_mul(dims)?..)?.get(..dims)
    }

    /// Returns the mean of each dimension before normalisation.
    #[must_use]
    pub fn means(&self) -> &[f32] {
        &self.means
    }

    /// Returns the scale of each dimension: the value of 1 in its own unit.
    #[must_use]
    pub fn scales(&self) -> &[f32] {
        &self.scales
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::Arc;

    #[test]
    fn default_layout_has_27_dimensions_in_disjoint_blocks() {
        let layout = Layout::new(&FeatureOptions::default()).unwrap();
        assert_eq!((layout.dims(), layout.ahead()), (27, &[20, 40, 60][..]));
        let mut next = 0;
        for block in Block::ALL {
            assert_eq!(layout.range(block).start, next);
            next = layout.range(block).end;
        }
        assert_eq!(next, 27);
        for times in [
            vec![],
            vec![0.0],
            vec![1.0, 0.5],
            vec![0.5, 0.501],
            vec![f64::NAN],
            vec![9.0],
            vec![0.1; 7],
        ] {
            let options = FeatureOptions { trajectory_secs: times, ..FeatureOptions::default() };
            assert!(matches!(Layout::new(&options), Err(MatchError::Times { .. })), "{options:?}");
        }
    }

    #[test]
    fn normalise_scales_by_block_and_constant_blocks_by_1() {
        let layout = Layout::new(&FeatureOptions {
            trajectory_secs: vec![0.5],
            ..FeatureOptions::default()
        })
        .unwrap();
        let dims = layout.dims();
        let mut rows = vec![3.0; 4 * dims];
        // Deviations 1 and 3 in the positions' two dimensions: scale 2.
        for (row, sign) in [-1.0, 1.0, -1.0, 1.0].into_iter().enumerate() {
            rows[row * dims] = 5.0 + sign;
            rows[row * dims + 1] = 3.0 * sign;
        }
        let all = Arc::new((0..4).collect());
        let normalised = |normalisation| {
            let (rows, all) = (rows.clone(), Arc::clone(&all));
            Normaliser::new(layout.clone(), normalisation, rows, all).finish()
        };
        let own = normalised(Normalisation::Dimension);
        let features = normalised(Normalisation::Block);
        assert_eq!(features.scales()[..3], [2.0, 2.0, 1.0]);
        assert_eq!(features.scales()[dims - 1], 1.0);
        // With a scale of its own each dimension varies by 1.
        assert_eq!(own.scales()[..3], [1.0, 3.0, 1.0]);
        assert_eq!(&own.row(1).unwrap()[..3], &[1.0, 1.0, 0.0]);
        assert_eq!(&features.row(1).unwrap()[..3], &[0.5, 1.5, 0.0]);
        assert_eq!((features.len(), features.row(4), features.row(usize::MAX)), (4, None, None));
    }

    #[test]
    fn normaliser_in_slices_gives_the_same_features() {
        let layout = Layout::new(&FeatureOptions::default()).unwrap();
        let rows: Vec<f32> = (0..4 * layout.dims()).map(|at| (at * at % 97) as f32).collect();
        let counted = Arc::new(vec![0, 1, 3]);
        let normalisation = Normalisation::Block;
        let begin =
            || Normaliser::new(layout.clone(), normalisation, rows.clone(), Arc::clone(&counted));
        let mut slices = begin();
        assert_eq!((0..9).take_while(|_| slices.advance(2)).count(), 2 + 2 + 1);
        assert_eq!(slices.finish(), begin().finish());
    }
}
