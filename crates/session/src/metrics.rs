//! The metrics of results. All facts about a metric are in its row of the table.

mod table;

pub use table::{METRICS, MetricId};

use segue_motion::math::sort::sort_by;
use segue_motion::metrics::{Extreme, ResultMetrics, SPIN_SECS};

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
}

/// All facts about a metric: a row of [`METRICS`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MetricRow {
    /// The metric.
    pub id: MetricId,
    /// The key in the page's API and in lessons; never changes.
    pub name: &'static str,
    /// The name on screen, in lessons and in tables.
    pub label: &'static str,
    /// The name where there is little room: words of the name.
    pub short: &'static str,
    /// The unit.
    pub unit: Unit,
    /// The direction in which it improves.
    pub better: Better,
    /// The least difference that a viewer can see: values closer than this are equally good.
    /// `None` where neither direction is better.
    pub noticeable: Option<f64>,
    /// One or two sentences: its meaning and how it is measured.
    pub help: &'static str,
    /// One or two sentences: which values are good, or what to compare it with.
    pub good: &'static str,
}

impl MetricRow {
    /// Returns the places of the best and of the worst of some values. Each is marked only if it
    /// differs from all others by what a viewer can see: equal values have no best.
    #[must_use]
    pub fn ends(&self, values: &[Option<f64>]) -> Ends {
        let Some(noticeable) = self.noticeable else {
            return Ends::default();
        };
        let mut known: Vec<(usize, f64)> = values
            .iter()
            .enumerate()
            .filter_map(|(place, value)| Some((place, (*value)?)))
            .collect();
        sort_by(&mut known, |a, b| a.1.total_cmp(&b.1));
        let ([lowest, second, ..], [.., last_but_one, highest]) = (&*known, &*known) else {
            return Ends::default();
        };
        let apart = |a: &(usize, f64), b: &(usize, f64)| b.1 - a.1 >= noticeable;
        let low = apart(lowest, second).then_some(lowest.0);
        let high = apart(last_but_one, highest).then_some(highest.0);
        match self.better {
            Better::Lower => Ends { best: low, worst: high },
            Better::Higher => Ends { best: high, worst: low },
            Better::Neutral => Ends::default(),
        }
    }
}

/// The places of the best and of the worst of several values; `None` where none stands out.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Ends {
    /// The place of the best.
    pub best: Option<usize>,
    /// The place of the worst.
    pub worst: Option<usize>,
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
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Metric {
    /// The metric.
    pub id: MetricId,
    /// The number; `None` where there is nothing to measure (no feet, no foot on the ground, no
    /// change of speed).
    pub value: Option<f64>,
    /// The time of the result where it happens, seconds: that of the frame with the worst value.
    /// `None` for means, lengths and rates, and where the number is 0.
    pub at_secs: Option<f64>,
}

impl Metric {
    /// Returns a metric with its value, which no single frame has.
    #[must_use]
    pub fn new(id: MetricId, value: impl Into<Option<f64>>) -> Self {
        Self { id, value: value.into(), at_secs: None }
    }

    /// Returns a metric with its value, and the frame where it happens.
    #[must_use]
    pub fn at_frame(
        id: MetricId,
        value: impl Into<Option<f64>>,
        frame: Option<usize>,
        fps: f64,
    ) -> Self {
        let at_secs = frame.map(|frame| frame as f64 / fps).filter(|secs| secs.is_finite());
        Self { at_secs, ..Self::new(id, value) }
    }

    /// Returns a metric whose value is the largest of all frames.
    #[must_use]
    pub fn extreme(id: MetricId, found: Option<Extreme>, fps: f64) -> Self {
        let frame = found.as_ref().and_then(Extreme::place);
        Self::at_frame(id, found.map(|found| found.value), frame, fps)
    }
}

/// Returns the metrics that results of every lab have, in the order of the lists; `fps` is the
/// result's frame rate.
pub(crate) fn of_result(found: &ResultMetrics, fps: f64) -> [Metric; 4] {
    // The first frame that is displaced, and the middle of a spin.
    let pose = found.pose_jump_at.map(|at| at.frame + 1);
    let velocity = found.velocity_jump_at.map(|at| at.frame);
    let spin = found.spin_at.map(|frame| frame + (0.5 * SPIN_SECS * fps).round() as usize);
    [
        Metric::at_frame(MetricId::PoseJump, found.pose_jump_deg, pose, fps),
        Metric::at_frame(MetricId::VelocityJump, found.velocity_jump_dps, velocity, fps),
        Metric::at_frame(MetricId::Spin, found.spin_deg, spin, fps),
        Metric::new(MetricId::Skating, found.skating_cm_per_sec),
    ]
}

#[cfg(test)]
mod tests;
