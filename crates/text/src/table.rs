//! The templates of a language, and the writing of messages.

use crate::template::{Digits, Part, names, parts};
use crate::{Arg, Message};
use std::collections::BTreeMap;
use std::fmt::{self, Write};

/// The templates of a language, by those of English.
#[derive(Clone, Debug, Default)]
pub struct Table {
    rows: BTreeMap<String, String>,
}

/// The reason why a template is not a translation of another.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum TemplateError {
    /// It has a name that the other template lacks.
    Unknown(String),
    /// It lacks a name of the other template.
    Missing(String),
}

impl Table {
    /// Returns a table of rows: the English template, and that of the language. The rows `", "`,
    /// `"; "`, `" "` and `"."` are the signs between the entries of a list, between clauses,
    /// between sentences, and at the end of a sentence.
    #[must_use]
    pub fn new<K: Into<String>, V: Into<String>>(rows: impl IntoIterator<Item = (K, V)>) -> Self {
        let rows = rows.into_iter().map(|(english, own)| (english.into(), own.into()));
        Self { rows: rows.collect() }
    }

    /// Returns the row of an English template.
    #[must_use]
    pub fn row(&self, english: &str) -> Option<&str> {
        self.rows.get(english).map(String::as_str)
    }

    /// Returns a message in this language. Parts without a row stay English.
    #[must_use]
    pub fn write(&self, message: &Message) -> String {
        Writer { table: Some(self) }.text_of(message)
    }

    /// Checks that a translation has the same names as the English template. The translation may
    /// choose forms by any of them.
    ///
    /// # Errors
    /// [`TemplateError`] with the first name that is on one side only.
    pub fn check(english: &str, own: &str) -> Result<(), TemplateError> {
        let [expected, found] = [names(english), names(own)];
        if let Some(name) = found.iter().find(|name| !expected.contains(name)) {
            return Err(TemplateError::Unknown((*name).to_owned()));
        }
        match expected.iter().find(|name| !found.contains(name)) {
            Some(name) => Err(TemplateError::Missing((*name).to_owned())),
            None => Ok(()),
        }
    }
}

/// Writes a message in English.
pub(crate) fn write_english(message: &Message, to: &mut dyn Write) -> fmt::Result {
    ENGLISH.message(message, to)
}

#[derive(Clone, Copy)]
struct Writer<'a> {
    table: Option<&'a Table>,
}

const ENGLISH: Writer<'_> = Writer { table: None };

// Panels write all their messages in each frame, so nothing is collected on the way to the text.
impl Writer<'_> {
    fn row<'a>(&'a self, english: &'a str) -> &'a str {
        self.table.and_then(|table| table.row(english)).unwrap_or(english)
    }

    fn text_of(self, message: &Message) -> String {
        text(|whole| self.message(message, whole))
    }

    fn message(self, message: &Message, to: &mut dyn Write) -> fmt::Result {
        self.template(self.row(message.template()), message, None, to)
    }

    /// Writes a template, or the form of one; `count` stands for `#` there.
    fn template(
        self,
        template: &str,
        message: &Message,
        count: Option<&str>,
        to: &mut dyn Write,
    ) -> fmt::Result {
        for part in parts(template) {
            match part {
                Part::Words(words) => match count {
                    Some(count) => to.write_str(&words.replace('#', count))?,
                    None => to.write_str(words)?,
                },
                Part::Value(name, digits) => {
                    if let Some(arg) = message.arg(name) {
                        self.arg(arg, digits, to)?;
                    }
                }
                Part::Forms(name, forms) => {
                    let Some(arg) = message.arg(name) else { continue };
                    // A form is chosen by the English word, whatever its translation.
                    let word = text(|whole| ENGLISH.arg(arg, Digits::default(), whole));
                    let exact = format!("={word}");
                    let is_one = matches!(arg, Arg::Count(1));
                    let plural = if is_one { "one" } else { "other" };
                    if let Some(form) = forms.find(&[&exact, &word, plural, "other"]) {
                        self.template(form, message, Some(&word), to)?;
                    }
                }
            }
        }
        Ok(())
    }

    fn arg(self, arg: &Arg, digits: Digits, to: &mut dyn Write) -> fmt::Result {
        match arg {
            Arg::Text(text) => to.write_str(text),
            Arg::Count(count) => write!(to, "{count:0width$}", width = digits.least),
            Arg::Number(number) => match digits.behind {
                Some(behind) => write!(to, "{number:.behind$}"),
                None => write!(to, "{number:0width$}", width = digits.least),
            },
            Arg::Message(message) => self.message(message, to),
            Arg::Joined(parts, between) => {
                for (index, part) in parts.iter().enumerate() {
                    if index > 0 {
                        to.write_str(self.row(between))?;
                    }
                    self.arg(part, digits, to)?;
                }
                Ok(())
            }
            Arg::Note(note) => to.write_str(&sentence(&self.text_of(note), self.row("."))),
        }
    }
}

/// Returns what is written into a text.
fn text(write: impl FnOnce(&mut String) -> fmt::Result) -> String {
    let mut whole = String::new();
    // Only a number whose own `Display` fails could be an error, and none does.
    write(&mut whole).unwrap_or_default();
    whole
}

/// Returns a note, `the rest pose was taken`, as a sentence: `The rest pose was taken.`
fn sentence(note: &str, stop: &str) -> String {
    let mut letters = note.chars();
    let first = letters.next().map_or_else(String::new, |first| first.to_uppercase().to_string());
    let has_stop = note.is_empty() || note.ends_with(stop);
    format!("{first}{}{}", letters.as_str(), if has_stop { "" } else { stop })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::msg;

    #[test]
    fn plural_form_is_that_of_the_count() {
        let told = |dead: usize| {
            msg!("{dead, plural, =0 {no dead end} one {# dead end} other {# dead ends}}.", dead)
                .to_string()
        };
        assert_eq!([0, 1, 7].map(told), ["no dead end.", "1 dead end.", "7 dead ends."]);
    }

    #[test]
    fn plural_of_a_translation_is_its_own() {
        let table = Table::new([("{n} clips", "{n, plural, one {einen Clip} other {# Clips}}")]);
        let told = |n: usize| table.write(&msg!("{n} clips", n));
        assert_eq!([1, 2].map(told), ["einen Clip", "2 Clips"]);
    }

    #[test]
    fn form_is_chosen_by_the_english_word() {
        let table = Table::new([
            ("the {side} foot", "{side, select, left {左腳} other {{side}的腳}}"),
            ("left", "左"),
            ("right", "右"),
        ]);
        let told = |side: &'static str| table.write(&msg!("the {side} foot", side));
        assert_eq!(["left", "right"].map(told), ["左腳", "右的腳"]);
    }

    #[test]
    fn numbers_have_the_digits_of_the_template() {
        let (cm, secs) = (2.345_f64, 7);
        let message = msg!("{cm:.1} cm, {cm} cm, 0:{secs:02}", cm, secs);
        assert_eq!(message.to_string(), "2.3 cm, 2.345 cm, 0:07");
        let table = Table::new([("{cm:.1} cm, {cm} cm, 0:{secs:02}", "{secs} {cm:.0}")]);
        assert_eq!(table.write(&message), "7 2");
        assert_eq!(msg!("{x}", x = 0.1_f32).to_string(), "0.1");
    }

    #[test]
    fn list_has_the_comma_of_the_language() {
        let table = Table::new([(", ", "、"), ("left", "左"), ("right", "右")]);
        let message = msg!("{sides}", sides = vec!["left", "right"]);
        assert_eq!(
            (table.write(&message), message.to_string()),
            ("左、右".into(), "left, right".into())
        );
    }

    #[test]
    fn note_becomes_a_sentence_of_the_language() {
        let table = Table::new([("the rest pose was taken", "採用靜止姿勢"), (".", "。")]);
        let told = |note: &Message| [note.to_string(), table.write(note)];
        let note = || Message::word("the rest pose was taken");
        assert_eq!(told(&note().sentence()), ["The rest pose was taken.", "採用靜止姿勢。"]);
        assert_eq!(told(&note().sentence().sentence())[1], "採用靜止姿勢。");
        assert_eq!(told(&Message::default().sentence()), ["", ""]);
    }

    #[test]
    fn data_that_is_also_a_word_stays_as_it_is() {
        let table = Table::new([("{name} is here.", "{name}在這裡。"), ("Walk", "走")]);
        let told = |message| table.write(&message);
        assert_eq!(told(msg!("{name} is here.", name = "Walk".to_owned())), "Walk在這裡。");
        assert_eq!(told(msg!("{name} is here.", name = "Walk")), "走在這裡。");
    }

    #[test]
    fn templates_are_those_of_all_parts() {
        let message = msg!("{what} on {sides}", what = "Walk", sides = vec!["left", "right"]);
        assert_eq!(message.templates(), ["{what} on {sides}", "Walk", "left", "right", ", "]);
    }

    #[test]
    fn check_finds_names_that_do_not_agree() {
        let check = |own| Table::check("{name} of {count} clips", own);
        assert_eq!(check("{count, plural, other {# 個}}中的{name}"), Ok(()));
        assert_eq!(check("{count} 個"), Err(TemplateError::Missing("name".to_owned())));
        assert_eq!(check("{name}{count}{x}"), Err(TemplateError::Unknown("x".to_owned())));
    }
}
