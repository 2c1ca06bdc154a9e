//! Folders with synthesised files, and runs of the program over them.

#![expect(clippy::unwrap_used, reason = "what fails here fails the test")]
#![allow(dead_code, reason = "each test file uses some of it")]

use segue_formats::bvh::{WriteOptions, write};
use segue_formats::{ImportOptions, import};
use segue_motion::clip::Clip;
use segue_motion::synth::{Action, Params, synthesize};
use serde_json::Value as Json;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

/// A folder of its own below the target folder, removed at the end.
pub(crate) struct Folder(pub(crate) PathBuf);

impl Folder {
    /// Returns an empty folder.
    pub(crate) fn new(name: &str) -> Self {
        let folder =
            Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("{name}-{}", std::process::id()));
        fs::remove_dir_all(&folder).ok();
        fs::create_dir_all(&folder).unwrap();
        Self(folder)
    }

    /// Writes a file, and returns its path.
    pub(crate) fn put(&self, name: &str, bytes: impl AsRef<[u8]>) -> PathBuf {
        let path = self.0.join(name);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(&path, bytes).unwrap();
        path
    }

    /// Writes a clip as BVH, and returns its path.
    pub(crate) fn put_clip(&self, name: &str, clip: &Clip) -> PathBuf {
        self.put(name, write(clip, &WriteOptions::default()))
    }

    /// Runs the program in the folder, without a standard input.
    pub(crate) fn run(&self, words: &[&str]) -> Run {
        let output = Command::new(env!("CARGO_BIN_EXE_segue"))
            .args(words)
            .current_dir(&self.0)
            .stdin(Stdio::null())
            .output()
            .unwrap();
        Run {
            code: output.status.code().unwrap(),
            out: String::from_utf8(output.stdout).unwrap(),
            error: String::from_utf8(output.stderr).unwrap(),
        }
    }

    /// Runs the program, which must end well.
    pub(crate) fn run_well(&self, words: &[&str]) -> Run {
        let run = self.run(words);
        assert_eq!(run.code, 0, "{words:?}: {} {}", run.out, run.error);
        run
    }

    /// Reads the only clip of a file.
    pub(crate) fn clip(&self, name: &str) -> Clip {
        let bytes = fs::read(self.0.join(name)).unwrap();
        let mut file = import(name, &bytes, &ImportOptions::default()).unwrap();
        assert_eq!(file.clips.len(), 1, "{name}");
        file.clips.remove(0).clip
    }

    /// Returns the paths of all files, sorted.
    pub(crate) fn files(&self) -> Vec<String> {
        let (mut folders, mut found) = (vec![self.0.clone()], Vec::new());
        while let Some(folder) = folders.pop() {
            for entry in fs::read_dir(folder).unwrap() {
                let path = entry.unwrap().path();
                if path.is_dir() {
                    folders.push(path);
                } else {
                    let path = path.strip_prefix(&self.0).unwrap();
                    found.push(path.to_string_lossy().replace('\\', "/"));
                }
            }
        }
        found.sort();
        found
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        fs::remove_dir_all(&self.0).ok();
    }
}

/// The end of a run.
pub(crate) struct Run {
    pub(crate) code: i32,
    pub(crate) out: String,
    pub(crate) error: String,
}

impl Run {
    /// Reads the output as JSON.
    pub(crate) fn json(&self) -> Json {
        serde_json::from_str(&self.out).unwrap_or_else(|error| panic!("{error}: {}", self.out))
    }
}

/// Returns a synthesised clip.
pub(crate) fn made(action: Action, duration_secs: f32) -> Clip {
    synthesize(&Params { duration_secs, ..Params::new(action) }).unwrap().clip
}

/// Returns the text of a clip as BVH, with one number of a row misspelt.
pub(crate) fn broken() -> String {
    let text = write(&made(Action::Walk, 1.0), &WriteOptions::default());
    let (head, rows) = text.split_once("Frame Time:").unwrap();
    let (time, rows) = rows.split_once('\n').unwrap();
    format!("{head}Frame Time:{time}\nx{rows}")
}

/// Returns the greatest distance of the joints of two clips, metres.
pub(crate) fn apart_m(a: &Clip, b: &Clip) -> f32 {
    assert_eq!((a.frames(), a.skeleton().len()), (b.frames(), b.skeleton().len()));
    let places = |clip: &Clip| clip.world_positions(0..clip.frames());
    let pairs = places(a).into_iter().zip(places(b));
    pairs.map(|(p, q)| p.distance(q)).fold(0.0, f32::max)
}
