//! Recordings played through a controller, and their metrics.

use super::control::Recording;
use super::database::Database;
use super::features::RATE;
use super::{Candidate, Controller, ControllerOptions, MatchError, SearchReason};
use crate::clip::{Clip, Contacts, character_frames};
use crate::math::{Planar, wrap_angle};
use crate::metrics::{Extreme, StanceSlide, foot_slides};
use crate::skeleton::Foot;
use std::sync::Arc;

/// The motion of a controller for a recording, and the desired motion.
#[derive(Clone, Debug, PartialEq)]
pub struct Drive {
    /// The motion at [`RATE`], feet planted; one frame per tick.
    pub clip: Clip,
    /// The contacts of the feet, from the clips that were played.
    pub contacts: Contacts,
    /// The character's root of each frame.
    pub roots: Vec<Planar>,
    /// The simulation object of each frame: the desired ground frame of the character.
    pub desired: Vec<Planar>,
    /// The desired yaw in each frame, radians.
    pub goals: Vec<f64>,
    /// The jumps.
    pub jumps: Vec<Jump>,
    /// Number of searches.
    pub searches: usize,
    /// Number of frames that the searches visited.
    pub visited: usize,
}

/// A jump of a controller from one frame to another.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Jump {
    /// The first frame of the drive that is played from the new frame.
    pub frame: usize,
    /// The cause of the search.
    pub reason: SearchReason,
    /// The frame before the jump, and the cost of continuing there.
    pub from: Candidate,
    /// The frame after the jump, and its cost.
    pub to: Candidate,
}

/// The least change of the desired facing that counts as a turn, radians.
const MIN_TURN_RADIANS: f64 = 0.6;
/// A turn is complete when the body faces within this of the desired yaw, and stays there, radians:
/// 20°. Walking sways it by up to 10°.
const FACING_TOLERANCE_RADIANS: f64 = 0.35;

/// Quality measures of a [`Drive`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DriveMetrics {
    /// Mean distance of the character from the simulation object, centimetres.
    pub error_cm: f64,
    /// The largest distance, centimetres.
    pub worst_error_cm: f64,
    /// The frame of the largest distance; `None` where there is no distance.
    pub worst_error_at: Option<usize>,
    /// The longest time from the input of a turn until the body faces there (within 20°, and
    /// stays), seconds. Infinite if it never does; `None` without turns.
    pub turn_secs: Option<f64>,
    /// The frame from which on the body faces there; `None` if no turn was completed.
    pub turned_at: Option<usize>,
    /// Mean slide of a stance, centimetres; `None` without stances.
    pub skate_cm: Option<f64>,
    /// The slide of the worst stance, centimetres.
    pub worst_skate_cm: Option<f64>,
    /// The frame in which that foot slides fastest; `None` where none slides.
    pub worst_skate_at: Option<usize>,
    /// Jumps per minute.
    pub seams_per_minute: f64,
    /// The shortest time between two jumps, seconds; `None` for fewer than two.
    pub shortest_secs: Option<f64>,
}

/// Controls a character by a recording, from the origin.
///
/// # Errors
/// [`MatchError`] when an option is out of range.
pub fn drive(
    database: &Arc<Database>,
    options: ControllerOptions,
    recording: &Recording,
) -> Result<Drive, MatchError> {
    let mut controller = Controller::new(Arc::clone(database), options, &Planar::IDENTITY)?;
    let ticks = recording.ticks();
    let mut poses = Vec::with_capacity(ticks);
    let mut planted: Vec<[bool; 4]> = Vec::with_capacity(ticks);
    let (mut roots, mut desired, mut goals) =
        (Vec::with_capacity(ticks), Vec::with_capacity(ticks), Vec::with_capacity(ticks));
    let (mut jumps, mut searches, mut visited) = (Vec::new(), 0, 0);
    for (frame, control) in recording.controls().enumerate() {
        let before = controller.jumps();
        controller.tick(&control);
        if let Some(search) =
            controller.last_search().filter(|search| search.tick + 1 == controller.ticks())
        {
            searches += 1;
            visited += search.visited;
            if let Some(to) = search.winner.filter(|_| controller.jumps() > before) {
                jumps.push(Jump { frame, reason: search.reason, from: search.current, to });
            }
        }
        poses.push(controller.pose().clone());
        planted.push(controller.planted());
        roots.push(controller.root());
        desired.push(controller.simulation().place());
        goals.push(controller.simulation().goal_yaw);
    }
    Ok(Drive {
        clip: Clip::from_poses("drive", Arc::clone(database.skeleton()), RATE as f64, poses)?,
        contacts: Contacts::of_feet(Foot::of(database.roles().body_plan()), |foot| {
            planted.iter().map(|feet| feet[foot.index()]).collect()
        }),
        roots,
        desired,
        goals,
        jumps,
        searches,
        visited,
    })
}

impl Drive {
    /// Measures the drive.
    #[must_use]
    pub fn metrics(&self, database: &Database) -> DriveMetrics {
        let errors: Vec<f64> = (self.roots.iter().zip(&self.desired))
            .map(|(root, desired)| root.shift.distance(desired.shift) * 100.0)
            .collect();
        let worst_error = Extreme::largest(errors.iter().copied().enumerate());
        let turn = self.longest_turn(database);
        let frames = errors.len().max(1) as f64;
        let slides = foot_slides(&self.clip, database.roles(), &self.contacts);
        let worst_slide = StanceSlide::worst(&slides);
        let mean = |sum: f64, count: usize| (count > 0).then(|| sum / count as f64);
        let gaps =
            self.jumps.windows(2).map(|pair| (pair[1].frame - pair[0].frame) as f64 / RATE as f64);
        DriveMetrics {
            error_cm: errors.iter().sum::<f64>() / frames,
            worst_error_cm: worst_error.map_or(0.0, |error| error.value),
            worst_error_at: worst_error.and_then(|error| error.place()),
            turn_secs: turn.map(|turn| turn.value),
            turned_at: turn.filter(|turn| turn.value.is_finite()).and_then(|turn| turn.place()),
            skate_cm: mean(slides.iter().map(|slide| slide.slide_cm).sum(), slides.len()),
            worst_skate_cm: worst_slide.map(|slide| slide.value),
            worst_skate_at: worst_slide.and_then(|slide| slide.place()),
            seams_per_minute: self.jumps.len() as f64 * 60.0 * RATE as f64 / frames,
            shortest_secs: gaps.reduce(f64::min),
        }
    }

    /// Returns the time of the longest turn, seconds, and the frame from which on the body faces
    /// where it was asked to.
    fn longest_turn(&self, database: &Database) -> Option<Extreme> {
        let faces = character_frames(&self.clip, database.roles());
        let asked: Vec<usize> = (1..self.goals.len())
            .filter(|&frame| {
                wrap_angle(self.goals[frame] - self.goals[frame - 1]).abs() > MIN_TURN_RADIANS
            })
            .collect();
        let turn = |(index, &from): (usize, &usize)| {
            let to = asked.get(index + 1).copied().unwrap_or(self.goals.len());
            let off = |frame: usize| {
                wrap_angle(faces[frame].yaw - self.goals[frame]).abs() > FACING_TOLERANCE_RADIANS
            };
            match (from..to).rev().find(|&frame| off(frame)) {
                None => (from, 0.0),
                Some(last) if last + 1 == to => (last, f64::INFINITY),
                Some(last) => (last + 1, (last + 1 - from) as f64 / RATE as f64),
            }
        };
        Extreme::largest(asked.iter().enumerate().map(turn))
    }
}
