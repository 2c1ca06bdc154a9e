//! The Register lab: two clips registered in time, then blended or joined.

use super::lab::{Beside, HasPart, Inputs, Lab, LabClips, LabInputs};
use crate::labs::LabError;
use crate::metrics::{Metric, MetricId};
use crate::params::{Key, List, MAX_WEIGHTED_CLIPS, Params, Value};
mod map;
mod scheduler;

pub use map::DistanceMap;
pub(crate) use scheduler::{RegistrationRequest, RegistrationSchedulers, registered, terms_of};

use super::blend::weight_law;
use super::feet::{Lock, slide, slide_before, with_feet};
use super::pair::{Pair, Pairs};
use super::{LabFacts, Outcome, PlacedClip, Slot, Transition};
use crate::choices;
use scheduler::FoundRegistration;
use segue_motion::blend::{
    DissolveOptions, FrameMix, Partner, RegisteredBlend, WeightCurve, WeightLaw, dissolve,
    registered_blend, registered_join,
};
use segue_motion::clip::{Clip, Contacts, Motion};
use segue_motion::math::Planar;
use segue_motion::metrics::{deepest_penetration, worst_foot_slide};
use segue_motion::registration::Registration;
use segue_motion::skeleton::{Foot, Side};
use segue_text::{Message, msg};
use std::ops::Range;
use std::sync::Arc;

/// The weight of a clip that joins A and B.
const FIRST_WEIGHT: f64 = 0.25;

/// The Register lab: clips registered in time, then blended or joined.
pub(super) struct RegisterLab;

impl<S: HasPart<Pairs> + HasPart<RegistrationSchedulers>> Lab<S> for RegisterLab {
    fn result_name(&self, _params: &Params, a: Message, b: Message) -> Message {
        msg!("{a} to {b}", a, b)
    }

    fn file_stem(&self, params: &Params) -> String {
        format!("{} and {} registered", params.text(Key::A), params.text(Key::B))
    }

    fn more_clips(&self, params: &Params) -> Result<Vec<String>, LabError> {
        Ok(params.weighted_clips().iter().map(|(id, _)| id.clone()).collect())
    }

    fn with_clips(&self, ids: &[String]) -> Option<Vec<(Key, Value)>> {
        let [a, b, others @ ..] = ids else {
            return None;
        };
        let others = others.iter().take(MAX_WEIGHTED_CLIPS);
        let weighted = others.map(|id| (id.clone(), FIRST_WEIGHT)).collect();
        Some(vec![
            (Key::A, Value::Text(a.clone())),
            (Key::B, Value::Text(b.clone())),
            (Key::WarpAlso, List::WeightedClips(weighted).into()),
        ])
    }

    fn captured_link(&self) -> Option<&'static str> {
        Some("a=cmu16_walk&b=cmu16_fast_walk")
    }

    fn has(&self, beside: Beside) -> bool {
        beside == Beside::DistanceMap
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
        let weights = params.weighted_clips().iter().map(|(_, weight)| *weight);
        let more: Result<Vec<_>, LabError> = (clips.motions().iter())
            .map(|motion| HasPart::<Pairs>::part(labs).of(&pair.a, motion, params))
            .collect();
        let Some(more) = more?.into_iter().collect::<Option<Vec<_>>>() else {
            return Ok(None);
        };
        let also: Vec<_> = more.into_iter().zip(weights).collect();
        Ok(HasPart::<RegistrationSchedulers>::part(labs)
            .inputs(&pair, &also, params)?
            .map(Inputs::new))
    }
}

/// The frames of A and B that a frame of a registered result is made from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FramePair {
    /// The frame of A and that of B, at A's rate; beyond the clips where one of them is over, or
    /// has not begun.
    pub frames: [f64; 2],
    /// The weights of A and of B, 0 to 1; with further clips, their sum is less than 1.
    pub weights: [f64; 2],
}

/// The registration of A and B, and the result made by it.
#[derive(Clone, Debug)]
pub struct RegistrationFacts {
    /// The distances.
    pub map: Arc<DistanceMap>,
    /// The path and the curves through it, which the result follows unless it is plain.
    pub registration: Arc<Registration>,
    /// Whether both clips run at their own speed.
    pub is_plain: bool,
    /// The frames of A and B for each frame of the result.
    pub frame_pairs: Vec<FramePair>,
    /// The contacts of the result, by its own motion.
    pub steps: Contacts,
    /// The part of A that can be registered, or that the join covers: from and to, seconds in A.
    pub part_secs: [f64; 2],
}

impl RegistrationFacts {
    fn fps(&self) -> f64 {
        self.map.fps()
    }

    /// Returns the frames of A and B at a time, which may be between two frames.
    #[must_use]
    pub fn frame_pair_at(&self, secs: f64) -> Option<FramePair> {
        let last = self.frame_pairs.len().checked_sub(1)?;
        // `max` maps NaN to 0.
        let at = (secs * self.fps()).max(0.0).min(last as f64);
        let (here, next) = (
            self.frame_pairs.get(at.floor() as usize)?,
            self.frame_pairs.get((at.floor() as usize + 1).min(last))?,
        );
        let mixed = |from: f64, to: f64| from + (to - from) * at.fract();
        Some(FramePair {
            frames: [0, 1].map(|clip| mixed(here.frames[clip], next.frames[clip])),
            weights: [0, 1].map(|clip| mixed(here.weights[clip], next.weights[clip])),
        })
    }

    /// Returns the time of the result that is nearest to a pair of frames.
    #[must_use]
    pub fn secs_near(&self, frames: [f64; 2]) -> Option<f64> {
        let off = |frame_pair: &FramePair| {
            libm::hypot(frame_pair.frames[0] - frames[0], frame_pair.frames[1] - frames[1])
        };
        let nearest =
            (self.frame_pairs.iter().enumerate()).min_by(|x, y| off(x.1).total_cmp(&off(y.1)));
        nearest.map(|(frame, _)| frame as f64 / self.fps())
    }

    /// Returns the stances of a foot of a source in the result's time; of the result itself if
    /// there is no source.
    #[must_use]
    pub fn stances(&self, of: Option<Slot>, foot: impl Into<Foot>) -> Vec<Range<f64>> {
        let foot = foot.into();
        let secs =
            |frames: Range<usize>| frames.start as f64 / self.fps()..frames.end as f64 / self.fps();
        let Some(slot) = of else {
            return self.steps.intervals(foot).into_iter().map(secs).collect();
        };
        let clip = usize::from(slot == Slot::B);
        let contacts = self.map.motions()[clip].contacts();
        let flags = self
            .frame_pairs
            .iter()
            .map(|frame_pair| stands(contacts, foot, frame_pair.frames[clip]))
            .collect();
        let in_result = Contacts::from_flags([flags, Vec::new()]);
        in_result.intervals(Side::Left).into_iter().map(secs).collect()
    }
}

fn stands(contacts: &Contacts, foot: Foot, frame: f64) -> bool {
    frame > -0.5 && contacts.planted(foot, frame.round() as usize)
}

/// The kind of result of two registered clips.
#[derive(Clone, Debug, PartialEq)]
enum RegisteredKind {
    /// Both clips at once.
    Blend {
        /// The weight of B.
        weight: WeightCurve,
    },
    /// A transition from A to B.
    Join {
        /// The beginning and end, seconds in A.
        part_secs: [Option<f64>; 2],
        /// The law by which the weight moves from A to B.
        law: WeightLaw,
    },
}

impl RegisteredKind {
    fn of(params: &Params) -> Self {
        if params.choice::<choices::WarpMode>() == choices::WarpMode::Join {
            return Self::Join {
                part_secs: [Key::WarpFrom, Key::WarpTo].map(|key| params.optional(key)),
                law: weight_law(params),
            };
        }
        let keys = params.weight_curve();
        let weight = if keys.is_empty() {
            WeightCurve::constant(params.number(Key::WarpWeight))
        } else {
            weight_curve(keys)
        };
        Self::Blend { weight }
    }
}

/// Returns the curve through keys in per cent of the blend and per cent of B.
#[must_use]
pub fn weight_curve(keys: &[(usize, usize)]) -> WeightCurve {
    WeightCurve::new(keys.iter().map(|&(at, weight)| (at as f64 / 100.0, weight as f64 / 100.0)))
}

/// The inputs of a registered result. Equal inputs give equal results.
#[derive(Clone, Debug)]
pub(crate) struct RegisterInputs {
    pair: Arc<Pair>,
    found: Arc<FoundRegistration>,
    also: Vec<ExtraClip>,
    made: RegisteredKind,
    is_plain: bool,
    foot_lock: Option<Lock>,
}

/// A further clip of a blend, registered to A.
#[derive(Clone, Debug)]
struct ExtraClip {
    pair: Arc<Pair>,
    found: Arc<FoundRegistration>,
    weight: f64,
}

impl PartialEq for ExtraClip {
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.pair, &other.pair)
            && Arc::ptr_eq(&self.found, &other.found)
            && self.weight == other.weight
    }
}

impl FoundRegistration {
    /// Returns the registration that a result follows.
    fn way(&self, is_plain: bool) -> &Registration {
        if is_plain { &self.lockstep } else { &self.registration }
    }
}

impl PartialEq for RegisterInputs {
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.pair, &other.pair)
            && Arc::ptr_eq(&self.found, &other.found)
            && self.also == other.also
            && self.made == other.made
            && (self.is_plain, self.foot_lock) == (other.is_plain, other.foot_lock)
    }
}

/// A motion made of two, before its feet are locked and measured.
struct Draft {
    clip: Clip,
    /// The ground frames of the character.
    frames: Vec<Planar>,
    frame_pairs: Vec<FramePair>,
    contacts: Contacts,
    /// The frames in which both clips are mixed.
    mixed: Range<usize>,
    /// The placement of B after them.
    world_from_b: Planar,
}

fn frame_pair(mix: &FrameMix) -> FramePair {
    let of = |values: &[f64], at: usize| values.get(at).copied().unwrap_or_default();
    FramePair {
        frames: [of(&mix.frames, 0), of(&mix.frames, 1)],
        weights: [of(&mix.weights, 0), of(&mix.weights, 1)],
    }
}

impl RegisterInputs {
    fn sources(&self) -> [&Motion; 2] {
        [&self.pair.a, &self.pair.incoming]
    }

    /// Returns the contacts of A and of B.
    fn contacts(&self) -> [&Contacts; 2] {
        [self.pair.a.contacts(), self.pair.incoming.contacts()]
    }

    /// Returns the first and the last registered frame of A.
    fn span(&self) -> [f64; 2] {
        let warp = self.found.registration.warp();
        let [last_a, last_b] = self.sources().map(|source| source.clip().frames() as f64 - 1.0);
        [
            warp.first().0.max(0.0).max(warp.inverse(0.0)),
            warp.last().0.min(last_a).min(warp.inverse(last_b)),
        ]
    }

    fn blend(&self, weight: &WeightCurve) -> Result<Draft, LabError> {
        let [a, b] = self.sources();
        let partner = Partner { source: b, registration: self.found.way(self.is_plain), weight };
        let weights: Vec<WeightCurve> =
            self.also.iter().map(|also| WeightCurve::constant(also.weight)).collect();
        let also = self.also.iter().zip(&weights).map(|(also, weight)| Partner {
            source: &also.pair.incoming,
            registration: also.found.way(self.is_plain),
            weight,
        });
        let partners: Vec<Partner<'_>> = std::iter::once(partner).chain(also).collect();
        let made = registered_blend(a, &partners)?;
        let also = self.also.iter().map(|also| also.pair.incoming.contacts());
        let all: Vec<&Contacts> = self.contacts().into_iter().chain(also).collect();
        let contacts = made.contacts(&all);
        let RegisteredBlend { clip, mixes, frames } = made;
        Ok(Draft {
            mixed: 0..clip.frames(),
            clip,
            frames,
            frame_pairs: mixes.iter().map(frame_pair).collect(),
            contacts,
            world_from_b: Planar::IDENTITY,
        })
    }

    /// Returns the places of the seams of A and B in the result, and of its own if it is a join.
    fn seams(&self, frame_pairs: &[FramePair], own: Option<&Range<usize>>) -> Vec<Range<usize>> {
        let plays = |of: usize, frame: usize| {
            frame_pairs.partition_point(|frame_pair| frame_pair.frames[of] < frame as f64)
        };
        let [of_a, of_b] = [&self.pair.a, &self.pair.incoming];
        let of_a = of_a.seams_at(|frame| plays(0, frame)).into_iter();
        let of_b = of_b.seams_at(|frame| plays(1, frame)).into_iter();
        let Some(own) = own else {
            return of_a.chain(of_b).collect();
        };
        let before = of_a.filter(|seam| seam.start < own.start);
        let behind = of_b.filter(|seam| seam.start >= own.start);
        before.chain([own.clone()]).chain(behind).collect()
    }

    /// Returns the first and the last frame of the join in A: as requested, within the registered
    /// part; otherwise the middle half of it, between the last seam of A and the first one of B, so
    /// that no seam of a kept clip is cut.
    fn part(&self, part_secs: [Option<f64>; 2]) -> Result<[usize; 2], LabError> {
        let [from, to] = self.span();
        let fps = self.pair.a.clip().fps();
        let Pair { a, incoming, .. } = &*self.pair;
        let mut room = [from, to];
        if !a.seams().is_empty() {
            room[0] = from.max(a.behind_seams() as f64);
        }
        if !incoming.seams().is_empty() {
            room[1] =
                to.min(self.found.registration.warp().inverse(incoming.before_seams() as f64));
        }
        if part_secs.contains(&None) && room != [from, to] && room[0] + 2.0 > room[1] {
            return Err(LabError::NoRoomToJoin {
                last_secs: room[0] / fps,
                first_secs: room[1] / fps,
            });
        }
        let asked = |secs: Option<f64>, share: f64| {
            let frame = secs.map_or(room[0] + share * (room[1] - room[0]), |secs| secs * fps);
            (frame.round() as usize)
                .clamp(from.ceil() as usize, (to.floor() as usize).max(from.ceil() as usize))
        };
        let [leave, arrive] = [asked(part_secs[0], 0.25), asked(part_secs[1], 0.75)];
        if leave + 2 > arrive {
            return Err(LabError::JoinBackwards {
                begin_secs: leave as f64 / fps,
                end_secs: arrive as f64 / fps,
                from_secs: from / fps,
                to_secs: to / fps,
            });
        }
        Ok([leave, arrive])
    }

    fn join(&self, [leave, arrive]: [usize; 2], law: WeightLaw) -> Result<Draft, LabError> {
        let [a, b] = self.sources();
        let [contacts_a, contacts_b] = self.contacts();
        let warp = self.found.registration.warp();
        let (joined, during, contacts) = if self.is_plain {
            let enter = (warp.at(leave as f64).round().max(0.0)) as usize;
            let window = (arrive - leave).min(b.clip().frames().saturating_sub(enter + 1));
            let options = DissolveOptions { window, law, ..DissolveOptions::default() };
            let joined = dissolve(a, leave, b, enter, &options)?;
            let frame_pair = |p: usize| FramePair {
                frames: [(leave + p) as f64, (enter + p) as f64],
                weights: of_two(1.0 - law.alpha((p + 1) as f64 / window.max(1) as f64)),
            };
            let during: Vec<FramePair> = (0..joined.transition.len()).map(frame_pair).collect();
            let contacts = Contacts::joined(contacts_a, contacts_b, leave, enter, joined.handover);
            (joined, during, contacts)
        } else {
            let made = registered_join(a, b, &self.found.registration, leave, arrive, law)?;
            let contacts = made.contacts(contacts_a, contacts_b);
            (made.joined, made.during.iter().map(frame_pair).collect(), contacts)
        };
        let before = (0..leave).map(|frame| FramePair {
            frames: [frame as f64, warp.at(frame as f64)],
            weights: of_two(0.0),
        });
        let last = during.last().map_or([arrive as f64, 0.0], |last| last.frames);
        let left = joined.clip.frames().saturating_sub(joined.transition.end);
        let after = (1..=left).map(|step| {
            let in_b = last[1] + step as f64;
            let in_a = if self.is_plain { last[0] + step as f64 } else { warp.inverse(in_b) };
            FramePair { frames: [in_a, in_b], weights: of_two(1.0) }
        });
        Ok(Draft {
            frame_pairs: before.chain(during).chain(after).collect(),
            clip: Arc::unwrap_or_clone(joined.clip),
            frames: joined.frames,
            contacts,
            mixed: joined.transition,
            world_from_b: joined.world_from_b,
        })
    }

    /// Returns all clips on the skeleton of A.
    fn beside(&self) -> Vec<Arc<Clip>> {
        let also = self.also.iter().map(|also| Arc::clone(also.pair.incoming.clip()));
        self.pair.clips().into_iter().chain(also).collect()
    }

    /// Returns the height of the ground under all clips, metres: the lowest.
    fn ground_m(&self) -> f32 {
        let also = self.also.iter().map(|also| also.pair.ground_m());
        also.fold(self.pair.ground_m(), f32::min)
    }

    /// Returns the metrics of foot slide, of the distance of the mixed frames, and of penetration.
    fn measured(
        &self,
        [clip, free]: [&Clip; 2],
        contacts: &Contacts,
        mixed: &Range<usize>,
        distance_cm: Option<f64>,
    ) -> Vec<Metric> {
        let roles = self.pair.a.roles();
        let slid = |clip: &Clip| worst_foot_slide(clip, roles, contacts);
        let fps = clip.fps();
        let mut metrics = vec![slide(slid(clip), fps)];
        if self.foot_lock.is_some() {
            metrics.push(slide_before(slid(free)));
        }
        metrics.push(Metric::new(MetricId::FrameDistance, distance_cm));
        let frames = mixed.start.saturating_sub(1)..mixed.end.saturating_add(1);
        let depth = deepest_penetration(clip, frames, self.ground_m());
        metrics.push(Metric::extreme(MetricId::Penetration, depth, fps));
        metrics
    }
}

impl LabInputs for RegisterInputs {
    fn run(&self) -> Result<Outcome, LabError> {
        let pair = &self.pair;
        let fps = pair.a.clip().fps();
        let (draft, part, is_join) = match &self.made {
            RegisteredKind::Blend { weight } => (self.blend(weight)?, self.span(), false),
            RegisteredKind::Join { part_secs, law } => {
                let part = self.part(*part_secs)?;
                (self.join(part, *law)?, part.map(|frame| frame as f64), true)
            }
        };
        let Draft { clip: free, frames, frame_pairs, contacts, mixed, world_from_b } = draft;
        let roles = pair.a.roles().clone();
        let sign = if is_join { "→" } else { "+" };
        let also = self.also.iter().map(|also| &also.pair.b);
        let others: Vec<&str> =
            std::iter::once(&pair.b).chain(also).map(|motion| motion.clip().name()).collect();
        let free = Arc::new(free.with_name(format!(
            "{} {sign} {}",
            pair.a.clip().name(),
            others.join(" + ")
        )));
        let clip = with_feet(&free, &roles, &contacts, self.ground_m(), self.foot_lock)?;
        let distance_cm = mean(
            frame_pairs
                .get(mixed.clone())
                .unwrap_or_default()
                .iter()
                .filter_map(|frame_pair| self.found.map.cm_at(frame_pair.frames)),
        );
        let secs = |frame: usize| frame as f64 / fps;
        let entered =
            frame_pairs.get(mixed.start).map_or(0.0, |frame_pair| frame_pair.frames[1] / fps);
        let left = frame_pairs
            .get(mixed.end)
            .or(frame_pairs.last())
            .map_or(0.0, |frame_pair| frame_pair.frames[1] / fps);
        let transition = is_join.then(|| Transition {
            start_secs: secs(mixed.start),
            end_secs: secs(mixed.end),
            leave_a_secs: secs(mixed.start),
            enter_b_secs: entered,
            window_frames: mixed.len(),
            distance_cm: distance_cm.unwrap_or(f64::NAN) as f32,
            search: None,
        });
        let metrics = self.measured([&clip, &free], &contacts, &mixed, distance_cm);
        let seams = self.seams(&frame_pairs, is_join.then_some(&mixed));
        let sources = vec![
            PlacedClip::new(Slot::A, &pair.a, 0.0, Planar::IDENTITY),
            PlacedClip::new(Slot::B, &pair.incoming, secs(mixed.end) - left, world_from_b),
        ];
        let steps = Contacts::detect(&clip, &roles, &pair.a.feet().contacts);
        let motion = Arc::new(
            Motion::with_ground_frames(clip, &roles, frames)
                .with_feet(pair.a.feet())
                .with_contacts(contacts)
                .with_ground_m(self.ground_m())
                .with_seams(seams),
        );
        Ok(Outcome {
            facts: LabFacts::of(Arc::new(RegistrationFacts {
                map: Arc::clone(&self.found.map),
                registration: Arc::clone(&self.found.registration),
                is_plain: self.is_plain,
                frame_pairs,
                steps,
                part_secs: part.map(|frame| frame / fps),
            })),
            sources,
            transition,
            retargeted: pair.retargeted.clone(),
            metrics,
            beside: self.beside(),
            ..Outcome::plain(motion)
        })
    }
}

/// Returns the weights of A and B without further clips.
fn of_two(weight_b: f64) -> [f64; 2] {
    [1.0 - weight_b, weight_b]
}

fn mean(values: impl Iterator<Item = f64>) -> Option<f64> {
    let (sum, count) = values.fold((0.0, 0_usize), |(sum, count), value| (sum + value, count + 1));
    (count > 0).then(|| sum / count as f64)
}

impl Outcome {
    /// Returns the registration and the facts about it; `None` if nothing was registered.
    #[must_use]
    pub fn registered(&self) -> Option<&Arc<RegistrationFacts>> {
        self.facts.get()
    }

    /// Returns the time of a source that contributes to the result at a time of the result, and the
    /// placement of the source on the result at that moment. `None` if it does not contribute, and
    /// if the sources are not registered: they then simply play on.
    #[must_use]
    pub fn source_at(&self, source: &PlacedClip, secs: f64) -> Option<(f64, Planar)> {
        let frame_pair = self.registered()?.frame_pair_at(secs)?;
        let at = frame_pair.frames[usize::from(source.slot == Slot::B)] / self.motion.clip().fps();
        let inside = at >= 0.0 && at <= source.motion.clip().duration_secs();
        inside.then(|| {
            let stands = source.motion.standing_at(at);
            (at, self.motion.standing_at(secs).after(&stands.inverse()))
        })
    }
}

#[cfg(test)]
mod command_tests;
