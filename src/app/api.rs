//! The calls of the page's API and their answers as plain data. `docs/api.md` documents them.

mod answers;
mod error;
#[cfg(test)]
mod tests;

pub(crate) use answers::{ExportedFile, KeyInfo, LoadedClips, MetricInfo, PoseInfo, Stats};
pub(crate) use error::ApiError;

use super::Segue;
use super::{link_query, link_query_for_others};
use crate::platform::{self, FileBytes};
use answers::JobInfo;
use eframe::wgpu::Backend;
use glam::{Quat, Vec3};
use segue_motion::clip::Motion;
use segue_motion::math::Planar;
use segue_scene::pose_at;
use segue_session::bone_map::BoneMap;
use segue_session::export::{
    Column, ExportBody, ExportFormat, ExportOptions, ExportRoot, export, file_name,
    plotted_of_clip, plotted_of_result,
};
use segue_session::metrics::MetricId;
use segue_session::outside;
use segue_session::packed;
use segue_session::reading::Content;
use segue_session::{
    ClipInfo, Command, CommandError, FileCommand, Key, Kind, LabError, LabId, List, LoadedFile,
    NoResult, PARAMS, Pane, PaneResult, Param, PlaybackCommand, ReportFacts, Selected as _, Value,
    check_graph_clips, file_stem, frame_at, report,
};
use serde_json::{Map, Value as Json};
use std::collections::BTreeMap;
use std::sync::Arc;

/// The name of the job of many files that are read, by which they are stopped together.
const FILES: &str = "files";

/// The longest time for which `loaded()` waits for the stored work, milliseconds.
const MAX_LATE_MS: f64 = 30_000.0;

/// A motion that a call of the API names.
enum Subject<'a> {
    /// A clip of the library.
    Clip(&'a Arc<Motion>),
    /// The result of a pane.
    Result(&'a Pane, PaneResult<'a>),
}

/// The options of an export as a caller of the API writes them; `None` where it says nothing.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct ExportWords {
    /// The name of the body in a GLB file; that of the character on the stage without it.
    pub(crate) body: Option<String>,
    /// The name of the joint that has the motion over the ground; as in the source file without it.
    pub(crate) root: Option<String>,
    /// Frames per second; the clip's own without it.
    pub(crate) fps: Option<f64>,
}

impl ExportWords {
    /// Returns them as options of a format, by its name.
    pub(crate) fn options(&self, format: &str) -> Result<ExportOptions, ApiError> {
        let format = ExportFormat::from_name(format)
            .ok_or_else(|| ApiError::UnknownFormat(format.to_owned()))?;
        let body = self.body.as_deref().map_or(Ok(ExportBody::default()), |body| {
            ExportBody::from_name(body).ok_or_else(|| ApiError::UnknownBody(body.to_owned()))
        })?;
        let root = self.root.as_deref().map_or(Ok(ExportRoot::default()), |root| {
            ExportRoot::from_name(root).ok_or_else(|| ApiError::UnknownRoot(root.to_owned()))
        })?;
        match self.fps {
            Some(fps) if !(1.0..=1000.0).contains(&fps) => Err(ApiError::UnfitRate(fps)),
            fps => Ok(ExportOptions { format, body, root, fps, ..ExportOptions::default() }),
        }
    }
}

/// Returns the name of a graphics backend in the API.
pub(crate) fn backend_name(backend: Backend) -> &'static str {
    match backend {
        Backend::BrowserWebGpu => "webgpu",
        Backend::Gl if cfg!(target_family = "wasm") => "webgl2",
        other => other.to_str(),
    }
}

/// Returns every row of the table of parameters.
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
            labs: LabId::ALL
                .iter()
                .filter(|lab| param.is_used_by(**lab))
                .map(|lab| lab.word())
                .collect(),
            help: param.help,
        }
    };
    PARAMS.iter().map(row).collect()
}

impl Segue {
    /// Returns every clip of the library.
    pub(crate) fn clips(&mut self) -> Vec<ClipInfo> {
        self.session.make_all();
        self.session.clip_infos()
    }

    /// Returns every parameter's value by its key.
    pub(crate) fn params(&self) -> Map<String, Json> {
        let params = self.session.params();
        PARAMS
            .iter()
            .map(|param| (param.name.to_owned(), param.to_json(params.get(param.key))))
            .collect()
    }

    /// Begins or ends several changes that are one step of undo.
    #[cfg(target_arch = "wasm32")]
    pub(crate) fn join_steps(&mut self, begins: bool) {
        self.session.join_steps(begins);
    }

    /// Sets parameters, all or none.
    pub(crate) fn set(&mut self, values: &Map<String, Json>) -> Result<(), ApiError> {
        let checked = values
            .iter()
            .map(|(name, json)| self.checked_value(name, json))
            .collect::<Result<Vec<_>, ApiError>>()?;
        self.apply(Command::Set(checked))?;
        Ok(self.apply(Command::Settle)?)
    }

    /// Returns a parameter and its value, checked as far as the session's commands do not.
    fn checked_value(&self, name: &str, json: &Json) -> Result<(Key, Value), ApiError> {
        let key = Key::from_name(name).ok_or_else(|| ApiError::UnknownKey(name.to_owned()))?;
        let param = key.param();
        let mut value = param.from_json(json)?;
        if let (Kind::Clip, Value::Text(id)) = (param.kind, &value) {
            let known = self.session.nameable(id);
            value = Value::Text(known.ok_or_else(|| ApiError::NoClip {
                key: param.name,
                error: CommandError::NoClip(id.clone()),
            })?);
        }
        if let (Key::Clips, Value::List(List::ClipIds(ids))) = (key, &value) {
            check_graph_clips(ids)
                .map_err(|error| ApiError::GraphClips { key: param.name, error })?;
        }
        Ok((key, value))
    }

    /// Returns the answer of `load()` for a file that was read.
    pub(super) fn loaded_clips(&mut self, loaded: &LoadedFile) -> LoadedClips {
        let clips = self.clips().into_iter().filter(|clip| loaded.ids.contains(&clip.id)).collect();
        let warnings = loaded.warnings.iter().map(ToString::to_string).collect();
        LoadedClips { clips, warnings }
    }

    /// Starts to read a file in the background, exactly as if it were dropped on the page. Returns
    /// the task's number, by which [`Self::read_result`] has the result.
    pub(crate) fn load_in_background(&mut self, name: &str, file: FileBytes) -> u64 {
        self.poll();
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

    /// Returns whether clips are still to come: from storage, over the network, or out of a file
    /// that is being read.
    pub(crate) fn is_loading(&mut self) -> bool {
        self.is_restoring()
            || self.is_storage_late()
            || !self.inbox.is_empty()
            || !self.downloads.is_empty()
            || !self.session.awaited_samples().is_empty()
            || self.session.is_reading_any()
    }

    /// Returns whether the stored work is still expected.
    fn is_storage_late(&self) -> bool {
        self.autosave.late_ms(platform::now_ms()).is_some()
    }

    /// Checks that the stored work has not been expected for too long.
    pub(crate) fn check_storage(&self) -> Result<(), ApiError> {
        match self.autosave.late_ms(platform::now_ms()) {
            Some(late_ms) if late_ms > MAX_LATE_MS => Err(ApiError::StorageLate),
            _ => Ok(()),
        }
    }

    /// Has the motion of a clip read that is not in memory. Returns whether it has to be waited
    /// for.
    pub(crate) fn read_clip(&mut self, which: &str) -> bool {
        let entry = self.session.library().find(which).filter(|_| pane_number(which).is_none());
        let Some(id) = entry.filter(|entry| entry.motion.is_none()).map(|entry| entry.id.clone())
        else {
            return false;
        };
        // A notice says why a file cannot be read; the call then finds no motion.
        self.dispatch(Command::File(FileCommand::Read(id)));
        self.poll();
        self.is_reading_clip(which)
    }

    /// Returns whether the motion of a clip is still being read.
    pub(crate) fn is_reading_clip(&self, which: &str) -> bool {
        self.session.is_reading_clip(which)
    }

    /// Returns whether a result waits for the motion of a clip that is being read.
    pub(crate) fn awaits_clips(&self) -> bool {
        let waits = |pane: &Pane| matches!(pane.problem, Some(LabError::Reading { .. }));
        self.session.panes().iter().any(waits)
    }

    /// Returns whether a task is still reading its file.
    pub(crate) fn is_reading(&self, task: u64) -> bool {
        self.session.is_reading(task)
    }

    /// Stops reading, fetching or writing the file of that name, which may be a lesson's.
    pub(crate) fn stop(&mut self, name: &str) -> Result<(), ApiError> {
        let name = outside::file_name(name);
        if self.stop_exports(&name) {
            return Ok(());
        }
        if let Some(task) = self.session.task_of(&name) {
            self.dispatch(Command::File(FileCommand::StopReading(task)));
        } else if name == FILES && self.session.is_reading_new() {
            self.dispatch(Command::File(FileCommand::StopReadingNew));
        } else if self.downloads.under_way().any(|(fetched, _)| fetched == name)
            || self.downloads.lessons_under_way().any(|lesson| lesson == name)
        {
            self.stop_fetching(&name);
        } else {
            return Err(ApiError::NotUnderWay(name));
        }
        Ok(())
    }

    /// Takes out the result of a task of [`Self::load_in_background`]; `None` when it was stopped.
    pub(crate) fn read_result(&mut self, task: u64) -> Option<Result<LoadedClips, ApiError>> {
        self.read.remove(&task).flatten()
    }

    /// Returns the link that restores this state.
    pub(crate) fn url(&self) -> String {
        platform::full_link(&link_query(&self.session))
    }

    /// Returns the link that shows this state to others, in their own type size and language.
    pub(crate) fn url_for_others(&self) -> String {
        platform::full_link(&link_query_for_others(&self.session))
    }

    /// Returns a report of the results in Markdown. `picture` is the address of a picture, which
    /// may be a `data:` URL.
    pub(crate) fn report(&self, picture: Option<&str>) -> Result<String, NoResult> {
        let facts = ReportFacts { link: &self.url(), picture, backend: self.window.backend };
        report(&self.session, &facts)
    }

    /// Plays or pauses.
    pub(crate) fn play(&mut self, on: bool) -> Result<(), ApiError> {
        if self.session.params().is_on(Key::Play) == on {
            return Ok(());
        }
        Ok(self.apply(Command::Playback(PlaybackCommand::TogglePlay))?)
    }

    /// Moves the playhead.
    pub(crate) fn seek(&mut self, secs: f64) -> Result<(), ApiError> {
        if !secs.is_finite() {
            return Err(ApiError::NotSeconds { call: "seek", secs });
        }
        Ok(self.apply(Command::Playback(PlaybackCommand::Seek(secs)))?)
    }

    /// Returns the position of the playhead, seconds.
    pub(crate) fn time(&self) -> f64 {
        self.session.now_secs()
    }

    /// Returns the motion of a clip's id, `result`, or `result:1` (the second pane).
    fn subject(&self, which: &str) -> Result<Subject<'_>, ApiError> {
        let panes = self.session.panes();
        let Some(index) = pane_number(which) else {
            let entry = self.session.library().find(which);
            let entry = entry.ok_or_else(|| ApiError::UnknownMotion(which.to_owned()))?;
            let motion = entry.motion.as_ref();
            return motion.map(Subject::Clip).ok_or_else(|| ApiError::NotLoaded(entry.id.clone()));
        };
        let pane = panes.get(index).ok_or_else(|| ApiError::UnknownPane {
            found: which.to_owned(),
            last: panes.len() - 1,
        })?;
        Ok(Subject::Result(pane, pane.result()?))
    }

    /// Puts a result into the library. Returns the id of the new clip.
    pub(crate) fn keep(&mut self, which: &str) -> Result<String, ApiError> {
        let pane = pane_number(which).ok_or_else(|| ApiError::NotAResult(which.to_owned()))?;
        self.apply(Command::Keep(pane))?;
        let kept = self.session.library().entries().last();
        Ok(kept.map(|entry| entry.id.clone()).unwrap_or_default())
    }

    /// Returns a shared handle of a motion; `which` as in [`Self::subject`].
    fn motion(&self, which: &str) -> Result<Arc<Motion>, ApiError> {
        Ok(match self.subject(which)? {
            Subject::Clip(motion) => Arc::clone(motion),
            Subject::Result(_, made) => Arc::clone(&made.outcome.motion),
        })
    }

    /// Returns a pose in the world; `which` is a clip's id, `result`, or `result:1` for the second
    /// pane.
    pub(crate) fn pose(&self, which: &str, secs: f64) -> Result<PoseInfo, ApiError> {
        if !secs.is_finite() {
            return Err(ApiError::NotSeconds { call: "pose", secs });
        }
        let motion = self.motion(which)?;
        let world = pose_at(&motion, secs, &Planar::IDENTITY).ok_or(ApiError::NoFrames)?;
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
            contacts: (motion.contacts().feet().iter())
                .map(|&foot| motion.contacts().planted(foot, frame))
                .collect(),
        })
    }

    /// Returns the metrics of the results by their names.
    pub(crate) fn metrics(&self) -> Result<BTreeMap<&'static str, MetricInfo>, NoResult> {
        let panes = self.session.panes();
        let of_pane = |pane: &Pane, id| pane.result().ok()?.outcome.metric(id);
        let value_of = |pane: &Pane, id| of_pane(pane, id)?.value;
        let main = self.session.first_result()?;
        let info = |id: MetricId| {
            let row = id.row();
            let info = MetricInfo {
                label: row.label,
                value: panes.first().and_then(|pane| value_of(pane, id)),
                unit: row.unit.text(),
                panes: panes.iter().map(|pane| value_of(pane, id)).collect(),
                at: panes.iter().map(|pane| of_pane(pane, id)?.at_secs).collect(),
                better: row.better.name(),
                help: row.help,
            };
            (row.name, info)
        };
        Ok(main.outcome.metrics.iter().map(|metric| info(metric.id)).collect())
    }

    /// Returns the bone map of a motion as JSON. `which` is as in [`Self::pose`].
    pub(crate) fn bone_map(&self, which: &str) -> Result<String, ApiError> {
        let motion = self.motion(which)?;
        Ok(BoneMap::of(motion.clip().skeleton(), motion.roles()).to_json())
    }

    /// Applies a bone map, the JSON of its file, to all clips that it fits.
    pub(crate) fn set_bone_map(&mut self, json: &str) -> Result<(), ApiError> {
        let map = BoneMap::from_json(json.as_bytes()).map_err(CommandError::from)?;
        Ok(self.apply(Command::File(FileCommand::ApplyBoneMap(map)))?)
    }

    /// Returns a motion as a file. `which` is as in [`Self::pose`].
    pub(crate) fn export_as(
        &self,
        which: &str,
        how: &ExportOptions,
    ) -> Result<ExportedFile, ApiError> {
        let (motion, curves, stem) = self.exported(which, how)?;
        Ok(ExportedFile {
            name: file_name(&stem, how.format.ending()),
            mime: how.format.mime(),
            bytes: export(motion, self.session.character().as_ref(), &curves, how)?,
        })
    }

    /// Returns the file name of an export that takes long, and the size and bytes of the export,
    /// packed for a worker; `None` for one that is made at once.
    pub(super) fn long_export(
        &self,
        which: &str,
        how: &ExportOptions,
    ) -> Result<Option<(String, usize, FileBytes)>, ApiError> {
        let (motion, curves, stem) = self.exported(which, how)?;
        if !packed::takes_long(motion) {
            return Ok(None);
        }
        let packed = packed::pack(motion, self.session.character().as_ref(), &curves, how).ok();
        Ok(packed.map(|packed| {
            let name = file_name(&stem, how.format.ending());
            (name, packed.size(), platform::packed_file(&packed))
        }))
    }

    /// Returns a motion, its plotted curves where the format has them, and the stem of its file's
    /// name. `which` is as in [`Self::pose`].
    fn exported(
        &self,
        which: &str,
        how: &ExportOptions,
    ) -> Result<(&Motion, Vec<Column>, String), ApiError> {
        let params = self.session.params();
        let has_curves = how.format == ExportFormat::Csv;
        let (motion, curves, stem): (&Motion, _, _) = match self.subject(which)? {
            Subject::Clip(motion) => {
                let curves = has_curves.then(|| plotted_of_clip(motion, params));
                (motion, curves, motion.clip().name().to_owned())
            }
            Subject::Result(pane, made) => {
                let value = pane.variant.as_ref().map(|(key, value)| {
                    let param = key.param();
                    format!(" {} {}", param.format(value), param.unit)
                });
                let stem = file_stem(made.params) + &value.unwrap_or_default();
                let curves = has_curves.then(|| plotted_of_result(made.outcome, params));
                (&made.outcome.motion, curves, stem)
            }
        };
        Ok((motion, curves.unwrap_or_default(), stem))
    }

    /// Returns the stem of the file name of a picture or a film of the stage.
    pub(super) fn stage_name(&self) -> String {
        let shown = self.session.panes().first().and_then(Pane::made_from);
        file_stem(shown.unwrap_or(self.session.params()))
    }

    /// Returns everything that is under way: computations, files, lessons and bundled takes.
    fn jobs(&self) -> Vec<JobInfo> {
        let computed = self
            .session
            .jobs()
            .into_iter()
            .map(|job| (job.kind.name().to_owned(), Some(job.progress)));
        let samples =
            self.session.awaited_samples().iter().map(|sample| (sample.id.to_owned(), None));
        let lessons = self.downloads.lessons_under_way().map(|name| (name, None));
        let written = self.exports.under_way().map(|name| (name.to_owned(), None));
        computed
            .chain(self.downloads.under_way())
            .chain(written)
            .chain(lessons)
            .chain(samples)
            .map(|(name, progress)| JobInfo { name, progress })
            .collect()
    }

    /// Returns statistics of the app.
    pub(crate) fn stats(&self, wasm_bytes: u64) -> Stats {
        Stats {
            backend: self.window.backend,
            frames: self.frame_stats.count(),
            frame_ms: self.frame_stats.update_times(),
            draw_ms: self.frame_stats.total_times(),
            jobs: self.jobs(),
            wasm_bytes,
            workers: self.pool.stats(),
        }
    }

    /// Returns the number of frames drawn since the start.
    pub(crate) fn frames_drawn(&self) -> u64 {
        self.frame_stats.count()
    }

    /// Returns whether the link at the start says that the page is embedded. Only then may the page
    /// around this one drive it, and nothing is stored.
    pub(crate) fn is_embedded(&self) -> bool {
        self.embedded
    }

    /// Returns the stage's rectangle on the page, in points; `None` before it was drawn.
    pub(crate) fn stage_rect(&self) -> Option<eframe::egui::Rect> {
        self.picture.stage_rect()
    }
}

/// Returns the index of the pane that `result` or `result:1` names, from 0; `None` for the id of a
/// clip.
fn pane_number(which: &str) -> Option<usize> {
    match which.strip_prefix("result")? {
        "" => Some(0),
        rest => rest.strip_prefix(':').map(|index| index.parse::<usize>().unwrap_or(usize::MAX)),
    }
}
