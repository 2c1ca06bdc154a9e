//! Statistics of the processor time of frames.

/// The number of recent frames that are kept: four seconds at 60 Hz.
const MAX_RECENT: usize = 240;

/// The processor time of recent frames in milliseconds, without the wait for the screen.
#[derive(Clone, Debug, Default)]
pub(crate) struct FrameStats {
    count: u64,
    recent: Vec<FrameDuration>,
}

/// The durations of one frame, milliseconds.
#[derive(Clone, Copy, Debug)]
struct FrameDuration {
    /// Input, panels and scene.
    update_ms: f32,
    /// Input, panels, scene, and the commands for the graphics device.
    total_ms: f32,
}

/// A summary of recent frames, milliseconds.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize)]
pub(crate) struct FrameTimes {
    /// The median.
    pub(crate) p50: f32,
    /// The 95th percentile.
    pub(crate) p95: f32,
    /// The maximum.
    pub(crate) max: f32,
}

impl FrameStats {
    /// Counts a frame at the beginning of its drawing.
    pub(crate) fn begin(&mut self) {
        self.count += 1;
    }

    /// Records the durations of a frame: `update_ms` for input, panels and scene, `total_ms` with
    /// the commands for the graphics device.
    pub(crate) fn record(&mut self, update_ms: f32, total_ms: f32) {
        if self.recent.len() >= MAX_RECENT {
            self.recent.remove(0);
        }
        self.recent.push(FrameDuration { update_ms, total_ms });
    }

    /// Returns the number of frames drawn since the start.
    pub(crate) fn count(&self) -> u64 {
        self.count
    }

    /// Returns a summary of the time for input, panels and scene; zeros before the first frame.
    pub(crate) fn update_times(&self) -> FrameTimes {
        self.summary(|duration| duration.update_ms)
    }

    /// Returns a summary of the time for whole frames, with the commands for the graphics device.
    pub(crate) fn total_times(&self) -> FrameTimes {
        self.summary(|duration| duration.total_ms)
    }

    fn summary(&self, part: impl Fn(&FrameDuration) -> f32) -> FrameTimes {
        let mut sorted: Vec<f32> = self.recent.iter().map(part).collect();
        sorted.sort_by(f32::total_cmp);
        let rank = |share: f32| {
            let index = (share * sorted.len() as f32).ceil() as usize;
            sorted.get(index.saturating_sub(1)).copied().unwrap_or_default()
        };
        FrameTimes { p50: rank(0.5), p95: rank(0.95), max: rank(1.0) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn percentiles_are_those_of_the_recent_frames() {
        let mut frames = FrameStats::default();
        assert_eq!(frames.update_times(), FrameTimes::default());
        (0..1000).for_each(|_| frames.record(500.0, 600.0));
        (1..=MAX_RECENT).rev().for_each(|millis| frames.record(millis as f32, 300.0));
        assert_eq!(frames.total_times().p50, 300.0);
        assert_eq!(frames.update_times(), FrameTimes { p50: 120.0, p95: 228.0, max: 240.0 });
    }
}
