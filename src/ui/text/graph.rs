//! The texts of the Graph lab.

use crate::ui::language::Word;
use segue_session::{BuiltGraph, FollowedPath, GraphClips};
use segue_text::{Message, msg};

/// The line about the Graph lab.
pub(crate) const GRAPH_ABOUT: Word = Word::new("Walks endlessly through a graph of clips.");
/// The help text of the Graph lab.
pub(crate) const GRAPH_DETAILS: Word =
    Word::new("The graph has the transitions between the clips; the seed sets the walk.");
/// The hint over the stage in the Graph lab.
pub(crate) const GRAPH_HINT: Word = Word::new(
    "Point at a ring or an arc to see both poses. Click it to play that transition alone.",
);
/// The help of the seed in this lab, in place of that for a made motion.
pub(crate) const GRAPH_SEED_HELP: Word =
    Word::new("Each seed gives another walk; the same seed gives the same walk on every machine.");
/// Says why a visit was not possible.
pub(crate) fn no_way(name: Message, secs: f64) -> Message {
    msg!(
        "{name} cannot be reached from the walk at {secs:.1} s: a higher threshold may connect them.",
        name,
        secs
    )
}

pub(crate) const GRAPH_LACKS_SOME: Word =
    Word::new("There are too many transitions below the threshold: the closest are kept.");
/// The label of a menu that adds a clip.
pub(crate) const ADD_CLIP: Word = Word::new("Add a clip");
/// The task of building graph and walk.
pub(crate) const GRAPHING: Word = Word::new("Building graph and walk");
/// The button that continues a task after it was stopped.
pub(crate) const GO_ON: Word = Word::new("Continue");
/// The heading of the parameters of the walk.
pub(crate) const WALK: Word = Word::new("The walk");
/// The accessible name of the picture of distances.
pub(crate) const ALL_DISTANCES: Word = Word::new("Distances of all windows");
/// The help below the picture of distances.
pub(crate) const MATRIX_HELP: Word = Word::new(
    "Across: the frame left. Up: the frame entered. Rings: transitions. Scroll to zoom, drag to pan.",
);
/// The accessible name of the histogram.
pub(crate) const ALL_HISTOGRAM: Word = Word::new("Histogram of window distances");
/// The accessible name of the graph as bars and arcs.
pub(crate) const GRAPH_STRIP: Word = Word::new("The graph: clips and transitions");
/// The heading of the experiments.
pub(crate) const EXPERIMENTS: Word = Word::new("Experiments");
/// The label of the menu that sends the walk to a clip.
pub(crate) const GO_TO_CLIP: Word = Word::new("Go to a clip from here");
/// The button that forgets the visits.
pub(crate) const FORGET_VISITS: Word = Word::new("Resume random walk");
/// The button that lets a path be drawn for the walk.
pub(crate) const DRAW_PATH: Word = Word::new("Draw a path on the ground");
/// The note while a path is drawn.
pub(crate) const DRAWING: Word =
    Word::new("Draw on the ground. The walk starts where the path starts.");
/// The button that removes the path.
pub(crate) const REMOVE_PATH: Word = Word::new("Remove the path");
/// The button that goes back from one transition to the walk.
pub(crate) const BACK_TO_WALK: Word = Word::new("Back to the walk");
/// The label of the buttons that save the graph as a file.
pub(crate) const GRAPH_FILES: Word = Word::new("The graph as a file");
/// The title of the table of numbers.
pub(crate) const NUMBERS: Word = Word::new("Numbers");
/// The button that copies the table as Markdown.
pub(crate) const COPY_MARKDOWN: Word = Word::new("Copy as Markdown");
/// The button that copies the table as CSV.
pub(crate) const COPY_CSV: Word = Word::new("Copy as CSV");
/// The notice after a table was copied.
pub(crate) const TABLE_COPIED: Word = Word::new("Table copied.");
/// The mark on the timeline where the walk changes clips.
pub(crate) const SEAM: Word = Word::new("Transition to another clip");

/// An experiment that a button opens: its name, its help, and the values that it sets.
pub(crate) struct Experiment {
    pub(crate) name: Word,
    pub(crate) help: Word,
    pub(crate) query: &'static str,
}

/// The experiments of the course, each on the same seed.
pub(crate) const GRAPH_EXPERIMENTS: &[Experiment] = &[
    Experiment {
        name: Word::new("Windows: full, half, third"),
        help: Word::new("Longer is smoother but slower to respond; shorter is snappier but pops."),
        query: "construction=segments&segment_size=60&blend_window=30&compare=blend_window:30,15,10",
    },
    Experiment {
        name: Word::new("Segments: full, half, third"),
        help: Word::new(
            "Long segments rarely repeat; short ones change clips all the time. A third is no longer than the window: nothing is left of a segment, and many programs crash.",
        ),
        query: "construction=segments&blend_window=20&segment_size=60&compare=segment_size:60,30,20",
    },
    Experiment {
        name: Word::new("Continuity: low, medium, high"),
        help: Word::new("How long a clip plays without a transition."),
        query: "going_on=share&compare=continuity:0.3,0.8,0.98",
    },
    Experiment {
        name: Word::new("Continuation weight: 1 and 1000"),
        help: Word::new(
            "A constant weight beside those of the transitions: the more transitions leave a segment, the less likely the clip continues.",
        ),
        query: "going_on=constant&edge_weight=proportional&compare=continuity_weight:1,1000",
    },
    Experiment {
        name: Word::new("atan for atan2"),
        help: Word::new(
            "Every clip is aligned back to front, as if it faced the other way in its file: the character spins.",
        ),
        query: "transform=whole&compare=atan:atan2,atan",
    },
    Experiment {
        name: Word::new("Degrees for radians"),
        help: Word::new(
            "An angle in degrees used as radians: every clip moves off in a wrong direction.",
        ),
        query: "transform=whole&compare=atan:atan2,degrees",
    },
    Experiment {
        name: Word::new("First frame only"),
        help: Word::new(
            "The clip starts at the right position, then continues in its recorded direction, or jumps back to its recorded position.",
        ),
        query: "atan=atan2&compare=transform:whole,first,teleport",
    },
];

/// Says how many transitions the limit for each segment has left out; `None` without any.
pub(crate) fn ways_left_out(built: &BuiltGraph) -> Option<Message> {
    let count = built.whole().left_out();
    (count > 0).then(|| {
        msg!(
            "{count, plural, one {# transition is left out} other {# transitions are left out}}: at most {most} may leave a segment. Raise the transitions per segment to include more.",
            count,
            most = built.options().most_ways_out
        )
    })
}

/// Returns the size of a graph: transitions, dead ends, components, and the time between
/// transitions.
pub(crate) fn graph_in_words(built: &BuiltGraph, run_secs: Option<f64>) -> Message {
    const NAMED: usize = 4;
    let first = msg!(
        "{jumps, plural, one {# transition} other {# transitions}}, {dead, plural, =0 {no dead end} one {# dead end} other {# dead ends}}.",
        jumps = built.whole().jumps().len(),
        dead = built.dead_ends()
    );
    let percent = |share: &f64| msg!("{percent:.0} %", percent = 100.0 * share);
    let components = match built.component_shares() {
        [] => "The graph has no cycle: every walk ends.".into(),
        [one] => msg!("One component, with {share} of all frames.", share = percent(one)),
        rings => {
            let mut shares: Vec<Message> = rings.iter().take(NAMED).map(percent).collect();
            shares.extend((rings.len() > NAMED).then_some("…".into()));
            msg!(
                "{count} separate components, with {shares} of all frames: a higher threshold may connect them.",
                count = rings.len(),
                shares
            )
        }
    };
    let pruned = built.is_pruned().then(|| {
        msg!(
            "The walk stays in the largest: {jumps, plural, one {# transition} other {# transitions}}.",
            jumps = built.graph().jumps().len()
        )
    });
    let run = run_secs
        .map(|secs| msg!("A clip plays for {secs:.1} s on average between transitions.", secs));
    let sentences = [first, components].into_iter().chain(pruned).chain(run).collect();
    Message::joined(sentences, " ")
}

/// Returns the ends, distance and probability of a transition.
pub(crate) fn jump_in_words(ends: [Message; 2], cm: f64, probability: Option<f64>) -> Message {
    let [leave, enter] = ends;
    if let Some(p) = probability {
        msg!("{leave} → {enter} · {cm:.1} cm · p {p:.2}", leave, enter, cm, p)
    } else {
        msg!("{leave} → {enter} · {cm:.1} cm", leave, enter, cm)
    }
}

/// Returns a frame of a clip in words.
pub(crate) fn frame_in_words(name: Message, frame: usize) -> Message {
    msg!("{name} {frame}", name, frame)
}

/// Returns the frames and the distance of two windows that are no transition.
pub(crate) fn windows_apart([leave, enter]: [Message; 2], cm: Option<f64>) -> Message {
    if let Some(cm) = cm {
        msg!("{leave} | {enter}: {cm:.1} cm apart", leave, enter, cm)
    } else {
        msg!("{leave} | {enter}: no window starts here", leave, enter)
    }
}

/// Says which clips were retargeted to the skeleton of the first; `None` without any.
pub(crate) fn moved_onto_first(
    clips: &GraphClips,
    title: impl Fn(&str) -> Message,
) -> Option<Message> {
    let moved: Vec<Message> = (clips.names().iter().enumerate())
        .filter(|(clip, _)| clips.retargeted(*clip).is_some())
        .map(|(_, name)| title(name))
        .collect();
    let first = clips.names().first().filter(|_| !moved.is_empty())?;
    Some(msg!(
        "Retargeted to the skeleton of {first}: {names}.",
        first = title(first),
        names = moved
    ))
}

/// Returns how closely a walk follows its path.
pub(crate) fn followed(trace: &FollowedPath) -> Message {
    let &FollowedPath { along_m, length_m, rms_m, looked_at, .. } = trace;
    if trace.is_searching {
        msg!(
            "Searching: the walk follows {along_m:.1} of {length_m:.1} m of the path so far, {rms_m:.2} m away on average; {looked_at} walks compared.",
            along_m,
            length_m,
            rms_m,
            looked_at
        )
    } else {
        msg!(
            "The walk follows {along_m:.1} of {length_m:.1} m of the path, {rms_m:.2} m away on average; {looked_at} walks compared.",
            along_m,
            length_m,
            rms_m,
            looked_at
        )
    }
}

/// Warns that a walk comes to an end.
pub(crate) fn dead_end(secs: f64) -> Message {
    msg!(
        "The walk reaches a dead end after {secs:.1} s. Switch on Largest component only to avoid it.",
        secs
    )
}
