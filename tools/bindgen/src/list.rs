//! The list of what the first frames do without, `web/rest.txt`.

use std::convert::Infallible;
use std::str::FromStr;

/// Lines that name functions by a part of their full names: of a path, as in
/// `segue_motion::matching`, or of a method, as in `Session>::route`. A line after `+` keeps what
/// it names in the first part of the module.
pub(crate) struct List {
    rest: Vec<String>,
    kept: Vec<String>,
}

impl FromStr for List {
    type Err = Infallible;

    fn from_str(text: &str) -> Result<Self, Infallible> {
        let lines = text.lines().map(str::trim);
        let lines = lines.filter(|line| !line.is_empty() && !line.starts_with('#'));
        let (kept, rest): (Vec<&str>, Vec<&str>) = lines.partition(|line| line.starts_with('+'));
        Ok(Self {
            rest: rest.into_iter().map(str::to_owned).collect(),
            kept: kept.into_iter().map(|line| line[1..].trim_start().to_owned()).collect(),
        })
    }
}

impl List {
    /// Returns whether a function with this name, as rustc writes it, is in the rest.
    pub(crate) fn has(&self, name: &str) -> bool {
        let name = without_hashes(name);
        let names = |lines: &[String]| lines.iter().any(|line| contains(&name, line));
        names(&self.rest) && !names(&self.kept)
    }
}

/// Returns whether a name contains words that do not go on before or behind them.
fn contains(name: &str, words: &str) -> bool {
    let is_of_word = |character: char| character.is_alphanumeric() || character == '_';
    name.match_indices(words).any(|(start, _)| {
        let before = name[..start].chars().next_back();
        let after = name[start + words.len()..].chars().next();
        let begins = words.starts_with(is_of_word);
        let goes_on = after.is_some_and(is_of_word)
            || begins && before.is_some_and(|before| is_of_word(before) || before == ':');
        !goes_on
    })
}

/// Takes the hashes of crates out of a name: `core[c5930c85a12de822]::fmt` becomes `core::fmt`.
fn without_hashes(name: &str) -> String {
    const DIGITS: std::ops::RangeInclusive<usize> = 12..=16;
    let mut plain = String::new();
    let mut rest = name;
    while let Some(start) = rest.find('[') {
        let inside = &rest[start + 1..];
        let digits = inside.bytes().take_while(u8::is_ascii_hexdigit).count();
        let is_hash = DIGITS.contains(&digits) && inside[digits..].starts_with(']');
        plain.push_str(&rest[..start]);
        if is_hash {
            rest = &inside[digits + 1..];
        } else {
            plain.push('[');
            rest = inside;
        }
    }
    plain + rest
}

#[cfg(test)]
mod tests {
    use super::*;

    fn list(text: &str) -> List {
        text.parse().unwrap_or_else(|never| match never {})
    }

    #[test]
    fn list_names_paths_as_a_whole() {
        let list = list("# a comment\n\n  motion::path \n");
        assert!(list.has("motion[a054cf14d576f129]::path::fit"));
        assert!(list.has(
            "<motion[a054cf14d576f129]::path::Fit as core[c5930c85a12de822]::fmt::Debug>::fmt"
        ));
        assert!(
            list.has("<alloc[3ca501edff3f0c7c]::vec::Vec<motion[a054cf14d576f129]::path>>::push")
        );
        assert!(!list.has("motion::paths::fit"));
        assert!(!list.has("locomotion::path::fit"));
        assert!(!list.has("app::motion::path::fit"));
        assert!(!list.has("a comment"));
    }

    #[test]
    fn list_names_methods() {
        let list = list("session::Session>::route");
        assert!(list.has("<session::Session>::route"));
        assert!(!list.has("<session::Session>::routes"));
        assert!(!list.has("<session::Session>::work"));
    }

    #[test]
    fn line_with_plus_keeps_what_it_names() {
        let list = list("core::slice::sort\n+ (&str, &str)");
        assert!(list.has("core::slice::sort::quicksort::<f32>"));
        assert!(!list.has("core::slice::sort::quicksort::<(&str, &str), [core::slice::Iter]>"));
    }
}
