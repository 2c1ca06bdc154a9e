//! Searches for faults and their mends, computed in slices and kept between results.

use super::super::sliced::{JobKind, Sliced};
use super::{CleanInputs, Mends};
use crate::jobs::JobBoard;
use crate::labs::LabError;
use crate::params::{Key, MAX_PANES, Params};
use segue_motion::clean::{Fault, FaultSearch, MendOptions, Mended, Mending, damage};
use segue_motion::clip::Motion;
use std::sync::Arc;

/// Takes of up to this number of frames are searched and mended at once.
const AT_ONCE: usize = 500;

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
    pub(super) made: Result<Mended, LabError>,
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
    job: Job,
}

#[derive(Debug)]
enum Job {
    Search {
        of: Arc<Motion>,
        broken: Broken,
        motion: Arc<Motion>,
        injected: usize,
        search: Box<FaultSearch>,
    },
    Mend {
        of: Arc<Searched>,
        mends: Mends,
        mending: Box<Mending>,
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
            && let Some(cleaned) = self.mend(&searched, &mends, at_once)?
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
        let pending = self.under_way.iter_mut().find(|at| match &at.job {
            Job::Search { of, broken, .. } => is_it(of, *broken),
            Job::Mend { .. } => false,
        });
        if let Some(pending) = pending {
            pending.is_wanted = true;
            return Ok(None);
        }
        let (broken_motion, injected) = broken.apply(motion)?;
        let job = Job::Search {
            of: Arc::clone(motion),
            broken,
            search: Box::new(FaultSearch::new(Arc::clone(&broken_motion))),
            motion: broken_motion,
            injected,
        };
        self.begin(job, at_once);
        let known = self.searched.iter().find(|known| is_it(&known.of, known.broken));
        Ok(known.cloned())
    }

    fn mend(
        &mut self,
        searched: &Arc<Searched>,
        mends: &Mends,
        at_once: bool,
    ) -> Result<Option<Arc<Cleaned>>, LabError> {
        let is_it = |of: &Arc<Searched>, by: &Mends| Arc::ptr_eq(of, searched) && by == mends;
        if let Some(known) = self.cleaned.iter().find(|known| is_it(&known.of, &known.mends)) {
            return Ok(Some(Arc::clone(known)));
        }
        let pending = self.under_way.iter_mut().find(|at| match &at.job {
            Job::Mend { of, mends, .. } => is_it(of, mends),
            Job::Search { .. } => false,
        });
        if let Some(pending) = pending {
            pending.is_wanted = true;
            return Ok(None);
        }
        let chosen: Vec<&Fault> =
            searched.faults.iter().filter(|fault| mends.is_on && mends.choose(fault)).collect();
        let options = MendOptions { cutoff_hz: mends.cutoff_hz, ..MendOptions::default() };
        let is_quick = at_once || chosen.is_empty();
        let mending = Box::new(Mending::new(&searched.motion, &chosen, &options)?);
        let job = Job::Mend { of: Arc::clone(searched), mends: mends.clone(), mending };
        self.begin(job, is_quick);
        let known = self.cleaned.iter().find(|known| is_it(&known.of, &known.mends));
        Ok(known.cloned())
    }

    fn begin(&mut self, job: Job, at_once: bool) {
        if at_once {
            let mut job = Some(job);
            while let Some(next) = job {
                job = self.step(next);
            }
        } else {
            self.under_way.push(Pending { is_wanted: true, job });
        }
    }

    /// Does one slice. Returns the rest of the job; keeps what is done.
    fn step(&mut self, job: Job) -> Option<Job> {
        match job {
            Job::Search { of, broken, motion, injected, mut search } => {
                if search.advance() {
                    return Some(Job::Search { of, broken, motion, injected, search });
                }
                let faults = search.finish();
                let found = Searched { of, broken, motion, injected, faults };
                keep(&mut self.searched, found);
            }
            Job::Mend { of, mends, mut mending } => {
                let made = match mending.advance() {
                    Ok(true) => return Some(Job::Mend { of, mends, mending }),
                    Ok(false) => Ok(mending.finish()),
                    Err(error) => Err(error.into()),
                };
                keep(&mut self.cleaned, Cleaned { of, mends, made });
            }
        }
        None
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

    fn work(&mut self, _jobs: &mut JobBoard) -> bool {
        self.under_way.retain(|at| at.is_wanted);
        if self.under_way.is_empty() {
            return false;
        }
        let Pending { is_wanted, job } = self.under_way.remove(0);
        match self.step(job) {
            Some(job) => self.under_way.insert(0, Pending { is_wanted, job }),
            None => self.is_ready = true,
        }
        true
    }

    fn is_ready(&self) -> bool {
        self.is_ready
    }

    fn progress(&self) -> Option<(JobKind, f64)> {
        let pending = self.under_way.first()?;
        let progress = match &pending.job {
            Job::Search { search, .. } => 0.7 * search.progress(),
            Job::Mend { mending, .. } => 0.7 + 0.3 * mending.progress(),
        };
        Some((JobKind::Cleaning, f64::from(progress)))
    }
}
