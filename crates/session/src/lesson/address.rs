//! Addresses in links, and the entities that addresses and texts may contain.

/// The greatest nesting of parentheses in an address.
const MAX_PARENTHESES: usize = 32;

/// The known entities.
const ENTITIES: [(&str, char); 5] =
    [("&amp;", '&'), ("&lt;", '<'), ("&gt;", '>'), ("&quot;", '"'), ("&nbsp;", '\u{a0}')];

/// Returns the host that an address with `://` leads to, with its port, as browsers read it: text
/// before an `@` or after a slash of either kind is not the host. Returns the address itself if it
/// has none.
#[must_use]
pub fn host_of(address: &str) -> &str {
    let rest = address.split_once("://").map_or(address, |(_, rest)| rest);
    let authority = rest.split(['/', '\\', '?', '#']).next().unwrap_or(rest);
    let host = authority.rsplit('@').next().unwrap_or(authority);
    if host.is_empty() { address } else { host }
}

/// Returns the character of an entity at the beginning of a text, and the length of the entity in
/// bytes.
pub(super) fn entity(text: &str) -> Option<(char, usize)> {
    let (name, letter) = ENTITIES.iter().find(|(name, _)| text.starts_with(name))?;
    Some((*letter, name.len()))
}

/// Returns the address that stands alone between `<` and `>`.
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

/// Returns the address after `](` up to the matching `)`, and the text after that.
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
            '(' if open == MAX_PARENTHESES => return None,
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

/// Returns the text after the title of a link, if there is one: browsers show titles on hover,
/// Segue does not.
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

/// Returns the position of the first of some characters without a backslash before it.
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

/// Returns an address without backslashes before punctuation, and with entities decoded.
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
    fn host_of_an_address_is_that_of_browsers() {
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
