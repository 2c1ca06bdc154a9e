//! Motion files: from bytes to clips and back.
//!
//! [`import`] recognises files by content rather than by name. Everything with a sensible reading
//! is read, and oddities are returned as [`ImportWarning`]s, one per kind; the rest is refused with
//! an [`ImportError`] that says where. Memory is bounded by the size of the file, never by a number
//! in a header.
//!
//! # The idea
//!
//! A motion file is a skeleton and a table of numbers, but no format contains all that a [`Clip`]
//! needs. Missing information is inferred:
//!
//! ```text
//! bytes → kind (first words) → skeleton and numbers, in the file's units and axes
//!       → unit and up axis (the height and stance of the character, Measure)
//!       → metres, Y up, parents first → Clip
//! ```
//!
//! A body that is 174 units tall is measured in centimetres, one of 1.74 in metres, and the stance
//! of the body shows which axis is up. [`ImportOptions`] override both.
//!
//! | | read | written |
//! |---|---|---|
//! | [`bvh`] | yes | [`bvh::write`] |
//! | [`acclaim`] (ASF, AMC) | yes, a motion with its skeleton | |
//! | [`gltf`] (glTF, GLB) | yes, motion and skinned meshes | [`gltf::write_glb`] |
//! | [`c3d`], [`trc`] | yes, a skeleton from labelled points, or points | |
//! | [`robot_csv`] | yes, the hinges of a Unitree G1 | [`robot_csv::write_robot_csv`] |
//! | [`numpy`] (NPY, NPZ) | motions of AMASS, SMPL, Kimodo, `HumanML3D` and others | [`numpy::write_npz`] |
//! | [`gltf`] (VRM, VRMA) | yes, with their bone map | [`gltf::write_vrma`] |
//! | [`fbx`] | yes, motion and skinned meshes | [`fbx::write_fbx`] |
//! | [`csv`] | | [`csv::write_csv`] |
//! | [`archive`] (zip), gzip | file by file, [`unpack_gzip`] | [`ZipWriter`] |
//!
//! # Example
//!
//! ```
//! use segue_motion::clip::Clip;
//! use segue_formats::{ImportOptions, bvh, import};
//! use segue_motion::synth::{Action, Params, synthesize};
//!
//! let walk = synthesize(&Params::new(Action::Walk))?.clip;
//! let text = bvh::write(&walk, &bvh::WriteOptions::default());
//! let read = |text: &str| import("walk.bvh", text.as_bytes(), &ImportOptions::default());
//!
//! // There and back: every joint keeps its position, and centimetres were inferred by the height.
//! let file = read(&text)?;
//! let back = &file.clips[0].clip;
//! let everywhere = |clip: &Clip| clip.world_positions(0..clip.frames());
//! let (there, here) = (everywhere(&walk), everywhere(back));
//! assert_eq!(there.len(), here.len());
//! assert!(there.iter().zip(&here).all(|(p, q)| p.distance(*q) < 1e-5));
//! assert!(file.clips[0].measure.unit_detected && file.warnings.is_empty());
//!
//! // A truncated row is reported and dropped; a typing error is reported with its place.
//! let shorter = read(&text[..text.len() - 40])?;
//! assert!(shorter.clips[0].clip.frames() == walk.frames() - 1 && !shorter.warnings.is_empty());
//! let error = read(&text.replacen("OFFSET", "OFSET", 1)).err().ok_or("it was read")?;
//! assert_eq!((error.line, error.column, error.found.to_string().as_str()), (4, 2, "`OFSET`"));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # Accuracy and cost
//!
//! A clip that is written as BVH and read back is equal to 1e-5 (metres, radians), whatever its
//! channels and rotation orders. Reading a BVH file takes memory of at most three times its size,
//! and linear time. Any bytes are read or refused, none panic.
//!
//! # What it does not do
//!
//! [`import`] neither opens archives nor looks for a second file: the caller has the files, and
//! passes an AMC file with its skeleton ([`acclaim::read_motion`]).
//!
//! # Sources
//!
//! [`bvh`], [`acclaim`], [`gltf`] and [`fbx`] cite the documents of their formats.

pub mod acclaim;
pub mod archive;
mod assemble;
pub mod bvh;
pub mod c3d;
pub mod csv;
mod encoding;
mod error;
pub mod fbx;
pub mod gltf;
mod gzip;
mod labelled;
mod measure;
pub mod numpy;
mod raw;
pub mod robot_csv;
mod t_pose;
mod takes;
mod text;
mod texture;
pub mod trc;
mod unlikely;
mod warning;
mod zip_out;

pub use error::ImportError;
pub use gzip::unpack_gzip;
pub use measure::{CMU_METRES_PER_UNIT, Measure, UpSource};
pub use unlikely::Mendable;
pub use warning::{ImportWarning, WarningKind};
pub use zip_out::{Crc, PackedFile, ZipFull, ZipIndex, ZipWriter};

use segue_motion::clip::{Clip, UpAxis};
use segue_motion::skeleton::Roles;
use segue_motion::skin::SkinnedMesh;
use segue_text::msg;
use std::sync::Arc;

/// Options of an import. They override the file, and values that would be inferred.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct ImportOptions {
    /// Metres per unit of length; inferred from the height of the character where `None` or out of
    /// range.
    pub metres_per_unit: Option<f64>,
    /// The up axis; inferred from the stance of the character where `None`.
    pub up: Option<UpAxis>,
    /// Frames per second; those of the file where `None` or out of range.
    pub fps: Option<f64>,
    /// The greatest size of a file, bytes.
    pub max_bytes: usize,
    /// Whether a first row that is a T-pose is dropped; otherwise it is only marked.
    pub drop_t_pose: bool,
    /// Whether single rows in which the root is metres away are replaced by positions between their
    /// neighbours.
    #[serde(default)]
    pub even_wild_rows: bool,
}

impl Default for ImportOptions {
    /// Everything inferred, up to 512 MB, without a leading T-pose.
    fn default() -> Self {
        Self {
            metres_per_unit: None,
            up: None,
            fps: None,
            max_bytes: 512 << 20,
            drop_t_pose: true,
            even_wild_rows: false,
        }
    }
}

/// A function that returns the bytes of a file beside the one that is read, by its path as that one
/// has it; `None` if there is no such file.
pub type Resolve<'a> = &'a dyn Fn(&str) -> Option<Arc<[u8]>>;

/// One character of a file.
#[derive(Clone, Debug, PartialEq)]
pub struct ImportedClip {
    /// The motion, in metres and Y up.
    pub clip: Clip,
    /// Whether the first row of the file is a T-pose that does not belong to the motion. Frame 0 of
    /// `clip` is that row unless [`t_pose_dropped`](Self::t_pose_dropped).
    pub t_pose_first_row: bool,
    /// Whether the first row was left out.
    pub t_pose_dropped: bool,
    /// The unit and up axis that were inferred or given; its text is a note for users.
    pub measure: Measure,
    /// The problems that another import could fix.
    pub mendable: Mendable,
    /// The character's own mesh, bound to the clip's skeleton; all clips of one character share it.
    pub mesh: Option<Arc<SkinnedMesh>>,
    /// The roles of the clip's joints, where the file states them; otherwise they are to be found
    /// ([`Roles::detect`]).
    pub roles: Option<Roles>,
}

impl ImportedClip {
    fn with_mesh(self, mesh: Option<&Arc<SkinnedMesh>>) -> Self {
        Self { mesh: mesh.cloned(), ..self }
    }
}

/// The content of a file.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ImportedFile {
    /// One clip for each character.
    pub clips: Vec<ImportedClip>,
    /// The oddities of the file, one per kind.
    pub warnings: Vec<ImportWarning>,
}

/// Reads a motion file. An ASF file is read as its skeleton alone; for an AMC file, which needs a
/// skeleton, see [`acclaim`]. `name` is the file's name: for errors, for the name of the clip, and
/// for its ending where the content is not conclusive.
///
/// # Errors
/// [`ImportError`] when the file is too large, of unknown format, or broken.
pub fn import(
    name: &str,
    bytes: &[u8],
    options: &ImportOptions,
) -> Result<ImportedFile, ImportError> {
    Ok(import_with_progress(name, bytes, options, &mut |_| true)?.unwrap_or_default())
}

/// Reads a motion file as [`import`] does, reports the bytes read so far about every 256 KB, and
/// stops with `None` when `progress` returns `false`.
///
/// # Errors
/// The same as for [`import`].
pub fn import_with_progress(
    name: &str,
    bytes: &[u8],
    options: &ImportOptions,
    progress: &mut dyn FnMut(usize) -> bool,
) -> Result<Option<ImportedFile>, ImportError> {
    check_size(name, bytes, options)?;
    match kind_of(name, bytes) {
        FileKind::Bvh => bvh::read_with_progress(name, bytes, options, progress),
        FileKind::Asf => {
            acclaim::skeleton_clip(&acclaim::read_skeleton(name, bytes, options)?, options)
                .map(Some)
        }
        FileKind::Amc => {
            let error = ImportError::whole_file(
                name,
                "a motion without its skeleton (.amc)",
                "the ASF file (.asf) that belongs to it",
            );
            Err(error.with_hint("drop the .asf file as well, before it, with it or after it"))
        }
        FileKind::Gltf | FileKind::Vrm | FileKind::Vrma => {
            gltf::read(name, bytes, &|_| None, options).map(Some)
        }
        FileKind::C3d => c3d::read(name, bytes, options).map(Some),
        FileKind::Trc => trc::read(name, bytes, options).map(Some),
        FileKind::RobotCsv => robot_csv::read(name, bytes, options).map(Some),
        FileKind::Numpy => numpy::read(name, bytes, options).map(Some),
        FileKind::SmplModel => {
            numpy::model_clip(&numpy::read_model(name, bytes, options)?, options).map(Some)
        }
        FileKind::Fbx => fbx::read_with_progress(name, bytes, &|_| None, options, progress),
        FileKind::Zip | FileKind::Gzip => {
            Err(ImportError::whole_file(name, "an archive", "one of the files in it"))
        }
        // The reader says which tables are read.
        FileKind::Unknown if has_extension(name, "csv") => {
            robot_csv::read(name, bytes, options).map(Some)
        }
        FileKind::Unknown => {
            let found = match name.rsplit_once('.') {
                Some((_, extension)) if !extension.is_empty() => {
                    msg!("a file that ends in .{extension}", extension = extension.to_owned())
                }
                _ => "a file of unknown format".into(),
            };
            let error = ImportError::whole_file(
                name,
                found,
                "a motion file (.bvh, .asf with .amc, .fbx, .glb, .gltf, .vrm, .vrma, .npz, .npy, .c3d, .trc, .csv of a robot, .zip)",
            );
            Err(error.with_hint("convert it to BVH, or rename it if it is one"))
        }
    }
}

/// The endings of files that hold motion.
pub const MOTION_ENDINGS: [&str; 13] =
    ["bvh", "asf", "amc", "fbx", "glb", "gltf", "vrm", "vrma", "npz", "npy", "c3d", "trc", "csv"];

/// The endings of files that hold others.
pub const ARCHIVE_ENDINGS: [&str; 2] = ["zip", "gz"];

/// The format of a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, serde::Serialize, serde::Deserialize)]
pub enum FileKind {
    /// Skeleton and motion, [`bvh`].
    Bvh,
    /// A skeleton whose motions are in AMC files, [`acclaim`].
    Asf,
    /// A motion whose skeleton is in an ASF file, [`acclaim`].
    Amc,
    /// A scene with animations, [`gltf`].
    Gltf,
    /// Labelled points and analogue channels, [`c3d`].
    C3d,
    /// A table of labelled points, [`trc`].
    Trc,
    /// A table of a robot's hinges, [`robot_csv`].
    RobotCsv,
    /// Arrays, [`numpy`].
    Numpy,
    /// A body whose motions are in files of arrays, [`numpy::SmplModel`].
    SmplModel,
    /// A humanoid character, a [`gltf`] file.
    Vrm,
    /// An animation of humanoid characters, a [`gltf`] file.
    Vrma,
    /// A scene with animations, [`fbx`].
    Fbx,
    /// Several files in one, [`archive`].
    Zip,
    /// One file, packed with gzip.
    Gzip,
    /// An unknown format.
    Unknown,
}

impl FileKind {
    /// Returns whether it is a skeleton for the motions of other files.
    #[must_use]
    pub const fn is_skeleton(self) -> bool {
        matches!(self, Self::Asf | Self::SmplModel)
    }

    /// Returns whether a motion of this format takes its skeleton from another file, if there is
    /// one.
    #[must_use]
    pub const fn takes_skeleton(self) -> bool {
        matches!(self, Self::Amc | Self::Numpy)
    }

    /// Returns the name on screen.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Bvh => "bvh",
            Self::Asf => "asf",
            Self::Amc => "amc",
            Self::Gltf => "gltf",
            Self::C3d => "c3d",
            Self::Trc => "trc",
            Self::RobotCsv => "csv",
            Self::Numpy => "npz",
            Self::SmplModel => "smpl",
            Self::Vrm => "vrm",
            Self::Vrma => "vrma",
            Self::Fbx => "fbx",
            Self::Zip => "zip",
            Self::Gzip => "gz",
            Self::Unknown => "unknown",
        }
    }
}

/// Returns the format of a file: by its first words, and where they are not conclusive by the
/// ending of its name.
#[must_use]
pub fn kind_of(name: &str, bytes: &[u8]) -> FileKind {
    /// Comments may come first; UTF-16 has two bytes for each character.
    const HEAD: usize = 16 << 10;
    if archive::is_zip(bytes) {
        return match numpy::content_of_zip(name, bytes) {
            Some(numpy::Content::Motion) => FileKind::Numpy,
            Some(numpy::Content::Model) => FileKind::SmplModel,
            None => FileKind::Zip,
        };
    }
    if numpy::is_npy(bytes) || numpy::is_pickle(name) {
        return FileKind::Numpy;
    }
    if gltf::is_gltf(bytes) {
        return gltf_kind(name).unwrap_or(FileKind::Gltf);
    }
    if fbx::is_fbx(bytes) {
        return FileKind::Fbx;
    }
    if gzip::is_gzip(bytes) {
        return FileKind::Gzip;
    }
    if c3d::is_c3d(bytes) {
        return FileKind::C3d;
    }
    let head = text::decode(bytes.get(..HEAD).unwrap_or(bytes));
    if bvh::starts_like_bvh(&head) {
        FileKind::Bvh
    } else if acclaim::starts_like_asf(&head) {
        FileKind::Asf
    } else if acclaim::starts_like_amc(&head) {
        FileKind::Amc
    } else if trc::starts_like_trc(&head) {
        FileKind::Trc
    } else if robot_csv::starts_like_robot_csv(&head) {
        FileKind::RobotCsv
    } else {
        let endings = [
            ("bvh", FileKind::Bvh),
            ("asf", FileKind::Asf),
            ("amc", FileKind::Amc),
            ("c3d", FileKind::C3d),
            ("trc", FileKind::Trc),
            ("npy", FileKind::Numpy),
            ("npz", FileKind::Numpy),
            ("fbx", FileKind::Fbx),
            ("zip", FileKind::Zip),
            ("gz", FileKind::Gzip),
        ];
        let known = endings.into_iter().find(|(ending, _)| has_extension(name, ending));
        known.map(|(_, kind)| kind).or_else(|| gltf_kind(name)).unwrap_or(FileKind::Unknown)
    }
}

/// Returns the kind of glTF that the ending of a name says. All are read alike: the extensions in
/// the file count.
fn gltf_kind(name: &str) -> Option<FileKind> {
    let endings = [
        ("glb", FileKind::Gltf),
        ("gltf", FileKind::Gltf),
        ("vrm", FileKind::Vrm),
        ("vrma", FileKind::Vrma),
    ];
    endings.into_iter().find(|(ending, _)| has_extension(name, ending)).map(|(_, kind)| kind)
}

fn has_extension(name: &str, extension: &str) -> bool {
    name.rsplit_once('.').is_some_and(|(_, found)| found.eq_ignore_ascii_case(extension))
}

/// Returns the file's name without folders and ending.
fn stem(name: &str) -> &str {
    let file = name.rsplit(['/', '\\']).next().unwrap_or(name);
    match file.rsplit_once('.') {
        Some((stem, _)) if !stem.is_empty() => stem,
        _ => file,
    }
}

fn check_size(name: &str, bytes: &[u8], options: &ImportOptions) -> Result<(), ImportError> {
    if bytes.len() <= options.max_bytes {
        return check_not_empty(name, bytes);
    }
    let found = msg!("a file of {mb} MB", mb = bytes.len().div_ceil(1 << 20));
    Err(ImportError::whole_file(name, found, msg!("at most {mb} MB", mb = options.max_bytes >> 20))
        .with_hint("cut the motion into parts"))
}

/// Refuses a file that is empty, or has only white space.
fn check_not_empty(name: &str, bytes: &[u8]) -> Result<(), ImportError> {
    if bytes.iter().any(|byte| !text::is_space(*byte)) {
        return Ok(());
    }
    Err(ImportError::whole_file(name, "an empty file", "a motion file"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn kind_of_a_file_follows_content_or_name() {
        let options = ImportOptions::default();
        let text = b"# a comment\nROOT Hips { OFFSET 0 1 0 }";
        assert_eq!(import("dir/walk.txt", text, &options).unwrap().clips[0].clip.name(), "walk");
        assert_eq!(
            import("walk.BVH", b"nothing", &options).unwrap_err().to_string(),
            "walk.BVH:1:1: found `nothing`, expected `HIERARCHY` and a `ROOT`"
        );
        let error = import("walk.max", b"Kaydara", &options).unwrap_err();
        assert_eq!(
            error.to_string(),
            "walk.max:1:1: found a file that ends in .max, expected a motion file (.bvh, .asf with .amc, .fbx, .glb, .gltf, .vrm, .vrma, .npz, .npy, .c3d, .trc, .csv of a robot, .zip)"
        );
        assert!(error.hint.is_some());
        for (name, empty) in [("x.bvh", ""), ("x.amc", " \r\n\t"), ("x.glb", ""), ("", "")] {
            let error = import(name, empty.as_bytes(), &options).unwrap_err();
            assert_eq!(
                error.to_string(),
                format!("{name}:1:1: found an empty file, expected a motion file")
            );
        }
    }

    #[test]
    fn kind_of_a_file_prefers_content_to_the_ending() {
        let kinds = [
            ("x.amc", "HIERARCHY\nROOT a", FileKind::Bvh),
            ("x.bvh", "# by hand\n:version 1.10\n:root", FileKind::Asf),
            ("x.bvh", ":DEGREES\n1\nroot 1", FileKind::Amc),
            ("x", "1\nroot 1 2 3", FileKind::Amc),
            ("x.AMC", "", FileKind::Amc),
            ("x.asf", "?", FileKind::Asf),
            ("x.txt", "?", FileKind::Unknown),
            ("x.txt", "PathFileType\t4", FileKind::Trc),
            ("x.trc", "?", FileKind::Trc),
            ("x.c3d", "?", FileKind::C3d),
            ("x.csv", "time,value\n0,1", FileKind::Unknown),
        ];
        for (name, text, kind) in kinds {
            assert_eq!(kind_of(name, text.as_bytes()), kind, "{name} {text}");
        }
    }

    #[test]
    fn import_of_a_large_file_is_refused_first() {
        let options = ImportOptions { max_bytes: 10 << 20, ..ImportOptions::default() };
        let error = import("big.bvh", &vec![b' '; (10 << 20) + 1], &options).unwrap_err();
        assert_eq!(error.to_string(), "big.bvh:1:1: found a file of 11 MB, expected at most 10 MB");
    }

    #[test]
    fn stem_is_the_name_without_folders_and_ending() {
        for (name, expected) in [
            ("a/b.c/walk.bvh", "walk"),
            ("C:\\x\\run.1.bvh", "run.1"),
            (".bvh", ".bvh"),
            ("walk", "walk"),
        ] {
            assert_eq!(stem(name), expected);
        }
    }
}
