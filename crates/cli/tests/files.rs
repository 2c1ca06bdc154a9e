//! `segue info` and `segue convert` over files that are made here.

mod common;

use common::{Folder, apart_m, broken, made};
use segue_motion::synth::Action;

#[test]
fn info_tells_what_a_file_contains() {
    let folder = Folder::new("info");
    let walk = made(Action::Walk, 2.0);
    folder.put_clip("走路.bvh", &walk);
    let text = folder.run_well(&["info", "走路.bvh"]).out;
    for part in ["走路.bvh\n", "kind      bvh, ", "17 of 17 body parts", " cm", "foot skating "] {
        assert!(text.contains(part), "{part} is not in\n{text}");
    }
    let all = folder.run_well(&["info", "走路.bvh", "--json"]).json();
    let (file, clip) = (&all[0], &all[0]["clips"][0]);
    assert_eq!((&file["kind"], &file["file"]), (&"bvh".into(), &"走路.bvh".into()));
    assert_eq!(clip["frames"], walk.frames());
    assert_eq!(clip["joints"], walk.skeleton().len());
    assert_eq!((&clip["unit"], &clip["up"]), (&"cm".into(), &"y".into()));
    assert!((clip["fps"].as_f64().unwrap() - walk.fps()).abs() < 1e-3);
    assert_eq!(clip["metrics"]["skating_cmps"]["unit"], "cm/s");
    let quick = folder.run_well(&["info", "走路.bvh", "--json", "--no-numbers"]).json();
    assert_eq!(quick[0]["clips"][0]["metrics"], serde_json::json!({}));
    // A unit that is named is used.
    let large = folder.run_well(&["info", "走路.bvh", "--json", "--from-unit", "m"]).json();
    assert_eq!(large[0]["clips"][0]["unit"], "m");
    assert!(large[0]["clips"][0]["height_m"].as_f64().unwrap() > 100.0);
}

#[test]
fn info_metrics_are_those_of_the_view_lab() {
    use segue_session::{Command, Session};
    let folder = Folder::new("metrics");
    let path = folder.put_clip("run.bvh", &made(Action::Run, 2.0));
    let told = folder.run_well(&["info", "run.bvh", "--json"]).json();
    let mut session = Session::new();
    let loaded = session.load("run.bvh", std::fs::read(path).unwrap().into()).unwrap();
    let link = format!("lab=view&a={}", loaded.ids[0]);
    session.apply(Command::OpenLink(link)).unwrap();
    while session.work() {}
    let shown = session.first_result().unwrap().outcome.metrics.clone();
    assert!(shown.len() > 5);
    for metric in shown {
        let own = &told[0]["clips"][0]["metrics"][metric.id.row().name]["value"];
        assert_eq!(own.as_f64(), metric.value, "{:?}", metric.id);
    }
}

#[test]
fn broken_file_is_named_with_its_place_and_ends_nothing() {
    let folder = Folder::new("broken");
    folder.put_clip("takes/a.bvh", &made(Action::Walk, 1.0));
    folder.put("takes/b.bvh", broken());
    folder.put_clip("takes/c/d.bvh", &made(Action::Run, 1.0));
    folder.put("takes/notes.csv", "no,motion\n1,2\n");
    let run = folder.run(&["info", "takes", "none.bvh", "--json"]);
    assert_eq!(run.code, 3);
    assert!(run.error.contains("there is no file or folder `none.bvh`"), "{}", run.error);
    let all = run.json();
    let names: Vec<_> = all.as_array().unwrap().iter().map(|file| &file["file"]).collect();
    assert_eq!(names, ["takes/a.bvh", "takes/b.bvh", "takes/c/d.bvh"]);
    let error = &all[1]["error"];
    assert!(error["line"].as_u64().unwrap() > 20 && error["column"] == 1, "{error}");
    assert!(error["text"].as_str().unwrap().starts_with("takes/b.bvh:"), "{error}");
    let run = folder.run(&["convert", "takes", "-o", "out", "--to", "glb"]);
    assert_eq!(run.code, 3);
    assert!(run.error.contains("takes/b.bvh:"), "{}", run.error);
    let made = folder.files().into_iter().filter(|path| path.starts_with("out/"));
    assert_eq!(made.collect::<Vec<_>>(), ["out/a.glb", "out/c/d.glb"]);
}

#[test]
fn folder_without_motion_is_named() {
    let folder = Folder::new("empty");
    folder.put("takes/readme.txt", "x");
    for words in [vec!["info", "takes"], vec!["lint", "takes"]] {
        let run = folder.run(&words);
        assert_eq!((run.code, run.out.as_str()), (3, ""));
        assert!(run.error.contains("takes has no motion files (.bvh, "), "{}", run.error);
    }
}

#[test]
fn conversion_there_and_back_keeps_every_position() {
    let folder = Folder::new("round");
    let walk = made(Action::Walk, 1.5);
    folder.put_clip("walk.bvh", &walk);
    for format in ["glb", "fbx", "npz", "vrma"] {
        let there = format!("walk.{format}");
        let back = format!("{format}.bvh");
        folder.run_well(&["convert", "walk.bvh", "-o", &there]);
        folder.run_well(&["convert", &there, "-o", &back]);
        let read = folder.clip(&back);
        assert!(apart_m(&walk, &read) < 1e-4, "{format}: {}", apart_m(&walk, &read));
    }
    folder.run_well(&["convert", "walk.bvh", "-o", "walk.csv"]);
    let table = std::fs::read_to_string(folder.0.join("walk.csv")).unwrap();
    assert_eq!(table.lines().count(), walk.frames() + 1);
    let run = folder.run(&["convert", "walk.bvh", "-o", "robot.csv", "--to", "g1"]);
    assert_eq!(run.code, 3);
    assert!(run.error.contains("walk.bvh: "), "{}", run.error);
}

#[test]
fn conversion_follows_its_options() {
    let folder = Folder::new("options");
    let walk = made(Action::Walk, 1.5);
    folder.put_clip("walk.bvh", &walk);
    let words = ["convert", "walk.bvh", "-o", "z.bvh", "--unit", "m", "--up", "z", "--rate", "30"];
    folder.run_well(&words);
    let told = folder.run_well(&["info", "z.bvh", "--json"]).json();
    let clip = &told[0]["clips"][0];
    assert_eq!((&clip["unit"], &clip["up"]), (&"m".into(), &"z".into()));
    assert_eq!(clip["fps"].as_f64().unwrap().round(), 30.0);
    // On the skeleton of another file.
    let run = made(Action::Run, 1.0);
    folder.put_clip("run.bvh", &run);
    folder.run_well(&["convert", "walk.bvh", "-o", "body.bvh", "--body", "run.bvh"]);
    assert_eq!(folder.clip("body.bvh").skeleton().len(), run.skeleton().len());
}

#[test]
fn conversion_refuses_what_would_lose_files() {
    let folder = Folder::new("refuse");
    folder.put_clip("walk.bvh", &made(Action::Walk, 1.0));
    folder.put_clip("run.bvh", &made(Action::Run, 1.0));
    let before = std::fs::read(folder.0.join("walk.bvh")).unwrap();
    let run = folder.run(&["convert", "walk.bvh", "-o", "walk.bvh", "--unit", "m"]);
    assert_eq!(run.code, 3);
    assert!(run.error.contains("is an input"), "{}", run.error);
    assert_eq!(std::fs::read(folder.0.join("walk.bvh")).unwrap(), before);
    let run = folder.run(&["convert", "walk.bvh", "run.bvh", "-o", "one.glb"]);
    assert_eq!(run.code, 3);
    assert!(run.error.contains("written twice"), "{}", run.error);
    let run = folder.run(&["convert", "walk.bvh", "-o", "out"]);
    assert_eq!(run.code, 2);
    assert!(run.error.contains("--to (bvh, fbx,"), "{}", run.error);
}

#[test]
fn zips_and_patterns_are_inputs() {
    let folder = Folder::new("zip");
    let walk = made(Action::Walk, 1.0);
    folder.put_clip("a/walk.bvh", &walk);
    let mut zip = segue_formats::ZipWriter::default();
    for name in ["set/x.bvh", "y.bvh"] {
        zip.store(name, &std::fs::read(folder.0.join("a/walk.bvh")).unwrap()).unwrap();
    }
    folder.put("pack.zip", zip.finish());
    let all = folder.run_well(&["info", "pack.zip", "a/*.bvh", "--json"]).json();
    let names: Vec<_> = all.as_array().unwrap().iter().map(|file| &file["file"]).collect();
    assert_eq!(names, ["pack.zip/set/x.bvh", "pack.zip/y.bvh", "a/walk.bvh"]);
    folder.run_well(&["convert", "pack.zip", "-o", "out", "--to", "bvh"]);
    assert!(apart_m(&walk, &folder.clip("out/pack/set/x.bvh")) < 1e-4);
    assert!(folder.files().contains(&"out/pack/y.bvh".to_owned()));
}

#[test]
fn motion_finds_the_skeleton_beside_it() {
    let folder = Folder::new("acclaim");
    folder.put("01/01.asf", ASF);
    folder.put("01/01_01.amc", AMC);
    let all = folder.run_well(&["info", "01/01_01.amc", "--json"]).json();
    assert_eq!((&all[0]["clips"][0]["frames"], &all[0]["skeleton"]), (&2.into(), &"01.asf".into()));
    // In a folder the skeleton is not a clip of its own.
    let all = folder.run_well(&["info", "01", "--json"]).json();
    assert_eq!(all.as_array().unwrap().len(), 1);
    folder.put("alone/01_01.amc", AMC);
    let run = folder.run(&["info", "alone"]);
    assert_eq!(run.code, 3);
    assert!(run.out.contains("needs its skeleton"), "{}", run.out);
    folder.run_well(&["info", "alone", "--skeleton", "01/01.asf"]);
}

const ASF: &str = include_str!("../../session/src/fixtures/toy.asf");
const AMC: &str = include_str!("../../session/src/fixtures/toy.amc");
