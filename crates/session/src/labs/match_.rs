//! The Match lab: a character that is driven, live or by recorded input.

use super::lab::{HasPart, Inputs, Lab, LabClips};
use crate::choices;
use crate::labs::LabError;
use crate::params::{Key, List, Params, Value};
use segue_text::{Message, msg};
mod crowd;
mod database_building;
mod live;
mod live_drive;
mod scheduler;
mod settings;
mod tagging;
mod trace;

pub(crate) use live_drive::{DrivenPane, LiveDrive};
pub(crate) use scheduler::DriveScheduler;
#[cfg(test)]
pub(crate) use settings::options_of;
use settings::{options_in, recording_of};
pub(crate) use tagging::filter_of;
pub use tagging::own_words;
pub use trace::{DriveHistory, DriveMoment};

/// The Match lab: a character that is steered.
pub(super) struct MatchLab;

impl<S: HasPart<DriveScheduler>> Lab<S> for MatchLab {
    fn more_clips(&self, params: &Params) -> Result<Vec<String>, LabError> {
        Ok(params.clip_ids(Key::MatchClips).to_vec())
    }

    fn with_clips(&self, ids: &[String]) -> Option<Vec<(Key, Value)>> {
        Some(vec![(Key::MatchClips, List::ClipIds(ids.to_vec()).into())])
    }

    fn result_name(&self, params: &Params, _a: Message, _b: Message) -> Message {
        match params.choice() {
            choices::Scenario::Own => "a drive".into(),
            scenario => msg!("a drive: {what}", what = scenario.label()),
        }
    }

    fn file_stem(&self, _params: &Params) -> String {
        "drive".to_owned()
    }

    fn is_own_drive(&self, params: &Params) -> bool {
        recording_of(params).is_none()
    }

    fn inputs(
        &self,
        labs: &mut S,
        clips: LabClips,
        params: &Params,
        _match_window: usize,
    ) -> Result<Option<Inputs>, LabError> {
        let Some(recording) = recording_of(params) else {
            return Err(LabError::NothingDriven);
        };
        let Some(database) = HasPart::<DriveScheduler>::part(labs).database_of(clips, params)?
        else {
            return Ok(None);
        };
        let options = options_in(&database, params)?;
        let replay = HasPart::<DriveScheduler>::part(labs).replay(
            database,
            options,
            recording,
            filter_of(params)?,
        )?;
        Ok(replay.map(Inputs::new))
    }
}

#[cfg(test)]
mod command_tests;
