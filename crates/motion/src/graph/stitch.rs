//! The motion of walks, stitched from clips.

use super::{FrameSet, GraphError, Jump, MotionGraph, Place, Stay};
use crate::blend::{AlignBy, Assembly, RootBlend, WeightLaw, alignment_of};
use crate::clip::{Clip, Motion};
use crate::math::{Decay, Planar, wrap_angle};
use crate::transition::{
    Inertialization, Method, Mistake, TransitionOptions, concatenate, concatenate_mistaken,
};
use std::ops::Range;
use std::sync::Arc;

/// Duration of the played motion that is kept for the next transition, seconds: a stride, over
/// which the steady velocity is averaged.
const PAST_SECS: f64 = 1.0;
/// The least time for which the clip that is left continues after a transition, seconds.
const MIN_AHEAD_SECS: f64 = 0.5;

/// A classic mistake in aligning one clip with the other, for experiments.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, serde::Serialize, serde::Deserialize)]
pub enum WalkMistake {
    /// Only the entered clip's first frame is rotated, instead of the whole clip: it begins at the
    /// right position and continues in the direction in which it was recorded.
    FirstFrameOnly,
    /// The transform is applied to the entered clip's first frame only: all other frames keep their
    /// recorded position and direction, and the character jumps back there.
    FirstFrameThenRecorded,
    /// A mistake of a single transition, made at each one.
    Transition(Mistake),
}

/// Options of the transitions of a walk.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct StitchOptions {
    /// The method.
    pub method: Method,
    /// The alignment of the entered clip with the one that is left.
    pub align_by: AlignBy,
    /// The blending of root motion.
    pub root: RootBlend,
    /// A deliberate mistake.
    pub mistake: Option<WalkMistake>,
}

impl StitchOptions {
    /// Returns the options of a method without mistakes.
    #[must_use]
    pub fn new(method: Method) -> Self {
        Self { method, align_by: AlignBy::default(), root: RootBlend::default(), mistake: None }
    }

    /// Returns the options of a dissolve over the graph's blend window.
    #[must_use]
    pub fn dissolve(window: usize) -> Self {
        Self::new(Method::Dissolve { window, law: WeightLaw::default() })
    }

    /// Returns the options of inertialization by a spring.
    #[must_use]
    pub fn inertialize(half_life_secs: f64) -> Self {
        Self::new(Method::Inertialize(Inertialization::Offset(Decay::Spring { half_life_secs })))
    }
}

/// A piece of a walk, from the entry of one clip to the entry of the next.
#[derive(Clone, Debug)]
pub struct WalkPiece {
    /// The motion, near the recorded position of its clip, because single precision does not
    /// suffice far from the origin.
    pub clip: Clip,
    /// The transform of the piece, accumulated in double precision.
    pub world_from_piece: Planar,
    /// The ground frame of the character in every frame (`piece_from_character`).
    pub frames: Vec<Planar>,
    /// The number in the walk of its first frame.
    pub start: usize,
    /// The stay that it plays.
    pub stay: Stay,
    /// The transition with which it begins; `None` for the first piece.
    pub seam: Option<PieceSeam>,
}

impl WalkPiece {
    /// Returns the frame of a clip that has the greater weight in a frame of the piece.
    #[must_use]
    pub fn shown_at(&self, frame: usize) -> Place {
        match self.seam.filter(|seam| frame < seam.handover) {
            Some(seam) => Place { frame: seam.leave.frame + frame, ..seam.leave },
            None => Place { clip: self.stay.clip, frame: self.stay.from + frame },
        }
    }
}

/// The transition at the start of a piece.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PieceSeam {
    /// The frame at which the last clip was left.
    pub leave: Place,
    /// The frame at which this clip was entered.
    pub enter: Place,
    /// Number of frames of the transition, which may continue in the next piece.
    pub frames: usize,
    /// The frame of the piece from which on its own clip has the greater weight.
    pub handover: usize,
}

/// Conversion of the stays of a walk to motion, piece by piece and without end.
///
/// A transition starts from the motion that is playing, not from the clip that is left, because
/// transitions may overlap when they follow each other quickly.
#[derive(Clone, Debug)]
pub struct Stitcher {
    set: Arc<FrameSet>,
    options: StitchOptions,
    playing: Option<Tail>,
    made: usize,
    world_from_first: Planar,
}

/// The end of the last piece, with its continuation.
#[derive(Clone, Debug)]
struct Tail {
    source: Motion,
    /// The first of its frames that has not been returned.
    leave: usize,
    world_from_here: Planar,
    /// The frame of its clip that would be played next.
    place: Place,
}

impl Stitcher {
    /// Returns a stitcher that has played nothing yet.
    #[must_use]
    pub fn new(set: Arc<FrameSet>, options: &StitchOptions) -> Self {
        Self { set, options: *options, playing: None, made: 0, world_from_first: Planar::IDENTITY }
    }

    /// Sets the transform of the first piece's clip; otherwise it keeps its recorded position. Must
    /// be called before the first piece is made.
    pub fn start_at(&mut self, world_from_first: Planar) {
        self.world_from_first = world_from_first;
    }

    /// Returns the next piece. Stays must be passed in the order in which a walk returns them;
    /// `graph` is the graph of that walk.
    ///
    /// # Errors
    /// [`GraphError`] when a stay is not part of the graph, or a half-life is out of range.
    pub fn stitch(&mut self, graph: &MotionGraph, stay: &Stay) -> Result<WalkPiece, GraphError> {
        let source = self.set.clip(stay.clip).ok_or(GraphError::NoClips)?;
        let frames = source.clip().frames();
        // This also checks the stay.
        source.clip().crop(stay.from..stay.to)?;
        let ahead = (MIN_AHEAD_SECS * self.set.fps()).round() as usize;
        let until = stay.to + ahead.max(graph.options().blend_window).min(frames - stay.to);
        let jump = stay.jump.and_then(|index| graph.jumps().get(index));
        let (made, entered, world_from_piece, seam) = match (self.playing.take(), jump) {
            (Some(tail), Some(jump)) => {
                let from = stay.from.saturating_sub(1);
                let incoming = part(source, from..until)?;
                let joined = self.joined(&tail, &incoming, stay.from - from)?;
                let seam = PieceSeam {
                    leave: jump.leave,
                    enter: jump.enter,
                    frames: joined.frames,
                    handover: joined.handover,
                };
                (
                    joined.source,
                    tail.leave,
                    tail.world_from_here.after(&joined.tail_from_piece),
                    Some(seam),
                )
            }
            _ => (part(source, stay.from..until)?, 0, self.world_from_first, None),
        };
        let leave = entered + (stay.to - stay.from);
        let past = (PAST_SECS * self.set.fps()).round() as usize;
        let kept = leave.saturating_sub(past.max(1));
        let name = source.clip().name();
        let piece = WalkPiece {
            clip: made.clip().crop(entered..leave)?.with_name(name),
            world_from_piece,
            frames: made.ground_frames().get(entered..leave).unwrap_or_default().to_vec(),
            start: self.made,
            stay: *stay,
            seam,
        };
        let tail = part(&made, kept..made.clip().frames())?;
        let renamed = tail.clip().as_ref().clone().with_name(name);
        self.playing = Some(Tail {
            source: tail.same_body(renamed, tail.ground_frames().to_vec()),
            leave: leave - kept,
            world_from_here: world_from_piece,
            place: Place { clip: stay.clip, frame: stay.to },
        });
        self.made += stay.to - stay.from;
        Ok(piece)
    }

    /// Returns the transform by which a transition aligns the clip that it enters with the clip
    /// that it leaves, both as recorded: `left_from_entered`. [`stitch`](Self::stitch) uses the
    /// same one if the clip that is left has played for a while.
    ///
    /// # Errors
    /// The same as for [`stitch`](Self::stitch).
    pub(super) fn placing(&self, jump: &Jump) -> Result<Planar, GraphError> {
        let secs = |secs: f64| (secs * self.set.fps()).round() as usize;
        let source = |place: Place| self.set.clip(place.clip).ok_or(GraphError::NoClips);
        let around = |place: Place, past: usize| -> Result<(Motion, usize), GraphError> {
            let source = source(place)?;
            let from = place.frame.saturating_sub(past);
            let until = (place.frame + secs(MIN_AHEAD_SECS)).min(source.clip().frames());
            Ok((part(source, from..until)?, place.frame - from))
        };
        let (outgoing, leave) = around(jump.leave, secs(PAST_SECS).max(1))?;
        let (incoming, enter) = around(jump.enter, 1)?;
        let tail =
            Tail { source: outgoing, leave, world_from_here: Planar::IDENTITY, place: jump.leave };
        Ok(self.joined(&tail, &incoming, enter)?.tail_from_piece)
    }

    /// Returns the next frame of the current clip; `None` before the first piece.
    #[must_use]
    pub fn place(&self) -> Option<Place> {
        self.playing.as_ref().map(|tail| tail.place)
    }

    fn joined(
        &self,
        tail: &Tail,
        incoming: &Motion,
        enter: usize,
    ) -> Result<JoinedMotions, GraphError> {
        let (a, leave) = (&tail.source, tail.leave);
        let options = TransitionOptions {
            align_by: self.options.align_by,
            root: self.options.root,
            ..TransitionOptions::new(self.options.method)
        };
        let in_the_world = TransitionOptions { align: false, root: RootBlend::World, ..options };
        let (made, moved) = match self.options.mistake {
            None => (concatenate(a, leave, incoming, enter, &options)?, Planar::IDENTITY),
            Some(WalkMistake::Transition(mistake)) => (
                concatenate_mistaken(a, leave, incoming, enter, &options, mistake)?,
                Planar::IDENTITY,
            ),
            Some(WalkMistake::FirstFrameOnly) => {
                let moved = first_frame_only(tail, incoming, enter);
                (concatenate(a, leave, &incoming.moved(&moved), enter, &in_the_world)?, moved)
            }
            Some(WalkMistake::FirstFrameThenRecorded) => {
                let window = match options.method {
                    Method::Dissolve { window, .. } => window,
                    _ => 0,
                };
                let here_from_there = alignment_of(
                    a,
                    leave.min(a.clip().frames().saturating_sub(1)),
                    incoming,
                    enter,
                    window,
                    options.align_by,
                )?;
                let recorded = tail.world_from_here.inverse();
                let incoming =
                    first_frame_then_recorded(incoming, enter, &here_from_there, &recorded);
                (concatenate(a, leave, &incoming, enter, &in_the_world)?, recorded)
            }
        };
        let tail_from_piece = made.world_from_b.after(&moved);
        let back = tail_from_piece.inverse();
        let frames = made.frames.iter().map(|frame| back.after(frame)).collect();
        Ok(JoinedMotions {
            source: incoming.same_body(made.clip.transformed(&back), frames),
            tail_from_piece,
            frames: made.transition.len(),
            handover: made.handover.saturating_sub(leave),
        })
    }
}

struct JoinedMotions {
    /// The tail and the incoming clip, as recorded.
    source: Motion,
    tail_from_piece: Planar,
    frames: usize,
    handover: usize,
}

/// Returns the transform of the incoming clip if only its first frame is rotated: the right
/// position and the recorded direction.
fn first_frame_only(tail: &Tail, incoming: &Motion, enter: usize) -> Planar {
    let (Some(here), Some(there)) =
        (tail.source.ground_frames().get(tail.leave), incoming.ground_frames().get(enter))
    else {
        return Planar::IDENTITY;
    };
    let turned = Planar::new(wrap_angle(-tail.world_from_here.yaw), 0.0, 0.0);
    let shift = here.shift - turned.apply_ground(there.shift);
    Planar { shift, ..turned }
}

/// Returns the incoming clip with the transform on its frames up to the one at which it is entered,
/// and the following frames as recorded.
fn first_frame_then_recorded(
    incoming: &Motion,
    enter: usize,
    transform: &Planar,
    recorded: &Planar,
) -> Motion {
    let place = |frame: usize| if frame <= enter { transform } else { recorded };
    let clip = incoming.clip();
    let frames = incoming
        .ground_frames()
        .iter()
        .enumerate()
        .map(|(frame, stands)| place(frame).after(stands));
    let moves: Vec<Planar> = (0..clip.frames()).map(|frame| *place(frame)).collect();
    incoming.same_body(clip.transformed_by_frame(&moves), frames.collect())
}

/// Returns some frames of a clip as a motion.
fn part(source: &Motion, frames: Range<usize>) -> Result<Motion, GraphError> {
    let clip = source.clip().crop(frames.clone())?;
    Ok(source.same_body(clip, source.ground_frames().get(frames).unwrap_or_default().to_vec()))
}

/// Returns the pieces as one clip in the walk's world, and the character's ground frame in each of
/// its frames. `None` without pieces.
///
/// # Errors
/// [`GraphError::Clip`]; not for pieces of one walk.
pub fn assembled(pieces: &[WalkPiece]) -> Result<Option<(Clip, Vec<Planar>)>, GraphError> {
    let Some(mut assembling) = WalkAssembly::new(pieces, usize::MAX) else {
        return Ok(None);
    };
    while !assembling.advance(pieces, usize::MAX) {}
    assembling.finish().map(Some)
}

/// The computation of [`assembled`] in slices. It does not hold the pieces: every call must be
/// given the same ones.
#[derive(Debug)]
pub struct WalkAssembly {
    made: Assembly,
    frames: Vec<Planar>,
    /// Number of frames.
    count: usize,
    /// The next piece, and the next frame in it.
    next: (usize, usize),
}

impl WalkAssembly {
    /// Begins the assembly of the first `most` frames of the pieces; `None` without pieces.
    #[must_use]
    pub fn new(pieces: &[WalkPiece], most: usize) -> Option<Self> {
        let count = pieces.iter().map(|piece| piece.clip.frames()).sum::<usize>().min(most);
        Some(Self {
            made: Assembly::of(
                &pieces.first()?.clip,
                pieces.iter().map(|piece| &piece.clip),
                count,
            ),
            frames: Vec::with_capacity(count),
            count,
            next: (0, 0),
        })
    }

    /// Processes up to `frames` more frames, at least one; returns `true` when nothing is left to
    /// do. 10,000 frames of 31 joints take about 3 ms.
    pub fn advance(&mut self, pieces: &[WalkPiece], frames: usize) -> bool {
        let mut left = frames.max(1).min(self.count - self.frames.len());
        while let (1.., Some(piece)) = (left, pieces.get(self.next.0)) {
            let from = self.next.1;
            let part = from..piece.clip.frames().min(from.saturating_add(left));
            self.made.play_moved(&piece.clip, part.clone(), &piece.world_from_piece);
            let frames = piece.frames.get(part.clone()).unwrap_or_default();
            self.frames.extend(frames.iter().map(|frame| piece.world_from_piece.after(frame)));
            left -= part.len();
            self.next = if part.end < piece.clip.frames() {
                (self.next.0, part.end)
            } else {
                (self.next.0 + 1, 0)
            };
        }
        self.frames.len() >= self.count || self.next.0 >= pieces.len()
    }

    /// Returns the assembled clip and its ground frames.
    ///
    /// # Errors
    /// [`GraphError::Clip`]; not for pieces of one walk.
    pub fn finish(self) -> Result<(Clip, Vec<Planar>), GraphError> {
        Ok((self.made.finish("walk".to_owned())?, self.frames))
    }
}
