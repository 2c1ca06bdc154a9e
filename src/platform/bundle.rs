//! Files that are opened together and belong together: models, and the images and arrays that they
//! refer to.

use super::motion_files::{is_motion_file, last_part};
use segue_formats::archive::{is_beside_scene, is_scene};
use segue_formats::{ZipFull, ZipWriter};

/// The greatest size of all files of a bundle together, bytes. The archive is made in memory.
const MAX_BYTES: u64 = 256 * 1024 * 1024;
/// The greatest number of models of a bundle: a clip whose motion is not in memory is read again
/// from the whole archive.
const MAX_MODELS: usize = 16;

/// Files that are read as one archive, because a reader gets one file, and the library stores it.
#[derive(Debug, PartialEq, Eq)]
pub(super) struct Bundle {
    /// The name of the archive: that of the first model, beside it.
    pub(super) name: String,
    /// The indices of its files among those that are opened, and their paths in the archive.
    pub(super) members: Vec<(usize, String)>,
}

impl Bundle {
    /// Returns the bundle of files that are opened together, given their names and sizes in bytes.
    /// `None` if no model is among them, or nothing beside it, or if there are too many or they are
    /// too large.
    pub(super) fn of<'a>(files: impl Iterator<Item = (&'a str, u64)>) -> Option<Self> {
        let files = files.enumerate().map(|(index, (name, bytes))| (index, name, bytes));
        let members: Vec<_> =
            files.filter(|(_, name, _)| is_scene(name) || is_beside_scene(name)).collect();
        let first = members.iter().map(|(_, name, _)| *name).find(|name| is_scene(name))?;
        let models = members.iter().filter(|(_, name, _)| is_scene(name)).count();
        let bytes: u64 = members.iter().map(|(.., bytes)| bytes).sum();
        if models == members.len() || models > MAX_MODELS || bytes > MAX_BYTES {
            return None;
        }
        let mut folder = folder_of(first);
        while !members.iter().all(|(_, name, _)| name.starts_with(folder)) {
            folder = folder_of(folder.trim_end_matches('/'));
        }
        let stem = last_part(first).rsplit_once('.').map_or(first, |(stem, _)| stem);
        let path = |name: &str| name.get(folder.len()..).unwrap_or(name).to_owned();
        Some(Self {
            name: format!("{folder}{stem}.zip"),
            members: members.iter().map(|&(index, name, _)| (index, path(name))).collect(),
        })
    }

    /// Puts the archive in the place of the first of its files.
    pub(super) fn replace<T>(self, mut files: Vec<(String, T)>, archive: T) -> Vec<(String, T)> {
        let Some(&(first, _)) = self.members.first() else {
            return files;
        };
        for &(index, _) in self.members.iter().rev() {
            files.remove(index);
        }
        files.insert(first, (self.name, archive));
        files
    }

    /// Returns the archive, given the contents of its files in the order of `members`.
    pub(super) fn archive(
        &self,
        contents: impl IntoIterator<Item = Vec<u8>>,
    ) -> Result<Vec<u8>, ZipFull> {
        let mut zip = ZipWriter::default();
        for ((_, path), bytes) in self.members.iter().zip(contents) {
            zip.store(path, &bytes)?;
        }
        Ok(zip.finish())
    }
}

/// Returns whether a file of a folder may be read, by its name: see [`leave_out_lone_images`].
pub(super) fn is_read_in_folder(name: &str) -> bool {
    is_motion_file(name) || (is_beside_scene(name) && !name.starts_with('.'))
}

/// Leaves out images and arrays of folders, unless they are in a bundle.
pub(super) fn leave_out_lone_images<T>(files: &mut Vec<(String, T)>, bytes: impl Fn(&T) -> u64) {
    if Bundle::of(files.iter().map(|(name, file)| (name.as_str(), bytes(file)))).is_none() {
        files.retain(|(name, _)| !is_beside_scene(name));
    }
}

/// Returns whether a file is in or below a folder.
pub(super) fn is_in_folder(path: &str, folder: &str) -> bool {
    path.strip_prefix(folder).is_some_and(|rest| rest.starts_with('/'))
}

/// Returns a path up to its last `/`.
fn folder_of(path: &str) -> &str {
    path.rfind('/').and_then(|at| path.get(..=at)).unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;
    use segue_formats::archive::{ArchiveLimits, unpack};

    fn of(names: &[&str]) -> Option<Bundle> {
        Bundle::of(names.iter().map(|name| (*name, 10)))
    }

    #[test]
    fn models_and_what_they_refer_to_are_a_bundle() {
        let bundle = of(&["walk.bvh", "skin.PNG", "fox.gltf", "fox.bin", "notes.txt"]).unwrap();
        assert_eq!(bundle.name, "fox.zip");
        let members = [(1, "skin.PNG"), (2, "fox.gltf"), (3, "fox.bin")];
        assert_eq!(bundle.members, members.map(|(index, path)| (index, path.to_owned())));
        let files = ["walk.bvh", "skin.PNG", "fox.gltf", "fox.bin", "notes.txt"];
        let files = files.map(|name| (name.to_owned(), false)).to_vec();
        let replaced = bundle.replace(files, true);
        let expected = [("walk.bvh", false), ("fox.zip", true), ("notes.txt", false)];
        assert_eq!(replaced, expected.map(|(name, is_archive)| (name.to_owned(), is_archive)));
        // Nothing beside the model, and nothing that refers to images.
        assert_eq!(of(&["fox.fbx", "walk.bvh"]), None);
        assert_eq!(of(&["skin.png", "walk.bvh"]), None);
        assert_eq!(of(&[]), None);
        let large = [("fox.fbx", MAX_BYTES), ("skin.png", 1)];
        assert_eq!(Bundle::of(large.into_iter()), None);
        let many = |models| [vec!["fox.fbx"; models], vec!["skin.png"]].concat();
        assert!(of(&many(MAX_MODELS)).is_some() && of(&many(MAX_MODELS + 1)).is_none());
    }

    #[test]
    fn images_of_a_folder_are_left_out_without_a_model() {
        assert!(["a.bvh", "a.PNG", "a.bin"].into_iter().all(is_read_in_folder));
        assert!(![".a.png", "._a.bvh", "notes.txt"].into_iter().any(is_read_in_folder));
        let left = |names: &[&str]| {
            let mut files = names.iter().map(|name| ((*name).to_owned(), 10)).collect();
            leave_out_lone_images(&mut files, |bytes| *bytes);
            files.into_iter().map(|(name, _)| name).collect::<Vec<_>>()
        };
        assert_eq!(left(&["walk", "z/a.bvh", "z/a.png"]), ["walk", "z/a.bvh"]);
        assert_eq!(left(&["a.fbx", "maps/a.png"]), ["a.fbx", "maps/a.png"]);
        assert!(is_in_folder("maps/a.png", "maps") && !is_in_folder("maps2/a.png", "maps"));
    }

    #[test]
    fn archive_of_a_folder_has_the_paths_below_what_its_files_share() {
        let names = ["zoo/fox/model/fox.fbx", "zoo/fox/maps/a/skin.png", "zoo/fox/maps/skin.jpeg"];
        let bundle = of(&names).unwrap();
        assert_eq!(bundle.name, "zoo/fox/fox.zip");
        let archive = bundle.archive([b"x", b"y", b"z"].map(|content| content.to_vec())).unwrap();
        let files = unpack("fox.zip", &archive, &ArchiveLimits::default()).unwrap().files;
        let paths: Vec<&str> = files.iter().map(|file| file.path.as_str()).collect();
        assert_eq!(paths, ["maps/a/skin.png", "maps/skin.jpeg", "model/fox.fbx"]);
        // Names that only begin alike share no folder.
        let bundle = of(&["zoo/a.fbx", "zoom/a.png"]).unwrap();
        assert_eq!((bundle.name.as_str(), bundle.members[1].1.as_str()), ("a.zip", "zoom/a.png"));
    }
}
