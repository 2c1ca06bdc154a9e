//! The search for the best path, in slices.

use super::section::{SearchSpace, Section};
use super::{
    DistanceMatrix, MAX_SLOPE_LIMIT, PathEnd, PathError, PathOptions, RegistrationPath,
    checked_pins, no_path,
};
use std::ops::Range;

/// The least number of rows and columns for which a path in a corridor is found before the best
/// one.
const MIN_CORRIDOR_SIZE: usize = 256;
/// Size of the blocks of the coarse matrix in which the corridor is found, in cells to a side, and
/// its radius in cells to either side of the path found there.
const CORRIDOR: (usize, usize) = (8, 12);
/// The greatest number of rounds of Dinkelbach's iteration: a handful suffices; the limit is for
/// NaN.
const MAX_ROUNDS: usize = 32;

/// The search of [`optimal_path`](super::optimal_path), a few rows at a time. Every call must be
/// given the same matrix.
#[derive(Clone, Debug)]
pub struct TimeWarpSearch {
    options: PathOptions,
    /// Block size of the coarse matrix, and radius of the corridor, in cells.
    corridor: (usize, usize),
    /// Whether a path in the corridor suffices.
    is_rough: bool,
    stage: Stage,
}

#[derive(Clone, Debug)]
enum Stage {
    Pooling,
    /// In the matrix of blocks.
    Coarse(DistanceMatrix, Rounds),
    Corridor(Rounds),
    Whole(Rounds),
}

impl TimeWarpSearch {
    /// Begins the search.
    ///
    /// # Errors
    /// [`PathError`] with the reason why there is no path, as far as that follows from the options.
    pub fn new(matrix: &DistanceMatrix, options: &PathOptions) -> Result<Self, PathError> {
        let is_free = options.start != PathEnd::Corner || options.end != PathEnd::Corner;
        let rounds = Rounds::new(matrix, options, None)?;
        // Every round of Dinkelbach's iteration is a pass over the whole matrix. The mean of a
        // nearly optimal path saves most of them.
        let has_estimate = is_free && matrix.rows().min(matrix.columns()) >= MIN_CORRIDOR_SIZE;
        Ok(Self {
            options: options.clone(),
            corridor: CORRIDOR,
            is_rough: false,
            stage: if has_estimate { Stage::Pooling } else { Stage::Whole(rounds) },
        })
    }

    /// Begins the search without an initial estimate: slower, with the same result.
    #[cfg(test)]
    pub(super) fn without_estimate(
        matrix: &DistanceMatrix,
        options: &PathOptions,
    ) -> Result<Self, PathError> {
        let search = Self::new(matrix, options)?;
        let stage = search.whole(matrix, None)?;
        Ok(Self { stage, ..search })
    }

    /// Begins the search of [`path_in_corridor`](super::path_in_corridor).
    pub(super) fn in_corridor(
        matrix: &DistanceMatrix,
        options: &PathOptions,
        factor: usize,
        radius: usize,
    ) -> Result<Self, PathError> {
        Rounds::new(matrix, options, None)?;
        Ok(Self {
            options: options.clone(),
            corridor: (factor.max(1), radius),
            is_rough: true,
            stage: Stage::Pooling,
        })
    }

    /// Processes up to `rows` more rows of the matrix. Returns the path once it is found.
    ///
    /// # Errors
    /// [`PathError`] with the reason why there is no path.
    pub fn advance(
        &mut self,
        matrix: &DistanceMatrix,
        rows: usize,
    ) -> Result<Option<RegistrationPath>, PathError> {
        let next = match &mut self.stage {
            Stage::Pooling => self.coarse(matrix),
            Stage::Coarse(coarse, rounds) => {
                match rounds.advance(coarse, rows.saturating_mul(self.corridor.0)) {
                    Ok(None) => return Ok(None),
                    Ok(Some(guide)) => self.beside(matrix, &guide).map(Stage::Corridor),
                    Err(error) => Err(error),
                }
            }
            Stage::Corridor(rounds) => {
                match rounds.advance(matrix, rows.saturating_mul(self.corridor.0)) {
                    Ok(None) => return Ok(None),
                    Ok(Some(path)) if self.is_rough => return Ok(Some(path)),
                    Ok(Some(path)) => self.whole(matrix, Some(&path)),
                    Err(error) => Err(error),
                }
            }
            Stage::Whole(rounds) => return rounds.advance(matrix, rows),
        };
        self.stage = match next {
            Err(error) if self.is_rough => return Err(error),
            // Without an estimate it only takes longer.
            Err(_) => self.whole(matrix, None)?,
            Ok(stage) => stage,
        };
        Ok(None)
    }

    /// Completes the search.
    pub(super) fn finish(mut self, matrix: &DistanceMatrix) -> Result<RegistrationPath, PathError> {
        loop {
            if let Some(path) = self.advance(matrix, usize::MAX)? {
                return Ok(path);
            }
        }
    }

    fn coarse(&self, matrix: &DistanceMatrix) -> Result<Stage, PathError> {
        let factor = self.corridor.0;
        let coarse = matrix.pooled(factor);
        let mut pins: Vec<(usize, usize)> =
            self.options.pins.iter().map(|pin| (pin.0 / factor, pin.1 / factor)).collect();
        pins.sort_unstable();
        // Pins in one row or column of the coarse matrix cannot all be passed there.
        pins.dedup_by(|next, before| next.0 <= before.0 || next.1 <= before.1);
        let (last_row, last_column) =
            (coarse.rows().saturating_sub(1), coarse.columns().saturating_sub(1));
        let inner = |&(row, column): &(usize, usize)| {
            row > 0 && column > 0 && row < last_row && column < last_column
        };
        pins.retain(inner);
        let options = PathOptions { pins, ..self.options.clone() };
        let rounds = Rounds::new(&coarse, &options, None)?;
        Ok(Stage::Coarse(coarse, rounds))
    }

    /// Returns the search in the corridor around a path of the coarse matrix.
    fn beside(
        &self,
        matrix: &DistanceMatrix,
        guide: &RegistrationPath,
    ) -> Result<Rounds, PathError> {
        let (factor, radius) = self.corridor;
        let columns = matrix.columns();
        let mut spans: Vec<Range<usize>> = vec![columns..0; matrix.rows()];
        let mut open = |row: usize, column: usize| {
            if let Some(span) = spans.get_mut(row) {
                *span = span.start.min(column)..span.end.max((column + 1).min(columns));
            }
        };
        let fine = guide.cells.iter().map(|&(row, column)| (row * factor, column * factor));
        for (row, column) in fine.chain(self.options.pins.iter().copied()) {
            for r in row.saturating_sub(radius)..row + factor + radius {
                open(r, column.saturating_sub(radius));
                open(r, column + factor + radius);
            }
        }
        Rounds::new(matrix, &self.options, Some(spans))
    }

    /// Returns the search through the whole matrix, starting from the mean of a known path.
    fn whole(
        &self,
        matrix: &DistanceMatrix,
        estimate: Option<&RegistrationPath>,
    ) -> Result<Stage, PathError> {
        let mut rounds = Rounds::new(matrix, &self.options, None)?;
        rounds.mean = estimate.map(|path| {
            let (cost, weight) = weigh(matrix, &path.cells, self.options.side_step_m);
            cost / weight
        });
        Ok(Stage::Whole(rounds))
    }
}

/// Dinkelbach's iteration: the best path at the mean of the best path so far, until it no longer
/// improves.
#[derive(Clone, Debug)]
struct Rounds {
    options: PathOptions,
    spans: Option<Vec<Range<usize>>>,
    pins: Vec<(usize, usize)>,
    /// The cells at which one section ends and the next begins: pins, and the last corner where the
    /// path ends there.
    anchors: Vec<(usize, usize)>,
    mean: Option<f64>,
    count: usize,
    pass: Pass,
}

/// One pass of dynamic programming, rectangle by rectangle from anchor to anchor.
#[derive(Clone, Debug, Default)]
struct Pass {
    done: Vec<Section>,
    /// The end of the last section, and its states there.
    carried: Option<((usize, usize), Vec<f64>)>,
    /// The current section, and the anchor at its end; `None` for a free end.
    current: Option<(Section, Option<(usize, usize)>)>,
    /// Number of anchors used so far.
    used: usize,
}

impl Rounds {
    fn new(
        matrix: &DistanceMatrix,
        options: &PathOptions,
        spans: Option<Vec<Range<usize>>>,
    ) -> Result<Self, PathError> {
        let (rows, columns) = (matrix.rows(), matrix.columns());
        let slope_limit = options.slope_limit;
        if rows == 0 || columns == 0 {
            return Err(PathError::TooShort { window: matrix.window() });
        }
        if !(1..=MAX_SLOPE_LIMIT).contains(&slope_limit) {
            return Err(PathError::SlopeLimit { slope_limit });
        }
        let pins = checked_pins(matrix, options)?;
        let last = (options.end == PathEnd::Corner).then_some((rows - 1, columns - 1));
        let mut anchors: Vec<(usize, usize)> = pins.iter().copied().chain(last).collect();
        anchors.dedup();
        Ok(Self {
            options: options.clone(),
            spans,
            pins,
            anchors,
            mean: None,
            count: 0,
            pass: Pass::default(),
        })
    }

    fn advance(
        &mut self,
        matrix: &DistanceMatrix,
        rows: usize,
    ) -> Result<Option<RegistrationPath>, PathError> {
        let space = SearchSpace {
            matrix,
            options: &self.options,
            spans: self.spans.as_deref(),
            bias: self.mean.unwrap_or(0.0),
        };
        let Some(found) = self.pass.advance(&space, &self.anchors, rows)? else {
            return Ok(None);
        };
        self.pass = Pass::default();
        self.count += 1;
        let both_given =
            self.options.start == PathEnd::Corner && self.options.end == PathEnd::Corner;
        let (cost, weight) = weigh(matrix, &found, self.options.side_step_m);
        let mean = cost / weight;
        if both_given || self.mean.is_some_and(|best| mean >= best - 1e-12 * best.abs()) {
            let (mean_m, weight) = weigh(matrix, &found, 0.0);
            return Ok(Some(RegistrationPath {
                cells: found,
                pins: self.pins.clone(),
                mean_m: mean_m / weight,
            }));
        }
        self.mean = Some(mean);
        if self.count < MAX_ROUNDS { Ok(None) } else { Err(PathError::NotFinite) }
    }
}

impl Pass {
    /// Processes up to `rows` rows of one section. Returns the cells of the best path once it is
    /// complete.
    fn advance(
        &mut self,
        space: &SearchSpace<'_>,
        anchors: &[(usize, usize)],
        rows: usize,
    ) -> Result<Option<Vec<(usize, usize)>>, PathError> {
        let (matrix, options) = (space.matrix, space.options);
        let corner = (matrix.rows() - 1, matrix.columns() - 1);
        let from = self.carried.as_ref().map(|(from, _)| *from);
        let Some((mut section, to)) = self.current.take() else {
            let to = anchors.get(self.used).copied();
            self.used += 1;
            if to.is_none() && options.end == PathEnd::Corner {
                return Ok(Some(self.trace(corner, None, space)));
            }
            let states = self.carried.as_ref().map(|(_, states)| states.clone());
            let section = Section::new(
                from.unwrap_or_default(),
                to.unwrap_or(corner),
                options.slope_limit,
                states,
            );
            self.current = Some((section, to));
            return Ok(None);
        };
        if !section.advance(space, rows) {
            self.current = Some((section, to));
            return Ok(None);
        }
        if let Some(anchor) = to {
            let states = section.states();
            if states.iter().all(|state| !state.is_finite()) {
                return Err(no_path(matrix, options, from, to));
            }
            self.done.push(section);
            self.carried = Some((anchor, states));
            return Ok(None);
        }
        let slack = if let PathEnd::Border { slack } = options.end { slack } else { 0.0 };
        let end = section.best_end(slack, (matrix.rows(), matrix.columns()));
        let end = end.ok_or_else(|| no_path(matrix, options, from, None))?;
        Ok(Some(self.trace(end, Some(section), space)))
    }

    /// Traces the path from its end back to its start.
    fn trace(
        &mut self,
        end: (usize, usize),
        last: Option<Section>,
        space: &SearchSpace<'_>,
    ) -> Vec<(usize, usize)> {
        self.done.extend(last);
        let mut cells = Vec::new();
        let mut cell = end;
        let mut state = self.done.last_mut().map_or(0, |section| section.any(end.0, end.1, space));
        for (index, section) in self.done.iter_mut().enumerate().rev() {
            // A section's first cell is the last of the one before it.
            (cell, state) = section.trace(cell, state, index > 0, space, &mut cells);
        }
        cells.reverse();
        cells
    }
}

/// Returns the cost and the weight of a path.
pub(super) fn weigh(
    matrix: &DistanceMatrix,
    cells: &[(usize, usize)],
    side_step_m: f64,
) -> (f64, f64) {
    let (mut cost, mut weight) = (0.0, 0.0);
    let mut before = None;
    for &(row, column) in cells {
        let here = f64::from(matrix.get(row, column).unwrap_or(f32::INFINITY));
        let diagonal = before.is_none_or(|(r, c)| r != row && c != column);
        cost += if diagonal { 2.0 * here } else { here + side_step_m };
        weight += if diagonal { 2.0 } else { 1.0 };
        before = Some((row, column));
    }
    (cost, weight)
}
