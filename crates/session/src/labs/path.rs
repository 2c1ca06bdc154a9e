//! The Path lab: a motion on another path.

use super::feet::{Lock, locking, slide, slide_before};
use super::lab::{Beside, HasPart, Inputs, Lab, LabClips, LabInputs};
use super::request_cache::RequestCache;
use super::sliced::{JobKind, Sliced};
use super::{LabFacts, Outcome, PlacedClip, Slot};
use crate::choices;
use crate::extra_characters::MAX_CHARACTERS;
use crate::jobs::JobBoard;
use crate::labs::LabError;
use crate::metrics::{Metric, MetricId};
use crate::params::{Key, List, Params, Value};
use locked_feet::{LockedFeet, LockedFeetCache};
use segue_motion::clip::{Clip, Contacts, Motion};
use segue_motion::math::Planar;
use segue_motion::metrics::{Extreme, SlideMeter, foot_slide_cm, worst_foot_slide};
use segue_motion::path::{
    ArcLengthPath, CarryOptions, EditedMotion, FitError, FitOptions, FittedPath, GroundSpline,
    HardTurn, MotionCarrying, Offset, Orientation, PathEditError, PathEditor, PathFitting, Slide,
    SplineEnds, Timing, Waypoint,
};
use segue_motion::transition::FootLocking;
use segue_text::{Message, msg};
use std::ops::ControlFlow;
use std::sync::Arc;

mod locked_feet;

/// The Path lab: a clip on an edited path.
pub(super) struct PathLab;

impl<S: HasPart<Paths>> Lab<S> for PathLab {
    fn listed(&self, params: &Params) -> Vec<String> {
        params.clip_ids(Key::Others).to_vec()
    }

    fn without_clip(&self, params: &Params, id: &str) -> Vec<(Key, Value)> {
        let ids = Lab::<S>::listed(self, params);
        let others: Vec<String> = ids.iter().filter(|known| *known != id).cloned().collect();
        if others.len() == ids.len() {
            return Vec::new();
        }
        vec![(Key::Others, List::ClipIds(others).into())]
    }

    fn with_clips(&self, ids: &[String]) -> Option<Vec<(Key, Value)>> {
        let (first, others) = ids.split_first()?;
        let others: Vec<String> = others.iter().take(MAX_CHARACTERS).cloned().collect();
        Some(vec![
            (Key::A, Value::Text(first.clone())),
            (Key::Others, List::ClipIds(others).into()),
        ])
    }

    fn result_name(&self, _params: &Params, a: Message, _b: Message) -> Message {
        msg!("{a} on a path", a)
    }

    fn file_stem(&self, params: &Params) -> String {
        format!("{} on a path", params.text(Key::A))
    }

    fn captured_link(&self) -> Option<&'static str> {
        Some("a=cmu16_walk")
    }

    fn has(&self, beside: Beside) -> bool {
        beside == Beside::ExtraCharacters
    }

    fn inputs(
        &self,
        labs: &mut S,
        clips: LabClips,
        params: &Params,
        _match_window: usize,
    ) -> Result<Option<Inputs>, LabError> {
        let inputs = HasPart::<Paths>::part(labs).inputs(clips.first()?, params)?;
        Ok(inputs.map(Inputs::new))
    }
}

/// A motion and the path that was fitted to its trajectory, which stay the same while the path is
/// edited.
#[derive(Debug)]
pub struct FittedMotion {
    motion: Arc<Motion>,
    editor: PathEditor,
    curve: Arc<ArcLengthPath>,
    error: FitError,
    errors_cm: Vec<[f64; 2]>,
}

impl FittedMotion {
    fn new(path: FittedPath, slide_cm: Option<f64>) -> Self {
        let motion = Arc::clone(path.source());
        let contacts = motion.contacts().clone();
        let off = path.residuals().map(|residual| residual.shift.length() * 100.0);
        Self {
            curve: Arc::new(path.curve().clone()),
            error: path.error(),
            errors_cm: path
                .places()
                .iter()
                .map(|place| place.along_m)
                .zip(off)
                .map(Into::into)
                .collect(),
            editor: PathEditor::with_slide_cm(path, motion.roles(), contacts, slide_cm),
            motion,
        }
    }

    /// Returns the motion before editing.
    #[must_use]
    pub fn motion(&self) -> &Arc<Motion> {
        &self.motion
    }

    /// Returns the fitted path.
    #[must_use]
    pub fn curve(&self) -> &Arc<ArcLengthPath> {
        &self.curve
    }

    /// Returns the place on the fitted path for every frame of the motion.
    #[must_use]
    pub fn places(&self) -> &[Waypoint] {
        self.editor.path().places()
    }

    /// Returns the distance of the hips from the path.
    #[must_use]
    pub fn error(&self) -> FitError {
        self.error
    }

    /// Returns the distances frame by frame: centimetres along the path, and centimetres away from
    /// it.
    #[must_use]
    pub fn errors_cm(&self) -> &[[f64; 2]] {
        &self.errors_cm
    }
}

/// Facts about a motion on an edited path.
#[derive(Clone, Debug)]
pub struct PathFacts {
    /// The motion before it was edited.
    pub fitted: Arc<FittedMotion>,
    /// The edited path.
    pub curve: Arc<ArcLengthPath>,
    /// Whether it differs from the fitted path.
    pub is_edited: bool,
    /// The place on the path for every frame of the result.
    pub places: Vec<Waypoint>,
    /// The places at which the path turns faster than the motion can.
    pub hard_turns: Vec<HardTurn>,
    /// Whether its feet are to be locked as soon as dragging ends, and are not yet.
    pub awaits_feet: bool,
}

/// The inputs of a motion on a path. Equal inputs give equal results.
#[derive(Clone, Debug)]
pub(crate) struct PathInputs {
    fitted: Arc<FittedMotion>,
    /// The edited path; `None` for the fitted one.
    edited: Option<GroundSpline>,
    carry: CarryOptions,
    /// The motion on the fitted path without foot lock, if it is long; any other is computed with
    /// the result.
    free: Option<Arc<FreeMotion>>,
    /// The foot lock options, if feet are locked.
    lock: Option<Lock>,
    feet: Feet,
}

/// A motion on a path without foot lock.
#[derive(Clone, Debug)]
struct FreeMotion {
    curve: Arc<ArcLengthPath>,
    made: EditedMotion,
}

/// The state of the feet.
#[derive(Clone, Debug)]
enum Feet {
    Free,
    AtOnce,
    Awaited,
    Locked(Arc<LockedFeet>),
}

/// The number of frames whose feet are locked during dragging: about 3 ms for 31 joints in a
/// browser.
const AT_ONCE: usize = 400;

/// The greatest number of frames of a motion that is carried to its fitted path at once; longer
/// ones are carried in slices. A motion on an edited path always follows in the same frame of the
/// display: the next edit begins with what is shown.
const CARRIED_AT_ONCE: usize = 16_000;
/// The number of frames that are carried, or whose slide is measured, in one slice: about 4 ms in a
/// browser.
const FRAMES_PER_SLICE: usize = 12_000;

impl PathInputs {
    /// Returns whether the motion and the path are the same.
    fn is_on_the_same_path(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.fitted, &other.fitted)
            && self.edited == other.edited
            && self.carry == other.carry
    }

    /// Returns whether the motion, the path and the foot lock are the same, whether locked at once
    /// or later.
    fn makes_the_same(&self, other: &Self) -> bool {
        self.is_on_the_same_path(other) && self.lock == other.lock
    }

    /// Begins to carry the motion to its path; [`LabError`] when the path has no length.
    fn begin_carrying(&self) -> Result<FreeMotionCarrying, LabError> {
        let curve = match &self.edited {
            Some(edited) => Arc::new(ArcLengthPath::new(edited.clone())?),
            None => Arc::clone(&self.fitted.curve),
        };
        Ok(FreeMotionCarrying { curve, carrying: MotionCarrying::new(self.carry) })
    }

    /// Returns the motion on the path without foot lock.
    fn free_motion(&self) -> Result<Arc<FreeMotion>, LabError> {
        if let Some(free) = &self.free {
            return Ok(Arc::clone(free));
        }
        let mut carrying = self.begin_carrying()?;
        loop {
            match carrying.advance(&self.fitted, usize::MAX)? {
                ControlFlow::Continue(rest) => carrying = rest,
                ControlFlow::Break(free) => return Ok(Arc::new(free)),
            }
        }
    }
}

/// The computation of a [`FreeMotion`] in slices.
#[derive(Debug)]
struct FreeMotionCarrying {
    curve: Arc<ArcLengthPath>,
    carrying: MotionCarrying,
}

impl FreeMotionCarrying {
    fn advance(
        self,
        fitted: &FittedMotion,
        count: usize,
    ) -> Result<ControlFlow<FreeMotion, Self>, LabError> {
        let Self { curve, carrying } = self;
        Ok(match carrying.advance(&fitted.editor, &curve, count)? {
            ControlFlow::Continue(carrying) => ControlFlow::Continue(Self { curve, carrying }),
            ControlFlow::Break(made) => ControlFlow::Break(FreeMotion { curve, made }),
        })
    }
}

impl PartialEq for PathInputs {
    fn eq(&self, other: &Self) -> bool {
        self.makes_the_same(other)
            && match (&self.feet, &other.feet) {
                (Feet::Locked(a), Feet::Locked(b)) => Arc::ptr_eq(a, b),
                (a, b) => std::mem::discriminant(a) == std::mem::discriminant(b),
            }
    }
}

/// A clip of up to this number of frames gets its path in the frame in which it is chosen: about
/// 4 ms in a browser. Up to [`CARRIED_AT_ONCE`], a change of the fit shows in its own frame: a
/// stage that waits is dimmed, and would flicker while a slider is dragged.
const FITTED_AT_ONCE: usize = 1_500;

/// The motion and the options of a fit.
type FittedOf = (Arc<Motion>, FitOptions);

/// A fit that is under way.
#[derive(Debug)]
enum Fitting {
    Requested,
    UnderWay(Box<PathFitting>),
    /// A path that is fitted; the slide of its motion is measured.
    Fitted(Box<FittedPath>, SlideMeter),
}

impl Fitting {
    /// Does a slice of the work.
    fn advance(
        self,
        (motion, options): &FittedOf,
    ) -> Result<ControlFlow<FittedMotion, Self>, PathEditError> {
        let under_way = |fitting| ControlFlow::Continue(Self::UnderWay(Box::new(fitting)));
        Ok(match self {
            Self::Requested => under_way(PathFitting::new(Arc::clone(motion), options)?),
            Self::UnderWay(fitting) => match fitting.advance()? {
                ControlFlow::Continue(rest) => under_way(rest),
                ControlFlow::Break(path) => {
                    let meter = SlideMeter::new(motion.clip(), motion.roles());
                    ControlFlow::Continue(Self::Fitted(Box::new(path), meter))
                }
            },
            Self::Fitted(path, mut meter) => {
                if meter.advance(motion.clip(), motion.contacts(), FRAMES_PER_SLICE) {
                    ControlFlow::Continue(Self::Fitted(path, meter))
                } else {
                    ControlFlow::Break(FittedMotion::new(*path, meter.worst_cm()))
                }
            }
        })
    }
}

/// A cache of the last fitted paths, which do not change while a point is dragged, and of the long
/// motions that are carried to them.
#[derive(Debug, Default)]
pub(crate) struct Paths {
    fitted: RequestCache<FittedOf, Fitting, Result<Arc<FittedMotion>, LabError>>,
    free: RequestCache<PathInputs, FreeMotionCarrying, Result<Arc<FreeMotion>, LabError>>,
    locked_feet: LockedFeetCache,
}

impl Paths {
    /// Returns the motion on a path of the parameters for a clip; `None` if the path is not fitted
    /// yet, or a long motion not carried to it: call [`work`](Self::work), then ask again.
    pub(crate) fn inputs(
        &mut self,
        motion: &Arc<Motion>,
        params: &Params,
    ) -> Result<Option<PathInputs>, LabError> {
        let options = FitOptions {
            control_points: params.number(Key::ControlPoints) as usize,
            smoothing: params.number(Key::PathSmoothing),
            pin_ends: false,
            ends: spline_ends(params),
        };
        let Some(fitted) = self.fitted(motion, options)? else {
            return Ok(None);
        };
        let mut inputs = PathInputs {
            fitted,
            edited: params.edited_path().cloned(),
            carry: carry_options(params),
            free: None,
            lock: Lock::of(params),
            feet: Feet::Free,
        };
        if motion.clip().frames() > CARRIED_AT_ONCE && inputs.edited.is_none() {
            let is_it = |of: &PathInputs| of.is_on_the_same_path(&inputs);
            let begin = |of: &PathInputs| Ok(ControlFlow::Continue(of.begin_carrying()?));
            inputs.free = self.free.request_or_begin(inputs.clone(), is_it, begin)?;
            if inputs.free.is_none() {
                return Ok(None);
            }
        }
        if inputs.lock.is_some() {
            inputs.feet = if motion.clip().frames() <= AT_ONCE {
                Feet::AtOnce
            } else {
                self.locked_feet.get_or_schedule(&inputs).map_or(Feet::Awaited, Feet::Locked)
            };
        }
        Ok(Some(inputs))
    }

    fn fitted(
        &mut self,
        motion: &Arc<Motion>,
        options: FitOptions,
    ) -> Result<Option<Arc<FittedMotion>>, LabError> {
        let is_new = self.fitted.known(|(of, _)| Arc::ptr_eq(of, motion)).is_none();
        let is_it = |(of, by): &FittedOf| Arc::ptr_eq(of, motion) && *by == options;
        self.fitted.request_or_begin((Arc::clone(motion), options), is_it, |_| {
            let at_once = if is_new { FITTED_AT_ONCE } else { CARRIED_AT_ONCE };
            if motion.clip().frames() > at_once {
                return Ok(ControlFlow::Continue(Fitting::Requested));
            }
            let path = FittedPath::new(Arc::clone(motion), &options)?;
            let slide_cm = foot_slide_cm(motion.clip(), motion.roles(), motion.contacts());
            Ok(ControlFlow::Break(Arc::new(FittedMotion::new(path, slide_cm))))
        })
    }
}

impl Sliced for Paths {
    fn clear_requests(&mut self) {
        self.fitted.clear_requests();
        self.free.clear_requests();
        self.locked_feet.clear_requests();
    }

    fn work(&mut self, _jobs: &mut JobBoard) -> bool {
        let fit = |of: &FittedOf, fitting: Fitting| match fitting.advance(of) {
            Ok(ControlFlow::Continue(rest)) => ControlFlow::Continue(rest),
            Ok(ControlFlow::Break(fitted)) => ControlFlow::Break(Ok(Arc::new(fitted))),
            Err(problem) => ControlFlow::Break(Err(problem.into())),
        };
        let carry = |of: &PathInputs, carrying: FreeMotionCarrying| match carrying
            .advance(&of.fitted, FRAMES_PER_SLICE)
        {
            Ok(ControlFlow::Continue(rest)) => ControlFlow::Continue(rest),
            Ok(ControlFlow::Break(free)) => ControlFlow::Break(Ok(Arc::new(free))),
            Err(problem) => ControlFlow::Break(Err(problem)),
        };
        self.fitted.work(fit) || self.free.work(carry) || self.locked_feet.work()
    }

    fn is_ready(&self) -> bool {
        self.fitted.is_ready() || self.free.is_ready() || self.locked_feet.is_ready()
    }

    fn progress(&self) -> Option<(JobKind, f64)> {
        if self.fitted.under_way().next().is_some() {
            return Some((JobKind::Analyzing, 0.0));
        }
        if self.free.under_way().next().is_some() {
            return Some((JobKind::Computing, 0.0));
        }
        Some((JobKind::HoldingFeet, f64::from(self.locked_feet.progress()?)))
    }
}

/// Returns whether the spline of a fitted or drawn path is open or closed.
#[must_use]
pub fn spline_ends(params: &Params) -> SplineEnds {
    match params.choice::<choices::PathSpline>() {
        choices::PathSpline::Uniform => SplineEnds::Uniform,
        choices::PathSpline::Clamped => SplineEnds::Clamped,
    }
}

fn carry_options(params: &Params) -> CarryOptions {
    CarryOptions {
        timing: match params.choice::<choices::PathKeep>() {
            choices::PathKeep::Duration => Timing::Duration,
            choices::PathKeep::Whole => Timing::Speed,
            choices::PathKeep::Speed => Timing::Metres,
        },
        orientation: match params.choice::<choices::PathFacing>() {
            choices::PathFacing::World => Orientation::World,
            choices::PathFacing::Path => Orientation::Path,
        },
        offset: match params.choice::<choices::PathOffset>() {
            choices::PathOffset::World => Offset::World,
            choices::PathOffset::Path => Offset::Path,
        },
    }
}

impl PathInputs {
    /// Begins to lock the feet of the motion on the path, which rotated the whole body by these
    /// angles in each frame, radians. `None` if they are not to be locked, or if there are no legs.
    fn locking(
        &self,
        free: &Arc<Clip>,
        contacts: &Contacts,
        turns: &[f64],
    ) -> Result<Option<FootLocking>, LabError> {
        let Some(lock) = self.lock else {
            return Ok(None);
        };
        let motion = &self.fitted.motion;
        let locking = locking(Arc::clone(free), motion.roles(), contacts, motion.ground_m(), lock)?;
        Ok(locking.map(|locking| locking.with_body_yaws(turns)))
    }
}

impl LabInputs for PathInputs {
    fn run(&self) -> Result<Outcome, LabError> {
        let FreeMotion { curve, made } = Arc::unwrap_or_clone(self.free_motion()?);
        let fitted = &self.fitted;
        let free = made.clip;
        let Slide { original, carried, carried_at, .. } = made.slide_cm;
        let free_slide =
            carried.map(|value| Extreme { value, frame: carried_at.unwrap_or_default() });
        let (clip, worst_slide) = match &self.feet {
            Feet::Free | Feet::Awaited => (free, free_slide),
            Feet::AtOnce => {
                let clip = match self.locking(&free, &made.contacts, &made.turns)? {
                    Some(locking) => Arc::new(locking.finish()?),
                    None => free,
                };
                let worst = worst_foot_slide(&clip, fitted.motion.roles(), &made.contacts);
                (clip, worst)
            }
            Feet::Locked(planted) => planted.made.clone()?,
        };
        let fps = clip.fps();
        let hard_turns = made.hard_turns.len() as f64;
        let hardest = made.hard_turns.iter().max_by(|a, b| a.turn_dps.total_cmp(&b.turn_dps));
        let hardest = hardest.map(|turn| turn.worst);
        let mut metrics = vec![
            slide(worst_slide, fps),
            Metric::new(MetricId::FootSlideOriginal, original),
            Metric::new(MetricId::FitError, fitted.error.rms_cm),
            Metric::new(MetricId::LargestFitError, fitted.error.most_cm),
            Metric::new(MetricId::PathLength, curve.length_m()),
            Metric::at_frame(MetricId::HardTurns, hard_turns, hardest, fps),
        ];
        if matches!(self.feet, Feet::AtOnce | Feet::Locked(_)) {
            metrics.push(slide_before(free_slide));
        }
        if self.edited.is_some() {
            metrics.push(Metric::new(MetricId::OriginalPathLength, fitted.curve.length_m()));
        }
        let (frames, before) = (clip.frames(), fitted.motion.clip().frames().max(1));
        let seams = fitted.motion.seams_at(|frame| frame * frames / before);
        let motion = Motion::with_ground_frames(clip, fitted.motion.roles(), made.characters)
            .with_feet(fitted.motion.feet())
            .with_contacts(made.contacts)
            .with_ground_m(fitted.motion.ground_m())
            .with_seams(seams);
        Ok(Outcome {
            sources: vec![PlacedClip::new(Slot::A, &fitted.motion, 0.0, Planar::IDENTITY)],
            facts: LabFacts::of(Arc::new(PathFacts {
                fitted: Arc::clone(fitted),
                curve,
                is_edited: self.edited.is_some(),
                places: made.places,
                hard_turns: made.hard_turns,
                awaits_feet: matches!(self.feet, Feet::Awaited),
            })),
            metrics,
            beside: vec![Arc::clone(fitted.motion.clip())],
            ..Outcome::plain(Arc::new(motion))
        })
    }

    /// Returns whether its feet are to be locked, and are not yet.
    fn is_draft(&self) -> bool {
        matches!(self.feet, Feet::Awaited)
    }
}

impl Outcome {
    /// Returns the facts about the path; `None` if the result is not on one.
    #[must_use]
    pub fn path(&self) -> Option<&Arc<PathFacts>> {
        self.facts.get()
    }

    /// Returns whether its feet are to be locked, and are not yet.
    pub(crate) fn awaits_feet(&self) -> bool {
        self.path().is_some_and(|path| path.awaits_feet)
    }
}

#[cfg(test)]
mod command_tests;
#[cfg(test)]
mod slice_tests;
