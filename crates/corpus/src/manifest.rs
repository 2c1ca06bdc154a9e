//! `corpus.json`: all that is needed to read the other files.

use crate::{
    FEATURE_STEP, MAX_DISTANCE_CM, Options, POSE_FPS, SHARD_BYTES, Scaling, StandardBody,
    THUMBNAIL_POSES, THUMBNAIL_SIZE,
};
use segue_motion::matching::Block;
use segue_session::metrics::METRICS;
use serde::{Deserialize, Serialize};
use serde_json::{Value as Json, json};

/// The version of the format.
pub const FORMAT: u32 = 2;

/// The name of the file with the columns for a page.
pub const COLUMNS: &str = "columns.bin";

/// The counts in `corpus.json`.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct Counts {
    /// Rows of the table.
    pub(crate) rows: usize,
    pub(crate) clips: usize,
    pub(crate) unplaced: usize,
    pub(crate) unreadable: usize,
    pub(crate) copies: usize,
    pub(crate) seconds: f64,
    pub(crate) moments: usize,
}

/// The files of a corpus, and how its index is searched.
#[derive(Clone, Debug)]
pub(crate) struct Layout {
    /// Lists of the index.
    pub(crate) lists: usize,
    /// The number of lists that a search reads.
    pub(crate) probes: usize,
    pub(crate) pose_shards: usize,
    pub(crate) thumbnail_shards: usize,
    pub(crate) list_files: usize,
}

/// Returns the columns of the table that are metrics: name, label, unit and help of each.
#[must_use]
pub fn column_rows() -> Vec<[&'static str; 4]> {
    METRICS.iter().map(|row| [row.name, row.label, row.unit.text(), row.help]).collect()
}

/// Returns the content of `corpus.json`.
pub(crate) fn manifest(
    body: &StandardBody,
    options: &Options,
    scaling: &Scaling,
    counts: &Counts,
    layout: &Layout,
) -> Json {
    let joints: Vec<Json> = (body.skeleton().joints().iter())
        .map(|joint| {
            json!({
                "name": joint.name,
                "parent": joint.parent,
                "offset_m": joint.offset.to_array(),
                "end_site_m": joint.end_site.map(|end| end.to_array()),
            })
        })
        .collect();
    let blocks: Vec<Json> = (Block::ALL.into_iter())
        .map(|block| {
            let range = body.layout().range(block);
            json!({ "name": block.name(), "start": range.start, "end": range.end })
        })
        .collect();
    json!({
        "format": FORMAT,
        "made_by": format!("segue {}", env!("CARGO_PKG_VERSION")),
        "options": options,
        "counts": counts,
        "clips": { "file": "clips.parquet" },
        "page": { "columns": COLUMNS },
        "body": { "joints": joints },
        "poses": {
            "fps": POSE_FPS,
            "shards": layout.pose_shards,
            "most_bytes": SHARD_BYTES,
        },
        "thumbnails": {
            "shards": layout.thumbnail_shards,
            "poses": THUMBNAIL_POSES,
            "width": THUMBNAIL_SIZE[0],
            "height": THUMBNAIL_SIZE[1],
        },
        "features": {
            "frames_per_row": FEATURE_STEP,
            "blocks": blocks,
            "scaling": scaling,
        },
        "index": {
            "lists": layout.lists,
            "files": layout.list_files,
            "probes": layout.probes,
        },
        "copies": { "most_cm": MAX_DISTANCE_CM },
    })
}
