//! Tests of the conditions of jumps.

use super::*;
use std::collections::BTreeSet;

#[test]
fn votes_for_another_clip_allow_jumps_within_a_clip() {
    let options = ControllerOptions {
        hysteresis: Hysteresis::ThreeVotesForAnotherClip,
        prefer_current: 0.0,
        ..options()
    };
    let mut controller =
        Controller::new(Arc::clone(small_database()), options, &Planar::IDENTITY).unwrap();
    let mut elsewhere = 0;
    for control in Scenario::FigureEight.recording().controls() {
        let (before, jumps) = (controller.place(), controller.jumps());
        controller.tick(&control);
        let Some(search) =
            controller.last_search().filter(|search| search.tick + 1 == controller.ticks())
        else {
            continue;
        };
        let Some(winner) = search.winner else {
            continue;
        };
        let jumped = controller.jumps() > jumps;
        let other = winner.place.motion != before.motion;
        elsewhere = if other { elsewhere + 1 } else { 0 };
        if search.reason == SearchReason::ClipEnd {
            elsewhere = 0;
        } else if jumped && other {
            assert!(elsewhere >= 3, "{search:?}");
            elsewhere = 0;
        } else if !jumped {
            let voted =
                matches!(search.held, Some(HoldReason::Same | HoldReason::Votes)) && elsewhere < 3;
            // A frame of another clip that is not cheaper at all, while the input is constant.
            assert!(voted || search.held == Some(HoldReason::CurrentClip), "{search:?}");
        }
    }
    // In a database of one clip no votes are needed.
    let walk = Motion::analyze(synthesize(&Params::new(Action::Walk)).unwrap().clip);
    let alone = DatabaseOptions { mirrored: false, ..cycle_options(false) };
    let alone = Arc::new(Database::new(vec![Arc::new(walk)], &alone).unwrap());
    let jumps = |hysteresis| {
        let options = ControllerOptions { hysteresis, ..options };
        drive(&alone, options, &Scenario::StartStop.recording()).unwrap().jumps
    };
    let free = jumps(Hysteresis::None);
    assert!(
        free.iter().any(|jump| jump.reason != SearchReason::ClipEnd)
            && free == jumps(options.hysteresis)
    );
}

#[test]
fn preferred_source_is_kept_while_the_input_is_constant() {
    let motions = small_database().motions();
    let named =
        motions.iter().find(|motion| motion.clip().name() == "walk 1.9 m/s").unwrap().source();
    let share = |prefer_source, prefer_current| {
        let options = ControllerOptions {
            prefer_source,
            prefer_current,
            hysteresis: Hysteresis::None,
            candidates: 4,
            ..options()
        };
        let mut controller =
            Controller::new(Arc::clone(small_database()), options, &Planar::IDENTITY).unwrap();
        let mut there = 0;
        for tick in 0..480 {
            controller.tick(&Control::new(DVec2::new(0.0, 1.4), None));
            let search = controller.last_search().unwrap();
            assert_eq!(search.candidates.first(), search.winner.as_ref());
            there += u32::from(tick >= 240 && motions[controller.place().motion].source() == named);
        }
        f64::from(there) / 240.0
    };
    assert!(share(Some(named), 1.0) > 0.95);
    let usual = share(None, 0.0);
    assert!(usual < 0.3 && share(Some(named), 0.0) < 0.3, "{usual}");
}

#[test]
fn hysteresis_suppresses_jumps_and_tags_filter_frames() {
    let recording = Scenario::StartStop.recording();
    let jumps = |hysteresis| {
        let options = ControllerOptions { hysteresis, prefer_current: 0.0, ..options() };
        drive(small_database(), options, &recording).unwrap().jumps
    };
    let free = jumps(Hysteresis::None).len();
    for hysteresis in [
        Hysteresis::ContinuingBias { share: 0.3, constant: 0.3 },
        Hysteresis::MinimumTime { secs: 0.5 },
        Hysteresis::ThreeVotes,
        Hysteresis::ThreeVotesForAnotherClip,
    ] {
        assert!(jumps(hysteresis).len() < free, "{hysteresis:?}");
    }
    let apart = jumps(Hysteresis::MinimumTime { secs: 0.5 });
    let apart = apart.windows(2).filter(|pair| pair[1].reason != SearchReason::ClipEnd);
    assert!(apart.map(|pair| pair[1].frame - pair[0].frame).all(|frames| frames >= 30));

    let walk = TagFilter { ask: TagSet::of(&[Tag::Run]), forbid: TagSet::of(&[Tag::Turn]) };
    let mut controller =
        Controller::new(Arc::clone(small_database()), options(), &Planar::IDENTITY).unwrap();
    let control = Control::new(DVec2::new(0.0, 1.4), None).with_filter(walk);
    let mut places = BTreeSet::new();
    for _ in 0..180 {
        controller.tick(&control);
        if let Some(winner) = controller.last_search().and_then(|search| search.winner) {
            places.insert(winner.place);
        }
    }
    assert!(!places.is_empty());
    for place in places {
        assert!(
            walk.admits(small_database().tags(small_database().number(place).unwrap())),
            "{place:?}"
        );
    }
    // No frame has such a tag: the clip continues, and at its end the character stands.
    let nowhere =
        control.with_filter(TagFilter { ask: TagSet::of(&[Tag::Own(7)]), forbid: TagSet::NONE });
    for _ in 0..600 {
        controller.tick(&nowhere);
    }
    let search = controller.last_search().unwrap();
    assert_eq!((search.winner, search.held), (None, Some(HoldReason::Nothing)));
}
