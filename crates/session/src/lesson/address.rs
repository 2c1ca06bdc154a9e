//! The addresses of links, and the entities that they and texts may hold.

/// An address with more parentheses inside of each other is none.
const MOST_PARENTHESES: usize = 32;

/// The entities that are known.
const ENTITIES: [(&str, char); 5] =
    [("&amp;", '&'), ("&lt;", '<'), ("&gt;", '>'), ("&quot;", '"'), ("&nbsp;", '\u{a0}')];

/// Returns the host that an address with `://` leads to, with its port: as browsers read it, so
/// that nothing before an `@` and nothing behind a slash of either kind passes for it. The address
/// itself where it has none.
#[must_use]
pub fn host_of(address: &str) -> &str {
    let rest = address.split_once("://").map_or(address, |(_, rest)| rest);
    let authority = rest.split(['/', '\\', '?', '#']).next().unwrap_or(rest);
    let host = authority.rsplit('@').next().unwrap_or(authority);
    if host.is_empty() { address } else { host }
}

/// The sign that an entity at the beginning of a text stands for, and how many bytes the entity
/// has.
pub(super) fn entity(text: &str) -> Option<(char, usize)> {
    let (name, letter) = ENTITIES.iter().find(|(name, _)| text.starts_with(name))?;
    Some((*letter, name.len()))
}

/// The address that stands alone between `<` and `>`.
pub(super) fn bare_address(text: &str) -> Option<&str> {
    let inner = text.strip_prefix('<')?;
    if !(inner.starts_with("https://") || inner.starts_with("http://")) {
        return None;
    }
    let end = inner.find(|letter: char| {
        letter == '<' || letter == '>' || letter.is_whitespace() || letter.is_control()
    })?;
    let (address, after) = inner.split_at_checked(end)?;
    after.starts_with('>').then_some(address)
}

/// What stands behind `](` up to the `)` that belongs to it: the address, and the text after all
/// that.
pub(super) fn address(text: &str) -> Option<(String, &str)> {
    let text = text.trim_start();
    let (address, after) = match text.strip_prefix('<') {
        Some(inner) => {
            let end = end_of(inner, &['>', '<', '\n'])?;
            let (address, after) = inner.split_at_checked(end)?;
            (address, after.strip_prefix('>')?)
        }
        None => text.split_at_checked(address_len(text)?)?,
    };
    let left = after.trim_start();
    let left = if left.len() < after.len() { without_title(left)? } else { left };
    Some((unescaped(address), left.strip_prefix(')')?))
}

fn address_len(text: &str) -> Option<usize> {
    let mut open = 0_usize;
    let mut letters = text.char_indices().peekable();
    while let Some((at, letter)) = letters.next() {
        match letter {
            '\\' => {
                letters.next_if(|(_, letter)| letter.is_ascii_punctuation());
            }
            '(' if open == MOST_PARENTHESES => return None,
            '(' => open += 1,
            ')' if open == 0 => return Some(at),
            ')' => open -= 1,
            ' ' | '\t' | '\n' => return (open == 0).then_some(at),
            _ if letter.is_control() => return None,
            _ => {}
        }
    }
    None
}

/// What follows on the words that browsers show over a link, if there are any: they are not shown
/// here.
fn without_title(text: &str) -> Option<&str> {
    let Some(begin) = text.chars().next().filter(|begin| ['"', '\'', '('].contains(begin)) else {
        return Some(text);
    };
    let inner = text.strip_prefix(begin)?;
    let end = match begin {
        '(' => end_of(inner, &[')', '(']),
        _ => end_of(inner, &[begin]),
    }?;
    let after = inner.get(end..)?;
    let after = after.strip_prefix(if begin == '(' { ')' } else { begin })?;
    Some(after.trim_start())
}

/// Where the first of these signs is that has no backslash before it.
fn end_of(text: &str, ends: &[char]) -> Option<usize> {
    let mut letters = text.char_indices();
    while let Some((at, letter)) = letters.next() {
        if letter == '\\' {
            letters.next();
        } else if ends.contains(&letter) {
            return Some(at);
        }
    }
    None
}

/// An address without backslashes before punctuation, and with entities read.
fn unescaped(text: &str) -> String {
    let mut read = String::with_capacity(text.len());
    let mut rest = text;
    while let Some(letter) = rest.chars().next() {
        let after = rest.strip_prefix(letter).unwrap_or_default();
        if let Some((letter, len)) = entity(rest) {
            read.push(letter);
            rest = rest.get(len..).unwrap_or_default();
            continue;
        }
        rest = after;
        match after.chars().next().filter(|next| letter == '\\' && next.is_ascii_punctuation()) {
            Some(next) => {
                read.push(next);
                rest = after.strip_prefix(next).unwrap_or_default();
            }
            None => read.push(letter),
        }
    }
    read
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn host_of_an_address_is_the_one_that_a_browser_asks() {
        for (address, host) in [
            ("https://example.org", "example.org"),
            ("https://example.org:8080/x?y#z", "example.org:8080"),
            ("https://good.org@evil.org/good.org", "evil.org"),
            ("https://evil.org\\@good.org", "evil.org"),
            ("https://evil.org?@good.org", "evil.org"),
            ("https://evil.org#@good.org", "evil.org"),
            ("nothing", "nothing"),
        ] {
            assert_eq!(host_of(address), host, "{address}");
        }
    }
}
