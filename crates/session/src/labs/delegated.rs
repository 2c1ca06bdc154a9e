//! Work that a worker does where there is one, and that is done in slices otherwise.

use super::request_cache::Step;
use crate::jobs::{JobBoard, Kind, Taken, Ticket};
use segue_motion::clip::Motion;
use std::ops::ControlFlow;
use std::sync::Arc;

/// Work that a worker does as a job, or that is done here in slices, as `W`.
#[derive(Debug)]
pub(super) enum Delegated<T, W> {
    /// It has not begun.
    New,
    /// A worker was asked.
    Asked(Ticket<T>),
    /// It is done here; `None` before the first slice.
    Here(Option<W>),
}

impl<T: Kind, W> Delegated<T, W> {
    /// Does one slice. First `offer` returns the job for a worker and its clips, or `None` for work
    /// that is too short for one; `taken` makes the result of the answer. Where no worker has one,
    /// `slice` does some of the work; it is given what the slices before have returned.
    pub(super) fn advance<M>(
        self,
        jobs: &mut JobBoard,
        offer: impl FnOnce() -> Option<(T, Vec<Arc<Motion>>)>,
        taken: impl FnOnce(T::Answer) -> Option<M>,
        slice: impl FnOnce(Option<W>) -> ControlFlow<M, W>,
    ) -> Step<Self, M> {
        match self {
            Self::New => match jobs.has_workers().then(offer).flatten() {
                Some((task, clips)) => Step::On(Self::Asked(jobs.offer(task, &clips))),
                None => Step::On(Self::Here(None)),
            },
            Self::Asked(ticket) => match jobs.take(&ticket) {
                Taken::Waits => Step::Waits(Self::Asked(ticket)),
                Taken::Answer(answer, _) => {
                    taken(answer).map_or(Step::On(Self::Here(None)), Step::Done)
                }
                // The reason is found where the work is done here.
                Taken::Failed => Step::On(Self::Here(None)),
            },
            Self::Here(work) => match slice(work) {
                ControlFlow::Continue(work) => Step::On(Self::Here(Some(work))),
                ControlFlow::Break(made) => Step::Done(made),
            },
        }
    }

    /// Returns the work that is done here, if it has begun.
    pub(super) fn here(&self) -> Option<&W> {
        match self {
            Self::Here(work) => work.as_ref(),
            _ => None,
        }
    }
}
