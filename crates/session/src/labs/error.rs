//! Why a lab has no result.

use segue_formats::ImportError;
use segue_motion::blend::{BlendError, LayerError};
use segue_motion::clip::{ClipError, RetargetError, RootWayError};
use segue_motion::gait::GaitError;
use segue_motion::graph::GraphError;
use segue_motion::matching::MatchError;
use segue_motion::path::PathEditError;
use segue_motion::registration::{PathError, RegistrationError};
use segue_motion::synth::SynthError;
use segue_motion::transition::{FootLockError, LoopError};
use segue_text::{Message, ToMessage};

/// The most clips of a motion graph: the picture of its distances shows no more.
pub(crate) const MOST_CLIPS: usize = 64;

/// Why a lab has no result, and what to do.
#[derive(Clone, Debug, PartialEq, thiserror::Error, ToMessage)]
pub enum LabError {
    /// A clip that the parameters name is not in the library.
    #[error("`{name}` is not here: drop its file, or choose another clip.")]
    MissingClip {
        /// Its name.
        name: String,
    },
    /// A bundled take is on its way.
    #[error("{name} is being loaded.")]
    Loading {
        /// Its name.
        name: &'static str,
    },
    /// An id that is no recipe.
    #[error("`{id}` names no motion.")]
    NoRecipe {
        /// The id.
        id: String,
    },
    /// A preset that there is not.
    #[error("`{id}` is no built-in motion.")]
    NoPreset {
        /// Its id.
        id: String,
    },
    /// A motion without its skeleton.
    #[error("{file} waits for its skeleton: drop its .asf file.")]
    AwaitsSkeleton {
        /// The motion's file.
        file: String,
    },
    /// The clip's file was not read.
    #[error("{0}")]
    Unread(Message),
    /// The clip's file is being read.
    #[error("{file} is being read.")]
    Reading {
        /// The file.
        file: String,
    },
    /// The file is another one by now.
    #[error("{file} has no such clip any more.")]
    NoSuchClip {
        /// The file.
        file: String,
    },
    /// A clip is itself a result that is computed.
    #[error("{name} is being made.")]
    BeingMade {
        /// What the clip is called.
        name: String,
    },
    /// Of one clip among several.
    #[error("{name}: {error}")]
    OfClip {
        /// What the clip is called.
        name: String,
        /// Why it cannot take part.
        error: Box<LabError>,
    },
    /// There is no first clip.
    #[error("There is no clip in A.")]
    NoClip,
    /// There are not two clips.
    #[error("There are no clips in A and B.")]
    NoPair,
    /// There is nothing to find a place in.
    #[error("there are no clips to match")]
    NothingToMatch,
    /// There is nothing to register.
    #[error("There are no clips to register.")]
    NothingToRegister,
    /// A cycle without frames.
    #[error("the cycle has no frames")]
    EmptyCycle,
    /// The user stopped the computation.
    #[error("Stopped. Change anything, or go on.")]
    Stopped,
    /// The graph has no clips.
    #[error("A motion graph needs a clip: add at least one.")]
    NoGraphClips,
    /// The graph has too many clips.
    #[error("These are {count} clips: take {MOST_CLIPS} at most.")]
    TooManyGraphClips {
        /// How many.
        count: usize,
    },
    /// Mistakes of the transform and of the angle at once.
    #[error(
        "Two mistakes at once cannot be told apart: choose the transform of the whole clip, or atan2."
    )]
    TwoMistakes,
    /// The walk is to visit a clip that there is not.
    #[error("Go to: there is no clip {clip}, they are counted from 0 to {last}.")]
    NoVisit {
        /// The clip's index.
        clip: usize,
        /// The index of the last one.
        last: usize,
    },
    /// The transition that is played alone is not in the graph any more.
    #[error(
        "There is no transition from frame {leave} of {from} to frame {enter} of {to} any more: go back to the walk, or raise the threshold."
    )]
    NoJump {
        /// The frame that is left.
        leave: usize,
        /// The clip that is left.
        from: String,
        /// The frame that is entered.
        enter: usize,
        /// The clip that is entered.
        to: String,
    },
    /// Nothing was driven.
    #[error("Nothing was driven yet.")]
    NothingDriven,
    /// The preferred clip is not in the database.
    #[error(
        "`{name}` is not among the clips to choose frames from: choose another clip to prefer, or none."
    )]
    NoPreferredClip {
        /// Its name.
        name: String,
    },
    /// A tag that no frame has.
    #[error(
        "No frame has the tag `{word}`: tag a stretch of a clip with it, or choose another tag."
    )]
    NoTag {
        /// The tag.
        word: String,
    },
    /// A pin outside of the clips.
    #[error(
        "The pin at frames {a} | {b} lies beyond the clips, which have {frames_a} and {frames_b} frames: move it inside or remove it."
    )]
    PinBeyond {
        /// Its frame of A.
        a: usize,
        /// Its frame of B.
        b: usize,
        /// Frames of A.
        frames_a: usize,
        /// Frames of B.
        frames_b: usize,
    },
    /// Seams of the clips leave no room for a join.
    #[error(
        "Behind the last seam of A, at {last_secs:.2} s, and before the first one of B, at {first_secs:.2} s of A, there is no room to go over: set by hand where the join begins and ends."
    )]
    NoRoomToJoin {
        /// The last seam of A, seconds.
        last_secs: f64,
        /// The first seam of B, seconds of A.
        first_secs: f64,
    },
    /// A join that ends before it begins.
    #[error(
        "The join begins at {begin_secs:.2} s and ends at {end_secs:.2} s of A, of which {from_secs:.2} to {to_secs:.2} s are registered: move its end behind its beginning."
    )]
    JoinBackwards {
        /// Where it begins, seconds of A.
        begin_secs: f64,
        /// Where it ends, seconds of A.
        end_secs: f64,
        /// Where the registered part begins, seconds of A.
        from_secs: f64,
        /// Where the registered part ends, seconds of A.
        to_secs: f64,
    },
    /// A file cannot be read.
    #[error(transparent)]
    Import(#[from] ImportError),
    /// Clips cannot be blended.
    #[error(transparent)]
    Blend(#[from] BlendError),
    /// Clips cannot be layered.
    #[error(transparent)]
    Layer(#[from] LayerError),
    /// The result is no clip.
    #[error(transparent)]
    Clip(#[from] ClipError),
    /// A clip does not fit the skeleton.
    #[error(transparent)]
    Retarget(#[from] RetargetError),
    /// The clip has no way over the ground.
    #[error(transparent)]
    RootWay(#[from] RootWayError),
    /// There is no gait.
    #[error(transparent)]
    Gait(#[from] GaitError),
    /// There is no graph.
    #[error(transparent)]
    Graph(#[from] GraphError),
    /// There is no database.
    #[error(transparent)]
    Match(#[from] MatchError),
    /// The path cannot be used.
    #[error(transparent)]
    Path(#[from] PathEditError),
    /// There is no way through the distances.
    #[error(transparent)]
    Warp(#[from] PathError),
    /// The clips cannot be compared.
    #[error(transparent)]
    Registration(#[from] RegistrationError),
    /// The motion cannot be made.
    #[error(transparent)]
    Synth(#[from] SynthError),
    /// Feet cannot be held.
    #[error(transparent)]
    FootLock(#[from] FootLockError),
    /// The cycle cannot be closed.
    #[error(transparent)]
    Loop(#[from] LoopError),
}
