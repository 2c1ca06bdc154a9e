//! The words of a search.

/// The words of a search: all of some are wanted, and none of others.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(super) struct Terms {
    wanted: Vec<String>,
    unwanted: Vec<String>,
}

impl Terms {
    /// Reads a search: words, a minus before what is not wanted, words that belong together in
    /// quotation marks.
    pub(super) fn read(text: &str) -> Self {
        let mut terms = Self::default();
        let mut rest = text.trim_start();
        while !rest.is_empty() {
            let (is_wanted, own) = match rest.strip_prefix('-') {
                Some(own) => (false, own),
                None => (true, rest),
            };
            let (word, next) = match own.strip_prefix('"') {
                Some(quoted) => quoted.split_once('"').unwrap_or((quoted, "")),
                None => own.split_at(own.find(char::is_whitespace).unwrap_or(own.len())),
            };
            let word = word.to_lowercase();
            if !word.trim().is_empty() {
                if is_wanted { terms.wanted.push(word) } else { terms.unwanted.push(word) }
            }
            rest = next.trim_start();
        }
        terms
    }

    /// Returns whether a text in lower case is wanted.
    pub(super) fn fit(&self, text: &str) -> bool {
        let has = |word: &String| text.contains(word.as_str());
        self.wanted.iter().all(has) && !self.unwanted.iter().any(has)
    }

    /// Returns whether every text is wanted.
    pub(super) fn is_empty(&self) -> bool {
        self.wanted.is_empty() && self.unwanted.is_empty()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn search_has_words_minus_and_quotation_marks() {
        let terms = |wanted: &[&str], unwanted: &[&str]| Terms {
            wanted: wanted.iter().map(|word| (*word).to_owned()).collect(),
            unwanted: unwanted.iter().map(|word| (*word).to_owned()).collect(),
        };
        for (text, expected) in [
            ("", terms(&[], &[])),
            ("  Walk\tRUN ", terms(&["walk", "run"], &[])),
            ("walk -run -\"two  Words\"", terms(&["walk"], &["run", "two  words"])),
            ("\"left turn", terms(&["left turn"], &[])),
            ("\"a\"b", terms(&["a", "b"], &[])),
            ("a-b - \"\" -\"", terms(&["a-b"], &[])),
            ("ÜBER", terms(&["über"], &[])),
        ] {
            assert_eq!(Terms::read(text), expected, "{text}");
        }
    }

    #[test]
    fn text_fits_if_it_has_all_wanted_words_and_no_unwanted_one() {
        let fit = |search: &str, text: &str| Terms::read(search).fit(text);
        assert!(fit("walk fast", "walks/walk_fast.bvh"));
        assert!(!fit("walk fast", "walks/slow.bvh"));
        assert!(!fit("walk -fast", "walks/walk_fast.bvh"));
        assert!(fit("", "anything") && fit("-x", "anything"));
        assert!(!fit("\"a b\"", "a\nb"));
    }
}
