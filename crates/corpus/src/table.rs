//! The table of a corpus in a page: sorted, filtered, searched and counted.

mod filter;
mod terms;
#[cfg(test)]
mod tests;

pub use filter::{Copies, Filter, Sort};

use crate::columns::{self, Coded, Columns, NOT_NAMED, rounded, stem};
use crate::packed::Texts;
use crate::{CorpusError, Slot, Status};
use serde::Serialize;
use std::cell::OnceCell;
use std::collections::BTreeMap;

/// The greatest number of values of a column that a page lists.
const MAX_VALUES: usize = 500;
/// The share of clips beyond each end of a column's range.
const BEYOND: f64 = 0.01;
/// Digits of a duration and of a frame rate in a cell.
const DIGITS: i32 = 6;

/// The columns that are not metrics: name, label, unit, help.
const TEXTS: [[&str; 4]; 2] = [
    ["name", "Name", "", "The clip's own name, or that of its file."],
    ["path", "File", "", "The path of the file."],
];
/// The columns of few values.
const CHOICES: [[&str; 4]; 4] = [
    ["labels", "Labels", "", "The labels that the corpus was built with."],
    ["format", "Format", "", "The format of the file."],
    ["rig", "Rig", "", "Clips with the same joints have the same digits."],
    ["status", "Status", "", "Whether the clip is on the standard body."],
];
/// The columns of numbers that are exact.
const EXACT: [[&str; 4]; 3] = [
    ["seconds", "Length", "s", "How long the clip lasts, from its first frame to its last."],
    ["frames", "Frames", "", "The number of frames in the file."],
    ["fps", "Frame rate", "fps", "Frames per second in the file."],
];

/// The table of a corpus, made of `columns.bin`.
#[derive(Debug)]
pub struct Table {
    columns: Columns,
    /// Path, name and labels of each place in lower case, by which clips are searched.
    searched: Texts,
    /// Whether a row has copies.
    has_copies: Vec<bool>,
    /// The range of each column of numbers.
    ranges: Vec<[f64; 2]>,
    /// The rank of each row by its name.
    by_name: OnceCell<Vec<u32>>,
}

/// A column of the table.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Column {
    /// The name in filters.
    pub name: String,
    /// The name on screen.
    pub label: String,
    /// The unit, as it is written after a number.
    pub unit: String,
    /// A sentence: its meaning.
    pub help: String,
    /// Its kind.
    pub kind: ColumnKind,
    /// The 1st percentile of numbers.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub min: Option<f64>,
    /// The 99th percentile of numbers.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub max: Option<f64>,
    /// Of choices, the values, the most frequent ones first.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub values: Option<Vec<String>>,
}

/// The kind of a column.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum ColumnKind {
    /// Texts, nearly all of them different.
    Text,
    /// Texts of which there are few.
    Choice,
    /// Numbers.
    Number,
}

/// The cells of a row.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "camelCase")]
pub struct Cells<'a> {
    /// The row.
    pub row: u32,
    /// The digits that are its own, and the number of the clip in its file.
    pub id: String,
    /// Its name.
    pub name: &'a str,
    /// The path of its file.
    pub path: &'a str,
    /// Its labels.
    pub labels: Vec<&'a str>,
    /// The format of the file.
    pub format: &'a str,
    /// Its rig.
    pub rig: Option<&'a str>,
    /// Its duration, seconds.
    pub seconds: Option<f64>,
    /// Its frame rate, frames per second.
    pub fps: Option<f64>,
    /// The number of its frames.
    pub frames: Option<u32>,
    /// Its state.
    pub status: Status,
    /// The reason of its state.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub message: Option<&'a str>,
    /// The row of which it is a copy.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub copy_of: Option<u32>,
    /// Whether it is a mirrored copy.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub is_mirrored: Option<bool>,
    /// Its other numbers.
    pub values: BTreeMap<&'a str, Option<f64>>,
}

/// A column of numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Number {
    Seconds,
    Frames,
    Fps,
    /// The number of the coded column.
    Coded(usize),
}

impl Table {
    /// Reads `columns.bin`.
    ///
    /// # Errors
    /// [`CorpusError`] if these are not the bytes of one.
    pub fn read(bytes: &[u8]) -> Result<Self, CorpusError> {
        let columns = columns::read(bytes)?;
        let mut has_copies = vec![false; columns.row_of.len()];
        for original in columns.originals.iter().flatten() {
            if let Some(has_copies) = has_copies.get_mut(original.row as usize) {
                *has_copies = true;
            }
        }
        let mut table = Self {
            columns,
            searched: Texts::default(),
            has_copies,
            ranges: Vec::new(),
            by_name: OnceCell::new(),
        };
        table.searched = table.searched_texts();
        table.ranges = table.numbers().map(|number| table.range(number)).collect();
        Ok(table)
    }

    /// Returns the number of rows.
    #[must_use]
    pub fn rows(&self) -> usize {
        self.columns.row_of.len()
    }

    /// Returns its columns: texts, choices, then the numbers that any clip has.
    #[must_use]
    pub fn columns(&self) -> Vec<Column> {
        let column = |[name, label, unit, help]: [&str; 4], kind| Column {
            name: name.to_owned(),
            label: label.to_owned(),
            unit: unit.to_owned(),
            help: help.to_owned(),
            kind,
            min: None,
            max: None,
            values: None,
        };
        let texts = TEXTS.map(|row| column(row, ColumnKind::Text));
        let choices = CHOICES.map(|row| Column {
            values: Some(self.values_of(row[0])),
            ..column(row, ColumnKind::Choice)
        });
        let numbers = self.numbers().zip(&self.ranges).map(|(number, [min, max])| Column {
            min: Some(*min),
            max: Some(*max),
            ..column(self.described(number), ColumnKind::Number)
        });
        texts.into_iter().chain(choices).chain(numbers).collect()
    }

    /// Returns what the table shows of a row; `None` if there is no such row.
    #[must_use]
    pub fn cells(&self, row: u32) -> Option<Cells<'_>> {
        let at = row as usize;
        let columns = &self.columns;
        let original = *columns.originals.get(at)?;
        let number = |number| self.number(number, row);
        let coded = columns.coded.iter().enumerate();
        Some(Cells {
            row,
            id: self.id(row),
            name: self.name(row),
            path: self.path(row),
            labels: self.labels(row).collect(),
            format: self.choice("format", row).unwrap_or(""),
            rig: self.choice("rig", row),
            seconds: number(Number::Seconds).map(|secs| rounded(secs, DIGITS)),
            fps: number(Number::Fps).map(|fps| rounded(fps, DIGITS)),
            frames: columns.frames.get(at)?.checked_sub(1),
            status: *columns.states.get(at)?,
            message: self.message(row),
            copy_of: original.map(|original| original.row),
            is_mirrored: original.map(|original| original.is_mirrored),
            values: coded
                .map(|(index, own)| (own.name.as_str(), number(Number::Coded(index))))
                .collect(),
        })
    }

    /// Returns the id of a row: the digits that are its own, and the number of the clip in its
    /// file.
    fn id(&self, row: u32) -> String {
        let (digits, number) = self.columns.ids.parts(row);
        format!("{digits}-{number}")
    }

    /// Returns the row of an id, or of a beginning of one that no other row has. More digits than
    /// the file has are not compared.
    #[must_use]
    pub fn find(&self, id: &str) -> Option<u32> {
        let (digits, number) = match id.split_once('-') {
            Some((digits, number)) => (digits, Some(number.parse::<u32>().ok()?)),
            None => (id, None),
        };
        let digits = digits.to_ascii_lowercase();
        if digits.is_empty() {
            return None;
        }
        let is_it = |row: &u32| {
            let (known, own) = self.columns.ids.parts(*row);
            let is_same = known.starts_with(&digits) || digits.starts_with(&known);
            is_same && number.is_none_or(|number| number == own)
        };
        // Rows are in the order of their digits.
        let first = digits.get(..digits.len().min(columns::DIGITS))?;
        let ends = ["0", "f"].map(|fill| {
            let filled = format!("{first}{}", fill.repeat(columns::DIGITS - first.len()));
            u32::from_str_radix(&filled, 16)
        });
        let [Ok(low), Ok(high)] = ends else { return None };
        let all = &self.columns.ids.digits;
        let (start, end) =
            (all.partition_point(|own| *own < low), all.partition_point(|own| *own <= high));
        let mut found = (start as u32..end as u32).filter(is_it);
        let row = found.next()?;
        found.next().is_none().then_some(row)
    }

    /// Returns the rows of the same motion, without the row itself, by path.
    #[must_use]
    pub fn copies_of(&self, row: u32) -> Vec<u32> {
        let original = |row: u32| match self.columns.originals.get(row as usize) {
            Some(Some(original)) => original.row,
            _ => row,
        };
        let of = original(row);
        let all = self.columns.row_of.iter().copied();
        all.filter(|other| *other != row && original(*other) == of).collect()
    }

    /// Returns the place of each row on the map, x and y from -1 to 1; NaN for a clip without
    /// moments.
    #[must_use]
    pub fn map(&self) -> Vec<f32> {
        self.columns.map.as_flattened().to_vec()
    }

    /// Returns the place of a row's poses in the shards.
    #[must_use]
    pub fn poses(&self, row: u32) -> Option<Slot> {
        self.columns.poses.get(row as usize).copied().flatten()
    }

    /// Returns the place of a row's thumbnail in the shards of thumbnails.
    #[must_use]
    pub fn thumbnail(&self, row: u32) -> Option<Slot> {
        self.columns.thumbnails.get(row as usize).copied().flatten()
    }

    /// Returns the rows in the order of their paths.
    fn by_path(&self) -> &[u32] {
        &self.columns.row_of
    }

    fn place(&self, row: u32) -> usize {
        self.columns.place_of.get(row as usize).map_or(usize::MAX, |place| *place as usize)
    }

    fn path(&self, row: u32) -> &str {
        self.columns.paths.get(self.place(row))
    }

    fn name(&self, row: u32) -> &str {
        match self.columns.named.get(row as usize) {
            Some(&name) if name != NOT_NAMED => self.columns.names.get(name as usize),
            _ => stem(self.path(row)),
        }
    }

    fn labels(&self, row: u32) -> impl Iterator<Item = &str> {
        let set = self.columns.label_sets.get(row as usize);
        let set = set.and_then(|set| self.columns.lists.label_sets.get(*set as usize));
        let labels = set.map_or(&[] as &[u32], Vec::as_slice);
        labels.iter().map(|label| self.columns.lists.labels.get(*label as usize))
    }

    fn message(&self, row: u32) -> Option<&str> {
        let number = *self.columns.messages.get(row as usize)? as usize;
        self.columns.lists.messages.get(number.checked_sub(1)?).map(String::as_str)
    }

    /// Returns the one value of a row in a column of choices.
    fn choice(&self, column: &str, row: u32) -> Option<&str> {
        let (at, lists) = (row as usize, &self.columns.lists);
        match column {
            "format" => {
                let number = *self.columns.formats.get(at)? as usize;
                lists.formats.get(number).map(String::as_str)
            }
            "rig" => {
                let number = *self.columns.rigs.get(at)? as usize;
                lists.rigs.get(number.checked_sub(1)?).map(String::as_str)
            }
            "status" => self.columns.states.get(at).copied().map(Status::name),
            _ => None,
        }
    }

    /// Returns the values of a column of choices, the most frequent ones first.
    fn values_of(&self, column: &str) -> Vec<String> {
        let mut counts: BTreeMap<&str, usize> = BTreeMap::new();
        for row in 0..self.rows() as u32 {
            if column == "labels" {
                self.labels(row).for_each(|label| *counts.entry(label).or_default() += 1);
            } else if let Some(value) = self.choice(column, row) {
                *counts.entry(value).or_default() += 1;
            }
        }
        let mut counts: Vec<(&str, usize)> = counts.into_iter().collect();
        counts.sort_by(|a, b| b.1.cmp(&a.1).then(a.0.cmp(b.0)));
        counts.truncate(MAX_VALUES);
        counts.into_iter().map(|(value, _)| value.to_owned()).collect()
    }

    fn numbers(&self) -> impl Iterator<Item = Number> + use<> {
        let coded = (0..self.columns.coded.len()).map(Number::Coded);
        [Number::Seconds, Number::Frames, Number::Fps].into_iter().chain(coded)
    }

    fn described(&self, number: Number) -> [&str; 4] {
        match number {
            Number::Seconds => EXACT[0],
            Number::Frames => EXACT[1],
            Number::Fps => EXACT[2],
            Number::Coded(index) => self
                .columns
                .coded
                .get(index)
                .map_or([""; 4], |own| [own.name.as_str(), &own.label, &own.unit, &own.help]),
        }
    }

    fn number(&self, number: Number, row: u32) -> Option<f64> {
        let (at, columns) = (row as usize, &self.columns);
        let rate = || columns.rates.get(at).copied();
        match number {
            Number::Seconds => columns.lists.secs(*columns.frames.get(at)?, rate()?),
            Number::Frames => Some(f64::from(columns.frames.get(at)?.checked_sub(1)?)),
            Number::Fps => columns.lists.rate(rate()?),
            Number::Coded(index) => {
                let coded = columns.coded.get(index)?;
                coded.values.get(usize::from(*coded.codes.get(at)?)).copied().flatten()
            }
        }
    }

    /// Returns the values that few clips are below and above.
    fn range(&self, number: Number) -> [f64; 2] {
        let range = |count: usize, nth: &mut dyn FnMut(usize) -> f64| {
            let Some(last) = count.checked_sub(1) else { return [0.0; 2] };
            let beyond = (last as f64 * BEYOND) as usize;
            [beyond, last - beyond].map(|at| rounded(nth(at), DIGITS))
        };
        if let Number::Coded(index) = number {
            // Few levels are counted in less time than all values are ordered.
            let levels = self.columns.coded.get(index).map(Coded::levels).unwrap_or_default();
            let count = levels.iter().map(|(_, count)| count).sum();
            return range(count, &mut |at| nth_value(&levels, at));
        }
        let all = (0..self.rows() as u32).filter_map(|row| self.number(number, row));
        let mut values: Vec<f64> = all.collect();
        range(values.len(), &mut |at| *values.select_nth_unstable_by(at, f64::total_cmp).1)
    }

    /// Returns path, name and labels of each place in lower case.
    fn searched_texts(&self) -> Texts {
        let mut texts = Texts::default();
        let mut text = String::new();
        for &row in self.by_path() {
            text.clear();
            text.push_str(self.path(row));
            // Lines keep them apart: no word is found across two of them.
            for own in std::iter::once(self.name(row)).chain(self.labels(row)) {
                text.push('\n');
                text.push_str(own);
            }
            texts.push(&text.to_lowercase());
        }
        texts
    }
}

/// Returns a value by its place in ascending order, where each level stands for so many values.
fn nth_value(levels: &[(f64, usize)], at: usize) -> f64 {
    let mut before = 0;
    let level = levels.iter().find(|(_, count)| {
        before += count;
        before > at
    });
    level.map_or(0.0, |(value, _)| *value)
}
