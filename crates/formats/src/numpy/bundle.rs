//! Named arrays: the content of a `.npz` file, of a pickled dictionary, or of a `.npy` file.

use super::array::{Array, shape_text};
use segue_text::{Message, msg};

/// The greatest number of arrays that an error lists.
const MAX_LISTED: usize = 8;

/// Named arrays.
#[derive(Clone, Debug, Default)]
pub(super) struct Bundle<'a> {
    arrays: Vec<(String, Array<'a>)>,
}

impl<'a> Bundle<'a> {
    pub(super) fn new(arrays: Vec<(String, Array<'a>)>) -> Self {
        Self { arrays }
    }

    /// Returns the first array that has one of the names, in the order of the names.
    pub(super) fn first(&self, names: &[&str]) -> Option<&Array<'a>> {
        names.iter().find_map(|name| self.get(name))
    }

    pub(super) fn get(&self, name: &str) -> Option<&Array<'a>> {
        self.arrays.iter().find(|(own, _)| own == name).map(|(_, array)| array)
    }

    /// Returns the first of the numbers with one of the names.
    pub(super) fn number(&self, names: &[&str]) -> Option<f64> {
        names.iter().find_map(|name| self.get(name)?.single()).filter(|value| value.is_finite())
    }

    pub(super) fn arrays(&self) -> impl Iterator<Item = (&str, &Array<'a>)> {
        self.arrays.iter().map(|(name, array)| (name.as_str(), array))
    }

    /// Returns names and shapes for an error.
    pub(super) fn description(&self) -> Message {
        let listed = self.arrays.iter().take(MAX_LISTED).map(|(name, array)| {
            let name = crate::text::short(name.as_bytes());
            format!("{name} {}", shape_text(array.shape())).trim().to_owned()
        });
        let listed: Vec<String> = listed.collect();
        match (listed.len(), self.arrays.len() - listed.len()) {
            (0, _) => "no arrays".into(),
            (_, 0) => msg!("the arrays {names}", names = listed),
            (_, more) => msg!("the arrays {names} and {more} more", names = listed, more),
        }
    }
}
