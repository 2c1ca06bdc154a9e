//! Tests of the deliberate mistakes.

use super::*;
use crate::metrics::TransitionMetrics;
use crate::synth::{Action, Params, synthesize};

const METHODS: [Method; 6] = [
    Method::Cut,
    Method::Dissolve { window: 24, law: WeightLaw::Smooth },
    Method::Inertialize(Inertialization::Offset(Decay::Spring { half_life_secs: 0.2 })),
    Method::Inertialize(Inertialization::Offset(Decay::Cubic { blend_secs: 0.4 })),
    Method::Inertialize(Inertialization::Offset(Decay::Quintic { blend_secs: 0.4 })),
    Method::Inertialize(Inertialization::DeadBlend {
        blend_secs: 0.4,
        extrapolation_half_life_secs: 0.1,
    }),
];
const ROOT_OPTIONS: [(bool, RootBlend); 3] =
    [(true, RootBlend::Velocity), (true, RootBlend::World), (false, RootBlend::Velocity)];
const LEAVE: usize = 120;
const ENTER: usize = 31;

/// The built-in walk and run.
struct Pair {
    a: Motion,
    b: Motion,
}

fn walk_and_run() -> Pair {
    let [a, b] = [Action::Walk, Action::Run]
        .map(|action| Motion::analyze(synthesize(&Params::new(action)).unwrap().clip));
    Pair { a, b }
}

impl Pair {
    fn made(
        &self,
        method: Method,
        (align, root): (bool, RootBlend),
        mistake: Option<Mistake>,
    ) -> Concatenation {
        let options = TransitionOptions { align, root, ..TransitionOptions::new(method) };
        let (a, b) = (&self.a, &self.b);
        let made = match mistake {
            Some(mistake) => concatenate_mistaken(a, LEAVE, b, ENTER, &options, mistake),
            None => concatenate(a, LEAVE, b, ENTER, &options),
        };
        made.unwrap()
    }

    fn measured(&self, made: &Concatenation) -> TransitionMetrics {
        TransitionMetrics::measure(&self.a, &self.b, made)
    }
}

/// Returns every method that a mistake concerns, with the metrics without it and with it.
fn with_and_without(
    pair: &Pair,
    mistake: Mistake,
) -> impl Iterator<Item = (Method, TransitionMetrics, TransitionMetrics)> + '_ {
    let concerned = METHODS.into_iter().filter(move |method| mistake.concerns(method));
    concerned.map(move |method| {
        let of = |mistake| pair.measured(&pair.made(method, ROOT_OPTIONS[0], mistake));
        (method, of(None), of(Some(mistake)))
    })
}

#[test]
fn mistaken_rotations_spin_or_jump() {
    let pair = walk_and_run();
    for (method, right, wrong) in with_and_without(&pair, Mistake::NoHemisphereCheck) {
        assert!(wrong.spin_deg.unwrap() > right.spin_deg.unwrap() + 90.0, "{method:?} {wrong:?}");
        assert!(wrong.seam_dps.unwrap() > 4.0 * right.seam_dps.unwrap(), "{method:?} {wrong:?}");
    }
    for (method, right, wrong) in with_and_without(&pair, Mistake::EulerLerp) {
        assert!(
            wrong.seam_dps.unwrap() > 1_000.0 + right.seam_dps.unwrap(),
            "{method:?} {wrong:?}"
        );
    }
    for (method, right, wrong) in with_and_without(&pair, Mistake::DegreesForRadians) {
        assert!(wrong.seam_deg.unwrap() > 90.0 + right.seam_deg.unwrap(), "{method:?} {wrong:?}");
    }
}

#[test]
fn mistaken_alignment_spins_jumps_or_slides() {
    let pair = walk_and_run();
    for (method, right, wrong) in with_and_without(&pair, Mistake::AtanForAtan2) {
        assert!(wrong.spin_deg.unwrap() > right.spin_deg.unwrap() + 140.0, "{method:?} {wrong:?}");
    }
    for (method, right, wrong) in with_and_without(&pair, Mistake::DegreesInTransform) {
        // Half a turn is 180 radians then, which is 53° off.
        assert!(wrong.spin_deg.unwrap() > right.spin_deg.unwrap() + 30.0, "{method:?} {wrong:?}");
    }
    for method in METHODS {
        let wrong = pair.made(method, ROOT_OPTIONS[0], Some(Mistake::WrongFacingAxis));
        let (a, b) = (&pair.a, &pair.b);
        // The first frame is aligned by the projections of the Y axes.
        let stands = wrong.aligned_b.after(&b.ground_frames()[ENTER]);
        assert!(stands.shift.distance(a.ground_frames()[LEAVE].shift) < 1e-6);
        let shadow = |root: Quat| {
            let axis = root * Vec3::Y;
            f64::from(axis.x).atan2(axis.z.into())
        };
        let (of_a, of_b) = (a.clip().rotations(LEAVE)[0], b.clip().rotations(ENTER)[0]);
        let apart = wrap_angle(shadow(wrong.aligned_b.rotation() * of_b) - shadow(of_a));
        assert!(apart.abs() < 1e-3, "{method:?} {apart}");
    }
    for (method, right, wrong) in with_and_without(&pair, Mistake::NoAlignment) {
        assert!(wrong.skate_cm.unwrap() > right.skate_cm.unwrap() + 10.0, "{method:?} {wrong:?}");
    }
    let long = Method::Dissolve { window: 60, law: WeightLaw::Smooth };
    for method in [long, METHODS[2], METHODS[3], METHODS[4]] {
        let [right, wrong] = [None, Some(Mistake::WorldRoot)]
            .map(|mistake| pair.measured(&pair.made(method, ROOT_OPTIONS[0], mistake)));
        assert!(
            wrong.skate_cm.unwrap() > right.skate_cm.unwrap() + 5.0,
            "{method:?} {right:?} {wrong:?}"
        );
    }
}

#[test]
fn mistaken_velocities_stop_the_motion() {
    let pair = walk_and_run();
    for (method, right, wrong) in with_and_without(&pair, Mistake::VelocityDividedTwice) {
        if matches!(method, Method::Dissolve { .. }) {
            assert!(
                wrong.skate_cm.unwrap() > right.skate_cm.unwrap() + 40.0,
                "{method:?} {wrong:?}"
            );
        } else {
            assert!(
                wrong.seam_dps.unwrap() > 1.4 * right.seam_dps.unwrap(),
                "{method:?} {wrong:?}"
            );
        }
    }
    // A dissolve that nearly stands still continues rigidly after its window.
    let [right, wrong] = [None, Some(Mistake::VelocityDividedTwice)]
        .map(|mistake| pair.made(METHODS[1], ROOT_OPTIONS[0], mistake));
    let (end, last) = (right.transition.end, right.frames.len() - 1);
    let way = |made: &Concatenation, from: usize, to: usize| {
        made.frames[from].inverse().after(&made.frames[to]).shift
    };
    assert!(
        way(&wrong, LEAVE - 1, end - 1).length() < 0.01
            && way(&right, LEAVE - 1, end - 1).length() > 0.4
    );
    assert!(way(&wrong, end, last).distance(way(&right, end, last)) < 1e-3);
    let b_stands = wrong.world_from_b.after(&pair.b.ground_frames()[ENTER + last - LEAVE]);
    assert!(b_stands.shift.distance(wrong.frames[last].shift) < 1e-3);
}

#[test]
fn mistake_that_does_not_concern_a_method_changes_nothing() {
    let pair = walk_and_run();
    let at_once = Method::Dissolve { window: 1, law: WeightLaw::Smooth };
    for mistake in Mistake::ALL {
        for method in [Method::Cut, at_once] {
            let [right, wrong] =
                [None, Some(mistake)].map(|mistake| pair.made(method, ROOT_OPTIONS[0], mistake));
            assert_eq!(right == wrong, !mistake.concerns(&method), "{mistake:?} {method:?}");
        }
        // Before the transition the result is A, whatever the mistake is.
        let made = pair.made(METHODS[2], ROOT_OPTIONS[0], Some(mistake));
        assert_eq!(made.clip.pose(LEAVE - 1), pair.a.clip().pose(LEAVE - 1), "{mistake:?}");
        assert_eq!(made.frames.len(), made.clip.frames());
        // Incompatible clips are refused as usual.
        let options = TransitionOptions::new(METHODS[2]);
        let (a, b) = (&pair.a, &pair.b);
        assert!(concatenate_mistaken(a, LEAVE, b, 1 << 20, &options, mistake).is_err());
    }
}

#[test]
fn mixing_with_correct_differences_equals_concatenate() {
    let pair = walk_and_run();
    for method in METHODS {
        for place in ROOT_OPTIONS {
            let right = pair.made(method, place, None);
            let (align, root) = place;
            let options = TransitionOptions { align, root, ..TransitionOptions::new(method) };
            let again =
                RotationMixing::new(&pair.a, LEAVE, &pair.b, ENTER, &options, RotationMix::Right)
                    .mixed(right.clone())
                    .unwrap();
            let apart = rotations_of(&right.clip)
                .iter()
                .zip(rotations_of(&again.clip))
                .map(|(p, q)| quat::angle_between(*p, q))
                .fold(0.0, f32::max);
            assert!(apart < 2e-3, "{method:?} {place:?}: {apart}");
        }
    }
}
