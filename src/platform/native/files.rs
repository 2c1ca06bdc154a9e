//! Opening and saving of the user's files. Dialogues and reading run on threads of their own, so
//! that frames continue.

use super::LargeFile;
use crate::platform::bundle::{Bundle, is_in_folder, is_read_in_folder, leave_out_lone_images};
use crate::platform::motion_files::{MAX_FILE_BYTES, endings, last_part, no_motion_in, too_large};
use crate::platform::{Inbox, Incoming};
use eframe::egui::DroppedFileHandle;
use segue_formats::ZipWriter;
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
        read_paths(files.iter().map(rfd::FileHandle::path), &inbox);
    });
}

/// Reads the files dropped on the window, in order.
pub(crate) fn read_dropped(files: &[DroppedFileHandle], inbox: &Inbox) {
    let (files, inbox) = (files.to_vec(), inbox.clone());
    std::thread::spawn(move || read_paths(files.iter().map(|file| file.path()), &inbox));
}

/// Reads the files that the command line names, in order.
pub(crate) fn read_arguments(inbox: &Inbox) {
    let paths: Vec<PathBuf> = std::env::args()
        .skip(1)
        .filter(|argument| !is_query(argument))
        .map(PathBuf::from)
        .collect();
    let inbox = inbox.clone();
    std::thread::spawn(move || read_paths(paths.iter().map(PathBuf::as_path), &inbox));
}

/// Returns whether an argument is a link's query and not a file.
pub(super) fn is_query(argument: &str) -> bool {
    argument.starts_with('?') || (argument.contains('=') && !Path::new(argument).exists())
}

/// Reads files, and the motion files in and below folders.
fn read_paths<'a>(paths: impl Iterator<Item = &'a Path>, inbox: &Inbox) {
    let refused = |reason| inbox.push(Incoming::Failed { reason });
    let (mut files, mut folders) = (Vec::new(), Vec::new());
    for path in paths {
        let name = last_part(&path.to_string_lossy()).to_owned();
        if !path.is_dir() {
            files.push((name, path.to_path_buf()));
            continue;
        }
        match motion_files(path, &name) {
            Ok(found) => {
                files.extend(found);
                folders.push(name);
            }
            Err(error) => {
                refused(msg!("{name} cannot be read: {error}.", name, error = error.to_string()));
            }
        }
    }
    leave_out_lone_images(&mut files, |path| size_of(path));
    folders.retain(|folder| !files.iter().any(|(path, _)| is_in_folder(path, folder)));
    for folder in &folders {
        refused(no_motion_in(folder));
    }
    read_files(files, inbox);
}

/// A file that is opened.
enum Opened {
    AtPath(PathBuf),
    /// The archive of a bundle.
    Archive(Vec<u8>),
}

/// Reads files, each with its name in the library, in order.
fn read_files(files: Vec<(String, PathBuf)>, inbox: &Inbox) {
    let bundle = Bundle::of(&files, |path| size_of(path));
    let mut opened: Vec<_> =
        files.into_iter().map(|(name, path)| (name, Opened::AtPath(path))).collect();
    if let Some(bundle) = bundle {
        // Otherwise the model is read without its images.
        if let Some(archive) = archive_of(&bundle, &opened) {
            opened = bundle.replace(opened, Opened::Archive(archive));
        }
    }
    inbox.push(Incoming::Opening(opened.len()));
    for (name, file) in opened {
        match file {
            Opened::AtPath(path) => read_file(&path, name, inbox),
            Opened::Archive(bytes) => deliver(name, bytes, inbox),
        }
    }
}

/// Returns the archive of a bundle of these files; `None` if one of them cannot be read.
fn archive_of(bundle: &Bundle, files: &[(String, Opened)]) -> Option<Vec<u8>> {
    let mut zip = ZipWriter::default();
    for (index, path) in &bundle.members {
        let (_, Opened::AtPath(file)) = files.get(*index)? else { return None };
        zip.store(path, &std::fs::read(file).ok()?).ok()?;
    }
    Some(zip.finish())
}

fn size_of(path: &Path) -> u64 {
    std::fs::metadata(path).map_or(0, |metadata| metadata.len())
}

/// Returns the motion files in and below a folder in the order of their paths, and what models
/// refer to, each with its name in the library.
fn motion_files(folder: &Path, name: &str) -> std::io::Result<Vec<(String, PathBuf)>> {
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
                if kind.is_dir() || (kind.is_file() && is_read_in_folder(&own)) {
                    children.push((child.path(), format!("{name}/{own}"), kind.is_dir()));
                }
            }
            children.sort_by(|x, y| y.1.cmp(&x.1));
            waiting.extend(children);
        } else {
            files.push((name, path));
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
    match bytes {
        Ok(bytes) => deliver(name, bytes, inbox),
        Err(reason) => inbox.push(Incoming::Failed { reason }),
    }
}

/// Hands the bytes of a file to the app.
fn deliver(name: String, bytes: Vec<u8>, inbox: &Inbox) {
    let bytes: Arc<[u8]> = Arc::from(bytes);
    inbox.push(if bytes.len() as u64 > LARGE_BYTES {
        Incoming::Large { name, file: LargeFile::new(bytes) }
    } else {
        Incoming::File { name, bytes }
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

/// Saves a file that was written in the background.
pub(crate) fn download_file(file_name: &str, mime: &str, file: &LargeFile, inbox: &Inbox) {
    download(file_name, mime, file.bytes(), inbox);
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
        let read = |paths: &[&Path]| read_paths(paths.iter().copied(), &inbox);
        read(&[&folder.join("takes")]);
        assert_eq!(
            received(&inbox),
            ["Opening(4)", "takes/a.zip", "takes/b/1.ASF", "takes/b/2.amc", "takes/c.bvh"]
        );
        std::fs::write(folder.join("takes/b/fox.FBX"), "x").unwrap();
        std::fs::write(folder.join("takes/skin.png"), "x").unwrap();
        read(&[&folder.join("takes")]);
        assert_eq!(
            received(&inbox)[1..],
            ["takes/a.zip", "takes/b/1.ASF", "takes/b/2.amc", "takes/fox.zip", "takes/c.bvh"]
        );
        read(&[Path::new("/nowhere/walk.bvh"), &folder.join("empty")]);
        let reasons = received(&inbox);
        assert!(reasons[2].starts_with("walk.bvh cannot be read: "), "{reasons:?}");
        assert_eq!(
            reasons[0],
            "empty has no motion files (.bvh, .asf, .amc, .fbx, .glb, .gltf, .vrm, .vrma, .npz, .npy, .c3d, .trc, .csv, .zip, .gz)."
        );
        std::fs::remove_dir_all(&folder).unwrap();
    }
}
