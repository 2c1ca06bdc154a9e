//! The steps of a track, and how far each departs from those around it.

use super::tracks::{Track, Tracks, median};
use crate::math::stats;
use glam::Vec3;

/// Steps are compared with those within this time to either side, seconds.
pub(super) const NEAR_SECS: f64 = 0.035;
/// The least number of these steps to either side.
pub(super) const NEAR_FRAMES: usize = 3;
/// The usual departure is a percentile of those within this time to either side, seconds.
const AROUND_SECS: f64 = 0.2;
/// This percentile.
const USUAL: f32 = 0.6;

/// The steps of a track with their departures.
#[derive(Clone, Debug)]
pub(super) struct Steps {
    pub(super) ways: Vec<Vec3>,
    /// For each step, its distance from the median of the steps near it.
    pub(super) departures: Vec<f32>,
    near: usize,
    around: usize,
}

impl Steps {
    /// Measures a track. O(frames).
    pub(super) fn of(track: &Track, tracks: &Tracks) -> Self {
        let steps = track.steps();
        let near = tracks.frames_of(NEAR_SECS, NEAR_FRAMES);
        let around = tracks.frames_of(AROUND_SECS, 8);
        let mut others = Vec::with_capacity(2 * near);
        let departures = (0..steps.len())
            .map(|at| {
                others.clear();
                let end = (at + near + 1).min(steps.len());
                others.extend_from_slice(&steps[at.saturating_sub(near)..at]);
                others.extend_from_slice(&steps[at + 1..end]);
                steps[at].distance(median(&others))
            })
            .collect();
        Self { ways: steps, departures, near, around }
    }

    /// Returns the usual departure around a step.
    pub(super) fn usual(&self, at: usize) -> f32 {
        let end = (at + self.around + 1).min(self.departures.len());
        let start = at.saturating_sub(self.around).min(end);
        stats::percentile(&self.departures[start..end], USUAL).unwrap_or(0.0)
    }

    /// Returns the velocity before a frame, per frame: the median of the steps that end there.
    pub(super) fn before(&self, frame: usize) -> Vec3 {
        median(&self.ways[frame.saturating_sub(self.near)..frame.min(self.ways.len())])
    }

    /// Returns the velocity after a frame, per frame: the median of the steps that begin there.
    pub(super) fn after(&self, frame: usize) -> Vec3 {
        let end = (frame + self.near).min(self.ways.len());
        median(&self.ways[frame.min(end)..end])
    }
}
