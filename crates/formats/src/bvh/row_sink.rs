//! What takes the rows of a file.

use crate::error::Fault;

/// A receiver of complete rows.
pub(super) trait RowSink: Send {
    /// A receiver of the rows of a part, on any core.
    #[cfg(feature = "parallel")]
    type Part<'p>: PartSink
    where
        Self: 'p;

    /// Takes one row, which ends at `end`; an error says why no more rows can be taken.
    fn row(&mut self, values: &[f64], end: usize) -> Result<(), Fault>;

    /// Returns receivers for parts that follow the last row, which ends at `end`: each for so many
    /// rows at most. `None` where there is no room for all of them: rows are then taken one by one.
    #[cfg(feature = "parallel")]
    fn parts(&mut self, most: &[usize], end: usize) -> Option<Vec<Self::Part<'_>>>;

    /// Keeps what the first of these parts have taken, one after the other, and drops the rest.
    #[cfg(feature = "parallel")]
    fn keep(&mut self, parts: &[KeptPart]);
}

/// A receiver of some of the rows that follow each other.
#[cfg(feature = "parallel")]
pub(super) trait PartSink: Send {
    /// Takes one row, or returns `false`, where there is no place for it.
    fn row(&mut self, values: &[f64]) -> bool;
}

/// A part that is kept.
#[cfg(feature = "parallel")]
#[derive(Clone, Copy, Debug)]
pub(super) struct KeptPart {
    /// The number of rows for which there was a place.
    pub(super) most: usize,
    /// The number of rows that it has taken.
    pub(super) rows: usize,
}

/// The rows of a test.
#[cfg(test)]
#[derive(Debug, Default, PartialEq)]
pub(super) struct Kept {
    pub(super) rows: Vec<Vec<f64>>,
    /// The rows of parts.
    #[cfg(feature = "parallel")]
    ahead: Vec<Vec<f64>>,
}

#[cfg(test)]
impl RowSink for Kept {
    #[cfg(feature = "parallel")]
    type Part<'p> = std::slice::IterMut<'p, Vec<f64>>;

    fn row(&mut self, values: &[f64], _end: usize) -> Result<(), Fault> {
        self.rows.push(values.to_vec());
        Ok(())
    }

    #[cfg(feature = "parallel")]
    fn parts(&mut self, most: &[usize], _end: usize) -> Option<Vec<Self::Part<'_>>> {
        self.ahead = vec![Vec::new(); most.iter().sum()];
        let mut left = self.ahead.as_mut_slice();
        let part = |&most: &usize| {
            let (own, rest) = std::mem::take(&mut left).split_at_mut(most);
            left = rest;
            own.iter_mut()
        };
        Some(most.iter().map(part).collect())
    }

    #[cfg(feature = "parallel")]
    fn keep(&mut self, parts: &[KeptPart]) {
        let mut ahead = std::mem::take(&mut self.ahead).into_iter();
        for part in parts {
            self.rows.extend(ahead.by_ref().take(part.rows));
            ahead.by_ref().take(part.most - part.rows).for_each(drop);
        }
    }
}

#[cfg(all(test, feature = "parallel"))]
impl PartSink for std::slice::IterMut<'_, Vec<f64>> {
    fn row(&mut self, values: &[f64]) -> bool {
        self.next().map(|row| *row = values.to_vec()).is_some()
    }
}
