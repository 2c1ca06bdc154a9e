//! The part of a result that plays.

/// The part of a result that plays.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Span {
    /// The beginning, seconds.
    pub start: f64,
    /// The end, seconds; not before `start`.
    pub end: f64,
}

impl Span {
    /// Returns the part of `[0, duration]` between two marks. A mark that is missing or outside is
    /// replaced by the end of the result; marks in the wrong order are swapped.
    #[must_use]
    pub fn between(in_mark: Option<f64>, out_mark: Option<f64>, duration: f64) -> Self {
        let start = in_mark.unwrap_or(0.0).clamp(0.0, duration);
        let end = out_mark.unwrap_or(duration).clamp(0.0, duration);
        Self { start: start.min(end), end: start.max(end) }
    }

    /// Returns the playhead after `dt_secs` of playing at `rate`, and whether it still moves.
    ///
    /// A playhead outside the span enters at the start. With `repeat` it wraps around; otherwise it
    /// stops at the end.
    #[must_use]
    pub fn advance(&self, now: f64, dt_secs: f64, rate: f64, repeat: bool) -> (f64, bool) {
        let length = self.end - self.start;
        if length <= 0.0 {
            return (self.start, false);
        }
        let now = if (self.start..=self.end).contains(&now) { now } else { self.start };
        let next = now + dt_secs * rate;
        if next <= self.end {
            (next, true)
        } else if repeat {
            (self.start + (next - self.start).rem_euclid(length), true)
        } else {
            (self.end, false)
        }
    }

    /// Returns how many times a repeating playhead, as in [`Span::advance`], reaches the end.
    #[must_use]
    pub fn wraps(&self, now: f64, dt_secs: f64, rate: f64) -> usize {
        let length = self.end - self.start;
        let inside = (self.start..=self.end).contains(&now);
        let next = (if inside { now } else { self.start }) + dt_secs * rate;
        if length > 0.0 && next > self.end {
            ((next - self.start) / length).floor() as usize
        } else {
            0
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn advance_at_the_end_wraps_or_stops() {
        let span = Span::between(Some(1.0), None, 3.0);
        assert_eq!(span.advance(0.0, 0.1, 1.0, true), (1.1, true));
        assert_eq!(span.advance(2.5, 1.0, 1.0, true), (1.5, true));
        assert_eq!(span.advance(2.5, 1.0, 1.0, false), (3.0, false));
        assert_eq!(span.advance(2.0, 0.5, 0.5, false), (2.25, true));
        assert_eq!(Span::between(None, None, 0.0).advance(0.0, 1.0, 1.0, true), (0.0, false));
        let wraps = [(2.5, 0.25), (2.5, 1.0), (2.5, 4.75), (0.0, 0.5), (0.0, 2.5)]
            .map(|(now, dt)| span.wraps(now, dt, 1.0));
        assert_eq!(wraps, [0, 1, 3, 0, 1]);
        assert_eq!(Span::between(None, None, 0.0).wraps(0.0, 1.0, 1.0), 0);
    }

    #[test]
    fn between_with_marks_in_the_wrong_order_swaps_them() {
        assert_eq!(Span::between(Some(2.0), Some(1.0), 3.0), Span { start: 1.0, end: 2.0 });
        assert_eq!(Span::between(Some(9.0), None, 3.0), Span { start: 3.0, end: 3.0 });
    }
}
