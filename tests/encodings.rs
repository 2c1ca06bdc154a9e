//! A result depends on the motion, not on its encoding in a file: every lab gives the same result
//! for one motion in ten files.

#[path = "../crates/formats/tests/common/mod.rs"]
mod common;
#[path = "encodings/rigs.rs"]
mod rigs;

use glam::{Quat, Vec3};
use rigs::{encodings, placed};
use segue_formats::{ImportOptions, import};
use segue_motion::clip::{Clip, Interpolation, resample};
use segue_motion::synth::{Action, Params, synthesize};
use segue_session::{Command, Outcome, Session};
use std::collections::BTreeMap;
use std::sync::Arc;

/// Two motions of one body.
struct Subject {
    name: &'static str,
    a: Clip,
    b: Clip,
}

fn made(name: &'static str, height_m: f32, a: Action, b: Action) -> Subject {
    let make = |action| {
        let params = Params { height_m, ..Params::new(action) };
        with_tremor(&synthesize(&params).expect("a motion").clip)
    };
    Subject { name, a: make(a), b: make(b) }
}

/// Returns the motion with a tremor that never repeats: synthesised gaits are periodic to the last
/// bit, and either of two equally good places may be found.
fn with_tremor(clip: &Clip) -> Clip {
    let poses = (0..clip.frames()).map(|frame| {
        let mut pose = clip.pose(frame);
        let t = frame as f32 / clip.fps() as f32;
        for (joint, rotation) in pose.rotations.iter_mut().enumerate() {
            let pace = 1.7 + 0.37 * joint as f32;
            *rotation *= Quat::from_rotation_x(0.02 * (pace * t).sin() + 0.01 * t);
        }
        pose
    });
    Clip::from_poses(clip.name(), Arc::clone(clip.skeleton()), clip.fps(), poses)
        .expect("poses of one skeleton")
}

/// Returns captured motion at 60 frames per second, if this machine has it.
fn captured() -> Vec<Subject> {
    let mut takes = common::captured(&["15", "35"]).into_iter();
    let (Some((_, a)), Some((_, b))) = (takes.next(), takes.next()) else {
        return vec![];
    };
    let slower = |clip: Clip| resample(&clip, 60.0, Interpolation::Cubic).expect("a rate");
    vec![Subject { name: "CMU 16", a: slower(a), b: slower(b) }]
}

/// The labs with their methods, as links; the last column is the tolerance for results, metres.
/// Without mirrored copies: the mirror image of a twist about a bone depends on the rest pose,
/// which has no meaning where the joints' axes are rotated.
const LABS: [(&str, f32); 25] = [
    ("lab=view", 0.001),
    ("lab=blend", 0.001),
    ("lab=blend&root_blend=off&weight_law=linear", 0.001),
    ("lab=blend&foot_lock=on", 0.001),
    ("lab=transition&method=inertialize", 0.001),
    ("lab=transition&method=cubic", 0.001),
    ("lab=transition&method=quintic", 0.001),
    ("lab=transition&method=dead", 0.001),
    ("lab=transition&method=smooth", 0.001),
    ("lab=transition&method=cut", 0.001),
    ("lab=speed", 0.001),
    ("lab=loop", 0.001),
    ("lab=layers", 0.001),
    ("lab=layers&mask=whole&layer_weight=0.5", 0.001),
    ("lab=layers&layer_mode=additive", 0.001),
    ("lab=register", 0.001),
    ("lab=register&warp_mode=join", 0.001),
    ("lab=path&keep=duration", 0.005),
    ("lab=graph&edge_threshold=15", 0.001),
    ("lab=match&scenario=left&mirrored=off", 0.001),
    ("lab=match&scenario=spin&mirrored=off", 0.001),
    ("lab=in_place", 0.001),
    ("lab=clean", 0.001),
    ("lab=in_place&root_way=put_back", 0.005),
    (
        "lab=edit&edit_from=0.3&edit_to=1.5&as_loop=on&reverse=on&resample=48&scale=1.2&turn=30",
        0.001,
    ),
];

/// Returns a session with two files loaded, and their clips.
fn loaded(files: [&str; 2]) -> (Session, [String; 2]) {
    let mut session = Session::new();
    let ids = [("first.bvh", files[0]), ("second.bvh", files[1])].map(|(name, text)| {
        let read = session.load(name, Arc::from(text.as_bytes())).expect("a file that is read");
        read.ids.first().expect("a clip").clone()
    });
    (session, ids)
}

/// Returns the result of a lab, or the reason why there is none.
fn result(session: &mut Session, [a, b]: &[String; 2], lab: &str) -> Result<Arc<Outcome>, String> {
    let link = format!("{lab}&a={a}&b={b}&clips={a},{b}&match_clips={a},{b}&play=off");
    session.apply(Command::OpenLink(link)).expect("a link is never refused");
    while session.work() {}
    let pane = session.panes().first().expect("a pane");
    match (&pane.outcome, &pane.problem) {
        (_, Some(problem)) => Err(problem.to_string()),
        (Some(outcome), None) => Ok(Arc::clone(outcome)),
        (None, None) => Err("neither a result nor a reason".into()),
    }
}

/// Returns the positions of the joints in the character's frame, by name, frame by frame.
fn seen_from_character(outcome: &Outcome) -> BTreeMap<String, Vec<Vec3>> {
    let clip = outcome.motion.clip();
    let mut joints: BTreeMap<String, Vec<Vec3>> = BTreeMap::new();
    for (frame, here) in outcome.motion.ground_frames().iter().enumerate() {
        let world = clip.world_pose(frame);
        for (joint, position) in clip.skeleton().joints().iter().zip(world.positions) {
            joints.entry(joint.name.clone()).or_default().push(here.inverse().apply(position));
        }
    }
    joints
}

/// Returns the largest distance of a joint between two results.
fn largest_distance(one: &Outcome, other: &Outcome) -> Result<f32, String> {
    let (one, other) = (seen_from_character(one), seen_from_character(other));
    let mut largest = 0.0_f32;
    for (name, positions) in &one {
        let theirs = other.get(name).ok_or_else(|| format!("no joint {name}"))?;
        if theirs.len() != positions.len() {
            return Err(format!("{} frames, not {}", theirs.len(), positions.len()));
        }
        for (p, q) in positions.iter().zip(theirs) {
            largest = largest.max(p.distance(*q));
        }
    }
    Ok(largest)
}

/// Runs every lab on every encoding of the subject; returns the differences.
fn differences(subject: &Subject) -> Vec<String> {
    let first = encodings(&subject.a);
    let second = encodings(&subject.b);
    let elsewhere = encodings(&placed(&subject.b));
    let (mut session, ids) = loaded([&first[0].1, &second[0].1]);
    let plain: Vec<_> = LABS.iter().map(|(lab, _)| result(&mut session, &ids, lab)).collect();
    for ((lab, _), made) in LABS.iter().zip(&plain) {
        assert!(made.is_ok(), "{}: {lab}: {:?}", subject.name, made.as_ref().err());
    }
    let mut wrong = Vec::new();
    for (placing, incoming) in [("", &second), (", B elsewhere", &elsewhere)] {
        for ((name, a), (_, b)) in first.iter().zip(incoming) {
            if (*name, placing) == ("plain", "") {
                continue;
            }
            let (mut session, ids) = loaded([a, b]);
            for ((lab, bound), plain) in LABS.iter().zip(&plain) {
                let made = result(&mut session, &ids, lab);
                let largest_distance = match (plain, made) {
                    (Ok(plain), Ok(made)) => largest_distance(plain, &made),
                    (_, Err(said)) => Err(said),
                    (Err(said), _) => Err(said.clone()),
                };
                match largest_distance {
                    Ok(largest_distance) if largest_distance <= *bound => {}
                    Ok(largest_distance) => wrong.push(format!(
                        "{}, {name}{placing}: {lab}: {:.1} mm",
                        subject.name,
                        1000.0 * largest_distance
                    )),
                    Err(said) => {
                        wrong.push(format!("{}, {name}{placing}: {lab}: {said}", subject.name));
                    }
                }
            }
        }
    }
    wrong
}

#[test]
fn encodings_of_one_motion_have_the_same_joints() {
    let subject = made("walk", 1.75, Action::Walk, Action::Run);
    let wanted = subject.a.world_positions(0..subject.a.frames());
    // Kept for comparisons with other programs.
    let folder = std::path::Path::new(env!("CARGO_TARGET_TMPDIR")).join("encodings");
    std::fs::create_dir_all(&folder).expect("a folder");
    for (name, text) in encodings(&subject.a) {
        std::fs::write(folder.join(format!("walk--{name}.bvh")), &text).expect("a file");
        let read = import("walk.bvh", text.as_bytes(), &ImportOptions::default())
            .expect("a file that is read");
        let clip = &read.clips[0].clip;
        assert_eq!(clip.skeleton().len(), subject.a.skeleton().len(), "{name}");
        let found = clip.world_positions(0..clip.frames());
        let far = found.iter().zip(&wanted).map(|(p, q)| p.distance(*q)).fold(0.0, f32::max);
        assert!(found.len() == wanted.len() && far < 1e-4, "{name}: {far} m");
    }
}

#[test]
fn labs_give_the_same_for_encodings_of_a_walk_and_run() {
    let wrong = differences(&made("grown-up", 1.75, Action::Walk, Action::Run));
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn labs_give_the_same_for_encodings_of_a_child() {
    let wrong = differences(&made("child", 1.2, Action::Walk, Action::Run));
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn labs_give_the_same_for_encodings_of_captured_motion() {
    let wrong: Vec<String> = captured().iter().flat_map(differences).collect();
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}
