//! The characters of the Match lab that the user drives: they continue while time advances, and all
//! their input is recorded.

use super::crowd::Crowd;
use super::live::Live;
use super::settings::options_in;
use crate::labs::answer::Answer;
use crate::labs::artefact_meter::ArtefactMeter;
use crate::labs::error::LabError;
use crate::labs::outcome::Outcome;
use crate::metrics::{Metric, MetricId};
use crate::params::Params;
use segue_motion::matching::{Control, ControllerOptions, Database, RATE, Recording, TagFilter};
use segue_motion::skeleton::Pose;
use std::sync::Arc;

/// The duration of a tick, seconds.
const TICK_SECS: f64 = 1.0 / RATE as f64;
/// The most ticks that are caught up after a pause of the page.
const MAX_TICKS: usize = 20;

/// The characters that the user drives: one in each pane, all with the same input.
#[derive(Debug, Default)]
pub(crate) struct LiveDrive {
    /// One for each pane; `None` in one whose database is not there yet.
    lives: Vec<Option<Live>>,
    crowd: Option<Crowd>,
    /// The present input.
    control: Control,
    /// The input of every tick so far.
    recording: Recording,
    /// Time that is not yet a whole tick, seconds.
    left_secs: f64,
    /// The ticks of the last call, whose duration is not known yet.
    unmeasured: usize,
    /// The duration of a tick of all characters, milliseconds, smoothed; 0 until it is measured.
    tick_ms: f64,
}

/// A pane with a driven character: the database that it requests, and the result that it shows.
pub(crate) struct DrivenPane {
    pub(crate) params: Arc<Params>,
    /// `None` while the database is built.
    pub(crate) database: Result<Option<Arc<Database>>, LabError>,
    pub(crate) shown: Option<Arc<Outcome>>,
}

impl LiveDrive {
    /// Returns whether there is a character in a pane.
    pub(crate) fn has_character(&self, pane: usize) -> bool {
        self.lives.get(pane).is_some_and(Option::is_some)
    }

    /// Returns the first character.
    fn main_live(&self) -> Option<&Live> {
        self.lives.iter().flatten().next()
    }

    /// Returns the present input.
    pub(crate) fn control(&self) -> Control {
        self.control
    }

    /// Returns the input since the characters stood at the origin.
    pub(crate) fn recording(&self) -> &Recording {
        &self.recording
    }

    /// Returns the crowd: the database that it comes from, and its poses in the world.
    pub(crate) fn crowd(&self) -> Option<(&Arc<Database>, Vec<&Pose>)> {
        let crowd = self.crowd.as_ref()?;
        Some((crowd.database(), crowd.poses().collect()))
    }

    /// Returns the time of the history that is shown, seconds: one tick behind its end, so that
    /// motion is smooth at any rate of the screen. `None` without a character.
    pub(crate) fn shown_secs(&self) -> Option<f64> {
        let live = self.main_live()?;
        Some((live.kept_secs() - TICK_SECS + self.left_secs).max(0.0))
    }

    /// Sets the input from now on. Returns whether it begins to request motion.
    pub(crate) fn steer(&mut self, control: Control) -> bool {
        let before = std::mem::replace(&mut self.control, control);
        before.is_at_rest() && !control.is_at_rest()
    }

    /// Puts the characters at the origin, and discards the recording.
    pub(crate) fn restart(&mut self) {
        *self = Self { control: self.control, ..Self::default() };
    }

    /// Advances the time. Returns the new outcome of each pane.
    pub(crate) fn advance(
        &mut self,
        dt_secs: f64,
        filter: TagFilter,
        meter: &mut ArtefactMeter,
    ) -> Vec<Option<Outcome>> {
        self.left_secs += dt_secs.max(0.0);
        let ticks = (self.left_secs / TICK_SECS) as usize;
        self.left_secs -= ticks as f64 * TICK_SECS;
        self.tick(ticks.min(MAX_TICKS), filter, meter)
    }

    /// Records the duration of the last ticks together, seconds.
    pub(crate) fn note_duration(&mut self, secs: f64) {
        let ticks = std::mem::take(&mut self.unmeasured);
        if ticks > 0 {
            let now = secs * 1e3 / ticks as f64;
            let known = self.tick_ms;
            self.tick_ms = if known > 0.0 { known + 0.05 * (now - known) } else { now };
        }
    }

    /// Advances by ticks with the present input. Returns the new outcome of each pane; none without
    /// a tick.
    pub(crate) fn tick(
        &mut self,
        ticks: usize,
        filter: TagFilter,
        meter: &mut ArtefactMeter,
    ) -> Vec<Option<Outcome>> {
        self.unmeasured = ticks;
        let control = self.control.with_filter(filter);
        for _ in 0..ticks {
            // A full recording keeps its first half hour.
            self.recording.push(control);
            for live in self.lives.iter_mut().flatten() {
                live.tick(&control);
            }
            if let (Some(crowd), Some(live)) =
                (self.crowd.as_mut(), self.lives.iter().flatten().next())
            {
                crowd.tick(&live.root());
            }
        }
        if ticks == 0 {
            return Vec::new();
        }
        let tick_ms = (self.tick_ms > 0.0).then_some(self.tick_ms);
        let outcome = |live: &mut Option<Live>| {
            // If the outcome fails, the pane stays as it was until the next tick.
            let mut outcome = live.as_mut()?.outcome(meter).ok()?;
            outcome.metrics.push(Metric::new(MetricId::TickTime, tick_ms));
            Some(outcome)
        };
        self.lives.iter_mut().map(outcome).collect()
    }

    /// Adapts the characters to the requests of the panes, with a crowd of `crowd` around them.
    /// Returns the answer for each pane.
    pub(crate) fn refresh(
        &mut self,
        panes: Vec<DrivenPane>,
        crowd: usize,
        meter: &mut ArtefactMeter,
    ) -> Vec<Answer> {
        self.lives.resize_with(panes.len(), || None);
        let has_begun = |(live, pane): (&Option<Live>, &DrivenPane)| match &pane.database {
            Ok(Some(database)) => live.as_ref().is_some_and(|live| live.plays(database)),
            _ => true,
        };
        // All panes have the same input from the same start: if one begins, all do.
        if !self.lives.iter().zip(&panes).all(has_begun) {
            self.lives.fill_with(|| None);
            self.recording = Recording::new();
        }
        let mut main = None;
        let mut answers = Vec::with_capacity(panes.len());
        for (live, DrivenPane { params, database, shown }) in self.lives.iter_mut().zip(panes) {
            answers.push(match database {
                // The old database plays until the new one is available.
                Ok(None) => Answer::Awaited,
                Ok(Some(database)) => options_in(&database, &params)
                    .and_then(|options| {
                        main = main.take().or(Some((Arc::clone(&database), options)));
                        answer(live, shown.as_deref(), &database, options, meter)
                    })
                    .unwrap_or_else(Answer::Refused),
                Err(problem) => Answer::Refused(problem),
            });
        }
        self.crowd = match (self.crowd.take(), main) {
            (_, Some(_)) if crowd == 0 => None,
            (Some(mut known), Some((database, options))) if known.is_of(&database, crowd) => {
                known.change(options).is_ok().then_some(known)
            }
            (_, Some((database, options))) => {
                let about = self.main_live().map(Live::root).unwrap_or_default();
                Crowd::new(&database, options, &about, crowd).ok()
            }
            (known, None) => known,
        };
        answers
    }
}

/// Returns whether a pane shows a drive through that database.
fn is_shown(shown: Option<&Outcome>, database: &Arc<Database>) -> bool {
    let driven = shown.and_then(Outcome::driven);
    driven.is_some_and(|driven| driven.is_live && Arc::ptr_eq(&driven.database, database))
}

/// Returns the answer for a pane. Its character takes the options; a new one begins if there is
/// none.
fn answer(
    live: &mut Option<Live>,
    shown: Option<&Outcome>,
    database: &Arc<Database>,
    options: ControllerOptions,
    meter: &mut ArtefactMeter,
) -> Result<Answer, LabError> {
    let (is_changed, live) = match live {
        Some(live) => (live.change(database, options)?, live),
        None => (true, live.insert(Live::new(database, options)?)),
    };
    if !is_changed && is_shown(shown, database) {
        return Ok(Answer::Same { is_draft: false });
    }
    Ok(Answer::Made { outcome: Arc::new(live.outcome(meter)?), is_draft: false, inputs: None })
}
