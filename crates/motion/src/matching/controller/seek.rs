//! When to search, what for, and whether to go there.

use super::super::features::{MAX_DIMS, RATE};
use super::super::motion::{Motion, write_trajectory};
use super::super::search::{Found, Hit, Question, TreeIndex, scan};
use super::super::{Place, TagFilter};
use super::record::{Candidate, Held, Reason, SearchRecord};
use super::{Asked, Controller, Hysteresis, SearchMethod, TICK_SECS};
use crate::math::wrap_angle;

/// An input that has changed by this much since the last search does not wait for the next, metres
/// per second and radians.
const CHANGE_MPS: f64 = 0.5;
const CHANGE_RADIANS: f64 = 0.6;
/// A winner this near to the frame that is playing is the same place: going there would be a
/// stutter, frames.
const SAME_FRAMES: usize = RATE / 5;
/// The input is still when it has not changed for this long, ticks.
const STILL_TICKS: u64 = RATE as u64 / 2;

impl Controller {
    pub(super) fn reason(&mut self, filter: TagFilter) -> Option<Reason> {
        let simulation = &self.simulation;
        let playing = self.database.motion(self.place.motion);
        // A cycle has no end.
        let ends = playing
            .is_none_or(|motion| !motion.is_cycle() && self.place.frame + 2 >= motion.frames());
        let changed = self.asked.velocity.distance(simulation.goal_velocity) > CHANGE_MPS
            || wrap_angle(self.asked.yaw - simulation.goal_yaw).abs() > CHANGE_RADIANS
            || self.asked.filter != filter;
        if changed {
            self.last_change = self.tick;
        }
        let interval = (self.options.search_interval_secs * RATE as f64).round().max(1.0) as u64;
        let due = self.last_search.is_none_or(|last| self.tick >= last + interval);
        if ends {
            Some(Reason::ClipEnd)
        } else if changed {
            Some(Reason::InputChange)
        } else {
            due.then_some(Reason::Interval)
        }
    }

    /// What is looked for: the body as it is in the clip that is playing, and the trajectory that
    /// is asked for; normalised.
    pub(super) fn query(&self) -> Vec<f32> {
        let features = self.database.features();
        let layout = features.layout();
        let mut row = [0.0; MAX_DIMS];
        let row = &mut row[..layout.dims()];
        if let Some(motion) = self.database.motion(self.place.motion) {
            motion.write_row(layout, self.place.frame, row);
        }
        let here = self.root.inverse();
        let times = layout.ahead().len();
        for (index, &frames) in layout.ahead().iter().enumerate() {
            let later = self.simulation.after(frames as f64 * TICK_SECS, &self.options.steering);
            write_trajectory(row, times, index, &here.after(&later.place()));
        }
        features.normalise_row(row);
        row.to_vec()
    }

    /// The best admitted frame, `known` being one of them.
    pub(super) fn find(&mut self, query: &[f32], filter: TagFilter, known: Option<Hit>) -> Found {
        let question = Question { query, weights: &self.weights, filter };
        let candidates = self.database.candidates();
        match self.options.method {
            SearchMethod::Boxes => {
                self.database.index().search(self.database.masks(), &question, known)
            }
            SearchMethod::Scan => scan(&candidates, &question),
            SearchMethod::Tree => {
                if !self.tree.as_ref().is_some_and(|tree| tree.fits(&self.weights, filter)) {
                    self.tree = TreeIndex::new(&candidates, &self.weights, filter);
                }
                match &self.tree {
                    Some(tree) => tree.search(&candidates, &question),
                    None => scan(&candidates, &question),
                }
            }
        }
    }

    /// Searches, and jumps where the winner is worth it.
    pub(super) fn seek(&mut self, reason: Reason, filter: TagFilter) {
        let query = self.query();
        let here = self.database.number(self.place).unwrap_or(0);
        let cost = |frame: usize| {
            let question = Question { query: &query, weights: &self.weights, filter };
            self.database.features().row(frame).map_or(f32::INFINITY, |row| question.cost(row))
        };
        let current = Hit { frame: here, cost: cost(here) };
        let admitted =
            self.database.is_valid(self.place) && filter.admits(self.database.tags(here));
        let found = self.find(&query, filter, admitted.then_some(current));
        let best = self.preferred(&query, filter, found.best);
        let held = match best.and_then(|best| Some((best, self.database.place(best.frame)?))) {
            None => Some(Held::Nothing),
            Some((best, to)) => {
                let held = self.held(reason, filter, current, best, to);
                if held.is_none() {
                    self.jump(to);
                }
                held
            }
        };
        self.last_search = Some(self.tick);
        self.asked = Asked {
            velocity: self.simulation.goal_velocity,
            yaw: self.simulation.goal_yaw,
            filter,
        };
        let candidate = |hit: Hit| {
            Some(Candidate {
                place: self.database.place(hit.frame)?,
                cost: hit.cost,
                split: self.database.split(&query, &self.options.weights, hit.frame),
            })
        };
        let Some(was) = candidate(current) else {
            return;
        };
        let winner = best.and_then(candidate);
        let mut candidates: Vec<Candidate> =
            winner.into_iter().take(self.options.candidates).collect();
        if self.options.candidates > 1 {
            candidates = self.best(&query, filter).into_iter().filter_map(candidate).collect();
            // The winner comes first, also where it is not the cheapest.
            candidates.retain(|other| winner.is_none_or(|winner| winner.place != other.place));
            candidates.splice(0..0, winner);
            candidates.truncate(self.options.candidates);
        }
        self.record = Some(SearchRecord {
            tick: self.tick,
            reason,
            current: was,
            winner,
            candidates,
            held,
            visited: found.visited,
            query,
        });
    }

    /// Whether the input has not changed for a while.
    fn is_still(&self) -> bool {
        self.tick >= self.last_change + STILL_TICKS
    }

    /// Whether a motion is of the clip that is preferred now, by its name.
    fn is_preferred(&self, motion: usize) -> bool {
        let source = self.options.prefer_source.filter(|_| self.is_still());
        source.is_some() && self.database.motion(motion).map(Motion::source) == source
    }

    /// A cost as it counts: frames of the clip that is preferred are cheaper.
    fn counted(&self, motion: usize, cost: f32) -> f32 {
        if self.is_preferred(motion) { cost * (1.0 - self.options.prefer_current) } else { cost }
    }

    /// The best frame of the clip that is preferred now, if it counts as no dearer than the best of
    /// all; else that one.
    fn preferred(&self, query: &[f32], filter: TagFilter, best: Option<Hit>) -> Option<Hit> {
        let best = best?;
        let question = Question { query, weights: &self.weights, filter };
        let database = &self.database;
        let frames = (0..database.motions().len())
            .filter(|&motion| self.is_preferred(motion))
            .flat_map(|motion| {
                let valid = database.motions()[motion].valid(database.features().layout());
                (0..valid).filter_map(move |frame| database.number(Place { motion, frame }))
            });
        let hits =
            frames.filter(|&frame| filter.admits(database.tags(frame))).filter_map(|frame| {
                let cost = question.cost(database.features().row(frame)?);
                Some(Hit { frame, cost })
            });
        let named = hits.reduce(|a, b| if b.beats(&a) { b } else { a });
        let motion_of =
            |hit: &Hit| database.place(hit.frame).map_or(usize::MAX, |place| place.motion);
        let counted = |hit: &Hit| self.counted(motion_of(hit), hit.cost);
        named.filter(|named| counted(named) <= counted(&best)).or(Some(best))
    }

    /// What speaks against going to the winner.
    fn held(
        &mut self,
        reason: Reason,
        filter: TagFilter,
        current: Hit,
        best: Hit,
        to: Place,
    ) -> Option<Held> {
        let playing = self.database.motion(self.place.motion);
        let apart =
            playing.map_or(usize::MAX, |motion| motion.frames_between(to.frame, self.place.frame));
        let same = to.motion == self.place.motion && apart <= SAME_FRAMES;
        let elsewhere = to.motion != self.place.motion;
        let cost = self.counted(to.motion, best.cost);
        let current_cost = self.counted(self.place.motion, current.cost);
        if reason == Reason::ClipEnd {
            self.votes = 0;
            return None;
        }
        if same {
            self.votes = 0;
            return Some(Held::Same);
        }
        // A frame that has not the tags that are asked for is left as soon as may be.
        if filter.admits(self.database.tags(current.frame)) {
            match self.options.hysteresis {
                Hysteresis::ContinuingBias { share, constant }
                    if cost + constant >= current_cost * (1.0 - share) =>
                {
                    return Some(Held::Bias);
                }
                Hysteresis::MinimumTime { secs }
                    if self
                        .last_jump
                        .is_some_and(|last| (self.tick - last) as f64 * TICK_SECS < secs) =>
                {
                    return Some(Held::MinimumTime);
                }
                Hysteresis::ThreeVotesForAnotherClip if !elsewhere => {}
                Hysteresis::ThreeVotes | Hysteresis::ThreeVotesForAnotherClip => {
                    self.votes += 1;
                    if self.votes < 3 {
                        return Some(Held::Votes);
                    }
                }
                _ => {}
            }
            let holds_on = self.options.prefer_source.is_none() && self.is_still();
            if holds_on
                && elsewhere
                && best.cost >= current.cost * (1.0 - self.options.prefer_current)
            {
                return Some(Held::CurrentClip);
            }
        }
        self.votes = 0;
        None
    }

    /// Goes on at another place; what differs dies away.
    fn jump(&mut self, to: Place) {
        let (old, new) = (self.moving(self.place), self.moving(to));
        self.inertializer.trigger_within(&old, &new, &self.database.pace().joints_radps);
        self.place = to;
        self.jumps += 1;
        self.last_jump = Some(self.tick);
    }

    /// The best frames that cost no more than those next to them in their clip, the best first.
    fn best(&self, query: &[f32], filter: TagFilter) -> Vec<Hit> {
        let question = Question { query, weights: &self.weights, filter };
        let database = &self.database;
        let cost = |frame: usize| {
            let row =
                database.features().row(frame).filter(|_| filter.admits(database.tags(frame)));
            row.map_or(f32::INFINITY, |row| question.cost(row))
        };
        let mut best: Vec<Hit> = Vec::new();
        let valid = database.valid();
        let costs: Vec<f32> = valid.iter().map(|&frame| cost(frame as usize)).collect();
        for (at, (&frame, &cost)) in valid.iter().zip(&costs).enumerate() {
            let next_to = |other: Option<usize>, by: u32| {
                let other = other
                    .filter(|&other| valid.get(other).is_some_and(|&id| id.abs_diff(frame) == by));
                other.and_then(|other| costs.get(other)).copied().unwrap_or(f32::INFINITY)
            };
            let hit = Hit { frame: frame as usize, cost };
            // Of equal neighbours the first.
            if !cost.is_finite()
                || next_to(at.checked_sub(1), 1) <= cost
                || next_to(Some(at + 1), 1) < cost
            {
                continue;
            }
            let place = best.partition_point(|other| other.beats(&hit));
            if place < self.options.candidates {
                best.insert(place, hit);
                best.truncate(self.options.candidates);
            }
        }
        best
    }
}
