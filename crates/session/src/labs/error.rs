//! The reasons why a lab has no result.

use super::outcome::Slot;
use segue_formats::ImportError;
use segue_motion::blend::{BlendError, LayerError};
use segue_motion::clean::MendError;
use segue_motion::clip::{ClipError, MirrorError, RetargetError, RootMotionError};
use segue_motion::gait::GaitError;
use segue_motion::graph::GraphError;
use segue_motion::matching::MatchError;
use segue_motion::path::PathEditError;
use segue_motion::registration::{PathError, RegistrationError};
use segue_motion::synth::SynthError;
use segue_motion::transition::{FootLockError, LoopError};
use segue_text::{Message, ToMessage};

/// The most clips of a motion graph: the picture of its distances shows no more.
pub(crate) const MAX_CLIPS: usize = 64;

/// The reason why a lab has no result, with the remedy.
#[derive(Clone, Debug, PartialEq, thiserror::Error, ToMessage)]
pub enum LabError {
    /// A clip in the parameters that is not in the library.
    #[error("`{name}` is not here: drop its file, or choose another clip.")]
    MissingClip {
        /// Its name.
        name: String,
    },
    /// A bundled take that is being loaded.
    #[error("{name} is being loaded.")]
    Loading {
        /// Its name.
        name: &'static str,
    },
    /// An id that is not a recipe.
    #[error("`{id}` names no motion.")]
    NoRecipe {
        /// The id.
        id: String,
    },
    /// An unknown preset.
    #[error("`{id}` is no built-in motion.")]
    NoPreset {
        /// Its id.
        id: String,
    },
    /// A motion without its skeleton.
    #[error("{file} needs its skeleton: drop its .asf file.")]
    AwaitsSkeleton {
        /// The motion's file.
        file: String,
    },
    /// A clip whose file could not be read.
    #[error("{0}")]
    Unread(Message),
    /// A clip whose file is being read.
    #[error("{file} is being read.")]
    Reading {
        /// The file.
        file: String,
    },
    /// A clip that its file no longer contains.
    #[error("{file} has no such clip any more.")]
    NoSuchClip {
        /// The file.
        file: String,
    },
    /// A clip that is itself a result being computed.
    #[error("{name} is being made.")]
    BeingMade {
        /// The name of the clip.
        name: String,
    },
    /// An error about one clip among several.
    #[error("{name}: {error}")]
    OfClip {
        /// The name of the clip.
        name: String,
        /// The error.
        error: Box<LabError>,
    },
    /// An error about the clip in a slot.
    #[error("{error}")]
    InSlot {
        /// The slot.
        slot: Slot,
        /// The error.
        error: Box<LabError>,
    },
    /// A clip without frames.
    #[error("This clip has no frames: choose another one.")]
    NoFrames,
    /// A clip that would have too many frames.
    #[error(
        "This clip would have {frames} frames of {joints} joints, more than the memory holds: lower the frame rate, or trim it."
    )]
    TooManyFrames {
        /// Its frames.
        frames: usize,
        /// Its joints.
        joints: usize,
    },
    /// A missing first clip.
    #[error("There is no clip in A.")]
    NoClip,
    /// Missing clips.
    #[error("There are no clips in A and B.")]
    NoPair,
    /// Missing clips for a match.
    #[error("there are no clips to match")]
    NothingToMatch,
    /// Missing clips for a registration.
    #[error("There are no clips to register.")]
    NothingToRegister,
    /// A cycle without frames.
    #[error("the cycle has no frames")]
    EmptyCycle,
    /// A computation that the user stopped.
    #[error("Stopped. Change any setting, or continue.")]
    Stopped,
    /// A graph without clips.
    #[error("A motion graph needs a clip: add at least one.")]
    NoGraphClips,
    /// A graph with too many clips.
    #[error("These are {count} clips: take {MAX_CLIPS} at most.")]
    TooManyGraphClips {
        /// Their number.
        count: usize,
    },
    /// Two mistakes at once, of the transform and of the angle.
    #[error(
        "Two mistakes at once cannot be told apart: choose the transform of the whole clip, or atan2."
    )]
    TwoMistakes,
    /// A visit to a clip that does not exist.
    #[error("Go to: there is no clip {clip}, they are counted from 0 to {last}.")]
    NoVisit {
        /// The clip's index.
        clip: usize,
        /// The index of the last clip.
        last: usize,
    },
    /// A transition to be played alone that is no longer in the graph.
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
    /// A replay without input.
    #[error("Nothing is recorded yet.")]
    NothingDriven,
    /// A preferred clip that is not in the database.
    #[error(
        "`{name}` is not among the clips to choose frames from: choose another clip to prefer, or none."
    )]
    NoPreferredClip {
        /// Its name.
        name: String,
    },
    /// A tag without frames.
    #[error(
        "No frame has the tag `{word}`: tag a stretch of a clip with it, or choose another tag."
    )]
    NoTag {
        /// The tag.
        word: String,
    },
    /// A pin outside the clips.
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
    /// Seams of the clips that leave no room for a join.
    #[error(
        "Between the last seam of A, at {last_secs:.2} s, and the first one of B, at {first_secs:.2} s of A, there is no room for a join: set its beginning and end by hand."
    )]
    NoRoomToJoin {
        /// The last seam of A, seconds.
        last_secs: f64,
        /// The first seam of B, seconds of A.
        first_secs: f64,
    },
    /// A join that ends before it begins.
    #[error(
        "The join begins at {begin_secs:.2} s and ends at {end_secs:.2} s of A, of which {from_secs:.2} to {to_secs:.2} s are registered: move its end after its beginning."
    )]
    JoinBackwards {
        /// The beginning of the join, seconds of A.
        begin_secs: f64,
        /// The end of the join, seconds of A.
        end_secs: f64,
        /// The beginning of the registered part, seconds of A.
        from_secs: f64,
        /// The end of the registered part, seconds of A.
        to_secs: f64,
    },
    /// An error of reading a file.
    #[error(transparent)]
    Import(#[from] ImportError),
    /// An error of blending.
    #[error(transparent)]
    Blend(#[from] BlendError),
    /// An error of layering.
    #[error(transparent)]
    Layer(#[from] LayerError),
    /// An invalid clip.
    #[error(transparent)]
    Clip(#[from] ClipError),
    /// An error of retargeting.
    #[error(transparent)]
    Retarget(#[from] RetargetError),
    /// An error of mirroring.
    #[error(transparent)]
    Mirror(#[from] MirrorError),
    /// An error of extracting root motion.
    #[error(transparent)]
    RootWay(#[from] RootMotionError),
    /// An error of mending faults.
    #[error(transparent)]
    Mend(#[from] MendError),
    /// An error of finding gaits.
    #[error(transparent)]
    Gait(#[from] GaitError),
    /// An error of building a motion graph.
    #[error(transparent)]
    Graph(#[from] GraphError),
    /// An error of building a database.
    #[error(transparent)]
    Match(#[from] MatchError),
    /// An error of editing a path.
    #[error(transparent)]
    Path(#[from] PathEditError),
    /// An error of finding a path through the distances.
    #[error(transparent)]
    Warp(#[from] PathError),
    /// An error of comparing clips.
    #[error(transparent)]
    Registration(#[from] RegistrationError),
    /// An error of synthesis.
    #[error(transparent)]
    Synth(#[from] SynthError),
    /// An error of locking feet.
    #[error(transparent)]
    FootLock(#[from] FootLockError),
    /// An error of closing a cycle.
    #[error(transparent)]
    Loop(#[from] LoopError),
}

impl LabError {
    /// Returns the error as one about the clip in a slot.
    pub(super) fn in_slot(self, slot: Slot) -> Self {
        Self::InSlot { slot, error: Box::new(self) }
    }
}
