//! Cycles of walks and runs: those found in a clip, compared with an exhaustive search, and clips
//! that are a single cycle. On synthesised motion everywhere, and on captured motion if this
//! machine has it.

#![expect(clippy::unwrap_used, reason = "what fails here fails the test")]

#[path = "../crates/formats/tests/common/mod.rs"]
mod common;

use common::{bvh_files, captured, shared_data};
use segue_formats::{ImportOptions, import};
use segue_motion::clip::{Clip, ContactOptions, Contacts, Motion, character_frames};
use segue_motion::registration::{REFERENCE_HEIGHT_M, distances_directly, limb_weights};
use segue_motion::skeleton::{Roles, Side};
use segue_motion::synth::{Action, Params, synthesize};
use segue_motion::transition::{CycleSearch, LoopOptions, close_loop, find_cycle};
use segue_session::{Command, Session};
use std::sync::Arc;

/// Returns synthesised walks and runs of several speeds, along lines and curves, and captured ones.
fn gaits() -> Vec<(String, Clip)> {
    let mut all = Vec::new();
    for (action, speed_mps, turn_rate_dps, fps) in [
        (Action::Walk, 0.8, 0.0, 60.0),
        (Action::Walk, 1.4, 40.0, 30.0),
        (Action::Walk, 1.9, -90.0, 60.0),
        (Action::Run, 2.6, 0.0, 30.0),
        (Action::Run, 3.8, 45.0, 60.0),
        (Action::Start, 1.4, 0.0, 60.0),
        (Action::Stop, 1.4, 0.0, 60.0),
    ] {
        let params = Params { speed_mps, turn_rate_dps, fps, ..Params::new(action) };
        all.push((
            format!("{action:?} {speed_mps} m/s {turn_rate_dps}°/s"),
            synthesize(&params).unwrap().clip,
        ));
    }
    if let Some(data) = shared_data() {
        for folder in ["bandai-namco", "games105", "cmu"] {
            for (name, bytes) in bvh_files(&data.join(folder)) {
                if ["walk", "run", "dash"].iter().any(|word| name.contains(word)) {
                    let clip = import(&name, &bytes, &ImportOptions::default())
                        .unwrap()
                        .clips
                        .swap_remove(0)
                        .clip;
                    all.push((name, clip));
                }
            }
        }
    }
    let takes = [
        "11", "13", "15", "16", "17", "19", "22", "29", "33", "35", "37", "39", "41", "43", "45",
        "55",
    ];
    all.extend(captured(&takes).into_iter().map(|(name, clip)| (format!("CMU 16_{name}"), clip)));
    all
}

/// Returns the least distance of any two windows that are a cycle apart, centimetres on the
/// reference body, by the slow distance without grid or refinement. As in the search, a foot must
/// strike within the cycle if one strikes anywhere, and the whole clip is compared by its ends
/// alone.
fn least_cm(clip: &Clip, contacts: &Contacts, body_height: f64, search: &CycleSearch) -> f64 {
    let (frames, fps) = (clip.frames(), clip.fps());
    let weights = limb_weights(clip.skeleton());
    let shortest = ((search.min_secs * fps).ceil() as usize).max(2);
    let longest = (search.max_secs * fps).floor() as usize;
    let window = search.window.clamp(1, frames - shortest);
    let touchdowns: Vec<usize> = Side::BOTH
        .into_iter()
        .flat_map(|side| contacts.intervals(side))
        .map(|stance| stance.start)
        .filter(|&at| at > 0)
        .collect();
    let mut least = [f64::INFINITY; 2];
    let mut offer = |start: usize, end: usize, rms_m: f32| {
        if (shortest..=longest).contains(&(end.saturating_sub(start))) {
            let steps = touchdowns.iter().any(|&at| at > start && at <= end);
            let place = &mut least[usize::from(steps)];
            *place = place.min(100.0 * f64::from(rms_m) * REFERENCE_HEIGHT_M / body_height);
        }
    };
    let grid =
        distances_directly((clip, 0..frames), (clip, 0..frames), &weights, window, 1).unwrap();
    for row in 0..grid.rows() {
        for column in row + 1..grid.columns() {
            offer(row, column, grid.get(row, column).unwrap());
        }
    }
    let ends =
        distances_directly((clip, 0..1), (clip, frames - 1..frames), &weights, 1, 1).unwrap();
    offer(0, frames - 1, ends.get(0, 0).unwrap());
    if least[1].is_finite() { least[1] } else { least[0] }
}

#[test]
fn automatic_cycles_equal_the_exhaustive_search() {
    let mut compared = 0;
    for (name, clip) in gaits() {
        let clip = Arc::new(clip);
        let roles = Roles::detect(clip.skeleton());
        let contacts = Contacts::detect(&clip, &roles, &ContactOptions::default());
        let height = f64::from(roles.body_height(clip.skeleton()));
        let source = Motion::with_roles(Arc::clone(&clip), &roles);
        let search = CycleSearch::new(clip.fps());
        if clip.duration_secs() <= search.min_secs {
            continue;
        }
        let found = find_cycle(&source, &search).unwrap();
        let least = least_cm(&clip, &contacts, height, &search);
        let looped = close_loop(&source, found.cycle.clone(), &LoopOptions::default()).unwrap();
        eprintln!(
            "{name:>44}: {:.2} to {:.2} s of {:.2}, {:.2} cm apart (least {least:.2}), gap {:.1}°, phases {:.2?} apart",
            clip.time_of(found.cycle.start),
            clip.time_of(found.cycle.end),
            clip.duration_secs(),
            found.rms_cm,
            looped.before.turn_deg,
            found.phase_gap
        );
        // The fast distance may be wrong by half a millimetre for nearly equal windows.
        assert!(found.rms_cm <= 1.1 * least + 0.05, "{name}: {} {least}", found.rms_cm);
        compared += 1;
    }
    assert!(compared >= 7);
}

/// GAMES-105 provides one cycle of a walk at 100 frames per second and one of a run at 60.
#[test]
fn single_cycles_of_a_course_blend_to_a_speed() {
    let Some(data) = shared_data() else { return };
    let mut session = Session::new();
    let [walk, run] = ["walk_forward.bvh", "run_forward.bvh"].map(|name| {
        let bytes = std::fs::read(data.join("games105").join(name)).unwrap();
        session.load(name, bytes.into()).unwrap().ids.swap_remove(0)
    });
    for speed in [1.5, 2.0] {
        let link = format!("lab=speed&a={walk}&b={run}&speed={speed}");
        session.apply(Command::OpenLink(link)).unwrap();
        let pane = &session.panes()[0];
        assert_eq!(pane.problem, None);
        let outcome = pane.outcome.as_ref().unwrap();
        let motion = &outcome.motion;
        let stands = character_frames(motion.clip(), motion.roles());
        let way: f64 = stands.windows(2).map(|pair| pair[0].shift.distance(pair[1].shift)).sum();
        let measured = way / motion.clip().duration_secs();
        let shown = outcome
            .metrics
            .iter()
            .find(|metric| metric.id.name() == "speed_mps")
            .and_then(|metric| metric.value)
            .unwrap();
        eprintln!(
            "{speed} m/s: measured {measured:.4}, shown {shown:.4}, made of {:?}",
            outcome.cycle.unwrap().made
        );
        assert!(
            (measured / speed - 1.0).abs() < 0.02 && (shown - measured).abs() < 1e-3,
            "{speed}: {measured} {shown}"
        );
    }
}
