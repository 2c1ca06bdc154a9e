//! The controller: from the player's input to the character's pose, tick by tick.

mod feet;
mod options;
mod record;
mod seek;

pub use options::{ControllerOptions, FollowOptions, FootPlanting, Hysteresis, SearchMethod};
pub use record::{Candidate, HoldReason, SearchReason, SearchRecord};

use super::control::Control;
use super::database::{Database, Place};
use super::desired::Simulation;
use super::features::RATE;
use super::search::TreeIndex;
use super::{MatchError, TagFilter};
use crate::blend::translation_of;
use crate::math::{Planar, quat, spring, wrap_angle};
use crate::skeleton::Pose;
use crate::transition::{Inertializer, MovingPose};
use feet::Feet;
use glam::{DVec2, Vec3};
use std::sync::Arc;

/// Duration of a tick, seconds.
const TICK_SECS: f64 = 1.0 / RATE as f64;
/// The greatest speed at which a character is pulled along, as a share of the greatest speed of its
/// clips.
const MAX_PULL_SHARE: f64 = 1.1;
/// The least values of that greatest speed, for clips that stay in place or walk straight on alone,
/// metres and radians per second: 0.5 m/s and 80° per second.
const MIN_PULL_MPS: f64 = 0.5;
const MIN_TWIST_RADPS: f64 = 1.4;
/// The greatest number of ticks per step: after a pause of the page the missed time is skipped.
const MAX_TICKS_AT_ONCE: usize = 30;

/// A character that is controlled by motion matching.
///
/// It advances in ticks of 1/60 s ([`Self::tick`]) whatever the screen's rate is: the same input
/// gives the same motion, bit for bit. Features and queries are rounded to a grid, so that machines
/// whose trigonometry differs in its last digit choose the same frames, except for ties within
/// that. [`Self::step`] runs as many ticks as fit into a frame of the screen; [`Self::shown`] is
/// the pose between the last two.
#[derive(Debug)]
pub struct Controller {
    database: Arc<Database>,
    options: ControllerOptions,
    /// One weight per dimension.
    weights: Vec<f32>,
    simulation: Simulation,
    root: Planar,
    place: Place,
    inertializer: Inertializer,
    feet: Feet,
    pose: Pose,
    previous: Pose,
    /// By [`Foot::index`](crate::skeleton::Foot).
    planted: [bool; 4],
    /// Real time that has not become a tick yet, seconds.
    left_secs: f64,
    tick: u64,
    jumps: u64,
    last_search: Option<u64>,
    last_jump: Option<u64>,
    last_change: u64,
    last_input: LastInput,
    votes: u32,
    tree: Option<TreeIndex>,
    record: Option<SearchRecord>,
}

/// The input of the last search.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct LastInput {
    velocity: DVec2,
    yaw: f64,
    filter: TagFilter,
}

impl Controller {
    /// Returns a character that stands at `start`, in the frame of the database that is most like
    /// standing still.
    ///
    /// # Errors
    /// [`MatchError::Setting`] when an option is out of range.
    pub fn new(
        database: Arc<Database>,
        options: ControllerOptions,
        start: &Planar,
    ) -> Result<Self, MatchError> {
        options.validate()?;
        let feet = Feet::new(&database);
        let mut controller = Self {
            weights: options.weights.spread(database.features().layout()),
            simulation: Simulation::at_rest(start),
            root: *start,
            place: Place::default(),
            inertializer: Inertializer::new(options.transition),
            feet,
            pose: Pose::default(),
            previous: Pose::default(),
            planted: [false; 4],
            left_secs: 0.0,
            tick: 0,
            jumps: 0,
            last_search: None,
            last_jump: None,
            last_change: 0,
            last_input: LastInput::default(),
            votes: 0,
            tree: None,
            record: None,
            database,
            options,
        };
        controller.begin();
        Ok(controller)
    }

    /// Returns the database.
    #[must_use]
    pub fn database(&self) -> &Arc<Database> {
        &self.database
    }

    /// Returns the options.
    #[must_use]
    pub fn options(&self) -> &ControllerOptions {
        &self.options
    }

    /// Sets options from the next tick on. A transition in progress continues from its pose and
    /// velocity.
    ///
    /// # Errors
    /// [`MatchError::Setting`] when one is out of range; the old ones stay.
    pub fn set_options(&mut self, options: ControllerOptions) -> Result<(), MatchError> {
        options.validate()?;
        if options.transition != self.options.transition {
            let playing = self.moving(self.place);
            self.inertializer.change(options.transition, &playing);
        }
        self.weights = options.weights.spread(self.database.features().layout());
        self.options = options;
        Ok(())
    }

    /// Continues with another database of the same clips: with other tags, or other trajectory
    /// times.
    pub fn set_database(&mut self, database: Arc<Database>) {
        self.weights = self.options.weights.spread(database.features().layout());
        let known = database
            .motion(self.place.motion)
            .is_some_and(|motion| self.place.frame < motion.frames());
        let same = database.skeleton() == self.database.skeleton() && known;
        self.database = database;
        self.tree = None;
        self.record = None;
        if !same {
            self.feet = Feet::new(&self.database);
            self.begin();
        }
    }

    /// Returns the character's pose after the last tick, in the world, with planted feet.
    #[must_use]
    pub fn pose(&self) -> &Pose {
        &self.pose
    }

    /// Returns the pose between the last two ticks at the time given to [`Self::step`]: one tick
    /// behind it, and smooth at any rate of the screen.
    #[must_use]
    pub fn shown(&self) -> Pose {
        let part = (self.left_secs / TICK_SECS).clamp(0.0, 1.0) as f32;
        let (from, to) = (&self.previous, &self.pose);
        Pose {
            root_translation: from.root_translation.lerp(to.root_translation, part),
            rotations: (from.rotations.iter().zip(&to.rotations))
                .map(|(&a, &b)| quat::slerp(a, b, part))
                .collect(),
            translations: (from.translations.iter().zip(&to.translations))
                .map(|(a, b)| (b.0, a.1.lerp(b.1, part)))
                .collect(),
        }
    }

    /// Returns the character's ground frame: `world_from_character`.
    #[must_use]
    pub fn root(&self) -> Planar {
        self.root
    }

    /// Returns the simulation object.
    #[must_use]
    pub fn simulation(&self) -> &Simulation {
        &self.simulation
    }

    /// Returns the frame that is playing.
    #[must_use]
    pub fn place(&self) -> Place {
        self.place
    }

    /// Returns which feet are planted, by their indices ([`Foot::index`](crate::skeleton::Foot)):
    /// left, right, and the forefeet of a body on four legs. A planted foot has a contact in its
    /// clip, and has landed.
    #[must_use]
    pub fn planted(&self) -> [bool; 4] {
        self.planted
    }

    /// Returns the number of ticks since the beginning.
    #[must_use]
    pub fn ticks(&self) -> u64 {
        self.tick
    }

    /// Returns the number of jumps since the beginning.
    #[must_use]
    pub fn jumps(&self) -> u64 {
        self.jumps
    }

    /// Returns the record of the last search.
    #[must_use]
    pub fn last_search(&self) -> Option<&SearchRecord> {
        self.record.as_ref()
    }

    /// Returns the desired trajectory, at the trajectory times, in the world.
    #[must_use]
    pub fn desired(&self) -> Vec<Planar> {
        let at = |frames: &usize| {
            let later = self.simulation.after(*frames as f64 * TICK_SECS, &self.options.steering);
            later.place()
        };
        self.database.features().layout().ahead().iter().map(at).collect()
    }

    /// Returns the trajectory of the clip that is playing, at the trajectory times, in the world.
    #[must_use]
    pub fn matched(&self) -> Vec<Planar> {
        self.database.trajectory(self.place, &self.root)
    }

    /// Advances real time: runs the ticks that fit into it, all with the same input. Returns their
    /// number, which a recording must hold.
    pub fn step(&mut self, dt_secs: f64, control: &Control) -> usize {
        if dt_secs > 0.0 && dt_secs.is_finite() {
            self.left_secs += dt_secs;
        }
        let mut ticks = (self.left_secs / TICK_SECS) as usize;
        self.left_secs -= ticks as f64 * TICK_SECS;
        ticks = ticks.min(MAX_TICKS_AT_ONCE);
        for _ in 0..ticks {
            self.tick(control);
        }
        ticks
    }

    /// Runs one tick of 1/60 s.
    pub fn tick(&mut self, control: &Control) {
        self.simulation.set_goal(control);
        if let Some(reason) = self.reason(control.filter()) {
            self.seek(reason, control.filter());
        }
        let travelled = self.advance_frame();
        self.simulation = self.simulation.after(TICK_SECS, &self.options.steering);
        self.follow(&travelled);
        std::mem::swap(&mut self.pose, &mut self.previous);
        self.write_pose();
        self.tick += 1;
    }

    /// Plays one frame further; returns the step of the character in its own frame.
    fn advance_frame(&mut self) -> Planar {
        let mut step = Planar::IDENTITY;
        if let Some(motion) = self.database.motion(self.place.motion)
            && let Some(next) = motion.next(self.place.frame)
        {
            step =
                motion.root(self.place.frame).inverse().after(&motion.root(self.place.frame + 1));
            self.place.frame = next;
        }
        self.inertializer.advance(TICK_SECS);
        let step = self.inertializer.step(&step, TICK_SECS);
        self.root = self.root.after(&step);
        step
    }

    /// Pulls the character towards the simulation object, and holds it near (Holden, "Code vs Data
    /// Driven Displacement", 2021).
    ///
    /// The pull is no faster than the motion in the clips: walks alone cannot be pulled along at a
    /// run, nor spun around. The simulation object then waits, so that its distance stays within
    /// the limit.
    fn follow(&mut self, travelled: &Planar) {
        let Some(following) = self.options.following else {
            return;
        };
        let (off, turn) = (
            self.simulation.position - self.root.shift,
            wrap_angle(self.simulation.yaw - self.root.yaw),
        );
        // The exact share of exponential decay.
        let share = 1.0 - spring::velocity_decay(following.half_life_secs, TICK_SECS).0;
        let most = |own: f64| own * following.max_share;
        let drawn = (off * share).clamp_length_max(most(travelled.shift.length()));
        let most_turn = most(travelled.yaw.abs());
        let turned = (turn * share).clamp(-most_turn, most_turn);
        let left = (off - drawn).clamp_length_max(following.max_distance_m);
        let left_turn =
            (turn - turned).clamp(-following.max_angle_radians, following.max_angle_radians);
        let pace = self.database.pace();
        let room = |fastest: f64, own: f64| (fastest * TICK_SECS - own).max(0.0);
        let most_pull =
            room(MAX_PULL_SHARE * pace.travel_mps.max(MIN_PULL_MPS), travelled.shift.length());
        let most_twist =
            room(MAX_PULL_SHARE * pace.turn_radps.max(MIN_TWIST_RADPS), travelled.yaw.abs());
        let pulled = (off - left).clamp_length_max(most_pull);
        let twisted = (turn - left_turn).clamp(-most_twist, most_twist);
        self.root =
            Planar { yaw: wrap_angle(self.root.yaw + twisted), shift: self.root.shift + pulled };
        if pulled.length() < (off - left).length() {
            self.simulation.position =
                self.root.shift + (off - pulled).clamp_length_max(following.max_distance_m);
        }
        if twisted.abs() < (turn - left_turn).abs() {
            let ahead =
                (turn - twisted).clamp(-following.max_angle_radians, following.max_angle_radians);
            self.simulation.yaw = wrap_angle(self.root.yaw + ahead);
        }
    }

    fn write_pose(&mut self) {
        let Some(motion) = self.database.motion(self.place.motion) else {
            return;
        };
        let (clip, frame) =
            (motion.clip(), self.place.frame.min(motion.frames().saturating_sub(1)));
        let here = motion.root(frame).inverse();
        let pose = &mut self.pose;
        pose.rotations.clear();
        pose.rotations.extend_from_slice(clip.rotations(frame));
        let root_translation = here.apply(clip.root_translations()[frame]);
        let mut translations = Vec::with_capacity(1 + self.database.moving.len());
        translations.push(root_translation);
        translations
            .extend(self.database.moving.iter().map(|&joint| translation_of(clip, joint, frame)));
        if let Some(root) = pose.rotations.first_mut() {
            *root = here.rotation() * *root;
        }
        self.inertializer.apply(&mut pose.rotations, &mut translations);
        if let Some(root) = pose.rotations.first_mut() {
            *root = quat::renormalize(self.root.rotation() * *root);
        }
        pose.root_translation = self.root.apply(translations[0]);
        pose.translations.clear();
        pose.translations
            .extend(self.database.moving.iter().copied().zip(translations.into_iter().skip(1)));
        let own = motion.feet(frame).map(|own| own.turned(&self.root));
        let planting = self.options.planting.as_ref();
        let usual = &self.database.pace().joints_radps;
        self.planted =
            self.feet.apply(self.database.skeleton(), pose, own, planting, usual, TICK_SECS);
    }

    /// Begins at the simulation object.
    fn begin(&mut self) {
        let query = self.query();
        if let Some(hit) = self.find(&query, TagFilter::default(), None).best
            && let Some(place) = self.database.place(hit.frame)
        {
            self.place = place;
        }
        self.inertializer = Inertializer::new(self.options.transition);
        self.write_pose();
        self.previous.clone_from(&self.pose);
        self.record = None;
    }

    /// Returns a frame as a pose with velocities in the character's own frame.
    fn moving(&self, place: Place) -> MovingPose {
        let Some(motion) = self.database.motion(place.motion) else {
            return MovingPose::default();
        };
        let last = motion.frames().saturating_sub(1);
        let (clip, frame) = (motion.clip(), place.frame.min(last));
        // The step from this frame to the next; for the last one of a clip that ends, the step
        // before.
        let (from, to) = if motion.next(frame).is_some() {
            (frame, frame + 1)
        } else {
            (last.saturating_sub(1), last)
        };
        let at = |frame: usize| {
            let frame = frame % (last + 1);
            let here = motion.root(frame).inverse();
            let mut rotations = clip.rotations(frame).to_vec();
            if let Some(root) = rotations.first_mut() {
                *root = quat::renormalize(here.rotation() * *root);
            }
            let mut translations = vec![here.apply(clip.root_translations()[frame])];
            translations.extend(
                self.database.moving.iter().map(|&joint| translation_of(clip, joint, frame)),
            );
            (rotations, translations)
        };
        let (before, after) = (at(from), at(to));
        let rate = RATE as f32;
        let step = motion.root(from).inverse().after(&motion.root(to));
        let travel = Vec3::new(step.shift.x as f32, step.yaw as f32, step.shift.y as f32) * rate;
        let angular_velocities = before.0.iter().zip(&after.0);
        let velocities = before.1.iter().zip(&after.1);
        MovingPose {
            angular_velocities: angular_velocities
                .map(|(&a, &b)| quat::log(b * a.conjugate()) * rate)
                .collect(),
            velocities: velocities.map(|(&a, &b)| (b - a) * rate).collect(),
            rotations: if frame == from { before.0 } else { after.0 },
            translations: if frame == from { before.1 } else { after.1 },
            // The simulation root has no sway.
            travel,
            steady_travel: travel,
        }
    }
}
