//! The texts of the Match lab.

use crate::ui::language::Word;
use segue_motion::matching::{Block, Database, HoldReason, RATE, SearchReason, SearchRecord, Tag};
use segue_session::HandTag;
use segue_session::choices::Hysteresis;
use segue_text::{Message, msg};

/// The line about the Match lab.
pub(crate) const MATCH_ABOUT: Word = Word::new("Drives a character by motion matching.");
/// The help text of the Match lab.
pub(crate) const MATCH_DETAILS: Word = Word::new(
    "Drive with W A S D or the arrows, Shift to run, Q to strafe. Several times a second, all clips are searched for the best-matching frame.",
);
/// The reason why a live drive is not saved.
pub(crate) const LIVE_NOT_SAVED: Word = Word::new("Press Replay to save the drive as a file.");
/// The hint over the stage in the Match lab.
pub(crate) const MATCH_HINT: Word = Word::new(
    "Drive with W A S D or the arrows, Shift to run, or the stick. Orange: the requested trajectory. Blue: the trajectory of the current frame.",
);
/// The title of a pane whose character the user drives.
pub(crate) const LIVE: Word = Word::new("Yours");
/// The accessible name of the stick on the screen.
pub(crate) const STICK: Word = Word::new("Stick: drive the character");
/// The button beside the stick that makes it run.
pub(crate) const RUN: Word = Word::new("Run");
/// The hint of the button beside the stick.
pub(crate) const RUN_HELP: Word = Word::new("The stick runs instead of walking");
/// The heading of the section on the current frame.
pub(crate) const WHY: Word = Word::new("Why this frame");
/// The note before there was a search.
pub(crate) const NO_SEARCH: Word = Word::new("No search yet.");
/// The help below the candidates.
pub(crate) const GHOST_HELP: Word =
    Word::new("Point at a frame to show it as a ghost; click to keep it.");
/// The heading of the weights of features.
pub(crate) const WEIGHTS: Word = Word::new("Feature weights");
/// The heading of the hysteresis.
pub(crate) const HYSTERESIS: Word = Word::new("Hysteresis");
/// The title of the section on the search.
pub(crate) const SEARCHING: Word = Word::new("Search and tags");
/// The title of the section on transitions and the trajectory.
pub(crate) const GOING_OVER: Word = Word::new("Transition and trajectory");
/// The title of the section on clips and characters.
pub(crate) const MATCH_CLIPS: Word = Word::new("Clips and characters");
/// The button that replays the input.
pub(crate) const REPLAY: Word = Word::new("Replay");
/// The hint of the button that replays the input.
pub(crate) const REPLAY_HELP: Word =
    Word::new("Replays the same input exactly, from the start; the link then includes it");
/// The button that starts over.
pub(crate) const START_OVER: Word = Word::new("Start over");
/// The hint of the button that starts over.
pub(crate) const START_OVER_HELP: Word =
    Word::new("Returns to the origin and clears the recorded input");
/// The button by which the user takes control.
pub(crate) const DRIVE_YOURSELF: Word = Word::new("Take control");
/// The note while recorded input plays.
pub(crate) const RECORDED: Word =
    Word::new("Recorded input, the same for everyone. Change the weights and compare the results.");
/// The button that compares kinds of hysteresis.
pub(crate) const HYSTERESES: Word = Word::new("Compare hysteresis: none, bias, votes");
/// The comparison that [`HYSTERESES`] opens.
pub(crate) const HYSTERESES_QUERY: &str = "hysteresis:none,bias,votes";
/// The note about the clips, while none are chosen.
pub(crate) const MADE_SET: Word =
    Word::new("The synthesised set: standing, walks and runs, turns, starts, stops and spins.");
/// The note on the feet by which poses are compared.
pub(crate) const HIND_FEET_ALONE: Word =
    Word::new("This body stands on four legs: poses are compared by its hind feet.");
/// The accessible name of the strip of clips.
pub(crate) const CLIP_STRIP: Word = Word::new("All clips, with the current frame");
/// The words before the name of a clip below that strip.
pub(crate) const CLIP_STRIP_TITLE: Word = Word::new("All clips, by tag:");
/// The note in the place of the curves of costs, until there is one.
pub(crate) const COSTS_LATER: Word =
    Word::new("Drive the character: each search adds its costs here.");
/// The title of the curves of costs.
pub(crate) const COST: Word = Word::new("cost");
/// The name of the curve of the cost of continuing.
pub(crate) const COST_GOING_ON: Word = Word::new("continuing");
/// The name of the curve of the cost of the best frame.
pub(crate) const COST_BEST: Word = Word::new("best frame");
/// The mark on the timeline where the character jumps to another frame.
pub(crate) const JUMP: Word = Word::new("Jump to another frame");

/// Returns the name of a block of features.
pub(crate) const fn block(block: Block) -> Word {
    Word::new(match block {
        Block::TrajectoryPosition => "path ahead",
        Block::TrajectoryDirection => "facing ahead",
        Block::FootPosition => "foot position",
        Block::FootVelocity => "foot velocity",
        Block::HipVelocity => "hip velocity",
    })
}

/// Returns a frame by its clip and time.
pub(crate) fn frame_of_clip(name: Message, mirrored: bool, secs: f64) -> Message {
    if mirrored {
        msg!("{name}, mirrored · {secs:.2} s", name, secs)
    } else {
        msg!("{name} · {secs:.2} s", name, secs)
    }
}

/// Returns the label of the frame that played when the search was made.
pub(crate) fn going_on(place: Message) -> Message {
    msg!("Continuing: {place}", place)
}

/// Returns the length of the recording.
pub(crate) fn driven_for(secs: f64) -> Message {
    let whole = secs.max(0.0) as u64;
    msg!("Recorded so far: {minutes}:{secs:02}.", minutes = whole / 60, secs = whole % 60)
}

/// Returns the description of a kind of hysteresis.
pub(crate) fn hysteresis(word: Hysteresis) -> Word {
    Word::new(match word {
        Hysteresis::None => "Always takes the best frame, however small the gain: many jumps.",
        Hysteresis::Time => "Waits a minimum time after each jump.",
        Hysteresis::Votes => "Jumps when three searches in a row find a better frame.",
        Hysteresis::ClipVotes => {
            "Jumps to another clip when three searches in a row find a better frame there; within a clip it jumps at once."
        }
        Hysteresis::Bias => "Favours continuing the current clip.",
    })
}

/// Returns the outcome of a search: a jump, or the reason why there was none.
fn held(held: Option<HoldReason>) -> Word {
    Word::new(match held {
        None => "jumped to the best match",
        Some(HoldReason::Same) => "stayed: already at the best match",
        Some(HoldReason::Bias) => "stayed: improvement below the bias",
        Some(HoldReason::MinimumTime) => "stayed: too soon after the last jump",
        Some(HoldReason::Votes) => "stayed: fewer than 3 votes in a row",
        Some(HoldReason::CurrentClip) => "stayed in its clip: constant input",
        Some(HoldReason::Nothing) => "stayed: no frame has the requested tags",
    })
}

/// Returns the outcome of a search, in a few words.
pub(crate) fn outcome_of_search(search: &SearchRecord, is_live: bool) -> Message {
    let what = held(search.held);
    if is_live { msg!("live · {what}", what) } else { what.into() }
}

/// Returns the reason, the outcome and the cost of a search.
pub(crate) fn searched(search: &SearchRecord, frames: usize) -> Message {
    let why = match search.reason {
        SearchReason::Interval => "Regular search",
        SearchReason::ClipEnd => "Search at the end of a clip",
        SearchReason::InputChange => "Search at a change of input",
    };
    msg!(
        "{why}: {what}. Compared {visited} of {frames} frames.",
        why,
        what = held(search.held),
        visited = search.visited,
        frames
    )
}

/// Returns the size of a database.
pub(crate) fn database(database: &Database) -> Message {
    msg!(
        "{motions} motions, {frames} frames ({minutes:.1} min), {valid} of them searchable.",
        motions = database.motions().len(),
        frames = database.frames(),
        minutes = database.frames() as f64 / (60 * RATE) as f64,
        valid = database.valid().len()
    )
}

/// Returns the name of the button that removes a clip.
pub(crate) fn leave_clip_out(name: Message) -> Message {
    msg!("Remove {name}", name)
}

/// Returns a tag that was set or removed by hand.
pub(crate) fn hand_tag(clip: Message, tag: &HandTag) -> Message {
    let [from, to] = tag.secs;
    let word = tag_name(&tag.word);
    if tag.takes_away {
        msg!("{clip}, {from:.2} to {to:.2} s: not {word}", clip, from, to, word)
    } else {
        msg!("{clip}, {from:.2} to {to:.2} s: {word}", clip, from, to, word)
    }
}

/// Returns the name of a tag on screen: one of Segue's, or a word of the user's own.
pub(crate) fn tag_name(word: &str) -> Message {
    let fixed = Tag::FIXED.into_iter().find(|tag| tag.name() == word);
    fixed.map_or_else(|| Message::data(word), |tag| tag.name().into())
}

/// Returns the name of the button that sets a tag on the chosen stretch, or removes it there.
pub(crate) fn tag_as(word: &str, takes_away: bool) -> Message {
    let word = tag_name(word);
    if takes_away { msg!("Not {word}", word) } else { msg!("Tag as {word}", word) }
}
