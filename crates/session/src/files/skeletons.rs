//! Motions without their skeleton, and skeletons without a motion (ASF and AMC, body models and
//! `NumPy`).

use super::intake::FileIntake;
use super::messages::notify_unread;
use super::setup::skeleton_files;
use crate::document::Document;
use crate::library::{Arrival, Library, Origin, SourceFile};
use crate::notice::Notices;
use crate::reading::SkeletonFile;
use segue_formats::{FileKind, acclaim};
use segue_text::{Message, ToMessage};

impl FileIntake {
    /// Reads the motions that waited for a skeleton, now that one has arrived.
    pub(super) fn read_waiting(
        &mut self,
        document: &mut Document,
        notices: &mut Notices,
        arrival: Arrival,
    ) {
        let (entries, skeletons) =
            (document.library.entries().to_vec(), skeleton_files(&document.library));
        let is_named = |file: &SourceFile, skeleton: &SkeletonFile| {
            acclaim::goes_by_name(&file.name, &skeleton.name)
        };
        for entry in &entries {
            let Origin::File(file) = &entry.origin else {
                continue;
            };
            let awaits = entry.awaits_skeleton();
            // A motion that was read with another subject's skeleton has its own now.
            let has_other = file.kind == FileKind::Amc
                && (file.skeleton_file.as_ref()).is_some_and(|had| {
                    !is_named(file, had)
                        && skeletons.iter().any(|skeleton| is_named(file, skeleton))
                });
            // A motion on a generic body has its own now.
            let has_body = file.kind == FileKind::Numpy
                && file.skeleton_file.is_none()
                && skeletons.iter().any(|skeleton| skeleton.is_model);
            if !(awaits || has_other || has_body) {
                continue;
            }
            let file = SourceFile { skeleton_file: None, ..file.clone() };
            match self.read_anew(document, &file, awaits.then_some(arrival)) {
                Ok(true) if awaits => {
                    offer_moving(document, &entry.id, arrival);
                    notify_misfit(&document.library, notices, &entry.id);
                }
                Ok(_) => {}
                Err(error) => notify_unread(notices, &error),
            }
        }
    }
}

/// Reports why a motion still waits although a skeleton has arrived.
fn notify_misfit(library: &Library, notices: &mut Notices, id: &str) {
    if let Some(entry) = library.get(id).filter(|entry| entry.awaits_skeleton()) {
        let told: Vec<Message> = entry.warnings.iter().map(ToMessage::to_sentence).collect();
        notices.say_missing(id, Message::joined(told, " "));
    }
}

/// Offers a slot to a clip that waited for its skeleton, if it has a motion by now.
pub(super) fn offer_moving(document: &mut Document, id: &str, arrival: Arrival) {
    if document.library.find(id).is_some_and(|entry| entry.is_known()) {
        document.offer(id, arrival);
    }
}

/// Removes the skeletons that have a motion by now: they need no row of their own.
pub(super) fn drop_used_skeletons(library: &mut Library) {
    let entries = library.entries().to_vec();
    let used = |sha256: &str| {
        entries.iter().any(|entry| match &entry.origin {
            // A body model is named as its own skeleton file.
            Origin::File(file) if !file.kind.is_skeleton() => file
                .skeleton_file
                .as_ref()
                .is_some_and(|skeleton_file| skeleton_file.sha256 == sha256),
            _ => false,
        })
    };
    for entry in &entries {
        if matches!(&entry.origin, Origin::File(file) if file.kind.is_skeleton() && used(&file.sha256))
        {
            library.remove(&entry.id);
        }
    }
}
