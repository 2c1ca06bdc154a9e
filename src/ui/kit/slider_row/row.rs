//! The description of a slider's row, and the user's input to it.

use crate::ui::language::{Text, Word};
use eframe::egui::{Color32, Response};
use std::ops::RangeInclusive;

/// The origin of a value.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum Source {
    /// The user, always.
    #[default]
    Manual,
    /// The user; after a reset, the app.
    ManualOverAuto,
    /// The app. Dragging takes the value over.
    Auto,
}

/// A mark on the track, such as the value of a neighbouring pane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Mark {
    /// Its place, in the unit of the value.
    pub(crate) value: f64,
    /// Its colour.
    pub(crate) color: Color32,
}

/// The description of a row.
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
    /// Returns a row for values of `range`, which must rise. One step is a hundredth of it until
    /// [`Self::step`] sets another.
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

    /// Sets another label.
    pub(crate) fn label(mut self, label: impl Into<Text<'a>>) -> Self {
        self.label = label.into();
        self
    }

    /// Sets the unit behind the number.
    pub(crate) fn unit(mut self, unit: Word) -> Self {
        self.unit = unit;
        self
    }

    /// Sets the same value in another unit, behind a dot: `0.50 s` after `30 frames`.
    pub(crate) fn secondary(mut self, secondary: &'a str) -> Self {
        self.secondary = secondary;
        self
    }

    /// Sets the help text.
    pub(crate) fn help(mut self, help: impl Into<Text<'a>>) -> Self {
        self.help = help.into();
        self
    }

    /// Sets the step of an arrow key; dragging also lands on multiples of it. The fine step (Shift)
    /// is a tenth.
    pub(crate) fn step(mut self, step: f64) -> Self {
        self.step = step;
        self.fine = step / 10.0;
        self
    }

    /// Allows whole numbers only: no decimals, and steps of one, also with Shift.
    pub(crate) fn whole(mut self) -> Self {
        self.step = 1.0;
        self.fine = 1.0;
        self.decimals = 0;
        self
    }

    /// Sets the number of digits after the point; two by default.
    pub(crate) fn decimals(mut self, decimals: usize) -> Self {
        self.decimals = decimals;
        self
    }

    /// Makes the track logarithmic. Both ends of the range must be positive.
    pub(crate) fn log(mut self) -> Self {
        self.log = *self.range.start() > 0.0 && *self.range.end() > 0.0;
        self
    }

    /// Sets the origin of the value.
    pub(crate) fn source(mut self, source: Source) -> Self {
        self.source = source;
        self
    }

    /// Sets the marks on the track.
    pub(crate) fn marks(mut self, marks: &'a [Mark]) -> Self {
        self.marks = marks;
        self
    }

    /// Returns the position of a value on the track, 0..=1.
    pub(super) fn position(&self, value: f64) -> f64 {
        let (low, high) = (*self.range.start(), *self.range.end());
        let position = if self.log {
            (value.max(low).ln() - low.ln()) / (high.ln() - low.ln())
        } else {
            (value - low) / (high - low)
        };
        if position.is_finite() { position.clamp(0.0, 1.0) } else { 0.0 }
    }

    /// Returns the value at a position on the track, on a multiple of `step`.
    pub(super) fn value_at(&self, position: f64, step: f64) -> f64 {
        let (low, high) = (*self.range.start(), *self.range.end());
        let position = position.clamp(0.0, 1.0);
        // The ends can be reached, whether or not they are multiples of the step.
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
        // A step that is large compared to the value of a logarithmic track would round it to zero.
        let step =
            if self.log { step.min(value.abs() / 50.0).max(f64::MIN_POSITIVE) } else { step };
        let value = if step > 0.0 { (value / step).round() * step } else { value };
        value.clamp(*self.range.start(), *self.range.end())
    }

    pub(super) fn written(&self, value: f64) -> String {
        format!("{value:.*}", self.decimals).replace('-', "−")
    }
}

/// The user's input to a [`SliderRow`].
#[derive(Debug)]
pub(crate) struct SliderResponse {
    /// The new value, if it differs from the shown one, in the row's range.
    pub(crate) changed: Option<f64>,
    /// The value was reset to the default, or to automatic. `changed` has the default as well.
    pub(crate) reset: bool,
    /// A drag began: the changes until [`Self::drag_ended`] are one step of undo.
    pub(crate) drag_started: bool,
    /// The drag ended.
    pub(crate) drag_ended: bool,
    /// The track.
    pub(crate) response: Response,
}
