//! The columns of the table of parameters.

use super::choices::{Choice, LabId};
use super::grammar::ListKind;
use super::key::Key;

/// The owner of a parameter: the lab whose panel shows it, or a part of the page.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Group {
    /// The page as a whole: the open lab and lesson, colours and language.
    Page,
    /// Time and playback.
    Transport,
    /// The camera.
    Camera,
    /// The stage and its characters.
    Stage,
    /// A lab.
    Lab(LabId),
}

impl Group {
    /// Returns the name in the API and in `docs/parameters.md`.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Page => "page",
            Self::Transport => "transport",
            Self::Camera => "camera",
            Self::Stage => "stage",
            Self::Lab(lab) => lab.word(),
        }
    }

    /// Returns whether these are the parameters of a lab, which change its result.
    #[must_use]
    pub const fn is_of_lab(self) -> bool {
        matches!(self, Self::Lab(_))
    }
}

/// The kind of values that a parameter accepts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Kind {
    /// A number in `[min, max]`, snapped to multiples of `step`.
    Number {
        /// Smallest value.
        min: f64,
        /// Largest value.
        max: f64,
        /// Distance between neighbouring values; 1 for whole numbers.
        step: f64,
        /// Whether the value may be left to Segue (`auto`).
        auto: bool,
        /// Whether a slider shows it on a logarithmic scale.
        logarithmic: bool,
    },
    /// `on` or `off`.
    Switch,
    /// One of a few words.
    Choice(&'static [Choice]),
    /// The id of a clip in the library.
    Clip,
    /// A body part, or the name of a joint.
    Joint,
    /// The id of a clip whose file contains a character; empty for a generated body.
    Character,
    /// Free text.
    Text,
    /// A list; see [`ListKind`].
    List(ListKind),
    /// A comparable parameter and two to four values of it; see
    /// [`Compare`](super::Compare).
    Compare,
}

impl Kind {
    /// The name in the API.
    #[must_use]
    pub const fn name(&self) -> &'static str {
        match self {
            Self::Number { step, .. } => {
                if *step == 1.0 {
                    "integer"
                } else {
                    "number"
                }
            }
            Self::Switch => "switch",
            Self::Choice(_) => "choice",
            Self::Clip => "clip",
            Self::Joint | Self::Character | Self::Text => "text",
            Self::List(_) => "list",
            Self::Compare => "compare",
        }
    }
}

/// A row of the table.
#[derive(Clone, Debug, PartialEq)]
pub struct Param {
    /// The name inside the program.
    pub key: Key,
    /// The key in the link and in the API.
    pub name: &'static str,
    /// The label on screen.
    pub label: &'static str,
    /// The kind of its values.
    pub kind: Kind,
    /// The unit of a number, shown after it; empty if there is none.
    pub unit: &'static str,
    /// Its owner.
    pub group: Group,
    /// One sentence of help.
    pub help: &'static str,
    /// Its special properties.
    pub(super) marks: &'static [Mark],
    /// The labs besides its own whose results depend on it.
    pub shared_with: &'static [LabId],
    pub(super) default: Start,
}

/// A special property of a parameter.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mark {
    /// A place in the clip in A: it has no meaning in another clip.
    PlaceInA,
    /// A place in the clip in B.
    PlaceInB,
    /// A place in the result: it has no meaning when another clip is shown.
    PlaceInResult,
    /// A number of frames that is also shown in seconds.
    InSeconds,
    /// Not an ingredient of a result, although it belongs to a lab: a view or a tool.
    LookedAt,
    /// Affects how feet are read and locked.
    Feet,
    /// Affects how planted feet are locked; without effect while they are not.
    Lock,
    /// Part of the shown state, although it belongs to the page.
    State,
    /// Not a step of undo: view and playback.
    NoUndo,
    /// Not comparable in panes, although it belongs to a lab: it changes how clips are read.
    NoCompare,
    /// Comparable in panes, although it belongs to no lab.
    Compare,
    /// Set with the pointer on the stage only: no panel shows it.
    ByPointer,
}

/// A default as a constant; [`Value`](super::Value) cannot be one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Start {
    Auto,
    Number(f64),
    Switch(bool),
    Choice(&'static str),
    Text(&'static str),
}

impl Param {
    /// Returns whether it has a mark.
    #[must_use]
    pub fn has(&self, mark: Mark) -> bool {
        self.marks.contains(&mark)
    }

    /// Returns whether a lab's result, or the views beside it, depend on this parameter.
    #[must_use]
    pub fn is_used_by(&self, lab: LabId) -> bool {
        self.group == Group::Lab(lab) || self.shared_with.contains(&lab)
    }

    /// Returns whether a lab's result is made from this parameter.
    #[must_use]
    pub fn is_ingredient_of(&self, lab: LabId) -> bool {
        self.is_used_by(lab) && !self.has(Mark::LookedAt)
    }

    /// Returns whether it can be compared in panes: a clip, or a number or choice that changes the
    /// result.
    #[must_use]
    pub fn is_comparable(&self) -> bool {
        let of_lab = self.group.is_of_lab() && !self.has(Mark::NoCompare);
        match self.kind {
            Kind::Clip => true,
            Kind::Number { .. } | Kind::Choice(_) => of_lab || self.has(Mark::Compare),
            _ => false,
        }
    }
}
