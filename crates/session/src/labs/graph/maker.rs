use super::plan::Plan;
use super::walk::Trace;
use super::wanted::Wanted;
use super::{Built, Passed, Walk};
use crate::labs::LabError;
use crate::labs::feet::{locking, slide, slide_before};
use petgraph::graph::NodeIndex;
use segue_motion::clip::{Clip, Contacts, Motion};
use segue_motion::graph::{
    Assembling, Choices, Followed, GraphError, GroundPath, PathSearch, Place, RunLength, Stay,
    Stitcher, WalkMeter, WalkMetrics, WalkPiece,
};
use segue_motion::metrics::{Metric, MotionTrace, SlideMeter, TraceMeter};
use segue_motion::skeleton::Side;
use segue_motion::transition::FootLocking;
use std::sync::Arc;

/// A walk is made so far ahead of the playhead, seconds.
const AHEAD_SECS: f64 = 20.0;
/// It does not get longer than this, seconds: at 60 frames per second and 31 joints that is 54 MB.
const LONGEST_SECS: f64 = 1_800.0;
/// Before and behind a single transition so much of both clips plays, seconds.
const AROUND_JUMP_SECS: f64 = 1.2;
/// Nodes that a search for a ground path looks at in all. It bounds what a link shows, on every
/// machine the same.
const PATH_BUDGET: usize = 60_000;
/// Nodes in one slice, about two milliseconds.
const PATH_NODES: usize = 2_000;
/// How long one waits for a search, seconds of work: then the best so far is walked, while the
/// search goes on to its end, and so again and again. How long that takes changes nothing of the
/// walk in the end.
const PATH_WAIT_SECS: f64 = 1.0;
/// Frames that one slice puts together to be shown, about three milliseconds.
const PUBLISHED_FRAMES: usize = 10_000;
/// Edges that one slice goes over for the expected run.
const RUN_EDGES: usize = 200_000;

/// Frames that one slice holds the feet of, about four milliseconds.
const LOCKED_FRAMES: usize = 2_000;
/// Frames that one slice measures the feet of, held and free, or the whole body, about four
/// milliseconds.
const MEASURED_FRAMES: usize = 1_000;
/// Frames that one slice measures the artefacts of, about two milliseconds.
const METERED_FRAMES: usize = 500;

/// A walk on its way to be shown. With held feet all of it is locked anew: a stance and what it
/// moves around it are a matter of a second, and a walk ends far ahead of the playhead. What has
/// played stays but for the plane in which a leg usually bends, which is a mean over the whole walk
/// and counts where a leg is nearly straight.
#[derive(Debug)]
enum Publishing {
    Assembling(Box<Assembling>),
    Locking(Box<FootLocking>, Box<Motion>),
    Measuring(Box<Measuring>),
}

/// What the joints and the feet of a walk do, and how far feet would slide if they were not held:
/// of each motion so far.
#[derive(Debug)]
struct Measuring {
    shown: Motion,
    meter: TraceMeter,
    slide: SlideMeter,
    /// The walk without the foot lock.
    free: Option<(Arc<Clip>, SlideMeter)>,
}

/// What was measured of a walk as it is shown.
#[derive(Debug)]
struct Seen {
    trace: Arc<MotionTrace>,
    slides: Vec<Metric>,
}

impl Measuring {
    /// Nothing is measured yet; `free` is the walk without the foot lock, where there is one.
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

    /// A slice. `false` when nothing is left to do.
    fn advance(&mut self, frames: usize) -> bool {
        let (clip, contacts) = (self.shown.clip(), self.shown.contacts());
        let of_free =
            |(free, meter): &mut (Arc<Clip>, SlideMeter)| meter.advance(free, contacts, frames);
        if self.slide.advance(clip, contacts, frames) | self.free.as_mut().is_some_and(of_free) {
            return true;
        }
        self.meter.advance(clip, frames)
    }

    fn finish(self) -> (Motion, Seen) {
        let before = self.free.map(|(_, meter)| slide_before(meter.worst_cm()));
        let seen = Seen {
            trace: Arc::new(self.meter.finish(self.shown.clip())),
            slides: std::iter::once(slide(self.slide.worst_cm())).chain(before).collect(),
        };
        (self.shown, seen)
    }
}

/// Makes a walk, stay by stay.
#[derive(Debug)]
pub(super) struct Maker {
    built: Arc<Built>,
    wanted: Wanted,
    choices: Arc<Choices>,
    run: RunLength,
    run_is_known: bool,
    search: Option<(PathSearch, GroundPath)>,
    /// Seconds of search since the best so far was shown.
    searched_secs: f64,
    /// Makes the walk that follows the path as far as it is known.
    preview: Option<Box<Self>>,
    trace: Option<Trace>,
    plan: Plan,
    stitcher: Stitcher,
    meter: WalkMeter,
    metrics: Option<Vec<Metric>>,
    pieces: Vec<WalkPiece>,
    /// Pieces that are measured, in so far as they are to be.
    metered: usize,
    /// When left and right foot stand.
    planted: [Vec<bool>; 2],
    frames: usize,
    ends: bool,
    /// How long it is to be next.
    goal: usize,
    /// The walk to be shown, as far as it is put together.
    publishing: Option<Publishing>,
    /// What was measured of the walk that was shown first.
    seen: Option<Seen>,
    walk: Option<Arc<Walk>>,
}

impl Maker {
    /// One that first looks for a way along the path that is wanted, where there is one. `others`
    /// may know of the same graph what this one needs.
    pub(super) fn new<'a>(
        built: &Arc<Built>,
        wanted: &Wanted,
        mut others: impl Iterator<Item = &'a Self>,
    ) -> Result<Self, LabError> {
        let knows = |other: &&Self| {
            other.run_is_known
                && Arc::ptr_eq(&other.built, built)
                && other.wanted.weights == wanted.weights
        };
        let mut maker = if let Some(known) = others.find(knows) {
            Self::like(known, wanted)?
        } else {
            let choices = Choices::new(built.graph(), &wanted.weights)?;
            let run = RunLength::new(built.graph(), &choices);
            Self::idle(built, wanted, Arc::new(choices), run)?
        };
        if !wanted.path.is_empty() && wanted.jump.is_none() {
            let path = GroundPath::new(&wanted.path)?;
            let search = PathSearch::new(
                built.graph(),
                NodeIndex::new(0),
                &path,
                PATH_BUDGET,
                &wanted.stitch,
            );
            maker.search = Some((search, path));
        }
        Ok(maker)
    }

    /// One that goes by what has been found of the path so far.
    fn preview(&self, found: Followed, length_m: f64) -> Result<Self, LabError> {
        let mut maker = Self::like(self, &self.wanted)?;
        maker.follow(found, length_m, true);
        Ok(maker)
    }

    /// One in the same graph with the same weights: how long it runs is known.
    fn like(other: &Self, wanted: &Wanted) -> Result<Self, LabError> {
        let mut maker =
            Self::idle(&other.built, wanted, Arc::clone(&other.choices), other.run.clone())?;
        maker.run_is_known = true;
        Ok(maker)
    }

    fn idle(
        built: &Arc<Built>,
        wanted: &Wanted,
        choices: Arc<Choices>,
        run: RunLength,
    ) -> Result<Self, LabError> {
        Ok(Self {
            plan: Plan::new(built.graph(), &choices, wanted)?,
            run,
            run_is_known: false,
            search: None,
            searched_secs: 0.0,
            preview: None,
            trace: None,
            stitcher: Stitcher::new(Arc::clone(built.cast.set()), &wanted.stitch),
            meter: WalkMeter::new(built.cast.set()),
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

    /// As far as it was given out.
    pub(super) fn walk(&self) -> Option<&Arc<Walk>> {
        self.walk.as_ref()
    }

    /// Its stays, for a walk that goes like it.
    pub(super) fn plan(&mut self) -> &mut Plan {
        &mut self.plan
    }

    fn fps(&self) -> f64 {
        self.built.cast.set().fps()
    }

    /// Whether it should be longer while the playhead is there.
    pub(super) fn is_short(&self, now_secs: f64) -> bool {
        let Some(walk) = self.walk.as_ref().filter(|_| self.search.is_none()) else {
            return true;
        };
        let secs = walk.motion.clip().frames() as f64 / self.fps();
        !walk.ends && !walk.is_jump && secs < (now_secs + AHEAD_SECS).min(LONGEST_SECS)
    }

    /// How much of what is under way is done, 0 to 1.
    pub(super) fn progress(&self) -> f64 {
        let searched = self.search.as_ref().map_or(1.0, |(search, path)| search.progress(path));
        0.4 * searched + 0.6 * (self.frames as f64 / self.goal.max(1) as f64).min(1.0)
    }

    /// One slice. `true` when there is a new walk to give out. `guide` is the walk that this one
    /// goes like.
    pub(super) fn step(
        &mut self,
        now_secs: f64,
        guide: Option<&mut Plan>,
    ) -> Result<bool, LabError> {
        if let Some([leave, enter]) = self.wanted.jump {
            self.walk = Some(Arc::new(self.jump(leave, enter)?));
            return Ok(true);
        }
        if !self.run_is_known {
            let steps = (RUN_EDGES / self.built.graph().graph().edge_count().max(1)).max(1);
            self.run_is_known = self.run.advance(steps);
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
            let assembling = Assembling::new(&self.pieces, self.goal.min(self.frames));
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

    /// A walk to be shown, or what is left to measure of it.
    fn unseen(&self, shown: Motion, free: Option<Arc<Clip>>) -> Result<Motion, Publishing> {
        if self.seen.is_some() {
            return Ok(shown);
        }
        Err(Publishing::Measuring(Box::new(Measuring::new(shown, free))))
    }

    /// A slice of what is between the pieces and a walk that is shown: the motion, or what is left
    /// to do.
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
                    return Ok(self.unseen(motion, None));
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
                    Ok(self.unseen(motion, Some(free)))
                }
            }
            Publishing::Locking(mut locking, motion) => {
                if locking.advance(LOCKED_FRAMES) {
                    return Ok(Err(Publishing::Locking(locking, motion)));
                }
                let clip = Arc::new(locking.finish()?);
                let free = Arc::clone(motion.clip());
                let locked = motion.with_clip(clip, motion.ground_frames().to_vec());
                Ok(self.unseen(locked, Some(free)))
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

    /// Frames: what is measured at first, then as far as the playhead asks for, and a good part
    /// more.
    fn next_goal(&self, now_secs: f64) -> usize {
        let mut secs = self.wanted.measured_secs;
        if let Some(walk) = &self.walk {
            secs = 1.25 * walk.motion.clip().frames() as f64 / self.fps();
        }
        if now_secs + AHEAD_SECS > secs {
            secs = now_secs + 2.0 * AHEAD_SECS;
        }
        // Tens of seconds: a walk that is kept says how long it is.
        ((secs / 10.0).ceil() * 10.0)
            .min(LONGEST_SECS.max(self.wanted.measured_secs))
            .mul_add(self.fps(), 0.5) as usize
    }

    /// A slice of the search for a path, or of the walk that shows the best so far.
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
                // What was shown meanwhile does not count.
                self.walk = None;
            } else {
                self.preview = Some(Box::new(self.preview(found, length)?));
            }
        }
        Ok(false)
    }

    /// Whether a path is searched for.
    pub(super) fn is_searching(&self) -> bool {
        self.search.is_some()
    }

    /// How long the last slice took, seconds.
    pub(super) fn took(&mut self, secs: f64) {
        if self.is_searching() && self.preview.is_none() {
            self.searched_secs += secs;
        }
    }

    /// The walk takes what was found.
    fn follow(&mut self, found: Followed, length_m: f64, is_searching: bool) {
        self.trace = Some(Trace {
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

    /// One stay more.
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

    /// Measures a slice of what is made, as much as is asked for. `false` when nothing is left to
    /// do.
    fn meter(&mut self) -> bool {
        let Some(piece) = self.pieces.get(self.metered).filter(|_| self.metrics.is_none()) else {
            return false;
        };
        if self.meter.advance(piece, self.built.cast.profile(), METERED_FRAMES) {
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
            let motion = self.built.cast.motions().get(place.clip);
            for side in Side::BOTH {
                let stands = motion.is_some_and(|motion| {
                    motion.contacts().planted(side, place.frame.min(motion.clip().frames() - 1))
                });
                self.planted[side.index()].push(stands);
            }
        }
        self.frames += piece.clip.frames();
        self.pieces.push(piece);
    }

    fn measured(&self) -> Vec<Metric> {
        let metrics: WalkMetrics = self.meter.metrics(self.built.cast.profile());
        metrics.list().to_vec()
    }

    /// What was assembled, as a motion.
    fn motion(&self, assembling: Assembling) -> Result<Motion, GraphError> {
        let (clip, ground_frames) = assembling.finish()?;
        let planted = self.planted.clone().map(|mut flags| {
            flags.truncate(clip.frames());
            flags
        });
        let motions = self.built.cast.motions();
        let first = motions.first();
        let roles = first.map(|motion| motion.roles().clone()).unwrap_or_default();
        // The lowest: no foot is lifted off the ground that its own clip has.
        let ground_m = motions.iter().map(|motion| motion.ground_m()).min_by(f32::total_cmp);
        // Without seams: a walk is left anywhere, since all of it is transitions.
        Ok(Motion::with_ground_frames(clip, &roles, ground_frames)
            .with_feet(first.map(|motion| motion.feet()).unwrap_or_default())
            .with_contacts(Contacts::from_flags(planted))
            .with_ground_m(ground_m.unwrap_or(0.0)))
    }

    /// The walk as it is now.
    fn walk_of(&self, motion: Motion) -> Walk {
        let walked = match &self.metrics {
            Some(metrics) => metrics.clone(),
            None => self.measured(),
        };
        let slides = self.seen.iter().flat_map(|seen| &seen.slides);
        let run_secs = self.run.secs(self.built.graph(), &self.choices);
        Walk {
            built: Arc::clone(&self.built),
            choices: Arc::clone(&self.choices),
            run_secs: run_secs.filter(|_| self.built.is_pruned() || self.built.dead_ends() == 0),
            passed: Arc::new(self.pieces.iter().map(Passed::of).collect()),
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

    /// The end of one clip, a transition, and the beginning of another.
    fn jump(&mut self, leave: Place, enter: Place) -> Result<Walk, LabError> {
        let whole = Arc::clone(self.built.whole());
        let index = self.built.jump_of(leave, enter).ok_or_else(|| {
            let name =
                |place: Place| self.built.cast.names().get(place.clip).map_or("?", String::as_str);
            LabError::NoJump {
                leave: leave.frame,
                from: name(leave).to_owned(),
                enter: enter.frame,
                to: name(enter).to_owned(),
            }
        })?;
        let set = self.built.cast.set();
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
        let assembling = Assembling::new(&self.pieces, self.frames).ok_or(GraphError::NoClips)?;
        let mut publishing = Publishing::Assembling(Box::new(assembling));
        // A few seconds of motion.
        let motion = loop {
            match self.published(publishing)? {
                Ok(motion) => break motion,
                Err(rest) => publishing = rest,
            }
        };
        let mut walk = self.walk_of(motion);
        // Of one transition these say nothing.
        walk.metrics.retain(|metric| !matches!(metric.id, "seams_per_min" | "variety"));
        Ok(walk)
    }
}
