//! The open lesson: its text is requested when it is needed, and its links set parameters.

use super::page::Page;
use super::parse::{LessonError, parse};
use super::sources::{CONTENTS, LESSONS, Source, source_of};
use crate::link::{self, Link};
use crate::params::{Group, Key, Kind, Mark, PARAMS, Param, Params};
use segue_text::{Message, msg};
use std::collections::BTreeMap;
use std::sync::Arc;

/// The content of the panel of lessons.
#[derive(Clone, Debug)]
pub enum Lesson<'a> {
    /// The list of the bundled lessons; see [`Page::entries`].
    Contents(&'a Page),
    /// A page.
    Page(LessonPage<'a>),
    /// A text that is being loaded.
    Waiting,
    /// A text that is not available, with the reason.
    Failed(Message),
}

/// An open page of a lesson.
#[derive(Clone, Debug)]
pub struct LessonPage<'a> {
    /// Its content.
    pub page: &'a Page,
    /// Its number, counted from 1: among the bundled lessons, or among the pages of a teacher's
    /// own.
    pub number: usize,
    /// The number of lessons or pages.
    pub of: usize,
    /// The value of the parameter `lesson` for the page before.
    pub previous: Option<String>,
    /// The value of the parameter `lesson` for the next page.
    pub next: Option<String>,
}

/// A text that was requested.
#[derive(Clone, Debug)]
enum Text {
    /// Requested, and not here yet.
    Awaited,
    /// Available.
    Here(Arc<[Page]>),
    /// Not loaded, or not a lesson; with the reason.
    Failed(Message),
}

/// The requested texts of lessons, and the lesson that is about to be set up.
#[derive(Clone, Debug)]
pub(crate) struct LessonState {
    /// The folder of the bundled lessons in the current language.
    language: &'static str,
    texts: BTreeMap<Source, Text>,
    /// The lesson whose page sets the parameters once its text is available.
    to_set_up: Option<String>,
    /// The parameters that were named together with it. They keep their values.
    set_besides: Vec<Key>,
    requests: Vec<Source>,
}

/// Parameters that replace the present ones, like those of a link that names some of them.
#[derive(Debug)]
pub(crate) struct NewParams {
    pub(crate) params: Params,
    pub(crate) named: Vec<Key>,
    /// The problems of the link.
    pub(crate) problems: Vec<Message>,
}

impl Default for LessonState {
    fn default() -> Self {
        Self {
            language: "en",
            texts: BTreeMap::new(),
            to_set_up: None,
            set_besides: Vec::new(),
            requests: Vec::new(),
        }
    }
}

impl LessonState {
    /// Returns the open lesson; `None` if there is none.
    pub(crate) fn lesson(&self, params: &Params) -> Option<Lesson<'_>> {
        let name = params.text(Key::Lesson);
        if name.is_empty() {
            return None;
        }
        let (source, index) = match source_of(name, self.language) {
            Ok(found) => found,
            Err(problem) => return Some(Lesson::Failed(problem)),
        };
        let pages = match self.texts.get(&source) {
            Some(Text::Here(pages)) => pages,
            Some(Text::Failed(problem)) => return Some(Lesson::Failed(problem.clone())),
            Some(Text::Awaited) | None => return Some(Lesson::Waiting),
        };
        let Some(page) = pages.get(index) else {
            let found = index + 1;
            return Some(Lesson::Failed(msg!(
                "lesson: found page {found}, expected 1 to {last}.",
                last = pages.len()
            )));
        };
        if name == CONTENTS {
            return Some(Lesson::Contents(page));
        }
        let page = match source {
            Source::BuiltIn(_) => {
                let at = LESSONS.iter().position(|lesson| *lesson == name).unwrap_or_default();
                let named = |at: Option<usize>| {
                    at.and_then(|at| LESSONS.get(at)).map(|name| (*name).to_owned())
                };
                LessonPage {
                    page,
                    number: at + 1,
                    of: LESSONS.len(),
                    previous: named(at.checked_sub(1)),
                    next: named(Some(at + 1)),
                }
            }
            Source::Web(address) => LessonPage {
                page,
                number: index + 1,
                of: pages.len(),
                previous: (index > 0).then(|| format!("{address}#{index}")),
                next: (index + 1 < pages.len()).then(|| format!("{address}#{}", index + 2)),
            },
        };
        Some(Lesson::Page(page))
    }

    /// Returns whether a link of the open page sets the parameters as they are, apart from camera
    /// and time.
    pub(crate) fn is_tried(&self, params: &Params, query: &str) -> bool {
        let Some(page) = self.page(params) else {
            return false;
        };
        let links =
            [page.state.as_ref().map_or("", |state| state.query.as_str()), query].map(link::read);
        let wanted = with_links(params, &links, false);
        let named = |key: Key| links.iter().any(|link| names(link, key));
        let counts = |param: &&Param| {
            // Those of the reader's own files stay.
            let is_own = param.key == Key::ContactEdits;
            (is_of_page_state(param) && !is_own)
                || (param.group == Group::Stage && named(param.key))
        };
        PARAMS.iter().filter(counts).all(|param| wanted.get(param.key) == params.get(param.key))
    }

    /// Stores the text of a lesson, or the reason why it did not arrive. A text that is not shown
    /// is kept.
    pub(crate) fn finish(&mut self, source: &Source, text: Result<&[u8], Message>) {
        let read = text.and_then(|bytes| parse(bytes).map_err(|error| unread(source, &error)));
        let text = match read {
            Ok(pages) => Text::Here(Arc::from(pages)),
            Err(problem) => Text::Failed(problem),
        };
        self.texts.insert(source.clone(), text);
    }

    /// Chooses the folder of the bundled lessons, `en` or `zh-Hant`. Returns whether it changed.
    pub(crate) fn set_language(&mut self, language: &'static str) -> bool {
        std::mem::replace(&mut self.language, language) != language
    }

    /// Returns the open page.
    fn page(&self, params: &Params) -> Option<&Page> {
        let (source, index) = source_of(params.text(Key::Lesson), self.language).ok()?;
        self.pages(&source)?.get(index)
    }

    /// Returns the pages of a text, if it is available.
    fn pages(&self, source: &Source) -> Option<&Arc<[Page]>> {
        match self.texts.get(source)? {
            Text::Here(pages) => Some(pages),
            Text::Awaited | Text::Failed(_) => None,
        }
    }

    /// Requests the text of the open lesson, if it was not requested yet.
    pub(crate) fn request_text(&mut self, params: &Params) {
        let name = params.text(Key::Lesson);
        if name.is_empty() {
            return;
        }
        let Ok((source, _)) = source_of(name, self.language) else {
            return;
        };
        if !self.texts.contains_key(&source) {
            self.texts.insert(source.clone(), Text::Awaited);
            self.requests.push(source);
        }
    }

    /// Returns the texts that were requested since the last call.
    pub(crate) fn take_requests(&mut self) -> Vec<Source> {
        std::mem::take(&mut self.requests)
    }

    /// Records that values were set together. A lesson that is opened without a lab sets the
    /// parameters, at once or when its text is available: [`Self::set_up`]. The other values that
    /// were set with it stay as they are. A lab shows that there is a whole state besides, which
    /// the lesson leaves as it is.
    pub(crate) fn note_set(&mut self, params: &Params, keys: &[Key]) {
        // Texts that failed are requested again.
        self.texts.retain(|_, text| !matches!(text, Text::Failed(_)));
        let lesson = params.text(Key::Lesson);
        let sets_up = !keys.contains(&Key::Lab) && !lesson.is_empty();
        self.to_set_up = sets_up.then(|| lesson.to_owned());
        self.set_besides = keys.iter().copied().filter(|&key| !is_about_the_reader(key)).collect();
    }

    /// Returns the parameters of the open page, if they are about to be set and its text is
    /// available.
    pub(crate) fn set_up(&mut self, params: &Params) -> Option<NewParams> {
        if self.to_set_up.as_deref() != Some(params.text(Key::Lesson)) {
            self.to_set_up = None;
            return None;
        }
        let state = self.page(params)?.state.as_ref().map(|state| link::read(&state.query));
        self.to_set_up = None;
        let state = state?;
        let mut new = with_links(params, std::slice::from_ref(&state), true);
        for &key in &self.set_besides {
            new.copy_from(params, key);
        }
        let named = state.values.iter().map(|(key, _)| *key);
        Some(NewParams {
            params: new,
            named: named.chain(self.set_besides.iter().copied()).collect(),
            problems: state.problems,
        })
    }

    /// Returns the parameters that a link of the open page sets; `None` if no lesson is open.
    pub(crate) fn try_params(&self, params: &Params, link: Link) -> Option<NewParams> {
        let page = self.page(params)?;
        let state = link::read(page.state.as_ref().map_or("", |state| state.query.as_str()));
        let problems = link.problems.clone();
        let links = [state, link];
        Some(NewParams {
            params: with_links(params, &links, false),
            named: links.iter().flat_map(|link| &link.values).map(|(key, _)| *key).collect(),
            problems,
        })
    }
}

/// Returns whether the link that [`link::write`] writes would make the open lesson set the
/// parameters.
pub(crate) fn would_set_up(params: &Params) -> bool {
    let mut named = link::named(params).map(|(param, _)| param.key);
    !params.text(Key::Lesson).is_empty() && !named.any(|key| key == Key::Lab)
}

/// Returns the parameters after several links, applied in order to the defaults of everything that
/// makes a result. Parameters about the reader stay as they are, as do A and B if no link names
/// them; stage, camera and time too, unless the page is `new`.
fn with_links(present: &Params, links: &[Link], new: bool) -> Params {
    let mut params = present.clone();
    let defaults = Params::default();
    let starts_anew =
        |param: &&Param| is_of_page_state(param) || (new && param.group != Group::Page);
    for param in PARAMS.iter().filter(starts_anew) {
        if !matches!(param.kind, Kind::Clip) {
            params.copy_from(&defaults, param.key);
        }
    }
    for (key, value) in links.iter().flat_map(|link| &link.values) {
        if !is_about_the_reader(*key) || *key == Key::Src {
            let result = params.set(*key, value.clone());
            debug_assert!(result.is_ok(), "links hold checked values: {result:?}");
        }
    }
    params
}

/// Returns the message about a file that is not a lesson.
fn unread(source: &Source, error: &LessonError) -> Message {
    let (Source::BuiltIn(name) | Source::Web(name)) = source;
    msg!("{name} is no lesson: {error}.")
}

/// Returns whether a link of a lesson sets a parameter even if it does not name it, because it
/// makes the result.
fn is_of_page_state(param: &Param) -> bool {
    param.group.is_of_lab() || param.has(Mark::State)
}

/// Returns whether a parameter is about the reader and not the stage. No lesson changes it.
fn is_about_the_reader(key: Key) -> bool {
    key.param().group == Group::Page && !is_of_page_state(key.param())
}

fn names(link: &Link, key: Key) -> bool {
    link.values.iter().any(|(named, _)| *named == key)
}
