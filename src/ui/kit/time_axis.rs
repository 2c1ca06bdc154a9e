//! The axis of time on the screen, and round steps between labels.

use eframe::egui::{Rangef, Rect, Response};

/// The axis of time on the screen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct TimeAxis {
    /// The range of x that stands for the whole duration.
    pub(crate) x: Rangef,
    /// The duration, in seconds.
    pub(crate) duration: f64,
}

impl TimeAxis {
    /// Returns the place of a time.
    pub(crate) fn x_of(&self, time: f64) -> f32 {
        let t = if self.duration > 0.0 { time / self.duration } else { 0.0 };
        self.x.min + t as f32 * self.x.span()
    }

    /// Returns the time at a place, within the duration.
    pub(crate) fn time_at(&self, x: f32) -> f64 {
        let t = f64::from((x - self.x.min) / self.x.span().max(1.0));
        (t * self.duration).clamp(0.0, self.duration.max(0.0))
    }
}

/// Returns the time under the pointer; `None` where it is not over the plot.
pub(super) fn hovered_time(axis: TimeAxis, plot: Rect, response: &Response) -> Option<f64> {
    response.hover_pos().filter(|pos| plot.contains(*pos)).map(|pos| axis.time_at(pos.x))
}

/// Returns the step of 1, 2 or 5 times a power of ten that divides `span` into at most `most`
/// pieces.
pub(super) fn nice_step(span: f64, most: f64) -> f64 {
    let rough = span / most.max(1.0);
    if !(rough.is_finite() && rough > 0.0) {
        return 1.0;
    }
    let power = 10.0_f64.powf(rough.log10().floor());
    [1.0, 2.0, 5.0, 10.0]
        .into_iter()
        .map(|factor| factor * power)
        .find(|&step| step >= rough * (1.0 - 1e-9))
        .unwrap_or(10.0 * power)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_and_times_are_inverse_and_stay_inside() {
        let axis = TimeAxis { x: Rangef::new(100.0, 500.0), duration: 8.0 };
        assert_eq!(axis.x_of(2.0), 200.0);
        assert_eq!(axis.time_at(200.0), 2.0);
        assert_eq!(axis.time_at(-50.0), 0.0);
        assert_eq!(axis.time_at(900.0), 8.0);
        let empty = TimeAxis { x: Rangef::new(100.0, 500.0), duration: 0.0 };
        assert_eq!((empty.x_of(3.0), empty.time_at(300.0)), (100.0, 0.0));
    }

    #[test]
    fn steps_are_round_and_few() {
        assert_eq!(nice_step(10.0, 10.0), 1.0);
        assert_eq!(nice_step(3.9, 10.0), 0.5);
        assert_eq!(nice_step(61.0, 8.0), 10.0);
        assert_eq!(nice_step(0.0, 8.0), 1.0);
        for span in [0.3, 1.7, 9.9, 128.0] {
            let step = nice_step(span, 8.0);
            assert!(
                span / step <= 8.0 + 1e-9 && span / step > 8.0 / 5.1,
                "{span} in steps of {step}"
            );
        }
    }
}
