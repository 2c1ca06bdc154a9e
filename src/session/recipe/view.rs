//! The View lab: a clip as it is, or with its planted feet held.

use super::Outcome;
use super::feet::{slide, slide_before};
use crate::metrics::SlideMeter;
use crate::session::motion::Motion;
use crate::transition::{FootLockOptions, FootLocking};
use std::sync::Arc;

/// Clips of up to so many frames are done at once: about 8 ms for 31 joints.
const AT_ONCE: usize = 1_000;
/// Frames in one slice of work: about 2 ms for 31 joints in a browser.
const PER_SLICE: usize = 500;

/// What a view depends on. Equal inputs, equal result.
#[derive(Clone, Debug)]
pub(in crate::session) struct ViewInputs {
    motion: Arc<Motion>,
    held: Option<Arc<Held>>,
}

impl PartialEq for ViewInputs {
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.motion, &other.motion) && self.held.is_some() == other.held.is_some()
    }
}

impl ViewInputs {
    /// A clip as it is.
    pub(in crate::session) fn plain(motion: Arc<Motion>) -> Self {
        Self { motion, held: None }
    }

    /// The clip.
    pub(in crate::session) fn run(&self) -> Result<Outcome, String> {
        match &self.held {
            None => Ok(Outcome::plain(Arc::clone(&self.motion))),
            Some(held) => held.made.clone(),
        }
    }
}

/// What came of it.
#[derive(Debug)]
struct Held {
    of: Arc<Motion>,
    made: Result<Outcome, String>,
}

/// Holds the feet of clips slice by slice, and keeps the last one.
#[derive(Debug, Default)]
pub(in crate::session) struct FeetHolder {
    known: Option<Arc<Held>>,
    under_way: Option<UnderWay>,
    /// It has just been done, and nobody has asked for it yet.
    is_ready: bool,
}

#[derive(Debug)]
struct UnderWay {
    motion: Arc<Motion>,
    stage: Stage,
}

#[derive(Debug)]
enum Stage {
    Before(SlideMeter),
    Locking { before_cm: Option<f64>, locking: FootLocking },
}

impl FeetHolder {
    /// Nobody waits any more: everybody is about to ask again.
    pub(in crate::session) fn ask_anew(&mut self) {
        self.is_ready = false;
    }

    /// The clip with its feet held. `None` when that takes longer than a frame: [`work`](Self::work), then ask again.
    pub(in crate::session) fn inputs(&mut self, motion: &Arc<Motion>) -> Option<ViewInputs> {
        loop {
            if let Some(held) = self.known.as_ref().filter(|held| Arc::ptr_eq(&held.of, motion)) {
                return Some(ViewInputs {
                    motion: Arc::clone(motion),
                    held: Some(Arc::clone(held)),
                });
            }
            if !self
                .under_way
                .as_ref()
                .is_some_and(|under_way| Arc::ptr_eq(&under_way.motion, motion))
            {
                self.under_way = Some(UnderWay {
                    motion: Arc::clone(motion),
                    stage: Stage::Before(SlideMeter::new(&motion.clip, &motion.roles)),
                });
            }
            if motion.clip.frames() > AT_ONCE {
                return None;
            }
            self.step();
        }
    }

    /// One slice of what a pane waits for. `false` when there was nothing to do.
    pub(in crate::session) fn work(&mut self) -> bool {
        let had_work = self.under_way.is_some();
        self.step();
        self.is_ready |= had_work && self.under_way.is_none();
        had_work
    }

    /// Whether what a pane waits for is there, so that it should ask again.
    pub(in crate::session) fn is_ready(&self) -> bool {
        self.is_ready
    }

    /// Lets go of what is under way: nobody wants it any more.
    pub(in crate::session) fn stop(&mut self) {
        self.under_way = None;
    }

    /// How much is done of what is worked on, 0 to 1; `None` when there is nothing.
    pub(in crate::session) fn progress(&self) -> Option<f32> {
        self.under_way.as_ref().map(|under_way| match &under_way.stage {
            Stage::Before(_) => 0.0,
            Stage::Locking { locking, .. } => 0.2 + 0.8 * locking.progress(),
        })
    }

    fn step(&mut self) {
        let Some(UnderWay { motion, stage }) = self.under_way.take() else {
            return;
        };
        let Motion {
            clip,
            roles,
            contacts,
            ground_frames,
        } = &*motion;
        let next = match stage {
            Stage::Before(mut meter) => {
                if meter.advance(clip, contacts, PER_SLICE) {
                    Ok(Stage::Before(meter))
                } else {
                    let locking = FootLocking::new(Arc::clone(clip), roles, contacts, &FootLockOptions::default());
                    let before_cm = meter.worst_cm();
                    locking
                        .map(|locking| Stage::Locking { before_cm, locking })
                        .map_err(|error| Err(error.to_string()))
                }
            }
            Stage::Locking { before_cm, mut locking } => {
                if locking.advance(PER_SLICE) {
                    Ok(Stage::Locking { before_cm, locking })
                } else {
                    let locked = locking.finish().map_err(|error| error.to_string());
                    Err(locked.map(|locked| Outcome {
                        metrics: vec![slide(&locked, roles, contacts), slide_before(before_cm)],
                        ..Outcome::plain(Arc::new(Motion {
                            clip: Arc::new(locked),
                            roles: roles.clone(),
                            contacts: contacts.clone(),
                            // Hips are only raised and lowered.
                            ground_frames: ground_frames.clone(),
                        }))
                    }))
                }
            }
        };
        match next {
            Ok(stage) => self.under_way = Some(UnderWay { motion, stage }),
            Err(made) => self.known = Some(Arc::new(Held { of: motion, made })),
        }
    }
}
