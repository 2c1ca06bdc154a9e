//! Tags that are set by hand, beside those that speed and turn rate suggest.

use crate::labs::LabError;
use crate::outside::short;
use crate::params::{HandTag, Key, Params};
use segue_motion::matching::{Database, DatabaseClip, RATE, Tag, TagFilter, TagRange, TagSet};
use std::sync::Arc;

/// Returns the users' own tags, in order of appearance.
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

/// Returns the tag of a word.
fn tag_of(word: &str, own: &[&str]) -> Option<Tag> {
    let fixed = Tag::FIXED.into_iter().find(|tag| tag.name() == word);
    fixed.or_else(|| {
        let number = u8::try_from(own.iter().position(|other| *other == word)?).ok()?;
        (number < Tag::MAX_OWN).then_some(Tag::Own(number))
    })
}

/// Returns the filter for the frames that a search may find.
pub(crate) fn filter_of(params: &Params) -> Result<TagFilter, LabError> {
    let own = own_words(params.tags());
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

/// Returns the name of a motion's clip in parameters: its id if the database was built from clips,
/// its own name in the synthesised set.
pub(crate) fn clip_name<'a>(motion: &'a DatabaseClip, ids: &'a [String]) -> &'a str {
    ids.get(motion.source()).map_or(motion.clip().name(), String::as_str)
}

/// Returns a database with tags set by hand; `ids` are its clips, empty for the synthesised set.
/// Tags of clips that are not in it are skipped.
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

/// Returns the parts of a range that are left when a tag is removed from a stretch.
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

    #[test]
    fn own_words_exclude_the_fixed_ones() {
        let hand = |word: &str| HandTag {
            clip: "walk".into(),
            secs: [0.0, 1.0],
            word: word.into(),
            takes_away: false,
        };
        let tags = ["exclude", "very proud", "turn", "very proud"].map(hand);
        assert_eq!(own_words(&tags), ["very proud"]);
    }

    #[test]
    fn tag_removed_in_the_middle_leaves_both_ends() {
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
