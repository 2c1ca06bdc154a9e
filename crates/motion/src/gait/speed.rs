//! Blending of two gaits to a given speed.

use super::phase::{Events, Part, PhaseAlignment};
use super::{GaitCycle, GaitError};
use crate::blend::{Assembly, moving_joints, translation_of};
use crate::clip::{Clip, Contacts};
use crate::math::{Planar, quat, wrap_angle};
use crate::skeleton::{Pose, Role, Roles, Side};
use glam::{DVec3, Quat, Vec3};
use std::ops::RangeInclusive;

/// Options of a blend by speed.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct SpeedOptions {
    /// The alignment of the gaits in phase.
    pub alignment: PhaseAlignment,
    /// The time in which a [`SpeedPlayer`](super::SpeedPlayer) changes its speed: the half-life of
    /// a critically damped spring, seconds. 0 is at once.
    pub half_life_secs: f64,
}

impl Default for SpeedOptions {
    fn default() -> Self {
        Self { alignment: PhaseAlignment::Feet, half_life_secs: 0.15 }
    }
}

/// The properties of a gait at one speed.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct GaitFacts {
    /// The speed of the result, metres per second: the requested one, or the nearest possible one.
    pub speed_mps: f64,
    /// The weight of the second gait, -0.25 to 1.25.
    pub weight: f64,
    /// The length of one cycle (two steps), metres.
    pub stride_m: f64,
    /// Steps per minute.
    pub cadence_spm: f64,
    /// The duration of one cycle, seconds.
    pub cycle_secs: f64,
    /// Whether the speed lies beyond the two gaits.
    pub extrapolated: bool,
    /// Whether the requested speed was too far beyond the two gaits, so that the nearest possible
    /// one was taken.
    pub limited: bool,
}

/// A motion at a speed.
#[derive(Clone, Debug, PartialEq)]
pub struct GaitClip {
    /// The motion; it begins at the origin, facing +Z.
    pub clip: Clip,
    /// The contacts of the feet, as blended.
    pub contacts: Contacts,
    /// The properties at the (last) speed.
    pub facts: GaitFacts,
}

/// The greatest amount by which a weight may leave the range 0 to 1.
const MAX_EXTRAPOLATION: f64 = 0.25;
/// Weights that lie beyond the gaits by up to this are not extrapolated: a walk of 1.4 m/s sways,
/// and its trajectory is a little longer.
const WEIGHT_TOLERANCE: f64 = 0.02;
/// The least speed and stride, as a share of the lesser of the two gaits.
const MIN_SHARE: f64 = 0.1;
/// The least difference of speeds, metres per second.
const MIN_DIFFERENCE_MPS: f64 = 0.1;
/// The greatest duration of a clip, seconds.
const MAX_SECS: f64 = 600.0;

/// Two gaits prepared for blending to any speed; a pose takes microseconds.
#[derive(Clone, Debug, PartialEq)]
pub struct SpeedBlend {
    gaits: [SampledCycle; 2],
    parts: Vec<Part>,
    moving: Vec<usize>,
    options: SpeedOptions,
    weights: [f64; 2],
    name: String,
}

/// A cycle as poses in the character's frame, and its trajectory.
#[derive(Clone, Debug, PartialEq)]
struct SampledCycle {
    clip: Clip,
    rotations: Vec<Quat>,
    translations: Vec<Vec3>,
    /// Sums of the steps in the character's own frame (sideways, yaw, forward) up to each frame,
    /// one more than there are frames.
    step_sums: Vec<DVec3>,
    events: Events,
    first_phase: f64,
    speed_mps: f64,
    secs: f64,
}

impl SpeedBlend {
    /// Prepares two gaits of one skeleton. Their frame rates may differ; results have that of the
    /// first.
    ///
    /// # Errors
    /// [`GaitError`] when the gaits have different skeletons or (nearly) the same speed, one does
    /// not travel, or the half-life is out of range.
    pub fn new(
        a: &GaitCycle,
        b: &GaitCycle,
        roles: &Roles,
        options: &SpeedOptions,
    ) -> Result<Self, GaitError> {
        let (first, second) = (&a.looped.clip, &b.looped.clip);
        if first.skeleton() != second.skeleton() {
            let (a, b) = (first.name().to_owned(), second.name().to_owned());
            return Err(GaitError::Skeletons { a, b });
        }
        let (a_mps, b_mps) = (a.speed_mps(), b.speed_mps());
        let differ =
            (a_mps - b_mps).abs() >= MIN_DIFFERENCE_MPS && a_mps.min(b_mps) >= MIN_DIFFERENCE_MPS;
        if !differ {
            return Err(GaitError::Speeds { a_mps, b_mps });
        }
        checked("half-life (s)", options.half_life_secs, 60.0)?;
        let moving = moving_joints(first, second);
        let mut gaits = [a, b].map(|cycle| SampledCycle::new(cycle, &moving));
        let [a_sampled, b_sampled] = &mut gaits;
        b_sampled.match_signs_to(a_sampled);
        let skeleton = first.skeleton();
        let mut parts = vec![Part::Body; skeleton.len()];
        for side in Side::BOTH {
            let thigh = roles.get_within(Role::thigh(side), skeleton.len());
            for joint in 0..skeleton.len() {
                // Parents come first.
                let above =
                    skeleton.parent(joint).is_some_and(|parent| parts[parent] == Part::Leg(side));
                if Some(joint) == thigh || above {
                    parts[joint] = Part::Leg(side);
                }
            }
        }
        let mut blend = Self {
            gaits,
            parts,
            moving,
            options: *options,
            weights: [-MAX_EXTRAPOLATION, 1.0 + MAX_EXTRAPOLATION],
            name: format!("{} ~ {}", first.name(), second.name()),
        };
        // Far beyond the slower gait, speed or stride would reach 0.
        let (speeds, strides) = ([a_mps, b_mps], [a_mps * a.secs(), b_mps * b.secs()]);
        for [from, to] in [speeds, strides] {
            let least = MIN_SHARE * from.min(to);
            let limit = (least - from) / (to - from);
            if to > from {
                blend.weights[0] = blend.weights[0].max(limit);
            } else if to < from {
                blend.weights[1] = blend.weights[1].min(limit);
            }
        }
        Ok(blend)
    }

    /// Returns the speeds of the two gaits, metres per second.
    #[must_use]
    pub fn speeds_mps(&self) -> [f64; 2] {
        [0, 1].map(|gait: usize| self.gaits[gait].speed_mps)
    }

    /// Returns the range of possible speeds, metres per second.
    #[must_use]
    pub fn range_mps(&self) -> RangeInclusive<f64> {
        let ends = self.weights.map(|weight| self.mixed(weight, |gait| gait.speed_mps));
        ends[0].min(ends[1])..=ends[0].max(ends[1])
    }

    /// Returns the options of the blend.
    #[must_use]
    pub fn options(&self) -> &SpeedOptions {
        &self.options
    }

    fn mixed(&self, weight: f64, of: impl Fn(&SampledCycle) -> f64) -> f64 {
        of(&self.gaits[0]) * (1.0 - weight) + of(&self.gaits[1]) * weight
    }

    /// Returns the properties of the gait at a speed. NaN counts as the speed of the first gait.
    #[must_use]
    pub fn facts(&self, speed_mps: f64) -> GaitFacts {
        let [a, b] = self.speeds_mps();
        let asked = (speed_mps - a) / (b - a);
        let weight =
            if asked.is_nan() { 0.0 } else { asked.clamp(self.weights[0], self.weights[1]) };
        let speed = self.mixed(weight, |gait| gait.speed_mps);
        let stride = self.mixed(weight, |gait| gait.speed_mps * gait.secs);
        let cycle_secs = stride / speed;
        GaitFacts {
            speed_mps: speed,
            weight,
            stride_m: stride,
            cadence_spm: 120.0 / cycle_secs,
            cycle_secs,
            extrapolated: !(-WEIGHT_TOLERANCE..=1.0 + WEIGHT_TOLERANCE).contains(&weight),
            limited: (weight - asked).abs() > 1e-6,
        }
    }

    /// Returns the events of the feet at a weight.
    fn events(&self, weight: f64) -> Events {
        let stride = |gait: &SampledCycle| gait.speed_mps * gait.secs;
        let share = weight * stride(&self.gaits[1]) / self.mixed(weight, stride);
        self.gaits[0].events.between(&self.gaits[1].events, share)
    }

    /// Returns the phases of a gait, in cycles, when the blend is at `phase`.
    fn phases(&self, gait: &SampledCycle, events: &Events, phase: f64) -> [f64; 3] {
        let alignment = self.options.alignment;
        let begin = if alignment == PhaseAlignment::None { gait.first_phase } else { 0.0 };
        Part::ALL.map(|part| begin + gait.events.warped(events, phase, part, alignment))
    }

    /// Returns the step over the ground between two phases at a weight, in the character's frame at
    /// the first.
    pub(super) fn step(&self, weight: f64, from: f64, to: f64) -> Planar {
        let events = self.events(weight);
        let made = |gait: &SampledCycle| {
            let at =
                |phase| gait.step_sum_at(self.phases(gait, &events, phase)[Part::Body.index()]);
            at(to) - at(from)
        };
        let step_sums = made(&self.gaits[0]) * (1.0 - weight) + made(&self.gaits[1]) * weight;
        Planar::new(wrap_angle(step_sums.y), step_sums.x, step_sums.z)
    }

    pub(super) fn planted(&self, weight: f64, phase: f64) -> [bool; 2] {
        if self.options.alignment == PhaseAlignment::None {
            let gait = &self.gaits[usize::from(weight > 0.5)];
            return Side::BOTH.map(|side| gait.events.planted(side, gait.first_phase + phase));
        }
        let events = self.events(weight);
        Side::BOTH.map(|side| events.planted(side, phase))
    }

    /// Computes the blended pose at a phase, in the character's frame: rotations, and translations
    /// of the root and of the joints that move.
    fn pose_into(
        &self,
        weight: f64,
        phase: f64,
        rotations: &mut Vec<Quat>,
        translations: &mut Vec<Vec3>,
    ) {
        let events = self.events(weight);
        let places = [0, 1].map(|index: usize| {
            let gait = &self.gaits[index];
            self.phases(gait, &events, phase).map(|phase| gait.frame_position(phase))
        });
        let [a, b] = &self.gaits;
        let t = weight as f32;
        rotations.clear();
        rotations.extend(self.parts.iter().enumerate().map(|(joint, part)| {
            let [at_a, at_b] = places.map(|places| places[part.index()]);
            if weight == 0.0 {
                a.rotation(joint, at_a)
            } else if weight == 1.0 {
                b.rotation(joint, at_b)
            } else {
                quat::slerp_as_given(a.rotation(joint, at_a), b.rotation(joint, at_b), t)
            }
        }));
        translations.clear();
        let body = places.map(|places| places[Part::Body.index()]);
        translations.extend((0..=self.moving.len()).map(|slot| {
            let slots = self.moving.len() + 1;
            a.translation(slot, slots, body[0]).lerp(b.translation(slot, slots, body[1]), t)
        }));
    }

    /// Returns the blended pose at a phase of a character in the ground frame `here`.
    pub(super) fn pose(&self, weight: f64, phase: f64, here: &Planar) -> Pose {
        let (mut rotations, mut translations) = (Vec::new(), Vec::new());
        self.pose_into(weight, phase, &mut rotations, &mut translations);
        if let Some(root) = rotations.first_mut() {
            *root = quat::renormalize(here.rotation() * *root);
        }
        Pose {
            root_translation: here.apply(translations.first().copied().unwrap_or_default()),
            rotations,
            translations: self
                .moving
                .iter()
                .copied()
                .zip(translations.into_iter().skip(1))
                .collect(),
        }
    }

    /// Returns one cycle, from a strike of the left foot to its next, at the nearest whole number
    /// of frames: with `n` steps it has `n + 1` frames at the phases `i / n`, so that the last
    /// equals the first, one stride on. Because of the rounding, the speed is off by up to half a
    /// frame of the cycle's duration.
    ///
    /// # Errors
    /// [`GaitError::Clip`] when the result is not a valid clip.
    pub fn cycle_at(&self, speed_mps: f64) -> Result<GaitClip, GaitError> {
        self.cycles_at(speed_mps, 1)
    }

    /// Returns several consecutive cycles as [`Self::cycle_at`] makes them: `n · cycles + 1`
    /// frames.
    ///
    /// # Errors
    /// [`GaitError::Option`] when they would take longer than 600 s.
    pub fn cycles_at(&self, speed_mps: f64, cycles: usize) -> Result<GaitClip, GaitError> {
        let facts = self.facts(speed_mps);
        checked("number of cycles", cycles as f64, MAX_SECS / facts.cycle_secs)?;
        let steps = (facts.cycle_secs * self.gaits[0].clip.fps()).round().max(2.0);
        let phases = (0..=steps as usize * cycles).map(|step| (facts.weight, step as f64 / steps));
        self.made(facts, phases)
    }

    /// Returns consecutive cycles at one speed, `secs` long.
    ///
    /// # Errors
    /// [`GaitError::Option`] when `secs` is not between 0 and 600.
    pub fn clip_of(&self, speed_mps: f64, secs: f64) -> Result<GaitClip, GaitError> {
        let facts = self.facts(speed_mps);
        let steps = self.steps_in(secs)?;
        let per_step = (facts.cycle_secs * self.gaits[0].clip.fps()).recip();
        self.made(facts, (0..=steps).map(|step| (facts.weight, step as f64 * per_step)))
    }

    /// Returns the frame rate of the gaits and of all that is made of them.
    pub(super) fn fps(&self) -> f64 {
        self.gaits[0].clip.fps()
    }

    pub(super) fn steps_in(&self, secs: f64) -> Result<usize, GaitError> {
        checked("duration (s)", secs, MAX_SECS)?;
        Ok((secs * self.fps()).round() as usize)
    }

    /// Returns frames at these weights and (rising) phases.
    pub(super) fn made(
        &self,
        facts: GaitFacts,
        phases: impl Iterator<Item = (f64, f64)>,
    ) -> Result<GaitClip, GaitError> {
        let [a, b] = &self.gaits;
        let mut made = Assembly::new(&a.clip, &b.clip, phases.size_hint().0);
        let (mut rotations, mut translations) = (Vec::new(), Vec::new());
        let mut planted = [Vec::new(), Vec::new()];
        let mut here = Planar::IDENTITY;
        let mut before = None;
        for (weight, phase) in phases {
            if let Some(before) = before {
                here = here.after(&self.step(weight, before, phase));
            }
            before = Some(phase);
            self.pose_into(weight, phase, &mut rotations, &mut translations);
            rotations[0] = quat::renormalize(here.rotation() * rotations[0]);
            let root = here.apply(translations[0]);
            made.push(root, &rotations, &translations[1..]);
            for (flags, down) in planted.iter_mut().zip(self.planted(weight, phase)) {
                flags.push(down);
            }
        }
        Ok(GaitClip {
            clip: made.finish(self.name.clone())?,
            contacts: Contacts::from_flags(planted),
            facts,
        })
    }
}

fn checked(what: &'static str, value: f64, most: f64) -> Result<(), GaitError> {
    let fits = (0.0..=most).contains(&value);
    if fits { Ok(()) } else { Err(GaitError::Option { what, value, most }) }
}

/// A frame of a cycle, the next, and the share between them.
type FramePosition = (usize, usize, f32);

impl SampledCycle {
    fn new(cycle: &GaitCycle, moving: &[usize]) -> Self {
        let (clip, frames) = (&cycle.looped.clip, &cycle.looped.frames);
        let mut rotations = Vec::with_capacity(clip.frames() * clip.skeleton().len());
        let mut translations = Vec::with_capacity(clip.frames() * (moving.len() + 1));
        let mut step_sums = vec![DVec3::ZERO];
        for (frame, here) in frames.iter().enumerate() {
            let first = rotations.len();
            rotations.extend_from_slice(clip.rotations(frame));
            if let Some(root) = rotations.get_mut(first) {
                *root = quat::renormalize(here.inverse().rotation() * *root);
            }
            translations.push(here.inverse().apply(clip.root_translations()[frame]));
            translations.extend(moving.iter().map(|&joint| translation_of(clip, joint, frame)));
            let next = frames.get(frame + 1).copied();
            let next = next.or_else(|| frames.first().map(|first| cycle.looped.cycle.after(first)));
            let step = next.map_or(Planar::IDENTITY, |next| here.inverse().after(&next));
            let sum =
                step_sums[frame] + DVec3::new(step.shift.x, wrap_angle(step.yaw), step.shift.y);
            step_sums.push(sum);
        }
        Self {
            clip: clip.clone(),
            rotations,
            translations,
            step_sums,
            events: cycle.events(),
            first_phase: cycle.first_phase(),
            speed_mps: cycle.speed_mps(),
            secs: cycle.secs(),
        }
    }

    /// Chooses the signs of a joint's rotations so that they do not change over the cycle.
    fn keep_signs(&mut self) {
        let joints = self.clip.skeleton().len();
        for at in joints..self.rotations.len() {
            self.rotations[at] =
                quat::in_hemisphere_of(self.rotations[at], self.rotations[at - joints]);
        }
    }

    /// Chooses the signs of each joint's rotations so that the way to the other cycle's is the
    /// shorter one over most of the cycle. If they were chosen for each pose alone, they would
    /// change where the two are about half a turn apart.
    fn match_signs_to(&mut self, other: &mut Self) {
        const SAMPLES: usize = 32;
        self.keep_signs();
        other.keep_signs();
        let joints = self.clip.skeleton().len();
        for joint in 0..joints {
            let alike = (0..SAMPLES).map(|sample| {
                let phase = sample as f64 / SAMPLES as f64;
                self.rotation(joint, self.frame_position(phase))
                    .dot(other.rotation(joint, other.frame_position(phase)))
            });
            if alike.sum::<f32>() < 0.0 {
                for rotation in self.rotations.iter_mut().skip(joint).step_by(joints) {
                    *rotation = -*rotation;
                }
            }
        }
    }

    /// Returns the frames around a phase. A phase within rounding of a frame is that frame.
    fn frame_position(&self, phase: f64) -> FramePosition {
        let count = self.clip.frames();
        let at = phase.rem_euclid(1.0) * count as f64;
        let nearest = at.round();
        let at = if (at - nearest).abs() < 1e-9 * count as f64 { nearest } else { at };
        let frame = at.floor() as usize % count.max(1);
        (frame, (frame + 1) % count.max(1), at.fract() as f32)
    }

    fn rotation(&self, joint: usize, (frame, next, part): FramePosition) -> Quat {
        let joints = self.clip.skeleton().len();
        let from = self.rotations[frame * joints + joint];
        if part == 0.0 {
            from
        } else {
            quat::slerp(from, self.rotations[next * joints + joint], part)
        }
    }

    fn translation(&self, slot: usize, slots: usize, (frame, next, part): FramePosition) -> Vec3 {
        self.translations[frame * slots + slot].lerp(self.translations[next * slots + slot], part)
    }

    /// Returns the sum of steps up to a phase, over all its cycles.
    fn step_sum_at(&self, phase: f64) -> DVec3 {
        let (cycles, last) = (phase.floor(), self.step_sums.len() - 1);
        let at = (phase - cycles) * last as f64;
        let frame = (at.floor() as usize).min(last.saturating_sub(1));
        let within =
            self.step_sums[frame].lerp(self.step_sums[(frame + 1).min(last)], at - frame as f64);
        self.step_sums[last] * cycles + within
    }
}

#[cfg(test)]
mod tests;
