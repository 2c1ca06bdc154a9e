//! The receiver of the rows of a file.

use crate::error::Fault;
#[cfg(feature = "parallel")]
use std::ops::Range;

/// A receiver of complete rows.
pub(super) trait RowSink: Sized + Send {
    /// Takes one row, which ends at `end`; an error says why no more rows can be taken.
    fn row(&mut self, values: &[f64], end: usize) -> Result<(), Fault>;

    /// Returns a sink without rows for those that lie in these bytes.
    #[cfg(feature = "parallel")]
    fn for_part(&self, bytes: Range<usize>) -> Self;

    /// Takes the rows of a part; an error says why they cannot be taken.
    #[cfg(feature = "parallel")]
    fn append(&mut self, part: Self) -> Result<(), Fault>;
}
