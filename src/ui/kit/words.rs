//! The few words that the kit itself says. Everything else is handed in by the panels, in the
//! language of the app.

use eframe::egui::{Context, Id, Ui};

/// What the kit's widgets say by themselves: states, accessible names and hints.
#[derive(Debug, PartialEq, Eq)]
pub(crate) struct Words {
    /// A switch that is on.
    pub(crate) on: &'static str,
    /// A switch that is off.
    pub(crate) off: &'static str,
    /// A value that the app chooses.
    pub(crate) auto: &'static str,
    /// The best of several.
    pub(crate) best: &'static str,
    /// The worst of several.
    pub(crate) worst: &'static str,
    /// Start time running.
    pub(crate) play: &'static str,
    /// Stop time.
    pub(crate) pause: &'static str,
    /// One frame back.
    pub(crate) step_back: &'static str,
    /// One frame on.
    pub(crate) step_forward: &'static str,
    /// Start again at the end.
    pub(crate) repeat: &'static str,
    /// How fast time runs.
    pub(crate) speed: &'static str,
    /// Before the frame's number.
    pub(crate) frame: &'static str,
    /// The strip that one scrubs along.
    pub(crate) timeline: &'static str,
    /// The handle where the loop begins.
    pub(crate) in_point: &'static str,
    /// The handle where the loop ends.
    pub(crate) out_point: &'static str,
    /// The edge where the transition begins.
    pub(crate) transition_start: &'static str,
    /// The edge where the transition ends.
    pub(crate) transition_end: &'static str,
    /// Take a notice away.
    pub(crate) dismiss: &'static str,
    /// Stop a task.
    pub(crate) cancel: &'static str,
    /// Hint on a slider's value.
    pub(crate) type_value: &'static str,
    /// Hint on a slider's label.
    pub(crate) reset_hint: &'static str,
}

/// The kit's words in English.
pub(crate) static ENGLISH: Words = Words {
    on: "on",
    off: "off",
    auto: "auto",
    best: "best",
    worst: "worst",
    play: "Play",
    pause: "Pause",
    step_back: "One frame back",
    step_forward: "One frame forward",
    repeat: "Repeat",
    speed: "Speed",
    frame: "frame",
    timeline: "Timeline",
    in_point: "Loop start",
    out_point: "Loop end",
    transition_start: "Transition start",
    transition_end: "Transition end",
    dismiss: "Dismiss",
    cancel: "Cancel",
    type_value: "Click to type a value",
    reset_hint: "Double-click to reset",
};

fn words_id() -> Id {
    Id::unique("segue kit words")
}

impl Words {
    /// From now on, the widgets of this context speak these words.
    pub(crate) fn install(&'static self, ctx: &Context) {
        ctx.data_mut(|data| data.insert_temp::<&'static Self>(words_id(), self));
    }

    /// The words of this context; English where none were installed.
    pub(crate) fn of(ui: &Ui) -> &'static Self {
        ui.ctx().data(|data| data.get_temp::<&'static Self>(words_id())).unwrap_or(&ENGLISH)
    }
}
