//! The columns of the table of parameters.

use super::choices::{Choice, LabId};
use super::grammar::ListKind;
use super::key::Key;

/// What a parameter belongs to: the lab whose panel shows it, or the part of the page that does.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Group {
    /// The page as a whole: what is open, and in which colours and language.
    Page,
    /// Time and playing.
    Transport,
    /// The camera.
    Camera,
    /// The stage and who stands on it.
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

/// What values a parameter takes.
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
    /// The id of a clip whose file brought a character; empty for a body made around the bones.
    Character,
    /// Free text.
    Text,
    /// A list, read once.
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
    /// Which parameter.
    pub key: Key,
    /// The key in the link and in the API.
    pub name: &'static str,
    /// The label on screen.
    pub label: &'static str,
    /// What values it takes.
    pub kind: Kind,
    /// The unit of a number, as shown behind it; empty where there is none.
    pub unit: &'static str,
    /// Where it belongs.
    pub group: Group,
    /// One sentence of help.
    pub help: &'static str,
    /// What is special about it.
    pub(super) marks: &'static [Mark],
    /// The labs besides its own whose results depend on it.
    pub shared_with: &'static [LabId],
    pub(super) default: Start,
}

/// What may be special about a parameter: a column of the table.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mark {
    /// A place in the clip in A: it means nothing in another clip.
    PlaceInA,
    /// A place in the clip in B.
    PlaceInB,
    /// A place in what plays: it means nothing when another clip is shown.
    PlaceInResult,
    /// A number of frames that is also said in seconds.
    InSeconds,
    /// Looked at or worked with: no result is made from it, though it stands in a lab.
    LookedAt,
    /// Says how feet are read and held.
    Feet,
    /// Says how planted feet are held, which counts only while they are.
    Lock,
    /// Part of what is shown, though it belongs to the page.
    State,
    /// A change of it is no step of undo: looking around, playing and stopping.
    NoUndo,
    /// No panes are made of its values, though it belongs to a lab: clips are read anew for it.
    NoCompare,
    /// Panes can be made of its values, though it belongs to no lab.
    Compare,
    /// Set by the pointer on the stage alone: no panel shows it.
    ByPointer,
}

/// A default, as a [`Value`](super::Value) that can stand in a constant.
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

    /// Returns whether a lab's result, or what it shows beside it, depends on this parameter.
    #[must_use]
    pub fn is_used_by(&self, lab: LabId) -> bool {
        self.group == Group::Lab(lab) || self.shared_with.contains(&lab)
    }

    /// Returns whether a lab's result is made from this parameter.
    #[must_use]
    pub fn is_ingredient_of(&self, lab: LabId) -> bool {
        self.is_used_by(lab) && !self.has(Mark::LookedAt)
    }

    /// Returns whether compare can make panes of it: a clip, or a number or choice that changes the
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
