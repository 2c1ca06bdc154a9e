//! Retargeting of captured motion to rigs of other families, with other proportions: how far feet
//! slide and sink in, and what knees do. The bundled takes are here everywhere; rigs of other
//! captures are used where this machine has them.
//!
//! `cargo test --no-default-features -p segue --test retarget -- --nocapture` prints the table.

#[path = "../crates/formats/tests/common/mod.rs"]
mod common;
#[path = "encodings/rigs.rs"]
mod encodings;

use common::shared_data;
use segue_formats::gltf::{GlbOptions, write_glb};
use segue_formats::{ImportOptions, bvh, import, unpack_gzip};
use segue_motion::clip::{Clip, Contacts, Motion};
use segue_motion::metrics::foot_slides;
use segue_motion::retarget::{RetargetErrors, RetargetOptions, TargetBody, retarget_motion};
use segue_motion::skeleton::{Joint, Role, Roles, Side, Skeleton, fixtures};
use segue_motion::skin::{SkinnedMesh, linear_blend};
use segue_motion::synth::{Action, Params, synthesize};
use segue_session::export::{ExportFormat, ExportOptions, export};
use segue_session::{Command, Outcome, Session, Slot};
use std::sync::Arc;

/// The bar: skating beyond that of the source, per stance, and depth in the ground, centimetres.
const MAX_MORE_SKATING_CM: f64 = 0.3;
const MAX_PENETRATION_CM: f64 = 0.5;
/// How deep the mesh of a character may be below the ground in nineteen of twenty frames, where
/// feet roll over their heels and tips, centimetres.
const MAX_SUNKEN_MESH_CM: f32 = 2.5;
/// The frames of a take that go through files.
const MAX_FRAMES: usize = 900;

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

impl Rig {
    fn body(&self) -> TargetBody {
        match &self.model {
            Some(model) => TargetBody::of_clip(model, &self.roles),
            None => TargetBody::at_rest(&self.skeleton, &self.roles),
        }
    }
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
            let body = rig.body();
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

/// Returns a session with the motions in its library, as files, and their ids.
fn opened(motions: &[(&str, &Clip)]) -> (Session, Vec<String>) {
    let mut session = Session::new();
    let ids = motions.iter().map(|(name, clip)| {
        let text = bvh::write(clip, &bvh::WriteOptions::default());
        let read = session.load(&format!("{name}.bvh"), Arc::from(text.as_bytes()));
        let read = read.expect("a file that is read");
        assert!(!read.ids.is_empty(), "{name}: {:?}", read.warnings);
        read.ids[0].clone()
    });
    let ids = ids.collect();
    (session, ids)
}

/// Returns what a user gets of a lab with A and B.
fn result(session: &mut Session, a: &str, b: &str, more: &str) -> Result<Arc<Outcome>, String> {
    let link = format!("{more}&a={a}&b={b}&clips={a},{b}&match_clips={a},{b}&play=off");
    session.apply(Command::OpenLink(link)).expect("a link is never refused");
    while session.work() {}
    let pane = session.panes().first().expect("a pane");
    match (&pane.outcome, &pane.problem) {
        (_, Some(problem)) => Err(problem.to_string()),
        (Some(outcome), None) => Ok(Arc::clone(outcome)),
        (None, None) => panic!("neither a result nor a reason"),
    }
}

/// Returns a motion of the synthesised body on another.
fn walking_on(rig: &Rig, duration_secs: f32) -> Clip {
    let params = Params { duration_secs, ..Params::new(Action::Walk) };
    let walk = Motion::analyze(synthesize(&params).expect("a walk").clip);
    retarget_motion(&walk, &rig.body(), &RetargetOptions::DIRECTIONS).expect("made").clip
}

/// Returns the worst slide in a stance and its mean, centimetres.
fn slides(motion: &Motion, contacts: &Contacts) -> [f64; 2] {
    let found = foot_slides(motion.clip(), motion.roles(), contacts);
    let slides = || found.iter().map(|slide| slide.slide_cm);
    [slides().fold(0.0, f64::max), slides().sum::<f64>() / found.len().max(1) as f64]
}

/// Returns the greatest depth of a foot below the ground, centimetres, and the greatest flexion of
/// a knee, degrees.
fn depth_and_flexion(motion: &Motion, ground_m: f32) -> [f32; 2] {
    let (roles, skeleton) = (motion.roles(), motion.clip().skeleton());
    let (mut lowest, mut bent) = (f32::INFINITY, 0.0f32);
    for frame in 0..motion.clip().frames() {
        let world = motion.clip().world_pose(frame);
        for side in Side::BOTH {
            for (joint, point) in roles.foot_points(skeleton, side) {
                lowest = lowest.min(world.point(joint, point).y);
            }
            let leg = Role::leg(side).map(|role| roles.get(role));
            let [thigh, shin, foot, _] = leg.map(|joint| world.positions[joint.expect("a leg")]);
            bent = bent.max((shin - thigh).angle_between(foot - shin).to_degrees());
        }
    }
    [(ground_m - lowest) * 100.0, bent]
}

/// The same bar, for what a blend gets: through files, the library and the lab's cache, at the
/// frame rate of A. Slides, depths and knees are measured here, not taken from the report.
#[test]
fn blends_with_other_bodies_neither_slide_nor_sink_in() {
    let mut faults = Vec::new();
    eprintln!("through the session: rig, take; slide of the clip and of the result, worst, mean");
    for rig in rigs() {
        let base = walking_on(&rig, 3.0);
        for (name, take) in takes() {
            // Larger files are read elsewhere.
            let part = take.clip().crop(0..take.clip().frames().min(MAX_FRAMES)).expect("frames");
            let (mut session, ids) = opened(&[("rig", &base), (name, &part)]);
            let made = result(&mut session, &ids[0], &ids[1], "lab=blend").expect("a blend");
            let report = made.retargeted.as_ref().expect("a report on retargeting");
            let (a, b) = (session.slot(Slot::A), session.slot(Slot::B));
            let [a, b] = [a, b].map(|entry| entry.expect("a clip").motion.clone().expect("read"));
            let incoming = &made.sources[1].motion;
            assert_eq!(incoming.clip().skeleton(), a.clip().skeleton());
            let legs = [&a, &b]
                .map(|motion| motion.roles().leg_length(motion.clip().skeleton()).expect("legs"));
            let [own, own_mean] = slides(&b, b.contacts());
            let [worst, mean] = slides(incoming, incoming.contacts());
            let ground_m = b.ground_m() * legs[0] / legs[1];
            let [depth, bent] = depth_and_flexion(incoming, ground_m);
            let limits = report.errors.expect("another rig").beyond_limits.result;
            eprintln!(
                "{:<28} {name:<10} {own:>6.2} {own_mean:>6.2} {worst:>6.2} {mean:>6.2} | depth {depth:>6.2} | knee {bent:>5.1}° | beyond {limits}",
                rig.name
            );
            if worst > own + MAX_MORE_SKATING_CM || mean > own_mean + MAX_MORE_SKATING_CM {
                faults.push(format!("{} {name}: slides {worst:.2} {mean:.2} cm", rig.name));
            }
            if f64::from(depth) > MAX_PENETRATION_CM || limits > 0 || bent > 155.7 {
                faults.push(format!("{} {name}: {depth:.2} cm, {limits}, {bent:.1}°", rig.name));
            }
        }
    }
    assert!(faults.is_empty(), "\n{}", faults.join("\n"));
}

/// Returns a file of another program with a rig and a mesh around its bones.
fn figure(rig: &Rig) -> Arc<[u8]> {
    let skeleton = Arc::clone(&rig.skeleton);
    let clip = Clip::new("figure", skeleton, 30.0, vec![], vec![]).expect("a clip of no frames");
    let options = GlbOptions { smooth: true, ..GlbOptions::default() };
    let mut bytes = write_glb(&clip, &options).expect("a file");
    let author = bytes.windows(6).position(|w| w == b"Segue ").expect("the author");
    bytes[author..author + 5].copy_from_slice(b"Other");
    bytes.into()
}

/// Returns the depth of a mesh below the ground in some frames of a clip: the greatest one, and the
/// one that nineteen of twenty frames do not exceed, centimetres.
fn depths_of_mesh(mesh: &SkinnedMesh, clip: &Clip) -> [f32; 2] {
    let [mut positions, mut normals] = [Vec::new(), Vec::new()];
    let mut depths: Vec<f32> = (0..clip.frames())
        .step_by(4)
        .map(|frame| {
            let transforms: Vec<_> = mesh.world_from_bind(&clip.world_pose(frame)).collect();
            linear_blend(mesh, &transforms, &mut positions, &mut normals);
            -100.0 * positions.iter().map(|p| p.y).fold(f32::INFINITY, f32::min)
        })
        .collect();
    depths.sort_by(f32::total_cmp);
    [depths[depths.len() - 1], depths[(depths.len() - 1) * 19 / 20]]
}

/// The same bar, for what users see of their own characters and save: through files, the library
/// and the cache of the stage.
#[test]
fn characters_of_other_rigs_neither_slide_nor_sink_in() {
    let mut faults = Vec::new();
    eprintln!("figure, take; slide of the clip, by directions and on the figure, worst; depth");
    let foreign = ["Mixamo, a child", "SMPL", "Unreal"];
    for rig in rigs().into_iter().filter(|rig| foreign.contains(&&*rig.name)) {
        for (name, take) in takes() {
            // Larger files are read elsewhere.
            let part = take.clip().crop(0..take.clip().frames().min(MAX_FRAMES)).expect("frames");
            let (mut session, ids) = opened(&[(name, &part)]);
            session.load("figure.glb", figure(&rig)).expect("a figure");
            let character = session.character().expect("the figure is shown");
            let made = result(&mut session, &ids[0], &ids[0], "lab=view");
            assert!(session.character().is_none(), "a link without a figure shows none");
            let id = session.library().entries().last().expect("the figure").id.clone();
            let made = made.and(result(
                &mut session,
                &ids[0],
                &ids[0],
                &format!("lab=view&character={id}"),
            ));
            let motion = Arc::clone(&made.expect("the clip").motion);
            let moved = session.on_character(&motion).expect("the clip on the figure");
            let errors = moved.errors().expect("another rig");
            let shown = Motion::with_roles(moved.clip().clone(), &character.roles);
            let [own, own_mean] = slides(&motion, motion.contacts());
            let [worst, mean] = slides(&shown, motion.contacts());
            let [deepest, deep] = depths_of_mesh(&character.mesh, moved.clip());
            eprintln!(
                "{:<16} {name:<10} {own:>6.2} {:>6.2} {worst:>6.2} | joints {:>5.2} mesh {deepest:>5.2} {deep:>5.2}",
                rig.name, errors.skating.directions.worst_cm, errors.penetration_cm.result
            );
            faults.extend(faults_of(errors).map(|fault| format!("{} {name}: {fault}", rig.name)));
            if worst > own + MAX_MORE_SKATING_CM || mean > own_mean + MAX_MORE_SKATING_CM {
                faults.push(format!("{} {name}: slides {worst:.2} {mean:.2} cm", rig.name));
            }
            if deep > MAX_SUNKEN_MESH_CM {
                faults.push(format!("{} {name}: its soles are {deep:.2} cm deep", rig.name));
            }
            // A file has the same poses.
            let glb = ExportOptions { format: ExportFormat::Glb, ..ExportOptions::default() };
            let bytes = export(&motion, Some(&character), &[], &glb).expect("a file");
            let saved = import("x.glb", &bytes, &ImportOptions::default()).expect("readable");
            let (saved, ours) = (&saved.clips[0].clip, moved.clip());
            assert_eq!(saved.frames(), ours.frames());
            for frame in (0..ours.frames()).step_by(7) {
                let [saved, ours] = [saved, ours].map(|clip| clip.world_pose(frame).positions);
                for (saved, ours) in saved.iter().zip(&ours) {
                    assert!(saved.distance(*ours) < 1e-4, "{} {name} {frame}", rig.name);
                }
            }
        }
    }
    assert!(faults.is_empty(), "\n{}", faults.join("\n"));
}

/// Returns a body on four legs.
fn quadruped() -> Rig {
    let mut joints = Vec::new();
    let mut add = |name: &str, parent: Option<usize>, offset: [f32; 3]| {
        let channels = Vec::new();
        let (name, offset) = (name.to_owned(), offset.into());
        joints.push(Joint { name, parent, offset, end_site: None, channels });
        joints.len() - 1
    };
    let hips = add("Hips", None, [0.0, 0.6, -0.3]);
    let spine = add("Spine", Some(hips), [0.0, 0.05, 0.3]);
    let chest = add("Chest", Some(spine), [0.0, 0.0, 0.3]);
    let neck = add("Neck", Some(chest), [0.0, 0.15, 0.15]);
    add("Head", Some(neck), [0.0, 0.15, 0.1]);
    add("Tail", Some(hips), [0.0, 0.0, -0.3]);
    for (side, sign) in [("Left", 1.0), ("Right", -1.0)] {
        for (end, on) in [("Hind", hips), ("Fore", chest)] {
            let upper = add(&format!("{side}{end}UpperLeg"), Some(on), [0.1 * sign, -0.05, 0.0]);
            let lower = add(&format!("{side}{end}LowerLeg"), Some(upper), [0.0, -0.28, 0.04]);
            add(&format!("{side}{end}Foot"), Some(lower), [0.0, -0.26, -0.04]);
        }
    }
    let skeleton = Arc::new(Skeleton::new(joints).expect("a tree"));
    Rig { name: "quadruped".into(), roles: Roles::detect(&skeleton), skeleton, model: None }
}

/// Returns a body without hands and feet.
fn without_ends() -> Rig {
    let whole = fixtures::lafan();
    let roles = fixtures::roles(&whole);
    let ends = Side::BOTH.into_iter().flat_map(|side| {
        [Role::hand(side), Role::foot(side), Role::toe(side)].map(|role| roles.get(role))
    });
    let ends: Vec<usize> = ends.flatten().collect();
    let (mut joints, mut moved) = (Vec::new(), Vec::new());
    for (index, joint) in whole.joints().iter().enumerate() {
        let above = joint.parent.map(|parent: usize| moved[parent]);
        let is_left_out = ends.contains(&index) || above == Some(None);
        moved.push((!is_left_out).then_some(joints.len()));
        if !is_left_out {
            joints.push(Joint { parent: above.flatten(), ..joint.clone() });
        }
    }
    let skeleton = Arc::new(Skeleton::new(joints).expect("a tree"));
    Rig { name: "stumps".into(), roles: Roles::detect(&skeleton), skeleton, model: None }
}

/// Bodies and clips that nobody hopes for have a result without wild numbers, or a reason.
#[test]
fn odd_bodies_have_a_result_or_a_reason() {
    let (walk, run) = (take("16_15", 0), take("16_55", 0));
    let lafan = fixtures::lafan();
    let plain = Rig {
        name: "plain".into(),
        roles: fixtures::roles(&lafan),
        skeleton: Arc::clone(&lafan),
        model: None,
    };
    let base = walking_on(&plain, 2.0);
    let mut bodies: Vec<(String, Clip)> = encodings::encodings(&base)
        .into_iter()
        .map(|(name, text)| (name.to_owned(), Clip::clone(read(name, text.as_bytes()).clip())))
        .collect();
    bodies.push(("elsewhere".into(), encodings::placed(&base)));
    bodies.push(("one frame".into(), base.crop(0..1).expect("a frame")));
    for rig in [quadruped(), without_ends()] {
        bodies.push((rig.name.clone(), walking_on(&rig, 2.0)));
    }
    let one = walk.clip().crop(0..1).expect("a frame");
    for (name, body) in &bodies {
        let clips = [("body", body), ("walk", &**walk.clip()), ("run", run.clip()), ("one", &one)];
        let (mut session, ids) = opened(&clips);
        let [body_id, walk_id, run_id, one_id] = [0, 1, 2, 3].map(|index: usize| &*ids[index]);
        for (a, b, lab) in [
            (body_id, walk_id, "lab=blend"),
            (body_id, walk_id, "lab=layers"),
            (body_id, walk_id, "lab=blend&retarget_feet=0&retarget_hands=0"),
            (body_id, one_id, "lab=layers"),
            (walk_id, body_id, "lab=blend"),
            (one_id, body_id, "lab=layers"),
            (body_id, run_id, "lab=graph"),
            (body_id, run_id, "lab=match&scenario=left"),
        ] {
            let made = match result(&mut session, a, b, lab) {
                Ok(made) => made,
                Err(reason) => {
                    eprintln!("{name} {lab} {a} {b}: {reason}");
                    assert!(reason.len() > 10, "{name} {lab}: {reason}");
                    continue;
                }
            };
            let clip = made.motion.clip();
            let mut at = clip.world_positions(0..clip.frames()).into_iter();
            let wild = at.find(|p| !p.is_finite() || p.y.abs() > 10.0);
            assert!(wild.is_none(), "{name} {lab}: {wild:?}");
            if let Some(errors) = made.retargeted.as_ref().and_then(|report| report.errors)
                && !lab.contains("retarget_feet=0")
            {
                let cm = errors.penetration_cm.result;
                eprintln!("{name} {lab} {a} {b}: {cm:.2} cm deep, {:?}", errors.beyond_limits);
                for foot in errors.feet.into_iter().flatten() {
                    assert!(foot.result.worst_cm < 15.0, "{name} {lab}: {errors:?}");
                }
            }
        }
    }
}
