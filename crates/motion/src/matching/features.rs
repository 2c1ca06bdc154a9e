use super::MatchError;
use std::ops::Range;

/// Frames per second of every database: clips are resampled to it, and controllers go on in steps
/// of it.
pub const RATE: usize = 60;
/// Features of the body: two feet's positions and velocities, and the hips' velocity.
pub(super) const BODY: usize = 15;
/// The most trajectory times.
pub(super) const MAX_TIMES: usize = 6;
/// The most dimensions: four for each time, and the body.
pub(super) const MAX_DIMS: usize = 4 * MAX_TIMES + BODY;
/// The farthest look ahead, seconds.
const MAX_SECS: f64 = 3.0;

/// A part of the features that is normalised as one, and has one weight.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, serde::Serialize, serde::Deserialize)]
pub enum Block {
    /// Where the character will be, (sideways, forward) at each trajectory time, metres.
    TrajectoryPosition,
    /// What it will face, as a unit vector (sideways, forward) at each trajectory time.
    TrajectoryDirection,
    /// Where left and right foot are, metres.
    FootPosition,
    /// How left and right foot move, metres per second.
    FootVelocity,
    /// How the hips move, metres per second.
    HipVelocity,
}

impl Block {
    /// The number of blocks.
    pub const COUNT: usize = 5;

    /// All blocks, in the order in which they lie in a row of features.
    pub const ALL: [Self; Self::COUNT] = [
        Self::TrajectoryPosition,
        Self::TrajectoryDirection,
        Self::FootPosition,
        Self::FootVelocity,
        Self::HipVelocity,
    ];

    /// What a person calls it.
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

/// Which numbers are brought to one scale together.
#[derive(
    Clone, Copy, Debug, Default, PartialEq, Eq, Hash, serde::Serialize, serde::Deserialize,
)]
pub enum Normalisation {
    /// Each [`Block`]: where hardly anything varies sideways, that counts as little as it is.
    #[default]
    Block,
    /// Each number by itself, so that all vary by as much: the plain standard score.
    Dimension,
}

/// What is looked at in a frame.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct FeatureOptions {
    /// How far ahead the trajectory is compared, seconds, rising. Three times give 27 dimensions.
    pub trajectory_secs: Vec<f64>,
    /// Which numbers are brought to one scale together.
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

/// Which number of a row of features means what.
///
/// All are in the character's frame: the simulation root ([`super::simulation_roots`]), +Z forward,
/// +X to the left. For T trajectory times a row holds 2T numbers of positions (x, z), 2T of
/// directions (x, z), and 15 of the body: left and right foot's position, left and right foot's
/// velocity, hip velocity.
#[derive(Clone, Debug, PartialEq)]
pub struct Layout {
    /// Frames ahead at [`RATE`], rising.
    ahead: Vec<usize>,
}

impl Layout {
    /// The layout for these times, each rounded to a frame.
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

    /// The trajectory times in frames at [`RATE`].
    #[must_use]
    pub fn ahead(&self) -> &[usize] {
        &self.ahead
    }

    /// The farthest of them.
    #[must_use]
    pub fn horizon(&self) -> usize {
        self.ahead.last().copied().unwrap_or(0)
    }

    /// Numbers in a row.
    #[must_use]
    pub fn dims(&self) -> usize {
        4 * self.ahead.len() + BODY
    }

    /// Which numbers of a row belong to a block.
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

    /// Where the body's numbers begin.
    pub(super) fn body(&self) -> usize {
        4 * self.ahead.len()
    }
}

/// How much each block counts: the factor of its normalised differences, so that a block's share of
/// the cost grows with the square.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Weights(pub [f32; Block::COUNT]);

impl Default for Weights {
    fn default() -> Self {
        Self([1.0, 1.25, 0.75, 1.0, 1.0])
    }
}

impl Weights {
    /// The weight of a block.
    #[must_use]
    pub const fn of(&self, block: Block) -> f32 {
        self.0[block as usize]
    }

    /// Whether every weight is a number from 0 to 100.
    ///
    /// # Errors
    /// [`MatchError::Setting`] for the first that is not.
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

    /// One factor for each number of a row.
    #[must_use]
    pub fn spread(&self, layout: &Layout) -> Vec<f32> {
        let mut spread = vec![0.0; layout.dims()];
        for block in Block::ALL {
            spread[layout.range(block)].fill(self.of(block));
        }
        spread
    }
}

/// Normalised features are rounded to this grid: what is chosen then hardly ever hangs on a last
/// digit in which machines' trigonometry differs.
const GRID: f32 = 4096.0;

/// No block varies by less: metres, metres per second, or the sine of an angle. A capture trembles
/// by about that much.
const MIN_SCALE: f32 = 0.02;

/// Normalised features of frames, row by row, and how they were normalised.
///
/// `(value - mean of its dimension) / scale of its block`; a block's scale is the mean of its
/// dimensions' standard deviations (Clavet, "Motion Matching and The Road to Next-Gen Animation",
/// GDC 2016; Holden et al., "Learned Motion Matching", 2020, section 3). With
/// [`Normalisation::Dimension`] each dimension has a scale of its own. What does not vary at all
/// has the scale 1. Rounded to 1/4096.
#[derive(Clone, Debug, PartialEq)]
pub struct Features {
    layout: Layout,
    rows: Vec<f32>,
    means: Vec<f32>,
    /// One for each number of a row.
    scales: Vec<f32>,
}

impl Features {
    /// Normalises raw rows (row-major, [`Layout::dims`] numbers each; a last row that is not whole
    /// is left out). Means and scales are those of the rows for which `counts` says so.
    #[must_use]
    pub fn normalise(
        layout: Layout,
        normalisation: Normalisation,
        mut rows: Vec<f32>,
        counts: impl Fn(usize) -> bool,
    ) -> Self {
        let dims = layout.dims();
        rows.truncate(rows.len() / dims * dims);
        let (mut sums, mut squares, mut number) = (vec![0.0f64; dims], vec![0.0f64; dims], 0usize);
        let counted = || {
            rows.chunks_exact(dims).enumerate().filter(|(row, _)| counts(*row)).map(|(_, row)| row)
        };
        for row in counted() {
            number += 1;
            for (sum, &value) in sums.iter_mut().zip(row) {
                *sum += f64::from(value);
            }
        }
        let number = number.max(1) as f64;
        for sum in &mut sums {
            *sum /= number;
        }
        for row in counted() {
            for ((square, mean), &value) in squares.iter_mut().zip(&sums).zip(row) {
                *square += (f64::from(value) - mean) * (f64::from(value) - mean);
            }
        }
        let scale_of = |dims: Range<usize>| {
            let deviations: f64 =
                squares[dims.clone()].iter().map(|square| (square / number).sqrt()).sum();
            match (deviations / dims.len() as f64) as f32 {
                still if still <= 1e-6 || !still.is_finite() => 1.0,
                // Clips that all go straight on: a tremble of the heading is not to be all that
                // counts.
                scale => scale.max(MIN_SCALE),
            }
        };
        let scales = match normalisation {
            Normalisation::Dimension => (0..dims).map(|dim| scale_of(dim..dim + 1)).collect(),
            Normalisation::Block => {
                let of_block = |block| {
                    let range = layout.range(block);
                    std::iter::repeat_n(scale_of(range.clone()), range.len())
                };
                Block::ALL.into_iter().flat_map(of_block).collect()
            }
        };
        let means = sums.into_iter().map(|mean| mean as f32).collect();
        let mut features = Self { layout, rows: Vec::new(), means, scales };
        for row in rows.chunks_exact_mut(dims) {
            features.normalise_row(row);
        }
        features.rows = rows;
        features
    }

    /// One raw row, normalised where it lies.
    pub fn normalise_row(&self, row: &mut [f32]) {
        for ((value, mean), scale) in row.iter_mut().zip(&self.means).zip(&self.scales) {
            *value = ((*value - mean) / scale * GRID).round() / GRID;
        }
    }

    /// What the numbers mean.
    #[must_use]
    pub fn layout(&self) -> &Layout {
        &self.layout
    }

    /// The number of rows.
    #[must_use]
    pub fn len(&self) -> usize {
        self.rows.len() / self.layout.dims()
    }

    /// Whether there are no rows.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.rows.is_empty()
    }

    /// One row; `None` where there is none.
    #[must_use]
    pub fn row(&self, row: usize) -> Option<&[f32]> {
        let dims = self.layout.dims();
        self.rows.get(row.checked_mul(dims)?..)?.get(..dims)
    }

    /// A dimension's mean before normalisation.
    #[must_use]
    pub fn means(&self) -> &[f32] {
        &self.means
    }

    /// The scale of each number of a row: what 1 is in its own unit.
    #[must_use]
    pub fn scales(&self) -> &[f32] {
        &self.scales
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_default_set_has_27_dimensions_and_every_number_one_block() {
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
    fn a_block_has_one_scale_and_one_that_stands_still_has_1() {
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
        let own =
            Features::normalise(layout.clone(), Normalisation::Dimension, rows.clone(), |_| true);
        let features = Features::normalise(layout, Normalisation::Block, rows, |_| true);
        assert_eq!(features.scales()[..3], [2.0, 2.0, 1.0]);
        assert_eq!(features.scales()[dims - 1], 1.0);
        // With a scale of its own each dimension varies by 1.
        assert_eq!(own.scales()[..3], [1.0, 3.0, 1.0]);
        assert_eq!(&own.row(1).unwrap()[..3], &[1.0, 1.0, 0.0]);
        assert_eq!(&features.row(1).unwrap()[..3], &[0.5, 1.5, 0.0]);
        assert_eq!((features.len(), features.row(4), features.row(usize::MAX)), (4, None, None));
    }
}
