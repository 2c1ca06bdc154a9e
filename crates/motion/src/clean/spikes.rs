//! Spikes: joints that leave their way for a few frames, turn over and back, or jump.

use super::fault::{Fault, FaultKind, Form, TrackFault, confidence};
use super::steps::Steps;
use super::tracks::{Track, Tracks};
use crate::math::sort::sort_by_key;
use glam::Vec3;
use std::ops::Range;

/// The least departure of a step, radians and metres.
const MIN_DEPARTURE: [f32; 2] = [0.09, 0.025];
/// The least ratio of a departure to the usual one around it.
const MIN_RATIO: f32 = 6.0;
/// A departure that recurs, as at every strike of a foot, is no fault. A fault exceeds the largest
/// departures of its joint by a ratio: the one of this rank, or at this share of all of them if
/// that is a later rank.
const HABIT_RANK: usize = 6;
const HABIT_SHARE: f32 = 0.012;
const HABIT_RATIO: f32 = 2.0;
/// Departures above this are a fault however often they happen, radians and metres.
const NO_HABIT: [f32; 2] = [0.6, 0.2];
/// A spike of this size is as likely as not a fault, radians and metres.
const HALF_SURE: [f32; 2] = [0.19, 0.05];
/// A joint that departs in the same frames as a spike belongs to it if its departure is at least
/// this share of `MIN_DEPARTURE`, and this multiple of the usual departure.
const ALONG_SHARE: f32 = 0.25;
const ALONG_RATIO: f32 = 4.5;
/// The longest spike, seconds, and the least number of frames for which it is allowed.
const MAX_SECS: f64 = 0.13;
const MAX_FRAMES: usize = 4;
/// The longest time for which a joint turns over, seconds, and the least angle of that, radians.
const MAX_FLIP_SECS: f64 = 3.0;
const MIN_FLIP: f32 = 0.8;
/// The largest bend where a bridge over a spike meets the motion, as a share of the spike.
const MAX_BEND: f32 = 0.4;

/// Returns the spikes of a track.
pub(super) fn of_track(track: &Track, index: usize, tracks: &Tracks) -> Vec<TrackFault> {
    let steps = Steps::of(track, tracks);
    let least = MIN_DEPARTURE[usize::from(!track.is_turn())];
    let habit = habit(&steps.departures) * HABIT_RATIO;
    let beyond = habit.min(NO_HABIT[usize::from(!track.is_turn())]);
    let sudden: Vec<(usize, f32)> = (0..steps.ways.len())
        .filter(|&at| steps.departures[at] > least.max(beyond))
        .map(|at| (at, steps.usual(at)))
        .filter(|&(at, usual)| steps.departures[at] > MIN_RATIO * usual)
        .collect();
    let longest = tracks.frames_of(MAX_SECS, MAX_FRAMES);
    let mut found: Vec<TrackFault> = Vec::new();
    let mut next = 0;
    for (place, &(first, usual)) in sudden.iter().enumerate() {
        if first < next {
            continue;
        }
        let ends = sudden[place + 1..].iter().take_while(|(last, _)| last - first <= longest);
        let best = ends
            .filter_map(|&(last, _)| {
                let run = Bridge::over(track, &steps, first, last);
                let is_spike = run.departure > least * 0.8
                    && run.bend
                        < MAX_BEND * run.departure + usual * (last - first + 1) as f32 * 0.5;
                is_spike.then_some((run, last))
            })
            .min_by(|a, b| a.0.left().total_cmp(&b.0.left()));
        if let Some((run, last)) = best {
            found.push(TrackFault {
                track: index,
                frames: first + 1..last + 1,
                form: Form::Run,
                size: tracks.size(index, run.departure),
                confidence: sureness(run.departure, usual, track),
            });
            next = last + 1;
        }
    }
    if track.is_turn() {
        let flips = flips(index, tracks, &steps, &sudden, &found);
        found.extend(flips);
    }
    found
}

/// Returns how sure a spike of a size is a fault.
fn sureness(departure: f32, usual: f32, track: &Track) -> f32 {
    let turn = usize::from(!track.is_turn());
    let by_ratio = confidence(departure / usual.max(MIN_DEPARTURE[turn] * 0.2), 4.0);
    by_ratio.min(confidence(departure, HALF_SURE[turn]))
}

/// Adds to a spike the tracks that leave their way with it. Where a captured joint turns over, its
/// children often turn against it: mended alone, either would throw the limb away.
pub(super) fn take_along(parts: &mut Vec<TrackFault>, tracks: &Tracks) {
    let runs: Vec<(usize, Range<usize>)> = parts
        .iter()
        .filter(|part| part.form == Form::Run)
        .map(|part| (tracks.joint_of[part.track], part.frames.clone()))
        .collect();
    for (joint, frames) in runs {
        for (index, track) in tracks.all.iter().enumerate() {
            let other = tracks.joint_of[index];
            let is_kin = other == joint
                || tracks.parents[other] == Some(joint)
                || tracks.parents[joint] == Some(other);
            if !is_kin {
                continue;
            }
            let is_known = parts.iter().any(|part| {
                part.track == index
                    && part.frames.start < frames.end
                    && frames.start < part.frames.end
            });
            if is_known || frames.start == 0 || frames.end >= track.len() {
                continue;
            }
            let (first, last) = (frames.start - 1, frames.end - 1);
            let reach = tracks.frames_of(0.15, 8);
            let near = first.saturating_sub(reach)..(last + reach + 2).min(track.len());
            let part = track.part(&near);
            let steps = Steps::of(&part, tracks);
            let (first, last) = (first - near.start, last - near.start);
            let run = Bridge::over(&part, &steps, first, last);
            let usual = steps.usual(first);
            let least = MIN_DEPARTURE[usize::from(!track.is_turn())] * ALONG_SHARE;
            if run.departure > least.max(ALONG_RATIO * usual)
                && run.bend < MAX_BEND * run.departure + usual
            {
                parts.push(TrackFault {
                    track: index,
                    frames: frames.clone(),
                    form: Form::Run,
                    size: tracks.size(index, run.departure),
                    confidence: 0.0,
                });
            }
        }
    }
}

/// Returns the largest departure that is usual for a track.
fn habit(departures: &[f32]) -> f32 {
    let rank = HABIT_RANK.max((HABIT_SHARE * departures.len() as f32) as usize);
    let mut sorted = departures.to_vec();
    sorted.sort_unstable_by(|a, b| b.total_cmp(a));
    sorted.get(rank).copied().unwrap_or(0.0)
}

/// Frames between two good ones, drawn anew.
struct Bridge {
    /// The largest distance of the frames from the bridge.
    departure: f32,
    /// The difference of the bridge from the velocities at both sides.
    bend: f32,
}

impl Bridge {
    /// Replaces the frames after step `first` up to step `last`.
    fn over(track: &Track, steps: &Steps, first: usize, last: usize) -> Self {
        let (leave, arrive) = (steps.before(first), steps.after(last + 1));
        let bridge = track.bridge(first, last + 1, leave, arrive);
        let departure = (0..bridge.len())
            .map(|at| track.distance(first + 1 + at, &bridge, at))
            .fold(0.0, f32::max);
        let length = (last + 1 - first) as f32;
        let bend = (track.way(first, last + 1) - (leave + arrive) * 0.5 * length).length();
        Self { departure, bend }
    }

    /// Returns the share of the spike that would stay.
    fn left(&self) -> f32 {
        self.bend / self.departure.max(1e-6)
    }
}

/// Returns the parts of a track in which a joint is turned over: the step into each is undone by
/// the step out of it.
fn flips(
    index: usize,
    tracks: &Tracks,
    steps: &Steps,
    sudden: &[(usize, f32)],
    spikes: &[TrackFault],
) -> Vec<TrackFault> {
    let free: Vec<usize> = sudden
        .iter()
        .map(|&(at, _)| at)
        .filter(|at| !spikes.iter().any(|s| s.frames.start <= at + 1 && *at < s.frames.end))
        .collect();
    let jump = |at: usize| {
        let usual = (steps.before(at) + steps.after(at + 1)) * 0.5;
        steps.ways[at] - usual
    };
    let longest = tracks.frames_of(MAX_FLIP_SECS, MAX_FRAMES);
    let mut found = Vec::new();
    let mut next = 0;
    for (place, &first) in free.iter().enumerate() {
        let over = jump(first);
        if first < next || over.length() < MIN_FLIP {
            continue;
        }
        let ends = free[place + 1..].iter().take_while(|&&last| last - first <= longest);
        let back = ends.copied().find(|&last| undoes(over, jump(last)));
        if let Some(last) = back {
            found.push(TrackFault {
                track: index,
                frames: first + 1..last + 1,
                form: Form::Flip(over),
                size: over.length().to_degrees(),
                confidence: confidence(over.length(), 0.5),
            });
            next = last + 1;
        }
    }
    found
}

/// Returns whether a rotation undoes another. Half a turn is undone by either way round.
fn undoes(over: Vec3, back: Vec3) -> bool {
    let rest = crate::math::quat::log(crate::math::quat::exp(back) * crate::math::quat::exp(over));
    rest.length() < 0.3 * over.length()
}

/// Joins the spikes of single tracks that happen at the same time.
pub(super) fn merged(kind: FaultKind, mut parts: Vec<TrackFault>, tracks: &Tracks) -> Vec<Fault> {
    sort_by_key(&mut parts, |part| (part.frames.start, part.frames.end, part.track));
    let mut groups: Vec<(Range<usize>, Vec<TrackFault>)> = Vec::new();
    for part in parts {
        match groups.last_mut() {
            Some((frames, group)) if part.frames.start < frames.end => {
                frames.end = frames.end.max(part.frames.end);
                group.push(part);
            }
            _ => groups.push((part.frames.clone(), vec![part])),
        }
    }
    groups.into_iter().map(|(_, group)| Fault::of_tracks(kind, group, tracks)).collect()
}
