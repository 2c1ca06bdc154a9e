//! The grammars of parameters that contain a list, one in each file: `read` names the place of an
//! entry that it cannot read, and `write` writes what `read` reads.
//!
//! A list is read once, with the link, the command or the id that contains it. Labs and panels use
//! its values. A list is written as it was read, except for spaces and the form of numbers.

mod addresses;
mod clip_ids;
mod contact_edits;
mod curve_list;
mod edited_path;
mod fault_places;
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
pub use contact_edits::ClipContacts;
pub use curve_list::MAX_MORE_CURVES;
pub use tags::HandTag;
pub use weighted_clips::MAX_WEIGHTED_CLIPS;

use super::choices::Curve;
use crate::outside::short;
use glam::DVec2;
use segue_motion::clean::FaultKind;
use segue_motion::graph::Place;
use segue_motion::matching::{Recording, RecordingError};
use segue_motion::path::{GroundSpline, PathEditError};

/// The reason why a text is not a list.
#[derive(Clone, Debug, PartialEq, thiserror::Error, segue_text::ToMessage)]
pub enum Misread {
    /// The text cannot be read as a whole.
    #[error("found `{found}`, expected {expected}", found = short(.found))]
    Text {
        /// The text that was found.
        found: String,
        /// A description of a valid text.
        expected: &'static str,
    },
    /// An entry cannot be read.
    #[error("entry {number}: found `{found}`, expected {expected}", found = short(.found))]
    Entry {
        /// Its number, counted from 1.
        number: usize,
        /// The text that was found.
        found: String,
        /// A description of a valid text.
        expected: &'static str,
    },
    /// There are too many entries.
    #[error("found {count} entries, expected {max} at most")]
    TooMany {
        /// The number of entries.
        count: usize,
        /// The greatest number of entries.
        max: usize,
    },
    /// The text is not a path.
    #[error(transparent)]
    Path(#[from] PathEditError),
    /// The text is not a recording.
    #[error(transparent)]
    Recording(#[from] RecordingError),
}

/// Reads every entry of a list of at most `max` entries.
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

/// Returns the entries between commas, without the spaces around them and without empty entries.
fn between_commas(text: &str) -> impl Iterator<Item = &str> {
    text.split(',').map(str::trim).filter(|entry| !entry.is_empty())
}

/// Writes the entries of a list, separated by commas.
fn joined<T>(entries: &[T], write: impl Fn(&T) -> String) -> String {
    entries.iter().map(write).collect::<Vec<_>>().join(",")
}

macro_rules! lists {
    ($(
        $(#[$doc:meta])*
        $kind:ident($list:ty) in $grammar:ident, else $none:expr;
    )*) => {
        /// The kinds of lists. The grammar of each is in a file of its own.
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        pub enum ListKind { $($(#[$doc])* $kind),* }

        /// The value of a parameter that is a list.
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
            /// Returns the kind of the list.
            #[must_use]
            pub const fn kind(&self) -> ListKind {
                match self { $(Self::$kind(_) => ListKind::$kind),* }
            }

            /// Writes the list as [`ListKind::read`] reads it.
            #[must_use]
            pub fn write(&self) -> String {
                match self { $(Self::$kind(list) => $grammar::write(list)),* }
            }
        }
    };
}

lists! {
    /// Ids of clips, as in `walk,blend(a:walk,b:run)`.
    ClipIds(Vec<String>) in clip_ids, else Vec::new();
    /// Clips and their weights, as in `0.3:run,0.2:fast_walk`.
    WeightedClips(Vec<(String, f64)>) in weighted_clips, else Vec::new();
    /// A weight over the course of a blend: per cent of the blend and per cent of B, as in
    /// `0-0,50-100`.
    WeightCurve(Vec<(usize, usize)>) in weight_curve, else Vec::new();
    /// Frames of A and B that must meet, as in `12-30,50-71`.
    Pins(Vec<(usize, usize)>) in pins, else Vec::new();
    /// An edited path, by its control points; `None` for the fitted one.
    EditedPath(Option<GroundSpline>) in edited_path, else None;
    /// Visits of clips: when to set off, seconds, and the clip's index, as in `12.5:3,40:0`.
    Visits(Vec<(f64, usize)>) in visits, else Vec::new();
    /// A line over the ground, x and z in metres, as in `0:0,1.5:4`.
    GroundPath(Vec<DVec2>) in ground_path, else Vec::new();
    /// A transition of a graph: the frame of the clip that is left, and that of the clip that is
    /// entered, as in `0:52-3:14`; `None` for none.
    Jump(Option<[Place; 2]>) in jump, else None;
    /// Recorded input; `None` for none.
    Recording(Option<Recording>) in recording, else None;
    /// Tags set by hand, as in `walk:0.2-1.5:exclude,run:0-1:-turn`.
    Tags(Vec<HandTag>) in tags, else Vec::new();
    /// Contacts of clips that are corrected by hand, as in `walk:L12-30;-R40-52`.
    ContactEdits(Vec<ClipContacts>) in contact_edits, else Vec::new();
    /// Faults that are left alone: kind and first frame, as in `spike-34,gap-120`.
    FaultPlaces(Vec<(FaultKind, usize)>) in fault_places, else Vec::new();
    /// Quantities that are plotted below the first, as in `height,angle`.
    Curves(Vec<Curve>) in curve_list, else Vec::new();
    /// Addresses of files on the web, separated by spaces.
    Addresses(Vec<String>) in addresses, else Vec::new();
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const KINDS: [ListKind; 14] = [
        ListKind::FaultPlaces,
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
        ListKind::ContactEdits,
        ListKind::Curves,
        ListKind::Addresses,
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
            (ListKind::ContactEdits, "walk:L12-30;-R40-52,run:R3-3"),
            (ListKind::Curves, "height,angle"),
            (ListKind::Addresses, "https://example.org/a.bvh http://example.org/b.bvh"),
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
