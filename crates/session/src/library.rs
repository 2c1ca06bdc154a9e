//! The library of clips: built in, dropped, or made in labs.

use super::bone_map::{BoneMap, BoneMaps, MAX_RIGS, mapped};
use super::clip_facts::ClipFacts;
use super::outside;
use super::reading::{About, Content, LARGE_BYTES, SkeletonFile};
use super::samples::Sample;
use segue_formats::{FileKind, ImportOptions};
use segue_motion::clip::Motion;
use segue_motion::skeleton::Roles;
use segue_motion::skin::{Character, SkinnedMesh};
use segue_text::Message;
use std::collections::BTreeMap;
use std::sync::Arc;

/// The way in which a file has arrived.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Arrival {
    /// The user dropped or opened it, or the page's API handed it over; with the number of the
    /// selection if it was one of several files.
    ByHand(Option<u32>),
    /// It was fetched from an address in the link.
    ByLink,
}

impl Arrival {
    /// Returns whether the user opened the file.
    pub(crate) fn is_by_hand(self) -> bool {
        matches!(self, Self::ByHand(_))
    }

    /// Returns the number of the selection that the file belongs to.
    pub(crate) fn batch(self) -> Option<u32> {
        match self {
            Self::ByHand(batch) => batch,
            Self::ByLink => None,
        }
    }
}

/// The origin of a clip.
#[derive(Clone, Debug, PartialEq)]
pub enum Origin {
    /// The synthesiser, with the id of a preset.
    Preset,
    /// A bundled take, loaded on request.
    Sample(&'static Sample),
    /// A file that was dropped, opened or fetched.
    File(SourceFile),
    /// A kept result; its id is its recipe.
    Made,
}

/// A source file, kept so that it can be stored and read again with other options.
#[derive(Clone, Debug, PartialEq)]
pub struct SourceFile {
    /// The file's name.
    pub name: String,
    /// SHA-256 of its bytes, lower-case hexadecimal.
    pub sha256: String,
    /// Its bytes.
    pub content: Content,
    /// The number of its bytes.
    pub size: u64,
    /// Its format.
    pub kind: FileKind,
    /// The skeleton file that it was read with.
    pub skeleton_file: Option<Box<SkeletonFile>>,
    /// The index of the clip in the file.
    pub index: usize,
    /// The options that the user set: unit, up axis and frame rate.
    pub options: ImportOptions,
}

impl SourceFile {
    /// Returns whether reading it takes longer than a frame.
    #[must_use]
    pub fn is_large(&self) -> bool {
        self.size > LARGE_BYTES
    }

    /// Returns whether it was read in the same way as another file: the same clip of the same bytes
    /// with the same options and the same skeleton.
    pub(crate) fn is_read_like(&self, other: &Self) -> bool {
        (&self.sha256, self.index, self.options, &self.skeleton_file)
            == (&other.sha256, other.index, other.options, &other.skeleton_file)
    }
}

/// A clip in the library.
#[derive(Clone, Debug)]
pub struct Entry {
    /// The unique id, used in links.
    pub id: String,
    /// The name on screen.
    pub name: String,
    /// Its name when it was added.
    pub own_name: Message,
    /// The origin.
    pub origin: Origin,
    /// The motion; `None` for a bundled take that has not been loaded, a preset that has not been
    /// used, a file that is being read, and one whose motion nothing has needed for a while: it is
    /// read again when it is needed. [`Entry::set_motion`] keeps the facts in step.
    pub motion: Option<Arc<Motion>>,
    /// The facts of the motion, which stay known while it is not here; `None` before it was first
    /// made or read.
    pub facts: Option<Arc<ClipFacts>>,
    /// The mesh of the file on the clip's skeleton.
    pub mesh: Option<Arc<SkinnedMesh>>,
    /// The reason why a known file has no motion: reading it failed or was stopped. It is read
    /// again on request.
    pub unread: Option<Message>,
    /// The report on reading its file; `None` without a file, and until it is read.
    pub about: Option<About>,
    /// The oddities of the file, one sentence each.
    pub warnings: Vec<Message>,
    /// The roles, if they were corrected by hand.
    pub roles_by_hand: Option<Roles>,
    /// The number of the selection of files that it was opened with; `None` if its file was opened
    /// alone.
    pub batch: Option<u32>,
}

/// The clips that an entry arrived with.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum ClipGroup {
    /// Those of a folder or an archive, by its name.
    Folder(String),
    /// Those of several files that were opened or dropped together, by a number.
    Batch(u32),
    /// Those of one file, by its SHA-256.
    File(String),
}

impl Entry {
    /// Returns an entry of which only the origin is known.
    pub(super) fn new(id: impl Into<String>, name: impl Into<Message>, origin: Origin) -> Self {
        let own_name = name.into();
        Self {
            id: id.into(),
            name: own_name.to_string(),
            own_name,
            origin,
            motion: None,
            facts: None,
            mesh: None,
            unread: None,
            about: None,
            warnings: Vec::new(),
            roles_by_hand: None,
            batch: None,
        }
    }

    /// Sets the motion, and its facts.
    pub(crate) fn set_motion(&mut self, motion: Arc<Motion>) {
        self.facts = Some(Arc::new(ClipFacts::of(&motion, self.mesh.is_some())));
        self.motion = Some(motion);
    }

    /// Gives a clip that was just read or made the roles of its rig's map, if there is one.
    pub(crate) fn take_mapped_roles(&mut self, maps: &BoneMaps) {
        let Some(motion) = &self.motion else { return };
        let Some(roles) = mapped(maps, motion.clip().skeleton(), motion.roles()) else { return };
        if roles != *motion.roles() {
            let corrected = Motion::clone(motion).with_corrected_roles(&roles);
            self.set_motion(Arc::new(corrected));
        }
        self.roles_by_hand = Some(roles);
    }

    /// Returns the entry with a motion.
    pub(crate) fn with_motion(mut self, motion: Arc<Motion>) -> Self {
        self.set_motion(motion);
        self
    }

    /// Drops the motion and the mesh; the facts stay.
    pub(crate) fn drop_motion(&mut self) {
        (self.motion, self.mesh) = (None, None);
    }

    /// Returns whether its motion can be had: it is here, or it was, and is read again when it is
    /// needed.
    #[must_use]
    pub fn is_known(&self) -> bool {
        self.facts.is_some() && self.unread.is_none()
    }

    /// Returns whether it is a motion of several frames. A skeleton or a character alone is not.
    #[must_use]
    pub fn moves(&self) -> bool {
        self.facts.as_ref().is_some_and(|facts| facts.moves())
    }

    /// Returns whether its file has a mesh on its skeleton.
    #[must_use]
    pub fn has_mesh(&self) -> bool {
        self.facts.as_ref().is_some_and(|facts| facts.has_mesh)
    }

    /// Returns the clips that it arrived with; `None` for a clip that is in no file.
    #[must_use]
    pub fn group(&self) -> Option<ClipGroup> {
        let Origin::File(file) = &self.origin else {
            return None;
        };
        let folder = file.name.split_once('/').map(|(folder, _)| folder);
        Some(match (folder, self.batch) {
            (Some(folder), _) => ClipGroup::Folder(folder.to_owned()),
            (None, Some(batch)) => ClipGroup::Batch(batch),
            (None, None) => ClipGroup::File(file.sha256.clone()),
        })
    }

    /// Returns the name on screen. The name of a built-in clip and of a result is the program's
    /// own, and is translated; a name that was given by hand or by a file is data.
    #[must_use]
    pub fn title(&self) -> Message {
        if self.name == self.own_name.to_string() {
            self.own_name.clone()
        } else {
            Message::data(&*self.name)
        }
    }

    /// Returns the format in the API.
    #[must_use]
    pub fn format(&self) -> &'static str {
        match &self.origin {
            Origin::Preset | Origin::Made => "synth",
            Origin::Sample(_) => "bvh",
            Origin::File(file) => file.kind.name(),
        }
    }

    /// Returns whether it is a motion whose skeleton is missing.
    #[must_use]
    pub fn awaits_skeleton(&self) -> bool {
        let motion_alone =
            |file: &SourceFile| file.kind == FileKind::Amc && file.skeleton_file.is_none();
        self.facts.is_none() && matches!(&self.origin, Origin::File(file) if motion_alone(file))
    }

    /// Returns the character of the file: its mesh on the clip's skeleton. `None` without a mesh,
    /// and until the file is read.
    #[must_use]
    pub fn character(&self) -> Option<Character> {
        let motion = self.motion.as_ref()?;
        Some(Character {
            skeleton: Arc::clone(motion.clip().skeleton()),
            roles: motion.roles().clone(),
            mesh: Arc::clone(self.mesh.as_ref()?),
        })
    }

    /// Returns the whole SHA-256 of its file, hexadecimal.
    #[must_use]
    pub fn sha256(&self) -> Option<&str> {
        if let Origin::File(file) = &self.origin { Some(&file.sha256) } else { None }
    }
}

/// The list of clips, in the order on screen.
#[derive(Clone, Debug, Default)]
pub struct Library {
    entries: Vec<Arc<Entry>>,
    /// The indices of the entries in the order of their ids.
    by_id: Vec<u32>,
    /// The corrected body parts of rigs, also of those that no present clip has.
    bone_maps: Arc<BoneMaps>,
}

impl FromIterator<Entry> for Library {
    fn from_iter<I: IntoIterator<Item = Entry>>(entries: I) -> Self {
        let mut library = Self::default();
        for entry in entries {
            library.put(entry);
        }
        library
    }
}

/// The number of hexadecimal digits of the SHA-256 in a link.
const SHA_DIGITS: usize = 8;

impl Library {
    /// Returns all clips in order.
    #[must_use]
    pub fn entries(&self) -> &[Arc<Entry>] {
        &self.entries
    }

    /// Returns the clip of a reference in a link: by id, otherwise by its SHA-256 prefix, otherwise
    /// by a file's name if that is unique.
    #[must_use]
    pub fn find(&self, reference: &str) -> Option<&Arc<Entry>> {
        if let Some(entry) = self.get(reference) {
            return Some(entry);
        }
        let (name, sha, index) = split_reference(reference);
        let mut matching = self.entries.iter().filter(|entry| match &entry.origin {
            Origin::File(file) if !sha.is_empty() => {
                file.sha256.starts_with(sha) && file.index == index
            }
            Origin::File(file) => file_stem(&file.name) == file_stem(name) && file.index == index,
            _ => false,
        });
        let found = matching.next();
        // Two files of one name are ambiguous.
        if sha.is_empty() && matching.next().is_some() { None } else { found }
    }

    /// Returns the clip of exactly that id.
    #[must_use]
    pub fn get(&self, id: &str) -> Option<&Arc<Entry>> {
        self.entries.get(self.index_of(id)?)
    }

    /// Returns the index of the clip of exactly that id.
    fn index_of(&self, id: &str) -> Option<usize> {
        let place = self.place_of(id).ok()?;
        self.by_id.get(place).map(|&index| index as usize)
    }

    /// Returns the place of an id in the order of ids, or the one where it would be.
    fn place_of(&self, id: &str) -> Result<usize, usize> {
        let id_at = |index: &u32| self.entries.get(*index as usize).map(|entry| entry.id.as_str());
        self.by_id.binary_search_by(|index| id_at(index).cmp(&Some(id)))
    }

    /// Returns the corrected body parts, by rig.
    #[must_use]
    pub(crate) fn bone_maps(&self) -> &Arc<BoneMaps> {
        &self.bone_maps
    }

    /// Sets the corrected body parts of all rigs.
    pub(crate) fn set_bone_maps(&mut self, maps: impl Into<Arc<BoneMaps>>) {
        self.bone_maps = maps.into();
    }

    /// Remembers the body parts of a rig. Beyond [`MAX_RIGS`] another one is forgotten.
    pub(crate) fn put_bone_map(&mut self, map: BoneMap) {
        let maps = Arc::make_mut(&mut self.bone_maps);
        let is_new = !maps.contains_key(&map.rig);
        if is_new && maps.len() >= MAX_RIGS {
            maps.pop_first();
        }
        maps.insert(map.rig.clone(), map);
    }

    /// Adds a clip at the end, or replaces the one with the same id.
    pub fn put(&mut self, entry: Entry) {
        self.put_shared(Arc::new(entry));
    }

    /// Adds or replaces a clip as [`Library::put`] does, shared with another library.
    pub fn put_shared(&mut self, entry: Arc<Entry>) {
        match self.place_of(&entry.id) {
            Ok(place) => {
                let index = self.by_id.get(place).map(|&index| index as usize);
                if let Some(old) = index.and_then(|index| self.entries.get_mut(index)) {
                    *old = entry;
                }
            }
            Err(place) => {
                self.by_id.insert(place, self.entries.len() as u32);
                self.entries.push(entry);
            }
        }
    }

    /// Removes a clip; returns whether it was there.
    pub fn remove(&mut self, id: &str) -> bool {
        let Ok(place) = self.place_of(id) else {
            return false;
        };
        let removed = self.by_id.remove(place);
        self.entries.remove(removed as usize);
        for index in self.by_id.iter_mut().filter(|index| **index > removed) {
            *index -= 1;
        }
        true
    }

    /// Moves the bytes of the files of clips out. Returns them with their SHA-256, the key that the
    /// entries have for them now.
    pub(crate) fn move_bytes_outside(&mut self, ids: &[String]) -> Vec<(String, Arc<[u8]>)> {
        let mut moved: BTreeMap<String, Arc<[u8]>> = BTreeMap::new();
        for id in ids {
            self.change(id, |entry| {
                let Origin::File(file) = &mut entry.origin else { return };
                let Content::Here(bytes) = &file.content else { return };
                moved.insert(file.sha256.clone(), Arc::clone(bytes));
                file.content = Content::Outside(file.sha256.clone());
            });
        }
        moved.into_iter().collect()
    }

    /// Replaces entries by newer ones, wherever an old one is, as `newer` has them by the addresses
    /// of the old ones.
    pub(crate) fn replace_shared(&mut self, newer: &BTreeMap<*const Entry, Arc<Entry>>) {
        for slot in &mut self.entries {
            if let Some(new) = newer.get(&Arc::as_ptr(slot)) {
                *slot = Arc::clone(new);
            }
        }
    }

    /// Takes the motions of clips that have none here from another library, where they were read
    /// with the same options.
    pub fn take_motions_of(&mut self, other: &Self) {
        for entry in self.entries.iter_mut().filter(|entry| entry.motion.is_none()) {
            let known = other.get(&entry.id).filter(|known| {
                let is_read_alike = match (&known.origin, &entry.origin) {
                    (Origin::File(a), Origin::File(b)) => a.is_read_like(b),
                    (a, b) => a == b,
                };
                known.motion.is_some()
                    && known.roles_by_hand == entry.roles_by_hand
                    && is_read_alike
            });
            if let Some(known) = known {
                *entry = Arc::new(Entry { name: entry.name.clone(), ..(**known).clone() });
            }
        }
    }

    /// Changes a clip in place, if it is there.
    pub fn change(&mut self, id: &str, change: impl FnOnce(&mut Entry)) -> bool {
        let Some(slot) = self.index_of(id).and_then(|index| self.entries.get_mut(index)) else {
            return false;
        };
        change(Arc::make_mut(slot));
        true
    }
}

/// Returns the id of the clip `index` of a file: `01_01~3fa9c1d2`, and `01_01~3fa9c1d2.2` for the
/// second character in it. A long name is truncated.
#[must_use]
pub fn file_id(name: &str, sha256: &str, index: usize) -> String {
    let sha = sha256.get(..SHA_DIGITS).unwrap_or(sha256);
    let suffix = if index == 0 { String::new() } else { format!(".{}", index + 1) };
    format!("{}~{sha}{suffix}", outside::for_id(file_stem(name)))
}

/// Splits a reference into name, SHA-256 prefix (possibly empty) and index.
#[must_use]
pub fn split_reference(reference: &str) -> (&str, &str, usize) {
    let split = reference.rsplit_once('~').and_then(|(name, rest)| {
        let (sha, index) = match rest.split_once('.') {
            Some((sha, number)) => (sha, number.parse::<usize>().ok()?.saturating_sub(1)),
            None => (rest, 0),
        };
        // The recipe of a result contains references to files, but is not one.
        let is_sha = !sha.is_empty() && sha.bytes().all(|digit| digit.is_ascii_hexdigit());
        is_sha.then_some((name, sha, index))
    });
    split.unwrap_or((reference, "", 0))
}

/// Returns a file's name without folders and ending.
#[must_use]
pub(super) fn file_stem(name: &str) -> &str {
    let name = name.rsplit(['/', '\\']).next().unwrap_or(name);
    match name.rsplit_once('.') {
        Some((stem, _)) if !stem.is_empty() => stem,
        _ => name,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn dropped(name: &str, sha256: &str) -> Entry {
        let file = SourceFile {
            name: name.into(),
            sha256: sha256.into(),
            content: Content::Here(Arc::from([])),
            size: 0,
            kind: FileKind::Bvh,
            skeleton_file: None,
            index: 0,
            options: ImportOptions::default(),
        };
        Entry::new(file_id(name, sha256, 0), name.to_owned(), Origin::File(file))
    }

    #[test]
    fn title_of_a_clip_that_a_user_named_is_data() {
        let mut preset = Entry::new("walk", "Walk", Origin::Preset);
        assert_eq!(preset.title(), Message::word("Walk"));
        assert_eq!(dropped("Walk", "3fa9c1d2aa").title(), Message::data("Walk"));
        preset.name = "Run".to_owned();
        assert_eq!(preset.title(), Message::data("Run"));
    }

    #[test]
    fn group_of_a_clip_is_its_folder_then_its_batch_then_its_file() {
        let in_folder = dropped("takes/day 1/walk.bvh", "11111111aa");
        assert_eq!(in_folder.group(), Some(ClipGroup::Folder("takes".into())));
        let mut alone = dropped("walk.bvh", "11111111aa");
        assert_eq!(alone.group(), Some(ClipGroup::File("11111111aa".into())));
        alone.batch = Some(3);
        assert_eq!(alone.group(), Some(ClipGroup::Batch(3)));
        assert_eq!(Entry::new("walk", "Walk", Origin::Preset).group(), None);
    }

    #[test]
    fn find_by_id_sha_or_name_returns_the_clip() {
        let mut library = Library::default();
        library.put(dropped("a/01_01.bvh", "3fa9c1d2aa"));
        library.put(dropped("walk.bvh", "11111111aa"));
        library.put(dropped("walk.bvh", "22222222aa"));
        assert_eq!(library.entries()[0].id, "01_01~3fa9c1d2");
        for reference in ["01_01~3fa9c1d2", "renamed~3fa9c1d2", "x~3fa9", "01_01", "01_01.bvh"] {
            assert_eq!(
                library.find(reference).map(|e| e.name.as_str()),
                Some("a/01_01.bvh"),
                "{reference}"
            );
        }
        assert_eq!(library.find("walk").map(|e| &e.id), None, "two files have that name");
        assert_eq!(library.find("walk~2222").map(|e| e.id.as_str()), Some("walk~22222222"));
        assert!(library.find("01_01~3fa9c1d2.2").is_none());
    }

    #[test]
    fn split_reference_returns_its_parts() {
        assert_eq!(split_reference("a~b~12.3"), ("a~b", "12", 2));
        for whole in ["walk", "blend(a:walk,b:spider~12ab34cd.2,enter_b:0.5)", "tilde~", "a~2 b~x"]
        {
            assert_eq!(split_reference(whole), (whole, "", 0));
        }
        assert_eq!(file_stem("x/y.z/.hidden"), ".hidden");
    }
}
