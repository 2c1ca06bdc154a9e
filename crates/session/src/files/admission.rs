//! Admission of the clips of read files to the library.

use super::corrections::{corrected_options, offer_corrections};
use super::intake::{FileIntake, LoadedFile};
use super::messages::{notify_all_unread, notify_unread};
use super::setup::lacks_skeleton;
use super::skeletons::drop_used_skeletons;
use crate::document::Document;
use crate::labs::Slot;
use crate::library::{Arrival, Entry, Origin, SourceFile, file_id, file_stem};
use crate::notice::{AddedClips, Level, Notices, in_the_library};
use crate::outside;
use crate::params::{Key, Value};
use crate::reading::{Content, ReadFile, ReadReport, ReadSetup};
use crate::saved::SavedEntry;
use segue_formats::{ImportError, ImportOptions};
use segue_motion::clip::Motion;
use segue_text::{Message, ToMessage, msg};
use std::sync::Arc;

/// The greatest number of remarks on files in one notice.
const MAX_REMARKS: usize = 6;

impl FileIntake {
    /// Adds the clips of a report to the library, as a step for undo.
    pub(super) fn admit(
        &mut self,
        document: &mut Document,
        notices: &mut Notices,
        report: ReadReport,
        content: &Content,
        setup: &ReadSetup,
        arrival: Arrival,
    ) -> Result<LoadedFile, ImportError> {
        // A single file fails as a whole; of several, some may be good.
        if let [ReadFile { result: Err(error), .. }] = report.files.as_slice() {
            let error = error.clone();
            notify_unread(notices, &error);
            return Err(error);
        }
        document.remember_arrival(arrival.batch());
        let mut loaded = LoadedFile::default();
        let (mut names, mut t_poses, mut failures) = (Vec::new(), 0, Vec::new());
        let brings_skeleton = |file: &ReadFile| {
            file.kind.is_skeleton()
                || file.result.as_ref().is_ok_and(|read| read.skeleton_file.is_some())
        };
        let skeleton_arrived = report.files.iter().any(brings_skeleton)
            || lacks_skeleton(&document.library, &report, setup);
        for file in report.files {
            let name = file.name.clone();
            match file_entries(file, content, &setup.options) {
                Ok((entries, warnings)) => {
                    names.push(name);
                    let has_t_pose = |entry: &Entry| {
                        entry.about.as_ref().is_some_and(|about| about.t_pose_first_row)
                    };
                    t_poses += usize::from(entries.iter().any(has_t_pose));
                    loaded.warnings.extend(warnings);
                    let first = entries.iter().find(|entry| entry.mesh.is_some());
                    if let Some(first) =
                        first.filter(|entry| takes_character(document, entry, arrival))
                    {
                        document.set_unchecked(Key::Character, Value::Text(first.id.clone()));
                    }
                    let may_be_cast = |entry: &&Entry| {
                        arrival.is_by_hand() || document.library.get(&entry.id).is_none()
                    };
                    let figure = first.filter(may_be_cast).cloned();
                    for entry in entries {
                        loaded.ids.push(entry.id.clone());
                        let entry = Entry { batch: arrival.batch(), ..entry };
                        self.join(document, notices, entry, arrival);
                    }
                    if let Some(figure) =
                        figure.filter(|figure| serves_its_own_clips(document, figure, &loaded.ids))
                    {
                        document.set_unchecked(Key::Character, Value::Text(figure.id));
                    }
                }
                Err(error) => failures.push(error),
            }
        }
        loaded.warnings.extend(report.notes);
        notify_all_unread(notices, &failures);
        if skeleton_arrived {
            self.read_waiting(document, notices, arrival);
            drop_used_skeletons(&mut document.library);
        }
        document.settle();
        document.library_revision += 1;
        if !names.is_empty() {
            let mut told: Vec<Message> = in_the_library(&names).into_iter().collect();
            let mut more = 0;
            for warning in loaded.warnings.iter().map(ToMessage::to_sentence) {
                if told.contains(&warning) {
                    continue;
                }
                if told.len() > MAX_REMARKS {
                    more += 1;
                } else {
                    told.push(warning);
                }
            }
            if more > 0 {
                told.push(msg!("{more} more warnings are listed with the clips."));
            }
            let text = Message::joined(told, " ");
            // The takes of whole databases begin with a T-pose: nothing has to be done about it,
            // and the clips' own warnings say it.
            let is_odd = loaded.warnings.len() > t_poses;
            let has_notes = |entry: &Entry| {
                let is_t_pose = entry.about.as_ref().is_some_and(|about| about.t_pose_first_row);
                entry.warnings.len() > usize::from(is_t_pose)
            };
            let added: Vec<_> =
                loaded.ids.iter().filter_map(|id| document.library.get(id)).collect();
            let with_notes = added.iter().filter(|entry| has_notes(entry)).count();
            notices.count_added(AddedClips { clips: added.len(), with_notes });
            let corrections: Vec<String> = loaded
                .ids
                .iter()
                .filter(|id| corrected_options(&document.library, id).is_some())
                .cloned()
                .collect();
            match loaded.ids.as_slice() {
                // Until its other half arrives.
                [id] if is_odd && document.is_unpaired(id) => notices.say_missing(id, text),
                // A skeleton that a motion waited for: the motion has it now.
                [id] if document.library.get(id).is_none() => notices.say_added(names),
                _ if !corrections.is_empty() => {
                    offer_corrections(&document.library, notices, text, corrections);
                }
                _ if is_odd => notices.say(Level::Warning, text),
                _ => notices.say_added(names),
            }
        } else if !loaded.warnings.is_empty() {
            // Notes on the archive hold even if nothing in it can be read.
            let told: Vec<Message> = loaded.warnings.iter().map(ToMessage::to_sentence).collect();
            notices.say(Level::Warning, Message::joined(told, " "));
        }
        // Listeners receive each of them.
        loaded.warnings.extend(failures.iter().map(ToMessage::to_message));
        Ok(loaded)
    }

    /// Adds a clip. If the library has it already, keeps what was set by hand.
    fn join(
        &mut self,
        document: &mut Document,
        notices: &mut Notices,
        entry: Entry,
        arrival: Arrival,
    ) {
        let mut entry = entry;
        entry.take_mapped_roles(document.library.bone_maps());
        let id = entry.id.clone();
        let known = document.library.get(&id).cloned();
        match &known {
            Some(known) => self.join_again(document, notices, known, entry),
            None => document.library.put(entry),
        }
        // A skeleton alone plays nothing, nor does a character without a motion of its own. A
        // motion that waits for a skeleton may take its slot when it can be read.
        let plays = document.library.get(&id).filter(|entry| entry.is_known());
        let plays = plays
            .and_then(|entry| entry.facts.as_ref())
            .is_some_and(|facts| facts.frames > usize::from(facts.has_mesh));
        // A file that the link fetches again after a reload has the slot that it was given then, or
        // none.
        if plays && (known.is_none() || arrival.is_by_hand()) {
            document.offer(&id, arrival);
        }
    }

    /// Adds a clip that the library has already.
    fn join_again(
        &mut self,
        document: &mut Document,
        notices: &mut Notices,
        known: &Entry,
        entry: Entry,
    ) {
        let (Origin::File(had), Origin::File(has)) = (&known.origin, &entry.origin) else {
            return;
        };
        if known.is_known()
            && (has.skeleton_file.is_none() || has.skeleton_file == had.skeleton_file)
        {
            // Its motion is at hand now, if it was read as the library has it.
            if known.motion.is_none() && had.is_read_like(has) && known.roles_by_hand.is_none() {
                let maps = Arc::clone(document.library.bone_maps());
                document.library.change(&known.id, |known| {
                    (known.motion, known.mesh, known.facts) =
                        (entry.motion, entry.mesh, entry.facts);
                    known.take_mapped_roles(&maps);
                });
            }
            return;
        }
        let is_read_as_said = had.options == has.options && known.roles_by_hand.is_none();
        let file = SourceFile { options: had.options, ..has.clone() };
        document.library.put(Entry {
            name: known.name.clone(),
            roles_by_hand: known.roles_by_hand.clone(),
            batch: known.batch,
            origin: Origin::File(file.clone()),
            ..entry
        });
        if is_read_as_said {
            return;
        }
        if let Err(error) = self.read_anew(document, &file, None) {
            notify_unread(notices, &error);
        }
    }
}

/// Returns whether a file with a skin becomes the character. A fetched one does not if it was in
/// the library before, or if the link names another character. A figure without limbs does not:
/// other clips cannot move it.
fn takes_character(document: &Document, entry: &Entry, arrival: Arrival) -> bool {
    let has_limbs = entry.character().is_some_and(|character| character.has_limbs());
    let is_free = document.params.text(Key::Character).is_empty();
    has_limbs
        && match arrival {
            Arrival::ByHand(_) => true,
            Arrival::ByLink => is_free && document.library.get(&entry.id).is_none(),
        }
}

/// Returns whether a figure without limbs becomes the character: none is chosen, and A holds one of
/// the clips that came with it.
fn serves_its_own_clips(document: &Document, figure: &Entry, clips: &[String]) -> bool {
    let is_free = document.params.text(Key::Character).is_empty();
    let in_a = document.slot(Slot::A).is_some_and(|entry| clips.contains(&entry.id));
    is_free && in_a && figure.character().is_some_and(|character| !character.has_limbs())
}

/// Replaces the content of clips in the library by that of a new report. Leaves out those whose
/// options have changed since.
pub(super) fn refill(
    document: &mut Document,
    report: ReadReport,
    options: &ImportOptions,
) -> Result<LoadedFile, ImportError> {
    let mut loaded = LoadedFile::default();
    for file in report.files {
        // The entries know where the bytes are.
        let (entries, warnings) = file_entries(file, &Content::Here(Arc::from([])), options)?;
        loaded.warnings.extend(warnings);
        for new in entries {
            let maps = Arc::clone(document.library.bone_maps());
            let id = new.id.clone();
            let stored_as = |document: &Document| {
                document.library.get(&id).map(|entry| SavedEntry::from(&**entry))
            };
            let before = stored_as(document);
            document.library.change(&id, |entry| {
                let (Origin::File(file), Origin::File(new_file)) = (&mut entry.origin, new.origin)
                else {
                    return;
                };
                if file.options != *options {
                    return;
                }
                file.skeleton_file = new_file.skeleton_file;
                // A motion whose skeleton was not found keeps waiting.
                (entry.motion, entry.mesh, entry.facts) = (new.motion, new.mesh, new.facts);
                entry.about = new.about;
                entry.warnings = new.warnings;
                // Roles may have been set since the file was sent off.
                if let (Some(motion), Some(roles)) = (&entry.motion, &entry.roles_by_hand)
                    && motion.roles() != roles
                {
                    let corrected = Motion::clone(motion).with_corrected_roles(roles);
                    entry.set_motion(Arc::new(corrected));
                }
                entry.take_mapped_roles(&maps);
            });
            // A motion that is only in memory again is no change.
            document.library_revision += u64::from(before != stored_as(document));
            loaded.ids.push(id);
        }
    }
    Ok(loaded)
}

/// Returns an entry for every clip of a file, and the file's warnings. `content` is the file's,
/// unless it came out of an archive.
fn file_entries(
    file: ReadFile,
    content: &Content,
    options: &ImportOptions,
) -> Result<(Vec<Entry>, Vec<Message>), ImportError> {
    let read = file.result?;
    let source = SourceFile {
        name: file.name,
        sha256: file.sha256,
        size: file.size,
        kind: file.kind,
        content: file
            .unpacked
            .map_or_else(|| content.clone(), |bytes| Content::Here(Arc::from(bytes))),
        skeleton_file: read.skeleton_file,
        index: 0,
        options: *options,
    };
    let mut warnings = read.warnings;
    if read.awaits_skeleton {
        warnings.push(msg!(
            "{name} needs its skeleton: drop the .asf file that belongs to it.",
            name = source.name
        ));
        let id = file_id(&source.name, &source.sha256, 0);
        let entry = Entry {
            warnings: warnings.clone(),
            ..Entry::new(id, outside::clip_name(file_stem(&source.name)), Origin::File(source))
        };
        return Ok((vec![entry], warnings));
    }
    let entries = read.clips.into_iter().enumerate().map(|(index, clip)| {
        let source = SourceFile { index, ..source.clone() };
        let entry = Entry {
            name: outside::clip_name(clip.motion.clip().name()),
            mesh: clip.mesh,
            about: Some(clip.about),
            warnings: warnings.clone(),
            ..Entry::new(
                file_id(&source.name, &source.sha256, index),
                String::new(),
                Origin::File(source),
            )
        };
        entry.with_motion(Arc::new(clip.motion))
    });
    let mut named: Vec<Entry> = entries.collect();
    let figure = named.iter().find_map(Entry::character);
    if figure.is_some_and(|character| !character.has_limbs()) {
        let warning = Message::word(
            "its character has no recognised limbs: only its own clips can animate it",
        );
        for entry in named.iter_mut().filter(|entry| entry.mesh.is_some()) {
            entry.warnings.push(warning.clone());
        }
        warnings.push(warning);
    }
    Ok((named, warnings))
}
