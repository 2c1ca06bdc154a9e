//! The order of the library's list: searched, sorted, and in groups.

use crate::ui::state::clip_order::ClipOrder;
use crate::ui::text;
use segue_motion::math::sort::sort_by;
use segue_session::{ClipGroup, Entry, Origin};
use segue_text::Message;
use std::cmp::Ordering;
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

/// Everything that the order of the list depends on.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct ArrangedFor {
    /// The session's revision.
    pub(super) revision: u64,
    /// The tag of the language, in which the names of built-in clips are.
    pub(super) language: &'static str,
    pub(super) order: ClipOrder,
    pub(super) search: String,
}

/// The arranged list.
#[derive(Clone, Debug)]
pub(crate) struct Arranged {
    pub(super) key: ArrangedFor,
    pub(super) sections: Vec<Section>,
}

/// A row of the list.
#[derive(Clone, Copy, Debug)]
pub(super) enum Row<'a> {
    /// The head of a section.
    Head(&'a Section),
    /// A clip.
    Clip(&'a Entry),
}

impl<'a> Row<'a> {
    /// Returns the clip; `None` for a head.
    pub(super) fn clip(&self) -> Option<&'a Entry> {
        if let Self::Clip(entry) = self { Some(entry) } else { None }
    }

    /// Returns whether its facts are known.
    pub(super) fn is_known(&self) -> bool {
        self.clip().is_some_and(Entry::is_known)
    }
}

/// The heights of rows as they were drawn last, points: those that are out of sight take as much
/// room.
#[derive(Clone, Debug)]
pub(crate) struct RowHeights {
    /// That of a clip.
    pub(super) clip: f32,
    /// That of a head.
    head: f32,
    /// Those of clips that have another one, by their ids: with their details, or with more to say.
    others: BTreeMap<String, f32>,
}

impl Default for RowHeights {
    fn default() -> Self {
        Self { clip: 44.0, head: 28.0, others: BTreeMap::new() }
    }
}

impl RowHeights {
    /// Returns the height of a row.
    pub(super) fn of(&self, row: &Row<'_>) -> f32 {
        match row {
            Row::Head(_) => self.head,
            Row::Clip(_) if self.others.is_empty() => self.clip,
            Row::Clip(entry) => self.others.get(&entry.id).copied().unwrap_or(self.clip),
        }
    }

    /// Records the height of a row that was drawn; `is_plain` says that it has no details, and no
    /// sentence in place of the facts.
    pub(super) fn note(&mut self, row: &Row<'_>, is_plain: bool, height: f32) {
        match row {
            Row::Head(_) => self.head = height,
            Row::Clip(entry) if is_plain => {
                self.clip = height;
                self.others.remove(&entry.id);
            }
            Row::Clip(entry) => {
                self.others.insert(entry.id.clone(), height);
            }
        }
    }
}

/// Neighbours in the list.
#[derive(Clone, Debug)]
pub(super) struct Section {
    /// The key under which it is folded, and its name; `None` for clips in no group.
    pub(super) head: Option<(String, Message)>,
    /// Whether the name of the group says how many files it has.
    pub(super) is_counted: bool,
    /// The indices of its clips in the library.
    pub(super) entries: Vec<usize>,
}

/// Returns the sections of the list: the user's clips alone, then their groups, then the built-in
/// clips. `search` is what names have to contain; `name_of` returns the name on screen.
pub(super) fn arrange(
    entries: &[Arc<Entry>],
    order: ClipOrder,
    search: &str,
    name_of: impl Fn(&Entry) -> String,
) -> Vec<Section> {
    let is_built_in = |entry: &Entry| matches!(entry.origin, Origin::Preset);
    let words: Vec<String> = search.split_whitespace().map(str::to_lowercase).collect();
    let mut shown: Vec<(usize, &Entry, String)> = (entries.iter().enumerate())
        .map(|(index, entry)| (index, &**entry, name_of(entry).to_lowercase()))
        .collect();
    shown.retain(|(.., name)| words.iter().all(|word| name.contains(word)));
    let secs =
        |entry: &Entry| entry.facts.as_ref().map_or(f64::INFINITY, |facts| facts.duration_secs());
    let speed = |entry: &Entry| entry.facts.as_ref().map_or(f32::INFINITY, |facts| facts.speed_mps);
    match order {
        ClipOrder::Added => {}
        ClipOrder::Name => sort_by(&mut shown, |(.., a), (.., b)| by_name(a, b)),
        ClipOrder::Length => {
            sort_by(&mut shown, |(_, a, _), (_, b, _)| secs(a).total_cmp(&secs(b)));
        }
        ClipOrder::Speed => {
            sort_by(&mut shown, |(_, a, _), (_, b, _)| speed(a).total_cmp(&speed(b)));
        }
    }
    let groups = groups_of(entries);
    let mut alone = Section { head: None, is_counted: false, entries: Vec::new() };
    let mut built_in = alone.clone();
    let mut grouped: Vec<Section> = Vec::new();
    // The places of the groups among them.
    let mut places: BTreeMap<ClipGroup, usize> = BTreeMap::new();
    for (index, entry, _) in shown {
        if is_built_in(entry) {
            built_in.entries.push(index);
            continue;
        }
        let group = entry.group().and_then(|group| Some((groups.get(&group)?.clone(), group)));
        let Some((head, group)) = group else {
            alone.entries.push(index);
            continue;
        };
        let is_counted = matches!(group, ClipGroup::Batch(_));
        let place = *places.entry(group).or_insert_with(|| {
            grouped.push(Section { head: Some(head), is_counted, entries: Vec::new() });
            grouped.len() - 1
        });
        if let Some(section) = grouped.get_mut(place) {
            section.entries.push(index);
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
            let name = |index: &usize| session.library().entries()[*index].name.clone();
            (head, section.entries.iter().map(name).collect())
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
    fn clips_are_ordered_by_speed() {
        let mut session = Session::new();
        session.make_all();
        let entries = session.library().entries();
        let sections = arrange(entries, ClipOrder::Speed, "", |entry| entry.name.clone());
        let speeds: Vec<f32> = sections[0]
            .entries
            .iter()
            .map(|&index| entries[index].facts.as_ref().expect("it was made").speed_mps)
            .collect();
        assert!(speeds.len() > 3 && speeds.is_sorted(), "{speeds:?}");
        assert!(speeds[0] < 0.5 && speeds[speeds.len() - 1] > 2.0, "{speeds:?}");
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
            .map(|&index| entries[index].facts.as_ref().expect("it was made").duration_secs())
            .collect();
        assert!(secs.len() > 3 && secs.is_sorted(), "{secs:?}");
    }
}
