//! Searches for faults and their mends, computed in slices and kept between results.

use super::super::delegated::Delegated;
use super::super::request_cache::{Step, work_on_first};
use super::super::sliced::{JobKind, Sliced};
use super::{CleanInputs, Mends};
use crate::jobs::{FaultTask, JobBoard, MendAnswer, MendTask, with_slide};
use crate::labs::LabError;
use crate::params::{Key, MAX_PANES, Params};
use segue_motion::clean::{Fault, FaultSearch, Mending, damage};
use segue_motion::clip::Motion;
use std::ops::ControlFlow;
use std::sync::Arc;

/// Takes of up to this number of frames are searched and mended at once.
const AT_ONCE: usize = 500;
/// The least number of frames of a take that a worker searches and mends: a shorter one takes less
/// time than a worker's start.
const FOR_WORKERS: usize = 2_000;

/// The faults of a take.
#[derive(Debug)]
pub(super) struct Searched {
    of: Arc<Motion>,
    broken: Broken,
    /// The take with the faults that were put in.
    pub(super) motion: Arc<Motion>,
    /// The number of faults that were put in.
    pub(super) injected: usize,
    pub(super) faults: Vec<Fault>,
}

/// A take without the faults that are chosen.
#[derive(Debug)]
pub(super) struct Cleaned {
    of: Arc<Searched>,
    mends: Mends,
    pub(super) made: Result<MendAnswer, LabError>,
}

/// The faults to put in: their number and seed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Broken {
    count: usize,
    seed: u64,
}

impl Broken {
    fn of(params: &Params) -> Self {
        let number = |key| params.number(key) as u64;
        let count = number(Key::CleanFaults) as usize;
        Self { count, seed: if count == 0 { 0 } else { number(Key::CleanSeed) } }
    }

    /// Returns the take with the faults, and their number.
    fn apply(self, motion: &Arc<Motion>) -> Result<(Arc<Motion>, usize), LabError> {
        if self.count == 0 {
            return Ok((Arc::clone(motion), 0));
        }
        let spoilt = damage(motion.clip(), motion.roles(), self.count, self.seed)?;
        let broken = Motion::with_roles(spoilt.clip, motion.roles()).with_feet(motion.feet());
        Ok((Arc::new(broken), spoilt.damages.len()))
    }
}

/// A cache of the last searches and mends, as many as there can be panes.
#[derive(Debug, Default)]
pub(crate) struct CleanCache {
    searched: Vec<Arc<Searched>>,
    cleaned: Vec<Arc<Cleaned>>,
    under_way: Vec<Pending>,
    /// Whether a requested result is available and has not been fetched yet.
    is_ready: bool,
}

#[derive(Debug)]
struct Pending {
    is_wanted: bool,
    work: Work,
}

#[derive(Debug)]
enum Work {
    Search {
        of: Arc<Motion>,
        broken: Broken,
        motion: Arc<Motion>,
        injected: usize,
        search: Delegated<FaultTask, Box<FaultSearch>>,
    },
    Mend {
        of: Arc<Searched>,
        mends: Mends,
        mending: Delegated<MendTask, Box<Mending>>,
    },
}

impl CleanCache {
    /// Returns the take of the parameters with its faults and mends; without them if that takes
    /// longer than a frame: call [`work`](Self::work), then ask again.
    pub(super) fn inputs(
        &mut self,
        motion: &Arc<Motion>,
        params: &Params,
    ) -> Result<CleanInputs, LabError> {
        let (broken, mends) = (Broken::of(params), Mends::of(params));
        let at_once = motion.clip().frames() <= AT_ONCE;
        let mut found = None;
        if let Some(searched) = self.search(motion, broken, at_once)?
            && let Some(cleaned) = self.mend(&searched, &mends, at_once)
        {
            found = Some((searched, cleaned));
        }
        Ok(CleanInputs { motion: Arc::clone(motion), mends, found })
    }

    fn search(
        &mut self,
        motion: &Arc<Motion>,
        broken: Broken,
        at_once: bool,
    ) -> Result<Option<Arc<Searched>>, LabError> {
        let is_it = |of: &Arc<Motion>, by: Broken| Arc::ptr_eq(of, motion) && by == broken;
        if let Some(known) = self.searched.iter().find(|known| is_it(&known.of, known.broken)) {
            return Ok(Some(Arc::clone(known)));
        }
        let pending = self.under_way.iter_mut().find(|at| match &at.work {
            Work::Search { of, broken, .. } => is_it(of, *broken),
            Work::Mend { .. } => false,
        });
        if let Some(pending) = pending {
            pending.is_wanted = true;
            return Ok(None);
        }
        let (broken_motion, injected) = broken.apply(motion)?;
        let work = Work::Search {
            of: Arc::clone(motion),
            broken,
            search: Delegated::New,
            motion: broken_motion,
            injected,
        };
        self.begin(work, at_once);
        let known = self.searched.iter().find(|known| is_it(&known.of, known.broken));
        Ok(known.cloned())
    }

    fn mend(
        &mut self,
        searched: &Arc<Searched>,
        mends: &Mends,
        at_once: bool,
    ) -> Option<Arc<Cleaned>> {
        let is_it = |of: &Arc<Searched>, by: &Mends| Arc::ptr_eq(of, searched) && by == mends;
        if let Some(known) = self.cleaned.iter().find(|known| is_it(&known.of, &known.mends)) {
            return Some(Arc::clone(known));
        }
        let pending = self.under_way.iter_mut().find(|at| match &at.work {
            Work::Mend { of, mends, .. } => is_it(of, mends),
            Work::Search { .. } => false,
        });
        if let Some(pending) = pending {
            pending.is_wanted = true;
            return None;
        }
        let is_quick = at_once || mends.faults_to_mend(&searched.faults).is_empty();
        let (of, mends) = (Arc::clone(searched), mends.clone());
        let work = Work::Mend { of, mends, mending: Delegated::New };
        self.begin(work, is_quick);
        let known = self.cleaned.iter().find(|known| is_it(&known.of, &known.mends));
        known.cloned()
    }

    fn begin(&mut self, work: Work, at_once: bool) {
        if !at_once {
            self.under_way.push(Pending { is_wanted: true, work });
            return;
        }
        // Without workers, none of it waits.
        let jobs = &mut JobBoard::default();
        let mut work = Some(work);
        while let Some(next) = work.take() {
            if let Step::On(next) = self.step(next, jobs) {
                work = Some(next);
            }
        }
    }

    /// Does one slice. Returns the rest of the work; keeps what is done.
    fn step(&mut self, work: Work, jobs: &mut JobBoard) -> Step<Work, ()> {
        match work {
            Work::Search { of, broken, motion, injected, search } => {
                let offer = || {
                    let is_long = motion.clip().frames() >= FOR_WORKERS;
                    is_long.then(|| (FaultTask, vec![Arc::clone(&motion)]))
                };
                let slice = |search: Option<Box<FaultSearch>>| {
                    let begin = || Box::new(FaultSearch::new(Arc::clone(&motion)));
                    let mut search = search.unwrap_or_else(begin);
                    if search.advance() {
                        ControlFlow::Continue(search)
                    } else {
                        ControlFlow::Break(search.finish())
                    }
                };
                match search.advance(jobs, offer, Some, slice) {
                    Step::On(search) => {
                        return Step::On(Work::Search { of, broken, motion, injected, search });
                    }
                    Step::Waits(search) => {
                        return Step::Waits(Work::Search { of, broken, motion, injected, search });
                    }
                    Step::Done(faults) => {
                        let found = Searched { of, broken, motion, injected, faults };
                        keep(&mut self.searched, found);
                    }
                }
            }
            Work::Mend { of, mends, mending } => {
                let (faults, options) = (mends.faults_to_mend(&of.faults), mends.options());
                let offer = || {
                    let faults: Vec<Fault> = faults.iter().copied().cloned().collect();
                    let is_long = of.motion.clip().frames() >= FOR_WORKERS && !faults.is_empty();
                    let task = MendTask { faults, options };
                    is_long.then(|| (task, vec![Arc::clone(&of.motion)]))
                };
                let slice = |mending: Option<Box<Mending>>| {
                    let begin = || Mending::new(&of.motion, &faults, &options).map(Box::new);
                    let mut mending = match mending.map_or_else(begin, Ok) {
                        Ok(mending) => mending,
                        Err(error) => return ControlFlow::Break(Err(error.into())),
                    };
                    match mending.advance() {
                        Ok(true) => ControlFlow::Continue(mending),
                        Ok(false) => ControlFlow::Break(Ok(with_slide(mending.finish()))),
                        Err(error) => ControlFlow::Break(Err(error.into())),
                    }
                };
                match mending.advance(jobs, offer, |answer| Some(Ok(answer)), slice) {
                    Step::On(mending) => return Step::On(Work::Mend { of, mends, mending }),
                    Step::Waits(mending) => return Step::Waits(Work::Mend { of, mends, mending }),
                    Step::Done(made) => keep(&mut self.cleaned, Cleaned { of, mends, made }),
                }
            }
        }
        Step::Done(())
    }
}

/// Keeps a result, and drops the oldest beyond twice the number of panes.
fn keep<T>(known: &mut Vec<Arc<T>>, found: T) {
    known.push(Arc::new(found));
    let surplus = known.len().saturating_sub(2 * MAX_PANES);
    known.drain(..surplus);
}

impl Sliced for CleanCache {
    fn clear_requests(&mut self) {
        self.is_ready = false;
        for pending in &mut self.under_way {
            pending.is_wanted = false;
        }
    }

    fn work(&mut self, jobs: &mut JobBoard) -> bool {
        self.under_way.retain(|at| at.is_wanted);
        let mut under_way = std::mem::take(&mut self.under_way);
        let worked = work_on_first(&mut under_way, |Pending { is_wanted, work }| {
            match self.step(work, jobs) {
                Step::On(work) => Step::On(Pending { is_wanted, work }),
                Step::Waits(work) => Step::Waits(Pending { is_wanted, work }),
                Step::Done(()) => Step::Done(()),
            }
        });
        self.under_way = under_way;
        self.is_ready |= worked.is_some_and(|flow| flow.is_break());
        worked.is_some()
    }

    fn is_ready(&self) -> bool {
        self.is_ready
    }

    fn progress(&self) -> Option<(JobKind, f64)> {
        let pending = self.under_way.first()?;
        let progress = match &pending.work {
            Work::Search { search, .. } => {
                0.7 * search.here().map_or(0.0, |search| search.progress())
            }
            Work::Mend { mending, .. } => {
                0.7 + 0.3 * mending.here().map_or(0.0, |mending| mending.progress())
            }
        };
        Some((JobKind::Cleaning, f64::from(progress)))
    }
}
