//! Opening and saving of the user's files. Dialogues and reading run on threads of their own, so
//! that frames continue.

use super::LargeFile;
use crate::platform::motion_files::{
    MAX_FILE_BYTES, endings, is_motion_file, last_part, no_motion_in, too_large,
};
use crate::platform::{Inbox, Incoming};
use eframe::egui::DroppedFileHandle;
use segue_session::reading::LARGE_BYTES;
use segue_text::msg;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Opens a dialogue for files, and reads the chosen ones.
pub(crate) fn open_files(inbox: &Inbox) {
    let asked = rfd::AsyncFileDialog::new()
        .add_filter("Motion files", &endings())
        .add_filter("All files", &["*"])
        .pick_files();
    let inbox = inbox.clone();
    std::thread::spawn(move || {
        let files = pollster::block_on(asked).unwrap_or_default();
        inbox.push(Incoming::Opening(files.len()));
        for file in files {
            read_path(file.path(), &inbox);
        }
    });
}

/// Reads the files dropped on the window, in order.
pub(crate) fn read_dropped(files: Vec<DroppedFileHandle>, inbox: &Inbox) {
    let inbox = inbox.clone();
    std::thread::spawn(move || {
        inbox.push(Incoming::Opening(files.len()));
        for file in files {
            read_path(file.path(), &inbox);
        }
    });
}

/// Reads the files that the command line names, in order.
pub(crate) fn read_arguments(inbox: &Inbox) {
    let paths: Vec<PathBuf> = std::env::args()
        .skip(1)
        .filter(|argument| !is_query(argument))
        .map(PathBuf::from)
        .collect();
    let inbox = inbox.clone();
    std::thread::spawn(move || {
        inbox.push(Incoming::Opening(paths.len()));
        for path in paths {
            read_path(&path, &inbox);
        }
    });
}

/// Returns whether an argument is a link's query and not a file.
pub(super) fn is_query(argument: &str) -> bool {
    argument.starts_with('?') || (argument.contains('=') && !Path::new(argument).exists())
}

/// Reads a file, or the motion files in and below a folder.
fn read_path(path: &Path, inbox: &Inbox) {
    let shown = path.to_string_lossy().into_owned();
    let name = last_part(&shown).to_owned();
    if !path.is_dir() {
        read_file(path, name, inbox);
        return;
    }
    let say = |reason| inbox.push(Incoming::Failed { reason });
    match motion_files(path, &name) {
        Err(error) => {
            say(msg!("{name} cannot be read: {error}.", name, error = error.to_string()));
        }
        Ok(files) if files.is_empty() => say(no_motion_in(&name)),
        Ok(files) => {
            for (path, name) in files {
                read_file(&path, name, inbox);
            }
        }
    }
}

/// Returns the motion files in and below a folder in the order of their paths, each with its name
/// in the library.
fn motion_files(folder: &Path, name: &str) -> std::io::Result<Vec<(PathBuf, String)>> {
    let mut files = Vec::new();
    // A stack of the paths to visit. Symbolic links are not followed, because they may form a
    // cycle.
    let mut waiting = vec![(folder.to_path_buf(), name.to_owned(), true)];
    while let Some((path, name, is_folder)) = waiting.pop() {
        if is_folder {
            let mut children = Vec::new();
            for child in std::fs::read_dir(&path)? {
                let child = child?;
                let own = child.file_name().to_string_lossy().into_owned();
                let kind = child.file_type()?;
                if kind.is_dir() || (kind.is_file() && is_motion_file(&own)) {
                    children.push((child.path(), format!("{name}/{own}"), kind.is_dir()));
                }
            }
            children.sort_by(|x, y| y.1.cmp(&x.1));
            waiting.extend(children);
        } else {
            files.push((path, name));
        }
    }
    Ok(files)
}

/// Reads a file into memory.
fn read_file(path: &Path, name: String, inbox: &Inbox) {
    let unreadable = |error: std::io::Error| {
        msg!("{name} cannot be read: {error}.", name = name.clone(), error = error.to_string())
    };
    let bytes = match std::fs::metadata(path) {
        Ok(metadata) => match too_large(&name, metadata.len(), MAX_FILE_BYTES) {
            Some(reason) => Err(reason),
            None => std::fs::read(path).map_err(unreadable),
        },
        Err(error) => Err(unreadable(error)),
    };
    inbox.push(match bytes {
        Ok(bytes) if bytes.len() as u64 > LARGE_BYTES => {
            Incoming::Large { name, file: LargeFile::new(Arc::from(bytes)) }
        }
        Ok(bytes) => Incoming::File { name, bytes: Arc::from(bytes) },
        Err(reason) => Incoming::Failed { reason },
    });
}

/// Opens a dialogue for a path, and writes a file there.
pub(crate) fn download(file_name: &str, _mime: &str, bytes: &[u8], inbox: &Inbox) {
    let asked = rfd::AsyncFileDialog::new().set_file_name(file_name).save_file();
    let (bytes, inbox) = (bytes.to_vec(), inbox.clone());
    std::thread::spawn(move || {
        let Some(file) = pollster::block_on(asked) else {
            return;
        };
        if let Err(error) = std::fs::write(file.path(), bytes) {
            inbox.push(Incoming::Failed {
                reason: msg!(
                    "{file} could not be saved: {error}.",
                    file = file.path().display().to_string(),
                    error = error.to_string()
                ),
            });
        }
    });
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn arguments_are_queries_or_files() {
        assert!(is_query("lab=blend&t=1") && is_query("?lab=view"));
        assert!(!is_query("walk.bvh"));
    }

    fn received(inbox: &Inbox) -> Vec<String> {
        let name = |incoming| match incoming {
            Incoming::Failed { reason } => reason.to_string(),
            Incoming::File { name, .. } | Incoming::Large { name, .. } => name,
            other => format!("{other:?}"),
        };
        inbox.take().into_iter().map(name).collect()
    }

    #[test]
    fn motion_files_of_a_folder_are_read_in_order() {
        let folder = std::env::temp_dir().join(format!("segue-folder-test-{}", std::process::id()));
        std::fs::remove_dir_all(&folder).ok();
        std::fs::create_dir_all(folder.join("takes/b")).unwrap();
        std::fs::create_dir_all(folder.join("empty")).unwrap();
        for path in [
            "takes/c.bvh",
            "takes/b/2.amc",
            "takes/b/1.ASF",
            "takes/a.zip",
            "takes/notes.txt",
            "takes/._a.zip",
        ] {
            std::fs::write(folder.join(path), "x").unwrap();
        }
        let inbox = Inbox::default();
        read_path(&folder.join("takes"), &inbox);
        assert_eq!(
            received(&inbox),
            ["takes/a.zip", "takes/b/1.ASF", "takes/b/2.amc", "takes/c.bvh"]
        );
        read_path(&folder.join("empty"), &inbox);
        read_path(Path::new("/nowhere/walk.bvh"), &inbox);
        let reasons = received(&inbox);
        assert_eq!(
            reasons[0],
            "empty has no motion files (.bvh, .asf, .amc, .fbx, .glb, .gltf, .vrm, .vrma, .npz, .npy, .c3d, .trc, .csv, .zip, .gz)."
        );
        assert!(reasons[1].starts_with("walk.bvh cannot be read: "), "{reasons:?}");
        std::fs::remove_dir_all(&folder).unwrap();
    }
}
