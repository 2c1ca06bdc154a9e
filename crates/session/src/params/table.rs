//! The rows of the table of parameters.

use super::grammar::ListKind;
use super::param::{Group, Kind, Mark, Param, Start};
use crate::choices::{
    AlignBy, Atan, Backdrop, Camera, Construction, Curve, EdgeWeight, Ends, Follow, GoingOn,
    Hysteresis, JumpMethod, LabId, LayerFit, LayerMode, LayerReference, Look, LoopMethod,
    MadeAction, Mask, MatchBy, Mistake, Normalisation, PageLanguage, PageTheme, PathFacing,
    PathKeep, PathOffset, PathSpline, RootMotion, RootWay, Scenario, SearchBy, Skinning, Transform,
    TransitionMethod, WalkMethod, WarpMode, WarpWith, WeightLaw,
};

/// Labs that a row names behind `in`.
macro_rules! labs {
    () => { &[] };
    ([$($lab:ident),*]) => { &[$(LabId::$lab),*] };
    ($labs:ident) => { $labs };
}

macro_rules! parameters {
    ($($key:ident $name:literal $label:literal $group:ident$(($lab:ident))?, $kind:expr, $default:expr, $unit:literal, $help:literal $([$($mark:ident),*])? $(in $labs:tt)?;)*) => {
        /// The name of a parameter inside the program; its row is [`Key::param`].
        #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
        #[expect(missing_docs, reason = "the help sentence of the row says it")]
        pub enum Key { $($key),* }

        /// Every parameter, in the order in which links and panels show them.
        pub static PARAMS: &[Param] = &[$(Param {
            key: Key::$key, name: $name, label: $label, kind: $kind, unit: $unit, group: Group::$group$((LabId::$lab))?, help: $help, marks: &[$($(Mark::$mark),*)?], shared_with: labs!($($labs)?), default: $default,
        }),*];
    };
}

const fn number(min: f64, max: f64, step: f64) -> Kind {
    Kind::Number { min, max, step, auto: false, logarithmic: false }
}
const fn auto(min: f64, max: f64, step: f64) -> Kind {
    Kind::Number { min, max, step, auto: true, logarithmic: false }
}
const fn logarithmic(min: f64, max: f64, step: f64) -> Kind {
    Kind::Number { min, max, step, auto: false, logarithmic: true }
}

/// The labs that make a result of the clip in A.
const OF_A: &[LabId] = &[
    LabId::View,
    LabId::Blend,
    LabId::Transition,
    LabId::Speed,
    LabId::Loop,
    LabId::Layers,
    LabId::Register,
    LabId::Path,
    LabId::InPlace,
];
/// The labs that make a result of the clip in B.
const OF_B: &[LabId] =
    &[LabId::Blend, LabId::Transition, LabId::Speed, LabId::Layers, LabId::Register];
/// The labs that read the feet of their clips, and can hold them.
const OF_FEET: &[LabId] = &[
    LabId::View,
    LabId::Make,
    LabId::Transition,
    LabId::Speed,
    LabId::Loop,
    LabId::Layers,
    LabId::Register,
    LabId::Path,
    LabId::Graph,
    LabId::InPlace,
];

// Key, name in the link, label, group, values, default, unit, help; [marks] and `in` the labs that
// share it, where there are any.
parameters! {
    Lab "lab" "Lab" Page, Kind::Choice(LabId::CHOICES), Start::Choice(LabId::Blend.word()), "", "Which experiment is open." [State];
    A "a" "A" Page, Kind::Clip, Start::Text("walk"), "", "The clip that plays first." [State] in OF_A;
    B "b" "B" Page, Kind::Clip, Start::Text("run"), "", "The clip that follows." [State] in OF_B;

    BlendWindow "blend_window" "Blend window" Lab(Blend), number(1.0, 240.0, 1.0), Start::Number(30.0), "frames", "How long A fades into B. Long drags, short bursts." [InSeconds] in [Transition, Graph];
    LeaveA "leave_a" "Leave A at" Lab(Blend), auto(0.0, 600.0, 0.001), Start::Auto, "s", "Where the blend window begins in A. Left to Segue: the best match in A's second half." [PlaceInA] in [Transition];
    EnterB "enter_b" "Enter B at" Lab(Blend), auto(0.0, 600.0, 0.001), Start::Auto, "s", "Where the blend window begins in B. Left to Segue: the best match in B's first half." [PlaceInB] in [Transition];
    WeightLaw "weight_law" "Weight law" Lab(Blend), Kind::Choice(WeightLaw::CHOICES), Start::Choice(WeightLaw::Smooth.word()), "", "How the weight moves from A to B inside the window." in [Transition, Graph, Register];
    Align "align" "Align to A" Lab(Blend), Kind::Switch, Start::Switch(true), "", "Turns and moves B over the ground so that it continues A." in [Transition];
    AlignBy "align_by" "Align by" Lab(Blend), Kind::Choice(AlignBy::CHOICES), Start::Choice(AlignBy::Window.word()), "", "What is laid on what: all joints over the blend window, as well as they fit, or the place and facing of the first posture alone." in [Transition, Graph];
    RootBlend "root_blend" "Blend root by velocity" Lab(Blend), Kind::Switch, Start::Switch(true), "", "Blends how the character moves instead of where it is: its speed does not dent, and feet slide less. Off, B stays where the alignment puts it." in [Transition, Graph];

    FootLock "foot_lock" "Foot lock" Lab(Blend), Kind::Switch, Start::Switch(false), "", "Holds planted feet where they stand, and bends the legs to it." [Feet] in OF_FEET;
    LockBlend "lock_blend" "Lock blend" Lab(Blend), number(0.02, 1.0, 0.01), Start::Number(0.2), "s", "How long a foot takes to reach the place where it is held, and to leave it again. Longer: softer, and more of the swing changes. Shorter: the swing stays as it was, and the foot moves suddenly." [Lock] in OF_FEET;
    LockReach "lock_reach" "Lock reach" Lab(Blend), number(1.0, 100.0, 1.0), Start::Number(30.0), "cm", "How far a foot may be moved to be held, for a body of 1.75 m. Farther: feet that slide a long way are held too, and legs bend more. Nearer: legs stay closer to how they were, and feet slide." [Lock] in OF_FEET;
    LockClearance "lock_clearance" "Swing clearance" Lab(Blend), number(0.0, 10.0, 0.5), Start::Number(2.5), "cm", "How high above where it stands a foot is kept while it swings, for a body of 1.75 m. Higher: low swings are lifted more. 0 leaves swings as they are." [Lock] in OF_FEET;
    Ground "ground" "Ground" Lab(Blend), auto(-100.0, 100.0, 0.5), Start::Auto, "cm", "The height of the ground for foot lock and penetration. Left to Segue: planted feet tell it, and it is 0 unless they stand or dip more than 3 cm elsewhere." [Feet, NoCompare] in OF_FEET;
    ContactHeight "contact_height" "Contact height" Lab(Blend), number(1.0, 15.0, 0.5), Start::Number(4.0), "cm", "A foot is planted below this height above its own lowest level, for a body of 1.75 m. Higher: longer stances." [Feet, NoCompare] in OF_FEET;
    ContactSpeed "contact_speed" "Contact speed" Lab(Blend), number(0.1, 2.0, 0.05), Start::Number(0.4), "m/s", "A foot is planted while it is slower than this. Faster: longer stances, and feet that slide are held too." [Feet, NoCompare] in OF_FEET;

    Method "method" "Method" Lab(Transition), Kind::Choice(TransitionMethod::CHOICES), Start::Choice(TransitionMethod::Inertialize.word()), "", "How A goes over into B.";
    HalfLife "half_life" "Half-life" Lab(Transition), logarithmic(0.02, 1.5, 0.01), Start::Number(0.2), "s", "How slowly the difference from A decays: half of it is left after 1.2 half-lives." in [Loop, Graph];
    BlendTime "blend_time" "Blend time" Lab(Transition), logarithmic(0.05, 2.0, 0.01), Start::Number(0.4), "s", "When nothing of A is left, for cubic, quintic and dead blend. A quintic ends sooner where the difference is small and closes fast: it would overshoot otherwise." in [Match];
    ExtrapolationHalfLife "extrapolation_half_life" "Extrapolation half-life" Lab(Transition), logarithmic(0.02, 1.0, 0.01), Start::Number(0.1), "s", "How long A runs on by itself in a dead blend: half of its velocity is left after this time." in [Match];
    MixFrameA "mix_frame_a" "Leave A at" Lab(Transition), auto(0.0, 1_000_000.0, 1.0), Start::Auto, "frame", "The frame of A at which B takes over. Left to Segue: the best match in A's second half." [PlaceInA];
    MixFrameB "mix_frame_b" "Enter B at" Lab(Transition), auto(0.0, 1_000_000.0, 1.0), Start::Auto, "frame", "The frame of B that plays then. Left to Segue: the best match in B's first half." [PlaceInB];
    MatchBy "match_by" "Match by" Lab(Transition), Kind::Choice(MatchBy::CHOICES), Start::Choice(MatchBy::Pose.word()), "", "What the best match compares: two poses, or windows of the whole body.";
    MatchPosition "match_position" "Weight of positions" Lab(Transition), number(0.0, 1.0, 0.05), Start::Number(0.6), "", "How much it counts where the joints are.";
    MatchRotation "match_rotation" "Weight of rotations" Lab(Transition), number(0.0, 1.0, 0.05), Start::Number(0.4), "", "How much it counts how the joints are turned.";
    MatchVelocity "match_velocity" "Weight of velocities" Lab(Transition), number(0.0, 1.0, 0.05), Start::Number(0.0), "", "How much it counts how fast the joints move.";

    Speed "speed" "Speed" Lab(Speed), auto(0.2, 10.0, 0.05), Start::Auto, "m/s", "How fast it goes. Left to Segue: half way between both clips.";
    PhaseAlign "phase_align" "Align phases" Lab(Speed), Kind::Switch, Start::Switch(true), "", "Lays strikes of the feet on strikes. Without it each clip begins where it begins, and legs cross.";

    LoopFrom "loop_from" "Cycle from" Lab(Loop), auto(0.0, 600.0, 0.001), Start::Auto, "s", "Where the cycle begins in A." [PlaceInA];
    LoopTo "loop_to" "Cycle to" Lab(Loop), auto(0.0, 600.0, 0.001), Start::Auto, "s", "Where in A the cycle is over: the pose that becomes the first one again." [PlaceInA];
    LoopMethod "loop_method" "Method" Lab(Loop), Kind::Choice(LoopMethod::CHOICES), Start::Choice(LoopMethod::Exact.word()), "", "How the difference between the ends is spread over the cycle.";
    LoopRatio "loop_ratio" "Ratio" Lab(Loop), number(0.0, 1.0, 0.05), Start::Number(0.5), "", "How much of the difference the beginning takes; the end takes the rest.";
    Mistake "mistake" "Break it" Lab(Transition), Kind::Choice(Mistake::CHOICES), Start::Choice(Mistake::None.word()), "", "One classic mistake, made on purpose: see what it looks like, and what the numbers say.";

    LayerMode "layer_mode" "Layer" Lab(Layers), Kind::Choice(LayerMode::CHOICES), Start::Choice(LayerMode::Partial.word()), "", "Partial: B takes A's place inside the mask. Additive: what B does beyond its reference is added to A.";
    Mask "mask" "Mask" Lab(Layers), Kind::Choice(Mask::CHOICES), Start::Choice(Mask::Upper.word()), "", "The part of the body that B moves.";
    LayerWeight "layer_weight" "Weight" Lab(Layers), number(0.0, 1.0, 0.01), Start::Number(1.0), "", "How much of B there is inside the mask.";
    Feather "feather" "Feather" Lab(Layers), number(0.0, 6.0, 1.0), Start::Number(2.0), "joints", "Over how many joints the mask fades in, up the spine or along the limb: 0 is a hard edge.";
    LayerReference "layer_reference" "Reference" Lab(Layers), Kind::Choice(LayerReference::CHOICES), Start::Choice(LayerReference::Mean.word()), "", "The pose of B that counts as nothing: what goes beyond it is added to A.";
    LayerFit "layer_fit" "B's time" Lab(Layers), Kind::Choice(LayerFit::CHOICES), Start::Choice(LayerFit::Step.word()), "", "In step: a cycle of B strikes with A's feet. Loop: B starts again at its end. Hold: it stays in its last frame.";
    LayerStart "layer_start" "B begins at" Lab(Layers), number(-10.0, 10.0, 0.01), Start::Number(0.0), "s", "B's time at A's first frame; in step, how far B runs ahead.";
    KeepOrientation "keep_orientation" "Keep B's posture" Lab(Layers), Kind::Switch, Start::Switch(true), "", "B's trunk leans and turns as in B, however A's hips tilt: for partial layers.";
    MaskColors "mask_colors" "Colour by share" Lab(Layers), Kind::Switch, Start::Switch(true), "", "Every limb in the colours of A and B, by its share of each." [LookedAt];

    RootMotion "root_motion" "Root motion" Lab(View), Kind::Choice(RootMotion::CHOICES), Start::Choice(RootMotion::World.word()), "", "Recorded: as it is in the clip. In place: position and facing are removed from every frame. Residual: a smooth path and its direction are removed, and the sway about it stays.";
    PlaceX "place_x" "Starts at x" Lab(View), auto(-100.0, 100.0, 0.01), Start::Auto, "m", "Where the first frame stands, along x; the whole clip is moved along. Left to Segue: where it was recorded.";
    PlaceZ "place_z" "Starts at z" Lab(View), auto(-100.0, 100.0, 0.01), Start::Auto, "m", "Where the first frame stands, along z.";
    PlaceHeading "place_heading" "Starts facing" Lab(View), auto(-180.0, 180.0, 0.5), Start::Auto, "°", "What the first frame faces, 0 along z and 90 along x; the whole clip is turned along.";

    WarpWith "warp_with" "Timewarp" Lab(Register), Kind::Choice(WarpWith::CHOICES), Start::Choice(WarpWith::Registered.word()), "", "Registered: B's time is bent so that like meets like. Plain: both clips run at their own speed, as in a dissolve.";
    WarpMode "warp_mode" "Make" Lab(Register), Kind::Choice(WarpMode::CHOICES), Start::Choice(WarpMode::Blend.word()), "", "Blend: both clips at once, with a weight. Join: A goes over into B.";
    WarpWeight "warp_weight" "Weight of B" Lab(Register), number(0.0, 1.0, 0.01), Start::Number(0.5), "", "0 is A, 1 is B; between them a motion that is in neither clip.";
    WarpAlso "warp_also" "More clips" Lab(Register), Kind::List(ListKind::WeightedClips), Start::Text(""), "", "Further clips in a blend, registered to A like B, each with its weight, as in 0.3:run,0.2:fast_walk. A has what the others leave.";
    WarpCurve "warp_curve" "Weight over time" Lab(Register), Kind::List(ListKind::WeightCurve), Start::Text(""), "", "The weight of B over the blend: per cent of the blend and per cent of B, as in 0-0,50-100,100-0. Empty: the same weight all the time.";
    WarpFrom "warp_from" "Leave A at" Lab(Register), auto(0.0, 600.0, 0.01), Start::Auto, "s", "Where in A a join begins to go over into B." [PlaceInA];
    WarpTo "warp_to" "All B at" Lab(Register), auto(0.0, 600.0, 0.01), Start::Auto, "s", "Where in A, on its own clock, a join is all B." [PlaceInA];
    RegistrationWindow "registration_window" "Window" Lab(Register), number(1.0, 121.0, 1.0), Start::Number(5.0), "frames", "How many frames about each pair are compared. One frame compares poses; more also tell how they move." [InSeconds];
    SlopeLimit "slope_limit" "Slope limit" Lab(Register), number(1.0, 16.0, 1.0), Start::Number(2.0), "steps", "How many steps in a row one clip may go on while the other stands still.";
    Ends "ends" "Ends" Lab(Register), Kind::Choice(Ends::CHOICES), Start::Choice(Ends::Free.word()), "", "Corner: first meets first, last meets last. Free: a clip may begin or end inside the other.";
    EndSlack "end_slack" "Left out at most" Lab(Register), number(0.0, 50.0, 1.0), Start::Number(40.0), "%", "How much of one clip may be left out at each free end.";
    WarpSmoothing "warp_smoothing" "Smoothing" Lab(Register), auto(0.0, 60.0, 1.0), Start::Auto, "frames", "Over how many frames to either side the timewarp and the alignment are smoothed. Left to Segue: a tenth of a second.";
    Pins "pins" "Pins" Lab(Register), Kind::List(ListKind::Pins), Start::Text(""), "", "Pairs of frames of A and B, at A's rate, that must meet, as in 12-30,50-71." [PlaceInA, PlaceInB];

    ControlPoints "control_points" "Control points" Lab(Path), number(4.0, 64.0, 1.0), Start::Number(8.0), "points", "How finely the path follows the way of the hips. Four cannot follow a turn, many follow every sway.";
    PathSmoothing "path_smoothing" "Smoothing" Lab(Path), number(0.0, 5.0, 0.01), Start::Number(0.0), "", "How much a bend counts against the distance from the hips: 0 is least squares alone.";
    PathKeep "keep" "Keep" Lab(Path), Kind::Choice(PathKeep::CHOICES), Start::Choice(PathKeep::Speed.word()), "", "What stays when the path becomes longer or shorter.";
    PathFacing "path_facing" "Body faces" Lab(Path), Kind::Choice(PathFacing::CHOICES), Start::Choice(PathFacing::Path.word()), "", "Whether the body turns where the path turns, or faces as it did before.";
    PathOffset "path_offset" "Sway of the hips" Lab(Path), Kind::Choice(PathOffset::CHOICES), Start::Choice(PathOffset::Path.word()), "", "Whether the way from the path to the hips turns with the path, or stays as it was in the world: then sway to the side becomes a surge where the path has turned.";
    PathSpline "path_spline" "Spline" Lab(Path), Kind::Choice(PathSpline::CHOICES), Start::Choice(PathSpline::Clamped.word()), "", "Clamped: the path begins in the first control point and ends in the last. Uniform: the same path from other control points, beside which it begins and ends.";
    Path "path" "Path" Lab(Path), Kind::List(ListKind::EditedPath), Start::Text(""), "", "The edited path: its control points to 1 cm in a short word. Empty: the path as it was fitted." [PlaceInA];
    PathGrid "path_grid" "Snap to grid" Lab(Path), number(0.0, 2.0, 0.05), Start::Number(0.0), "m", "Width of the grid that moved points snap to; 0 is none." [LookedAt];
    PinStart "pin_start" "Pin the start" Lab(Path), Kind::Switch, Start::Switch(false), "", "Whatever is done to the path, its start stays where it is." [LookedAt];
    PinEnd "pin_end" "Pin the end" Lab(Path), Kind::Switch, Start::Switch(false), "", "Whatever is done to the path, its end stays where it is." [LookedAt];
    Others "others" "Others" Lab(Path), Kind::List(ListKind::ClipIds), Start::Text(""), "", "Clips that play along on the stage, each in a colour of its own: ids, separated by commas." [LookedAt];
    Clips "clips" "Clips" Lab(Graph), Kind::List(ListKind::ClipIds), Start::Text("walk,walk_left,walk_right,slow_walk,fast_walk,start,stop,idle"), "", "The clips of the graph, as in walk,run,idle. Those that move another skeleton than the first are moved onto it.";
    Construction "construction" "Construction" Lab(Graph), Kind::Choice(Construction::CHOICES), Start::Choice(Construction::Minima.word()), "", "Segments: all clips are cut into equal parts. Local minima: one goes over where two windows are more alike than all around.";
    SegmentSize "segment_size" "Segment size" Lab(Graph), number(1.0, 600.0, 1.0), Start::Number(60.0), "frames", "How long each part of a clip is. It must be longer than the blend window." [InSeconds];
    EdgeThreshold "edge_threshold" "Edge threshold" Lab(Graph), number(0.1, 60.0, 0.1), Start::Number(8.0), "cm", "One goes over only between windows that are closer than this: root mean square per joint on a body of 1.75 m.";
    MinJump "min_jump" "Shortest jump" Lab(Graph), number(0.0, 5.0, 0.05), Start::Number(0.5), "s", "Inside of a clip one does not go to what is less than this away.";
    MostWaysOut "most_ways_out" "Ways out at most" Lab(Graph), logarithmic(1.0, 10_000.0, 1.0), Start::Number(64.0), "", "How many transitions may leave one segment: the closest stay. More of them take longer to build and to choose from.";
    EdgeWeight "edge_weight" "Edge weight" Lab(Graph), Kind::Choice(EdgeWeight::CHOICES), Start::Choice(EdgeWeight::Inverse.word()), "", "How the distance of a transition makes it more or less probable.";
    EdgeSigma "edge_sigma" "Width σ" Lab(Graph), logarithmic(0.1, 20.0, 0.1), Start::Number(2.0), "cm", "A transition that is this much farther than the closest one is 2.7 times less probable.";
    Continuity "continuity" "Keep going" Lab(Graph), number(0.0, 1.0, 0.01), Start::Number(0.95), "", "The chance to stay in the clip wherever one could leave it.";
    GoingOn "going_on" "Going on has" Lab(Graph), Kind::Choice(GoingOn::CHOICES), Start::Choice(GoingOn::Share.word()), "", "Share: the same chance to stay everywhere. Constant weight: one weight beside those of the transitions, so that the chance to stay falls with every further way out.";
    ContinuityWeight "continuity_weight" "Weight of going on" Lab(Graph), logarithmic(0.1, 10_000.0, 0.1), Start::Number(1_000.0), "", "What the next segment of the same clip weighs beside the transitions: the higher, the longer a clip is left unbroken.";
    VisitedDiscount "visited_discount" "Worth after a visit" Lab(Graph), number(0.0, 1.0, 0.01), Start::Number(1.0), "", "How much of its chance a place keeps each time it was seen: below 1 the walk looks for what is new.";
    Prune "prune" "Largest component only" Lab(Graph), Kind::Switch, Start::Switch(true), "", "Leaves out all from where there is no way back: no walk comes to an end.";
    WalkMethod "walk_method" "Transitions" Lab(Graph), Kind::Choice(WalkMethod::CHOICES), Start::Choice(WalkMethod::Dissolve.word()), "", "Dissolve: both clips are mixed over the blend window. Inertialize: the difference dies away.";
    Transform "transform" "Transform" Lab(Graph), Kind::Choice(Transform::CHOICES), Start::Choice(Transform::Whole.word()), "", "What is laid onto the walk: the whole clip, or its first frame alone, which is a classic mistake. The rest then has its recorded direction, or its recorded place as well.";
    Atan "atan" "Angle of the transform" Lab(Graph), Kind::Choice(Atan::CHOICES), Start::Choice(Atan::Atan2.word()), "", "Taken by atan2, or by a mistake: atan cannot tell a direction from its opposite, degrees are no radians, and the root's Y axis points up and not ahead.";
    WalkSeconds "walk_seconds" "Measured walk" Lab(Graph), number(10.0, 600.0, 10.0), Start::Number(60.0), "s", "How much of the walk the numbers are about. It goes on while it plays, for half an hour.";
    GoTo "go_to" "Go to" Lab(Graph), Kind::List(ListKind::Visits), Start::Text(""), "", "When to set off for which clip, by its place in the list, as in 12.5:3,40:0.";
    WalkPath "walk_path" "Ground path" Lab(Graph), Kind::List(ListKind::GroundPath), Start::Text(""), "", "A line over the ground that the walk follows: x and z in metres, as in 0:0,1.5:4.";
    Jump "jump" "Transition" Lab(Graph), Kind::List(ListKind::Jump), Start::Text(""), "", "One transition in place of the walk: which clip is left and entered at which frame, as in 0:52-3:14.";

    Scenario "scenario" "Input" Lab(Match), Kind::Choice(Scenario::CHOICES), Start::Choice(Scenario::Own.word()), "", "Who drives: you, or input that was written down, the same for everybody.";
    Drive "drive" "Recorded input" Lab(Match), Kind::List(ListKind::Recording), Start::Text(""), "", "Input that is played again, exactly: stretches of ticks and velocities. Empty: drive yourself.";
    MatchClips "match_clips" "Clips" Lab(Match), Kind::List(ListKind::ClipIds), Start::Text(""), "", "The clips to choose frames from: ids, separated by commas. Empty: the synthesiser's set of walks, runs, turns, starts, stops and spins.";
    Mirrored "mirrored" "Mirrored copies" Lab(Match), Kind::Switch, Start::Switch(true), "", "Every clip a second time, left and right exchanged.";
    MatchCycles "match_cycles" "Cycles go round" Lab(Match), Kind::Switch, Start::Switch(true), "", "A clip that is a cycle plays round and round and is searched to its last frame. Off: it ends, and what is near its end is never chosen.";
    WalkSpeed "walk_speed" "Walking speed" Lab(Match), number(0.3, 2.2, 0.05), Start::Number(1.4), "m/s", "How fast the character is asked to walk." [LookedAt];
    RunSpeed "run_speed" "Running speed" Lab(Match), number(1.5, 6.0, 0.05), Start::Number(3.2), "m/s", "How fast it is asked to go with Shift." [LookedAt];
    Strafe "strafe" "Strafe" Lab(Match), Kind::Switch, Start::Switch(false), "", "It faces where the camera looks, whichever way it goes." [LookedAt];
    WeightPath "weight_path" "Path ahead" Lab(Match), number(0.0, 4.0, 0.05), Start::Number(1.0), "×", "How much it counts where the next second leads.";
    WeightFacing "weight_facing" "Facing ahead" Lab(Match), number(0.0, 4.0, 0.05), Start::Number(1.25), "×", "How much it counts what the body will face.";
    WeightFeet "weight_feet" "Feet, where" Lab(Match), number(0.0, 4.0, 0.05), Start::Number(0.75), "×", "How much it counts where the feet are.";
    WeightFootSpeed "weight_foot_speed" "Feet, how fast" Lab(Match), number(0.0, 4.0, 0.05), Start::Number(1.0), "×", "How much it counts how the feet move.";
    WeightHipSpeed "weight_hip_speed" "Hips, how fast" Lab(Match), number(0.0, 4.0, 0.05), Start::Number(1.0), "×", "How much it counts how the hips move.";
    AheadNear "ahead_near" "Look ahead, near" Lab(Match), number(0.05, 1.0, 0.01), Start::Number(0.33), "s", "The first time at which path and facing are compared.";
    AheadMiddle "ahead_middle" "Look ahead, middle" Lab(Match), number(0.1, 2.0, 0.01), Start::Number(0.67), "s", "The second.";
    AheadFar "ahead_far" "Look ahead, far" Lab(Match), number(0.2, 3.0, 0.01), Start::Number(1.0), "s", "The last. Frames nearer to their clip's end than this are never chosen, unless the clip is a cycle.";
    Normalisation "normalisation" "Normalise" Lab(Match), Kind::Choice(Normalisation::CHOICES), Start::Choice(Normalisation::Block.word()), "", "By block: positions, directions and velocities keep their proportions among themselves. By dimension: each number varies by as much, also where it hardly moves.";
    SearchInterval "search_interval" "Search every" Lab(Match), logarithmic(0.02, 2.0, 0.01), Start::Number(0.1), "s", "How often the best frame is looked for. A clip's end and another input do not wait.";
    SearchBy "search_by" "Search by" Lab(Match), Kind::Choice(SearchBy::CHOICES), Start::Choice(SearchBy::Boxes.word()), "", "Three searches that find the same frame: how many frames they look at differs." [LookedAt];
    Hysteresis "hysteresis" "Hysteresis" Lab(Match), Kind::Choice(Hysteresis::CHOICES), Start::Choice(Hysteresis::Bias.word()), "", "What keeps it from jumping for next to nothing.";
    BiasShare "bias_share" "Bias, share" Lab(Match), number(0.0, 0.9, 0.01), Start::Number(0.15), "", "A better frame must be cheaper by this share of the present cost.";
    BiasConstant "bias_constant" "Bias, constant" Lab(Match), number(0.0, 5.0, 0.05), Start::Number(0.2), "cost", "And by this.";
    MinimumTime "minimum_time" "Time between jumps" Lab(Match), number(0.0, 2.0, 0.05), Start::Number(0.3), "s", "No jump sooner than this after another.";
    PreferCurrent "prefer_current" "Prefer this clip" Lab(Match), number(0.0, 1.0, 0.05), Start::Number(0.2), "", "While the input is still, a frame of another clip must be cheaper by this share.";
    PreferClip "prefer_clip" "Clip preferred" Lab(Match), Kind::Text, Start::Text(""), "", "Which clip is preferred by that share while the input is still. Empty: the one that plays.";
    JumpMethod "jump_method" "Transition" Lab(Match), Kind::Choice(JumpMethod::CHOICES), Start::Choice(JumpMethod::Inertialize.word()), "", "How a jump is hidden.";
    JumpHalfLife "jump_half_life" "Half-life" Lab(Match), logarithmic(0.02, 1.0, 0.01), Start::Number(0.1), "s", "How lazily the difference of a jump dies away. Longer ones are softer, and let feet slide.";
    VelocityHalfLife "velocity_half_life" "Velocity half-life" Lab(Match), number(0.05, 1.0, 0.01), Start::Number(0.28), "s", "How lazily the way follows the stick.";
    FacingHalfLife "facing_half_life" "Facing half-life" Lab(Match), number(0.05, 1.0, 0.01), Start::Number(0.3), "s", "How lazily the facing follows.";
    Adjust "adjust" "Adjust to the way" Lab(Match), Kind::Switch, Start::Switch(true), "", "Draws the character to where it was asked to be, and holds it near.";
    AdjustHalfLife "adjust_half_life" "Adjustment half-life" Lab(Match), number(0.02, 1.0, 0.01), Start::Number(0.1), "s", "How fast it is drawn there.";
    AdjustShare "adjust_share" "Adjustment at most" Lab(Match), number(0.0, 2.0, 0.05), Start::Number(0.5), "of speed", "It is drawn by no more than this share of its own speed, so that feet slide little.";
    ClampDistance "clamp_distance" "Never farther than" Lab(Match), number(0.0, 2.0, 0.01), Start::Number(0.35), "m", "The farthest that the character may be from where it should.";
    ClampTurn "clamp_turn" "Never turned more than" Lab(Match), number(0.0, 180.0, 1.0), Start::Number(57.0), "°", "The farthest that it may be turned away.";
    PlantFeet "plant_feet" "Foot lock" Lab(Match), Kind::Switch, Start::Switch(true), "", "Holds planted feet where they stand while it plays.";
    AskTag "ask_tag" "Only frames of" Lab(Match), Kind::Text, Start::Text("any"), "", "Frames must have this tag: walk, run, idle, turn, or a word of your own.";
    ForbidTag "forbid_tag" "No frames of" Lab(Match), Kind::Text, Start::Text("nothing"), "", "Frames must not have this tag.";
    Tags "tags" "Tags" Lab(Match), Kind::List(ListKind::Tags), Start::Text(""), "", "Tags by hand: clip, seconds and word, as in walk:0.2-1.5:exclude. A word behind a minus sign is taken away there.";
    ShownCandidates "shown_candidates" "Candidates shown" Lab(Match), number(1.0, 8.0, 1.0), Start::Number(5.0), "frames", "How many of the best frames each search tells of." [LookedAt];
    Crowd "crowd" "Characters" Lab(Match), number(1.0, 100.0, 1.0), Start::Number(1.0), "", "Others walk about you, each with a controller of its own, all with the same clips." [LookedAt];

    RootWay "root_way" "Root motion" Lab(InPlace), Kind::Choice(RootWay::CHOICES), Start::Choice(RootWay::TakeOut.word()), "", "Removed: the body stays over the origin. Rebuilt: computed from the planted feet of a clip that goes in place.";
    RootWayTurn "root_way_turn" "Include turning" Lab(InPlace), Kind::Switch, Start::Switch(true), "", "Turning is removed or rebuilt, too. Off: the body faces as it does in the clip.";

    Gait "gait" "Motion" Lab(Make), Kind::Choice(MadeAction::CHOICES), Start::Choice(MadeAction::Walk.word()), "", "What the character does.";
    GaitSpeed "gait_speed" "Speed" Lab(Make), auto(0.4, 6.5, 0.05), Start::Auto, "m/s", "How fast it walks or runs: a walk takes 0.4 to 2.2, a run 1.8 to 6.5.";
    TurnRate "turn_rate" "Turn rate" Lab(Make), number(-120.0, 120.0, 1.0), Start::Number(0.0), "°/s", "How fast the path turns; positive is left.";
    BodyHeight "body_height" "Body height" Lab(Make), number(1.0, 2.2, 0.01), Start::Number(1.75), "m", "Longer legs take longer and slower strides.";
    ArmSwing "arm_swing" "Arm swing" Lab(Make), number(0.0, 2.0, 0.05), Start::Number(1.0), "×", "How far the arms swing; 1 is natural.";
    Bounce "bounce" "Bounce" Lab(Make), number(0.0, 2.0, 0.05), Start::Number(1.0), "×", "How far the hips rise and fall; 1 is natural.";
    Lean "lean" "Lean" Lab(Make), number(0.0, 2.0, 0.05), Start::Number(1.0), "×", "How far the trunk leans forward and into turns; 1 is natural.";
    MakeSeconds "make_seconds" "Length" Lab(Make), number(1.0, 30.0, 0.1), Start::Number(4.0), "s", "How long the clip is.";
    Seed "seed" "Seed" Lab(Make), number(0.0, 999.0, 1.0), Start::Number(7.0), "", "Another seed, another natural variation; the same seed, the same clip." in [Graph];

    Stage "stage" "Stage" Stage, Kind::Choice(Backdrop::CHOICES), Start::Choice(Backdrop::Auto.word()), "", "Dark, light, or paper: black lines on white, for print and bright rooms. Auto goes with the theme.";
    Look "look" "Character" Stage, Kind::Choice(Look::CHOICES), Start::Choice(Look::Body.word()), "", "A body in one skin, a mannequin of limbs, bones, or bones inside of the body.";
    Character "character" "Figure" Stage, Kind::Character, Start::Text(""), "", "The clip whose file brought a mesh with a skin: its character is moved. Empty: a body is made around the bones.";
    FigureHeight "figure_height" "Height" Stage, number(0.5, 1.5, 0.01), Start::Number(1.0), "×", "How high the character is beside its clip. Its steps and its path grow with it.";
    FigureBuild "figure_build" "Build" Stage, number(0.6, 1.6, 0.05), Start::Number(1.0), "×", "How broad the character is: 1 is average.";
    Skinning "skinning" "Skinning" Stage, Kind::Choice(Skinning::CHOICES), Start::Choice(Skinning::Dual.word()), "", "How the skin follows two joints at once: twist a forearm to see the difference." [Compare];
    Twist "twist" "Twist of the hands" Stage, number(-180.0, 180.0, 1.0), Start::Number(0.0), "°", "Turns both hands about their forearms, whatever the clip does. Linear blend wraps the wrist like a candy wrapper, dual quaternions keep it round.";
    Axes "axes" "Joint axes" Stage, Kind::Switch, Start::Switch(false), "", "Red, green and blue arrows for x, y and z of every joint.";
    Sources "sources" "A and B as ghosts" Stage, Kind::Switch, Start::Switch(true), "", "Shows both sources inside the transition.";
    Ghosts "ghosts" "Onion skin" Stage, number(0.0, 8.0, 1.0), Start::Number(0.0), "poses", "Poses before and after the present one.";
    GhostStep "ghost_step" "Onion skin step" Stage, number(0.05, 1.0, 0.05), Start::Number(0.25), "s", "Time from one onion-skin pose to the next.";
    Trail "trail" "Ground path" Stage, Kind::Switch, Start::Switch(true), "", "The way of the hips, drawn on the ground.";
    JointTrail "joint_trail" "Joint trail" Stage, Kind::Switch, Start::Switch(false), "", "The way of the chosen joint through the air.";
    Joint "joint" "Joint" Stage, Kind::Joint, Start::Text("right foot"), "", "The joint whose curve and trail are shown: a body part or a joint's name.";
    Curve "curve" "Curve" Stage, Kind::Choice(Curve::CHOICES), Start::Choice(Curve::Speed.word()), "", "What of the chosen joint is plotted.";
    Contacts "contacts" "Foot contacts" Stage, Kind::Switch, Start::Switch(true), "", "A ring under a planted foot, red where it slides.";
    Follow "follow" "Follow" Camera, Kind::Choice(Follow::CHOICES), Start::Choice(Follow::Result.word()), "", "Which character the camera stays with.";
    FollowOther "follow_other" "Which other" Camera, number(1.0, 6.0, 1.0), Start::Number(1.0), "", "Which of the others the camera stays with, by their order.";
    FollowJoint "follow_joint" "Follow joint" Camera, Kind::Joint, Start::Text("hips"), "", "The joint that the camera stays with.";
    FollowHalfLife "follow_half_life" "Camera half-life" Camera, logarithmic(0.02, 2.0, 0.01), Start::Number(0.2), "s", "How lazily the camera follows.";
    Camera "camera" "Camera" Camera, Kind::Choice(Camera::CHOICES), Start::Choice(Camera::Orbit.word()), "", "From the side, or from above.";
    CameraYaw "camera_yaw" "Camera direction" Camera, number(-180.0, 180.0, 0.5), Start::Number(62.0), "°", "From where the camera looks, around the vertical." [NoUndo];
    CameraPitch "camera_pitch" "Camera pitch" Camera, number(-10.0, 89.0, 0.5), Start::Number(9.0), "°", "How far above the horizon the camera stands." [NoUndo];
    CameraDistance "camera_distance" "Camera distance" Camera, logarithmic(0.5, 60.0, 0.05), Start::Number(4.8), "m", "How far away the camera stands." [NoUndo];
    PanX "pan_x" "Camera shift x" Camera, number(-100.0, 100.0, 0.01), Start::Number(0.0), "m", "How far the middle of the picture lies beside what the camera follows, along x." [NoUndo, ByPointer];
    PanY "pan_y" "Camera shift y" Camera, number(-100.0, 100.0, 0.01), Start::Number(0.0), "m", "Likewise upwards." [NoUndo, ByPointer];
    PanZ "pan_z" "Camera shift z" Camera, number(-100.0, 100.0, 0.01), Start::Number(0.0), "m", "Likewise along z." [NoUndo, ByPointer];

    Play "play" "Play" Transport, Kind::Switch, Start::Switch(true), "", "Whether time runs." [NoUndo];
    Rate "rate" "Playback speed" Transport, logarithmic(0.05, 4.0, 0.05), Start::Number(1.0), "×", "How fast time runs.";
    Loop "loop" "Loop" Transport, Kind::Switch, Start::Switch(true), "", "Starts again at the end.";
    Time "t" "Time" Transport, number(0.0, 3600.0, 0.001), Start::Number(0.0), "s", "Where the playhead stands; written to the link while paused." [NoUndo];
    In "in" "In mark" Transport, auto(0.0, 3600.0, 0.01), Start::Auto, "s", "Where playing begins." [PlaceInResult];
    Out "out" "Out mark" Transport, auto(0.0, 3600.0, 0.01), Start::Auto, "s", "Where playing ends." [PlaceInResult];

    Compare "compare" "Compare" Page, Kind::Compare, Start::Text(""), "", "One pane for each value of a parameter, as in blend_window:30,15,10." [State];
    Theme "theme" "Theme" Page, Kind::Choice(PageTheme::CHOICES), Start::Choice(PageTheme::Auto.word()), "", "Dark, light, or as the system has it.";
    Lang "lang" "Language" Page, Kind::Choice(PageLanguage::CHOICES), Start::Choice(PageLanguage::Auto.word()), "", "English, Traditional Chinese, or as the browser has it. A link that names none leaves every reader their own.";
    Projector "projector" "Projector" Page, Kind::Switch, Start::Switch(false), "", "Larger type for the back row.";
    Embed "embed" "Embed" Page, Kind::Switch, Start::Switch(false), "", "The stage and the parameters that the link names, without the rest.";
    Lesson "lesson" "Lesson" Page, Kind::Text, Start::Text(""), "", "The lesson that is open: its name, `contents` for the list of all, or the address of a Markdown file of your own.";
    Src "src" "Source" Page, Kind::Text, Start::Text(""), "", "Addresses of motion files to load, separated by spaces.";
}

impl Key {
    /// The row of this parameter.
    #[must_use]
    pub fn param(self) -> &'static Param {
        &PARAMS[self as usize]
    }

    /// The parameter of that name in the link.
    #[must_use]
    pub fn from_name(name: &str) -> Option<Self> {
        PARAMS.iter().find(|param| param.name == name).map(|param| param.key)
    }
}
