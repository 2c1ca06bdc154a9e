//! The lesson that is open: its text is asked for when it is needed, and its links lay a state over
//! the document.

use super::Session;
use crate::command::{CommandError, Request};
use crate::lesson::{CONTENTS, LESSONS, LessonError, Page, Source, Text, parse, source_of};
use crate::link::{self, Link};
use crate::missing::look_for_clips;
use crate::notice::Level;
use crate::params::{Group, Key, Mark, PARAMS, Param, Params};
use segue_text::{Message, msg};
use std::sync::Arc;

/// So many of a link's problems are named, the others are counted.
const MOST_PROBLEMS: usize = 6;

/// What the panel of lessons shows.
#[derive(Clone, Debug)]
pub enum Lesson<'a> {
    /// The list of the lessons that come with Segue; see [`Page::entries`].
    Contents(&'a Page),
    /// A page.
    Page(LessonPage<'a>),
    /// A text is under way.
    Waiting,
    /// There is no such text: why.
    Failed(Message),
}

/// The page of a lesson that is open.
#[derive(Clone, Debug)]
pub struct LessonPage<'a> {
    /// What it says.
    pub page: &'a Page,
    /// Its place, counted from 1: among the lessons that come with Segue, or among the pages of a
    /// teacher's own.
    pub number: usize,
    /// How many there are.
    pub of: usize,
    /// What the parameter `lesson` is for the page before.
    pub previous: Option<String>,
    /// Likewise for the page behind.
    pub next: Option<String>,
}

impl Session {
    /// The lesson that is open; `None` where none is.
    #[must_use]
    pub fn lesson(&self) -> Option<Lesson<'_>> {
        let name = self.document.params.text(Key::Lesson);
        if name.is_empty() {
            return None;
        }
        let (source, index) = match source_of(name, self.shelf.language) {
            Ok(found) => found,
            Err(problem) => return Some(Lesson::Failed(problem)),
        };
        let pages = match self.shelf.texts.get(&source) {
            Some(Text::Here(pages)) => pages,
            Some(Text::Failed(problem)) => return Some(Lesson::Failed(problem.clone())),
            Some(Text::Asked) | None => return Some(Lesson::Waiting),
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

    /// Whether what a link of the open page sets is what there is. Where the camera stands and what
    /// time it is do not matter.
    #[must_use]
    pub fn is_tried(&self, query: &str) -> bool {
        let Some(page) = self.lesson_page() else {
            return false;
        };
        let links =
            [page.state.as_ref().map_or("", |state| state.query.as_str()), query].map(link::read);
        let wanted = self.laid_over(&links, false);
        let named = |key: Key| links.iter().any(|link| names(link, key));
        let counts = |param: &&Param| {
            is_of_page_state(param) || (param.group == Group::Stage && named(param.key))
        };
        PARAMS
            .iter()
            .filter(counts)
            .all(|param| wanted.get(param.key) == self.document.params.get(param.key))
    }

    /// Takes the text of a lesson, or why it did not come. A text that nobody waits for is kept.
    pub fn finish_lesson(&mut self, source: &Source, text: Result<&[u8], Message>) {
        let read = text.and_then(|bytes| parse(bytes).map_err(|error| unread(source, &error)));
        let text = match read {
            Ok(pages) => Text::Here(Arc::from(pages)),
            Err(problem) => Text::Failed(problem),
        };
        self.shelf.texts.insert(source.clone(), text);
        if self.set_up() {
            self.refresh();
            self.begin_anew();
        }
        self.revision += 1;
    }

    /// From now on, the lessons that come with Segue are those in this language: a folder of
    /// theirs, `en` or `zh-Hant`.
    pub fn read_lessons_in(&mut self, language: &'static str) {
        if self.shelf.language != language {
            self.shelf.language = language;
            self.ask_for_lesson();
            self.revision += 1;
        }
    }

    /// The page that is open.
    fn lesson_page(&self) -> Option<&Page> {
        let (source, index) =
            source_of(self.document.params.text(Key::Lesson), self.shelf.language).ok()?;
        self.shelf.pages(&source)?.get(index)
    }

    /// Asks for the text of the open lesson, where it was not asked for yet.
    pub(super) fn ask_for_lesson(&mut self) {
        let name = self.document.params.text(Key::Lesson);
        if name.is_empty() {
            return;
        }
        let Ok((source, _)) = source_of(name, self.shelf.language) else {
            return;
        };
        if !self.shelf.texts.contains_key(&source) {
            self.shelf.texts.insert(source.clone(), Text::Asked);
            self.requests.push(Request::Lesson(source));
        }
    }

    /// Values were taken over together. A lesson that is opened and nothing besides sets the
    /// document up, at once or when its text is here; with other values it is read beside what they
    /// say.
    pub(super) fn lesson_was_set(&mut self, values: impl IntoIterator<Item = Key>) {
        // What did not come may come now.
        self.shelf.texts.retain(|_, text| !matches!(text, Text::Failed(_)));
        let alone = values.into_iter().all(is_about_the_reader);
        let lesson = self.document.params.text(Key::Lesson);
        self.shelf.to_set_up = (alone && !lesson.is_empty()).then(|| lesson.to_owned());
        self.set_up();
    }

    /// Whether a link that names only what is not as in the table would set the document up for a
    /// lesson, in place of what is there.
    pub(super) fn would_set_up(&self) -> bool {
        let mut changed = self.document.params.changed().map(|(param, _)| param.key);
        !self.document.params.text(Key::Lesson).is_empty() && changed.all(is_about_the_reader)
    }

    /// Sets the document up as the open page says, if it waits for that and the text is here.
    /// Whether it did.
    fn set_up(&mut self) -> bool {
        if self.shelf.to_set_up.as_deref() != Some(self.document.params.text(Key::Lesson)) {
            self.shelf.to_set_up = None;
            return false;
        }
        let Some(page) = self.lesson_page() else {
            return false;
        };
        let state = page.state.as_ref().map(|state| link::read(&state.query));
        self.shelf.to_set_up = None;
        let Some(state) = state else { return false };
        let params = self.laid_over(std::slice::from_ref(&state), true);
        let named: Vec<Key> = state.values.iter().map(|(key, _)| *key).collect();
        self.take_over(params, &state.problems, &named);
        true
    }

    /// What a link of the open page asks for, as one step for undo.
    pub(super) fn try_out(&mut self, query: &str) -> Result<(), CommandError> {
        let link = link::read(query);
        if let Some(lesson) = link.values.iter().find(|(key, _)| *key == Key::Lesson) {
            if self.document.params.get(Key::Lesson) == &lesson.1 {
                // It is open already: what did not come is asked for again.
                self.document.remember(None);
                self.lesson_was_set([Key::Lesson]);
            }
            self.set(vec![lesson.clone()])?;
            self.document.settle();
            return Ok(());
        }
        let page = self.lesson_page().ok_or(CommandError::NotPossible("no lesson is open"))?;
        let state = link::read(page.state.as_ref().map_or("", |state| state.query.as_str()));
        let problems = link.problems.clone();
        let links = [state, link];
        let named: Vec<Key> =
            links.iter().flat_map(|link| &link.values).map(|(key, _)| *key).collect();
        let params = self.laid_over(&links, false);
        self.document.remember(None);
        self.take_over(params, &problems, &named);
        Ok(())
    }

    /// What the parameters are when links are laid over each other, and over nothing else that
    /// makes a result. What is about the reader stays as it is, as do A and B where no link names
    /// them; stage, camera and time too, unless the page is `new`.
    fn laid_over(&self, links: &[Link], new: bool) -> Params {
        let mut params = self.document.params.clone();
        let defaults = Params::default();
        let starts_anew =
            |param: &&Param| is_of_page_state(param) || (new && param.group != Group::Page);
        for param in PARAMS.iter().filter(starts_anew) {
            if !matches!(param.key, Key::A | Key::B) {
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

    /// Takes over all parameters, as those of a link that names some of them: says what is wrong
    /// with it and what is missing.
    pub(super) fn take_over(&mut self, params: Params, problems: &[Message], named: &[Key]) {
        let new_sources = self.document.replace_params(params, named);
        match problems.get(MOST_PROBLEMS..).map_or(0, <[_]>::len) {
            _ if problems.is_empty() => {}
            0 => self.say(
                Level::Warning,
                msg!(
                    "The link was used, but for this: {problems}.",
                    problems = Message::joined(problems.to_vec(), "; ")
                ),
            ),
            more => {
                let first = problems.get(..MOST_PROBLEMS).unwrap_or(problems);
                self.say(
                    Level::Warning,
                    msg!(
                        "The link was used, but for this: {first}; and {more} more like these.",
                        first = Message::joined(first.to_vec(), "; ")
                    ),
                );
            }
        }
        self.fetch(new_sources);
        look_for_clips(&mut self.document, &mut self.notices);
        self.labs.grapher.stop(false);
    }
}

/// What is said of a file that is no lesson.
fn unread(source: &Source, error: &LessonError) -> Message {
    let (Source::BuiltIn(name) | Source::Web(name)) = source;
    msg!("{name} is no lesson: {error}.")
}

/// What a link of a lesson sets even where it does not name it: what makes the result.
fn is_of_page_state(param: &Param) -> bool {
    param.group.is_of_lab() || param.has(Mark::State)
}

/// What belongs to who reads, and not to what is shown: no lesson changes it.
fn is_about_the_reader(key: Key) -> bool {
    key.param().group == Group::Page && !is_of_page_state(key.param())
}

fn names(link: &Link, key: Key) -> bool {
    link.values.iter().any(|(named, _)| *named == key)
}
