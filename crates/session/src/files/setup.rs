//! The options, roles and skeleton files by which a file is read, from the library.

use crate::library::{Library, Origin, SourceFile};
use crate::reading::{Content, ReadFile, ReadReport, ReadSetup, SkeletonFile};
use segue_formats::FileKind;
use segue_motion::skeleton::Roles;
use std::collections::BTreeMap;
use std::sync::Arc;

/// Returns the setup for reading a file of the library, as its entries say.
pub(super) fn setup_of(library: &Library, file: &SourceFile) -> ReadSetup {
    ReadSetup {
        options: file.options,
        roles: roles_by_hand(library, file),
        bone_maps: Arc::clone(library.bone_maps()),
        skeleton_files: match &file.skeleton_file {
            Some(skeleton_file) => vec![SkeletonFile::clone(skeleton_file)],
            None if file.kind.takes_skeleton() => skeleton_files(library),
            None => Vec::new(),
        },
        sha256: Some(file.sha256.clone()),
    }
}

/// Returns the setup for reading a new file.
pub(crate) fn setup_for_new(library: &Library) -> ReadSetup {
    ReadSetup {
        skeleton_files: skeleton_files(library),
        bone_maps: Arc::clone(library.bone_maps()),
        ..ReadSetup::default()
    }
}

/// Returns the roles that were corrected by hand, by the index of the clip in its file.
fn roles_by_hand(library: &Library, file: &SourceFile) -> BTreeMap<usize, Roles> {
    let entries = library.entries().iter().filter_map(|entry| match &entry.origin {
        Origin::File(own) if own.sha256 == file.sha256 => {
            Some((own.index, entry.roles_by_hand.clone()?))
        }
        _ => None,
    });
    entries.collect()
}

/// Returns the known skeleton files: those in the library, and those that its motions were read
/// with. A skeleton file is named as its own, a body model in a small form; earlier versions have
/// stored ASF files without one.
pub(super) fn skeleton_files(library: &Library) -> Vec<SkeletonFile> {
    let mut all: Vec<SkeletonFile> = Vec::new();
    for entry in library.entries() {
        let Origin::File(file) = &entry.origin else {
            continue;
        };
        let found = match (&file.skeleton_file, &file.content) {
            (Some(skeleton_file), _) => SkeletonFile::clone(skeleton_file),
            (None, Content::Here(bytes)) if file.kind == FileKind::Asf => SkeletonFile {
                name: file.name.clone(),
                sha256: file.sha256.clone(),
                bytes: Arc::clone(bytes),
                is_model: false,
            },
            _ => continue,
        };
        if all.iter().all(|known| known.sha256 != found.sha256) {
            all.push(found);
        }
    }
    all
}

/// Returns whether a motion needs a skeleton file, and one has arrived since it was read.
pub(super) fn lacks_skeleton(library: &Library, report: &ReadReport, setup: &ReadSetup) -> bool {
    let takes_skeleton = |file: &ReadFile| file.kind.takes_skeleton();
    report.files.iter().any(takes_skeleton) && skeleton_files(library) != setup.skeleton_files
}
