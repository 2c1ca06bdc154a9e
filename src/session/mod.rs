//! The document: the library, the parameters, what is made from them, and everything that can be done to it.
//!
//! One direction: a link, a slider or the page's API gives a [`Command`]; [`Session::apply`] changes the document and recomputes what
//! depends on the change; the scene and the panels are drawn from what then stands here. Nothing here knows a screen, a file system or a clock.

mod command;
mod compare;
mod document;
pub mod export;
pub mod lesson;
mod library;
pub mod link;
mod motion;
mod notice;
mod numbers;
mod params;
pub mod reading;
mod recipe;
mod report;
mod saved;
pub mod transport;
mod undo;

pub use command::{Command, CommandError, CompanyChange, Request};
pub use compare::{Compare, MAX_PANES};
pub use document::{ClipInfo, Companion, Job, Lesson, LessonPage, Loaded, Pane, Session, Shown};
pub use library::{Entry, Library, Origin, SAMPLES_CREDIT, Sample, SourceFile, file_id, split_reference};
pub use motion::{Motion, curve_kind, frame_at, joint_of, word_of_joint};
pub use notice::{Level, Notice, Notices};
pub use numbers::{NumberRow, NumberTable, digits};
pub use params::{Choice, Group, Key, Kind, PARAMS, Param, Params, Value, ValueError, decimals_of, format_number};
pub use recipe::write_ids;
pub use recipe::{At, Built, Cast, Field, Passed, Trace, Walk, WalkGhost, write_jump, write_path, write_visits};
pub use recipe::{Beat, DistanceMap, DriveMoment, Driven, FittedMotion, OnPath, Registered};
pub use recipe::{Cycle, CycleMade, LayerFacts, LayerFit, Outcome, Retargeted, Slot, Source, Transition, mistake_shows};
pub use recipe::{HandTag, own_words, write_tags};
pub use recipe::{MOST_ALSO, weight_curve, write_also, write_pairs};
pub use report::{ReportFacts, report};
pub use saved::{Saved, SavedEntry};
