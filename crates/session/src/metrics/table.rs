//! The rows of the table of metrics.

use super::{Better, MetricRow, Unit};

macro_rules! metrics {
    ($($id:ident $name:literal $label:literal $(or $short:literal)?, $unit:ident,
        $better:ident $(by $noticeable:literal)?, $help:literal, $good:literal;)*) => {
        /// The name of a metric inside the program; its row is [`MetricId::row`].
        #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, serde::Serialize, serde::Deserialize)]
        #[expect(missing_docs, reason = "the help sentence of the row says it")]
        pub enum MetricId { $($id),* }

        /// Every metric, in the order on screen: those that a lab is about, the artefacts of every
        /// lab, details. Where there is little room the first ones are shown.
        pub static METRICS: &[MetricRow] = &[$(MetricRow {
            id: MetricId::$id,
            name: $name,
            label: $label,
            short: first(&[$($short,)? $label]),
            unit: Unit::$unit,
            better: Better::$better,
            noticeable: optional(&[$($noticeable)?]),
            help: $help,
            good: $good,
        }),*];
    };
}

/// Returns the first of some texts, of which there is at least one.
const fn first(texts: &[&'static str]) -> &'static str {
    texts[0]
}

/// Returns the number of a row, if it has one.
const fn optional(numbers: &[f64]) -> Option<f64> {
    if numbers.is_empty() { None } else { Some(numbers[0]) }
}

// The least difference that makes one value better than another stands behind `by`: what a viewer
// can see, rounded down so that no visible difference is left unmarked. Its measure is a
// displacement of 1 cm on a body of 1.7 m, half of the 2.1 cm from which on most viewers see a foot
// slide (Pražák, Hoyet, O'Sullivan, "Perceptual evaluation of footskate cleanup", SCA 2011). For
// angles it is the angle that displaces a part of the body by as much, for velocities 5 % of those
// of a walk (McKee, "A local mechanism for differential velocity detection", Vision Research 1981),
// for delays half of what players of games notice (Claypool, Claypool, "Latency and player actions
// in online games", CACM 2006). Where these do not tell, the comment says why.
metrics! {
    // Numbers of single labs.

    // One spin more is visible.
    Spins "spins" "Spins", Count, Lower by 1.0,
        "Transitions in which the character turns by more than 30° in 0.2 s and neither clip does.",
        "0 is best: every spin is seen as a fault.";
    // One flash more is visible.
    Flashes "flashes" "Flashes", Count, Lower by 1.0,
        "Transitions in which the root or a joint jumps more than twice as far as in all but one in a thousand frames of the clips.",
        "0 is best: every flash is a visible jump. A lower threshold of the graph gives fewer.";
    // A twentieth of the clips.
    Variety "variety" "Variety", Percent, Higher by 5.0,
        "How much of the clips the walk has shown.",
        "Higher is better: at 100 % every frame of the clips was shown.";
    Speed "speed_mps" "Speed", MetresPerSec, Neutral,
        "The distance travelled over the ground, divided by the time, measured on the result.",
        "It should be the speed that is set. A walk has about 1.4 m/s, a run 2.5 to 5 m/s.";
    ClipLength "clip_s" "Length", Secs, Neutral,
        "How long the clip lasts, from its first frame to its last.",
        "Neither is better: it is the length of what was kept of the clip.";
    ClipFrames "clip_frames" "Frames", Frames, Neutral,
        "The number of frames of the clip.",
        "Neither is better: it is the length times the frame rate.";
    Stride "stride_m" "Stride", Metres, Neutral,
        "The distance travelled in one cycle, which is two steps.",
        "A walk has about 1.4 m, a run 2 m and more.";
    Cadence "cadence_spm" "Cadence", StepsPerMinute, Neutral,
        "Steps per minute.",
        "A walk has 100 to 120 steps per minute, a run 150 to 180.";
    WeightOfB "weight_percent" "Weight of B", Percent, Neutral,
        "The share of B in the pose: 0 at the speed of A, 100 at that of B. Other values extrapolate both clips.",
        "From 0 to 100 % the pose lies between both clips. Beyond, joints may bend unnaturally.";
    // As for the pose jump: a seam is one, in every cycle.
    LoopSeam "loop_seam_deg" "Seam", Degrees, Lower by 1.0,
        "The largest angle of a joint between the end of the cycle and its beginning.",
        "0 is best: the loop closes. A few degrees are seen as a pop in every cycle.";
    // As for the velocity jump: a seam is one, in every cycle.
    LoopVelocitySeam "loop_seam_dps" "Velocity seam", DegreesPerSec, Lower by 5.0,
        "The largest difference of a joint's angular velocity between the end of the cycle and its beginning.",
        "0 is best: no joint changes its velocity where the loop closes.";
    GapBeforeClosing "loop_before_deg" "Gap before closing" or "Gap", Degrees, Neutral,
        "The seam without any correction: the angle that the method had to close.",
        "The smaller it is, the less the motion is changed. Above about 30°, choose other ends.";
    // A displacement of 1 cm, as for a sliding foot.
    FrameDistance "apart_cm" "Pose distance", Centimetres, Lower by 1.0,
        "The mean distance of the frames that are blended: root mean square per joint, after the best alignment.",
        "Lower is better. Up to about 10 cm poses blend well; beyond 20 cm limbs cross and feet slide.";
    // A tenth of the shoulder width: less cannot be seen.
    PositionError "match_error" "Position error", Centimetres, Lower by 5.0,
        "Mean distance of the character from where the player steers it: the simulation object.",
        "Lower is better: the character is where the input wants it. Up to 10 cm feels direct.";
    // A tenth of the shoulder width, as for the mean position error.
    LargestPositionError "match_worst_error" "Largest position error" or "Largest error", Centimetres, Lower by 5.0,
        "The largest distance of the character from where the player steers it.",
        "Lower is better. It never exceeds the largest deviation that is set.";
    // The lag that players notice; the end of a turn is not sharper than that.
    TurnTime "match_turn" "Time to turn", Secs, Lower by 0.1,
        "The longest time from asking for a turn until the body faces within 20° of it and stays there.",
        "Lower responds faster. A walking person takes about 1 s to turn round.";
    // One more jump in the half minute of a recorded input.
    JumpsPerMinute "match_seams" "Jumps", PerMinute, Lower by 2.0,
        "How often the character jumps from one place of the clips to another.",
        "Fewer jumps look calmer; without any, the character cannot follow its input.";
    // One hard turn more is visible.
    HardTurns "hard_turns" "Hard turns", Bends, Lower by 1.0,
        "Places where curvature times speed is beyond what the original does.",
        "0 is best. Widen the bend or slow down where the path turns too hard.";
    // One fault more is visible.
    FaultsLeft "faults_left" "Faults", Count, Lower by 1.0,
        "The number of certain faults that were found and not mended.",
        "0 is best. What is left is in the list of faults.";
    FaultsMended "faults_mended" "Mends", Count, Neutral,
        "The number of faults that were mended.",
        "Neither is better: fewer mends leave more of the recording as it is.";
    Distance "root_way_m" "Distance travelled" or "Distance", Metres, Neutral,
        "The distance that the body travels over the ground: what is removed, or rebuilt.",
        "A rebuilt distance should be that of the recording.";
    MeanSpeed "root_way_mps" "Mean speed", MetresPerSec, Neutral,
        "The distance travelled, divided by its duration.",
        "A walk has about 1.4 m/s, a run 2.5 to 5 m/s.";
    TotalTurn "root_way_turn_deg" "Total turn", Degrees, Neutral,
        "How far the body turns over the clip, to the left.",
        "0° ends in the direction of the beginning; 360° is a full circle.";
    ArmsOffA "off_arms_deg" "Arm deviation", Degrees, Neutral,
        "How far the joints of the arms are turned from A's, against their parents: the mean over joints and frames.",
        "0 leaves A's arms as they are; larger shows more of the layer.";
    SpineOffA "off_spine_deg" "Spine deviation", Degrees, Neutral,
        "How far the joints of the spine are turned from A's, against their parents: the mean over joints and frames.",
        "0 leaves A's spine as it is; larger shows more of the layer.";
    HeadOffA "off_head_deg" "Head deviation", Degrees, Neutral,
        "How far neck and head are turned from A's, against their parents: the mean over joints and frames.",
        "0 leaves A's head as it is; larger shows more of the layer.";
    LegsOffA "off_legs_deg" "Leg deviation", Degrees, Neutral,
        "How far hips and legs are turned from A's, against their parents: the mean over joints and frames.",
        "0 leaves A's legs as they are; larger shows more of the layer.";

    // The artefacts of every lab, and of transitions.

    // The limbs of a walk turn by 100 to 200°/s, and speeds are told apart from 5 % on (McKee).
    VelocityJump "velocity_jump_dps" "Velocity jump", DegreesPerSec, Lower by 5.0,
        "How much a joint's angular velocity changes within 1/30 s, beyond the most that it does in the clips: the worst. Of a clip by itself, beyond all but one in a hundred of its frames.",
        "0 is best: nothing speeds up or slows down faster than in the clips. From about 100°/s on it is seen as a jolt.";
    // Three frames of a display, and half of the 0.1 s that players notice (Claypool, Claypool).
    Lag "lag_s" "Lag", Secs, Lower by 0.05,
        "The time until the velocity over the ground has changed by 90 % to that of the incoming clip; the median of several transitions.",
        "Lower responds faster, and jolts more: weigh it against the velocity jump. Below 0.1 s it feels immediate.";
    // Half of the 2.1 cm that most viewers see.
    FootSlide "foot_slide_cm" "Foot slide", Centimetres, Lower by 1.0,
        "How far a planted foot slides in the worst stance.",
        "Lower is better. Most viewers see a slide of 2 cm.";
    FootSlideBefore "foot_slide_before_cm" "Foot slide before lock" or "Slide before lock", Centimetres, Neutral,
        "How far a planted foot slides in the worst stance without the foot lock.",
        "Compare it with the foot slide: the difference is what the foot lock takes away.";
    FootSlideOriginal "foot_slide_original_cm" "Original foot slide" or "Original slide", Centimetres, Neutral,
        "How far a planted foot slides in the worst stance before the path was edited.",
        "Compare it with the foot slide: the difference is what the edited path adds.";
    // At the end of a leg, 0.9 m from the hip, 1° is 1.6 cm.
    PoseJump "pose_jump_deg" "Pose jump", Degrees, Lower by 1.0,
        "How far a joint turns in one frame, beyond the most that it does in the clips: the worst. Of a clip by itself, beyond all but one in a hundred of its frames.",
        "0 is best: no joint moves farther in a frame than in the clips. From about 5° on it is seen as a pop.";
    // A foot that slides by 1 cm in each stance, at 60 % of the time on the ground.
    Skating "skating_cmps" "Foot skating", CentimetresPerSec, Lower by 1.0,
        "How fast the feet move over the ground while they are within 2.5 cm of it, the more the lower: the mean of all frames, for a body of 1.7 m.",
        "Lower is better. A recorded walk has a few cm/s, because feet roll: compare with the clips.";
    // The shoulders, 20 cm from the axis, move by 1 cm.
    Spin "spin_deg" "Spin", Degrees, Lower by 3.0,
        "How far the character turns within 0.2 s at most, beyond the most that it does in the clips. Of a clip by itself, beyond what it does three quarters of the time.",
        "0 is best: the character turns no faster than in the clips. A wrong alignment gives 90° and more.";
    // A displacement of 1 cm, as for a sliding foot.
    Penetration "penetration_cm" "Penetration", Centimetres, Lower by 1.0,
        "How deep the lowest point of the body is below the ground during the transition.",
        "0 is best. Less than 1 cm is not seen.";
    // A displacement of 1 cm, as for a sliding foot.
    ClipPenetration "clip_penetration_cm" "Penetration", Centimetres, Lower by 1.0,
        "How deep the lowest point of the body is below the ground.",
        "0 is best. Less than 1 cm is not seen.";
    // A displacement of 1 cm, as for a sliding foot: the feet move with the body.
    PositionJump "jump_cm" "Position jump", Centimetres, Lower by 1.0,
        "How far the character moves over the ground in one frame at the transition, beyond its usual step.",
        "0 is best: the character goes on with its usual step. From about 2 cm on the body is seen to jump.";
    // A displacement of 1 cm, as for a sliding foot: the feet move with the body.
    ClipPositionJump "clip_jump_cm" "Position jump", Centimetres, Lower by 1.0,
        "How far the character moves over the ground in one frame, beyond all but one in a hundred frames of the clip: the worst.",
        "0 is best: all steps are alike. From about 2 cm on the body is seen to jump.";

    // Details.

    FootSlideInPlace "foot_slide_in_place_cm" "Foot slide in place" or "Slide in place", Centimetres, Neutral,
        "How far a planted foot moves in the worst stance without root motion.",
        "It is no fault: without root motion a planted foot moves as on a treadmill.";
    SeamsPerMinute "seams_per_min" "Transitions", PerMinute, Neutral,
        "How many transitions a minute of the walk has.",
        "Neither is better: more of them vary the walk, fewer show longer parts of the clips.";
    CycleTime "cycle_s" "Cycle time", Secs, Neutral,
        "How long one cycle takes.",
        "A cycle of a walk takes 1.0 to 1.2 s, one of a run about 0.7 s.";
    CycleFrames "cycle_frames" "Cycle length", Frames, Neutral,
        "The length of one cycle in frames of A.",
        "It is the cycle time in frames.";
    CycleLength "cycle_m" "Cycle distance", Metres, Neutral,
        "The distance travelled in one cycle.",
        "Of a walk or a run it is the stride: about 1.4 m, or 2 m and more.";
    CycleTurn "cycle_turn_deg" "Turn per cycle", Degrees, Neutral,
        "The turn of one cycle, to the left: the loop follows this curve.",
        "0° goes straight ahead. 360° divided by it is the number of cycles in a circle.";
    PathLength "path_m" "Path length", Metres, Neutral,
        "The edited path from its start to its end.",
        "Compare it with the original path: a longer one is walked faster, or takes more time.";
    OriginalPathLength "path_original_m" "Original path length" or "Original length", Metres, Neutral,
        "The fitted path from its start to its end.",
        "It is what the edited path is compared with.";
    FitError "fit_rms_cm" "Fit error", Centimetres, Neutral,
        "The root mean square distance of the hips from the fitted path. The edited motion keeps it.",
        "It is the sway of the hips around their path. More control points make it smaller.";
    LargestFitError "fit_most_cm" "Largest fit error", Centimetres, Neutral,
        "The largest distance of the hips from the fitted path.",
        "It is the largest sway of the hips around their path. More control points make it smaller.";
    FramesVisited "match_visited" "Frames searched", Frames, Neutral,
        "How many frames a search looked at, on average.",
        "Fewer make the search faster; the frame that it finds is the same.";
    TickTime "match_tick_ms" "Time per tick", Millisecs, Neutral,
        "The time to compute a sixtieth of a second of all characters, searches included.",
        "A frame of the display has 16.7 ms for this and for the drawing.";
    BuildTime "graph_build_s" "Build time", Secs, Neutral,
        "The time to compare the clips, unless that was done before, and to build the graph, on this machine.",
        "It is spent once: walks with other seeds use the same graph.";
}
