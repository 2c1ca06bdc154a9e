//! Blends of clips along their registration.

use super::assembly::{Assembly, moving_joints_of, translation_of};
use super::dissolve::check_bodies;
use super::{BlendError, Concatenation, WeightCurve, WeightLaw};
use crate::clip::{Clip, Contacts, Interpolation, Motion};
use crate::math::{Planar, quat, wrap_angle};
use crate::registration::Registration;
use crate::skeleton::{Foot, Pose};
use glam::{DVec2, Quat, Vec3};
use std::sync::Arc;

/// A clip that is blended with a reference, to which it is registered as the target.
#[derive(Clone, Copy, Debug)]
pub struct Partner<'a> {
    /// The clip.
    pub source: &'a Motion,
    /// Its registration to the reference.
    pub registration: &'a Registration,
    /// Its weight over the course of the blend. The reference has the rest up to 1; partners whose
    /// weights sum to more than 1 are scaled down.
    pub weight: &'a WeightCurve,
}

/// The contributions of the clips to a frame of a registered blend.
#[derive(Clone, Debug, PartialEq)]
pub struct FrameMix {
    /// The frame of each clip, which may lie between two frames: the reference, then the partners
    /// in order.
    pub frames: Vec<f64>,
    /// The weight of each clip; their sum is 1.
    pub weights: Vec<f64>,
}

/// Registered clips played as one.
#[derive(Clone, Debug, PartialEq)]
pub struct RegisteredBlend {
    /// The blend, in the world of the reference; it begins with the registered part.
    pub clip: Clip,
    /// The contributions to each frame.
    pub mixes: Vec<FrameMix>,
    /// The ground frames of the character (`world_from_character`).
    pub frames: Vec<Planar>,
}

/// A transition from one clip to another along their registration.
#[derive(Clone, Debug, PartialEq)]
pub struct RegisteredJoin {
    /// The resulting clip and transition.
    pub joined: Concatenation,
    /// The contributions to each frame of the transition: A, then B.
    pub during: Vec<FrameMix>,
}

/// Blends clips along their registrations (Kovar, Gleicher 2003, section 5).
///
/// The clips show corresponding frames: while the reference shows its frame t, a partner shows
/// `warp(t)`. From frame to frame the weighted mean of the clips' clocks advances by one frame, so
/// that a clip with all the weight plays at its own speed. Poses are blended after alignment by the
/// alignment curves; the trajectory over the ground is integrated from the steps of the blended
/// character while every clip is moved rigidly.
///
/// # Errors
/// [`BlendError`] when clips have different skeletons or frame rates, or the registered parts have
/// less than two frames in common.
pub fn registered_blend(
    reference: &Motion,
    partners: &[Partner<'_>],
) -> Result<RegisteredBlend, BlendError> {
    let blend = Blend::new(reference, partners)?;
    let span = blend.span()?;
    let mixes = blend.schedule(span, None);
    let (clip, frames) = blend.clip(&mixes)?;
    Ok(RegisteredBlend { clip, mixes, frames })
}

/// Joins clip A with clip B, which is registered to it: A up to frame `leave`, then both along the
/// registration with falling weight of A, then B. The transition takes the registered part of A
/// from `leave` to about frame `arrive`: to the nearest whole frame of B. Its first frame is all A,
/// its last all B.
///
/// The clocks are stretched by at most half a frame over the transition, so that it ends on a
/// frame.
///
/// # Errors
/// [`BlendError`] as for [`registered_blend`]; also [`BlendError::NothingInCommon`] when fewer than
/// two frames of either clip lie between `leave` and `arrive`.
pub fn registered_join(
    a: &Motion,
    b: &Motion,
    registration: &Registration,
    leave: usize,
    arrive: usize,
    law: WeightLaw,
) -> Result<RegisteredJoin, BlendError> {
    // Keys would ease twice: the law is applied to the share directly.
    let weight = WeightCurve::constant(0.0);
    let partner = [Partner { source: b, registration, weight: &weight }];
    let blend = Blend { law: Some(law), ..Blend::new(a, &partner)? };
    let (from, to) = blend.span()?;
    let apart = || BlendError::NothingInCommon { reference: a.clip().name().into() };
    let warp = registration.warp();
    let start = leave as f64;
    let end_in_b = warp.at((arrive as f64).min(to)).round().min(warp.at(to).floor());
    let end = warp.inverse(end_in_b);
    if start < from - 1e-9 || end < start + 1.0 || end_in_b < warp.at(start) + 1.0 {
        return Err(apart());
    }
    let mut during = blend.schedule((start, end), None);
    // The whole number of frames nearest to the time of the clocks.
    let steps = during.len() - 1;
    let left = during.last().map_or(0.0, |last| blend.clock(&last.weights, last.frames[0], end));
    let needed = steps as f64 + left;
    let steps = (needed.round() as usize).max(1);
    during = blend.schedule((start, end), Some((steps, needed / steps as f64)));
    let (middle, frames) = blend.clip(&during)?;

    let enter_end = (end_in_b as usize).min(b.clip().frames().saturating_sub(1));
    let mut made =
        Assembly::new(a.clip(), b.clip(), leave + during.len() + b.clip().frames() - enter_end - 1);
    made.play(a.clip(), 0..leave);
    made.play(&middle, 0..middle.frames());
    let b_during: Vec<Planar> = (during.iter().zip(&frames))
        .map(|(mix, frame)| frame.after(&character_at(b, mix.frames[1]).inverse()))
        .collect();
    let world_from_b =
        frames.last().ok_or_else(apart)?.after(&b.ground_frames()[enter_end].inverse());
    made.play_moved(b.clip(), enter_end + 1..b.clip().frames(), &world_from_b);
    let clip = made.finish(format!("{} → {}", a.clip().name(), b.clip().name()))?;
    let half = during.iter().position(|mix| mix.weights[1] >= 0.5).unwrap_or(during.len());
    let mut all_frames = a.ground_frames()[..leave].to_vec();
    all_frames.extend(frames);
    all_frames
        .extend(b.ground_frames()[enter_end + 1..].iter().map(|frame| world_from_b.after(frame)));
    Ok(RegisteredJoin {
        joined: Concatenation {
            clip: Arc::new(clip),
            transition: leave..leave + during.len(),
            // Time is warped in between: counted back from the end, after which B plays as it is.
            enter: (enter_end + 1).saturating_sub(during.len()),
            handover: leave + half,
            aligned_b: registration.alignment_at(start),
            b_during,
            world_from_b,
            frames: all_frames,
        },
        during,
    })
}

impl RegisteredBlend {
    /// Returns the contacts of the result: a foot is planted where clips with more than half of the
    /// weight have it planted. `of` are the clips' contacts, the reference's first.
    #[must_use]
    pub fn contacts(&self, of: &[&Contacts]) -> Contacts {
        contacts_of(&self.mixes, of)
    }
}

impl RegisteredJoin {
    /// Returns the contacts of the whole result; `a` and `b` are the clips' contacts.
    #[must_use]
    pub fn contacts(&self, a: &Contacts, b: &Contacts) -> Contacts {
        let during = contacts_of(&self.during, &[a, b]);
        let last = self.during.last().map_or(0, |last| last.frames[1].round() as usize);
        Contacts::of_feet(a.feet_with(b), |foot| {
            let before = (0..self.joined.transition.start).map(|frame| a.planted(foot, frame));
            let during = (0..during.frames()).map(|frame| during.planted(foot, frame));
            let after = (last + 1..b.frames()).map(|frame| b.planted(foot, frame));
            before.chain(during).chain(after).collect()
        })
    }
}

fn contacts_of(mixes: &[FrameMix], of: &[&Contacts]) -> Contacts {
    let planted = |foot: Foot| {
        mixes.iter().map(move |mix| {
            let parts = mix.weights.iter().zip(&mix.frames).zip(of);
            let planted = parts
                .filter(|((_, frame), contacts)| contacts.planted(foot, frame.round() as usize));
            planted.map(|((weight, _), _)| weight).sum::<f64>() > 0.5
        })
    };
    let feet = of.iter().map(|contacts| contacts.feet()).max_by_key(|feet| feet.len());
    Contacts::of_feet(feet.unwrap_or_default(), |foot| planted(foot).collect())
}

struct Blend<'a> {
    reference: &'a Motion,
    partners: &'a [Partner<'a>],
    /// The law of the reference's weight, in place of the first partner's curve.
    law: Option<WeightLaw>,
}

impl<'a> Blend<'a> {
    fn new(reference: &'a Motion, partners: &'a [Partner<'a>]) -> Result<Self, BlendError> {
        for partner in partners {
            check_bodies(reference, partner.source)?;
        }
        Ok(Self { reference, partners, law: None })
    }

    fn sources(&self) -> impl Iterator<Item = &'a Motion> + '_ {
        std::iter::once(self.reference).chain(self.partners.iter().map(|partner| partner.source))
    }

    /// Returns the frames of the reference at which all clips are registered.
    fn span(&self) -> Result<(f64, f64), BlendError> {
        let last = |source: &Motion| source.clip().frames() as f64 - 1.0;
        let mut span = (0.0_f64, last(self.reference));
        for partner in self.partners {
            let warp = partner.registration.warp();
            let (first, end) = (warp.first(), warp.last());
            // A registration of other, longer clips may reach beyond this one.
            span.0 = span.0.max(first.0).max(warp.inverse(0.0));
            span.1 = span.1.min(end.0).min(warp.inverse(last(partner.source)));
        }
        if span.1 - span.0 >= 1.0 {
            Ok(span)
        } else {
            Err(BlendError::NothingInCommon { reference: self.reference.clip().name().into() })
        }
    }

    /// Returns the frames of all clips while the reference shows `frame`.
    fn frames(&self, frame: f64) -> Vec<f64> {
        let others = self.partners.iter().map(|partner| partner.registration.warp().at(frame));
        std::iter::once(frame).chain(others).collect()
    }

    fn weights(&self, share: f64) -> Vec<f64> {
        let mut weights = vec![0.0];
        if let Some(law) = self.law {
            weights.push(1.0 - law.alpha(share));
        } else {
            weights.extend(self.partners.iter().map(|partner| partner.weight.at(share)));
        }
        let sum: f64 = weights.iter().sum();
        if sum > 1.0 {
            for weight in &mut weights {
                *weight /= sum;
            }
        } else {
            weights[0] = 1.0 - sum;
        }
        weights
    }

    /// Returns the weighted mean of the clips' frames that pass while the reference goes from one
    /// frame to another.
    fn clock(&self, weights: &[f64], from: f64, to: f64) -> f64 {
        let others = self.partners.iter().zip(&weights[1..]).filter(|(_, weight)| **weight > 0.0);
        let others = others.map(|(partner, weight)| {
            let warp = partner.registration.warp();
            weight * (warp.at(to) - warp.at(from))
        });
        weights[0] * (to - from) + others.sum::<f64>()
    }

    /// Returns the frame of the reference when the mean clock has advanced by `step` from `from`;
    /// `None` beyond the end.
    fn next(&self, weights: &[f64], from: f64, end: f64, step: f64) -> Option<f64> {
        // A remainder within rounding of a whole frame counts as a frame.
        let left = self.clock(weights, from, end) - step;
        if left < 1e-6 {
            return (left > -1e-6).then_some(end);
        }
        let (mut low, mut high) = (from, end);
        let mut at = from + step;
        for _ in 0..80 {
            if !(at > low && at < high) {
                at = 0.5 * (low + high);
            }
            let off = self.clock(weights, from, at) - step;
            if off.abs() < 1e-11 {
                break;
            }
            if off > 0.0 {
                high = at;
            } else {
                low = at;
            }
            let others = self.partners.iter().zip(&weights[1..]);
            let rate = weights[0]
                + others
                    .map(|(partner, weight)| weight * partner.registration.warp().slope(at))
                    .sum::<f64>();
            at -= off / rate;
        }
        Some(at)
    }

    /// Returns the contributions to every frame of the blend, from one frame of the reference to
    /// another: as many as there are, or a number of steps of a given length, the last of which
    /// ends at the end.
    fn schedule(&self, (start, end): (f64, f64), steps: Option<(usize, f64)>) -> Vec<FrameMix> {
        let mix = |at: f64| FrameMix {
            frames: self.frames(at),
            weights: self.weights((at - start) / (end - start)),
        };
        let mut at = start;
        let mut mixes = vec![mix(at)];
        let (count, step) = steps.unwrap_or((usize::MAX, 1.0));
        while mixes.len() <= count {
            // Approximately the weights in the middle of the step.
            let rate =
                self.clock(&self.weights((at - start) / (end - start)), at, (at + 0.5).min(end))
                    / (end - at).min(0.5);
            let middle = (at + 0.5 * step / rate.max(0.05)).min(end);
            let weights = self.weights((middle - start) / (end - start));
            at = match self.next(&weights, at, end, step) {
                Some(next) if mixes.len() < count => next,
                None if steps.is_none() => break,
                _ => end,
            };
            mixes.push(mix(at));
            if at >= end && steps.is_none() {
                break;
            }
        }
        mixes
    }

    /// Returns the transform of each clip to the reference's world while that shows `frame`.
    fn alignments(&self, frame: f64) -> Vec<Planar> {
        let others = self.partners.iter().map(|partner| partner.registration.alignment_at(frame));
        std::iter::once(Planar::IDENTITY).chain(others).collect()
    }

    /// Returns the blended ground frame in the reference's world, with the clips transformed by
    /// `alignments`.
    fn character(&self, mix: &FrameMix, alignments: &[Planar]) -> Planar {
        let mut mean = Planar::IDENTITY;
        let mut sum = 0.0;
        let parts = self.sources().zip(alignments).zip(mix.frames.iter().zip(&mix.weights));
        for ((source, alignment), (&frame, &weight)) in
            parts.filter(|(_, (_, weight))| **weight > 0.0)
        {
            let here = alignment.after(&character_at(source, frame));
            sum += weight;
            mean = between(&mean, &here, weight / sum);
        }
        mean
    }

    /// Returns the ground frame of every frame, integrated from the steps of the blend.
    fn ground_frames(&self, mixes: &[FrameMix]) -> Vec<(Planar, Planar, Vec<Planar>)> {
        let mut ground_frames: Vec<(Planar, Planar, Vec<Planar>)> = Vec::with_capacity(mixes.len());
        for mix in mixes {
            let alignments = self.alignments(mix.frames[0]);
            let in_reference = self.character(mix, &alignments);
            let here = match ground_frames.last() {
                None => in_reference,
                // Every clip moves rigidly during the step, with its transform before it.
                Some((here, before, alignments)) => {
                    here.after(&before.inverse().after(&self.character(mix, alignments)))
                }
            };
            ground_frames.push((here, in_reference, alignments));
        }
        ground_frames
    }

    fn clip(&self, mixes: &[FrameMix]) -> Result<(Clip, Vec<Planar>), BlendError> {
        let clips: Vec<&Clip> = self.sources().map(|source| &**source.clip()).collect();
        let mut made = Assembly::of(clips[0], clips.iter().copied(), mixes.len());
        let moving = moving_joints_of(clips.iter().copied());
        let ground_frames = self.ground_frames(mixes);
        let mut sides = vec![quat::Hemispheres::default(); clips.len()];
        for (mix, (here, in_reference, alignments)) in mixes.iter().zip(&ground_frames) {
            let mut mean = Mean::default();
            for (index, clip) in clips.iter().enumerate() {
                let weight = mix.weights[index];
                let pose = (weight > 0.0)
                    .then(|| clip.sample(mix.frames[index] / clip.fps(), Interpolation::Linear))
                    .flatten();
                if let Some(pose) = pose {
                    mean.add(weight, clip, &pose, &alignments[index], &moving, &mut sides[index]);
                }
            }
            let place = here.after(&in_reference.inverse());
            if let Some(rotation) = mean.rotations.first_mut() {
                *rotation = quat::renormalize(place.rotation() * *rotation);
            }
            made.push(place.apply(mean.root), &mean.rotations, &mean.translations);
        }
        let names: Vec<&str> = clips.iter().map(|clip| clip.name()).collect();
        let clip = made.finish(names.join(" + "))?;
        Ok((clip, ground_frames.into_iter().map(|(here, _, _)| here).collect()))
    }
}

/// A weighted mean of poses, clip by clip: rotations slerp towards each further clip, by the
/// shorter way at first and the same way from then on. For two clips it is the slerp between them.
#[derive(Default)]
struct Mean {
    sum: f64,
    root: Vec3,
    rotations: Vec<Quat>,
    translations: Vec<Vec3>,
}

impl Mean {
    fn add(
        &mut self,
        weight: f64,
        clip: &Clip,
        pose: &Pose,
        world_from_clip: &Planar,
        moving: &[usize],
        sides: &mut quat::Hemispheres,
    ) {
        self.sum += weight;
        let share = (weight / self.sum) as f32;
        let turn = world_from_clip.rotation();
        let root = world_from_clip.apply(pose.root_translation);
        let rotations = pose
            .rotations
            .iter()
            .enumerate()
            .map(|(joint, &q)| if joint == 0 { quat::renormalize(turn * q) } else { q });
        let translations = moving.iter().map(|&joint| {
            let own = pose.translations.iter().find(|(of, _)| *of == joint);
            own.map_or_else(|| translation_of(clip, joint, 0), |&(_, value)| value)
        });
        if self.rotations.is_empty() {
            self.root = root;
            self.rotations.extend(rotations);
            self.translations.extend(translations);
            return;
        }
        self.root = self.root.lerp(root, share);
        for (joint, (mean, q)) in self.rotations.iter_mut().zip(rotations).enumerate() {
            *mean = quat::slerp_as_given(*mean, sides.follow(joint, *mean, q), share);
        }
        for (mean, value) in self.translations.iter_mut().zip(translations) {
            *mean = mean.lerp(value, share);
        }
    }
}

/// Returns the ground frame at a time that may lie between two frames.
fn character_at(source: &Motion, frame: f64) -> Planar {
    let frames = source.ground_frames();
    let last = frames.len().saturating_sub(1);
    let at = frame.max(0.0).min(last as f64);
    let (before, next) = (at.floor() as usize, (at.floor() as usize + 1).min(last));
    match (frames.get(before), frames.get(next)) {
        (Some(before), Some(next)) => between(before, next, at.fract()),
        _ => Planar::IDENTITY,
    }
}

/// Interpolates from one ground frame to another, turning the shorter way.
fn between(from: &Planar, to: &Planar, share: f64) -> Planar {
    let shift: DVec2 = from.shift + (to.shift - from.shift) * share;
    Planar { yaw: wrap_angle(from.yaw + wrap_angle(to.yaw - from.yaw) * share), shift }
}

#[cfg(test)]
mod tests;
