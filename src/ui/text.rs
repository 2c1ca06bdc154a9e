//! Every sentence and word of the interface that is not a parameter's own (those stand in the table
//! of parameters).

use segue_motion::gait::GaitFacts;
use segue_motion::matching::{Block, Database, HoldReason, RATE, SearchReason, SearchRecord};
use segue_motion::path::HardTurn;
use segue_session::JobKind;
use segue_session::choices::{Hysteresis, LoopMethod, Mistake, PathKeep};
use segue_session::export::ExportFormat;
use segue_session::{
    Built, Cast, ClipSet, Entry, Job, LayerFacts, LayerFit, MemoryUse, OnPath, Origin, Retargeted,
    Storing, Trace, Transition, format_number,
};

pub(crate) const APP: &str = "Segue";
pub(crate) const LIBRARY: &str = "Library";
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
    "The page around this frame can read and save what you open here.";
pub(crate) const COMPARE: &str = "Compare";
pub(crate) const COMPARE_OFF: &str = "One pane";
/// Of what several values stand side by side, and nothing of the kind.
pub(crate) const SIDE_BY_SIDE: &str = "Side by side";
pub(crate) const COMPARE_NOTHING: &str = "one value of each";
pub(crate) const PANE_MORE: &str = "One more pane";
pub(crate) const PANE_LESS: &str = "One pane fewer";
pub(crate) const COMPARE_HELP: &str = "Full, half and a third of the value side by side";
pub(crate) const FULL_HALF_THIRD: &str = "full, half, third";
pub(crate) const COPY_LINK: &str = "Copy link";
pub(crate) const LINK: &str = "Link";
pub(crate) const LINK_COPIED: &str = "The link is in the clipboard. It opens exactly this state.";
pub(crate) const COPY_REPORT: &str = "Copy a report: picture, settings, numbers, link";
pub(crate) const REPORT: &str = "Copy a report";
pub(crate) const REPORT_COPIED: &str =
    "The report is in the clipboard: Markdown, with the picture in it.";
pub(crate) const COMPARE_WITH_A: &str = "Compare with A";
pub(crate) const CLIP: &str = "Clip";
pub(crate) const COMPARE_CLIPS: &str = "Compare with B";
pub(crate) const COMPARE_CLIPS_HELP: &str =
    "A and B as they are, side by side, with the same numbers for both";
pub(crate) const BLEND_MORE: &str = "Blend in another clip";
pub(crate) const TAGS: &str = "Tags";
pub(crate) const TAGS_HELP: &str = "Speed and turn rate suggest tags. Drag along a clip in the strip below the stage to tag a stretch of it by hand.";
pub(crate) const TAG_WHAT_PLAYS: &str = "Choose what plays now";
pub(crate) const STRETCH_FROM: &str = "Stretch from";
pub(crate) const STRETCH_TO: &str = "Stretch to";
pub(crate) const OWN_WORD: &str = "A word of your own";
pub(crate) const TYPE_A_WORD: &str = "type it and press Enter";
pub(crate) const TAKE_TAG_AWAY: &str = "Take this tag away";
pub(crate) const THEME: &str = "Dark or light";
pub(crate) const PROJECTOR: &str = "Projector: larger type";
pub(crate) const LARGER: &str = "Aa";
/// Behind the sign 中.
pub(crate) const OR_ENGLISH: &str = "/ EN";
pub(crate) const IN_CHINESE: &str = "Interface in Chinese";
pub(crate) const IN_ENGLISH: &str = "Interface in English";
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
pub(crate) const STOP_RECORDING: &str = "End the recording and save it";
pub(crate) const RECORDING: &str = "Recording";
pub(crate) const USE_AS_A: &str = "Use as A";
pub(crate) const USE_AS_B: &str = "Use as B";
pub(crate) const LOADING: &str = "loading…";
pub(crate) const LOADING_SAMPLES: &str = "Loading samples";
pub(crate) const FRAME_ALL: &str = "Frame everything";
pub(crate) const TOP_VIEW: &str = "From above";
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
pub(crate) const NO_LEGS: &str = "Its feet are not held: this skeleton has no leg with thigh, shin and foot. Choose these joints under Body parts in the View lab.";
pub(crate) const FEET: &str = "Feet and ground";
pub(crate) const MEAN_SPEED: &str = "Mean speed";
pub(crate) const JOINTS: &str = "Joints";
pub(crate) const JOINT_TREE: &str = "Joints of the clip";
pub(crate) const ROOT: &str = "Root";
pub(crate) const POSITION: &str = "position";
pub(crate) const ROTATION: &str = "rotation";
pub(crate) const MADE_BODY: &str = "made around the bones";
pub(crate) const BODY_PARTS: &str = "Body parts";
pub(crate) const BODY_PARTS_HELP: &str =
    "Which joint is which part of the body. Found by name or by shape; correct what is wrong.";
pub(crate) const UNIT: &str = "Unit";
pub(crate) const UP_AXIS: &str = "Up axis";
pub(crate) const FOUND_WORD: &str = "found";
pub(crate) const AS_FOUND: &str = "as found";
pub(crate) const AS_FILE: &str = "as in the file";
pub(crate) const AS_IT_IS: &str = "as it is";
pub(crate) const OTHER: &str = "other…";
pub(crate) const TYPED_RATE: &str = "Frames per second";
pub(crate) const DROP_T_POSE: &str = "Leave out the T-pose";
pub(crate) const NOBODY: &str = "none";
pub(crate) const FOUND: &str = "Found automatically";
pub(crate) const BY_HAND: &str =
    "Set by hand; double-click the label to find the best match again.";
/// How the place of a transition was found, and how far apart the clips are there. `automatic`:
/// whether A's frame and B's are left to Segue.
pub(crate) fn place_found(transition: &Transition, automatic: [bool; 2]) -> String {
    let Some(search) = transition.search.filter(|_| transition.distance_cm.is_finite()) else {
        return if automatic == [false, false] { BY_HAND.to_owned() } else { format!("{FOUND}.") };
    };
    let cm = transition.distance_cm;
    let mut said = match (automatic, search.by_pose) {
        ([false, false], true) => {
            vec![BY_HAND.to_owned(), format!("The poses are {cm:.1} cm apart.")]
        }
        ([false, false], false) => {
            vec![BY_HAND.to_owned(), format!("The windows are {cm:.1} cm apart.")]
        }
        (_, true) => vec![format!("{FOUND}: best match of two poses, {cm:.1} cm.")],
        (_, false) => vec![format!("{FOUND}: best match of both windows, {cm:.1} cm.")],
    };
    match automatic {
        _ if search.is_widened => {
            said.push("A clip is too short for its half to be searched: all of it was.".to_owned());
        }
        [true, true] => said.push("Searched: A's second half and B's first half.".to_owned()),
        [true, false] => said.push("Searched: A's second half.".to_owned()),
        [false, true] => said.push("Searched: B's first half.".to_owned()),
        [false, false] => {}
    }
    if search.is_shortened && !search.by_pose {
        said.push(match search.window_frames {
            1 => "Compared over 1 frame: the clip ends there.".to_owned(),
            frames => format!("Compared over {frames} frames: the clip ends there."),
        });
    }
    said.join(" ")
}
pub(crate) const SMOOTHEST: &str = "smoothest";
pub(crate) const ROUGHEST: &str = "roughest";
pub(crate) const WELCOME_HINT: &str = "Same walk, same instant. Watch the feet and the hips: the shorter the window, the harder the burst into the run.";
pub(crate) const EMPTY_PANE: &str = "Nothing to show yet";
/// On a pane that still shows an earlier result.
pub(crate) const OUTDATED: &str = "computing the new one";
/// Below a button that keeps and rows that save.
pub(crate) const NOTHING_TO_KEEP: &str = "There is no result to keep or save.";
pub(crate) const STILL_COMPUTED: &str = "The result is still being computed.";

/// What is being worked on, and how much of it is done.
pub(crate) fn under_way(job: &Job) -> String {
    let percent = 100.0 * job.progress;
    match &job.kind {
        JobKind::Matching => format!("Looking for the best match {percent:.0} %"),
        JobKind::Registering => format!("Registering the clips {percent:.0} %"),
        JobKind::BuildingGraph => format!("Building the graph {percent:.0} %"),
        JobKind::HoldingFeet => format!("Holding the feet {percent:.0} %"),
        JobKind::Driving => format!("Driving {percent:.0} %"),
        JobKind::BuildingDatabase => format!("Building the database {percent:.0} %"),
        JobKind::Reading(file) => format!("{file} {percent:.0} %"),
    }
}
pub(crate) const CLOSE: &str = "Close";
pub(crate) const MATCHING: &str = "Looking for the best match";

pub(crate) const READING: &str = "being read…";
/// Of a bundled take that did not come: a notice said why.
pub(crate) const NOT_LOADED: &str = "not loaded: choose it again";
/// Likewise, when reading it failed or was stopped: a notice said why.
pub(crate) const UNREAD: &str = "not read: drop the file again";
/// Likewise.
pub(crate) const AWAITS_SKELETON: &str = "waits for its skeleton: drop the .asf file";

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
pub(crate) fn stored(stored: Storing) -> &'static str {
    match stored {
        Storing::Done => SAVED,
        Storing::UnderWay => SAVING,
        Storing::Incomplete => NOT_ALL_SAVED,
    }
}

/// How much memory is in use, and how much there is.
pub(crate) fn memory(memory: MemoryUse) -> String {
    let limit_gb = (memory.limit as f64 / 1e8).round() / 10.0;
    format!("{:.0} MB of {limit_gb} GB", memory.used as f64 / 1e6)
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
pub(crate) fn missing(name: &str) -> String {
    format!("{name} · missing")
}

/// So many joints have other channels.
pub(crate) fn others(count: usize) -> String {
    match count {
        1 => "1 has others".to_owned(),
        count => format!("{count} have others"),
    }
}

/// That B was moved onto A's skeleton, and what was not matched.
pub(crate) fn retargeted(retargeted: &Retargeted) -> String {
    /// More names would be a list that nobody reads.
    const NAMED: usize = 4;
    let unmatched = &retargeted.unmatched;
    let moved = "B's motion is moved onto A's skeleton";
    if unmatched.is_empty() {
        return format!("{moved}.");
    }
    let named = unmatched.iter().take(NAMED).map(String::as_str).collect::<Vec<_>>().join(", ");
    if unmatched.len() > NAMED {
        format!("{moved}; not matched: {named}, … ({}).", unmatched.len())
    } else {
        format!("{moved}; not matched: {named}.")
    }
}

/// That B runs at another rate than A.
pub(crate) fn resampled(from: f64, to: f64) -> String {
    let [from, to] = [from, to].map(|fps| format_number(fps, 0.01));
    format!(
        "B is resampled from {from} to {to} frames per second, the rate of A and of the result."
    )
}

/// The numbers under a pane, by id, with the short names that fit there: first those of every lab.
/// A narrow pane has room for these and two more.
pub(crate) const METRICS: &[(&str, &str)] = &[
    ("pose_jump_deg", "pose jump"),
    ("velocity_jump_dps", "velocity jump °/s"),
    ("spin_deg", "spin"),
    ("skating_cmps", "skating cm/s"),
    ("foot_slide_cm", "slide cm"),
    ("foot_slide_before_cm", "unlocked cm"),
    ("foot_slide_original_cm", "original cm"),
    ("spins", "spins"),
    ("flashes", "flashes"),
    ("seams_per_min", "seams / min"),
    ("lag_s", "lag s"),
    ("variety", "variety %"),
    ("speed_mps", "m/s"),
    ("stride_m", "stride m"),
    ("cadence_spm", "steps/min"),
    ("weight_percent", "B %"),
    ("match_error", "error cm"),
    ("match_seams", "jumps/min"),
    ("match_visited", "visited"),
    ("match_tick_ms", "ms/tick"),
    ("match_turn", "turn s"),
    ("match_worst_error", "largest error cm"),
    ("loop_seam_deg", "seam"),
    ("loop_seam_dps", "seam °/s"),
    ("apart_cm", "distance cm"),
    ("fit_rms_cm", "fit error cm"),
    ("fit_most_cm", "largest fit error cm"),
    ("path_m", "length m"),
    ("path_original_m", "original m"),
    ("hard_turns", "hard turns"),
    ("off_arms_deg", "arms off A"),
    ("off_spine_deg", "spine"),
    ("off_head_deg", "head"),
    ("off_legs_deg", "legs"),
    ("penetration_cm", "penetration cm"),
    ("clip_penetration_cm", "penetration cm"),
    ("clip_jump_cm", "position jump cm"),
    ("loop_before_deg", "bare seam"),
    ("cycle_s", "cycle s"),
    ("cycle_frames", "frames"),
    ("cycle_m", "travelled m"),
    ("cycle_turn_deg", "turn"),
    ("root_way_m", "travelled m"),
    ("root_way_mps", "m/s"),
    ("root_way_turn_deg", "turn"),
];

/// What the In place lab does.
pub(crate) const IN_PLACE_ABOUT: &str =
    "Removes the root motion of a clip, or rebuilds it from the planted feet.";
/// What the Speed lab does.
pub(crate) const SPEED_ABOUT: &str = "Blends two gaits, such as a walk and a run, to any speed between them. Drag the speed while it plays.";
/// Opens the speeds of A and B and the one between.
pub(crate) const THREE_SPEEDS: &str = "A, half way, B";
/// A chip over a pane whose speed lies beyond both clips.
pub(crate) const BEYOND: &str = "beyond both clips";

/// How fast both clips go, and where.
pub(crate) fn gaits([a, b]: [f64; 2], [[from_a, to_a], [from_b, to_b]]: [[f64; 2]; 2]) -> String {
    format!(
        "Speed of one cycle: A {a:.2} m/s from {from_a:.2} to {to_a:.2} s, B {b:.2} m/s from {from_b:.2} to {to_b:.2} s. The mean over a whole clip, as in View, may differ."
    )
}

/// That the speed asked for lies beyond both clips; `None` where it does not.
pub(crate) fn beyond_gaits(facts: &GaitFacts, [a, b]: [f64; 2]) -> Option<String> {
    let range = format!("{:.2} to {:.2} m/s", a.min(b), a.max(b));
    if facts.limited {
        Some(format!(
            "Too far beyond both clips ({range}): this is {:.2} m/s, the nearest that can be made of them.",
            facts.speed_mps
        ))
    } else if facts.extrapolated {
        Some(format!(
            "Beyond both clips ({range}): the pose is a guess, and may bend what does not bend."
        ))
    } else {
        None
    }
}

/// A mark on the timeline.
pub(crate) const CYCLE_BEGINS: &str = "The cycle begins again";
/// What the Loop lab does.
pub(crate) const LOOP_ABOUT: &str =
    "Makes a seamless cycle of a part of A: the difference between its ends is spread over it.";
/// What the half-life does to a loop.
pub(crate) const LOOP_HALF_LIFE: &str =
    "How far into the cycle the correction reaches from its ends.";
/// Several methods on the same cycle.
pub(crate) const LOOP_SHOOT_OUT: &str = "Exact against classic";
/// What the button opens.
pub(crate) const LOOP_SHOOT_OUT_QUERY: &str = "loop_method:exact,both,end";

/// What a way to close a loop does.
pub(crate) fn loop_method(method: LoopMethod) -> &'static str {
    match method {
        LoopMethod::Both => {
            "Springs from both ends, as they are: what has not died away at the other end stays as a seam."
        }
        LoopMethod::Crossed => {
            "As with both ends, but the beginning takes the other share of the velocity's difference. With a ratio of 0.5 it is the same."
        }
        LoopMethod::Start => "A spring at the beginning alone takes all of the difference.",
        LoopMethod::End => "A spring at the end alone takes all of the difference.",
        LoopMethod::Linear => {
            "Evenly over the whole cycle: the pose closes, its velocity does not."
        }
        LoopMethod::Cubic => {
            "A cubic over the whole cycle: pose and velocity close, and every pose bends a little."
        }
        LoopMethod::Exact => {
            "Springs from both ends, solved so that pose and velocity close exactly."
        }
    }
}

/// How the ends of a cycle were found.
pub(crate) fn ends_found(distance_cm: f64) -> String {
    format!("{FOUND}: the ends that fit best, {distance_cm:.1} cm apart.")
}

/// That the ends of a cycle that was found hardly fit.
pub(crate) fn poor_ends(distance_cm: f64) -> String {
    format!(
        "The best ends that were found are {distance_cm:.1} cm apart: this clip hardly repeats itself. Choose a steadier clip, or set the ends by hand."
    )
}

/// What the Register lab does, and where to look.
pub(crate) const REGISTER_ABOUT: &str = "Bends B's time so that alike frames meet. Watch the feet on the timeline: A, B and the result strike together.";
/// The same over the stage.
pub(crate) const REGISTER_HINT: &str = "A and B go beside what is made of them, in step. Compare with plain: there steps double and feet slide.";
/// What makes the weight of a registered blend a curve.
pub(crate) const WEIGHT_OVER_TIME: &str = "Draw over time";
/// And a number again.
pub(crate) const ONE_WEIGHT: &str = "One weight";
/// What that curve begins as.
pub(crate) const FIRST_WEIGHTS: &str = "0-0,100-100";
/// The ends of the weight.
pub(crate) const ALL_B: &str = "all B";
/// See [`ALL_B`].
pub(crate) const ALL_A: &str = "all A";
/// How the curve is worked.
pub(crate) const WEIGHT_CURVE_HELP: &str =
    "Drag a key to move it; double-click to add one, or to take one away.";
/// Opens both beside each other.
pub(crate) const REGISTERED_AND_PLAIN: &str = "Registered beside plain";
/// The map's name.
pub(crate) const DISTANCES: &str = "Distances between A and B";
/// While they are computed.
pub(crate) const COMPARING: &str = "Comparing all frames";
/// What can be done with the map.
pub(crate) const MAP_HELP: &str =
    "Point: both poses. Click: go there. Drag: a pin; drag it out or double-click it to remove it.";
/// A button.
pub(crate) const REMOVE_PINS: &str = "Remove pins";
/// Of the parameters below the map.
pub(crate) const REGISTRATION: &str = "Registration";
/// Before the stripes of feet.
pub(crate) const FEET_OF_A: &str = "A feet";
/// Likewise.
pub(crate) const FEET_OF_B: &str = "B feet";
/// Likewise.
pub(crate) const FEET_OF_RESULT: &str = "Result";

/// How far apart a pair of frames is.
pub(crate) fn pair_apart([a, b]: [f64; 2], cm: Option<f64>) -> String {
    match cm {
        Some(cm) => format!("A {a:.2} s, B {b:.2} s: {cm:.1} cm per joint"),
        None => format!("A {a:.2} s, B {b:.2} s"),
    }
}

/// The ends of the colours.
pub(crate) fn heat_ends([low, high]: [f64; 2]) -> [String; 2] {
    [format!("{low:.0}"), format!("{high:.0} cm per joint")]
}

/// How many pins there are.
pub(crate) fn pins(count: usize) -> String {
    if count == 1 { "1 pin".to_owned() } else { format!("{count} pins") }
}

/// What the Path lab does.
pub(crate) const PATH_ABOUT: &str = "A curve is fitted to the path of the hips. Drag its points: the path bends, and the character follows with what the curve left over.";
/// The same over the stage.
pub(crate) const PATH_HINT: &str = "Drag a point: the path bends, and the character follows. Double-click the path for one more point.";
/// A button.
pub(crate) const DRAW: &str = "Draw";
/// Its hint.
pub(crate) const DRAW_HELP: &str =
    "Draw a path on the ground with one stroke; back to where it began makes a loop";
/// Over the stage, until something was drawn.
pub(crate) const DRAW_HINT: &str =
    "Draw the path on the ground in one stroke. Esc leaves it as it is.";
/// A button.
pub(crate) const ADD_POINT: &str = "Add a point";
/// Its hint.
pub(crate) const ADD_POINT_HELP: &str =
    "One more control point behind the chosen one; the path stays as it is";
/// A button.
pub(crate) const REMOVE_POINT: &str = "Take it out";
/// Its hint.
pub(crate) const REMOVE_POINT_HELP: &str = "Takes the chosen control point out of the path";
/// While no point is chosen.
pub(crate) const POINTS_HELP: &str = "Points on the stage: drag, or choose one and use the arrow keys, Shift for more, Delete to take it out, Tab for the next.";
/// When none is chosen.
pub(crate) const CHOOSE_POINT: &str = "Choose a control point on the stage first.";
/// Over the buttons that follow.
pub(crate) const WHOLE_PATH: &str = "Whole path";
/// A button.
pub(crate) const TURN_LEFT: &str = "Left 15°";
/// Likewise.
pub(crate) const TURN_RIGHT: &str = "Right 15°";
/// Likewise.
pub(crate) const LARGER_PATH: &str = "Larger";
/// Likewise.
pub(crate) const SMALLER_PATH: &str = "Smaller";
/// Likewise.
pub(crate) const MIRROR: &str = "Mirror";
/// Likewise.
pub(crate) const STRAIGHTEN: &str = "Straighten";
/// Likewise.
pub(crate) const SMOOTH: &str = "Smooth";
/// Likewise.
pub(crate) const CLOSE_LOOP: &str = "Close the loop";
/// Likewise.
pub(crate) const OPEN_LOOP: &str = "Open the loop";
/// Likewise.
pub(crate) const SNAP_ALL: &str = "Snap all points";
/// Likewise.
pub(crate) const RESET_PATH: &str = "Reset the path";
/// Its hint.
pub(crate) const RESET_PATH_HELP: &str =
    "Back to the path as it was fitted; undo brings the edited one back";
/// Over what belongs to the fit.
pub(crate) const FIT: &str = "Fit";
/// A button that opens panes.
pub(crate) const FOUR_EIGHT_SIXTEEN: &str = "4, 8, 16 points";
/// What it opens.
pub(crate) const FOUR_EIGHT_SIXTEEN_QUERY: &str = "control_points:4,8,16";
/// A chip over a pane whose path turns harder than the motion can.
pub(crate) const TOO_HARD: &str = "turns too hard";
/// Where that is, on the timeline.
pub(crate) const HARD_MOMENT: &str = "The path turns faster than the original";
/// Over the list of those who play along.
pub(crate) const COMPANY: &str = "On the stage together";
/// A button.
pub(crate) const JOIN: &str = "This one joins";
/// Its hint.
pub(crate) const JOIN_HELP: &str =
    "Leaves this character on the stage as it is, so that another path can be made beside it";
/// A list of clips.
pub(crate) const JOIN_CLIP: &str = "A clip joins";
/// Which clip is preferred while none is chosen.
pub(crate) const THE_CLIP_THAT_PLAYS: &str = "the one that plays";
/// While none is chosen.
pub(crate) const CHOOSE_CLIP: &str = "choose…";
/// What that is for.
pub(crate) const COMPANY_HELP: &str =
    "Each on its own path and in its own colour, all in the same time. The link carries them.";

/// What a screen reader says of a control point.
pub(crate) fn control_point(index: usize, count: usize, place: glam::DVec2) -> String {
    format!("Control point {} of {count}: {:.2} m, {:.2} m", index + 1, place.x, place.y)
}

/// The chosen point, in the panel.
pub(crate) fn chosen_point(index: usize, count: usize, place: glam::DVec2) -> String {
    let [x, z] = [place.x, place.y].map(|metres| format!("{metres:.2}").replace('-', "−"));
    format!(
        "Point {} of {count} at x {x} m, z {z} m: arrow keys move it, Delete takes it out.",
        index + 1
    )
}

/// What stays when a path becomes longer or shorter.
pub(crate) fn path_keep(word: PathKeep) -> &'static str {
    match word {
        PathKeep::Duration => {
            "It takes the whole path in the time that it took before: faster on a longer one, and feet slide."
        }
        PathKeep::Whole => {
            "It takes the whole path at its speed: a longer one takes longer, with longer strides."
        }
        PathKeep::Speed => {
            "Speed and strides stay: on a longer path it does not come to the end, on a closed one it goes round."
        }
    }
}

/// How long the path is, and was.
pub(crate) fn path_lengths(path: &OnPath) -> String {
    let (now, before) = (path.road.length_m(), path.fitted.road().length_m());
    if path.is_edited { format!("{now:.2} m, was {before:.2} m") } else { format!("{now:.2} m") }
}

/// How well the path follows the hips.
pub(crate) fn fit_error(rms_cm: f64, most_cm: f64, along_m: f64) -> String {
    format!(
        "Hips beside the path: {rms_cm:.1} cm on average (root mean square), at most {most_cm:.1} cm at {along_m:.1} m."
    )
}

/// That an edited path does not change with the slider.
pub(crate) fn own_points(count: usize) -> String {
    format!(
        "The edited path keeps its own {count} points; this is the path that it is measured against."
    )
}

/// A turn that the motion does not hold.
pub(crate) fn hard_turn(turn: &HardTurn, fps: f64) -> String {
    let secs = |frame: usize| frame as f64 / fps;
    format!(
        "At {:.1} to {:.1} s the path turns by up to {:.0}°/s, and the original by {:.0}: widen the bend or slow down.",
        secs(turn.frames.start),
        secs(turn.frames.end),
        turn.turn_dps,
        turn.limit_dps
    )
}

/// How many more there are.
pub(crate) fn more_hard_turns(count: usize) -> String {
    if count == 1 {
        "One more bend is as hard.".to_owned()
    } else {
        format!("{count} more bends are as hard.")
    }
}

/// While the feet of a long motion are not planted yet.
pub(crate) const FEET_LATER: &str = "A long motion: its feet are planted when the hand rests.";

/// A button beside a companion.
pub(crate) fn edit_companion(name: &str) -> String {
    format!("Edit the path of {name}; the present one takes its place")
}

/// Likewise.
pub(crate) fn companion_leaves(name: &str) -> String {
    format!("{name} leaves the stage")
}

/// What the student will see of a mistake of the Transition lab; empty for none.
pub(crate) fn mistake(key: Mistake) -> &'static str {
    match key {
        Mistake::Hemisphere => {
            "Limbs swing the long way round: half of B's quaternions come with the other sign, the same rotations, and nobody took the nearer one."
        }
        Mistake::Euler => {
            "Limbs twist and flip, forearms first: three angles mixed one by one are no rotation on the way from A to B."
        }
        Mistake::Degrees => {
            "Limbs whirl: an angle in degrees taken for radians is 57 times too large."
        }
        Mistake::Atan => {
            "B arrives turned by half a turn and goes off backwards: atan cannot tell a direction from its opposite."
        }
        Mistake::TransformDegrees => {
            "B goes off in a direction of its own: its turn in degrees was taken for radians."
        }
        Mistake::Facing => {
            "B is turned to wherever the hips happen to tilt: the root's Y axis points up, and its shadow on the ground is no facing."
        }
        Mistake::Alignment => "The character flies to where B's file has it: nobody laid B on A.",
        Mistake::Velocity => {
            "Everything that moved stops dead at the seam and starts anew: the velocities are thousands of times too small."
        }
        Mistake::WorldRoot => {
            "The feet slide and the pace surges: where A and B stand is mixed, not how they go."
        }
        Mistake::None => "",
    }
}
/// Of `velocity` where the method is a dissolve, which has no other velocity.
pub(crate) const VELOCITY_IN_DISSOLVE: &str = "The character treads on the spot through the window and then goes on: its velocity over the ground is thousands of times too small.";
/// For a method that the mistake cannot be made in.
pub(crate) const MISTAKE_IDLE: &str =
    "A cut mixes nothing, so there is nothing to see: choose another method.";
/// What a comparison opens that shows the mistake.
pub(crate) const RIGHT_AND_WRONG: &str = "Right beside wrong";

/// How B's time goes in a layer.
pub(crate) fn fit(layer: &LayerFacts) -> String {
    let how = match layer.fit {
        LayerFit::InStep => "One cycle of B keeps step with A",
        LayerFit::Looped => "B loops, its ends brought together",
        LayerFit::Once => "B is long enough to play once",
        LayerFit::Held => "B stays in its last frame when it is over",
    };
    if layer.has_no_steps {
        format!("No steps to keep in time with. {how}.")
    } else {
        format!("{how}.")
    }
}

/// Several methods on the same transition.
pub(crate) const SHOOT_OUT: &str = "Shoot-out of methods";
/// What the button opens.
pub(crate) const SHOOT_OUT_QUERY: &str = "method:inertialize,smooth,dead";
/// The rows of the half-life ruler.
pub(crate) const HALF_LEFT: &str = "Half is left after";
/// Likewise.
pub(crate) const TENTH_LEFT: &str = "A tenth";
/// Likewise.
pub(crate) const HUNDREDTH_LEFT: &str = "A hundredth";
/// The dissolve with as much of A in it.
pub(crate) const ALIKE_WINDOW: &str = "Dissolve that feels alike";

/// A set of clips, and what its button does.
pub(crate) const fn clip_set(set: ClipSet) -> (&'static str, &'static str) {
    match set {
        ClipSet::Made => ("Synthesised motion", "The clips that this lab begins with"),
        ClipSet::Captured => {
            ("Real motion (CMU 16)", "Captured walks and runs of one actor, from the CMU database")
        }
        ClipSet::Own => ("My clips", "All motions of the files that you have dropped or opened"),
    }
}

/// What the Graph lab does.
pub(crate) const GRAPH_ABOUT: &str = "Several clips, and every place where one may go over into another. A walk through them never ends: the seed says where it goes.";
/// Over the stage.
pub(crate) const GRAPH_HINT: &str =
    "Point at a ring or an arc to see both poses. Click it to play that transition alone.";
/// Of the seed, in place of what it does for a made motion.
pub(crate) const GRAPH_SEED_HELP: &str =
    "Another seed, another way through the graph; the same seed, the same walk on every machine.";
/// Why a visit came to nothing.
pub(crate) fn no_way(name: &str, secs: f64) -> String {
    format!(
        "No way leads to {name} from where the walk is at {secs:.1} s: a higher threshold may make one."
    )
}
pub(crate) const GRAPH_LACKS_SOME: &str =
    "More transitions lie below the threshold than can be held: the closest are.";
/// Of the clips.
pub(crate) const GRAPH_CLIPS: &str = "Clips of the graph";
/// Adds one.
pub(crate) const ADD_CLIP: &str = "Add a clip";
/// Takes one out.
pub(crate) const LEAVE_OUT: &str = "Leave out";
/// While it is computed.
pub(crate) const GRAPHING: &str = "Making graph and walk";
/// After it was given up.
pub(crate) const GO_ON: &str = "Go on";
/// Of the parameters that say where the walk goes.
pub(crate) const WALK: &str = "The walk";
/// The picture of the distances.
pub(crate) const ALL_DISTANCES: &str = "Distances of all windows";
/// Below it.
pub(crate) const MATRIX_HELP: &str = "Down: where a clip is left. Across: where one is entered. Rings are transitions. Wheel: closer; drag: move.";
/// The histogram's name.
pub(crate) const ALL_HISTOGRAM: &str = "How many pairs of windows are how far apart";
/// The strip's name.
pub(crate) const GRAPH_STRIP: &str = "The graph: clips and transitions";
/// Of the links to what is worth a look.
pub(crate) const EXPERIMENTS: &str = "Experiments";
/// Chooses a clip to go to.
pub(crate) const GO_TO_CLIP: &str = "Go to a clip from here";
/// Takes that back.
pub(crate) const FORGET_VISITS: &str = "By chance again";
/// Draws a line to follow.
pub(crate) const DRAW_PATH: &str = "Draw a path on the ground";
/// While it is drawn.
pub(crate) const DRAWING: &str = "Press on the ground and draw. The walk starts at its beginning.";
/// Takes it away.
pub(crate) const REMOVE_PATH: &str = "Remove the path";
/// Back from one transition.
pub(crate) const BACK_TO_WALK: &str = "Back to the walk";
/// Of the files.
pub(crate) const GRAPH_FILES: &str = "The graph as a file";
/// Of the table of numbers.
pub(crate) const NUMBERS: &str = "Numbers";
/// Copies it.
pub(crate) const COPY_MARKDOWN: &str = "Copy as Markdown";
/// Copies it.
pub(crate) const COPY_CSV: &str = "Copy as CSV";
/// What is said then.
pub(crate) const TABLE_COPIED: &str = "The table is in the clipboard.";
/// A row of it.
/// A mark of the walk.
pub(crate) const SEAM: &str = "Into another clip";

/// What is opened by a click: its name, what it does, and the values that it sets.
pub(crate) struct Experiment {
    pub(crate) name: &'static str,
    pub(crate) help: &'static str,
    pub(crate) query: &'static str,
}

/// The experiments of the course, each on the same seed.
pub(crate) const GRAPH_EXPERIMENTS: &[Experiment] = &[
    Experiment {
        name: "Windows: full, half, third",
        help: "A long one drags, a short one bursts.",
        query: "construction=segments&segment_size=60&blend_window=30&compare=blend_window:30,15,10",
    },
    Experiment {
        name: "Segments: full, half, third",
        help: "Long segments repeat little, short ones never come to rest. A third is no longer than the window: nothing is left of a segment, and many programs crash.",
        query: "construction=segments&blend_window=20&segment_size=60&compare=segment_size:60,30,20",
    },
    Experiment {
        name: "Continuity: low, middle, high",
        help: "How long a clip is left unbroken.",
        query: "going_on=share&compare=continuity:0.3,0.8,0.98",
    },
    Experiment {
        name: "Weight of going on: 1 and 1000",
        help: "One constant beside the distances: the more ways lead out, the less it holds.",
        query: "going_on=constant&edge_weight=proportional&compare=continuity_weight:1,1000",
    },
    Experiment {
        name: "atan for atan2",
        help: "Every clip is laid on with its back to the front, as if it faced the other way in its file: spins.",
        query: "transform=whole&compare=atan:atan2,atan",
    },
    Experiment {
        name: "Degrees for radians",
        help: "A turn in degrees that is taken for radians: every clip goes off in a direction of its own.",
        query: "transform=whole&compare=atan:atan2,degrees",
    },
    Experiment {
        name: "First frame only",
        help: "The clip starts in the right place and goes off as it was recorded, or flies back to where it was recorded.",
        query: "atan=atan2&compare=transform:whole,first,teleport",
    },
];

/// What the limit of ways out has left out; `None` where that is nothing.
pub(crate) fn ways_left_out(built: &Built) -> Option<String> {
    let most = built.options().most_ways_out;
    match built.whole().left_out() {
        0 => None,
        1 => Some(format!(
            "1 transition is left out: no more than {most} leave one stretch. Raise the ways out to have it."
        )),
        count => Some(format!(
            "{count} transitions are left out: no more than {most} leave one stretch. Raise the ways out to have them."
        )),
    }
}

/// What there is of a graph.
pub(crate) fn graph_in_words(built: &Built, run_secs: Option<f64>) -> String {
    let jumps = |count: usize| {
        if count == 1 { "1 transition".to_owned() } else { format!("{count} transitions") }
    };
    let dead = match built.dead_ends() {
        0 => "no dead end".to_owned(),
        1 => "1 dead end".to_owned(),
        count => format!("{count} dead ends"),
    };
    let percent = |share: &f64| format!("{:.0} %", 100.0 * share);
    let components = match built.rings() {
        [] => "Nothing leads back: every walk comes to an end.".to_owned(),
        [one] => format!("One component, with {} of all frames.", percent(one)),
        rings => {
            let shares: Vec<String> = rings.iter().take(4).map(percent).collect();
            let more = if rings.len() > 4 { ", …" } else { "" };
            format!(
                "{} components that do not reach each other, with {}{more} of all frames: a higher threshold joins them.",
                rings.len(),
                shares.join(", ")
            )
        }
    };
    let first = format!("{}, {dead}.", jumps(built.whole().jumps().len()));
    let pruned = (built.is_pruned())
        .then(|| format!("The walk keeps to the largest: {}.", jumps(built.graph().jumps().len())));
    let run = run_secs
        .map(|secs| format!("A clip runs for {secs:.1} s on average until the next transition."));
    let sentences: Vec<String> = [first, components].into_iter().chain(pruned).chain(run).collect();
    sentences.join(" ")
}

/// A transition: from where to where, how far apart, how probable.
pub(crate) fn jump_in_words(
    [leave, enter]: [(&str, usize); 2],
    cm: f64,
    probability: Option<f64>,
) -> String {
    let probable = probability.map_or_else(String::new, |p| format!(" · p {p:.2}"));
    format!("{} {} → {} {} · {cm:.1} cm{probable}", leave.0, leave.1, enter.0, enter.1)
}

/// A pair of windows that is no transition.
pub(crate) fn windows_apart([leave, enter]: [(&str, usize); 2], cm: Option<f64>) -> String {
    let apart =
        cm.map_or_else(|| "no window starts here".to_owned(), |cm| format!("{cm:.1} cm apart"));
    format!("{} {} | {} {}: {apart}", leave.0, leave.1, enter.0, enter.1)
}

/// Which clips were moved onto the skeleton of the first; `None` where all are on it.
pub(crate) fn moved_onto_first(cast: &Cast) -> Option<String> {
    let moved: Vec<&str> = (cast.names().iter().enumerate())
        .filter(|(clip, _)| cast.retargeted(*clip).is_some())
        .map(|(_, name)| name.as_str())
        .collect();
    let first = cast.names().first()?;
    (!moved.is_empty())
        .then(|| format!("Moved onto the skeleton of {first}: {}.", moved.join(", ")))
}

/// How a walk follows its line.
pub(crate) fn followed(trace: &Trace) -> String {
    let Trace { along_m, length_m, rms_m, looked_at, .. } = trace;
    if trace.is_searching {
        format!(
            "So far {along_m:.1} of {length_m:.1} m of the path are followed, {rms_m:.2} m off it on average; {looked_at} ways were looked at."
        )
    } else {
        format!(
            "Follows {along_m:.1} of {length_m:.1} m of the path, {rms_m:.2} m off it on average; {looked_at} ways were looked at."
        )
    }
}

/// That a walk has an end.
pub(crate) fn dead_end(secs: f64) -> String {
    format!(
        "The walk comes to a dead end after {secs:.1} s. Keep to the largest component, and it never does."
    )
}

/// What the Match lab does.
pub(crate) const MATCH_ABOUT: &str = "Drive the character: W A S D or arrows, Shift to run, Q to strafe. Ten times a second the frame of all clips that fits best is looked for.";
/// The same over the stage.
pub(crate) const MATCH_HINT: &str = "Drive with W A S D or the arrows, Shift to run, or the stick. Orange: where you ask it to go. Blue: where the frame that plays leads.";
/// Over a pane whose character the user drives.
pub(crate) const LIVE: &str = "Yours";
/// The stick on the screen.
pub(crate) const STICK: &str = "Stick: drive the character";
/// Beside it.
pub(crate) const RUN: &str = "Run";
/// Likewise.
pub(crate) const RUN_HELP: &str = "The stick runs instead of walking";
/// A section.
pub(crate) const WHY: &str = "Why this frame";
/// Before there was a search.
pub(crate) const NO_SEARCH: &str = "Nothing was searched yet.";
/// How candidates are looked at.
pub(crate) const GHOST_HELP: &str =
    "Point at a frame to see it as a ghost; press to keep it there.";
/// A section.
pub(crate) const WEIGHTS: &str = "What counts";
/// A section.
pub(crate) const HYSTERESIS: &str = "Hysteresis";
/// A section.
pub(crate) const SEARCHING: &str = "Search and tags";
/// A section.
pub(crate) const GOING_OVER: &str = "Transition and way";
/// A section.
pub(crate) const MATCH_CLIPS: &str = "Clips and characters";
/// A button.
pub(crate) const REPLAY: &str = "Play it again";
/// What it does.
pub(crate) const REPLAY_HELP: &str =
    "Plays the same input from the start, exactly; the link then holds it";
/// A button.
pub(crate) const START_OVER: &str = "Start over";
/// What it does.
pub(crate) const START_OVER_HELP: &str = "Back to the origin; nothing is remembered";
/// A button.
pub(crate) const DRIVE_YOURSELF: &str = "Drive yourself";
/// While written input plays.
pub(crate) const RECORDED: &str =
    "Recorded input: the same for everybody. Change what counts and see what becomes of it.";
/// A button.
pub(crate) const HYSTERESES: &str = "None beside bias and votes";
/// What it opens.
pub(crate) const HYSTERESES_QUERY: &str = "hysteresis:none,bias,votes";
/// Of the clips.
pub(crate) const MADE_SET: &str =
    "The synthesiser's set: standing, walks and runs, turns, starts, stops and spins.";
/// The strip's name.
pub(crate) const CLIP_STRIP: &str = "All clips, and the frame that plays";
/// Of the curves.
pub(crate) const COST: &str = "cost";
/// Likewise.
pub(crate) const COST_GOING_ON: &str = "going on";
/// Likewise.
pub(crate) const COST_BEST: &str = "best frame";
/// A mark on the timeline.
pub(crate) const JUMP: &str = "Goes over to another frame";

/// What a block of features is called below the bars.
pub(crate) const fn block(block: Block) -> &'static str {
    match block {
        Block::TrajectoryPosition => "path ahead",
        Block::TrajectoryDirection => "facing ahead",
        Block::FootPosition => "feet, where",
        Block::FootVelocity => "feet, how fast",
        Block::HipVelocity => "hips, how fast",
    }
}

/// A frame by its clip and time.
pub(crate) fn frame_of_clip(name: &str, mirrored: bool, secs: f64) -> String {
    let mirrored = if mirrored { ", mirrored" } else { "" };
    format!("{name}{mirrored} · {secs:.2} s")
}

/// The frame that played when the search was made.
pub(crate) fn going_on(place: &str) -> String {
    format!("Going on: {place}")
}

/// How long was driven.
pub(crate) fn driven_for(secs: f64) -> String {
    let whole = secs.max(0.0) as u64;
    format!("Recorded so far: {}:{:02}.", whole / 60, whole % 60)
}

/// What a way to hold on does.
pub(crate) fn hysteresis(word: Hysteresis) -> &'static str {
    match word {
        Hysteresis::None => "The best frame is taken, however little better it is: many jumps.",
        Hysteresis::Time => "After a jump it stays for a while, whatever comes.",
        Hysteresis::Votes => "Three searches in a row must want to go.",
        Hysteresis::ClipVotes => {
            "Three searches in a row must want to go to another clip; within its clip it jumps at once."
        }
        Hysteresis::Bias => "Going on counts as better than it is.",
    }
}

/// Whether a search led anywhere.
fn held(held: Option<HoldReason>) -> &'static str {
    match held {
        None => "went over to the best frame",
        Some(HoldReason::Same) => "stayed: it plays the best frame already",
        Some(HoldReason::Bias) => "stayed: not better by the bias",
        Some(HoldReason::MinimumTime) => "stayed: the last jump is too recent",
        Some(HoldReason::Votes) => "stayed: not three votes yet",
        Some(HoldReason::CurrentClip) => "stayed in its clip: the input is still",
        Some(HoldReason::Nothing) => "stayed: no frame has the tags that are asked for",
    }
}

/// What a search came to, in a few words.
pub(crate) fn outcome_of_search(search: &SearchRecord, is_live: bool) -> String {
    let live = if is_live { "live · " } else { "" };
    format!("{live}{}", held(search.held))
}

/// What a search came to, and what it took.
pub(crate) fn searched(search: &SearchRecord, frames: usize) -> String {
    let why = match search.reason {
        SearchReason::Interval => "It was time to search",
        SearchReason::ClipEnd => "The clip came to its end",
        SearchReason::InputChange => "The input changed",
    };
    format!("{why}; {}. {} of {frames} frames were looked at.", held(search.held), search.visited)
}

/// How large a database is.
pub(crate) fn database(database: &Database) -> String {
    let minutes = database.frames() as f64 / (60 * RATE) as f64;
    format!(
        "{} motions, {} frames ({minutes:.1} min), {} of them can be gone to.",
        database.motions().len(),
        database.frames(),
        database.valid().len()
    )
}

/// The name of a button.
pub(crate) fn leave_clip_out(name: &str) -> String {
    format!("Leave {name} out")
}

/// The letter of a further clip in a blend: those behind A and B.
fn letter(index: usize) -> char {
    char::from_u32('C' as u32 + index as u32).unwrap_or('…')
}

/// What a further clip of a blend is called.
pub(crate) fn blended_clip(index: usize) -> String {
    letter(index).to_string()
}

/// Its weight.
pub(crate) fn weight_of(index: usize) -> String {
    format!("Weight of {}", letter(index))
}

/// The button that opens the list of lessons.
pub(crate) const LESSONS: &str = "Lessons";
/// Its hint.
pub(crate) const LESSONS_HELP: &str =
    "Short guided pages: what to look at, what to try, a question";
/// Of the page, where it shares its place with the parameters.
pub(crate) const LESSON: &str = "Lesson";
/// See [`LESSON`].
pub(crate) const PARAMETERS: &str = "Parameters";
/// What the two are, for a screen reader.
pub(crate) const LESSON_OR_PARAMETERS: &str = "Lesson or parameters";
/// Back to the list.
pub(crate) const ALL_LESSONS: &str = "All lessons";
/// Closes the panel.
pub(crate) const CLOSE_LESSONS: &str = "Close the lessons";
/// To the page before.
pub(crate) const PREVIOUS_PAGE: &str = "Previous page";
/// To the page behind.
pub(crate) const NEXT_PAGE: &str = "Next page";
/// Likewise, below the text.
pub(crate) const NEXT: &str = "Next";
/// Over what there is to try.
pub(crate) const TRY: &str = "Try";
/// Over the question.
pub(crate) const QUESTION: &str = "Question";
/// Shows what was hidden.
pub(crate) const SHOW_ANSWER: &str = "Show answer";
/// And hides it.
pub(crate) const HIDE_ANSWER: &str = "Hide answer";
/// Ends the wait for a text.
pub(crate) const STOP_LOADING: &str = "Stop loading";
/// While a text is under way.
pub(crate) const LESSON_WAITING: &str = "The lesson is loading…";
/// After it did not come.
pub(crate) const TRY_AGAIN: &str = "Try again";

/// The place of a page.
pub(crate) fn page_of(number: usize, of: usize) -> String {
    format!("{number} of {of}")
}

/// A tag that was set by hand, or taken away.
pub(crate) fn hand_tag(clip: &str, [from, to]: [f64; 2], word: &str, takes_away: bool) -> String {
    if takes_away {
        format!("{clip}, {from:.2} to {to:.2} s: no longer {word}")
    } else {
        format!("{clip}, {from:.2} to {to:.2} s: {word}")
    }
}

/// The button that puts a tag on the chosen stretch, or takes it away from there.
pub(crate) fn tag_as(word: &str, takes_away: bool) -> String {
    if takes_away { format!("Not {word}") } else { format!("Tag as {word}") }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_was_not_matched_is_named_and_counted() {
        let told = |names: &[&str]| {
            retargeted(&Retargeted {
                unmatched: names.iter().map(|name| (*name).to_owned()).collect(),
            })
        };
        assert_eq!(told(&[]), "B's motion is moved onto A's skeleton.");
        assert_eq!(told(&["Tail"]), "B's motion is moved onto A's skeleton; not matched: Tail.");
        assert_eq!(
            told(&["a", "b", "c", "d", "e"]),
            "B's motion is moved onto A's skeleton; not matched: a, b, c, d, … (5)."
        );
    }
}
