//! The Layers lab: a part of one clip over another.

use super::feet::{Lock, slide, slide_before, with_feet};
use super::lab::{HasPart, Inputs, Lab, LabClips, LabInputs};
use super::pair::{Pair, Pairs};
use super::request_cache::RequestCache;
use super::sliced::{JobKind, Sliced};
use super::{LabFacts, Outcome, PlacedClip, Slot};
use crate::choices;
use crate::jobs::JobBoard;
use crate::labs::LabError;
use crate::metrics::{Metric, MetricId};
use crate::params::{Key, Params};
use segue_motion::blend::{
    BodyPart, LayerMode, LayerOptions, LayerTime, Reference, layer_timed, mask,
};
use segue_motion::clip::{Clip, Contacts, Motion};
use segue_motion::gait::{GaitCycle, strike_phases};
use segue_motion::math::Planar;
use segue_motion::metrics::{Deviations, deepest_penetration, worst_foot_slide};
use segue_motion::transition::{Loop, LoopOptions, close_loop};
use segue_text::{Message, msg};
use serde::{Deserialize, Serialize};
use std::ops::ControlFlow;
use std::sync::Arc;

/// The Layers lab: a part of one clip over another.
pub(super) struct LayersLab;

impl<S: HasPart<Pairs> + HasPart<LayerCache>> Lab<S> for LayersLab {
    fn result_name(&self, _params: &Params, a: Message, b: Message) -> Message {
        msg!("{a} with {b}", a, b)
    }

    fn file_stem(&self, params: &Params) -> String {
        format!("{} and {}", params.text(Key::A), params.text(Key::B))
    }

    fn inputs(
        &self,
        labs: &mut S,
        clips: LabClips,
        params: &Params,
        _match_window: usize,
    ) -> Result<Option<Inputs>, LabError> {
        let Some(pair) = HasPart::<Pairs>::part(labs).of_slots(&clips.slots, params)? else {
            return Ok(None);
        };
        let inputs = HasPart::<LayerCache>::part(labs).inputs(&pair, params)?;
        Ok(inputs.map(Inputs::new))
    }
}

/// The fit of the layer's time to that of the clip below.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum LayerFit {
    /// One cycle of B is repeated so that its feet would strike when A's do.
    InStep,
    /// B starts again at its end; its ends are made to match.
    Looped,
    /// B is long enough to play once.
    Once,
    /// B holds its last frame after its end, and its first before its beginning.
    Held,
}

/// Facts about a layer that was laid over a clip.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct LayerFacts {
    /// The share of B in each joint, 0 to 1.
    pub shares: Vec<f32>,
    /// The fit of B's time.
    pub fit: LayerFit,
    /// Whether B should be in step, but one of the clips has no steps.
    pub has_no_steps: bool,
}

/// The inputs of a layer. Equal inputs give equal results.
#[derive(Clone, Debug)]
pub(crate) struct LayerInputs {
    pair: Arc<Pair>,
    timed: Arc<TimedLayer>,
    options: LayerOptions,
    foot_lock: Option<Lock>,
}

impl PartialEq for LayerInputs {
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.pair, &other.pair)
            && Arc::ptr_eq(&self.timed, &other.timed)
            && self.options == other.options
            && self.foot_lock == other.foot_lock
    }
}

/// A reading of B: a clip, and the time in it for each frame of A.
#[derive(Clone, Debug)]
struct Reading {
    /// With the roles of A.
    over: Arc<Motion>,
    /// The time for every frame of A, seconds.
    times: Arc<Vec<f64>>,
}

/// B in A's time.
#[derive(Debug)]
struct TimedLayer {
    reading: Reading,
    fit: LayerFit,
    has_no_steps: bool,
    /// B frame by frame in A's time.
    shown: Arc<Motion>,
}

/// The parameters of B in A's time: the chosen fit, and the start in seconds.
type Timing = (choices::LayerFit, f64);

/// The two clips and the parameters of a layer in A's time.
type LayerOf = (Arc<Pair>, Timing);

/// A clip of up to this number of frames gets its layer in the frame in which it is chosen: about
/// 6 ms in a browser. Another time for the same clips always shows in its own frame: a stage that
/// waits is dimmed, and would flicker while a slider is dragged.
const AT_ONCE: usize = 1_500;

/// A cache of B in A's time.
#[derive(Debug, Default)]
pub(crate) struct LayerCache {
    in_step: InStep,
    timed: RequestCache<LayerOf, (), Result<Arc<TimedLayer>, LabError>>,
}

/// The last B in step with A, if both have steps.
#[derive(Debug, Default)]
struct InStep(Option<(Arc<Pair>, Option<Reading>)>);

impl LayerCache {
    /// Prepares the inputs, with which the layer itself is a pure function; `None` if that takes
    /// longer than a frame: call [`work`](Self::work), then ask again.
    pub(crate) fn inputs(
        &mut self,
        pair: &Arc<Pair>,
        params: &Params,
    ) -> Result<Option<LayerInputs>, LabError> {
        let timed = self.timed(pair, (params.choice(), params.number(Key::LayerStart)))?;
        Ok(timed.map(|timed| LayerInputs {
            pair: Arc::clone(pair),
            timed,
            options: options_of(params),
            foot_lock: Lock::of(params),
        }))
    }

    fn timed(
        &mut self,
        pair: &Arc<Pair>,
        timing: Timing,
    ) -> Result<Option<Arc<TimedLayer>>, LabError> {
        let Self { in_step, timed } = self;
        let is_new = timed.known(|(known, _)| Arc::ptr_eq(known, pair)).is_none();
        let is_it = |(known, by): &LayerOf| Arc::ptr_eq(known, pair) && *by == timing;
        timed.request_or_begin((Arc::clone(pair), timing), is_it, |_| {
            if is_new && pair.a.clip().frames() > AT_ONCE {
                return Ok(ControlFlow::Continue(()));
            }
            Ok(ControlFlow::Break(Arc::new(in_step.layer(pair, timing)?)))
        })
    }
}

impl Sliced for LayerCache {
    fn clear_requests(&mut self) {
        self.timed.clear_requests();
    }

    fn work(&mut self, _jobs: &mut JobBoard) -> bool {
        let Self { in_step, timed } = self;
        timed.work(|(pair, timing), ()| {
            ControlFlow::Break(in_step.layer(pair, *timing).map(Arc::new))
        })
    }

    fn is_ready(&self) -> bool {
        self.timed.is_ready()
    }

    fn progress(&self) -> Option<(JobKind, f64)> {
        self.timed.under_way().next().map(|_| (JobKind::Analyzing, 0.0))
    }
}

impl InStep {
    /// Returns B in A's time.
    fn layer(&mut self, pair: &Arc<Pair>, (chosen, start): Timing) -> Result<TimedLayer, LabError> {
        let (a, b) = (pair.a.clip(), &pair.incoming);
        let roles = pair.a.roles();
        let of_clip = |clip: Arc<Clip>| Arc::new(Motion::with_roles(clip, roles));
        let times =
            || Arc::new((0..a.frames()).map(|frame| a.time_of(frame)).collect::<Vec<f64>>());
        let whole = || {
            if b.roles() == roles { Arc::clone(b) } else { of_clip(Arc::clone(b.clip())) }
        };
        let plain = || Reading { over: whole(), times: times() };
        let in_step = if chosen == choices::LayerFit::Step { self.reading(pair) } else { None };
        let fits = start >= 0.0 && start + a.duration_secs() <= b.clip().duration_secs();
        let (reading, fit) = match (in_step, chosen) {
            (Some(reading), _) => (reading, LayerFit::InStep),
            (None, choices::LayerFit::Hold) => (plain(), LayerFit::Held),
            _ if fits => (plain(), LayerFit::Once),
            _ => {
                let over = closed(pair).map_or_else(whole, of_clip);
                (Reading { over, times: times() }, LayerFit::Looped)
            }
        };
        let all = LayerOptions {
            parts: vec![BodyPart::Whole],
            feather: 0,
            start_secs: start,
            time: time_of(fit),
            ..LayerOptions::default()
        };
        let shown = layer_timed(&pair.a, &reading.over, &all, &reading.times)?;
        let shown = Motion::with_roles(shown.with_name(b.clip().name()), roles);
        let shown = Arc::new(shown.with_feet(pair.b.feet()));
        Ok(TimedLayer {
            reading,
            fit,
            has_no_steps: chosen == choices::LayerFit::Step && fit != LayerFit::InStep,
            shown,
        })
    }

    /// Returns one cycle of B, and for every frame of A the time in that cycle at which B's feet
    /// are where A's are.
    fn reading(&mut self, pair: &Arc<Pair>) -> Option<Reading> {
        if let Some((known, reading)) = &self.0
            && Arc::ptr_eq(known, pair)
        {
            return reading.clone();
        }
        let reading = GaitCycle::find(&pair.incoming).ok().and_then(|cycle| {
            let phases = strike_phases(pair.a.contacts(), cycle.events().right_strike)?;
            let over = with_first_frame_repeated(cycle.looped())?;
            Some(Reading {
                over: Arc::new(Motion::with_roles(over, pair.a.roles())),
                times: Arc::new(phases.into_iter().map(|phase| phase * cycle.secs()).collect()),
            })
        });
        self.0 = Some((Arc::clone(pair), reading.clone()));
        reading
    }
}

/// Returns all of B as a cycle.
fn closed(pair: &Pair) -> Option<Arc<Clip>> {
    let source = &pair.incoming;
    let last = source.clip().frames().checked_sub(1)?;
    with_first_frame_repeated(&close_loop(source, 0..last, &LoopOptions::default()).ok()?)
}

/// Returns a cycle and its first frame again: where a layer loops, its last frame is its first.
fn with_first_frame_repeated(looped: &Loop) -> Option<Arc<Clip>> {
    let twice = looped.repeat(2).ok()?;
    twice.crop(0..looped.clip.frames() + 1).ok().map(Arc::new)
}

fn time_of(fit: LayerFit) -> LayerTime {
    match fit {
        LayerFit::InStep | LayerFit::Looped => LayerTime::Loop,
        LayerFit::Once | LayerFit::Held => LayerTime::Hold,
    }
}

/// Returns the options of the parameters; the duration of the layer is not known here.
fn options_of(params: &Params) -> LayerOptions {
    let parts = match params.choice::<choices::Mask>() {
        choices::Mask::Arms => vec![BodyPart::LeftArm, BodyPart::RightArm],
        choices::Mask::LeftArm => vec![BodyPart::LeftArm],
        choices::Mask::RightArm => vec![BodyPart::RightArm],
        choices::Mask::Head => vec![BodyPart::Head],
        choices::Mask::Spine => vec![BodyPart::Spine],
        choices::Mask::Legs => vec![BodyPart::LowerBody],
        choices::Mask::Whole => vec![BodyPart::Whole],
        choices::Mask::Upper => vec![BodyPart::UpperBody],
    };
    let reference = match params.choice::<choices::LayerReference>() {
        choices::LayerReference::Rest => Reference::Rest,
        choices::LayerReference::First => Reference::Frame(0),
        choices::LayerReference::Mean => Reference::Mean,
    };
    LayerOptions {
        parts,
        feather: params.number(Key::Feather) as usize,
        weight: params.number(Key::LayerWeight) as f32,
        mode: match params.choice::<choices::LayerMode>() {
            choices::LayerMode::Additive => LayerMode::Additive(reference),
            choices::LayerMode::Partial => LayerMode::Override,
        },
        time: LayerTime::default(),
        start_secs: params.number(Key::LayerStart),
        keep_orientation: params.is_on(Key::KeepOrientation),
    }
}

impl LabInputs for LayerInputs {
    fn run(&self) -> Result<Outcome, LabError> {
        let (pair, timed) = (&self.pair, &self.timed);
        let (a, roles) = (&pair.a, pair.a.roles().clone());
        let options = LayerOptions { time: time_of(timed.fit), ..self.options.clone() };
        let Reading { over, times } = &timed.reading;
        let made = layer_timed(a, over, &options, times)?;
        let free =
            Arc::new(made.with_name(format!("{} + {}", a.clip().name(), pair.b.clip().name())));
        let shares: Vec<f32> = mask(a.clip().skeleton(), &roles, &options.parts, options.feather)
            .into_iter()
            .map(|share| share * options.weight)
            .collect();
        let root_share = shares.first().copied().unwrap_or(0.0);
        let ground_m = if root_share == 0.0 { a.ground_m() } else { pair.ground_m() };
        // Legs that the layer does not touch keep their contacts.
        let contacts = if root_share == 0.0 {
            a.contacts().clone()
        } else {
            Contacts::detect(&free, &roles, &a.feet().contacts)
        };
        let clip = with_feet(&free, &roles, &contacts, ground_m, self.foot_lock)?;
        let slid = |clip: &Clip| worst_foot_slide(clip, &roles, &contacts);
        let fps = clip.fps();
        let mut metrics = vec![slide(slid(&clip), fps)];
        if self.foot_lock.is_some() {
            metrics.push(slide_before(slid(&free)));
        }
        let depth = deepest_penetration(&clip, 0..clip.frames(), ground_m);
        let off_a = Deviations::measure(&clip, a.clip(), &roles);
        metrics.extend([
            Metric::extreme(MetricId::Penetration, depth, fps),
            Metric::new(MetricId::ArmsOffA, off_a.arms_deg),
            Metric::new(MetricId::SpineOffA, off_a.spine_deg),
            Metric::new(MetricId::HeadOffA, off_a.head_deg),
            Metric::new(MetricId::LegsOffA, off_a.legs_deg),
        ]);
        let motion = Motion::with_roles(clip, &roles)
            .with_feet(a.feet())
            .with_contacts(contacts)
            .with_ground_m(ground_m)
            .with_seams(a.seams().to_vec());
        let source = |slot, motion| PlacedClip::new(slot, motion, 0.0, Planar::IDENTITY);
        Ok(Outcome {
            sources: vec![source(Slot::A, a), source(Slot::B, &timed.shown)],
            retargeted: pair.retargeted.clone(),
            facts: LabFacts::of(Arc::new(LayerFacts {
                shares,
                fit: timed.fit,
                has_no_steps: timed.has_no_steps,
            })),
            metrics,
            beside: vec![Arc::clone(a.clip()), Arc::clone(timed.shown.clip())],
            ..Outcome::plain(Arc::new(motion))
        })
    }
}

impl Outcome {
    /// Returns the facts about the layer; `None` if the result has none.
    #[must_use]
    pub fn layer(&self) -> Option<&Arc<LayerFacts>> {
        self.facts.get()
    }
}

#[cfg(test)]
mod command_tests;
