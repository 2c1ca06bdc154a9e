//! Locking of the feet of a motion on a path. It takes longer than a frame while dragging, and is
//! therefore done in slices when dragging ends.

use super::PathInputs;
use crate::labs::LabError;
use crate::params::MAX_PANES;
use segue_motion::clip::{Clip, Contacts};
use segue_motion::metrics::{Extreme, SlideMeter};
use segue_motion::transition::FootLocking;
use std::sync::Arc;

/// The number of frames in one slice of work: about 2 ms for 31 joints in a browser.
const PER_SLICE: usize = 500;

/// The motion with its feet locked, and their slide in the worst stance, centimetres.
type LockedMotion = Result<(Arc<Clip>, Option<Extreme>), LabError>;

/// The result for one request.
#[derive(Debug)]
pub(super) struct LockedFeet {
    of: PathInputs,
    pub(super) made: LockedMotion,
}

#[derive(Debug)]
enum Stage {
    Locking(Box<FootLocking>, Contacts),
    Measuring(Arc<Clip>, Contacts, SlideMeter),
}

/// A cache of the last results, with their work in slices.
#[derive(Debug, Default)]
pub(super) struct LockedFeetCache {
    done: Vec<Arc<LockedFeet>>,
    wanted: Vec<PathInputs>,
    under_way: Option<(PathInputs, Stage)>,
    /// Whether a requested result is available and has not been fetched yet.
    is_ready: bool,
}

impl LockedFeetCache {
    pub(super) fn clear_requests(&mut self) {
        self.wanted.clear();
        self.is_ready = false;
    }

    /// Returns the result if it is known; otherwise schedules it.
    pub(super) fn get_or_schedule(&mut self, of: &PathInputs) -> Option<Arc<LockedFeet>> {
        let known = self.done.iter().find(|planted| planted.of.makes_the_same(of));
        if known.is_none() {
            self.wanted.push(of.clone());
        }
        known.cloned()
    }

    pub(super) fn is_ready(&self) -> bool {
        self.is_ready
    }

    pub(super) fn progress(&self) -> Option<f32> {
        let share = self.under_way.as_ref().map(|(_, stage)| match stage {
            Stage::Locking(locking, _) => 0.8 * locking.progress(),
            Stage::Measuring(..) => 0.8,
        });
        share.or((!self.wanted.is_empty()).then_some(0.0))
    }

    /// Does one slice. Returns `false` if there was nothing to do.
    pub(super) fn work(&mut self) -> bool {
        // Requests of a drag that has moved on are dropped.
        let wanted = |of: &PathInputs| self.wanted.iter().any(|wanted| wanted.makes_the_same(of));
        let under_way = self.under_way.take().filter(|(of, _)| wanted(of));
        let next = match (under_way, self.wanted.first()) {
            (Some((of, stage)), _) => {
                step(&of, stage).map(|stage| (of.clone(), stage)).map_err(|made| (of, made))
            }
            (None, Some(of)) => begin(of)
                .map(|stage| (of.clone(), stage))
                .map_err(|problem| (of.clone(), Err(problem))),
            (None, None) => return false,
        };
        match next {
            Ok(under_way) => self.under_way = Some(under_way),
            Err((of, made)) => {
                self.wanted.retain(|wanted| !wanted.makes_the_same(&of));
                if self.done.len() >= MAX_PANES {
                    self.done.remove(0);
                }
                // `makes_the_same` does not compare the motion without foot lock.
                let of = PathInputs { free: None, ..of };
                self.done.push(Arc::new(LockedFeet { of, made }));
                self.is_ready = true;
            }
        }
        true
    }
}

fn begin(of: &PathInputs) -> Result<Stage, LabError> {
    let free = of.free_motion()?;
    let (roles, made, contacts) =
        (of.fitted.motion.roles(), &free.made, free.made.contacts.clone());
    Ok(match of.locking(&made.clip, &contacts, &made.turns)? {
        Some(locking) => Stage::Locking(Box::new(locking), contacts),
        None => {
            Stage::Measuring(Arc::clone(&made.clip), contacts, SlideMeter::new(&made.clip, roles))
        }
    })
}

/// Returns the next stage, or the final result.
fn step(of: &PathInputs, stage: Stage) -> Result<Stage, LockedMotion> {
    match stage {
        Stage::Locking(mut locking, contacts) => {
            if locking.advance(PER_SLICE) {
                return Ok(Stage::Locking(locking, contacts));
            }
            let clip = locking.finish().map_err(|error| Err(error.into()))?;
            let meter = SlideMeter::new(&clip, of.fitted.motion.roles());
            Ok(Stage::Measuring(Arc::new(clip), contacts, meter))
        }
        Stage::Measuring(clip, contacts, mut meter) => {
            if meter.advance(&clip, &contacts, PER_SLICE) {
                return Ok(Stage::Measuring(clip, contacts, meter));
            }
            Err(Ok((clip, meter.worst())))
        }
    }
}
