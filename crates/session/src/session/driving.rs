//! The character of the Match lab at the user's hand: it goes on by itself while time runs, and
//! everything that it was told is written down.

use super::Session;
use super::panes::{Answer, Pane};
use crate::choices;
use crate::command::CommandError;
use crate::labs::LabError;
use crate::labs::{Crowd, Gauge, HandTag, Live, filter_of, lab, options_in, read_ids, read_tags};
use crate::params::{Key, Params, Value};
use segue_motion::matching::{Control, ControllerOptions, Database, RATE, Recording};
use segue_motion::metrics::Metric;
use segue_motion::skeleton::Pose;
use std::sync::Arc;

/// Seconds of a tick.
const TICK_SECS: f64 = 1.0 / RATE as f64;
/// After a pause of the page nobody wants to wait for all that was missed, ticks.
const MOST_TICKS: usize = 20;

/// What the user drives: one character in each pane, all with the same input.
#[derive(Debug, Default)]
pub(super) struct Driving {
    /// One for each pane; `None` in one whose database is not there yet.
    lives: Vec<Option<Live>>,
    crowd: Option<Crowd>,
    /// What is asked for now.
    control: Control,
    /// What was asked for in every tick so far.
    recording: Recording,
    /// Time that is no tick yet, seconds.
    left_secs: f64,
    /// Ticks of the last call, whose duration is not known yet.
    unmeasured: usize,
    /// How long a tick of all characters takes, milliseconds, smoothed; 0 while nobody measured it.
    tick_ms: f64,
}

/// Whether these parameters let the user drive.
fn is_own(params: &Params) -> bool {
    lab::of(params.lab()).is_own_drive(params)
}

/// What a pane is driven by: its parameters, and its database; `None` while that is built.
type Wanted = (Arc<Params>, Result<Option<Arc<Database>>, LabError>);

impl Session {
    /// Whether a character is driven now: it goes on with time, and has no end.
    #[must_use]
    pub fn is_driven(&self) -> bool {
        let is_one =
            |(pane, live): (&Pane, &Option<Live>)| pane.problem.is_none() && live.is_some();
        self.panes.iter().zip(&self.driving.lives).any(is_one)
    }

    /// The first character that there is.
    fn main_live(&self) -> Option<&Live> {
        self.driving.lives.iter().flatten().next()
    }

    /// What the character is asked for now.
    #[must_use]
    pub fn control(&self) -> Control {
        self.driving.control
    }

    /// What it was asked for since it stood at the origin.
    #[must_use]
    pub fn recording(&self) -> &Recording {
        &self.driving.recording
    }

    /// Those who walk about it: their poses in the world, and the database that they come from.
    #[must_use]
    pub fn crowd(&self) -> Option<(&Arc<Database>, Vec<&Pose>)> {
        let crowd = self.driving.crowd.as_ref()?;
        Some((crowd.database(), crowd.poses().collect()))
    }

    /// The ids of the clips of the Match lab; none where the synthesiser's set is used or the list
    /// cannot be read.
    #[must_use]
    pub fn match_clip_ids(&self) -> Vec<String> {
        read_ids(self.document.params.text(Key::MatchClips)).unwrap_or_default()
    }

    /// The time in what was seen last that is shown now: one tick behind, so that it is smooth at
    /// any rate of the screen.
    pub(super) fn driven_secs(&self) -> Option<f64> {
        let live = self.main_live().filter(|_| self.is_driven())?;
        Some((live.kept_secs() - TICK_SECS + self.driving.left_secs).max(0.0))
    }

    /// What the character is asked for from now on. Whoever begins to push wants it to move: time
    /// runs then.
    pub(super) fn steer(&mut self, control: Control) {
        let before = std::mem::replace(&mut self.driving.control, control);
        if self.is_driven()
            && before.is_at_rest()
            && !control.is_at_rest()
            && !self.document.params.is_on(Key::Play)
        {
            self.document.set_unchecked(Key::Play, Value::Switch(true));
            self.revision += 1;
        }
    }

    /// The characters stand at the origin again, and nothing is written down.
    pub(super) fn restart_driving(&mut self) {
        self.driving = Driving { control: self.driving.control, ..Driving::default() };
    }

    /// What was written down becomes the input.
    pub(super) fn replay_driving(&mut self) -> Result<(), CommandError> {
        if self.driving.recording.ticks() == 0 {
            return Err(CommandError::NotPossible("nothing was driven yet"));
        }
        let text = self.driving.recording.to_text();
        self.set(vec![
            (Key::Scenario, choices::Scenario::Own.into()),
            (Key::Drive, Value::Text(text)),
            (Key::Time, Value::Number(0.0)),
        ])?;
        self.document.settle();
        Ok(())
    }

    /// Time passes for the characters. Says whether there were any.
    pub(super) fn drive_on(&mut self, dt_secs: f64) -> bool {
        if !self.is_driven() {
            return false;
        }
        self.driving.left_secs += dt_secs.max(0.0);
        let ticks = (self.driving.left_secs / TICK_SECS) as usize;
        self.driving.left_secs -= ticks as f64 * TICK_SECS;
        self.drive_ticks(ticks.min(MOST_TICKS));
        true
    }

    /// How long the last call of [`Session::tick`] took, seconds: there is no clock here.
    pub fn tick_took(&mut self, secs: f64) {
        let ticks = std::mem::take(&mut self.driving.unmeasured);
        if ticks > 0 {
            let now = secs * 1e3 / ticks as f64;
            let known = self.driving.tick_ms;
            self.driving.tick_ms = if known > 0.0 { known + 0.05 * (now - known) } else { now };
        }
    }

    /// So many ticks with the present input.
    pub(super) fn drive_ticks(&mut self, ticks: usize) {
        // One that cannot be read is told where the database is asked for.
        let filter = filter_of(&self.document.params).unwrap_or_default();
        let Driving { lives, crowd, control, recording, unmeasured, tick_ms, .. } =
            &mut self.driving;
        *unmeasured = ticks;
        let control = control.with_filter(filter);
        for _ in 0..ticks {
            // A recording that is full holds the first half hour.
            recording.push(control);
            for live in lives.iter_mut().flatten() {
                live.tick(&control);
            }
            if let (Some(crowd), Some(live)) = (crowd.as_mut(), lives.iter().flatten().next()) {
                crowd.tick(&live.root());
            }
        }
        if ticks > 0 {
            for (pane, live) in self.panes.iter_mut().zip(lives) {
                let Some(live) = live else { continue };
                let timed = Metric::fact(
                    "match_tick_ms",
                    "time per tick",
                    (*tick_ms > 0.0).then_some(*tick_ms),
                    "ms",
                    "How long a sixtieth of a second of all characters takes to compute, searches included.",
                );
                // One that cannot be told of stays as it was: its next moment can.
                if let Ok(mut outcome) = live.outcome(&mut self.labs.gauge) {
                    outcome.metrics.push(timed);
                    pane.go_on(outcome);
                }
            }
        }
    }

    /// The characters that the parameters ask for; none where nobody drives.
    pub(super) fn refresh_driving(&mut self) {
        if !is_own(&self.document.params) {
            self.restart_driving();
            return;
        }
        let wanted: Vec<Params> = self.panes.iter().map(|pane| self.params_of(pane)).collect();
        let wanted: Vec<Wanted> = wanted
            .into_iter()
            .map(|params| {
                let database = self.match_database(&params);
                (Arc::new(params), database)
            })
            .collect();
        let Driving { lives, recording, .. } = &mut self.driving;
        lives.resize_with(wanted.len(), || None);
        let is_begun = |(live, (_, database)): (&Option<Live>, &Wanted)| match database {
            Ok(Some(database)) => live.as_ref().is_some_and(|live| live.plays(database)),
            _ => true,
        };
        // Panes are driven by the same input from the same start: where one begins, all do.
        if !lives.iter().zip(&wanted).all(is_begun) {
            lives.fill_with(|| None);
            *recording = Recording::new();
        }
        let mut main = None;
        for (index, (params, database)) in wanted.into_iter().enumerate() {
            let (Some(pane), Some(live)) =
                (self.panes.get_mut(index), self.driving.lives.get_mut(index))
            else {
                continue;
            };
            let answer = match database {
                // The old one is played until the new one is there.
                Ok(None) => Answer::Awaited,
                Ok(Some(database)) => options_in(&database, &params)
                    .and_then(|options| {
                        main = main.take().or(Some((Arc::clone(&database), options)));
                        driven(live, pane, &database, options, &mut self.labs.gauge)
                    })
                    .unwrap_or_else(Answer::Refused),
                Err(problem) => Answer::Refused(problem),
            };
            pane.take(answer, &params);
        }
        let count = self.document.params.number(Key::Crowd) as usize - 1;
        self.driving.crowd = match (self.driving.crowd.take(), main) {
            (_, Some(_)) if count == 0 => None,
            (Some(mut crowd), Some((database, options))) if crowd.is_of(&database, count) => {
                crowd.change(options).is_ok().then_some(crowd)
            }
            (_, Some((database, options))) => {
                let about = self.main_live().map(Live::root).unwrap_or_default();
                Crowd::new(&database, options, &about, count).ok()
            }
            (crowd, None) => crowd,
        };
    }

    /// The tags that were set by hand; none where they cannot be read.
    #[must_use]
    pub fn hand_tags(&self) -> Vec<HandTag> {
        read_tags(self.document.params.text(Key::Tags)).unwrap_or_default()
    }

    /// The database that the parameters ask for; `None` while it is built.
    pub(super) fn match_database(
        &mut self,
        params: &Params,
    ) -> Result<Option<Arc<Database>>, LabError> {
        let clips = self.lab_clips(params)?;
        self.labs.match_database(clips, params)
    }

    /// The parameters under which what a driven pane shows is made again: the input is written
    /// down.
    pub(super) fn with_recording(&self, mut params: Params) -> Params {
        if self.is_driven() {
            let text = Value::Text(self.driving.recording.to_text());
            let result = params.set(Key::Drive, text);
            debug_assert!(result.is_ok(), "{result:?}");
        }
        params
    }

    /// Whether the user drives in the lab that is open, now or as soon as there is a database.
    pub(super) fn is_own_drive(&self) -> bool {
        is_own(&self.document.params)
    }
}

/// Whether a pane shows what was driven in that database.
fn is_shown(pane: &Pane, database: &Arc<Database>) -> bool {
    let driven = pane.outcome.as_ref().and_then(|outcome| outcome.driven());
    driven.is_some_and(|driven| driven.is_live && Arc::ptr_eq(&driven.database, database))
}

/// What a pane shows of its character, which is told what has changed, and begins where there is
/// none.
fn driven(
    live: &mut Option<Live>,
    pane: &Pane,
    database: &Arc<Database>,
    options: ControllerOptions,
    gauge: &mut Gauge,
) -> Result<Answer, LabError> {
    let (changed, live) = match live {
        Some(live) => (live.change(database, options)?, live),
        None => (true, live.insert(Live::new(database, options)?)),
    };
    if !changed && is_shown(pane, database) {
        return Ok(Answer::Same { is_draft: false });
    }
    Ok(Answer::Made { outcome: Arc::new(live.outcome(gauge)?), is_draft: false, inputs: None })
}
