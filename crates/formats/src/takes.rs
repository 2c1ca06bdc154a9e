//! Names of several clips in one file.

use std::collections::BTreeSet;

/// Returns the names in order, each once: where a name was there before, a number follows it.
pub(crate) fn unique_names(names: impl IntoIterator<Item = String>) -> Vec<String> {
    let names: Vec<String> = names.into_iter().collect();
    // A number leads to no name that another clip has.
    let mut taken: BTreeSet<String> = BTreeSet::new();
    let given: BTreeSet<&String> = names.iter().collect();
    let mut unique = Vec::with_capacity(names.len());
    for name in &names {
        let mut own = name.clone();
        let mut number = 2;
        while taken.contains(&own) || (own != *name && given.contains(&own)) {
            own = format!("{name} {number}");
            number += 1;
        }
        taken.insert(own.clone());
        unique.push(own);
    }
    unique
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_that_are_repeated_are_numbered_past_those_that_are_there() {
        let names = ["walk", "run", "walk", "walk 2", "walk", ""].map(str::to_owned);
        assert_eq!(unique_names(names), ["walk", "run", "walk 3", "walk 2", "walk 4", ""]);
    }
}
