//! The motions under test: those of a folder, or synthesised ones.

use super::guard::{guarded, parallel_map};
use segue_formats::archive::{self, ArchiveLimits};
use segue_formats::{FileKind, ImportOptions, kind_of};
use segue_motion::skeleton::Skeleton;
use segue_session::reading::{ReadReport, ReadSetup, SkeletonFile, read};
use segue_session::{Command, Request, Session};
use segue_text::msg;
use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// A motion file that is read on demand.
#[derive(Debug)]
pub struct MotionFile {
    /// The path below the folder.
    pub path: String,
    content: FileContent,
    /// The skeleton files beside it; for an AMC only.
    skeletons: Vec<SkeletonFile>,
}

#[derive(Debug)]
enum FileContent {
    OnDisk(PathBuf),
    Unpacked(Arc<[u8]>),
}

/// A clip under test.
#[derive(Debug)]
pub struct Take {
    /// The name in tables.
    pub name: String,
    /// The number of its rig: takes with equal skeletons share it.
    pub rig: usize,
    from: TakeSource,
}

#[derive(Debug)]
enum TakeSource {
    /// The index of the file, and that of the clip in it.
    File(usize, usize),
    /// The id of a clip that every session can synthesise.
    Made(String),
}

/// All motions under test.
#[derive(Debug, Default)]
pub struct Motions {
    files: Vec<MotionFile>,
    /// The takes, sorted by name.
    pub takes: Vec<Take>,
    /// Files without takes: the path, and the error.
    pub refused: Vec<(String, String)>,
    /// Files whose reading panicked, and the place of the panic.
    pub panics: Vec<(String, String)>,
}

/// Returns the name without folders.
fn file_name(path: &str) -> &str {
    path.rsplit('/').next().unwrap_or(path)
}

fn folder_of(path: &str) -> &str {
    path.rsplit_once('/').map_or("", |(folder, _)| folder)
}

/// Returns every file below a folder, sorted by path. Links to folders are not followed, because
/// they may form cycles.
fn files_below(folder: &Path) -> Result<Vec<PathBuf>, String> {
    let at = |path: &Path, error: &std::io::Error| format!("{}: {error}", path.display());
    let (mut folders, mut files) = (vec![folder.to_owned()], Vec::new());
    while let Some(folder) = folders.pop() {
        for entry in fs::read_dir(&folder).map_err(|error| at(&folder, &error))? {
            let entry = entry.map_err(|error| at(&folder, &error))?;
            let kind = entry.file_type().map_err(|error| at(&entry.path(), &error))?;
            if kind.is_dir() {
                folders.push(entry.path());
            } else {
                files.push(entry.path());
            }
        }
    }
    files.sort();
    Ok(files)
}

impl Motions {
    /// Returns all motion files below a folder: BVH, AMC beside their ASF, GLB, and zip archives of
    /// these.
    ///
    /// # Errors
    /// A sentence if the folder cannot be read.
    pub fn of_folder(folder: &Path) -> Result<Self, String> {
        let mut motions = Self::default();
        let mut skeletons: BTreeMap<String, Vec<SkeletonFile>> = BTreeMap::new();
        for path in files_below(folder)? {
            let name =
                path.strip_prefix(folder).unwrap_or(&path).to_string_lossy().replace('\\', "/");
            let ending = name.rsplit('.').next().unwrap_or_default().to_lowercase();
            if !["bvh", "amc", "asf", "glb", "zip", "gz"].contains(&ending.as_str()) {
                continue;
            }
            let skeletons = skeletons.entry(folder_of(&name).to_owned()).or_default();
            match ending.as_str() {
                "asf" => match fs::read(&path) {
                    Ok(bytes) => skeletons.push(SkeletonFile::new(file_name(&name), &bytes)),
                    Err(error) => motions.refused.push((name, error.to_string())),
                },
                "zip" => motions.unpack(&path, &name),
                _ => motions.files.push(MotionFile {
                    path: name,
                    content: FileContent::OnDisk(path),
                    skeletons: Vec::new(),
                }),
            }
        }
        for file in &mut motions.files {
            if file.path.to_lowercase().ends_with(".amc") && file.skeletons.is_empty() {
                file.skeletons = skeletons.get(folder_of(&file.path)).cloned().unwrap_or_default();
            }
        }
        motions.read_all();
        Ok(motions)
    }

    fn unpack(&mut self, path: &Path, name: &str) {
        let unpacked = fs::read(path).map_err(|error| error.to_string()).and_then(|bytes| {
            archive::unpack(name, &bytes, &ArchiveLimits::default())
                .map_err(|error| error.to_string())
        });
        let unpacked = match unpacked {
            Ok(unpacked) => unpacked,
            Err(sentence) => return self.refused.push((name.to_owned(), sentence)),
        };
        let (skeletons, motions): (Vec<_>, Vec<_>) = (unpacked.files.into_iter())
            .partition(|file| kind_of(&file.path, &file.bytes) == FileKind::Asf);
        for file in motions {
            let beside = skeletons
                .iter()
                .filter(|skeleton| folder_of(&skeleton.path) == folder_of(&file.path));
            self.files.push(MotionFile {
                path: format!("{name}/{}", file.path),
                content: FileContent::Unpacked(file.bytes.into()),
                skeletons: beside
                    .map(|file| SkeletonFile::new(file_name(&file.path), &file.bytes))
                    .collect(),
            });
        }
    }

    /// Returns synthesised clips on three bodies, as many as asked for, the same for the same seed.
    #[must_use]
    pub fn synthesised(count: usize, seed: u64) -> Self {
        let mut motions = Self::default();
        let mut chance = Random::new(seed);
        let mut session = Session::new();
        let mut rigs: Vec<Arc<Skeleton>> = Vec::new();
        for number in 0..count {
            let id = made_id(&mut chance, number);
            let made = guarded(|| opened(&mut session, &format!("lab=view&a={}", encoded(&id))));
            match made {
                Ok(Ok(skeleton)) => motions.takes.push(Take {
                    name: id.clone(),
                    rig: rig_of(&mut rigs, &skeleton),
                    from: TakeSource::Made(id),
                }),
                Ok(Err(sentence)) => motions.refused.push((id, sentence)),
                Err(place) => motions.panics.push((id, place)),
            }
        }
        motions
    }

    fn read_all(&mut self) {
        let files = &self.files;
        let read = parallel_map(files.len(), |index| guarded(|| files[index].skeletons_of_clips()));
        let mut rigs: Vec<Arc<Skeleton>> = Vec::new();
        for (index, (file, found)) in self.files.iter().zip(read).enumerate() {
            match found {
                Ok(Ok(clips)) if clips.is_empty() => {
                    let sentence = "waits for its skeleton, or has no motion".to_owned();
                    self.refused.push((file.path.clone(), sentence));
                }
                Ok(Ok(clips)) => {
                    for (clip, skeleton) in clips.iter().enumerate() {
                        let number =
                            if clips.len() > 1 { format!("#{}", clip + 1) } else { String::new() };
                        self.takes.push(Take {
                            name: format!("{}{number}", file.path),
                            rig: rig_of(&mut rigs, skeleton),
                            from: TakeSource::File(index, clip),
                        });
                    }
                }
                Ok(Err(sentence)) => self.refused.push((file.path.clone(), sentence)),
                Err(place) => self.panics.push((file.path.clone(), place)),
            }
        }
    }

    /// Returns a session with these takes in its library, and their ids in links.
    ///
    /// # Errors
    /// A sentence if a file has changed.
    pub fn open(&self, takes: &[usize]) -> Result<(Session, Vec<String>), String> {
        let mut session = Session::new();
        session
            .apply(Command::OpenLink("lab=view".to_owned()))
            .map_err(|error| error.to_string())?;
        while session.work() {}
        let (mut loaded, mut ids) = (BTreeMap::new(), Vec::new());
        for &take in takes {
            match &self.takes[take].from {
                TakeSource::Made(id) => ids.push(id.clone()),
                TakeSource::File(file, clip) => {
                    if !loaded.contains_key(file) {
                        loaded.insert(*file, self.files[*file].load(&mut session)?);
                    }
                    let found = loaded.get(file).and_then(|ids: &Vec<String>| ids.get(*clip));
                    ids.push(found.ok_or("a clip of the file is gone")?.clone());
                }
            }
        }
        Ok((session, ids))
    }
}

impl MotionFile {
    fn bytes(&self) -> Result<Arc<[u8]>, String> {
        match &self.content {
            FileContent::OnDisk(path) => {
                fs::read(path).map(Into::into).map_err(|error| error.to_string())
            }
            FileContent::Unpacked(bytes) => Ok(Arc::clone(bytes)),
        }
    }

    fn skeletons_of_clips(&self) -> Result<Vec<Arc<Skeleton>>, String> {
        let setup = ReadSetup {
            options: ImportOptions::default(),
            skeleton_files: self.skeletons.clone(),
            ..ReadSetup::default()
        };
        let report: ReadReport =
            read(file_name(&self.path), &self.bytes()?, &setup, &mut |_| true).unwrap_or_default();
        let mut clips = Vec::new();
        for file in report.files {
            let read = file.result.map_err(|error| error.to_string())?;
            clips.extend(read.clips.iter().map(|clip| Arc::clone(clip.motion.clip().skeleton())));
        }
        Ok(clips)
    }

    /// Loads the file as if it were dropped on the page; returns the ids of its clips.
    fn load(&self, session: &mut Session) -> Result<Vec<String>, String> {
        for skeleton in &self.skeletons {
            loaded(session, &skeleton.name, &skeleton.bytes)?;
        }
        loaded(session, file_name(&self.path), &self.bytes()?)
    }
}

fn loaded(session: &mut Session, name: &str, bytes: &Arc<[u8]>) -> Result<Vec<String>, String> {
    let mut ids = session.load(name, Arc::clone(bytes)).map_err(|error| error.to_string())?.ids;
    // Large files are read by the caller.
    for request in session.take_requests() {
        if let Request::Read(task) = request {
            let report = read(&task.name, bytes, &task.setup, &mut |_| true)
                .ok_or_else(|| msg!("it was not read"));
            let done = session.finish_reading(task.id, report).transpose();
            let loaded = done.map_err(|error| error.to_string())?;
            ids.extend(loaded.map(|loaded| loaded.ids).unwrap_or_default());
        }
    }
    Ok(ids)
}

fn rig_of(rigs: &mut Vec<Arc<Skeleton>>, skeleton: &Arc<Skeleton>) -> usize {
    rigs.iter().position(|rig| rig == skeleton).unwrap_or_else(|| {
        rigs.push(Arc::clone(skeleton));
        rigs.len() - 1
    })
}

/// Returns the skeleton of the clip that a link shows.
fn opened(session: &mut Session, link: &str) -> Result<Arc<Skeleton>, String> {
    session.apply(Command::OpenLink(link.to_owned())).map_err(|error| error.to_string())?;
    let pane = &session.panes()[0];
    match (&pane.outcome, &pane.problem) {
        (Some(outcome), None) => Ok(Arc::clone(outcome.motion.clip().skeleton())),
        (_, problem) => Err(problem.as_ref().map(ToString::to_string).unwrap_or_default()),
    }
}

/// Encodes an id for a link.
#[must_use]
pub fn encoded(id: &str) -> String {
    form_urlencoded::byte_serialize(id.as_bytes()).collect()
}

/// Returns the id of a synthesised clip: five walks, three runs, and two of the other actions in
/// ten.
fn made_id(chance: &mut Random, number: usize) -> String {
    let height = ["1.6", "1.75", "1.9"][chance.below(3)];
    let seed = chance.below(1000);
    let secs = 3 + chance.below(6);
    let common = format!("body_height:{height},seed:{seed},make_seconds:{secs}");
    let turn = chance.below(121) as i64 - 60;
    let style = format!(
        "arm_swing:{:.2},bounce:{:.2}",
        0.05 * chance.below(41) as f64,
        0.05 * chance.below(41) as f64
    );
    match number % 10 {
        0..=4 => {
            let speed = 0.5 + 0.05 * chance.below(34) as f64;
            format!("walk(gait_speed:{speed:.2},turn_rate:{turn},{style},{common})")
        }
        5..=7 => {
            let speed = 2.0 + 0.05 * chance.below(80) as f64;
            format!("run(gait_speed:{speed:.2},turn_rate:{turn},{style},{common})")
        }
        8 => format!("{}({common})", ["start", "stop", "idle"][chance.below(3)]),
        _ => format!("{}({common})", ["spin", "jump"][chance.below(2)]),
    }
}

/// Pseudorandom numbers, the same for the same seed on every machine (Steele, Lea, Flood 2014,
/// "Fast Splittable Pseudorandom Number Generators").
#[derive(Debug)]
pub struct Random(u64);

impl Random {
    /// Returns a generator with a seed.
    #[must_use]
    pub fn new(seed: u64) -> Self {
        Self(seed)
    }

    /// Returns a number below a limit; 0 for the limit 0.
    pub fn below(&mut self, limit: usize) -> usize {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut mixed = self.0;
        mixed = (mixed ^ (mixed >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((mixed ^ (mixed >> 31)) % limit.max(1) as u64) as usize
    }
}
