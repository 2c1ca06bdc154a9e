//! Files of the user: into the window and out of it. Reading and asking happen on threads of their own, so that the picture goes on.

use super::LargeFile;
use crate::platform::{Inbox, Incoming, last_part, too_large};
use eframe::egui::DroppedFileHandle;
use segue::session::reading::LARGE_BYTES;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Lets the user choose files.
pub(crate) fn open_files(inbox: &Inbox) {
    let asked = rfd::AsyncFileDialog::new()
        .add_filter("Motion files", &["bvh", "asf", "amc", "zip", "gz"])
        .add_filter("All files", &["*"])
        .pick_files();
    let inbox = inbox.clone();
    std::thread::spawn(move || {
        for file in pollster::block_on(asked).unwrap_or_default() {
            read_path(file.path(), &inbox);
        }
    });
}

/// Reads what was dropped on the window, in order.
pub(crate) fn read_dropped(files: Vec<DroppedFileHandle>, inbox: &Inbox) {
    let inbox = inbox.clone();
    std::thread::spawn(move || {
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
        for path in paths {
            read_path(&path, &inbox);
        }
    });
}

/// Whether an argument is a link's query and not a file.
pub(super) fn is_query(argument: &str) -> bool {
    argument.starts_with('?') || (argument.contains('=') && !Path::new(argument).exists())
}

fn read_path(path: &Path, inbox: &Inbox) {
    let shown = path.to_string_lossy().into_owned();
    let name = last_part(&shown).to_owned();
    let unreadable = |error: std::io::Error| format!("{name} cannot be read: {error}.");
    let bytes = if path.is_dir() {
        Err(format!("{name} is a folder. Drop the files in it."))
    } else {
        match std::fs::metadata(path) {
            Ok(metadata) => match too_large(&name, metadata.len()) {
                Some(reason) => Err(reason),
                None => std::fs::read(path).map_err(unreadable),
            },
            Err(error) => Err(unreadable(error)),
        }
    };
    inbox.push(match bytes {
        Ok(bytes) if bytes.len() as u64 > LARGE_BYTES => Incoming::Large {
            name,
            file: LargeFile::new(Arc::from(bytes)),
        },
        Ok(bytes) => Incoming::File {
            name,
            bytes: Arc::from(bytes),
        },
        Err(reason) => Incoming::Failed { reason },
    });
}

/// Asks where to and writes a file there.
pub(crate) fn download(file_name: &str, _mime: &str, bytes: &[u8], inbox: &Inbox) {
    let asked = rfd::AsyncFileDialog::new().set_file_name(file_name).save_file();
    let (bytes, inbox) = (bytes.to_vec(), inbox.clone());
    std::thread::spawn(move || {
        let Some(file) = pollster::block_on(asked) else { return };
        if let Err(error) = std::fs::write(file.path(), bytes) {
            inbox.push(Incoming::Failed {
                reason: format!("{} could not be saved: {error}.", file.path().display()),
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

    #[test]
    fn folders_and_missing_files_are_told() {
        let inbox = Inbox::default();
        read_path(Path::new(env!("CARGO_MANIFEST_DIR")), &inbox);
        read_path(Path::new("/nowhere/walk.bvh"), &inbox);
        let reasons: Vec<String> = (inbox.take().into_iter())
            .map(|incoming| {
                if let Incoming::Failed { reason } = incoming {
                    reason
                } else {
                    String::new()
                }
            })
            .collect();
        assert!(reasons[0].ends_with("is a folder. Drop the files in it."), "{reasons:?}");
        assert!(reasons[1].starts_with("walk.bvh cannot be read: "), "{reasons:?}");
    }
}
