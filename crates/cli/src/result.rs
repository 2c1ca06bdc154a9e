//! Results of labs: what is printed of them, and their files.

use crate::info::rounded;
use crate::lint::fault_size;
use crate::numbers;
use crate::status::{Failure, Status};
use crate::table;
use crate::write::Outputs;
use segue_batch::{Driven, page_link, shown};
use segue_session::export::{ExportOptions, export, plotted_of_result};
use segue_session::metrics::Metric;
use segue_session::{FoundFault, Outcome, PaneResult, file_stem};
use serde_json::{Value as Json, json};
use std::io::{self, Write};
use std::path::{Path, PathBuf};

/// A result, or the reason why there is none.
#[derive(Debug)]
pub(crate) struct Made {
    /// The clip that it was made from, where each clip gives a result.
    source: String,
    /// The name by which it differs from others.
    name: Option<String>,
    /// The path of its file in the folder, without an ending.
    stem: PathBuf,
    /// The link that makes it in the page.
    link: String,
    motion: Result<MadeMotion, String>,
    /// The bytes of its file until they are written.
    bytes: Option<Result<Vec<u8>, String>>,
    ending: &'static str,
    /// The file that was written.
    written: Option<Result<PathBuf, String>>,
    /// The refusals and corrections of the options, one sentence each.
    notes: Vec<String>,
    /// The exit code of a run that gave nothing.
    failed: Option<Status>,
}

/// Facts about a result.
#[derive(Debug)]
struct MadeMotion {
    frames: usize,
    fps: f64,
    secs: f64,
    joints: usize,
    metrics: Vec<Metric>,
    faults: Vec<FaultRow>,
    transition: Json,
}

/// A fault of a cleaned take.
#[derive(Debug)]
struct FaultRow {
    text: String,
    json: Json,
}

/// Returns the results of a session that has done its work, one for each pane. `relative` is the
/// path of their files in a folder; the lab names them otherwise.
pub(crate) fn collect(
    driven: &Driven,
    source: &str,
    name: Option<&str>,
    relative: Option<&Path>,
    options: Option<&ExportOptions>,
    page: &str,
) -> Vec<Made> {
    let link = page_link(&driven.session, page);
    let mut notes = driven.all_notes();
    let made = driven.results().into_iter().map(|(variant, result)| {
        let name = variant.or_else(|| name.map(str::to_owned));
        let bytes = match (&result, options) {
            (Ok(made), Some(options)) => Some(exported(driven, *made, options)),
            _ => None,
        };
        let stem = relative
            .map_or_else(|| PathBuf::from(file_stem(driven.session.params())), Path::to_owned);
        let stem = match name.as_ref().filter(|_| relative.is_none()) {
            Some(name) => stem.with_file_name(format!("{} {name}", stem.display())),
            None => stem,
        };
        Made {
            source: source.to_owned(),
            name,
            stem,
            link: link.clone(),
            motion: result.map(|made| MadeMotion::of(made.outcome)).map_err(|no| no.to_string()),
            bytes,
            ending: options.map_or("", |options| options.format.ending()),
            written: None,
            notes: std::mem::take(&mut notes),
            failed: None,
        }
    });
    made.collect()
}

impl Made {
    /// Returns the lack of a result, because its clip could not be read or used.
    pub(crate) fn failed(source: &str, failure: &Failure) -> Self {
        Self {
            source: source.to_owned(),
            name: None,
            stem: PathBuf::new(),
            link: String::new(),
            motion: Err(failure.to_string()),
            bytes: None,
            ending: "",
            written: None,
            notes: Vec::new(),
            failed: Some(failure.status),
        }
    }
}

/// Returns the bytes of a result's file, as the page saves it.
fn exported(
    driven: &Driven,
    made: PaneResult<'_>,
    options: &ExportOptions,
) -> Result<Vec<u8>, String> {
    let columns = plotted_of_result(made.outcome, made.params);
    let character = driven.session.character();
    export(&made.outcome.motion, character.as_ref(), &columns, options)
        .map_err(|error| error.to_string())
}

impl MadeMotion {
    fn of(outcome: &Outcome) -> Self {
        let clip = outcome.motion.clip();
        let cleaned = outcome.cleaned();
        let names: Vec<&str> =
            clip.skeleton().joints().iter().map(|joint| joint.name.as_str()).collect();
        let faults = cleaned.into_iter().flat_map(|facts| {
            facts.faults.iter().map(|found| fault_row(found, facts.mends, &names))
        });
        let transition = outcome.transition.map(|transition| {
            json!({
                "start_s": transition.start_secs,
                "end_s": transition.end_secs,
                "leave_a_s": transition.leave_a_secs,
                "enter_b_s": transition.enter_b_secs,
                "window_frames": transition.window_frames,
                "distance_cm": transition.distance_cm,
            })
        });
        Self {
            frames: clip.frames(),
            fps: clip.fps(),
            secs: clip.duration_secs(),
            joints: clip.skeleton().len(),
            metrics: outcome.metrics.clone(),
            faults: faults.collect(),
            transition: Json::from(transition),
        }
    }

    fn as_json(&self) -> Json {
        json!({
            "frames": self.frames,
            "fps": self.fps,
            "seconds": self.secs,
            "joints": self.joints,
            "metrics": numbers::as_json(&self.metrics),
            "transition": self.transition,
            "faults": self.faults.iter().map(|fault| &fault.json).collect::<Vec<_>>(),
        })
    }

    fn in_words(&self) -> String {
        let Self { frames, fps, secs, .. } = self;
        format!("{frames} frames at {} fps, {secs:.2} s", rounded(*fps))
    }
}

fn fault_row(found: &FoundFault, mends: bool, names: &[&str]) -> FaultRow {
    let fault = &found.fault;
    let (kind, is_mended) = (fault.kind.word(), mends && found.is_chosen);
    let last = fault.frames.end.saturating_sub(1);
    let joints: Vec<&str> =
        fault.joints.iter().filter_map(|&joint| names.get(joint).copied()).collect();
    let who = match joints.as_slice() {
        [] => String::new(),
        [one] => format!(", {one}"),
        [first, rest @ ..] => format!(", {first} and {} more", rest.len()),
    };
    let text = format!(
        "{} {kind}, frames {} to {last}{who}, {}, {:.0} % sure",
        if is_mended { "mended" } else { "left  " },
        fault.frames.start,
        fault_size(fault),
        fault.confidence * 100.0
    );
    let json = json!({
        "kind": kind,
        "frames": [fault.frames.start, last],
        "joints": joints,
        "size": fault_size(fault),
        "confidence": fault.confidence,
        "is_mended": is_mended,
    });
    FaultRow { text, json }
}

impl Made {
    /// Writes its file, if that was not done yet.
    pub(crate) fn write(&mut self, outputs: &mut Outputs) {
        if let Some(bytes) = self.bytes.take() {
            let write = |bytes: Vec<u8>| outputs.write(&self.stem, self.ending, &bytes);
            self.written = Some(bytes.and_then(write));
        }
    }

    /// Returns the exit code that it asks for.
    pub(crate) fn status(&self) -> Status {
        match (&self.motion, &self.written) {
            (Err(_), _) => self.failed.unwrap_or(Status::Findings),
            (_, Some(Err(_))) => Status::Unreadable,
            _ => Status::Fine,
        }
    }

    fn as_json(&self) -> Json {
        let mut json = match &self.motion {
            Ok(motion) => motion.as_json(),
            Err(reason) => json!({ "error": reason }),
        };
        if !self.source.is_empty() {
            json["source"] = Json::from(self.source.clone());
        }
        json["name"] = Json::from(self.name.clone());
        json["link"] = Json::from(self.link.clone());
        json["notes"] = Json::from(self.notes.clone());
        match &self.written {
            Some(Ok(path)) => json["file"] = Json::from(shown(path)),
            Some(Err(reason)) => json["error"] = Json::from(reason.clone()),
            None => {}
        }
        json
    }

    /// Returns its name, length and file on one line.
    fn heading(&self) -> String {
        let name = [self.source.as_str(), self.name.as_deref().unwrap_or_default()];
        let name: Vec<&str> = name.into_iter().filter(|part| !part.is_empty()).collect();
        let name = if name.is_empty() { "result".to_owned() } else { name.join(", ") };
        let about = match &self.motion {
            Ok(motion) => motion.in_words(),
            Err(reason) => format!("no result: {reason}"),
        };
        let file = match &self.written {
            Some(Ok(path)) => format!(" → {}", shown(path)),
            _ => String::new(),
        };
        format!("{name}: {about}{file}")
    }
}

/// Prints results.
///
/// # Errors
/// [`Failure`] if the output cannot be written.
pub(crate) fn tell(made: &[Made], is_json: bool, prints_link: bool) -> Result<(), Failure> {
    let mut out = io::stdout().lock();
    for own in made {
        for note in &own.notes {
            eprintln!("segue: {note}");
        }
        if let Some(Err(reason)) = &own.written {
            eprintln!("segue: {reason}");
        }
    }
    if is_json {
        let all: Vec<Json> = made.iter().map(Made::as_json).collect();
        writeln!(out, "{:#}", Json::Array(all))?;
        return Ok(());
    }
    let of_each = made.iter().any(|own| !own.source.is_empty()) && made.len() > 1;
    for own in made {
        writeln!(out, "{}", own.heading())?;
        if let Some(motion) = own.motion.as_ref().ok().filter(|_| of_each) {
            writeln!(out, "  {}", numbers::on_one_line(&motion.metrics))?;
        }
        for fault in own.motion.iter().flat_map(|motion| &motion.faults) {
            writeln!(out, "  {}", fault.text)?;
        }
    }
    if !of_each {
        table::write(&mut out, &side_by_side(made))?;
    }
    let links = made.iter().map(|own| own.link.as_str());
    let mut links: Vec<&str> = links.filter(|link| !link.is_empty()).collect();
    links.dedup();
    for link in links.into_iter().filter(|_| prints_link) {
        writeln!(out, "{link}")?;
    }
    Ok(())
}

/// Returns the metrics of results in columns, with a heading where there are several.
fn side_by_side(made: &[Made]) -> Vec<Vec<String>> {
    let motions = || made.iter().map(|own| own.motion.as_ref().ok());
    let listed = segue_session::metrics::METRICS.iter().filter(|row| {
        motions().flatten().any(|motion| motion.metrics.iter().any(|own| own.id == row.id))
    });
    let mut rows = Vec::new();
    if made.len() > 1 {
        let names = made.iter().map(|own| own.name.clone().unwrap_or_default());
        rows.push([String::new(), String::new()].into_iter().chain(names).collect());
    }
    for row in listed {
        let value = |motion: Option<&MadeMotion>| {
            let own =
                motion.and_then(|motion| motion.metrics.iter().find(|metric| metric.id == row.id));
            own.map_or_else(|| "–".to_owned(), numbers::number)
        };
        let heading = [format!("  {}", row.label), row.unit.text().to_owned()];
        rows.push(heading.into_iter().chain(motions().map(value)).collect());
    }
    rows
}
