//! Construction of databases and playback of recorded input, in slices.

use super::super::sliced::{JobKind, Sliced};
use super::database_building::{BuildStep, DatabaseBuilding};
use super::tagging::{filter_of, tagged};
use super::trace::Tracer;
use crate::choices;
use crate::jobs::JobBoard;
use crate::labs::LabError;
use crate::labs::Outcome;
use crate::labs::lab::{LabClips, MadeInputs};
use crate::labs::pair::retarget_options;
use crate::params::{HandTag, Key, MAX_PANES, Params};
use segue_motion::clip::Motion;
use segue_motion::matching::{
    Control, Controller, ControllerOptions, Database, DatabaseOptions, FeatureOptions, MatchError,
    Normalisation, Recording, TagFilter, made_clip, made_params,
};
use segue_motion::math::Planar;
use std::sync::Arc;

/// The number of ticks in one slice: about 2 ms in a browser.
const TICKS: usize = 20;

/// The inputs of a database.
#[derive(Clone, Debug)]
pub(crate) struct Source {
    /// The clips; the synthesised set if empty.
    clips: Vec<Arc<Motion>>,
    options: DatabaseOptions,
}

impl Source {
    /// Returns the inputs for these clips and the parameters.
    pub(crate) fn new(clips: Vec<Arc<Motion>>, params: &Params) -> Self {
        let trajectory_secs = [Key::AheadNear, Key::AheadMiddle, Key::AheadFar]
            .map(|key| params.number(key))
            .to_vec();
        Self {
            clips,
            options: DatabaseOptions {
                features: FeatureOptions {
                    trajectory_secs,
                    normalisation: match params.choice::<choices::Normalisation>() {
                        choices::Normalisation::Dimension => Normalisation::Dimension,
                        choices::Normalisation::Block => Normalisation::Block,
                    },
                },
                retarget: retarget_options(params),
                mirrored: params.is_on(Key::Mirrored),
                cycles: params.is_on(Key::MatchCycles),
            },
        }
    }

    /// Returns whether only the features differ.
    fn has_clips_of(&self, other: &Self) -> bool {
        (self.options.mirrored, self.options.cycles, self.options.retarget)
            == (other.options.mirrored, other.options.cycles, other.options.retarget)
            && self.clips.len() == other.clips.len()
            && self.clips.iter().zip(&other.clips).all(|(a, b)| Arc::ptr_eq(a, b))
    }
}

impl PartialEq for Source {
    fn eq(&self, other: &Self) -> bool {
        self.has_clips_of(other) && self.options == other.options
    }
}

/// The inputs of a replay.
#[derive(Clone, Debug)]
struct Script {
    database: Arc<Database>,
    options: ControllerOptions,
    recording: Recording,
    filter: TagFilter,
}

impl PartialEq for Script {
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.database, &other.database)
            && self.options == other.options
            && self.filter == other.filter
            && self.recording == other.recording
    }
}

/// A replay in progress.
#[derive(Debug)]
struct RunningReplay {
    tracer: Tracer,
    controls: Vec<Control>,
    next: usize,
}

/// A database with tags set by hand.
#[derive(Debug)]
struct TaggedDatabase {
    /// The database without these tags, and the ids of its clips.
    base: Arc<Database>,
    ids: Vec<String>,
    tags: Vec<HandTag>,
    made: Arc<Database>,
}

/// A cache of databases and replays, with their work in slices.
#[derive(Debug, Default)]
pub(crate) struct DriveScheduler {
    made: Vec<Arc<Motion>>,
    databases: Vec<(Source, Result<Arc<Database>, LabError>)>,
    tagged: Vec<TaggedDatabase>,
    building: Option<(Source, Box<DatabaseBuilding>)>,
    wanted: Vec<Source>,
    replays: Vec<(Script, Result<Arc<Outcome>, LabError>)>,
    playing: Option<(Script, Box<RunningReplay>)>,
    scripts: Vec<Script>,
    is_ready: bool,
}

impl DriveScheduler {
    /// Returns a database. `None` while it is built: call [`work`](Self::work), then ask again.
    fn database(&mut self, source: &Source) -> Result<Option<Arc<Database>>, LabError> {
        if let Some((_, known)) = self.databases.iter().find(|(known, _)| known == source) {
            return known.clone().map(Some);
        }
        self.wanted.push(source.clone());
        Ok(None)
    }

    /// Returns the database of clips and parameters, with tags by hand. `None` while it is built.
    pub(crate) fn database_of(
        &mut self,
        clips: LabClips,
        params: &Params,
    ) -> Result<Option<Arc<Database>>, LabError> {
        filter_of(params)?;
        let database = self.database(&Source::new(clips.motions(), params))?;
        let ids = clips.more.into_iter().map(|clip| clip.id).collect();
        Ok(database.map(|database| self.tagged(database, ids, params.tags().to_vec())))
    }

    /// Returns a database with tags set by hand; `ids` are its clips, empty for the synthesised
    /// set.
    fn tagged(
        &mut self,
        database: Arc<Database>,
        ids: Vec<String>,
        tags: Vec<HandTag>,
    ) -> Arc<Database> {
        if tags.is_empty() {
            return database;
        }
        let is_it = |known: &&TaggedDatabase| {
            Arc::ptr_eq(&known.base, &database) && known.ids == ids && known.tags == tags
        };
        if let Some(known) = self.tagged.iter().find(is_it) {
            return Arc::clone(&known.made);
        }
        let made = Arc::new(tagged(&database, &ids, &tags));
        if self.tagged.len() >= MAX_PANES {
            drop(self.tagged.remove(0));
        }
        self.tagged.push(TaggedDatabase { base: database, ids, tags, made: Arc::clone(&made) });
        made
    }

    /// Returns the result of recorded input. `None` while it is played.
    pub(crate) fn replay(
        &mut self,
        database: Arc<Database>,
        options: ControllerOptions,
        recording: Recording,
        filter: TagFilter,
    ) -> Result<Option<MadeInputs>, LabError> {
        let script = Script { database, options, recording, filter };
        if let Some((_, known)) = self.replays.iter().find(|(known, _)| *known == script) {
            return known.clone().map(|outcome| Some(MadeInputs(outcome)));
        }
        self.scripts.push(script);
        Ok(None)
    }

    fn next_source(&self) -> Option<&Source> {
        let is_known = |source: &&Source| self.databases.iter().any(|(known, _)| known == *source);
        self.wanted.iter().find(|source| !is_known(source))
    }

    fn next_script(&self) -> Option<&Script> {
        let is_known = |script: &&Script| self.replays.iter().any(|(known, _)| known == *script);
        self.scripts.iter().find(|script| !is_known(script))
    }

    /// Does a slice of the construction of a database.
    fn build(&mut self, source: &Source, jobs: &mut JobBoard) -> Result<BuildStep, MatchError> {
        let under_way = self.building.take().filter(|(of, _)| of == source);
        let mut building = if let Some((_, building)) = under_way {
            building
        } else {
            let alike = self.databases.iter().find(|(known, _)| known.has_clips_of(source));
            if let Some((_, Ok(database))) = alike {
                Box::new(DatabaseBuilding::retimed(database, &source.options)?)
            } else if !source.clips.is_empty() {
                Box::new(DatabaseBuilding::new(&source.clips, &source.options)?)
            } else if let Some(params) = made_params().get(self.made.len()) {
                let roles = self.made.first().map(|first| first.roles().clone());
                self.made.push(Arc::new(made_clip(params, roles)?));
                return Ok(BuildStep::Worked);
            } else {
                Box::new(DatabaseBuilding::new(&self.made, &source.options)?)
            }
        };
        let step = building.advance(jobs)?;
        self.building = Some((source.clone(), building));
        Ok(step)
    }

    /// Keeps the result of a construction.
    fn keep(&mut self, source: Source, built: Result<Database, MatchError>) {
        if self.databases.len() >= 2 * MAX_PANES {
            drop(self.databases.remove(0));
        }
        self.databases.push((source, built.map(Arc::new).map_err(LabError::from)));
        self.is_ready = true;
    }

    fn play(&mut self, script: &Script) -> Result<Option<Outcome>, LabError> {
        let under_way = self.playing.take().filter(|(of, _)| of == script);
        let mut playing = if let Some((_, playing)) = under_way {
            playing
        } else {
            let controller =
                Controller::new(Arc::clone(&script.database), script.options, &Planar::IDENTITY);
            Box::new(RunningReplay {
                tracer: Tracer::new(controller?, usize::MAX),
                controls: script
                    .recording
                    .controls()
                    .map(|control| filtered(control, script.filter))
                    .collect(),
                next: 0,
            })
        };
        let end = (playing.next + TICKS).min(playing.controls.len());
        for control in playing.controls.get(playing.next..end).unwrap_or(&[]) {
            playing.tracer.tick(control);
        }
        playing.next = end;
        if end < playing.controls.len() {
            self.playing = Some((script.clone(), playing));
            return Ok(None);
        }
        let mut outcome = playing.tracer.outcome(false)?;
        outcome.metrics = playing.tracer.metrics(&outcome.motion);
        Ok(Some(outcome))
    }
}

impl Sliced for DriveScheduler {
    fn clear_requests(&mut self) {
        self.wanted.clear();
        self.scripts.clear();
        self.is_ready = false;
    }

    fn work(&mut self, jobs: &mut JobBoard) -> bool {
        if self.is_ready {
            return false;
        }
        if let Some(source) = self.next_source().cloned() {
            match self.build(&source, jobs) {
                Ok(BuildStep::Worked) => return true,
                Ok(BuildStep::Complete) => {
                    if let Some((source, building)) = self.building.take() {
                        self.keep(source, building.finish());
                    }
                    return true;
                }
                Err(error) => {
                    self.keep(source, Err(error));
                    return true;
                }
                Ok(BuildStep::Waits) => {}
            }
        } else if let Some((_, building)) = &mut self.building {
            building.cancel_jobs();
        }
        let Some(script) = self.next_script().cloned() else {
            return false;
        };
        if let Some(played) = self.play(&script).transpose() {
            if self.replays.len() >= 2 * MAX_PANES {
                drop(self.replays.remove(0));
            }
            self.replays.push((script, played.map(Arc::new)));
            self.is_ready = true;
        }
        true
    }

    fn is_ready(&self) -> bool {
        self.is_ready
    }

    fn progress(&self) -> Option<(JobKind, f64)> {
        if let Some(source) = self.next_source() {
            let built = match &self.building {
                Some((of, building)) if of == source => building.progress(),
                _ => 0.0,
            };
            let all = made_params().len().max(1) as f64;
            let made = if source.clips.is_empty() { self.made.len() as f64 / all } else { 1.0 };
            return Some((JobKind::BuildingDatabase, 0.4 * made + 0.6 * built));
        }
        let script = self.next_script()?;
        let done = match &self.playing {
            Some((of, playing)) if of == script => {
                playing.next as f64 / playing.controls.len().max(1) as f64
            }
            _ => 0.0,
        };
        Some((JobKind::Driving, done))
    }
}

/// Returns the input with the filter of the parameters; without one, it keeps the filter of the
/// recording.
fn filtered(control: Control, filter: TagFilter) -> Control {
    if filter == TagFilter::default() { control } else { control.with_filter(filter) }
}
