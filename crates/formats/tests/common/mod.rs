//! Helpers of the tests of file formats.

#![expect(clippy::unwrap_used, reason = "helpers of tests: what fails here fails the test")]
#![allow(dead_code, reason = "every test binary uses a part of it")]
#![allow(unreachable_pub, reason = "a module of several test binaries")]

use glam::Vec3;
use segue_formats::acclaim::{read_motion, read_skeleton};
use segue_formats::{ImportError, ImportOptions, ImportedClip, ImportedFile, import};
use segue_motion::clip::Clip;
use segue_motion::skeleton::WorldPose;
use std::path::{Path, PathBuf};

/// Returns the folder of captured motion, if this machine has it.
pub fn shared_data() -> Option<PathBuf> {
    let beside = Path::new(env!("CARGO_MANIFEST_DIR"))
        .ancestors()
        .skip(1)
        .map(|folder| folder.join("shared/data"));
    let found = std::env::var_os("SEGUE_SHARED")
        .map(PathBuf::from)
        .into_iter()
        .chain(beside)
        .find(|place| place.is_dir());
    if found.is_none() {
        eprintln!("no motion data on this machine: set SEGUE_SHARED to its folder; skipped");
    }
    found
}

/// Returns the folder with the takes of subject 16 of the CMU database, if this machine has them.
pub fn subject_16() -> Option<PathBuf> {
    shared_data().map(|data| data.join("cmu/16")).filter(|folder| folder.is_dir())
}

/// Returns the takes of subject 16 whose names have these endings, with their names; empty if they
/// are not there.
pub fn captured(endings: &[&'static str]) -> Vec<(&'static str, Clip)> {
    let Some(folder) = subject_16() else {
        return vec![];
    };
    let bytes = std::fs::read(folder.join("16.asf")).unwrap();
    let skeleton = read_skeleton("16.asf", &bytes, &ImportOptions::default()).unwrap();
    let take = |&name: &&'static str| {
        let bytes = std::fs::read(folder.join(format!("16_{name}.amc"))).unwrap();
        let mut read = read_motion(name, &bytes, &skeleton, &ImportOptions::default()).unwrap();
        (name, read.clips.remove(0).clip)
    };
    endings.iter().map(take).collect()
}

/// Returns the BVH files of a folder, sorted by name.
pub fn bvh_files(folder: &std::path::Path) -> Vec<(String, Vec<u8>)> {
    let entries = std::fs::read_dir(folder).unwrap();
    let mut paths: Vec<PathBuf> = entries
        .map(|entry| entry.unwrap().path())
        .filter(|path| path.extension().is_some_and(|e| e == "bvh"))
        .collect();
    paths.sort();
    let name = |path: &PathBuf| path.file_name().unwrap().to_string_lossy().into_owned();
    paths.iter().map(|path| (name(path), std::fs::read(path).unwrap())).collect()
}

pub fn read(text: impl AsRef<[u8]>) -> Result<ImportedFile, ImportError> {
    import("test.bvh", text.as_ref(), &ImportOptions::default())
}

/// Returns the only clip of a file that must be readable, and its warnings.
pub fn one(text: impl AsRef<[u8]>) -> (ImportedClip, Vec<String>) {
    let mut imported = read(text).unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(imported.clips.len(), 1);
    (imported.clips.remove(0), imported.warnings.iter().map(ToString::to_string).collect())
}

/// Returns joints and end sites in the world.
pub fn points(clip: &Clip, frame: usize) -> Vec<Vec3> {
    let world: WorldPose = clip.world_pose(frame);
    let ends = clip
        .skeleton()
        .joints()
        .iter()
        .enumerate()
        .filter_map(|(index, joint)| Some(world.point(index, joint.end_site?)));
    let ends: Vec<Vec3> = ends.collect();
    world.positions.iter().copied().chain(ends).collect()
}

/// The HIERARCHY of a chain of three joints, 1.64 m tall in centimetres: 6 + 3 + 3 channels, 20
/// lines.
pub const CHAIN: &str = "HIERARCHY
ROOT Pelvis
{
  OFFSET 0 88 0
  CHANNELS 6 Xposition Yposition Zposition Zrotation Xrotation Yrotation
  JOINT Torso
  {
    OFFSET 0 12 0
    CHANNELS 3 Zrotation Xrotation Yrotation
    JOINT Skull
    {
      OFFSET 0 42 0
      CHANNELS 3 Zrotation Xrotation Yrotation
      End Site
      {
        OFFSET 0 22 0
      }
    }
  }
}
";

/// Returns a row for [`CHAIN`].
pub fn row(frame: usize) -> String {
    let f = frame as f64;
    format!(
        "{:.1} 90.5 {:.1} 1.5 2.5 {:.1} 4.5 5.5 6.5 7.5 8.5 9.5",
        f + 0.5,
        2.0 * f + 0.5,
        3.0 + f
    )
}

/// Returns [`CHAIN`] with a number of rows.
pub fn chain(frames: usize) -> String {
    let rows: String = (0..frames).map(|frame| row(frame) + "\n").collect();
    format!("{CHAIN}MOTION\nFrames: {frames}\nFrame Time: 0.01\n{rows}")
}
