//! All labs, and the state that they keep between results.

use super::analyses::Analyses;
use super::artefact_meter::ArtefactMeter;
use super::blend::{self, BlendCache};
use super::clean::{self, CleanCache};
use super::graph::{self, GraphScheduler};
use super::lab::{HasPart, Inputs, Lab, LabClips};
use super::layers::{self, LayerCache};
use super::long_results::LongResults;
use super::loop_::{self, CycleCache};
use super::match_::{self, DriveScheduler};
use super::on_character::CharacterMotions;
use super::pair::Pairs;
use super::path::{self, Paths};
use super::register::{self, RegistrationSchedulers};
use super::sliced::{JobKind, Sliced};
use super::speed::{self, GaitFinder};
use super::view::{self, ViewCache};
use super::{LabError, edit, in_place, make, transition};
use crate::LabId;
use crate::jobs::JobBoard;
use crate::motion::FeetReader;
use crate::params::Params;
use segue_motion::clip::Motion;
use std::ops::ControlFlow;

/// Returns the definition of a lab.
pub(crate) fn lab_of(lab: LabId) -> &'static dyn Lab<LabSet> {
    match lab {
        LabId::View => &view::ViewLab,
        LabId::Make => &make::MakeLab,
        LabId::Blend => &blend::BlendLab,
        LabId::Transition => &transition::TransitionLab,
        LabId::Speed => &speed::SpeedLab,
        LabId::Loop => &loop_::LoopLab,
        LabId::Layers => &layers::LayersLab,
        LabId::Register => &register::RegisterLab,
        LabId::Path => &path::PathLab,
        LabId::Graph => &graph::GraphLab,
        LabId::Match => &match_::MatchLab,
        LabId::InPlace => &in_place::InPlaceLab,
        LabId::Edit => &edit::EditLab,
        LabId::Clean => &clean::CleanLab,
    }
}

/// The caches of all labs, so that unchanged intermediate results are not computed again.
#[derive(Debug, Default)]
pub(crate) struct LabSet {
    /// The analyses of long clips.
    analyses: Analyses,
    pairs: Pairs,
    blends: BlendCache,
    gaits: GaitFinder,
    cycles: CycleCache,
    layers: LayerCache,
    long_results: LongResults,
    pub(crate) registrations: RegistrationSchedulers,
    paths: Paths,
    pub(crate) graphs: GraphScheduler,
    views: ViewCache,
    cleaned: CleanCache,
    pub(crate) drives: DriveScheduler,
    pub(crate) meter: ArtefactMeter,
    pub(crate) characters: CharacterMotions,
    /// Clips whose feet are read with options other than the defaults.
    pub(crate) feet: FeetReader,
    /// The jobs for workers.
    pub(crate) jobs: JobBoard,
}

impl LabSet {
    /// Returns all sliced work, in the order of scheduling.
    fn sliced(&self) -> [&dyn Sliced; 14] {
        [
            &self.analyses,
            &self.pairs,
            &self.blends,
            &self.cycles,
            &self.layers,
            &self.long_results,
            &self.registrations,
            &self.views,
            &self.cleaned,
            &self.paths,
            &self.drives,
            &self.meter,
            &self.characters,
            &self.graphs,
        ]
    }

    fn sliced_mut(&mut self) -> ([&mut dyn Sliced; 14], &mut JobBoard) {
        let sliced: [&mut dyn Sliced; 14] = [
            &mut self.analyses,
            &mut self.pairs,
            &mut self.blends,
            &mut self.cycles,
            &mut self.layers,
            &mut self.long_results,
            &mut self.registrations,
            &mut self.views,
            &mut self.cleaned,
            &mut self.paths,
            &mut self.drives,
            &mut self.meter,
            &mut self.characters,
            &mut self.graphs,
        ];
        (sliced, &mut self.jobs)
    }

    /// Returns whether everything that is derived from these clips is known or takes no longer than
    /// a frame. Otherwise it is requested: call [`work`](Self::work), then ask again.
    fn knows(&mut self, clips: &LabClips) -> bool {
        let all = clips.slots.iter().chain(clips.more.iter().map(|clip| &clip.motion));
        let are_known: Vec<bool> = all.map(|clip| self.analyses.knows(clip, &self.jobs)).collect();
        are_known.into_iter().all(|is_known| is_known)
    }

    /// Returns the inputs of a result; `None` while they are being computed: call
    /// [`work`](Self::work), then ask again.
    pub(crate) fn inputs(
        &mut self,
        clips: LabClips,
        params: &Params,
        match_window: usize,
    ) -> Result<Option<Inputs>, LabError> {
        if self.knows(&clips)
            && let ControlFlow::Break(inputs) =
                self.long_results.inputs(&clips, params, match_window, &self.jobs)
        {
            return Ok(inputs);
        }
        self.inputs_here(clips, params, match_window)
    }

    /// Returns the inputs of a result that no worker makes, however long its clips are; `None`
    /// while they are being computed.
    pub(crate) fn inputs_here(
        &mut self,
        clips: LabClips,
        params: &Params,
        match_window: usize,
    ) -> Result<Option<Inputs>, LabError> {
        if !self.knows(&clips) {
            return Ok(None);
        }
        lab_of(params.lab()).inputs(self, clips, params, match_window)
    }

    /// Returns whether a worker is at what is derived from a motion.
    pub(crate) fn is_analyzing(&self, motion: &Motion) -> bool {
        self.analyses.is_under_way(motion)
    }

    /// Clears the pending requests of all labs; each pane then requests what it needs again.
    pub(crate) fn clear_requests(&mut self) {
        for sliced in self.sliced_mut().0 {
            sliced.clear_requests();
        }
    }

    /// Does one slice of work; `now_secs` is the playhead. Returns `false` if there was nothing to
    /// do but to wait for workers.
    pub(crate) fn work(&mut self, now_secs: f64) -> bool {
        self.graphs.play_at(now_secs);
        let (sliced, jobs) = self.sliced_mut();
        sliced.into_iter().any(|sliced| sliced.work(jobs))
    }

    /// Returns whether any requested result is available.
    pub(crate) fn is_ready(&self) -> bool {
        self.sliced().into_iter().any(Sliced::is_ready)
    }

    /// Returns the kinds of work in progress, each once, with their progress, 0 to 1.
    pub(crate) fn progress(&self) -> Vec<(JobKind, f64)> {
        let mut found: Vec<(JobKind, f64)> = Vec::new();
        for (kind, progress) in self.sliced().into_iter().filter_map(Sliced::progress) {
            if found.iter().all(|(known, _)| *known != kind) {
                found.push((kind, progress));
            }
        }
        found
    }
}

macro_rules! has_parts {
    ($($part:ty, $field:ident;)*) => {$(
        impl HasPart<$part> for LabSet {
            fn part(&mut self) -> &mut $part {
                &mut self.$field
            }
        }
    )*};
}

has_parts! {
    Pairs, pairs;
    BlendCache, blends;
    GaitFinder, gaits;
    CycleCache, cycles;
    LayerCache, layers;
    RegistrationSchedulers, registrations;
    Paths, paths;
    GraphScheduler, graphs;
    ViewCache, views;
    CleanCache, cleaned;
    DriveScheduler, drives;
}
