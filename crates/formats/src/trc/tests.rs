//! TRC files with gaps, odd headers and rows.

use super::*;
use crate::import;

const HEAD: &str = "PathFileType\t4\t(X/Y/Z)\tmade.trc\n\
    DataRate\tCameraRate\tNumFrames\tNumMarkers\tUnits\tOrigDataRate\n\
    100.00\t100.00\t3\t2\tmm\t100.00\n";
const NAMES: &str = "Frame#\tTime\tBall One\t\t\tB\t\t\t\n\t\tX1\tY1\tZ1\tX2\tY2\tZ2\t\n\n";
const ROWS: &str = "1\t0.00\t1000\t2000\t500\t10\t20\t30\t\n\
    2\t0.01\t\t\t\t20\t20\t30\t\n\
    3\t0.02\t1200\t2000\t500\tnan\tNaN\t-nan(ind)\n";

fn points(text: &str) -> LabelledPoints {
    table(text.as_bytes(), &mut Tally::default()).unwrap()
}

#[test]
fn trc_with_gaps_keeps_names_unit_and_rate() {
    let text = format!("{HEAD}{NAMES}{ROWS}");
    for text in [text.clone(), text.replace('\n', "\r\n"), text.replace(".00", ",00")] {
        let points = points(&text);
        assert_eq!(points.labels, ["Ball One", "B"]);
        assert_eq!((points.fps, points.unit), (Some(100.0), Some(0.001)));
        let known: Vec<bool> = points.positions.iter().map(|at| at.is_finite()).collect();
        assert_eq!(known, [true, true, false, true, true, false]);
        assert_eq!(points.positions[4], Vec3::new(1200.0, 2000.0, 500.0));
    }
    let file = import("made.trc", text.as_bytes(), &ImportOptions::default()).unwrap();
    let clip = &file.clips[0].clip;
    assert_eq!((clip.frames(), clip.skeleton().len()), (3, 3));
    // The gap in the middle is filled between its neighbours.
    let ball = clip.world_positions(1..2)[1];
    assert!(ball.distance(Vec3::new(1.1, 2.0, 0.5)) < 1e-4, "{ball}");
}

#[test]
fn trc_with_spaces_or_without_names_is_read() {
    let spaced = format!("{HEAD}{NAMES}{ROWS}")
        .replace("Ball One", "Ball")
        .replace("\t\t\t\t", "\t7\t7\t7\t")
        .replace('\t', "  ");
    assert_eq!(points(&spaced).labels, ["Ball", "B"]);
    let nameless = format!("{HEAD}Frame#\tTime\t\n\t\t\n\n1\t0.0\t1\t2\t3\t4\t5\t6\n");
    assert_eq!(points(&nameless).labels, ["M1", "M2"]);
    let wide = format!("{HEAD}{NAMES}1\t0\t1\t2\t3\t4\t5\t6\t7\t8\t9\n");
    assert_eq!(points(&wide).labels, ["Ball One", "B", "M3"]);
    let commas = format!("{HEAD}{NAMES}{ROWS}").replace('\t', ",");
    assert_eq!(points(&commas).labels, ["Ball One", "B"]);
    assert_eq!((points(&commas).fps, points(&commas).unit), (Some(100.0), Some(0.001)));
    assert_eq!(points(&commas).positions[0], Vec3::new(1000.0, 2000.0, 500.0));
    // Without a rate the times of the rows show it.
    let no_rate = format!("{HEAD}{NAMES}{ROWS}").replace("100.00\t100.00", "x\ty");
    assert!((points(&no_rate).fps.unwrap() - 100.0).abs() < 1e-6);
}

#[test]
fn trc_that_is_broken_is_refused_with_its_place() {
    let error = |text: &str| {
        read("b.trc", text.as_bytes(), &ImportOptions::default()).unwrap_err().to_string()
    };
    assert_eq!(
        error(HEAD),
        "b.trc:4:1: found the end of the file, expected a line that begins with `Frame#`"
    );
    assert!(error(&format!("{HEAD}{NAMES}")).contains("a table without rows"));
    let typing_error = format!("{HEAD}{NAMES}{ROWS}").replace("\n2\t", "\nzwei\t");
    assert!(
        error(&typing_error).starts_with("b.trc:8:1: found `zwei`"),
        "{}",
        error(&typing_error)
    );
    let empty = format!("{HEAD}{NAMES}1\t0\n2\t0.01\n");
    assert!(error(&empty).contains("points that no frame shows"), "{}", error(&empty));
}

#[test]
fn trc_of_many_names_and_empty_rows_is_refused_before_it_fills_the_memory() {
    let names = "name\t\t\t".repeat(4000);
    let rows = "1\t0\n".repeat(4000);
    let text = format!("{HEAD}Frame#\tTime\t{names}\n\tX1\n{rows}");
    let error = read("m.trc", text.as_bytes(), &ImportOptions::default()).unwrap_err();
    assert!(error.to_string().contains("without values"), "{error}");
}

#[test]
fn trc_with_a_wrong_count_and_words_is_read_with_warnings() {
    let text = format!("{HEAD}{NAMES}{ROWS}").replace("100.00\t3\t2", "100.00\t900\t2");
    let text = text.replace("1200", "lost");
    let file = read("w.trc", text.as_bytes(), &ImportOptions::default()).unwrap();
    let kinds: Vec<&WarningKind> = file.warnings.iter().map(|warning| &warning.kind).collect();
    assert!(kinds.contains(&&WarningKind::FrameCount { declared: "900".into(), found: 3 }));
    assert!(kinds.contains(&&WarningKind::NotNumbers { text: "`lost`".into() }), "{kinds:?}");
}
