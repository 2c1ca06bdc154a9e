//! The lists of a document, by their values.

use super::choices::Curve;
use super::current::Params;
use super::grammar::{ClipContacts, HandTag, List};
use super::key::Key;
use super::value::Value;
use glam::DVec2;
use segue_motion::clean::FaultKind;
use segue_motion::graph::Place;
use segue_motion::matching::Recording;
use segue_motion::path::GroundSpline;

impl Params {
    /// Returns the ids of clips that a parameter lists; none for a parameter of another kind.
    #[must_use]
    pub fn clip_ids(&self, key: Key) -> &[String] {
        match self.get(key) {
            Value::List(List::ClipIds(ids)) => ids,
            _ => &[],
        }
    }

    /// Returns the further clips of a registered blend, each with its weight.
    #[must_use]
    pub fn weighted_clips(&self) -> &[(String, f64)] {
        match self.get(Key::WarpAlso) {
            Value::List(List::WeightedClips(clips)) => clips,
            _ => &[],
        }
    }

    /// Returns the weight of B over a registered blend: per cent of the blend and per cent of B.
    #[must_use]
    pub fn weight_curve(&self) -> &[(usize, usize)] {
        match self.get(Key::WarpCurve) {
            Value::List(List::WeightCurve(points)) => points,
            _ => &[],
        }
    }

    /// Returns the frames of A and B that must meet in a registration.
    #[must_use]
    pub fn pins(&self) -> &[(usize, usize)] {
        match self.get(Key::Pins) {
            Value::List(List::Pins(pins)) => pins,
            _ => &[],
        }
    }

    /// Returns the faults that are left alone: the kind and the first frame of each.
    #[must_use]
    pub fn faults_left_alone(&self) -> &[(FaultKind, usize)] {
        match self.get(Key::CleanSkip) {
            Value::List(List::FaultPlaces(places)) => places,
            _ => &[],
        }
    }

    /// Returns the edited path; `None` for the fitted one.
    #[must_use]
    pub fn edited_path(&self) -> Option<&GroundSpline> {
        match self.get(Key::Path) {
            Value::List(List::EditedPath(path)) => path.as_ref(),
            _ => None,
        }
    }

    /// Returns the visits of a walk: when to set off, seconds, and the clip's index.
    #[must_use]
    pub fn visits(&self) -> &[(f64, usize)] {
        match self.get(Key::GoTo) {
            Value::List(List::Visits(visits)) => visits,
            _ => &[],
        }
    }

    /// Returns the line over the ground that a walk follows, x and z in metres.
    #[must_use]
    pub fn ground_path(&self) -> &[DVec2] {
        match self.get(Key::WalkPath) {
            Value::List(List::GroundPath(points)) => points,
            _ => &[],
        }
    }

    /// Returns the chosen transition of a graph: the frame that is left, and the one that is
    /// entered; `None` if none is chosen.
    #[must_use]
    pub fn jump(&self) -> Option<&[Place; 2]> {
        match self.get(Key::Jump) {
            Value::List(List::Jump(ends)) => ends.as_ref(),
            _ => None,
        }
    }

    /// Returns the recorded input of the Match lab; `None` if there is none.
    #[must_use]
    pub fn recording(&self) -> Option<&Recording> {
        match self.get(Key::Drive) {
            Value::List(List::Recording(recording)) => recording.as_ref(),
            _ => None,
        }
    }

    /// Returns the tags that are set by hand.
    #[must_use]
    pub fn tags(&self) -> &[HandTag] {
        match self.get(Key::Tags) {
            Value::List(List::Tags(tags)) => tags,
            _ => &[],
        }
    }

    /// Returns the contacts of clips that are corrected by hand.
    #[must_use]
    pub fn contact_edits(&self) -> &[ClipContacts] {
        match self.get(Key::ContactEdits) {
            Value::List(List::ContactEdits(clips)) => clips,
            _ => &[],
        }
    }

    /// Returns the quantities of the chosen joint that are plotted, each once, the first of them
    /// above the others.
    #[must_use]
    pub fn plotted_curves(&self) -> Vec<Curve> {
        let mut curves = vec![self.choice::<Curve>()];
        if let Value::List(List::Curves(more)) = self.get(Key::MoreCurves) {
            for curve in more {
                if !curves.contains(curve) {
                    curves.push(*curve);
                }
            }
        }
        curves
    }

    /// Returns the addresses of the motion files that are loaded with the link.
    #[must_use]
    pub fn source_addresses(&self) -> &[String] {
        match self.get(Key::Src) {
            Value::List(List::Addresses(addresses)) => addresses,
            _ => &[],
        }
    }
}
