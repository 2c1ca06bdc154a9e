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

    /// Returns the ids of the clips that the graph is made of; none where there are too many.
    #[must_use]
    pub fn graph_clip_ids(&self) -> Vec<String> {
        clips_of(self.document.params.clip_ids(Key::Clips)).unwrap_or_default()
    }

    /// Returns the clips of the graph, on one skeleton; `None` outside of the Graph lab and while
    /// they are made ready.
    #[must_use]
    pub fn graph_cast(&self) -> Option<&Arc<GraphClips>> {
        self.labs.grapher.cast().filter(|_| self.is_graph_lab())
    }

    /// Returns the distances of the first pane's window, or the last ones while these are computed;
    /// `None` outside of the Graph lab.
    #[must_use]
    pub fn graph_field(&self) -> Option<&Arc<DistanceField>> {
        self.labs.grapher.field().filter(|_| self.is_graph_lab())
    }

    /// Returns the graph of the first pane: that of the present parameters where it is made, else
    /// that of the walk.
    #[must_use]
    pub fn graph_built(&self) -> Option<&Arc<BuiltGraph>> {
        let walked = || self.graph_walk().map(|walk| &walk.built);
        self.labs.grapher.built().or_else(walked).filter(|_| self.is_graph_lab())
    }

    /// Returns the walk of the first pane.
    #[must_use]
    pub fn graph_walk(&self) -> Option<&Arc<Walk>> {
        self.main_outcome()?.walk().filter(|_| self.is_graph_lab())
    }

    /// Returns how long it took to make a graph, seconds, as far as [`Session::work_took`] was
    /// told.
    #[must_use]
    pub fn graph_build_secs(&self, built: &BuiltGraph) -> Option<f64> {
        self.labs.grapher.build_secs(built)
    }

    /// Takes in how long the last call of [`Session::work`] took, seconds: the session has no
    /// clock.
    pub fn work_took(&mut self, secs: f64) {
        self.labs.grapher.took(secs);
    }

    /// Returns whether making the graph was given up.
    #[must_use]
    pub fn graph_is_stopped(&self) -> bool {
        self.is_graph_lab() && self.labs.grapher.is_stopped()
    }

    /// Returns when the walk sets off for which clip: seconds, and the clip's index.
    #[must_use]
    pub fn graph_visits(&self) -> Vec<(f64, usize)> {
        visits_of(&self.document.params)
    }

    /// Returns the line that the walk follows, (x, z) in metres.
    #[must_use]
    pub fn graph_path(&self) -> &[DVec2] {
        if self.is_graph_lab() { self.document.params.ground_path() } else { &[] }
    }
}
