//! The order of the library's list: searched, sorted, and in groups.

use crate::ui::state::ClipOrder;
use crate::ui::text;
use segue_motion::math::sort::sort_by;
use segue_session::{ClipGroup, Entry, Origin};
use segue_text::Message;
use std::cmp::Ordering;
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

/// Neighbours in the list.
#[derive(Clone, Debug)]
pub(super) struct Section<'a> {
    /// The key under which it is folded, and its name; `None` for clips in no group.
    pub(super) head: Option<(String, Message)>,
    /// Whether the name of the group says how many files it has.
    pub(super) is_counted: bool,
    /// Its clips.
    pub(super) entries: Vec<&'a Entry>,
}

/// Returns the sections of the list: the user's clips alone, then their groups, then the built-in
/// clips. `search` is what names have to contain; `name_of` returns the name on screen.
pub(super) fn arrange<'a>(
    entries: &'a [Arc<Entry>],
    order: ClipOrder,
    search: &str,
    name_of: impl Fn(&Entry) -> String,
) -> Vec<Section<'a>> {
    let is_built_in = |entry: &Entry| matches!(entry.origin, Origin::Preset);
    let words: Vec<String> = search.split_whitespace().map(str::to_lowercase).collect();
    let mut shown: Vec<(&'a Entry, String)> =
        entries.iter().map(|entry| (&**entry, name_of(entry).to_lowercase())).collect();
    shown.retain(|(_, name)| words.iter().all(|word| name.contains(word)));
    let secs = |entry: &Entry| {
        entry.motion.as_ref().map_or(f64::INFINITY, |motion| motion.clip().duration_secs())
    };
    match order {
        ClipOrder::Added => {}
        ClipOrder::Name => sort_by(&mut shown, |(_, a), (_, b)| by_name(a, b)),
        ClipOrder::Length => sort_by(&mut shown, |(a, _), (b, _)| secs(a).total_cmp(&secs(b))),
    }
    let groups = groups_of(entries);
    let mut alone = Section { head: None, is_counted: false, entries: Vec::new() };
    let mut built_in = alone.clone();
    let mut grouped: Vec<Section<'a>> = Vec::new();
    for (entry, _) in shown {
        if is_built_in(entry) {
            built_in.entries.push(entry);
            continue;
        }
        let Some((key, title)) = entry.group().and_then(|group| groups.get(&group)) else {
            alone.entries.push(entry);
            continue;
        };
        let is_same = |section: &&mut Section<'_>| {
            section.head.as_ref().is_some_and(|(known, _)| known == key)
        };
        match grouped.iter_mut().find(is_same) {
            Some(section) => section.entries.push(entry),
            None => grouped.push(Section {
                head: Some((key.clone(), title.clone())),
                is_counted: matches!(entry.group(), Some(ClipGroup::Batch(_))),
                entries: vec![entry],
            }),
        }
    }
    // Among clips of the user's the built-in ones are a group as well.
    if entries.iter().any(|entry| !is_built_in(entry)) {
        built_in.head = Some(("built-in".to_owned(), text::BUILT_IN.into()));
    }
    let sections = std::iter::once(alone).chain(grouped).chain([built_in]);
    sections.filter(|section| !section.entries.is_empty()).collect()
}

/// Returns the groups of more than one clip, each with its key and its name.
fn groups_of(entries: &[Arc<Entry>]) -> BTreeMap<ClipGroup, (String, Message)> {
    let mut members: BTreeMap<ClipGroup, Vec<&Entry>> = BTreeMap::new();
    for entry in entries {
        if let Some(group) = entry.group() {
            members.entry(group).or_default().push(entry);
        }
    }
    members.retain(|_, entries| entries.len() > 1);
    let named = members.into_iter().map(|(group, entries)| {
        let named = match &group {
            ClipGroup::Folder(name) => (format!("folder:{name}"), Message::data(&**name)),
            ClipGroup::Batch(number) => {
                let files: BTreeSet<_> =
                    entries.iter().filter_map(|entry| entry.sha256()).collect();
                (format!("batch:{number}"), text::opened_files(files.len()))
            }
            ClipGroup::File(sha256) => {
                let name = entries.iter().find_map(|entry| match &entry.origin {
                    Origin::File(file) => Some(file.name.clone()),
                    _ => None,
                });
                (format!("file:{sha256}"), Message::data(name.unwrap_or_default()))
            }
        };
        (group, named)
    });
    named.collect()
}

/// Compares names as people do: numbers in them by their value.
fn by_name(a: &str, b: &str) -> Ordering {
    let (mut a, mut b) = (a, b);
    loop {
        let (head_a, rest_a) = head_of(a);
        let (head_b, rest_b) = head_of(b);
        let order = match (head_a.parse::<u64>(), head_b.parse::<u64>()) {
            (Ok(number_a), Ok(number_b)) => number_a.cmp(&number_b).then(head_a.cmp(head_b)),
            _ => head_a.cmp(head_b),
        };
        if order != Ordering::Equal || (rest_a.is_empty() && rest_b.is_empty()) {
            return order;
        }
        (a, b) = (rest_a, rest_b);
    }
}

/// Splits a name behind its first digits, or before them if it does not begin with any.
fn head_of(name: &str) -> (&str, &str) {
    let is_number = name.starts_with(|letter: char| letter.is_ascii_digit());
    let end = name.find(|letter: char| letter.is_ascii_digit() != is_number);
    name.split_at(end.unwrap_or(name.len()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use segue_session::Session;

    const BVH: &str = "HIERARCHY ROOT Hips { OFFSET 0 1 0 CHANNELS 1 Yrotation End Site { OFFSET 0 0.7 0 } } MOTION Frames: 2 Frame Time: .1\n1\n";

    /// Returns a session with files of these names. The files of a tuple are opened together.
    fn session(batches: &[&[&str]]) -> Session {
        let mut session = Session::new();
        let mut turn = 1;
        for batch in batches {
            session.open_together(batch.len());
            for name in *batch {
                turn += 1;
                let bytes = format!("{BVH}{turn}").into_bytes();
                session.load(name, bytes.into()).expect("a small file");
            }
        }
        session
    }

    fn shown(session: &Session, order: ClipOrder, search: &str) -> Vec<(String, Vec<String>)> {
        let sections =
            arrange(session.library().entries(), order, search, |entry| entry.name.clone());
        let own = sections.into_iter().map(|section| {
            let head = section.head.map_or_else(String::new, |(_, title)| title.to_string());
            (head, section.entries.iter().map(|entry| entry.name.clone()).collect())
        });
        own.collect()
    }

    #[test]
    fn clips_are_in_groups_of_what_came_together() {
        let session = session(&[
            &["x.bvh"],
            &["takes/b.bvh", "takes/day 2/a.bvh"],
            &["one.bvh", "two.bvh", "three.bvh"],
            &["y.bvh"],
        ]);
        let all = shown(&session, ClipOrder::Added, "");
        let heads: Vec<&str> = all.iter().map(|(head, _)| head.as_str()).collect();
        assert_eq!(heads, ["", "takes", "3 files", "Built-in clips"]);
        assert_eq!(all[0].1, ["x", "y"]);
        assert_eq!(all[1].1, ["b", "a"]);
        assert_eq!(shown(&session, ClipOrder::Name, "")[1].1, ["a", "b"]);
        // A group stays one when the search leaves one clip of it.
        assert_eq!(
            shown(&session, ClipOrder::Added, " TW "),
            [("3 files".to_owned(), vec!["two".to_owned()])]
        );
        assert!(shown(&session, ClipOrder::Added, "no such clip").is_empty());
        let built_in = arrange(Session::new().library().entries(), ClipOrder::Added, "", |entry| {
            entry.name.clone()
        })
        .len();
        assert_eq!(built_in, 1, "without own clips there is one section without a head");
    }

    #[test]
    fn names_are_ordered_by_the_numbers_in_them() {
        let mut names = ["walk_10", "walk_9", "Walk", "walk_9b", "2", "10", "walk_009"];
        names.sort_by(|a, b| by_name(a, b));
        assert_eq!(names, ["2", "10", "Walk", "walk_009", "walk_9", "walk_9b", "walk_10"]);
    }

    #[test]
    fn clips_are_ordered_by_length() {
        let mut session = Session::new();
        session.make_all();
        let entries = session.library().entries();
        let sections = arrange(entries, ClipOrder::Length, "", |entry| entry.name.clone());
        let secs: Vec<f64> = sections[0]
            .entries
            .iter()
            .map(|entry| entry.motion.as_ref().expect("it was made").clip().duration_secs())
            .collect();
        assert!(secs.len() > 3 && secs.is_sorted(), "{secs:?}");
    }
}
