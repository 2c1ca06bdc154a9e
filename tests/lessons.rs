//! The bundled lessons: they are complete, their links do what they say, and their numbers are
//! those of the program.

mod bundled;

use segue_session::lesson::{CONTENTS, LESSONS, MAX_BYTES, Page, file_name, parse};
use segue_session::{Command, Level, Session, link};
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

const LANGUAGES: [&str; 2] = ["en", "zh-Hant"];

fn folder(language: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("assets/lessons").join(language)
}

fn text(language: &str, lesson: &str) -> String {
    let file = file_name(lesson).expect("a lesson of the list");
    let text = std::fs::read_to_string(folder(language).join(&file));
    text.unwrap_or_else(|error| panic!("{language}/{file}: {error}"))
}

fn page(language: &str, lesson: &str) -> Page {
    let text = text(language, lesson);
    assert!(text.len() < MAX_BYTES / 16, "{language}, {lesson}");
    let pages =
        parse(text.as_bytes()).unwrap_or_else(|error| panic!("{language}, {lesson}: {error}"));
    let [page] = pages.as_slice() else { panic!("{language}, {lesson}: {} pages", pages.len()) };
    page.clone()
}

fn queries(page: &Page) -> Vec<String> {
    let state = page.state.iter().map(|state| &state.query);
    state.chain(page.tries.iter().map(|link| &link.query)).cloned().collect()
}

#[test]
fn lessons_have_all_parts_in_both_languages() {
    for lesson in LESSONS {
        let pages = LANGUAGES.map(|language| page(language, lesson));
        for page in &pages {
            assert!(!page.title.is_empty() && page.body.len() >= 3, "{lesson}");
            assert!(page.state.as_ref().is_some_and(|state| !state.label.is_empty()), "{lesson}");
            assert!((2..=5).contains(&page.tries.len()), "{lesson}: {} tries", page.tries.len());
            assert!(
                page.tries.iter().all(|link| !link.label.is_empty() && !link.about.is_empty()),
                "{lesson}"
            );
            assert!(page.question.len() == 1 && page.answer.len() == 1, "{lesson}");
        }
        assert_eq!(queries(&pages[0]), queries(&pages[1]), "{lesson}: both languages try the same");
    }
}

#[test]
fn lessons_are_listed_completely() {
    for language in LANGUAGES {
        let files: BTreeSet<String> = std::fs::read_dir(folder(language))
            .expect("the folder of the lessons")
            .map(|entry| entry.expect("a file").file_name().to_string_lossy().into_owned())
            .collect();
        let known = LESSONS.into_iter().chain([CONTENTS]).filter_map(file_name).collect();
        assert_eq!(files, known, "{language}");
        let listed: Vec<(String, String)> = page(language, CONTENTS)
            .entries()
            .map(|entry| {
                assert!(!entry.about.is_empty(), "{}", entry.label);
                (entry.query, entry.label)
            })
            .collect();
        let expected: Vec<(String, String)> = LESSONS
            .iter()
            .map(|lesson| (format!("lesson={lesson}"), page(language, lesson).title))
            .collect();
        assert_eq!(listed, expected, "{language}");
    }
}

/// Returns a session with a lesson open and one of its links tried, with the bundled takes that the
/// lesson names, and all work done.
fn tried(lesson: &str, query: &str) -> Session {
    let mut session = Session::new();
    session.apply(Command::OpenLink(format!("lesson={lesson}"))).expect("a link is never refused");
    let source = segue_session::lesson::source_of(lesson, "en").expect("a lesson of the list").0;
    session.finish_lesson(&source, Ok(text("en", lesson).as_bytes()));
    session.apply(Command::Try(query.to_owned())).expect("a lesson is open");
    assert!(session.is_tried(query), "{lesson}: {query}");
    bundled::settle(&mut session);
    session
}

/// The states in which some panes have no graph, because a segment is no longer than the window.
const CRASHES: [&str; 2] = ["", "blend_window=30"];

#[test]
fn links_of_lessons_give_results() {
    let (mut checked, mut wrong) = (0, Vec::new());
    for lesson in LESSONS {
        let page = page("en", lesson);
        let mut seen = BTreeSet::new();
        for query in
            std::iter::once(String::new()).chain(page.tries.iter().map(|link| link.query.clone()))
        {
            assert_eq!(link::read(&query).problems, [], "{lesson}: {query}");
            let session = tried(lesson, &query);
            checked += check_numbers(lesson, &query, &session, &mut wrong);
            let said: Vec<_> = session
                .notices()
                .list()
                .iter()
                .filter(|notice| notice.level != Level::Info)
                .collect();
            assert!(said.is_empty(), "{lesson}: {query}: {said:?}");
            for pane in session.panes() {
                let crashes = lesson == "segment_size" && CRASHES.contains(&query.as_str());
                assert!(pane.problem.is_none() || crashes, "{lesson}: {query}: {:?}", pane.problem);
                assert!(pane.outcome.is_some() || crashes, "{lesson}: {query}");
            }
            assert!(seen.insert(session.query()), "{lesson}: {query} changes nothing");
            let others = page.tries.iter().filter(|link| link.query != query);
            for other in others {
                assert!(
                    !session.is_tried(&other.query),
                    "{lesson}: {query} and {} are alike",
                    other.query
                );
            }
        }
    }
    assert!(wrong.is_empty(), "\n{}", wrong.join("\n"));
    assert_eq!(checked, QUOTED.len(), "numbers of links that no lesson has");
}

/// The bounds of a number: the pane, the number's id, the least and the greatest value.
type Bounds = (usize, &'static str, f64, f64);

/// The lessons about labs that work with captured motion, and bounds of some of their numbers. The
/// bounds are those of a plausible result; the exact values change with the program.
const REAL: &[(&str, &[Bounds])] = &[
    (
        "loops",
        &[
            (0, "cycle_s", 0.8, 1.6),
            (0, "loop_seam_deg", 0.0, 0.5),
            (0, "loop_before_deg", 0.5, 40.0),
            (0, "foot_slide_cm", 0.0, 15.0),
        ],
    ),
    ("time_warp", &[(0, "apart_cm", 1.0, 20.0), (0, "foot_slide_cm", 0.0, 20.0)]),
    (
        "distance_matrix",
        &[(0, "spins", 0.0, 0.0), (0, "seams_per_min", 2.0, 120.0), (0, "variety", 20.0, 100.0)],
    ),
    ("segment_size", &[(0, "spins", 0.0, 0.0), (0, "seams_per_min", 2.0, 120.0)]),
    ("edge_weights", &[(0, "spins", 0.0, 0.0), (0, "seams_per_min", 10.0, 400.0)]),
    ("atan", &[(0, "spins", 0.0, 0.0), (1, "spins", 5.0, 100.0)]),
    ("first_frame", &[(0, "spins", 0.0, 0.0), (1, "spins", 1.0, 100.0)]),
    ("motion_matching", &[(0, "match_error", 0.0, 30.0), (0, "match_seams", 5.0, 200.0)]),
];

/// Returns the violations of the bounds of captured motion. Every number that exists must be
/// finite.
fn check_bounds(what: &str, session: &Session, bounds: &[(usize, &str, f64, f64)]) -> Vec<String> {
    let mut wrong = Vec::new();
    for (index, pane) in session.panes().iter().enumerate() {
        let Some(outcome) = &pane.outcome else {
            wrong.push(format!("{what}: pane {index}: {:?}", pane.problem));
            continue;
        };
        let values =
            outcome.metrics.iter().filter_map(|metric| Some((metric.id.name(), metric.value?)));
        for (id, value) in values.clone() {
            eprintln!("{what}: pane {index}: {id} {value:.2}");
            if !value.is_finite() {
                wrong.push(format!("{what}: pane {index}: {id} is {value}"));
            }
        }
        for &(_, id, least, most) in bounds.iter().filter(|bound| bound.0 == index) {
            let value = values.clone().find(|value| value.0 == id).map(|value| value.1);
            if !value.is_some_and(|value| (least..=most).contains(&value)) {
                wrong.push(format!(
                    "{what}: pane {index}: {id} is {value:?}, expected {least} to {most}"
                ));
            }
        }
        let root = outcome.motion.clip().root_translations();
        let fps = outcome.motion.clip().fps() as f32;
        let fastest =
            root.windows(2).map(|pair| pair[0].distance(pair[1]) * fps).fold(0.0, f32::max);
        if !(0.2..8.0).contains(&fastest) {
            wrong.push(format!("{what}: pane {index}: the root moves at {fastest} m/s"));
        }
    }
    wrong
}

#[test]
fn links_to_captured_motion_have_plausible_numbers() {
    let mut wrong = Vec::new();
    for (lesson, bounds) in REAL {
        let real = LANGUAGES.map(|language| {
            let tries = page(language, lesson).tries.into_iter();
            let real: Vec<_> = tries.filter(|link| link.query.contains("cmu16_")).collect();
            assert_eq!(real.len(), 1, "{language}, {lesson}");
            (real[0].label.clone(), real[0].query.clone())
        });
        assert_eq!([&real[0].0, &real[1].0], ["With real motion", "換成真實動作"], "{lesson}");
        wrong.extend(check_bounds(lesson, &tried(lesson, &real[0].1), bounds));
    }
    assert!(wrong.is_empty(), "\n{}", wrong.join("\n"));
}

/// The links to captured motion in `docs/labs.md`, by their beginnings.
const LAB_LINKS: &[(&str, &[Bounds])] = &[
    (
        "lab=speed",
        &[
            (0, "speed_mps", 1.2, 3.0),
            (0, "cadence_spm", 90.0, 200.0),
            (0, "foot_slide_cm", 0.0, 20.0),
        ],
    ),
    ("lab=loop", &[(0, "cycle_s", 0.8, 1.6), (0, "loop_seam_deg", 0.0, 0.5)]),
    ("lab=register", &[(0, "apart_cm", 1.0, 25.0)]),
    ("lab=graph", &[(0, "spins", 0.0, 0.0), (0, "seams_per_min", 2.0, 120.0)]),
    ("lab=match", &[(0, "match_error", 0.0, 30.0), (0, "match_seams", 5.0, 200.0)]),
];

#[test]
fn links_of_the_labs_document_have_plausible_numbers() {
    let text = std::fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/labs.md"))
        .expect("the document");
    let links: Vec<&str> = (text.split("<code>?").skip(1))
        .filter_map(|rest| rest.split_once("</code>"))
        .map(|(link, _)| link)
        .filter(|link| link.contains("cmu16_"))
        .collect();
    assert_eq!(links.len(), LAB_LINKS.len(), "{links:?}");
    let mut wrong = Vec::new();
    for (begins, bounds) in LAB_LINKS {
        let link = links
            .iter()
            .find(|link| link.starts_with(begins))
            .unwrap_or_else(|| panic!("{begins}"));
        assert_eq!(link::read(link).problems, [], "{link}");
        let mut session = Session::new();
        session.apply(Command::OpenLink((*link).to_owned())).expect("a link is never refused");
        let named = link.matches("cmu16_").count();
        assert_eq!(
            bundled::settle(&mut session).len(),
            named,
            "{link}: what it names is loaded, and nothing else"
        );
        wrong.extend(check_bounds(link, &session, bounds));
    }
    assert!(wrong.is_empty(), "\n{}", wrong.join("\n"));
}

/// Numbers that lessons quote: the lesson, the link, the pane, the number's id, and the words in
/// both languages.
const QUOTED: &[(&str, &str, usize, &str, &str)] = &[
    ("alignment", "align=off", 0, "spin_deg", "23°"),
    ("alignment", "align=off", 0, "foot_slide_cm", "153 cm"),
    ("alignment", "b=walk_right&align=off", 0, "spin_deg", "47°"),
    ("slerp", "compare=mistake:none,hemisphere", 1, "pose_jump_deg", "133°"),
    ("slerp", "compare=mistake:none,euler", 1, "pose_jump_deg", "151°"),
    ("blend_window", "", 0, "velocity_jump_dps", "47"),
    ("blend_window", "", 1, "velocity_jump_dps", "179"),
    ("blend_window", "", 2, "velocity_jump_dps", "348"),
    ("blend_window", "", 0, "lag_s", "0.40"),
    ("blend_window", "", 1, "lag_s", "0.20"),
    ("blend_window", "", 2, "lag_s", "0.13"),
    ("blend_window", "compare=blend_window:60,30,15,10", 0, "lag_s", "0.80 s"),
    (
        "blend_window",
        "compare=weight_law:smooth,linear,smoother",
        1,
        "velocity_jump_dps",
        "154 °/s",
    ),
    ("blend_window", "compare=blend_window:30,1", 1, "pose_jump_deg", "74°"),
    ("half_life", "compare=half_life:0.4,0.2,0.1", 0, "lag_s", "1.12"),
    ("half_life", "compare=half_life:0.4,0.2,0.1", 1, "lag_s", "0.55"),
    ("half_life", "compare=half_life:0.4,0.2,0.1", 2, "lag_s", "0.28"),
    ("half_life", "compare=half_life:0.4,0.2,0.1", 0, "velocity_jump_dps", "5"),
    ("half_life", "compare=half_life:0.4,0.2,0.1", 1, "velocity_jump_dps", "71"),
    ("half_life", "compare=half_life:0.4,0.2,0.1", 2, "velocity_jump_dps", "244 °/s"),
    ("half_life", "compare=mistake:none,velocity", 1, "velocity_jump_dps", "206 °/s"),
    ("loops", "", 0, "cycle_s", "1.07 s"),
    ("loops", "", 0, "loop_before_deg", "1.2°"),
    ("loops", "loop_from=0.5&loop_to=1.4", 0, "loop_before_deg", "44.5°"),
    ("loops", "loop_from=0.5&loop_to=1.4", 0, "foot_slide_cm", "25 cm"),
    (
        "loops",
        "loop_from=0.5&loop_to=1.4&compare=loop_method:exact,both,end",
        1,
        "loop_seam_deg",
        "0.6",
    ),
    (
        "loops",
        "loop_from=0.5&loop_to=1.4&compare=loop_method:exact,both,end",
        1,
        "loop_seam_deg",
        "0.63°",
    ),
    (
        "loops",
        "loop_from=0.5&loop_to=1.4&compare=loop_method:exact,both,end",
        2,
        "loop_seam_deg",
        "1.5°",
    ),
    ("loops", "compare=loop_method:exact,linear,cubic", 1, "loop_seam_dps", "136 °/s"),
    ("time_warp", "", 0, "apart_cm", "3.3 cm"),
    ("time_warp", "", 1, "apart_cm", "15.6 cm"),
    ("time_warp", "", 0, "foot_slide_cm", "0.5 cm"),
    ("time_warp", "", 0, "skating_cmps", "2.3 cm/s"),
    ("time_warp", "", 1, "skating_cmps", "4.6 cm/s"),
    ("time_warp", "", 1, "foot_slide_cm", "3.1 cm"),
    ("time_warp", "b=run", 0, "apart_cm", "12.7 cm"),
    ("time_warp", "b=run", 1, "apart_cm", "20.6 cm"),
    ("time_warp", "b=run&warp_mode=join", 0, "foot_slide_cm", "5.0 cm"),
    ("time_warp", "b=run&warp_mode=join", 1, "foot_slide_cm", "40 cm"),
    ("distance_matrix", "clips=walk,run&edge_threshold=40", 0, "flashes", "7"),
    ("edge_weights", "", 0, "flashes", "6"),
    ("edge_weights", "", 0, "velocity_jump_dps", "75 °/s"),
    ("edge_weights", "", 0, "variety", "52 %"),
    ("edge_weights", "", 0, "seams_per_min", "226"),
    ("edge_weights", "edge_weight=exponential", 0, "velocity_jump_dps", "18 °/s"),
    ("edge_weights", "edge_weight=exponential", 0, "variety", "31 %"),
    ("edge_weights", "edge_weight=proportional", 0, "flashes", "14"),
    ("edge_weights", "continuity=0.95", 0, "seams_per_min", "25"),
    ("atan", "", 1, "spins", "43"),
    (
        "atan",
        "lab=transition&a=walk&b=run&method=smooth&blend_window=30&root_blend=off&compare=mistake:none,atan",
        1,
        "spin_deg",
        "98°",
    ),
    ("first_frame", "", 1, "flashes", "8"),
    ("first_frame", "", 1, "spins", "6"),
    ("first_frame", "", 1, "foot_slide_cm", "56 cm"),
    ("first_frame", "", 0, "foot_slide_cm", "12"),
    ("first_frame", "clips=walk_left,walk_right&compare=transform:whole,first", 1, "spins", "22"),
    ("path_editing", "", 0, "fit_rms_cm", "1.3 cm"),
    ("path_editing", "", 0, "foot_slide_cm", "0.6 cm"),
    ("path_editing", "compare=control_points:4,8,16", 0, "fit_rms_cm", "1.9"),
    ("path_editing", "compare=control_points:4,8,16", 2, "fit_rms_cm", "0.5 cm"),
    ("path_editing", "path=AAgAABB-MHRKZmJQdDZ8Fn4J", 0, "foot_slide_cm", "6.8 cm"),
    ("path_editing", "path=AAgAABB-MHRKZmJQdDZ8Fn4J&foot_lock=on", 0, "foot_slide_cm", "0.0 cm"),
    ("motion_matching", "", 0, "match_error", "1.8 cm"),
    ("motion_matching", "", 0, "match_seams", "17"),
    ("motion_matching", "weight_path=0", 0, "match_error", "32 cm"),
    ("motion_matching", "weight_path=4", 0, "match_error", "1.4 cm"),
    ("motion_matching", "weight_feet=4", 0, "match_error", "26 cm"),
    ("motion_matching", "hysteresis=none", 0, "match_seams", "23"),
    ("foot_skate", "", 0, "foot_slide_cm", "41 cm"),
    ("foot_skate", "leave_a=auto&enter_b=auto", 0, "foot_slide_cm", "9.2 cm"),
    ("foot_skate", "foot_lock=on", 0, "foot_slide_cm", "9.9 cm"),
    ("foot_skate", "leave_a=auto&enter_b=auto&foot_lock=on", 0, "foot_slide_cm", "0.0 cm"),
    ("clean", "", 0, "pose_jump_deg", "142°"),
    ("clean", "", 1, "pose_jump_deg", "0.5°"),
];

/// Returns whether words such as `3.7 cm` are the rounded value.
fn is_rounded(words: &str, value: f64) -> bool {
    let digits: String = words.chars().take_while(|c| c.is_ascii_digit() || *c == '.').collect();
    let decimals = digits.split_once('.').map_or(0, |(_, after)| after.len());
    // Halves may be rounded either way: the last bits differ between machines.
    let unit = 10f64.powi(-(decimals as i32));
    digits.parse::<f64>().is_ok_and(|quoted| (quoted - value).abs() <= 0.51 * unit)
}

/// Returns how many numbers the lesson quotes for a state; wrong ones are added to `wrong`.
fn check_numbers(lesson: &str, query: &str, session: &Session, wrong: &mut Vec<String>) -> usize {
    let said = QUOTED.iter().filter(|quoted| (quoted.0, quoted.1) == (lesson, query));
    said.map(|&(_, _, pane, id, words)| {
        let outcome = session.panes().get(pane).and_then(|pane| pane.outcome.as_ref());
        let metric = outcome.and_then(|outcome| {
            outcome.metrics.iter().find(|metric| metric.id.name() == id)?.value
        });
        if !metric.is_some_and(|value| is_rounded(words, value)) {
            wrong.push(format!("{lesson}: {query}: {id} is {metric:?}, not {words}"));
        }
        for language in LANGUAGES {
            if !text(language, lesson).contains(words) {
                wrong.push(format!("{language}, {lesson}: says nothing of {words}"));
            }
        }
    })
    .count()
}

#[test]
fn graphs_of_lessons_have_the_quoted_transitions() {
    let cases = [
        ("distance_matrix", "", 0, "638", 74.0),
        ("distance_matrix", "edge_threshold=4", 0, "136", 51.0),
        ("distance_matrix", "edge_threshold=16", 0, "1158", 74.0),
        ("distance_matrix", "clips=walk,run&edge_threshold=40", 0, "", 67.0),
        ("segment_size", "blend_window=15", 0, "118", 83.0),
        ("segment_size", "blend_window=15", 1, "460", 100.0),
        ("segment_size", "blend_window=15", 2, "1090", 100.0),
        ("segment_size", "blend_window=30", 0, "77", 27.0),
    ];
    for (lesson, query, pane, jumps, percent) in cases {
        let session = tried(lesson, query);
        let walk =
            session.panes()[pane].outcome.as_ref().and_then(|outcome| outcome.walk().cloned());
        let built = walk.expect("a walk").built.clone();
        if !jumps.is_empty() {
            assert_eq!(built.whole().jumps().len().to_string(), jumps, "{lesson}: {query}");
        }
        assert!(
            (100.0 * built.component_shares()[0] - percent).abs() < 0.6,
            "{lesson}: {query}: {:?}",
            built.component_shares()
        );
        for language in LANGUAGES {
            assert!(text(language, lesson).contains(jumps), "{language}, {lesson}");
        }
    }
    for (lesson, query, cm) in [
        ("alignment", "", "4.4 cm"),
        ("foot_skate", "", "23.7 cm"),
        ("foot_skate", "leave_a=auto&enter_b=auto", "9.2 cm"),
    ] {
        let session = tried(lesson, query);
        let transition =
            session.main_outcome().and_then(|outcome| outcome.transition).expect("a transition");
        assert!(
            is_rounded(cm, f64::from(transition.distance_cm)),
            "{lesson}: {}",
            transition.distance_cm
        );
        assert!(LANGUAGES.iter().all(|language| text(language, lesson).contains(cm)), "{lesson}");
    }
}
