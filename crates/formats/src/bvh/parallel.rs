//! Rows of plain numbers, read on all cores.
//!
//! Each core reads a part of the rows into a sink of its own. A part ends early at whatever is no
//! plain row; the reader of single rows goes on there. What is read does not depend on the number
//! of parts.

use super::decimal::Lines;
use super::row_sink::RowSink;
use crate::error::Fault;
use crate::text::is_space;
use rayon::prelude::*;
use std::ops::Range;

/// The least size of a part, bytes: reading less takes about as long as handing it out.
const MIN_PART_BYTES: usize = 3 << 18;
/// The greatest size of a part, bytes: progress is reported, and cancelling possible, between rounds
/// of parts.
const MAX_PART_BYTES: usize = 4 << 20;

/// The plain rows of a round of parts.
#[derive(Debug, PartialEq, Eq)]
pub(super) struct PlainRows {
    /// Their number.
    pub(super) rows: usize,
    /// The offset behind the last one.
    pub(super) end: usize,
    /// Whether there was nothing else, so that another round may follow.
    pub(super) is_complete: bool,
}

/// Reads plain rows into `sink`, from the offset `start` on: a part for each core. `row` becomes the
/// values of the last row.
///
/// # Errors
/// The sink's, when it cannot hold the rows.
pub(super) fn plain_rows<S: RowSink + Send>(
    text: &[u8],
    start: usize,
    row: &mut [f64],
    sink: &mut S,
) -> Result<PlainRows, Fault> {
    let most = rayon::current_num_threads();
    plain_rows_in(parts(text, start, most), text, start, row, sink)
}

fn plain_rows_in<S: RowSink + Send>(
    parts: Vec<Range<usize>>,
    text: &[u8],
    start: usize,
    row: &mut [f64],
    sink: &mut S,
) -> Result<PlainRows, Fault> {
    let mut found = PlainRows { rows: 0, end: start, is_complete: false };
    if parts.len() < 2 {
        return Ok(found);
    }
    let tasks: Vec<(Range<usize>, S)> =
        parts.into_iter().map(|part| (part.clone(), sink.for_part(part))).collect();
    let width = row.len();
    let read: Vec<Part<S>> =
        tasks.into_par_iter().map(|(part, sink)| Part::read(text, part, width, sink)).collect();
    for part in read {
        if part.rows > 0 {
            sink.append(part.sink)?;
            row.copy_from_slice(&part.last);
            (found.rows, found.end) = (found.rows + part.rows, part.end);
        }
        found.is_complete = part.is_complete;
        if !found.is_complete {
            break;
        }
    }
    Ok(found)
}

/// Returns up to `most` parts of a text from an offset on, which begin behind line ends.
fn parts(text: &[u8], start: usize, most: usize) -> Vec<Range<usize>> {
    let size = text.len().saturating_sub(start).min(most.saturating_mul(MAX_PART_BYTES));
    let count = (size / MIN_PART_BYTES).min(most);
    let mut parts = Vec::with_capacity(count);
    let mut begin = start;
    for number in 1..=count {
        let rest = text.get(start + size / count * number..).unwrap_or_default();
        let line_end = rest.iter().position(|b| *b == b'\n');
        let end = line_end.map_or(text.len(), |at| text.len() - rest.len() + at + 1);
        if end > begin {
            parts.push(begin..end);
        }
        begin = end;
    }
    parts
}

/// A part that was read.
struct Part<S> {
    sink: S,
    rows: usize,
    /// The values of the last row.
    last: Vec<f64>,
    /// The offset behind the last row.
    end: usize,
    /// Whether there was nothing but plain rows.
    is_complete: bool,
}

impl<S: RowSink> Part<S> {
    fn read(text: &[u8], bytes: Range<usize>, width: usize, mut sink: S) -> Self {
        let (mut row, mut last) = (vec![0.0; width], vec![0.0; width]);
        let mut lines = Lines::default();
        let (mut rows, mut end) = (0, bytes.start);
        loop {
            let rest = text.get(end..bytes.end).unwrap_or_default();
            let blanks = rest.iter().position(|b| !is_space(*b));
            let Some(blanks) = blanks else {
                return Self { sink, rows, last, end, is_complete: true };
            };
            let found = lines.line(text, end + blanks, &mut row);
            let Some(line_end) = found.filter(|at| sink.row(&row, *at).is_ok()) else {
                return Self { sink, rows, last, end, is_complete: false };
            };
            std::mem::swap(&mut row, &mut last);
            (rows, end) = (rows + 1, line_end);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// The rows, and the bytes for which a sink was made.
    #[derive(Debug, Default, PartialEq)]
    struct Kept(Vec<Vec<f64>>);

    impl RowSink for Kept {
        fn row(&mut self, values: &[f64], _end: usize) -> Result<(), Fault> {
            self.0.push(values.to_vec());
            Ok(())
        }

        fn for_part(&self, _bytes: Range<usize>) -> Self {
            Self::default()
        }

        fn append(&mut self, part: Self) -> Result<(), Fault> {
            self.0.extend(part.0);
            Ok(())
        }
    }

    fn at_once(text: &[u8], width: usize) -> Part<Kept> {
        Part::read(text, 0..text.len(), width, Kept::default())
    }

    proptest! {
        #[test]
        fn rows_of_parts_are_those_of_the_whole(
            lines in prop::collection::vec("(-?[0-9]{1,3}\\.[0-9]{1,6} ){3}|1 2 3|1 nan 3|# x||4 5", 1..60),
            cuts in prop::collection::vec(0..60_usize, 0..5),
        ) {
            let text = format!("{}\n", lines.join("\n")).into_bytes();
            let ends: Vec<usize> =
                text.iter().enumerate().filter(|(_, b)| **b == b'\n').map(|(at, _)| at + 1).collect();
            let mut bounds: Vec<usize> = cuts.iter().filter_map(|cut| ends.get(*cut)).copied().collect();
            bounds.extend([0, text.len()]);
            bounds.sort_unstable();
            bounds.dedup();
            let parts: Vec<_> = bounds.windows(2).map(|pair| pair[0]..pair[1]).collect();
            prop_assume!(parts.len() > 1);
            let (mut kept, mut row) = (Kept::default(), [0.0; 3]);
            let found = plain_rows_in(parts, &text, 0, &mut row, &mut kept).unwrap();
            let whole = at_once(&text, 3);
            prop_assert_eq!((found.rows, &kept), (whole.rows, &whole.sink));
            prop_assert_eq!(found.is_complete, whole.is_complete);
            if found.rows > 0 {
                prop_assert_eq!((found.end, row.to_vec()), (whole.end, whole.last));
            }
        }

        #[test]
        fn parts_cover_the_text_and_begin_behind_line_ends(most in 1..9_usize, start in 0..9_usize) {
            let text = b"1.25 -3.5\n".repeat(900_000);
            let found = parts(&text, start, most);
            prop_assert_eq!((found.len(), found[0].start), (most, start));
            let end = found[most - 1].end;
            prop_assert!(end == text.len() || end >= most * MAX_PART_BYTES);
            prop_assert_eq!(text[end - 1], b'\n');
            for pair in found.windows(2) {
                prop_assert_eq!(pair[0].end, pair[1].start);
                prop_assert_eq!(text[pair[1].start - 1], b'\n');
            }
        }
    }

    #[test]
    fn small_texts_are_one_part() {
        assert_eq!(parts(b"1 2\n3 4\n", 0, 8).len(), 0);
        let found = plain_rows(b"1 2\n", 0, &mut [0.0; 2], &mut Kept::default()).unwrap();
        assert_eq!(found, PlainRows { rows: 0, end: 0, is_complete: false });
    }
}
