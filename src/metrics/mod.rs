//! Artefacts as numbers with a unit: what a viewer would point at, measured.

mod deviation;
mod lowest;
mod profile;
mod slide;
mod transition;
mod whole;

pub use deviation::deviations;
pub use profile::Profile;
pub use slide::{SlideMeter, foot_slide_cm, foot_slides_cm};
pub use transition::{Subject, TransitionMetrics};
pub use whole::{ClipMeter, ClipMetrics};

/// Which way a number should go.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub enum Better {
    /// Smaller is better; 0 is perfect.
    Lower,
    /// Larger is better.
    Higher,
    /// Neither: it describes.
    Neutral,
}

/// One number for a person.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Metric {
    /// The key in links, exports and comparisons; never changes.
    pub id: &'static str,
    /// What it is called.
    pub label: &'static str,
    /// The number; `None` where there is nothing to measure (no feet, no foot on the ground, no change of speed).
    pub value: Option<f64>,
    /// The unit, as written behind the number.
    pub unit: &'static str,
    /// Which way it should go.
    pub better: Better,
    /// One or two sentences: what it means and how it is measured.
    pub help: &'static str,
}

impl Metric {
    /// A number that should be small; 0 is perfect.
    #[must_use]
    pub fn lower(id: &'static str, label: &'static str, value: impl Into<Option<f64>>, unit: &'static str, help: &'static str) -> Self {
        Self {
            better: Better::Lower,
            ..Self::fact(id, label, value, unit, help)
        }
    }

    /// A number that only describes.
    #[must_use]
    pub fn fact(id: &'static str, label: &'static str, value: impl Into<Option<f64>>, unit: &'static str, help: &'static str) -> Self {
        Self {
            id,
            label,
            value: value.into(),
            unit,
            better: Better::Neutral,
            help,
        }
    }
}
