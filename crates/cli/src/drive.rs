//! The session of the page, driven to a result: a link or a lab, files, values, and all work done.

use crate::labs::{Clips, LabCommand, command_of};
use crate::samples;
use crate::status::Failure;
use percent_encoding::{NON_ALPHANUMERIC, utf8_percent_encode};
use segue_formats::ImportOptions;
use segue_session::reading::{Content, read};
use segue_session::{
    Command, FileCommand, Key, Level, List, NoResult, PaneResult, Request, Session, Value,
};
use std::sync::Arc;

/// A clip on the command line.
#[derive(Clone, Debug)]
pub(crate) enum Clip {
    /// A file, of which all clips are used.
    File(ClipFile),
    /// The id of a clip that needs no file: a built-in one, or a recipe of some.
    Known(String),
}

/// A file with its name and bytes.
#[derive(Clone, Debug)]
pub(crate) struct ClipFile {
    pub(crate) name: String,
    pub(crate) bytes: Arc<[u8]>,
}

/// All that a result is made from.
#[derive(Clone, Debug)]
pub(crate) struct Ingredients<'a> {
    pub(crate) command: &'static LabCommand,
    /// The link or query whose state is opened; the clips are those that it names.
    pub(crate) link: Option<&'a str>,
    /// Skeletons that the clips need.
    pub(crate) skeletons: &'a [ClipFile],
    pub(crate) clips: Vec<Clip>,
    /// The file on whose body the clips are put.
    pub(crate) body: Option<&'a ClipFile>,
    /// Values of parameters.
    pub(crate) values: &'a [(Key, Value)],
    pub(crate) options: ImportOptions,
}

/// A session with everything loaded and set.
#[derive(Debug)]
pub(crate) struct Driven {
    pub(crate) session: Session,
    /// The ids of the clips, in the order of the command line.
    pub(crate) ids: Vec<String>,
    /// Values that hold whatever clip is shown.
    values: Vec<(Key, Value)>,
    /// The session's refusals and corrections of the options, one sentence each.
    pub(crate) notes: Vec<String>,
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
    /// [`Failure`] if a file cannot be read, or the clips or values do not fit the lab.
    pub(crate) fn new(from: &Ingredients<'_>) -> Result<Self, Failure> {
        let lab = from.command.lab;
        let query = from.link.map_or_else(|| format!("lab={lab}"), query_of);
        let mut driven = Self {
            session: Session::new(),
            ids: Vec::new(),
            values: Vec::new(),
            notes: Vec::new(),
        };
        for clip in &from.clips {
            // A recipe is known once a link has named it.
            if let Clip::Known(id) = clip {
                let id = utf8_percent_encode(id, NON_ALPHANUMERIC);
                driven.apply(Command::OpenLink(format!("lab=view&a={id}")))?;
            }
        }
        driven.apply(Command::OpenLink(query))?;
        let opened = driven.session.params().lab().word();
        if opened != lab {
            let name = command_of(opened).map_or(opened, |command| command.name);
            return Err(Failure::usage(format!(
                "the link opens another lab: use `segue {name} --link …`"
            )));
        }
        for skeleton in from.skeletons {
            driven.load(skeleton, from)?;
        }
        if let Some(body) = from.body {
            let ids = driven.load(body, from)?;
            let body = ids.into_iter().take(1).collect::<Vec<_>>();
            driven.values.push((Key::EditBody, List::ClipIds(body).into()));
        }
        for clip in &from.clips {
            match clip {
                Clip::File(file) => {
                    let ids = driven.load(file, from)?;
                    driven.ids.extend(ids);
                }
                Clip::Known(id) => driven.ids.push(id.clone()),
            }
        }
        if from.link.is_none() && !driven.ids.is_empty() {
            let clips = driven.clip_values(from.command)?;
            driven.values.splice(0..0, clips);
        }
        driven.values.extend(from.values.iter().cloned());
        driven.set(Vec::new())?;
        Ok(driven)
    }

    /// Sets the values of the command line after some others, which change first.
    ///
    /// # Errors
    /// [`Failure`] if one of them does not fit.
    pub(crate) fn set(&mut self, mut first: Vec<(Key, Value)>) -> Result<(), Failure> {
        first.extend(self.values.iter().cloned());
        if first.is_empty() { Ok(()) } else { self.apply(Command::Set(first)) }
    }

    fn apply(&mut self, command: Command) -> Result<(), Failure> {
        self.session.apply(command).map_err(|error| Failure::usage(error.to_string()))
    }

    /// Returns the values that put the clips into the lab.
    fn clip_values(&self, command: &LabCommand) -> Result<Vec<(Key, Value)>, Failure> {
        let (ids, name) = (self.ids.as_slice(), command.name);
        let refusal = |count: &str| {
            Failure::usage(format!("`segue {name}` takes {count}; here are {}", ids.len()))
        };
        match command.clips {
            Clips::None => Err(refusal("no clips")),
            // Shown one after the other.
            Clips::Each => Ok(Vec::new()),
            Clips::List => self.session.with_clips(ids).ok_or_else(|| refusal("fewer clips")),
            Clips::Slots => {
                if let Some(values) = self.session.with_clips(ids) {
                    return Ok(values);
                }
                let takes_more = Key::WarpAlso.param().is_used_by(self.session.params().lab());
                let (pair, more) = ids.split_at_checked(2).unwrap_or((ids, &[]));
                let values = self.session.with_clips(pair).filter(|_| takes_more);
                let mut values = values.ok_or_else(|| refusal("two clips, first A and then B"))?;
                // The same weight for each: A has what the others leave.
                let weight = (100.0 / ids.len() as f64).round() / 100.0;
                let also = more.iter().map(|id| (id.clone(), weight)).collect();
                values.push((Key::WarpWeight, Value::Number(weight)));
                values.push((Key::WarpAlso, List::WeightedClips(also).into()));
                Ok(values)
            }
        }
    }

    /// Loads a file. Returns the ids of its clips.
    fn load(&mut self, file: &ClipFile, from: &Ingredients<'_>) -> Result<Vec<String>, Failure> {
        let (content, size) = (Content::Here(Arc::clone(&file.bytes)), file.bytes.len() as u64);
        // A clip that a link names keeps its slot.
        let task = if from.link.is_some() {
            self.session.begin_reading_fetched(&file.name, content, size)
        } else {
            self.session.begin_reading(&file.name, content, size)
        };
        let mut ids = Vec::new();
        for (of, loaded) in self.answer_requests().read {
            match loaded {
                Ok(loaded) if of == task => ids = loaded,
                Ok(_) => {}
                Err(reason) if of == task => return Err(Failure::unreadable(reason)),
                Err(reason) => self.notes.push(reason),
            }
        }
        let library = self.session.library();
        ids.retain(|id| library.get(id).is_some());
        if ids.is_empty() && !from.skeletons.iter().any(|skeleton| skeleton.name == file.name) {
            return Err(Failure::unreadable(format!("{}: it has no motion", file.name)));
        }
        if from.options != ImportOptions::default() {
            for id in ids.clone() {
                self.apply(Command::File(FileCommand::Reimport(id, from.options)))?;
            }
            self.answer_requests();
        }
        Ok(ids)
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
                    Request::Fetch(address) => self.notes.push(format!(
                        "{address} is not fetched: download it, and name the file on the command line"
                    )),
                    Request::Lesson(_) | Request::StopReading { .. } => {}
                }
            }
        }
    }

    /// Does all work that the results need. What else the session would do is for those who look at
    /// it.
    pub(crate) fn settle(&mut self) {
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
    pub(crate) fn results(&self) -> Vec<(Option<String>, Result<PaneResult<'_>, NoResult>)> {
        let panes = self.session.panes().iter();
        let name = |pane| self.session.variant_name(pane).map(|name| name.to_string());
        panes.map(|pane| (name(pane), pane.result())).collect()
    }

    /// Returns what the session had to say, a sentence each.
    pub(crate) fn all_notes(&self) -> Vec<String> {
        let said = self.session.notices().list().iter();
        let said = said.filter(|notice| notice.level != Level::Info);
        self.notes.iter().cloned().chain(said.map(|notice| notice.text.to_string())).collect()
    }
}

/// Returns the query of a link: all behind its question mark, without a fragment.
pub(crate) fn query_of(link: &str) -> String {
    let query = link.split_once('?').map_or(link, |(_, query)| query);
    query.split('#').next().unwrap_or_default().to_owned()
}

/// Returns the id of a clip that needs no file: of a built-in one, or a recipe such as
/// `run(turn_rate:20)`.
pub(crate) fn known_clip(session: &Session, word: &str) -> Option<String> {
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
