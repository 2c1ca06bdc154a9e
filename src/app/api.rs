//! The page's own API, as far as it is plain data: what it is asked, and what it answers.
//! `docs/api.md` documents it.

mod answers;
#[cfg(test)]
mod tests;

pub(crate) use answers::{ExportedFile, KeyInfo, LoadedClips, MetricInfo, PoseInfo, Stats};

use super::Segue;
use super::link_query;
use crate::platform::{self, FileBytes};
use answers::JobInfo;
use eframe::wgpu::Backend;
use glam::{Quat, Vec3};
use segue_motion::clip::Motion;
use segue_motion::math::Planar;
use segue_motion::skeleton::Side;
use segue_scene::pose_at;
use segue_session::export::{
    ExportBody, ExportFormat, ExportOptions, export, file_name, plotted_of_clip, plotted_of_result,
};
use segue_session::metrics::MetricId;
use segue_session::outside;
use segue_session::reading::Content;
use segue_session::{
    ClipInfo, Command, CommandError, FileCommand, Key, Kind, List, LoadedFile, PARAMS, Pane,
    PaneResult, Param, PlaybackCommand, ReportFacts, Value, check_graph_clips, file_stem, frame_at,
    report,
};
use serde_json::{Map, Value as Json};
use std::collections::BTreeMap;
use std::sync::Arc;

/// What the API asks a motion of.
enum Subject<'a> {
    /// A clip of the library.
    Clip(&'a Arc<Motion>),
    /// The result of a pane.
    Result(&'a Pane, PaneResult<'a>),
}

/// What the API calls a backend.
pub(crate) fn backend_name(backend: Backend) -> &'static str {
    match backend {
        Backend::BrowserWebGpu => "webgpu",
        Backend::Gl if cfg!(target_family = "wasm") => "webgl2",
        other => other.to_str(),
    }
}

/// Every row of the table of parameters.
pub(crate) fn keys() -> Vec<KeyInfo> {
    let row = |param: &'static Param| {
        let number = if let Kind::Number { min, max, step, auto, .. } = param.kind {
            Some((min, max, step, auto))
        } else {
            None
        };
        KeyInfo {
            key: param.name,
            label: param.label,
            kind: param.kind.name(),
            min: number.map(|(min, ..)| min),
            max: number.map(|(_, max, ..)| max),
            step: number.map(|(_, _, step, _)| step),
            auto: number.is_some_and(|(.., auto)| auto),
            choices: if let Kind::Choice(choices) = param.kind {
                choices.iter().map(|choice| choice.key).collect()
            } else {
                Vec::new()
            },
            default: param.to_json(&param.default_value()),
            unit: param.unit,
            lab: param.group.name(),
            help: param.help,
        }
    };
    PARAMS.iter().map(row).collect()
}

impl Segue {
    /// Every clip of the library.
    pub(crate) fn clips(&mut self) -> Vec<ClipInfo> {
        self.session.make_all();
        self.session.clip_infos()
    }

    /// Every parameter's value by its key.
    pub(crate) fn params(&self) -> Map<String, Json> {
        let params = self.session.params();
        PARAMS
            .iter()
            .map(|param| (param.name.to_owned(), param.to_json(params.get(param.key))))
            .collect()
    }

    /// Sets parameters, all or none.
    pub(crate) fn set(&mut self, values: &Map<String, Json>) -> Result<(), String> {
        let checked = values
            .iter()
            .map(|(name, json)| self.checked(name, json))
            .collect::<Result<Vec<_>, String>>()?;
        self.apply(Command::Set(checked)).map_err(|error| error.to_string())?;
        self.apply(Command::Settle).map_err(|error| error.to_string())
    }

    fn checked(&self, name: &str, json: &Json) -> Result<(Key, Value), String> {
        let key = Key::from_name(name)
            .ok_or_else(|| format!("`{name}` is not a parameter; keys() lists them"))?;
        let mut value = key.param().from_json(json).map_err(|error| error.to_string())?;
        if let (Kind::Clip, Value::Text(id)) = (key.param().kind, &value) {
            let known = self.session.nameable(id);
            value = Value::Text(
                known.ok_or_else(|| format!("{name}: {}", CommandError::NoClip(id.clone())))?,
            );
        }
        if let (Key::Clips, Value::List(List::ClipIds(ids))) = (key, &value) {
            check_graph_clips(ids).map_err(|reason| format!("{name}: {reason}"))?;
        }
        Ok((key, value))
    }

    pub(super) fn loaded_clips(&mut self, loaded: &LoadedFile) -> LoadedClips {
        let clips = self.clips().into_iter().filter(|clip| loaded.ids.contains(&clip.id)).collect();
        let warnings = loaded.warnings.iter().map(ToString::to_string).collect();
        LoadedClips { clips, warnings }
    }

    /// Has a file read elsewhere, exactly as if it were dropped on the page, and keeps what comes
    /// of it. Returns the task's number.
    pub(crate) fn load_elsewhere(&mut self, name: &str, file: FileBytes) -> u64 {
        self.pump();
        let task = match file {
            FileBytes::Large(file) => self.begin_reading(name, file),
            FileBytes::Here(bytes) => {
                let size = bytes.len() as u64;
                self.session.begin_reading(name, Content::Here(bytes), size)
            }
        };
        self.read.insert(task, None);
        task
    }

    /// Whether clips are still to come: from storage, over the network, or out of a file that is
    /// being read.
    pub(crate) fn is_loading(&mut self) -> bool {
        self.awaits_work()
            || !self.downloads.is_empty()
            || !self.session.awaited_samples().is_empty()
            || self.session.is_reading_any()
    }

    /// Whether that file is still being read.
    pub(crate) fn is_reading(&self, task: u64) -> bool {
        self.session.is_reading(task)
    }

    /// Stops what is under way: the file of that name that is read or fetched, a lesson's too.
    pub(crate) fn stop(&mut self, name: &str) -> Result<(), String> {
        let name = outside::file_name(name);
        let reading = self
            .session
            .jobs()
            .into_iter()
            .find(|job| job.kind.name() == name && job.task.is_some());
        if let Some(task) = reading.and_then(|job| job.task) {
            self.obey(Command::File(FileCommand::StopReading(task)));
        } else if self.downloads.under_way().any(|(fetched, _)| fetched == name)
            || self.downloads.lessons_under_way().any(|lesson| lesson == name)
        {
            self.stop_fetching(&name);
        } else {
            return Err(format!(
                "stop: found `{name}`, expected the name of a file that is under way"
            ));
        }
        Ok(())
    }

    /// What [`Self::load_elsewhere`] gave; `None` when it was stopped.
    pub(crate) fn read_result(&mut self, task: u64) -> Option<Result<LoadedClips, String>> {
        self.read.remove(&task).flatten()
    }

    /// The link that restores this state.
    pub(crate) fn url(&self) -> String {
        platform::full_link(&link_query(&self.session))
    }

    /// What is shown, in Markdown. `picture` is an address, such as one that is the picture itself.
    pub(crate) fn report(&self, picture: Option<&str>) -> Result<String, String> {
        let facts = ReportFacts { link: &self.url(), picture, backend: self.window.backend };
        report(&self.session, &facts).map_err(|reason| reason.to_string())
    }

    /// Plays or pauses.
    pub(crate) fn play(&mut self, on: bool) -> Result<(), String> {
        if self.session.params().is_on(Key::Play) == on {
            return Ok(());
        }
        self.apply(Command::Playback(PlaybackCommand::TogglePlay))
            .map_err(|error| error.to_string())
    }

    /// Moves the playhead.
    pub(crate) fn seek(&mut self, secs: f64) -> Result<(), String> {
        if !secs.is_finite() {
            return Err(format!("seek: found {secs}, expected seconds"));
        }
        self.apply(Command::Playback(PlaybackCommand::Seek(secs)))
            .map_err(|error| error.to_string())
    }

    /// The playhead, seconds.
    pub(crate) fn time(&self) -> f64 {
        self.session.now_secs()
    }

    /// What a clip's id, `result`, or `result:1` (the second pane) names.
    fn subject(&self, which: &str) -> Result<Subject<'_>, String> {
        let panes = self.session.panes();
        let Some(index) = pane_number(which) else {
            let entry = self.session.library().find(which);
            let entry =
                entry.ok_or_else(|| format!("found `{which}`, expected the id of a clip, `result`, or `result:1` for the second pane"))?;
            let motion = entry.motion.as_ref();
            return motion.map(Subject::Clip).ok_or_else(|| {
                format!("`{}` is not loaded yet; put it into a or b first", entry.id)
            });
        };
        let pane = panes.get(index).ok_or_else(|| {
            format!(
                "found `{which}`, expected a pane from `result:0` to `result:{}`",
                panes.len() - 1
            )
        })?;
        pane.result().map(|made| Subject::Result(pane, made)).map_err(|reason| reason.to_string())
    }

    /// Puts a result into the library. Returns the id of the new clip.
    pub(crate) fn keep(&mut self, which: &str) -> Result<String, String> {
        let pane = pane_number(which).ok_or_else(|| {
            format!("found `{which}`, expected `result`, or `result:1` for the second pane")
        })?;
        self.apply(Command::Keep(pane)).map_err(|error| error.to_string())?;
        let kept = self.session.library().entries().last();
        Ok(kept.map(|entry| entry.id.clone()).unwrap_or_default())
    }

    /// The motion of [`Self::subject`].
    fn motion(&self, which: &str) -> Result<Arc<Motion>, String> {
        Ok(match self.subject(which)? {
            Subject::Clip(motion) => Arc::clone(motion),
            Subject::Result(_, made) => Arc::clone(&made.outcome.motion),
        })
    }

    /// A pose in the world.
    pub(crate) fn pose(&self, which: &str, secs: f64) -> Result<PoseInfo, String> {
        if !secs.is_finite() {
            return Err(format!("pose: found {secs}, expected seconds"));
        }
        let motion = self.motion(which)?;
        let world = pose_at(&motion, secs, &Planar::IDENTITY).ok_or("the clip has no frames")?;
        let frame = frame_at(&motion, secs);
        let joints = motion.clip().skeleton().joints();
        Ok(PoseInfo {
            joints: joints.iter().map(|joint| joint.name.clone()).collect(),
            parents: joints
                .iter()
                .map(|joint| joint.parent.map_or(-1, |parent| parent as i64))
                .collect(),
            positions: world.positions.iter().flat_map(Vec3::to_array).collect(),
            rotations: world.rotations.iter().flat_map(Quat::to_array).collect(),
            contacts: [Side::Left, Side::Right].map(|side| motion.contacts().planted(side, frame)),
        })
    }

    /// The artefacts of the results, by name.
    pub(crate) fn metrics(&self) -> Result<BTreeMap<&'static str, MetricInfo>, String> {
        let panes = self.session.panes();
        let of_pane = |pane: &Pane, id| pane.result().ok()?.outcome.metric(id)?.value;
        let main = self.session.first_result().map_err(|reason| reason.to_string())?;
        let info = |id: MetricId| {
            let row = id.row();
            let info = MetricInfo {
                label: row.label,
                value: panes.first().and_then(|pane| of_pane(pane, id)),
                unit: row.unit.text(),
                panes: panes.iter().map(|pane| of_pane(pane, id)).collect(),
                better: row.better.name(),
                help: row.help,
            };
            (row.name, info)
        };
        Ok(main.outcome.metrics.iter().map(|metric| info(metric.id)).collect())
    }

    /// A motion as a file of that format. `which` as in [`Self::pose`]; `body` says whose body a
    /// GLB file has, the character's on the stage where `None`.
    pub(crate) fn export(
        &self,
        which: &str,
        format: &str,
        body: Option<&str>,
    ) -> Result<ExportedFile, String> {
        let format = ExportFormat::from_name(format).ok_or_else(|| {
            let names = ExportFormat::ALL.map(ExportFormat::name).join(", ");
            format!("found `{format}`, expected one of {names}")
        })?;
        let body = body.map_or(Ok(ExportBody::default()), |body| {
            let names = ExportBody::ALL.map(ExportBody::name).join(", ");
            ExportBody::from_name(body)
                .ok_or_else(|| format!("found `{body}`, expected one of {names}"))
        })?;
        self.export_as(which, &ExportOptions { format, body, ..ExportOptions::default() })
    }

    /// A motion as a file, in the way that a person wants it.
    pub(crate) fn export_as(
        &self,
        which: &str,
        how: &ExportOptions,
    ) -> Result<ExportedFile, String> {
        let params = self.session.params();
        let (motion, curves, stem) = match self.subject(which)? {
            Subject::Clip(motion) => {
                (motion, plotted_of_clip(motion, params), motion.clip().name().to_owned())
            }
            Subject::Result(pane, made) => {
                let value = pane.variant.as_ref().map(|(key, value)| {
                    let param = key.param();
                    format!(" {} {}", param.format(value), param.unit)
                });
                let stem = file_stem(made.params) + &value.unwrap_or_default();
                (&made.outcome.motion, plotted_of_result(made.outcome, params), stem)
            }
        };
        Ok(ExportedFile {
            name: file_name(&stem, how.format.name()),
            mime: how.format.mime(),
            bytes: export(motion, self.session.character().as_ref(), &curves, how)
                .map_err(|error| error.to_string())?,
        })
    }

    /// What a picture or a film of the stage is called as a file: what is seen.
    pub(super) fn stage_name(&self) -> String {
        let seen = self.session.panes().first().and_then(Pane::made_from);
        file_stem(seen.unwrap_or(self.session.params()))
    }

    /// What is under way.
    fn jobs(&self) -> Vec<JobInfo> {
        let computed = self
            .session
            .jobs()
            .into_iter()
            .map(|job| (job.kind.name().to_owned(), Some(job.progress)));
        let samples =
            self.session.awaited_samples().iter().map(|sample| (sample.id.to_owned(), None));
        let lessons = self.downloads.lessons_under_way().map(|name| (name, None));
        computed
            .chain(self.downloads.under_way())
            .chain(lessons)
            .chain(samples)
            .map(|(name, progress)| JobInfo { name, progress })
            .collect()
    }

    /// How the app is doing.
    pub(crate) fn stats(&self, wasm_bytes: u64) -> Stats {
        Stats {
            backend: self.window.backend,
            frames: self.frames.count(),
            frame_ms: self.frames.times(),
            draw_ms: self.frames.whole_times(),
            jobs: self.jobs(),
            wasm_bytes,
        }
    }

    /// How many frames were drawn since the start.
    pub(crate) fn frames_drawn(&self) -> u64 {
        self.frames.count()
    }

    /// Returns whether the link at the start said that the page is embedded: only then may the page
    /// around this one drive it, and nothing is stored.
    pub(crate) fn is_embedded(&self) -> bool {
        self.embedded
    }

    /// Where the stage is on the page, in points; none before it was drawn.
    pub(crate) fn stage_place(&self) -> Option<eframe::egui::Rect> {
        self.picture.place()
    }
}

/// The pane that `result` or `result:1` means, from 0; `None` for the id of a clip.
fn pane_number(which: &str) -> Option<usize> {
    match which.strip_prefix("result")? {
        "" => Some(0),
        rest => rest.strip_prefix(':').map(|index| index.parse::<usize>().unwrap_or(usize::MAX)),
    }
}
