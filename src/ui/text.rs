//! Every sentence and word of the interface that is not a parameter's own (those stand in the table of parameters).

pub(crate) const APP: &str = "Segue";
pub(crate) const LIBRARY: &str = "Library";
pub(crate) const SAMPLES: &str = "samples";
pub(crate) const DROP_HERE: &str = "Drop BVH files";
pub(crate) const OPEN_FILES: &str = "open…";
pub(crate) const DROP_NOW: &str = "Drop to open";
pub(crate) const COMPARE: &str = "Compare";
pub(crate) const COMPARE_OFF: &str = "One pane";
pub(crate) const COMPARE_HELP: &str = "Full, half and a third of the value side by side";
pub(crate) const FULL_HALF_THIRD: &str = "full, half, third";
pub(crate) const COPY_LINK: &str = "Copy link";
pub(crate) const LINK: &str = "Link";
pub(crate) const LINK_COPIED: &str = "The link is in the clipboard. It opens exactly this state.";
pub(crate) const THEME: &str = "Dark or light";
pub(crate) const PROJECTOR: &str = "Projector: larger type";
pub(crate) const LARGER: &str = "Aa";
pub(crate) const HELP: &str = "Shortcuts";
pub(crate) const MENU: &str = "Menu";
pub(crate) const UNDO: &str = "Undo";
pub(crate) const REDO: &str = "Redo";
pub(crate) const REMOVE: &str = "Remove";
pub(crate) const RENAME: &str = "Rename";
pub(crate) const DETAILS: &str = "Details";
pub(crate) const EXPORT_BVH: &str = "Save as BVH";
pub(crate) const EXPORT_RESULT: &str = "Save the result as BVH";
pub(crate) const USE_AS_A: &str = "Use as A";
pub(crate) const USE_AS_B: &str = "Use as B";
pub(crate) const LOADING: &str = "loading…";
pub(crate) const FRAME_ALL: &str = "Frame everything";
pub(crate) const TOP_VIEW: &str = "From above";
pub(crate) const FOLLOW: &str = "Camera follows";
pub(crate) const KEEP: &str = "Keep in library";
pub(crate) const STAGE: &str = "Stage";
pub(crate) const CAMERA: &str = "Camera";
pub(crate) const CURVES: &str = "curves";
pub(crate) const RESULT: &str = "result";
pub(crate) const JOINTS: &str = "Body parts";
pub(crate) const JOINTS_HELP: &str = "Which joint is which part of the body. Found by name or by shape; correct what is wrong.";
pub(crate) const UNIT: &str = "Unit of the file";
pub(crate) const UP_AXIS: &str = "Up axis of the file";
pub(crate) const NOBODY: &str = "none";
pub(crate) const FOUND: &str = "Found automatically";
pub(crate) const BY_HAND: &str = "Set by hand; double-click the label to find the best match again.";
pub(crate) const SMOOTHEST: &str = "smoothest";
pub(crate) const ROUGHEST: &str = "roughest";
pub(crate) const WELCOME_HINT: &str =
    "Same walk, same instant. Watch the feet and the hips: the shorter the window, the harder the burst into the run.";
pub(crate) const EMPTY_PANE: &str = "Nothing to show yet";
pub(crate) const CLOSE: &str = "Close";
pub(crate) const MATCHING: &str = "Looking for the best match";

/// The shortcuts, in the order of the list under `?`.
pub(crate) const SHORTCUTS: &[(&str, &str)] = &[
    ("Space", "play or pause"),
    ("← →", "one frame back or on"),
    ("Shift ← →", "ten frames"),
    ("Home", "to the beginning"),
    ("I  O", "set the in or out mark here; Shift takes it away"),
    ("[ ]", "slower, faster"),
    ("L", "loop"),
    ("C", "compare full, half, third"),
    ("1 2 3 4", "View, Make, Blend, Transition"),
    ("T", "from above"),
    ("F", "frame everything"),
    ("G", "camera follows or stands"),
    ("B", "body, bones, both"),
    ("Ctrl Z", "undo"),
    ("Ctrl Shift Z", "redo"),
    ("Ctrl C", "copy the link, when nothing else is selected"),
    ("?", "this list"),
    ("drag", "turn the camera; with Shift or the right button, move it"),
    ("wheel, pinch", "zoom"),
];

/// The artefact numbers under a pane, by id, with the short names that fit there. The first four are what a narrow pane has room for.
pub(crate) const METRICS: &[(&str, &str)] = &[
    ("seam_dps", "seam °/s"),
    ("skate_cm", "skate cm"),
    ("lag_s", "lag s"),
    ("spin_deg", "spin"),
    ("seam_deg", "jump"),
    ("penetration_cm", "sunk cm"),
];

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
