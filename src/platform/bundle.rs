//! Files that are opened together and belong together: models, and the images and arrays that they
//! refer to.

use super::motion_files::{is_motion_file, last_part};
use segue_formats::archive::{is_beside_scene, is_scene};

/// The greatest size of all files of a bundle together, bytes. The reader unpacks them in memory.
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
    /// Returns the bundle of files that are opened together, each with its name; `bytes` returns
    /// the size of one. `None` if no model is among them, or nothing beside it, or if there are too
    /// many or they are too large.
    pub(super) fn of<T>(files: &[(String, T)], bytes: impl Fn(&T) -> u64) -> Option<Self> {
        let names = files.iter().map(|(name, _)| name.as_str()).enumerate();
        let members: Vec<_> =
            names.filter(|(_, name)| is_scene(name) || is_beside_scene(name)).collect();
        let (_, first) = *members.iter().find(|(_, name)| is_scene(name))?;
        let models = members.iter().filter(|(_, name)| is_scene(name)).count();
        if models == members.len() || models > MAX_MODELS {
            return None;
        }
        let sizes = members.iter().filter_map(|(index, _)| files.get(*index));
        if sizes.map(|(_, file)| bytes(file)).sum::<u64>() > MAX_BYTES {
            return None;
        }
        let mut folder = folder_of(first);
        while !members.iter().all(|(_, name)| name.starts_with(folder)) {
            folder = folder_of(folder.trim_end_matches('/'));
        }
        let stem = last_part(first).rsplit_once('.').map_or(first, |(stem, _)| stem);
        let path = |name: &str| name.get(folder.len()..).unwrap_or(name).to_owned();
        Some(Self {
            name: format!("{folder}{stem}.zip"),
            members: members.iter().map(|&(index, name)| (index, path(name))).collect(),
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
}

/// Returns whether a file of a folder may be read, by its name: see [`leave_out_lone_images`].
pub(super) fn is_read_in_folder(name: &str) -> bool {
    is_motion_file(name) || (is_beside_scene(name) && !name.starts_with('.'))
}

/// Leaves out images and arrays of folders, unless they are in a bundle.
pub(super) fn leave_out_lone_images<T>(files: &mut Vec<(String, T)>, bytes: impl Fn(&T) -> u64) {
    if Bundle::of(files, bytes).is_none() {
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

    fn of(names: &[&str]) -> Option<Bundle> {
        let files: Vec<_> = names.iter().map(|name| ((*name).to_owned(), ())).collect();
        Bundle::of(&files, |()| 10)
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
        let large = large.map(|(name, bytes)| (name.to_owned(), bytes));
        assert_eq!(Bundle::of(&large, |bytes| *bytes), None);
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
        let paths: Vec<&str> = bundle.members.iter().map(|(_, path)| path.as_str()).collect();
        assert_eq!(paths, ["model/fox.fbx", "maps/a/skin.png", "maps/skin.jpeg"]);
        // Names that only begin alike share no folder.
        let bundle = of(&["zoo/a.fbx", "zoom/a.png"]).unwrap();
        assert_eq!((bundle.name.as_str(), bundle.members[1].1.as_str()), ("a.zip", "zoom/a.png"));
    }
}
