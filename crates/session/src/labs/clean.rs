//! The Clean lab: the faults of a take are listed, and mended one by one or all together.

mod cache;

pub(crate) use self::cache::CleanCache;

use self::cache::{Cleaned, Searched};
use super::feet::slide;
use super::lab::{HasPart, Inputs, Lab, LabClips, LabInputs};
use super::{LabFacts, Outcome};
use crate::choices::Mending;
use crate::labs::LabError;
use crate::metrics::{Metric, MetricId};
use crate::params::{Key, Params};
use segue_motion::clean::{Fault, FaultKind, MendOptions, find_faults, mend};
use segue_motion::clip::Motion;
use segue_text::{Message, msg};
use std::ops::Range;
use std::sync::Arc;

/// The Clean lab: one take without its faults.
pub(super) struct CleanLab;

impl<S: HasPart<CleanCache>> Lab<S> for CleanLab {
    fn result_name(&self, params: &Params, a: Message, _b: Message) -> Message {
        if is_mended(params) { msg!("{a}, cleaned", a) } else { msg!("{a}, with faults", a) }
    }

    fn file_stem(&self, params: &Params) -> String {
        format!("{} clean", params.text(Key::A))
    }

    fn is_clip_as_it_is(&self, params: &Params) -> bool {
        !is_mended(params) && params.number(Key::CleanFaults) == 0.0
    }

    fn captured_link(&self) -> Option<&'static str> {
        Some("a=cmu16_walk")
    }

    fn inputs(
        &self,
        labs: &mut S,
        clips: LabClips,
        params: &Params,
        _match_window: usize,
    ) -> Result<Option<Inputs>, LabError> {
        let cache = HasPart::<CleanCache>::part(labs);
        Ok(Some(Inputs::new(cache.inputs(clips.first()?, params)?)))
    }
}

/// Returns whether faults are mended, rather than shown.
fn is_mended(params: &Params) -> bool {
    params.choice::<Mending>() == Mending::Mended
}

/// Returns the switch of a kind of fault.
const fn switch_of(kind: FaultKind) -> Key {
    match kind {
        FaultKind::Swap => Key::CleanSwaps,
        FaultKind::Gap => Key::CleanGaps,
        FaultKind::Spike => Key::CleanSpikes,
        FaultKind::Jitter => Key::CleanJitter,
        FaultKind::Drift => Key::CleanDrift,
        FaultKind::Ground => Key::CleanGround,
        FaultKind::Ends => Key::CleanEnds,
        FaultKind::Skating => Key::CleanSkating,
        FaultKind::Rate => Key::CleanRate,
    }
}

/// A choice of mends.
#[derive(Clone, Debug, PartialEq)]
struct Mends {
    is_on: bool,
    /// The least confidence.
    least: f32,
    kinds: Vec<FaultKind>,
    /// The faults that are left alone, by kind and first frame.
    skipped: Vec<(FaultKind, usize)>,
    cutoff_hz: Option<f64>,
}

impl Mends {
    fn of(params: &Params) -> Self {
        let is_on = |kind: &FaultKind| params.is_on(switch_of(*kind));
        Self {
            is_on: is_mended(params),
            least: (params.number(Key::CleanSure) / 100.0) as f32,
            kinds: FaultKind::ALL.into_iter().filter(is_on).collect(),
            skipped: params.faults_left_alone().to_vec(),
            cutoff_hz: params.optional(Key::CleanCutoff),
        }
    }

    /// Returns whether a fault is chosen, even while nothing is mended.
    fn choose(&self, fault: &Fault) -> bool {
        self.kinds.contains(&fault.kind)
            && fault.confidence >= self.least
            && !self.skipped.contains(&(fault.kind, fault.frames.start))
    }

    /// Returns the chosen faults; none while nothing is mended.
    fn faults_to_mend<'a>(&self, faults: &'a [Fault]) -> Vec<&'a Fault> {
        faults.iter().filter(|fault| self.is_on && self.choose(fault)).collect()
    }

    fn options(&self) -> MendOptions {
        MendOptions { cutoff_hz: self.cutoff_hz, ..MendOptions::default() }
    }
}

/// Returns a take mended as the Clean lab mends it by default, and the number of faults that were
/// mended. Without a session, and all at once.
///
/// # Errors
/// [`LabError`] if its feet cannot be held.
pub fn cleaned(motion: &Arc<Motion>) -> Result<(Arc<Motion>, usize), LabError> {
    let mends = Mends::of(&Params::default());
    let faults = find_faults(motion);
    let chosen = mends.faults_to_mend(&faults);
    Ok((mend(motion, &chosen, &mends.options())?.motion, chosen.len()))
}

/// A fault of the take, and what is done about it.
#[derive(Clone, Debug, PartialEq)]
pub struct FoundFault {
    /// The fault, in frames of the take.
    pub fault: Fault,
    /// Whether its mend is chosen.
    pub is_chosen: bool,
    /// Whether it is certain enough.
    pub is_sure: bool,
}

/// Facts about a cleaned take.
#[derive(Clone, Debug, PartialEq)]
pub struct CleanFacts {
    /// The faults, by kind and in order of time.
    pub faults: Vec<FoundFault>,
    /// The frames of the take that are left.
    pub frames: Range<usize>,
    /// The number of frames of the take.
    pub take_frames: usize,
    /// The number of faults that were injected.
    pub injected: usize,
    /// Whether anything is mended.
    pub mends: bool,
}

impl CleanFacts {
    /// Returns the kinds that were found, with their faults by number, in the order in which they
    /// are mended.
    #[must_use]
    pub fn kinds(&self) -> Vec<(FaultKind, Vec<usize>)> {
        let of = |kind: FaultKind| -> Vec<usize> {
            let all = self.faults.iter().enumerate();
            all.filter(|(_, found)| found.fault.kind == kind).map(|(at, _)| at).collect()
        };
        let kinds = FaultKind::ALL.into_iter().map(|kind| (kind, of(kind)));
        kinds.filter(|(_, found)| !found.is_empty()).collect()
    }

    /// Returns the switch of a kind of fault.
    #[must_use]
    pub const fn switch_of(kind: FaultKind) -> Key {
        switch_of(kind)
    }

    /// Returns the frame of the result that shows a frame of the take.
    #[must_use]
    pub fn frame_in_result(&self, frame: usize) -> usize {
        let last = self.frames.len().saturating_sub(1);
        frame.saturating_sub(self.frames.start).min(last)
    }
}

impl Outcome {
    /// Returns the facts about a cleaned take; `None` for results of other labs, and while faults
    /// are looked for.
    #[must_use]
    pub fn cleaned(&self) -> Option<&Arc<CleanFacts>> {
        self.facts.get::<CleanFacts>()
    }
}

/// The inputs of the result. Equal inputs give equal results.
#[derive(Clone, Debug)]
pub(crate) struct CleanInputs {
    motion: Arc<Motion>,
    mends: Mends,
    /// The faults and their mends; `None` while they are computed.
    found: Option<(Arc<Searched>, Arc<Cleaned>)>,
}

impl PartialEq for CleanInputs {
    fn eq(&self, other: &Self) -> bool {
        let same_found = match (&self.found, &other.found) {
            (Some(a), Some(b)) => Arc::ptr_eq(&a.0, &b.0) && Arc::ptr_eq(&a.1, &b.1),
            (None, None) => true,
            _ => false,
        };
        Arc::ptr_eq(&self.motion, &other.motion) && self.mends == other.mends && same_found
    }
}

impl LabInputs for CleanInputs {
    fn run(&self) -> Result<Outcome, LabError> {
        let Some((searched, cleaned)) = &self.found else {
            return Ok(Outcome::plain(Arc::clone(&self.motion)));
        };
        let (mended, slid) = cleaned.made.clone()?;
        let faults: Vec<FoundFault> = (searched.faults.iter())
            .map(|fault| FoundFault {
                is_chosen: self.mends.choose(fault),
                is_sure: fault.confidence >= self.mends.least,
                fault: fault.clone(),
            })
            .collect();
        let goes = |found: &&FoundFault| self.mends.is_on && found.is_chosen;
        let mends = faults.iter().filter(goes).count();
        let left = faults.iter().filter(|found| found.is_sure && !goes(found)).count();
        let motion = &mended.motion;
        let metrics = vec![
            Metric::new(MetricId::FaultsLeft, left as f64),
            Metric::new(MetricId::FaultsMended, mends as f64),
            slide(slid, motion.clip().fps()),
        ];
        let facts = CleanFacts {
            faults,
            frames: mended.frames.clone(),
            take_frames: searched.motion.clip().frames(),
            injected: searched.injected,
            mends: self.mends.is_on,
        };
        Ok(Outcome {
            metrics,
            facts: LabFacts::of(Arc::new(facts)),
            ..Outcome::plain(Arc::clone(motion))
        })
    }

    /// Returns whether only the take itself is known so far.
    fn is_draft(&self) -> bool {
        self.found.is_none()
    }
}

#[cfg(test)]
mod tests;
