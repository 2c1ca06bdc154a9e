//! Results that go round: they walk on when the playhead begins again, and go on in the same phase
//! when they give way to another. A gait takes on another speed little by little.

use super::Session;
use super::panes::Pane;
use crate::choices;
use crate::labs::{CycleMade, Inputs, Outcome, SpeedInputs};
use crate::params::{Key, Value};
use segue_motion::gait::SpeedOptions;
use segue_motion::math::{Planar, spring};
use std::mem::discriminant;
use std::sync::Arc;

/// A gait on its way to the speed that was asked for: the speed is a critically damped spring, as
/// that of a [`SpeedPlayer`](segue_motion::gait::SpeedPlayer).
#[derive(Clone, Debug)]
pub(super) struct Glide {
    speed_mps: f64,
    acceleration: f64,
    /// The gait at the speed that is reached by now.
    pub(super) outcome: Arc<Outcome>,
}

/// Speeds and accelerations that nobody sees the end of: metres per second, and per second squared.
const ARRIVED: [f64; 2] = [0.01, 0.05];

/// What was shown before a change.
pub(super) struct Held {
    /// The playhead as the parameters have it.
    time: f64,
    /// The playhead inside of the timeline.
    now_secs: f64,
    panes: Vec<Option<Showing>>,
}

/// What a pane shows.
struct Showing {
    /// The pane's result.
    outcome: Arc<Outcome>,
    inputs: Option<Inputs>,
    /// What is on the stage: the result, or a gait on its way to it.
    glide: Glide,
    /// Where the character stands.
    character: Planar,
}

/// The cycles' durations, if one result can go on where the other is: both are cycles, and of the
/// same kind.
pub(super) fn durations(old: &Outcome, new: &Outcome) -> Option<[f64; 2]> {
    let (old, new) = (old.cycle?, new.cycle?);
    let kind = |made: &CycleMade| discriminant(made);
    (kind(&old.made) == kind(&new.made) && old.secs > 0.0).then_some([old.secs, new.secs])
}

/// What a gait was made from; `None` for what is none.
fn gait_of(inputs: Option<&Inputs>) -> Option<&SpeedInputs> {
    inputs?.of_lab()
}

/// The speed of a gait; 0 for what is none.
fn speed_of(outcome: &Outcome) -> f64 {
    match outcome.cycle.map(|cycle| cycle.made) {
        Some(CycleMade::Gait { facts, .. }) => facts.speed_mps,
        _ => 0.0,
    }
}

impl Pane {
    /// Where the character stands in the world that is shown.
    fn character(&self, secs: f64) -> Option<Planar> {
        let shown = self.shown_at(secs)?;
        Some(shown.place.after(&shown.outcome.motion.standing_at(shown.secs)))
    }

    /// Lays what is shown so that the character stands there at this time.
    fn lay(&mut self, secs: f64, character: &Planar) {
        self.place = Planar::IDENTITY;
        if let Some(stands) = self.character(secs) {
            self.place = character.after(&stands.inverse());
        }
    }

    /// Brings a gait on its way nearer to its speed. Says whether there was one.
    fn glide_on(&mut self, now_secs: f64, dt_secs: f64, playing: bool) -> bool {
        let character = self.character(now_secs);
        let (Some(mut glide), Some(outcome)) = (self.glide.take(), &self.outcome) else {
            return false;
        };
        let target = speed_of(outcome);
        let half_life_secs = SpeedOptions::default().half_life_secs;
        let (speed, acceleration) =
            spring::towards(glide.speed_mps, glide.acceleration, target, half_life_secs, dt_secs);
        let arrived = (speed - target).abs() < ARRIVED[0] && acceleration.abs() < ARRIVED[1];
        // A picture that stands shows what was asked for.
        if let (true, false, Some(inputs)) = (playing, arrived, gait_of(self.inputs.as_ref()))
            && let Ok(outcome) = inputs.run_at(speed)
        {
            (glide.speed_mps, glide.acceleration, glide.outcome) =
                (speed, acceleration, Arc::new(outcome));
            self.glide = Some(glide);
        }
        if let Some(character) = character {
            self.lay(now_secs, &character);
        }
        true
    }
}

impl Session {
    /// What is shown, to be gone on with.
    pub(super) fn held(&self) -> Held {
        let now_secs = self.now_secs();
        let showing = |pane: &Pane| {
            let outcome = Arc::clone(pane.outcome.as_ref()?);
            let standing = || Glide {
                speed_mps: speed_of(&outcome),
                acceleration: 0.0,
                outcome: Arc::clone(&outcome),
            };
            Some(Showing {
                glide: pane.glide.clone().unwrap_or_else(standing),
                inputs: pane.inputs.clone(),
                character: pane.character(now_secs)?,
                outcome,
            })
        };
        Held {
            time: self.document.params.number(Key::Time),
            now_secs,
            panes: self.panes.iter().map(showing).collect(),
        }
    }

    /// Goes on with what was shown: where a cycle gave way to another, the playhead keeps its phase
    /// and the character its place, and a gait that plays changes its speed from the one that it
    /// has. Unless the playhead was put elsewhere: then everything begins where it lies.
    pub(super) fn go_on_from(&mut self, held: &Held) {
        let moved = self.document.params.number(Key::Time) != held.time;
        let playing = self.document.params.is_on(Key::Play);
        let replaced = |session: &Self, index: usize| {
            let old = &held.panes.get(index)?.as_ref()?.outcome;
            let new = session.panes.get(index)?.outcome.as_ref()?;
            (!Arc::ptr_eq(old, new)).then(|| durations(old, new))
        };
        if let (false, Some(Some([old_secs, new_secs]))) = (moved, replaced(self, 0)) {
            let to = held.now_secs / old_secs * new_secs;
            let duration = self.duration_secs();
            let to = if to > duration { to.rem_euclid(duration.max(new_secs)) } else { to };
            self.document.set_unchecked(Key::Time, Value::Number(to));
        }
        let now_secs = self.now_secs();
        for index in 0..self.panes.len() {
            let replaced = replaced(self, index);
            let pane = &mut self.panes[index];
            if moved {
                pane.glide = None;
            }
            let Some(alike) = replaced else { continue };
            (pane.place, pane.glide) = (Planar::IDENTITY, None);
            let Some(shown) = held.panes.get(index).and_then(Option::as_ref) else {
                continue;
            };
            if moved || alike.is_none() {
                continue;
            }
            if let (true, Some(old), Some(new)) =
                (playing, gait_of(shown.inputs.as_ref()), gait_of(pane.inputs.as_ref()))
                && old.differs_in_speed_alone(new)
            {
                pane.glide = Some(shown.glide.clone());
            }
            pane.lay(now_secs, &shown.character);
        }
    }

    /// Every result lies where it was made: a link shows the same to everybody.
    pub(super) fn begin_anew(&mut self) {
        for pane in &mut self.panes {
            (pane.place, pane.glide) = (Planar::IDENTITY, None);
        }
    }

    /// Gaits on their way to another speed get nearer to it. Says whether there were any.
    pub(super) fn glide(&mut self, dt_secs: f64) -> bool {
        let (now_secs, playing) = (self.now_secs(), self.document.params.is_on(Key::Play));
        let mut any = false;
        for pane in &mut self.panes {
            any |= pane.glide_on(now_secs, dt_secs, playing);
        }
        any
    }

    /// The playhead has come to the end of what plays, `rounds` times, and begins again. The
    /// character goes on from there if the camera is with it; if the camera stands, or several
    /// panes run against each other, it goes back to the start.
    pub(super) fn come_round(&mut self, rounds: usize) {
        let span = self.span();
        let walks_on = self.panes.len() == 1
            && self.document.params.choice::<choices::Follow>() != choices::Follow::Off;
        for pane in &mut self.panes {
            if !walks_on || pane.outcome.as_ref().is_none_or(|outcome| outcome.cycle.is_none()) {
                pane.place = Planar::IDENTITY;
                continue;
            }
            for _ in 0..rounds {
                if let Some(character) = pane.character(span.end) {
                    pane.lay(span.start, &character);
                }
            }
        }
    }
}
