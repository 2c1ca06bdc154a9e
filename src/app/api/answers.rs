//! Answers of the page's API as plain data.

use crate::app::frame_stats::FrameTimes;
use crate::platform::PoolStats;
use segue_session::ClipInfo;
use serde::Serialize;
use serde_json::Value as Json;

/// A row of `keys()`.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(crate) struct KeyInfo {
    pub(super) key: &'static str,
    pub(super) label: &'static str,
    #[serde(rename = "type")]
    pub(super) kind: &'static str,
    pub(super) min: Option<f64>,
    pub(super) max: Option<f64>,
    pub(super) step: Option<f64>,
    /// Whether the value may be `"auto"`.
    pub(super) auto: bool,
    /// The words that a choice takes.
    pub(super) choices: Vec<&'static str>,
    pub(super) default: Json,
    pub(super) unit: &'static str,
    pub(super) lab: &'static str,
    /// The labs whose results, or the views beside them, depend on it.
    pub(super) labs: Vec<&'static str>,
    pub(super) help: &'static str,
}

/// The answer of `load()`.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(crate) struct LoadedClips {
    pub(super) clips: Vec<ClipInfo>,
    pub(super) warnings: Vec<String>,
}

impl LoadedClips {
    /// Returns the SHA-256 of the files that the clips came from.
    #[cfg(target_arch = "wasm32")]
    pub(crate) fn files(&self) -> Vec<String> {
        self.clips.iter().filter_map(|clip| clip.sha256.clone()).collect()
    }
}

/// The answer of `pose()`.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(crate) struct PoseInfo {
    /// The joints' names.
    pub(super) joints: Vec<String>,
    /// The index of every joint's parent; -1 for a root.
    pub(super) parents: Vec<i64>,
    /// World positions in metres: x, y, z of the first joint, then of the next.
    pub(super) positions: Vec<f32>,
    /// World rotations: x, y, z, w of the first joint, then of the next.
    pub(super) rotations: Vec<f32>,
    /// Whether the left and the right foot is planted; of a body on four legs the hind feet, then
    /// the forefeet.
    pub(super) contacts: Vec<bool>,
}

/// One number of `metrics()`.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(crate) struct MetricInfo {
    pub(super) label: &'static str,
    /// The number of the first pane; `null` where it is not known.
    pub(super) value: Option<f64>,
    pub(super) unit: &'static str,
    /// The numbers of all panes, left to right.
    pub(super) panes: Vec<Option<f64>>,
    /// The time of the worst frame in each of them, seconds; `null` where no single frame has it.
    pub(super) at: Vec<Option<f64>>,
    /// `lower`, `higher`, or `neutral` where neither is better.
    pub(super) better: &'static str,
    pub(super) help: &'static str,
}

/// A computation or a file that is under way.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(crate) struct JobInfo {
    pub(super) name: String,
    /// 0 to 1; `null` where it is not known.
    pub(super) progress: Option<f64>,
}

/// The answer of `stats()`, without the fields that the page adds.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(crate) struct Stats {
    pub(super) backend: &'static str,
    pub(super) frames: u64,
    /// The time for input, panels and scene.
    pub(super) frame_ms: FrameTimes,
    /// The time for whole frames, with the commands for the graphics device.
    pub(super) draw_ms: FrameTimes,
    pub(super) jobs: Vec<JobInfo>,
    pub(super) wasm_bytes: u64,
    pub(super) workers: PoolStats,
}

/// A file to hand to the user.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct ExportedFile {
    /// Its name.
    pub(crate) name: String,
    /// Its media type.
    pub(crate) mime: &'static str,
    /// Its bytes.
    pub(crate) bytes: Vec<u8>,
}
