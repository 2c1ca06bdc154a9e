//! Formulas as they are printed: letters that stand for quantities are italic, exponents are
//! raised.

/// A part of a formula in one style.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Part<'a> {
    /// Its text.
    pub(super) text: &'a str,
    /// Whether it stands for a quantity: a single letter.
    pub(super) is_quantity: bool,
    /// Its place.
    pub(super) place: Place,
}

/// The place of a part of a formula.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Place {
    /// On the line.
    Line,
    /// Above the line: an exponent.
    Raised,
    /// Nowhere: a mark of the plain text, which stays in it for those who copy it.
    Hidden,
}

/// Returns the parts of a formula in plain text, in which `^` marks an exponent: `e^(−γ t)`, `x^2`.
pub(super) fn parts_of(formula: &str) -> Vec<Part<'_>> {
    let mut parts = Vec::new();
    let mut rest = formula;
    while let Some(at) = rest.find('^') {
        let (line, exponent) = rest.split_at(at);
        push(line, Place::Line, &mut parts);
        let after = exponent.get(1..).unwrap_or_default();
        let (opens, raised, closes) = exponent_of(after);
        if raised.is_empty() {
            push(exponent.get(..1).unwrap_or_default(), Place::Line, &mut parts);
            rest = after;
            continue;
        }
        push(exponent.get(..1 + opens).unwrap_or_default(), Place::Hidden, &mut parts);
        push(raised, Place::Raised, &mut parts);
        let end = opens + raised.len();
        push(after.get(end..end + closes).unwrap_or_default(), Place::Hidden, &mut parts);
        rest = after.get(end + closes..).unwrap_or_default();
    }
    push(rest, Place::Line, &mut parts);
    parts
}

/// Returns the exponent at the beginning of a text, and the lengths of its brackets: all between a
/// pair of them, else all letters and digits. Without the second bracket there is no exponent.
fn exponent_of(text: &str) -> (usize, &str, usize) {
    let Some(inner) = text.strip_prefix('(') else {
        let end = text.find(|letter: char| !letter.is_alphanumeric()).unwrap_or(text.len());
        return (0, text.get(..end).unwrap_or_default(), 0);
    };
    let mut depth = 1;
    for (at, letter) in inner.char_indices() {
        match letter {
            '(' => depth += 1,
            ')' => depth -= 1,
            _ => {}
        }
        if depth == 0 {
            return (1, inner.get(..at).unwrap_or_default(), 1);
        }
    }
    (0, "", 0)
}

/// Adds a text, cut where a quantity begins or ends.
fn push<'a>(text: &'a str, place: Place, parts: &mut Vec<Part<'a>>) {
    // Σ is the sign of a sum.
    let is_letter = |letter: char| letter.is_alphabetic() && letter < '\u{2e80}' && letter != 'Σ';
    let mut from = 0;
    let mut letters = text.char_indices().peekable();
    let mut before = None;
    while let Some((at, letter)) = letters.next() {
        let alone = is_letter(letter)
            && !before.is_some_and(|before| is_letter(before) || before == '_')
            && !letters.peek().is_some_and(|&(_, next)| is_letter(next) || next == '_');
        before = Some(letter);
        if alone && place != Place::Hidden {
            let end = at + letter.len_utf8();
            add(&text[from..at], false, place, parts);
            add(&text[at..end], true, place, parts);
            from = end;
        }
    }
    add(&text[from..], false, place, parts);
}

fn add<'a>(text: &'a str, is_quantity: bool, place: Place, parts: &mut Vec<Part<'a>>) {
    if !text.is_empty() {
        parts.push(Part { text, is_quantity, place });
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Writes the parts of a formula: quantities in stars, exponents in braces, marks in brackets.
    fn marked(formula: &str) -> String {
        let mark = |part: &Part<'_>| {
            let text =
                if part.is_quantity { format!("*{}*", part.text) } else { part.text.to_owned() };
            match part.place {
                Place::Line => text,
                Place::Raised => format!("{{{text}}}"),
                Place::Hidden => format!("[{text}]"),
            }
        };
        parts_of(formula).iter().map(mark).collect()
    }

    #[test]
    fn exponents_are_raised_without_their_marks() {
        assert_eq!(marked("e^(−γ t) x₀"), "*e*[^(]{−}{*γ*}{ }{*t*}[)] *x*₀");
        assert_eq!(marked("(p⁻¹ q)^t"), "(*p*⁻¹ *q*)[^]{*t*}");
        assert_eq!(marked("2^(n (m + 1))!"), "2[^(]{*n*}{ (}{*m*}{ + 1)}[)]!");
    }

    #[test]
    fn words_in_formulas_are_no_quantities() {
        assert_eq!(marked("y = 2 ln 2 / h"), "*y* = 2 ln 2 / *h*");
        assert_eq!(marked("blend_window"), "blend_window");
        assert_eq!(marked("x_min"), "x_min");
        assert_eq!(marked("cost = Σ (w · 差異)²"), "cost = Σ (*w* · 差異)²");
    }

    #[test]
    fn mark_without_an_exponent_is_text() {
        for formula in ["a ^ b", "^", "x^(y", "x^", "^(", "x^()"] {
            let plain: String = parts_of(formula).iter().map(|part| part.text).collect();
            assert_eq!(plain, formula);
            assert!(parts_of(formula).iter().all(|part| part.place == Place::Line), "{formula}");
        }
    }
}
