//! The findings of the checks in a file.

use super::checks::{Rule, Source, unit_of};
use crate::info::rounded;
use segue_batch::import_text;
use segue_formats::FileKind;
use segue_motion::clean::{Fault, SizeUnit, find_faults};
use segue_motion::clip::Motion;
use segue_session::metrics::Metric;
use segue_session::metrics_of_clip;
use segue_session::reading::{ReadClip, ReadFile};
use serde::Serialize;
use std::ops::RangeInclusive;
use std::sync::Arc;

/// The most joints of a fault that a sentence names.
const MAX_NAMED: usize = 3;

/// The severity of a finding.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub(super) enum Severity {
    /// The run fails.
    Error,
    /// It is told.
    Warning,
}

impl Severity {
    /// Returns the word in reports.
    pub(super) const fn word(self) -> &'static str {
        match self {
            Self::Error => "error",
            Self::Warning => "warning",
        }
    }
}

/// A finding.
#[derive(Clone, Debug, Serialize)]
pub(super) struct Finding {
    /// The word of the check.
    pub(super) check: &'static str,
    pub(super) severity: Severity,
    /// The clip; empty for a finding about the file.
    pub(super) clip: String,
    /// A sentence.
    pub(super) text: String,
    /// The measured value; the confidence of a fault, per cent.
    pub(super) value: Option<f64>,
    pub(super) unit: &'static str,
    /// The first and the last frame of the clip, counted from 0.
    pub(super) frames: Option<[usize; 2]>,
    /// The line of the file, counted from 1, where it is text with a line for each frame.
    pub(super) line: Option<usize>,
    /// The joints.
    pub(super) joints: Vec<String>,
}

/// A file that was checked.
#[derive(Clone, Debug, Serialize)]
pub(super) struct Checked {
    pub(super) file: String,
    /// The clips by name.
    pub(super) clips: Vec<String>,
    pub(super) findings: Vec<Finding>,
    /// The reason why it could not be read.
    pub(super) error: Option<Unreadable>,
}

/// The reason why a file could not be read, and its place.
#[derive(Clone, Debug, Serialize)]
pub(super) struct Unreadable {
    pub(super) text: String,
    pub(super) line: Option<usize>,
    pub(super) column: Option<usize>,
}

impl Checked {
    /// Returns a file that could not be read.
    pub(super) fn unreadable(file: &str, text: String) -> Self {
        let error = Some(Unreadable { text, line: None, column: None });
        Self { file: file.to_owned(), clips: Vec::new(), findings: Vec::new(), error }
    }
}

/// Checks the clips of a file. `bytes` are those of the file, if it is no archive.
pub(super) fn check_file(file: ReadFile, bytes: Option<&[u8]>, rules: &[Rule]) -> Checked {
    let ReadFile { name, kind, result, .. } = file;
    let read = match result {
        Ok(read) => read,
        Err(error) => {
            let (line, column) = (Some(error.line), Some(error.column));
            let error = Some(Unreadable { text: import_text(&error), line, column });
            return Checked { file: name, clips: Vec::new(), findings: Vec::new(), error };
        }
    };
    let mut checked = Checked { file: name, clips: Vec::new(), findings: Vec::new(), error: None };
    if read.awaits_skeleton {
        let text = "it needs its skeleton, an ASF file: put it beside, or name it by --skeleton";
        checked.error = Some(Unreadable { text: text.to_owned(), line: None, column: None });
    }
    for rule in rules.iter().filter(|rule| rule.check.source == Source::Oddity) {
        checked.findings.extend(
            read.warnings
                .iter()
                .map(|warning| Finding { text: warning.to_string(), ..Finding::new(rule, "") }),
        );
    }
    let rows = bytes.filter(|_| kind == FileKind::Bvh).map(Rows::of);
    for clip in read.clips {
        let ReadClip { motion, about, .. } = clip;
        let motion = Arc::new(motion);
        let name = motion.clip().name().to_owned();
        let found = check_clip(&motion, rules);
        let first = usize::from(about.t_pose_dropped);
        checked.findings.extend(found.into_iter().map(|mut finding| {
            let row = finding.frames.map(|[from, _]| from + first);
            finding.line = row.and_then(|row| rows.as_ref()?.line(row));
            finding
        }));
        checked.clips.push(name);
    }
    checked
}

fn check_clip(motion: &Arc<Motion>, rules: &[Rule]) -> Vec<Finding> {
    if motion.clip().frames() < 2 {
        return Vec::new();
    }
    let metrics = metrics_of_clip(motion);
    let faults = find_faults(motion);
    let mut findings = Vec::new();
    for rule in rules {
        match rule.check.source {
            Source::Metric(id) => {
                let own = metrics.iter().find(|metric| metric.id == id);
                findings.extend(own.and_then(|metric| of_metric(rule, motion, metric)));
            }
            Source::Fault(kind) => {
                let own = faults.iter().filter(|fault| fault.kind == kind);
                findings.extend(own.filter_map(|fault| of_fault(rule, motion, fault)));
            }
            Source::Oddity => {}
        }
    }
    findings
}

fn of_metric(rule: &Rule, motion: &Motion, metric: &Metric) -> Option<Finding> {
    let (value, unit) = (metric.value?, unit_of(rule.check));
    if value <= rule.limit {
        return None;
    }
    let frame = metric.at_secs.map(|secs| (secs * motion.clip().fps()).round() as usize);
    let place = frame.map_or_else(String::new, |frame| format!(", at frame {frame}"));
    let space = if unit.starts_with('°') { "" } else { " " };
    let decimals = metric.id.row().unit.decimals(value).max(1);
    let text = format!(
        "{value:.decimals$}{space}{unit}, more than {}{space}{unit}{place}",
        rounded(rule.limit)
    );
    Some(Finding {
        text,
        value: Some(value),
        frames: frame.map(|frame| [frame; 2]),
        ..Finding::new(rule, motion.clip().name())
    })
}

fn of_fault(rule: &Rule, motion: &Motion, fault: &Fault) -> Option<Finding> {
    let sure = f64::from(fault.confidence) * 100.0;
    if sure < rule.limit {
        return None;
    }
    let joints = motion.clip().skeleton().joints();
    let named = fault.joints.iter().filter_map(|&joint| joints.get(joint));
    let names: Vec<String> = named.map(|joint| joint.name.clone()).collect();
    let who = match names.as_slice() {
        [] => String::new(),
        few if few.len() <= MAX_NAMED => format!("{}, ", few.join(", ")),
        [first, rest @ ..] => format!("{first} and {} others, ", rest.len()),
    };
    let (from, to) =
        (fault.frames.start, fault.frames.end.saturating_sub(1).max(fault.frames.start));
    let text = format!("{who}{}, {}, {sure:.0} % sure", span(from..=to), size(fault));
    Some(Finding {
        text,
        value: Some(sure),
        frames: Some([from, to]),
        joints: names,
        ..Finding::new(rule, motion.clip().name())
    })
}

fn span(frames: RangeInclusive<usize>) -> String {
    match frames.into_inner() {
        (from, to) if from == to => format!("frame {from}"),
        (from, to) => format!("frames {from} to {to}"),
    }
}

/// Returns the size of a fault in words.
pub(crate) fn size(fault: &Fault) -> String {
    let size = fault.size;
    match fault.unit {
        SizeUnit::Degrees => format!("{size:.1}°"),
        SizeUnit::Centimetres => format!("{size:.1} cm"),
        SizeUnit::Frames => format!("{size:.0} frames"),
        SizeUnit::DegreesPerSecond => format!("{size:.1}°/s"),
        SizeUnit::CentimetresPerSecond => format!("{size:.1} cm/s"),
        SizeUnit::FramesPerSecond => format!("looks right at {size:.0} fps"),
    }
}

impl Finding {
    /// Returns a finding of a rule without anything else.
    fn new(rule: &Rule, clip: &str) -> Self {
        Self {
            check: rule.check.word,
            severity: if rule.fails { Severity::Error } else { Severity::Warning },
            clip: clip.to_owned(),
            text: String::new(),
            value: None,
            unit: unit_of(rule.check),
            frames: None,
            line: None,
            joints: Vec::new(),
        }
    }
}

/// The lines of a BVH file that hold its frames.
struct Rows {
    /// The line of the first row, counted from 1; `None` where a row is not one line.
    first: Option<usize>,
    count: usize,
}

impl Rows {
    fn of(bytes: &[u8]) -> Self {
        let lines = || bytes.split(|byte| *byte == b'\n').map(<[u8]>::trim_ascii);
        let starts = |line: &[u8]| {
            line.get(..11).is_some_and(|start| start.eq_ignore_ascii_case(b"frame time:"))
        };
        let header = lines().position(starts);
        let rows = header.map(|header| lines().skip(header + 1));
        // Empty lines between rows would count as frames.
        let count = rows.map_or(0, |rows| rows.take_while(|line| !line.is_empty()).count());
        Self { first: header.map(|header| header + 2), count }
    }

    fn line(&self, row: usize) -> Option<usize> {
        self.first.filter(|_| row < self.count).map(|first| first + row)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_are_the_lines_behind_the_header() {
        let rows = Rows::of(b"HIERARCHY\nMOTION\r\nFrames: 2\r\nFrame Time: 0.1\r\n1 2\r\n3 4\r\n");
        assert_eq!([rows.line(0), rows.line(1), rows.line(2)], [Some(5), Some(6), None]);
        assert_eq!(Rows::of(b"HIERARCHY").line(0), None);
    }

    #[test]
    fn span_of_one_frame_is_that_frame() {
        assert_eq!([span(3..=3), span(3..=5)], ["frame 3", "frames 3 to 5"]);
    }
}
