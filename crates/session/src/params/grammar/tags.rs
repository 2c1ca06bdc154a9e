//! Tags that are set by hand: `walk:0.2-1.5:exclude,run:0-1:-turn,walk:2-3:proud`.

use super::clip_ids::{all_parts, escaped, read_id, write_id};
use super::{Misread, entries, joined};

/// The greatest number of tags; a link with more is an accident.
const MAX_TAGS: usize = 200;
/// The longest word of a tag, in characters.
const MAX_WORD: usize = 24;

/// A stretch of a clip to which a tag is added, or from which one is removed.
#[derive(Clone, Debug, PartialEq)]
pub struct HandTag {
    /// The clip's id, or the name of one of the synthesiser's set.
    pub clip: String,
    /// From and to, seconds in the clip.
    pub secs: [f64; 2],
    /// `walk`, `run`, `idle`, `turn`, `exclude`, or a word of one's own.
    pub word: String,
    /// Whether the tag is removed there.
    pub takes_away: bool,
}

pub(super) fn read(text: &str) -> Result<Vec<HandTag>, Misread> {
    let parts = all_parts(text)?.into_iter().map(str::trim).filter(|part| !part.is_empty());
    let expected = "a clip, its seconds and a word, as in walk:0.2-1.5:exclude";
    entries(parts, MAX_TAGS, expected, read_tag)
}

fn read_tag(entry: &str) -> Option<HandTag> {
    let (rest, word) = entry.rsplit_once(':')?;
    let (clip, secs) = rest.rsplit_once(':')?;
    let (from, to) = secs.split_once('-')?;
    let number =
        |text: &str| text.trim().parse().ok().filter(|secs: &f64| secs.is_finite() && *secs >= 0.0);
    let secs = [number(from)?, number(to)?].map(f64::abs);
    let (word, takes_away) =
        word.trim().strip_prefix('-').map_or((word.trim(), false), |word| (word, true));
    let word = read_id(word).trim().to_owned();
    // A minus sign before the word removes the tag.
    let is_word = !word.is_empty()
        && (takes_away || !word.starts_with('-'))
        && word.chars().count() <= MAX_WORD;
    let clip = clip.trim();
    (is_word && !clip.is_empty() && secs[0] < secs[1]).then(|| HandTag {
        clip: read_id(clip),
        secs,
        word,
        takes_away,
    })
}

pub(super) fn write(tags: &[HandTag]) -> String {
    joined(tags, |tag| {
        let [from, to] = tag.secs;
        let sign = if tag.takes_away { "-" } else { "" };
        format!("{}:{from}-{to}:{sign}{}", write_id(&tag.clip), escaped(tag.word.trim()))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn tag(clip: &str, secs: [f64; 2], word: &str, takes_away: bool) -> HandTag {
        HandTag { clip: clip.into(), secs, word: word.into(), takes_away }
    }

    #[test]
    fn tags_read_back_as_written() {
        let tags = vec![
            tag("walk(make_seconds:6)", [0.2, 1.5], "exclude", false),
            tag("blend(a:my%2C walk.bvh,b:run)", [0.2, 1.5], "exclude", false),
            tag("a, b: c~0a1b2c3d", [0.0, 2.0], "turn", true),
            tag("run", [1.0, 1.25], "very proud", false),
            tag("run", [1.0, 1.25], "a, b: (c) 100 %", true),
        ];
        assert_eq!(read(&write(&tags)), Ok(tags.clone()));
        for text in ["walk:0.2-1.5:exclude,run:0-1:-turn,walk:2-3:proud", "walk:0.125-1:very proud"]
        {
            assert_eq!(write(&read(text).unwrap()), text);
        }
        assert_eq!(read(" "), Ok(vec![]));
    }

    #[test]
    fn invalid_tag_is_named() {
        for bad in [
            "walk",
            "walk:1-2",
            "walk:2-1:run",
            "walk:0-NaN:run",
            "walk:0-1:",
            "walk:0-1:-",
            ":0-1:run",
        ] {
            let error = read(&format!("run:0-1:turn,{bad}")).unwrap_err().to_string();
            assert!(error.starts_with(&format!("entry 2: found `{bad}`")), "{error}");
        }
        assert!(read("walk(:0-1:run").is_err());
    }
}
