//! Reading files apart from the document: a pure function of names and bytes, so that a large file
//! can be read by another thread or worker and handed over when it is done.

mod wire;

pub use wire::{Parcel, Unpacker, WireError};

use super::outside;
use segue_formats::acclaim::{self, AcclaimSkeleton};
use segue_formats::archive::{self, ArchiveLimits};
use segue_formats::{
    FileKind, ImportError, ImportOptions, Imported, ImportedClip, gltf, import_with_progress,
    kind_of, unpack_gzip,
};
use segue_motion::clip::Motion;
use segue_motion::skeleton::Roles;
use segue_motion::skin::SkinnedMesh;
use segue_text::{Message, ToMessage, msg};
use serde::{Deserialize, Serialize};
use sha2::{Digest as _, Sha256};
use std::collections::BTreeMap;
use std::sync::Arc;

/// Files above this size are not read between two frames, bytes.
pub const LARGE_BYTES: u64 = 1 << 20;

/// Where the bytes of a file are.
#[derive(Clone, Debug, PartialEq)]
pub enum Content {
    /// In the document.
    Here(Arc<[u8]>),
    /// With the platform, under this key: too large to be copied about. Once the file was read, the
    /// key is its SHA-256.
    Outside(String),
}

/// What is to be read, and how.
#[derive(Clone, Debug, PartialEq)]
pub struct ReadTask {
    /// Its number.
    pub id: u64,
    /// The file's name.
    pub name: String,
    /// Its bytes.
    pub content: Content,
    /// How many there are.
    pub size: u64,
    /// How to read them.
    pub setup: ReadSetup,
}

/// How a file is to be read.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ReadSetup {
    /// What the user says about units, axes and the frame rate.
    pub options: ImportOptions,
    /// Roles that were set by hand, by the number of the clip in the file.
    pub roles: BTreeMap<usize, Roles>,
    /// Files that this one may lean on: skeletons for the motion of another file.
    pub companions: Vec<Companion>,
    /// SHA-256 of the file's bytes, where it is known already; lower-case hexadecimal.
    #[serde(default)]
    pub sha256: Option<String>,
}

/// A small file that others lean on: the skeleton of a motion.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Companion {
    /// The file's name.
    pub name: String,
    /// SHA-256 of its bytes, lower-case hexadecimal.
    pub sha256: String,
    /// Its bytes.
    pub bytes: Arc<[u8]>,
}

/// What reading a file gave: one part for a motion file, several for an archive.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ReadReport {
    /// The motion files.
    pub files: Vec<ReadFile>,
    /// What is to be said of the whole, one sentence each.
    pub notes: Vec<Message>,
}

impl ReadReport {
    /// Whether it is of one motion file that lay in no archive.
    #[must_use]
    pub fn is_one_file(&self) -> bool {
        matches!(self.files.as_slice(), [file] if file.unpacked.is_none())
    }
}

/// One motion file.
#[derive(Clone, Debug, PartialEq)]
pub struct ReadFile {
    /// The file's name.
    pub name: String,
    /// SHA-256 of its bytes, lower-case hexadecimal.
    pub sha256: String,
    /// How many bytes it has.
    pub size: u64,
    /// What it is.
    pub kind: FileKind,
    /// Its bytes, where it came out of an archive: nobody else has them.
    pub unpacked: Option<Vec<u8>>,
    /// Its clips, or why there are none.
    pub result: Result<ReadClips, ImportError>,
}

/// The clips of a file.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ReadClips {
    /// One for each character.
    pub clips: Vec<ReadClip>,
    /// What was odd, one sentence each.
    pub warnings: Vec<Message>,
    /// The skeleton file that the motion was read with.
    pub companion: Option<Companion>,
    /// Whether there are no clips because the skeleton file is not here.
    pub awaits_skeleton: bool,
}

/// A clip, with all that is derived from it.
#[derive(Clone, Debug, PartialEq)]
pub struct ReadClip {
    /// The clip.
    pub motion: Motion,
    /// How it was read.
    pub about: About,
    /// The mesh that the file has for the clip's skeleton; all clips of one character share it.
    pub mesh: Option<Arc<SkinnedMesh>>,
}

/// How a clip was read: what the clip panel tells.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct About {
    /// Unit, height and up axis, in words.
    pub measure: Message,
    /// Whether the file's first row is a T-pose that the motion does not start from.
    pub t_pose_first_row: bool,
    /// Whether that row was left out.
    pub t_pose_dropped: bool,
    /// Metres per unit that would make the body as tall as a person, where it is of no size that
    /// people have.
    #[serde(default)]
    pub fitting_unit: Option<f64>,
    /// Whether the root is far away in single rows.
    #[serde(default)]
    pub wild_rows: bool,
}

/// [`read`], or none of it.
pub type Reads = fn(&str, &[u8], &ReadSetup, &mut dyn FnMut(usize) -> bool) -> Option<ReadReport>;

/// Reads a file, or all motion files of an archive. `progress` hears how much of it is done, in
/// bytes, and says whether to go on; `None` when it said no.
pub fn read(
    name: &str,
    bytes: &[u8],
    setup: &ReadSetup,
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
            // Only a motion leans on them.
            let companions = if kind == FileKind::Amc { setup.companions.as_slice() } else { &[] };
            let skeletons = skeletons_of(companions, &setup.options);
            let sha256 = setup.sha256.as_deref();
            let file = One { name, bytes, kind, sha256 };
            return Some(ReadReport {
                files: vec![file.read(setup, &skeletons, &|_| None, progress)?],
                notes: Vec::new(),
            });
        }
    };
    match unpacked {
        Ok((files, notes)) => read_several(files, notes, bytes.len(), setup, progress),
        Err(error) => Some(ReadReport {
            files: vec![ReadFile {
                name: name.to_owned(),
                sha256: String::new(),
                size: bytes.len() as u64,
                kind: kind_of(name, bytes),
                unpacked: None,
                result: Err(error),
            }],
            notes: Vec::new(),
        }),
    }
}

/// Reads what came out of an archive of `packed` bytes.
fn read_several(
    mut files: Vec<(String, Vec<u8>)>,
    notes: Vec<Message>,
    packed: usize,
    setup: &ReadSetup,
    progress: &mut dyn FnMut(usize) -> bool,
) -> Option<ReadReport> {
    let kinds: Vec<FileKind> = files.iter().map(|(name, bytes)| kind_of(name, bytes)).collect();
    let own = files.iter().zip(&kinds).filter(|(_, kind)| **kind == FileKind::Asf);
    let mut companions: Vec<Companion> =
        own.map(|((name, bytes), _)| Companion::new(name, bytes)).collect();
    companions.extend(setup.companions.iter().cloned());
    let skeletons = skeletons_of(&companions, &setup.options);
    let beside = |path: &str| {
        let found = files.iter().find(|(name, _)| name.ends_with(path));
        found.map(|(_, bytes)| Arc::from(bytes.as_slice()))
    };
    let total = files.iter().map(|(_, bytes)| bytes.len()).sum::<usize>().max(1) as f64;
    let mut before = 0;
    let mut read = Vec::new();
    for (index, ((name, bytes), kind)) in files.iter().zip(kinds).enumerate() {
        // What glTF files lean on is no motion.
        if kind == FileKind::Unknown {
            continue;
        }
        let mut scaled =
            |done: usize| progress(((before + done) as f64 / total * packed as f64) as usize);
        let file = One { name, bytes, kind, sha256: None }.read(
            setup,
            &skeletons,
            &beside,
            &mut scaled,
        )?;
        read.push((index, file));
        before += bytes.len();
    }
    // A skeleton that has a motion is not looked at by itself.
    let used: Vec<String> = (read.iter())
        .filter_map(|(_, file)| Some(file.result.as_ref().ok()?.companion.as_ref()?.sha256.clone()))
        .collect();
    read.retain(|(_, file)| !used.contains(&file.sha256));
    for (index, file) in &mut read {
        file.unpacked = files.get_mut(*index).map(|(_, bytes)| std::mem::take(bytes));
    }
    Some(ReadReport { files: read.into_iter().map(|(_, file)| file).collect(), notes })
}

/// The skeleton files that can be read.
fn skeletons_of<'a>(
    companions: &'a [Companion],
    options: &ImportOptions,
) -> Vec<(&'a Companion, AcclaimSkeleton)> {
    let read = |companion: &'a Companion| {
        let skeleton = acclaim::read_skeleton(&companion.name, &companion.bytes, options).ok()?;
        Some((companion, skeleton))
    };
    companions.iter().filter_map(read).collect()
}

/// A file that is no archive.
struct One<'a> {
    name: &'a str,
    bytes: &'a [u8],
    kind: FileKind,
    sha256: Option<&'a str>,
}

impl One<'_> {
    fn read(
        &self,
        setup: &ReadSetup,
        skeletons: &[(&Companion, AcclaimSkeleton)],
        beside: &dyn Fn(&str) -> Option<Arc<[u8]>>,
        progress: &mut dyn FnMut(usize) -> bool,
    ) -> Option<ReadFile> {
        let Self { name, bytes, kind, .. } = *self;
        let (mut companion, mut warnings) = (None, Vec::new());
        let imported = match kind {
            FileKind::Amc => {
                let named: Vec<(&str, &AcclaimSkeleton)> =
                    skeletons.iter().map(|(own, read)| (own.name.as_str(), read)).collect();
                let best = acclaim::best_skeleton(name, bytes, &named)
                    .and_then(|index| skeletons.get(index));
                match best {
                    // It is one that waits for its skeleton, where it is one at all.
                    None => acclaim::check_motion(name, bytes).map(|()| {
                        warnings.extend(misfit(name, bytes, skeletons));
                        None
                    }),
                    Some((own, skeleton)) => {
                        companion = Some((*own).clone());
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
            FileKind::Gltf => gltf::read(name, bytes, beside, &setup.options).map(Some),
            _ => match import_with_progress(name, bytes, &setup.options, progress) {
                Ok(None) => return None,
                other => other,
            },
        };
        Some(ReadFile {
            name: name.to_owned(),
            sha256: self.sha256.map_or_else(|| sha256_hex(bytes), str::to_owned),
            size: bytes.len() as u64,
            kind,
            unpacked: None,
            result: imported.map(|imported| {
                let awaits_skeleton = imported.is_none();
                let clips = ReadClips::of(imported.unwrap_or_default(), setup);
                warnings.extend(clips.warnings.iter().cloned());
                ReadClips { warnings, companion, awaits_skeleton, ..clips }
            }),
        })
    }
}

/// What is to be said where there are skeletons, and none is that of the motion: of the one that is
/// most like it.
fn misfit(
    name: &str,
    bytes: &[u8],
    skeletons: &[(&Companion, AcclaimSkeleton)],
) -> Option<Message> {
    let fits =
        skeletons.iter().map(|(own, skeleton)| (own, acclaim::matching_bones(bytes, skeleton)));
    let (own, (fitting, bones)) =
        fits.max_by_key(|(own, (fitting, _))| (acclaim::goes_by_name(name, &own.name), *fitting))?;
    Some(msg!(
        "the skeleton of {file} does not fit: {fitting} of {bones} bones have its names and degrees of freedom",
        file = own.name
    ))
}

impl ReadClips {
    fn of(imported: Imported, setup: &ReadSetup) -> Self {
        Self {
            warnings: imported.warnings.iter().map(ToMessage::to_message).collect(),
            clips: (imported.clips.into_iter().enumerate())
                .map(|(index, clip)| ReadClip::new(clip, setup.roles.get(&index).cloned()))
                .collect(),
            ..Self::default()
        }
    }
}

impl Companion {
    /// A file that was just read.
    #[must_use]
    pub fn new(name: &str, bytes: &[u8]) -> Self {
        Self { name: name.to_owned(), sha256: sha256_hex(bytes), bytes: Arc::from(bytes) }
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
    fn new(imported: ImportedClip, roles: Option<Roles>) -> Self {
        let about = About::from(&imported);
        let roles = roles.unwrap_or_else(|| Roles::detect(imported.clip.skeleton()));
        Self { mesh: imported.mesh, motion: Motion::with_roles(imported.clip, &roles), about }
    }
}

/// SHA-256 in lower-case hexadecimal.
fn sha256_hex(bytes: &[u8]) -> String {
    use std::fmt::Write as _;
    // In pieces: browsers only optimise a function from one call to its next.
    let mut digest = Sha256::new();
    bytes.chunks(1 << 16).for_each(|piece| digest.update(piece));
    digest.finalize().iter().fold(String::with_capacity(64), |mut hex, byte| {
        // Writing to a string cannot fail.
        write!(hex, "{byte:02x}").ok();
        hex
    })
}
