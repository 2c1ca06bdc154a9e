//! Walks through a motion graph, as far as they have been made.

use super::BuiltGraph;
use crate::labs::outcome::Outcome;
use crate::metrics::{Metric, MetricId};
use glam::DVec2;
use segue_motion::clip::Motion;
use segue_motion::graph::{Choices, PieceSeam, Place, Stay, WalkMetrics, WalkPiece};
use segue_motion::math::Planar;
use segue_motion::metrics::MotionTrace;
use std::sync::Arc;

/// A stay in one clip, in the walk's time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WalkStay {
    /// The walk's frame at which it begins.
    pub start: usize,
    /// One past its last frame.
    pub end: usize,
    /// The stay.
    pub stay: Stay,
    /// The transition into it.
    pub seam: Option<PieceSeam>,
    /// The placement of its clip in the walk's world.
    pub world_from_clip: Planar,
}

impl WalkStay {
    pub(super) fn of(piece: &WalkPiece) -> Self {
        Self {
            start: piece.start,
            end: piece.start + piece.clip.frames(),
            stay: piece.stay,
            seam: piece.seam,
            world_from_clip: piece.world_from_piece,
        }
    }
}

/// The state of a walk at a time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WalkMoment {
    /// The number of the stay.
    pub stay: usize,
    /// The frame of the clip that plays.
    pub place: Place,
    /// The frame of the clip that is left, during a transition.
    pub left: Option<Place>,
    /// The progress of the transition, 0 to 1; 1 after it.
    pub share: f64,
}

/// A walk through a graph, as far as it has been made.
#[derive(Clone, Debug)]
pub struct Walk {
    /// The graph.
    pub built: Arc<BuiltGraph>,
    /// The probabilities of its choices.
    pub choices: Arc<Choices>,
    /// The probability of each transition of the whole graph ([`BuiltGraph::probabilities`]).
    pub probabilities: Arc<Vec<Option<f64>>>,
    /// The expected time between transitions in a long walk, seconds; `None` if a walk ends, or
    /// never leaves its clip.
    pub run_secs: Option<f64>,
    /// The motion so far.
    pub motion: Arc<Motion>,
    /// The stays that it consists of.
    pub passed: Arc<Vec<WalkStay>>,
    /// Visits of clips that cannot be reached: time, seconds, and clip.
    pub missed: Vec<(f64, usize)>,
    /// Its metrics.
    pub metrics: Vec<Metric>,
    /// The trace of its joints, hips and feet, for the part that was shown first; `None` before it
    /// is measured.
    pub trace: Option<Arc<MotionTrace>>,
    /// Whether it ended in a dead end.
    pub ends: bool,
    /// Whether it is a single transition between parts of two clips.
    pub is_jump: bool,
    /// Whether it follows the walk of another pane where it can.
    pub is_guided: bool,
    /// The path that it follows, and how well.
    pub followed: Option<FollowedPath>,
}

/// A clip of a walk, drawn as a ghost.
#[derive(Clone, Copy, Debug)]
pub struct WalkGhost<'a> {
    /// The clip.
    pub motion: &'a Arc<Motion>,
    /// Its time, seconds.
    pub secs: f64,
    /// The placement of the clip in the walk's world.
    pub world_from_clip: Planar,
    /// The opacity, 0 to 1.
    pub clear: f64,
}

/// A path over the ground, and how closely a walk follows it.
#[derive(Clone, Debug, PartialEq)]
pub struct FollowedPath {
    /// The points, (x, z) in metres.
    pub points: Vec<DVec2>,
    /// The root mean square distance of the walk from the path, by the search, metres.
    pub rms_m: f64,
    /// The distance that the walk covers along the path, metres.
    pub along_m: f64,
    /// The length of the path, metres.
    pub length_m: f64,
    /// The number of nodes expanded.
    pub looked_at: usize,
    /// Whether it is the best so far.
    pub is_searching: bool,
}

impl Walk {
    /// Returns the frame of the walk at a time.
    fn frame_at(&self, secs: f64) -> usize {
        let last = self.motion.clip().frames().saturating_sub(1);
        ((secs * self.motion.clip().fps()).max(0.0).round() as usize).min(last)
    }

    /// Returns the state at a time; `None` for a walk without frames.
    #[must_use]
    pub fn at(&self, secs: f64) -> Option<WalkMoment> {
        let frame = self.frame_at(secs);
        let stay = self.passed.partition_point(|passed| passed.start <= frame).checked_sub(1)?;
        let passed = self.passed.get(stay)?;
        let into = frame - passed.start;
        let seam = passed.seam.filter(|seam| into < seam.frames);
        Some(WalkMoment {
            stay,
            place: Place { clip: passed.stay.clip, frame: passed.stay.from + into },
            left: seam.map(|seam| Place { frame: seam.leave.frame + into, ..seam.leave }),
            share: seam.map_or(1.0, |seam| into as f64 / seam.frames.max(1) as f64),
        })
    }

    /// Returns the distance of the transition into a stay, centimetres.
    #[must_use]
    pub fn jump_cm(&self, passed: &WalkStay) -> Option<f64> {
        let graph = if self.is_jump { self.built.whole() } else { self.built.graph() };
        Some(graph.jumps().get(passed.stay.jump?)?.distance_cm)
    }

    /// Returns the clips that play in the transition around a time, the one that is left first.
    /// They fade in before it and out after it.
    #[must_use]
    pub fn ghosts_at(&self, secs: f64, fade_secs: f64) -> [Option<WalkGhost<'_>>; 2] {
        let fps = self.motion.clip().fps();
        let near = |passed: &&WalkStay| {
            let (Some(seam), start) = (passed.seam, passed.start as f64 / fps) else {
                return false;
            };
            secs > start - fade_secs && secs < start + seam.frames as f64 / fps + fade_secs
        };
        let frame = self.frame_at(secs + fade_secs);
        let last = self.passed.partition_point(|passed| passed.start <= frame);
        let few = self.passed.get(last.saturating_sub(3)..last).unwrap_or_default();
        let Some((passed, seam)) =
            few.iter().rev().find(near).and_then(|passed| Some((passed, passed.seam?)))
        else {
            return [None, None];
        };
        let (start, length) = (passed.start as f64 / fps, seam.frames.max(1) as f64 / fps);
        let inside = ((secs - start) / length).clamp(0.0, 1.0);
        let before = 1.0 - ((start - secs) / fade_secs).clamp(0.0, 1.0);
        let behind = 1.0 - ((secs - start - length) / fade_secs).clamp(0.0, 1.0);
        // The placement at which the walk equals its clips: at the beginning the clip that is left,
        // at the end the one that is entered.
        let end = (passed.start + seam.frames).min(self.motion.clip().frames().saturating_sub(1));
        let laid = |place: Place, met: usize, walk_frame: usize, clear: f64| {
            let motion = self.built.clips().motions().get(place.clip)?;
            let stands = motion.ground_frames().get(met)?;
            let world_from_clip =
                self.motion.ground_frames().get(walk_frame)?.after(&stands.inverse());
            let secs = place.frame as f64 / fps + secs - start;
            let there = (0.0..=motion.clip().duration_secs()).contains(&secs) && clear > 0.02;
            there.then_some(WalkGhost { motion, secs, world_from_clip, clear })
        };
        [
            laid(seam.leave, seam.leave.frame, passed.start, (2.0 * inside).min(1.0) * behind),
            laid(
                seam.enter,
                seam.enter.frame + (end - passed.start),
                end,
                (2.0 * (1.0 - inside)).min(1.0) * before,
            ),
        ]
    }
}

/// Returns the metrics of a walk beyond those of every result, in the order in which they are
/// listed.
pub(super) fn of_walk(found: &WalkMetrics, fps: f64) -> [Metric; 5] {
    let at = |id, count: usize, frame| Metric::at_frame(id, count as f64, frame, fps);
    [
        Metric::new(MetricId::SeamsPerMinute, found.seams_per_minute()),
        at(MetricId::Spins, found.spins(), found.worst_spin_at()),
        at(MetricId::Flashes, found.flashes(), found.worst_flash_at()),
        Metric::new(MetricId::Lag, found.median_lag_s()),
        Metric::new(MetricId::Variety, found.variety * 100.0),
    ]
}

impl Outcome {
    /// Returns the walk of the result; `None` if it is not a walk.
    #[must_use]
    pub fn walk(&self) -> Option<&Arc<Walk>> {
        self.facts.get()
    }
}
