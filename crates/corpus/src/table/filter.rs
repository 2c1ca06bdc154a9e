//! Filters and sorting of rows.

use super::terms::Terms;
use super::{CHOICES, Number, Table};
use crate::CorpusError;
use crate::packed::Texts;
use serde::Deserialize;
use std::cmp::Ordering;
use std::collections::{BTreeMap, BTreeSet};

/// The greatest number of bins of a histogram.
const MAX_BINS: usize = 4_096;

/// A choice of rows. An empty one chooses all.
#[derive(Clone, Debug, Default, PartialEq, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Filter {
    /// Words that path, name or labels have; `-` before one that they do not have, quotation marks
    /// around those that belong together.
    pub text: String,
    /// The least and the greatest value of columns of numbers; both belong to it.
    pub ranges: BTreeMap<String, (Option<f64>, Option<f64>)>,
    /// The values of columns of choices; all where the list is empty.
    pub choices: BTreeMap<String, Vec<String>>,
    /// The way in which copies are chosen.
    pub copies: Copies,
    /// Only these rows, in this order unless `sort` is set.
    pub near: Option<Vec<u32>>,
    /// The order; that of the paths where it is not given.
    pub sort: Option<Sort>,
}

/// The way in which copies are chosen.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Copies {
    /// They are chosen as other clips are.
    #[default]
    All,
    /// Of clips that are copies of each other, one is chosen.
    Hide,
    /// Clips are chosen that are copies or have copies.
    Only,
}

/// An order of rows. Those without a value are last.
#[derive(Clone, Debug, PartialEq, Eq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Sort {
    /// The column.
    pub by: String,
    /// Whether the greatest value comes first.
    #[serde(default)]
    pub down: bool,
}

/// A filter with its columns looked up.
struct Test<'a> {
    terms: Terms,
    ranges: Vec<(Number, Option<f64>, Option<f64>)>,
    choices: Vec<(&'a str, BTreeSet<&'a str>)>,
    copies: Copies,
}

impl Table {
    /// Returns the rows of a filter, in its order.
    ///
    /// # Errors
    /// [`CorpusError::NoColumn`] if a column that it names is none, or another kind of column.
    pub fn select(&self, filter: &Filter) -> Result<Vec<u32>, CorpusError> {
        let mut rows = self.selected(filter, None)?;
        if let Some(sort) = &filter.sort {
            self.sort(&mut rows, sort)?;
        }
        Ok(rows)
    }

    /// Returns how many of the rows of a filter have which value of a column, whatever the filter
    /// asks of that column. Of numbers: `bins` parts of the column's range, of equal width, where
    /// the first and the last also count what lies beyond. Of choices: the values of
    /// [`columns`](Self::columns), in their order.
    ///
    /// # Errors
    /// [`CorpusError::NoColumn`] as [`select`](Self::select), and for a column of texts.
    pub fn histogram(
        &self,
        column: &str,
        filter: &Filter,
        bins: usize,
    ) -> Result<Vec<u32>, CorpusError> {
        let rows = self.selected(filter, Some(column))?;
        if CHOICES.iter().any(|row| row[0] == column) {
            let values = self.values_of(column);
            let places: BTreeMap<&str, usize> =
                values.iter().enumerate().map(|(place, value)| (value.as_str(), place)).collect();
            let mut counts = vec![0; values.len()];
            for row in rows {
                self.each_choice(column, row, |value| {
                    if let Some(&place) = places.get(value) {
                        counts[place] += 1;
                    }
                });
            }
            return Ok(counts);
        }
        let number = self.number_of(column)?;
        let range = self.numbers().position(|own| own == number);
        let [low, high] = range.and_then(|at| self.ranges.get(at)).copied().unwrap_or_default();
        let bins = bins.clamp(1, MAX_BINS);
        let mut counts = vec![0; bins];
        for value in rows.into_iter().filter_map(|row| self.spread_number(number, row)) {
            let share = if high > low { (value - low) / (high - low) } else { 0.0 };
            counts[((share * bins as f64).max(0.0) as usize).min(bins - 1)] += 1;
        }
        Ok(counts)
    }

    /// Returns a number of a row, somewhere between the middles to its neighbours where it is one
    /// of few levels: bins that are narrower than a level would be empty otherwise.
    fn spread_number(&self, number: Number, row: u32) -> Option<f64> {
        let value = self.number(number, row)?;
        let Number::Coded(index) = number else { return Some(value) };
        let coded = self.columns.coded.get(index)?;
        let code = usize::from(*coded.codes.get(row as usize)?);
        let level = |code: usize| coded.values.get(code).copied().flatten();
        let neighbours = code.checked_sub(1).and_then(level).zip(level(code + 1));
        // 0 is exact, and the levels at both ends have a neighbour on one side alone.
        let Some((below, above)) = neighbours.filter(|_| value != 0.0) else { return Some(value) };
        // Dithering by multiples of the golden ratio is even, and the same each time.
        let share = (f64::from(row) * 0.618_033_988_749_895).fract();
        Some(0.5 * (below + value + share * (above - below)))
    }

    /// Returns the rows of a filter; one column may be left out.
    fn selected(&self, filter: &Filter, without: Option<&str>) -> Result<Vec<u32>, CorpusError> {
        let test = self.test(filter, without)?;
        let fits = |row: &u32| self.fits(&test, *row);
        Ok(match &filter.near {
            Some(near) => near.iter().copied().filter(fits).collect(),
            None => self.by_path().iter().copied().filter(fits).collect(),
        })
    }

    fn test<'a>(&self, filter: &'a Filter, without: Option<&str>) -> Result<Test<'a>, CorpusError> {
        let mut test = Test {
            terms: Terms::read(&filter.text),
            ranges: Vec::new(),
            choices: Vec::new(),
            copies: filter.copies,
        };
        for (name, (least, most)) in &filter.ranges {
            let number = self.number_of(name)?;
            if without != Some(name.as_str()) && (least.is_some() || most.is_some()) {
                test.ranges.push((number, *least, *most));
            }
        }
        for (name, values) in &filter.choices {
            if !CHOICES.iter().any(|row| row[0] == name) {
                return Err(CorpusError::NoColumn(name.clone()));
            }
            if without != Some(name.as_str()) && !values.is_empty() {
                test.choices.push((name.as_str(), values.iter().map(String::as_str).collect()));
            }
        }
        Ok(test)
    }

    fn fits(&self, test: &Test<'_>, row: u32) -> bool {
        let Some(original) = self.columns.originals.get(row as usize) else { return false };
        let has_copies = || self.has_copies.get(row as usize).copied().unwrap_or(false);
        let by_copies = match test.copies {
            Copies::All => true,
            Copies::Hide => original.is_none(),
            Copies::Only => original.is_some() || has_copies(),
        };
        let in_range = |(number, least, most): &(Number, Option<f64>, Option<f64>)| {
            self.number(*number, row).is_some_and(|value| {
                least.is_none_or(|least| value >= least) && most.is_none_or(|most| value <= most)
            })
        };
        let is_chosen = |(column, values): &(&str, BTreeSet<&str>)| {
            let mut is_chosen = false;
            self.each_choice(column, row, |value| is_chosen |= values.contains(value));
            is_chosen
        };
        by_copies
            && test.ranges.iter().all(in_range)
            && test.choices.iter().all(is_chosen)
            && (test.terms.is_empty() || test.terms.fit(self.searched.get(self.place(row))))
    }

    fn each_choice(&self, column: &str, row: u32, mut visit: impl FnMut(&str)) {
        if column == "labels" {
            self.labels(row).for_each(visit);
        } else if let Some(value) = self.choice(column, row) {
            visit(value);
        }
    }

    fn number_of(&self, name: &str) -> Result<Number, CorpusError> {
        let mut numbers = self.numbers();
        let found = numbers.find(|number| self.described(*number)[0] == name);
        found.ok_or_else(|| CorpusError::NoColumn(name.to_owned()))
    }

    /// Sorts rows; those that are equal keep their order.
    fn sort(&self, rows: &mut [u32], sort: &Sort) -> Result<(), CorpusError> {
        let columns = &self.columns;
        let rank = |rank: Option<u32>| rank.map(f64::from);
        // Lists are sorted, so that their numbers are ranks. Numbers of what may be missing begin
        // with 1.
        let listed = |numbers: &[u32], row: u32| {
            rank(numbers.get(row as usize).copied().filter(|number| *number > 0))
        };
        let key: Box<dyn Fn(u32) -> Option<f64> + '_> = match sort.by.as_str() {
            "id" => Box::new(|row| rank(Some(row))),
            "path" => Box::new(|row| rank(columns.place_of.get(row as usize).copied())),
            "name" => {
                let ranks = self.by_name.get_or_init(|| self.name_ranks());
                Box::new(move |row| rank(ranks.get(row as usize).copied()))
            }
            "labels" => Box::new(move |row| listed(&columns.label_sets, row)),
            "rig" => Box::new(move |row| listed(&columns.rigs, row)),
            "format" => Box::new(|row| rank(columns.formats.get(row as usize).copied())),
            "status" => {
                Box::new(|row| columns.states.get(row as usize).map(|own| f64::from(*own as u8)))
            }
            name => {
                let number = self.number_of(name)?;
                Box::new(move |row| self.number(number, row))
            }
        };
        let mut keyed: Vec<(Option<f64>, u32)> = rows.iter().map(|row| (key(*row), *row)).collect();
        keyed.sort_by(|(a, _), (b, _)| match (a, b) {
            (Some(a), Some(b)) if sort.down => b.total_cmp(a),
            (Some(a), Some(b)) => a.total_cmp(b),
            (Some(_), None) => Ordering::Less,
            (None, Some(_)) => Ordering::Greater,
            (None, None) => Ordering::Equal,
        });
        for (row, (_, own)) in rows.iter_mut().zip(keyed) {
            *row = own;
        }
        Ok(())
    }

    /// Returns the rank of each row by its name in lower case.
    fn name_ranks(&self) -> Vec<u32> {
        let mut names = Texts::default();
        self.by_path().iter().for_each(|row| names.push(&self.name(*row).to_lowercase()));
        let named = self.by_path().iter().enumerate().map(|(at, row)| (names.get(at), *row));
        let mut rows: Vec<(&str, u32)> = named.collect();
        rows.sort_by_key(|(name, _)| *name);
        let mut ranks = vec![0; rows.len()];
        let mut rank = 0;
        let mut before = rows.first().map_or("", |(name, _)| name);
        for (name, row) in &rows {
            // Equal names have one rank, so that the order of paths remains among them.
            if *name != before {
                rank += 1;
                before = name;
            }
            ranks[*row as usize] = rank;
        }
        ranks
    }
}
