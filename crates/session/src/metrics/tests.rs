//! Keys, units and directions of metrics never change: scripts and tables of users have them.

use super::{Better, Ends, METRICS, MetricId};
use std::collections::BTreeSet;

/// The metrics of results, by their names in the page's API.
const PUBLISHED: [(&str, &str, &str, Better); 51] = [
    ("apart_cm", "Pose distance", "cm", Better::Lower),
    ("cadence_spm", "Cadence", "steps/min", Better::Neutral),
    ("clip_frames", "Frames", "frames", Better::Neutral),
    ("clip_jump_cm", "Position jump", "cm", Better::Lower),
    ("clip_penetration_cm", "Penetration", "cm", Better::Lower),
    ("clip_s", "Length", "s", Better::Neutral),
    ("cycle_frames", "Cycle length", "frames", Better::Neutral),
    ("cycle_m", "Cycle distance", "m", Better::Neutral),
    ("cycle_s", "Cycle time", "s", Better::Neutral),
    ("cycle_turn_deg", "Turn per cycle", "°", Better::Neutral),
    ("faults_left", "Faults", "", Better::Lower),
    ("faults_mended", "Mends", "", Better::Neutral),
    ("fit_most_cm", "Largest fit error", "cm", Better::Neutral),
    ("fit_rms_cm", "Fit error", "cm", Better::Neutral),
    ("flashes", "Flashes", "", Better::Lower),
    ("foot_slide_before_cm", "Foot slide before lock", "cm", Better::Neutral),
    ("foot_slide_cm", "Foot slide", "cm", Better::Lower),
    ("foot_slide_in_place_cm", "Foot slide in place", "cm", Better::Neutral),
    ("foot_slide_original_cm", "Original foot slide", "cm", Better::Neutral),
    ("hard_turns", "Hard turns", "bends", Better::Lower),
    ("jump_cm", "Position jump", "cm", Better::Lower),
    ("lag_s", "Lag", "s", Better::Lower),
    ("loop_before_deg", "Gap before closing", "°", Better::Neutral),
    ("loop_seam_deg", "Seam", "°", Better::Lower),
    ("loop_seam_dps", "Velocity seam", "°/s", Better::Lower),
    ("match_error", "Position error", "cm", Better::Lower),
    ("match_seams", "Jumps", "/min", Better::Lower),
    ("match_tick_ms", "Time per tick", "ms", Better::Neutral),
    ("match_turn", "Time to turn", "s", Better::Lower),
    ("match_visited", "Frames searched", "frames", Better::Neutral),
    ("match_worst_error", "Largest position error", "cm", Better::Lower),
    ("off_arms_deg", "Arm deviation", "°", Better::Neutral),
    ("off_head_deg", "Head deviation", "°", Better::Neutral),
    ("off_legs_deg", "Leg deviation", "°", Better::Neutral),
    ("off_spine_deg", "Spine deviation", "°", Better::Neutral),
    ("path_m", "Path length", "m", Better::Neutral),
    ("path_original_m", "Original path length", "m", Better::Neutral),
    ("penetration_cm", "Penetration", "cm", Better::Lower),
    ("pose_jump_deg", "Pose jump", "°", Better::Lower),
    ("root_way_m", "Distance travelled", "m", Better::Neutral),
    ("root_way_mps", "Mean speed", "m/s", Better::Neutral),
    ("root_way_turn_deg", "Total turn", "°", Better::Neutral),
    ("seams_per_min", "Transitions", "/min", Better::Neutral),
    ("skating_cmps", "Foot skating", "cm/s", Better::Lower),
    ("speed_mps", "Speed", "m/s", Better::Neutral),
    ("spin_deg", "Spin", "°", Better::Lower),
    ("spins", "Spins", "", Better::Lower),
    ("stride_m", "Stride", "m", Better::Neutral),
    ("variety", "Variety", "%", Better::Higher),
    ("velocity_jump_dps", "Velocity jump", "°/s", Better::Lower),
    ("weight_percent", "Weight of B", "%", Better::Neutral),
];

#[test]
fn metrics_have_their_published_names_units_and_directions() {
    let mut rows: Vec<_> = METRICS
        .iter()
        .filter(|row| row.id != MetricId::BuildTime)
        .map(|row| (row.name, row.label, row.unit.text(), row.better))
        .collect();
    rows.sort_by_key(|row| row.0);
    assert_eq!(rows, PUBLISHED);
}

#[test]
fn row_of_each_metric_is_its_own_and_has_all_texts() {
    for row in METRICS {
        assert_eq!(row.id.row(), row);
        for text in [row.name, row.label, row.short, row.help, row.good] {
            assert!(!text.trim().is_empty(), "{row:?}");
        }
        assert!(row.help.ends_with('.') && row.good.ends_with('.'), "{row:?}");
        assert_eq!(row.noticeable.is_some(), row.better != Better::Neutral, "{row:?}");
        assert!(row.noticeable.is_none_or(|least| least > 0.0), "{row:?}");
        // One name: the short one has words of the long one alone.
        let lower = row.label.to_lowercase();
        assert!(
            row.short.to_lowercase().split(' ').all(|word| lower.split(' ').any(|w| w == word)),
            "{row:?}"
        );
    }
    let names: BTreeSet<&str> = METRICS.iter().map(|row| row.name).collect();
    assert_eq!(names.len(), METRICS.len());
}

#[test]
fn ends_are_marked_only_where_a_viewer_sees_the_difference() {
    let ends = |id: MetricId, values: &[f64]| {
        let found = id.row().ends(&values.iter().copied().map(Some).collect::<Vec<_>>());
        (found.best, found.worst)
    };
    let slide = MetricId::FootSlide;
    assert_eq!(ends(slide, &[0.4, 0.0]), (None, None), "less than 1 cm");
    assert_eq!(ends(slide, &[3.0, 2.0]), (Some(1), Some(0)));
    // Two equally good values have no best, beside a third that is the worst.
    assert_eq!(ends(slide, &[0.0, 0.3, 12.0]), (None, Some(2)));
    assert_eq!(ends(slide, &[0.0, 11.7, 12.0]), (Some(0), None));
    assert_eq!(ends(slide, &[0.0, 0.6, 1.2]), (None, None), "neighbours look alike");
    assert_eq!(ends(slide, &[5.0]), (None, None));
    assert_eq!(ends(MetricId::Variety, &[52.0, 31.0]), (Some(0), Some(1)), "more is better");
    assert_eq!(ends(MetricId::Speed, &[1.0, 9.0]), (None, None), "it only describes");
    // Panes without a value are left out.
    let found = slide.row().ends(&[None, Some(9.0), None, Some(1.0)]);
    assert_eq!(found, Ends { best: Some(3), worst: Some(1) });
    assert_eq!(slide.row().ends(&[None, None]), Ends::default());
}
