use super::{DistanceMatrix, PathError};
use std::ops::Range;

/// The largest slope limit: the choices of a cell fit into 16 bits.
pub const MAX_SLOPE_LIMIT: usize = 16;

/// Where a path may begin or end.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub enum PathEnd {
    /// In the corner: with the first (last) windows of both clips.
    #[default]
    Corner,
    /// Anywhere on the border: with the first (last) window of one clip, and one of the first (last) windows of the other.
    Border {
        /// The share of the other clip that may be left out, 0 to 1; above a half nothing may be left.
        slack: f64,
    },
}

/// What a path has to be like.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct PathOptions {
    /// How many steps in a row may go on in one clip while the other stands: 1 to [`MAX_SLOPE_LIMIT`].
    pub slope_limit: usize,
    /// Where it begins.
    pub start: PathEnd,
    /// Where it ends.
    pub end: PathEnd,
    /// Cells (row, column) that it must pass, in any order.
    pub pins: Vec<(usize, usize)>,
    /// What a step in one clip alone costs beside its cell, metres: settles plateaus, where both clips stand still, for the diagonal.
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
    /// The mean distance along the path, metres per point, each cell weighted by how many frames its step goes on in both clips.
    pub mean_m: f64,
}

/// The path with the least cost (Kovar, Gleicher 2003, section 4.2; Sakoe, Chiba 1978 for the weights).
///
/// A step on in both clips costs its cell twice, a step on in one of them once, and [`PathOptions::side_step_m`] beside: between two given ends all
/// paths then weigh the same, and none is favoured for its length. With a free end the least *mean* is sought, by Dinkelbach's iteration.
///
/// Exact: how many steps have gone one way is part of the state, O(cells × slope limit) in time; 2 bytes per cell. Of equal paths the one with
/// diagonal steps towards its end is taken.
///
/// # Errors
/// [`PathError`] says what excludes every path.
pub fn optimal_path(matrix: &DistanceMatrix, options: &PathOptions) -> Result<RegistrationPath, PathError> {
    let columns = matrix.columns();
    let is_free = options.start != PathEnd::Corner || options.end != PathEnd::Corner;
    // Every round of Dinkelbach's iteration is a pass over the whole matrix. The mean of a path that is nearly the best saves most of them.
    let nearly = (is_free && matrix.rows().min(columns) >= WORTH_A_CORRIDOR)
        .then(|| path_in_corridor(matrix, options, 8, 12).ok())
        .flatten()
        .map(|path| {
            let (cost, weight) = weigh(matrix, &path.cells, options.side_step_m);
            cost / weight
        });
    search(matrix, options, |_| 0..columns, nearly)
}

/// From so many rows and columns on, a path in a corridor is found before the best one.
const WORTH_A_CORRIDOR: usize = 256;

/// [`optimal_path`] for long clips: the path is sought in a matrix with cells of `factor` × `factor` first (their mean), then in a
/// corridor of `radius` cells to either side of it.
///
/// Not exact: what leaves the corridor is not seen. O(N² / factor² + N × radius) beside one reading of the matrix.
///
/// # Errors
/// [`PathError`], also where the corridor leaves no path: then take a larger radius.
pub fn path_in_corridor(
    matrix: &DistanceMatrix,
    options: &PathOptions,
    factor: usize,
    radius: usize,
) -> Result<RegistrationPath, PathError> {
    let coarse = matrix.pooled(factor);
    let factor = factor.max(1);
    let mut pins: Vec<(usize, usize)> = options.pins.iter().map(|pin| (pin.0 / factor, pin.1 / factor)).collect();
    pins.sort_unstable();
    // Pins that fall into one row or column of the coarse matrix cannot all be passed there.
    pins.dedup_by(|next, before| next.0 <= before.0 || next.1 <= before.1);
    let (last_row, last_column) = (coarse.rows().saturating_sub(1), coarse.columns().saturating_sub(1));
    let inner = |&(row, column): &(usize, usize)| row > 0 && column > 0 && row < last_row && column < last_column;
    pins.retain(inner);
    let guide = optimal_path(&coarse, &PathOptions { pins, ..options.clone() })?;
    let columns = matrix.columns();
    let mut spans: Vec<Range<usize>> = vec![columns..0; matrix.rows()];
    let mut open = |row: usize, column: usize| {
        if let Some(span) = spans.get_mut(row) {
            *span = span.start.min(column)..span.end.max((column + 1).min(columns));
        }
    };
    let fine = guide.cells.iter().map(|&(row, column)| (row * factor, column * factor));
    for (row, column) in fine.chain(options.pins.iter().copied()) {
        for r in row.saturating_sub(radius)..row + factor + radius {
            open(r, column.saturating_sub(radius));
            open(r, column + factor + radius);
        }
    }
    search(matrix, options, |row| spans.get(row).cloned().unwrap_or_default(), None)
}

/// `bias` is the mean of a path that there is; it only saves time.
fn search(
    matrix: &DistanceMatrix,
    options: &PathOptions,
    spans: impl Fn(usize) -> Range<usize>,
    mut bias: Option<f64>,
) -> Result<RegistrationPath, PathError> {
    let (rows, columns) = (matrix.rows(), matrix.columns());
    let slope_limit = options.slope_limit;
    if rows == 0 || columns == 0 {
        return Err(PathError::TooShort { window: matrix.window() });
    }
    if !(1..=MAX_SLOPE_LIMIT).contains(&slope_limit) {
        return Err(PathError::SlopeLimit { slope_limit });
    }
    let pins = checked_pins(matrix, options)?;
    let mut last = (options.end == PathEnd::Corner).then_some((rows - 1, columns - 1));
    if last.is_some() && pins.last() == last.as_ref() {
        last = None;
    }
    let anchors: Vec<(usize, usize)> = pins.iter().copied().chain(last).collect();
    // Dinkelbach: the best path at the mean of the best path so far, until it is no better. A handful of rounds; the limit is for NaN.
    for _ in 0..32 {
        let found = sweep(matrix, options, &spans, &anchors, bias.unwrap_or(0.0))?;
        let both_given = options.start == PathEnd::Corner && options.end == PathEnd::Corner;
        let (cost, weight) = weigh(matrix, &found, options.side_step_m);
        let mean = cost / weight;
        if both_given || bias.is_some_and(|bias| mean >= bias - 1e-12 * bias.abs()) {
            let (mean_m, weight) = weigh(matrix, &found, 0.0);
            return Ok(RegistrationPath {
                cells: found,
                pins,
                mean_m: mean_m / weight,
            });
        }
        bias = Some(mean);
    }
    Err(PathError::NotFinite)
}

/// The pins in order, each strictly behind the one before in both clips.
fn checked_pins(matrix: &DistanceMatrix, options: &PathOptions) -> Result<Vec<(usize, usize)>, PathError> {
    let (rows, columns) = (matrix.rows(), matrix.columns());
    let mut pins = options.pins.clone();
    pins.sort_unstable();
    pins.dedup();
    if let Some(&pin) = pins.iter().find(|pin| pin.0 >= rows || pin.1 >= columns) {
        let (row, column) = pin;
        return Err(PathError::PinOutside {
            row,
            column,
            rows,
            columns,
        });
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
        if options.end == PathEnd::Corner && pin != corner && (pin.0 == corner.0 || pin.1 == corner.1) {
            return Err(PathError::PinAtEnd { pin: frames, end: "end" });
        }
    }
    Ok(pins)
}

/// The cost of a path and what it weighs.
fn weigh(matrix: &DistanceMatrix, cells: &[(usize, usize)], side_step_m: f64) -> (f64, f64) {
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

/// One pass of dynamic programming, rectangle by rectangle from anchor to anchor, with `bias` taken off every unit of weight.
fn sweep(
    matrix: &DistanceMatrix,
    options: &PathOptions,
    spans: &impl Fn(usize) -> Range<usize>,
    anchors: &[(usize, usize)],
    bias: f64,
) -> Result<Vec<(usize, usize)>, PathError> {
    let (rows, columns) = (matrix.rows(), matrix.columns());
    let s = options.slope_limit;
    let mut stretches: Vec<Stretch> = Vec::with_capacity(anchors.len() + 1);
    let mut carried: Option<((usize, usize), Vec<f64>)> = None;
    for &anchor in anchors {
        if carried.as_ref().is_some_and(|(from, _)| *from == anchor) {
            continue;
        }
        let mut stretch = Stretch::new(carried.as_ref().map_or((0, 0), |(from, _)| *from), anchor, s);
        let states = stretch.fill(matrix, options, spans, carried.as_ref().map(|(_, states)| states.as_slice()), bias);
        if states.iter().all(|state| !state.is_finite()) {
            return Err(no_path(matrix, options, carried.map(|(from, _)| from), Some(anchor)));
        }
        stretches.push(stretch);
        carried = Some((anchor, states));
    }
    let mut cells = Vec::with_capacity(rows + columns);
    let (mut cell, mut state);
    if let PathEnd::Border { slack } = options.end {
        let from = carried.as_ref().map(|(from, _)| *from);
        let mut stretch = Stretch::new(from.unwrap_or_default(), (rows - 1, columns - 1), s);
        stretch.fill(matrix, options, spans, carried.as_ref().map(|(_, states)| states.as_slice()), bias);
        let (row, column) = stretch
            .best_end(slack, (rows, columns))
            .ok_or_else(|| no_path(matrix, options, from, None))?;
        (cell, state) = ((row, column), stretch.any(row, column));
        stretches.push(stretch);
    } else {
        cell = (rows - 1, columns - 1);
        state = stretches.last().map_or(0, |stretch| stretch.any(cell.0, cell.1));
    }
    for (index, stretch) in stretches.iter().enumerate().rev() {
        // A stretch's first cell is the last of the one before it.
        (cell, state) = stretch.trace(cell, state, index > 0, &mut cells);
    }
    cells.reverse();
    Ok(cells)
}

fn no_path(matrix: &DistanceMatrix, options: &PathOptions, from: Option<(usize, usize)>, to: Option<(usize, usize)>) -> PathError {
    let start = from.or((options.start == PathEnd::Corner).then_some((0, 0)));
    let needed = start.zip(to).map(|(from, to)| {
        let (i, j) = (to.0 - from.0, to.1 - from.1);
        // With n steps of the shorter side there are n + 1 places for s steps of the longer one alone.
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

/// A choice among the states of a cell, packed: best run along rows (4 bits), along columns (4 bits), then which of "diagonal" and those two is best
/// for a step along rows, along columns, and for any.
type Choice = u16;
const ALONG_COLUMNS: u16 = 4;
const BEST_NOT_COLUMNS: u16 = 1 << 8;
const BEST_NOT_ROWS: u16 = 1 << 9;
const BEST_IS_COLUMNS: u16 = 1 << 10;

/// The states of one row of cells: how cheaply each is reached by a diagonal step (0), by the k-th step in a row along rows (k = 1…s), or along
/// columns (s + k). Column c is at c + 1 - first; entry 0 is the border.
struct Row {
    states: Vec<Vec<f64>>,
    /// The cheapest that is not along rows, not along columns, and of all.
    not_rows: Vec<f64>,
    not_columns: Vec<f64>,
    any: Vec<f64>,
    /// Entries that are set.
    used: Range<usize>,
}

impl Row {
    fn new(width: usize, states: usize) -> Self {
        let unreached = || vec![f64::INFINITY; width + 1];
        Self {
            states: (0..states).map(|_| unreached()).collect(),
            not_rows: unreached(),
            not_columns: unreached(),
            any: unreached(),
            used: 0..0,
        }
    }

    fn clear(&mut self) {
        let used = self.used.clone();
        let others = [&mut self.not_rows, &mut self.not_columns, &mut self.any];
        for values in self.states.iter_mut().chain(others) {
            values[used.clone()].fill(f64::INFINITY);
        }
    }
}

/// The part of a path between two anchors: dynamic programming in their rectangle.
struct Stretch {
    first: (usize, usize),
    last: (usize, usize),
    slope_limit: usize,
    /// Per row: the first column that has choices, and where they begin.
    starts: Vec<(usize, usize)>,
    choices: Vec<Choice>,
    /// The cheapest of all states on the last row and on the last column, for a free end.
    last_row: Vec<f64>,
    last_column: Vec<f64>,
}

impl Stretch {
    fn new(first: (usize, usize), last: (usize, usize), slope_limit: usize) -> Self {
        Self {
            first,
            last,
            slope_limit,
            starts: Vec::with_capacity(last.0 - first.0 + 1),
            choices: Vec::new(),
            last_row: Vec::new(),
            last_column: Vec::with_capacity(last.0 - first.0 + 1),
        }
    }

    /// Fills the rectangle and returns the states of its last cell. It begins with the states carried from the stretch before, or at the path's start.
    fn fill(
        &mut self,
        matrix: &DistanceMatrix,
        options: &PathOptions,
        spans: &impl Fn(usize) -> Range<usize>,
        carried: Option<&[f64]>,
        bias: f64,
    ) -> Vec<f64> {
        let (s, (first_row, first_column)) = (self.slope_limit, self.first);
        let width = self.last.1 - first_column + 1;
        let (mut before, mut here) = (Row::new(width, 2 * s + 1), Row::new(width, 2 * s + 1));
        let (mut twice, mut once) = (Vec::with_capacity(width), Vec::with_capacity(width));
        for row in first_row..=self.last.0 {
            std::mem::swap(&mut before, &mut here);
            here.clear();
            let span = spans(row);
            let (low, high) = (span.start.max(first_column), span.end.min(self.last.1 + 1));
            let high = high.max(low);
            self.starts.push((low, self.choices.len()));
            // Entries of this row: column c at c + 1 - first_column.
            let (from, to) = (low + 1 - first_column, high + 1 - first_column);
            here.used = from..to;
            let distances = matrix.row(row).get(low..high).unwrap_or_default();
            twice.clear();
            twice.extend(distances.iter().map(|&d| 2.0 * (f64::from(d) - bias)));
            once.clear();
            once.extend(distances.iter().map(|&d| f64::from(d) - bias + options.side_step_m));

            let diagonal = &mut here.states[0][from..to];
            add(diagonal, &before.any[from - 1..to - 1], &twice);
            if carried.is_none() {
                // Cells on the border have no diagonal before them: there a path begins, or none.
                let begins = |row, column| match options.start {
                    PathEnd::Corner => (row, column) == (0, 0),
                    PathEnd::Border { slack } => {
                        row == 0 && within(column, matrix.columns(), slack) || column == 0 && within(row, matrix.rows(), slack)
                    }
                };
                let candidates = if row == 0 { low..high } else { low..high.min(1) };
                for column in candidates.filter(|&column| begins(row, column)) {
                    diagonal[column - low] = twice[column - low];
                }
            }
            let corner = carried.filter(|_| row == first_row && low == first_column && high > low);
            if let Some(states) = corner {
                here.states[0][1] = states[0];
            }
            for k in 1..=s {
                let from_run = if k == 1 { &before.not_rows } else { &before.states[k - 1] };
                add(&mut here.states[k][from..to], &from_run[from..to], &once);
                if let Some(states) = corner {
                    here.states[k][1] = states[k];
                }
            }
            self.choices.resize(self.choices.len() + (high - low), 0);
            let at = self.choices.len() - (high - low);
            let choices = &mut self.choices[at..];
            let best = &mut here.not_columns;
            best[from..to].copy_from_slice(&here.states[1][from..to]);
            for k in 2..=s {
                choose(&mut best[from..to], &here.states[k][from..to], choices, 0xf, k as u16 - 1);
            }
            // The diagonal wins a tie.
            for ((best, &diagonal), choice) in best[from..to].iter_mut().zip(&here.states[0][from..to]).zip(choices.iter_mut()) {
                let along = *best < diagonal;
                *best = if along { *best } else { diagonal };
                *choice |= if along { BEST_NOT_COLUMNS } else { 0 };
            }
            for k in 1..=s {
                let (shorter, longer) = here.states.split_at_mut(s + k);
                let from_run = if k == 1 { &here.not_columns } else { &shorter[s + k - 1] };
                add(&mut longer[0][from..to], &from_run[from - 1..to - 1], &once);
                if let Some(states) = corner {
                    longer[0][1] = states[s + k];
                }
            }
            let best = &mut here.not_rows;
            best[from..to].copy_from_slice(&here.states[s + 1][from..to]);
            for k in 2..=s {
                let run = &here.states[s + k][from..to];
                choose(
                    &mut best[from..to],
                    run,
                    choices,
                    0xf << ALONG_COLUMNS,
                    (k as u16 - 1) << ALONG_COLUMNS,
                );
            }
            let any = here.any[from..to].iter_mut().zip(&here.not_columns[from..to]);
            let states = best[from..to]
                .iter_mut()
                .zip(&here.states[0][from..to])
                .zip(any)
                .zip(choices.iter_mut());
            for (((best, &diagonal), (any, &not_columns)), choice) in states {
                let columns = *best < not_columns;
                *any = if columns { *best } else { not_columns };
                let along = *best < diagonal;
                *best = if along { *best } else { diagonal };
                *choice |= if columns { BEST_IS_COLUMNS } else { 0 } | if along { BEST_NOT_ROWS } else { 0 };
            }
            self.last_column.push(here.any[width]);
        }
        self.last_row = here.any[1..].to_vec();
        here.states.iter().map(|states| states[width]).collect()
    }

    fn choice(&self, row: usize, column: usize) -> Choice {
        let (low, at) = self.starts[row - self.first.0];
        self.choices[at + column - low]
    }

    fn along_rows(choice: Choice) -> usize {
        1 + usize::from(choice & 0xf)
    }

    fn along_columns(&self, choice: Choice) -> usize {
        1 + self.slope_limit + usize::from(choice >> ALONG_COLUMNS & 0xf)
    }

    /// The best state of a cell.
    fn any(&self, row: usize, column: usize) -> usize {
        let choice = self.choice(row, column);
        if choice & BEST_IS_COLUMNS != 0 {
            self.along_columns(choice)
        } else if choice & BEST_NOT_COLUMNS != 0 {
            Self::along_rows(choice)
        } else {
            0
        }
    }

    /// The cheapest cell on the last row and the last column, where at most `slack` of the other clip is left out.
    fn best_end(&self, slack: f64, (rows, columns): (usize, usize)) -> Option<(usize, usize)> {
        let on_row = self
            .last_row
            .iter()
            .enumerate()
            .map(|(c, &cost)| (cost, (self.last.0, self.first.1 + c)));
        let on_column = self
            .last_column
            .iter()
            .enumerate()
            .map(|(r, &cost)| (cost, (self.first.0 + r, self.last.1)));
        let allowed = |&(cost, (row, column)): &(f64, (usize, usize))| {
            cost.is_finite() && within(rows - 1 - row, rows, slack) && within(columns - 1 - column, columns, slack)
        };
        let best = on_row.chain(on_column).filter(allowed).min_by(|a, b| a.0.total_cmp(&b.0))?;
        Some(best.1)
    }

    /// Walks back from a cell to the stretch's first one, or to where the path begins. Adds the cells, the first one only if it is not `shared` with the
    /// stretch before; returns the first cell with its state.
    fn trace(&self, mut cell: (usize, usize), mut state: usize, shared: bool, cells: &mut Vec<(usize, usize)>) -> ((usize, usize), usize) {
        let s = self.slope_limit;
        loop {
            let (row, column) = cell;
            let at_first = if shared {
                cell == self.first
            } else {
                state == 0 && (row == 0 || column == 0)
            };
            if at_first {
                if !shared {
                    cells.push(cell);
                }
                return (cell, state);
            }
            cells.push(cell);
            (cell, state) = if state == 0 {
                let before = (row - 1, column - 1);
                (before, self.any(before.0, before.1))
            } else if state <= s {
                let choice = self.choice(row - 1, column);
                let along = if choice & BEST_NOT_ROWS != 0 {
                    self.along_columns(choice)
                } else {
                    0
                };
                ((row - 1, column), if state == 1 { along } else { state - 1 })
            } else {
                let choice = self.choice(row, column - 1);
                let along = if choice & BEST_NOT_COLUMNS != 0 {
                    Self::along_rows(choice)
                } else {
                    0
                };
                ((row, column - 1), if state == s + 1 { along } else { state - 1 })
            };
        }
    }
}

/// Whether leaving out `left` of `of` cells is no more than the share `slack`.
fn within(left: usize, of: usize, slack: f64) -> bool {
    left == 0 || (left as f64) <= slack.clamp(0.0, 0.5) * of as f64
}

fn add(out: &mut [f64], from: &[f64], cost: &[f64]) {
    for ((out, from), cost) in out.iter_mut().zip(from).zip(cost) {
        *out = from + cost;
    }
}

/// Where `other` is cheaper it is taken, and `code` noted in the bits of `mask`.
fn choose(best: &mut [f64], other: &[f64], choices: &mut [Choice], mask: Choice, code: Choice) {
    for ((best, &other), choice) in best.iter_mut().zip(other).zip(choices) {
        let better = other < *best;
        *best = if better { other } else { *best };
        *choice = if better { *choice & !mask | code } else { *choice };
    }
}

#[cfg(test)]
mod tests;
