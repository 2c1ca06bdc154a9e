use super::{DistanceMatrix, PathEnd, PathOptions, within};
use std::ops::Range;

/// A choice among the states of a cell, packed: best run along rows (4 bits), along columns (4 bits), then which of "diagonal" and those two is best
/// for a step along rows, along columns, and for any.
type Choice = u16;
const ALONG_COLUMNS: u16 = 4;
const BEST_NOT_COLUMNS: u64 = 1 << 8;
const BEST_NOT_ROWS: u64 = 1 << 9;
const BEST_IS_COLUMNS: u64 = 1 << 10;

/// The states of one row of cells: how cheaply each is reached by a diagonal step (0), by the k-th step in a row along rows (k = 1…s), or along
/// columns (s + k). Column c is at c + 1 - first; entry 0 is the border.
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
#[derive(Clone, Debug)]
pub(super) struct Stretch {
    first: (usize, usize),
    last: (usize, usize),
    slope_limit: usize,
    /// Per row: the first column that has choices, and where they begin.
    starts: Vec<(usize, usize)>,
    choices: Vec<Choice>,
    /// The cheapest of all states on the last column, for a free end.
    last_column: Vec<f64>,
    /// Rows that are filled: the last of them, and the one before it.
    filled: usize,
    here: Row,
    before: Row,
    /// What the cells of a row cost, for a step on in one clip.
    costs: Vec<f64>,
    /// The choices of a row while it is filled, as wide as what they depend on: both are then taken two at a time, without a branch.
    codes: Vec<u64>,
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

impl Stretch {
    pub(super) fn new(first: (usize, usize), last: (usize, usize), slope_limit: usize) -> Self {
        let row = || Row::new(last.1 - first.1 + 1, 2 * slope_limit + 1);
        Self {
            first,
            last,
            slope_limit,
            starts: Vec::with_capacity(last.0 - first.0 + 1),
            choices: Vec::new(),
            last_column: Vec::with_capacity(last.0 - first.0 + 1),
            filled: 0,
            here: row(),
            before: row(),
            costs: Vec::new(),
            codes: Vec::new(),
        }
    }

    /// Fills `rows` more rows of the rectangle, which begins with the states carried from the stretch before, or at the path's start. `true` when it is
    /// full.
    pub(super) fn advance(&mut self, ground: &Ground<'_>, carried: Option<&[f64]>, rows: usize) -> bool {
        let height = self.last.0 + 1 - self.first.0;
        for _ in 0..rows.min(height - self.filled) {
            self.fill_row(self.first.0 + self.filled, ground, carried);
            self.filled += 1;
        }
        self.filled == height
    }

    /// The states of the last cell that was filled.
    pub(super) fn states(&self) -> Vec<f64> {
        self.here.states.iter().map(|states| states[self.width()]).collect()
    }

    fn width(&self) -> usize {
        self.last.1 - self.first.1 + 1
    }

    /// One row, as a function of its own: a browser compiles well what is called often, from one call to the next.
    #[inline(never)]
    fn fill_row(&mut self, row: usize, ground: &Ground<'_>, carried: Option<&[f64]>) {
        let Ground {
            matrix,
            options,
            spans,
            bias,
        } = *ground;
        let (s, (first_row, first_column), width) = (self.slope_limit, self.first, self.width());
        let Self {
            before,
            here,
            costs,
            codes,
            ..
        } = self;
        std::mem::swap(before, here);
        let span = spans.map_or(0..matrix.columns(), |spans| spans.get(row).cloned().unwrap_or_default());
        let (low, high) = (span.start.max(first_column), span.end.min(self.last.1 + 1));
        let high = high.max(low);
        self.starts.push((low, self.choices.len()));
        // Entries of this row: column c at c + 1 - first_column.
        let (from, to) = (low + 1 - first_column, high + 1 - first_column);
        // What is set in both is overwritten.
        if here.used != (from..to) {
            here.clear();
            here.used = from..to;
        }
        let distances = matrix.row(row).get(low..high).unwrap_or_default();
        costs.clear();
        costs.extend(distances.iter().map(|&d| f64::from(d) - bias));
        let side_step_m = options.side_step_m;

        let diagonal = &mut here.states[0][from..to];
        add(diagonal, &before.any[from - 1..to - 1], costs, |cost| 2.0 * cost);
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
                diagonal[column - low] = 2.0 * costs[column - low];
            }
        }
        let corner = carried.filter(|_| row == first_row && low == first_column && high > low);
        if let Some(states) = corner {
            here.states[0][1] = states[0];
        }
        for k in 1..=s {
            let from_run = if k == 1 { &before.not_rows } else { &before.states[k - 1] };
            add(&mut here.states[k][from..to], &from_run[from..to], costs, |cost| cost + side_step_m);
            if let Some(states) = corner {
                here.states[k][1] = states[k];
            }
        }
        codes.clear();
        codes.resize(high - low, 0);
        let best = &mut here.not_columns[from..to];
        cheapest_run(best, &here.states[1..=s], &(from..to), codes, 0);
        or_diagonal(best, &here.states[0][from..to], codes, BEST_NOT_COLUMNS);
        for k in 1..=s {
            let (shorter, longer) = here.states.split_at_mut(s + k);
            let from_run = if k == 1 { &here.not_columns } else { &shorter[s + k - 1] };
            add(&mut longer[0][from..to], &from_run[from - 1..to - 1], costs, |cost| {
                cost + side_step_m
            });
            if let Some(states) = corner {
                longer[0][1] = states[s + k];
            }
        }
        let best = &mut here.not_rows[from..to];
        cheapest_run(best, &here.states[s + 1..], &(from..to), codes, ALONG_COLUMNS);
        cheapest(&mut here.any[from..to], &here.not_columns[from..to], best, codes, BEST_IS_COLUMNS);
        or_diagonal(best, &here.states[0][from..to], codes, BEST_NOT_ROWS);
        self.choices.extend(codes.iter().map(|&code| code as Choice));
        self.last_column.push(here.any[width]);
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
    pub(super) fn any(&self, row: usize, column: usize) -> usize {
        let choice = self.choice(row, column);
        if u64::from(choice) & BEST_IS_COLUMNS != 0 {
            self.along_columns(choice)
        } else if u64::from(choice) & BEST_NOT_COLUMNS != 0 {
            Self::along_rows(choice)
        } else {
            0
        }
    }

    /// The cheapest cell on the last row and the last column, where at most `slack` of the other clip is left out.
    pub(super) fn best_end(&self, slack: f64, (rows, columns): (usize, usize)) -> Option<(usize, usize)> {
        let on_row = self.here.any[1..]
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
    pub(super) fn trace(
        &self,
        mut cell: (usize, usize),
        mut state: usize,
        shared: bool,
        cells: &mut Vec<(usize, usize)>,
    ) -> ((usize, usize), usize) {
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
                let along = if u64::from(choice) & BEST_NOT_ROWS != 0 {
                    self.along_columns(choice)
                } else {
                    0
                };
                ((row - 1, column), if state == 1 { along } else { state - 1 })
            } else {
                let choice = self.choice(row, column - 1);
                let along = if u64::from(choice) & BEST_NOT_COLUMNS != 0 {
                    Self::along_rows(choice)
                } else {
                    0
                };
                ((row, column - 1), if state == s + 1 { along } else { state - 1 })
            };
        }
    }
}

// Every loop is a function of its own, over slices that share nothing: then it takes two cells at a time, without a branch.

#[inline(never)]
fn add(out: &mut [f64], from: &[f64], costs: &[f64], of_step: impl Fn(f64) -> f64) {
    for ((out, from), &cost) in out.iter_mut().zip(from).zip(costs) {
        *out = from + of_step(cost);
    }
}

/// The cheapest of the runs; which of them it is, is noted in the four bits of the codes from `at` on, which are 0.
fn cheapest_run(best: &mut [f64], runs: &[Vec<f64>], span: &Range<usize>, codes: &mut [u64], at: u16) {
    let run = |k: usize| &runs[k][span.clone()];
    if runs.len() == 1 {
        best.copy_from_slice(run(0));
        return;
    }
    cheapest(best, run(0), run(1), codes, 1 << at);
    for k in 2..runs.len() {
        choose(best, run(k), codes, 0xf << at, (k as u64) << at);
    }
}

/// The cheaper of two; where that is the second, `code` is noted.
#[inline(never)]
fn cheapest(best: &mut [f64], first: &[f64], second: &[f64], codes: &mut [u64], code: u64) {
    for (((best, &first), &second), codes) in best.iter_mut().zip(first).zip(second).zip(codes) {
        let better = second < first;
        *best = if better { second } else { first };
        *codes = if better { *codes | code } else { *codes };
    }
}

/// Where `other` is cheaper it is taken, and `code` noted in the bits of `mask`.
#[inline(never)]
fn choose(best: &mut [f64], other: &[f64], codes: &mut [u64], mask: u64, code: u64) {
    for ((best, &other), codes) in best.iter_mut().zip(other).zip(codes) {
        let better = other < *best;
        *best = if better { other } else { *best };
        *codes = if better { *codes & !mask | code } else { *codes };
    }
}

/// Where the best run is cheaper than the diagonal, `code` is noted; else the diagonal is taken: it wins a tie.
#[inline(never)]
fn or_diagonal(best: &mut [f64], diagonal: &[f64], codes: &mut [u64], code: u64) {
    for ((best, &diagonal), codes) in best.iter_mut().zip(diagonal).zip(codes) {
        let along = *best < diagonal;
        *best = if along { *best } else { diagonal };
        *codes = if along { *codes | code } else { *codes };
    }
}
