mod search;
mod stretch;

pub use search::PathSearch;

use super::{DistanceMatrix, PathError};

/// The largest slope limit: the choices of a cell fit into 16 bits.
pub const MAX_SLOPE_LIMIT: usize = 16;

/// Where a path may begin or end.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub enum PathEnd {
    /// In the corner: with the first (last) windows of both clips.
    #[default]
    Corner,
    /// Anywhere on the border: with the first (last) window of one clip, and one of the first
    /// (last) windows of the other.
    Border {
        /// The share of the other clip that may be left out, 0 to 1; above a half nothing may be
        /// left.
        slack: f64,
    },
}

/// What a path has to be like.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct PathOptions {
    /// How many steps in a row may go on in one clip while the other stands: 1 to
    /// [`MAX_SLOPE_LIMIT`].
    pub slope_limit: usize,
    /// Where it begins.
    pub start: PathEnd,
    /// Where it ends.
    pub end: PathEnd,
    /// Cells (row, column) that it must pass, in any order.
    pub pins: Vec<(usize, usize)>,
    /// What a step in one clip alone costs beside its cell, metres: settles plateaus, where both
    /// clips stand still, for the diagonal.
    pub side_step_m: f64,
}

impl Default for PathOptions {
    /// From corner to corner, at most 2 side steps in a row, each at 1 mm.
    fn default() -> Self {
        Self {
            slope_limit: 2,
            start: PathEnd::Corner,
            end: PathEnd::Corner,
            pins: Vec::new(),
            side_step_m: 1e-3,
        }
    }
}

/// A way through a distance matrix: which frame of one clip is like which frame of the other.
#[derive(Clone, Debug, PartialEq)]
pub struct RegistrationPath {
    /// Cells (row, column) from beginning to end; each step goes one row, one column, or both on.
    pub cells: Vec<(usize, usize)>,
    /// Those of the cells that were asked for: pins, in order.
    pub pins: Vec<(usize, usize)>,
    /// The mean distance along the path, metres per point, each cell weighted by how many frames
    /// its step goes on in both clips.
    pub mean_m: f64,
}

/// The path with the least cost (Kovar, Gleicher 2003, section 4.2; Sakoe, Chiba 1978 for the
/// weights).
///
/// A step on in both clips costs its cell twice, a step on in one of them once, and
/// [`PathOptions::side_step_m`] beside: between two given ends all paths then weigh the same, and
/// none is favoured for its length. With a free end the least *mean* is sought, by Dinkelbach's
/// iteration.
///
/// Exact: how many steps have gone one way is part of the state, O(cells × slope limit) in time; 2
/// bytes per cell. Of equal paths the one with diagonal steps towards its end is taken.
///
/// # Errors
/// [`PathError`] says what excludes every path.
pub fn optimal_path(
    matrix: &DistanceMatrix,
    options: &PathOptions,
) -> Result<RegistrationPath, PathError> {
    PathSearch::new(matrix, options)?.finish(matrix)
}

/// [`optimal_path`] for long clips: the path is sought in a matrix with cells of `factor` ×
/// `factor` first (their mean), then in a corridor of `radius` cells to either side of it.
///
/// Not exact: what leaves the corridor is not seen. O(N² / factor² + N × radius) beside one reading
/// of the matrix.
///
/// # Errors
/// [`PathError`], also where the corridor leaves no path: then take a larger radius.
pub fn path_in_corridor(
    matrix: &DistanceMatrix,
    options: &PathOptions,
    factor: usize,
    radius: usize,
) -> Result<RegistrationPath, PathError> {
    PathSearch::in_corridor(matrix, options, factor, radius)?.finish(matrix)
}

/// The pins in order, each strictly behind the one before in both clips.
fn checked_pins(
    matrix: &DistanceMatrix,
    options: &PathOptions,
) -> Result<Vec<(usize, usize)>, PathError> {
    let (rows, columns) = (matrix.rows(), matrix.columns());
    let mut pins = options.pins.clone();
    pins.sort_unstable();
    pins.dedup();
    if let Some(&pin) = pins.iter().find(|pin| pin.0 >= rows || pin.1 >= columns) {
        let (row, column) = pin;
        return Err(PathError::PinOutside { row, column, rows, columns });
    }
    for pair in pins.windows(2) {
        if pair[1].1 <= pair[0].1 || pair[1].0 == pair[0].0 {
            return Err(PathError::Pins {
                first: matrix.frames(pair[0].0, pair[0].1),
                second: matrix.frames(pair[1].0, pair[1].1),
            });
        }
    }
    let corner = (rows - 1, columns - 1);
    for &pin in &pins {
        let frames = matrix.frames(pin.0, pin.1);
        if options.start == PathEnd::Corner && pin != (0, 0) && (pin.0 == 0 || pin.1 == 0) {
            return Err(PathError::PinAtEnd { pin: frames, end: "start" });
        }
        if options.end == PathEnd::Corner
            && pin != corner
            && (pin.0 == corner.0 || pin.1 == corner.1)
        {
            return Err(PathError::PinAtEnd { pin: frames, end: "end" });
        }
    }
    Ok(pins)
}

fn no_path(
    matrix: &DistanceMatrix,
    options: &PathOptions,
    from: Option<(usize, usize)>,
    to: Option<(usize, usize)>,
) -> PathError {
    let start = from.or((options.start == PathEnd::Corner).then_some((0, 0)));
    let needed = start.zip(to).map(|(from, to)| {
        let (i, j) = (to.0 - from.0, to.1 - from.1);
        // With n steps of the shorter side there are n + 1 places for s steps of the longer one
        // alone.
        (i.max(j) - i.min(j)).div_ceil(i.min(j) + 1)
    });
    PathError::NoPath {
        from: start.map(|cell| matrix.frames(cell.0, cell.1)),
        to: to.map(|cell| matrix.frames(cell.0, cell.1)),
        slope_limit: options.slope_limit,
        // Where a run goes on across a pin, the sides alone do not tell.
        needed: needed.unwrap_or_default().max(options.slope_limit + 1),
    }
}

/// Whether leaving out `left` of `of` cells is no more than the share `slack`.
fn within(left: usize, of: usize, slack: f64) -> bool {
    left == 0 || (left as f64) <= slack.clamp(0.0, 0.5) * of as f64
}

#[cfg(test)]
mod tests;
