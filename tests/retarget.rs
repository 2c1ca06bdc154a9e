//! Retargeting of captured motion to rigs of other families, with other proportions: how far feet
//! slide and sink in, and what knees do. The bundled takes are here everywhere; rigs of other
//! captures are used where this machine has them.
//!
//! `cargo test --no-default-features -p segue --test retarget -- --nocapture` prints the table.

#[path = "../crates/formats/tests/common/mod.rs"]
mod common;

use common::shared_data;
use segue_formats::{ImportOptions, import, unpack_gzip};
use segue_motion::clip::{Clip, Motion};
use segue_motion::retarget::{RetargetErrors, RetargetOptions, TargetBody, retarget_motion};
use segue_motion::skeleton::{Joint, Role, Roles, Side, Skeleton, fixtures};
use std::sync::Arc;

/// The bar: skating beyond that of the source, per stance, and depth in the ground, centimetres.
const MAX_MORE_SKATING_CM: f64 = 0.3;
const MAX_PENETRATION_CM: f64 = 0.5;

fn read(name: &str, bytes: &[u8]) -> Motion {
    let mut file = import(name, bytes, &ImportOptions::default()).expect("a motion file");
    Motion::analyze(file.clips.swap_remove(0).clip)
}

/// Returns a bundled take without the frames before `start`: some begin with a T-pose.
fn take(name: &str, start: usize) -> Motion {
    let path = format!("{}/assets/samples/{name}.bvh.gz", env!("CARGO_MANIFEST_DIR"));
    let packed = std::fs::read(path).expect("a bundled take");
    let bytes = unpack_gzip(name, &packed, 1 << 26).expect("a gzip file");
    let motion = read(&format!("{name}.bvh"), &bytes);
    let frames = motion.clip().frames();
    motion.cropped(start..frames).expect("frames")
}

fn takes() -> Vec<(&'static str, Motion)> {
    let named = [
        ("16_15", 0),
        ("16_55", 0),
        ("16_22", 0),
        ("16_17", 0),
        ("16_57", 0),
        ("16_33", 0),
        ("01_01", 1),
        ("pirouette", 1),
    ];
    named.map(|(name, start)| (name, take(name, start))).into()
}

/// Factors of a body's proportions.
#[derive(Clone, Copy)]
struct Build {
    size: f32,
    thigh: f32,
    shin: f32,
    foot: f32,
    hips: f32,
    arm: f32,
}

const AVERAGE: Build = Build { size: 1.0, thigh: 1.0, shin: 1.0, foot: 1.0, hips: 1.0, arm: 1.0 };

/// Returns a body with other proportions.
fn built(skeleton: &Skeleton, build: Build) -> Arc<Skeleton> {
    let roles = fixtures::roles(skeleton);
    let factor = |joint: usize| {
        let is = |role: fn(Side) -> Role| {
            Side::BOTH.into_iter().any(|side| roles.get(role(side)) == Some(joint))
        };
        match () {
            () if is(Role::thigh) => build.hips,
            () if is(Role::shin) => build.thigh,
            () if is(Role::foot) => build.shin,
            () if is(Role::toe) => build.foot,
            () if is(Role::forearm) || is(Role::hand) => build.arm,
            () => 1.0,
        }
    };
    let toes = Side::BOTH.map(|side| roles.get(Role::toe(side)));
    let joints = skeleton.joints().iter().enumerate().map(|(index, joint)| {
        let tip = if toes.contains(&Some(index)) { build.foot } else { 1.0 };
        Joint {
            offset: joint.offset * build.size * factor(index),
            end_site: joint.end_site.map(|end| end * build.size * tip),
            ..joint.clone()
        }
    });
    Arc::new(Skeleton::new(joints.collect()).expect("a skeleton"))
}

/// Returns the largest jolt of a knee: the second difference of its flexion, degrees per frame at
/// 60 frames per second.
fn knee_jolt(clip: &Clip, roles: &Roles) -> f32 {
    let mut worst = 0.0f32;
    let step = (clip.fps() / 60.0).round().max(1.0) as usize;
    for side in Side::BOTH {
        let [thigh, shin, foot, _] = Role::leg(side).map(|role| roles.get(role).expect("a leg"));
        let flexion: Vec<f32> = (0..clip.frames())
            .map(|frame| clip.world_pose(frame).positions)
            .map(|at| (at[shin] - at[thigh]).angle_between(at[foot] - at[shin]).to_degrees())
            .collect();
        for frame in 2 * step..flexion.len() {
            let [a, b, c] = [frame - 2 * step, frame - step, frame].map(|frame| flexion[frame]);
            worst = worst.max((a - 2.0 * b + c).abs());
        }
    }
    worst
}

/// A body to move motions to.
struct Rig {
    name: String,
    skeleton: Arc<Skeleton>,
    roles: Roles,
    model: Option<Arc<Clip>>,
}

fn rigs() -> Vec<Rig> {
    let builds = [
        ("Bandai-Namco", fixtures::bandai(), Build { shin: 1.2, thigh: 0.9, ..AVERAGE }),
        ("GAMES-105", fixtures::games105(), Build { foot: 1.4, ..AVERAGE }),
        ("LAFAN1", fixtures::lafan(), Build { hips: 1.5, arm: 0.85, ..AVERAGE }),
        (
            "Mixamo, a child",
            fixtures::mixamo(),
            Build { size: 0.6, foot: 1.2, shin: 0.85, ..AVERAGE },
        ),
        ("SMPL", fixtures::smpl(), Build { thigh: 1.25, hips: 0.7, ..AVERAGE }),
        ("Xsens, a giant", fixtures::xsens(), Build { size: 1.5, arm: 1.3, foot: 0.7, ..AVERAGE }),
        ("Unreal", fixtures::unreal(), Build { shin: 1.15, thigh: 1.15, ..AVERAGE }),
        ("OptiTrack", fixtures::optitrack(), AVERAGE),
    ];
    let mut rigs: Vec<Rig> = builds
        .into_iter()
        .map(|(name, skeleton, build)| {
            let skeleton = built(&skeleton, build);
            Rig { name: name.into(), roles: fixtures::roles(&skeleton), skeleton, model: None }
        })
        .collect();
    let real = ["bandai-namco/dataset-2_walk_normal_001.bvh", "games105/walk_forward.bvh"];
    for file in shared_data().iter().flat_map(|data| real.map(|name| data.join(name))) {
        let Ok(bytes) = std::fs::read(&file) else { continue };
        let name = file.file_name().map(|name| name.to_string_lossy().into_owned());
        let name = name.unwrap_or_default();
        let model = read(&name, &bytes);
        let skeleton = Arc::clone(model.clip().skeleton());
        let (roles, model) = (model.roles().clone(), Some(Arc::clone(model.clip())));
        rigs.push(Rig { name, skeleton, roles, model });
    }
    rigs
}

#[test]
fn captured_motion_on_other_rigs_neither_slides_nor_sinks_in() {
    eprintln!(
        "{:<28} {:<10} {:>17} {:>17} {:>13} {:>13} {:>11} {:>11} {:>13}",
        "rig",
        "take",
        "slide cm src",
        "dir → ik worst",
        "mean dir → ik",
        "depth cm",
        "foot cm",
        "limit hits",
        "knee jolt °"
    );
    let mut faults = Vec::new();
    for rig in rigs() {
        for (name, motion) in takes() {
            let body = TargetBody {
                skeleton: &rig.skeleton,
                roles: &rig.roles,
                model: rig.model.as_deref(),
            };
            let made = retarget_motion(&motion, &body, &RetargetOptions::default()).expect("made");
            let errors = made.report;
            let plain =
                retarget_motion(&motion, &body, &RetargetOptions::DIRECTIONS).expect("made");
            let jolts = [&plain.clip, &made.clip].map(|clip| knee_jolt(clip, &rig.roles));
            print_row(&rig.name, name, &errors, jolts);
            faults.extend(faults_of(&errors).map(|fault| format!("{} {name}: {fault}", rig.name)));
        }
    }
    assert!(faults.is_empty(), "\n{}", faults.join("\n"));
}

fn print_row(rig: &str, take: &str, errors: &RetargetErrors, jolts: [f32; 2]) {
    let skating = errors.skating;
    let feet = errors.feet.iter().flatten().map(|foot| foot.result.worst_cm).fold(0.0, f64::max);
    eprintln!(
        "{rig:<28} {take:<10} {:>8.2} {:>8.2} {:>8.2} {:>8.2} {:>6.2} {:>6.2} {:>6.2} {:>6.2} {:>11.2} {:>5} {:>5} {:>6.2} {:>6.2}",
        errors.source_skating.worst_cm,
        errors.source_skating.mean_cm,
        skating.directions.worst_cm,
        skating.result.worst_cm,
        skating.directions.mean_cm,
        skating.result.mean_cm,
        errors.penetration_cm.directions,
        errors.penetration_cm.result,
        feet,
        errors.beyond_limits.directions,
        errors.beyond_limits.result,
        jolts[0],
        jolts[1],
    );
}

fn faults_of(errors: &RetargetErrors) -> impl Iterator<Item = String> {
    let more = |own: f64, source: f64| own - source > MAX_MORE_SKATING_CM;
    let skating = errors.skating.result;
    let worst = more(skating.worst_cm, errors.source_skating.worst_cm)
        .then(|| format!("a foot slides {:.2} cm", skating.worst_cm));
    let mean = more(skating.mean_cm, errors.source_skating.mean_cm)
        .then(|| format!("feet slide {:.2} cm per stance", skating.mean_cm));
    let deep = (errors.penetration_cm.result > MAX_PENETRATION_CM)
        .then(|| format!("a foot sinks in by {:.2} cm", errors.penetration_cm.result));
    let bent = (errors.beyond_limits.result > 0)
        .then(|| format!("{} limbs beyond their limits", errors.beyond_limits.result));
    let none = (skating.stances == 0).then(|| "no stance was measured".to_owned());
    [worst, mean, deep, bent, none].into_iter().flatten()
}
