//! The table of parameters, one row each.
//!
//! [`Key`](super::Key) and [`PARAMS`](super::PARAMS) are generated from it, in files of their own:
//! the types of the columns name keys, and the rows name those types.

// Key, name in the link, label, group, values, default, unit, help; then, where there are any,
// [marks] and `in` with the labs that share it. The lists of labs are in `choices.rs`.
macro_rules! parameters {
    ($expand:ident) => { $expand! {
    Lab "lab" "Lab" Page, Kind::Choice(LabId::CHOICES), Start::Choice(LabId::Blend.word()), "", "Which experiment is open." [State];
    A "a" "A" Page, Kind::Clip, Start::Text("walk"), "", "The clip that plays first." [State] in OF_A;
    B "b" "B" Page, Kind::Clip, Start::Text("run"), "", "The clip that follows." [State] in OF_B;

    BlendWindow "blend_window" "Blend window" Lab(Blend), number(1.0, 240.0, 1.0), Start::Number(30.0), "frames", "How long A fades into B. Longer is smoother but slower to respond; shorter is snappier but pops." [InSeconds] in [Transition, Graph];
    LeaveA "leave_a" "Leave A at" Lab(Blend), auto(0.0, 600.0, 0.001), Start::Auto, "s", "Where the blend window begins in A. Auto: the best match in A's second half." [PlaceInA] in [Transition];
    EnterB "enter_b" "Enter B at" Lab(Blend), auto(0.0, 600.0, 0.001), Start::Auto, "s", "Where the blend window begins in B. Auto: the best match in B's first half." [PlaceInB] in [Transition];
    WeightLaw "weight_law" "Weight law" Lab(Blend), Kind::Choice(WeightLaw::CHOICES), Start::Choice(WeightLaw::Smooth.word()), "", "How the weight moves from A to B inside the window." in [Transition, Graph, Register];
    Align "align" "Align to A" Lab(Blend), Kind::Switch, Start::Switch(true), "", "Turns and moves B over the ground so that it continues A." in [Transition];
    AlignBy "align_by" "Align by" Lab(Blend), Kind::Choice(AlignBy::CHOICES), Start::Choice(AlignBy::Window.word()), "", "What B is aligned by: the best fit of all joints over the blend window, or the position and facing of the first pose alone." in [Transition, Graph];
    RootBlend "root_blend" "Blend root by velocity" Lab(Blend), Kind::Switch, Start::Switch(true), "", "Blends the velocity of the root instead of its position: the speed stays even, and feet slide less. Off: B stays where the alignment puts it." in [Transition, Graph];

    FootLock "foot_lock" "Foot lock" Lab(Blend), Kind::Switch, Start::Switch(false), "", "Holds planted feet in place by bending the legs." [Feet] in OF_FEET;
    LockBlend "lock_blend" "Lock blend" Lab(Blend), number(0.02, 1.0, 0.01), Start::Number(0.2), "s", "How long a foot takes to reach the position where it is held, and to leave it. Longer: softer, but more of the swing changes. Shorter: the swing is kept, but the foot moves abruptly." [Lock] in OF_FEET;
    LockReach "lock_reach" "Lock reach" Lab(Blend), number(1.0, 100.0, 1.0), Start::Number(30.0), "cm", "How far a foot may be moved to be held, for a body of 1.75 m. Farther: feet that slide far are held too, and legs bend more. Nearer: legs change less, and feet slide." [Lock] in OF_FEET;
    LockClearance "lock_clearance" "Swing clearance" Lab(Blend), number(0.0, 10.0, 0.5), Start::Number(2.5), "cm", "The least height of a swinging foot above its stance, for a body of 1.75 m. Higher: low swings are lifted more. 0 leaves swings unchanged." [Lock] in OF_FEET;
    Ground "ground" "Ground" Lab(Blend), auto(-100.0, 100.0, 0.5), Start::Auto, "cm", "The height of the ground for foot lock and penetration. Auto: 0, or the height of planted feet where they are more than 3 cm away from that." [Feet, NoCompare] in OF_FEET;
    ContactHeight "contact_height" "Contact height" Lab(Blend), number(1.0, 15.0, 0.5), Start::Number(4.0), "cm", "A foot is planted below this height above its own lowest level, for a body of 1.75 m. Higher: longer stances." [Feet, NoCompare] in OF_FEET;
    ContactSpeed "contact_speed" "Contact speed" Lab(Blend), number(0.1, 2.0, 0.05), Start::Number(0.4), "m/s", "A foot is planted while it is slower than this. Faster: longer stances, and feet that slide are held too." [Feet, NoCompare] in OF_FEET;
    ContactEdits "contact_edits" "Corrected contacts" Lab(Blend), Kind::List(ListKind::ContactEdits), Start::Text(""), "", "Contacts corrected by hand: for each clip the feet that are planted, with their first and last frames, as in walk:L12-30;-R40-52. LF and RF are forefeet. A minus sign before a foot lifts it." in OF_CONTACTS;

    RetargetFeet "retarget_feet" "Weight of feet" Lab(Blend), number(0.0, 1.0, 0.05), Start::Number(1.0), "", "For clips of another body: how far the feet move from where rotations alone put them to where the clip has them, at the body's scale. Higher: planted feet slide less and penetrate the ground less, and legs bend more." [NoCompare] in OF_BODIES;
    RetargetHands "retarget_hands" "Weight of hands" Lab(Blend), number(0.0, 1.0, 0.05), Start::Number(1.0), "", "For clips of another body: how far the hands move from where rotations alone put them to where the clip has them, relative to the shoulders. Higher: arms stretch as far as in the clip, and hands that touch keep touching." [NoCompare] in OF_BODIES;
    RetargetRightFoot "retarget_right_foot" "Weight of right foot" Lab(Blend), auto(0.0, 1.0, 0.05), Start::Auto, "", "The weight of the right foot alone; the weight of feet is then that of the left foot. Auto: the same for both." [NoCompare] in OF_BODIES;
    RetargetRightHand "retarget_right_hand" "Weight of right hand" Lab(Blend), auto(0.0, 1.0, 0.05), Start::Auto, "", "The weight of the right hand alone; the weight of hands is then that of the left hand. Auto: the same for both." [NoCompare] in OF_BODIES;

    Method "method" "Method" Lab(Transition), Kind::Choice(TransitionMethod::CHOICES), Start::Choice(TransitionMethod::Inertialize.word()), "", "The method of the transition from A to B.";
    HalfLife "half_life" "Half-life" Lab(Transition), logarithmic(0.02, 1.5, 0.01), Start::Number(0.2), "s", "How slowly the offset from A decays: half of it remains after 1.2 half-lives. Longer is smoother, but has more lag." in [Loop, Graph];
    BlendTime "blend_time" "Blend time" Lab(Transition), logarithmic(0.05, 2.0, 0.01), Start::Number(0.4), "s", "The time after which nothing of A is left, for cubic, quintic and dead blend. A quintic ends sooner where the offset is small and closing fast, since it would overshoot." in [Match];
    ExtrapolationHalfLife "extrapolation_half_life" "Extrapolation half-life" Lab(Transition), logarithmic(0.02, 1.0, 0.01), Start::Number(0.1), "s", "How long a dead blend extrapolates A: half of its velocity is left after this time." in [Match];
    MixFrameA "mix_frame_a" "Leave A at" Lab(Transition), auto(0.0, 1_000_000.0, 1.0), Start::Auto, "frame", "The frame of A at which B takes over. Auto: the best match in A's second half." [PlaceInA];
    MixFrameB "mix_frame_b" "Enter B at" Lab(Transition), auto(0.0, 1_000_000.0, 1.0), Start::Auto, "frame", "The frame at which B begins. Auto: the best match in B's first half." [PlaceInB];
    MatchBy "match_by" "Match by" Lab(Transition), Kind::Choice(MatchBy::CHOICES), Start::Choice(MatchBy::Pose.word()), "", "What the best match compares: two poses, or windows of the whole body.";
    MatchPosition "match_position" "Weight of positions" Lab(Transition), number(0.0, 1.0, 0.05), Start::Number(0.6), "", "The weight of joint positions in the match. Higher: the joints are closer together where B takes over.";
    MatchRotation "match_rotation" "Weight of rotations" Lab(Transition), number(0.0, 1.0, 0.05), Start::Number(0.4), "", "The weight of joint rotations in the match. Higher: the limbs point in more similar directions where B takes over.";
    MatchVelocity "match_velocity" "Weight of velocities" Lab(Transition), number(0.0, 1.0, 0.05), Start::Number(0.0), "", "The weight of joint velocities in the match. Higher: the joints move more alike where B takes over.";

    Speed "speed" "Speed" Lab(Speed), auto(0.2, 10.0, 0.05), Start::Auto, "m/s", "Target speed. Auto: midway between A and B.";
    PhaseAlign "phase_align" "Align phases" Lab(Speed), Kind::Switch, Start::Switch(true), "", "Aligns foot strikes. Off: the clips start out of phase, and legs cross.";

    LoopFrom "loop_from" "Cycle from" Lab(Loop), auto(0.0, 600.0, 0.001), Start::Auto, "s", "Where the cycle begins in A." [PlaceInA];
    LoopTo "loop_to" "Cycle to" Lab(Loop), auto(0.0, 600.0, 0.001), Start::Auto, "s", "Where the cycle ends in A: the pose that becomes the first one again." [PlaceInA];
    LoopMethod "loop_method" "Method" Lab(Loop), Kind::Choice(LoopMethod::CHOICES), Start::Choice(LoopMethod::Exact.word()), "", "How the difference between the ends is spread over the cycle.";
    LoopRatio "loop_ratio" "Ratio" Lab(Loop), number(0.0, 1.0, 0.05), Start::Number(0.5), "", "The share of the difference that is spread from the beginning; the rest is spread from the end.";
    Mistake "mistake" "Break it" Lab(Transition), Kind::Choice(Mistake::CHOICES), Start::Choice(Mistake::None.word()), "", "One classic bug on purpose: see what it looks like, and what the metrics say.";

    LayerMode "layer_mode" "Layer" Lab(Layers), Kind::Choice(LayerMode::CHOICES), Start::Choice(LayerMode::Partial.word()), "", "Partial: B replaces A inside the mask. Additive: the difference of B from its reference is added to A.";
    Mask "mask" "Mask" Lab(Layers), Kind::Choice(Mask::CHOICES), Start::Choice(Mask::Upper.word()), "", "The part of the body that B moves.";
    LayerWeight "layer_weight" "Weight" Lab(Layers), number(0.0, 1.0, 0.01), Start::Number(1.0), "", "The weight of B inside the mask. 0 leaves A unchanged; higher: more of B.";
    Feather "feather" "Feather" Lab(Layers), number(0.0, 6.0, 1.0), Start::Number(2.0), "joints", "The number of joints over which the mask fades in, up the spine or along the limb: 0 is a hard edge.";
    LayerReference "layer_reference" "Reference" Lab(Layers), Kind::Choice(LayerReference::CHOICES), Start::Choice(LayerReference::Mean.word()), "", "The reference pose of B: the difference from it is added to A.";
    LayerFit "layer_fit" "B's time" Lab(Layers), Kind::Choice(LayerFit::CHOICES), Start::Choice(LayerFit::Step.word()), "", "In step: a cycle of B is synchronised with A's foot strikes. Loop: B starts again at its end. Hold: it stays in its last frame.";
    LayerStart "layer_start" "B begins at" Lab(Layers), number(-10.0, 10.0, 0.01), Start::Number(0.0), "s", "B's time at A's first frame; in step, the lead of B over A.";
    KeepOrientation "keep_orientation" "Keep B's posture" Lab(Layers), Kind::Switch, Start::Switch(true), "", "Keeps B's trunk orientation in the world, however A's hips tilt: for partial layers.";
    MaskColors "mask_colors" "Colour by share" Lab(Layers), Kind::Switch, Start::Switch(true), "", "Colours every limb by its shares of A and B." [LookedAt];

    RootMotion "root_motion" "Root motion" Lab(View), Kind::Choice(RootMotion::CHOICES), Start::Choice(RootMotion::World.word()), "", "Recorded: as in the clip. In place: position and facing are removed from every frame. Residual: a smooth path and its direction are removed, and the sway around it is kept.";
    PlaceX "place_x" "Starts at x" Lab(View), auto(-100.0, 100.0, 0.01), Start::Auto, "m", "The position of the first frame along x; the whole clip moves with it. Auto: as recorded.";
    PlaceZ "place_z" "Starts at z" Lab(View), auto(-100.0, 100.0, 0.01), Start::Auto, "m", "The position of the first frame along z.";
    PlaceHeading "place_heading" "Starts facing" Lab(View), auto(-180.0, 180.0, 0.5), Start::Auto, "°", "The facing of the first frame, 0 along z and 90 along x; the whole clip turns with it.";

    WarpWith "warp_with" "Time warp" Lab(Register), Kind::Choice(WarpWith::CHOICES), Start::Choice(WarpWith::Registered.word()), "", "Registered: B is time-warped so that matching poses line up. Plain: both clips run at their own speed, as in a dissolve.";
    WarpMode "warp_mode" "Make" Lab(Register), Kind::Choice(WarpMode::CHOICES), Start::Choice(WarpMode::Blend.word()), "", "Blend: both clips at once, with a weight. Join: a transition from A to B.";
    WarpWeight "warp_weight" "Weight of B" Lab(Register), number(0.0, 1.0, 0.01), Start::Number(0.5), "", "0 is A, 1 is B; values between them give a motion that neither clip has.";
    WarpAlso "warp_also" "More clips" Lab(Register), Kind::List(ListKind::WeightedClips), Start::Text(""), "", "Further clips in a blend, registered to A like B, each with its weight, as in 0.3:run,0.2:fast_walk. A has the remaining weight.";
    WarpCurve "warp_curve" "Weight over time" Lab(Register), Kind::List(ListKind::WeightCurve), Start::Text(""), "", "The weight of B over the blend: per cent of the blend and per cent of B, as in 0-0,50-100,100-0. Empty: a constant weight.";
    WarpFrom "warp_from" "Leave A at" Lab(Register), auto(0.0, 600.0, 0.01), Start::Auto, "s", "The time in A at which a join begins." [PlaceInA];
    WarpTo "warp_to" "Reach B at" Lab(Register), auto(0.0, 600.0, 0.01), Start::Auto, "s", "The time in A at which a join reaches B." [PlaceInA];
    RegistrationWindow "registration_window" "Window" Lab(Register), number(1.0, 121.0, 1.0), Start::Number(5.0), "frames", "The number of frames around each pair that are compared. One frame compares poses only; more frames also compare how they move." [InSeconds];
    SlopeLimit "slope_limit" "Slope limit" Lab(Register), number(1.0, 16.0, 1.0), Start::Number(2.0), "steps", "The number of consecutive steps that one clip may advance alone. Higher: stronger time warps.";
    Ends "ends" "Ends" Lab(Register), Kind::Choice(Ends::CHOICES), Start::Choice(Ends::Free.word()), "", "Corner: the first frames match, and the last. Free: a clip may begin or end inside the other.";
    EndSlack "end_slack" "End slack" Lab(Register), number(0.0, 50.0, 1.0), Start::Number(40.0), "%", "The greatest share of one clip that may be left out at each free end.";
    WarpSmoothing "warp_smoothing" "Smoothing" Lab(Register), auto(0.0, 60.0, 1.0), Start::Auto, "frames", "The number of frames to either side over which the time warp and the alignment are smoothed. Auto: a tenth of a second.";
    Pins "pins" "Pins" Lab(Register), Kind::List(ListKind::Pins), Start::Text(""), "", "Pairs of frames of A and B, at A's rate, that must meet, as in 12-30,50-71." [PlaceInA, PlaceInB];

    ControlPoints "control_points" "Control points" Lab(Path), number(4.0, 64.0, 1.0), Start::Number(8.0), "points", "How closely the path follows the hips. Four points cannot follow a turn; many follow every sway.";
    PathSmoothing "path_smoothing" "Smoothing" Lab(Path), number(0.0, 5.0, 0.01), Start::Number(0.0), "", "The weight of curvature against the distance from the hips: 0 is least squares alone, higher is straighter.";
    PathKeep "keep" "Keep" Lab(Path), Kind::Choice(PathKeep::CHOICES), Start::Choice(PathKeep::Speed.word()), "", "The quantity that is kept when the path becomes longer or shorter.";
    PathFacing "path_facing" "Body facing" Lab(Path), Kind::Choice(PathFacing::CHOICES), Start::Choice(PathFacing::Path.word()), "", "Whether the body turns with the path, or keeps its recorded facing.";
    PathOffset "path_offset" "Hip offset" Lab(Path), Kind::Choice(PathOffset::CHOICES), Start::Choice(PathOffset::Path.word()), "", "Whether the offset from the path to the hips turns with the path, or keeps its direction in the world: lateral sway then becomes a surge where the path has turned.";
    PathSpline "path_spline" "Spline" Lab(Path), Kind::Choice(PathSpline::CHOICES), Start::Choice(PathSpline::Clamped.word()), "", "Clamped: the path begins at the first control point and ends at the last. Uniform: the same path from other control points, with its ends beside the outer ones.";
    Path "path" "Path" Lab(Path), Kind::List(ListKind::EditedPath), Start::Text(""), "", "The edited path: its control points to 1 cm, as a short code. Empty: the fitted path." [PlaceInA];
    PathGrid "path_grid" "Snap to grid" Lab(Path), number(0.0, 2.0, 0.05), Start::Number(0.0), "m", "The spacing of the grid that moved points snap to; 0 is none." [LookedAt];
    PinStart "pin_start" "Pin the start" Lab(Path), Kind::Switch, Start::Switch(false), "", "Keeps the start of the path in place while it is edited." [LookedAt];
    PinEnd "pin_end" "Pin the end" Lab(Path), Kind::Switch, Start::Switch(false), "", "Keeps the end of the path in place while it is edited." [LookedAt];
    Others "others" "Others" Lab(Path), Kind::List(ListKind::ClipIds), Start::Text(""), "", "Extra clips on the stage, each in a colour of its own: ids, separated by commas." [LookedAt];
    Clips "clips" "Clips" Lab(Graph), Kind::List(ListKind::ClipIds), Start::Text("walk,walk_left,walk_right,slow_walk,fast_walk,start,stop,idle"), "", "The clips of the graph, as in walk,run,idle. Clips on another skeleton than the first are retargeted to it.";
    Construction "construction" "Construction" Lab(Graph), Kind::Choice(Construction::CHOICES), Start::Choice(Construction::Minima.word()), "", "Segments: all clips are cut into equal parts. Local minima: transitions are made where two windows are more similar than all around them.";
    SegmentSize "segment_size" "Segment size" Lab(Graph), number(1.0, 600.0, 1.0), Start::Number(60.0), "frames", "The length of each part of a clip. It must be longer than the blend window." [InSeconds];
    EdgeThreshold "edge_threshold" "Edge threshold" Lab(Graph), number(0.1, 60.0, 0.1), Start::Number(8.0), "cm", "The greatest distance for a transition: root mean square per joint on a body of 1.75 m. Higher: more transitions, and worse ones.";
    MinJump "min_jump" "Minimum jump" Lab(Graph), number(0.0, 5.0, 0.05), Start::Number(0.5), "s", "The least time between both ends of a transition within one clip.";
    MostWaysOut "most_ways_out" "Transitions per segment" Lab(Graph), logarithmic(1.0, 10_000.0, 1.0), Start::Number(64.0), "", "The greatest number of transitions that leave one segment: the closest are kept. Higher: slower to build and to choose from.";
    EdgeWeight "edge_weight" "Edge weight" Lab(Graph), Kind::Choice(EdgeWeight::CHOICES), Start::Choice(EdgeWeight::Inverse.word()), "", "The law by which the distance of a transition determines its probability.";
    EdgeSigma "edge_sigma" "Width σ" Lab(Graph), logarithmic(0.1, 20.0, 0.1), Start::Number(2.0), "cm", "For every σ that a transition is farther than the closest one, its probability is divided by e ≈ 2.7.";
    Continuity "continuity" "Keep going" Lab(Graph), number(0.0, 1.0, 0.01), Start::Number(0.95), "", "Probability of continuing the current clip at each transition.";
    GoingOn "going_on" "Continuation" Lab(Graph), Kind::Choice(GoingOn::CHOICES), Start::Choice(GoingOn::Share.word()), "", "Share: the same probability of continuing everywhere. Constant weight: one weight beside those of the transitions, so that the probability falls with each further transition.";
    ContinuityWeight "continuity_weight" "Continuation weight" Lab(Graph), logarithmic(0.1, 10_000.0, 0.1), Start::Number(1_000.0), "", "The weight of the next segment of the same clip beside the transitions. Higher: a clip plays longer.";
    VisitedDiscount "visited_discount" "Revisit weight" Lab(Graph), number(0.0, 1.0, 0.01), Start::Number(1.0), "", "The factor on the probability of a segment for each time it was visited: below 1 the walk prefers new segments.";
    Prune "prune" "Largest component only" Lab(Graph), Kind::Switch, Start::Switch(true), "", "Keeps the largest strongly connected component, so that walks never reach a dead end.";
    WalkMethod "walk_method" "Transitions" Lab(Graph), Kind::Choice(WalkMethod::CHOICES), Start::Choice(WalkMethod::Dissolve.word()), "", "Dissolve: both clips are blended over the blend window. Inertialize: the difference decays.";
    Transform "transform" "Transform" Lab(Graph), Kind::Choice(Transform::CHOICES), Start::Choice(Transform::Whole.word()), "", "What is aligned with the walk: the whole clip, or only its first frame, which is a classic mistake. The rest then keeps its recorded direction, or its recorded position as well.";
    Atan "atan" "Angle of the transform" Lab(Graph), Kind::Choice(Atan::CHOICES), Start::Choice(Atan::Atan2.word()), "", "Computed by atan2, or by mistake: atan cannot tell a direction from its opposite, degrees are not radians, and the root's Y axis points up, not forward.";
    WalkSeconds "walk_seconds" "Measured walk" Lab(Graph), number(10.0, 600.0, 10.0), Start::Number(60.0), "s", "The part of the walk that is measured. The walk continues while it plays, for up to half an hour.";
    GoTo "go_to" "Go to" Lab(Graph), Kind::List(ListKind::Visits), Start::Text(""), "", "Visits of clips: the time and the clip's place in the list, as in 12.5:3,40:0.";
    WalkPath "walk_path" "Ground path" Lab(Graph), Kind::List(ListKind::GroundPath), Start::Text(""), "", "A path over the ground that the walk follows: x and z in metres, as in 0:0,1.5:4.";
    Jump "jump" "Transition" Lab(Graph), Kind::List(ListKind::Jump), Start::Text(""), "", "A single transition instead of the walk: the clips and frames that are left and entered, as in 0:52-3:14.";

    Scenario "scenario" "Input" Lab(Match), Kind::Choice(Scenario::CHOICES), Start::Choice(Scenario::Own.word()), "", "Live input, or a recorded scenario that is the same for everyone.";
    Drive "drive" "Recorded input" Lab(Match), Kind::List(ListKind::Recording), Start::Text(""), "", "Recorded input that is replayed exactly: runs of ticks and velocities. Empty: live input.";
    MatchClips "match_clips" "Clips" Lab(Match), Kind::List(ListKind::ClipIds), Start::Text(""), "", "The clips of the database: ids, separated by commas. Empty: the synthesised set of walks, runs, turns, starts, stops and spins.";
    Mirrored "mirrored" "Mirrored copies" Lab(Match), Kind::Switch, Start::Switch(true), "", "Adds a mirrored copy of every clip.";
    MatchCycles "match_cycles" "Loop cycles" Lab(Match), Kind::Switch, Start::Switch(true), "", "A clip that is a cycle loops, and is searched to its last frame. Off: it ends, and frames near its end are never chosen.";
    WalkSpeed "walk_speed" "Walking speed" Lab(Match), number(0.3, 2.2, 0.05), Start::Number(1.4), "m/s", "The requested walking speed. Higher: the character walks faster, as far as the clips allow." [LookedAt];
    RunSpeed "run_speed" "Running speed" Lab(Match), number(1.5, 6.0, 0.05), Start::Number(3.2), "m/s", "The requested speed with Shift held. Higher: the character runs faster, as far as the clips allow." [LookedAt];
    Strafe "strafe" "Strafe" Lab(Match), Kind::Switch, Start::Switch(false), "", "The character faces where the camera looks, whatever its direction of travel." [LookedAt];
    WeightPath "weight_path" "Path ahead" Lab(Match), number(0.0, 4.0, 0.05), Start::Number(1.0), "×", "The weight of the future trajectory in the cost. Higher: the character follows the requested path more closely.";
    WeightFacing "weight_facing" "Facing ahead" Lab(Match), number(0.0, 4.0, 0.05), Start::Number(1.25), "×", "The weight of the future facing in the cost. Higher: the character turns to the requested facing sooner.";
    WeightFeet "weight_feet" "Foot position" Lab(Match), number(0.0, 4.0, 0.05), Start::Number(0.75), "×", "The weight of foot positions in the cost. Higher: smoother steps, but a slower response.";
    WeightFootSpeed "weight_foot_speed" "Foot velocity" Lab(Match), number(0.0, 4.0, 0.05), Start::Number(1.0), "×", "The weight of foot velocities in the cost. Higher: smoother steps, but a slower response.";
    WeightHipSpeed "weight_hip_speed" "Hip velocity" Lab(Match), number(0.0, 4.0, 0.05), Start::Number(1.0), "×", "The weight of the hip velocity in the cost. Higher: a steadier speed, but a slower response.";
    AheadNear "ahead_near" "Look ahead, near" Lab(Match), number(0.05, 1.0, 0.01), Start::Number(0.33), "s", "The first future time at which trajectory and facing are compared.";
    AheadMiddle "ahead_middle" "Look ahead, middle" Lab(Match), number(0.1, 2.0, 0.01), Start::Number(0.67), "s", "The second future time at which they are compared.";
    AheadFar "ahead_far" "Look ahead, far" Lab(Match), number(0.2, 3.0, 0.01), Start::Number(1.0), "s", "The last future time. Frames nearer to their clip's end than this are never chosen, unless the clip is a cycle.";
    Normalisation "normalisation" "Normalise" Lab(Match), Kind::Choice(Normalisation::CHOICES), Start::Choice(Normalisation::Block.word()), "", "By block: positions, directions and velocities keep their proportions within the block. By dimension: each number gets the same spread, even if it hardly varies.";
    SearchInterval "search_interval" "Search every" Lab(Match), logarithmic(0.02, 2.0, 0.01), Start::Number(0.1), "s", "The time between searches for the best frame. Longer: fewer jumps. The end of a clip and a change of input trigger a search at once.";
    SearchBy "search_by" "Search by" Lab(Match), Kind::Choice(SearchBy::CHOICES), Start::Choice(SearchBy::Boxes.word()), "", "Three searches that find the same frame, but compare different numbers of frames." [LookedAt];
    Hysteresis "hysteresis" "Hysteresis" Lab(Match), Kind::Choice(Hysteresis::CHOICES), Start::Choice(Hysteresis::Bias.word()), "", "Prevents needless jumps.";
    BiasShare "bias_share" "Bias, share" Lab(Match), number(0.0, 0.9, 0.01), Start::Number(0.15), "", "A jump needs a cost that is lower by this share of the current one. Higher: fewer jumps.";
    BiasConstant "bias_constant" "Bias, constant" Lab(Match), number(0.0, 5.0, 0.05), Start::Number(0.2), "cost", "Fixed part of the bias. Higher: fewer jumps.";
    MinimumTime "minimum_time" "Time between jumps" Lab(Match), number(0.0, 2.0, 0.05), Start::Number(0.3), "s", "The least time between two jumps. Longer: fewer jumps, but a slower response.";
    PreferCurrent "prefer_current" "Prefer this clip" Lab(Match), number(0.0, 1.0, 0.05), Start::Number(0.2), "", "While the input is constant, a frame of another clip needs a cost that is lower by this share.";
    PreferClip "prefer_clip" "Preferred clip" Lab(Match), Kind::Text, Start::Text(""), "", "The clip that is preferred by that share while the input is constant. Empty: the current one.";
    JumpMethod "jump_method" "Transition" Lab(Match), Kind::Choice(JumpMethod::CHOICES), Start::Choice(JumpMethod::Inertialize.word()), "", "The method of hiding a jump.";
    JumpHalfLife "jump_half_life" "Half-life" Lab(Match), logarithmic(0.02, 1.0, 0.01), Start::Number(0.1), "s", "Decay time of the offset after a jump. Longer is softer, but feet slide more.";
    VelocityHalfLife "velocity_half_life" "Velocity half-life" Lab(Match), number(0.05, 1.0, 0.01), Start::Number(0.28), "s", "How slowly the velocity follows the stick. Longer is smoother but less responsive.";
    FacingHalfLife "facing_half_life" "Facing half-life" Lab(Match), number(0.05, 1.0, 0.01), Start::Number(0.3), "s", "How slowly the facing follows the stick. Longer is smoother but less responsive.";
    Adjust "adjust" "Pull to trajectory" Lab(Match), Kind::Switch, Start::Switch(true), "", "Pulls the character toward the requested trajectory, and limits its distance from it.";
    AdjustHalfLife "adjust_half_life" "Adjustment half-life" Lab(Match), number(0.02, 1.0, 0.01), Start::Number(0.1), "s", "The half-life of that pull. Shorter is faster.";
    AdjustShare "adjust_share" "Maximum adjustment" Lab(Match), number(0.0, 2.0, 0.05), Start::Number(0.5), "of speed", "The greatest share of the character's own speed that is added, so that feet slide little.";
    ClampDistance "clamp_distance" "Maximum distance" Lab(Match), number(0.0, 2.0, 0.01), Start::Number(0.35), "m", "The greatest distance of the character from the requested position.";
    ClampTurn "clamp_turn" "Maximum turn" Lab(Match), number(0.0, 180.0, 1.0), Start::Number(57.0), "°", "The greatest angle of the character from the requested facing.";
    PlantFeet "plant_feet" "Foot lock" Lab(Match), Kind::Switch, Start::Switch(true), "", "Holds planted feet in place during playback.";
    AskTag "ask_tag" "Only frames of" Lab(Match), Kind::Text, Start::Text("any"), "", "Only frames with this tag are found: walk, run, idle, turn, or a tag of your own.";
    ForbidTag "forbid_tag" "No frames of" Lab(Match), Kind::Text, Start::Text("nothing"), "", "Frames with this tag are not found.";
    Tags "tags" "Tags" Lab(Match), Kind::List(ListKind::Tags), Start::Text(""), "", "Tags set by hand: clip, seconds and tag, as in walk:0.2-1.5:exclude. A minus sign before the tag removes it.";
    ShownCandidates "shown_candidates" "Candidates shown" Lab(Match), number(1.0, 8.0, 1.0), Start::Number(5.0), "frames", "The number of best frames that each search reports." [LookedAt];
    Crowd "crowd" "Characters" Lab(Match), number(1.0, 100.0, 1.0), Start::Number(1.0), "", "The number of characters; the others wander around yours, each with a controller of its own and the same clips." [LookedAt];

    RootWay "root_way" "Root motion" Lab(InPlace), Kind::Choice(RootWay::CHOICES), Start::Choice(RootWay::TakeOut.word()), "", "Removed: the body stays over the origin. Rebuilt: computed from the planted feet of an in-place clip.";
    RootWayTurn "root_way_turn" "Include turning" Lab(InPlace), Kind::Switch, Start::Switch(true), "", "Removes or rebuilds turning, too. Off: the body keeps its facing.";

    EditFrom "edit_from" "Trim from" Lab(Edit), auto(0.0, 600.0, 0.001), Start::Auto, "s", "The first time that stays. Later: more of the beginning is removed." [PlaceInA];
    EditTo "edit_to" "Trim to" Lab(Edit), auto(0.0, 600.0, 0.001), Start::Auto, "s", "The last time that stays. Later: more of the end stays." [PlaceInA];
    AsLoop "as_loop" "Treat as a loop" Lab(Edit), Kind::Choice(Repeats::CHOICES), Start::Choice(Repeats::Once.word()), "", "One cycle: the last frame becomes the first one again, and Speed, Loop and Match take the clip as one whole cycle. The difference between both ends is spread over it.";
    Reverse "reverse" "Direction" Lab(Edit), Kind::Choice(Direction::CHOICES), Start::Choice(Direction::Forwards.word()), "", "Backwards: the last frame plays first. The body faces where it faced, so that it walks backward.";
    Mirror "mirror" "Sides" Lab(Edit), Kind::Choice(Sides::CHOICES), Start::Choice(Sides::Recorded.word()), "", "Mirrored: the left side does what the right one did, in the plane x = 0.";
    EditBody "edit_body" "Body of" Lab(Edit), Kind::List(ListKind::ClipIds), Start::Text(""), "", "The clip whose body A gets, its skeleton and proportions. Empty: A keeps its own.";
    Resample "resample" "Frame rate" Lab(Edit), auto(5.0, 240.0, 1.0), Start::Auto, "fps", "Higher: more frames, interpolated between those of the clip. The length stays. Auto: as in the clip.";
    Scale "scale" "Scale" Lab(Edit), logarithmic(0.1, 10.0, 0.01), Start::Number(1.0), "×", "Larger: the body and its path grow alike. Angles and times stay.";
    Turn "turn" "Turn" Lab(Edit), number(-180.0, 180.0, 0.5), Start::Number(0.0), "°", "Turns the clip about the position of its first frame; positive is left.";
    MoveX "move_x" "Move along x" Lab(Edit), number(-100.0, 100.0, 0.01), Start::Number(0.0), "m", "Larger: the whole clip lies farther along x.";
    MoveZ "move_z" "Move along z" Lab(Edit), number(-100.0, 100.0, 0.01), Start::Number(0.0), "m", "Larger: the whole clip lies farther along z.";

    CleanMend "clean_mend" "Show" Lab(Clean), Kind::Choice(Mending::CHOICES), Start::Choice(Mending::Mended.word()), "", "Mended: without the faults that are switched on. As recorded: with them.";
    CleanSure "clean_sure" "Minimum confidence" Lab(Clean), number(0.0, 95.0, 5.0), Start::Number(50.0), "%", "Faults that are less certain than this are listed, and left alone. Higher: fewer mends.";
    CleanSwaps "clean_swaps" "Swapped sides" Lab(Clean), Kind::Switch, Start::Switch(true), "", "Swaps left and right back where they are swapped.";
    CleanGaps "clean_gaps" "Gaps" Lab(Clean), Kind::Switch, Start::Switch(true), "", "Fills frames in which a limb or the body holds still between moving frames.";
    CleanSpikes "clean_spikes" "Spikes" Lab(Clean), Kind::Switch, Start::Switch(true), "", "Rebuilds frames in which a joint leaves its trajectory, and undoes flips.";
    CleanJitter "clean_jitter" "Jitter" Lab(Clean), Kind::Switch, Start::Switch(true), "", "Filters noise, only where there is some.";
    CleanCutoff "clean_cutoff" "Cut-off" Lab(Clean), auto(2.0, 60.0, 0.5), Start::Auto, "Hz", "The frequency above which jitter is filtered. Higher: quick movements stay, and more of the noise. Auto: by the noise of each joint.";
    CleanDrift "clean_drift" "Drift" Lab(Clean), Kind::Switch, Start::Switch(true), "", "Moves the body back where it drifts or turns evenly over planted feet.";
    CleanGround "clean_ground" "Ground height" Lab(Clean), Kind::Switch, Start::Switch(true), "", "Brings planted feet to height 0, also where the ground rises evenly.";
    CleanEnds "clean_ends" "Ends" Lab(Clean), Kind::Switch, Start::Switch(true), "", "Cuts off a T-pose in front of the motion, and standing still at the ends.";
    CleanSkating "clean_skating" "Sliding feet" Lab(Clean), Kind::Switch, Start::Switch(true), "", "Holds planted feet that slide in place.";
    CleanRate "clean_rate" "Frame rate" Lab(Clean), Kind::Switch, Start::Switch(false), "", "Plays the frames at the rate at which steps and falls take as long as those of a person.";
    CleanSkip "clean_skip" "Left alone" Lab(Clean), Kind::List(ListKind::FaultPlaces), Start::Text(""), "", "Faults that are not mended although their kind is: the kind and the first frame of each, as in spike-34,gap-120." [PlaceInA];
    CleanFaults "clean_faults" "Injected faults" Lab(Clean), number(0.0, 20.0, 1.0), Start::Number(0.0), "", "Injects this number of faults into the clip, to see how well they are found: spikes, gaps, swapped sides and jitter in turn.";
    CleanSeed "clean_seed" "Seed of the faults" Lab(Clean), number(0.0, 999.0, 1.0), Start::Number(1.0), "", "Chooses where the faults are injected; the same seed gives the same places.";

    Gait "gait" "Motion" Lab(Make), Kind::Choice(MadeAction::CHOICES), Start::Choice(MadeAction::Walk.word()), "", "The action to synthesise.";
    GaitSpeed "gait_speed" "Speed" Lab(Make), auto(0.4, 6.5, 0.05), Start::Auto, "m/s", "The speed of a walk (0.4 to 2.2) or a run (1.8 to 6.5).";
    TurnRate "turn_rate" "Turn rate" Lab(Make), number(-120.0, 120.0, 1.0), Start::Number(0.0), "°/s", "The turn rate of the path; positive is left.";
    BodyHeight "body_height" "Body height" Lab(Make), number(1.0, 2.2, 0.01), Start::Number(1.75), "m", "Longer legs take longer and slower strides.";
    ArmSwing "arm_swing" "Arm swing" Lab(Make), number(0.0, 2.0, 0.05), Start::Number(1.0), "×", "The amplitude of the arm swing; 1 is natural.";
    Bounce "bounce" "Bounce" Lab(Make), number(0.0, 2.0, 0.05), Start::Number(1.0), "×", "The vertical amplitude of the hips; 1 is natural.";
    Lean "lean" "Lean" Lab(Make), number(0.0, 2.0, 0.05), Start::Number(1.0), "×", "The lean of the trunk forward and into turns; 1 is natural.";
    MakeSeconds "make_seconds" "Length" Lab(Make), number(1.0, 30.0, 0.1), Start::Number(4.0), "s", "The duration of the clip.";
    Seed "seed" "Seed" Lab(Make), number(0.0, 999.0, 1.0), Start::Number(7.0), "", "Chooses a natural variation; the same seed gives the same clip." in [Graph];

    Stage "stage" "Stage" Stage, Kind::Choice(Backdrop::CHOICES), Start::Choice(Backdrop::Auto.word()), "", "Dark, light, or paper: black lines on white, for print and bright rooms. Auto follows the theme.";
    Look "look" "Character" Stage, Kind::Choice(Look::CHOICES), Start::Choice(Look::Body.word()), "", "A skinned body, a mannequin of limbs, bones, or bones inside the body.";
    Character "character" "Figure" Stage, Kind::Character, Start::Text(""), "", "The clip whose file contains the skinned character to show. Empty: a body generated around the skeleton.";
    FigureHeight "figure_height" "Height" Stage, number(0.5, 1.5, 0.01), Start::Number(1.0), "×", "The height of the character relative to its clip. Its steps and its path scale with it.";
    FigureBuild "figure_build" "Build" Stage, number(0.6, 1.6, 0.05), Start::Number(1.0), "×", "The build of the character: 1 is average, higher is broader.";
    Skinning "skinning" "Skinning" Stage, Kind::Choice(Skinning::CHOICES), Start::Choice(Skinning::Dual.word()), "", "How the skin deforms between two joints: twist a forearm to see the difference." [Compare];
    Twist "twist" "Hand twist" Stage, number(-180.0, 180.0, 1.0), Start::Number(0.0), "°", "Twists both hands about their forearms, on top of the clip. Linear blend collapses the wrist like a candy wrapper; dual quaternions keep its volume.";
    Axes "axes" "Joint axes" Stage, Kind::Switch, Start::Switch(false), "", "Red, green and blue arrows for x, y and z of every joint.";
    Sources "sources" "A and B as ghosts" Stage, Kind::Switch, Start::Switch(true), "", "Shows both sources inside the transition.";
    Ghosts "ghosts" "Onion skin" Stage, number(0.0, 8.0, 1.0), Start::Number(0.0), "poses", "The number of poses before and after the current one.";
    GhostStep "ghost_step" "Onion skin step" Stage, number(0.05, 1.0, 0.05), Start::Number(0.25), "s", "Time from one onion-skin pose to the next.";
    Trail "trail" "Ground path" Stage, Kind::Switch, Start::Switch(true), "", "The path of the hips, drawn on the ground.";
    JointTrail "joint_trail" "Joint trail" Stage, Kind::Switch, Start::Switch(false), "", "The path of the chosen joint through the air.";
    Joint "joint" "Joint" Stage, Kind::Joint, Start::Text("right foot"), "", "The joint whose curve and trail are shown: a body part or a joint's name.";
    Curve "curve" "Curve" Stage, Kind::Choice(Curve::CHOICES), Start::Choice(Curve::Speed.word()), "", "The quantity of the chosen joint that is plotted. Distance is measured over the ground, from its place in the first frame.";
    MoreCurves "more_curves" "More curves" Stage, Kind::List(ListKind::Curves), Start::Text(""), "", "Up to three further quantities of the chosen joint, each plotted below the first, as in height,angle.";
    CurvesOf "curves_of" "Curves of" Stage, Kind::Choice(CurvesOf::CHOICES), Start::Choice(CurvesOf::All.word()), "", "The motions whose curves are plotted.";
    Contacts "contacts" "Foot contacts" Stage, Kind::Switch, Start::Switch(true), "", "A ring under a planted foot, red where it slides.";
    Follow "follow" "Follow" Camera, Kind::Choice(Follow::CHOICES), Start::Choice(Follow::Result.word()), "", "The character that the camera follows.";
    FollowOther "follow_other" "Extra character" Camera, number(1.0, 6.0, 1.0), Start::Number(1.0), "", "The extra character that the camera follows, by order.";
    FollowJoint "follow_joint" "Follow joint" Camera, Kind::Joint, Start::Text("hips"), "", "The joint that the camera follows.";
    FollowHalfLife "follow_half_life" "Camera half-life" Camera, logarithmic(0.02, 2.0, 0.01), Start::Number(0.2), "s", "How slowly the camera follows. Longer is smoother.";
    Camera "camera" "Camera" Camera, Kind::Choice(Camera::CHOICES), Start::Choice(Camera::Orbit.word()), "", "From the side, or from above.";
    CameraYaw "camera_yaw" "Camera direction" Camera, number(-180.0, 180.0, 0.5), Start::Number(62.0), "°", "The direction of the camera, around the vertical." [NoUndo];
    CameraPitch "camera_pitch" "Camera pitch" Camera, number(-10.0, 89.0, 0.5), Start::Number(9.0), "°", "The angle of the camera above the horizon." [NoUndo];
    CameraDistance "camera_distance" "Camera distance" Camera, logarithmic(0.5, 60.0, 0.05), Start::Number(4.8), "m", "The distance of the camera." [NoUndo];
    PanX "pan_x" "Camera shift x" Camera, number(-100.0, 100.0, 0.01), Start::Number(0.0), "m", "The offset of the view's centre from what the camera follows, along x." [NoUndo, ByPointer];
    PanY "pan_y" "Camera shift y" Camera, number(-100.0, 100.0, 0.01), Start::Number(0.0), "m", "The offset of the view's centre from what the camera follows, upwards." [NoUndo, ByPointer];
    PanZ "pan_z" "Camera shift z" Camera, number(-100.0, 100.0, 0.01), Start::Number(0.0), "m", "The offset of the view's centre from what the camera follows, along z." [NoUndo, ByPointer];

    Play "play" "Play" Transport, Kind::Switch, Start::Switch(true), "", "Whether time runs." [NoUndo];
    Rate "rate" "Playback speed" Transport, logarithmic(0.05, 4.0, 0.05), Start::Number(1.0), "×", "The speed of playback.";
    Loop "loop" "Loop" Transport, Kind::Switch, Start::Switch(true), "", "Starts again at the end.";
    Time "t" "Time" Transport, number(0.0, 3600.0, 0.001), Start::Number(0.0), "s", "The position of the playhead; written to the link while paused." [NoUndo];
    In "in" "In mark" Transport, auto(0.0, 3600.0, 0.01), Start::Auto, "s", "Where playing begins." [PlaceInResult];
    Out "out" "Out mark" Transport, auto(0.0, 3600.0, 0.01), Start::Auto, "s", "Where playing ends." [PlaceInResult];

    Compare "compare" "Compare" Page, Kind::Compare, Start::Text(""), "", "One pane for each value of a parameter, as in blend_window:30,15,10." [State];
    Theme "theme" "Theme" Page, Kind::Choice(PageTheme::CHOICES), Start::Choice(PageTheme::Auto.word()), "", "Dark, light, or as the system.";
    Lang "lang" "Language" Page, Kind::Choice(PageLanguage::CHOICES), Start::Choice(PageLanguage::Auto.word()), "", "English, Traditional Chinese, or as the browser. A link without it opens in each reader's own language.";
    Projector "projector" "Projector" Page, Kind::Switch, Start::Switch(false), "", "Larger text for projectors.";
    Embed "embed" "Embed" Page, Kind::Switch, Start::Switch(false), "", "Shows only the stage and the parameters that the link names.";
    Lesson "lesson" "Lesson" Page, Kind::Text, Start::Text(""), "", "The lesson that is open: its name, `contents` for the list of all, or the address of a Markdown file of your own.";
    Src "src" "Source" Page, Kind::List(ListKind::Addresses), Start::Text(""), "", "Addresses of motion files to load, separated by spaces. A clip of a corpus is the address of its `corpus.json` with the clip's id, as in `…/corpus.json#3fa9c1d2@1.5-4`: here the seconds from 1.5 to 4.";
    Corpus "corpus" "Corpus" Page, Kind::Text, Start::Text(""), "", "The corpus that is open beside the stage: the address of its folder, or of its `corpus.json`." [NoUndo];
    } };
}

pub(super) use parameters;
