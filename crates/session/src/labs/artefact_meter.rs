//! Measurement of the artefact metrics of every lab: each result is measured in the same way,
//! compared with the clips that it was made from.

use super::sliced::{JobKind, Sliced};
use super::{MeasuredMotion, Outcome};
use crate::jobs::JobBoard;
use segue_motion::clip::Clip;
use segue_motion::metrics::{MotionTrace, ResultMetrics, TraceMeter};
use segue_motion::skeleton::Roles;
use std::sync::{Arc, Weak};

/// The number of frames that are measured at once: about 5 ms for 31 joints.
const AT_ONCE: usize = 1_200;
/// The number of frames in one slice of work: about 2 ms for 31 joints in a browser.
const PER_SLICE: usize = 500;

/// A measurement of results and their clips in slices. Measurements of a clip are kept as long as
/// the clip exists.
#[derive(Debug, Default)]
pub(crate) struct ArtefactMeter {
    known: Vec<(Weak<Clip>, Arc<MotionTrace>)>,
    /// The requested clips.
    wanted: Vec<(Arc<Clip>, Roles)>,
    under_way: Option<(Arc<Clip>, TraceMeter)>,
    /// Whether everything requested has been measured and not been fetched yet.
    is_ready: bool,
}

impl ArtefactMeter {
    /// Returns the metrics of a result. `None` if they take longer than a frame: call
    /// [`work`](Self::work), then ask again.
    pub(crate) fn numbers(&mut self, outcome: &Outcome) -> Option<ResultMetrics> {
        let (mut left, roles) = (AT_ONCE, outcome.motion.roles());
        let own = match &outcome.measured {
            MeasuredMotion::Motion => self.trace(outcome.motion.clip(), roles, &mut left),
            MeasuredMotion::Clip(clip) => self.trace(clip, roles, &mut left),
            MeasuredMotion::Trace(trace) => Some(Arc::clone(trace)),
        };
        let clips = self.traces(&outcome.beside, roles, &mut left);
        Some(measured(own.as_deref()?, &clips?))
    }

    /// Returns the metrics of the last seconds of a live drive, measured at once. `None` while its
    /// clips have not been measured.
    pub(crate) fn numbers_now(&mut self, outcome: &Outcome) -> Option<ResultMetrics> {
        let clips = self.traces(&outcome.beside, outcome.motion.roles(), &mut 0)?;
        Some(measured(&MotionTrace::new(outcome.motion.clip(), outcome.motion.roles()), &clips))
    }

    /// Returns the measurements of some clips; `None` and requests them if one of them is missing.
    fn traces(
        &mut self,
        clips: &[Arc<Clip>],
        roles: &Roles,
        left: &mut usize,
    ) -> Option<Vec<Arc<MotionTrace>>> {
        let traces: Vec<_> = clips.iter().map(|clip| self.trace(clip, roles, left)).collect();
        traces.into_iter().collect()
    }

    fn trace(
        &mut self,
        clip: &Arc<Clip>,
        roles: &Roles,
        left: &mut usize,
    ) -> Option<Arc<MotionTrace>> {
        let is_it = |(known, _): &&(Weak<Clip>, _)| std::ptr::eq(known.as_ptr(), Arc::as_ptr(clip));
        if let Some((_, trace)) = self.known.iter().find(is_it) {
            return Some(Arc::clone(trace));
        }
        if let Some(rest) = left.checked_sub(clip.frames()) {
            *left = rest;
            return Some(self.keep(clip, MotionTrace::new(clip, roles)));
        }
        if !self.wanted.iter().any(|(wanted, _)| Arc::ptr_eq(wanted, clip)) {
            self.wanted.push((Arc::clone(clip), roles.clone()));
        }
        None
    }

    fn keep(&mut self, clip: &Arc<Clip>, trace: MotionTrace) -> Arc<MotionTrace> {
        let trace = Arc::new(trace);
        // An address is reused as soon as both the clip and all weak pointers to it are gone: the
        // weak pointers here prevent that.
        self.known.retain(|(known, _)| known.strong_count() > 0);
        self.known.push((Arc::downgrade(clip), Arc::clone(&trace)));
        trace
    }
}

impl Sliced for ArtefactMeter {
    fn clear_requests(&mut self) {
        self.wanted.clear();
        self.is_ready = false;
    }

    fn work(&mut self, _jobs: &mut JobBoard) -> bool {
        let Some((clip, roles)) = self.wanted.first() else {
            return false;
        };
        let is_it = |(of, _): &(Arc<Clip>, TraceMeter)| Arc::ptr_eq(of, clip);
        let (clip, mut meter) = (self.under_way.take().filter(is_it))
            .unwrap_or_else(|| (Arc::clone(clip), TraceMeter::new(clip, roles)));
        if meter.advance(&clip, PER_SLICE) {
            self.under_way = Some((clip, meter));
        } else {
            self.keep(&clip, meter.finish(&clip));
            self.wanted.remove(0);
            self.is_ready = self.wanted.is_empty();
        }
        true
    }

    fn is_ready(&self) -> bool {
        self.is_ready
    }

    /// Metrics are quick, so no progress is reported.
    fn progress(&self) -> Option<(JobKind, f64)> {
        None
    }
}

fn measured(own: &MotionTrace, clips: &[Arc<MotionTrace>]) -> ResultMetrics {
    let clips: Vec<&MotionTrace> = clips.iter().map(|clip| &**clip).collect();
    ResultMetrics::measure(own, &clips)
}
