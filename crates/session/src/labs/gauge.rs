//! The artefact numbers that stand first in the list of every lab: each result is measured in the
//! same way, beside the clips that it is made of.

use super::sliced::{JobKind, Sliced};
use super::{Measured, Outcome};
use segue_motion::clip::Clip;
use segue_motion::metrics::{MotionTrace, ResultMetrics, TraceMeter};
use segue_motion::skeleton::Roles;
use std::sync::{Arc, Weak};

/// So many frames are measured at once when a result is asked for: about 5 ms for 31 joints.
const AT_ONCE: usize = 1_200;
/// Frames in one slice of work: about 2 ms for 31 joints in a browser.
const PER_SLICE: usize = 500;

/// Measures results and their clips slice by slice, and keeps what was measured of a clip as long
/// as the clip is there.
#[derive(Debug, Default)]
pub(crate) struct Gauge {
    known: Vec<(Weak<Clip>, Arc<MotionTrace>)>,
    /// What a pane waits for.
    wanted: Vec<(Arc<Clip>, Roles)>,
    under_way: Option<(Arc<Clip>, TraceMeter)>,
    /// All that panes waited for has just been measured, and nobody has asked for it yet.
    is_ready: bool,
}

impl Gauge {
    /// The numbers of a result. `None` when they take longer than a frame: [`work`](Self::work),
    /// then ask again.
    pub(crate) fn numbers(&mut self, outcome: &Outcome) -> Option<ResultMetrics> {
        let (mut left, roles) = (AT_ONCE, outcome.motion.roles());
        let own = match &outcome.measured {
            Measured::Motion => self.trace(outcome.motion.clip(), roles, &mut left),
            Measured::Clip(clip) => self.trace(clip, roles, &mut left),
            Measured::Trace(trace) => Some(Arc::clone(trace)),
        };
        let clips = self.traces(&outcome.beside, roles, &mut left);
        Some(measured(own.as_deref()?, &clips?))
    }

    /// The numbers of what was just done by somebody who is driven: a few seconds, which are
    /// measured at once. `None` while its clips are not.
    pub(crate) fn numbers_now(&mut self, outcome: &Outcome) -> Option<ResultMetrics> {
        let clips = self.traces(&outcome.beside, outcome.motion.roles(), &mut 0)?;
        Some(measured(&MotionTrace::new(outcome.motion.clip(), outcome.motion.roles()), &clips))
    }

    /// What is known of some clips; `None` while one of them is not measured. All that are not
    /// known are asked for.
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
        // An address is another clip's as soon as its own is gone and its weak pointers are, too:
        // those that are kept here hold it.
        self.known.retain(|(known, _)| known.strong_count() > 0);
        self.known.push((Arc::downgrade(clip), Arc::clone(&trace)));
        trace
    }
}

impl Sliced for Gauge {
    fn ask_anew(&mut self) {
        self.wanted.clear();
        self.is_ready = false;
    }

    fn work(&mut self) -> bool {
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

    /// Numbers come soon by themselves.
    fn progress(&self) -> Option<(JobKind, f64)> {
        None
    }
}

fn measured(own: &MotionTrace, clips: &[Arc<MotionTrace>]) -> ResultMetrics {
    let clips: Vec<&MotionTrace> = clips.iter().map(|clip| &**clip).collect();
    ResultMetrics::measure(own, &clips)
}
