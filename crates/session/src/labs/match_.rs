//! The Match lab: a character that is driven, live or by input that was written down.

use super::Slot;
use super::lab::{HasPart, Inputs, Lab, LabClips};
use super::recipe::{read_ids, write_ids};
use crate::LabId;
use crate::choices;
use crate::labs::LabError;
use crate::params::{Key, Params, Value};
use segue_text::{Message, msg};
mod crowd;
mod driver;
mod live;
mod live_drive;
mod settings;
mod tagging;
mod trace;

pub(crate) use driver::Driver;
pub(crate) use live_drive::{DrivenPane, LiveDrive};
#[cfg(test)]
pub(crate) use settings::options_of;
use settings::{options_in, recording_of};
pub use tagging::{HandTag, own_words, write_tags};
pub(crate) use tagging::{filter_of, read_tags};
pub use trace::{DriveMoment, Driven};

/// The Match lab: a character that is steered.
pub(super) struct MatchLab;

impl<S: HasPart<Driver>> Lab<S> for MatchLab {
    fn parameters_of(&self) -> &'static [LabId] {
        &[LabId::Match]
    }

    fn shared_keys(&self) -> &'static [Key] {
        &[Key::BlendTime, Key::ExtrapolationHalfLife]
    }

    fn has_feet(&self) -> bool {
        false
    }

    fn slots(&self) -> &'static [Slot] {
        &[]
    }

    fn more_clips(&self, params: &Params) -> Result<Vec<String>, LabError> {
        read_ids(params.text(Key::MatchClips)).ok_or(LabError::MatchClips)
    }

    fn with_clips(&self, ids: &[String]) -> Option<Vec<(Key, Value)>> {
        Some(vec![(Key::MatchClips, Value::Text(write_ids(ids)))])
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
        matches!(recording_of(params), Ok(None))
    }

    fn inputs(
        &self,
        labs: &mut S,
        clips: LabClips,
        params: &Params,
        _match_window: usize,
    ) -> Result<Option<Inputs>, LabError> {
        let Some(recording) = recording_of(params)? else {
            return Err(LabError::NothingDriven);
        };
        let Some(database) = HasPart::<Driver>::part(labs).database_of(clips, params)? else {
            return Ok(None);
        };
        let options = options_in(&database, params)?;
        let replay = HasPart::<Driver>::part(labs).replay(
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
