//! The texts of the page: its panels, its buttons and the details of a clip.

use crate::ui::language::Word;
use segue_session::export::ExportFormat;
use segue_session::{ClipSet, Entry, Job, JobKind, MemoryUse, Origin, StorageState};
use segue_text::{Message, msg};

pub(crate) const APP: Word = Word::new("Segue");
pub(crate) const LIBRARY: Word = Word::new("Library");
/// Names of parts of the page, for a screen reader.
pub(crate) const TOP_BAR: Word = Word::new("Top bar");
pub(crate) const TIMELINE: Word = Word::new("Timeline");
pub(crate) const MAP: Word = Word::new("Map");
pub(crate) const SKIP_TO_PARAMETERS: Word = Word::new("Skip to the parameters");
pub(crate) const SAVED: Word = Word::new("Saved");
pub(crate) const SAVING: Word = Word::new("Saving…");
pub(crate) const NOT_ALL_SAVED: Word = Word::new("Not all saved");
pub(crate) const MEMORY: Word = Word::new("Memory");
pub(crate) const DROP_HERE: Word =
    Word::new("Drop BVH, FBX, GLB, NPZ, AMC, C3D, a zip or a folder");
pub(crate) const DROP_NOW: Word = Word::new("Drop to open");
/// The button that corrects a clip that was read in the wrong unit, or with displaced roots.
pub(crate) const CORRECT: Word = Word::new("Correct it");
/// The button that corrects several clips.
pub(crate) const CORRECT_ALL: Word = Word::new("Correct all");
/// The warning in a frame of another page.
pub(crate) const HOST_READS: Word =
    Word::new("The page that embeds Segue can read and save what you open here.");
pub(crate) const COMPARE: Word = Word::new("Compare");
pub(crate) const COMPARE_OFF: Word = Word::new("One pane");
/// The label of the choice of the parameter that is compared.
pub(crate) const SIDE_BY_SIDE: Word = Word::new("Compare values");
pub(crate) const COMPARE_NOTHING: Word = Word::new("off");
pub(crate) const PANE_MORE: Word = Word::new("Add a pane");
pub(crate) const PANE_LESS: Word = Word::new("Remove a pane");
pub(crate) const COMPARE_HELP: Word = Word::new("Full, half and a third of the value side by side");
pub(crate) const FULL_HALF_THIRD: Word = Word::new("full, half, third");
pub(crate) const COPY_LINK: Word = Word::new("Copy link");
/// The line of the menu that copies the link with what is each reader's own otherwise.
pub(crate) const COPY_LINK_AS_SHOWN: Word = Word::new("Copy link with text size and language");
pub(crate) const SHARE: Word = Word::new("More ways to share");
pub(crate) const PRESENT: Word = Word::new("Present");
pub(crate) const STOP_PRESENTING: Word = Word::new("Stop presenting");
pub(crate) const PREVIOUS: Word = Word::new("Previous");
/// The step of a presenter that shows a whole comparison.
pub(crate) const ALL_PANES: Word = Word::new("All panes");
pub(crate) const NEXT_PANE: Word = Word::new("Next pane");
pub(crate) const PREVIOUS_PANE: Word = Word::new("Previous pane");
pub(crate) const LINK: Word = Word::new("Link");
pub(crate) const LINK_COPIED: Word = Word::new("Link copied. It opens exactly this state.");
pub(crate) const COPY_REPORT: Word = Word::new("Copy a report: picture, settings, numbers, link");
pub(crate) const REPORT: Word = Word::new("Copy a report");
pub(crate) const REPORT_COPIED: Word = Word::new("Report copied as Markdown, with the picture.");
pub(crate) const COMPARE_WITH_A: Word = Word::new("Compare with A");
pub(crate) const COMPARE_CLIPS: Word = Word::new("Compare with B");
pub(crate) const COMPARE_CLIPS_HELP: Word =
    Word::new("A and B unchanged, side by side, with the same metrics");
pub(crate) const BLEND_MORE: Word = Word::new("Blend in another clip");
pub(crate) const TAGS: Word = Word::new("Tags");
pub(crate) const TAGS_HELP: Word = Word::new(
    "Speed and turn rate suggest tags. To tag part of a clip by hand, drag along it in the strip below the stage.",
);
pub(crate) const TAG_WHAT_PLAYS: Word = Word::new("Select what is playing");
pub(crate) const STRETCH_FROM: Word = Word::new("Range start");
pub(crate) const STRETCH_TO: Word = Word::new("Range end");
pub(crate) const OWN_WORD: Word = Word::new("Custom tag");
pub(crate) const TYPE_A_WORD: Word = Word::new("type it, then press Enter");
pub(crate) const TAKE_TAG_AWAY: Word = Word::new("Remove this tag");
pub(crate) const THEME: Word = Word::new("Dark or light");
pub(crate) const PROJECTOR: Word = Word::new("Projector: larger type");
pub(crate) const LARGER: Word = Word::new("Aa");
/// The word behind the sign 中.
pub(crate) const OR_ENGLISH: Word = Word::new("/ EN");
pub(crate) const HELP: Word = Word::new("Shortcuts");
pub(crate) const MENU: Word = Word::new("Menu");
pub(crate) const MORE_LABS: Word = Word::new("More labs");
pub(crate) const UNDO: Word = Word::new("Undo");
pub(crate) const REDO: Word = Word::new("Redo");
pub(crate) const REMOVE: Word = Word::new("Remove");
pub(crate) const RENAME: Word = Word::new("Rename");
pub(crate) const DETAILS: Word = Word::new("Details");
pub(crate) const SAVE_AS: Word = Word::new("Save as");
pub(crate) const SAVE: Word = Word::new("Save the file");
pub(crate) const SAVE_OPTIONS: Word = Word::new("File options");
pub(crate) const SAVED_PANE: Word = Word::new("Result");
pub(crate) const SAVE_UNIT: Word = Word::new("Unit of length");
pub(crate) const SAVE_BODY: Word = Word::new("Body in the file");
pub(crate) const SAVE_ROOT: Word = Word::new("Root motion");
pub(crate) const ROOT_AS_IT_IS: Word = Word::new("as it is");
pub(crate) const ROOT_ON_GROUND: Word = Word::new("root bone on the ground");
pub(crate) const ROOT_IN_PLACE: Word = Word::new("in place");
pub(crate) const BODY_CHARACTER: Word = Word::new("Character on the stage");
pub(crate) const BODY_PLAIN: Word = Word::new("Plain body");
pub(crate) const ROTATION_ORDER: Word = Word::new("Rotation order");
pub(crate) const SAVE_PICTURE: Word = Word::new("Save the stage as a picture");
pub(crate) const RECORD: Word = Word::new("Record a video of the page");
pub(crate) const STOP_RECORDING: Word = Word::new("Stop recording and save");
pub(crate) const RECORDING: Word = Word::new("Recording");
pub(crate) const USE_AS_A: Word = Word::new("Use as A");
pub(crate) const USE_AS_B: Word = Word::new("Use as B");
pub(crate) const LOADING: Word = Word::new("loading…");
pub(crate) const LOADING_SAMPLES: Word = Word::new("Loading samples");
pub(crate) const FRAME_ALL: Word = Word::new("Frame all");
pub(crate) const TOP_VIEW: Word = Word::new("Top view");
pub(crate) const FOLLOW: Word = Word::new("Camera follows");
pub(crate) const KEEP: Word = Word::new("Keep in library");
pub(crate) const KEEP_HELP: Word = Word::new("Adds the result to the library as a clip");
/// The button that opens the format and the options of a file.
pub(crate) const SAVE_MENU: Word = Word::new("Save…");
pub(crate) const SAVE_MENU_HELP: Word =
    Word::new("Saves the result as a file: BVH, FBX, GLB, VRMA, NPZ or CSV");
/// The reason why an unchanged clip is not kept.
pub(crate) const KEPT_ALREADY: Word = Word::new("This clip is in the library already.");
/// The button that opens the help texts of all rows.
pub(crate) const ALL_HELP: Word = Word::new("Show all help");
pub(crate) const STAGE: Word = Word::new("Stage");
pub(crate) const CAMERA: Word = Word::new("Camera");
pub(crate) const CURVES: Word = Word::new("curves");
pub(crate) const RESULT: Word = Word::new("result");
pub(crate) const LENGTH: Word = Word::new("Length");
pub(crate) const FRAMES: Word = Word::new("Frames");
pub(crate) const FRAME_RATE: Word = Word::new("Frame rate");
pub(crate) const BODY_HEIGHT: Word = Word::new("Body height");
pub(crate) const GROUND: Word = Word::new("Ground");
/// The warning for a skeleton whose feet cannot be locked.
pub(crate) const NO_LEGS: Word = Word::new(
    "The foot lock does nothing: this skeleton has no leg with thigh, shin and foot. Assign these joints under Body parts in the View lab.",
);
/// The label of the contacts of a clip on the timeline.
pub(crate) const CONTACTS: Word = Word::new("Contacts");
pub(crate) const FEET: Word = Word::new("Feet and ground");
pub(crate) const MEAN_SPEED: Word = Word::new("Mean speed");
pub(crate) const JOINTS: Word = Word::new("Joints");
pub(crate) const JOINT_TREE: Word = Word::new("Joints of the clip");
/// The colours of a robot's limbs.
pub(crate) const HINGE_COLORS: Word =
    Word::new("Limbs behind a hinge at its limit (within 1°) are amber, beyond its limit red.");
pub(crate) const MADE_BODY: Word = Word::new("generated from the skeleton");
pub(crate) const BODY_PARTS: Word = Word::new("Body parts");
pub(crate) const UNIT: Word = Word::new("Unit");
pub(crate) const UP_AXIS: Word = Word::new("Up axis");
pub(crate) const AS_FOUND: Word = Word::new("as detected");
pub(crate) const AS_FILE: Word = Word::new("as in the file");
pub(crate) const AS_IT_IS: Word = Word::new("unchanged");
pub(crate) const OTHER: Word = Word::new("other…");
pub(crate) const TYPED_RATE: Word = Word::new("Frames per second");
pub(crate) const DROP_T_POSE: Word = Word::new("Skip the T-pose");
pub(crate) const NOBODY: Word = Word::new("none");
pub(crate) const FOUND: Word = Word::new("Found automatically");
pub(crate) const BY_HAND: Word =
    Word::new("Set by hand; double-click the label to find the best match again.");
pub(crate) const SMOOTHEST: Word = Word::new("smoothest");
pub(crate) const ROUGHEST: Word = Word::new("roughest");
pub(crate) const WELCOME_HINT: Word = Word::new(
    "The same walk, in sync. Watch the feet and hips: the shorter the blend window, the more abrupt the change to the run.",
);
pub(crate) const EMPTY_PANE: Word = Word::new("Nothing to show yet");
/// Returns the name of a lab in a sentence, or alone.
pub(crate) fn lab(name: Word) -> Message {
    msg!("{name} lab", name)
}

/// The line about the View lab.
pub(crate) const VIEW_ABOUT: Word = Word::new("Plays a clip as it is.");
/// The help text of the View lab.
pub(crate) const VIEW_DETAILS: Word = Word::new(
    "Move it over the ground, remove its root motion or lock its feet to make another clip of it. Its joints and body parts are at the end.",
);
/// The line about the Make lab.
pub(crate) const MAKE_ABOUT: Word = Word::new("Synthesises a motion from a few numbers.");
/// The help text of the Make lab.
pub(crate) const MAKE_DETAILS: Word =
    Word::new("Keep it in the library to use it as A or B in the other labs.");
/// The chip of a pane that still shows an earlier result.
pub(crate) const OUTDATED: Word = Word::new("updating…");
/// The note below the buttons that keep and save, without a result.
pub(crate) const NOTHING_TO_KEEP: Word = Word::new("There is no result to keep or save.");
pub(crate) const STILL_COMPUTED: Word = Word::new("The result is still being computed.");

/// Returns the task under way, and its progress.
pub(crate) fn under_way(job: &Job) -> Message {
    let percent = 100.0 * job.progress;
    match &job.kind {
        JobKind::Analyzing => msg!("Analysing the clip {percent:.0} %", percent),
        JobKind::Computing => "Computing the result…".into(),
        JobKind::Matching => msg!("Finding the best match {percent:.0} %", percent),
        JobKind::Registering => msg!("Registering the clips {percent:.0} %", percent),
        JobKind::BuildingGraph => msg!("Building the graph {percent:.0} %", percent),
        JobKind::Retargeting => msg!("Retargeting {percent:.0} %", percent),
        JobKind::HoldingFeet => msg!("Locking feet {percent:.0} %", percent),
        JobKind::Cleaning => msg!("Looking for faults {percent:.0} %", percent),
        JobKind::Driving => msg!("Simulating {percent:.0} %", percent),
        JobKind::BuildingDatabase => msg!("Building the database {percent:.0} %", percent),
        JobKind::Reading(file) => msg!("{file} {percent:.0} %", file = file.clone(), percent),
        JobKind::ReadingFiles { done, all } => files_read(*done, *all),
    }
}

/// Returns how many of the files that are to join the library were read.
pub(crate) fn files_read(done: usize, all: usize) -> Message {
    msg!("Reading files: {done} of {all}", done, all)
}

pub(crate) const CLOSE: Word = Word::new("Close");

pub(crate) const READING: Word = Word::new("being read…");
/// The status of a bundled take that could not be fetched; a notice has said why.
pub(crate) const NOT_LOADED: Word = Word::new("not loaded: select it again");
/// The status of a file that could not be read, or whose reading was stopped; a notice has said
/// why.
pub(crate) const UNREAD: Word = Word::new("not read: drop the file again");
/// The status of a motion whose file of the skeleton is missing.
pub(crate) const AWAITS_SKELETON: Word = Word::new("needs its skeleton: drop the .asf file");

/// Returns the reason why a clip cannot be played now; empty where it can.
pub(crate) fn status(entry: &Entry) -> Word {
    match (&entry.motion, &entry.origin) {
        (Some(_), _) | (None, Origin::Preset | Origin::Made) => Word::default(),
        (None, Origin::Sample(_)) if entry.unread.is_some() => NOT_LOADED,
        (None, Origin::Sample(_)) => LOADING,
        (None, Origin::File(_)) if entry.unread.is_some() => UNREAD,
        (None, Origin::File(_)) if entry.awaits_skeleton() => AWAITS_SKELETON,
        (None, Origin::File(_)) => READING,
    }
}

/// Returns the name of the pane that is shown, and its number among all.
pub(crate) fn pane_of(name: Message, number: usize, of: usize) -> Message {
    msg!("{name} · {number} / {of}", name, number, of)
}

/// Returns how far the work is stored.
pub(crate) fn stored(stored: StorageState) -> Word {
    match stored {
        StorageState::Done => SAVED,
        StorageState::UnderWay => SAVING,
        StorageState::Incomplete => NOT_ALL_SAVED,
    }
}

/// Returns how much memory is in use, and how much there is.
pub(crate) fn memory(memory: MemoryUse) -> Message {
    let limit_gb = (memory.limit as f64 / 1e8).round() / 10.0;
    msg!("{used_mb:.0} MB of {limit_gb} GB", used_mb = memory.used as f64 / 1e6, limit_gb)
}

/// Returns the name of a file format.
pub(crate) fn format(format: ExportFormat) -> Word {
    Word::new(match format {
        ExportFormat::Bvh => "BVH",
        ExportFormat::Csv => "CSV",
        ExportFormat::Fbx => "FBX",
        ExportFormat::Glb => "GLB",
        ExportFormat::Vrma => "VRMA",
        ExportFormat::Npz => "NPZ",
        ExportFormat::G1Csv => "CSV of a Unitree G1",
    })
}

/// Returns the line in a menu of clips for one that the link names and the library lacks.
pub(crate) fn missing(name: &str) -> Message {
    msg!("{name} · missing", name = name.to_owned())
}

/// Says how many joints have other channels.
pub(crate) fn others(count: usize) -> Message {
    msg!("{count, plural, one {# has others} other {# have others}}", count)
}

/// Returns the name of a set of clips, and the hint of its button.
pub(crate) const fn clip_set(set: ClipSet) -> (Word, Word) {
    let (label, help) = match set {
        ClipSet::Made => ("Synthesised motion", "The default clips of this lab"),
        ClipSet::Captured => {
            ("Real motion (CMU 16)", "Captured walks and runs of one actor, from the CMU database")
        }
        ClipSet::Own => ("My clips", "All clips from the files that you opened"),
    };
    (Word::new(label), Word::new(help))
}
