//! Tests of the cycles of a body on four legs.

use super::GaitCycle;
use crate::clip::Motion;
use crate::clip::fixtures::QuadrupedWalk;
use crate::transition::{CycleSearch, find_cycle};
use glam::Vec3;

#[test]
fn cycle_of_a_walk_on_four_legs_is_that_of_its_hind_feet() {
    for axis in [None, Some(Vec3::X)] {
        let made = QuadrupedWalk { axis, ..QuadrupedWalk::default() };
        let motion = Motion::analyze(made.clip());
        let cycle = GaitCycle::find(&motion).unwrap();
        assert!((cycle.secs() - 0.8).abs() < 0.05, "{axis:?}: {} s", cycle.secs());
        assert!((cycle.speed_mps() - 0.55).abs() < 0.03, "{axis:?}: {} m/s", cycle.speed_mps());
        // A loop is whole cycles, after which all four feet are where they began.
        let cut = find_cycle(&motion, &CycleSearch::new(motion.clip().fps())).unwrap();
        let cycles = cut.cycle.len() as f64 / motion.clip().fps() / 0.8;
        assert!((cycles - cycles.round()).abs() < 0.06, "{axis:?}: {cycles} cycles");
        assert!(cut.phase_gap.is_some_and(|gap| gap < 0.05), "{axis:?}: {:?}", cut.phase_gap);
    }
}
