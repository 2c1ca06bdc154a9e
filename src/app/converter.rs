//! Conversion of many files: one after the other is read and converted by the reader of files, and
//! what comes back is added to one archive.

use super::{Segue, exports};
use crate::platform::{self, FileBytes, LargeFile, ReadError, ReadEvent, Reader};
use crate::ui::{ConvertAction, ConvertShown};
use segue_formats::FileKind;
use segue_session::conversion::{Conversion, ConversionRow, ConvertedFile};
use segue_session::convert::{ConvertOptions, TargetRig};
use segue_session::export::ExportOptions;
use segue_session::packed;
use segue_session::reading::{Content, Product, ReadReport, ReadSetup, ReadTask, SkeletonFile};
use segue_session::{Command, FileCommand, Level, Origin, Session, Slot};
use segue_text::{Message, ToMessage as _, msg};
use std::collections::VecDeque;
use std::sync::Arc;

/// The number of the first task of a conversion; those of the session are lower.
const FIRST_TASK: u64 = 1 << 40;
/// A file or clip that is to be converted.
#[derive(Debug)]
enum Item {
    File { name: String, bytes: FileBytes },
    Clip { id: String },
}

/// The files that wait, and the conversion under way.
#[derive(Debug, Default)]
pub(super) struct Converter {
    waiting: VecDeque<Item>,
    run: Option<Run>,
    /// The table of the last conversion, or of the one under way.
    rows: Arc<Vec<ConversionRow>>,
    tasks: u64,
}

/// A conversion under way.
#[derive(Debug)]
struct Run {
    conversion: Conversion,
    setup: ReadSetup,
    /// The result that is asked for of each file.
    product: Product,
    /// Whether long clips of the library are converted here, too: a worker could not.
    has_no_writer: bool,
    /// The number of files and clips in all.
    all: usize,
    current: Option<Current>,
}

/// The file or clip that is converted now.
#[derive(Debug)]
struct Current {
    task: u64,
    name: String,
    size: u64,
    done: u64,
    clip: Option<CurrentClip>,
}

/// The clip of the library that is converted now.
#[derive(Debug)]
struct CurrentClip {
    id: String,
    /// The bytes that the worker has made of it.
    made: Option<LargeFile>,
}

impl Converter {
    /// Returns whether a task of the reader is part of a conversion.
    pub(super) fn is_own(task: u64) -> bool {
        (FIRST_TASK..exports::FIRST_TASK).contains(&task)
    }

    /// Adds a file; allowed while a conversion is running.
    pub(super) fn add_file(&mut self, name: String, bytes: FileBytes) {
        let bytes = match bytes {
            // Each task carries the bytes of the skeleton files, so they stay in memory.
            FileBytes::Here(bytes) if !is_skeleton(&name) => platform::outside_memory(bytes),
            other => other,
        };
        self.add(Item::File { name, bytes });
    }

    fn add(&mut self, item: Item) {
        self.waiting.push_back(item);
        if let Some(run) = &mut self.run {
            run.all += 1;
        }
    }

    /// Takes in an event of the file or clip that is converted.
    pub(super) fn on_read_event(&mut self, task: u64, event: ReadEvent) {
        let Some(run) = &mut self.run else { return };
        let Some(current) = run.current.as_mut().filter(|current| current.task == task) else {
            return;
        };
        let report = match event {
            ReadEvent::Progress(done) => {
                current.done = done;
                return;
            }
            ReadEvent::Bytes(made) => {
                // Files that are read are not stored.
                if let Some(clip) = &mut current.clip {
                    clip.made = Some(made);
                }
                return;
            }
            ReadEvent::NoRoom(_) => Err(ReadError::NoRoom),
            ReadEvent::Done(report) => report,
        };
        if let Some(CurrentClip { id, made }) = current.clip.take() {
            let name = std::mem::take(&mut current.name);
            run.current = None;
            let made = made.and_then(|made| packed::read_converted(&made.to_vec()?));
            match (report, made) {
                (Ok(_), Some(made)) => run.conversion.add_converted(&name, Ok(made)),
                (Err(ReadError::Refused(reason)), _) => {
                    run.conversion.add_converted(&name, Err(reason));
                }
                // The program cannot be fetched, or its memory is used up.
                _ => {
                    run.has_no_writer = true;
                    self.waiting.push_front(Item::Clip { id });
                }
            }
            return;
        }
        let report = report.map_err(|error| match error {
            ReadError::NoRoom => msg!("there is no room for the file"),
            other => other.to_message(),
        });
        let name = std::mem::take(&mut current.name);
        run.current = None;
        let has_motions = self.waiting.iter().any(Item::may_need_model);
        // A body model is not converted where there are motions that need it.
        let mut is_model = false;
        let report = report.map(|mut report| {
            if has_motions {
                let models = take_models(&mut report);
                is_model = !models.is_empty() && report.files.is_empty();
                run.setup.skeleton_files.extend(models);
            }
            report
        });
        if !is_model {
            run.conversion.add_report(&name, report);
        }
    }

    /// Returns what the panel shows.
    pub(super) fn shown(&self) -> ConvertShown {
        let progress = self.run.as_ref().map(|run| {
            let current = run.current.as_ref();
            let part = current.map_or(0.0, |now| now.done as f32 / now.size.max(1) as f32);
            let left = self.waiting.len() + usize::from(current.is_some());
            let done = run.all.saturating_sub(left);
            let share = (done as f32 + part.min(1.0)) / run.all.max(1) as f32;
            (share, done, run.all)
        });
        ConvertShown { waiting: self.waiting.len(), progress, rows: Arc::clone(&self.rows) }
    }

    /// Begins with the next file when the one before is done. Returns whether there is more to do
    /// at once, and what is to be saved after the last file.
    fn advance(&mut self, session: &Session, reader: &mut Reader) -> (bool, Option<ConvertedFile>) {
        let Some(run) = &mut self.run else {
            return (false, None);
        };
        if run.conversion.rows().len() != self.rows.len() {
            self.rows = Arc::new(run.conversion.rows().to_vec());
        }
        if run.current.is_some() {
            return (false, None);
        }
        match self.waiting.pop_front() {
            None => return (false, self.end()),
            Some(Item::File { name, bytes }) => {
                self.tasks += 1;
                let id = FIRST_TASK + self.tasks;
                let size = match &bytes {
                    FileBytes::Here(bytes) => bytes.len() as u64,
                    FileBytes::Large(file) => file.len(),
                };
                let content = Content::Outside(String::new());
                let (setup, product) = (run.setup.clone(), run.product.clone());
                let task = ReadTask { id, name: name.clone(), content, size, setup, product };
                run.current = Some(Current { task: id, name, size, done: 0, clip: None });
                reader.start(task, bytes);
            }
            Some(Item::Clip { id }) => {
                let entry = session.library().find(&id);
                let Some((entry, motion)) =
                    entry.and_then(|entry| Some((entry, entry.motion.as_ref()?)))
                else {
                    run.conversion.fail(&id, "its motion is not loaded".into());
                    return (true, None);
                };
                let (name, mesh) = (entry.title().to_string(), entry.mesh.as_ref());
                let options = run.conversion.options();
                // One file of all clips needs their motions.
                let is_elsewhere = matches!(run.product, Product::Convert(_))
                    && !run.has_no_writer
                    && packed::takes_long(motion);
                let packed = is_elsewhere.then(|| packed::pack_conversion(motion, mesh, options));
                let Some(Ok(packed)) = packed else {
                    run.conversion.add_clip(&name, motion, mesh);
                    return (true, None);
                };
                self.tasks += 1;
                let task = FIRST_TASK + self.tasks;
                let (size, clip) = (packed.size() as u64, Some(CurrentClip { id, made: None }));
                reader.start(
                    ReadTask::of_packed_motion(task, &name, packed.size()),
                    platform::packed_file(&packed),
                );
                run.current = Some(Current { task, name, size, done: 0, clip });
            }
        }
        (true, None)
    }

    /// Returns the clip that is next if its motion is not in memory and can be read again.
    fn awaited_clip(&self, session: &Session) -> Option<String> {
        self.run.as_ref().filter(|run| run.current.is_none())?;
        let Some(Item::Clip { id }) = self.waiting.front() else { return None };
        let entry = session.library().find(id)?;
        let can_be_read = matches!(entry.origin, Origin::File(_)) && entry.is_known();
        (entry.motion.is_none() && can_be_read).then(|| entry.id.clone())
    }

    /// Stops, and returns what is done.
    fn stop(&mut self, reader: &mut Reader) -> Option<ConvertedFile> {
        let run = self.run.as_mut()?;
        if let Some(current) = run.current.take() {
            reader.stop(&[current.task].into());
            run.conversion.fail(&current.name, stopped());
        }
        for item in self.waiting.drain(..) {
            let (Item::File { name, .. } | Item::Clip { id: name }) = item;
            run.conversion.fail(&name, stopped());
        }
        self.end()
    }

    fn end(&mut self) -> Option<ConvertedFile> {
        let mut run = self.run.take()?;
        run.conversion.write_one_file();
        self.rows = Arc::new(run.conversion.rows().to_vec());
        Some(run.conversion.into_file())
    }

    /// Returns the queued skeleton files, and removes them from the queue if there are motions that
    /// need them.
    fn take_skeletons(&mut self) -> Vec<SkeletonFile> {
        let has_motions = self
            .waiting
            .iter()
            .any(|item| matches!(item, Item::File { name, .. } if has_ending(name, "amc")));
        let mut found = Vec::new();
        if has_motions {
            self.waiting.retain(|item| match item {
                Item::File { name, bytes: FileBytes::Here(bytes) } if is_skeleton(name) => {
                    found.push(SkeletonFile::new(name, bytes));
                    false
                }
                _ => true,
            });
        }
        found
    }
}

impl Item {
    /// Returns whether it is a file that may be a motion of a body model.
    fn may_need_model(&self) -> bool {
        let is_motion = |name: &str| ["npz", "npy", "pkl"].iter().any(|own| has_ending(name, own));
        matches!(self, Self::File { name, .. } if is_motion(name))
    }

    /// Returns whether it has the name of a body model, which is to be read before the motions. The
    /// content decides when it is read.
    fn has_name_of_model(&self) -> bool {
        let Self::File { name, .. } = self else { return false };
        let name = name.rsplit(['/', '\\']).next().unwrap_or(name).to_lowercase();
        self.may_need_model() && (name.contains("smpl") || name.contains("model"))
    }
}

/// Takes the body models out of a report, to be used for the motions that follow.
fn take_models(report: &mut ReadReport) -> Vec<SkeletonFile> {
    let mut found = Vec::new();
    report.files.retain(|file| {
        let read = file.result.as_ref().ok().filter(|_| file.kind == FileKind::SmplModel);
        let model = read.and_then(|read| read.skeleton_file.as_deref());
        found.extend(model.cloned());
        model.is_none()
    });
    found
}

fn has_ending(name: &str, ending: &str) -> bool {
    name.rsplit_once('.').is_some_and(|(_, own)| own.eq_ignore_ascii_case(ending))
}

fn is_skeleton(name: &str) -> bool {
    has_ending(name, "asf")
}

impl Segue {
    /// Carries out a step of a conversion that the user asks for.
    pub(super) fn run_conversion(&mut self, action: &ConvertAction) {
        match action {
            ConvertAction::AddClips(ids) => {
                for id in ids {
                    self.converter.add(Item::Clip { id: id.clone() });
                }
            }
            ConvertAction::Start { how, onto_a, in_one_file } => {
                self.start_conversion(how, *onto_a, *in_one_file);
            }
            ConvertAction::Stop => {
                let made = self.converter.stop(&mut self.reader);
                self.save_converted(made);
            }
            ConvertAction::Clear => {
                self.converter.waiting.clear();
                self.converter.rows = Arc::default();
            }
        }
    }

    fn start_conversion(&mut self, how: &ExportOptions, onto_a: bool, in_one_file: bool) {
        if self.converter.run.is_some() || self.converter.waiting.is_empty() {
            return;
        }
        let a = self.session.slot(Slot::A).and_then(|entry| entry.motion.clone());
        let rig = match (onto_a, a) {
            (true, None) => {
                let reason = msg!("A has no skeleton to convert to: choose a clip for A.");
                return self.session.say(Level::Warning, reason);
            }
            (true, Some(a)) => Some(TargetRig::of(&a)),
            (false, _) => None,
        };
        let options = ConvertOptions { export: *how, rig };
        let mut setup = self.session.setup_for_conversion();
        setup.skeleton_files.extend(self.converter.take_skeletons());
        // Bodies before the motions that need them, the others in their order.
        self.converter.waiting.make_contiguous().sort_by_key(|item| !item.has_name_of_model());
        let all = self.converter.waiting.len();
        // One file of all needs their motions, for the body that they share.
        let product =
            if in_one_file { Product::Clips } else { Product::Convert(Arc::new(options.clone())) };
        let conversion = if in_one_file {
            let character = self.session.character().filter(|_| !onto_a);
            Conversion::in_one_file(options, character.as_ref())
        } else {
            Conversion::new(options)
        };
        self.converter.run =
            Some(Run { conversion, setup, product, has_no_writer: false, all, current: None });
        self.converter.rows = Arc::default();
    }

    /// Begins with the next file when the one before is done, and saves the result after the last.
    /// Returns whether there is more to do at once.
    pub(super) fn advance_conversion(&mut self) -> bool {
        if let Some(id) = self.converter.awaited_clip(&self.session) {
            if !self.session.is_reading_clip(&id) {
                self.dispatch(Command::File(FileCommand::Read(id.clone())));
            }
            if self.session.is_reading_clip(&id) {
                return false;
            }
        }
        let (more, made) = self.converter.advance(&self.session, &mut self.reader);
        self.save_converted(made);
        more
    }

    fn save_converted(&self, made: Option<ConvertedFile>) {
        if let Some(ConvertedFile { name, mime, bytes }) = made {
            platform::download(&name, mime, &bytes, &self.inbox);
        }
    }
}

fn stopped() -> Message {
    "the conversion was stopped".into()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::platform::{Inbox, Incoming};
    use segue_formats::bvh;
    use segue_motion::synth::{Action, Params, synthesize};
    use segue_session::export::ExportFormat;

    const BVH: &[u8] = b"HIERARCHY ROOT Hips { OFFSET 0 1 0 CHANNELS 1 Yrotation End Site { OFFSET 0 0.7 0 } } MOTION Frames: 2 Frame Time: .1\n1\n2";

    /// Returns an app whose panel of conversions is open.
    fn app() -> Segue {
        let mut segue = Segue::new(Inbox::default(), None, "lab=view&play=off".to_owned());
        while segue.poll() || segue.is_busy() {}
        segue.panels.convert.is_open = true;
        segue
    }

    fn start(segue: &mut Segue) {
        let how = ExportOptions { format: ExportFormat::Npz, ..ExportOptions::default() };
        let (onto_a, in_one_file) = (false, false);
        segue.run_conversion(&ConvertAction::Start { how, onto_a, in_one_file });
    }

    /// Returns what the conversion under way leaves to be saved.
    fn converted(segue: &mut Segue) -> ConvertedFile {
        loop {
            let (_, made) = segue.converter.advance(&segue.session, &mut segue.reader);
            if let Some(made) = made {
                return made;
            }
            for incoming in segue.inbox.take() {
                segue.receive(incoming);
            }
            std::thread::yield_now();
        }
    }

    #[test]
    fn files_dropped_on_the_open_panel_are_converted_and_do_not_join_the_library() {
        let mut segue = app();
        let before = segue.session.library().entries().len();
        segue.receive(Incoming::Opening(3));
        for (name, bytes) in [("a/one.bvh", BVH), ("two.bvh", &BVH[..80]), ("three.bvh", BVH)] {
            segue.receive(Incoming::File { name: name.into(), bytes: Arc::from(bytes) });
        }
        segue.run_conversion(&ConvertAction::AddClips(vec!["walk".into(), "nowhere".into()]));
        assert_eq!(segue.converter.shown().waiting, 5);
        start(&mut segue);
        assert_eq!(segue.converter.shown().progress, Some((0.0, 0, 5)));
        let made = converted(&mut segue);
        assert!(made.bytes.starts_with(b"PK"));
        assert_eq!((made.name.as_str(), made.mime), ("converted.zip", "application/zip"));
        let shown = segue.converter.shown();
        assert_eq!((shown.waiting, shown.progress), (0, None));
        let outputs: Vec<Option<&str>> =
            shown.rows.iter().map(|row| row.output.as_deref().ok()).collect();
        let expected = [Some("a/one.npz"), None, Some("three.npz"), Some("Walk.npz"), None];
        assert_eq!(outputs, expected);
        assert_eq!(segue.session.library().entries().len(), before);
        // With the panel closed, a file is for the library again.
        segue.panels.convert.is_open = false;
        segue.receive(Incoming::File { name: "one.bvh".into(), bytes: Arc::from(BVH) });
        assert_eq!(segue.session.library().entries().len(), before + 1);
    }

    /// Opens an app with a clip of a minute, and begins to convert it. Returns the task.
    fn begin_with_a_long_clip() -> (Segue, u64) {
        let mut segue = app();
        segue.panels.convert.is_open = false;
        let params = Params { duration_secs: 60.0, ..Params::new(Action::Walk) };
        let clip = synthesize(&params).expect("natural parameters").clip;
        let text = bvh::write(&clip, &bvh::WriteOptions::default());
        let task = segue.load_in_background("long.bvh", FileBytes::Here(text.into_bytes().into()));
        while segue.is_reading(task) {
            segue.poll();
        }
        segue.read_result(task).expect("a result").expect("a clip");
        let own = segue.clips().into_iter().find(|clip| clip.id.starts_with("long"));
        let id = own.expect("the clip").id;
        segue.run_conversion(&ConvertAction::AddClips(vec![id]));
        start(&mut segue);
        let (more, _) = segue.converter.advance(&segue.session, &mut segue.reader);
        assert!(more, "the clip is with a worker");
        let run = segue.converter.run.as_ref().expect("a conversion");
        let task = run.current.as_ref().expect("a clip").task;
        (segue, task)
    }

    #[test]
    fn page_converts_a_long_clip_as_a_worker_does_where_none_can() {
        let mut made = Vec::new();
        for fails in [false, true] {
            let (mut segue, task) = begin_with_a_long_clip();
            if fails {
                let event = ReadEvent::Done(Err(ReadError::NotStarted));
                segue.converter.on_read_event(task, event);
                assert!(segue.converter.run.as_ref().is_some_and(|run| run.has_no_writer));
            }
            made.push((converted(&mut segue).bytes, segue.converter.shown().rows));
        }
        assert_eq!(made[0].1[0].output, Ok("long.npz".to_owned()));
        assert!(made[0] == made[1]);
    }

    #[test]
    fn long_clip_that_is_stopped_gets_a_line_and_late_answers_change_nothing() {
        let (mut segue, task) = begin_with_a_long_clip();
        assert!(segue.converter.stop(&mut segue.reader).is_some());
        let event = ReadEvent::Done(Ok(ReadReport::default()));
        segue.converter.on_read_event(task, event);
        let rows = segue.converter.shown().rows;
        assert_eq!((rows.len(), &rows[0].output), (1, &Err(stopped())));
    }

    #[test]
    fn files_and_clips_in_one_file_share_a_body() {
        let mut segue = app();
        for (name, bytes) in [("one.bvh", BVH), ("two.bvh", &BVH[..80])] {
            segue.converter.add_file(name.to_owned(), FileBytes::Here(Arc::from(bytes)));
        }
        segue.run_conversion(&ConvertAction::AddClips(vec!["walk".into(), "run".into()]));
        let how = ExportOptions { format: ExportFormat::Fbx, ..ExportOptions::default() };
        let (onto_a, in_one_file) = (true, true);
        segue.run_conversion(&ConvertAction::Start { how, onto_a, in_one_file });
        let made = converted(&mut segue);
        assert_eq!(made.name, "clips.fbx");
        assert!(made.bytes.starts_with(b"Kaydara FBX Binary"));
        let rows = segue.converter.shown().rows;
        let outputs: Vec<Option<&str>> =
            rows.iter().map(|row| row.output.as_deref().ok()).collect();
        let file = Some("clips.fbx");
        // One joint is no body that A's can have the motion of; a file that is cut cannot be read.
        assert_eq!(outputs, [file, None, file, file]);
    }

    #[test]
    fn body_model_among_the_files_gives_its_bones_to_their_motions() {
        const MODEL: &[u8] =
            include_bytes!("../../crates/formats/tests/cases/numpy/SMPLH_FEMALE.npz");
        const MOTION: &[u8] = include_bytes!("../../crates/formats/tests/cases/numpy/amass.npz");
        let motion = ("walk.npz", MOTION);
        let run = |files: &[(&str, &[u8])]| {
            let mut segue = app();
            for (name, bytes) in files {
                segue.converter.add_file((*name).to_owned(), FileBytes::Here(Arc::from(*bytes)));
            }
            start(&mut segue);
            let made = converted(&mut segue);
            (made.bytes, segue.converter.shown().rows)
        };
        let (_, alone) = run(&[motion]);
        let (_, both) = run(&[motion, ("bodies/SMPLH_FEMALE.npz", MODEL)]);
        assert_eq!((alone.len(), both.len()), (1, 1), "the model itself is not converted");
        let told = |rows: &[ConversionRow]| rows[0].odd.iter().map(ToString::to_string).collect();
        let (alone, both): (Vec<String>, Vec<String>) = (told(&alone), told(&both));
        let says = |told: &[String]| told.iter().any(|line| line.contains("SMPLH_FEMALE.npz"));
        assert!(!says(&alone) && says(&both), "{alone:?} {both:?}");
        // A model alone has nothing to convert.
        let (_, model) = run(&[("SMPLH_FEMALE.npz", MODEL)]);
        assert_eq!(model[0].output, Err("it has no frames".into()));
    }

    #[test]
    fn conversion_that_is_stopped_keeps_what_is_done() {
        let mut segue = app();
        segue.run_conversion(&ConvertAction::AddClips(vec!["walk".into()]));
        for index in 0..3 {
            segue.converter.add_file(format!("{index}.bvh"), FileBytes::Here(Arc::from(BVH)));
        }
        start(&mut segue);
        // The clip is done at once, and the first file has begun.
        for _ in 0..2 {
            let (_, archive) = segue.converter.advance(&segue.session, &mut segue.reader);
            assert_eq!(archive, None);
        }
        let archive = segue.converter.stop(&mut segue.reader);
        assert!(archive.is_some_and(|made| made.bytes.starts_with(b"PK")));
        let rows = segue.converter.shown().rows;
        assert!(rows[0].output.is_ok() && rows.len() == 4);
        assert!(rows[1..].iter().all(|row| row.output.is_err()));
        // Late answers for the file that was stopped are ignored.
        for incoming in segue.inbox.take() {
            segue.receive(incoming);
        }
        assert_eq!(segue.converter.shown().rows.len(), 4);
    }
}
