//! The rows of the table of metrics.

use super::{Better, MetricRow, Unit};

macro_rules! metrics {
    ($($id:ident $name:literal $label:literal, $short:expr, $unit:ident, $better:ident, $help:literal;)*) => {
        /// The name of a metric inside the program; its row is [`MetricId::row`].
        #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
        #[expect(missing_docs, reason = "the help sentence of the row says it")]
        pub enum MetricId { $($id),* }

        /// Every metric, in the order on the stage: first those of every lab. A narrow pane has
        /// room for these and two more.
        pub static METRICS: &[MetricRow] = &[$(MetricRow {
            id: MetricId::$id,
            name: $name,
            label: $label,
            short: $short,
            unit: Unit::$unit,
            better: Better::$better,
            help: $help,
        }),*];
    };
}

metrics! {
    PoseJump "pose_jump_deg" "Pose jump", Some("pose jump"), Degrees, Lower,
        "How far a joint turns in one frame, beyond the most that it does in the clips: the worst. Of a clip by itself, beyond all but one in a hundred of its frames.";
    VelocityJump "velocity_jump_dps" "Velocity jump", Some("velocity jump °/s"), DegreesPerSec, Lower,
        "How much a joint's angular velocity changes within 1/30 s, beyond the most that it does in the clips: the worst. Of a clip by itself, beyond all but one in a hundred of its frames.";
    Spin "spin_deg" "Spin", Some("spin"), Degrees, Lower,
        "How far the character turns within 0.2 s at most, beyond the most that it does in the clips. Of a clip by itself, beyond what it does three quarters of the time.";
    Skating "skating_cmps" "Skating", Some("skating cm/s"), CentimetresPerSec, Lower,
        "How fast the feet move over the ground while they are within 2.5 cm of it, the more the lower: the mean of all frames, for a body of 1.7 m.";
    FootSlide "foot_slide_cm" "Foot slide", Some("slide cm"), Centimetres, Lower,
        "How far a planted foot slides in the worst stance.";
    FootSlideBefore "foot_slide_before_cm" "Foot slide before the lock", Some("unlocked cm"), Centimetres, Neutral,
        "How far a planted foot slides in the worst stance without the foot lock.";
    FootSlideOriginal "foot_slide_original_cm" "Foot slide of the original", Some("original cm"), Centimetres, Neutral,
        "How far a planted foot slides in the worst stance before the path was edited.";
    Spins "spins" "Spins", Some("spins"), Count, Lower,
        "Transitions in which the character turns by more than 30° in 0.2 s and neither clip does.";
    Flashes "flashes" "Flashes", Some("flashes"), Count, Lower,
        "Transitions in which the root or a joint jumps more than twice as far as in all but one in a thousand frames of the clips.";
    SeamsPerMinute "seams_per_min" "Seams", Some("seams / min"), PerMinute, Neutral,
        "How many transitions a minute of the walk has.";
    Lag "lag_s" "Lag", Some("lag s"), Secs, Lower,
        "The time until the velocity over the ground has changed by 90 % to that of the incoming clip; the median of several transitions.";
    Variety "variety" "Variety", Some("variety %"), Percent, Higher,
        "How much of the clips the walk has shown.";
    Speed "speed_mps" "Speed", Some("m/s"), MetresPerSec, Neutral,
        "The distance travelled over the ground, divided by the time, measured on the result.";
    Stride "stride_m" "Stride", Some("stride m"), Metres, Neutral,
        "The distance travelled in one cycle, which is two steps.";
    Cadence "cadence_spm" "Cadence", Some("steps/min"), StepsPerMinute, Neutral,
        "Steps per minute.";
    WeightOfB "weight_percent" "Weight of B", Some("B %"), Percent, Neutral,
        "The share of B in the pose: 0 at the speed of A, 100 at that of B. Other values extrapolate both clips.";
    PositionError "match_error" "position error", Some("error cm"), Centimetres, Lower,
        "Mean distance of the character from where the player steers it: the simulation object.";
    JumpsPerMinute "match_seams" "seams per minute", Some("jumps/min"), PerMinute, Lower,
        "How often the character jumps from one place of the clips to another.";
    FramesVisited "match_visited" "frames visited", Some("visited"), Frames, Neutral,
        "How many frames a search looked at, on average.";
    TickTime "match_tick_ms" "time per tick", Some("ms/tick"), Millisecs, Neutral,
        "The time to compute a sixtieth of a second of all characters, searches included.";
    TurnTime "match_turn" "time to turn", Some("turn s"), Secs, Lower,
        "The longest time from asking for a turn until the body faces within 20° of it and stays there.";
    LargestPositionError "match_worst_error" "largest position error", Some("largest error cm"), Centimetres, Lower,
        "The largest distance of the character from where the player steers it.";
    LoopSeam "loop_seam_deg" "Seam", Some("seam"), Degrees, Lower,
        "The largest angle of a joint between the end of the cycle and its beginning.";
    LoopVelocitySeam "loop_seam_dps" "Velocity seam", Some("seam °/s"), DegreesPerSec, Lower,
        "The largest difference of a joint's angular velocity between the end of the cycle and its beginning.";
    FrameDistance "apart_cm" "Distance", Some("distance cm"), Centimetres, Lower,
        "The mean distance of the frames that are blended: root mean square per joint, after the best alignment.";
    FitError "fit_rms_cm" "Fit error", Some("fit error cm"), Centimetres, Neutral,
        "The root mean square distance of the hips from the fitted path. The edited motion keeps it.";
    LargestFitError "fit_most_cm" "Largest fit error", Some("largest fit error cm"), Centimetres, Neutral,
        "The largest distance of the hips from the fitted path.";
    PathLength "path_m" "Length of the path", Some("length m"), Metres, Neutral,
        "The edited path from its start to its end.";
    OriginalPathLength "path_original_m" "Length of the original path", Some("original m"), Metres, Neutral,
        "The fitted path from its start to its end.";
    HardTurns "hard_turns" "Hard turns", Some("hard turns"), Bends, Lower,
        "Places where curvature times speed is beyond what the original does.";
    ArmsOffA "off_arms_deg" "Arms off A", Some("arms off A"), Degrees, Neutral,
        "How far the joints of the arms are turned from A's, against their parents: the mean over joints and frames.";
    SpineOffA "off_spine_deg" "Spine off A", Some("spine"), Degrees, Neutral,
        "How far the joints of the spine are turned from A's, against their parents: the mean over joints and frames.";
    HeadOffA "off_head_deg" "Head off A", Some("head"), Degrees, Neutral,
        "How far neck and head are turned from A's, against their parents: the mean over joints and frames.";
    LegsOffA "off_legs_deg" "Legs off A", Some("legs"), Degrees, Neutral,
        "How far hips and legs are turned from A's, against their parents: the mean over joints and frames.";
    Penetration "penetration_cm" "Penetration", Some("penetration cm"), Centimetres, Lower,
        "How deep the lowest point of the body is below the ground during the transition.";
    ClipPenetration "clip_penetration_cm" "Deepest point", Some("penetration cm"), Centimetres, Lower,
        "How deep the lowest point of the body is below the ground.";
    ClipPositionJump "clip_jump_cm" "Largest position jump", Some("position jump cm"), Centimetres, Lower,
        "How far the character moves over the ground in one frame, beyond all but one in a hundred frames of the clip: the worst.";
    BareSeam "loop_before_deg" "Seam of the bare cut", Some("bare seam"), Degrees, Neutral,
        "The seam without any correction: the angle that the method had to close.";
    CycleTime "cycle_s" "Cycle", Some("cycle s"), Secs, Neutral,
        "How long one cycle takes.";
    CycleFrames "cycle_frames" "Cycle", Some("frames"), Frames, Neutral,
        "The length of one cycle in frames of A.";
    CycleLength "cycle_m" "Distance per cycle", Some("travelled m"), Metres, Neutral,
        "The distance travelled in one cycle.";
    CycleTurn "cycle_turn_deg" "Turn per cycle", Some("turn"), Degrees, Neutral,
        "The turn of one cycle, to the left: the loop follows this curve.";
    Distance "root_way_m" "Distance travelled", Some("travelled m"), Metres, Neutral,
        "The distance that the body travels over the ground: what is removed, or rebuilt.";
    MeanSpeed "root_way_mps" "Mean speed", Some("m/s"), MetresPerSec, Neutral,
        "The distance travelled, divided by its duration.";
    TotalTurn "root_way_turn_deg" "Total turn", Some("turn"), Degrees, Neutral,
        "How far the body turns over the clip, to the left.";
    ClipLength "clip_s" "Length", Some("length s"), Secs, Neutral,
        "How long the clip lasts, from its first frame to its last.";
    ClipFrames "clip_frames" "Frames", Some("frames"), Frames, Neutral,
        "The number of frames of the clip.";
    PositionJump "jump_cm" "Position jump", None, Centimetres, Lower,
        "How far the character moves over the ground in one frame at the transition, beyond its usual step.";
    FootSlideInPlace "foot_slide_in_place_cm" "Foot slide in place", None, Centimetres, Neutral,
        "How far a planted foot moves in the worst stance without root motion.";
    BuildTime "graph_build_s" "Build time", None, Secs, Neutral,
        "The time to compare the clips, unless that was done before, and to build the graph, on this machine.";
}
