//! The session of the page, driven to a result: a link or a lab, files, values, and all work done.

use crate::clips::Clips;
use crate::error::{BatchError, FileError};
use crate::inputs::shown;
use crate::read::bytes_of;
use crate::samples;
use percent_encoding::{NON_ALPHANUMERIC, utf8_percent_encode};
use segue_formats::ImportOptions;
use segue_session::reading::{Content, ReadFile, ReadReport, read};
use segue_session::{
    Command, FileCommand, Key, LabId, Level, List, MAX_WEIGHTED_CLIPS, NoResult, PaneResult,
    Request, Session, Value,
};
use std::path::Path;
use std::sync::Arc;

/// A clip of a lab.
#[derive(Clone, Debug)]
pub enum Clip {
    /// A file, of which all clips are used.
    File(ClipFile),
    /// A clip of a file that was read before, by its id: all clips of the file join the library.
    Read(Arc<ReadFile>, String),
    /// The id of a clip that needs no file: a built-in one, or a recipe of some.
    Known(String),
}

/// A file with its name and bytes.
#[derive(Clone, Debug)]
pub struct ClipFile {
    /// Its name.
    pub name: String,
    /// Its bytes.
    pub bytes: Arc<[u8]>,
}

impl ClipFile {
    /// Reads a file from disk, of at most `max_bytes`.
    ///
    /// # Errors
    /// [`FileError`] with its name.
    pub fn load(path: &Path, max_bytes: usize) -> Result<Self, FileError> {
        let bytes = Arc::from(bytes_of(path, max_bytes)?);
        Ok(Self { name: shown(Path::new(path.file_name().unwrap_or_default())), bytes })
    }
}

/// All that a result is made from.
#[derive(Clone, Debug)]
pub struct Ingredients<'a> {
    /// The lab that makes it.
    pub lab: LabId,
    /// The link or query whose state is opened; the clips are those that it names.
    pub link: Option<&'a str>,
    /// Skeletons that the clips need.
    pub skeletons: &'a [ClipFile],
    /// The clips, in the order in which the lab takes them.
    pub clips: Vec<Clip>,
    /// The clip on whose body the clips are put; the first one where a file has several.
    pub body: Option<&'a Clip>,
    /// Files that the recipes of clips name, and that no clip brings.
    pub beside: &'a [Arc<ReadFile>],
    /// Values of parameters.
    pub values: &'a [(Key, Value)],
    /// How files are read.
    pub options: ImportOptions,
}

impl Ingredients<'_> {
    /// Returns the ingredients of a lab's result with its default clips.
    #[must_use]
    pub fn of(lab: LabId) -> Self {
        Self {
            lab,
            link: None,
            skeletons: &[],
            clips: Vec::new(),
            body: None,
            beside: &[],
            values: &[],
            options: ImportOptions::default(),
        }
    }
}

/// A session with everything loaded and set.
#[derive(Debug)]
pub struct Driven {
    /// The session.
    pub session: Session,
    /// The ids of the clips, in their order.
    pub ids: Vec<String>,
    /// Values that hold whatever clip is shown.
    values: Vec<(Key, Value)>,
    /// The session's refusals and corrections of the options, one sentence each.
    notes: Vec<String>,
}

/// The session's requests that were answered.
#[derive(Debug, Default)]
struct Answered {
    is_any: bool,
    /// The files that were read, by the number of the task: the ids of the clips, or the reason why
    /// there are none.
    read: Vec<(u64, Result<Vec<String>, String>)>,
}

impl Driven {
    /// Opens the link or lab, and loads the clips.
    ///
    /// # Errors
    /// [`BatchError`] if a file cannot be read, or the clips or values do not fit the lab.
    pub fn new(from: &Ingredients<'_>) -> Result<Self, BatchError> {
        let query = from.link.map_or_else(|| format!("lab={}", from.lab.word()), query_of);
        let mut driven = Self {
            session: Session::new(),
            ids: Vec::new(),
            values: Vec::new(),
            notes: Vec::new(),
        };
        for file in from.beside {
            driven.add_read(file, from)?;
        }
        for clip in from.clips.iter().chain(from.body) {
            // A recipe is known once a link has named it.
            if let Clip::Known(id) = clip {
                let id = utf8_percent_encode(id, NON_ALPHANUMERIC);
                driven.apply(Command::OpenLink(format!("lab=view&a={id}")))?;
            }
        }
        driven.apply(Command::OpenLink(query))?;
        let opened = driven.session.params().lab();
        if opened != from.lab {
            return Err(BatchError::OtherLab(opened));
        }
        for skeleton in from.skeletons {
            driven.load(skeleton, from)?;
        }
        if let Some(body) = from.body {
            let body = driven.ids_of(body, from)?.into_iter().take(1).collect();
            driven.values.push((Key::EditBody, List::ClipIds(body).into()));
        }
        for clip in &from.clips {
            let ids = driven.ids_of(clip, from)?;
            driven.ids.extend(ids);
        }
        if from.link.is_none() && !driven.ids.is_empty() {
            let clips = driven.clip_values(from.lab)?;
            driven.values.splice(0..0, clips);
        }
        driven.values.extend(from.values.iter().cloned());
        driven.set(Vec::new())?;
        Ok(driven)
    }

    /// Sets the values of the ingredients after some others, which change first.
    ///
    /// # Errors
    /// [`BatchError::Command`] if one of them does not fit.
    pub fn set(&mut self, mut first: Vec<(Key, Value)>) -> Result<(), BatchError> {
        first.extend(self.values.iter().cloned());
        if first.is_empty() { Ok(()) } else { self.apply(Command::Set(first)) }
    }

    fn apply(&mut self, command: Command) -> Result<(), BatchError> {
        Ok(self.session.apply(command)?)
    }

    /// Returns the values that put the clips into the lab.
    fn clip_values(&self, lab: LabId) -> Result<Vec<(Key, Value)>, BatchError> {
        let ids = self.ids.as_slice();
        let refusal = |expected| BatchError::Clips { lab, expected, found: ids.len() };
        match Clips::of(lab) {
            Clips::None => Err(refusal("no clips")),
            // Shown one after the other.
            Clips::Each => Ok(Vec::new()),
            Clips::List => self.session.with_clips(ids).ok_or_else(|| refusal("fewer clips")),
            Clips::Slots => {
                let takes_more = Key::WarpAlso.param().is_used_by(lab);
                let (pair, more) = ids.split_at_checked(2).unwrap_or((ids, &[]));
                let expected =
                    if takes_more { "two to eight clips" } else { "two clips, first A and then B" };
                let most = if takes_more { MAX_WEIGHTED_CLIPS } else { 0 };
                let values = self.session.with_clips(pair).filter(|_| more.len() <= most);
                let mut values = values.ok_or_else(|| refusal(expected))?;
                if !more.is_empty() {
                    // The same weight for each: A has what the others leave.
                    let weight = (100.0 / ids.len() as f64).round() / 100.0;
                    let also = more.iter().map(|id| (id.clone(), weight)).collect();
                    values.push((Key::WarpWeight, Value::Number(weight)));
                    values.push((Key::WarpAlso, List::WeightedClips(also).into()));
                }
                Ok(values)
            }
        }
    }

    /// Loads a clip. Returns the ids of the clips of its file, or the one that is meant.
    fn ids_of(&mut self, clip: &Clip, from: &Ingredients<'_>) -> Result<Vec<String>, BatchError> {
        match clip {
            Clip::File(file) => self.load(file, from),
            Clip::Read(file, id) => {
                self.add_read(file, from)?;
                Ok(vec![id.clone()])
            }
            Clip::Known(id) => Ok(vec![id.clone()]),
        }
    }

    /// Loads a file. Returns the ids of its clips.
    fn load(&mut self, file: &ClipFile, from: &Ingredients<'_>) -> Result<Vec<String>, BatchError> {
        let (content, size) = (Content::Here(Arc::clone(&file.bytes)), file.bytes.len() as u64);
        let task = self.begin(&file.name, content, size, from);
        let mut ids = Vec::new();
        for (of, loaded) in self.answer_requests().read {
            match loaded {
                Ok(loaded) if of == task => ids = loaded,
                Ok(_) => {}
                Err(reason) if of == task => return Err(BatchError::Unusable(reason)),
                Err(reason) => self.notes.push(reason),
            }
        }
        let library = self.session.library();
        ids.retain(|id| library.get(id).is_some());
        if ids.is_empty() && !from.skeletons.iter().any(|skeleton| skeleton.name == file.name) {
            return Err(BatchError::Unusable(format!("{}: it has no motion", file.name)));
        }
        if from.options != ImportOptions::default() {
            for id in ids.clone() {
                self.apply(Command::File(FileCommand::Reimport(id, from.options)))?;
            }
            self.answer_requests();
        }
        Ok(ids)
    }

    /// Begins to read a file. Returns the task's number.
    fn begin(&mut self, name: &str, content: Content, size: u64, from: &Ingredients<'_>) -> u64 {
        // A clip that a link names keeps its slot.
        if from.link.is_some() {
            self.session.begin_reading_fetched(name, content, size)
        } else {
            self.session.begin_reading(name, content, size)
        }
    }

    /// Adds a file that was read before.
    fn add_read(&mut self, file: &Arc<ReadFile>, from: &Ingredients<'_>) -> Result<(), BatchError> {
        let content = Content::Outside(file.sha256.clone());
        let own = self.begin(&file.name, content, file.size, from);
        for request in self.session.take_requests() {
            match request {
                Request::Read(task) if task.id == own => {
                    let files = vec![ReadFile::clone(file)];
                    let report = ReadReport { files, notes: Vec::new() };
                    let loaded = self.session.finish_reading(own, Ok(report));
                    if let Some(Err(reason)) = loaded {
                        return Err(BatchError::Unusable(reason.to_string()));
                    }
                }
                other => self.answer(other, &mut Answered::default()),
            }
        }
        Ok(())
    }

    /// Answers the session's requests until there are no more.
    fn answer_requests(&mut self) -> Answered {
        let mut answered = Answered::default();
        loop {
            let requests = self.session.take_requests();
            if requests.is_empty() {
                return answered;
            }
            answered.is_any = true;
            for request in requests {
                self.answer(request, &mut answered);
            }
        }
    }

    /// Answers a request of the session.
    fn answer(&mut self, request: Request, answered: &mut Answered) {
        match request {
            Request::Read(task) => {
                let report = match &task.content {
                    Content::Here(bytes) => {
                        let read = read(&task.name, bytes, &task.setup, &mut |_| true);
                        Ok(read.unwrap_or_default())
                    }
                    Content::Outside(_) => Err("its bytes are not here".into()),
                };
                let loaded = self.session.finish_reading(task.id, report);
                answered.read.extend(loaded.map(|loaded| {
                    let ids = loaded.map(|loaded| loaded.ids);
                    (task.id, ids.map_err(|reason| reason.to_string()))
                }));
            }
            Request::Sample(sample) => {
                let packed = samples::packed(sample).unwrap_or_default();
                if let Err(error) = self.session.load_sample(sample, packed) {
                    self.notes.push(error.to_string());
                }
            }
            Request::Fetch(address) => self
                .notes
                .push(format!("{address} is not fetched: download it, and name the file here")),
            Request::Lesson(_) | Request::StopReading { .. } => {}
        }
    }

    /// Does all work that the results need. What else the session would do is for those who look at
    /// it.
    pub fn settle(&mut self) {
        loop {
            let is_answered = self.answer_requests().is_any;
            let mut panes = self.session.panes().iter();
            let is_awaited = panes.any(|pane| matches!(pane.result(), Err(NoResult::Awaited)));
            if !is_answered && (!is_awaited || !self.session.work()) {
                return;
            }
        }
    }

    /// Returns the results of all panes, each with the name by which it differs; without a name
    /// where nothing is compared.
    #[must_use]
    pub fn results(&self) -> Vec<(Option<String>, Result<PaneResult<'_>, NoResult>)> {
        let panes = self.session.panes().iter();
        let name = |pane| self.session.variant_name(pane).map(|name| name.to_string());
        panes.map(|pane| (name(pane), pane.result())).collect()
    }

    /// Returns what the session had to say, a sentence each.
    #[must_use]
    pub fn all_notes(&self) -> Vec<String> {
        let said = self.session.notices().list().iter();
        let said = said.filter(|notice| notice.level != Level::Info);
        self.notes.iter().cloned().chain(said.map(|notice| notice.text.to_string())).collect()
    }
}

/// Returns the link of a session's state on the page at an address.
#[must_use]
pub fn page_link(session: &Session, page: &str) -> String {
    match session.query_for_others() {
        // The page shows a first visitor something else than all defaults.
        empty if empty.is_empty() => format!("{page}?lab={}", session.params().lab().word()),
        query => format!("{page}?{query}"),
    }
}

/// Returns the lab that a link opens.
///
/// # Errors
/// [`BatchError::Command`] if it cannot be opened.
pub fn lab_of_link(link: &str) -> Result<LabId, BatchError> {
    let mut session = Session::new();
    session.apply(Command::OpenLink(query_of(link)))?;
    Ok(session.params().lab())
}

/// Returns the query of a link: all behind its question mark, without a fragment.
#[must_use]
pub fn query_of(link: &str) -> String {
    let query = link.split_once('?').map_or(link, |(_, query)| query);
    query.split('#').next().unwrap_or_default().to_owned()
}

/// Returns the id of a clip that needs no file: of a built-in one, or a recipe such as
/// `run(turn_rate:20)`.
#[must_use]
pub fn known_clip(session: &Session, word: &str) -> Option<String> {
    let is_recipe = word.ends_with(')') && word.contains('(');
    session.nameable(word).or_else(|| is_recipe.then(|| word.to_owned()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn query_is_the_part_behind_the_question_mark() {
        for link in ["https://a.org/x/?lab=loop&a=walk#y", "?lab=loop&a=walk", "lab=loop&a=walk"] {
            assert_eq!(query_of(link), "lab=loop&a=walk");
        }
    }
}
