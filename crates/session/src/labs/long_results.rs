//! The results of labs from long clips, which workers make.

use super::Outcome;
use super::blend::{BlendCache, BlendLab};
use super::delegated::Delegated;
use super::edit::EditLab;
use super::in_place::InPlaceLab;
use super::lab::{HasPart, Inputs, Lab, LabClips, MadeInputs};
use super::layers::{LayerCache, LayersLab};
use super::pair::Pairs;
use super::request_cache::RequestCache;
use super::sliced::{JobKind, Sliced};
use super::transition::TransitionLab;
use crate::LabId;
use crate::jobs::{JobBoard, ResultTask};
use crate::params::{Key, Params};
use segue_motion::clip::Motion;
use std::ops::ControlFlow;
use std::sync::Arc;

/// Returns the number of frames of A and B from which on a worker makes the result of a lab: up to
/// there a change shows in the next frame, while a slider is dragged. `None` for a lab that has
/// work of its own for workers, or results with facts that are no messages.
fn worker_frames(lab: LabId) -> Option<usize> {
    match lab {
        LabId::Layers => Some(16_000),
        LabId::Blend | LabId::Transition | LabId::InPlace | LabId::Edit => Some(32_000),
        _ => None,
    }
}

/// The labs that make a result from one or two clips, as a worker has them.
#[derive(Debug, Default)]
pub(crate) struct PairLabs {
    pairs: Pairs,
    blends: BlendCache,
    layers: LayerCache,
}

impl HasPart<Pairs> for PairLabs {
    fn part(&mut self) -> &mut Pairs {
        &mut self.pairs
    }
}

impl HasPart<BlendCache> for PairLabs {
    fn part(&mut self) -> &mut BlendCache {
        &mut self.blends
    }
}

impl HasPart<LayerCache> for PairLabs {
    fn part(&mut self) -> &mut LayerCache {
        &mut self.layers
    }
}

impl PairLabs {
    /// Returns the definition of a lab, if it is one of these.
    fn lab_of(lab: LabId) -> Option<&'static dyn Lab<Self>> {
        match lab {
            LabId::Blend => Some(&BlendLab),
            LabId::Transition => Some(&TransitionLab),
            LabId::Layers => Some(&LayersLab),
            LabId::InPlace => Some(&InPlaceLab),
            LabId::Edit => Some(&EditLab),
            _ => None,
        }
    }

    /// Returns the result of the parameters from the clips in the lab's slots; `None` where there
    /// is none.
    pub(crate) fn result(
        &mut self,
        slots: &[Arc<Motion>],
        params: &Params,
        match_window: usize,
    ) -> Option<Outcome> {
        let lab = Self::lab_of(params.lab())?;
        // All of it is computed here.
        let jobs = &mut JobBoard::default();
        loop {
            let clips = LabClips { slots: slots.to_vec(), more: Vec::new() };
            for part in self.sliced() {
                part.clear_requests();
            }
            let inputs = lab.inputs(self, clips, params, match_window).ok()?;
            let mut has_worked = false;
            while self.sliced().into_iter().any(|part| part.work(jobs)) {
                has_worked = true;
            }
            // Work that is done may change even what is no draft: the distance at given frames.
            if !has_worked {
                return inputs.filter(|inputs| !inputs.is_draft())?.run().ok();
            }
        }
    }

    fn sliced(&mut self) -> [&mut dyn Sliced; 3] {
        [&mut self.pairs, &mut self.blends, &mut self.layers]
    }
}

/// A result that a worker is asked for.
#[derive(Clone, Debug)]
struct ResultOf {
    slots: Vec<Arc<Motion>>,
    task: ResultTask,
}

impl ResultOf {
    fn is(&self, other: &Self) -> bool {
        let same = |(a, b): (&Arc<Motion>, &Arc<Motion>)| Arc::ptr_eq(a, b);
        self.task == other.task
            && self.slots.len() == other.slots.len()
            && self.slots.iter().zip(&other.slots).all(same)
    }
}

/// The results that workers make for panes.
#[derive(Debug, Default)]
pub(crate) struct LongResults {
    /// `None` for a result that no worker could make: the lab makes it, or says why it cannot.
    cache: RequestCache<ResultOf, Delegated<ResultTask, ()>, Option<Arc<Outcome>>>,
}

impl LongResults {
    /// Requests a result of a worker: `None` while it is made. The lab makes it itself
    /// ([`ControlFlow::Continue`]) if the clips are short, if it takes clips besides those in its
    /// slots, if it scales the body, if there are no workers, or if none could make it.
    pub(crate) fn inputs(
        &mut self,
        clips: &LabClips,
        params: &Params,
        match_window: usize,
        jobs: &JobBoard,
    ) -> ControlFlow<Option<Inputs>> {
        let frames: usize = clips.slots.iter().map(|clip| clip.clip().frames()).sum();
        let is_long = worker_frames(params.lab()).is_some_and(|least| frames >= least);
        // A body of another size is none of the page's, and cannot be packed.
        let keeps_body = params.lab() != LabId::Edit || params.number(Key::Scale) == 1.0;
        if !is_long || !keeps_body || !clips.more.is_empty() || !jobs.has_workers() {
            return ControlFlow::Continue(());
        }
        let task = ResultTask::new(params, match_window);
        let of = ResultOf { slots: clips.slots.clone(), task };
        if let Some(made) = self.cache.request(|known, _| known.is(&of)) {
            return match made {
                Some(outcome) => {
                    ControlFlow::Break(Some(Inputs::new(MadeInputs(Arc::clone(outcome)))))
                }
                None => ControlFlow::Continue(()),
            };
        }
        if !self.cache.is_under_way(|known| known.is(&of)) {
            self.cache.begin(of, Delegated::New);
        }
        ControlFlow::Break(None)
    }
}

impl Sliced for LongResults {
    fn clear_requests(&mut self) {
        self.cache.clear_requests();
    }

    fn work(&mut self, jobs: &mut JobBoard) -> bool {
        self.cache.work(|of, work| {
            let offer = || Some((of.task.clone(), of.slots.clone()));
            let taken = |outcome| Some(Some(Arc::new(outcome)));
            work.advance(jobs, offer, taken, |_| ControlFlow::Break(None))
        })
    }

    fn is_ready(&self) -> bool {
        self.cache.is_ready()
    }

    fn progress(&self) -> Option<(JobKind, f64)> {
        self.cache.under_way().next().map(|_| (JobKind::Computing, 0.0))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::choices::Selected as _;

    #[test]
    fn worker_has_every_lab_that_it_is_asked_for() {
        let asked = |lab: &&LabId| worker_frames(**lab).is_some();
        let has = |lab: &&LabId| PairLabs::lab_of(**lab).is_some();
        let all = LabId::ALL;
        assert!(all.iter().filter(asked).eq(all.iter().filter(has)));
        assert_eq!(all.iter().filter(asked).count(), 5);
    }
}
