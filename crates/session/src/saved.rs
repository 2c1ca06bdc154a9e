//! The stored state of the work, which survives a reload. The bytes of files are stored separately,
//! by their SHA-256.

use super::bone_map::{BoneMap, MAX_RIGS};
use super::clip_facts::ClipFacts;
use super::library::{Entry, Origin};
use super::reading::{About, SkeletonFile};
use segue_formats::{FileKind, ImportOptions};
use segue_motion::skeleton::Roles;
use segue_text::Message;
use serde::{Deserialize, Serialize};
use std::collections::BTreeSet;

/// The progress of storing.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum StorageState {
    /// Everything is stored.
    #[default]
    Done,
    /// Something is being written.
    UnderWay,
    /// Some files could not be stored.
    Incomplete,
}

/// The work without the bytes of its files.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Saved {
    /// The parameters, as a link.
    pub query: String,
    /// The library in order.
    pub entries: Vec<SavedEntry>,
    /// The corrected body parts of rigs; states that were stored without this field have none.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub bone_maps: Vec<BoneMap>,
}

impl Saved {
    /// Keeps clips in `there`, the stored state, that other windows added: those that are not among
    /// the `known`. This window never had them, so it cannot have removed them. Body parts of rigs
    /// that this window has not corrected are kept, too.
    #[must_use]
    pub fn with_others_of(mut self, there: &Self, known: &BTreeSet<String>) -> Self {
        let own: BTreeSet<&str> = self.entries.iter().map(|entry| entry.id.as_str()).collect();
        let is_of_others =
            |entry: &&SavedEntry| !own.contains(entry.id.as_str()) && !known.contains(&entry.id);
        let others: Vec<SavedEntry> = there.entries.iter().filter(is_of_others).cloned().collect();
        self.entries.extend(others);
        let is_new = |map: &&BoneMap| self.bone_maps.iter().all(|own| own.rig != map.rig);
        let others: Vec<BoneMap> = there.bone_maps.iter().filter(is_new).cloned().collect();
        self.bone_maps.extend(others);
        self.bone_maps.truncate(MAX_RIGS);
        self
    }

    /// Returns the SHA-256 of the files of all clips.
    #[must_use]
    pub fn files(&self) -> BTreeSet<&str> {
        let files = self.entries.iter().filter_map(|entry| entry.file.as_ref());
        files.map(|file| file.sha256.as_str()).collect()
    }
}

/// One clip of the library.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SavedEntry {
    /// Its id.
    pub id: String,
    /// Its name.
    pub name: String,
    /// The source file; `None` for clips that Segue can make or fetch again by their id.
    pub file: Option<SavedFile>,
    /// Roles that were corrected by hand.
    pub roles: Option<Roles>,
    /// Whether it is a bundled take. States that were stored without this field list all takes,
    /// requested or not.
    #[serde(default)]
    pub is_sample: bool,
    /// The number of the selection of files that it was opened with; states that were stored
    /// without this field have none.
    #[serde(default)]
    pub batch: Option<u32>,
    /// The facts of a clip of a file, so that it need not be read before it is used; states that
    /// were stored without this field have none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub known: Option<KnownClip>,
}

/// The facts about a clip of a file that is not read.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct KnownClip {
    /// The facts of its motion.
    pub facts: ClipFacts,
    /// The report on reading the file.
    #[serde(default)]
    pub about: Option<About>,
    /// The oddities of the file, one sentence each.
    #[serde(default)]
    pub warnings: Vec<Message>,
}

/// A file without its bytes.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SavedFile {
    /// The file's name.
    pub name: String,
    /// SHA-256 of its bytes, hexadecimal, which is the key of storage.
    pub sha256: String,
    /// The number of its bytes.
    #[serde(default)]
    pub size: u64,
    /// Its format.
    #[serde(default = "bvh")]
    pub kind: FileKind,
    /// The skeleton file that it is read with, by the name that earlier versions stored it by.
    #[serde(default, rename = "companion")]
    pub skeleton_file: Option<Box<SkeletonFile>>,
    /// The index of the clip in the file.
    pub index: usize,
    /// The options of reading it.
    pub options: ImportOptions,
}

/// Returns the only format of older states.
fn bvh() -> FileKind {
    FileKind::Bvh
}

impl From<&Entry> for SavedEntry {
    fn from(entry: &Entry) -> Self {
        let file = match &entry.origin {
            Origin::File(file) => Some(SavedFile {
                name: file.name.clone(),
                sha256: file.sha256.clone(),
                size: file.size,
                kind: file.kind,
                skeleton_file: file.skeleton_file.clone(),
                index: file.index,
                options: file.options,
            }),
            Origin::Preset | Origin::Sample(_) | Origin::Made => None,
        };
        let facts = entry.facts.as_ref().filter(|_| file.is_some() && entry.unread.is_none());
        Self {
            id: entry.id.clone(),
            name: entry.name.clone(),
            file,
            roles: entry.roles_by_hand.clone(),
            is_sample: matches!(entry.origin, Origin::Sample(_)),
            batch: entry.batch,
            known: facts.map(|facts| KnownClip {
                facts: ClipFacts::clone(facts),
                about: entry.about.clone(),
                warnings: entry.warnings.clone(),
            }),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn saved(query: &str, ids: &[&str]) -> Saved {
        let entry = |id: &&str| SavedEntry {
            id: (*id).to_owned(),
            name: format!("{id} of {query}"),
            file: id.split_once('~').map(|(name, sha256)| SavedFile {
                name: name.to_owned(),
                sha256: sha256.to_owned(),
                size: 1,
                kind: FileKind::Bvh,
                skeleton_file: None,
                index: 0,
                options: ImportOptions::default(),
            }),
            roles: None,
            is_sample: false,
            batch: None,
            known: None,
        };
        Saved {
            query: query.to_owned(),
            entries: ids.iter().map(entry).collect(),
            ..Saved::default()
        }
    }

    fn names(saved: &Saved) -> Vec<&str> {
        saved.entries.iter().map(|entry| entry.name.as_str()).collect()
    }

    #[test]
    fn saved_keeps_clips_of_other_windows_and_drops_removed_ones() {
        let known = ["walk", "x~11", "y~22"].map(str::to_owned).into();
        let here = saved("t=1", &["walk", "x~11"]);
        let there = saved("t=2", &["walk", "y~22", "theirs~33", "run(turn_rate:20)"]);
        let written = here.clone().with_others_of(&there, &known);
        assert_eq!(written.query, "t=1");
        assert_eq!(
            names(&written),
            ["walk of t=1", "x~11 of t=1", "theirs~33 of t=2", "run(turn_rate:20) of t=2"]
        );
        assert_eq!(written.files(), BTreeSet::from(["11", "33"]));
        // Written again without changes by the others, it stays the same.
        assert_eq!(here.clone().with_others_of(&written, &known), written);
        assert_eq!(here.clone().with_others_of(&Saved::default(), &known), here);
        // Two windows write in turn: neither loses the other's clips.
        let theirs = there.with_others_of(&here, &["y~22".to_owned()].into());
        assert!(names(&theirs).contains(&"x~11 of t=1"));
    }

    #[test]
    fn saved_skeleton_file_keeps_its_stored_name() {
        let mut state = saved("t=1", &["01_01.amc~11"]);
        let file = state.entries[0].file.as_mut().unwrap();
        file.skeleton_file = Some(Box::new(SkeletonFile::new("01.asf", b":root")));
        let record = serde_json::to_value(&state).unwrap();
        assert_eq!(record["entries"][0]["file"]["companion"]["name"], "01.asf");
        assert_eq!(serde_json::from_value::<Saved>(record).unwrap(), state);
    }
}
