//! Parsing of the rows of the MOTION section: one pass over the bytes, one row in memory.

#[cfg(feature = "parallel")]
use super::convert::FIRST_ROWS;
use super::decimal::{Lines, MAX_MAGNITUDE};
use super::lexer::{Lexer, Stop};
use super::number::{Scan, scan};
use super::row_sink::RowSink;
use crate::error::Fault;
use crate::text::is_space;
use crate::warning::WarningKind;
use segue_text::msg;

/// Bytes between two reports of progress.
const PROGRESS_STEP: usize = 1 << 18;

/// A callback with the number of bytes read so far; it returns `false` to stop.
pub(super) type Progress<'a> = &'a mut dyn FnMut(usize) -> bool;

/// The end of a line of numbers.
enum End {
    /// A line end or the end of the file.
    Line,
    /// The end of the file inside a number.
    Cut,
}

/// Reads all rows into `sink` and returns their number. `first_row` holds the values of channels
/// before any good value.
///
/// A line that holds exactly one row makes lines count: a shorter last row is then dropped and any
/// other wrong row is refused. If no line holds exactly one row, numbers are read one after the
/// other.
pub(super) fn rows(
    lexer: &mut Lexer<'_>,
    first_row: Vec<f64>,
    sink: &mut impl RowSink,
    progress: Progress<'_>,
) -> Result<usize, Stop> {
    let mut reader = Rows {
        not_finite: 0,
        first_not_finite: 0,
        values: 0,
        row: first_row,
        reported: lexer.at,
        lines: Lines::default(),
        #[cfg(feature = "parallel")]
        rounds: super::parallel::Rounds::default(),
        lexer,
    };
    reader.lexer.skip_blank();
    if reader.lexer.at >= reader.lexer.text.len() {
        return Ok(0);
    }
    if reader.row.is_empty() {
        return Err(reader
            .lexer
            .unexpected("the end of the file, since no joint has channels")
            .into());
    }
    let by_line = reader.a_line_is_one_row();
    let count = if by_line {
        reader.by_line(sink, progress)?
    } else {
        reader.across_lines(sink, progress)?
    };
    reader.check_share_of_bad_values()?;
    Ok(count)
}

struct Rows<'l, 'a> {
    lexer: &'l mut Lexer<'a>,
    /// The row being read. It keeps the values of the row before, so that an invalid value repeats
    /// the last good one.
    row: Vec<f64>,
    values: u64,
    not_finite: u64,
    first_not_finite: usize,
    reported: usize,
    lines: Lines,
    #[cfg(feature = "parallel")]
    rounds: super::parallel::Rounds,
}

impl Rows<'_, '_> {
    /// Returns whether any line holds as many numbers as a row has. Usually the first one does.
    fn a_line_is_one_row(&self) -> bool {
        let rest = self.lexer.text.get(self.lexer.at..).unwrap_or_default();
        rest.split(|b| matches!(b, b'\n' | b'\r')).any(|line| count_numbers(line) == self.row.len())
    }

    fn by_line(&mut self, sink: &mut impl RowSink, progress: Progress<'_>) -> Result<usize, Stop> {
        let width = self.row.len();
        let mut count = 0;
        loop {
            #[cfg(feature = "parallel")]
            {
                count += self.rounds(count, sink, progress)?;
            }
            self.lexer.skip_blank();
            let start = self.lexer.at;
            if start >= self.lexer.text.len() {
                return Ok(count);
            }
            self.report(progress)?;
            let mut column = 0;
            let end = if self.plain_line() {
                column = width;
                End::Line
            } else {
                self.numbers(&mut column, width, false)?
            };
            if let (true, End::Line) = (column == width, &end) {
                sink.row(&self.row, self.lexer.at).map_err(|fault| Fault { at: start, ..fault })?;
                count += 1;
                continue;
            }
            self.lexer.skip_blank();
            let is_last = self.lexer.at >= self.lexer.text.len();
            if is_last && column < width {
                self.truncated(start, column);
                return Ok(count);
            }
            let found = if column >= width {
                msg!("a row of more than {width} numbers")
            } else {
                msg!("a row of {column} numbers")
            };
            return Err(Fault::new(start, found, msg!("{width} numbers, one for each channel"))
                .with_hint("complete the row or delete it, then drop the file again")
                .into());
        }
    }

    fn across_lines(
        &mut self,
        sink: &mut impl RowSink,
        progress: Progress<'_>,
    ) -> Result<usize, Stop> {
        let (width, start) = (self.row.len(), self.lexer.at);
        let mut count = 0;
        loop {
            self.lexer.skip_blank();
            let row_start = self.lexer.at;
            self.report(progress)?;
            let mut column = 0;
            let end = self.numbers(&mut column, width, true)?;
            if column == width && matches!(end, End::Line) {
                sink.row(&self.row, self.lexer.at).map_err(|fault| Fault { at: start, ..fault })?;
                count += 1;
                continue;
            }
            if count > 0 {
                self.lexer.tally.add(WarningKind::RowsAcrossLines, Some(start));
            }
            if column > 0 || matches!(end, End::Cut) {
                self.truncated(row_start, column);
            }
            return Ok(count);
        }
    }

    /// Reads plain rows on all cores, as far as that goes, after the `count` rows before. Returns
    /// their number.
    #[cfg(feature = "parallel")]
    fn rounds(
        &mut self,
        count: usize,
        sink: &mut impl RowSink,
        progress: Progress<'_>,
    ) -> Result<usize, Stop> {
        let mut rows = 0;
        // The first rows show how much memory all of them need.
        let mut goes_on = count >= FIRST_ROWS && !self.lexer.commas;
        while goes_on {
            // The line feed of the last row would count as that of another one.
            self.lexer.skip_blank();
            let Self { rounds, lexer, row, .. } = self;
            let Some(found) = rounds.read(lexer.text, lexer.at, row, sink) else { break };
            lexer.at = found.end;
            self.values += (found.rows * self.row.len()) as u64;
            rows += found.rows;
            goes_on = found.is_complete;
            while self.lexer.at - self.reported >= PROGRESS_STEP {
                self.reported += PROGRESS_STEP;
                if !progress(self.reported) {
                    return Err(Stop::Cancelled);
                }
            }
        }
        Ok(rows)
    }

    fn truncated(&mut self, at: usize, found: usize) {
        self.lexer
            .tally
            .add(WarningKind::TruncatedRow { found, expected: self.row.len() }, Some(at));
    }

    fn report(&mut self, progress: Progress<'_>) -> Result<(), Stop> {
        if self.lexer.at - self.reported >= PROGRESS_STEP {
            self.reported = self.lexer.at;
            if !progress(self.lexer.at) {
                return Err(Stop::Cancelled);
            }
        }
        Ok(())
    }

    /// Reads a line that holds one row of plain numbers and nothing else; otherwise changes
    /// nothing, so that the row is still the one before.
    // Not inlined: browsers optimise a function only between calls, and a whole file would be read
    // before its reader is fast.
    #[inline(never)]
    fn plain_line(&mut self) -> bool {
        if self.lexer.commas {
            return false;
        }
        let end = self.lines.line(self.lexer.text, self.lexer.at, &mut self.row);
        if let Some(end) = end {
            self.lexer.at = end;
            self.values += self.row.len() as u64;
        }
        end.is_some()
    }

    /// Reads numbers into the row: up to the end of the line, or, `across_lines`, until the row is
    /// full. Reads at most one number more than a row has.
    #[inline]
    fn numbers(
        &mut self,
        column: &mut usize,
        width: usize,
        across_lines: bool,
    ) -> Result<End, Stop> {
        let text = self.lexer.text;
        let mut at = self.lexer.at;
        while let Some(&b) = text.get(at) {
            match b {
                b'\n' | b'\r' if !across_lines => {
                    self.lexer.at = at;
                    return Ok(End::Line);
                }
                _ if is_space(b) => at += 1,
                _ => {
                    // The common case: a plain number with white space after it.
                    let rest = text.get(at..).unwrap_or_default();
                    match fast_float2::parse_partial::<f64, _>(rest) {
                        Ok((value, length))
                            if !self.lexer.commas
                                && value.abs() <= MAX_MAGNITUDE
                                && rest.get(length).is_none_or(|&next| is_space(next)) =>
                        {
                            at += length;
                            if let Some(slot) = self.row.get_mut(*column) {
                                *slot = value;
                            }
                        }
                        _ => {
                            self.lexer.at = at;
                            match self.odd_number(*column)? {
                                OddNumber::Number(end) => at = end,
                                OddNumber::Comment(end) => {
                                    at = end;
                                    continue;
                                }
                                OddNumber::Cut => {
                                    self.lexer.at = text.len();
                                    return Ok(End::Cut);
                                }
                            }
                        }
                    }
                    self.values += 1;
                    *column += 1;
                    if *column > width || (across_lines && *column == width) {
                        self.lexer.at = at;
                        return Ok(End::Line);
                    }
                }
            }
        }
        self.lexer.at = text.len();
        Ok(End::Line)
    }

    /// Reads anything but a plain number.
    #[cold]
    fn odd_number(&mut self, column: usize) -> Result<OddNumber, Stop> {
        if self.lexer.at_comment() {
            return Ok(OddNumber::Comment(self.lexer.line_end()));
        }
        let start = self.lexer.at;
        let (end, glued) = match scan(self.lexer.text, start, self.lexer.commas) {
            Scan::Value { value, end, glued } => {
                if let Some(slot) = self.row.get_mut(column) {
                    *slot = value;
                }
                (end, glued)
            }
            Scan::NotFinite { end, glued } => {
                if self.not_finite == 0 {
                    self.first_not_finite = start;
                }
                self.not_finite += 1;
                self.lexer.tally.add(WarningKind::NotFinite, Some(start));
                (end, glued)
            }
            Scan::OtherDecimalSign => return Err(self.lexer.other_decimal_sign()),
            Scan::Cut => return Ok(OddNumber::Cut),
            Scan::Bad => return Err(self.lexer.unexpected("a number").into()),
        };
        if glued {
            self.lexer.tally.add(WarningKind::MissingSpaces, Some(end));
        }
        Ok(OddNumber::Number(end))
    }

    /// Refuses a file in which more than 1 % of the values are not numbers.
    fn check_share_of_bad_values(&self) -> Result<(), Stop> {
        if self.not_finite * 100 > self.values {
            let found = msg!(
                "no number in {count} of {values} values",
                count = self.not_finite,
                values = self.values
            );
            let fault = Fault::new(self.first_not_finite, found, "at most 1 % of them");
            return Err(fault
                .with_hint("export the motion again: too much of it is lost to be filled in")
                .into());
        }
        Ok(())
    }
}

/// The result of reading an odd number.
enum OddNumber {
    /// A number up to this offset.
    Number(usize),
    /// A comment up to this offset.
    Comment(usize),
    /// The file ends inside a number.
    Cut,
}

/// Returns the approximate number of numbers on a line: white space and signs inside a token count,
/// their content does not.
fn count_numbers(line: &[u8]) -> usize {
    let mut count = 0;
    let mut before = b' ';
    for (index, &b) in line.iter().enumerate() {
        if is_space(before)
            && (b == b'#' || line.get(index..).is_some_and(|rest| rest.starts_with(b"//")))
        {
            break;
        }
        let sign = matches!(b, b'+' | b'-') && !matches!(before, b'e' | b'E' | b'+' | b'-');
        if !is_space(b) && (is_space(before) || sign) {
            count += 1;
        }
        before = b;
    }
    count
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bvh::row_sink::Kept;

    fn read(text: &str, width: usize) -> Result<(Vec<Vec<f64>>, Vec<String>), Stop> {
        let mut lexer = Lexer::new(text.as_bytes(), false);
        let mut kept = Kept::default();
        let count = rows(&mut lexer, vec![0.0; width], &mut kept, &mut |_| true)?;
        assert_eq!(count, kept.rows.len());
        let warnings =
            lexer.tally.into_warnings(text.as_bytes()).iter().map(ToString::to_string).collect();
        Ok((kept.rows, warnings))
    }

    fn fault(text: &str, width: usize) -> Fault {
        match read(text, width) {
            Err(Stop::Fault(fault)) => fault,
            other => panic!("{other:?}"),
        }
    }

    #[test]
    fn rows_with_a_matching_line_are_read_by_line() {
        let expected = vec![vec![1.0, 2.0], vec![3.0, 4.0]];
        assert_eq!(read("1 2\n3 4\n", 2).unwrap(), (expected.clone(), vec![]));
        assert_eq!(read("\r\n 1\t2 \r\r\n\n# x\n3 4 // y", 2).unwrap(), (expected.clone(), vec![]));
        let (rows, warnings) = read("1 2\n3 4\n5\n\n", 2).unwrap();
        assert_eq!((rows, warnings.len()), (expected.clone(), 1));
        assert_eq!(warnings[0], "the last row holds 1 number instead of 2 (line 3); dropped");
        assert_eq!(
            read("1 2\n3 4\n5 -", 2).unwrap(),
            (expected, vec!["the last row holds 1 number instead of 2 (line 3); dropped".into()])
        );
        assert_eq!((fault("1 2\n3\n5 6", 2).at, fault("1\n3 4", 2).at), (4, 0));
        assert_eq!(fault("1 2\n3 4 5\n", 2).found.to_string(), "a row of more than 2 numbers");
    }

    /// A sink that notes for how many rows of parts it is asked.
    #[cfg(feature = "parallel")]
    #[derive(Default)]
    struct Asked {
        kept: Kept,
        rows: usize,
    }

    #[cfg(feature = "parallel")]
    impl RowSink for Asked {
        type Part<'p> = <Kept as RowSink>::Part<'p>;

        fn row(&mut self, values: &[f64], end: usize) -> Result<(), Fault> {
            self.kept.row(values, end)
        }

        fn parts(&mut self, most: &[usize], end: usize) -> Option<Vec<Self::Part<'_>>> {
            self.rows += most.iter().sum::<usize>();
            self.kept.parts(most, end)
        }

        fn keep(&mut self, parts: &[crate::bvh::row_sink::KeptPart]) {
            self.kept.keep(parts);
        }
    }

    /// Fails when more room is asked for than there are rows: a motion has room for those that the
    /// header declares, and the rest of the file would be read on one core.
    #[cfg(feature = "parallel")]
    #[test]
    fn rows_of_parts_are_as_many_as_the_file_has() {
        if rayon::current_num_threads() < 2 {
            return;
        }
        for line_end in ["\n", "\r\n"] {
            let rows_in_all = 40_000;
            let text = format!("12.25 -3.5{line_end}").repeat(rows_in_all);
            let mut asked = Asked::default();
            let mut lexer = Lexer::new(text.as_bytes(), false);
            assert!(rows(&mut lexer, vec![0.0; 2], &mut asked, &mut |_| true).is_ok());
            assert_eq!(asked.kept.rows.len(), rows_in_all);
            assert_eq!(FIRST_ROWS + asked.rows, rows_in_all);
        }
    }

    #[test]
    fn rows_without_a_matching_line_are_read_across_lines() {
        let expected = vec![vec![1.0, 2.0], vec![3.0, 4.0]];
        let note =
            "no line holds exactly one frame (line 1); the numbers were read one after the other";
        for text in ["1 2 3 4", "1\n2\n3\n4\n", "1\n2 3 4"] {
            assert_eq!(read(text, 2).unwrap(), (expected.clone(), vec![note.to_owned()]), "{text}");
        }
        let (rows, warnings) = read("1 2 3 4 5", 2).unwrap();
        assert_eq!((rows, warnings.len()), (expected, 2));
        let (rows, warnings) = read("1", 2).unwrap();
        assert_eq!(
            (rows.len(), warnings),
            (0, vec!["the last row holds 1 number instead of 2 (line 1); dropped".to_owned()])
        );
    }

    #[test]
    fn rows_with_invalid_values_hold_the_last_good_one() {
        let many = "1 2\n".repeat(100);
        let (rows, warnings) = read(&format!("{many}nan 5\n6 1.#IND\n"), 2).unwrap();
        assert_eq!(rows[100..], [[1.0, 5.0], [6.0, 5.0]]);
        assert_eq!(
            warnings,
            ["2 values without a number (first: line 101); the last good value was held"]
        );
        let refused = fault("1 2\nnan 3\n", 2);
        assert_eq!(
            (refused.at, refused.found.to_string().as_str()),
            (4, "no number in 1 of 4 values")
        );
    }

    #[test]
    fn rows_of_words_are_refused() {
        assert_eq!(fault("1 2\nabc 4\n", 2).found.to_string(), "`abc`");
        assert_eq!(fault("1 2\n3 4\nHIERARCHY", 2).found.to_string(), "`HIERARCHY`");
        assert_eq!(
            fault("1", 0).expected.to_string(),
            "the end of the file, since no joint has channels"
        );
    }

    #[test]
    fn rows_with_missing_spaces_are_split() {
        let (rows, warnings) = read("1-2\n3e-1+4\n", 2).unwrap();
        assert_eq!(rows, [[1.0, -2.0], [0.3, 4.0]]);
        assert_eq!(
            warnings,
            ["2 missing spaces between numbers (first: line 1); split before the sign"]
        );
    }

    #[test]
    fn rows_report_progress_and_stop() {
        let text = "1 2\n".repeat(200_000);
        let mut lexer = Lexer::new(text.as_bytes(), false);
        let mut seen = vec![];
        rows(&mut lexer, vec![0.0; 2], &mut Kept::default(), &mut |done| {
            seen.push(done);
            true
        })
        .unwrap();
        assert_eq!(seen.len(), 3);
        let mut lexer = Lexer::new(text.as_bytes(), false);
        assert_eq!(
            rows(&mut lexer, vec![0.0; 2], &mut Kept::default(), &mut |_| { false }),
            Err(Stop::Cancelled)
        );
    }
}
