//! The texts of the Match lab.

use segue_motion::matching::{Block, Database, HoldReason, RATE, SearchReason, SearchRecord, Tag};
use segue_session::HandTag;
use segue_session::choices::Hysteresis;
use segue_text::{Message, msg};

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
pub(crate) fn frame_of_clip(name: Message, mirrored: bool, secs: f64) -> Message {
    if mirrored {
        msg!("{name}, mirrored · {secs:.2} s", name, secs)
    } else {
        msg!("{name} · {secs:.2} s", name, secs)
    }
}

/// The frame that played when the search was made.
pub(crate) fn going_on(place: Message) -> Message {
    msg!("Going on: {place}", place)
}

/// How long was driven.
pub(crate) fn driven_for(secs: f64) -> Message {
    let whole = secs.max(0.0) as u64;
    msg!("Recorded so far: {minutes}:{secs:02}.", minutes = whole / 60, secs = whole % 60)
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
pub(crate) fn outcome_of_search(search: &SearchRecord, is_live: bool) -> Message {
    let what = held(search.held);
    if is_live { msg!("live · {what}", what) } else { what.into() }
}

/// What a search came to, and what it took.
pub(crate) fn searched(search: &SearchRecord, frames: usize) -> Message {
    let why = match search.reason {
        SearchReason::Interval => "It was time to search",
        SearchReason::ClipEnd => "The clip came to its end",
        SearchReason::InputChange => "The input changed",
    };
    msg!(
        "{why}; {what}. {visited} of {frames} frames were looked at.",
        why,
        what = held(search.held),
        visited = search.visited,
        frames
    )
}

/// How large a database is.
pub(crate) fn database(database: &Database) -> Message {
    msg!(
        "{motions} motions, {frames} frames ({minutes:.1} min), {valid} of them can be gone to.",
        motions = database.motions().len(),
        frames = database.frames(),
        minutes = database.frames() as f64 / (60 * RATE) as f64,
        valid = database.valid().len()
    )
}

/// The name of a button.
pub(crate) fn leave_clip_out(name: Message) -> Message {
    msg!("Leave {name} out", name)
}

/// A tag that was set by hand, or taken away.
pub(crate) fn hand_tag(clip: Message, tag: &HandTag) -> Message {
    let [from, to] = tag.secs;
    let word = tag_name(&tag.word);
    if tag.takes_away {
        msg!("{clip}, {from:.2} to {to:.2} s: no longer {word}", clip, from, to, word)
    } else {
        msg!("{clip}, {from:.2} to {to:.2} s: {word}", clip, from, to, word)
    }
}

/// Returns a tag as it is said on screen: one of Segue's, or a word of the user's own.
pub(crate) fn tag_name(word: &str) -> Message {
    let fixed = Tag::FIXED.into_iter().find(|tag| tag.name() == word);
    fixed.map_or_else(|| Message::data(word), |tag| tag.name().into())
}

/// The button that puts a tag on the chosen stretch, or takes it away from there.
pub(crate) fn tag_as(word: &str, takes_away: bool) -> Message {
    let word = tag_name(word);
    if takes_away { msg!("Not {word}", word) } else { msg!("Tag as {word}", word) }
}
