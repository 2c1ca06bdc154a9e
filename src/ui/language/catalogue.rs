//! A catalogue: what English sentences are in another language.
//!
//! English stands in the program, where it is written and read; it is the key of its own
//! translation. So the core needs no language at all, and a sentence that has no translation is
//! still a sentence. What is made of parts is found again by its parts:
//!
//! - an entry with placeholders, `{} could not be loaded: {}.`, is a pattern; `{#}` stands for a
//!   number alone, `{=}` for what stays as it is. What its placeholders stood for is translated in
//!   turn, and goes into the placeholders of the translation, in order or by number (`{1}`);
//! - several sentences behind each other, lists, and `title: text` are translated piece by piece;
//! - a note, `the rest pose was taken`, is found also where it was made a sentence, `The rest pose
//!   was taken.`;
//! - a number before a thing, `3 bones`, needs an entry for one `bone` only;
//! - a row of words and numbers that all have entries, `27 seam °/s best`, is translated word by
//!   word.

use segue_text::{Message, Table};
use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, PoisonError};

/// Texts with numbers in them are ever new; once so many are known they are all forgotten.
const MOST_KNOWN: usize = 4096;
/// Parts of parts are not looked into any deeper.
const DEEPEST: usize = 6;
/// A pattern with so many letters does not fit a text by chance.
const ENOUGH: usize = 12;
/// A row of more words is a sentence.
const LONGEST_ROW: usize = 14;

/// See the module.
#[derive(Debug)]
pub(crate) struct Catalogue {
    table: Table,
    exact: BTreeMap<String, String>,
    /// Those with the most words of their own come first.
    patterns: Vec<Pattern>,
    /// What was asked before; none for what has no translation.
    known: Mutex<BTreeMap<String, Option<Arc<str>>>>,
}

#[derive(Debug)]
struct Pattern {
    english: Vec<Piece>,
    /// The names of its placeholders, where they have names.
    names: Vec<String>,
    translation: String,
    letters: usize,
}

/// A part of an entry.
#[derive(Clone, Debug, PartialEq)]
enum Piece {
    Words(String),
    Anything,
    Number,
    /// What is not translated: keys of the link.
    Kept,
}

impl Catalogue {
    /// Reads a catalogue: JSON, sections by name, and in each the translations by their English.
    ///
    /// # Errors
    /// What is wrong with the JSON.
    pub(crate) fn read(json: &[u8]) -> Result<Self, String> {
        let sections: BTreeMap<String, BTreeMap<String, String>> =
            serde_json::from_slice(json).map_err(|error| error.to_string())?;
        let mut exact = BTreeMap::new();
        let mut patterns = Vec::new();
        let table = Table::new(sections.values().flatten());
        for (english, translation) in sections.into_values().flatten() {
            let pieces = pieces(&english);
            if let [Piece::Words(words)] = pieces.as_slice() {
                exact.insert(words.clone(), translation);
            } else {
                let letters = pieces.iter().map(Piece::letters).sum();
                let names = names(&english);
                patterns.push(Pattern { english: pieces, names, translation, letters });
            }
        }
        patterns.sort_by_key(|pattern| std::cmp::Reverse(pattern.letters));
        Ok(Self { table, exact, patterns, known: Mutex::default() })
    }

    /// The translation of a text; `None` where there is none.
    pub(crate) fn find(&self, text: &str) -> Option<Arc<str>> {
        let mut known = self.known.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(found) = known.get(text) {
            return found.clone();
        }
        let found: Option<Arc<str>> = self.look_up(text, 0).map(Arc::from);
        if known.len() >= MOST_KNOWN {
            known.clear();
        }
        known.insert(text.to_owned(), found.clone());
        found
    }

    /// A message in this language. One that is not known as a whole is looked for as what it is in
    /// English.
    pub(crate) fn say(&self, message: &Message) -> String {
        if self.table.has(message) {
            let found = |data: &str| self.find(data).map(|found| found.to_string());
            return self.table.write_with(message, found);
        }
        let english = message.to_string();
        self.find(&english).map_or(english, |found| found.to_string())
    }

    /// What was asked so far, with what was found.
    #[cfg(all(test, feature = "ui-tests"))]
    pub(crate) fn asked(&self) -> Vec<(String, Option<Arc<str>>)> {
        let known = self.known.lock().unwrap_or_else(PoisonError::into_inner);
        known.iter().map(|(text, found)| (text.clone(), found.clone())).collect()
    }

    fn look_up(&self, text: &str, depth: usize) -> Option<String> {
        if depth > DEEPEST || !has_word(text) {
            return None;
        }
        let core = text.trim();
        self.whole(core)
            .or_else(|| self.sentences(core, depth))
            .or_else(|| self.titled(core))
            .or_else(|| self.pattern(core, depth))
            .or_else(|| self.counted(core, depth))
            .or_else(|| self.bracketed(core, depth))
            .or_else(|| self.joined(core, depth))
            .or_else(|| self.row(core))
    }

    fn part(&self, text: &str, depth: usize) -> String {
        self.look_up(text, depth + 1).unwrap_or_else(|| text.trim().to_owned())
    }

    /// As it stands, or as the note that it was before it was made a sentence.
    fn whole(&self, text: &str) -> Option<String> {
        let exact = |text: &str| self.exact.get(text).or_else(|| self.exact.get(&small(text)));
        let sentence = || Some(format!("{}。", exact(text.strip_suffix('.')?)?));
        self.exact.get(text).cloned().or_else(sentence).or_else(|| exact(text).cloned())
    }

    /// `title: text`, where both stand in the catalogue as they are.
    fn titled(&self, text: &str) -> Option<String> {
        let (title, rest) = text.split_once(": ")?;
        Some(format!("{}：{}", self.whole(title)?, self.whole(rest)?))
    }

    /// `It is so. It is not.`: only where there is a translation of each.
    fn sentences(&self, text: &str, depth: usize) -> Option<String> {
        let ends: Vec<usize> = (text.match_indices(". "))
            .filter(|(at, _)| text[at + 2..].starts_with(|first: char| first.is_uppercase()))
            .map(|(at, _)| at + 1)
            .collect();
        if ends.is_empty() {
            return None;
        }
        let mut whole = String::new();
        let mut from = 0;
        for to in ends.into_iter().chain([text.len()]) {
            whole.push_str(&self.look_up(&text[from..to], depth + 1)?);
            from = to;
        }
        Some(whole)
    }

    /// By the pattern with the most words; a sentence also by that of a note.
    fn pattern(&self, text: &str, depth: usize) -> Option<String> {
        let note = note_of(text);
        self.patterns.iter().find_map(|pattern| {
            let fits = |text: &str| {
                let mut filled = Vec::new();
                let fits = fill(&pattern.english, text, &mut filled);
                let places =
                    pattern.english.iter().filter(|piece| !matches!(piece, Piece::Words(_)));
                let part = |(part, piece): (&&str, &Piece)| {
                    if *piece == Piece::Kept { (*part).to_owned() } else { self.part(part, depth) }
                };
                let parts =
                    fits.then(|| filled.iter().zip(places).map(part).collect::<Vec<_>>())?;
                // Few words stand in a long text by chance, too: what they stand between must then
                // be known.
                let known = |(part, english): (&String, &&str)| {
                    part != english.trim() || !has_word(english) || !english.trim().contains(' ')
                };
                (pattern.letters >= ENOUGH || parts.iter().zip(&filled).all(known))
                    .then(|| put_in(&pattern.translation, &pattern.names, &parts))
            };
            fits(text).or_else(|| Some(format!("{}。", fits(note.as_deref()?)?)))
        })
    }

    /// `3 bones`, by the entry of `bone` or of `bones`.
    fn counted(&self, text: &str, depth: usize) -> Option<String> {
        let (number, thing) = text.split_once(' ')?;
        if !is_number(number) {
            return None;
        }
        let one = thing.strip_suffix('s').unwrap_or(thing);
        let found = self.whole(thing).or_else(|| self.whole(one)).or_else(|| {
            // As in `3 bones (line 7)`.
            let (thing, rest) = thing.split_once(" (")?;
            Some(format!(
                "{}{}",
                self.whole(thing.strip_suffix('s').unwrap_or(thing))?,
                self.part(&format!("({rest}"), depth)
            ))
        })?;
        // A unit is no thing.
        (!found.is_ascii()).then(|| format!("{number} 個{found}"))
    }

    /// `words (more words)`.
    fn bracketed(&self, text: &str, depth: usize) -> Option<String> {
        let (words, more) = text.strip_suffix(')')?.rsplit_once(" (")?;
        let whole = format!("({more})");
        let inside = self
            .look_up(&whole, depth + 1)
            .or_else(|| Some(format!("（{}）", self.look_up(more, depth + 1)?)));
        let before = self.look_up(words, depth + 1);
        (inside.is_some() || before.is_some()).then(|| {
            let inside = inside.unwrap_or_else(|| format!("（{more}）"));
            format!("{}{inside}", before.unwrap_or_else(|| words.to_owned()))
        })
    }

    /// What stands beside each other: `this · that`, `this; that`, `this: that`, `this, that`. Some
    /// of it must have a translation; of what is divided by commas, which also stand in sentences,
    /// all.
    fn joined(&self, text: &str, depth: usize) -> Option<String> {
        [(" · ", " · "), ("; ", "；"), (": ", "："), (" → ", " → "), (" | ", " | "), (", ", "、")]
            .into_iter()
            .filter(|(between, _)| text.contains(between))
            .find_map(|(between, translated)| {
                let parts: Vec<&str> = if between == ": " {
                    let (title, rest) = text.split_once(between)?;
                    vec![title, rest]
                } else {
                    text.split(between).collect()
                };
                let found: Vec<Option<String>> =
                    parts.iter().map(|part| self.look_up(part, depth + 1)).collect();
                let some = found.iter().any(Option::is_some);
                let all = found
                    .iter()
                    .zip(&parts)
                    .all(|(found, part)| found.is_some() || !has_word(part));
                (some && (all || between != ", ")).then(|| {
                    let whole: Vec<String> = (found.into_iter().zip(&parts))
                        .map(|(found, part)| found.unwrap_or_else(|| part.trim().to_owned()))
                        .collect();
                    whole.join(translated)
                })
            })
    }

    /// Words and numbers in a row: all of them must have entries, the longest are taken first.
    fn row(&self, text: &str) -> Option<String> {
        let words: Vec<&str> = text.split_whitespace().collect();
        if words.len() > LONGEST_ROW {
            return None;
        }
        let mut whole: Vec<String> = Vec::new();
        let mut from = 0;
        while from < words.len() {
            let (to, found) = (from + 1..=words.len()).rev().find_map(|to| {
                let words = words[from..to].join(" ");
                let bare = words.trim_end_matches([',', ';', '.']);
                let one = || (to == from + 1 && !has_word(bare)).then(|| bare.to_owned());
                let found = self.whole(bare).or_else(one)?;
                let comma = match &words[bare.len()..] {
                    "" => "",
                    "." => "。",
                    _ => "，",
                };
                Some((to, format!("{found}{comma}")))
            })?;
            whole.push(found);
            from = to;
        }
        Some(whole.join(" "))
    }
}

/// What a sentence was before it was made one: `no frame time`, of `No frame time.`.
fn note_of(sentence: &str) -> Option<String> {
    sentence.strip_suffix('.').map(small)
}

/// The same, beginning with a small letter.
fn small(text: &str) -> String {
    let mut letters = text.chars();
    let first = letters.next().into_iter().flat_map(char::to_lowercase);
    first.chain(letters.clone()).collect()
}

impl Piece {
    fn letters(&self) -> usize {
        match self {
            Self::Words(words) => words.chars().filter(|letter| letter.is_alphabetic()).count(),
            Self::Anything | Self::Number | Self::Kept => 0,
        }
    }
}

/// An entry by its parts.
fn pieces(entry: &str) -> Vec<Piece> {
    let mut pieces = Vec::new();
    let mut words = String::new();
    let mut rest = entry.trim();
    while !rest.is_empty() {
        let placeholder = [("{}", Piece::Anything), ("{#}", Piece::Number), ("{=}", Piece::Kept)]
            .into_iter()
            .find_map(|(sign, piece)| Some((rest.strip_prefix(sign)?, piece)))
            .or_else(|| Some((named(rest)?.1, Piece::Anything)));
        if let Some((after, piece)) = placeholder {
            if !words.is_empty() {
                pieces.push(Piece::Words(std::mem::take(&mut words)));
            }
            pieces.push(piece);
            rest = after;
        } else {
            let mut letters = rest.chars();
            words.extend(letters.next());
            rest = letters.as_str();
        }
    }
    if !words.is_empty() {
        pieces.push(Piece::Words(words));
    }
    pieces
}

/// A placeholder with a name at the beginning of a text, `{cm:.1}`: its name, and what follows.
fn named(text: &str) -> Option<(&str, &str)> {
    let (inside, rest) = text.strip_prefix('{')?.split_once('}')?;
    let name = inside.split(':').next()?;
    let is_name = |sign: char| sign.is_ascii_alphanumeric() || sign == '_';
    (!name.is_empty() && name.chars().all(is_name)).then_some((name, rest))
}

/// The names in an entry, in order.
fn names(entry: &str) -> Vec<String> {
    let found = entry.match_indices('{').filter_map(|(at, _)| named(entry.get(at..)?));
    found.map(|(name, _)| name.to_owned()).collect()
}

/// Whether `text` is made of these pieces; `filled` holds then what the placeholders stand for.
fn fill<'a>(pieces: &[Piece], text: &'a str, filled: &mut Vec<&'a str>) -> bool {
    let Some((first, rest)) = pieces.split_first() else {
        return text.is_empty();
    };
    if let Piece::Words(words) = first {
        return text.strip_prefix(words.as_str()).is_some_and(|text| fill(rest, text, filled));
    }
    let fits = |part: &str| match first {
        Piece::Number => is_number(part),
        Piece::Kept => !part.contains(": "),
        _ => true,
    };
    let known = filled.len();
    let ends: Vec<usize> = match rest.first() {
        None => vec![text.len()],
        // Two placeholders side by side: the first takes all, for they go side by side into the
        // translation, too.
        Some(Piece::Anything | Piece::Number | Piece::Kept) => {
            let next = rest
                .iter()
                .find_map(|piece| if let Piece::Words(words) = piece { Some(words) } else { None });
            next.map_or_else(
                || vec![text.len()],
                |words| text.match_indices(words.as_str()).map(|(at, _)| at).collect(),
            )
        }
        Some(Piece::Words(words)) => text.match_indices(words.as_str()).map(|(at, _)| at).collect(),
    };
    for end in ends {
        if fits(&text[..end]) {
            filled.push(&text[..end]);
            if fill(rest, &text[end..], filled) {
                return true;
            }
            filled.truncate(known);
        }
    }
    false
}

/// A translation with its placeholders filled.
fn put_in(translation: &str, names: &[String], parts: &[String]) -> String {
    let mut whole = String::new();
    let mut rest = translation;
    let mut next = 0;
    while let Some((before, after)) = rest.split_once('{') {
        whole.push_str(before);
        let Some((index, behind)) = after.split_once('}') else {
            whole.push('{');
            rest = after;
            continue;
        };
        let name = index.split(':').next().unwrap_or_default();
        let of_name = names.iter().position(|known| known == name);
        let index = of_name.or_else(|| index.parse().ok()).unwrap_or_else(|| {
            next += 1;
            next - 1
        });
        whole.push_str(parts.get(index).map_or("", String::as_str));
        rest = behind;
    }
    whole.push_str(rest);
    whole
}

/// Whether there is anything to translate: two letters side by side.
fn has_word(text: &str) -> bool {
    text.as_bytes().windows(2).any(|pair| pair.iter().all(u8::is_ascii_alphabetic))
}

fn is_number(text: &str) -> bool {
    text.contains(|sign: char| sign.is_ascii_digit())
        && text.chars().all(|sign| sign.is_ascii_digit() || "+-−.,:".contains(sign))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn catalogue() -> Catalogue {
        Catalogue::read(
            r#"{
                "words": {"Walk": "走", "frame": "影格", "bone": "骨頭", "too short": "太短", "left": "左", "samples": "範例",
                          "cm": "cm", "seam": "接縫", "best": "最佳", "walk": "走", "turn left": "左轉"},
                "patterns": {
                    "{} could not be loaded: {}.": "無法載入 {0}：{1}。",
                    "{} of {} frames": "{1} 個影格中的 {0} 個",
                    "{#} transitions, {}.": "{} 個轉場，{}。",
                    "no dead end": "沒有死路",
                    "(line {#})": "（第 {} 行）",
                    "{}{} ignored": "略過{}{}",
                    "One is enough.": "一個就夠了。",
                    "a window of {} frames": "{} 個影格的視窗",
                    "{} {#} %": "{} {} %", "{}: found `{=}`, expected {=}": "{}：讀到 `{}`，應為 {}",
                    "{} to {}": "{} → {}", "{} with {}": "{} 加上 {}",
                    "B keeps step with A": "B 與 A 同步"
                }
            }"#
            .as_bytes(),
        )
        .unwrap()
    }

    fn told(text: &str) -> String {
        catalogue().find(text).map_or_else(|| format!("({text})"), |found| found.to_string())
    }

    #[test]
    fn sentences_are_found_by_their_words_and_by_their_parts() {
        for (english, expected) in [
            ("Walk", "走"),
            (" Walk ", "走"),
            ("Walk could not be loaded: too short.", "無法載入 走：太短。"),
            ("3 of 12 frames", "12 個影格中的 3 個"),
            ("12 transitions, no dead end. One is enough.", "12 個轉場，沒有死路。一個就夠了。"),
            ("Too short.", "太短。"),
            ("3 bones (line 7) ignored", "略過3 個骨頭（第 7 行）"),
            ("Walk · 3 frames", "走 · 3 個影格"),
            ("Walk, left", "走、左"),
            ("samples: 3.2 s", "範例：3.2 s"),
            ("A window of 5 frames.", "5 個影格的視窗。"),
            ("One is enough", "(One is enough)"),
            ("B keeps step with A.", "B 與 A 同步。"),
            ("27 seam °/s best", "27 接縫 °/s 最佳"),
            ("walk, turn left, 3 bones", "走、左轉、3 個骨頭"),
            ("28 cm", "28 cm"),
            ("best: walk to seam", "最佳：走 → 接縫"),
            ("Too short 34 %", "太短 34 %"),
            ("key: found `walk`, expected walk, seam", "key：讀到 `walk`，應為 walk, seam"),
            ("walk to seam", "走 → 接縫"),
            ("press to type a value", "(press to type a value)"),
        ] {
            assert_eq!(told(english), expected, "{english}");
        }
    }

    #[test]
    fn what_is_not_known_stays() {
        for english in [
            "",
            "0.5 s",
            "01_01",
            "Walk on, then left",
            "x could be",
            "many transitions, no dead end.",
        ] {
            assert_eq!(told(english), format!("({english})"));
        }
    }

    #[test]
    fn a_file_that_is_no_catalogue_is_refused() {
        assert!(Catalogue::read(b"<!doctype html>").is_err());
        assert!(Catalogue::read(br#"{"a": "b"}"#).is_err());
    }

    #[test]
    fn translations_hold_their_parts_in_any_order() {
        let parts = ["a".to_owned(), "b".to_owned()];
        assert_eq!(put_in("{1}{0}", &[], &parts), "ba");
        assert_eq!(put_in("{} {}{2}{", &[], &parts), "a b{");
        let names = ["name".to_owned(), "cm".to_owned()];
        assert_eq!(put_in("{cm:.1} {name}", &names, &parts), "b a");
    }
}
