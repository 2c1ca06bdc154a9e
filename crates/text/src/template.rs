//! Parsing of templates.

/// A part of a template.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Part<'a> {
    /// Text that is written unchanged.
    Words(&'a str),
    /// An argument, with its number format.
    Value(&'a str, Digits),
    /// One of several forms, by an argument.
    Forms(&'a str, Forms<'a>),
}

/// The format of a number.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Digits {
    /// The number of decimals; as many as needed if `None`.
    pub(crate) behind: Option<usize>,
    /// The least number of digits in all, with leading zeros.
    pub(crate) least: usize,
}

/// The forms of a plural or a choice: `one {…} other {…}`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Forms<'a>(&'a str);

/// Returns the parts of a template. Invalid parts are text.
pub(crate) fn parts(template: &str) -> impl Iterator<Item = Part<'_>> {
    let mut rest = template;
    std::iter::from_fn(move || {
        let at = rest.find(['{', '}']).unwrap_or(rest.len());
        if at > 0 {
            let (words, after) = rest.split_at(at);
            rest = after;
            return Some(Part::Words(words));
        }
        for double in ["{{", "}}"] {
            if let Some(after) = rest.strip_prefix(double) {
                rest = after;
                return Some(Part::Words(&double[..1]));
            }
        }
        let first = rest.get(..1)?;
        let Some(inside) = first.starts_with('{').then(|| inside(rest)).flatten() else {
            rest = rest.get(1..).unwrap_or("");
            return Some(Part::Words(first));
        };
        rest = rest.get(inside.len() + 2..).unwrap_or("");
        Some(placeholder(inside))
    })
}

/// Returns the text up to the brace that closes it.
fn inside(text: &str) -> Option<&str> {
    let mut depth = 0_usize;
    for (at, letter) in text.char_indices() {
        match letter {
            '{' => depth += 1,
            '}' => {
                depth = depth.checked_sub(1)?;
                if depth == 0 {
                    return text.get(1..at);
                }
            }
            _ => {}
        }
    }
    None
}

fn placeholder(inside: &str) -> Part<'_> {
    if let Some((name, choice)) = inside.split_once(',')
        && let Some((_, forms)) = choice.split_once(',')
    {
        return Part::Forms(name.trim(), Forms(forms));
    }
    let (name, digits) = inside.split_once(':').unwrap_or((inside, ""));
    let digits = match digits.strip_prefix('.') {
        Some(behind) => Digits { behind: behind.parse().ok(), least: 0 },
        None => Digits { behind: None, least: digits.parse().unwrap_or(0) },
    };
    Part::Value(name.trim(), digits)
}

impl<'a> Forms<'a> {
    /// Returns the forms with their keys, in order.
    pub(crate) fn iter(self) -> impl Iterator<Item = (&'a str, &'a str)> {
        let mut rest = self.0;
        std::iter::from_fn(move || {
            let (key, _) = rest.split_once('{')?;
            let form = inside(rest.get(key.len()..)?)?;
            rest = rest.get(key.len() + form.len() + 2..)?;
            Some((key.trim(), form))
        })
    }

    /// Returns the first form that has one of these keys.
    pub(crate) fn find(self, keys: &[&str]) -> Option<&'a str> {
        keys.iter()
            .find_map(|key| self.iter().find(|(known, _)| known == key))
            .map(|(_, form)| form)
    }
}

/// Returns the text of a template without its arguments and forms.
#[must_use]
pub fn text_of_template(template: &str) -> String {
    parts(template)
        .filter_map(|part| match part {
            Part::Words(words) => Some(words),
            Part::Value(..) | Part::Forms(..) => None,
        })
        .collect()
}

/// Returns the names in a template, including those in forms, each as often as it occurs.
pub(crate) fn names(template: &str) -> Vec<&str> {
    parts(template)
        .flat_map(|part| match part {
            Part::Words(_) => Vec::new(),
            Part::Value(name, _) => vec![name],
            Part::Forms(name, forms) => {
                let inside = forms.iter().flat_map(|(_, form)| names(form));
                [name].into_iter().chain(inside).collect()
            }
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_of_any_text_do_not_panic() {
        for text in [
            "{",
            "}",
            "{{",
            "}}",
            "{a",
            "{a,plural",
            "{a,b,c}",
            "{a, plural, {",
            "影{格",
            "{影:.x}",
        ] {
            assert!(parts(text).count() <= text.len(), "{text}");
            assert!(names(text).len() <= 1, "{text}");
        }
    }

    #[test]
    fn parts_are_words_values_and_forms() {
        let template = "a {b:.2}{{{c:03} {n, plural, =0 {no} one {# {x}} other {}}";
        let found: Vec<Part> = parts(template).collect();
        let [behind, least] = [(Some(2), 0), (None, 3)];
        assert_eq!(
            found[..5],
            [
                Part::Words("a "),
                Part::Value("b", Digits { behind: behind.0, least: behind.1 }),
                Part::Words("{"),
                Part::Value("c", Digits { behind: least.0, least: least.1 }),
                Part::Words(" "),
            ]
        );
        let Part::Forms("n", forms) = found[5] else { panic!("{found:?}") };
        let forms: Vec<_> = forms.iter().collect();
        assert_eq!(forms, [("=0", "no"), ("one", "# {x}"), ("other", "")]);
        assert_eq!(names(template), ["b", "c", "n", "x"]);
    }

    #[test]
    fn text_of_template_has_no_arguments() {
        let template = "The join ends at {secs:.2} s: move {n, plural, one {# bone} other {it}}.";
        assert_eq!(text_of_template(template), "The join ends at  s: move .");
    }
}
