//! Labs: results made from clips and parameters, as pure functions of their inputs.

mod analyses;
mod answer;
mod artefact_meter;
mod blend;
mod clean;
mod delegated;
mod edit;
mod error;
mod feet;
mod graph;
mod in_place;
pub(super) mod lab;
mod lab_set;
mod layers;
mod long_results;
mod loop_;
mod make;
mod match_;
mod on_character;
mod outcome;
mod pair;
mod path;
mod recipe;
mod register;
mod remedy;
mod repetition;
mod request_cache;
pub(super) mod sliced;
mod speed;
mod transition;
mod view;

pub(super) use answer::Answer;
pub(super) use artefact_meter::ArtefactMeter;
pub use blend::mistake_shows;
pub use clean::{CleanFacts, FoundFault, cleaned};
pub(super) use edit::edit_params;
pub use edit::{ClipEdit, edits_of};
pub use error::LabError;
pub use graph::{
    BuiltGraph, DistanceField, Distances, FollowedPath, GraphClips, Walk, WalkGhost, WalkMoment,
    WalkStay, check_graph_clips, graph_of,
};
pub(super) use graph::{clips_of, visits_of};
pub(super) use lab::{Inputs, LabClips, MoreClip, slots_of};
pub(super) use lab_set::{LabSet, lab_of};
pub use layers::{LayerFacts, LayerFit};
pub(super) use long_results::PairLabs;
pub(super) use make::{has as made_motion_has, preset_motion, range_of, synth_action};
#[cfg(test)]
pub(super) use match_::options_of;
pub use match_::{DriveHistory, DriveMoment, own_words};
pub(super) use match_::{DrivenPane, LiveDrive, filter_of};
pub use on_character::CharacterMotion;
pub use outcome::{
    Cycle, CycleMade, MatchSearch, Outcome, PlacedClip, RetargetReport, Slot, Transition,
};
pub(super) use outcome::{LabFacts, MeasuredMotion};
pub use path::{FittedMotion, PathFacts, spline_ends};
pub use recipe::file_stem;
pub(super) use recipe::{recipe_id, recipe_ingredients, recipe_name, recipe_params};
pub use register::{DistanceMap, FramePair, RegistrationFacts, weight_curve};
pub(super) use register::{RegistrationRequest, registered, terms_of};
pub use remedy::Remedy;
pub(super) use remedy::remedies;
pub use sliced::JobKind;
pub(super) use speed::{SpeedInputs, middle_mps};
pub use view::metrics_of_clip;

#[cfg(test)]
mod foot_lock_tests;
#[cfg(test)]
mod quadruped_tests;
#[cfg(test)]
mod retarget_tests;
