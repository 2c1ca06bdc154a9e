//! The requests of the panels, which change nothing themselves.

use segue_session::export::ExportOptions;
use segue_session::{Command, Compare, Key, Value};

/// A step of a conversion of many files.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum ConvertAction {
    /// Add clips of the library, by their ids.
    AddClips(Vec<String>),
    /// Convert all files and clips that were added.
    Start {
        /// The format and its options.
        how: ExportOptions,
        /// Whether motions are put on the body of A.
        onto_a: bool,
        /// Whether all are saved in one file.
        in_one_file: bool,
    },
    /// Stop, and save what is done.
    Stop,
    /// Remove the files that were added, and the last result.
    Clear,
}

/// A request to the platform.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Action {
    /// Let the user choose files.
    OpenFiles,
    /// Let the user choose a corpus.
    ChooseCorpus,
    /// Open a page of the web beside this one.
    OpenPage(String),
    /// Put the address of this state into the clipboard, for readers with a type size and a
    /// language of their own.
    CopyLink,
    /// Put the address of this state into the clipboard, with the type size and the language.
    CopyLinkAsShown,
    /// Show the page on the whole screen, or in its window again.
    Fullscreen(bool),
    /// Stop fetching a file, by its name.
    StopFetching(String),
    /// Stop waiting for the open lesson.
    StopLesson,
    /// Save a motion as a file.
    Save {
        /// A clip's id, `result`, or `result:1` for the second pane.
        which: String,
        /// The format and its options.
        how: ExportOptions,
    },
    /// Convert files, or stop that.
    Convert(ConvertAction),
    /// Put a report on the present state into the clipboard, with a picture.
    CopyReport,
    /// Put a text into the clipboard.
    CopyText(String),
    /// Save a text as a file.
    SaveText {
        /// The file's name.
        name: &'static str,
        /// Its media type.
        mime: &'static str,
        /// Its content.
        text: String,
    },
    /// Save the stage as a picture.
    SavePicture,
    /// Start a video of the page, or end it and save it.
    Record,
}

/// The requests of one frame.
#[derive(Debug, Default)]
pub(crate) struct Out {
    /// Changes of the document, in order.
    pub(crate) commands: Vec<Command>,
    /// Requests to the platform.
    pub(crate) actions: Vec<Action>,
    /// The parameters whose rows were shown and that can be compared, in order.
    pub(crate) rows: Vec<Key>,
}

impl Out {
    /// Sets one parameter.
    pub(crate) fn set(&mut self, key: Key, value: Value) {
        self.commands.push(Command::Set(vec![(key, value)]));
    }

    /// Sets one parameter in one step of its own.
    pub(crate) fn set_once(&mut self, key: Key, value: Value) {
        self.set(key, value);
        self.commands.push(Command::Settle);
    }

    /// Opens values side by side, or one pane, in one step of its own.
    pub(crate) fn compare(&mut self, compare: Option<Compare>) {
        self.set_once(Key::Compare, Value::Compare(compare));
    }

    /// Brings a parameter back to its default, in one step of its own.
    pub(crate) fn reset(&mut self, key: Key) {
        self.commands.push(Command::Reset(key));
    }

    /// Turns a switch on or off.
    pub(crate) fn toggle(&mut self, key: Key, on: bool) {
        self.set_once(key, Value::Switch(!on));
    }
}
