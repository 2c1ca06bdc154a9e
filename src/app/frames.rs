//! How long frames take.

/// How many frames are remembered: four seconds at 60 Hz.
const REMEMBERED: usize = 240;

/// The work that recent frames took the processor, in milliseconds, without waiting for the screen.
#[derive(Clone, Debug, Default)]
pub(crate) struct Frames {
    count: u64,
    recent: Vec<Took>,
}

/// What one frame took, milliseconds.
#[derive(Clone, Copy, Debug)]
struct Took {
    /// Input, panels and scene.
    thinking: f32,
    /// All of it, with the commands for the graphics device.
    whole: f32,
}

/// A summary of recent frames, milliseconds.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize)]
pub(crate) struct FrameTimes {
    /// Half of them took no longer.
    pub(crate) p50: f32,
    /// 19 of 20 took no longer.
    pub(crate) p95: f32,
    /// None took longer.
    pub(crate) max: f32,
}

impl Frames {
    /// Counts a frame that begins to be drawn.
    pub(crate) fn begin(&mut self) {
        self.count += 1;
    }

    /// Remembers how long a frame took: input, panels and scene, and with them the commands for the
    /// graphics device.
    pub(crate) fn took(&mut self, thinking: f32, whole: f32) {
        if self.recent.len() >= REMEMBERED {
            self.recent.remove(0);
        }
        self.recent.push(Took { thinking, whole });
    }

    /// How many frames have been drawn since the start.
    pub(crate) fn count(&self) -> u64 {
        self.count
    }

    /// Input, panels and scene of the recent ones; zeros before the first.
    pub(crate) fn times(&self) -> FrameTimes {
        self.summary(|took| took.thinking)
    }

    /// The same with the commands for the graphics device.
    pub(crate) fn whole_times(&self) -> FrameTimes {
        self.summary(|took| took.whole)
    }

    fn summary(&self, part: impl Fn(&Took) -> f32) -> FrameTimes {
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
    fn ranks_are_those_of_the_recent_frames() {
        let mut frames = Frames::default();
        assert_eq!(frames.times(), FrameTimes::default());
        (0..1000).for_each(|_| frames.took(500.0, 600.0));
        (1..=REMEMBERED).rev().for_each(|millis| frames.took(millis as f32, 300.0));
        assert_eq!(frames.whole_times().p50, 300.0);
        assert_eq!(frames.times(), FrameTimes { p50: 120.0, p95: 228.0, max: 240.0 });
    }
}
