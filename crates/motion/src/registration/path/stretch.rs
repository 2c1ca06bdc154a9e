use super::{DistanceMatrix, PathEnd, PathOptions, within};
use std::ops::Range;

/// Of so many rows the last is kept, and those behind it are filled again on the way back: to note
/// in each cell where its states come from would take as long as to fill it.
const BLOCK: usize = 32;
/// Columns that are filled together: what that takes stays in the processor's nearest memory.
const TILE: usize = 192;

/// The states of one row of cells: how cheaply each is reached by a diagonal step (0), by the k-th
/// step in a row along rows (k = 1…s), or along columns (s + k). Column c is at c + 1 - first;
/// entry 0 is the border.
#[derive(Clone, Debug)]
struct Row {
    states: Vec<Vec<f64>>,
    /// The cheapest that is not along rows, not along columns, and of all.
    not_rows: Vec<f64>,
    not_columns: Vec<f64>,
    any: Vec<f64>,
    /// Entries that are set.
    used: Range<usize>,
}

/// Some of the values of a row where it is set, one after the other.
#[derive(Clone, Debug, Default)]
struct Kept {
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

    /// All but these entries is out of reach from now on; what is in them is to be set.
    fn open(&mut self, entries: Range<usize>) {
        if self.used != entries {
            let others = [&mut self.not_rows, &mut self.not_columns, &mut self.any];
            for values in self.states.iter_mut().chain(others) {
                values[self.used.clone()].fill(f64::INFINITY);
            }
            self.used = entries;
        }
    }

    /// What is not diagonal of some entries. `corner` holds the states of the first entry of all,
    /// where they are given.
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

    /// What the next row needs: steps along rows go on from where they are, and everything else
    /// from the cheapest.
    fn keep(&self, slope_limit: usize) -> Kept {
        self.kept(self.states[1..=slope_limit].iter().chain([&self.not_rows, &self.any]))
    }

    /// Some of its values where it is set; of all states a [`Kept::choice`] can be made.
    fn kept<'a>(&self, parts: impl Iterator<Item = &'a Vec<f64>>) -> Kept {
        let mut values = Vec::with_capacity((self.states.len() + 1) * self.used.len());
        for part in parts {
            values.extend_from_slice(&part[self.used.clone()]);
        }
        Kept { values, used: self.used.clone() }
    }

    fn restore(&mut self, kept: &Kept, slope_limit: usize) {
        self.open(kept.used.clone());
        let parts =
            self.states[1..=slope_limit].iter_mut().chain([&mut self.not_rows, &mut self.any]);
        let mut from = kept.values.as_slice();
        for values in parts {
            let (values_of_one, rest) = from.split_at(kept.used.len());
            values[kept.used.clone()].copy_from_slice(values_of_one);
            from = rest;
        }
    }
}

/// The cheapest states of a cell: without those along columns, without those along rows, and of
/// all.
#[derive(Clone, Copy, Debug)]
struct Choice {
    not_columns: usize,
    not_rows: usize,
    any: usize,
}

impl Kept {
    /// Of a row with all its states, the cheapest of an entry. The diagonal wins a tie, and the
    /// shorter run.
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
pub(super) struct Stretch {
    shape: Shape,
    front: Front,
    /// The cheapest of all states on the last column, for a free end.
    last_column: Vec<f64>,
    /// Rows that are filled.
    filled: usize,
    /// The last row of every block.
    kept: Vec<Kept>,
    /// All states of the rows that a path is walked back through; those of narrow rows from the
    /// start.
    known: Vec<Kept>,
}

/// A rectangle of cells, first and last; how many steps may go one way; and what the states of the
/// first cell cost where a stretch before led there.
#[derive(Clone, Debug)]
struct Shape {
    first: (usize, usize),
    last: (usize, usize),
    slope_limit: usize,
    carried: Option<Vec<f64>>,
}

impl Shape {
    /// So many columns to the left a path of so many rows can come from: the steps that may go
    /// along columns, and a diagonal one, in each row.
    fn reach(&self, rows: usize) -> usize {
        (self.slope_limit + 1) * (rows + 2)
    }
}

/// How far the states are known.
#[derive(Clone, Debug)]
struct Front {
    here: Row,
    before: Row,
    /// What the cells of a row cost, for a step on in one clip.
    costs: Vec<f64>,
}

/// What a path is sought in, and how.
#[derive(Clone, Copy)]
pub(super) struct Ground<'a> {
    pub(super) matrix: &'a DistanceMatrix,
    pub(super) options: &'a PathOptions,
    /// The columns of each row that are looked at; all of them where there is none.
    pub(super) spans: Option<&'a [Range<usize>]>,
    /// What is taken off every unit of weight.
    pub(super) bias: f64,
}

impl Front {
    /// The next row, as far as its columns lie in `limit`. A function of its own: a browser
    /// compiles well what is called often, from one call to the next.
    #[inline(never)]
    fn fill_row(&mut self, row: usize, limit: &Range<usize>, shape: &Shape, ground: &Ground<'_>) {
        let Ground { matrix, options, spans, bias } = *ground;
        let (s, (first_row, first_column)) = (shape.slope_limit, shape.first);
        let Self { before, here, costs } = self;
        std::mem::swap(before, here);
        let span =
            spans.map_or(0..matrix.columns(), |spans| spans.get(row).cloned().unwrap_or_default());
        let end = shape.last.1 + 1;
        // A row beside the corridor has no cells, wherever that is.
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
                // Cells on the border have no diagonal before them: there a path begins, or none.
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

impl Stretch {
    /// Of the rectangle of two cells. It begins with the states carried from the stretch before, or
    /// at the path's start.
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
            kept: Vec::new(),
            known: vec![Kept::default(); last.0 - first.0 + 1],
        }
    }

    /// Fills `rows` more rows. `true` when the rectangle is full.
    pub(super) fn advance(&mut self, ground: &Ground<'_>, rows: usize) -> bool {
        let (first, last) = (self.shape.first, self.shape.last);
        let height = last.0 + 1 - first.0;
        for _ in 0..rows.min(height - self.filled) {
            self.front.fill_row(first.0 + self.filled, &(0..usize::MAX), &self.shape, ground);
            let row = &self.front.here;
            self.last_column.push(row.any[self.width()]);
            // What is no wider than what would be filled again is known at once.
            if row.used.len() <= self.shape.reach(BLOCK) {
                self.known[self.filled] = row.kept(row.states.iter());
            }
            self.filled += 1;
            if self.filled.is_multiple_of(BLOCK) && self.filled < height {
                self.kept.push(row.keep(self.shape.slope_limit));
            }
        }
        self.filled == height
    }

    /// The states of the last cell that was filled.
    pub(super) fn states(&self) -> Vec<f64> {
        self.front.here.states.iter().map(|states| states[self.width()]).collect()
    }

    fn width(&self) -> usize {
        self.shape.last.1 - self.shape.first.1 + 1
    }

    /// What is cheapest in a cell. Asked for from below upwards and from right to left, as a path
    /// is walked back.
    fn choice(&mut self, row: usize, column: usize, ground: &Ground<'_>) -> Choice {
        let at = row - self.shape.first.0;
        let entry = column + 1 - self.shape.first.1;
        if !self.known[at].used.contains(&entry) {
            self.fill_again(at, column, ground);
        }
        self.known[at].choice(entry, self.shape.slope_limit)
    }

    /// Fills a block up to a row again, as far as a path through that cell can come from.
    fn fill_again(&mut self, at: usize, column: usize, ground: &Ground<'_>) {
        let (shape, front) = (&self.shape, &mut self.front);
        let first = at / BLOCK * BLOCK;
        self.known.truncate(at + 1);
        self.kept.truncate(first / BLOCK);
        match self.kept.pop() {
            Some(kept) => front.here.restore(&kept, shape.slope_limit),
            None => front.here.open(0..0),
        }
        let limit = column.saturating_sub(shape.reach(at - first))..column + 1;
        for (row, known) in self.known.iter_mut().enumerate().skip(first) {
            front.fill_row(shape.first.0 + row, &limit, shape, ground);
            *known = front.here.kept(front.here.states.iter());
        }
    }

    /// The best state of a cell.
    pub(super) fn any(&mut self, row: usize, column: usize, ground: &Ground<'_>) -> usize {
        self.choice(row, column, ground).any
    }

    /// The cheapest cell on the last row and the last column, where at most `slack` of the other
    /// clip is left out.
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

    /// Walks back from a cell to the stretch's first one, or to where the path begins. Adds the
    /// cells, the first one only if it is not `shared` with the stretch before; returns the first
    /// cell with its state.
    pub(super) fn trace(
        &mut self,
        mut cell: (usize, usize),
        mut state: usize,
        shared: bool,
        ground: &Ground<'_>,
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
                (before, self.any(before.0, before.1, ground))
            } else if state <= s {
                let before = (row - 1, column);
                let first =
                    |stretch: &mut Self| stretch.choice(before.0, before.1, ground).not_rows;
                (before, if state == 1 { first(self) } else { state - 1 })
            } else {
                let before = (row, column - 1);
                let first =
                    |stretch: &mut Self| stretch.choice(before.0, before.1, ground).not_columns;
                (before, if state == s + 1 { first(self) } else { state - 1 })
            };
        }
    }
}

/// One step further in runs, and the cheapest so far. A function of its own, over slices that share
/// nothing: then it takes two cells at a time, without a branch.
#[inline(never)]
fn step_on(out: &mut [f64], from: &[f64], costs: &[f64], best: &mut [f64]) {
    for (((out, from), cost), best) in out.iter_mut().zip(from).zip(costs).zip(best) {
        let reached = from + cost;
        *out = reached;
        *best = if reached < *best { reached } else { *best };
    }
}
