//! The texts of the Path lab.

use segue_motion::path::HardTurn;
use segue_session::OnPath;
use segue_session::choices::PathKeep;
use segue_text::{Message, msg};

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
pub(crate) fn control_point(index: usize, count: usize, place: glam::DVec2) -> Message {
    msg!(
        "Control point {number} of {count}: {x:.2} m, {z:.2} m",
        number = index + 1,
        count,
        x = place.x,
        z = place.y
    )
}

/// The chosen point, in the panel.
pub(crate) fn chosen_point(index: usize, count: usize, place: glam::DVec2) -> Message {
    let [x, z] = [place.x, place.y].map(|metres| format!("{metres:.2}").replace('-', "−"));
    msg!(
        "Point {number} of {count} at x {x} m, z {z} m: arrow keys move it, Delete takes it out.",
        number = index + 1,
        count,
        x,
        z
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
pub(crate) fn path_lengths(path: &OnPath) -> Message {
    let (now, before) = (path.curve.length_m(), path.fitted.curve().length_m());
    if path.is_edited {
        msg!("{now:.2} m, was {before:.2} m", now, before)
    } else {
        msg!("{now:.2} m", now)
    }
}

/// How well the path follows the hips.
pub(crate) fn fit_error(rms_cm: f64, most_cm: f64, along_m: f64) -> Message {
    msg!(
        "Hips beside the path: {rms_cm:.1} cm on average (root mean square), at most {most_cm:.1} cm at {along_m:.1} m.",
        rms_cm,
        most_cm,
        along_m
    )
}

/// That an edited path does not change with the slider.
pub(crate) fn own_points(count: usize) -> Message {
    msg!(
        "The edited path keeps its own {count} points; this is the path that it is measured against.",
        count
    )
}

/// A turn that the motion does not hold.
pub(crate) fn hard_turn(turn: &HardTurn, fps: f64) -> Message {
    let secs = |frame: usize| frame as f64 / fps;
    msg!(
        "At {from:.1} to {to:.1} s the path turns by up to {dps:.0}°/s, and the original by {limit:.0}: widen the bend or slow down.",
        from = secs(turn.frames.start),
        to = secs(turn.frames.end),
        dps = turn.turn_dps,
        limit = turn.limit_dps
    )
}

/// How many more there are.
pub(crate) fn more_hard_turns(count: usize) -> Message {
    msg!(
        "{count, plural, one {One more bend is as hard.} other {# more bends are as hard.}}",
        count
    )
}

/// While the feet of a long motion are not planted yet.
pub(crate) const FEET_LATER: &str = "A long motion: its feet are planted when the hand rests.";

/// A button beside a companion.
pub(crate) fn edit_companion(name: Message) -> Message {
    msg!("Edit the path of {name}; the present one takes its place", name)
}

/// Likewise.
pub(crate) fn companion_leaves(name: Message) -> Message {
    msg!("{name} leaves the stage", name)
}
