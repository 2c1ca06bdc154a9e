//! Gait cycles: one stride of a walk or run, closed.

use super::GaitError;
use super::phase::Events;
use crate::clip::{ContactOptions, Contacts, Motion, ground_speed};
use crate::math::sort::sort_by;
use crate::math::{quat, stats};
use crate::skeleton::{Foot, Roles, Side};
use crate::transition::{CycleSearch, Loop, LoopOptions, WholeCycle, close_loop, find_cycle};
use std::ops::Range;

/// One cycle of a walk or run, from a strike of the left foot to its next one, closed.
#[derive(Clone, Debug, PartialEq)]
pub struct GaitCycle {
    /// The closed cycle. The frame after its last one is its first.
    pub(super) looped: Loop,
    range: Range<usize>,
    events: Events,
    speed_mps: f64,
}

/// The greatest distance between the ends of a cycle, centimetres on the reference body.
const MAX_APART_CM: f64 = 12.0;
/// Range of the duration of a cycle, seconds.
const CYCLE_SECS: Range<f64> = 0.3..3.0;
/// The strikes and lifts of a walk whose feet take turns evenly, each planted for three fifths of
/// the cycle.
const EVEN_WALK: Events = Events { left_lift: 0.6, right_strike: 0.5, right_lift: 1.1 };

impl GaitCycle {
    /// Finds the most regular cycle of a clip, and closes it ([`close_loop`], half of the
    /// difference at each end).
    ///
    /// A cycle goes from a strike of the left foot to the next one and contains one strike of the
    /// right foot. Of all cycles the one is taken that differs least from the median in duration,
    /// speed, and the phases of strike and lift, and whose ends are most alike. A foot that is
    /// planted in the clip's first frame counts as striking there only if there is no other cycle.
    ///
    /// A clip that is one cycle, or most of one, rarely begins with a strike. If it contains none
    /// of the cycles above, it is closed at its own ends ([`WholeCycle`]), or where its poses
    /// repeat best ([`find_cycle`]); the contacts of the closed, repeated cycle then give the
    /// strikes.
    ///
    /// A clip that was declared a cycle ([`Motion::is_cycle`]) is taken whole. Where its feet do
    /// not strike once each, the strikes of an even walk are assumed.
    ///
    /// # Errors
    /// [`GaitError::NoFeet`] and [`GaitError::NoCycle`] when no cycle is found, [`GaitError::Loop`]
    /// when it cannot be closed.
    pub fn find(source: &Motion) -> Result<Self, GaitError> {
        if source.is_cycle() {
            return Self::declared(source);
        }
        let mut candidates = candidates(source);
        if candidates.iter().any(|candidate| candidate.range.start > 0) {
            candidates.retain(|candidate| candidate.range.start > 0);
        } else {
            // A foot that is planted in the first frame may have come down long before.
            match Self::closed_by_its_ends(source) {
                Err(_) if !candidates.is_empty() => {}
                closed => return closed,
            }
        }
        let measures: Vec<[f32; 5]> =
            candidates.iter().map(|candidate| candidate.measures(source)).collect();
        let median = |index: usize| {
            let values: Vec<f32> = measures.iter().map(|measures| measures[index]).collect();
            stats::percentile(&values, 0.5).unwrap_or(0.0)
        };
        let medians = [0, 1, 2, 3, 4].map(median);
        let odd = |index: usize| -> f32 {
            let apart: f32 = measures[index]
                .iter()
                .zip(medians)
                .map(|(value, median)| (value - median).abs())
                .sum();
            apart + candidates[index].gap(source)
        };
        let best = (0..candidates.len()).min_by(|&a, &b| odd(a).total_cmp(&odd(b))).unwrap_or(0);
        let Candidate { range, events } = candidates.swap_remove(best);
        let looped = close_loop(source, range.clone(), &LoopOptions::default())?;
        Ok(Self::new(looped, range, events))
    }

    fn new(looped: Loop, range: Range<usize>, events: Events) -> Self {
        let mut frames = looped.frames.clone();
        frames.extend(frames.first().map(|first| looped.cycle.after(first)));
        Self {
            speed_mps: f64::from(ground_speed(&frames, looped.clip.fps())),
            looped,
            range,
            events,
        }
    }

    /// Returns the cycle of a clip that was declared one.
    fn declared(source: &Motion) -> Result<Self, GaitError> {
        let range = 0..source.clip().frames().saturating_sub(1);
        let looped = close_loop(source, range.clone(), &LoopOptions::default())?;
        let corrections = source.contact_corrections();
        let by_hand = |foot: Foot, frame| corrections.planted(foot, frame);
        let Some((strike, events)) = events_of(&looped, source.roles(), by_hand) else {
            return Ok(Self::new(looped, range, EVEN_WALK));
        };
        let looped = looped.starting_at(strike).map_err(GaitError::Clip)?;
        Ok(Self::new(looped, strike..strike + range.len(), events))
    }

    /// Returns the cycle of a clip that does not contain one from strike to strike.
    fn closed_by_its_ends(source: &Motion) -> Result<Self, GaitError> {
        let (clip, roles) = (source.clip(), source.roles());
        let name = || clip.name().to_owned();
        if Side::BOTH.iter().any(|&side| roles.foot_points(clip.skeleton(), side).is_empty()) {
            return Err(GaitError::NoFeet { name: name() });
        }
        // Both ways to choose the ends, the one with the smaller distance first.
        let whole = WholeCycle::of(source);
        let search = CycleSearch { min_secs: CYCLE_SECS.start, ..CycleSearch::new(clip.fps()) };
        let inside = find_cycle(source, &search).ok().filter(|cut| cut.rms_cm < MAX_APART_CM);
        let mut closed: Vec<(f64, usize, Loop)> = Vec::new();
        if let Some(whole) = &whole {
            closed.push((whole.gap_cm, 0, whole.close(&LoopOptions::default())?));
        }
        if let Some(cut) = inside {
            let looped = close_loop(source, cut.cycle.clone(), &LoopOptions::default())?;
            closed.push((cut.rms_cm, cut.cycle.start, looped));
        }
        sort_by(&mut closed, |a, b| a.0.total_cmp(&b.0));
        for (_, start, looped) in closed {
            let corrections = source.contact_corrections();
            let by_hand = |foot: Foot, frame| corrections.planted(foot, start + frame);
            let Some((strike, events)) = events_of(&looped, roles, by_hand) else {
                continue;
            };
            let frames = looped.clip.frames();
            let looped = looped.starting_at(strike).map_err(GaitError::Clip)?;
            return Ok(Self::new(looped, start + strike..start + strike + frames, events));
        }
        Err(GaitError::NoCycle { name: name(), secs: clip.duration_secs() })
    }

    /// Returns the frames of the clip that were used; `end` is the frame that corresponds to
    /// `start`. It lies beyond the clip's last frame where the clip was closed at its own ends.
    #[must_use]
    pub fn range(&self) -> Range<usize> {
        self.range.clone()
    }

    /// Returns the phases at which the feet strike and lift.
    #[must_use]
    pub fn events(&self) -> Events {
        self.events
    }

    /// Returns the length of the trajectory over the ground divided by its duration, metres per
    /// second ([`ground_speed`]).
    #[must_use]
    pub fn speed_mps(&self) -> f64 {
        self.speed_mps
    }

    /// Returns the duration of a cycle, seconds.
    #[must_use]
    pub fn secs(&self) -> f64 {
        self.looped.clip.frames() as f64 / self.looped.clip.fps()
    }

    /// Returns the closed cycle.
    #[must_use]
    pub fn looped(&self) -> &Loop {
        &self.looped
    }

    /// Returns the phase of the clip's first frame.
    pub(super) fn first_phase(&self) -> f64 {
        -(self.range.start as f64) / self.range.len() as f64
    }
}

/// Returns the frame of a closed cycle in which the left foot strikes, and the events from there
/// on. `None` unless each foot stands once. `by_hand` is whether a foot is planted in a frame of
/// the cycle, where that was corrected.
pub(crate) fn events_of(
    looped: &Loop,
    roles: &Roles,
    by_hand: impl Fn(Foot, usize) -> Option<bool>,
) -> Option<(usize, Events)> {
    let frames = looped.clip.frames();
    if !CYCLE_SECS.contains(&(frames as f64 / looped.clip.fps())) {
        return None;
    }
    // In the middle one of three repetitions no stance is cut off.
    let found = Contacts::detect(&looped.repeat(3).ok()?, roles, &ContactOptions::default());
    let contacts = found.corrected(|foot, frame| by_hand(foot, frame % frames));
    let stance = |side: Side| {
        let mut within = contacts
            .intervals(side)
            .into_iter()
            .filter(|stance| (frames..2 * frames).contains(&stance.start));
        within.next().filter(|stance| within.next().is_none() && stance.len() < frames)
    };
    let (left, right) = (stance(Side::Left)?, stance(Side::Right)?);
    let phase = |frames_on: usize| frames_on as f64 / frames as f64;
    let right_strike = phase((right.start + frames - left.start) % frames);
    let events = Events {
        left_lift: phase(left.len()),
        right_strike,
        right_lift: right_strike + phase(right.len()),
    };
    (right_strike > 0.0).then_some((left.start - frames, events))
}

struct Candidate {
    range: Range<usize>,
    events: Events,
}

fn candidates(source: &Motion) -> Vec<Candidate> {
    let contacts = source.contacts();
    let fps = source.clip().fps();
    let last = source.clip().frames().min(contacts.frames());
    let (left, right) = (contacts.intervals(Side::Left), contacts.intervals(Side::Right));
    let candidate = |pair: &[Range<usize>]| {
        let (stance, range) = (&pair[0], pair[0].start..pair[1].start);
        let mut strikes =
            right.iter().filter(|stance| stance.start > range.start && stance.start < range.end);
        let (only, more) = (strikes.next()?, strikes.next());
        if more.is_some() || range.end >= last || !CYCLE_SECS.contains(&(range.len() as f64 / fps))
        {
            return None;
        }
        let phase = |frame: usize| (frame - range.start) as f64 / range.len() as f64;
        let events = Events {
            left_lift: phase(stance.end),
            right_strike: phase(only.start),
            right_lift: phase(only.end),
        };
        // A stance that is cut off by the clip's end has no lift.
        (events.right_lift < events.right_strike + 1.0 && only.end < last)
            .then_some(Candidate { range, events })
    };
    left.windows(2).filter_map(candidate).collect()
}

impl Candidate {
    /// Returns duration and speed (logarithms), and the phases of the events: the measures of
    /// regularity.
    fn measures(&self, source: &Motion) -> [f32; 5] {
        let speed = ground_speed(
            &source.ground_frames()[self.range.start..=self.range.end],
            source.clip().fps(),
        );
        [
            libm::logf(self.range.len() as f32),
            libm::logf(speed.max(1e-3)),
            self.events.left_lift as f32,
            self.events.right_strike as f32,
            (self.events.right_lift - self.events.right_strike) as f32,
        ]
    }

    /// Returns the root mean square of the angles between the poses at both ends, radians.
    fn gap(&self, source: &Motion) -> f32 {
        let (clip, frames) = (source.clip(), source.ground_frames());
        let ends = [self.range.start, self.range.end].map(|frame| {
            let mut rotations = clip.rotations(frame).to_vec();
            if let Some(root) = rotations.first_mut() {
                *root = frames[frame].inverse().rotation() * *root;
            }
            rotations
        });
        let squares =
            ends[0].iter().zip(&ends[1]).map(|(&a, &b)| quat::angle_between(a, b).powi(2));
        (squares.sum::<f32>() / ends[0].len().max(1) as f32).sqrt()
    }
}
