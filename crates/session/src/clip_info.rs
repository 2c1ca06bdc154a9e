//! Clips as the page's API has them.

use crate::clip_facts::ClipFacts;
use crate::library::Entry;

/// A clip as the page's API has it.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct ClipInfo {
    /// Its name in links.
    pub id: String,
    /// Its name on screen.
    pub name: String,
    /// `bvh`, `amc`, `asf`, `gltf`, `vrm`, `vrma` or `synth`.
    pub format: &'static str,
    /// Number of joints; 0 while it is not loaded.
    pub joints: usize,
    /// Number of frames.
    pub frames: usize,
    /// Frames per second.
    pub fps: f64,
    /// Seconds.
    pub duration: f64,
    /// Standing height in metres.
    pub height: f32,
    /// SHA-256 of the file, hexadecimal; `null` without a file.
    pub sha256: Option<String>,
}

impl ClipInfo {
    pub(crate) fn of(entry: &Entry) -> Self {
        let facts = entry.facts.as_deref();
        Self {
            id: entry.id.clone(),
            name: entry.name.clone(),
            format: entry.format(),
            joints: facts.map_or(0, |facts| facts.joints),
            frames: facts.map_or(0, |facts| facts.frames),
            fps: facts.map_or(0.0, |facts| facts.fps),
            duration: facts.map_or(0.0, ClipFacts::duration_secs),
            height: facts.map_or(0.0, |facts| facts.height_m),
            sha256: entry.sha256().map(str::to_owned),
        }
    }
}
