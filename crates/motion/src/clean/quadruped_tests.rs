//! Tests of faults in the motion of a body on four legs.

use super::{Fault, FaultKind, MendOptions, find_faults, mend};
use crate::clip::Motion;
use crate::clip::fixtures::QuadrupedWalk;
use crate::skeleton::{FootPair, Roles};
use glam::Vec3;
use std::sync::Arc;

fn skating(motion: &Arc<Motion>) -> Vec<Fault> {
    let faults = find_faults(motion);
    assert!(faults.iter().all(|fault| fault.kind != FaultKind::Rate), "{faults:#?}");
    faults.into_iter().filter(|fault| fault.kind == FaultKind::Skating).collect()
}

/// Returns whether a fault is one of a foot of this pair.
fn is_of(fault: &Fault, pair: FootPair, roles: &Roles) -> bool {
    let own = |foot: crate::skeleton::Foot| roles.get(foot.leg()[2]);
    let mut feet = crate::skeleton::Foot::ALL.into_iter().filter(|foot| foot.pair == pair);
    feet.any(|foot| own(foot).is_some_and(|joint| fault.joints.contains(&joint)))
}

#[test]
fn sliding_forefeet_are_found_and_mended() {
    for axis in [None, Some(Vec3::X)] {
        let still = QuadrupedWalk { axis, ..QuadrupedWalk::default() };
        let sound = skating(&Arc::new(Motion::analyze(still.clip())));
        assert!(sound.iter().all(|fault| !fault.is_sure()), "{axis:?}: {sound:#?}");
        let made = QuadrupedWalk { fore_slide_mps: 0.15, ..still };
        let motion = Arc::new(Motion::analyze(made.clip()));
        let faults = skating(&motion);
        let of_forefeet =
            faults.iter().filter(|fault| is_of(fault, FootPair::Fore, motion.roles())).count();
        assert!(of_forefeet >= 6, "{axis:?}: {faults:#?}");
        let all: Vec<&Fault> = faults.iter().collect();
        let mended = mend(&motion, &all, &MendOptions::default()).unwrap().motion;
        let left = skating(&mended);
        assert!(left.is_empty(), "{axis:?}: {left:#?}");
    }
}
