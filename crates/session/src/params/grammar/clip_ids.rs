//! Ids of clips, separated by commas: `walk,blend(a:walk,b:run),my%2C walk.bvh~0a1b2c3d`.
//!
//! The id of a kept result is written unchanged, because its brackets close. In any other id,
//! characters that end an entry are percent-encoded.

use super::Misread;
use crate::params::choices::{LabId, MadeAction, Selected};
use percent_encoding::{AsciiSet, CONTROLS, percent_decode_str, utf8_percent_encode};

/// The characters to percent-encode inside an id: its delimiters, and `%` itself.
const RESERVED: &AsciiSet = &CONTROLS.add(b'(').add(b')').add(b',').add(b':').add(b'%');
/// The characters to percent-encode at the ends of an id.
const RESERVED_AT_ENDS: &AsciiSet = &RESERVED.add(b' ');
/// The greatest nesting of results in an id; deeper ids are not valid.
const MAX_DEPTH: usize = 6;

pub(super) fn read(text: &str) -> Result<Vec<String>, Misread> {
    Ok(all_parts(text)?
        .into_iter()
        .map(str::trim)
        .filter(|id| !id.is_empty())
        .map(read_id)
        .collect())
}

pub(super) fn write(ids: &[String]) -> String {
    write_ids(ids)
}

/// Writes several ids as one text, separated by commas.
#[must_use]
pub fn write_ids(ids: &[String]) -> String {
    super::joined(ids, |id| write_id(id))
}

/// Returns the parts of a list whose entries contain ids of clips.
pub(super) fn all_parts(text: &str) -> Result<Vec<&str>, Misread> {
    parts(text).ok_or_else(|| Misread::Text {
        found: text.to_owned(),
        expected: "brackets that close, and commas between the entries",
    })
}

/// Reads the id of a clip.
pub(crate) fn read_id(text: &str) -> String {
    if text.ends_with(')') {
        text.to_owned()
    } else {
        percent_decode_str(text).decode_utf8_lossy().into_owned()
    }
}

/// Writes the id of a clip.
pub(super) fn write_id(id: &str) -> String {
    if is_recipe(id) {
        return id.to_owned();
    }
    // Spaces between entries are ignored.
    let (before, inner) = id.split_at(id.len() - id.trim_start().len());
    let (inner, behind) = inner.split_at(inner.trim_end().len());
    let spaces = |spaces: &str| utf8_percent_encode(spaces, RESERVED_AT_ENDS).to_string();
    format!("{}{}{}", spaces(before), escaped(inner), spaces(behind))
}

/// Writes a text so that it neither ends an entry nor opens a bracket.
pub(crate) fn escaped(text: &str) -> String {
    utf8_percent_encode(text, RESERVED).to_string()
}

/// Returns whether an id is that of a result, with its recipe in brackets.
pub(crate) fn is_recipe(id: &str) -> bool {
    let Some((word, list)) = id.strip_suffix(')').and_then(|id| id.split_once('(')) else {
        return false;
    };
    let is_made = LabId::from_word(word).is_some() || MadeAction::from_word(word).is_some();
    let mut depth = 0_usize;
    let stays_inside = list.bytes().all(|byte| match byte {
        b'(' => {
            depth += 1;
            true
        }
        b')' => match depth.checked_sub(1) {
            Some(outer) => {
                depth = outer;
                true
            }
            None => false,
        },
        _ => true,
    });
    is_made && stays_inside && depth == 0
}

/// Returns the parts of a list between the commas outside of brackets. `None` if the brackets do
/// not close, or are nested too deeply.
pub(crate) fn parts(list: &str) -> Option<Vec<&str>> {
    let (mut parts, mut depth, mut start) = (Vec::new(), 0_usize, 0);
    for (at, letter) in list.char_indices() {
        match letter {
            '(' => depth += 1,
            ')' => depth = depth.checked_sub(1)?,
            ',' if depth == 0 => {
                parts.push(&list[start..at]);
                start = at + 1;
            }
            _ => {}
        }
        if depth > MAX_DEPTH {
            return None;
        }
    }
    parts.push(&list[start..]);
    parts.retain(|part| !part.is_empty());
    (depth == 0).then_some(parts)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn ids_with_commas_and_brackets_stay_whole() {
        let ids = [
            "walk",
            "slow, then fast.bvh",
            "turn (left",
            "a (copy)",
            "100 %",
            " spaces ",
            "walk(turn_rate:20,make_seconds:2)",
            "blend(a:my%2C walk.bvh,b:walk(turn_rate:20))",
        ]
        .map(str::to_owned);
        assert_eq!(read(&write(&ids)), Ok(ids.to_vec()));
        assert_eq!(
            read("walk, run ,,idle"),
            Ok(["walk", "run", "idle"].map(str::to_owned).to_vec())
        );
        assert_eq!(
            write(&["a (copy)".to_owned(), "walk(lean:2)".to_owned()]),
            "a %28copy%29,walk(lean:2)"
        );
    }

    #[test]
    fn brackets_that_do_not_close_are_named() {
        let error = read("walk,blend(a:walk").unwrap_err();
        assert_eq!(
            error.to_string(),
            "found `walk,blend(a:walk`, expected brackets that close, and commas between the entries"
        );
        assert!(read("walk)").is_err());
    }

    proptest! {
        #[test]
        fn any_ids_read_back_as_written(ids in prop::collection::vec(".{1,16}", 0..4)) {
            prop_assert_eq!(read(&write(&ids)), Ok(ids));
        }
    }
}
