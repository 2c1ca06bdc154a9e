//! Rows of plain numbers, read on all cores.
//!
//! In each round, the cores read parts of the text into the places where their rows belong. A part
//! ends early at whatever is no plain row; the reader of single rows goes on there. So the same
//! rows come of any number of parts, and rounds need no memory beside the motion.

use super::decimal::Lines;
use super::row_sink::{KeptPart, PartSink, RowSink};
use crate::text::is_space;
use memchr::{memchr, memchr_iter};
use rayon::prelude::*;
use std::ops::Range;

/// The least size of a part, bytes: reading less takes about as long as handing it out.
const MIN_PART_BYTES: usize = 1 << 16;
/// The greatest size of a part, bytes: between rounds, progress is reported and reading stopped.
const MAX_PART_BYTES: usize = 1 << 20;
/// The number of parts for each core: one that is disturbed leaves a part to the others.
const PARTS_PER_CORE: usize = 4;

/// The plain rows of a round.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct PlainRows {
    /// Their number.
    pub(super) rows: usize,
    /// The offset behind the last one.
    pub(super) end: usize,
    /// Whether there was nothing else, so that another round may follow.
    pub(super) is_complete: bool,
}

/// A reader of rounds.
#[derive(Debug, Default)]
pub(super) struct Rounds {
    /// The offset from which on the next round may begin. Where a round met what is no plain row,
    /// all of its text is left to the reader of single rows: odd rows are seldom alone.
    next: usize,
    parts: Vec<PartReader>,
}

/// The buffers of a part.
#[derive(Debug, Default)]
struct PartReader {
    lines: Lines,
    /// The row that is read.
    row: Vec<f64>,
    /// The last complete row.
    last: Vec<f64>,
}

impl Rounds {
    /// Reads plain rows into `sink`, from the offset `start` on: a few parts for each core. `row`
    /// becomes the values of the last row. Returns `None` where rows are to be read one by one.
    pub(super) fn read<S: RowSink>(
        &mut self,
        text: &[u8],
        start: usize,
        row: &mut [f64],
        sink: &mut S,
    ) -> Option<PlainRows> {
        // On a thread of the pool, this file is one of many, and the other cores read those.
        if start < self.next || rayon::current_thread_index().is_some() {
            return None;
        }
        let most = rayon::current_num_threads();
        let parts = if most > 1 { parts(text, start, PARTS_PER_CORE * most) } else { Vec::new() };
        if parts.len() < 2 {
            self.next = usize::MAX;
            return None;
        }
        // Within one call of the pool, because each call wakes its threads.
        rayon::scope(|_| self.read_parts(parts, text, start, row, sink))
    }

    fn read_parts<S: RowSink>(
        &mut self,
        parts: Vec<Range<usize>>,
        text: &[u8],
        start: usize,
        row: &mut [f64],
        sink: &mut S,
    ) -> Option<PlainRows> {
        let end = parts.last()?.end;
        // Each row ends in a line feed, if anything here is as usual.
        let line_feeds = |part: &Range<usize>| {
            memchr_iter(b'\n', text.get(part.clone()).unwrap_or_default()).count()
        };
        let most: Vec<usize> = parts.par_iter().map(line_feeds).collect();
        let Some(sinks) = sink.parts(&most, start) else {
            self.next = parts.first().map_or(end, |part| part.end);
            return None;
        };
        self.parts.resize_with(parts.len().max(self.parts.len()), PartReader::default);
        let width = row.len();
        let tasks: Vec<_> = self.parts.iter_mut().zip(parts).zip(sinks).collect();
        let read: Vec<PlainRows> = tasks
            .into_par_iter()
            .map(|((reader, part), mut sink)| reader.read(text, part, width, &mut sink))
            .collect();

        let mut found = PlainRows { rows: 0, end: start, is_complete: true };
        let mut kept = Vec::with_capacity(read.len());
        for ((part, most), reader) in read.into_iter().zip(most).zip(&self.parts) {
            kept.push(KeptPart { most, rows: part.rows });
            if part.rows > 0 {
                row.copy_from_slice(&reader.last);
                found.rows += part.rows;
                found.end = part.end;
            }
            if !part.is_complete {
                found.is_complete = false;
                self.next = end;
                break;
            }
        }
        sink.keep(&kept);
        if found.rows == 0 {
            // Blank lines, perhaps up to the end.
            found.is_complete = false;
            self.next = end;
        }
        Some(found)
    }
}

impl PartReader {
    fn read(
        &mut self,
        text: &[u8],
        bytes: Range<usize>,
        width: usize,
        sink: &mut impl PartSink,
    ) -> PlainRows {
        let Self { lines, row, last } = self;
        row.resize(width, 0.0);
        last.resize(width, 0.0);
        let mut found = PlainRows { rows: 0, end: bytes.start, is_complete: false };
        loop {
            let rest = text.get(found.end..bytes.end).unwrap_or_default();
            let Some(blanks) = rest.iter().position(|b| !is_space(*b)) else {
                return PlainRows { is_complete: true, ..found };
            };
            let Some(end) = lines.line(text, found.end + blanks, row) else {
                return found;
            };
            if !sink.row(row) {
                return found;
            }
            std::mem::swap(row, last);
            found.rows += 1;
            found.end = end;
        }
    }
}

/// Returns up to `most` parts of a text from an offset on, which end behind line feeds or with the
/// text.
fn parts(text: &[u8], start: usize, most: usize) -> Vec<Range<usize>> {
    let size = text.len().saturating_sub(start);
    let count = (size / MIN_PART_BYTES).min(most);
    let mut parts = Vec::with_capacity(count);
    if count == 0 {
        return parts;
    }
    let size = (size / count).min(MAX_PART_BYTES);
    let mut begin = start;
    // Each part is longer than `size`, so that all of them reach the end where none is the longest.
    while parts.len() < count && begin < text.len() {
        let rest = text.get(begin + size..).unwrap_or_default();
        let end = memchr(b'\n', rest).map_or(text.len(), |at| begin + size + at + 1);
        parts.push(begin..end);
        begin = end;
    }
    parts
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bvh::row_sink::Kept;
    use proptest::prelude::*;

    /// Reads rows one after the other.
    fn at_once(text: &[u8]) -> (Kept, PlainRows, Vec<f64>) {
        let (mut kept, mut lines, mut row) = (Kept::default(), Lines::default(), vec![0.0; 3]);
        let mut found = PlainRows { rows: 0, end: 0, is_complete: true };
        let mut last = row.clone();
        while let Some(blanks) = text[found.end..].iter().position(|b| !is_space(*b)) {
            let Some(end) = lines.line(text, found.end + blanks, &mut row) else {
                found.is_complete = false;
                break;
            };
            kept.row(&row, end).unwrap();
            last.clone_from(&row);
            (found.rows, found.end) = (found.rows + 1, end);
        }
        (kept, found, last)
    }

    proptest! {
        #[test]
        fn rows_of_parts_are_those_of_the_whole(
            lines in prop::collection::vec(
                "((-?[0-9]{1,3}\\.[0-9]{1,6} ){3}|1 2 3|){1,3}\r?|1 nan 3|# x|4 5|1 2 3\r4 5 6",
                1..60,
            ),
            plain in prop::collection::vec("(-?[0-9]{1,3}\\.[0-9]{1,6} ){3}", 1..60),
            is_plain: bool,
            cuts in prop::collection::vec(0..60_usize, 0..5),
        ) {
            let lines = if is_plain { plain } else { lines };
            // Numbers at the very end may be left to the reader of single rows.
            let text = format!("{}\n{}", lines.join("\n"), "\n".repeat(16)).into_bytes();
            let ends: Vec<usize> = memchr_iter(b'\n', &text).map(|at| at + 1).collect();
            let mut bounds: Vec<usize> =
                cuts.iter().filter_map(|cut| ends.get(*cut)).copied().collect();
            bounds.extend([0, text.len()]);
            bounds.sort_unstable();
            bounds.dedup();
            let parts: Vec<_> = bounds.windows(2).map(|pair| pair[0]..pair[1]).collect();
            prop_assume!(parts.len() > 1);
            let (mut kept, mut row) = (Kept::default(), [0.0; 3]);
            let mut rounds = Rounds::default();
            let found = rounds.read_parts(parts, &text, 0, &mut row, &mut kept).unwrap();
            let (whole, expected, last) = at_once(&text);
            // More rows than lines: the rest of them is left to the reader of single rows.
            let is_short = found.rows < expected.rows && memchr(b'\r', &text).is_some();
            prop_assert!(found.rows == expected.rows || is_short, "{found:?} {expected:?}");
            prop_assert_eq!(&kept.rows[..], &whole.rows[..found.rows]);
            prop_assert!(!found.is_complete || expected.is_complete);
            prop_assert_eq!(rounds.next, if found.is_complete { 0 } else { text.len() });
            if found.rows == expected.rows && found.rows > 0 {
                prop_assert_eq!((found.end, row.to_vec()), (expected.end, last));
            }
        }

        #[test]
        fn parts_cover_the_text_and_end_behind_line_feeds(most in 1..9_usize, start in 0..9_usize) {
            let text: Vec<u8> = b"1.25 -3.5\n".iter().copied().cycle().take(300_000).collect();
            let found = parts(&text, start, most);
            prop_assert_eq!(found.len(), most.min(4));
            prop_assert_eq!((found[0].start, found[found.len() - 1].end), (start, text.len()));
            for pair in found.windows(2) {
                prop_assert_eq!(pair[0].end, pair[1].start);
                prop_assert_eq!(text[pair[1].start - 1], b'\n');
            }
        }
    }

    #[test]
    fn parts_of_small_texts_and_of_one_line_are_none() {
        assert_eq!(parts(b"1 2\n3 4\n", 0, 8).len(), 0);
        assert_eq!(parts(&b"1 2 ".repeat(100_000), 0, 8), vec![0..400_000]);
        let mut rounds = Rounds::default();
        let found = rounds.read(b"1 2\n", 0, &mut [0.0; 2], &mut Kept::default());
        assert_eq!((found, rounds.next), (None, usize::MAX));
    }

    #[test]
    fn parts_of_a_large_text_are_bounded() {
        let text = b"1.25 -3.5\n".repeat(1_000_000);
        let found = parts(&text, 0, 4);
        assert_eq!(found.len(), 4);
        assert!(found.iter().all(|part| part.len() < MAX_PART_BYTES + 10), "{found:?}");
    }
}
