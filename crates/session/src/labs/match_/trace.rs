//! The history of a driven character, tick by tick: its motion, and the reasons for its choices.

use crate::labs::LabError;
use crate::labs::{LabFacts, Outcome};
use crate::metrics::{Metric, MetricId};
use segue_motion::clip::{Clip, Contacts, Motion};
use segue_motion::matching::{
    Control, Controller, Database, Drive, DriveMetrics, Jump, Place, RATE, SearchRecord,
    Simulation, Steering,
};
use segue_motion::math::Planar;
use segue_motion::skeleton::{Foot, Pose};
use std::collections::VecDeque;
use std::sync::Arc;

/// One tick of a driven character.
#[derive(Clone, Debug)]
pub struct DriveMoment {
    /// The frame that played.
    pub place: Place,
    /// The position of the character: `world_from_character`.
    pub root: Planar,
    /// The simulation object.
    pub simulation: Simulation,
    /// The most recent search.
    pub search: Option<Arc<SearchRecord>>,
    /// Whether the character jumped to another frame in this tick.
    pub jumped: bool,
}

/// The history of a motion: one moment for each of its frames.
#[derive(Clone, Debug)]
pub struct DriveHistory {
    /// The database of its frames.
    pub database: Arc<Database>,
    /// The steering of the simulation object.
    pub steering: Steering,
    /// The moments, tick by tick.
    pub moments: Vec<Arc<DriveMoment>>,
    /// Whether it is live: the motion is then the most recent history.
    pub is_live: bool,
}

impl DriveHistory {
    /// Returns the moment at a time of the motion, seconds.
    #[must_use]
    pub fn at(&self, secs: f64) -> Option<&DriveMoment> {
        let last = self.moments.len().checked_sub(1)?;
        // The clamp maps earlier times and NaN to the first frame.
        let frame = (secs * RATE as f64).round().max(0.0).min(last as f64) as usize;
        self.moments.get(frame).map(|moment| &**moment)
    }

    /// Returns the horizon of the compared trajectories, seconds.
    #[must_use]
    pub fn horizon_secs(&self) -> f64 {
        self.database.features().layout().horizon() as f64 / RATE as f64
    }

    /// Returns the predicted path of the simulation object at that moment, `steps` and one places
    /// from now to the horizon.
    #[must_use]
    pub fn requested_path(&self, moment: &DriveMoment, steps: usize) -> Vec<Planar> {
        let horizon = self.horizon_secs();
        let secs = |step: usize| horizon * step as f64 / steps.max(1) as f64;
        (0..=steps)
            .map(|step| moment.simulation.after(secs(step), &self.steering).place())
            .collect()
    }

    /// Returns the path of the clip that plays, in the same places.
    #[must_use]
    pub fn matched_path(&self, moment: &DriveMoment, steps: usize) -> Vec<Planar> {
        let Some(motion) = self.database.motion(moment.place.motion) else {
            return Vec::new();
        };
        let horizon = self.database.features().layout().horizon();
        let world_from_clip = moment.root.after(&motion.root(moment.place.frame).inverse());
        (0..=steps)
            .map(|step| {
                world_from_clip
                    .after(&motion.root(moment.place.frame + horizon * step / steps.max(1)))
            })
            .collect()
    }

    /// Returns the times of the jumps, seconds.
    pub fn jumps_secs(&self) -> impl Iterator<Item = f64> + '_ {
        let jumps = self.moments.iter().enumerate().filter(|(_, moment)| moment.jumped);
        jumps.map(|(frame, _)| frame as f64 / RATE as f64)
    }
}

/// A controller with its history: all of it, or the most recent part.
#[derive(Debug)]
pub(super) struct Tracer {
    pub(super) controller: Controller,
    poses: VecDeque<Pose>,
    planted: VecDeque<[bool; 4]>,
    moments: VecDeque<Arc<DriveMoment>>,
    /// The greatest number of frames that are kept.
    most: usize,
    search: Option<Arc<SearchRecord>>,
}

impl Tracer {
    /// Returns a controller without history.
    pub(super) fn new(controller: Controller, most: usize) -> Self {
        Self {
            controller,
            poses: VecDeque::new(),
            planted: VecDeque::new(),
            moments: VecDeque::new(),
            most,
            search: None,
        }
    }

    /// Advances by one tick.
    pub(super) fn tick(&mut self, control: &Control) {
        let jumps = self.controller.jumps();
        self.controller.tick(control);
        let is_new = |search: &&SearchRecord| search.tick + 1 == self.controller.ticks();
        if let Some(search) = self.controller.last_search().filter(is_new) {
            self.search = Some(Arc::new(search.clone()));
        }
        self.note(self.controller.jumps() > jumps);
    }

    /// Records the current state.
    pub(super) fn note(&mut self, jumped: bool) {
        if self.poses.len() >= self.most {
            self.poses.pop_front();
            self.planted.pop_front();
            self.moments.pop_front();
        }
        self.poses.push_back(self.controller.pose().clone());
        self.planted.push_back(self.controller.planted());
        self.moments.push_back(Arc::new(DriveMoment {
            place: self.controller.place(),
            root: self.controller.root(),
            simulation: *self.controller.simulation(),
            search: self.search.clone(),
            jumped,
        }));
    }

    /// Returns the number of frames that are kept.
    pub(super) fn frames(&self) -> usize {
        self.poses.len()
    }

    /// Returns the motion with all facts about it except its metrics.
    pub(super) fn outcome(&self, is_live: bool) -> Result<Outcome, LabError> {
        let database = self.controller.database();
        let clip = Clip::from_poses(
            "drive",
            Arc::clone(database.skeleton()),
            RATE as f64,
            self.poses.iter().cloned(),
        );
        let frames = self.moments.iter().map(|moment| moment.root).collect();
        let motion = Motion::with_ground_frames(clip?, database.roles(), frames)
            .with_contacts(self.contacts())
            .with_ground_m(database.ground_m());
        let driven = DriveHistory {
            database: Arc::clone(database),
            steering: self.controller.options().steering,
            moments: self.moments.iter().cloned().collect(),
            is_live,
        };
        Ok(Outcome {
            facts: LabFacts::of(Arc::new(driven)),
            beside: database.motions().iter().map(|motion| Arc::clone(motion.clip())).collect(),
            ..Outcome::plain(Arc::new(motion))
        })
    }

    fn contacts(&self) -> Contacts {
        let roles = self.controller.database().roles();
        Contacts::of_feet(Foot::of(roles.body_plan()), |foot| {
            self.planted.iter().map(|feet| feet[foot.index()]).collect()
        })
    }

    /// Returns the metrics of the history.
    pub(super) fn metrics(&self, motion: &Motion) -> Vec<Metric> {
        let database = self.controller.database();
        let (mut jumps, mut searches, mut visited, mut last) = (Vec::new(), 0, 0, None);
        for (frame, moment) in self.moments.iter().enumerate() {
            let Some(search) = moment.search.as_ref().filter(|search| last != Some(search.tick))
            else {
                continue;
            };
            last = Some(search.tick);
            searches += 1;
            visited += search.visited;
            if let (true, Some(to)) = (moment.jumped, search.winner) {
                jumps.push(Jump { frame, reason: search.reason, from: search.current, to });
            }
        }
        let drive = Drive {
            clip: Clip::clone(motion.clip()),
            contacts: motion.contacts().clone(),
            roots: motion.ground_frames().to_vec(),
            desired: self.moments.iter().map(|moment| moment.simulation.place()).collect(),
            goals: self.moments.iter().map(|moment| moment.simulation.goal_yaw).collect(),
            jumps,
            searches,
            visited,
        };
        let mut metrics = of_drive(&drive.metrics(database)).to_vec();
        // A turn that was never made has no duration.
        for metric in &mut metrics {
            metric.value = metric.value.filter(|value| value.is_finite());
        }
        let mean = visited as f64 / searches.max(1) as f64;
        metrics.push(Metric::new(MetricId::FramesVisited, (searches > 0).then_some(mean)));
        metrics
    }
}

/// Returns the metrics of a drive beyond those of every result, in the order in which they are
/// listed.
pub(super) fn of_drive(found: &DriveMetrics) -> [Metric; 5] {
    let at = |id, value: Option<f64>, frame| Metric::at_frame(id, value, frame, RATE as f64);
    [
        Metric::new(MetricId::PositionError, found.error_cm),
        at(MetricId::LargestPositionError, Some(found.worst_error_cm), found.worst_error_at),
        at(MetricId::TurnTime, found.turn_secs, found.turned_at),
        at(MetricId::FootSlide, found.worst_skate_cm, found.worst_skate_at),
        Metric::new(MetricId::JumpsPerMinute, found.seams_per_minute),
    ]
}

impl Outcome {
    /// Returns the facts about the drive; `None` if the result was not driven.
    #[must_use]
    pub fn driven(&self) -> Option<&Arc<DriveHistory>> {
        self.facts.get()
    }
}
