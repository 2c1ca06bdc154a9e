//! The outcome of a trial, and its faults.

/// The ratio above which foot skating counts as more than another clip's: two measurements agree to
/// within this ratio.
const SAME_SKATING: f64 = 1.05;
/// The least difference in foot skating that counts, cm/s: standing clips have next to none, and a
/// millimetre per second is not visible.
const MIN_SKATING_CMPS: f64 = 0.1;

/// The kind of a draw of takes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Draw {
    /// Two takes of one rig.
    SameRig,
    /// Two takes of two rigs.
    OtherRigs,
    /// Four takes of one rig.
    Set,
}

impl Draw {
    /// Returns the heading of its table.
    #[must_use]
    pub const fn title(self) -> &'static str {
        match self {
            Self::SameRig => "Pairs of the same rig",
            Self::OtherRigs => "Pairs of different rigs",
            Self::Set => "Sets of four takes of one rig",
        }
    }
}

/// The result of one use of a lab on some takes.
#[derive(Debug, serde::Serialize)]
pub struct Trial {
    /// The lab's name in links.
    pub lab: &'static str,
    /// The name of the method.
    pub method: String,
    /// The table of the trial.
    #[serde(skip)]
    pub draw: Draw,
    /// The takes.
    pub takes: Vec<String>,
    /// The link, which opens the result if the takes are in the library.
    pub link: String,
    /// Whether feet are locked.
    pub locked: bool,
    /// Whether the bounds apply.
    pub bound: bool,
    /// The duration, seconds.
    pub secs: f64,
    /// The result.
    pub result: TrialResult,
}

/// The result of a trial.
#[derive(Debug, serde::Serialize)]
#[serde(rename_all = "snake_case")]
pub enum TrialResult {
    /// A motion with its measurements.
    Made(Box<Numbers>),
    /// No motion, with a sentence that says why.
    Refused(String),
    /// No motion, and no message.
    Silent,
    /// A panic with its message and place.
    Panicked(String),
}

/// Measurements of a result compared with its sources.
#[derive(Clone, Debug, Default, serde::Serialize)]
pub struct Numbers {
    /// Whether anything in it is not finite.
    pub not_finite: bool,
    /// Counts as in [`segue_motion::metrics::Artefacts`].
    pub spins: usize,
    pub flashes: usize,
    pub new_flashes: usize,
    pub root_jumps: usize,
    pub new_root_jumps: usize,
    /// The first flash that no source has: frame, joint, and the ratio to the sources' 99.9th
    /// percentile.
    pub first_flash: Option<(usize, String, f64)>,
    /// Foot skating of the result, and of the worst source, cm/s.
    pub skating: Option<f64>,
    pub source_skating: Option<f64>,
    /// The median foot slide of a stance in the result, and in the sources, cm.
    pub stance_cm: Option<f64>,
    pub source_stance_cm: Option<f64>,
}

impl Trial {
    /// Returns the names of the numbers that are worse than the sources' beyond the bounds.
    #[must_use]
    pub fn faults(&self) -> Vec<&'static str> {
        let mut faults = Vec::new();
        let mut note = |is_fault: bool, name: &'static str| {
            if is_fault {
                faults.push(name);
            }
        };
        match &self.result {
            TrialResult::Refused(_) => {}
            TrialResult::Silent => note(true, "refused without a message"),
            TrialResult::Panicked(_) => note(true, "panic"),
            TrialResult::Made(numbers) => {
                note(numbers.not_finite, "not finite");
                if self.bound {
                    note(numbers.spins > 0, "spin");
                    note(numbers.new_flashes > 0, "flash");
                    note(numbers.new_root_jumps > 0, "root jump");
                    let worse =
                        numbers.skating.zip(numbers.source_skating).is_some_and(|(own, source)| {
                            own > (SAME_SKATING * source).max(source + MIN_SKATING_CMPS)
                        });
                    note(self.locked && worse, "skating");
                }
            }
        }
        faults
    }
}
