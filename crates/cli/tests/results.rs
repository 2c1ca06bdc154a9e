//! The commands of labs: their results are those of the session, bit for bit, and their links make
//! them again.

#![expect(clippy::unwrap_used, reason = "what fails here fails the test")]

mod common;

use common::{Folder, apart_m, made};
use segue_motion::synth::Action;
use segue_session::export::{ExportFormat, ExportOptions, export};
use segue_session::{Command, Session};
use std::fs;
use std::sync::Arc;

/// Returns the BVH of the first result of a session with some files and a link.
fn made_by_session(folder: &Folder, files: &[&str], link: impl Fn(&[String]) -> String) -> Vec<u8> {
    let mut session = Session::new();
    let mut ids = Vec::new();
    for name in files {
        let bytes = fs::read(folder.0.join(name)).unwrap();
        ids.extend(session.load(name, Arc::from(bytes)).unwrap().ids);
    }
    session.apply(Command::OpenLink(link(&ids))).unwrap();
    while session.work() {}
    let made = session.first_result().unwrap();
    let options = ExportOptions { format: ExportFormat::Bvh, ..ExportOptions::default() };
    export(&made.outcome.motion, None, &[], &options).unwrap()
}

fn two_clips(name: &str) -> Folder {
    let folder = Folder::new(name);
    folder.put_clip("walk 走.bvh", &made(Action::Walk, 3.0));
    folder.put_clip("run.bvh", &made(Action::Run, 3.0));
    folder
}

#[test]
fn blend_is_that_of_the_session_bit_for_bit() {
    let folder = two_clips("blend");
    let words =
        ["blend", "walk 走.bvh", "run.bvh", "-o", "out.bvh", "--blend-window", "24", "--json"];
    let run = folder.run_well(&words);
    let own = fs::read(folder.0.join("out.bvh")).unwrap();
    let theirs = made_by_session(&folder, &["walk 走.bvh", "run.bvh"], |ids| {
        format!("lab=blend&a={}&b={}&blend_window=24", ids[0], ids[1])
    });
    assert!(own == theirs, "the files differ");
    let made = &run.json()[0];
    assert_eq!(
        (&made["file"], &made["transition"]["window_frames"]),
        (&"out.bvh".into(), &24.into())
    );
    assert!(made["metrics"]["pose_jump_deg"]["value"].is_number());
}

#[test]
fn printed_link_makes_the_same_result() {
    let folder = two_clips("link");
    let files = ["walk 走.bvh", "run.bvh"];
    for (lab, options) in [
        ("blend", vec!["--blend-window", "12", "--weight-law", "linear"]),
        ("transition", vec!["--method", "quintic", "--set", "blend-time=0.5"]),
        ("register", vec!["--warp-weight", "0.25"]),
    ] {
        let mut words = vec![lab, files[0], files[1], "-o", "first.bvh", "--print-link"];
        words.extend(options);
        let run = folder.run_well(&words);
        let link = run.out.lines().last().unwrap();
        assert!(link.starts_with("http://127.0.0.1:8080/?"), "{link}");
        // In another order, because the link says which file is A.
        folder.run_well(&[lab, files[1], files[0], "--link", link, "-o", "second.bvh"]);
        let [first, second] =
            ["first.bvh", "second.bvh"].map(|name| fs::read(folder.0.join(name)).unwrap());
        assert!(first == second, "{lab}: the files differ");
        let again = folder.run_well(&[lab, files[0], files[1], "--link", link, "--print-link"]);
        assert_eq!(again.out.lines().last().unwrap(), link);
    }
}

#[test]
fn link_of_another_lab_or_without_its_file_is_refused() {
    let folder = two_clips("other");
    let run = folder.run(&["blend", "--link", "?lab=loop&a=walk"]);
    assert_eq!(run.code, 2);
    assert!(run.error.contains("use `segue loop --link"), "{}", run.error);
    let run = folder.run(&["loop", "run.bvh", "--link", "?lab=loop&a=take~0a1b2c3d"]);
    assert_eq!(run.code, 1, "{}", run.out);
    assert!(run.error.contains("`take` (SHA-256 0a1b2c3d…), which is not here"), "{}", run.error);
    let run = folder.run(&["loop", "run.bvh", "--link", "?lab=loop&loop_ratio=7"]);
    assert!(run.error.contains("loop_ratio: found 7, expected 0 to 1"), "{}", run.error);
}

#[test]
fn built_in_clips_need_no_file() {
    let folder = Folder::new("known");
    let words = ["transition", "walk", "run(turn_rate:20)", "-o", "out.bvh"];
    folder.run_well(&words);
    assert!(folder.clip("out.bvh").frames() > 100);
    // A bundled take.
    folder.run_well(&["loop", "cmu16_walk", "-o", "cycle.bvh"]);
    let run = folder.run(&["make", "--gait", "run", "--make-seconds", "2", "-o", "run.glb"]);
    assert_eq!(run.code, 0, "{}", run.error);
    assert_eq!(folder.run(&["make", "walk"]).code, 2);
}

#[test]
fn invalid_value_is_refused_with_the_sentence_of_the_table() {
    let folder = Folder::new("invalid");
    for (words, reason) in [
        (
            vec!["blend", "--blend-window", "1000"],
            "blend_window: found 1000, expected 1 to 240 frames",
        ),
        (vec!["blend", "--weight-law", "steep"], "steep"),
        (vec!["blend", "--set", "colour=red"], "`colour` is not a parameter"),
        (vec!["blend", "--set", "align"], "expected key=value"),
        (vec!["blend", "walk"], "takes two clips"),
        (vec!["retarget", "walk"], "--body"),
        (vec!["blend", "--half-lives", "1"], "--half-lives"),
        (vec!["dance"], "dance"),
    ] {
        let run = folder.run(&words);
        assert_eq!(run.code, 2, "{words:?}: {} {}", run.out, run.error);
        assert!(run.error.contains(reason), "{words:?}: {}", run.error);
    }
}

#[test]
fn each_clip_has_a_result_and_a_failure_ends_nothing() {
    let folder = two_clips("each");
    folder.put("broken.bvh", common::broken());
    let words = ["clean", "broken.bvh", "run.bvh", "walk 走.bvh", "-o", "out", "--to", "bvh"];
    let run = folder.run(&words);
    assert_eq!(run.code, 3);
    let first = run.out.lines().next().unwrap();
    assert!(first.starts_with("broken.bvh: no result: broken.bvh:"), "{}", run.out);
    let out: Vec<_> = folder.files().into_iter().filter(|path| path.starts_with("out/")).collect();
    assert_eq!(out, ["out/run.bvh", "out/walk 走.bvh"]);
    let theirs = made_by_session(&folder, &["run.bvh"], |ids| format!("lab=clean&a={}", ids[0]));
    assert!(fs::read(folder.0.join("out/run.bvh")).unwrap() == theirs, "the files differ");
}

#[test]
fn compared_values_have_a_file_each() {
    let folder = Folder::new("compare");
    let words = [
        "blend",
        "walk",
        "run",
        "--set",
        "compare=blend_window:30,10",
        "-o",
        "out",
        "--to",
        "bvh",
        "--json",
    ];
    let all = folder.run_well(&words).json();
    let names: Vec<_> = all.as_array().unwrap().iter().map(|made| &made["name"]).collect();
    assert_eq!(names, ["30 frames", "10 frames"]);
    assert_eq!(folder.files().len(), 2);
}

#[test]
fn retargeted_clip_has_the_body_of_the_file() {
    let folder = Folder::new("retarget");
    let small = segue_motion::synth::synthesize(&segue_motion::synth::Params {
        height_m: 1.2,
        ..segue_motion::synth::Params::new(Action::Idle)
    });
    folder.put_clip("small.bvh", &small.unwrap().clip);
    folder.put_clip("walk.bvh", &made(Action::Walk, 2.0));
    folder.run_well(&["retarget", "walk.bvh", "--body", "small.bvh", "-o", "out.bvh"]);
    let (out, small, walk) =
        (folder.clip("out.bvh"), folder.clip("small.bvh"), folder.clip("walk.bvh"));
    assert_eq!(out.frames(), walk.frames());
    let offset = |clip: &segue_motion::clip::Clip| clip.skeleton().joints()[1].offset.length();
    assert!((offset(&out) - offset(&small)).abs() < 1e-3);
    assert!(apart_m(&out, &walk) > 0.05);
}

#[test]
fn walk_and_bench_are_made_from_any_number_of_clips() {
    let folder = Folder::new("lists");
    let words = [
        "graph",
        "walk",
        "walk",
        "walk_left",
        "walk_right",
        "--walk-seconds",
        "10",
        "--seed",
        "3",
        "-o",
        "walk.bvh",
        "--json",
    ];
    let made = folder.run_well(&words).json();
    let secs = made[0]["seconds"].as_f64().unwrap();
    assert!(secs >= 10.0, "{secs}");
    assert!(made[0]["metrics"]["seams_per_min"]["value"].is_number());
    let words = ["match", "bench", "walk", "walk_left", "walk_right", "idle", "--json"];
    let all = folder.run_well(&words).json();
    let names: Vec<_> = all.as_array().unwrap().iter().map(|made| &made["name"]).collect();
    assert_eq!(names.len(), 7, "{names:?}");
    assert!(all[0]["metrics"]["match_error"]["value"].is_number(), "{}", all[0]);
    let one = folder.run_well(&["match", "bench", "walk", "idle", "--scenario", "spin"]);
    assert!(one.out.contains("Position error"), "{}", one.out);
}
