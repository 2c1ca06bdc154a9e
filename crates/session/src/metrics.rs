//! The metrics of results. All facts about a metric are in its row of the table.

mod table;

pub use table::{METRICS, MetricId};

use segue_motion::metrics::ResultMetrics;

/// The direction in which a metric improves.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Better {
    /// Smaller is better; 0 is perfect.
    Lower,
    /// Larger is better.
    Higher,
    /// Neither: the number only describes.
    Neutral,
}

impl Better {
    /// Returns the name in the page's API.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Lower => "lower",
            Self::Higher => "higher",
            Self::Neutral => "neutral",
        }
    }
}

/// The unit of a metric.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[expect(missing_docs, reason = "`text` shows each as it is written")]
pub enum Unit {
    /// A number of things, without a unit.
    Count,
    Degrees,
    DegreesPerSec,
    Metres,
    MetresPerSec,
    Centimetres,
    CentimetresPerSec,
    Secs,
    Millisecs,
    Percent,
    PerMinute,
    StepsPerMinute,
    Frames,
    Bends,
}

impl Unit {
    /// Returns the unit as it is written after a number.
    #[must_use]
    pub fn text(self) -> &'static str {
        match self {
            Self::Count => "",
            Self::Degrees => "°",
            Self::DegreesPerSec => "°/s",
            Self::Metres => "m",
            Self::MetresPerSec => "m/s",
            Self::Centimetres => "cm",
            Self::CentimetresPerSec => "cm/s",
            Self::Secs => "s",
            Self::Millisecs => "ms",
            Self::Percent => "%",
            Self::PerMinute => "/min",
            Self::StepsPerMinute => "steps/min",
            Self::Frames => "frames",
            Self::Bends => "bends",
        }
    }

    /// Returns the number of decimals with which a value is read at a glance.
    #[must_use]
    pub fn decimals(self, value: f64) -> usize {
        match self {
            Self::Secs | Self::Metres | Self::MetresPerSec | Self::Millisecs => 2,
            Self::Centimetres => 1,
            Self::Percent | Self::Frames | Self::Bends | Self::Count => 0,
            Self::Degrees
            | Self::DegreesPerSec
            | Self::CentimetresPerSec
            | Self::PerMinute
            | Self::StepsPerMinute => usize::from(value < 9.95),
        }
    }

    /// Returns the smallest difference between two results that makes one the better.
    #[must_use]
    pub fn least_difference(self) -> f64 {
        match self {
            Self::DegreesPerSec => 5.0,
            Self::Degrees => 1.0,
            Self::Secs => 0.05,
            _ => 0.5,
        }
    }
}

/// All facts about a metric: a row of [`METRICS`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MetricRow {
    /// The metric.
    pub id: MetricId,
    /// The key in the page's API and in lessons; never changes.
    pub name: &'static str,
    /// The name on screen and in tables.
    pub label: &'static str,
    /// The name below the number on the stage, with the unit; `None` for a metric that is listed in
    /// tables alone.
    pub short: Option<&'static str>,
    /// The unit.
    pub unit: Unit,
    /// The direction in which it improves.
    pub better: Better,
    /// One or two sentences: its meaning and how it is measured.
    pub help: &'static str,
}

impl MetricId {
    /// Returns the row of the metric.
    #[must_use]
    pub fn row(self) -> &'static MetricRow {
        // The rows are in the order of the enum, which is made from them.
        &METRICS[self as usize]
    }

    /// Returns the key in the page's API and in lessons.
    #[must_use]
    pub fn name(self) -> &'static str {
        self.row().name
    }
}

/// One measured number.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Metric {
    /// The metric.
    pub id: MetricId,
    /// The number; `None` where there is nothing to measure (no feet, no foot on the ground, no
    /// change of speed).
    pub value: Option<f64>,
}

impl Metric {
    /// Returns a metric with its value.
    #[must_use]
    pub fn new(id: MetricId, value: impl Into<Option<f64>>) -> Self {
        Self { id, value: value.into() }
    }
}

/// Returns the metrics that results of every lab have, in the order of the lists.
pub(crate) fn of_result(found: &ResultMetrics) -> [Metric; 4] {
    [
        Metric::new(MetricId::PoseJump, found.pose_jump_deg),
        Metric::new(MetricId::VelocityJump, found.velocity_jump_dps),
        Metric::new(MetricId::Spin, found.spin_deg),
        Metric::new(MetricId::Skating, found.skating_cm_per_sec),
    ]
}

#[cfg(test)]
mod tests;
