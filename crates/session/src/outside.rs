//! Sanitising of texts from outside (names of files, values of links) for messages: on one line,
//! short, and without a meaning in Markdown.

/// The greatest number of characters of a value that a message quotes.
const MAX_QUOTED: usize = 60;
/// The greatest number of characters of a name.
const MAX_NAME: usize = 200;
/// The greatest number of characters of a name in an id, which links contain.
const MAX_ID_NAME: usize = 100;
/// The name of nameless things.
const UNNAMED: &str = "unnamed";
/// The greatest number of characters of a file's ending.
const MAX_ENDING: usize = 10;

/// Returns a text without line breaks, invisible characters and changes of the reading direction:
/// line breaks and tabs become spaces, the others are removed.
#[must_use]
pub fn on_one_line(text: &str) -> String {
    let letters = text.chars().filter_map(|letter| match letter {
        '\t' | '\n' | '\r' | '\u{b}' | '\u{c}' | '\u{85}' | '\u{2028}' | '\u{2029}' => Some(' '),
        letter if letter.is_control() || is_direction_sign(letter) => None,
        letter => Some(letter),
    });
    letters.collect()
}

/// Returns whether a character is a control of Unicode's bidirectional algorithm (UAX #9, section
/// 2), or a byte order mark.
fn is_direction_sign(letter: char) -> bool {
    matches!(
        letter,
        '\u{61c}' | '\u{200e}' | '\u{200f}' | '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}' | '\u{feff}'
    )
}

/// Returns a text for quotation in a message: on one line, and of a long one its first 60
/// characters and `…`.
#[must_use]
pub fn short(text: &str) -> String {
    cut(&on_one_line(text), MAX_QUOTED)
}

fn cut(text: &str, most: usize) -> String {
    match text.char_indices().nth(most) {
        Some((end, _)) => format!("{}…", text.get(..end).unwrap_or(text)),
        None => text.to_owned(),
    }
}

/// Returns the name of a clip for storage and display: on one line, and of a long one its first
/// characters and `…`.
#[must_use]
pub fn clip_name(name: &str) -> String {
    let name = on_one_line(name);
    let name = cut(name.trim(), MAX_NAME);
    if name.is_empty() { UNNAMED.to_owned() } else { name }
}

/// Returns a file's path for storage and display: on one line, and of a long one its first
/// characters, `…` and its ending.
#[must_use]
pub fn file_name(path: &str) -> String {
    let path = on_one_line(path);
    let (folders, name) = path.rsplit_once('/').unwrap_or(("", &path));
    let name = name.trim();
    let name = if name.is_empty() {
        UNNAMED.to_owned()
    } else if name.chars().count() <= MAX_NAME {
        name.to_owned()
    } else {
        let ending = name.rsplit_once('.').map_or("", |(_, ending)| ending);
        let ending = if ending.chars().count() > MAX_ENDING { "" } else { ending };
        format!("{}.{ending}", cut(name, MAX_NAME - MAX_ENDING - 2))
            .trim_end_matches('.')
            .to_owned()
    };
    if folders.is_empty() { name } else { format!("{folders}/{name}") }
}

/// Returns the beginning of a long name, for an id.
#[must_use]
pub fn for_id(name: &str) -> &str {
    let end = name.char_indices().nth(MAX_ID_NAME).map_or(name.len(), |(end, _)| end);
    name.get(..end).unwrap_or(name)
}

/// Returns a text escaped for Markdown, in a paragraph or in a cell of a table: no HTML, no link,
/// no image, no other cell.
#[must_use]
pub fn markdown(text: &str) -> String {
    let text = on_one_line(text);
    let mut escaped = String::with_capacity(text.len());
    let mut before = "";
    for (at, letter) in text.char_indices() {
        let (_, rest) = text.split_at(at);
        // GitHub turns bare addresses into links.
        let begins_address = (letter == ':' && rest.starts_with("://"))
            || (letter == '.' && before.to_ascii_lowercase().ends_with("www"));
        if begins_address
            || matches!(letter, '\\' | '`' | '*' | '[' | ']' | '<' | '>' | '|' | '@' | '&')
        {
            escaped.push('\\');
        }
        escaped.push(letter);
        before = text.get(..at + letter.len_utf8()).unwrap_or_default();
    }
    escaped
}

/// Returns a text as inline code in Markdown, in a paragraph or in a cell of a table.
#[must_use]
pub fn markdown_code(text: &str) -> String {
    format!("`{}`", on_one_line(text).replace('`', "'").replace('|', "\\|"))
}

/// Returns a sentence of Segue's that quotes texts from outside in backticks, as Markdown with the
/// quotes as code.
#[must_use]
pub fn markdown_sentence(sentence: &str) -> String {
    let parts: Vec<&str> = sentence.split('`').collect();
    let is_closed = |index: usize| index + 1 < parts.len();
    let written = parts.iter().enumerate().map(|(index, part)| match index % 2 {
        0 => markdown(part),
        _ if is_closed(index) => markdown_code(part),
        _ => markdown(&format!("`{part}")),
    });
    written.collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn on_one_line_removes_breaks_and_invisible_characters() {
        assert_eq!(on_one_line("a\r\nb\tc\u{2028}d"), "a  b c d");
        assert_eq!(on_one_line("walk\0\u{202e}hvb.exe\u{2066}\u{feff}\u{1b}[1m"), "walkhvb.exe[1m");
        // Characters that scripts need are kept.
        assert_eq!(on_one_line("क्‍ष Säule 走る 👩‍🚀"), "क्‍ष Säule 走る 👩‍🚀");
    }

    #[test]
    fn short_of_a_long_text_ends_at_a_character() {
        assert_eq!(short(&"走".repeat(60)), "走".repeat(60));
        assert_eq!(short(&"走".repeat(61)), format!("{}…", "走".repeat(60)));
    }

    #[test]
    fn file_name_of_a_long_path_keeps_its_ending() {
        for name in [
            format!("a/{}.bvh", "x".repeat(4000)),
            format!("a/{}", "x".repeat(4000)),
            format!("{}.{}", "x".repeat(300), "y".repeat(300)),
        ] {
            let cut = file_name(&name);
            assert!(cut.chars().count() <= MAX_NAME + 2, "{cut}");
            let ends =
                |name: &str| (name.rsplit('.').next() == Some("bvh"), name.starts_with("a/"));
            assert_eq!(ends(&cut), ends(&name));
            assert_eq!(file_name(&cut), cut, "a name that is kept stays");
        }
        for empty in ["", " \n", "\0\u{202e}"] {
            assert_eq!(
                (file_name(empty), clip_name(empty)),
                (UNNAMED.to_owned(), UNNAMED.to_owned())
            );
        }
        assert_eq!(file_name(" a\nb.bvh"), "a b.bvh");
        assert_eq!(for_id(&"走".repeat(4000)).chars().count(), MAX_ID_NAME);
    }

    #[test]
    fn markdown_of_any_name_shows_its_characters() {
        for (name, escaped) in [
            ("<img src=x onerror=alert(1)>", "\\<img src=x onerror=alert(1)\\>"),
            ("![x](http://evil)", "!\\[x\\](http\\://evil)"),
            ("a|b\nc", "a\\|b c"),
            ("a\\|b", "a\\\\\\|b"),
            ("WWW.evil.org me@evil.org", "WWW\\.evil.org me\\@evil.org"),
            ("*a* &lt; `b`", "\\*a\\* \\&lt; \\`b\\`"),
            ("02_03 walk~3fa9", "02_03 walk~3fa9"),
        ] {
            assert_eq!(markdown(name), escaped);
        }
        assert_eq!(markdown_code("a`b|c\nd"), "`a'b\\|c d`");
        assert_eq!(markdown_sentence("`<b>|` is *not* here"), "`<b>\\|` is \\*not\\* here");
        assert_eq!(markdown_sentence("a `b <i>"), "a \\`b \\<i\\>");
    }
}
