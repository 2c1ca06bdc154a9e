//! Body parts that are corrected by hand, in all clips of a rig.

use super::intake::{FileIntake, LoadedFile};
use crate::bone_map::{BoneMap, rig_of, with_changes};
use crate::command::CommandError;
use crate::document::Document;
use crate::library::{Entry, Origin};
use crate::notice::{Level, Notices};
use crate::outside;
use segue_formats::FileKind;
use segue_motion::clip::Motion;
use segue_motion::skeleton::{Role, Roles};
use segue_text::{ToMessage, msg};
use std::collections::BTreeSet;
use std::sync::Arc;

impl FileIntake {
    /// Corrects the joints of roles by hand, in all clips of the rig.
    pub(super) fn set_roles(
        &mut self,
        document: &mut Document,
        id: &str,
        changes: &[(Role, Option<usize>)],
    ) -> Result<(), CommandError> {
        let motion = motion_of(document, id)?;
        let skeleton = motion.clip().skeleton();
        if changes.iter().filter_map(|&(_, joint)| joint).any(|joint| joint >= skeleton.len()) {
            return Err(CommandError::NotPossible("the skeleton has no such joint"));
        }
        let roles = with_changes(motion.roles(), changes);
        let map = BoneMap::of(skeleton, &roles);
        let before = document.library.clone();
        // This clip by its indices, which tell joints of one name apart, the others by the map.
        self.give_roles(document, id, roles);
        self.map_clips(document, &map, |entry, rig| entry.id != id && rig == map.rig);
        document.library.put_bone_map(map);
        document.remember_library(&before);
        document.library_revision += 1;
        Ok(())
    }

    /// Takes back the corrections of a clip's rig.
    pub(super) fn reset_roles(
        &mut self,
        document: &mut Document,
        id: &str,
    ) -> Result<(), CommandError> {
        let rig = rig_of(motion_of(document, id)?.clip().skeleton());
        let before = document.library.clone();
        // An empty map, so that another window's older one does not come back.
        document.library.put_bone_map(BoneMap { rig: rig.clone(), ..BoneMap::default() });
        for entry in before.entries() {
            if entry.roles_by_hand.is_some()
                && entry.facts.as_ref().is_some_and(|facts| facts.rig == rig)
            {
                self.find_roles(document, entry);
            }
        }
        document.remember_library(&before);
        document.library_revision += 1;
        Ok(())
    }

    /// Applies a bone map to all clips that have its bones, as a step for undo, and says to how
    /// many. A map of a rig that is not here is remembered.
    pub(super) fn apply_bone_map(
        &mut self,
        document: &mut Document,
        notices: &mut Notices,
        map: &BoneMap,
    ) {
        let before = document.library.clone();
        let rigs = self.map_clips(document, map, |_, _| true);
        let clips = rigs.len();
        let mut rigs: BTreeSet<String> = rigs.into_iter().collect();
        if !map.rig.is_empty() {
            rigs.insert(map.rig.clone());
        }
        let is_kept = !rigs.is_empty();
        for rig in rigs {
            document.library.put_bone_map(BoneMap { rig, ..map.clone() });
        }
        document.remember_library(&before);
        document.library_revision += 1;
        match (clips, is_kept) {
            (0, false) => notices.say(
                Level::Warning,
                msg!(
                    "The bone map fits no clip here. Open a clip with its bones, then the map again."
                ),
            ),
            (0, true) => notices.say(
                Level::Info,
                msg!(
                    "The bone map fits no clip here. It is kept for clips of its rig that are opened later."
                ),
            ),
            (clips, _) => notices.say(
                Level::Info,
                msg!(
                    "The bone map was applied to {clips, plural, one {# clip} other {# clips}}.",
                    clips
                ),
            ),
        }
    }

    /// Corrects the body parts that a link names, in all clips of each rig. Others stay as they
    /// are.
    pub(crate) fn correct_as_linked(&mut self, document: &mut Document, maps: &[BoneMap]) {
        for map in maps {
            let known = document.library.bone_maps().get(&map.rig).cloned().unwrap_or_default();
            if map.roles.iter().all(|(role, name)| known.roles.get(role) == Some(name)) {
                continue;
            }
            self.map_clips(document, map, |_, rig| rig == map.rig);
            for entry in document.library.entries().to_vec() {
                let is_of_rig = entry.facts.as_ref().is_some_and(|facts| facts.rig == map.rig);
                if is_of_rig && entry.motion.is_none() {
                    // It gets the map when it is read.
                    document.library.change(&entry.id, |entry| entry.roles_by_hand = None);
                }
            }
            let mut roles = known.roles;
            roles.extend(map.roles.clone());
            document.library.put_bone_map(BoneMap { rig: map.rig.clone(), roles });
            document.library_revision += 1;
        }
    }

    /// Reads a bone map from a file, and applies it.
    pub(super) fn load_bone_map(
        &mut self,
        document: &mut Document,
        notices: &mut Notices,
        name: &str,
        bytes: &[u8],
    ) -> LoadedFile {
        match BoneMap::from_json(bytes) {
            Ok(map) => {
                self.apply_bone_map(document, notices, &map);
                LoadedFile::default()
            }
            Err(error) => {
                let reason = error.to_message();
                let text = msg!("{name}: {reason}.", name = outside::file_name(name), reason);
                notices.say(Level::Error, text.clone());
                LoadedFile { warnings: vec![text], ..LoadedFile::default() }
            }
        }
    }

    /// Gives clips the roles of a map that they fit. Returns the rig of each of them.
    fn map_clips(
        &mut self,
        document: &mut Document,
        map: &BoneMap,
        is_wanted: impl Fn(&Entry, &str) -> bool,
    ) -> Vec<String> {
        let mut rigs = Vec::new();
        for entry in document.library.entries().to_vec() {
            let Some(motion) = &entry.motion else { continue };
            let skeleton = motion.clip().skeleton();
            let rig = rig_of(skeleton);
            if is_wanted(&entry, &rig)
                && let Some(roles) = map.roles_for(skeleton, motion.roles())
            {
                self.give_roles(document, &entry.id, roles);
                rigs.push(rig);
            }
        }
        rigs
    }

    /// Gives a clip roles that were set by hand. A file that is large or being read is read again
    /// with them.
    fn give_roles(&mut self, document: &mut Document, id: &str, roles: Roles) {
        let Some(entry) = document.library.get(id).cloned() else { return };
        if let Some(motion) = entry.motion.as_ref().filter(|motion| *motion.roles() != roles) {
            match &entry.origin {
                Origin::File(file) if file.is_large() || self.is_read_again(file) => {
                    document.library.change(id, |entry| entry.roles_by_hand = Some(roles));
                    self.read_again(document, file.clone(), None);
                    return;
                }
                _ => {
                    let corrected = Motion::clone(motion).with_corrected_roles(&roles);
                    document.library.change(id, |entry| entry.set_motion(Arc::new(corrected)));
                }
            }
        }
        document.library.change(id, |entry| entry.roles_by_hand = Some(roles));
    }

    /// Gives a clip the roles that were found in it.
    fn find_roles(&mut self, document: &mut Document, entry: &Entry) {
        document.library.change(&entry.id, |entry| entry.roles_by_hand = None);
        match &entry.origin {
            // They are found when it is read again.
            Origin::File(file) if entry.motion.is_none() && !self.is_read_again(file) => {}
            // The file may state roles, or take too long.
            Origin::File(file)
                if file.is_large()
                    || self.is_read_again(file)
                    || matches!(file.kind, FileKind::Gltf | FileKind::Vrm | FileKind::Vrma) =>
            {
                // It was read before; if it no longer can be, the clip stays as it is.
                if self.read_anew(document, file, None).is_err() {
                    document.library.change(&entry.id, |own| {
                        own.roles_by_hand.clone_from(&entry.roles_by_hand);
                    });
                }
            }
            // It is made again when it is used.
            Origin::Made => {
                document.library.change(&entry.id, |entry| entry.motion = None);
            }
            Origin::File(_) | Origin::Preset | Origin::Sample(_) => {
                let found = entry.motion.as_ref().map(|motion| {
                    let roles = Roles::detect(motion.clip().skeleton());
                    Arc::new(Motion::clone(motion).with_corrected_roles(&roles))
                });
                if let Some(found) = found {
                    document.library.change(&entry.id, |entry| entry.set_motion(found));
                }
            }
        }
    }
}

fn motion_of(document: &Document, id: &str) -> Result<Arc<Motion>, CommandError> {
    let motion = document.clip(id)?.motion.clone();
    motion.ok_or(CommandError::NotPossible("the clip is not loaded yet"))
}
