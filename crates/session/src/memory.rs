//! Memory of the page: its size, the part in use, and the expected need of a file.

use super::clip_facts::motion_bytes;
use super::library::{Entry, Library, Origin};
use super::reading::Content;
use segue_motion::clip::Clip;
use segue_motion::math::sort::sort_by_key;
use segue_text::{Message, msg};
use std::cmp::Reverse;
use std::collections::BTreeSet;
use std::sync::Arc;

/// The memory of a page, bytes. The memory of a WebAssembly instance grows and never shrinks: freed
/// memory is used again.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PageMemory {
    /// The current size.
    pub bytes: u64,
    /// The greatest size.
    pub limit: u64,
    /// The part that is reserved for clips on their way from a reader.
    pub coming: u64,
}

impl PageMemory {
    /// Returns the greatest size of a page's memory, bytes: 3 GB of the 4 GiB that WebAssembly can
    /// address, since results and their drawings need memory beside the clips; but at most half the
    /// memory of the device, if the browser reports it.
    #[must_use]
    pub fn limit_of(device_gib: Option<f64>) -> u64 {
        let most = 3_000_000_000;
        let half = |gib: f64| (gib * 0.5 * f64::from(1 << 30)) as u64;
        device_gib.filter(|gib| *gib > 0.0).map_or(most, |gib| half(gib).min(most))
    }
}

/// Memory in use, bytes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MemoryUse {
    /// The part in use.
    pub used: u64,
    /// The greatest total.
    pub limit: u64,
}

impl MemoryUse {
    /// Returns the remaining memory, bytes.
    #[must_use]
    pub fn left(self) -> u64 {
        self.limit.saturating_sub(self.used)
    }

    /// Returns the share in use, 0 to 1.
    #[must_use]
    pub fn share(self) -> f32 {
        (self.used as f64 / self.limit.max(1) as f64).min(1.0) as f32
    }
}

/// An estimate of the memory in use. The page does not report its free memory, but the memory that
/// clips freed is known.
#[derive(Clone, Copy, Debug)]
pub(super) struct Memory {
    page: PageMemory,
    /// The memory of the library's clips, bytes.
    held: u64,
    /// The memory that clips freed, bytes: the difference between the page's size and its use.
    freed: u64,
}

impl Memory {
    /// Updates the estimate from the page's size and the memory of the library's clips, bytes.
    pub(super) fn follow(before: Option<Self>, page: PageMemory, clips: u64) -> Self {
        let held = clips.saturating_add(page.coming);
        let freed = before
            .map_or(0, |before| before.freed.saturating_add(before.held).saturating_sub(held));
        Self { page, held, freed: freed.min(page.bytes) }
    }

    pub(super) fn in_use(&self) -> MemoryUse {
        MemoryUse { used: self.page.bytes - self.freed, limit: self.page.limit }
    }

    /// Returns whether memory is so scarce that motions that are not shown are dropped.
    pub(super) fn is_scarce(&self) -> bool {
        self.page.bytes > self.page.limit / 2
    }
}

fn clip_bytes(clip: &Clip) -> u64 {
    motion_bytes(clip.frames(), clip.skeleton().len(), clip.translations().len())
}

/// Returns the expected memory of a file's clips, bytes, from its name and size alone. The clips of
/// 30 BVH files of captured motion took 0.27 to 0.71 times the file's size; text compresses to
/// about a quarter, and files from an archive are kept beside their clips.
pub(super) fn expected_bytes(name: &str, size: u64) -> u64 {
    let ending = name.rsplit_once('.').map_or("", |(_, ending)| ending).to_ascii_lowercase();
    match ending.as_str() {
        "zip" | "gz" => size.saturating_mul(7),
        "fbx" => size.saturating_mul(2),
        "glb" | "gltf" | "vrm" | "vrma" | "npy" | "npz" => size,
        _ => size / 4 * 3,
    }
}

/// Returns the memory of a library, bytes.
pub(super) fn library_bytes(library: &Library) -> u64 {
    let mut meshes = MeshesOnce::default();
    let bytes = |entry: &Arc<Entry>| entry_bytes(entry) + meshes.bytes(entry);
    library.entries().iter().map(bytes).sum()
}

/// The meshes that were counted: the clips of a file share one.
#[derive(Default)]
pub(crate) struct MeshesOnce(BTreeSet<usize>);

impl MeshesOnce {
    /// Returns the memory of a clip's mesh, bytes; 0 for one that was counted with another clip.
    pub(crate) fn bytes(&mut self, entry: &Entry) -> u64 {
        let mesh = entry.mesh.as_ref();
        let new = mesh.filter(|mesh| self.0.insert(Arc::as_ptr(mesh).addr()));
        new.map_or(0, |mesh| mesh.bytes())
    }
}

/// Returns the memory of a clip without its mesh, bytes.
fn entry_bytes(entry: &Entry) -> u64 {
    let motion = entry.motion.as_ref().map_or(0, |motion| clip_bytes(motion.clip()));
    let file = match &entry.origin {
        Origin::File(file) if file.index == 0 => match &file.content {
            Content::Here(bytes) => bytes.len() as u64,
            Content::Outside(_) => 0,
        },
        _ => 0,
    };
    motion + file
}

/// Returns megabytes for messages, rounded up.
fn megabytes(bytes: u64) -> u64 {
    bytes.div_ceil(1_000_000)
}

/// The number of removable clips that a message names.
const MAX_NAMED: usize = 3;
/// The least size of a clip that is worth removing, bytes.
const MIN_REMOVABLE_BYTES: u64 = 10_000_000;

/// Returns the message that there is no memory for a file of `size` bytes, which needs `needed`,
/// with the remedy.
pub(super) fn refusal(
    name: &str,
    size: u64,
    needed: u64,
    memory: MemoryUse,
    library: &Library,
) -> Message {
    let mut large: Vec<(&str, u64)> = library
        .entries()
        .iter()
        .map(|entry| (entry.name.as_str(), entry_bytes(entry) + MeshesOnce::default().bytes(entry)))
        .filter(|(_, bytes)| *bytes >= MIN_REMOVABLE_BYTES)
        .collect();
    sort_by_key(&mut large, |(_, bytes)| Reverse(*bytes));
    let named: Vec<Message> = large
        .iter()
        .take(MAX_NAMED)
        .map(|(name, bytes)| {
            msg!("{name} ({mb} MB)", name = (*name).to_owned(), mb = megabytes(*bytes))
        })
        .collect();
    let advice = if named.is_empty() {
        Message::word("Cut the motion into parts.")
    } else {
        msg!("Remove clips that you do not need; the largest are {named}.")
    };
    let told = msg!(
        "There is no memory for {name} ({size} MB): its clips need {needed} MB, and {left} of {limit} MB are left.",
        name = name.to_owned(),
        size = megabytes(size),
        needed = megabytes(needed),
        left = memory.left() / 1_000_000,
        limit = megabytes(memory.limit),
    );
    Message::joined(vec![told, advice], " ")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::library::SourceFile;
    use glam::Vec3;
    use segue_formats::{FileKind, ImportOptions};
    use segue_motion::skin::SkinnedMesh;

    const GB: u64 = 1 << 30;

    /// Returns a library of files of these names and sizes, bytes.
    fn library_of<const N: usize>(files: [(&str, usize); N]) -> Library {
        let entry = |(name, size): (&str, usize)| {
            let file = SourceFile {
                name: name.into(),
                sha256: String::new(),
                content: Content::Here(vec![0; size].into()),
                size: size as u64,
                kind: FileKind::Bvh,
                skeleton_file: None,
                index: 0,
                options: ImportOptions::default(),
            };
            Entry::new(name, name.to_owned(), Origin::File(file))
        };
        files.into_iter().map(entry).collect()
    }

    fn page(bytes: u64, coming: u64) -> PageMemory {
        PageMemory { bytes, limit: 3 * GB, coming }
    }

    #[test]
    fn memory_freed_by_clips_is_available() {
        let mut memory = Memory::follow(None, page(GB / 10, 0), 0);
        assert_eq!(memory.in_use().used, GB / 10);
        // A clip of 2 GB is transferred, arrives, and is removed.
        memory = Memory::follow(Some(memory), page(2 * GB + GB / 10, 2 * GB), 0);
        memory = Memory::follow(Some(memory), page(2 * GB + GB / 10, 0), 2 * GB);
        assert_eq!(memory.in_use().used, 2 * GB + GB / 10);
        assert!(memory.in_use().left() < GB && memory.is_scarce());
        memory = Memory::follow(Some(memory), page(2 * GB + GB / 10, 0), 0);
        assert_eq!(memory.in_use().used, GB / 10);
        // The next one uses that memory, and more.
        memory = Memory::follow(Some(memory), page(2 * GB + GB / 2, 0), 2 * GB + GB / 4);
        assert_eq!(memory.in_use().used, 2 * GB + GB / 2);
        // A cancelled transfer frees its memory, too.
        memory = Memory::follow(Some(memory), page(3 * GB, GB / 2), 2 * GB + GB / 4);
        memory = Memory::follow(Some(memory), page(3 * GB, 0), 2 * GB + GB / 4);
        assert_eq!(memory.in_use().left(), GB / 2);
    }

    #[test]
    fn limit_is_three_gigabytes_or_half_of_the_device() {
        let limits = [None, Some(8.0), Some(4.0), Some(0.5), Some(0.0), Some(f64::NAN)]
            .map(PageMemory::limit_of);
        let most = 3_000_000_000;
        assert_eq!(limits, [most, most, 2 * GB, GB / 4, most, most]);
    }

    #[test]
    fn use_of_memory_has_a_share_and_a_rest() {
        let (half, over) = ([1, 2], [3, 2]);
        let facts = [half, over]
            .map(|[used, limit]| MemoryUse { used, limit })
            .map(|memory| (memory.share(), memory.left()));
        assert_eq!(facts, [(0.5, 1), (1.0, 0)]);
    }

    #[test]
    fn expected_memory_follows_the_kind_of_file() {
        let expected = ["a.bvh", "A.AMC", "b.GLB", "c.zip", "c.bvh.gz", "none"]
            .map(|name| expected_bytes(name, 4000));
        assert_eq!(expected, [3000, 3000, 4000, 28_000, 28_000, 3000]);
    }

    #[test]
    fn mesh_that_clips_share_is_counted_once() {
        let mesh = Arc::new(SkinnedMesh { positions: vec![Vec3::ZERO; 10], ..Default::default() });
        let with_mesh =
            |entry: &Arc<Entry>| Entry { mesh: Some(Arc::clone(&mesh)), ..Entry::clone(entry) };
        let files = library_of([("a", 1000), ("b", 2000)]);
        let library: Library = files.entries().iter().map(with_mesh).collect();
        assert_eq!(library_bytes(&library), 3000 + mesh.bytes());
    }

    #[test]
    fn refusal_names_memory_file_and_the_largest_clips() {
        let memory = MemoryUse { used: 2_900_000_000, limit: 3_000_000_000 };
        let none = refusal("long.bvh", 480_000_000, 1_250_000_001, memory, &Library::default());
        assert_eq!(
            none.to_string(),
            "There is no memory for long.bvh (480 MB): its clips need 1251 MB, and 100 of 3000 MB are left. Cut the motion into parts."
        );
        // Five files, the smallest of which would not help.
        let library = library_of([
            ("b", 20_000_000),
            ("a", 30_000_000),
            ("tiny", 9_000_000),
            ("d", 10_000_001),
            ("c", 11_000_000),
        ]);
        assert_eq!(library_bytes(&library), 80_000_001);
        let named = refusal("long.bvh", 1, 1, memory, &library);
        assert!(
            named.to_string().ends_with("Remove clips that you do not need; the largest are a (30 MB), b (20 MB), c (11 MB)."),
            "{named}"
        );
    }
}
