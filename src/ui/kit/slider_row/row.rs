//! A slider's row as it is described, and what was done to it.

use crate::ui::language::{Text, Word};
use eframe::egui::{Color32, Response};
use std::ops::RangeInclusive;

/// Who decides the value.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum Source {
    /// Always the user.
    #[default]
    Manual,
    /// The user now; the app could be asked to (a reset asks it).
    ManualOverAuto,
    /// The app found the value. Dragging takes it over.
    Auto,
}

/// A small mark on the track, such as the value of a neighbouring pane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Mark {
    /// Where, in the unit of the value.
    pub(crate) value: f64,
    /// In which colour.
    pub(crate) color: Color32,
}

/// A parameter as the row shows it.
#[derive(Clone, Debug)]
pub(crate) struct SliderRow<'a> {
    pub(super) label: Text<'a>,
    pub(super) unit: Word,
    pub(super) secondary: &'a str,
    pub(super) help: Text<'a>,
    pub(super) range: RangeInclusive<f64>,
    pub(super) step: f64,
    pub(super) fine: f64,
    pub(super) default: f64,
    pub(super) decimals: usize,
    pub(super) log: bool,
    pub(super) source: Source,
    pub(super) marks: &'a [Mark],
}

impl<'a> SliderRow<'a> {
    /// A row for values of `range`, which must rise. One step is a hundredth of it until
    /// [`Self::step`] says otherwise.
    pub(crate) fn new(
        label: impl Into<Text<'a>>,
        range: RangeInclusive<f64>,
        default: f64,
    ) -> Self {
        let step = (range.end() - range.start()).abs() / 100.0;
        Self {
            label: label.into(),
            unit: Word::default(),
            secondary: "",
            help: Text::EMPTY,
            range,
            step,
            fine: step / 10.0,
            default,
            decimals: 2,
            log: false,
            source: Source::Manual,
            marks: &[],
        }
    }

    /// The same row with another label.
    pub(crate) fn label(mut self, label: impl Into<Text<'a>>) -> Self {
        self.label = label.into();
        self
    }

    /// The unit behind the number, in the quiet colour.
    pub(crate) fn unit(mut self, unit: Word) -> Self {
        self.unit = unit;
        self
    }

    /// The same value said in another way, behind a dot: `0.50 s` after `30 frames`.
    pub(crate) fn secondary(mut self, secondary: &'a str) -> Self {
        self.secondary = secondary;
        self
    }

    /// One sentence below the track.
    pub(crate) fn help(mut self, help: impl Into<Text<'a>>) -> Self {
        self.help = help.into();
        self
    }

    /// How much an arrow key changes the value; dragging lands on multiples of it too. The fine
    /// step (shift) is a tenth.
    pub(crate) fn step(mut self, step: f64) -> Self {
        self.step = step;
        self.fine = step / 10.0;
        self
    }

    /// Only whole numbers: no decimals, steps of one, shift included.
    pub(crate) fn whole(mut self) -> Self {
        self.step = 1.0;
        self.fine = 1.0;
        self.decimals = 0;
        self
    }

    /// How many digits stand after the point. Two until said.
    pub(crate) fn decimals(mut self, decimals: usize) -> Self {
        self.decimals = decimals;
        self
    }

    /// Every tenfold takes the same length of track. Both ends of the range must be positive.
    pub(crate) fn log(mut self) -> Self {
        self.log = *self.range.start() > 0.0 && *self.range.end() > 0.0;
        self
    }

    /// Who decides the value now.
    pub(crate) fn source(mut self, source: Source) -> Self {
        self.source = source;
        self
    }

    /// Marks on the track.
    pub(crate) fn marks(mut self, marks: &'a [Mark]) -> Self {
        self.marks = marks;
        self
    }

    /// Where on the track a value lies, 0..=1.
    pub(super) fn position(&self, value: f64) -> f64 {
        let (low, high) = (*self.range.start(), *self.range.end());
        let position = if self.log {
            (value.max(low).ln() - low.ln()) / (high.ln() - low.ln())
        } else {
            (value - low) / (high - low)
        };
        if position.is_finite() { position.clamp(0.0, 1.0) } else { 0.0 }
    }

    /// The value at a position on the track, on a multiple of `step`.
    pub(super) fn value_at(&self, position: f64, step: f64) -> f64 {
        let (low, high) = (*self.range.start(), *self.range.end());
        let position = position.clamp(0.0, 1.0);
        // The ends are the ends, whether or not they are multiples of the step.
        if position <= 0.0 {
            return low;
        }
        if position >= 1.0 {
            return high;
        }
        let value = if self.log {
            (low.ln() + position * (high.ln() - low.ln())).exp()
        } else {
            low + position * (high - low)
        };
        self.snapped(value, step)
    }

    pub(super) fn snapped(&self, value: f64, step: f64) -> f64 {
        // Where the steps of a logarithmic track are wide compared to the value they would swallow
        // it.
        let step =
            if self.log { step.min(value.abs() / 50.0).max(f64::MIN_POSITIVE) } else { step };
        let value = if step > 0.0 { (value / step).round() * step } else { value };
        value.clamp(*self.range.start(), *self.range.end())
    }

    pub(super) fn written(&self, value: f64) -> String {
        format!("{value:.*}", self.decimals).replace('-', "−")
    }
}

/// What was done to a [`SliderRow`].
#[derive(Debug)]
pub(crate) struct SliderResponse {
    /// The value asked for, if it differs from the one shown. In the row's range.
    pub(crate) changed: Option<f64>,
    /// The default was asked for; for a value the app can find, that it find it. `changed` has the
    /// default as well.
    pub(crate) reset: bool,
    /// A drag began: what follows until [`Self::drag_ended`] is one thing to undo.
    pub(crate) drag_started: bool,
    /// The drag is over.
    pub(crate) drag_ended: bool,
    /// The track.
    pub(crate) response: Response,
}
