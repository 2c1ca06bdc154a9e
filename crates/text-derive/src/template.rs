//! The names in a template.

/// Returns the names of a template, each once, in the order in which they stand there. Those in
/// the forms of a plural count, too.
///
/// # Errors
/// What is wrong with the template.
pub(crate) fn names(template: &str) -> Result<Vec<String>, String> {
    let mut found: Vec<String> = Vec::new();
    let mut depth = 0_usize;
    let mut letters = template.char_indices().peekable();
    while let Some((at, letter)) = letters.next() {
        let is_double = letters.peek().is_some_and(|(_, next)| *next == letter);
        match letter {
            '{' | '}' if is_double && depth == 0 => {
                letters.next();
            }
            '}' if depth == 0 => return Err("a `}` that closes nothing: write `}}`".to_owned()),
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
                        return Err(format!("`{{{name}}}` is not a name"));
                    }
                    if !found.iter().any(|known| known == name) {
                        found.push(name.to_owned());
                    }
                }
            }
            _ => {}
        }
    }
    if depth == 0 { Ok(found) } else { Err("a `{` that is not closed".to_owned()) }
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
        for template in ["{}", "{a", "a}", "{a b}"] {
            assert!(names(template).is_err(), "{template}");
        }
    }
}
