//! The characters of the Match lab that the user drives.

use super::Session;
use crate::choices::Scenario;
use crate::command::{CommandError, DriveCommand};
use crate::labs::filter_of;
use crate::params::{Key, List, Params, Value};
use segue_motion::matching::{Control, Database, Recording};
use segue_motion::skeleton::Pose;
use std::sync::Arc;

impl Session {
    /// Returns whether a character is driven now: it continues with time, and has no end.
    #[must_use]
    pub fn is_driven(&self) -> bool {
        let panes = self.panes.list.iter().enumerate();
        panes
            .filter(|(_, pane)| pane.problem.is_none())
            .any(|(index, _)| self.drive.has_character(index))
    }

    /// Returns the present input.
    #[must_use]
    pub fn control(&self) -> Control {
        self.drive.control()
    }

    /// Returns the input since the characters stood at the origin.
    #[must_use]
    pub fn recording(&self) -> &Recording {
        self.drive.recording()
    }

    /// Returns the crowd around the character: the database that it comes from, and its poses in
    /// the world.
    #[must_use]
    pub fn crowd(&self) -> Option<(&Arc<Database>, Vec<&Pose>)> {
        self.drive.crowd()
    }

    /// Records the duration of the last call of [`Session::tick`], seconds, because the session has
    /// no clock.
    pub fn tick_took(&mut self, secs: f64) {
        self.drive.note_duration(secs);
    }

    /// Changes the input. Input that begins to request motion starts playback.
    pub(super) fn steer(&mut self, control: Control) {
        if self.drive.steer(control) && self.is_driven() && !self.document.params.is_on(Key::Play) {
            self.document.set_unchecked(Key::Play, Value::Switch(true));
            self.revision += 1;
        }
    }

    pub(super) fn apply_drive(&mut self, command: DriveCommand) -> Result<(), CommandError> {
        match command {
            DriveCommand::Steer(control) => self.steer(control),
            DriveCommand::Restart => self.drive.restart(),
            DriveCommand::Replay => {
                if self.drive.recording().ticks() == 0 {
                    return Err(CommandError::NotPossible("nothing is recorded yet"));
                }
                let recording = List::Recording(Some(self.drive.recording().clone()));
                self.set_as_step(vec![
                    (Key::Scenario, Scenario::Own.into()),
                    (Key::Drive, recording.into()),
                    (Key::Time, Value::Number(0.0)),
                ])?;
            }
        }
        Ok(())
    }

    /// Advances the time of the driven characters.
    pub(super) fn advance_drive(&mut self, dt_secs: f64) {
        // Tags that cannot be read are refused where the database is requested.
        let filter = filter_of(&self.document.params).unwrap_or_default();
        let outcomes = self.drive.advance(dt_secs, filter, &mut self.labs.meter);
        self.panes.show_next(outcomes);
    }

    /// Moves the driven characters by whole ticks; they cannot go back.
    pub(super) fn step_drive(&mut self, ticks: i64) {
        let filter = filter_of(&self.document.params).unwrap_or_default();
        let ticks = ticks.clamp(0, 60) as usize;
        let outcomes = self.drive.tick(ticks, filter, &mut self.labs.meter);
        self.panes.show_next(outcomes);
    }

    /// Returns the parameters by which the result of a driven pane is made again: with the recorded
    /// input.
    pub(super) fn with_recording(&self, mut params: Params) -> Params {
        if self.is_driven() {
            let recording = Some(self.drive.recording().clone());
            let driven = recording.filter(|recording| recording.ticks() > 0);
            let result = params.set(Key::Drive, List::Recording(driven).into());
            debug_assert!(result.is_ok(), "{result:?}");
        }
        params
    }
}
