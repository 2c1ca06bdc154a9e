//! The analyses of long clips, which workers do before any lab needs them.

use super::delegated::Delegated;
use super::request_cache::RequestCache;
use super::sliced::{JobKind, Sliced};
use crate::jobs::{AnalysisTask, JobBoard};
use segue_motion::clip::{Motion, MotionAnalysis};
use std::ops::ControlFlow;
use std::sync::Arc;

/// The number of frames from which on a worker analyses a clip: about 15 ms for 31 joints in a
/// browser.
const FOR_WORKERS: usize = 8_000;

/// The analyses of the clips of labs that are under way. A clip keeps its own.
#[derive(Debug, Default)]
pub(crate) struct Analyses {
    /// The clips whose job has ended: those that no worker could analyse compute on first use.
    cache: RequestCache<Arc<Motion>, Delegated<AnalysisTask, ()>, ()>,
}

impl Analyses {
    /// Returns whether everything that is derived from a clip is known, or takes no longer than a
    /// frame, or has no worker to do it. Otherwise it is requested.
    pub(crate) fn knows(&mut self, motion: &Arc<Motion>, jobs: &JobBoard) -> bool {
        if motion.clip().frames() < FOR_WORKERS || motion.is_analyzed() || !jobs.has_workers() {
            return true;
        }
        let is_it = |of: &Arc<Motion>| Arc::ptr_eq(of, motion);
        if self.cache.request(|of, ()| is_it(of)).is_some() {
            return true;
        }
        if !self.cache.is_under_way(is_it) {
            self.cache.begin(Arc::clone(motion), Delegated::New);
        }
        false
    }

    /// Returns whether a worker analyses a clip.
    pub(crate) fn is_under_way(&self, motion: &Motion) -> bool {
        self.cache.under_way().any(|(of, _)| std::ptr::eq(&raw const **of, motion))
    }
}

impl Sliced for Analyses {
    fn clear_requests(&mut self) {
        self.cache.clear_requests();
    }

    fn work(&mut self, jobs: &mut JobBoard) -> bool {
        self.cache.work(|motion, work| {
            let offer = || Some((AnalysisTask, vec![Arc::clone(motion)]));
            let taken = |analysis: MotionAnalysis| {
                motion.learn(analysis);
                Some(())
            };
            work.advance(jobs, offer, taken, |_| ControlFlow::Break(()))
        })
    }

    fn is_ready(&self) -> bool {
        self.cache.is_ready()
    }

    fn progress(&self) -> Option<(JobKind, f64)> {
        self.cache.under_way().next().map(|_| (JobKind::Analyzing, 0.0))
    }
}
