//! The commands that change a session, the reasons why one cannot be carried out, and the session's
//! requests to the app.

use super::labs::{ClipEdit, Slot};
use super::lesson::Source;
use super::outside::short;
use super::pane::NoResult;
use super::params::{Key, Value, ValueError};
use super::reading::ReadTask;
use super::samples::{Sample, SampleSet};
use crate::bone_map::{BoneMap, BoneMapError};
use segue_formats::{ImportError, ImportOptions};
use segue_motion::matching::Control;
use segue_motion::skeleton::Role;

/// A change of the document. Buttons, shortcuts, links and the page's API all end here.
#[derive(Clone, Debug, PartialEq)]
pub enum Command {
    /// Sets parameters, all or none.
    Set(Vec<(Key, Value)>),
    /// Sets parameters of the camera, all or none, where the app moves it by itself, as when the
    /// Path lab shows the whole path: no step of undo.
    Frame(Vec<(Key, Value)>),
    /// Brings one parameter back to its default.
    Reset(Key),
    /// Ends a gesture: all changes of a slider since it was pressed are one step for undo.
    Settle,
    /// Replaces the parameters by those of a query string; those that it does not name return to
    /// their defaults.
    OpenLink(String),
    /// Puts a clip into a slot.
    Assign(Slot, String),
    /// Takes a clip out of the library.
    Remove(String),
    /// Takes a clip out of the library that was only looked at: without a notice, and without a
    /// step of undo.
    Discard(String),
    /// Takes several clips out of the library, in one step.
    RemoveAll(Vec<String>),
    /// Gives a clip another name.
    Rename(String, String),
    /// Puts the result of a pane, counted from 0, into the library.
    Keep(usize),
    /// Adds an edited clip to the library, by its recipe; with a slot, also puts it there, in the
    /// same step of undo.
    Edit(String, ClipEdit, Option<Slot>),
    /// Changes the library's files.
    File(FileCommand),
    /// Moves the playhead, plays or pauses.
    Playback(PlaybackCommand),
    /// Drives the characters of the Match lab.
    Drive(DriveCommand),
    /// Changes the clips that play beside the result.
    ExtraCharacters(ExtraCharacterCommand),
    /// Opens several values of a parameter side by side: full, half and a third of a number; the
    /// alternatives of a choice.
    Compare(Key),
    /// Applies a link of the open lesson to the state of its page; an empty link restores that
    /// state.
    Try(String),
    /// Takes back the last step.
    Undo,
    /// Makes the step again that was taken back last.
    Redo,
    /// Removes a notice, by its number.
    Dismiss(u64),
    /// Stops the construction of the graph and the walk, or resumes it.
    StopGraph(bool),
}

/// A change of the clips that play beside the result, by their place in the list, counted from 0.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum ExtraCharacterCommand {
    /// Adds a clip of the library.
    Add(String),
    /// Adds the result of a pane, and keeps it in the library; another path can be made then.
    AddResult(usize),
    /// Exchanges a clip with the one that is being edited.
    Edit(usize),
    /// Removes a clip from the stage; it stays in the library.
    Remove(usize),
}

/// A change of the playhead.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PlaybackCommand {
    /// Moves the playhead, seconds.
    Seek(f64),
    /// Moves the playhead by whole frames and pauses.
    Step(i64),
    /// Plays or pauses.
    TogglePlay,
}

/// A change of the characters that the user drives.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum DriveCommand {
    /// Changes the input from now on.
    Steer(Control),
    /// Puts the characters back at the origin, and discards the recorded input.
    Restart,
    /// Plays the recorded input again: it becomes the parameter `drive`.
    Replay,
}

/// A change of the library's files.
#[derive(Clone, Debug, PartialEq)]
pub enum FileCommand {
    /// Loads all takes of a bundled set into the library.
    LoadSamples(&'static SampleSet),
    /// Corrects by hand which joints of a clip have roles, in all clips of its rig, as one step.
    SetRoles(String, Vec<(Role, Option<usize>)>),
    /// Takes back the corrections of a clip's rig: the roles are those that were found.
    ResetRoles(String),
    /// Applies a bone map to the clips that it fits, as one step.
    ApplyBoneMap(BoneMap),
    /// Reads a clip's file again with other options.
    Reimport(String, ImportOptions),
    /// Reads the clips of a notice again with better options, as one step, and removes the notice.
    Correct(u64),
    /// Stops reading a file, by the number of its task.
    StopReading(u64),
    /// Stops reading all files that are to join the library.
    StopReadingNew,
    /// Reads the motion of a clip again if it is not in memory.
    Read(String),
}

/// The reason why a command could not be carried out. The session is unchanged.
#[derive(Clone, Debug, PartialEq, thiserror::Error, segue_text::ToMessage)]
pub enum CommandError {
    /// A value that does not fit.
    #[error(transparent)]
    Value(#[from] ValueError),
    /// A file that cannot be read.
    #[error(transparent)]
    Import(#[from] ImportError),
    /// A bone map that cannot be read.
    #[error(transparent)]
    BoneMap(#[from] BoneMapError),
    /// A clip that is not there.
    #[error("there is no clip `{id}` in the library", id = short(.0))]
    NoClip(String),
    /// A pane without a result to keep.
    #[error(transparent)]
    NoResult(#[from] NoResult),
    /// Not possible with this clip.
    #[error("{0}")]
    NotPossible(&'static str),
}

/// A request of the session to the app.
#[derive(Clone, Debug, PartialEq)]
pub enum Request {
    /// A bundled take: hand its packed bytes to [`super::Session::load_sample`], or the reason why
    /// there are none to [`super::Session::fail_sample`].
    Sample(&'static Sample),
    /// A file at an address; hand its bytes to [`super::Session::load_fetched`].
    Fetch(String),
    /// The text of a lesson; hand its bytes to [`super::Session::finish_lesson`].
    Lesson(Source),
    /// A file that takes too long to be read between two frames: read it elsewhere, and hand the
    /// report to [`super::Session::finish_reading`].
    Read(ReadTask),
    /// A task that was stopped.
    StopReading {
        /// The task's number.
        task: u64,
        /// The key of a file outside the document that is no longer needed.
        forget: Option<String>,
    },
}

macro_rules! from_part {
    ($($part:ident $variant:ident)*) => {$(
        impl From<$part> for Command {
            fn from(command: $part) -> Self {
                Self::$variant(command)
            }
        }
    )*};
}

from_part! {
    FileCommand File
    PlaybackCommand Playback
    DriveCommand Drive
    ExtraCharacterCommand ExtraCharacters
}
