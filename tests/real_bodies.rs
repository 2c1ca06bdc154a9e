//! Roles, mirroring, retargeting and contacts on captured motion. The tests pass without the files,
//! which are not part of the project.

#[path = "../crates/formats/tests/common/mod.rs"]
mod common;

use common::shared_data;
use segue_formats::{ImportOptions, import};
use segue_motion::clip::{
    Clip, ContactOptions, Contacts, character_frames, ground_speed, mirror, retarget,
};
use segue_motion::skeleton::{Joint, Role, RoleSource, Roles, Side, Skeleton};

fn clips(names: &[&str]) -> Vec<(Clip, Roles)> {
    let Some(data) = shared_data() else {
        return Vec::new();
    };
    let load = |name: &&str| {
        let bytes = std::fs::read(data.join(name)).ok()?;
        let clip = import(name, &bytes, &ImportOptions::default()).ok()?.clips.swap_remove(0).clip;
        let roles = Roles::detect(clip.skeleton());
        Some((clip.with_name(*name), roles))
    };
    names.iter().map(|name| load(name).unwrap_or_else(|| panic!("{name} does not load"))).collect()
}

const GAMES: [&str; 6] = [
    "games105/walk_forward.bvh",
    "games105/run_forward.bvh",
    "games105/walkF.bvh",
    "games105/idle.bvh",
    "games105/walk_and_ture_right.bvh",
    "games105/walk_and_turn_left.bvh",
];
const CMU: [&str; 2] = ["cmu/01_01.bvh", "cmu/run.bvh"];

#[test]
fn roles_by_name_and_by_shape_agree() {
    for (clip, roles) in clips(&[&GAMES[..], &CMU, &["cmu/pirouette.bvh"]].concat()) {
        // One of the rigs has no toes.
        let wanted: &[Role] =
            if clip.name().contains("pirouette") { &[Role::LeftToe, Role::RightToe] } else { &[] };
        assert_eq!(roles.missing().collect::<Vec<_>>(), wanted, "{}", clip.name());
        let nameless = clip
            .skeleton()
            .joints()
            .iter()
            .map(|joint| Joint { name: String::new(), ..joint.clone() });
        let by_shape = Roles::detect(&Skeleton::new(nameless.collect()).unwrap());
        for role in Role::ALL {
            assert_eq!(roles.get(role), by_shape.get(role), "{}: {role:?}", clip.name());
            assert!([None, Some(RoleSource::ByName)].contains(&roles.source(role)));
        }
    }
}

#[test]
fn retargeting_between_equal_rigs_is_lossless() {
    let clips = clips(&GAMES);
    for (clip, roles) in &clips {
        for (other, other_roles) in &clips {
            let there = retarget(clip, roles, other.skeleton(), other_roles).unwrap();
            for frame in (0..clip.frames()).step_by(7) {
                let (before, after) = (clip.world_pose(frame), there.world_pose(frame));
                for (joint, own) in clip.skeleton().joints().iter().enumerate() {
                    let same = other.skeleton().find(&own.name).unwrap();
                    assert!(
                        before.positions[joint].distance(after.positions[same]) < 1e-5,
                        "{}: {}",
                        clip.name(),
                        own.name
                    );
                }
            }
        }
    }
}

#[test]
fn mirror_applied_twice_is_the_original() {
    for (clip, roles) in clips(&[&GAMES[..], &CMU].concat()) {
        let once = mirror(&clip, &roles).unwrap();
        let twice = mirror(&once, &roles).unwrap();
        for frame in (0..clip.frames()).step_by(5) {
            let (a, b) = (clip.world_pose(frame), twice.world_pose(frame));
            assert!(
                a.positions.iter().zip(&b.positions).all(|(a, b)| a.distance(*b) < 1e-5),
                "{}",
                clip.name()
            );
        }
        for (a, b) in
            character_frames(&clip, &roles).iter().zip(character_frames(&once, &roles)).step_by(5)
        {
            // Rigs are slightly asymmetric; the facing is mirrored to within a degree.
            assert!(
                (a.forward().z - b.forward().z).abs() < 0.02
                    && (a.forward().x + b.forward().x).abs() < 0.02,
                "{}",
                clip.name()
            );
        }
    }
}

/// Measured: in a walk at 1.2 m/s a stance lasts 0.6 to 0.75 s, in a sprint at 5.7 m/s less than
/// 0.1 s, two for each foot.
#[test]
fn contacts_of_gaits_match_their_speed() {
    for (clip, roles) in clips(&["games105/walkF.bvh", "cmu/run.bvh", "games105/idle.bvh"]) {
        let contacts = Contacts::detect(&clip, &roles, &ContactOptions::default());
        let speed = ground_speed(&character_frames(&clip, &roles), clip.fps());
        for side in Side::BOTH {
            // Stances that the ends of the clip do not cut.
            let whole = contacts
                .intervals(side)
                .into_iter()
                .filter(|range| range.start > 1 && range.end + 1 < clip.frames());
            let secs: Vec<f64> = whole.map(|range| range.len() as f64 / clip.fps()).collect();
            match clip.name() {
                "games105/walkF.bvh" => {
                    assert!(
                        (1.1..1.3).contains(&speed)
                            && secs.len() == 2
                            && secs.iter().all(|s| (0.6..0.75).contains(s)),
                        "{speed} {secs:?}"
                    );
                }
                "cmu/run.bvh" => {
                    assert!((5.5..6.0).contains(&speed), "{speed}");
                    let all = contacts.intervals(side);
                    assert!(
                        all.len() == 2 && all.iter().all(|range| (4..13).contains(&range.len())),
                        "{all:?}"
                    );
                }
                _ => assert!(
                    speed < 0.05 && contacts.intervals(side).len() == 1 && secs.is_empty(),
                    "{speed} {secs:?}"
                ),
            }
        }
    }
}
