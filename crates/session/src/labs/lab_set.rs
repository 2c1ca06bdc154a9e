//! All labs with what they remember: inputs for results, and the work that takes longer than a
//! frame.

use super::Outcome;
use super::blend::{BlendInputs, Blender};
use super::gauge::Gauge;
use super::graph::{GraphInputs, Grapher};
use super::layers::{LayerInputs, Layerer};
use super::loop_::{CycleFinder, LoopInputs};
use super::make::MakeInputs;
use super::match_::{
    Driver, HandTag, ReplayInputs, Source as MatchSource, filter_of, options_in, read_tags,
    recording_of,
};
use super::pair::Pairs;
use super::path::{PathInputs, Paths};
use super::register::{RegisterInputs, Registrars, read_also};
use super::speed::{GaitFinder, SpeedInputs};
use super::view::{ViewInputs, Viewer};
use crate::LabId;
use crate::motion::Motion;
use crate::params::{Key, Params};
use segue_motion::matching::Database;
use std::sync::Arc;

/// What is worked on in slices.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub enum JobKind {
    /// The best place for a transition is searched for.
    Matching,
    /// Clips are registered in time.
    Registering,
    /// A motion graph is built.
    BuildingGraph,
    /// Planted feet are held.
    HoldingFeet,
    /// The features of clips are computed for motion matching.
    BuildingDatabase,
    /// Recorded input is played.
    Driving,
    /// A file is read; its name.
    Reading(String),
}

impl JobKind {
    /// The name in the page's API: a word of its own, or the file's name.
    #[must_use]
    pub fn name(&self) -> &str {
        match self {
            Self::Matching => "matching",
            Self::Registering => "registering",
            Self::BuildingGraph => "graphing",
            Self::HoldingFeet => "holding feet",
            Self::BuildingDatabase => "building the database",
            Self::Driving => "driving",
            Self::Reading(file) => file,
        }
    }
}

/// Work that is done in slices, between frames, for panes that wait for it.
pub(crate) trait Sliced {
    /// Forgets who waits: all panes are about to ask again.
    fn ask_anew(&mut self);

    /// Does one slice. Returns `false` when there was nothing to do.
    fn work(&mut self) -> bool;

    /// Returns whether something that a pane waits for is there, so that it should ask again.
    fn is_ready(&self) -> bool;

    /// Returns what is worked on and how much of it is done, 0 to 1; `None` when there is nothing
    /// to tell.
    fn progress(&self) -> Option<(JobKind, f64)>;
}

/// The clips that a result is made from.
#[derive(Clone, Debug, Default)]
pub(crate) struct LabClips {
    /// Those of the lab's slots, in their order.
    pub(crate) slots: Vec<Arc<Motion>>,
    /// Those that it takes besides, by id.
    pub(crate) more: Vec<MoreClip>,
}

/// A clip that a lab takes besides those in its slots.
#[derive(Clone, Debug)]
pub(crate) struct MoreClip {
    pub(crate) id: String,
    /// What a person calls it.
    pub(crate) name: String,
    pub(crate) motion: Arc<Motion>,
}

impl LabClips {
    fn first(&self) -> Result<&Arc<Motion>, String> {
        self.slots.first().ok_or_else(|| "There is no clip in A.".to_owned())
    }

    fn motions(&self) -> Vec<Arc<Motion>> {
        self.more.iter().map(|clip| Arc::clone(&clip.motion)).collect()
    }
}

/// All labs. Each remembers what it has found, so that what did not change is not computed again.
#[derive(Debug, Default)]
pub(crate) struct LabSet {
    pairs: Pairs,
    blender: Blender,
    gaits: GaitFinder,
    cycles: CycleFinder,
    layerer: Layerer,
    pub(crate) registrars: Registrars,
    paths: Paths,
    pub(crate) grapher: Grapher,
    viewer: Viewer,
    driver: Driver,
    pub(crate) gauge: Gauge,
}

impl LabSet {
    /// What works in slices, in the order in which it gets its turn.
    fn sliced(&self) -> [&dyn Sliced; 7] {
        [
            &self.blender,
            &self.registrars,
            &self.viewer,
            &self.paths,
            &self.driver,
            &self.gauge,
            &self.grapher,
        ]
    }

    fn sliced_mut(&mut self) -> [&mut dyn Sliced; 7] {
        [
            &mut self.blender,
            &mut self.registrars,
            &mut self.viewer,
            &mut self.paths,
            &mut self.driver,
            &mut self.gauge,
            &mut self.grapher,
        ]
    }

    /// Forgets what panes wait for: all are about to ask again.
    pub(crate) fn ask_anew(&mut self) {
        for sliced in self.sliced_mut() {
            sliced.ask_anew();
        }
    }

    /// Does one slice of work; `now_secs` is where the playhead stands. Returns `false` when there
    /// was nothing to do.
    pub(crate) fn work(&mut self, now_secs: f64) -> bool {
        self.grapher.play_at(now_secs);
        self.sliced_mut().into_iter().any(Sliced::work)
    }

    /// Returns whether something that a pane waits for is there.
    pub(crate) fn is_ready(&self) -> bool {
        self.sliced().into_iter().any(Sliced::is_ready)
    }

    /// Returns what is worked on, each kind once, and how much of it is done, 0 to 1.
    pub(crate) fn progress(&self) -> Vec<(JobKind, f64)> {
        let mut found: Vec<(JobKind, f64)> = Vec::new();
        for (kind, progress) in self.sliced().into_iter().filter_map(Sliced::progress) {
            if found.iter().all(|(known, _)| *known != kind) {
                found.push((kind, progress));
            }
        }
        found
    }

    /// Returns what a result depends on; `None` while that is still being computed. `match_window`
    /// is the window of the automatic match, in frames.
    pub(crate) fn inputs(
        &mut self,
        clips: LabClips,
        params: &Params,
        match_window: usize,
    ) -> Result<Option<Inputs>, String> {
        let inputs = match params.lab() {
            LabId::View => return Ok(self.viewer.inputs(clips.first()?, params).map(Inputs::View)),
            LabId::Make => Inputs::Make(MakeInputs::of(params)),
            LabId::Blend | LabId::Transition => Inputs::Blend(self.blender.inputs(
                &self.pairs.of_slots(&clips.slots)?,
                params,
                match_window,
            )?),
            LabId::Speed => {
                Inputs::Speed(self.gaits.inputs(&self.pairs.of_slots(&clips.slots)?, params)?)
            }
            LabId::Loop => Inputs::Loop(self.cycles.inputs(clips.first()?, params)?),
            LabId::Layers => {
                Inputs::Layers(self.layerer.inputs(&self.pairs.of_slots(&clips.slots)?, params)?)
            }
            LabId::Register => {
                let pair = self.pairs.of_slots(&clips.slots)?;
                let weights =
                    read_also(params.text(Key::WarpAlso))?.into_iter().map(|(_, weight)| weight);
                let also: Vec<_> = clips.motions().into_iter().zip(weights).collect();
                return Ok(self.registrars.inputs(&pair, &also, params)?.map(Inputs::Register));
            }
            LabId::Path => Inputs::Path(self.paths.inputs(clips.first()?, params)?),
            LabId::Graph => {
                let clips = clips.more.into_iter().map(|clip| (clip.name, clip.motion)).collect();
                return Ok(self.grapher.inputs(clips, params)?.map(Inputs::Graph));
            }
            LabId::Match => return Ok(self.replay(clips, params)?.map(Inputs::Match)),
        };
        Ok(Some(inputs))
    }

    /// Returns the database of the Match lab; `None` while it is built.
    pub(crate) fn match_database(
        &mut self,
        clips: LabClips,
        params: &Params,
    ) -> Result<Option<Arc<Database>>, String> {
        let tags: Vec<HandTag> = read_tags(params.text(Key::Tags))?;
        filter_of(params)?;
        let database = self.driver.database(&MatchSource::new(clips.motions(), params))?;
        let ids = clips.more.into_iter().map(|clip| clip.id).collect();
        Ok(database.map(|database| self.driver.tagged(database, ids, tags)))
    }

    fn replay(&mut self, clips: LabClips, params: &Params) -> Result<Option<ReplayInputs>, String> {
        let Some(recording) = recording_of(params)? else {
            return Err("Nothing was driven yet.".to_owned());
        };
        let Some(database) = self.match_database(clips, params)? else {
            return Ok(None);
        };
        let options = options_in(&database, params)?;
        self.driver.replay(database, options, recording, filter_of(params)?)
    }
}

/// What a result depends on. Equal inputs give equal results: nothing is computed again.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Inputs {
    View(ViewInputs),
    Make(MakeInputs),
    Blend(BlendInputs),
    Speed(SpeedInputs),
    Loop(LoopInputs),
    Layers(LayerInputs),
    Register(RegisterInputs),
    Path(PathInputs),
    Graph(GraphInputs),
    Match(ReplayInputs),
}

impl Inputs {
    /// Makes the result.
    pub(crate) fn run(&self) -> Result<Outcome, String> {
        match self {
            Self::View(view) => view.run(),
            Self::Make(made) => made.run(),
            Self::Blend(blend) => blend.run(),
            Self::Speed(speed) => speed.run(),
            Self::Loop(cycle) => cycle.run(),
            Self::Layers(layers) => layers.run(),
            Self::Register(register) => register.run(),
            Self::Path(path) => path.run(),
            Self::Graph(graph) => Ok(graph.run()),
            Self::Match(replay) => Ok(replay.run()),
        }
    }

    /// Returns whether the result is shown while more of it is computed: it will be another motion
    /// then, or have numbers.
    pub(crate) fn is_draft(&self) -> bool {
        match self {
            Self::View(view) => view.awaits_numbers(),
            Self::Blend(blend) => blend.awaits_place(),
            Self::Path(path) => path.awaits_feet(),
            Self::Graph(graph) => graph.awaits_path(),
            _ => false,
        }
    }
}
