//! The times of searches, their queries, and the decision to jump.

use super::super::features::{MAX_DIMS, RATE};
use super::super::motion::{DatabaseClip, write_trajectory};
use super::super::search::{Hit, Query, SearchResult, TreeIndex, scan};
use super::super::{Place, TagFilter};
use super::record::{Candidate, HoldReason, SearchReason, SearchRecord};
use super::{Controller, Hysteresis, LastInput, SearchMethod, TICK_SECS};
use crate::math::wrap_angle;

/// A change of the input since the last search that triggers a search at once, metres per second
/// and radians.
const CHANGE_MPS: f64 = 0.5;
const CHANGE_RADIANS: f64 = 0.6;
/// A winner this near to the frame that is playing, in frames, is not a jump: it would be a
/// stutter.
const SAME_FRAMES: usize = RATE / 5;
/// The input counts as constant when it has not changed for this long, ticks.
const STILL_TICKS: u64 = RATE as u64 / 2;

impl Controller {
    pub(super) fn reason(&mut self, filter: TagFilter) -> Option<SearchReason> {
        let simulation = &self.simulation;
        let playing = self.database.motion(self.place.motion);
        // A cycle has no end.
        let ends = playing
            .is_none_or(|motion| !motion.is_cycle() && self.place.frame + 2 >= motion.frames());
        let changed = self.last_input.velocity.distance(simulation.goal_velocity) > CHANGE_MPS
            || wrap_angle(self.last_input.yaw - simulation.goal_yaw).abs() > CHANGE_RADIANS
            || self.last_input.filter != filter;
        if changed {
            self.last_change = self.tick;
        }
        let interval = (self.options.search_interval_secs * RATE as f64).round().max(1.0) as u64;
        let due = self.last_search.is_none_or(|last| self.tick >= last + interval);
        if ends {
            Some(SearchReason::ClipEnd)
        } else if changed {
            Some(SearchReason::InputChange)
        } else {
            due.then_some(SearchReason::Interval)
        }
    }

    /// Returns the query: the body as in the clip that is playing, and the desired trajectory;
    /// normalised.
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

    /// Returns the best admitted frame; `known` is one of them.
    pub(super) fn find(
        &mut self,
        query: &[f32],
        filter: TagFilter,
        known: Option<Hit>,
    ) -> SearchResult {
        let query = Query { row: query, weights: &self.weights, filter };
        let candidates = self.database.candidates();
        match self.options.method {
            SearchMethod::Boxes => {
                self.database.index().search(self.database.masks(), &query, known)
            }
            SearchMethod::Scan => scan(&candidates, &query),
            SearchMethod::Tree => {
                if !self.tree.as_ref().is_some_and(|tree| tree.fits(&self.weights, filter)) {
                    self.tree = TreeIndex::new(&candidates, &self.weights, filter);
                }
                match &self.tree {
                    Some(tree) => tree.search(&candidates, &query),
                    None => scan(&candidates, &query),
                }
            }
        }
    }

    /// Searches, and jumps where the winner is worth it.
    pub(super) fn seek(&mut self, reason: SearchReason, filter: TagFilter) {
        let query = self.query();
        let here = self.database.number(self.place).unwrap_or(0);
        let cost = |frame: usize| {
            let query = Query { row: &query, weights: &self.weights, filter };
            self.database.features().row(frame).map_or(f32::INFINITY, |row| query.cost(row))
        };
        let current = Hit { frame: here, cost: cost(here) };
        let admitted =
            self.database.is_valid(self.place) && filter.admits(self.database.tags(here));
        let found = self.find(&query, filter, admitted.then_some(current));
        let best = self.preferred(&query, filter, found.best);
        let held = match best.and_then(|best| Some((best, self.database.place(best.frame)?))) {
            None => Some(HoldReason::Nothing),
            Some((best, to)) => {
                let held = self.held(reason, filter, current, best, to);
                if held.is_none() {
                    self.jump(to);
                }
                held
            }
        };
        self.last_search = Some(self.tick);
        self.last_input = LastInput {
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
            // The winner comes first, even if it is not the cheapest.
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

    /// Returns whether the input has not changed for a while.
    fn is_still(&self) -> bool {
        self.tick >= self.last_change + STILL_TICKS
    }

    /// Returns whether a motion belongs to the preferred clip.
    fn is_preferred(&self, motion: usize) -> bool {
        let source = self.options.prefer_source.filter(|_| self.is_still());
        source.is_some() && self.database.motion(motion).map(DatabaseClip::source) == source
    }

    /// Returns the cost of a frame including the preference: frames of the preferred clip are
    /// cheaper.
    fn counted(&self, motion: usize, cost: f32) -> f32 {
        if self.is_preferred(motion) { cost * (1.0 - self.options.prefer_current) } else { cost }
    }

    /// Returns the best frame of the preferred clip, if it is no more expensive than the best of
    /// all including the preference; otherwise that one.
    fn preferred(&self, query: &[f32], filter: TagFilter, best: Option<Hit>) -> Option<Hit> {
        let best = best?;
        let query = Query { row: query, weights: &self.weights, filter };
        let database = &self.database;
        let frames = (0..database.motions().len())
            .filter(|&motion| self.is_preferred(motion))
            .flat_map(|motion| {
                let valid = database.motions()[motion].valid(database.features().layout());
                (0..valid).filter_map(move |frame| database.number(Place { motion, frame }))
            });
        let hits =
            frames.filter(|&frame| filter.admits(database.tags(frame))).filter_map(|frame| {
                let cost = query.cost(database.features().row(frame)?);
                Some(Hit { frame, cost })
            });
        let named = hits.reduce(|a, b| if b.beats(&a) { b } else { a });
        let motion_of =
            |hit: &Hit| database.place(hit.frame).map_or(usize::MAX, |place| place.motion);
        let counted = |hit: &Hit| self.counted(motion_of(hit), hit.cost);
        named.filter(|named| counted(named) <= counted(&best)).or(Some(best))
    }

    /// Returns the reason not to jump to the winner.
    fn held(
        &mut self,
        reason: SearchReason,
        filter: TagFilter,
        current: Hit,
        best: Hit,
        to: Place,
    ) -> Option<HoldReason> {
        let playing = self.database.motion(self.place.motion);
        let apart =
            playing.map_or(usize::MAX, |motion| motion.frames_between(to.frame, self.place.frame));
        let same = to.motion == self.place.motion && apart <= SAME_FRAMES;
        let elsewhere = to.motion != self.place.motion;
        let cost = self.counted(to.motion, best.cost);
        let current_cost = self.counted(self.place.motion, current.cost);
        if reason == SearchReason::ClipEnd {
            self.votes = 0;
            return None;
        }
        if same {
            self.votes = 0;
            return Some(HoldReason::Same);
        }
        // A frame without the required tags is left as soon as possible.
        if filter.admits(self.database.tags(current.frame)) {
            match self.options.hysteresis {
                Hysteresis::ContinuingBias { share, constant }
                    if cost + constant >= current_cost * (1.0 - share) =>
                {
                    return Some(HoldReason::Bias);
                }
                Hysteresis::MinimumTime { secs }
                    if self
                        .last_jump
                        .is_some_and(|last| (self.tick - last) as f64 * TICK_SECS < secs) =>
                {
                    return Some(HoldReason::MinimumTime);
                }
                Hysteresis::ThreeVotesForAnotherClip if !elsewhere => {}
                Hysteresis::ThreeVotes | Hysteresis::ThreeVotesForAnotherClip => {
                    self.votes += 1;
                    if self.votes < 3 {
                        return Some(HoldReason::Votes);
                    }
                }
                _ => {}
            }
            let holds_on = self.options.prefer_source.is_none() && self.is_still();
            if holds_on
                && elsewhere
                && best.cost >= current.cost * (1.0 - self.options.prefer_current)
            {
                return Some(HoldReason::CurrentClip);
            }
        }
        self.votes = 0;
        None
    }

    /// Jumps to another frame; the difference decays.
    fn jump(&mut self, to: Place) {
        let (old, new) = (self.moving(self.place), self.moving(to));
        self.inertializer.trigger_within(&old, &new, &self.database.pace().joints_radps);
        self.place = to;
        self.jumps += 1;
        self.last_jump = Some(self.tick);
    }

    /// Returns the best frames that cost no more than those next to them in their clip, the best
    /// first.
    fn best(&self, query: &[f32], filter: TagFilter) -> Vec<Hit> {
        let query = Query { row: query, weights: &self.weights, filter };
        let database = &self.database;
        let cost = |frame: usize| {
            let row =
                database.features().row(frame).filter(|_| filter.admits(database.tags(frame)));
            row.map_or(f32::INFINITY, |row| query.cost(row))
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
            // The first of equal neighbours is taken.
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
