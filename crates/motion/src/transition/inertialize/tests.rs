//! Tests of inertialization.

use super::*;
use proptest::prelude::*;

const KINDS: [Inertialization; 4] = [
    Inertialization::Offset(Decay::Spring { half_life_secs: 0.15 }),
    Inertialization::Offset(Decay::Cubic { blend_secs: 0.5 }),
    Inertialization::Offset(Decay::Quintic { blend_secs: 0.5 }),
    Inertialization::DeadBlend { blend_secs: 0.5, extrapolation_half_life_secs: 0.15 },
];

/// A joint and a root that rotate and move steadily, with a closed form.
#[derive(Clone, Copy, Debug)]
struct Steady {
    start: Vec3,
    spin: Vec3,
    place: Vec3,
    velocity: Vec3,
}

impl Steady {
    fn at(&self, secs: f32) -> MovingPose {
        MovingPose {
            rotations: vec![quat::exp(self.spin * secs) * quat::exp(self.start)],
            angular_velocities: vec![self.spin],
            translations: vec![self.place + self.velocity * secs],
            velocities: vec![self.velocity],
            travel: self.velocity,
            steady_travel: self.velocity,
        }
    }
}

fn vector(size: f32) -> impl Strategy<Value = Vec3> {
    (-size..size, -size..size, -size..size).prop_map(|(x, y, z)| Vec3::new(x, y, z))
}

fn steady() -> impl Strategy<Value = Steady> {
    (vector(1.5), vector(2.0), vector(1.0), vector(2.0))
        .prop_map(|(start, spin, place, velocity)| Steady { start, spin, place, velocity })
}

fn with_inertia(inertia: &mut Inertializer, mut pose: MovingPose) -> MovingPose {
    inertia.apply(&mut pose.rotations, &mut pose.translations);
    pose
}

fn off(a: &MovingPose, b: &MovingPose) -> f32 {
    quat::angle_between(a.rotations[0], b.rotations[0])
        + a.translations[0].distance(b.translations[0])
}

/// Returns the velocities from pose `a` to pose `b`, `dt` later.
fn rates(a: &MovingPose, b: &MovingPose, dt: f32) -> (Vec3, Vec3) {
    (
        quat::angular_velocity(a.rotations[0], b.rotations[0], dt),
        (b.translations[0] - a.translations[0]) / dt,
    )
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]
    #[test]
    fn inertializer_starts_with_the_old_pose_and_ends_with_the_new(
        old in steady(),
        new in steady(),
    ) {
        for how in KINDS {
            let mut inertia = Inertializer::new(how);
            prop_assert_eq!(&with_inertia(&mut inertia, new.at(0.3)), &new.at(0.3));
            inertia.trigger(&old.at(0.0), &new.at(0.0));
            prop_assert!(off(&with_inertia(&mut inertia, new.at(0.0)), &old.at(0.0)) < 1e-5);
            inertia.advance(3.0);
            prop_assert!(off(&with_inertia(&mut inertia, new.at(3.0)), &new.at(3.0)) < 1e-4);
        }
    }

    /// The rotations are any angle apart, and the next jump comes while the offsets of the last one
    /// are still decaying.
    #[test]
    fn inertializer_over_several_jumps_has_continuous_velocities(
        clips in [steady(), steady(), steady()],
        between in 0.01f32..0.4,
    ) {
        for how in KINDS {
            let mut inertia = Inertializer::new(how);
            inertia.trigger(&clips[0].at(0.0), &clips[1].at(0.0));
            let dt = 2e-3;
            let (mut secs, mut track) = (0.0_f32, vec![]);
            while secs < between {
                track.push(with_inertia(&mut inertia, clips[1].at(secs)));
                secs += dt;
                inertia.advance(f64::from(dt));
            }
            track.push(with_inertia(&mut inertia, clips[1].at(secs)));
            inertia.trigger(&clips[1].at(secs), &clips[2].at(secs));
            let seam = track.len() - 1;
            prop_assert!(
                off(&with_inertia(&mut inertia, clips[2].at(secs)), &track[seam]) < 1e-4,
                "{how:?}"
            );
            for _ in 0..3 {
                secs += dt;
                inertia.advance(f64::from(dt));
                track.push(with_inertia(&mut inertia, clips[2].at(secs)));
            }
            // Accelerations are finite on both sides: y² times the offset and 2y times the
            // velocity; the quintic's may be high, when it must not overshoot.
            if matches!(how, Inertialization::Offset(Decay::Quintic { .. })) {
                continue;
            }
            let (before, after) = (
                rates(&track[seam - 1], &track[seam], dt),
                rates(&track[seam], &track[seam + 1], dt),
            );
            let bound = dt * 1500.0;
            prop_assert!((before.0 - after.0).length() < bound, "{how:?} {} {}", before.0, after.0);
            prop_assert!((before.1 - after.1).length() < bound, "{how:?} {} {}", before.1, after.1);
        }
    }

    /// The half-life or the method changes in the middle of a transition.
    #[test]
    fn inertializer_change_keeps_pose_and_velocity(
        old in steady(),
        new in steady(),
        at in 0.01f32..0.4,
    ) {
        for (how, then) in KINDS.into_iter().flat_map(|how| KINDS.map(|then| (how, then))) {
            let mut inertia = Inertializer::new(how);
            inertia.trigger(&old.at(0.0), &new.at(0.0));
            let dt = 1e-3;
            inertia.advance(f64::from(at - dt));
            let before = with_inertia(&mut inertia, new.at(at - dt));
            inertia.advance(f64::from(dt));
            let here = with_inertia(&mut inertia, new.at(at));
            inertia.change(then, &new.at(at));
            prop_assert!(
                off(&with_inertia(&mut inertia, new.at(at)), &here) < 1e-4,
                "{how:?} {then:?}"
            );
            // A quintic may start with a high acceleration, so that it does not overshoot.
            if [how, then]
                .iter()
                .any(|how| matches!(how, Inertialization::Offset(Decay::Quintic { .. })))
            {
                continue;
            }
            inertia.advance(f64::from(dt));
            let after = with_inertia(&mut inertia, new.at(at + dt));
            let (before, after) = (rates(&before, &here, dt), rates(&here, &after, dt));
            let bound = dt * 1500.0;
            prop_assert!(
                (before.0 - after.0).length() < bound,
                "{how:?} {then:?} {} {}",
                before.0,
                after.0
            );
            prop_assert!(
                (before.1 - after.1).length() < bound,
                "{how:?} {then:?} {} {}",
                before.1,
                after.1
            );
        }
    }

    /// An extrapolated pose never makes the result jump the other way round.
    #[test]
    fn dead_blend_does_not_flip(old in steady(), new in steady()) {
        let mut inertia = Inertializer::new(KINDS[3]);
        inertia.trigger(&old.at(0.0), &new.at(0.0));
        let dt = 1.0 / 240.0;
        let mut last = with_inertia(&mut inertia, new.at(0.0));
        for step in 1..150 {
            inertia.advance(f64::from(dt));
            let next = with_inertia(&mut inertia, new.at(step as f32 * dt));
            prop_assert!(quat::angle_between(last.rotations[0], next.rotations[0]) < 0.15);
            last = next;
        }
    }

    #[test]
    fn inertializer_in_small_steps_equals_one_step(old in steady(), new in steady()) {
        for how in KINDS {
            let (mut fine, mut coarse) = (Inertializer::new(how), Inertializer::new(how));
            for inertia in [&mut fine, &mut coarse] {
                inertia.trigger(&old.at(0.0), &new.at(0.0));
            }
            for step in 1..=20 {
                fine.advance(0.01);
                with_inertia(&mut fine, new.at(step as f32 * 0.01));
            }
            coarse.advance(0.1);
            with_inertia(&mut coarse, new.at(0.1));
            coarse.advance(0.1);
            prop_assert!(
                off(&with_inertia(&mut fine, new.at(0.2)), &with_inertia(&mut coarse, new.at(0.2)))
                    < 1e-4,
                "{how:?}"
            );
        }
    }
}

#[test]
fn inertializer_step_leads_from_the_old_speed_to_the_new() {
    let pose = |travel: Vec3| MovingPose { travel, steady_travel: travel, ..MovingPose::default() };
    let (old, new, dt) = (Vec3::new(0.2, -1.0, 1.4), Vec3::new(0.0, 0.5, 3.5), 1.0 / 60.0);
    let step = Planar::new(0.5 * dt, 0.0, 3.5 * dt);
    for how in KINDS {
        let mut inertia = Inertializer::new(how);
        assert_eq!(inertia.step(&step, dt), step);
        inertia.trigger(&pose(old), &pose(new));
        inertia.advance(dt);
        let first = travel(&inertia.step(&step, dt), 60.0);
        assert!((first - old).length() < 0.25, "{how:?} {first}");
        inertia.advance(5.0);
        let last = travel(&inertia.step(&step, dt), 60.0);
        assert!((last - new).length() < 1e-4, "{how:?} {last}");
        assert_eq!(inertia.elapsed_secs(), dt + 5.0);
    }
}

/// A sway that continues in neither motion leaves the trajectory unchanged; a difference of speeds
/// does not.
#[test]
fn inertializer_step_returns_from_sway() {
    let dt = 1e-3;
    for how in &KINDS[..3] {
        let way = |old: MovingPose| {
            let mut inertia = Inertializer::new(*how);
            inertia.trigger(&old, &MovingPose::default());
            let mut here = Planar::IDENTITY;
            for _ in 0..3000 {
                inertia.advance(dt);
                here = here.after(&inertia.step(&Planar::IDENTITY, dt));
            }
            here
        };
        let swaying = way(MovingPose { travel: Vec3::new(0.3, 1.0, 0.0), ..MovingPose::default() });
        assert!(swaying.shift.length() < 5e-3 && swaying.yaw.abs() < 1e-3, "{how:?} {swaying:?}");
        let walking =
            way(MovingPose { travel: Vec3::Z, steady_travel: Vec3::Z, ..MovingPose::default() });
        let area = (0..3000).map(|i| how.remaining((f64::from(i) + 0.5) * dt) * dt).sum::<f64>();
        assert!((walking.shift.y - area).abs() < 1e-4, "{how:?} {walking:?} {area}");
    }
}

#[derive(serde::Deserialize)]
struct Golden {
    times: Vec<f64>,
    turns: Vec<GoldenTurn>,
}

#[derive(serde::Deserialize)]
struct GoldenTurn {
    old: [Vec3; 2],
    new: [Vec3; 2],
    spring_half_life: f64,
    spring: Vec<Vec3>,
    dead_blend: [f64; 2],
    dead: Vec<Vec3>,
}

#[test]
fn inertializer_agrees_with_scipy() {
    let golden: Golden =
        serde_json::from_str(include_str!("../../../tests/oracles/transition.json")).unwrap();
    for turn in &golden.turns {
        let of = |[start, spin]: [Vec3; 2]| Steady {
            start,
            spin,
            place: Vec3::ZERO,
            velocity: Vec3::ZERO,
        };
        let (old, new) = (of(turn.old), of(turn.new));
        let spring =
            Inertialization::Offset(Decay::Spring { half_life_secs: turn.spring_half_life });
        let dead = Inertialization::DeadBlend {
            blend_secs: turn.dead_blend[0],
            extrapolation_half_life_secs: turn.dead_blend[1],
        };
        for (how, wanted) in [(spring, &turn.spring), (dead, &turn.dead)] {
            let mut inertia = Inertializer::new(how);
            inertia.trigger(&old.at(0.0), &new.at(0.0));
            let mut before = 0.0;
            for (&secs, &wanted) in golden.times.iter().zip(wanted) {
                inertia.advance(secs - before);
                before = secs;
                let found = with_inertia(&mut inertia, new.at(secs as f32)).rotations[0];
                let off = quat::angle_between(found, quat::exp(wanted));
                assert!(off < 2e-5, "{how:?} at {secs}: {off}");
            }
        }
    }
    assert!(golden.turns.len() >= 3);
}

#[test]
fn trigger_within_slows_down_large_offsets_of_slow_joints() {
    let turned = |angle: f32| MovingPose {
        rotations: vec![Quat::from_rotation_x(angle); 2],
        angular_velocities: vec![Vec3::ZERO; 2],
        ..MovingPose::default()
    };
    let (old, new) = (turned(1.2), turned(0.0));
    let (usual, dt) = ([1.0, 100.0], 1.0 / 240.0);
    for kind in KINDS {
        // The greatest angular speed of each joint, radians per second, and the rest after a second
        // and at the end.
        let played = |usual: &[f32]| {
            let mut inertia = Inertializer::new(kind);
            inertia.trigger_within(&old, &new, usual);
            let (mut fastest, mut before) = ([0.0_f32; 2], [1.2_f32; 2]);
            let mut left = Vec::new();
            for tick in 1..=2400 {
                inertia.advance(dt);
                let mut rotations = new.rotations.clone();
                inertia.apply(&mut rotations, &mut []);
                let now = [0, 1].map(|joint: usize| quat::log(rotations[joint]).x);
                for joint in 0..2 {
                    fastest[joint] =
                        fastest[joint].max((before[joint] - now[joint]).abs() / dt as f32);
                }
                before = now;
                if tick % 240 == 0 {
                    left.push(now);
                }
            }
            (fastest, left)
        };
        let (free, _) = played(&[]);
        let (held, left) = played(&usual);
        assert!(free[0] > 1.5 && (free[0] - free[1]).abs() < 1e-4, "{kind:?}: {free:?}");
        assert!(held[0] <= 0.76 && (held[1] - free[1]).abs() < 1e-3, "{kind:?}: {held:?}");
        assert!(left[0][0] > 0.3 && left[0][1] < 0.02, "{kind:?}: {left:?}");
        assert!(left[9][0].abs() < 1e-3, "{kind:?}: {left:?}");
        // A jump in the middle of it continues from the current pose.
        let mut inertia = Inertializer::new(kind);
        inertia.trigger_within(&old, &new, &usual);
        (0..60).for_each(|_| inertia.advance(dt));
        let mut before = new.rotations.clone();
        inertia.apply(&mut before, &mut []);
        inertia.trigger_within(&new, &new, &usual);
        let mut after = new.rotations.clone();
        inertia.apply(&mut after, &mut []);
        assert!(quat::angle_between(before[0], after[0]) < 1e-4, "{kind:?}");
    }
}
