//! What a timeline shows, and what can be asked of it.

use super::super::chip::Part;
use super::super::curves::Curves;
use crate::ui::language::{Text, Word};
use eframe::egui::Color32;
use std::ops::Range;

/// A clip on the timeline.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Track<'a> {
    /// Which part it plays: gives the bar its colour.
    pub(crate) part: Part,
    /// What stands before the bar: `A walk`. Hidden where there is no room.
    pub(crate) label: Text<'a>,
    /// What stands inside the bar.
    pub(crate) name: Text<'a>,
    /// When it begins and ends, in seconds.
    pub(crate) start: f64,
    /// When it ends, in seconds.
    pub(crate) end: f64,
    /// How long it takes to appear, in seconds.
    pub(crate) fade_in: f64,
    /// How long it takes to vanish, in seconds.
    pub(crate) fade_out: f64,
}

/// When the feet of a motion stand: the left one in the upper line, the right one in the lower.
#[derive(Clone, Debug, Default)]
pub(crate) struct Stripe<'a> {
    /// Whose feet: gives the colour.
    pub(crate) part: Part,
    /// What stands before them.
    pub(crate) label: Text<'a>,
    /// From and to, seconds: left, right.
    pub(crate) feet: [Vec<Range<f64>>; 2],
}

/// A moment with a mark: where a foot is planted, or a cycle begins.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Moment {
    /// When, in seconds.
    pub(crate) time: f64,
    /// Its colour.
    pub(crate) color: Color32,
    /// What it is.
    pub(crate) name: Word,
}

/// All that the timeline shows.
#[derive(Clone, Debug, Default)]
pub(crate) struct Timeline<'a> {
    /// The length of it all, in seconds.
    pub(crate) duration: f64,
    /// Where the playhead stands, in seconds.
    pub(crate) now: f64,
    /// Frames per second: arrow keys step by one frame. 0: by a hundredth of the whole.
    pub(crate) fps: f64,
    /// The clips, from top to bottom.
    pub(crate) tracks: &'a [Track<'a>],
    /// When feet stand, below the clips, from top to bottom.
    pub(crate) stripes: &'a [Stripe<'a>],
    /// When the transition begins and ends, in seconds.
    pub(crate) transition: Option<Range<f64>>,
    /// Its edges can be dragged.
    pub(crate) transition_editable: bool,
    /// Where a loop begins, in seconds.
    pub(crate) in_point: Option<f64>,
    /// Where it ends, in seconds.
    pub(crate) out_point: Option<f64>,
    /// Marks above the bars.
    pub(crate) moments: &'a [Moment],
    /// The curves below the bars; none: bars only.
    pub(crate) curves: Option<Curves<'a>>,
}

/// What was asked of the timeline. Times are in seconds, within the timeline.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum TimelineEvent {
    /// Show this moment.
    Seek(f64),
    /// The playhead was taken hold of: pause while it is held.
    ScrubStarted,
    /// It was let go.
    ScrubEnded,
    /// Let the loop begin here.
    SetIn(f64),
    /// Let the loop end here.
    SetOut(f64),
    /// Let the transition begin here.
    SetTransitionStart(f64),
    /// Let the transition end here.
    SetTransitionEnd(f64),
    /// A handle was taken hold of: what follows until it is let go is one thing to undo.
    EditStarted,
    /// The handle was let go.
    EditEnded,
}
