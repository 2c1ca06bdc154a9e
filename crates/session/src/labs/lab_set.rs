//! What all labs remember, and the work that takes longer than a frame.

use super::blend::Blender;
use super::gauge::Gauge;
use super::graph::Grapher;
use super::layers::Layerer;
use super::loop_::CycleFinder;
use super::match_::{Driver, HandTag, Source as MatchSource, filter_of, read_tags};
use super::pair::Pairs;
use super::path::Paths;
use super::register::Registrars;
use super::speed::GaitFinder;
use super::view::Viewer;
use crate::labs::LabError;
use crate::motion::FeetReader;
use crate::params::{Key, Params};
use segue_motion::clip::Motion;
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
    pub(super) fn first(&self) -> Result<&Arc<Motion>, LabError> {
        self.slots.first().ok_or(LabError::NoClip)
    }

    pub(super) fn motions(&self) -> Vec<Arc<Motion>> {
        self.more.iter().map(|clip| Arc::clone(&clip.motion)).collect()
    }
}

/// What labs remember of what they have found, so that what did not change is not computed again.
#[derive(Debug, Default)]
pub(crate) struct LabSet {
    pub(super) pairs: Pairs,
    pub(super) blender: Blender,
    pub(super) gaits: GaitFinder,
    pub(super) cycles: CycleFinder,
    pub(super) layerer: Layerer,
    pub(crate) registrars: Registrars,
    pub(super) paths: Paths,
    pub(crate) grapher: Grapher,
    pub(super) viewer: Viewer,
    pub(super) driver: Driver,
    pub(crate) gauge: Gauge,
    /// Clips whose feet are read otherwise than usual.
    pub(crate) feet: FeetReader,
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

    /// Returns the database of the Match lab; `None` while it is built.
    pub(crate) fn match_database(
        &mut self,
        clips: LabClips,
        params: &Params,
    ) -> Result<Option<Arc<Database>>, LabError> {
        let tags: Vec<HandTag> = read_tags(params.text(Key::Tags))?;
        filter_of(params)?;
        let database = self.driver.database(&MatchSource::new(clips.motions(), params))?;
        let ids = clips.more.into_iter().map(|clip| clip.id).collect();
        Ok(database.map(|database| self.driver.tagged(database, ids, tags)))
    }
}
