//! Others that walk about, with the same clips and controllers of their own.

use crate::labs::LabError;
use glam::DVec2;
use segue_motion::matching::{Control, Controller, ControllerOptions, Database, RATE};
use segue_motion::math::Planar;
use segue_motion::skeleton::Pose;
use std::f64::consts::TAU;
use std::sync::Arc;

/// A walker keeps its direction for so long, ticks.
const STEADY: u64 = 3 * RATE as u64;
/// Whoever is farther than this from the one who is driven comes back, metres.
const FAR_M: f64 = 9.0;
/// Between neighbours at the beginning, metres.
const APART_M: f64 = 1.3;

/// The others.
#[derive(Debug)]
pub(crate) struct Crowd {
    database: Arc<Database>,
    walkers: Vec<Controller>,
    ticks: u64,
}

impl Crowd {
    /// So many stand about a place, each looking its own way.
    pub(crate) fn new(
        database: &Arc<Database>,
        options: ControllerOptions,
        about: &Planar,
        count: usize,
    ) -> Result<Self, LabError> {
        let options = ControllerOptions { candidates: 1, ..options };
        let walker = |index: usize| {
            // A sunflower: as even as it is far from rows.
            let (turn, reach) =
                (2.399_963 * (index + 1) as f64, APART_M * libm::sqrt((index + 1) as f64));
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

    /// How many they are, and from which database.
    pub(crate) fn is_of(&self, database: &Arc<Database>, count: usize) -> bool {
        Arc::ptr_eq(&self.database, database) && self.walkers.len() == count
    }

    /// Everybody takes over other options.
    pub(crate) fn change(&mut self, options: ControllerOptions) -> Result<(), LabError> {
        let options = ControllerOptions { candidates: 1, ..options };
        for walker in self.walkers.iter_mut().filter(|walker| *walker.options() != options) {
            walker.set_options(options)?;
        }
        Ok(())
    }

    /// One tick: each goes its way, and comes back from far off.
    pub(crate) fn tick(&mut self, about: &Planar) {
        for (index, walker) in self.walkers.iter_mut().enumerate() {
            // Not all at once.
            let beat = (self.ticks + 7 * index as u64) / STEADY;
            let off = about.shift - walker.root().shift;
            let direction = if off.length() > FAR_M {
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

    /// Where everybody is.
    pub(crate) fn poses(&self) -> impl Iterator<Item = &Pose> {
        self.walkers.iter().map(Controller::pose)
    }

    /// Whose body they have.
    pub(crate) fn database(&self) -> &Arc<Database> {
        &self.database
    }
}

/// A number from 0 to 1 that is the same for everybody (Steele, Lea and Flood, "Fast splittable
/// pseudorandom number generators", 2014).
fn chance(who: u64, when: u64) -> f64 {
    let mut z =
        (who.wrapping_mul(0x1_0000) ^ when).wrapping_add(1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
}
