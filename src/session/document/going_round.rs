//! Results that go round: they walk on when the playhead begins again, and go on in the same phase when they give way to another.

use super::Session;
use crate::math::Planar;
use crate::session::params::{Key, Value};
use crate::session::recipe::{CycleMade, Outcome};
use std::mem::discriminant;
use std::sync::Arc;

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
    outcome: Arc<Outcome>,
    /// Where the character stands.
    character: Planar,
}

/// The cycles' durations, if one result can go on where the other is: both are cycles, and of the same kind.
fn durations(old: &Outcome, new: &Outcome) -> Option<[f64; 2]> {
    let (old, new) = (old.cycle?, new.cycle?);
    let kind = |made: &CycleMade| discriminant(made);
    (kind(&old.made) == kind(&new.made) && old.secs > 0.0).then_some([old.secs, new.secs])
}

impl Session {
    /// What is shown, to be gone on with.
    pub(super) fn held(&self) -> Held {
        let now_secs = self.now_secs();
        let showing = |pane: &super::Pane| {
            let outcome = Arc::clone(pane.outcome.as_ref()?);
            let (secs, place) = pane.shown_at(now_secs);
            let character = place.after(&outcome.motion.standing_at(secs));
            Some(Showing { outcome, character })
        };
        Held {
            time: self.params.number(Key::Time),
            now_secs,
            panes: self.panes.iter().map(showing).collect(),
        }
    }

    /// Goes on with what was shown: where a cycle gave way to another, the playhead keeps its phase and the character its place. Unless the
    /// playhead was put elsewhere: then everything begins where it lies.
    pub(super) fn go_on_from(&mut self, held: &Held) {
        let moved = self.params.number(Key::Time) != held.time;
        let replaced = |session: &Self, index: usize| {
            let old = &held.panes.get(index)?.as_ref()?.outcome;
            let new = session.panes.get(index)?.outcome.as_ref()?;
            (!Arc::ptr_eq(old, new)).then(|| durations(old, new))
        };
        if let (false, Some(Some([old_secs, new_secs]))) = (moved, replaced(self, 0)) {
            let to = held.now_secs / old_secs * new_secs;
            let duration = self.duration_secs();
            let to = if to > duration { to.rem_euclid(duration.max(new_secs)) } else { to };
            self.set_unchecked(Key::Time, Value::Number(to));
        }
        let now_secs = self.now_secs();
        for index in 0..self.panes.len() {
            let Some(alike) = replaced(self, index) else { continue };
            let pane = &mut self.panes[index];
            pane.place = Planar::IDENTITY;
            let shown = held.panes.get(index).and_then(Option::as_ref);
            if let (false, Some(_), Some(shown), Some(outcome)) = (moved, alike, shown, &pane.outcome) {
                let (secs, place) = pane.shown_at(now_secs);
                let stands = place.after(&outcome.motion.standing_at(secs));
                pane.place = shown.character.after(&stands.inverse());
            }
        }
    }

    /// The playhead has come to the end of what plays, `rounds` times, and begins again. The character goes on from there if the camera is with it;
    /// if the camera stands, or several panes run against each other, it goes back to the start.
    pub(super) fn come_round(&mut self, rounds: usize) {
        let span = self.span();
        let walks_on = self.panes.len() == 1 && self.params.text(Key::Follow) != "off";
        for pane in &mut self.panes {
            let Some(outcome) = pane.outcome.as_ref().filter(|outcome| walks_on && outcome.cycle.is_some()) else {
                pane.place = Planar::IDENTITY;
                continue;
            };
            // From the place of the last pose to that of the first.
            let step = (outcome.motion.standing_at(span.end)).after(&outcome.motion.standing_at(span.start).inverse());
            for _ in 0..rounds {
                pane.place = pane.place.after(&step);
            }
        }
    }
}
