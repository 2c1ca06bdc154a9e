//! Queries of panels and pictures about the Graph lab.

use super::Session;
use crate::labs::lab::Beside;
use crate::labs::lab_of;
use crate::labs::{BuiltGraph, DistanceField, GraphClips, Walk, clips_of, visits_of};
use crate::params::Key;
use glam::DVec2;
use std::sync::Arc;

impl Session {
    fn is_graph_lab(&self) -> bool {
        lab_of(self.document.params.lab()).has(Beside::Graph)
    }

    /// Returns the ids of the graph's clips; none if there are too many.
    #[must_use]
    pub fn graph_clip_ids(&self) -> Vec<String> {
        clips_of(self.document.params.clip_ids(Key::Clips)).unwrap_or_default()
    }

    /// Returns the clips of the graph, on one skeleton; `None` outside of the Graph lab and while
    /// they are prepared.
    #[must_use]
    pub fn graph_clips(&self) -> Option<&Arc<GraphClips>> {
        self.labs.graphs.graph_clips().filter(|_| self.is_graph_lab())
    }

    /// Returns the distances of the first pane's window, or the last ones while these are computed;
    /// `None` outside of the Graph lab.
    #[must_use]
    pub fn graph_field(&self) -> Option<&Arc<DistanceField>> {
        self.labs.graphs.field().filter(|_| self.is_graph_lab())
    }

    /// Returns the graph of the first pane: that of the present parameters if it is built,
    /// otherwise that of the walk.
    #[must_use]
    pub fn graph_built(&self) -> Option<&Arc<BuiltGraph>> {
        let walked = || self.graph_walk().map(|walk| &walk.built);
        self.labs.graphs.built().or_else(walked).filter(|_| self.is_graph_lab())
    }

    /// Returns the walk of the first pane.
    #[must_use]
    pub fn graph_walk(&self) -> Option<&Arc<Walk>> {
        self.main_outcome()?.walk().filter(|_| self.is_graph_lab())
    }

    /// Returns the time that building a graph took, seconds, as far as it was reported by
    /// [`Session::work_took`].
    #[must_use]
    pub fn graph_build_secs(&self, built: &BuiltGraph) -> Option<f64> {
        self.labs.graphs.build_secs(built)
    }

    /// Records the duration of the last call of [`Session::work`], seconds, because the session has
    /// no clock.
    pub fn work_took(&mut self, secs: f64) {
        self.labs.graphs.took(secs);
    }

    /// Returns whether the construction of the graph was stopped.
    #[must_use]
    pub fn graph_is_stopped(&self) -> bool {
        self.is_graph_lab() && self.labs.graphs.is_stopped()
    }

    /// Returns the visits of the walk: when to set off, seconds, and the clip's index.
    #[must_use]
    pub fn graph_visits(&self) -> Vec<(f64, usize)> {
        visits_of(&self.document.params)
    }

    /// Returns the path that the walk follows, (x, z) in metres.
    #[must_use]
    pub fn graph_path(&self) -> &[DVec2] {
        if self.is_graph_lab() { self.document.params.ground_path() } else { &[] }
    }
}
