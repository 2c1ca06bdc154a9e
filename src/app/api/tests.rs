//! Tests of the page's API: answers, and the texts of rejections.

use super::*;
use crate::platform::{Inbox, Storage};
use segue_text::ToMessage;
use serde_json::json;

fn open(link: &str) -> Segue {
    let mut segue = Segue::new(Inbox::default(), None, link.to_owned());
    while segue.poll() || segue.is_busy() {}
    segue
}

/// Loads a file as the page's `load` does.
fn load(segue: &mut Segue, name: &str, bytes: &[u8]) -> Result<LoadedClips, ApiError> {
    let task = segue.load_in_background(name, FileBytes::Here(Arc::from(bytes)));
    while segue.is_reading(task) {
        segue.poll();
    }
    segue.read_result(task).expect("no test stops a task")
}

/// Returns a motion as a file, by words as a caller writes them.
fn exported(
    which: &str,
    format: &str,
    words: &ExportWords,
    segue: &Segue,
) -> Result<ExportedFile, ApiError> {
    segue.export_as(which, &words.options(format)?)
}

fn object(json: Json) -> Map<String, Json> {
    if let Json::Object(map) = json { map } else { panic!("{json} is no object") }
}

#[test]
fn bundled_take_outside_the_library_can_be_set() {
    let mut segue = open("lab=view&play=off");
    segue.set(&object(json!({ "a": "cmu_jump" }))).unwrap();
    assert_eq!(segue.params()["a"], json!("cmu_jump"));
    assert!(segue.clips().iter().any(|clip| clip.id == "cmu_jump"));
}

#[test]
fn set_with_a_wrong_value_changes_nothing_and_names_it() {
    let mut segue = open("lab=blend");
    segue
        .set(&object(
            json!({ "blend_window": 24, "align": false, "weight_law": "linear", "leave_a": "auto" }),
        ))
        .unwrap();
    assert_eq!(segue.params()["blend_window"], json!(24.0));
    assert_eq!(segue.params()["align"], json!(false));
    let before = segue.url();
    for (values, part) in [
        (json!({ "blend_window": 12, "colour": "red" }), "`colour` is not a parameter"),
        (
            json!({ "align": true, "blend_window": 0 }),
            "blend_window: found 0, expected 1 to 240 frames",
        ),
        (json!({ "blend_window": null }), "blend_window: found `null`, expected a number"),
        (json!({ "a": "nobody" }), "a: there is no clip `nobody`"),
        (json!({ "blend_window": [1, 2] }), "blend_window: found `[1,2]`"),
    ] {
        let message = segue.set(&object(values)).unwrap_err().to_string();
        assert!(message.contains(part), "{message}");
        assert_eq!(segue.url(), before, "{message}");
    }
}

#[test]
fn url_of_every_state_restores_it_even_of_the_defaults() {
    let mut segue = open("blend_window=24");
    assert_eq!(segue.url(), "?blend_window=24");
    segue.set(&object(json!({ "blend_window": 30 }))).unwrap();
    assert_eq!(segue.url(), "?lab=blend");
    assert_eq!(open("lab=blend").url(), segue.url());
}

#[test]
fn keys_and_params_have_the_same_names() {
    let names: Vec<&str> = keys().iter().map(|key| key.key).collect();
    let segue = open("lab=blend");
    assert!(names.iter().all(|name| segue.params().contains_key(*name)));
    assert_eq!(names.len(), segue.params().len());
    let rows = serde_json::to_value(keys()).unwrap();
    let window = rows.as_array().unwrap().iter().find(|row| row["key"] == "blend_window").unwrap();
    assert_eq!(
        (&window["type"], &window["min"], &window["max"], &window["unit"], &window["lab"]),
        (&json!("integer"), &json!(1.0), &json!(240.0), &json!("frames"), &json!("blend"))
    );
}

#[test]
fn pose_of_a_result_has_every_joint_in_the_world() {
    let segue = open("compare=blend_window:30,10");
    let pose = segue.pose("result:1", 0.5).unwrap();
    let joints = pose.joints.len();
    assert!(joints > 10);
    assert_eq!(
        (pose.parents.len(), pose.positions.len(), pose.rotations.len()),
        (joints, 3 * joints, 4 * joints)
    );
    assert_eq!(pose.parents[0], -1);
    // Bones keep their lengths: a child is as far from its parent as at the start.
    let start = segue.pose("result:1", 0.0).unwrap();
    let bone = |pose: &PoseInfo, joint: usize| {
        let place = |joint: usize| Vec3::from_slice(&pose.positions[3 * joint..]);
        place(joint).distance(place(pose.parents[joint] as usize))
    };
    for joint in 1..joints {
        assert!((bone(&pose, joint) - bone(&start, joint)).abs() < 1e-4, "{}", pose.joints[joint]);
    }
    for which in ["result:2", "result:x", "resultant", "nobody"] {
        assert!(
            segue.pose(which, 0.0).unwrap_err().to_string().contains(&format!("found `{which}`")),
            "{which}"
        );
    }
}

#[test]
fn metrics_of_compared_panes_have_a_number_for_each() {
    let segue = open("compare=blend_window:30,15,10");
    let metrics = segue.metrics().unwrap();
    assert!(!metrics.is_empty());
    for (name, metric) in metrics {
        assert_eq!((metric.panes.len(), metric.at.len()), (3, 3), "{name}");
        assert_eq!(metric.panes[0], metric.value, "{name}");
    }
}

#[test]
fn every_call_on_a_refused_result_rejects_with_its_sentence() {
    for (good, bad, part) in [
        ("lab=speed", json!({ "a": "idle" }), "cycle"),
        ("lab=loop&loop_to=1.5", json!({ "loop_from": 1.5 }), "cycle"),
        ("lab=path&a=walk", json!({ "a": "idle" }), "stays within"),
        (
            "lab=match&match_clips=walk,run",
            json!({ "ahead_near": 1, "ahead_far": 0.5 }),
            "must rise",
        ),
    ] {
        let mut segue = open(good);
        let name = segue.stage_name();
        assert!(
            segue.metrics().is_ok()
                && exported("result", "bvh", &ExportWords::default(), &segue).is_ok()
                && segue.report(None).is_ok()
        );
        segue.set(&object(bad)).unwrap();
        while segue.poll() || segue.is_busy() {}
        let kept = segue.clips().len();
        let refused = [
            segue.pose("result", 0.0).unwrap_err().to_string(),
            segue.metrics().unwrap_err().to_string(),
            exported("result", "bvh", &ExportWords::default(), &segue).unwrap_err().to_string(),
            segue.report(None).unwrap_err().to_string(),
            segue.keep("result").unwrap_err().to_string(),
        ];
        let problem = segue.session.panes()[0].problem.clone().unwrap();
        let sentence = problem.to_sentence().to_string();
        assert!(sentence.contains(part), "{good}: {sentence}");
        assert_eq!(refused, std::array::from_fn(|_| sentence.clone()), "{good}");
        assert_eq!(segue.clips().len(), kept);
        assert!(segue.stage_name() != name || !good.contains("path"), "{name}");
    }
}

#[test]
fn exported_file_can_be_loaded() {
    let mut segue = open("a=walk&lab=view");
    let file = exported("result", "bvh", &ExportWords::default(), &segue).unwrap();
    assert_eq!(file.name, "walk.bvh");
    let loaded = load(&mut segue, &file.name, &file.bytes).unwrap();
    assert_eq!(loaded.clips.len(), 1);
    assert_eq!(loaded.clips[0].frames, segue.motion("walk").unwrap().clip().frames());
    assert_eq!(
        exported("result", "max", &ExportWords::default(), &segue).unwrap_err().to_string(),
        "found `max`, expected one of bvh, fbx, glb, vrma, npz, csv, g1"
    );
    let statue = ExportWords { body: Some("statue".into()), ..ExportWords::default() };
    let pelvis = ExportWords { root: Some("pelvis".into()), ..ExportWords::default() };
    let never = ExportWords { fps: Some(0.0), ..ExportWords::default() };
    for (words, problem) in [
        (statue, "found `statue`, expected one of character, plain"),
        (pelvis, "root: found `pelvis`, expected one of as-is, ground, in-place"),
        (never, "fps: found 0, expected 1 to 1000 frames per second"),
    ] {
        assert_eq!(exported("result", "glb", &words, &segue).unwrap_err().to_string(), problem);
    }
    let refused = load(&mut segue, "x.bvh", b"HIERARCHY oops").unwrap_err().to_string();
    assert!(refused.starts_with("x.bvh:1:"), "{refused}");
    assert_eq!(segue.clips().iter().filter(|clip| clip.sha256.is_some()).count(), 1);
}

#[test]
fn exported_root_and_rate_are_those_of_the_call() {
    let mut segue = open("a=walk&lab=view");
    let own = segue.motion("walk").unwrap();
    let own = own.clip();
    let as_is = exported("result", "bvh", &ExportWords::default(), &segue).unwrap();
    let words = ExportWords { root: Some("ground".into()), fps: Some(24.0), body: None };
    let file = exported("result", "bvh", &words, &segue).unwrap();
    let loaded = load(&mut segue, "ground.bvh", &file.bytes).unwrap();
    let read = segue.motion(&loaded.clips[0].id).unwrap();
    assert!((read.clip().fps() - 24.0).abs() < 1e-3, "{}", read.clip().fps());
    // Reading takes the bone on the ground off again.
    assert_eq!(read.clip().skeleton().len(), own.skeleton().len());
    let joints = |bytes: &[u8]| String::from_utf8_lossy(bytes).matches("JOINT ").count();
    assert_eq!(joints(&file.bytes), joints(&as_is.bytes) + 1, "a bone on the ground");
}

#[test]
fn bone_map_of_the_api_is_that_of_its_file() {
    let mut segue = open("a=walk&lab=view");
    let map = segue.bone_map("walk").unwrap();
    let read = BoneMap::from_json(map.as_bytes()).unwrap();
    assert!(read.roles.values().flatten().count() > 10, "{map}");
    let foot = read.roles.values().flatten().next().unwrap();
    let without = map.replace(&format!("\"{foot}\""), "null");
    segue.set_bone_map(&without).unwrap();
    assert_ne!(segue.bone_map("walk").unwrap(), map, "a part has lost its bone");
    segue.set_bone_map(&map).unwrap();
    assert_eq!(segue.bone_map("walk").unwrap(), map);
    assert!(segue.bone_map("nothing").is_err() && segue.set_bone_map("{}").is_err());
}

#[test]
fn clips_and_panes_are_exported_in_every_format() {
    let segue = open("compare=blend_window:30,10&joint=left%20foot");
    for (which, stem) in [
        ("walk", "Walk"),
        ("result", "walk to run 30 frames"),
        ("result:1", "walk to run 10 frames"),
    ] {
        for (format, mime) in
            [("bvh", "text/plain"), ("csv", "text/csv"), ("glb", "model/gltf-binary")]
        {
            let file = exported(which, format, &ExportWords::default(), &segue).unwrap();
            assert_eq!(
                (file.name.to_lowercase(), file.mime),
                (format!("{}.{format}", stem.to_lowercase()), mime)
            );
            assert!(file.bytes.len() > 1000);
        }
    }
    let table = String::from_utf8(
        exported("result:1", "csv", &ExportWords::default(), &segue).unwrap().bytes,
    )
    .unwrap();
    let header = table.lines().next().unwrap();
    assert!(
        header.ends_with(
            "left foot.speed_m_per_s,A left foot.speed_m_per_s,B left foot.speed_m_per_s"
        )
    );
    let frames = segue.motion("result:1").unwrap().clip().frames();
    assert_eq!(table.lines().count(), frames + 1);
}

#[test]
fn set_with_more_clips_than_a_graph_takes_is_rejected() {
    let mut segue = open("lab=graph&play=off");
    let before = segue.params();
    let many: Vec<String> = (0..65).map(|n| format!("clip{n}")).collect();
    let refused = segue.set(&object(json!({ "clips": many.join(",") }))).unwrap_err();
    assert_eq!(refused.to_string(), "clips: These are 65 clips: take 64 at most.");
    assert_eq!(segue.params(), before);
}

#[test]
fn pose_at_a_time_that_is_not_finite_is_rejected() {
    let segue = open("lab=view&play=off");
    for secs in [f64::NAN, f64::INFINITY] {
        assert!(segue.pose("walk", secs).unwrap_err().to_string().contains("expected seconds"));
    }
}

/// Pages that a framing page may drive, by any spelling of the link, are the pages that store
/// nothing.
#[test]
fn embedded_page_in_any_spelling_has_no_storage() {
    for (link, embedded) in [
        ("embed=1", true),
        ("embed=on", true),
        ("embed=yes", true),
        ("embed=true", true),
        ("?embed=1", true),
        ("??embed=1", true),
        ("embed=%31", true),
        ("%65mbed=1", true),
        ("lab=view&embed=1", true),
        ("embed=1&embed=0", true),
        ("embed=0&embed=1", true),
        ("embed=1&embed=nonsense", true),
        ("embed=On", false),
        ("embed=ON", false),
        ("embed=1%20", false),
        ("embed=+1", false),
        ("embed=", false),
        ("embed", false),
        ("??embed", false),
        ("Embed=1", false),
        ("embed=0", false),
        ("embed%3D1", false),
        ("", false),
    ] {
        let segue = Segue::start_on(Inbox::default(), link.to_owned(), |_| {
            assert!(!embedded, "{link}: the storage is opened");
            Storage::default()
        });
        assert_eq!(segue.is_embedded(), embedded, "{link}");
    }
}

#[test]
fn warning_of_the_framing_page_is_shown_once() {
    let mut segue = open("lab=view&play=off");
    let shown = |segue: &Segue| {
        segue
            .session
            .notices()
            .list()
            .iter()
            .filter(|notice| notice.text.to_string() == crate::ui::HOST_READS.english())
            .count()
    };
    segue.warn_of_host();
    assert_eq!(shown(&segue), 0, "no page frames this one");
    segue.panels.host_reads = true;
    segue.warn_of_host();
    assert_eq!(shown(&segue), 1);
    let id = segue.session.notices().list().last().unwrap().id;
    segue.apply(Command::Dismiss(id)).unwrap();
    segue.warn_of_host();
    assert_eq!(shown(&segue), 0, "it was dismissed");
}
