//! Tests of compared walks, which follow the first one where they can.

use super::fixtures::{SMALL, assert_connected, number, set, walk, walk_of, way};
use crate::List;
use crate::fixtures::*;
use glam::DVec2;

#[test]
fn mistakes_spin_on_the_same_walk() {
    let session = opened(&format!("{SMALL}&compare=atan:atan2,atan"));
    assert_eq!(way(walk_of(&session, 0)), way(walk_of(&session, 1)));
    assert!(
        number(&session, 0, MetricId::Spins) == 0.0 && number(&session, 1, MetricId::Spins) > 0.0
    );
    let session = opened(&format!("{SMALL}&compare=transform:whole,first"));
    assert_eq!(way(walk_of(&session, 0)), way(walk_of(&session, 1)));
    assert!(
        number(&session, 0, MetricId::Spins) == 0.0 && number(&session, 1, MetricId::Spins) > 0.0
    );
    let both = opened(&format!("{SMALL}&atan=atan&transform=first"));
    assert!(both.panes()[0].problem.as_ref().unwrap().to_string().contains("Two mistakes at once"));
}

#[test]
fn walks_with_other_windows_follow_the_first_where_they_can() {
    let session = opened(&format!("{SMALL}&edge_threshold=10&compare=blend_window:24,12,8"));
    let clips = |pane: usize| -> Vec<usize> {
        walk_of(&session, pane).passed.iter().map(|passed| passed.stay.clip).collect()
    };
    assert!(!walk_of(&session, 0).is_guided && walk_of(&session, 1).is_guided);
    // Most of the time the same clip plays in all panes.
    for pane in 1..session.panes().len() {
        let same = (0..200).filter(|k| {
            let secs = f64::from(*k) * 0.1;
            let clip = |pane| walk_of(&session, pane).at(secs).unwrap().place.clip;
            clip(0) == clip(pane)
        });
        let share = same.count() as f64 / 200.0;
        assert!(share > 0.6, "{share}: {:?} {:?}", clips(0), clips(pane));
    }
}

#[test]
fn walks_with_other_segments_or_thresholds_are_their_own() {
    let segments = "lab=graph&clips=walk,walk_left,walk_right&walk_seconds=20&construction=segments&blend_window=10&edge_threshold=10";
    for link in [
        format!("{segments}&compare=segment_size:40,20"),
        format!("{SMALL}&compare=edge_threshold:2,10"),
    ] {
        let session = opened(&link);
        assert!(!walk_of(&session, 1).is_guided);
        assert_ne!(way(walk_of(&session, 0)), way(walk_of(&session, 1)), "{link}");
        let slides = [0, 1].map(|pane| number(&session, pane, MetricId::FootSlide));
        assert_ne!(slides[0], slides[1], "{link}");
        // Each is the same as alone.
        let alone = opened(
            &link
                .replace("compare=segment_size:40,20", "segment_size=20")
                .replace("compare=edge_threshold:2,10", "edge_threshold=10"),
        );
        assert_eq!(way(walk(&alone)), way(walk_of(&session, 1)), "{link}");
    }
}

#[test]
fn guided_walk_does_not_depend_on_what_was_shown_of_its_guide() {
    let small = format!("{SMALL}&edge_threshold=10&play=off");
    let compare = "blend_window:24,12,8";
    let fresh = opened(&format!("{small}&compare={compare}"));
    // The first walk is known already, and is much longer.
    let mut late = opened(&format!("{small}&blend_window=24&t=90"));
    assert!(walk(&late).motion.clip().duration_secs() > 100.0);
    late.apply(Command::Set(vec![
        (Key::Compare, Key::Compare.param().parse(compare).unwrap()),
        (Key::Time, Value::Number(0.0)),
    ]))
    .unwrap();
    while late.work() {}
    // The guiding walk becomes long.
    let mut long = opened(&format!("{small}&compare={compare}"));
    long.apply(Command::Playback(PlaybackCommand::Seek(70.0))).unwrap();
    while long.work() {}
    for pane in 1..3 {
        let wanted = way(walk_of(&fresh, pane));
        let wanted = &wanted[..wanted.len() - 1];
        assert!(walk_of(&fresh, pane).is_guided && wanted.len() > 5);
        for other in [&late, &long] {
            assert_eq!(way(walk_of(other, pane))[..wanted.len()], *wanted, "pane {pane}");
        }
        assert_connected(walk_of(&long, pane));
    }
    // A walk along a line follows the line, whatever the first one does.
    let line: Vec<DVec2> = (0..=10).map(|k| DVec2::new(0.1 * f64::from(k), f64::from(k))).collect();
    let path = List::GroundPath(line).write();
    let both = opened(&format!("{small}&walk_path={path}&compare={compare}"));
    let alone = opened(&format!("{small}&walk_path={path}&blend_window=12"));
    assert!(!walk_of(&both, 1).is_guided);
    assert_eq!(walk_of(&both, 1).followed, walk(&alone).followed);
    let (found, wanted) = (way(walk_of(&both, 1)), way(walk(&alone)));
    assert_eq!(found[..found.len() - 1], wanted[..found.len() - 1]);
}

#[test]
fn guided_walk_makes_its_visits() {
    // From a walk, the only way to rest is by a stop.
    let link = "lab=graph&clips=walk,start,stop,idle,walk_left&walk_seconds=30&play=off&compare=blend_window:24,12,8&edge_threshold=10";
    let mut session = opened(link);
    for secs in (2..16).map(f64::from) {
        set(&mut session, Key::GoTo, List::Visits(vec![(secs, 3)]).into());
        for pane in 0..3 {
            let walk = walk_of(&session, pane);
            assert_eq!(walk.missed, []);
            let due = (secs * 60.0).round() as usize;
            let mut behind = walk.passed.iter().filter(|passed| passed.end > due);
            let transitions = behind.position(|passed| passed.stay.clip == 3);
            assert!(
                transitions.is_some_and(|transitions| transitions <= 4),
                "{secs} s, pane {pane}: {transitions:?}"
            );
        }
    }
}
