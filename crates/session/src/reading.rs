//! Reading of files outside the document: a pure function of names and bytes, so that a thread or
//! worker can read a large file.

mod converted;
mod skeletons;
mod wire;

pub(crate) use converted::without_motion;
pub use skeletons::SkeletonFile;
pub(crate) use wire::{CharacterHead, put_character};
pub use wire::{Parcel, Unpacker, WireError};

use super::bone_map::{BoneMaps, mapped};
use super::convert::{ConvertOptions, ConvertedClip};
use super::hex;
use super::outside;
use converted::convert_file;
use segue_formats::acclaim::{self, AcclaimSkeleton};
use segue_formats::archive::{self, ArchiveLimits};
use segue_formats::numpy::{self, SmplModel};
use segue_formats::{
    FileKind, ImportError, ImportOptions, ImportedClip, ImportedFile, Resolve, fbx, gltf,
    import_with_progress, kind_of, unpack_gzip,
};
use segue_motion::clip::{Motion, with_body_plan_of};
use segue_motion::skeleton::Roles;
use segue_motion::skin::SkinnedMesh;
use segue_text::{Message, ToMessage, msg};
use serde::{Deserialize, Serialize};
use sha2::{Digest as _, Sha256};
use skeletons::{Skeletons, mismatch};
use std::collections::BTreeMap;
use std::sync::Arc;

/// Files above this size are not read between two frames, bytes.
pub const LARGE_BYTES: u64 = 1 << 20;

/// The location of a file's bytes.
#[derive(Clone, Debug, PartialEq)]
pub enum Content {
    /// In the document.
    Here(Arc<[u8]>),
    /// With the platform, under this key, because they are too large to be copied. Once the file
    /// was read, the key is its SHA-256.
    Outside(String),
}

/// A file to be read, with options.
#[derive(Clone, Debug, PartialEq)]
pub struct ReadTask {
    /// Its number.
    pub id: u64,
    /// The file's name.
    pub name: String,
    /// Its bytes.
    pub content: Content,
    /// The number of its bytes.
    pub size: u64,
    /// The options of reading it.
    pub setup: ReadSetup,
    /// The result that is asked for.
    pub product: Product,
}

impl ReadTask {
    /// Returns the task of a packed motion of `size` bytes, which are handed over beside it.
    #[must_use]
    pub fn of_packed_motion(id: u64, name: &str, size: usize) -> Self {
        Self {
            id,
            name: name.to_owned(),
            content: Content::Outside(String::new()),
            size: size as u64,
            setup: ReadSetup::default(),
            product: Product::PackedMotion,
        }
    }
}

/// The result that is asked for of a file.
#[derive(Clone, Debug, PartialEq)]
pub enum Product {
    /// Its clips ([`read`]).
    Clips,
    /// Its clips in another format ([`read_and_convert`]).
    Convert(Arc<ConvertOptions>),
    /// The bytes that [`packed::write`](crate::packed::write) returns for a packed motion.
    PackedMotion,
}

/// Options of reading a file.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ReadSetup {
    /// The options that the user set: unit, up axis and frame rate.
    pub options: ImportOptions,
    /// Roles that were set by hand, by the index of the clip in the file.
    pub roles: BTreeMap<usize, Roles>,
    /// The corrected body parts of rigs.
    #[serde(default)]
    pub bone_maps: Arc<BoneMaps>,
    /// Files that it may depend on: skeletons for the motion of another file.
    pub skeleton_files: Vec<SkeletonFile>,
    /// SHA-256 of the file's bytes, if it is known already; lower-case hexadecimal.
    #[serde(default)]
    pub sha256: Option<String>,
}

/// The result of reading a file: one part for a motion file, several for an archive.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ReadReport {
    /// The motion files.
    pub files: Vec<ReadFile>,
    /// Notes on the whole file, one sentence each.
    pub notes: Vec<Message>,
}

impl ReadReport {
    /// Returns whether it is a single motion file outside any archive.
    #[must_use]
    pub fn is_one_file(&self) -> bool {
        matches!(self.files.as_slice(), [file] if file.unpacked.is_none())
    }
}

/// A motion file that was read.
#[derive(Clone, Debug, PartialEq)]
pub struct ReadFile {
    /// The file's name.
    pub name: String,
    /// SHA-256 of its bytes, lower-case hexadecimal.
    pub sha256: String,
    /// The number of its bytes.
    pub size: u64,
    /// Its format.
    pub kind: FileKind,
    /// Its bytes, if it was unpacked from an archive: there is no other copy. If it was converted,
    /// the compressed bytes of the new file.
    pub unpacked: Option<Vec<u8>>,
    /// The clip that was converted, or the reason why there is none; `None` where no conversion was
    /// asked for.
    pub converted: Option<Result<ConvertedClip, Message>>,
    /// Its clips, or the error.
    pub result: Result<ReadClips, ImportError>,
}

/// The clips of a file.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ReadClips {
    /// One clip for each character.
    pub clips: Vec<ReadClip>,
    /// The oddities, one sentence each.
    pub warnings: Vec<Message>,
    /// The skeleton file that was used.
    pub skeleton_file: Option<Box<SkeletonFile>>,
    /// Whether there are no clips because the skeleton file is missing.
    pub awaits_skeleton: bool,
}

/// A clip with everything derived from it.
#[derive(Clone, Debug, PartialEq)]
pub struct ReadClip {
    /// The clip.
    pub motion: Motion,
    /// The report on how it was read.
    pub about: About,
    /// The mesh of the file on the clip's skeleton; all clips of one character share it.
    pub mesh: Option<Arc<SkinnedMesh>>,
}

/// A report on how a clip was read, shown in the clip panel.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct About {
    /// Unit, height and up axis, in words.
    pub measure: Message,
    /// Whether the file's first row is a T-pose that the motion does not start from.
    pub t_pose_first_row: bool,
    /// Whether that row was left out.
    pub t_pose_dropped: bool,
    /// Metres per unit that would make the body as tall as a person, if its size is implausible.
    #[serde(default)]
    pub fitting_unit: Option<f64>,
    /// Whether the root is far off in single rows.
    #[serde(default)]
    pub wild_rows: bool,
}

/// The type of [`read`], and of functions that replace it.
pub type ReadFunction =
    fn(&str, &[u8], &ReadSetup, &mut dyn FnMut(usize) -> bool) -> Option<ReadReport>;

/// Reads a file, or all motion files of an archive. `progress` receives the bytes done and returns
/// whether to continue; the result is `None` if it returned `false`.
pub fn read(
    name: &str,
    bytes: &[u8],
    setup: &ReadSetup,
    progress: &mut dyn FnMut(usize) -> bool,
) -> Option<ReadReport> {
    read_each(name, bytes, setup, &|_| None, None, progress)
}

/// Reads a file as [`read`] does. `beside` returns the bytes of a file beside it, by its path from
/// there: the buffers of a glTF file, or images of textures.
pub fn read_beside(
    name: &str,
    bytes: &[u8],
    setup: &ReadSetup,
    beside: Resolve<'_>,
    progress: &mut dyn FnMut(usize) -> bool,
) -> Option<ReadReport> {
    read_each(name, bytes, setup, beside, None, progress)
}

/// Reads a file as [`read`] does, and converts its clips. Of an archive each file is converted as
/// soon as it is read and its motions are dropped, so that many take the memory of one.
///
/// Programs that only [`read`] are linked without what writes files.
pub fn read_and_convert(
    name: &str,
    bytes: &[u8],
    setup: &ReadSetup,
    options: &ConvertOptions,
    progress: &mut dyn FnMut(usize) -> bool,
) -> Option<ReadReport> {
    let convert: Convert<'_> = &|file| convert_file(file, options);
    read_each(name, bytes, setup, &|_| None, Some(convert), progress)
}

/// A function that replaces a file with clips by files that are converted.
type Convert<'a> = &'a dyn Fn(ReadFile) -> Vec<ReadFile>;

fn read_each(
    name: &str,
    bytes: &[u8],
    setup: &ReadSetup,
    beside: Resolve<'_>,
    convert: Option<Convert<'_>>,
    progress: &mut dyn FnMut(usize) -> bool,
) -> Option<ReadReport> {
    let most = setup.options.max_bytes;
    let unpacked = match kind_of(name, bytes) {
        FileKind::Zip => archive::unpack(
            name,
            bytes,
            &ArchiveLimits { max_bytes: most, ..ArchiveLimits::default() },
        )
        .map(|unpacked| {
            let files = unpacked
                .files
                .into_iter()
                .map(|file| (outside::file_name(&format!("{name}/{}", file.path)), file.bytes))
                .collect();
            (files, unpacked.warnings.iter().map(ToMessage::to_message).collect())
        }),
        FileKind::Gzip => unpack_gzip(name, bytes, most)
            .map(|bytes| (vec![(without_gz(name).to_owned(), bytes)], Vec::new())),
        kind => {
            // Only motions depend on them.
            let skeleton_files =
                if kind.takes_skeleton() { setup.skeleton_files.as_slice() } else { &[] };
            let skeletons = Skeletons::of(skeleton_files, &setup.options);
            let sha256 = setup.sha256.as_deref();
            let file = SingleFile { name, bytes, kind, sha256 };
            let file = file.read(setup, &skeletons, beside, progress)?;
            return Some(ReadReport { files: converted(file, convert), notes: Vec::new() });
        }
    };
    match unpacked {
        Ok((files, notes)) => read_several(files, notes, bytes.len(), setup, convert, progress),
        Err(error) => Some(ReadReport {
            files: vec![ReadFile {
                name: name.to_owned(),
                sha256: String::new(),
                size: bytes.len() as u64,
                kind: kind_of(name, bytes),
                unpacked: None,
                converted: None,
                result: Err(error),
            }],
            notes: Vec::new(),
        }),
    }
}

/// Reads the files of an archive of `packed` bytes.
fn read_several(
    mut files: Vec<(String, Vec<u8>)>,
    notes: Vec<Message>,
    packed: usize,
    setup: &ReadSetup,
    convert: Option<Convert<'_>>,
    progress: &mut dyn FnMut(usize) -> bool,
) -> Option<ReadReport> {
    let kinds: Vec<FileKind> = files.iter().map(|(name, bytes)| kind_of(name, bytes)).collect();
    let own = files.iter().zip(&kinds).filter(|(_, kind)| kind.is_skeleton());
    let mut skeleton_files: Vec<SkeletonFile> = own
        .map(|((name, bytes), kind)| match kind {
            FileKind::SmplModel => SkeletonFile::of_model(name, bytes, &setup.options)
                .unwrap_or_else(|_| SkeletonFile::new(name, &[])),
            _ => SkeletonFile::new(name, bytes),
        })
        .collect();
    skeleton_files.extend(setup.skeleton_files.iter().cloned());
    let skeletons = Skeletons::of(&skeleton_files, &setup.options);
    let total = files.iter().map(|(_, bytes)| bytes.len()).sum::<usize>().max(1) as f64;
    let mut before = 0;
    let mut read = Vec::new();
    for (index, ((name, bytes), kind)) in files.iter().zip(kinds).enumerate() {
        // Buffers and images are not motions.
        if kind == FileKind::Unknown {
            continue;
        }
        let mut scaled =
            |done: usize| progress(((before + done) as f64 / total * packed as f64) as usize);
        let beside = |path: &str| file_beside(&files, name, path);
        let file = SingleFile { name, bytes, kind, sha256: None }.read(
            setup,
            &skeletons,
            &beside,
            &mut scaled,
        )?;
        read.extend(converted(file, convert).into_iter().map(|file| (index, file)));
        before += bytes.len();
    }
    // A skeleton that a motion uses is not imported by itself.
    let used: Vec<String> = (read.iter())
        .filter(|(_, file)| !file.kind.is_skeleton())
        .filter_map(|(_, file)| {
            Some(file.result.as_ref().ok()?.skeleton_file.as_ref()?.sha256.clone())
        })
        .collect();
    read.retain(|(_, file)| !used.contains(&file.sha256));
    for (index, file) in read.iter_mut().filter(|_| convert.is_none()) {
        file.unpacked = files.get_mut(*index).map(|(_, bytes)| std::mem::take(bytes));
    }
    Some(ReadReport { files: read.into_iter().map(|(_, file)| file).collect(), notes })
}

/// Returns a file of an archive by its path from the folder of another: where that says, or else
/// the first one whose path ends in it. As on the machines where scenes are made, capital and small
/// letters are the same.
fn file_beside(files: &[(String, Vec<u8>)], name: &str, path: &str) -> Option<Arc<[u8]>> {
    let ends_in = |whole: &str, end: &str| {
        let start = whole.len().checked_sub(end.len());
        start.and_then(|start| whole.get(start..)).is_some_and(|own| own.eq_ignore_ascii_case(end))
    };
    let below = format!("/{path}");
    let folder = name.rsplit_once('/').map_or("", |(folder, _)| folder);
    let there = format!("{folder}{below}");
    let is_there = |(name, _): &&(String, Vec<u8>)| name.eq_ignore_ascii_case(&there);
    let found = files.iter().find(is_there);
    let found = found.or_else(|| files.iter().find(|(name, _)| ends_in(name, &below)));
    found.map(|(_, bytes)| Arc::from(bytes.as_slice()))
}

fn converted(file: ReadFile, convert: Option<Convert<'_>>) -> Vec<ReadFile> {
    match convert {
        Some(convert) => convert(file),
        None => vec![file],
    }
}

/// A file that is not an archive.
struct SingleFile<'a> {
    name: &'a str,
    bytes: &'a [u8],
    kind: FileKind,
    sha256: Option<&'a str>,
}

impl SingleFile<'_> {
    fn read(
        &self,
        setup: &ReadSetup,
        skeletons: &Skeletons<'_>,
        beside: Resolve<'_>,
        progress: &mut dyn FnMut(usize) -> bool,
    ) -> Option<ReadFile> {
        let Self { name, bytes, kind, .. } = *self;
        let (mut skeleton_file, mut warnings) = (None, Vec::new());
        let imported = match kind {
            FileKind::Amc => {
                let skeletons = skeletons.acclaim.as_slice();
                let named: Vec<(&str, &AcclaimSkeleton)> =
                    skeletons.iter().map(|(own, read)| (own.name.as_str(), read)).collect();
                let best = acclaim::best_skeleton(name, bytes, &named)
                    .and_then(|index| skeletons.get(index));
                match best {
                    // A motion without its skeleton, if it is valid.
                    None => acclaim::check_motion(name, bytes).map(|()| {
                        warnings.extend(mismatch(name, bytes, skeletons));
                        None
                    }),
                    Some((own, skeleton)) => {
                        skeleton_file = Some(Box::new(SkeletonFile::clone(own)));
                        if !acclaim::goes_by_name(name, &own.name) {
                            warnings.push(msg!("it is on the skeleton of {file}", file = own.name));
                        }
                        let read = acclaim::read_motion_with_progress(
                            name,
                            bytes,
                            skeleton,
                            &setup.options,
                            progress,
                        );
                        match read {
                            Ok(None) => return None,
                            other => other,
                        }
                    }
                }
            }
            FileKind::Gltf | FileKind::Vrm | FileKind::Vrma => {
                gltf::read(name, bytes, beside, &setup.options).map(Some)
            }
            FileKind::Fbx => {
                match fbx::read_with_progress(name, bytes, beside, &setup.options, progress) {
                    Ok(None) => return None,
                    other => other,
                }
            }
            FileKind::Numpy => {
                let models: Vec<&SmplModel> =
                    skeletons.models.iter().map(|(_, model)| model).collect();
                let read = numpy::read_with_models(name, bytes, &models, &setup.options);
                read.map(|(file, used)| {
                    if let Some((own, _)) = used.and_then(|index| skeletons.models.get(index)) {
                        skeleton_file = Some(Box::new(SkeletonFile::clone(own)));
                        warnings.push(msg!("its bones are those of {file}", file = own.name));
                    }
                    Some(file)
                })
            }
            FileKind::SmplModel => {
                numpy::read_model(name, bytes, &setup.options).and_then(|model| {
                    let sha256 = self.sha256.map_or_else(|| sha256_hex(bytes), str::to_owned);
                    skeleton_file = Some(Box::new(SkeletonFile::of_joints(name, sha256, &model)));
                    numpy::model_clip(&model, &setup.options).map(Some)
                })
            }
            _ => {
                if kind == FileKind::Asf {
                    skeleton_file = Some(Box::new(SkeletonFile::new(name, bytes)));
                }
                match import_with_progress(name, bytes, &setup.options, progress) {
                    Ok(None) => return None,
                    other => other,
                }
            }
        };
        Some(ReadFile {
            name: name.to_owned(),
            sha256: self.sha256.map_or_else(|| sha256_hex(bytes), str::to_owned),
            size: bytes.len() as u64,
            kind,
            unpacked: None,
            converted: None,
            result: imported.map(|imported| {
                let awaits_skeleton = imported.is_none();
                let clips = ReadClips::of(imported.unwrap_or_default(), setup);
                warnings.extend(clips.warnings.iter().cloned());
                ReadClips { warnings, skeleton_file, awaits_skeleton, ..clips }
            }),
        })
    }
}

impl ReadClips {
    fn of(imported: ImportedFile, setup: &ReadSetup) -> Self {
        Self {
            warnings: imported.warnings.iter().map(ToMessage::to_message).collect(),
            clips: (imported.clips.into_iter().enumerate())
                .map(|(index, clip)| {
                    ReadClip::new(clip, setup.roles.get(&index).cloned(), &setup.bone_maps)
                })
                .collect(),
            ..Self::default()
        }
    }
}

fn without_gz(name: &str) -> &str {
    match name.len().checked_sub(3).and_then(|at| name.split_at_checked(at)) {
        Some((stem, ending)) if ending.eq_ignore_ascii_case(".gz") => stem,
        _ => name,
    }
}

impl From<&ImportedClip> for About {
    fn from(imported: &ImportedClip) -> Self {
        Self {
            measure: imported.measure.to_message(),
            t_pose_first_row: imported.t_pose_first_row,
            t_pose_dropped: imported.t_pose_dropped,
            fitting_unit: imported.mendable.metres_per_unit,
            wild_rows: imported.mendable.wild_rows,
        }
    }
}

impl ReadClip {
    fn new(imported: ImportedClip, roles: Option<Roles>, maps: &BoneMaps) -> Self {
        let about = About::from(&imported);
        let skeleton = imported.clip.skeleton();
        let roles = roles.or(imported.roles).unwrap_or_else(|| Roles::detect(skeleton));
        let roles = mapped(maps, skeleton, &roles).unwrap_or(roles);
        let roles = with_body_plan_of(&imported.clip, roles);
        Self { mesh: imported.mesh, motion: Motion::with_roles(imported.clip, &roles), about }
    }
}

/// The SHA-256 of bytes that come piece by piece.
#[derive(Clone, Debug, Default)]
pub struct PiecewiseSha256(Sha256);

impl PiecewiseSha256 {
    /// Takes the bytes that follow.
    pub fn update(&mut self, piece: &[u8]) {
        self.0.update(piece);
    }

    /// Returns the SHA-256 of all bytes in lower-case hexadecimal.
    #[must_use]
    pub fn hex(self) -> String {
        hex(&self.0.finalize())
    }
}

/// Returns the SHA-256 of some bytes in lower-case hexadecimal.
#[must_use]
pub fn sha256_hex(bytes: &[u8]) -> String {
    // In pieces, because browsers optimise a function only between calls.
    let mut sha256 = PiecewiseSha256::default();
    bytes.chunks(1 << 16).for_each(|piece| sha256.update(piece));
    sha256.hex()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn file_beside_another_is_the_nearest_of_its_name() {
        let names = ["x.zip/a/skin.png", "x.zip/b/Tex/Skin.png", "x.zip/b/skin.png", "x.zip/b.bin"];
        let files: Vec<(String, Vec<u8>)> =
            names.iter().map(|name| ((*name).to_owned(), name.as_bytes().to_vec())).collect();
        let beside = |name: &str, path: &str| {
            file_beside(&files, name, path)
                .map(|found| String::from_utf8_lossy(&found).into_owned())
        };
        let found = |path: &str| beside("x.zip/b/body.fbx", path);
        assert_eq!(found("skin.png").as_deref(), Some("x.zip/b/skin.png"));
        assert_eq!(found("tex/skin.png").as_deref(), Some("x.zip/b/Tex/Skin.png"));
        assert_eq!(found("b.bin").as_deref(), Some("x.zip/b.bin"));
        assert_eq!(found("kin.png"), None);
        assert_eq!(beside("x.zip/c/body.fbx", "skin.png").as_deref(), Some("x.zip/a/skin.png"));
    }
}
