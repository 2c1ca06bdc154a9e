//! The search for faults, in slices.

use super::fault::{Fault, FaultKind, TrackFault};
use super::gaps::{self, Hold};
use super::mend::in_tracks;
use super::swaps::{self, Limbs};
use super::tracks::Tracks;
use super::{ends, footing, jitter, rate, spikes};
use crate::clip::Motion;
use crate::math::sort::sort_by_key;
use std::sync::Arc;

/// A search for faults. Each kind is looked for in a copy from which the kinds before it have been
/// mended: a swap begins with a jump, and what trembles hides small spikes.
#[derive(Debug)]
pub struct FaultSearch {
    motion: Arc<Motion>,
    tracks: Tracks,
    limbs: Vec<Limbs>,
    stage: Stage,
    /// The next item of the stage.
    next: usize,
    holds: Vec<Hold>,
    parts: Vec<TrackFault>,
    /// The motion without the faults of single tracks.
    steady: Option<Arc<Motion>>,
    faults: Vec<Fault>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[repr(u8)]
enum Stage {
    Swaps,
    Gaps,
    Spikes,
    Jitter,
    Body,
    Done,
}

/// Items of the last stage: the copy, drift, ground, ends, skating, rate.
const BODY_ITEMS: usize = 6;

impl FaultSearch {
    /// Begins a search. Nothing is searched yet: call [`advance`](Self::advance).
    #[must_use]
    pub fn new(motion: Arc<Motion>) -> Self {
        let tracks = Tracks::of(motion.clip());
        let limbs = swaps::limbs(motion.clip().skeleton(), motion.roles());
        let stage = if tracks.frames < 2 { Stage::Done } else { Stage::Swaps };
        let (holds, parts, faults) = (Vec::new(), Vec::new(), Vec::new());
        Self { motion, tracks, limbs, stage, next: 0, holds, parts, steady: None, faults }
    }

    /// Searches one track, or for one fault of the whole body. Returns `false` when all is done.
    /// A track of 1,000 frames takes about 1 ms.
    pub fn advance(&mut self) -> bool {
        let tracks = self.tracks.all.len();
        match self.stage {
            Stage::Swaps if self.next < self.limbs.len() => {
                let found = swaps::swaps(&self.limbs[self.next], &self.tracks);
                self.keep(found);
            }
            Stage::Gaps if self.next < tracks => {
                let track = &self.tracks.all[self.next];
                self.holds.extend(gaps::holds(track, self.next, &self.tracks));
            }
            Stage::Spikes if self.next < tracks => {
                let track = &self.tracks.all[self.next];
                self.parts.extend(spikes::of_track(track, self.next, &self.tracks));
            }
            Stage::Jitter if self.next < tracks => {
                let track = &self.tracks.all[self.next];
                self.parts.extend(jitter::of_track(track, self.next, &self.tracks));
            }
            Stage::Body if self.next < BODY_ITEMS => self.body(),
            Stage::Done => return false,
            _ => {
                self.end_stage();
                return self.stage != Stage::Done;
            }
        }
        self.next += 1;
        true
    }

    /// Collects what a stage found, and begins the next.
    fn end_stage(&mut self) {
        let mut parts = std::mem::take(&mut self.parts);
        if self.stage == Stage::Spikes {
            spikes::take_along(&mut parts, &self.tracks);
        }
        let (found, next) = match self.stage {
            Stage::Swaps => (Vec::new(), Stage::Gaps),
            Stage::Gaps => {
                (gaps::gaps(std::mem::take(&mut self.holds), &self.tracks), Stage::Spikes)
            }
            Stage::Spikes => (spikes::merged(FaultKind::Spike, parts, &self.tracks), Stage::Jitter),
            Stage::Jitter => (spikes::merged(FaultKind::Jitter, parts, &self.tracks), Stage::Body),
            Stage::Body | Stage::Done => (Vec::new(), Stage::Done),
        };
        self.keep(found);
        (self.stage, self.next) = (next, 0);
    }

    /// Takes faults of tracks, and mends them in the copy.
    fn keep(&mut self, found: Vec<Fault>) {
        for fault in &found {
            in_tracks(fault, &mut self.tracks, None);
        }
        self.faults.extend(found);
    }

    fn body(&mut self) {
        let Some(steady) = self.steady.clone() else {
            let source = &self.motion;
            self.steady = self.tracks.clip(source.clip()).ok().map(|clip| {
                let motion = Motion::with_roles(clip, source.roles())
                    .with_feet(source.feet())
                    .with_contact_corrections(source.contact_corrections().clone());
                Arc::new(motion)
            });
            return;
        };
        match self.next {
            1 => self.faults.extend(footing::drift(&steady)),
            2 => self.faults.extend(footing::ground(&steady)),
            3 => self.faults.extend(ends::ends(&self.tracks)),
            4 => {
                let found = footing::skating(steady.clip(), steady.roles(), steady.contacts());
                self.faults.extend(found);
            }
            _ => self.faults.extend(rate::rate(&steady)),
        }
    }

    /// Returns the share of the work that is done, 0 to 1.
    #[must_use]
    pub fn progress(&self) -> f32 {
        let items = match self.stage {
            Stage::Swaps => self.limbs.len(),
            Stage::Body => BODY_ITEMS,
            _ => self.tracks.all.len(),
        };
        let within = self.next as f32 / items.max(1) as f32;
        ((f32::from(self.stage as u8) + within.min(1.0)) / f32::from(Stage::Done as u8)).min(1.0)
    }

    /// Returns the faults, by kind and in order of time. Those that were not yet looked for are
    /// looked for now.
    #[must_use]
    pub fn finish(mut self) -> Vec<Fault> {
        while self.advance() {}
        sort_by_key(&mut self.faults, |fault| (fault.kind, fault.frames.start));
        self.faults
    }
}

/// Returns the faults of a motion, by kind and in order of time: a whole [`FaultSearch`].
#[must_use]
pub fn find_faults(motion: &Arc<Motion>) -> Vec<Fault> {
    FaultSearch::new(Arc::clone(motion)).finish()
}
