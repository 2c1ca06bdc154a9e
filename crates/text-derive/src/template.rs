//! The names in a template.

use std::fmt;

/// The reason why a template is invalid.
#[derive(Debug, PartialEq, Eq)]
pub(crate) enum TemplateError {
    /// A `}` without its `{`.
    Unopened,
    /// A `{` without its `}`.
    Unclosed,
    /// A placeholder whose name is empty or has other characters than letters, digits and `_`.
    Name(String),
}

impl fmt::Display for TemplateError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Unopened => f.write_str("a `}` that closes nothing: write `}}`"),
            Self::Unclosed => f.write_str("a `{` that is not closed"),
            Self::Name(name) => write!(f, "`{{{name}}}` is not a name"),
        }
    }
}

/// Returns the names of a template, each once, in their order, including those in the forms of a
/// plural.
///
/// # Errors
/// [`TemplateError`] where a brace or a name is invalid.
pub(crate) fn names(template: &str) -> Result<Vec<String>, TemplateError> {
    let mut found: Vec<String> = Vec::new();
    let mut depth = 0_usize;
    let mut letters = template.char_indices().peekable();
    while let Some((at, letter)) = letters.next() {
        let is_double = letters.peek().is_some_and(|(_, next)| *next == letter);
        match letter {
            '{' | '}' if is_double && depth == 0 => {
                letters.next();
            }
            '}' if depth == 0 => return Err(TemplateError::Unopened),
            '}' => depth -= 1,
            '{' => {
                depth += 1;
                // An even depth is the text of a form, an odd one a placeholder.
                if depth % 2 == 1 {
                    let rest = &template[at + 1..];
                    let end = rest.find([',', ':', '}']).unwrap_or(rest.len());
                    let name = rest[..end].trim();
                    let is_name = |sign: char| sign.is_alphanumeric() || sign == '_';
                    if name.is_empty() || !name.chars().all(is_name) {
                        return Err(TemplateError::Name(name.to_owned()));
                    }
                    if !found.iter().any(|known| known == name) {
                        found.push(name.to_owned());
                    }
                }
            }
            _ => {}
        }
    }
    if depth == 0 { Ok(found) } else { Err(TemplateError::Unclosed) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_of_placeholders_and_forms_are_found_once() {
        for (template, expected) in [
            ("plain", &[][..]),
            ("{a} of {b:.1} m, {a}", &["a", "b"]),
            (
                "{n, plural, one {# bone of {name}} other {# bones of {name}}} {x}",
                &["n", "name", "x"],
            ),
            ("`}}` for joint {{ {0}", &["0"]),
        ] {
            assert_eq!(names(template).expect(template), expected, "{template}");
        }
    }

    #[test]
    fn names_of_broken_templates_are_refused() {
        for (template, error) in [
            ("{}", TemplateError::Name(String::new())),
            ("{a", TemplateError::Unclosed),
            ("a}", TemplateError::Unopened),
            ("{a b}", TemplateError::Name("a b".to_owned())),
        ] {
            assert_eq!(names(template), Err(error), "{template}");
        }
    }
}
