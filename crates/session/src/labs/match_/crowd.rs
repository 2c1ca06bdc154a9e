//! Extra characters that wander around, with the same clips and their own controllers.

use crate::labs::LabError;
use glam::DVec2;
use segue_motion::matching::{Control, Controller, ControllerOptions, Database, RATE};
use segue_motion::math::Planar;
use segue_motion::skeleton::Pose;
use std::f64::consts::TAU;
use std::sync::Arc;

/// The time for which a character keeps its direction, ticks.
const DIRECTION_TICKS: u64 = 3 * RATE as u64;
/// The distance from the driven character at which they turn back, metres.
const MAX_DISTANCE_M: f64 = 9.0;
/// The distance between neighbours at the beginning, metres.
const SPACING_M: f64 = 1.3;

/// A group of wandering characters.
#[derive(Debug)]
pub(crate) struct Crowd {
    database: Arc<Database>,
    walkers: Vec<Controller>,
    ticks: u64,
}

impl Crowd {
    /// Places `count` characters around a point, each with its own facing.
    pub(crate) fn new(
        database: &Arc<Database>,
        options: ControllerOptions,
        about: &Planar,
        count: usize,
    ) -> Result<Self, LabError> {
        let options = ControllerOptions { candidates: 1, ..options };
        let walker = |index: usize| {
            // A sunflower pattern: evenly spread without rows.
            let (turn, reach) =
                (2.399_963 * (index + 1) as f64, SPACING_M * libm::sqrt((index + 1) as f64));
            let shift = about.shift + DVec2::new(libm::sin(turn), libm::cos(turn)) * reach;
            let start = Planar { yaw: chance(index as u64, 0) * TAU, shift };
            Controller::new(Arc::clone(database), options, &start).map_err(LabError::from)
        };
        Ok(Self {
            database: Arc::clone(database),
            walkers: (0..count).map(walker).collect::<Result<_, _>>()?,
            ticks: 0,
        })
    }

    /// Returns whether the crowd has this number of characters from this database.
    pub(crate) fn is_of(&self, database: &Arc<Database>, count: usize) -> bool {
        Arc::ptr_eq(&self.database, database) && self.walkers.len() == count
    }

    /// Changes the options of all controllers.
    pub(crate) fn change(&mut self, options: ControllerOptions) -> Result<(), LabError> {
        let options = ControllerOptions { candidates: 1, ..options };
        for walker in self.walkers.iter_mut().filter(|walker| *walker.options() != options) {
            walker.set_options(options)?;
        }
        Ok(())
    }

    /// Advances by one tick: each character continues its way, and comes back from far off.
    pub(crate) fn tick(&mut self, about: &Planar) {
        for (index, walker) in self.walkers.iter_mut().enumerate() {
            // Staggered, so that they do not all turn at once.
            let beat = (self.ticks + 7 * index as u64) / DIRECTION_TICKS;
            let off = about.shift - walker.root().shift;
            let direction = if off.length() > MAX_DISTANCE_M {
                off.normalize_or_zero()
            } else {
                let turn = chance(index as u64, 2 * beat + 1) * TAU;
                DVec2::new(libm::sin(turn), libm::cos(turn))
            };
            let speed = match (chance(index as u64, 2 * beat + 2) * 10.0) as u32 {
                0 => 0.0,
                1 => 3.0,
                _ => 1.3,
            };
            walker.tick(&Control::new(direction * speed, None));
        }
        self.ticks += 1;
    }

    /// Returns the poses of all characters.
    pub(crate) fn poses(&self) -> impl Iterator<Item = &Pose> {
        self.walkers.iter().map(Controller::pose)
    }

    /// Returns the database, which determines the skeleton.
    pub(crate) fn database(&self) -> &Arc<Database> {
        &self.database
    }
}

/// Returns a number from 0 to 1 that is the same on every machine (Steele, Lea and Flood, "Fast
/// splittable pseudorandom number generators", 2014).
fn chance(who: u64, when: u64) -> f64 {
    let mut z =
        (who.wrapping_mul(0x1_0000) ^ when).wrapping_add(1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
}
