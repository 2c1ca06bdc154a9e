//! Transitions as the Transition lab makes them, frames found by itself, all parameters at their defaults: on made motion everywhere, and on captured
//! motion where this machine has it. `cargo xtask quality` shows the same numbers for a whole folder.

#[path = "formats_common/mod.rs"]
mod formats_common;
#[path = "../examples/transition_quality/measure.rs"]
mod measure;

use measure::{Lab, Numbers};
use segue::math::{spring, stats};

fn all_pairs(mut lab: Lab) -> Vec<Numbers> {
    let count = lab.len();
    let pair = |index: usize| lab.pair(index / count, index % count).expect("the lab joins any two clips");
    let pairs: Vec<Numbers> = (0..count * count).map(pair).collect();
    for pair in &pairs {
        eprintln!(
            "{:>10} → {:<10} seam {:.2} ({} {:.1} °/s) spin {:.1}° slide {:.2} → {:.3} cm knee {:.2}",
            pair.names[0],
            pair.names[1],
            pair.seam,
            pair.seam_joint,
            pair.seam_excess_dps,
            pair.spin_deg,
            pair.worst_cm[0],
            pair.worst_cm[1],
            pair.knee
        );
    }
    pairs
}

/// The median over all stances, centimetres.
fn slide(pairs: &[Numbers], lock: usize) -> f32 {
    let all: Vec<f32> = pairs.iter().flat_map(|pair| pair.slides_cm[lock].iter().copied()).collect();
    assert!(all.len() >= pairs.len(), "hardly a foot stands in {} pairs", pairs.len());
    stats::percentile(&all, 0.5).expect("feet stand")
}

fn what_holds_everywhere(pairs: &[Numbers]) {
    for pair in pairs {
        assert!(pair.spin_deg <= 10.0, "{:?} spins by {:.1}°", pair.names, pair.spin_deg);
    }
    let [free, locked] = [0, 1].map(|lock| slide(pairs, lock));
    assert!(free > 1.0 && locked <= 1.0, "{free} {locked}");
}

#[test]
fn made_motion() {
    let lab = Lab::of_presets(&["walk", "run", "walk_left", "idle", "stop"]).expect("presets are there");
    let pairs = all_pairs(lab);
    what_holds_everywhere(&pairs);
    // Nothing trembles here, and a joint's usual is next to nothing. What is left is how a spring starts: at once with y² times the offset, at 60
    // frames per second, for arms that hang and arms that are bent for a run.
    let start_of_spring = (spring::rate(0.2).powi(2) * 1.5 / 60.0).to_degrees() as f32;
    for pair in &pairs {
        assert!(
            pair.seam_excess_dps <= start_of_spring,
            "{:?}: {} jumps by {:.1} °/s",
            pair.names,
            pair.seam_joint,
            pair.seam_excess_dps
        );
    }
}

#[test]
fn captured_motion() {
    let Some(folder) = formats_common::subject_16() else { return };
    let wanted = ["16_15.amc", "16_17.amc", "16_35.amc", "16_41.amc"];
    let pairs = all_pairs(Lab::of_folder(&folder, |name| wanted.contains(&name)).expect("the takes are read"));
    what_holds_everywhere(&pairs);
    for pair in &pairs {
        assert!(
            pair.seam <= 1.0,
            "{:?}: {} jumps {:.2} times as usual",
            pair.names,
            pair.seam_joint,
            pair.seam
        );
        assert!(pair.knee <= 1.5, "{:?}: {:.2}", pair.names, pair.knee);
    }
    // From the walk into the run.
    let [free, locked] = pairs[2].worst_cm;
    assert!(free > 1.0 && locked <= 0.1 * free, "{free} {locked}");
    assert_eq!(pairs[2].names, ["16_15", "16_35"]);
}
