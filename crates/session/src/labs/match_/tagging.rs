//! Tags that are set by hand, beside those that speed and turn rate suggest:
//! `walk:0.2-1.5:exclude,run:0-1:-turn,walk:2-3:proud`.

use crate::labs::LabError;
use crate::labs::recipe::{read_ids, write_ids};
use crate::outside::short;
use crate::params::{Key, Params, format_number};
use segue_motion::matching::{Database, DatabaseClip, RATE, Tag, TagFilter, TagRange, TagSet};
use std::sync::Arc;

/// A link with more tags is an accident.
const MOST_TAGS: usize = 200;
/// A word of one's own is no longer than this, characters.
const LONGEST_WORD: usize = 24;

/// A stretch of a clip that gets a tag, or loses one.
#[derive(Clone, Debug, PartialEq)]
pub struct HandTag {
    /// The clip's id, or the name of one of the synthesiser's set.
    pub clip: String,
    /// From and to, seconds in the clip.
    pub secs: [f64; 2],
    /// `walk`, `run`, `idle`, `turn`, `exclude`, or a word of one's own.
    pub word: String,
    /// The tag is taken away there.
    pub takes_away: bool,
}

/// Reads the parameter `tags`.
pub(crate) fn read_tags(text: &str) -> Result<Vec<HandTag>, LabError> {
    if text.trim().is_empty() {
        return Ok(Vec::new());
    }
    let refuse = |found: &str| LabError::Tags { found: short(found) };
    let parts = read_ids(text).ok_or_else(|| refuse(text))?;
    if parts.len() > MOST_TAGS {
        return Err(LabError::TooMany { what: "Tags", count: parts.len(), most: MOST_TAGS });
    }
    parts.iter().map(|part| read_tag(part).ok_or_else(|| refuse(part))).collect()
}

fn read_tag(part: &str) -> Option<HandTag> {
    let (rest, word) = part.rsplit_once(':')?;
    let (clip, secs) = rest.rsplit_once(':')?;
    let (from, to) = secs.split_once('-')?;
    let number =
        |text: &str| text.trim().parse().ok().filter(|secs: &f64| secs.is_finite() && *secs >= 0.0);
    let secs = [number(from)?, number(to)?];
    let (word, takes_away) =
        word.trim().strip_prefix('-').map_or((word.trim(), false), |word| (word, true));
    let is_word = !word.is_empty() && word.chars().count() <= LONGEST_WORD;
    (is_word && !clip.is_empty() && secs[0] < secs[1]).then(|| HandTag {
        clip: clip.to_owned(),
        secs,
        word: word.to_owned(),
        takes_away,
    })
}

/// Writes tags as the parameter `tags` has them, to hundredths of a second.
#[must_use]
pub fn write_tags(tags: &[HandTag]) -> String {
    let written = |tag: &HandTag| {
        let [from, to] = tag.secs.map(|secs| format_number(secs, 0.01));
        let sign = if tag.takes_away { "-" } else { "" };
        // What would end a part of the list ends no word.
        let word = tag.word.replace([',', ':', '(', ')', '%'], " ");
        format!("{}:{from}-{to}:{sign}{}", write_ids(std::slice::from_ref(&tag.clip)), word.trim())
    };
    tags.iter().map(written).collect::<Vec<_>>().join(",")
}

/// The words of one's own among tags, in the order in which they come.
#[must_use]
pub fn own_words(tags: &[HandTag]) -> Vec<&str> {
    let mut words: Vec<&str> = Vec::new();
    for tag in tags {
        let is_fixed = Tag::FIXED.iter().any(|fixed| fixed.name() == tag.word);
        if !is_fixed && !words.contains(&tag.word.as_str()) {
            words.push(&tag.word);
        }
    }
    words
}

/// What a word stands for.
fn tag_of(word: &str, own: &[&str]) -> Option<Tag> {
    let fixed = Tag::FIXED.into_iter().find(|tag| tag.name() == word);
    fixed.or_else(|| {
        let number = u8::try_from(own.iter().position(|other| *other == word)?).ok()?;
        (number < Tag::MAX_OWN).then_some(Tag::Own(number))
    })
}

/// Which frames may be found.
pub(crate) fn filter_of(params: &Params) -> Result<TagFilter, LabError> {
    let tags = read_tags(params.text(Key::Tags))?;
    let own = own_words(&tags);
    let set = |key: Key| {
        let word = params.text(key).trim();
        if word.is_empty() || word == key.param().format(&key.param().default_value()) {
            return Ok(TagSet::NONE);
        }
        let tag = tag_of(word, &own).ok_or_else(|| LabError::NoTag { word: short(word) })?;
        Ok::<_, LabError>(TagSet::of(&[tag]))
    };
    Ok(TagFilter { ask: set(Key::AskTag)?, forbid: set(Key::ForbidTag)? })
}

/// What a motion's clip is called in parameters: its id among those that the database was built
/// from, its own name in the synthesiser's set.
pub(crate) fn clip_name<'a>(motion: &'a DatabaseClip, ids: &'a [String]) -> &'a str {
    ids.get(motion.source()).map_or(motion.clip().name(), String::as_str)
}

/// A database with tags by hand; `ids` are the clips that it was built from, none for the
/// synthesiser's set. Clips that are not in it are passed over.
pub(super) fn tagged(database: &Database, ids: &[String], tags: &[HandTag]) -> Database {
    let own = own_words(tags);
    let mut result = database.clone();
    let originals: Vec<_> =
        database.motions().iter().filter(|motion| !motion.is_mirrored()).map(Arc::clone).collect();
    for motion in originals {
        let name = clip_name(&motion, ids);
        let mut ranges = motion.tags().to_vec();
        let of_this = tags.iter().filter(|tag| tag.clip == name);
        let mut changed = false;
        for hand in of_this {
            let Some(tag) = tag_of(&hand.word, &own) else {
                continue;
            };
            let [from, to] =
                hand.secs.map(|secs| ((secs * RATE as f64).round() as usize).min(motion.frames()));
            if hand.takes_away {
                ranges =
                    ranges.into_iter().flat_map(|range| without(range, tag, from, to)).collect();
            } else {
                ranges.push(TagRange { tag, frames: from..to });
            }
            changed = true;
        }
        if changed {
            result = result.retagged(motion.source(), &ranges);
        }
    }
    result
}

/// What is left of a range when a tag is taken away from a stretch.
fn without(range: TagRange, tag: Tag, from: usize, to: usize) -> Vec<TagRange> {
    if range.tag != tag {
        return vec![range];
    }
    let before = range.frames.start..range.frames.end.min(from);
    let after = range.frames.start.max(to)..range.frames.end;
    [before, after]
        .into_iter()
        .filter(|frames| !frames.is_empty())
        .map(|frames| TagRange { tag, frames })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn hand(clip: &str, secs: [f64; 2], word: &str, takes_away: bool) -> HandTag {
        HandTag { clip: clip.into(), secs, word: word.into(), takes_away }
    }

    #[test]
    fn tags_read_back_as_written() {
        let tags = vec![
            hand("walk(make_seconds:6)", [0.2, 1.5], "exclude", false),
            hand("a, b: c~0a1b2c3d", [0.0, 2.0], "turn", true),
            hand("run", [1.0, 1.25], "very proud", false),
        ];
        assert_eq!(read_tags(&write_tags(&tags)), Ok(tags.clone()));
        assert_eq!(own_words(&tags), ["very proud"]);
        for bad in [
            "walk",
            "walk:1-2",
            "walk:2-1:run",
            "walk:0-NaN:run",
            "walk:0-1:",
            "walk:0-1:-",
            ":0-1:run",
            "walk(:0-1:run",
        ] {
            assert!(read_tags(bad).is_err(), "{bad}");
        }
        assert_eq!(read_tags(" "), Ok(vec![]));
    }

    #[test]
    fn a_tag_is_taken_away_from_the_middle() {
        let range = TagRange { tag: Tag::Walk, frames: 10..50 };
        let left: Vec<_> = without(range.clone(), Tag::Walk, 20, 30)
            .into_iter()
            .map(|range| range.frames)
            .collect();
        assert_eq!(left, [10..20, 30..50]);
        assert_eq!(without(range.clone(), Tag::Walk, 0, 60), []);
        assert_eq!(without(range.clone(), Tag::Run, 0, 60), [range]);
    }
}
