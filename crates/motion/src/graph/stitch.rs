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

/// How much of what has played is kept for the next transition, seconds: a stride, over which its
/// speed is taken.
const PAST_SECS: f64 = 1.0;
/// How far beyond a transition the clip that is left is made for it, seconds, if the transition
/// does not ask for more.
const AHEAD_SECS: f64 = 0.5;

/// A classic mistake in laying one clip on the other, for experiments.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, serde::Serialize, serde::Deserialize)]
pub enum WalkMistake {
    /// Only the entered clip's first frame is turned, in place of the whole clip: it begins in the
    /// right place, and goes on in the direction in which it was recorded.
    FirstFrameOnly,
    /// The transform is applied to the entered clip's first frame alone: all others stay in the
    /// place and the direction in which they were recorded, and the character goes back there.
    FirstFrameThenRecorded,
    /// That of a single transition, made at each.
    Transition(Mistake),
}

/// How transitions are made.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct StitchOptions {
    /// The method.
    pub method: Method,
    /// By what a clip is laid on the one that is left.
    pub align_by: AlignBy,
    /// How the way over the ground is made.
    pub root: RootBlend,
    /// A mistake to be made.
    pub mistake: Option<WalkMistake>,
}

impl StitchOptions {
    /// A method, with nothing wrong.
    #[must_use]
    pub fn new(method: Method) -> Self {
        Self { method, align_by: AlignBy::default(), root: RootBlend::default(), mistake: None }
    }

    /// A dissolve over the graph's blend window.
    #[must_use]
    pub fn dissolve(window: usize) -> Self {
        Self::new(Method::Dissolve { window, law: WeightLaw::default() })
    }

    /// Inertialization by a spring.
    #[must_use]
    pub fn inertialize(half_life_secs: f64) -> Self {
        Self::new(Method::Inertialize(Inertialization::Offset(Decay::Spring { half_life_secs })))
    }
}

/// A piece of a walk, from where one clip is entered to where the next is.
#[derive(Clone, Debug)]
pub struct WalkPiece {
    /// The motion, near where its clip was recorded: a walk may go far, and single precision does
    /// not.
    pub clip: Clip,
    /// Where the piece lies in the walk's world, accumulated in double precision.
    pub world_from_piece: Planar,
    /// Where the character stands and faces in every frame (`piece_from_character`).
    pub frames: Vec<Planar>,
    /// The number of its first frame in the walk.
    pub start: usize,
    /// What it plays.
    pub stay: Stay,
    /// The transition that it begins with; none in the first piece.
    pub seam: Option<PieceSeam>,
}

impl WalkPiece {
    /// The frame of a clip that has the greater part in a frame of the piece.
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
    /// Where the last clip was left.
    pub leave: Place,
    /// Where this one was entered.
    pub enter: Place,
    /// Frames of the transition; they may reach into the next piece.
    pub frames: usize,
    /// The frame of the piece from which its own clip has the greater part.
    pub handover: usize,
}

/// Makes motion of the stays of a walk, piece by piece and without end.
///
/// A transition starts from what plays, not from the clip that is left: transitions may follow each
/// other so fast that they overlap.
#[derive(Clone, Debug)]
pub struct Stitcher {
    set: Arc<FrameSet>,
    options: StitchOptions,
    playing: Option<Tail>,
    made: usize,
    world_from_first: Planar,
}

/// What has played of the last piece, and what would have played on.
#[derive(Clone, Debug)]
struct Tail {
    source: Motion,
    /// The first of its frames that has not been given out.
    leave: usize,
    world_from_here: Planar,
    /// The frame of its clip that it would show next.
    place: Place,
}

impl Stitcher {
    /// Nothing has played yet.
    #[must_use]
    pub fn new(set: Arc<FrameSet>, options: &StitchOptions) -> Self {
        Self { set, options: *options, playing: None, made: 0, world_from_first: Planar::IDENTITY }
    }

    /// Where the first piece's clip lies in the walk's world, which it otherwise lies in as it was
    /// recorded. For a stitcher that has made nothing yet.
    pub fn start_at(&mut self, world_from_first: Planar) {
        self.world_from_first = world_from_first;
    }

    /// The next piece. Stays come in the order in which a walk gives them; `graph` is the one it
    /// goes through.
    ///
    /// # Errors
    /// [`GraphError`] when a stay is none of the graph's, or a half-life is none.
    pub fn stitch(&mut self, graph: &MotionGraph, stay: &Stay) -> Result<WalkPiece, GraphError> {
        let source = self.set.clip(stay.clip).ok_or(GraphError::NoClips)?;
        let frames = source.clip().frames();
        // Checks the stay, too.
        source.clip().crop(stay.from..stay.to)?;
        let ahead = (AHEAD_SECS * self.set.fps()).round() as usize;
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

    /// Where the clip that a transition enters comes to lie on the one that it leaves, both as they
    /// were recorded: `left_from_entered`. In a walk in which the clip that is left has played for
    /// a while, that is where [`stitch`](Self::stitch) lays it, too.
    ///
    /// # Errors
    /// As [`stitch`](Self::stitch).
    pub(super) fn placing(&self, jump: &Jump) -> Result<Planar, GraphError> {
        let secs = |secs: f64| (secs * self.set.fps()).round() as usize;
        let source = |place: Place| self.set.clip(place.clip).ok_or(GraphError::NoClips);
        let around = |place: Place, past: usize| -> Result<(Motion, usize), GraphError> {
            let source = source(place)?;
            let from = place.frame.saturating_sub(past);
            let until = (place.frame + secs(AHEAD_SECS)).min(source.clip().frames());
            Ok((part(source, from..until)?, place.frame - from))
        };
        let (outgoing, leave) = around(jump.leave, secs(PAST_SECS).max(1))?;
        let (incoming, enter) = around(jump.enter, 1)?;
        let tail =
            Tail { source: outgoing, leave, world_from_here: Planar::IDENTITY, place: jump.leave };
        Ok(self.joined(&tail, &incoming, enter)?.tail_from_piece)
    }

    /// Where the walk would go on in its present clip; none before the first piece.
    #[must_use]
    pub fn place(&self) -> Option<Place> {
        self.playing.as_ref().map(|tail| tail.place)
    }

    fn joined(&self, tail: &Tail, incoming: &Motion, enter: usize) -> Result<Joined, GraphError> {
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
        Ok(Joined {
            source: incoming.same_body(made.clip.transformed(&back), frames),
            tail_from_piece,
            frames: made.transition.len(),
            handover: made.handover.saturating_sub(leave),
        })
    }
}

struct Joined {
    /// The tail and the incoming clip, where the latter was recorded.
    source: Motion,
    tail_from_piece: Planar,
    frames: usize,
    handover: usize,
}

/// Where the incoming clip comes to lie if only its first frame is turned: in the right place, and
/// in the direction in which it was recorded.
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

/// The incoming clip with the transform on its frames up to the one where it is entered, and where
/// it was recorded from the next one on.
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

/// Some frames of a clip, with what is known of it.
fn part(source: &Motion, frames: Range<usize>) -> Result<Motion, GraphError> {
    let clip = source.clip().crop(frames.clone())?;
    Ok(source.same_body(clip, source.ground_frames().get(frames).unwrap_or_default().to_vec()))
}

/// The pieces as one clip in the walk's world, and where the character stands in each frame. `None`
/// for no pieces.
///
/// # Errors
/// [`GraphError::Clip`]; not for pieces of one walk.
pub fn assembled(pieces: &[WalkPiece]) -> Result<Option<(Clip, Vec<Planar>)>, GraphError> {
    let Some(mut assembling) = Assembling::new(pieces, usize::MAX) else {
        return Ok(None);
    };
    while !assembling.advance(pieces, usize::MAX) {}
    assembling.finish().map(Some)
}

/// [`assembled`] in slices. Between them it does not hold the pieces: every call is given the same
/// ones.
#[derive(Debug)]
pub struct Assembling {
    made: Assembly,
    frames: Vec<Planar>,
    /// Frames in all.
    count: usize,
    /// The piece, and its frame, that come next.
    next: (usize, usize),
}

impl Assembling {
    /// For the first `most` frames of the pieces; `None` for no pieces.
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

    /// Up to so many frames more, at least one; `true` when nothing is left to do. 10,000 frames of
    /// 31 joints take about 3 ms.
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

    /// What is assembled.
    ///
    /// # Errors
    /// [`GraphError::Clip`]; not for pieces of one walk.
    pub fn finish(self) -> Result<(Clip, Vec<Planar>), GraphError> {
        Ok((self.made.finish("walk".to_owned())?, self.frames))
    }
}
