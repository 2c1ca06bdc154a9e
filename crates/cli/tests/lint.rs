//! `segue lint`: exit codes, findings and their places, SARIF and JUnit.

#![expect(clippy::unwrap_used, reason = "what fails here fails the test")]

mod common;

use common::{Folder, broken, made};
use segue_formats::bvh::{WriteOptions, write};
use segue_motion::clip::Clip;
use segue_motion::synth::Action;

/// The frame of [`spiky`] in which an arm leaves its way.
const SPIKE: usize = 60;

/// Returns a walk as BVH in which one joint is turned by 80° in one frame, and the line of that
/// frame, counted from 1.
fn spiky(walk: &Clip) -> (String, usize) {
    let text = write(walk, &WriteOptions::default());
    let mut lines: Vec<String> = text.lines().map(str::to_owned).collect();
    let first = lines.iter().position(|line| line.starts_with("Frame Time:")).unwrap() + 1;
    let mut numbers: Vec<String> =
        lines[first + SPIKE].split_whitespace().map(str::to_owned).collect();
    for number in numbers.iter_mut().skip(12).take(3) {
        *number = (number.parse::<f64>().unwrap() + 80.0).to_string();
    }
    lines[first + SPIKE] = numbers.join(" ");
    (lines.join("\n") + "\n", first + SPIKE + 1)
}

#[test]
fn clean_files_pass_and_a_spike_fails_at_its_line() {
    let folder = Folder::new("lint");
    let walk = made(Action::Walk, 3.0);
    folder.put_clip("good.bvh", &walk);
    let run = folder.run(&["lint", "good.bvh"]);
    assert_eq!(run.code, 0, "{}", run.out);
    let (text, line) = spiky(&walk);
    folder.put("bad.bvh", text);
    let run = folder.run(&["lint", "good.bvh", "bad.bvh", "--quiet"]);
    assert_eq!(run.code, 1, "{}", run.out);
    assert!(run.out.contains(&format!("bad.bvh:{line}  error  spike")), "{line}: {}", run.out);
    assert!(!run.out.contains("good.bvh"), "{}", run.out);
    // The same as a warning.
    let run = folder.run(&["lint", "bad.bvh", "--fail-on", "swap"]);
    assert_eq!(run.code, 0, "{}", run.out);
    assert!(run.out.contains("warning  spike"), "{}", run.out);
    let run = folder.run(&["lint", "good.bvh", "--fail-on", "skating>0.001m/s"]);
    assert_eq!(run.code, 1, "{}", run.out);
    let run = folder.run(&["lint", "good.bvh", "--fail-on", "spni"]);
    assert_eq!(run.code, 2);
    assert!(run.error.contains("--fail-on: found `spni`, expected all, none"), "{}", run.error);
}

#[test]
fn reports_have_the_shape_of_their_formats() {
    let folder = Folder::new("reports");
    let (text, line) = spiky(&made(Action::Walk, 3.0));
    folder.put("a b/走路.bvh", text);
    folder.put("a b/broken.bvh", broken());
    let words = ["lint", "a b", "--sarif", "out.sarif", "--junit", "out.xml", "--json"];
    let run = folder.run(&words);
    assert_eq!(run.code, 3, "{}", run.error);
    let all = run.json();
    assert_eq!(all[0]["file"], "a b/broken.bvh");
    assert!(all[0]["error"]["line"].as_u64().unwrap() > 20);
    let spike = &all[1]["findings"][0];
    assert_eq!((&spike["check"], &spike["severity"]), (&"spike".into(), &"error".into()));
    assert_eq!((&spike["frames"][0], &spike["line"]), (&SPIKE.into(), &line.into()));

    let sarif = std::fs::read_to_string(folder.0.join("out.sarif")).unwrap();
    let sarif: serde_json::Value = serde_json::from_str(&sarif).unwrap();
    assert_eq!(sarif["version"], "2.1.0");
    let run = &sarif["runs"][0];
    let rules: Vec<_> =
        run["tool"]["driver"]["rules"].as_array().unwrap().iter().map(|rule| &rule["id"]).collect();
    let results = run["results"].as_array().unwrap();
    assert!(results.iter().all(|result| rules.contains(&&result["ruleId"])));
    assert!(results.iter().all(|result| {
        result["message"]["text"].is_string()
            && ["error", "warning"].contains(&result["level"].as_str().unwrap())
    }));
    let place = |at: usize| &results[at]["locations"][0]["physicalLocation"];
    assert_eq!(results[0]["ruleId"], "unreadable");
    assert_eq!(place(0)["artifactLocation"]["uri"], "a%20b/broken.bvh");
    assert_eq!(place(0)["region"]["startColumn"], 1);
    let spike = results.iter().position(|result| result["ruleId"] == "spike").unwrap();
    assert_eq!(place(spike)["artifactLocation"]["uri"], "a%20b/%E8%B5%B0%E8%B7%AF.bvh");
    assert_eq!(place(spike)["region"]["startLine"], line);

    let xml = std::fs::read_to_string(folder.0.join("out.xml")).unwrap();
    assert!(xml.starts_with("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<testsuites "), "{xml}");
    assert!(xml.contains("tests=\"2\" failures=\"1\" errors=\"1\""), "{xml}");
    assert!(xml.contains("<testsuite name=\"a b/走路.bvh\" tests=\"1\" failures=\"1\""), "{xml}");
    assert!(xml.contains("<failure type=\"spike\" message=\"spike: "), "{xml}");
    assert!(xml.contains("<error type=\"unreadable\" message=\"a b/broken.bvh:"), "{xml}");
    for word in ["testsuites", "testsuite", "testcase", "failure"] {
        let count = |tag: String| xml.matches(&tag).count();
        assert_eq!(count(format!("<{word} ")), count(format!("</{word}>")), "{word}");
    }
}
