//! The characters of the Match lab that the user drives.

use super::Session;
use crate::choices::Scenario;
use crate::command::{CommandError, DriveCommand};
use crate::labs::{HandTag, filter_of, read_ids, read_tags};
use crate::params::{Key, Params, Value};
use segue_motion::matching::{Control, Database, Recording};
use segue_motion::skeleton::Pose;
use std::sync::Arc;

impl Session {
    /// Returns whether a character is driven now: it goes on with time, and has no end.
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

    /// Returns the crowd about the character: the database that it comes from, and its poses in the
    /// world.
    #[must_use]
    pub fn crowd(&self) -> Option<(&Arc<Database>, Vec<&Pose>)> {
        self.drive.crowd()
    }

    /// Returns the ids of the clips of the Match lab; none where the synthesiser's set is used or
    /// the list cannot be read.
    #[must_use]
    pub fn match_clip_ids(&self) -> Vec<String> {
        read_ids(self.document.params.text(Key::MatchClips)).unwrap_or_default()
    }

    /// Returns the tags that were set by hand; none where they cannot be read.
    #[must_use]
    pub fn hand_tags(&self) -> Vec<HandTag> {
        read_tags(self.document.params.text(Key::Tags)).unwrap_or_default()
    }

    /// Takes in how long the last call of [`Session::tick`] took, seconds: the session has no
    /// clock.
    pub fn tick_took(&mut self, secs: f64) {
        self.drive.note_duration(secs);
    }

    /// Changes the input. One that begins to ask for motion has time run.
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
                    return Err(CommandError::NotPossible("nothing was driven yet"));
                }
                let text = self.drive.recording().to_text();
                self.set_as_step(vec![
                    (Key::Scenario, Scenario::Own.into()),
                    (Key::Drive, Value::Text(text)),
                    (Key::Time, Value::Number(0.0)),
                ])?;
            }
        }
        Ok(())
    }

    /// Lets time pass for the driven characters.
    pub(super) fn advance_drive(&mut self, dt_secs: f64) {
        // Tags that cannot be read are refused where the database is asked for.
        let filter = filter_of(&self.document.params).unwrap_or_default();
        let outcomes = self.drive.advance(dt_secs, filter, &mut self.labs.gauge);
        self.panes.show_next(outcomes);
    }

    /// Moves the driven characters by whole ticks; they cannot go back.
    pub(super) fn step_drive(&mut self, ticks: i64) {
        let filter = filter_of(&self.document.params).unwrap_or_default();
        let ticks = ticks.clamp(0, 60) as usize;
        let outcomes = self.drive.tick(ticks, filter, &mut self.labs.gauge);
        self.panes.show_next(outcomes);
    }

    /// Returns the parameters under which the result of a driven pane is made again: the input is
    /// written down.
    pub(super) fn with_recording(&self, mut params: Params) -> Params {
        if self.is_driven() {
            let text = Value::Text(self.drive.recording().to_text());
            let result = params.set(Key::Drive, text);
            debug_assert!(result.is_ok(), "{result:?}");
        }
        params
    }
}
