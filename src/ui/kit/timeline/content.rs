//! The content of a timeline, and the user's input to it.

use super::super::chip::Part;
use super::super::curves::Curves;
use crate::ui::language::{Text, Word};
use eframe::egui::{Color32, Rect};
use segue_motion::clip::StanceEnd;
use segue_text::Message;
use std::ops::Range;

/// A clip on the timeline.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Track<'a> {
    /// Its part in the result, which gives the bar its colour.
    pub(crate) part: Part,
    /// The label before the bar: `A`. Hidden where there is no room.
    pub(crate) label: Text<'a>,
    /// The name inside the bar.
    pub(crate) name: Text<'a>,
    /// When it begins, in seconds.
    pub(crate) start: f64,
    /// When it ends, in seconds.
    pub(crate) end: f64,
    /// The length of its fade in, in seconds.
    pub(crate) fade_in: f64,
    /// The length of its fade out, in seconds.
    pub(crate) fade_out: f64,
}

/// The stances of a motion: those of the left foot in the upper line, of the right foot in the
/// lower.
#[derive(Clone, Debug, Default)]
pub(crate) struct Stripe<'a> {
    /// The part of the motion, which gives the colour.
    pub(crate) part: Part,
    /// The label before them.
    pub(crate) label: Text<'a>,
    /// The stances of each foot, seconds: left, right; of a body on four legs those of the hind
    /// feet, then those of the forefeet.
    pub(crate) feet: Vec<Vec<Range<f64>>>,
    /// The correction of the stances; `None` where they can only be seen.
    pub(crate) edit: Option<StanceEdit>,
}

/// The correction of stances by hand.
#[derive(Clone, Debug, Default)]
pub(crate) struct StanceEdit {
    /// The parts of each foot that are corrected, seconds.
    pub(crate) corrected: Vec<Vec<Range<f64>>>,
    /// A sentence about the corrections; `None` without any.
    pub(crate) hint: Option<Message>,
}

impl StanceEdit {
    /// Returns whether anything is corrected.
    pub(crate) fn is_corrected(&self) -> bool {
        self.corrected.iter().any(|parts| !parts.is_empty())
    }
}

/// A moment with a mark, such as the beginning of a cycle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Moment {
    /// Its time, in seconds.
    pub(crate) time: f64,
    /// Its colour.
    pub(crate) color: Color32,
    /// Its name.
    pub(crate) name: Word,
}

/// The content of a timeline.
#[derive(Clone, Debug, Default)]
pub(crate) struct Timeline<'a> {
    /// The whole length, in seconds.
    pub(crate) duration: f64,
    /// The playhead, in seconds.
    pub(crate) now: f64,
    /// Frames per second, by which arrow keys step. 0: they step by a hundredth of the whole.
    pub(crate) fps: f64,
    /// The clips, from top to bottom.
    pub(crate) tracks: &'a [Track<'a>],
    /// The stances, below the clips, from top to bottom.
    pub(crate) stripes: &'a [Stripe<'a>],
    /// When the transition begins and ends, in seconds.
    pub(crate) transition: Option<Range<f64>>,
    /// Whether its edges can be dragged.
    pub(crate) transition_editable: bool,
    /// The start of a loop, in seconds.
    pub(crate) in_point: Option<f64>,
    /// The end of a loop, in seconds.
    pub(crate) out_point: Option<f64>,
    /// The marks above the bars.
    pub(crate) moments: &'a [Moment],
    /// The curves below the bars, a plot for each quantity; none for bars alone.
    pub(crate) curves: &'a [Curves<'a>],
}

/// A correction of stances. Feet and stances are given by their numbers; times are in seconds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum StanceEvent {
    /// Move an end of a stance.
    Move {
        /// The foot.
        foot: usize,
        /// The stance.
        stance: usize,
        /// The end.
        end: StanceEnd,
        /// Its new time.
        time: f64,
    },
    /// Add a stance.
    Add {
        /// The foot.
        foot: usize,
        /// The middle of the stance.
        time: f64,
    },
    /// Remove a stance.
    Remove {
        /// The foot.
        foot: usize,
        /// The stance.
        stance: usize,
    },
    /// Take back all corrections.
    Reset,
}

/// The user's input to a timeline, and the places of its bars.
#[derive(Clone, Debug, Default)]
pub(crate) struct TimelineResponse {
    /// The input, in its order.
    pub(crate) events: Vec<TimelineEvent>,
    /// The bar of each track, points.
    pub(crate) bars: Vec<Rect>,
}

/// The user's input to a timeline. Times are in seconds, within the timeline.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum TimelineEvent {
    /// Move the playhead.
    Seek(f64),
    /// The playhead was taken hold of: playback pauses while it is held.
    ScrubStarted,
    /// The playhead was released.
    ScrubEnded,
    /// Move the start of the loop.
    SetIn(f64),
    /// Move the end of the loop.
    SetOut(f64),
    /// Move the start of the transition.
    SetTransitionStart(f64),
    /// Move the end of the transition.
    SetTransitionEnd(f64),
    /// Correct the stances of a stripe, by its number.
    Stance {
        /// The stripe's number.
        stripe: usize,
        /// The correction.
        event: StanceEvent,
    },
    /// A handle was taken hold of: the changes until it is released are one step of undo.
    EditStarted,
    /// The handle was released.
    EditEnded,
}
