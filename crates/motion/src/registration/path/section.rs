//! One section of a path: dynamic programming in a rectangle of cells.

use super::{DistanceMatrix, PathEnd, PathOptions, within};
use std::ops::Range;

/// The last of so many rows is saved, and the others are filled again during the trace: to store
/// the origin of the states in each cell would take as long as to fill it.
const BLOCK: usize = 32;
/// Number of columns that are filled together: their data fits into the processor's first-level
/// cache.
const TILE: usize = 192;

/// The states of one row of cells: the least cost of reaching each by a diagonal step (0), by the
/// k-th step in a row along rows (k = 1…s), or along columns (s + k). Column c is at c + 1 - first;
/// entry 0 is the border.
#[derive(Clone, Debug)]
struct Row {
    states: Vec<Vec<f64>>,
    /// The least costs of states that are not along rows, of states that are not along columns, and
    /// of all.
    not_rows: Vec<f64>,
    not_columns: Vec<f64>,
    any: Vec<f64>,
    /// The entries that are set.
    used: Range<usize>,
}

/// Some of the values of a row where it is set, one after the other.
#[derive(Clone, Debug, Default)]
struct SavedRow {
    used: Range<usize>,
    values: Vec<f64>,
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

    /// Makes all entries but these unreachable; these are to be set.
    fn open(&mut self, entries: Range<usize>) {
        if self.used != entries {
            let others = [&mut self.not_rows, &mut self.not_columns, &mut self.any];
            for values in self.states.iter_mut().chain(others) {
                values[self.used.clone()].fill(f64::INFINITY);
            }
            self.used = entries;
        }
    }

    /// Fills the states of some entries that are not diagonal. `corner` holds the states of the
    /// first entry of all, where they are given.
    fn fill(
        &mut self,
        s: usize,
        tile: &Range<usize>,
        before: &Self,
        costs: &[f64],
        corner: Option<&[f64]>,
    ) {
        if let Some(states) = corner {
            self.states[0][1] = states[0];
        }
        self.not_columns[tile.clone()].copy_from_slice(&self.states[0][tile.clone()]);
        self.not_rows[tile.clone()].copy_from_slice(&self.states[0][tile.clone()]);
        for k in 1..=s {
            let from_run = if k == 1 { &before.not_rows } else { &before.states[k - 1] };
            let best = &mut self.not_columns[tile.clone()];
            step_on(&mut self.states[k][tile.clone()], &from_run[tile.clone()], costs, best);
            if let Some(states) = corner {
                self.states[k][1] = states[k];
            }
        }
        let least = |states: &[Vec<f64>], best: f64| {
            states.iter().fold(best, |best, of| if of[1] < best { of[1] } else { best })
        };
        if corner.is_some() {
            self.not_columns[1] = least(&self.states[1..=s], self.states[0][1]);
        }
        for k in 1..=s {
            let (shorter, longer) = self.states.split_at_mut(s + k);
            let from_run = if k == 1 { &self.not_columns } else { &shorter[s + k - 1] };
            let best = &mut self.not_rows[tile.clone()];
            step_on(
                &mut longer[0][tile.clone()],
                &from_run[tile.start - 1..tile.end - 1],
                costs,
                best,
            );
            if let Some(states) = corner {
                longer[0][1] = states[s + k];
            }
        }
        if corner.is_some() {
            self.not_rows[1] = least(&self.states[s + 1..], self.states[0][1]);
        }
        let others = self.not_columns[tile.clone()].iter().zip(&self.not_rows[tile.clone()]);
        for (best, (&a, &b)) in self.any[tile.clone()].iter_mut().zip(others) {
            *best = if b < a { b } else { a };
        }
    }

    /// Returns the values that the next row needs: steps along rows continue from their own states,
    /// and all other steps from the least cost.
    fn saved_for_next_row(&self, slope_limit: usize) -> SavedRow {
        self.saved(self.states[1..=slope_limit].iter().chain([&self.not_rows, &self.any]))
    }

    /// Returns some of the values where the row is set; with all states, [`SavedRow::choice`] can
    /// be computed.
    fn saved<'a>(&self, parts: impl Iterator<Item = &'a Vec<f64>>) -> SavedRow {
        let mut values = Vec::with_capacity((self.states.len() + 1) * self.used.len());
        for part in parts {
            values.extend_from_slice(&part[self.used.clone()]);
        }
        SavedRow { values, used: self.used.clone() }
    }

    fn restore(&mut self, saved: &SavedRow, slope_limit: usize) {
        self.open(saved.used.clone());
        let parts =
            self.states[1..=slope_limit].iter_mut().chain([&mut self.not_rows, &mut self.any]);
        let mut from = saved.values.as_slice();
        for values in parts {
            let (values_of_one, rest) = from.split_at(saved.used.len());
            values[saved.used.clone()].copy_from_slice(values_of_one);
            from = rest;
        }
    }
}

/// The states of least cost of a cell: without those along columns, without those along rows, and
/// of all.
#[derive(Clone, Copy, Debug)]
struct Choice {
    not_columns: usize,
    not_rows: usize,
    any: usize,
}

impl SavedRow {
    /// Returns the states of least cost of an entry, from a row with all its states. The diagonal
    /// wins a tie, then the shorter run.
    fn choice(&self, entry: usize, slope_limit: usize) -> Choice {
        let cost = |state: usize| self.values[state * self.used.len() + entry - self.used.start];
        let run = |first: usize| {
            (first + 1..first + slope_limit)
                .fold(first, |best, state| if cost(state) < cost(best) { state } else { best })
        };
        let (rows, columns) = (run(1), run(slope_limit + 1));
        let not_columns = if cost(rows) < cost(0) { rows } else { 0 };
        Choice {
            not_columns,
            not_rows: if cost(columns) < cost(0) { columns } else { 0 },
            any: if cost(columns) < cost(not_columns) { columns } else { not_columns },
        }
    }
}

/// The part of a path between two anchors: dynamic programming in their rectangle.
#[derive(Clone, Debug)]
pub(super) struct Section {
    shape: Shape,
    front: Front,
    /// The least cost of all states in the last column, for a free end.
    last_column: Vec<f64>,
    /// Number of rows that are filled.
    filled: usize,
    /// The last row of every block.
    saved: Vec<SavedRow>,
    /// All states of the rows that are traced back; for narrow rows they are stored when filled.
    known: Vec<SavedRow>,
}

/// A rectangle of cells, first and last; the slope limit; and the costs of the first cell's states,
/// if a section before led there.
#[derive(Clone, Debug)]
struct Shape {
    first: (usize, usize),
    last: (usize, usize),
    slope_limit: usize,
    carried: Option<Vec<f64>>,
}

impl Shape {
    /// Returns how many columns a path can advance in this many rows: the steps along columns, and
    /// a diagonal one, in each row.
    fn reach(&self, rows: usize) -> usize {
        (self.slope_limit + 1) * (rows + 2)
    }
}

/// The rows around the last one that is filled.
#[derive(Clone, Debug)]
struct Front {
    here: Row,
    before: Row,
    /// The costs of a row's cells, for a step in one clip.
    costs: Vec<f64>,
}

/// The matrix, options and constraints of a search.
#[derive(Clone, Copy)]
pub(super) struct SearchSpace<'a> {
    pub(super) matrix: &'a DistanceMatrix,
    pub(super) options: &'a PathOptions,
    /// The columns of each row that are considered; all of them where it is `None`.
    pub(super) spans: Option<&'a [Range<usize>]>,
    /// The value that is subtracted per unit of weight.
    pub(super) bias: f64,
}

impl Front {
    /// Fills the next row, as far as its columns lie in `limit`. A separate function, because
    /// browsers optimise a function between two of its calls.
    #[inline(never)]
    fn fill_row(
        &mut self,
        row: usize,
        limit: &Range<usize>,
        shape: &Shape,
        space: &SearchSpace<'_>,
    ) {
        let SearchSpace { matrix, options, spans, bias } = *space;
        let (s, (first_row, first_column)) = (shape.slope_limit, shape.first);
        let Self { before, here, costs } = self;
        std::mem::swap(before, here);
        let span =
            spans.map_or(0..matrix.columns(), |spans| spans.get(row).cloned().unwrap_or_default());
        let end = shape.last.1 + 1;
        // A row outside of the corridor has no cells.
        let low = span.start.max(first_column).max(limit.start).min(end);
        let high = span.end.min(end).min(limit.end).max(low);
        // Entries of this row: column c at c + 1 - first_column.
        let (from, to) = (low + 1 - first_column, high + 1 - first_column);
        here.open(from..to);
        let distances = matrix.row(row).get(low..high).unwrap_or_default();
        costs.resize(to - from, 0.0);
        for (cost, &distance) in costs.iter_mut().zip(distances) {
            *cost = f64::from(distance) - bias;
        }
        let carried = shape.carried.as_deref();
        let corner = carried.filter(|_| row == first_row && low == first_column && high > low);
        for start in (from..to).step_by(TILE) {
            let tile = start..(start + TILE).min(to);
            let costs = &mut costs[start - from..tile.end - from];
            let diagonal = &mut here.states[0][tile.clone()];
            for ((out, from), &cost) in
                diagonal.iter_mut().zip(&before.any[start - 1..tile.end - 1]).zip(&*costs)
            {
                *out = from + 2.0 * cost;
            }
            if shape.carried.is_none() {
                // Cells on the border have no diagonal predecessor: a path may begin there, or not.
                let begins = |row, column| match options.start {
                    PathEnd::Corner => (row, column) == (0, 0),
                    PathEnd::Border { slack } => {
                        row == 0 && within(column, matrix.columns(), slack)
                            || column == 0 && within(row, matrix.rows(), slack)
                    }
                };
                let first = first_column + start - 1;
                let candidates = first..if row == 0 { first + tile.len() } else { 1 };
                for column in candidates.filter(|&column| begins(row, column)) {
                    diagonal[column - first] = 2.0 * costs[column - first];
                }
            }
            for cost in costs.iter_mut() {
                *cost += options.side_step_m;
            }
            here.fill(s, &tile, before, costs, corner.filter(|_| start == from));
        }
    }
}

impl Section {
    /// Returns the section of the rectangle of two cells. It begins with the states carried from
    /// the section before, or at the path's start.
    pub(super) fn new(
        first: (usize, usize),
        last: (usize, usize),
        slope_limit: usize,
        carried: Option<Vec<f64>>,
    ) -> Self {
        let row = || Row::new(last.1 - first.1 + 1, 2 * slope_limit + 1);
        Self {
            shape: Shape { first, last, slope_limit, carried },
            front: Front { here: row(), before: row(), costs: Vec::new() },
            last_column: Vec::with_capacity(last.0 - first.0 + 1),
            filled: 0,
            saved: Vec::new(),
            known: vec![SavedRow::default(); last.0 - first.0 + 1],
        }
    }

    /// Fills `rows` more rows. Returns `true` when the rectangle is full.
    pub(super) fn advance(&mut self, space: &SearchSpace<'_>, rows: usize) -> bool {
        let (first, last) = (self.shape.first, self.shape.last);
        let height = last.0 + 1 - first.0;
        for _ in 0..rows.min(height - self.filled) {
            self.front.fill_row(first.0 + self.filled, &(0..usize::MAX), &self.shape, space);
            let row = &self.front.here;
            self.last_column.push(row.any[self.width()]);
            // Rows that are no wider than the part that would be filled again are stored at once.
            if row.used.len() <= self.shape.reach(BLOCK) {
                self.known[self.filled] = row.saved(row.states.iter());
            }
            self.filled += 1;
            if self.filled.is_multiple_of(BLOCK) && self.filled < height {
                self.saved.push(row.saved_for_next_row(self.shape.slope_limit));
            }
        }
        self.filled == height
    }

    /// Returns the states of the last cell that was filled.
    pub(super) fn states(&self) -> Vec<f64> {
        self.front.here.states.iter().map(|states| states[self.width()]).collect()
    }

    fn width(&self) -> usize {
        self.shape.last.1 - self.shape.first.1 + 1
    }

    /// Returns the states of least cost of a cell. Cells must be requested upwards and from right
    /// to left, as a path is traced.
    fn choice(&mut self, row: usize, column: usize, space: &SearchSpace<'_>) -> Choice {
        let at = row - self.shape.first.0;
        let entry = column + 1 - self.shape.first.1;
        if !self.known[at].used.contains(&entry) {
            self.fill_again(at, column, space);
        }
        self.known[at].choice(entry, self.shape.slope_limit)
    }

    /// Fills a block up to a row again, as far as a path through that cell can come from.
    fn fill_again(&mut self, at: usize, column: usize, space: &SearchSpace<'_>) {
        let (shape, front) = (&self.shape, &mut self.front);
        let first = at / BLOCK * BLOCK;
        self.known.truncate(at + 1);
        self.saved.truncate(first / BLOCK);
        match self.saved.pop() {
            Some(saved) => front.here.restore(&saved, shape.slope_limit),
            None => front.here.open(0..0),
        }
        let limit = column.saturating_sub(shape.reach(at - first))..column + 1;
        for (row, known) in self.known.iter_mut().enumerate().skip(first) {
            front.fill_row(shape.first.0 + row, &limit, shape, space);
            *known = front.here.saved(front.here.states.iter());
        }
    }

    /// Returns the best state of a cell.
    pub(super) fn any(&mut self, row: usize, column: usize, space: &SearchSpace<'_>) -> usize {
        self.choice(row, column, space).any
    }

    /// Returns the cell of least cost in the last row and the last column, where at most `slack` of
    /// the other clip is left out.
    pub(super) fn best_end(
        &self,
        slack: f64,
        (rows, columns): (usize, usize),
    ) -> Option<(usize, usize)> {
        let on_row = self.front.here.any[1..]
            .iter()
            .enumerate()
            .map(|(c, &cost)| (cost, (self.shape.last.0, self.shape.first.1 + c)));
        let on_column = self
            .last_column
            .iter()
            .enumerate()
            .map(|(r, &cost)| (cost, (self.shape.first.0 + r, self.shape.last.1)));
        let allowed = |&(cost, (row, column)): &(f64, (usize, usize))| {
            cost.is_finite()
                && within(rows - 1 - row, rows, slack)
                && within(columns - 1 - column, columns, slack)
        };
        let best = on_row.chain(on_column).filter(allowed).min_by(|a, b| a.0.total_cmp(&b.0))?;
        Some(best.1)
    }

    /// Traces back from a cell to the section's first one, or to the start of the path. Appends the
    /// cells, the first one only if it is not `shared` with the section before; returns the first
    /// cell with its state.
    pub(super) fn trace(
        &mut self,
        mut cell: (usize, usize),
        mut state: usize,
        shared: bool,
        space: &SearchSpace<'_>,
        cells: &mut Vec<(usize, usize)>,
    ) -> ((usize, usize), usize) {
        let s = self.shape.slope_limit;
        loop {
            let (row, column) = cell;
            let at_first = if shared {
                cell == self.shape.first
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
                (before, self.any(before.0, before.1, space))
            } else if state <= s {
                let before = (row - 1, column);
                let first = |section: &mut Self| section.choice(before.0, before.1, space).not_rows;
                (before, if state == 1 { first(self) } else { state - 1 })
            } else {
                let before = (row, column - 1);
                let first =
                    |section: &mut Self| section.choice(before.0, before.1, space).not_columns;
                (before, if state == s + 1 { first(self) } else { state - 1 })
            };
        }
    }
}

/// Extends all runs by one step, and updates the least costs. A separate function over slices that
/// do not alias, so that it is vectorised: two cells at a time, without a branch.
#[inline(never)]
fn step_on(out: &mut [f64], from: &[f64], costs: &[f64], best: &mut [f64]) {
    for (((out, from), cost), best) in out.iter_mut().zip(from).zip(costs).zip(best) {
        let reached = from + cost;
        *out = reached;
        *best = if reached < *best { reached } else { *best };
    }
}
