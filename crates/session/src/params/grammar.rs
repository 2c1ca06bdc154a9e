//! The grammars of parameters that hold a list: one a file, with `read`, which names the place of
//! what it cannot read, and `write`, which writes what `read` reads.
//!
//! A list is read once, when a link, a command or an id is; labs and panels take its values. What
//! was read is written as it stood there, but for spaces and the form of numbers.

mod clip_ids;
mod edited_path;
mod frame_pairs;
mod ground_path;
mod jump;
mod number_pairs;
mod pins;
mod recording;
mod tags;
mod visits;
mod weight_curve;
mod weighted_clips;

pub use clip_ids::write_ids;
pub(crate) use clip_ids::{escaped, is_recipe, parts, read_id};
pub use tags::HandTag;
pub use weighted_clips::MAX_WEIGHTED_CLIPS;

use super::current::Params;
use super::table::Key;
use super::value::Value;
use crate::outside::short;
use glam::DVec2;
use segue_motion::graph::Place;
use segue_motion::matching::{Recording, RecordingError};
use segue_motion::path::{GroundSpline, PathEditError};

/// What of a text is not as a list has it.
#[derive(Clone, Debug, PartialEq, thiserror::Error, segue_text::ToMessage)]
pub enum Misread {
    /// The text as a whole.
    #[error("found `{found}`, expected {expected}", found = short(.found))]
    Text {
        /// What was there.
        found: String,
        /// What would do.
        expected: &'static str,
    },
    /// One of its entries.
    #[error("entry {number}: found `{found}`, expected {expected}", found = short(.found))]
    Entry {
        /// Which, counted from 1.
        number: usize,
        /// What was there.
        found: String,
        /// What would do.
        expected: &'static str,
    },
    /// It is too long.
    #[error("found {count} entries, expected {max} at most")]
    TooMany {
        /// How many there are.
        count: usize,
        /// How many there may be.
        max: usize,
    },
    /// No path.
    #[error(transparent)]
    Path(#[from] PathEditError),
    /// No recording.
    #[error(transparent)]
    Recording(#[from] RecordingError),
}

/// Reads each of a list's entries, of which there are at most `max`.
fn entries<'a, T>(
    texts: impl IntoIterator<Item = &'a str>,
    max: usize,
    expected: &'static str,
    read: impl Fn(&str) -> Option<T>,
) -> Result<Vec<T>, Misread> {
    let texts: Vec<&str> = texts.into_iter().collect();
    if texts.len() > max {
        return Err(Misread::TooMany { count: texts.len(), max });
    }
    let numbered = texts.into_iter().zip(1..);
    let read = |(text, number): (&str, usize)| {
        read(text).ok_or_else(|| Misread::Entry { number, found: text.to_owned(), expected })
    };
    numbered.map(read).collect()
}

/// Returns the entries between commas, without spaces about them and without empty ones.
fn between_commas(text: &str) -> impl Iterator<Item = &str> {
    text.split(',').map(str::trim).filter(|entry| !entry.is_empty())
}

/// Writes entries with commas between them.
fn joined<T>(entries: &[T], write: impl Fn(&T) -> String) -> String {
    entries.iter().map(write).collect::<Vec<_>>().join(",")
}

macro_rules! lists {
    ($(
        $(#[$doc:meta])*
        $kind:ident($list:ty) in $grammar:ident, $getter:ident($($name:ident: $key_type:ty)?) at $key:expr, $slice:ident() -> $slices:ty, else $none:expr;
    )*) => {
        /// What a list holds: its grammar is in the file of that name.
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        pub enum ListKind { $($(#[$doc])* $kind),* }

        /// A list.
        #[derive(Clone, Debug, PartialEq)]
        pub enum List { $($(#[$doc])* $kind($list)),* }

        impl ListKind {
            /// Reads a list as a link has it.
            ///
            /// # Errors
            /// [`Misread`] names what cannot be read, and its place.
            pub fn read(self, text: &str) -> Result<List, Misread> {
                match self { $(Self::$kind => $grammar::read(text).map(List::$kind)),* }
            }

            /// Returns the list without entries.
            #[must_use]
            pub const fn empty(self) -> List {
                match self { $(Self::$kind => List::$kind($none)),* }
            }
        }

        impl List {
            /// Returns what it holds.
            #[must_use]
            pub const fn kind(&self) -> ListKind {
                match self { $(Self::$kind(_) => ListKind::$kind),* }
            }

            /// Writes it as [`ListKind::read`] reads it.
            #[must_use]
            pub fn write(&self) -> String {
                match self { $(Self::$kind(list) => $grammar::write(list)),* }
            }
        }

        impl Params {$(
            $(#[$doc])*
            #[must_use]
            pub fn $getter(&self $(, $name: $key_type)?) -> $slices {
                static NONE: $list = $none;
                match self.get($key) {
                    Value::List(List::$kind(list)) => list.$slice(),
                    _ => NONE.$slice(),
                }
            }
        )*}
    };
}

lists! {
    /// Ids of clips, as in `walk,blend(a:walk,b:run)`.
    ClipIds(Vec<String>) in clip_ids, clip_ids(key: Key) at key, as_slice() -> &[String], else Vec::new();
    /// Clips and their weights, as in `0.3:run,0.2:fast_walk`.
    WeightedClips(Vec<(String, f64)>) in weighted_clips, weighted_clips() at Key::WarpAlso, as_slice() -> &[(String, f64)], else Vec::new();
    /// A weight over the course of a blend: per cent of the blend and per cent of B, as in
    /// `0-0,50-100`.
    WeightCurve(Vec<(usize, usize)>) in weight_curve, weight_curve() at Key::WarpCurve, as_slice() -> &[(usize, usize)], else Vec::new();
    /// Frames of A and B that must meet, as in `12-30,50-71`.
    Pins(Vec<(usize, usize)>) in pins, pins() at Key::Pins, as_slice() -> &[(usize, usize)], else Vec::new();
    /// An edited path, by its control points; `None` for the fitted one.
    EditedPath(Option<GroundSpline>) in edited_path, edited_path() at Key::Path, as_ref() -> Option<&GroundSpline>, else None;
    /// When to set off for which clip: seconds and the clip's index, as in `12.5:3,40:0`.
    Visits(Vec<(f64, usize)>) in visits, visits() at Key::GoTo, as_slice() -> &[(f64, usize)], else Vec::new();
    /// A line over the ground, x and z in metres, as in `0:0,1.5:4`.
    GroundPath(Vec<DVec2>) in ground_path, ground_path() at Key::WalkPath, as_slice() -> &[DVec2], else Vec::new();
    /// A transition of a graph: where one clip is left and where another one entered, as in
    /// `0:52-3:14`; `None` for none.
    Jump(Option<[Place; 2]>) in jump, jump() at Key::Jump, as_ref() -> Option<&[Place; 2]>, else None;
    /// Recorded input; `None` for none.
    Recording(Option<Recording>) in recording, recording() at Key::Drive, as_ref() -> Option<&Recording>, else None;
    /// Tags set by hand, as in `walk:0.2-1.5:exclude,run:0-1:-turn`.
    Tags(Vec<HandTag>) in tags, tags() at Key::Tags, as_slice() -> &[HandTag], else Vec::new();
}

impl From<List> for Value {
    fn from(list: List) -> Self {
        Self::List(list)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const KINDS: [ListKind; 10] = [
        ListKind::ClipIds,
        ListKind::WeightedClips,
        ListKind::WeightCurve,
        ListKind::Pins,
        ListKind::EditedPath,
        ListKind::Visits,
        ListKind::GroundPath,
        ListKind::Jump,
        ListKind::Recording,
        ListKind::Tags,
    ];

    #[test]
    fn empty_list_is_written_as_nothing() {
        for kind in KINDS {
            assert_eq!(kind.empty().write(), "", "{kind:?}");
            assert_eq!(kind.read(""), Ok(kind.empty()), "{kind:?}");
        }
    }

    #[test]
    fn list_of_a_link_is_written_as_it_stands() {
        for (kind, text) in [
            (ListKind::ClipIds, "walk,run(turn_rate:20,lean:2),my%2C walk.bvh~0a1b2c3d"),
            (ListKind::WeightedClips, "0.3:run,0.25:fast_walk"),
            (ListKind::WeightCurve, "0-0,50-100,100-0"),
            (ListKind::Pins, "50-71,12-30"),
            (ListKind::EditedPath, "AAUAAADIAfAByAF3yAF3rAI"),
            (ListKind::Visits, "40:0,12.5:1"),
            (ListKind::GroundPath, "0:0,1.5:-4"),
            (ListKind::Jump, "0:52-1:14"),
            (ListKind::Recording, "3c.0.s_1o.0.0"),
            (ListKind::Tags, "walk:0.2-1.5:exclude,run:0-1:-turn"),
        ] {
            assert_eq!(kind.read(text).map(|list| list.write()), Ok(text.to_owned()));
        }
    }

    proptest! {
        #[test]
        fn list_of_any_text_reads_back_as_written(
            kind in prop::sample::select(KINDS.as_slice()),
            text in prop_oneof!["[0-9:,.\\-a-z()% ]{0,40}", ".{0,40}", "([a-z(]{1,4}:)?[0-9]{1,3}[:-][0-9]{1,2}(:[a-z%]{1,4})?"],
        ) {
            if let Ok(list) = kind.read(&text) {
                prop_assert_eq!(kind.read(&list.write()), Ok(list));
            }
        }
    }
}
