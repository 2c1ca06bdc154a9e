//! The texts of the Path lab.

use crate::ui::language::Word;
use segue_motion::path::HardTurn;
use segue_session::PathFacts;
use segue_session::choices::PathKeep;
use segue_text::{Message, msg};

/// The line about the Path lab.
pub(crate) const PATH_ABOUT: Word = Word::new("Fits a path to the hips, and lets you reshape it.");
/// The help text of the Path lab.
pub(crate) const PATH_DETAILS: Word =
    Word::new("Drag its control points: the character follows and keeps its local motion.");
/// The hint over the stage in the Path lab.
pub(crate) const PATH_HINT: Word = Word::new(
    "Drag a point to bend the path; the character follows. Double-click the path to add a point.",
);
/// The button that lets a path be drawn.
pub(crate) const DRAW: Word = Word::new("Draw");
/// The hint of the button that lets a path be drawn.
pub(crate) const DRAW_HELP: Word =
    Word::new("Draw a path on the ground in one stroke; end at its start to make a loop");
/// The note over the stage until something is drawn.
pub(crate) const DRAW_HINT: Word =
    Word::new("Draw the path on the ground in one stroke. Esc cancels.");
/// The button that adds a control point.
pub(crate) const ADD_POINT: Word = Word::new("Add point");
/// The hint of the button that adds a control point.
pub(crate) const ADD_POINT_HELP: Word =
    Word::new("Adds a control point after the selected one; the path keeps its shape");
/// The button that removes a control point.
pub(crate) const REMOVE_POINT: Word = Word::new("Remove point");
/// The hint of the button that removes a control point.
pub(crate) const REMOVE_POINT_HELP: Word =
    Word::new("Removes the selected control point from the path");
/// The help while no control point is chosen.
pub(crate) const POINTS_HELP: Word = Word::new(
    "Drag points on the stage, or select one: arrow keys move it (Shift: farther), Delete removes it, Tab selects the next.",
);
/// The refusal of a button that needs a control point.
pub(crate) const CHOOSE_POINT: Word = Word::new("Select a control point on the stage first.");
/// The heading of the buttons for the whole path.
pub(crate) const WHOLE_PATH: Word = Word::new("Whole path");
/// The button that turns the whole path to the left.
pub(crate) const TURN_LEFT: Word = Word::new("Left 15°");
/// The button that turns the whole path to the right.
pub(crate) const TURN_RIGHT: Word = Word::new("Right 15°");
/// The button that makes the whole path larger.
pub(crate) const LARGER_PATH: Word = Word::new("Larger");
/// The button that makes the whole path smaller.
pub(crate) const SMALLER_PATH: Word = Word::new("Smaller");
/// The button that mirrors the whole path.
pub(crate) const MIRROR: Word = Word::new("Mirror");
/// The button that straightens the whole path.
pub(crate) const STRAIGHTEN: Word = Word::new("Straighten");
/// The button that smooths the whole path.
pub(crate) const SMOOTH: Word = Word::new("Smooth");
/// The button that closes the path.
pub(crate) const CLOSE_LOOP: Word = Word::new("Close the loop");
/// The button that opens a closed path.
pub(crate) const OPEN_LOOP: Word = Word::new("Open the loop");
/// The button that snaps all points to the grid.
pub(crate) const SNAP_ALL: Word = Word::new("Snap all points");
/// The button that restores the fitted path.
pub(crate) const RESET_PATH: Word = Word::new("Reset path");
/// The hint of the button that restores the fitted path.
pub(crate) const RESET_PATH_HELP: Word =
    Word::new("Restores the fitted path; undo brings the edited one back");
/// The heading of the rows about the fit.
pub(crate) const FIT: Word = Word::new("Fit");
/// The button that compares numbers of control points.
pub(crate) const FOUR_EIGHT_SIXTEEN: Word = Word::new("4, 8, 16 points");
/// The comparison that [`FOUR_EIGHT_SIXTEEN`] opens.
pub(crate) const FOUR_EIGHT_SIXTEEN_QUERY: &str = "control_points:4,8,16";
/// The chip over a pane whose path turns harder than its motion can.
pub(crate) const TOO_HARD: Word = Word::new("turns too sharply");
/// The mark on the timeline where the path turns harder than the motion can.
pub(crate) const HARD_MOMENT: Word = Word::new("The path turns faster than the original");
/// The heading of the list of extra characters.
pub(crate) const COMPANY: Word = Word::new("Also on stage");
/// The button that keeps this character on the stage.
pub(crate) const JOIN: Word = Word::new("Add to stage");
/// The hint of the button that keeps this character on the stage.
pub(crate) const JOIN_HELP: Word =
    Word::new("Keeps this character on the stage, so that you can edit another path beside it");
/// The choice of preferring the current clip.
pub(crate) const THE_CLIP_THAT_PLAYS: Word = Word::new("the current one");
/// The first line of a menu of clips, before one is chosen.
pub(crate) const CHOOSE_CLIP: Word = Word::new("choose…");
/// The help below the list of extra characters.
pub(crate) const COMPANY_HELP: Word =
    Word::new("Each has its own path and colour; all play in sync. Links include them.");

/// Returns the accessible name of a control point.
pub(crate) fn control_point(index: usize, count: usize, place: glam::DVec2) -> Message {
    msg!(
        "Control point {number} of {count}: {x:.2} m, {z:.2} m",
        number = index + 1,
        count,
        x = place.x,
        z = place.y
    )
}

/// Returns the number and place of the chosen control point, and its keys.
pub(crate) fn chosen_point(index: usize, count: usize, place: glam::DVec2) -> Message {
    let [x, z] = [place.x, place.y].map(|metres| format!("{metres:.2}").replace('-', "−"));
    msg!(
        "Point {number} of {count} at x {x} m, z {z} m: arrow keys move it, Delete removes it.",
        number = index + 1,
        count,
        x,
        z
    )
}

/// Returns the description of the quantity that stays when a path changes its length.
pub(crate) fn path_keep(word: PathKeep) -> Word {
    Word::new(match word {
        PathKeep::Duration => {
            "Keeps the duration: a longer path is travelled faster, and feet may slide."
        }
        PathKeep::Whole => {
            "Keeps the speed and travels the whole path: a longer path takes longer, with longer strides."
        }
        PathKeep::Speed => {
            "Keeps speed and stride: the clip ends before a longer path does, and goes round a closed one."
        }
    })
}

/// Returns the length of a path, and of the fitted one where it was edited.
pub(crate) fn path_lengths(path: &PathFacts) -> Message {
    let (now, before) = (path.curve.length_m(), path.fitted.curve().length_m());
    if path.is_edited {
        msg!("{now:.2} m, was {before:.2} m", now, before)
    } else {
        msg!("{now:.2} m", now)
    }
}

/// Returns how well a path follows the hips.
pub(crate) fn fit_error(rms_cm: f64, most_cm: f64, along_m: f64) -> Message {
    msg!(
        "Distance from the hips to the path: {rms_cm:.1} cm (root mean square), at most {most_cm:.1} cm at {along_m:.1} m.",
        rms_cm,
        most_cm,
        along_m
    )
}

/// Says that an edited path does not change with the slider.
pub(crate) fn own_points(count: usize) -> Message {
    msg!(
        "The edited path keeps its {count} points; this number changes only the fitted path that it is compared with.",
        count
    )
}

/// Warns of a turn that is harder than the motion can follow.
pub(crate) fn hard_turn(turn: &HardTurn, fps: f64) -> Message {
    let secs = |frame: usize| frame as f64 / fps;
    msg!(
        "{from:.1}–{to:.1} s: the path turns at up to {dps:.0}°/s, the original clip at {limit:.0}°/s at most. Widen the bend or slow down.",
        from = secs(turn.frames.start),
        to = secs(turn.frames.end),
        dps = turn.turn_dps,
        limit = turn.limit_dps
    )
}

/// Returns the number of further turns that are too hard.
pub(crate) fn more_hard_turns(count: usize) -> Message {
    msg!(
        "{count, plural, one {One more bend is too sharp.} other {# more bends are too sharp.}}",
        count
    )
}

/// The note while the feet of a long motion are not locked yet.
pub(crate) const FEET_LATER: Word =
    Word::new("Long clip: the foot lock is applied when you stop dragging.");

/// Returns the name of the button that edits the path of an extra character.
pub(crate) fn edit_companion(name: Message) -> Message {
    msg!("Edit the path of {name}; it changes places with the current one", name)
}

/// Returns the name of the button that removes an extra character.
pub(crate) fn companion_leaves(name: Message) -> Message {
    msg!("Remove {name} from the stage", name)
}
