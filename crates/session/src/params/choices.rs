//! The choices of parameters that accept a few fixed words, as types:
//! `params.choice::<TransitionMethod>()`.

use super::key::Key;

/// A word that a parameter accepts; see [`Kind::Choice`](super::Kind::Choice).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Choice {
    /// The word in the link.
    pub key: &'static str,
    /// The word on screen.
    pub label: &'static str,
}

/// A type whose values are the choices of one parameter.
pub trait Selected: Copy + PartialEq + 'static {
    /// The parameter with these choices.
    const KEY: Key;
    /// Every choice, in the order on screen.
    const ALL: &'static [Self];
    /// The first choice.
    const FIRST: Self;

    /// Returns the choice's word in a link.
    fn word(self) -> &'static str;

    /// Returns the choice with a word in a link.
    fn from_word(word: &str) -> Option<Self> {
        Self::ALL.iter().copied().find(|choice| choice.word() == word)
    }
}

macro_rules! choices {
    ($($(#[$doc:meta])* $name:ident of $key:ident {
        $first:ident $first_word:literal $first_label:literal, $($variant:ident $word:literal $label:literal,)*
    })*) => {$(
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
        pub enum $name {
            #[doc = concat!("\"", $first_label, "\" on screen.")] $first,
            $(#[doc = concat!("\"", $label, "\" on screen.")] $variant,)*
        }

        impl $name {
            /// The words in links and on screen.
            pub(super) const CHOICES: &'static [Choice] = &[
                Choice { key: $first_word, label: $first_label }, $(Choice { key: $word, label: $label }),*
            ];

            /// Returns the choice's word in a link.
            #[must_use]
            pub const fn word(self) -> &'static str {
                match self {
                    Self::$first => $first_word,
                    $(Self::$variant => $word,)*
                }
            }

            /// Returns the choice's words on screen.
            #[must_use]
            pub const fn label(self) -> &'static str {
                match self {
                    Self::$first => $first_label,
                    $(Self::$variant => $label,)*
                }
            }
        }

        impl Selected for $name {
            const KEY: Key = Key::$key;
            const ALL: &'static [Self] = &[Self::$first, $(Self::$variant),*];
            const FIRST: Self = Self::$first;

            fn word(self) -> &'static str {
                self.word()
            }
        }
    )*};
}

choices! {
    /// A lab: one kind of experiment.
    LabId of Lab {
        View "view" "View",
        Make "make" "Make",
        Blend "blend" "Blend",
        Transition "transition" "Transition",
        Speed "speed" "Speed",
        Loop "loop" "Loop",
        Layers "layers" "Layers",
        Register "register" "Register",
        Path "path" "Path",
        Graph "graph" "Graph",
        Match "match" "Match",
        InPlace "in_place" "In place",
        Edit "edit" "Edit",
        Clean "clean" "Clean",
    }

    /// The law by which the weight moves from A to B inside a blend window.
    WeightLaw of WeightLaw {
        Smooth "smooth" "smooth",
        Linear "linear" "linear",
        Smoother "smoother" "smoother",
    }

    /// The method of the transition in the Transition lab.
    TransitionMethod of Method {
        Inertialize "inertialize" "inertialize",
        Cubic "cubic" "cubic",
        Quintic "quintic" "quintic",
        Dead "dead" "dead blend",
        Smooth "smooth" "dissolve, smooth",
        Linear "linear" "dissolve, linear",
        Cut "cut" "cut",
    }

    /// The method by which the difference between the ends of a cycle is spread over it.
    LoopMethod of LoopMethod {
        Exact "exact" "exact",
        Both "both" "both ends",
        Crossed "crossed" "both ends, crossed",
        Start "start" "start only",
        End "end" "end only",
        Linear "linear" "linear",
        Cubic "cubic" "cubic",
    }

    /// The unit of comparison for the best match of two clips.
    MatchBy of MatchBy {
        Pose "pose" "pose",
        Window "window" "window",
    }

    /// A classic mistake, made on purpose.
    Mistake of Mistake {
        None "none" "no mistake",
        Hemisphere "hemisphere" "no hemisphere check",
        Euler "euler" "Euler angles blended",
        Degrees "degrees" "degrees for radians",
        Atan "atan" "atan for atan2",
        TransformDegrees "transform_degrees" "transform in degrees",
        Facing "facing" "wrong facing axis",
        Alignment "alignment" "no alignment",
        Velocity "velocity" "velocity divided twice",
        WorldRoot "world_root" "root blended in world space",
    }

    /// The way in which a layer joins the motion below it.
    LayerMode of LayerMode {
        Partial "partial" "partial",
        Additive "additive" "additive",
    }

    /// The part of the body that a layer moves.
    Mask of Mask {
        Upper "upper" "upper body",
        Arms "arms" "both arms",
        LeftArm "left_arm" "left arm",
        RightArm "right_arm" "right arm",
        Head "head" "head",
        Spine "spine" "spine",
        Legs "legs" "hips and legs",
        Whole "whole" "whole body",
    }

    /// The way in which a layer's time follows the motion below it.
    LayerFit of LayerFit {
        Step "step" "in step",
        Loop "loop" "loop",
        Hold "hold" "hold",
    }

    /// The pose of an additive layer that adds nothing.
    LayerReference of LayerReference {
        Mean "mean" "mean",
        First "first" "first frame",
        Rest "rest" "rest pose",
    }

    /// The relation in time of two clips that are blended: registered, or plain.
    WarpWith of WarpWith {
        Registered "registered" "registered",
        Plain "plain" "plain",
    }

    /// The result of registered clips: a blend throughout, or a join.
    WarpMode of WarpMode {
        Blend "blend" "blend",
        Join "join" "join",
    }

    /// The places where a time warp may begin and end.
    Ends of Ends {
        Free "free" "free",
        Corner "corner" "corner",
    }

    /// The property of a motion that stays the same on an edited path.
    PathKeep of PathKeep {
        Speed "speed" "speed",
        Duration "duration" "duration",
        Whole "whole" "whole path",
    }

    /// The knots at the ends of a path.
    PathSpline of PathSpline {
        Clamped "clamped" "clamped",
        Uniform "uniform" "uniform",
    }

    /// The coordinates in which the root keeps its offset from a path.
    PathOffset of PathOffset {
        Path "path" "with the path",
        World "world" "as it was",
    }

    /// The part of a clip's root motion that is kept.
    RootMotion of RootMotion {
        World "world" "recorded",
        InPlace "in_place" "in place",
        Residual "residual" "residual",
    }

    /// The change of a clip's root motion.
    RootWay of RootWay {
        TakeOut "take_out" "removed",
        PutBack "put_back" "rebuilt",
    }

    /// Whether the part of an edited clip is declared one cycle.
    Repeats of AsLoop {
        Once "off" "once",
        Cycle "on" "one cycle",
    }

    /// The direction in which an edited clip plays.
    Direction of Reverse {
        Forwards "off" "forwards",
        Backwards "on" "backwards",
    }

    /// The sides of the body in an edited clip.
    Sides of Mirror {
        Recorded "off" "as recorded",
        Mirrored "on" "mirrored",
    }

    /// The coordinates in which a character on a path keeps its heading.
    PathFacing of PathFacing {
        Path "path" "with the path",
        World "world" "as it did",
    }

    /// The method by which the nodes of a motion graph are found.
    Construction of Construction {
        Segments "segments" "segments",
        Minima "minima" "local minima",
    }

    /// The law by which the probability of a transition follows from its distance d.
    EdgeWeight of EdgeWeight {
        Inverse "inverse" "1 / d",
        Exponential "exponential" "exp(−d)",
        Uniform "uniform" "uniform",
        Proportional "proportional" "d (wrong)",
    }

    /// The law for the probability that a walk continues in its clip.
    GoingOn of GoingOn {
        Share "share" "a share",
        Constant "constant" "a constant weight",
    }

    /// The method by which the clips of a walk are joined.
    WalkMethod of WalkMethod {
        Dissolve "dissolve" "dissolve",
        Inertialize "inertialize" "inertialize",
    }

    /// The points by which B is aligned with A.
    AlignBy of AlignBy {
        Window "window" "whole window",
        First "first" "first posture",
    }

    /// The frames of a clip that a walk moves to the end of the last clip.
    Transform of Transform {
        Whole "whole" "whole clip",
        First "first" "first frame only",
        Teleport "teleport" "first frame, then as recorded",
    }

    /// The formula for the alignment angle of a walk; all but the first are mistakes.
    Atan of Atan {
        Atan2 "atan2" "atan2",
        Atan "atan" "atan (wrong)",
        Degrees "degrees" "degrees (wrong)",
        Facing "facing" "rotation · Y (wrong)",
    }

    /// Recorded input for the Match lab.
    Scenario of Scenario {
        Own "own" "my own",
        Straight "straight" "walk straight",
        Left "left" "90° to the left",
        Right "right" "90° to the right",
        Spin "spin" "180° spin",
        StartStop "start_stop" "start and stop",
        Run "run" "walk to run",
        Eight "eight" "figure eight",
    }

    /// The rule that keeps a matched character from jumping too often.
    Hysteresis of Hysteresis {
        None "none" "none",
        Bias "bias" "bias",
        Time "time" "time",
        Votes "votes" "votes",
        ClipVotes "clip_votes" "votes for another clip",
    }

    /// The scale by which features of motion matching are divided.
    Normalisation of Normalisation {
        Block "block" "by block",
        Dimension "dimension" "by dimension",
    }

    /// The method of the search for the nearest features.
    SearchBy of SearchBy {
        Boxes "boxes" "boxes",
        Tree "tree" "k-d tree",
        Scan "scan" "scan",
    }

    /// The method by which a matched character jumps to another frame.
    JumpMethod of JumpMethod {
        Inertialize "inertialize" "inertialize",
        Dead "dead" "dead blend",
    }

    /// The action that the Make lab synthesises.
    MadeAction of Gait {
        Walk "walk" "walk",
        Run "run" "run",
        Idle "idle" "idle",
        Start "start" "start",
        Stop "stop" "stop",
        Spin "spin" "spin",
        Jump "jump" "jump",
    }

    /// The parts of a figure that are drawn.
    Look of Look {
        Body "body" "body",
        Limbs "limbs" "limbs",
        Bones "bones" "bones",
        Both "both" "both",
    }

    /// The method by which a body follows its skeleton.
    Skinning of Skinning {
        Dual "dual" "dual quaternions",
        Linear "linear" "linear blend",
    }

    /// The background of the stage.
    Backdrop of Stage {
        Auto "auto" "auto",
        Dark "dark" "dark",
        Light "light" "light",
        Paper "paper" "paper",
    }

    /// The point that the camera follows.
    Follow of Follow {
        Off "off" "off",
        Result "result" "result",
        A "a" "A",
        B "b" "B",
        Other "other" "an extra character",
    }

    /// The kind of camera.
    Camera of Camera {
        Orbit "orbit" "orbit",
        Top "top" "top",
    }

    /// The quantity that the timeline draws.
    Curve of Curve {
        Speed "speed" "speed",
        Height "height" "height",
        Distance "distance" "distance",
        Angle "angle" "angle",
        Turn "turn" "turn rate",
    }

    /// Whether the Clean lab shows the take without its faults, or as it is.
    Mending of CleanMend {
        Mended "on" "mended",
        Recorded "off" "as recorded",
    }

    /// The motions whose curves the timeline draws.
    CurvesOf of CurvesOf {
        All "all" "A, B and result",
        Result "result" "result",
        Sources "sources" "A and B",
    }

    /// The colours of the page.
    PageTheme of Theme {
        Auto "auto" "auto",
        Dark "dark" "dark",
        Light "light" "light",
    }

    /// The language of the page.
    PageLanguage of Lang {
        Auto "auto" "auto",
        En "en" "English",
        ZhHant "zh-Hant" "繁體中文",
    }
}

/// The labs that make a result from the clip in A.
pub(super) const OF_A: &[LabId] = &[
    LabId::View,
    LabId::Blend,
    LabId::Transition,
    LabId::Speed,
    LabId::Loop,
    LabId::Layers,
    LabId::Register,
    LabId::Path,
    LabId::InPlace,
    LabId::Edit,
    LabId::Clean,
];

/// The labs that make a result from the clip in B.
pub(super) const OF_B: &[LabId] =
    &[LabId::Blend, LabId::Transition, LabId::Speed, LabId::Layers, LabId::Register];

/// The labs that put their clips on one body.
pub(super) const OF_BODIES: &[LabId] = &[
    LabId::Transition,
    LabId::Speed,
    LabId::Layers,
    LabId::Register,
    LabId::Graph,
    LabId::Match,
    LabId::Edit,
];

/// The labs that read the feet of their clips, and can lock them.
pub(super) const OF_FEET: &[LabId] = &[
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
    LabId::Edit,
];

/// The labs whose results depend on the contacts of their clips.
pub(super) const OF_CONTACTS: &[LabId] = &[
    LabId::View,
    LabId::Transition,
    LabId::Speed,
    LabId::Loop,
    LabId::Layers,
    LabId::Register,
    LabId::Path,
    LabId::Graph,
    LabId::Match,
    LabId::InPlace,
    LabId::Edit,
];
