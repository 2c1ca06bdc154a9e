//! Construction of a walk in slices, ahead of the playhead.

use super::plan::Plan;
use super::requests::WalkRequest;
use super::walk::{FollowedPath, of_walk};
use super::{BuiltGraph, Walk, WalkStay};
use crate::labs::LabError;
use crate::labs::feet::{locking, slide, slide_before};
use crate::metrics::{Metric, MetricId};
use petgraph::graph::NodeIndex;
use segue_motion::clip::{Clip, Contacts, Motion};
use segue_motion::graph::{
    Choices, FollowSearch, FollowedWalk, GraphError, GroundPath, Place, RunLength, Stay, Stitcher,
    WalkAssembly, WalkMeter, WalkPiece,
};
use segue_motion::metrics::{MotionTrace, SlideMeter, TraceMeter};
use segue_motion::skeleton::Foot;
use segue_motion::transition::FootLocking;
use std::sync::Arc;

/// The lead of a walk over the playhead, seconds.
const LEAD_SECS: f64 = 20.0;
/// The greatest duration of a walk, seconds: 54 MB at 60 frames per second and 31 joints.
const MAX_SECS: f64 = 1_800.0;
/// The duration of both clips before and after a single transition, seconds.
const AROUND_JUMP_SECS: f64 = 1.2;
/// The number of nodes that a search for a ground path expands in all. It bounds the work for a
/// link, equally on every machine.
const PATH_BUDGET: usize = 60_000;
/// The number of nodes in one slice, about two milliseconds.
const PATH_NODES: usize = 2_000;
/// Work time after which the best path so far is previewed while the search continues, again and
/// again. It does not affect the final result.
const PATH_WAIT_SECS: f64 = 1.0;
/// The number of frames that one slice assembles to be shown, about three milliseconds.
const PUBLISHED_FRAMES: usize = 10_000;
/// The number of edges that one slice follows for the expected run, about a millisecond.
const RUN_EDGES: usize = 500_000;

/// The number of frames whose feet one slice locks, about four milliseconds.
const LOCKED_FRAMES: usize = 2_000;
/// The number of frames that one slice measures, of the feet locked and unlocked or of the whole
/// body, about four milliseconds.
const MEASURED_FRAMES: usize = 1_000;
/// The number of frames whose artefacts one slice measures, about two milliseconds.
const METERED_FRAMES: usize = 500;

/// The stages from assembled pieces to a walk on screen. With locked feet, all of the walk is
/// locked again: a stance and its surroundings last about a second, and a walk ends far ahead of
/// the playhead. Frames that have played stay the same except for the plane in which a leg usually
/// bends, which is a mean over the whole walk and matters only for nearly straight legs.
#[derive(Debug)]
enum Publishing {
    Assembling(Box<WalkAssembly>),
    Locking(Box<FootLocking>, Box<Motion>),
    Measuring(Box<Measuring>),
}

/// A measurement of a walk: its joints and feet, and its foot slide without the foot lock.
#[derive(Debug)]
struct Measuring {
    shown: Motion,
    meter: TraceMeter,
    slide: SlideMeter,
    /// The walk without the foot lock.
    free: Option<(Arc<Clip>, SlideMeter)>,
}

/// The measurements of a walk that is shown.
#[derive(Debug)]
struct WalkMeasurements {
    trace: Arc<MotionTrace>,
    slides: Vec<Metric>,
}

impl Measuring {
    /// Begins a measurement; `free` is the walk without the foot lock, if there is one.
    fn new(shown: Motion, free: Option<Arc<Clip>>) -> Self {
        Self {
            meter: TraceMeter::new(shown.clip(), shown.roles()),
            slide: SlideMeter::new(shown.clip(), shown.roles()),
            free: free.map(|free| {
                let meter = SlideMeter::new(&free, shown.roles());
                (free, meter)
            }),
            shown,
        }
    }

    /// Measures a slice. Returns `false` if nothing is left to do.
    fn advance(&mut self, frames: usize) -> bool {
        let (clip, contacts) = (self.shown.clip(), self.shown.contacts());
        let of_free =
            |(free, meter): &mut (Arc<Clip>, SlideMeter)| meter.advance(free, contacts, frames);
        if self.slide.advance(clip, contacts, frames) | self.free.as_mut().is_some_and(of_free) {
            return true;
        }
        self.meter.advance(clip, frames)
    }

    fn finish(self) -> (Motion, WalkMeasurements) {
        let before = self.free.map(|(_, meter)| slide_before(meter.worst()));
        let slide = slide(self.slide.worst(), self.shown.clip().fps());
        let seen = WalkMeasurements {
            trace: Arc::new(self.meter.finish(self.shown.clip())),
            slides: std::iter::once(slide).chain(before).collect(),
        };
        (self.shown, seen)
    }
}

/// The construction of a walk, stay by stay.
#[derive(Debug)]
pub(super) struct WalkBuilder {
    built: Arc<BuiltGraph>,
    wanted: WalkRequest,
    choices: Arc<Choices>,
    /// The probabilities of the transitions, once they are computed.
    probabilities: Option<Arc<Vec<Option<f64>>>>,
    /// The expected run, as far as it is computed.
    run: Option<RunLength>,
    run_is_known: bool,
    search: Option<(FollowSearch, GroundPath)>,
    /// Seconds of search since the best path so far was shown.
    searched_secs: f64,
    /// The walk that follows the path as far as it is known.
    preview: Option<Box<Self>>,
    trace: Option<FollowedPath>,
    plan: Plan,
    stitcher: Stitcher,
    meter: WalkMeter,
    metrics: Option<Vec<Metric>>,
    pieces: Vec<WalkPiece>,
    /// The number of pieces that are measured, as far as they are to be.
    metered: usize,
    /// The frames in which each foot is planted, by [`Foot::index`].
    planted: [Vec<bool>; 4],
    frames: usize,
    ends: bool,
    /// The length to extend the walk to next, frames.
    goal: usize,
    /// The walk to be shown, as far as it is assembled.
    publishing: Option<Publishing>,
    /// The measurements of the walk that was shown first.
    seen: Option<WalkMeasurements>,
    walk: Option<Arc<Walk>>,
}

impl WalkBuilder {
    /// Begins a walk, with a search for a way along the requested path if there is one. `others`
    /// may have results for the same graph that this one needs.
    pub(super) fn new<'a>(
        built: &Arc<BuiltGraph>,
        wanted: &WalkRequest,
        mut others: impl Iterator<Item = &'a Self>,
    ) -> Result<Self, LabError> {
        let knows = |other: &&Self| {
            other.run_is_known
                && Arc::ptr_eq(&other.built, built)
                && other.wanted.weights == wanted.weights
        };
        let mut builder = if let Some(known) = others.find(knows) {
            Self::with_known_run(known, wanted)?
        } else {
            let choices = Choices::new(built.graph(), &wanted.weights)?;
            Self::idle(built, wanted, Arc::new(choices))?
        };
        if !wanted.path.is_empty() && wanted.jump.is_none() {
            let path = GroundPath::new(&wanted.path)?;
            let search = FollowSearch::new(
                built.graph(),
                NodeIndex::new(0),
                &path,
                PATH_BUDGET,
                &wanted.stitch,
            );
            builder.search = Some((search, path));
        }
        Ok(builder)
    }

    /// Begins a walk along the path as far as it has been found.
    fn preview(&self, found: FollowedWalk, length_m: f64) -> Result<Self, LabError> {
        let mut builder = Self::with_known_run(self, &self.wanted)?;
        builder.follow(found, length_m, true);
        Ok(builder)
    }

    /// Begins a walk in the same graph with the same weights, whose expected run is known.
    fn with_known_run(other: &Self, wanted: &WalkRequest) -> Result<Self, LabError> {
        Ok(Self {
            run: other.run.clone(),
            run_is_known: true,
            probabilities: other.probabilities.clone(),
            ..Self::idle(&other.built, wanted, Arc::clone(&other.choices))?
        })
    }

    fn idle(
        built: &Arc<BuiltGraph>,
        wanted: &WalkRequest,
        choices: Arc<Choices>,
    ) -> Result<Self, LabError> {
        Ok(Self {
            plan: Plan::new(built.graph(), &choices, wanted)?,
            probabilities: None,
            run: None,
            run_is_known: false,
            search: None,
            searched_secs: 0.0,
            preview: None,
            trace: None,
            stitcher: Stitcher::new(Arc::clone(built.clips.set()), &wanted.stitch),
            meter: WalkMeter::new(built.clips.set()),
            metrics: None,
            pieces: Vec::new(),
            metered: 0,
            planted: Default::default(),
            frames: 0,
            ends: false,
            goal: 0,
            publishing: None,
            seen: None,
            walk: None,
            choices,
            built: Arc::clone(built),
            wanted: wanted.clone(),
        })
    }

    /// Returns the walk as far as it was published.
    pub(super) fn walk(&self) -> Option<&Arc<Walk>> {
        self.walk.as_ref()
    }

    /// Returns its plan, for a walk that follows it.
    pub(super) fn plan(&mut self) -> &mut Plan {
        &mut self.plan
    }

    fn fps(&self) -> f64 {
        self.built.clips.set().fps()
    }

    /// Returns whether the walk should be longer for this playhead.
    pub(super) fn is_short(&self, now_secs: f64) -> bool {
        let Some(walk) = self.walk.as_ref().filter(|_| self.search.is_none()) else {
            return true;
        };
        let secs = walk.motion.clip().frames() as f64 / self.fps();
        !walk.ends && !walk.is_jump && secs < (now_secs + LEAD_SECS).min(MAX_SECS)
    }

    /// Returns the progress of the work under way, 0 to 1.
    pub(super) fn progress(&self) -> f64 {
        let searched = self.search.as_ref().map_or(1.0, |(search, path)| search.progress(path));
        0.4 * searched + 0.6 * (self.frames as f64 / self.goal.max(1) as f64).min(1.0)
    }

    /// Does one slice. Returns `true` if there is a new walk to publish. `guide` is the walk that
    /// this one follows.
    pub(super) fn step(
        &mut self,
        now_secs: f64,
        guide: Option<&mut Plan>,
    ) -> Result<bool, LabError> {
        if self.probabilities.is_none() {
            self.probabilities = Some(Arc::new(self.built.probabilities(&self.choices)));
            return Ok(false);
        }
        if let Some([leave, enter]) = self.wanted.jump {
            self.walk = Some(Arc::new(self.jump(leave, enter)?));
            return Ok(true);
        }
        if !self.run_is_known {
            if let Some(run) = &mut self.run {
                self.run_is_known = run.advance(RUN_EDGES);
            } else {
                self.run = Some(RunLength::new(self.built.graph(), &self.choices));
            }
            return Ok(false);
        }
        if self.search.is_some() {
            return self.seek(now_secs);
        }
        if self.meter() {
            return Ok(false);
        }
        if self.publishing.is_none() && (self.goal <= self.frames || self.goal == 0) {
            self.goal = self.next_goal(now_secs);
        }
        if self.frames < self.goal && !self.ends {
            self.stay(guide)?;
            return Ok(false);
        }
        let found = if let Some(publishing) = self.publishing.take() {
            publishing
        } else {
            let assembling = WalkAssembly::new(&self.pieces, self.goal.min(self.frames));
            Publishing::Assembling(Box::new(assembling.ok_or(GraphError::NoClips)?))
        };
        match self.published(found)? {
            Ok(motion) => {
                self.walk = Some(Arc::new(self.walk_of(motion)));
                Ok(true)
            }
            Err(publishing) => {
                self.publishing = Some(publishing);
                Ok(false)
            }
        }
    }

    /// Returns a motion that is ready to be shown, or what is left to measure of it.
    fn measured_or_pending(
        &self,
        shown: Motion,
        free: Option<Arc<Clip>>,
    ) -> Result<Motion, Publishing> {
        if self.seen.is_some() {
            return Ok(shown);
        }
        Err(Publishing::Measuring(Box::new(Measuring::new(shown, free))))
    }

    /// Does a slice from the pieces to a walk that is shown: returns the motion, or the remaining
    /// work.
    fn published(
        &mut self,
        publishing: Publishing,
    ) -> Result<Result<Motion, Publishing>, LabError> {
        match publishing {
            Publishing::Assembling(mut assembling) => {
                if !assembling.advance(&self.pieces, PUBLISHED_FRAMES) {
                    return Ok(Err(Publishing::Assembling(assembling)));
                }
                let motion = self.motion(*assembling)?;
                let Some(lock) = self.wanted.foot_lock else {
                    return Ok(self.measured_or_pending(motion, None));
                };
                if let Some(locking) = locking(
                    Arc::clone(motion.clip()),
                    motion.roles(),
                    motion.contacts(),
                    motion.ground_m(),
                    lock,
                )? {
                    Ok(Err(Publishing::Locking(Box::new(locking), Box::new(motion))))
                } else {
                    let free = Arc::clone(motion.clip());
                    Ok(self.measured_or_pending(motion, Some(free)))
                }
            }
            Publishing::Locking(mut locking, motion) => {
                if locking.advance(LOCKED_FRAMES) {
                    return Ok(Err(Publishing::Locking(locking, motion)));
                }
                let clip = Arc::new(locking.finish()?);
                let free = Arc::clone(motion.clip());
                let locked = motion.with_clip(clip, motion.ground_frames().to_vec());
                Ok(self.measured_or_pending(locked, Some(free)))
            }
            Publishing::Measuring(mut measuring) => {
                if measuring.advance(MEASURED_FRAMES) {
                    return Ok(Err(Publishing::Measuring(measuring)));
                }
                let (shown, seen) = measuring.finish();
                self.seen = Some(seen);
                Ok(Ok(shown))
            }
        }
    }

    /// Returns the next length in frames: first the part that is measured, then as far as the
    /// playhead requires, with a margin.
    fn next_goal(&self, now_secs: f64) -> usize {
        let mut secs = self.wanted.measured_secs;
        if let Some(walk) = &self.walk {
            secs = 1.25 * walk.motion.clip().frames() as f64 / self.fps();
        }
        if now_secs + LEAD_SECS > secs {
            secs = now_secs + 2.0 * LEAD_SECS;
        }
        // In tens of seconds, because a kept walk stores its length.
        ((secs / 10.0).ceil() * 10.0)
            .min(MAX_SECS.max(self.wanted.measured_secs))
            .mul_add(self.fps(), 0.5) as usize
    }

    /// Does a slice of the search for a path, or of the walk that previews the best so far.
    fn seek(&mut self, now_secs: f64) -> Result<bool, LabError> {
        if let Some(mut preview) = self.preview.take() {
            if preview.step(now_secs, None)? {
                self.walk = preview.walk;
                return Ok(true);
            }
            self.preview = Some(preview);
            return Ok(false);
        }
        let Some((search, path)) = &mut self.search else {
            return Ok(false);
        };
        let is_over = search.advance(self.built.graph(), path, PATH_NODES);
        if is_over || self.searched_secs >= PATH_WAIT_SECS {
            let found = search.so_far(self.built.graph(), path);
            let length = path.length();
            self.searched_secs = 0.0;
            if is_over {
                self.search = None;
                self.follow(found, length, false);
                // The preview is discarded.
                self.walk = None;
            } else {
                self.preview = Some(Box::new(self.preview(found, length)?));
            }
        }
        Ok(false)
    }

    /// Returns whether a path is searched for.
    pub(super) fn is_searching(&self) -> bool {
        self.search.is_some()
    }

    /// Records the duration of the last slice, seconds.
    pub(super) fn took(&mut self, secs: f64) {
        if self.is_searching() && self.preview.is_none() {
            self.searched_secs += secs;
        }
    }

    /// Makes the walk follow a path that was found.
    fn follow(&mut self, found: FollowedWalk, length_m: f64, is_searching: bool) {
        self.trace = Some(FollowedPath {
            points: self.wanted.path.clone(),
            rms_m: found.rms_m,
            along_m: found.along_m,
            length_m,
            looked_at: found.looked_at,
            is_searching,
        });
        self.plan.take(found.edges);
        self.stitcher.start_at(found.world_from_first);
    }

    /// Adds one stay.
    fn stay(&mut self, guide: Option<&mut Plan>) -> Result<(), GraphError> {
        let Some(stay) = self.plan.stay(self.pieces.len(), guide) else {
            self.ends = true;
            return Ok(());
        };
        let graph = Arc::clone(self.built.graph());
        let piece = self.stitcher.stitch(&graph, &stay)?;
        self.take(piece);
        Ok(())
    }

    /// Measures a slice of the walk, as much as is requested. Returns `false` if nothing is left to
    /// do.
    fn meter(&mut self) -> bool {
        let Some(piece) = self.pieces.get(self.metered).filter(|_| self.metrics.is_none()) else {
            return false;
        };
        if self.meter.advance(piece, self.built.clips.profile(), METERED_FRAMES) {
            self.metered += 1;
            if (self.meter.frames() as f64) >= self.wanted.measured_secs * self.fps() {
                self.metrics = Some(self.measured());
            }
        }
        true
    }

    fn take(&mut self, piece: WalkPiece) {
        for frame in 0..piece.clip.frames() {
            let place = piece.shown_at(frame);
            let motion = self.built.clips.motions().get(place.clip);
            for (foot, planted) in Foot::ALL.into_iter().zip(&mut self.planted) {
                let stands = motion.is_some_and(|motion| {
                    motion.contacts().planted(foot, place.frame.min(motion.clip().frames() - 1))
                });
                planted.push(stands);
            }
        }
        self.frames += piece.clip.frames();
        self.pieces.push(piece);
    }

    fn measured(&self) -> Vec<Metric> {
        of_walk(&self.meter.metrics(self.built.clips.profile()), self.fps()).to_vec()
    }

    /// Returns the assembled frames as a motion.
    fn motion(&self, assembling: WalkAssembly) -> Result<Motion, GraphError> {
        let (clip, ground_frames) = assembling.finish()?;
        let motions = self.built.clips.motions();
        let first = motions.first();
        let roles = first.map(|motion| motion.roles().clone()).unwrap_or_default();
        // The lowest ground: no foot is lifted off the ground of its own clip.
        let ground_m = motions.iter().map(|motion| motion.ground_m()).min_by(f32::total_cmp);
        let contacts = Contacts::of_feet(Foot::of(roles.body_plan()), |foot| {
            self.planted[foot.index()].iter().copied().take(clip.frames()).collect()
        });
        // Without seams: a walk is left anywhere, since all of it is transitions.
        Ok(Motion::with_ground_frames(clip, &roles, ground_frames)
            .with_feet(first.map(|motion| motion.feet()).unwrap_or_default())
            .with_contacts(contacts)
            .with_ground_m(ground_m.unwrap_or(0.0)))
    }

    /// Returns the walk in its current state.
    fn walk_of(&self, motion: Motion) -> Walk {
        let walked = match &self.metrics {
            Some(metrics) => metrics.clone(),
            None => self.measured(),
        };
        let slides = self.seen.iter().flat_map(|seen| &seen.slides);
        let run = self.run.as_ref();
        let run_secs = run.and_then(|run| run.secs(self.built.graph(), &self.choices));
        Walk {
            built: Arc::clone(&self.built),
            choices: Arc::clone(&self.choices),
            probabilities: self.probabilities.clone().unwrap_or_default(),
            run_secs: run_secs.filter(|_| self.built.is_pruned() || self.built.dead_ends() == 0),
            passed: Arc::new(self.pieces.iter().map(WalkStay::of).collect()),
            missed: self.plan.missed().to_vec(),
            metrics: slides.copied().chain(walked).collect(),
            trace: self.seen.as_ref().map(|seen| Arc::clone(&seen.trace)),
            ends: self.ends && motion.clip().frames() == self.frames,
            is_jump: self.wanted.jump.is_some(),
            followed: self.trace.clone(),
            is_guided: self.wanted.guide.is_some(),
            motion: Arc::new(motion),
        }
    }

    /// Builds a walk from the end of one clip, a transition, and the beginning of another.
    fn jump(&mut self, leave: Place, enter: Place) -> Result<Walk, LabError> {
        let whole = Arc::clone(self.built.whole());
        let index = self.built.jump_of(leave, enter).ok_or_else(|| {
            let name =
                |place: Place| self.built.clips.names().get(place.clip).map_or("?", String::as_str);
            LabError::NoJump {
                leave: leave.frame,
                from: name(leave).to_owned(),
                enter: enter.frame,
                to: name(enter).to_owned(),
            }
        })?;
        let set = self.built.clips.set();
        let around = (AROUND_JUMP_SECS * self.fps()).round() as usize;
        let first = Stay {
            clip: leave.clip,
            from: leave.frame.saturating_sub(around),
            to: leave.frame,
            jump: None,
        };
        let window = self.built.options().blend_window;
        let second = Stay {
            clip: enter.clip,
            from: enter.frame,
            to: (enter.frame + window + around).min(set.frames_of(enter.clip)),
            jump: Some(index),
        };
        for stay in [first, second] {
            let piece = self.stitcher.stitch(&whole, &stay)?;
            self.take(piece);
        }
        while self.meter() {}
        let assembling = WalkAssembly::new(&self.pieces, self.frames).ok_or(GraphError::NoClips)?;
        let mut publishing = Publishing::Assembling(Box::new(assembling));
        // A few seconds of motion.
        let motion = loop {
            match self.published(publishing)? {
                Ok(motion) => break motion,
                Err(rest) => publishing = rest,
            }
        };
        let mut walk = self.walk_of(motion);
        // These metrics do not apply to a single transition.
        walk.metrics
            .retain(|metric| !matches!(metric.id, MetricId::SeamsPerMinute | MetricId::Variety));
        Ok(walk)
    }
}
