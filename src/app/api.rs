//! The page's own API, as far as it is plain data: what it is asked, and what it answers.
//! `docs/api.md` documents it.

use super::Segue;
use super::frames::FrameTimes;
use super::link_query;
use crate::platform::{self, FileBytes};
use eframe::wgpu::Backend;
use glam::{Quat, Vec3};
use segue_motion::clip::Motion;
use segue_motion::math::Planar;
use segue_motion::metrics::{Better, Metric};
use segue_motion::skeleton::Side;
use segue_scene::pose_at;
use segue_session::export::{
    ExportBody, ExportFormat, ExportOptions, export, file_name, plotted_of_clip, plotted_of_result,
};
use segue_session::outside;
use segue_session::reading::Content;
use segue_session::{
    ClipInfo, Command, CommandError, FileCommand, Key, Kind, List, Loaded, Made, PARAMS, Pane,
    Param, PlaybackCommand, ReportFacts, Value, check_graph_clips, file_stem, frame_at, report,
};
use serde::Serialize;
use serde_json::{Map, Value as Json};
use std::collections::BTreeMap;
use std::sync::Arc;

/// A row of `keys()`.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(crate) struct KeyInfo {
    key: &'static str,
    label: &'static str,
    #[serde(rename = "type")]
    kind: &'static str,
    min: Option<f64>,
    max: Option<f64>,
    step: Option<f64>,
    /// Whether the value may be `"auto"`.
    auto: bool,
    /// The words that a choice takes.
    choices: Vec<&'static str>,
    default: Json,
    unit: &'static str,
    lab: &'static str,
    help: &'static str,
}

/// What `load()` resolves with.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(crate) struct LoadedClips {
    clips: Vec<ClipInfo>,
    warnings: Vec<String>,
}

impl LoadedClips {
    /// The SHA-256 of the files that the clips came from.
    #[cfg(target_arch = "wasm32")]
    pub(crate) fn files(&self) -> Vec<String> {
        self.clips.iter().filter_map(|clip| clip.sha256.clone()).collect()
    }
}

/// What `pose()` answers.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(crate) struct PoseInfo {
    /// The joints' names.
    joints: Vec<String>,
    /// The index of every joint's parent; -1 for a root.
    parents: Vec<i64>,
    /// World positions in metres: x, y, z of the first joint, then of the next.
    positions: Vec<f32>,
    /// World rotations: x, y, z, w of the first joint, then of the next.
    rotations: Vec<f32>,
    /// Whether the left and the right foot is planted.
    contacts: [bool; 2],
}

/// One number of `metrics()`.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(crate) struct MetricInfo {
    label: &'static str,
    /// The number of the first pane; `null` where it cannot be told.
    value: Option<f64>,
    unit: &'static str,
    /// The numbers of all panes, left to right.
    panes: Vec<Option<f64>>,
    /// `lower`, `higher`, or `neutral` where neither is better.
    better: &'static str,
    help: &'static str,
}

/// Something that is under way.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(crate) struct JobInfo {
    name: String,
    /// 0 to 1; `null` where it cannot be told.
    progress: Option<f64>,
}

/// What `stats()` answers, but for what only the page knows.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(crate) struct Stats {
    backend: &'static str,
    frames: u64,
    /// Input, panels and scene.
    frame_ms: FrameTimes,
    /// The same with the commands for the graphics device.
    draw_ms: FrameTimes,
    jobs: Vec<JobInfo>,
    wasm_bytes: u64,
}

/// What the API asks a motion of.
enum Subject<'a> {
    /// A clip of the library.
    Clip(&'a Arc<Motion>),
    /// The result of a pane.
    Result(&'a Pane, Made<'a>),
}

/// A file to hand to the user.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct ExportedFile {
    /// A name for it.
    pub(crate) name: String,
    /// What it is.
    pub(crate) mime: &'static str,
    /// Its bytes.
    pub(crate) bytes: Vec<u8>,
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

    pub(super) fn loaded_clips(&mut self, loaded: &Loaded) -> LoadedClips {
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
        let of_pane = |pane: &Pane, id| {
            let metrics = &pane.result().ok()?.outcome.metrics;
            metrics.iter().find(|metric| metric.id == id).and_then(|metric| metric.value)
        };
        let main = self.session.first_result().map_err(|reason| reason.to_string())?;
        let info = |metric: &Metric| MetricInfo {
            label: metric.label,
            value: panes.first().and_then(|pane| of_pane(pane, metric.id)),
            unit: metric.unit,
            panes: panes.iter().map(|pane| of_pane(pane, metric.id)).collect(),
            better: match metric.better {
                Better::Lower => "lower",
                Better::Higher => "higher",
                Better::Neutral => "neutral",
            },
            help: metric.help,
        };
        Ok(main.outcome.metrics.iter().map(|metric| (metric.id, info(metric))).collect())
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::platform::{Inbox, Storage};
    use segue_text::ToMessage;
    use serde_json::json;

    fn open(link: &str) -> Segue {
        let mut segue = Segue::new(Inbox::default(), None, link.to_owned());
        while segue.pump() || segue.is_busy() {}
        segue
    }

    /// As the page's `load` does.
    fn load(segue: &mut Segue, name: &str, bytes: &[u8]) -> Result<LoadedClips, String> {
        let task = segue.load_elsewhere(name, FileBytes::Here(Arc::from(bytes)));
        while segue.is_reading(task) {
            segue.pump();
        }
        segue.read_result(task).expect("nobody stopped it")
    }

    fn object(json: Json) -> Map<String, Json> {
        if let Json::Object(map) = json { map } else { panic!("{json} is no object") }
    }

    #[test]
    fn a_bundled_take_can_be_named_before_it_is_in_the_library() {
        let mut segue = open("lab=view&play=off");
        segue.set(&object(json!({ "a": "cmu_jump" }))).unwrap();
        assert_eq!(segue.params()["a"], json!("cmu_jump"));
        assert!(segue.clips().iter().any(|clip| clip.id == "cmu_jump"));
    }

    #[test]
    fn values_are_set_all_or_none_and_what_is_wrong_is_named() {
        let mut segue = open("lab=blend");
        segue
            .set(&object(
                json!({ "blend_window": 24, "align": false, "weight_law": "linear", "leave_a": "auto" }),
            ))
            .unwrap();
        assert_eq!(segue.params()["blend_window"], json!(24.0));
        assert_eq!(segue.params()["align"], json!(false));
        let before = segue.url();
        for (values, part) in [
            (json!({ "blend_window": 12, "colour": "red" }), "`colour` is not a parameter"),
            (
                json!({ "align": true, "blend_window": 0 }),
                "blend_window: found 0, expected 1 to 240 frames",
            ),
            (json!({ "blend_window": null }), "blend_window: found `null`, expected a number"),
            (json!({ "a": "nobody" }), "a: there is no clip `nobody`"),
            (json!({ "blend_window": [1, 2] }), "blend_window: found `[1,2]`"),
        ] {
            let message = segue.set(&object(values)).unwrap_err();
            assert!(message.contains(part), "{message}");
            assert_eq!(segue.url(), before, "{message}");
        }
    }

    #[test]
    fn every_link_leads_back_even_that_of_the_defaults() {
        let mut segue = open("blend_window=24");
        assert_eq!(segue.url(), "?blend_window=24");
        segue.set(&object(json!({ "blend_window": 30 }))).unwrap();
        assert_eq!(segue.url(), "?lab=blend");
        assert_eq!(open("lab=blend").url(), segue.url());
    }

    #[test]
    fn keys_and_values_have_the_same_names() {
        let names: Vec<&str> = keys().iter().map(|key| key.key).collect();
        let segue = open("lab=blend");
        assert!(names.iter().all(|name| segue.params().contains_key(*name)));
        assert_eq!(names.len(), segue.params().len());
        let rows = serde_json::to_value(keys()).unwrap();
        let window =
            rows.as_array().unwrap().iter().find(|row| row["key"] == "blend_window").unwrap();
        assert_eq!(
            (&window["type"], &window["min"], &window["max"], &window["unit"], &window["lab"]),
            (&json!("integer"), &json!(1.0), &json!(240.0), &json!("frames"), &json!("blend"))
        );
    }

    #[test]
    fn a_pose_is_in_the_world_and_complete() {
        let segue = open("compare=blend_window:30,10");
        let pose = segue.pose("result:1", 0.5).unwrap();
        let joints = pose.joints.len();
        assert!(joints > 10);
        assert_eq!(
            (pose.parents.len(), pose.positions.len(), pose.rotations.len()),
            (joints, 3 * joints, 4 * joints)
        );
        assert_eq!(pose.parents[0], -1);
        // Bones keep their lengths: a child is as far from its parent as at the start.
        let start = segue.pose("result:1", 0.0).unwrap();
        let bone = |pose: &PoseInfo, joint: usize| {
            let place = |joint: usize| Vec3::from_slice(&pose.positions[3 * joint..]);
            place(joint).distance(place(pose.parents[joint] as usize))
        };
        for joint in 1..joints {
            assert!(
                (bone(&pose, joint) - bone(&start, joint)).abs() < 1e-4,
                "{}",
                pose.joints[joint]
            );
        }
        for which in ["result:2", "result:x", "resultant", "nobody"] {
            assert!(
                segue.pose(which, 0.0).unwrap_err().contains(&format!("found `{which}`")),
                "{which}"
            );
        }
    }

    #[test]
    fn metrics_have_a_number_for_every_pane() {
        let segue = open("compare=blend_window:30,15,10");
        let metrics = segue.metrics().unwrap();
        assert!(!metrics.is_empty());
        for (name, metric) in metrics {
            assert_eq!(metric.panes.len(), 3, "{name}");
            assert_eq!(metric.panes[0], metric.value, "{name}");
        }
    }

    #[test]
    fn what_cannot_be_made_is_refused_with_its_sentence_by_every_call() {
        for (good, bad, part) in [
            ("lab=speed", json!({ "a": "idle" }), "cycle"),
            ("lab=loop&loop_to=1.5", json!({ "loop_from": 1.5 }), "cycle"),
            ("lab=path&a=walk", json!({ "a": "idle" }), "stays within"),
            (
                "lab=match&match_clips=walk,run",
                json!({ "ahead_near": 1, "ahead_far": 0.5 }),
                "must rise",
            ),
        ] {
            let mut segue = open(good);
            let name = segue.stage_name();
            assert!(
                segue.metrics().is_ok()
                    && segue.export("result", "bvh", None).is_ok()
                    && segue.report(None).is_ok()
            );
            segue.set(&object(bad)).unwrap();
            while segue.pump() || segue.is_busy() {}
            let kept = segue.clips().len();
            let refused = [
                segue.pose("result", 0.0).map(drop),
                segue.metrics().map(drop),
                segue.export("result", "bvh", None).map(drop),
                segue.report(None).map(drop),
                segue.keep("result").map(drop),
            ];
            let problem = segue.session.panes()[0].problem.clone().unwrap();
            let sentence = problem.to_sentence().to_string();
            assert!(sentence.contains(part), "{good}: {sentence}");
            assert_eq!(refused, std::array::from_fn(|_| Err(sentence.clone())), "{good}");
            assert_eq!(segue.clips().len(), kept);
            assert!(segue.stage_name() != name || !good.contains("path"), "{name}");
        }
    }

    #[test]
    fn what_is_exported_can_be_loaded_again() {
        let mut segue = open("a=walk&lab=view");
        let file = segue.export("result", "bvh", None).unwrap();
        assert_eq!(file.name, "walk.bvh");
        let loaded = load(&mut segue, &file.name, &file.bytes).unwrap();
        assert_eq!(loaded.clips.len(), 1);
        assert_eq!(loaded.clips[0].frames, segue.motion("walk").unwrap().clip().frames());
        assert_eq!(
            segue.export("result", "fbx", None).unwrap_err(),
            "found `fbx`, expected one of bvh, csv, glb"
        );
        assert_eq!(
            segue.export("result", "glb", Some("statue")).unwrap_err(),
            "found `statue`, expected one of character, plain"
        );
        assert!(load(&mut segue, "x.bvh", b"HIERARCHY oops").unwrap_err().starts_with("x.bvh:1:"));
        assert_eq!(segue.clips().iter().filter(|clip| clip.sha256.is_some()).count(), 1);
    }

    #[test]
    fn every_clip_and_every_pane_is_exported_in_every_format() {
        let segue = open("compare=blend_window:30,10&joint=left%20foot");
        for (which, stem) in [
            ("walk", "Walk"),
            ("result", "walk to run 30 frames"),
            ("result:1", "walk to run 10 frames"),
        ] {
            for (format, mime) in
                [("bvh", "text/plain"), ("csv", "text/csv"), ("glb", "model/gltf-binary")]
            {
                let file = segue.export(which, format, None).unwrap();
                assert_eq!(
                    (file.name.to_lowercase(), file.mime),
                    (format!("{}.{format}", stem.to_lowercase()), mime)
                );
                assert!(file.bytes.len() > 1000);
            }
        }
        let table =
            String::from_utf8(segue.export("result:1", "csv", None).unwrap().bytes).unwrap();
        let header = table.lines().next().unwrap();
        assert!(header.ends_with(
            "left foot.speed_m_per_s,A left foot.speed_m_per_s,B left foot.speed_m_per_s"
        ));
        let frames = segue.motion("result:1").unwrap().clip().frames();
        assert_eq!(table.lines().count(), frames + 1);
    }

    #[test]
    fn more_clips_than_a_graph_takes_are_refused_with_the_sentence() {
        let mut segue = open("lab=graph&play=off");
        let before = segue.params();
        let many: Vec<String> = (0..65).map(|n| format!("clip{n}")).collect();
        let refused = segue.set(&object(json!({ "clips": many.join(",") }))).unwrap_err();
        assert_eq!(refused, "clips: These are 65 clips: take 64 at most.");
        assert_eq!(segue.params(), before);
    }

    #[test]
    fn time_of_a_pose_is_a_number() {
        let segue = open("lab=view&play=off");
        for secs in [f64::NAN, f64::INFINITY] {
            assert!(segue.pose("walk", secs).unwrap_err().contains("expected seconds"));
        }
    }

    /// However a link spells it, the page that answers the one around it is the page that stores
    /// nothing.
    #[test]
    fn embedded_page_in_any_spelling_has_no_storage() {
        for (link, embedded) in [
            ("embed=1", true),
            ("embed=on", true),
            ("embed=yes", true),
            ("embed=true", true),
            ("?embed=1", true),
            ("??embed=1", true),
            ("embed=%31", true),
            ("%65mbed=1", true),
            ("lab=view&embed=1", true),
            ("embed=1&embed=0", true),
            ("embed=0&embed=1", true),
            ("embed=1&embed=nonsense", true),
            ("embed=On", false),
            ("embed=ON", false),
            ("embed=1%20", false),
            ("embed=+1", false),
            ("embed=", false),
            ("embed", false),
            ("??embed", false),
            ("Embed=1", false),
            ("embed=0", false),
            ("embed%3D1", false),
            ("", false),
        ] {
            let segue = Segue::start_on(Inbox::default(), link.to_owned(), |_| {
                assert!(!embedded, "{link}: the storage is opened");
                Storage::default()
            });
            assert_eq!(segue.is_embedded(), embedded, "{link}");
        }
    }

    #[test]
    fn page_around_the_frame_is_told_of_once() {
        let mut segue = open("lab=view&play=off");
        let said = |segue: &Segue| {
            segue
                .session
                .notices()
                .list()
                .iter()
                .filter(|notice| notice.text.to_string() == crate::ui::HOST_READS)
                .count()
        };
        segue.tell_of_host();
        assert_eq!(said(&segue), 0, "there is none");
        segue.panels.host_reads = true;
        segue.tell_of_host();
        assert_eq!(said(&segue), 1);
        let id = segue.session.notices().list().last().unwrap().id;
        segue.apply(Command::Dismiss(id)).unwrap();
        segue.tell_of_host();
        assert_eq!(said(&segue), 0, "it is told once");
    }
}
