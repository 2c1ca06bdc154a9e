//! The document: the library, the parameters, the results made from them, and the commands that
//! change them.
//!
//! # The idea
//!
//! There is one way in and one way out, and both are data:
//!
//! ```text
//! link, slider, API → Command → Session::apply → recipe (inputs → clip, numbers) → panes → scene
//! ```
//!
//! One table ([`PARAMS`]) defines the parameters: their keys in the link, ranges, steps, defaults
//! and help. Sliders, link, API, comparison and undo are made from it. A *recipe* is a pure
//! function of clips and parameters. Its inputs are stored with its result, so that unchanged
//! results are not computed again, as in a spreadsheet, where a change recomputes only the cells
//! that depend on it.
//!
//! Work that takes longer than a frame is cut into slices ([`Session::work`]). Files and texts from
//! outside are requested from the app ([`Request`]) and handed over; nothing here depends on a
//! screen, a file system or a clock. Time is advanced by [`Session::tick`].
//!
//! # Example
//!
//! ```
//! use segue_session::{Command, Key, Session, Value};
//!
//! // The first visit shows one blend in three panes, with windows of 30, 15 and 10 frames.
//! let mut session = Session::new();
//! while session.work() {}
//! assert_eq!(session.panes().len(), 3);
//! assert_eq!(session.query(), "compare=blend_window:30,15,10");
//!
//! let window = |frames| Command::Set(vec![(Key::BlendWindow, Value::Number(frames))]);
//! session.apply(Command::OpenLink("blend_window=24".into()))?;
//! session.apply(window(12.0))?;
//! let transition = session.main_outcome().and_then(|outcome| outcome.transition);
//! assert_eq!(transition.map(|transition| transition.window_frames), Some(12));
//! assert_eq!(session.query(), "blend_window=12");
//!
//! // An invalid value is refused with a sentence, and changes nothing.
//! let error = session.apply(window(1000.0)).err().ok_or("it was taken")?;
//! assert!(error.to_string().contains("1 to 240") && session.query() == "blend_window=12");
//!
//! // The link is the state: another session makes the same motion from it. Undo takes steps back.
//! let mut other = Session::new();
//! other.apply(Command::OpenLink(session.query()))?;
//! let clip = |session: &Session| session.main_outcome().map(|made| made.motion.clip().clone());
//! assert!(clip(&session).is_some() && clip(&session) == clip(&other));
//! session.apply(Command::Undo)?;
//! assert_eq!(session.query(), "blend_window=24");
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # Accuracy and cost
//!
//! The same link gives the same motion; numbers in it are whole multiples of their parameter's
//! step. A change costs as much as the recipes that depend on it: turning the camera recomputes
//! nothing.
//!
//! # What it does not do
//!
//! It draws nothing, plays nothing by itself, and stores nothing: [`Saved`] is the state that an
//! app may store. A link contains parameters, not data: it names a file by its name and the first
//! digits of its SHA-256, and the reader of the link must have that file.

pub mod bone_map;
mod built_in;
mod clip_facts;
mod clip_info;
mod clip_resolver;
mod clip_sets;
mod command;
mod compare;
mod contact_edits;
pub mod conversion;
pub mod convert;
mod document;
pub mod export;
mod extra_characters;
mod files;
#[cfg(test)]
mod fixtures;
mod hex;
pub mod jobs;
mod labs;
pub mod lesson;
mod library;
pub mod link;
mod memory;
pub mod metrics;
mod missing;
mod motion;
mod notice;
mod numbers;
pub mod outside;
pub mod packed;
mod pane;
mod panes;
mod params;
mod playback;
pub mod reading;
mod report;
mod samples;
mod saved;
mod session;

pub use clip_facts::ClipFacts;
pub use clip_info::ClipInfo;
pub use clip_sets::ClipSet;
pub use command::{
    Command, CommandError, DriveCommand, ExtraCharacterCommand, FileCommand, PlaybackCommand,
    Request,
};
pub use contact_edits::ContactClip;
pub use extra_characters::ExtraCharacter;
pub use files::{Job, LoadedFile};
pub use hex::hex;
pub use labs::{
    BuiltGraph, DistanceField, Distances, FollowedPath, GraphClips, Walk, WalkGhost, WalkMoment,
    WalkStay, check_graph_clips, graph_of,
};
pub use labs::{
    CharacterMotion, CleanFacts, Cycle, CycleMade, FoundFault, LayerFacts, LayerFit, MatchSearch,
    Outcome, PlacedClip, RetargetReport, Slot, Transition, mistake_shows,
};
pub use labs::{ClipEdit, LabError, Remedy, edits_of};
pub use labs::{
    DistanceMap, DriveHistory, DriveMoment, FittedMotion, FramePair, PathFacts, RegistrationFacts,
    spline_ends,
};
pub use labs::{JobKind, cleaned, file_stem, metrics_of_clip, own_words, weight_curve};
pub use lesson::{Lesson, LessonPage};
pub use library::{ClipGroup, Entry, Library, Origin, SourceFile, file_id, split_reference};
pub use memory::{MemoryUse, PageMemory};
pub use motion::{curve_kind, foot_options, frame_at, joint_of, word_of_joint};
pub use notice::{AddedClips, Level, Notice, Notices};
pub use numbers::{NumberRow, NumberTable, digits, listed_metrics};
pub use pane::{NoResult, Pane, PaneContent, PaneResult};
pub use params::choices::{self, LabId, Selected};
pub use params::{
    Choice, ClipContacts, Compare, Group, HandTag, Key, Kind, List, ListKind, MAX_MORE_CURVES,
    MAX_PANES, MAX_WEIGHTED_CLIPS, Mark, Misread, PARAMS, Param, Params, Value, ValueError,
    decimals_of, format_number, write_ids,
};
pub use playback::Span;
pub use report::{ReportFacts, report};
pub use samples::{SAMPLES_CREDIT, Sample, SampleSet};
pub use saved::{KnownClip, Saved, SavedEntry, StorageState};
pub use session::Session;
