//! The files that some words name: files, folders with all below them, and patterns.

use crate::error::BatchError;
use glob::MatchOptions;
use segue_formats::{ARCHIVE_ENDINGS, MOTION_ENDINGS};
use std::collections::BTreeSet;
use std::ffi::OsString;
use std::path::{Path, PathBuf};
use walkdir::{DirEntry, WalkDir};

/// A file to read.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Input {
    /// The path by which it is opened.
    pub path: PathBuf,
    /// The name in messages and reports: the path with `/` between folders.
    pub name: String,
    /// The path below the folder that was named; the file's own name where it was named itself.
    pub relative: PathBuf,
    /// Whether it was named itself. A file that was found in a folder and holds no motion is left
    /// out.
    pub is_named: bool,
}

/// The files that some words name, in the order of the words; those of a folder sorted by path.
#[derive(Clone, Debug, Default)]
pub struct Inputs {
    /// The files, each once.
    pub files: Vec<Input>,
    /// The words that lead to no file, a sentence each.
    pub problems: Vec<String>,
    seen: BTreeSet<PathBuf>,
}

impl Inputs {
    /// Returns the files that some words name.
    ///
    /// # Errors
    /// [`BatchError::Unusable`] if they name no file at all.
    pub fn of(words: &[OsString]) -> Result<Self, BatchError> {
        let mut inputs = Self::default();
        for word in words {
            inputs.add(word);
        }
        if inputs.files.is_empty() {
            return Err(BatchError::Unusable(inputs.problems.join("\n")));
        }
        Ok(inputs)
    }

    /// Adds the files of a word.
    pub fn add(&mut self, word: &OsString) {
        let path = Path::new(word);
        if path.is_dir() {
            return self.add_folder(path);
        }
        if path.exists() {
            return self.add_file(path, Path::new(path.file_name().unwrap_or(word)), true);
        }
        let text = word.to_string_lossy();
        if !text.contains(['*', '?', '[']) {
            return self.problems.push(format!("there is no file or folder `{text}`"));
        }
        // As in a shell, a pattern finds no hidden files.
        let how = MatchOptions { require_literal_leading_dot: true, ..MatchOptions::new() };
        let found = match glob::glob_with(&text, how) {
            Ok(paths) => paths.filter_map(Result::ok).collect::<Vec<_>>(),
            Err(error) => return self.problems.push(format!("`{text}` is no pattern: {error}")),
        };
        if found.is_empty() {
            return self.problems.push(format!("no file matches `{text}`"));
        }
        for path in found {
            if path.is_dir() {
                self.add_folder(&path);
            } else {
                let name = path.file_name().unwrap_or_default().to_owned();
                self.add_file(&path, Path::new(&name), true);
            }
        }
    }

    fn add_folder(&mut self, folder: &Path) {
        let is_shown = |entry: &DirEntry| {
            entry.depth() == 0 || !entry.file_name().to_string_lossy().starts_with('.')
        };
        let mut is_empty = true;
        let walk = WalkDir::new(folder).sort_by_file_name().into_iter().filter_entry(is_shown);
        for entry in walk {
            match entry {
                Ok(entry) if entry.file_type().is_file() && is_motion_file(entry.path()) => {
                    let relative = entry.path().strip_prefix(folder).unwrap_or(entry.path());
                    self.add_file(entry.path(), relative, false);
                    is_empty = false;
                }
                Ok(_) => {}
                Err(error) => self.problems.push(error.to_string()),
            }
        }
        if is_empty {
            let endings: Vec<String> = MOTION_ENDINGS
                .iter()
                .chain(&ARCHIVE_ENDINGS)
                .map(|ending| format!(".{ending}"))
                .collect();
            self.problems.push(format!(
                "{} has no motion files ({})",
                shown(folder),
                endings.join(", ")
            ));
        }
    }

    fn add_file(&mut self, path: &Path, relative: &Path, is_named: bool) {
        if self.seen.insert(path.to_owned()) {
            let (path, relative) = (path.to_owned(), relative.to_owned());
            self.files.push(Input { name: shown(&path), path, relative, is_named });
        }
    }
}

/// Returns a path for messages, with `/` between folders.
#[must_use]
pub fn shown(path: &Path) -> String {
    let text = path.to_string_lossy();
    if std::path::MAIN_SEPARATOR == '/' { text.into_owned() } else { text.replace('\\', "/") }
}

/// Returns whether the ending of a path is one of a motion file or an archive.
fn is_motion_file(path: &Path) -> bool {
    let mut endings = MOTION_ENDINGS.iter().chain(&ARCHIVE_ENDINGS);
    has_ending(path, |own| endings.any(|ending| own.eq_ignore_ascii_case(ending)))
}

/// Returns whether a path has an ending, and the ending is as asked for.
pub fn has_ending(path: &Path, is_it: impl FnOnce(&str) -> bool) -> bool {
    path.extension().and_then(|ending| ending.to_str()).is_some_and(is_it)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns an empty folder of its own below the system's temporary one.
    fn folder(name: &str) -> PathBuf {
        let folder =
            std::env::temp_dir().join(format!("segue-batch-{}-{name}", std::process::id()));
        std::fs::remove_dir_all(&folder).ok();
        std::fs::create_dir_all(folder.join("b/.hidden")).unwrap();
        folder
    }

    #[test]
    fn inputs_of_a_folder_are_its_motion_files_in_order() {
        let folder = folder("order");
        for name in ["b/走路.BVH", "a.bvh", "b/x.txt", ".a.bvh", "b/.hidden/y.bvh", "c.zip"] {
            std::fs::write(folder.join(name), "x").unwrap();
        }
        let all = Inputs::of(&[folder.clone().into()]).unwrap();
        let found: Vec<_> = all.files.iter().map(|file| shown(&file.relative)).collect();
        assert_eq!(found, ["a.bvh", "b/走路.BVH", "c.zip"]);
        assert!(all.problems.is_empty() && all.files.iter().all(|file| !file.is_named));
        // A file that is named twice is read once, at its first place.
        let words = [folder.join("c.zip"), folder.join("*.bvh"), folder.clone(), "none".into()];
        let all = Inputs::of(&words.map(OsString::from)).unwrap();
        let found: Vec<_> = all.files.iter().map(|file| shown(&file.relative)).collect();
        assert_eq!(found, ["c.zip", "a.bvh", "b/走路.BVH"]);
        assert_eq!(all.problems, ["there is no file or folder `none`"]);
        std::fs::remove_dir_all(folder).unwrap();
    }

    #[test]
    fn inputs_without_a_file_are_refused() {
        let folder = folder("empty");
        let pattern = folder.join("*.bvh");
        for (word, reason) in
            [(&folder, "has no motion files (.bvh, "), (&pattern, "no file matches")]
        {
            let failure = Inputs::of(&[OsString::from(word)]).unwrap_err();
            assert!(failure.to_string().contains(reason), "{failure}");
        }
        std::fs::remove_dir_all(folder).unwrap();
    }
}
