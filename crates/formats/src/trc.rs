//! TRC: the tables of labelled points of Motion Analysis, which `OpenSim` and others write.
//!
//! Two lines name and give the rate, the numbers of frames and markers, and the unit; the next one
//! names the markers, each above three columns, and one more numbers the columns. Rows hold a frame
//! number, a time, and three numbers for each marker; a gap is an empty cell, or not a number.
//! Cells are separated by tabs, in some files by commas, or by spaces, which leave no room for
//! gaps.
//!
//! The numbers in the header are not relied upon: the names and the rows count.
//!
//! Source: the documentation of `OpenSim`, "Marker (.trc) Files", and files of Cortex, `OptiTrack`,
//! `FiLMBOX` and `OpenSim`.

#[cfg(test)]
mod tests;

use super::bvh::{MEMORY_FLOOR, MEMORY_PER_BYTE};
use super::error::Fault;
use super::labelled::{LabelledPoints, UnitWord};
use super::text::{decode, is_space, name as text_of, quoted};
use super::warning::{Tally, WarningKind};
use super::{ImportError, ImportOptions, ImportedFile, check_size};
use glam::Vec3;
use segue_text::msg;

/// Returns whether the first words of a file are those of a TRC file.
pub(super) fn starts_like_trc(head: &[u8]) -> bool {
    let start = head.iter().position(|b| !is_space(*b)).unwrap_or(head.len());
    head.get(start..start + 12).is_some_and(|word| word.eq_ignore_ascii_case(b"PathFileType"))
}

/// Reads the points of a TRC file: as a body where labels tell its joints, otherwise as they are.
///
/// # Errors
/// [`ImportError`] when no line names markers, or no row holds a point.
pub fn read(
    name: &str,
    bytes: &[u8],
    options: &ImportOptions,
) -> Result<ImportedFile, ImportError> {
    check_size(name, bytes, options)?;
    let text = decode(bytes);
    let mut tally = Tally::default();
    let clips = table(&text, &mut tally)
        .and_then(|points| points.into_clips(name, options, &mut tally))
        .map_err(|fault| fault.locate(name, &text))?;
    Ok(ImportedFile { clips, warnings: tally.into_warnings(&text) })
}

/// The memory that a point in a frame takes, bytes: its position, and a joint's rotation and track.
const BYTES_PER_POINT: u64 = 48;

/// A line, and its offset in the file.
#[derive(Clone, Copy)]
struct Line<'a> {
    at: usize,
    text: &'a [u8],
}

fn lines(text: &[u8]) -> impl Iterator<Item = Line<'_>> {
    let mut at = 0;
    text.split(|b| matches!(b, b'\n' | b'\r')).map(move |line| {
        let start = at;
        at += line.len() + 1;
        Line { at: start, text: line }
    })
}

fn trimmed(cell: &[u8]) -> &[u8] {
    cell.trim_ascii()
}

fn words(line: &[u8]) -> impl Iterator<Item = &[u8]> {
    line.split(|b| is_space(*b)).filter(|word| !word.is_empty())
}

fn number(cell: &[u8]) -> Option<f64> {
    let cell = trimmed(cell);
    let mut buffer = [0; 64];
    // A cell is not divided by commas, so that one is a decimal sign.
    let copy = buffer.get_mut(..cell.len())?;
    copy.copy_from_slice(cell);
    copy.iter_mut().filter(|b| **b == b',').for_each(|b| *b = b'.');
    fast_float2::parse::<f64, _>(&*copy).ok()
}

/// Returns the first cell of a row, whatever separates them.
fn first_cell(line: &[u8]) -> Option<&[u8]> {
    words(line).next().and_then(|word| word.split(|b| *b == b',').next())
}

/// The values of the header by their names.
#[derive(Clone, Copy, Default)]
struct Header {
    rate: Option<f64>,
    frames: Option<f64>,
    unit: Option<f64>,
}

impl Header {
    fn of(names: &[u8], values: &[u8]) -> Self {
        let mut header = Self::default();
        // Where commas separate cells, they are no decimal signs.
        let commas = names.contains(&b',');
        let cells = |line| -> Vec<&[u8]> {
            words(line)
                .flat_map(|word| word.split(move |b| commas && *b == b','))
                .filter(|cell| !cell.is_empty())
                .collect()
        };
        for (name, value) in cells(names).into_iter().zip(cells(values)) {
            let value_of = || number(value).filter(|value| value.is_finite());
            match name.to_ascii_lowercase().as_slice() {
                b"datarate" => header.rate = value_of(),
                b"numframes" => header.frames = value_of(),
                b"units" => header.unit = UnitWord::metres(&text_of(value).0),
                _ => {}
            }
        }
        header
    }
}

fn table(text: &[u8], tally: &mut Tally) -> Result<LabelledPoints, Fault> {
    let starts_with = |line: &Line<'_>, word: &[u8]| {
        trimmed(line.text).get(..word.len()).is_some_and(|head| head.eq_ignore_ascii_case(word))
    };
    let is_blank = |line: &Line<'_>| line.text.iter().all(|b| is_space(*b) || *b == b',');
    let mut lines = lines(text).filter(|line| !is_blank(line)).peekable();
    let mut header = Header::default();
    let names = loop {
        let Some(line) = lines.next() else {
            let fault = Fault::at_token(text.len(), b"", "a line that begins with `Frame#`");
            return Err(fault.with_hint("export the file again: its header is incomplete"));
        };
        if starts_with(&line, b"DataRate") {
            if let Some(values) = lines.peek() {
                header = Header::of(line.text, values.text);
            }
        } else if starts_with(&line, b"Frame#") {
            break line;
        }
    };
    let separator = [b'\t', b','].into_iter().find(|sign| names.text.contains(sign));
    let labels: Vec<String> = if let Some(sign) = separator {
        let cells = names.text.split(|b| *b == sign).skip(2);
        let mut cells: Vec<&[u8]> = cells.map(trimmed).collect();
        // Names stand above the first of three columns; some files leave no room for the others.
        if cells.iter().skip(1).step_by(3).all(|cell| cell.is_empty()) {
            cells = cells.into_iter().step_by(3).collect();
        }
        while cells.last().is_some_and(|cell| cell.is_empty()) {
            cells.pop();
        }
        cells.into_iter().map(|cell| text_of(cell).0).collect()
    } else {
        words(names.text).skip(2).map(|word| text_of(word).0).collect()
    };
    let mut rows = Rows { labels, positions: Vec::new(), frames: 0, times: Vec::new() };
    // Rows may be short: names times rows is no measure of the file.
    let limit = MEMORY_FLOOR.saturating_add(MEMORY_PER_BYTE.saturating_mul(text.len() as u64));
    let mut first = true;
    for line in lines {
        let begins_row = first_cell(line.text).and_then(number).is_some();
        // The line that numbers the columns: X1 Y1 Z1.
        if std::mem::take(&mut first) && !begins_row {
            continue;
        }
        rows.push(line, separator, tally)?;
        if rows.positions.len() as u64 * BYTES_PER_POINT > limit {
            let found = msg!(
                "a motion of more than {mb} MB, most of it in bones without values",
                mb = limit >> 20
            );
            return Err(Fault::new(line.at, found, "a motion that fits into memory")
                .with_hint("cut the motion into parts"));
        }
    }
    rows.finish(text, header, tally)
}

struct Rows {
    labels: Vec<String>,
    positions: Vec<Vec3>,
    frames: usize,
    /// The times of the first rows.
    times: Vec<f64>,
}

impl Rows {
    fn push(
        &mut self,
        line: Line<'_>,
        separator: Option<u8>,
        tally: &mut Tally,
    ) -> Result<(), Fault> {
        let cells: Vec<&[u8]> = match separator.filter(|sign| line.text.contains(sign)) {
            Some(sign) => line.text.split(|b| *b == sign).map(trimmed).collect(),
            None => words(line.text).collect(),
        };
        let Some(frame) = cells.first().copied() else { return Ok(()) };
        if number(frame).is_none() {
            return Err(Fault::at_token(line.at, frame, "the number of a frame"));
        }
        // Columns without a name are counted by the first row.
        if self.frames == 0 {
            let filled = cells.iter().rposition(|cell| !cell.is_empty()).map_or(0, |last| last + 1);
            let named = self.labels.len();
            let columns = filled.saturating_sub(2).div_ceil(3);
            self.labels.extend((named + 1..=columns).map(|number| format!("M{number}")));
        }
        if self.times.len() < 64
            && let Some(time) = cells.get(1).and_then(|cell| number(cell))
        {
            self.times.push(time);
        }
        for marker in 0..self.labels.len() {
            let mut value = |axis: usize| {
                let cell = cells.get(2 + 3 * marker + axis).copied().unwrap_or_default();
                let value = number(cell).filter(|value| value.is_finite() && value.abs() < 1e30);
                if value.is_none() && !cell.is_empty() {
                    let lower = cell.to_ascii_lowercase();
                    if !lower.windows(3).any(|word| word == b"nan") {
                        tally.add(WarningKind::NotNumbers { text: quoted(cell) }, Some(line.at));
                    }
                }
                value.map_or(f32::NAN, |value| value as f32)
            };
            let place = Vec3::new(value(0), value(1), value(2));
            let is_gap = !place.is_finite() || place == Vec3::ZERO;
            self.positions.push(if is_gap { Vec3::NAN } else { place });
        }
        self.frames += 1;
        Ok(())
    }

    fn finish(
        self,
        text: &[u8],
        header: Header,
        tally: &mut Tally,
    ) -> Result<LabelledPoints, Fault> {
        if self.labels.is_empty() || self.frames == 0 {
            let found =
                if self.frames == 0 { "a table without rows" } else { "a table without markers" };
            return Err(Fault::new(
                text.len(),
                found,
                "rows of a frame number, a time, and points",
            ));
        }
        if let Some(declared) = header.frames.filter(|frames| *frames != self.frames as f64) {
            let declared = declared.to_string();
            tally.add(WarningKind::FrameCount { declared, found: self.frames }, None);
        }
        // Some programs write the rate of the cameras; the times of the rows show the true one.
        let by_times = match self.times.as_slice() {
            [first, .., last] if last > first => {
                Some((self.times.len() - 1) as f64 / (last - first))
            }
            _ => None,
        };
        let usable = |rate: &f64| rate.is_finite() && (0.1..=100_000.0).contains(rate);
        Ok(LabelledPoints {
            labels: self.labels,
            positions: self.positions,
            fps: header.rate.filter(usable).or_else(|| by_times.filter(usable)),
            unit: header.unit,
            up: None,
        })
    }
}
