//! What the page says: its panels, buttons and the details of a clip.

use segue_session::export::ExportFormat;
use segue_session::{ClipSet, Entry, Job, JobKind, MemoryUse, Origin, StorageState};
use segue_text::{Message, msg};

pub(crate) const APP: &str = "Segue";
pub(crate) const LIBRARY: &str = "Library";
/// Names of parts of the page, for a screen reader.
pub(crate) const TOP_BAR: &str = "Top bar";
pub(crate) const TIMELINE: &str = "Timeline";
pub(crate) const MAP: &str = "Map";
pub(crate) const SKIP_TO_PARAMETERS: &str = "Skip to the parameters";
pub(crate) const SAVED: &str = "Saved";
pub(crate) const SAVING: &str = "Saving…";
pub(crate) const NOT_ALL_SAVED: &str = "Not all saved";
pub(crate) const MEMORY: &str = "Memory";
pub(crate) const SAMPLES: &str = "samples";
pub(crate) const DROP_HERE: &str = "Drop BVH, ASF + AMC, GLB, a zip or a folder";
pub(crate) const OPEN_FILES: &str = "open…";
pub(crate) const DROP_NOW: &str = "Drop to open";
/// Of a clip that was read in the wrong unit, or with a root that is elsewhere in a row.
pub(crate) const MEND: &str = "Correct it";
/// Of several of them.
pub(crate) const MEND_ALL: &str = "Correct all";
/// In a frame of another page.
pub(crate) const HOST_READS: &str =
    "The page that embeds Segue can read and save what you open here.";
pub(crate) const COMPARE: &str = "Compare";
pub(crate) const COMPARE_OFF: &str = "One pane";
/// Of what several values stand side by side, and nothing of the kind.
pub(crate) const SIDE_BY_SIDE: &str = "Compare values";
pub(crate) const COMPARE_NOTHING: &str = "off";
pub(crate) const PANE_MORE: &str = "Add a pane";
pub(crate) const PANE_LESS: &str = "Remove a pane";
pub(crate) const COMPARE_HELP: &str = "Full, half and a third of the value side by side";
pub(crate) const FULL_HALF_THIRD: &str = "full, half, third";
pub(crate) const COPY_LINK: &str = "Copy link";
pub(crate) const LINK: &str = "Link";
pub(crate) const LINK_COPIED: &str = "Link copied. It opens exactly this state.";
pub(crate) const COPY_REPORT: &str = "Copy a report: picture, settings, numbers, link";
pub(crate) const REPORT: &str = "Copy a report";
pub(crate) const REPORT_COPIED: &str = "Report copied as Markdown, with the picture.";
pub(crate) const COMPARE_WITH_A: &str = "Compare with A";
pub(crate) const COMPARE_CLIPS: &str = "Compare with B";
pub(crate) const COMPARE_CLIPS_HELP: &str =
    "A and B unchanged, side by side, with the same metrics";
pub(crate) const BLEND_MORE: &str = "Blend in another clip";
pub(crate) const TAGS: &str = "Tags";
pub(crate) const TAGS_HELP: &str = "Speed and turn rate suggest tags. To tag part of a clip by hand, drag along it in the strip below the stage.";
pub(crate) const TAG_WHAT_PLAYS: &str = "Select what is playing";
pub(crate) const STRETCH_FROM: &str = "Range start";
pub(crate) const STRETCH_TO: &str = "Range end";
pub(crate) const OWN_WORD: &str = "Custom tag";
pub(crate) const TYPE_A_WORD: &str = "type it, then press Enter";
pub(crate) const TAKE_TAG_AWAY: &str = "Remove this tag";
pub(crate) const THEME: &str = "Dark or light";
pub(crate) const PROJECTOR: &str = "Projector: larger type";
pub(crate) const LARGER: &str = "Aa";
/// Behind the sign 中.
pub(crate) const OR_ENGLISH: &str = "/ EN";
pub(crate) const HELP: &str = "Shortcuts";
pub(crate) const MENU: &str = "Menu";
pub(crate) const MORE_LABS: &str = "More labs";
pub(crate) const UNDO: &str = "Undo";
pub(crate) const REDO: &str = "Redo";
pub(crate) const REMOVE: &str = "Remove";
pub(crate) const RENAME: &str = "Rename";
pub(crate) const DETAILS: &str = "Details";
pub(crate) const SAVE_AS: &str = "Save as";
pub(crate) const SAVE: &str = "Save the file";
pub(crate) const SAVE_OPTIONS: &str = "File options";
pub(crate) const SAVED_PANE: &str = "Result";
pub(crate) const SAVE_UNIT: &str = "Unit of length";
pub(crate) const SAVE_BODY: &str = "Body in the file";
pub(crate) const BODY_CHARACTER: &str = "Character on the stage";
pub(crate) const BODY_PLAIN: &str = "Plain body";
pub(crate) const ROTATION_ORDER: &str = "Rotation order";
pub(crate) const FILE_FORMAT: &str = "File format";
pub(crate) const SAVE_PICTURE: &str = "Save the stage as a picture";
pub(crate) const RECORD: &str = "Record a video of the page";
pub(crate) const STOP_RECORDING: &str = "Stop recording and save";
pub(crate) const RECORDING: &str = "Recording";
pub(crate) const USE_AS_A: &str = "Use as A";
pub(crate) const USE_AS_B: &str = "Use as B";
pub(crate) const LOADING: &str = "loading…";
pub(crate) const LOADING_SAMPLES: &str = "Loading samples";
pub(crate) const FRAME_ALL: &str = "Frame all";
pub(crate) const TOP_VIEW: &str = "Top view";
pub(crate) const FOLLOW: &str = "Camera follows";
pub(crate) const KEEP: &str = "Keep in library";
pub(crate) const STAGE: &str = "Stage";
pub(crate) const CAMERA: &str = "Camera";
pub(crate) const CURVES: &str = "curves";
pub(crate) const RESULT: &str = "result";
pub(crate) const LENGTH: &str = "Length";
pub(crate) const FRAMES: &str = "Frames";
pub(crate) const FRAME_RATE: &str = "Frame rate";
pub(crate) const BODY_HEIGHT: &str = "Body height";
pub(crate) const GROUND: &str = "Ground";
/// Of a body whose feet cannot be held.
pub(crate) const NO_LEGS: &str = "The foot lock does nothing: this skeleton has no leg with thigh, shin and foot. Assign these joints under Body parts in the View lab.";
pub(crate) const FEET: &str = "Feet and ground";
pub(crate) const MEAN_SPEED: &str = "Mean speed";
pub(crate) const JOINTS: &str = "Joints";
pub(crate) const JOINT_TREE: &str = "Joints of the clip";
pub(crate) const MADE_BODY: &str = "generated from the skeleton";
pub(crate) const BODY_PARTS: &str = "Body parts";
pub(crate) const BODY_PARTS_HELP: &str =
    "The joint of each body part, found by name or by shape. Change what is wrong.";
pub(crate) const UNIT: &str = "Unit";
pub(crate) const UP_AXIS: &str = "Up axis";
pub(crate) const AS_FOUND: &str = "as detected";
pub(crate) const AS_FILE: &str = "as in the file";
pub(crate) const AS_IT_IS: &str = "unchanged";
pub(crate) const OTHER: &str = "other…";
pub(crate) const TYPED_RATE: &str = "Frames per second";
pub(crate) const DROP_T_POSE: &str = "Skip the T-pose";
pub(crate) const NOBODY: &str = "none";
pub(crate) const FOUND: &str = "Found automatically";
pub(crate) const BY_HAND: &str =
    "Set by hand; double-click the label to find the best match again.";
pub(crate) const SMOOTHEST: &str = "smoothest";
pub(crate) const ROUGHEST: &str = "roughest";
pub(crate) const WELCOME_HINT: &str = "The same walk, in sync. Watch the feet and hips: the shorter the blend window, the more abrupt the change to the run.";
pub(crate) const EMPTY_PANE: &str = "Nothing to show yet";
/// On a pane that still shows an earlier result.
pub(crate) const OUTDATED: &str = "updating…";
/// Below a button that keeps and rows that save.
pub(crate) const NOTHING_TO_KEEP: &str = "There is no result to keep or save.";
pub(crate) const STILL_COMPUTED: &str = "The result is still being computed.";

/// What is being worked on, and how much of it is done.
pub(crate) fn under_way(job: &Job) -> Message {
    let percent = 100.0 * job.progress;
    match &job.kind {
        JobKind::Matching => msg!("Finding the best match {percent:.0} %", percent),
        JobKind::Registering => msg!("Registering the clips {percent:.0} %", percent),
        JobKind::BuildingGraph => msg!("Building the graph {percent:.0} %", percent),
        JobKind::HoldingFeet => msg!("Locking feet {percent:.0} %", percent),
        JobKind::Driving => msg!("Simulating {percent:.0} %", percent),
        JobKind::BuildingDatabase => msg!("Building the database {percent:.0} %", percent),
        JobKind::Reading(file) => msg!("{file} {percent:.0} %", file = file.clone(), percent),
    }
}

pub(crate) const CLOSE: &str = "Close";

pub(crate) const READING: &str = "being read…";
/// Of a bundled take that did not come: a notice said why.
pub(crate) const NOT_LOADED: &str = "not loaded: select it again";
/// Likewise, when reading it failed or was stopped: a notice said why.
pub(crate) const UNREAD: &str = "not read: drop the file again";
/// Likewise.
pub(crate) const AWAITS_SKELETON: &str = "needs its skeleton: drop the .asf file";

/// What keeps a clip from being played; empty where nothing does.
pub(crate) fn status(entry: &Entry) -> &'static str {
    match (&entry.motion, &entry.origin) {
        (Some(_), _) | (None, Origin::Preset | Origin::Made) => "",
        (None, Origin::Sample(_)) if entry.unread.is_some() => NOT_LOADED,
        (None, Origin::Sample(_)) => LOADING,
        (None, Origin::File(_)) if entry.unread.is_some() => UNREAD,
        (None, Origin::File(_)) if entry.awaits_skeleton() => AWAITS_SKELETON,
        (None, Origin::File(_)) => READING,
    }
}

/// How far the work is stored.
pub(crate) fn stored(stored: StorageState) -> &'static str {
    match stored {
        StorageState::Done => SAVED,
        StorageState::UnderWay => SAVING,
        StorageState::Incomplete => NOT_ALL_SAVED,
    }
}

/// How much memory is in use, and how much there is.
pub(crate) fn memory(memory: MemoryUse) -> Message {
    let limit_gb = (memory.limit as f64 / 1e8).round() / 10.0;
    msg!("{used_mb:.0} MB of {limit_gb} GB", used_mb = memory.used as f64 / 1e6, limit_gb)
}

/// The name of a file format on screen.
pub(crate) fn format(format: ExportFormat) -> &'static str {
    match format {
        ExportFormat::Bvh => "BVH",
        ExportFormat::Csv => "CSV",
        ExportFormat::Glb => "GLB",
    }
}

/// What the menu of clips shows of one that the link names and that is not here.
pub(crate) fn missing(name: &str) -> Message {
    msg!("{name} · missing", name = name.to_owned())
}

/// So many joints have other channels.
pub(crate) fn others(count: usize) -> Message {
    msg!("{count, plural, one {# has others} other {# have others}}", count)
}

/// A set of clips, and what its button does.
pub(crate) const fn clip_set(set: ClipSet) -> (&'static str, &'static str) {
    match set {
        ClipSet::Made => ("Synthesised motion", "The default clips of this lab"),
        ClipSet::Captured => {
            ("Real motion (CMU 16)", "Captured walks and runs of one actor, from the CMU database")
        }
        ClipSet::Own => ("My clips", "All clips from the files that you opened"),
    }
}
