//! The construction of a database, whose clips are measured by workers where there are some.

use crate::jobs::{DatabaseClipTask, JobBoard, Taken, Ticket};
use segue_motion::clip::Motion;
use segue_motion::matching::{Database, DatabaseBuilder, DatabaseOptions, MatchError};
use std::sync::Arc;

/// The number of frames of a database's clips from which on workers measure them; fewer take less
/// time than a worker takes to begin.
const MIN_WORKER_FRAMES: usize = 4_000;

/// The construction of a database in slices.
#[derive(Debug)]
pub(super) struct DatabaseBuilding {
    builder: DatabaseBuilder,
    /// The clips to be measured.
    clips: Vec<Arc<Motion>>,
    options: DatabaseOptions,
    /// The clips that workers measure; `None` before they are asked.
    asked: Option<Vec<(usize, Ticket<DatabaseClipTask>)>>,
}

/// The outcome of a slice of the construction.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum BuildStep {
    /// There is more to do.
    Worked,
    /// Workers are at what is to be done next.
    Waits,
    /// Everything is done.
    Complete,
}

impl DatabaseBuilding {
    /// Begins the construction of a database of clips.
    ///
    /// # Errors
    /// [`MatchError`] when they or the options are refused.
    pub(super) fn new(
        clips: &[Arc<Motion>],
        options: &DatabaseOptions,
    ) -> Result<Self, MatchError> {
        let builder = DatabaseBuilder::new(clips.to_vec(), options)?;
        Ok(Self { builder, clips: clips.to_vec(), options: options.clone(), asked: None })
    }

    /// Begins the construction of a database of the same clips with other features, none of which
    /// is measured again.
    ///
    /// # Errors
    /// [`MatchError`] when the options are refused.
    pub(super) fn retimed(
        database: &Database,
        options: &DatabaseOptions,
    ) -> Result<Self, MatchError> {
        let builder = DatabaseBuilder::retimed(database, &options.features)?;
        Ok(Self { builder, clips: Vec::new(), options: options.clone(), asked: None })
    }

    /// Returns the progress, 0 to 1.
    pub(super) fn progress(&self) -> f64 {
        let progress = self.builder.progress();
        progress.done as f64 / progress.total.max(1) as f64
    }

    /// Does one slice: asks workers, takes one of their answers, or goes on with what they are not
    /// asked for.
    ///
    /// # Errors
    /// [`MatchError`] with the reason why there is no database.
    pub(super) fn advance(&mut self, jobs: &mut JobBoard) -> Result<BuildStep, MatchError> {
        let Some(asked) = &mut self.asked else {
            let frames: usize = self.clips.iter().map(|clip| clip.clip().frames()).sum();
            let is_for_workers = jobs.has_workers() && frames >= MIN_WORKER_FRAMES;
            self.asked = Some(if is_for_workers { self.ask(jobs) } else { Vec::new() });
            return Ok(BuildStep::Worked);
        };
        for at in 0..asked.len() {
            let measured = match jobs.take(&asked[at].1) {
                Taken::Waits => continue,
                Taken::Answer(measured, _) => Some(measured),
                // It is measured here when it is its turn, and has its error there.
                Taken::Failed => None,
            };
            let (clip, _) = asked.remove(at);
            if let Some(measured) = measured {
                self.builder.set_measured(clip, measured);
            }
            return Ok(BuildStep::Worked);
        }
        let next = self.builder.next_clip();
        if next.is_some_and(|next| asked.iter().any(|(clip, _)| *clip == next)) {
            return Ok(BuildStep::Waits);
        }
        let is_complete = self.builder.advance()?.is_complete();
        Ok(if is_complete { BuildStep::Complete } else { BuildStep::Worked })
    }

    /// Cancels the jobs of workers. They are asked again when the construction goes on.
    pub(super) fn cancel_jobs(&mut self) {
        self.asked = None;
    }

    /// Returns the database. All slices are done.
    ///
    /// # Errors
    /// [`MatchError`] with the reason why there is none.
    pub(super) fn finish(self) -> Result<Database, MatchError> {
        self.builder.finish()
    }

    /// Offers the measurement of every clip that is not measured.
    fn ask(&self, jobs: &mut JobBoard) -> Vec<(usize, Ticket<DatabaseClipTask>)> {
        let Some(first) = self.clips.first() else { return Vec::new() };
        let offer = |source: usize| {
            let clip = Arc::clone(self.clips.get(source)?);
            let is_on_first = clip.clip().skeleton() == first.clip().skeleton();
            let (options, roles) = (self.options.clone(), Box::new(first.roles().clone()));
            let task = DatabaseClipTask { source, options, roles };
            let clips = if is_on_first { vec![clip] } else { vec![clip, Arc::clone(first)] };
            Some((source, jobs.offer(task, &clips)))
        };
        self.builder.unmeasured().filter_map(offer).collect()
    }
}
