//! Playback: the playhead, and results that loop. When the playhead wraps, a loop continues from
//! where the character is; when another loop replaces it, its phase is kept.

mod span;
pub(crate) mod speed_ramp;

use crate::choices::Follow;
use crate::command::PlaybackCommand;
use crate::labs::{Inputs, Outcome};
use crate::pane::Pane;
use crate::params::{Key, Params, Value};
use segue_motion::math::Planar;
pub use span::Span;
use speed_ramp::{SpeedRamp, cycle_durations, differ_in_speed_alone};
use std::sync::Arc;

/// The time of the panes.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Timeline {
    /// The duration of the longest result, seconds.
    pub(crate) duration_secs: f64,
    /// The time of a character that the user drives, which has no end, seconds.
    pub(crate) driven_secs: Option<f64>,
    /// The frame rate of the first result.
    pub(crate) fps: Option<f64>,
}

impl Timeline {
    /// Returns the position of the playhead, seconds.
    pub(crate) fn now_secs(&self, params: &Params) -> f64 {
        self.driven_secs.unwrap_or_else(|| params.number(Key::Time).min(self.duration_secs))
    }

    /// Returns the part that plays.
    pub(crate) fn span(&self, params: &Params) -> Span {
        Span::between(params.optional(Key::In), params.optional(Key::Out), self.duration_secs)
    }

    /// Carries out a command. Steps of a driven character are made by its owner.
    pub(crate) fn apply(&self, command: PlaybackCommand, params: &mut Params) {
        match command {
            PlaybackCommand::Seek(_) if self.driven_secs.is_some() => {}
            PlaybackCommand::Seek(secs) => {
                let to = if secs.is_finite() { secs.clamp(0.0, self.duration_secs) } else { 0.0 };
                set(params, Key::Time, Value::Number(to));
            }
            PlaybackCommand::Step(frames) => {
                let Some(fps) = self.fps else { return };
                set(params, Key::Play, Value::Switch(false));
                if self.driven_secs.is_none() {
                    let frame = (self.now_secs(params) * fps).round() + frames as f64;
                    let to = (frame / fps).clamp(0.0, self.duration_secs);
                    set(params, Key::Time, Value::Number(to));
                }
            }
            PlaybackCommand::TogglePlay => {
                let is_playing = params.is_on(Key::Play);
                let span = self.span(params);
                if !is_playing && !params.is_on(Key::Loop) && self.now_secs(params) >= span.end {
                    set(params, Key::Time, Value::Number(span.start));
                }
                set(params, Key::Play, Value::Switch(!is_playing));
            }
        }
    }

    /// Moves the playhead. Returns `false` if it reaches its end and stops.
    pub(crate) fn advance(&self, params: &mut Params, panes: &mut [Pane], dt_secs: f64) -> bool {
        let (span, before, rate) =
            (self.span(params), self.now_secs(params), params.number(Key::Rate));
        let (now, is_moving) = span.advance(before, dt_secs, rate, params.is_on(Key::Loop));
        let wraps = span.wraps(before, dt_secs, rate);
        if is_moving && wraps > 0 {
            wrap_playhead(params, panes, span, wraps);
        }
        set(params, Key::Time, Value::Number(now));
        if !is_moving {
            set(params, Key::Play, Value::Switch(false));
        }
        is_moving
    }
}

/// Sets a value that is known to be valid.
fn set(params: &mut Params, key: Key, value: Value) {
    let result = params.set(key, value);
    debug_assert!(result.is_ok(), "{result:?}");
}

/// The playback before a change.
pub(crate) struct PlaybackState {
    /// The playhead in the parameters, seconds.
    time: f64,
    /// The playhead inside of the timeline, seconds.
    now_secs: f64,
    panes: Vec<Option<PaneState>>,
}

/// The playback of a pane before a change.
struct PaneState {
    outcome: Arc<Outcome>,
    inputs: Option<Inputs>,
    /// The gait on the stage, which has the speed of the result or approaches it.
    ramp: SpeedRamp,
    world_from_character: Planar,
}

impl PlaybackState {
    /// Records the playback of the panes.
    pub(crate) fn of(timeline: &Timeline, params: &Params, panes: &[Pane]) -> Self {
        let now_secs = timeline.now_secs(params);
        let state = |pane: &Pane| {
            let outcome = Arc::clone(pane.outcome.as_ref()?);
            Some(PaneState {
                ramp: pane.ramp.clone().unwrap_or_else(|| SpeedRamp::at_speed_of(&outcome)),
                inputs: pane.inputs.clone(),
                world_from_character: pane.world_from_character(now_secs)?,
                outcome,
            })
        };
        Self { time: params.number(Key::Time), now_secs, panes: panes.iter().map(state).collect() }
    }

    /// Continues from this state after a change. If a cycle replaced another, the playhead keeps
    /// its phase and the character its place, and a gait that plays changes its speed from the
    /// present one. If the playhead was moved, results begin where it is.
    pub(crate) fn resume(&self, timeline: &Timeline, params: &mut Params, panes: &mut [Pane]) {
        let is_moved = params.number(Key::Time) != self.time;
        let is_playing = params.is_on(Key::Play);
        let replaced = |pane: &Pane, before: Option<&PaneState>| {
            let (old, new) = (&before?.outcome, pane.outcome.as_ref()?);
            (!Arc::ptr_eq(old, new)).then(|| cycle_durations(old, new))
        };
        let before = |index: usize| self.panes.get(index).and_then(Option::as_ref);
        let first = panes.first().and_then(|pane| replaced(pane, before(0)));
        if let (false, Some(Some([old_secs, new_secs]))) = (is_moved, first) {
            let to = self.now_secs / old_secs * new_secs;
            let duration = timeline.duration_secs;
            let to = if to > duration { to.rem_euclid(duration.max(new_secs)) } else { to };
            set(params, Key::Time, Value::Number(to));
        }
        let now_secs = timeline.now_secs(params);
        for (index, pane) in panes.iter_mut().enumerate() {
            let replaced = replaced(pane, before(index));
            if is_moved {
                pane.ramp = None;
            }
            let (Some(durations), Some(before)) = (replaced, before(index)) else { continue };
            (pane.place, pane.ramp) = (Planar::IDENTITY, None);
            if is_moved || durations.is_none() {
                continue;
            }
            if is_playing && differ_in_speed_alone(before.inputs.as_ref(), pane.inputs.as_ref()) {
                pane.ramp = Some(before.ramp.clone());
            }
            pane.place_character(now_secs, &before.world_from_character);
        }
    }
}

/// Places every result where it was made, so that a link shows the same to everybody.
pub(crate) fn restart(panes: &mut [Pane]) {
    for pane in panes {
        (pane.place, pane.ramp) = (Planar::IDENTITY, None);
    }
}

/// Advances the gaits that approach another speed. Returns whether there were any.
pub(crate) fn advance_ramps(
    timeline: &Timeline,
    params: &Params,
    panes: &mut [Pane],
    dt_secs: f64,
) -> bool {
    let (now_secs, is_playing) = (timeline.now_secs(params), params.is_on(Key::Play));
    let mut any = false;
    for pane in panes {
        any |= pane.advance_ramp(now_secs, dt_secs, is_playing);
    }
    any
}

/// Restarts the span after the playhead has reached its end `wraps` times. The character continues
/// from there if the camera follows it; with a fixed camera or several panes it returns to the
/// start.
fn wrap_playhead(params: &Params, panes: &mut [Pane], span: Span, wraps: usize) {
    let walks_on = panes.len() == 1 && params.choice::<Follow>() != Follow::Off;
    for pane in panes {
        if !walks_on || pane.outcome.as_ref().is_none_or(|outcome| outcome.cycle.is_none()) {
            pane.place = Planar::IDENTITY;
            continue;
        }
        for _ in 0..wraps {
            if let Some(character) = pane.world_from_character(span.end) {
                pane.place_character(span.start, &character);
            }
        }
    }
}

impl Pane {
    /// Returns the placement of the character in the shown world.
    fn world_from_character(&self, secs: f64) -> Option<Planar> {
        let shown = self.shown_at(secs)?;
        Some(shown.place.after(&shown.outcome.motion.standing_at(shown.secs)))
    }

    /// Places the result so that the character is there at this time.
    fn place_character(&mut self, secs: f64, world_from_character: &Planar) {
        self.place = Planar::IDENTITY;
        if let Some(present) = self.world_from_character(secs) {
            self.place = world_from_character.after(&present.inverse());
        }
    }

    /// Advances the gait that approaches another speed. A paused one takes that speed at once.
    /// Returns whether there was one.
    fn advance_ramp(&mut self, now_secs: f64, dt_secs: f64, is_playing: bool) -> bool {
        let character = self.world_from_character(now_secs);
        let (Some(ramp), Some(outcome)) = (self.ramp.take(), &self.outcome) else {
            return false;
        };
        if is_playing {
            self.ramp = ramp.advance(outcome, self.inputs.as_ref(), dt_secs);
        }
        if let Some(character) = character {
            self.place_character(now_secs, &character);
        }
        true
    }
}

#[cfg(test)]
mod tests;
