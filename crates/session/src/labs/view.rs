//! The View lab: one clip, with its planted feet locked, at another place or without its root
//! motion, and its metrics.

use super::delegated::Delegated;
use super::feet::{Lock, locking, slide_before};
use super::lab::{HasPart, Inputs, Lab, LabClips, LabInputs, can_change_result};
use super::request_cache::RequestCache;
use super::sliced::{JobKind, Sliced};
use super::{ArtefactMeter, MeasuredMotion, Outcome};
use crate::contact_edits::with_own_edits;
use crate::jobs::{JobBoard, ViewAnswer, ViewTask};
use crate::labs::LabError;
use crate::metrics::{Metric, MetricId};
use crate::params::{Compare, Key, Kind, MAX_PANES, PARAMS, Param, Params, Value};
use crate::{LabId, choices};
use segue_motion::clip::{Clip, Motion, take_in_place};
use segue_motion::math::Planar;
use segue_motion::metrics::{ClipMeter, ClipMetrics, Extreme, SlideMeter};
use segue_motion::path::{FitOptions, FittedPath};
use segue_motion::transition::FootLocking;
use segue_text::{Message, msg};
use std::ops::ControlFlow;
use std::sync::Arc;

/// The View lab: one clip, placed on the ground.
pub(super) struct ViewLab;

impl<S: HasPart<ViewCache>> Lab<S> for ViewLab {
    fn result_name(&self, params: &Params, a: Message, _b: Message) -> Message {
        let is_placed = [Key::PlaceX, Key::PlaceZ, Key::PlaceHeading]
            .iter()
            .any(|&key| params.optional(key).is_some());
        let held = if params.is_on(Key::FootLock) { msg!("{a}, feet held", a) } else { a };
        match params.choice() {
            choices::RootMotion::InPlace => msg!("{held}, in place", held),
            choices::RootMotion::Residual => msg!("{held}, beside its path", held),
            choices::RootMotion::World if is_placed => msg!("{held}, moved", held),
            choices::RootMotion::World if !params.contact_edits().is_empty() => {
                msg!("{held}, contacts corrected", held)
            }
            choices::RootMotion::World => held,
        }
    }

    fn file_stem(&self, params: &Params) -> String {
        params.text(Key::A).to_owned()
    }

    fn with_clips(&self, ids: &[String]) -> Option<Vec<(Key, Value)>> {
        let first = ids.first().filter(|_| ids.len() <= MAX_PANES)?;
        let values = ids.iter().map(|id| Value::Text(id.clone())).collect();
        let compare = (ids.len() > 1).then_some(Compare { key: Key::A, values });
        Some(vec![(Key::A, Value::Text(first.clone())), (Key::Compare, Value::Compare(compare))])
    }

    fn is_clip_as_it_is(&self, params: &Params) -> bool {
        let params = &with_own_edits(params);
        let changes = |param: &Param| {
            !matches!(param.kind, Kind::Clip)
                && param.is_used_by(LabId::View)
                && can_change_result(params, param.key)
                && params.is_changed(param.key)
        };
        !PARAMS.iter().any(changes)
    }

    fn shows_clip(&self) -> bool {
        true
    }

    fn inputs(
        &self,
        labs: &mut S,
        clips: LabClips,
        params: &Params,
        _match_window: usize,
    ) -> Result<Option<Inputs>, LabError> {
        Ok(HasPart::<ViewCache>::part(labs).inputs(clips.first()?, params).map(Inputs::new))
    }
}

/// Clips of up to this number of frames are processed at once: about 8 ms for 31 joints.
const AT_ONCE: usize = 1_000;
/// The number of frames in one slice of work: about 2 ms for 31 joints in a browser.
const PER_SLICE: usize = 500;
/// The number of frames from which on a worker locks and measures: what takes it longer than to
/// begin.
const FOR_WORKERS: usize = 8_000;

/// Returns the metrics of a clip as it is: those that the View lab shows, without a session. Empty
/// for a clip that cannot be shown.
#[must_use]
pub fn metrics_of_clip(motion: &Arc<Motion>) -> Vec<Metric> {
    let (mut cache, mut meter) = (ViewCache::default(), ArtefactMeter::default());
    let params = Params::default();
    // Without workers, everything is computed here.
    let jobs = &mut JobBoard::default();
    // A long clip is measured in slices: it is asked for once before and once after the work.
    let mut inputs = cache.inputs(motion, &params);
    while cache.work(jobs) {
        inputs = cache.inputs(motion, &params);
    }
    let Some(Ok(mut outcome)) = inputs.map(|inputs| inputs.run()) else {
        return Vec::new();
    };
    let mut found = meter.numbers(&outcome);
    while found.is_none() && meter.work(jobs) {
        found = meter.numbers(&outcome);
    }
    outcome.take_numbers(found);
    outcome.metrics
}

/// The inputs of a view. Equal inputs give equal results.
#[derive(Clone, Debug)]
pub(crate) struct ViewInputs {
    motion: Arc<Motion>,
    viewed: Option<Arc<ViewResult>>,
    ground: Ground,
}

impl PartialEq for ViewInputs {
    fn eq(&self, other: &Self) -> bool {
        let same_view = match (&self.viewed, &other.viewed) {
            (Some(a), Some(b)) => a.lock == b.lock,
            (None, None) => true,
            _ => false,
        };
        Arc::ptr_eq(&self.motion, &other.motion) && same_view && self.ground == other.ground
    }
}

impl LabInputs for ViewInputs {
    fn run(&self) -> Result<Outcome, LabError> {
        let shown = match &self.viewed {
            None => Outcome::plain(Arc::clone(&self.motion)),
            Some(viewed) => viewed.made.clone()?,
        };
        let measured = MeasuredMotion::Clip(Arc::clone(shown.motion.clip()));
        let mut motion = self.ground.moved(&shown.motion)?;
        if !motion.contact_corrections().is_empty() {
            // A kept result has no corrections of its own: its contacts are those that it shows.
            let contacts = motion.contacts().clone();
            motion = Arc::new(Motion::clone(&motion).with_contacts(contacts));
        }
        Ok(Outcome { motion, measured, ..shown })
    }

    /// Returns whether only the clip itself is known so far.
    fn is_draft(&self) -> bool {
        self.viewed.is_none()
    }
}

/// The part of the root motion that is removed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum RootMotion {
    /// Nothing.
    World,
    /// The position and facing of the character, frame by frame.
    InPlace,
    /// The path and its direction: the residual motion of path editing is left.
    Residual,
}

/// The placement of a clip on the ground.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Ground {
    root_motion: RootMotion,
    /// The position of the first frame, (x, z) in metres, and its facing, degrees; unchanged if not
    /// given.
    start: [Option<f64>; 2],
    heading_deg: Option<f64>,
}

impl Ground {
    fn of(params: &Params) -> Self {
        Self {
            root_motion: match params.choice::<choices::RootMotion>() {
                choices::RootMotion::InPlace => RootMotion::InPlace,
                choices::RootMotion::Residual => RootMotion::Residual,
                choices::RootMotion::World => RootMotion::World,
            },
            start: [Key::PlaceX, Key::PlaceZ].map(|key| params.optional(key)),
            heading_deg: params.optional(Key::PlaceHeading),
        }
    }

    /// Returns the motion at this placement.
    fn moved(&self, motion: &Arc<Motion>) -> Result<Arc<Motion>, LabError> {
        let frames = motion.ground_frames();
        let mut moves = match self.root_motion {
            RootMotion::World if self.start == [None; 2] && self.heading_deg.is_none() => {
                return Ok(Arc::clone(motion));
            }
            RootMotion::World => vec![Planar::IDENTITY; frames.len()],
            RootMotion::InPlace => take_in_place(frames, true),
            RootMotion::Residual => {
                let path = FittedPath::new(Arc::clone(motion), &FitOptions::default())?;
                path.places().iter().map(|place| place.frame.inverse()).collect()
            }
        };
        let Some(first) =
            frames.first().zip(moves.first()).map(|(frame, planar)| planar.after(frame))
        else {
            return Ok(Arc::clone(motion));
        };
        let wanted = Planar::new(
            self.heading_deg.map_or(first.yaw, f64::to_radians),
            self.start[0].unwrap_or(first.shift.x),
            self.start[1].unwrap_or(first.shift.y),
        );
        let there = wanted.after(&first.inverse());
        for planar in &mut moves {
            *planar = there.after(planar);
        }
        let placed = moves.iter().zip(frames).map(|(planar, frame)| planar.after(frame));
        let clip = motion.clip().transformed_by_frame(&moves);
        Ok(Arc::new(motion.with_clip(clip, placed.collect())))
    }
}

/// The result for one clip.
#[derive(Debug)]
struct ViewResult {
    lock: Option<Lock>,
    made: Result<Outcome, LabError>,
}

/// A cache of locked and measured clips that panes ask for, with their work.
#[derive(Debug, Default)]
pub(crate) struct ViewCache {
    cache: RequestCache<ViewOf, Delegated<ViewTask, Stage>, Arc<ViewResult>>,
}

/// A clip, and how its feet are locked.
type ViewOf = (Arc<Motion>, Option<Lock>);

#[derive(Debug)]
enum Stage {
    /// Measures the unlocked feet of a clip that will be locked.
    Before(Lock, Box<SlideMeter>),
    Locking {
        /// The foot slide before locking.
        before: Option<Extreme>,
        locking: Box<FootLocking>,
    },
    Measuring {
        /// The clip as it will be shown.
        motion: Arc<Motion>,
        /// The foot slide before locking, for a clip with locked feet.
        before: Option<Metric>,
        meter: Box<ClipMeter>,
    },
}

impl Stage {
    fn of((motion, lock): &ViewOf) -> Self {
        match *lock {
            Some(lock) => {
                Self::Before(lock, Box::new(SlideMeter::new(motion.clip(), motion.roles())))
            }
            None => Self::measuring(Arc::clone(motion), None),
        }
    }

    fn measuring(motion: Arc<Motion>, before: Option<Metric>) -> Self {
        let meter = Box::new(ClipMeter::new(motion.clip(), motion.roles(), motion.ground_m()));
        Self::Measuring { motion, before, meter }
    }
}

impl ViewCache {
    /// Returns the clip of the parameters, with its feet locked if they are to be. `None` if that
    /// takes longer than a frame: call [`work`](Self::work), then ask again. An unchanged clip is
    /// returned at once, and later again with its metrics.
    pub(crate) fn inputs(&mut self, motion: &Arc<Motion>, params: &Params) -> Option<ViewInputs> {
        let lock = Lock::of(params);
        let viewed = self.viewed((Arc::clone(motion), lock));
        (viewed.is_some() || lock.is_none()).then(|| ViewInputs {
            motion: Arc::clone(motion),
            viewed,
            ground: Ground::of(params),
        })
    }

    fn viewed(&mut self, of: ViewOf) -> Option<Arc<ViewResult>> {
        let is_it = |(motion, lock): &ViewOf| Arc::ptr_eq(motion, &of.0) && *lock == of.1;
        if let Some(known) = self.cache.request(|of, _| is_it(of)) {
            return Some(Arc::clone(known));
        }
        if self.cache.is_under_way(is_it) {
            return None;
        }
        if of.0.clip().frames() > AT_ONCE {
            self.cache.begin(of, Delegated::New);
            return None;
        }
        let mut stage = Stage::of(&of);
        let made = loop {
            stage = match next(&of.0, stage) {
                ControlFlow::Continue(stage) => stage,
                ControlFlow::Break(made) => break made,
            };
        };
        let viewed = Arc::new(ViewResult { lock: of.1, made });
        self.cache.keep(of, Arc::clone(&viewed));
        Some(viewed)
    }
}

impl Sliced for ViewCache {
    fn clear_requests(&mut self) {
        self.cache.clear_requests();
    }

    fn work(&mut self, jobs: &mut JobBoard) -> bool {
        self.cache.work(|of, work| {
            let (motion, lock) = of;
            let view = |made| Arc::new(ViewResult { lock: *lock, made });
            let offer = || {
                let is_long = motion.clip().frames() >= FOR_WORKERS;
                let lock = lock.map(|lock| lock.on_ground(motion.ground_m()));
                is_long.then(|| (ViewTask { lock }, vec![Arc::clone(motion)]))
            };
            let taken = |ViewAnswer { locked, before, found }: ViewAnswer| {
                let shown = match locked {
                    Some(locked) => Arc::new(with_locked_feet(motion, locked)),
                    None => Arc::clone(motion),
                };
                let before = lock.map(|_| slide_before(before));
                Some(view(Ok(outcome(shown, before, &found))))
            };
            work.advance(jobs, offer, taken, |stage| {
                next(motion, stage.unwrap_or_else(|| Stage::of(of))).map_break(view)
            })
        })
    }

    fn is_ready(&self) -> bool {
        self.cache.is_ready()
    }

    fn progress(&self) -> Option<(JobKind, f64)> {
        // Metrics alone are quick, so no progress is reported, except where a worker takes them.
        let is_long = |motion: &Motion| motion.clip().frames() >= FOR_WORKERS;
        let mut under_way = self.cache.under_way();
        let ((_, lock), work) =
            under_way.find(|((motion, lock), _)| lock.is_some() || is_long(motion))?;
        let kind = if lock.is_some() { JobKind::HoldingFeet } else { JobKind::Analyzing };
        let progress = match work.here() {
            None | Some(Stage::Before(..)) => 0.0,
            Some(Stage::Locking { locking, .. }) => 0.2 + 0.6 * locking.progress(),
            Some(Stage::Measuring { motion, meter, .. }) => {
                let own = if lock.is_some() { 0.8 } else { 0.0 };
                own + (1.0 - own) * meter.progress(motion.clip())
            }
        };
        Some((kind, f64::from(progress)))
    }
}

/// Returns a clip whose feet are locked. Hips are only raised and lowered, so the character's
/// ground frames stay.
fn with_locked_feet(of: &Motion, locked: Clip) -> Motion {
    of.with_clip(locked, of.ground_frames().to_vec())
}

/// Returns the result that shows a motion.
fn outcome(motion: Arc<Motion>, before: Option<Metric>, found: &ClipMetrics) -> Outcome {
    let fps = motion.clip().fps();
    let at = |id, value: Option<f64>, frame| Metric::at_frame(id, value, frame, fps);
    let slide = at(MetricId::FootSlide, found.foot_slide_cm, found.foot_slide_at);
    let slides = std::iter::once(slide).chain(before);
    let faults = [
        at(MetricId::ClipPenetration, found.penetration_cm, found.penetration_at),
        at(MetricId::ClipPositionJump, found.jump_cm, found.jump_at),
    ];
    Outcome { metrics: slides.chain(faults).collect(), ..Outcome::plain(motion) }
}

/// Does one slice of the work for a clip.
fn next(of: &Arc<Motion>, stage: Stage) -> ControlFlow<Result<Outcome, LabError>, Stage> {
    ControlFlow::Continue(match stage {
        Stage::Before(lock, mut meter) => {
            if meter.advance(of.clip(), of.contacts(), PER_SLICE) {
                return ControlFlow::Continue(Stage::Before(lock, meter));
            }
            let before = meter.worst();
            match locking(Arc::clone(of.clip()), of.roles(), of.contacts(), of.ground_m(), lock) {
                Ok(Some(locking)) => Stage::Locking { before, locking: Box::new(locking) },
                Ok(None) => Stage::measuring(Arc::clone(of), Some(slide_before(before))),
                Err(error) => return ControlFlow::Break(Err(error)),
            }
        }
        Stage::Locking { before, mut locking } => {
            if locking.advance(PER_SLICE) {
                return ControlFlow::Continue(Stage::Locking { before, locking });
            }
            match locking.finish() {
                Ok(locked) => Stage::measuring(
                    Arc::new(with_locked_feet(of, locked)),
                    Some(slide_before(before)),
                ),
                Err(error) => return ControlFlow::Break(Err(error.into())),
            }
        }
        Stage::Measuring { motion, before, mut meter } => {
            if meter.advance(motion.clip(), motion.contacts(), PER_SLICE) {
                return ControlFlow::Continue(Stage::Measuring { motion, before, meter });
            }
            let found = meter.finish(motion.ground_frames());
            return ControlFlow::Break(Ok(outcome(motion, before, &found)));
        }
    })
}
