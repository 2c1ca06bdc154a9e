//! Paths through distance matrices, by dynamic programming.

mod search;
mod section;

pub use search::TimeWarpSearch;

use super::{DistanceMatrix, PathError};

/// The greatest slope limit: the choices of a cell fit into 16 bits.
pub const MAX_SLOPE_LIMIT: usize = 16;

/// The cells at which a path may begin or end.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub enum PathEnd {
    /// The corner: the first (last) windows of both clips.
    #[default]
    Corner,
    /// Any cell on the border: the first (last) window of one clip, and one of the first (last)
    /// windows of the other.
    Border {
        /// The share of the other clip that may be left out, 0 to 1; at most half is ever left out.
        slack: f64,
    },
}

/// Constraints on a path.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct PathOptions {
    /// The number of steps in a row that one clip may advance alone: 1 to [`MAX_SLOPE_LIMIT`].
    pub slope_limit: usize,
    /// The cells at which it may begin.
    pub start: PathEnd,
    /// The cells at which it may end.
    pub end: PathEnd,
    /// Cells (row, column) that it must pass through, in any order.
    pub pins: Vec<(usize, usize)>,
    /// The cost of a step in one clip alone in addition to its cell, metres: on plateaus, where
    /// both clips stand still, it makes the path prefer the diagonal.
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

/// A path through a distance matrix: the correspondence of the frames of two clips.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RegistrationPath {
    /// Cells (row, column) from beginning to end; each step advances one row, one column, or both.
    pub cells: Vec<(usize, usize)>,
    /// The pins among the cells, in order.
    pub pins: Vec<(usize, usize)>,
    /// The mean distance along the path, metres per point, each cell weighted by the number of
    /// frames that its step advances in both clips together.
    pub mean_m: f64,
}

/// Returns the path of least cost (Kovar, Gleicher 2003, section 4.2; Sakoe, Chiba 1978 for the
/// weights).
///
/// A step in both clips costs twice its cell, a step in one of them once its cell plus
/// [`PathOptions::side_step_m`]: between two given ends all paths then have the same total weight,
/// and none is preferred for its length. With a free end the least *mean* is found, by Dinkelbach's
/// iteration.
///
/// The result is exact: the number of steps in a row that advance one clip is part of the state,
/// O(cells × slope limit) in time; 2 bytes per cell. Of equal paths the one with diagonal steps
/// towards its end is taken.
///
/// # Errors
/// [`PathError`] with the reason why there is no path.
pub fn optimal_path(
    matrix: &DistanceMatrix,
    options: &PathOptions,
) -> Result<RegistrationPath, PathError> {
    TimeWarpSearch::new(matrix, options)?.finish(matrix)
}

/// Returns an approximation of [`optimal_path`] for long clips: the path is found in a matrix of
/// blocks of `factor` × `factor` cells first (their mean), then in a corridor of `radius` cells to
/// either side of it.
///
/// It is not exact: paths outside the corridor are not considered. O(N² / factor² + N × radius)
/// plus one reading of the matrix.
///
/// # Errors
/// [`PathError`], also when there is no path in the corridor: then use a larger radius.
pub fn path_in_corridor(
    matrix: &DistanceMatrix,
    options: &PathOptions,
    factor: usize,
    radius: usize,
) -> Result<RegistrationPath, PathError> {
    TimeWarpSearch::in_corridor(matrix, options, factor, radius)?.finish(matrix)
}

/// Returns the pins in order, each strictly after the one before in both clips.
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
        // The n steps of the shorter side leave n + 1 gaps for the s single steps of the longer
        // one.
        (i.max(j) - i.min(j)).div_ceil(i.min(j) + 1)
    });
    PathError::NoPath {
        from: start.map(|cell| matrix.frames(cell.0, cell.1)),
        to: to.map(|cell| matrix.frames(cell.0, cell.1)),
        slope_limit: options.slope_limit,
        // If a run continues across a pin, the lengths of the sides are not sufficient.
        needed: needed.unwrap_or_default().max(options.slope_limit + 1),
    }
}

/// Returns whether leaving out `left` of `of` cells is at most the share `slack`.
fn within(left: usize, of: usize, slack: f64) -> bool {
    left == 0 || (left as f64) <= slack.clamp(0.0, 0.5) * of as f64
}

#[cfg(test)]
mod tests;
