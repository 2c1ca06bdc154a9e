//! Names, units and directions of metrics never change: scripts and tables of users have them.

use super::{Better, METRICS, MetricId};
use std::collections::BTreeSet;

/// The metrics of results, by their names in the page's API.
const PUBLISHED: [(&str, &str, &str, Better); 49] = [
    ("apart_cm", "Distance", "cm", Better::Lower),
    ("cadence_spm", "Cadence", "steps/min", Better::Neutral),
    ("clip_frames", "Frames", "frames", Better::Neutral),
    ("clip_jump_cm", "Largest position jump", "cm", Better::Lower),
    ("clip_penetration_cm", "Deepest point", "cm", Better::Lower),
    ("clip_s", "Length", "s", Better::Neutral),
    ("cycle_frames", "Cycle", "frames", Better::Neutral),
    ("cycle_m", "Distance per cycle", "m", Better::Neutral),
    ("cycle_s", "Cycle", "s", Better::Neutral),
    ("cycle_turn_deg", "Turn per cycle", "°", Better::Neutral),
    ("fit_most_cm", "Largest fit error", "cm", Better::Neutral),
    ("fit_rms_cm", "Fit error", "cm", Better::Neutral),
    ("flashes", "Flashes", "", Better::Lower),
    ("foot_slide_before_cm", "Foot slide before the lock", "cm", Better::Neutral),
    ("foot_slide_cm", "Foot slide", "cm", Better::Lower),
    ("foot_slide_in_place_cm", "Foot slide in place", "cm", Better::Neutral),
    ("foot_slide_original_cm", "Foot slide of the original", "cm", Better::Neutral),
    ("hard_turns", "Hard turns", "bends", Better::Lower),
    ("jump_cm", "Position jump", "cm", Better::Lower),
    ("lag_s", "Lag", "s", Better::Lower),
    ("loop_before_deg", "Seam of the bare cut", "°", Better::Neutral),
    ("loop_seam_deg", "Seam", "°", Better::Lower),
    ("loop_seam_dps", "Velocity seam", "°/s", Better::Lower),
    ("match_error", "position error", "cm", Better::Lower),
    ("match_seams", "seams per minute", "/min", Better::Lower),
    ("match_tick_ms", "time per tick", "ms", Better::Neutral),
    ("match_turn", "time to turn", "s", Better::Lower),
    ("match_visited", "frames visited", "frames", Better::Neutral),
    ("match_worst_error", "largest position error", "cm", Better::Lower),
    ("off_arms_deg", "Arms off A", "°", Better::Neutral),
    ("off_head_deg", "Head off A", "°", Better::Neutral),
    ("off_legs_deg", "Legs off A", "°", Better::Neutral),
    ("off_spine_deg", "Spine off A", "°", Better::Neutral),
    ("path_m", "Length of the path", "m", Better::Neutral),
    ("path_original_m", "Length of the original path", "m", Better::Neutral),
    ("penetration_cm", "Penetration", "cm", Better::Lower),
    ("pose_jump_deg", "Pose jump", "°", Better::Lower),
    ("root_way_m", "Distance travelled", "m", Better::Neutral),
    ("root_way_mps", "Mean speed", "m/s", Better::Neutral),
    ("root_way_turn_deg", "Total turn", "°", Better::Neutral),
    ("seams_per_min", "Seams", "/min", Better::Neutral),
    ("skating_cmps", "Skating", "cm/s", Better::Lower),
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
        for text in [row.name, row.label, row.short.unwrap_or("-"), row.help] {
            assert!(!text.trim().is_empty(), "{row:?}");
        }
        assert!(row.help.ends_with('.'), "{row:?}");
    }
    let names: BTreeSet<&str> = METRICS.iter().map(|row| row.name).collect();
    assert_eq!(names.len(), METRICS.len());
}
