//! Warnings about oddities of files that were read.

use super::text::position;
use segue_motion::clip::UpAxis;
use segue_text::{Message, ToMessage, msg};
use std::fmt;

/// A kind of oddity that a file was read in spite of, or a note on how it was read.
#[derive(Clone, Debug, PartialEq)]
pub enum WarningKind {
    /// Names are no UTF-8.
    Latin1Names,
    /// A joint's CHANNELS line gives another number than it has names. The names count.
    ChannelCount {
        /// The number in the file.
        declared: String,
        /// The number of names after it.
        named: usize,
    },
    /// Scale channels: their values are skipped.
    ScaleChannels,
    /// An End Site with channels: their values are skipped.
    EndSiteChannels,
    /// A joint has more than one End Site: the first one that is not at the joint itself is kept.
    SeveralEndSites,
    /// A joint has no OFFSET line.
    MissingOffset,
    /// There is no MOTION section, or no row in it.
    NoFrames,
    /// `Frames:` gives another number than there are rows. The rows count.
    FrameCount {
        /// What the header says.
        declared: String,
        /// The rows that there are.
        found: usize,
    },
    /// `Frame Time:` is missing or no time. 30 frames per second are taken.
    FrameTime {
        /// What the header says; `None` where it says nothing.
        found: Option<String>,
    },
    /// `Frame Time:` is longer than a second or shorter than a ten-thousandth of one, and taken as
    /// it is.
    UnlikelyFrameTime {
        /// Seconds.
        secs: f64,
    },
    /// The last row is cut off, and dropped.
    TruncatedRow {
        /// The numbers that it has.
        found: usize,
        /// The numbers of a row.
        expected: usize,
    },
    /// No line holds exactly one frame: the numbers are taken one after the other.
    RowsAcrossLines,
    /// Values that are no numbers: each repeats the last good one of its channel.
    NotFinite,
    /// Numbers are written with a decimal comma.
    DecimalCommas,
    /// Two numbers without a space between them, split before the sign.
    MissingSpaces,
    /// Hidden files of an archive, and what a Mac adds to it: left out.
    HiddenFiles,
    /// Files of an archive that hold no motion: left out.
    OtherFiles,
    /// More motion files in an archive than are read: left out.
    TooManyFiles {
        /// How many are read.
        most: usize,
    },
    /// Files of an archive with a path that leads out of it: the rest of the path counts.
    PathsOutside,
    /// Files of an archive that cannot be read: left out.
    UnreadableFiles {
        /// The first of them.
        path: String,
        /// Why it cannot be read.
        why: Message,
    },
    /// Animated scales: the scale at rest is taken.
    ScaleAnimation,
    /// Nodes that are scaled by another factor along each axis: joints below them are where they
    /// should be at rest, and nearly so in motion.
    UnevenScale,
    /// The keys of an animation lie at no common rate that can be played: it is sampled.
    Resampled {
        /// Frames per second.
        fps: f64,
    },
    /// A format that is made for metres holds a body of another size.
    NotMetres {
        /// Metres per unit.
        metres_per_unit: f64,
    },
    /// All OFFSETs are zero: the rest pose is taken from the position channels of the first row.
    RestFromFirstRow,
    /// The first row is a T-pose in front of the motion.
    TPose {
        /// Whether it was left out.
        dropped: bool,
    },
    /// The format has no frame rate: this one is taken.
    AssumedFrameRate {
        /// Frames per second.
        fps: f64,
    },
    /// Frame numbers that do not follow each other. Frames count as they come.
    FrameNumbers,
    /// Frames that leave out bones which frames before them have: their pose is held.
    MissingBones,
    /// Bones of the motion that the skeleton does not have: left out.
    UnknownBones {
        /// The first of them.
        name: String,
    },
    /// Bones with another number of values than the skeleton has degrees of freedom for: they rest.
    ValueCount {
        /// The first of them.
        name: String,
        /// Its values in the motion.
        found: usize,
        /// Its degrees of freedom.
        expected: usize,
    },
    /// Bones of the skeleton that can move, and of which the motion says nothing: they rest.
    RestingBones {
        /// The first of them.
        name: String,
    },
    /// Names in the hierarchy that no bone has: left out.
    UnknownInHierarchy {
        /// The first of them.
        name: String,
    },
    /// Bones that do not hang on the root: left out.
    LooseBones {
        /// The first of them.
        name: String,
    },
    /// The lowest point of the motion is far from the ground: the skeleton may be that of another
    /// person.
    OffGround {
        /// Its height over the ground, metres.
        metres: f32,
    },
    /// A body of no size that people have.
    UnlikelyHeight {
        /// Its height, metres.
        metres: f64,
    },
    /// Single rows in which the root is far from where it is before and after.
    WildRows {
        /// The farthest jump, metres.
        metres: f64,
        /// Whether they got a place between their neighbours.
        evened: bool,
    },
    /// The root jumps from one frame to the next, and stays there.
    RootJumps {
        /// The farthest jump, metres.
        metres: f64,
    },
    /// The root goes far from the origin.
    FarAway {
        /// How far, metres.
        metres: f64,
    },
    /// No unit of length makes this skeleton the size of a person: centimetres are taken.
    UnknownUnit,
    /// Neither the limbs nor the floor tell which axis points up, as for a body that lies: this one
    /// is taken.
    UncertainUp {
        /// The axis that was taken.
        up: UpAxis,
    },
    /// Images of materials: the colour without them is taken.
    Textures,
    /// Meshes that change their shape by morph targets: they keep the one they have.
    MorphTargets,
    /// Meshes with a skin that cannot be read: left out.
    BrokenMesh {
        /// Why the first of them cannot be read.
        why: Message,
    },
}

/// One line on one kind of oddity.
#[derive(Clone, Debug, PartialEq)]
pub struct ImportWarning {
    /// What it is.
    pub kind: WarningKind,
    /// How often it occurs; at least 1.
    pub count: usize,
    /// The line, counted from 1, where it occurs first; `None` where it is about the whole file.
    pub line: Option<usize>,
}

/// A length that may be of any size, with its unit.
fn length(metres: f64) -> String {
    match metres {
        0.1..10.0 => format!("{metres:.1} m"),
        10.0..1e6 => format!("{metres:.0} m"),
        _ => format!("{metres:.1e} m"),
    }
}

impl fmt::Display for ImportWarning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.to_message().fmt(f)
    }
}

impl ToMessage for ImportWarning {
    fn to_message(&self) -> Message {
        let count = self.count;
        let one = count == 1;
        let place = match self.line {
            Some(line) if one => msg!(" (line {line})"),
            Some(line) => msg!(" (first: line {line})"),
            None => Message::default(),
        };
        match &self.kind {
            WarningKind::Latin1Names => {
                msg!(
                    "{count, plural, one {# name} other {# names}} not in UTF-8{place}; read as Latin-1"
                )
            }
            WarningKind::ChannelCount { declared, named } => {
                msg!(
                    "{count, plural, one {# CHANNELS line gives a number that disagrees} other {# CHANNELS lines give numbers that disagree}} with the names after it{place}, such as {declared} for {named}; the names count"
                )
            }
            WarningKind::ScaleChannels => msg!(
                "{count, plural, one {# scale channel} other {# scale channels}}{place} ignored"
            ),
            WarningKind::EndSiteChannels => {
                msg!(
                    "{count, plural, one {# channel} other {# channels}} of End Sites{place} ignored"
                )
            }
            WarningKind::SeveralEndSites => {
                msg!(
                    "{count, plural, one {# joint} other {# joints}} with more than one End Site{place}; one was kept"
                )
            }
            WarningKind::MissingOffset => {
                msg!(
                    "{count, plural, one {# joint} other {# joints}} without OFFSET{place}; placed on the parent"
                )
            }
            WarningKind::NoFrames => msg!("the file holds a skeleton and no motion"),
            WarningKind::FrameCount { declared, found } => {
                msg!(
                    "the header says {declared} frames{place}, the file holds {found}; the rows count"
                )
            }
            WarningKind::FrameTime { found: None } => {
                msg!("no frame time; 30 frames per second are taken")
            }
            WarningKind::FrameTime { found: Some(found) } => {
                msg!("a frame time of {found} is no time{place}; 30 frames per second are taken")
            }
            WarningKind::UnlikelyFrameTime { secs } => {
                msg!(
                    "a frame time of {secs} s is unlikely{place}; taken as written, the frame rate can be set by hand"
                )
            }
            WarningKind::TruncatedRow { found, expected } => {
                msg!(
                    "the last row holds {found, plural, one {# number} other {# numbers}} instead of {expected}{place}; dropped"
                )
            }
            WarningKind::RowsAcrossLines => msg!(
                "no line holds exactly one frame{place}; the numbers were read one after the other"
            ),
            WarningKind::NotFinite => {
                msg!(
                    "{count, plural, one {# value} other {# values}} without a number{place}; the last good value was held"
                )
            }
            WarningKind::DecimalCommas => {
                msg!("the numbers have decimal commas{place}; read as points")
            }
            WarningKind::MissingSpaces => {
                msg!(
                    "{count, plural, one {# missing space} other {# missing spaces}} between numbers{place}; split before the sign"
                )
            }
            WarningKind::HiddenFiles => msg!(
                "{count, plural, one {# hidden file} other {# hidden files}} of the archive left out"
            ),
            WarningKind::OtherFiles => {
                msg!(
                    "{count, plural, one {# file} other {# files}} of the archive without motion left out"
                )
            }
            WarningKind::TooManyFiles { most } => {
                msg!(
                    "{count, plural, one {# motion file} other {# motion files}} of the archive left out: the first {most} are read"
                )
            }
            WarningKind::PathsOutside => msg!(
                "{count, plural, one {# file} other {# files}} of the archive with a path out of it; the rest of the path was taken"
            ),
            WarningKind::UnreadableFiles { path, why } if one => {
                msg!("`{path}` in the archive left out: {why}")
            }
            WarningKind::UnreadableFiles { path, why } => {
                msg!(
                    "{count, plural, one {# file} other {# files}} of the archive left out, the first: `{path}`, {why}"
                )
            }
            WarningKind::ScaleAnimation => {
                msg!("{count, plural, one {# animated scale} other {# animated scales}} ignored")
            }
            WarningKind::UnevenScale => msg!(
                "{count, plural, one {# node} other {# nodes}} scaled by a different factor along each axis; joints below are exact at rest and near in motion"
            ),
            WarningKind::Resampled { fps } => {
                msg!("the keys have no common rate; sampled at {fps} frames per second")
            }
            WarningKind::NotMetres { metres_per_unit } => {
                msg!("the body is far too large for metres; units of {metres_per_unit} m are taken")
            }
            WarningKind::RestFromFirstRow => {
                msg!("all OFFSETs are zero; the rest pose was taken from the first row")
            }
            WarningKind::TPose { dropped: true } => {
                msg!("the first row is a T-pose{place}; dropped")
            }
            WarningKind::TPose { dropped: false } => {
                msg!("the first row is a T-pose{place}; kept and marked")
            }
            WarningKind::AssumedFrameRate { fps } => {
                msg!(
                    "the format has no frame rate; {fps} frames per second are taken, it can be set by hand"
                )
            }
            WarningKind::FrameNumbers => msg!(
                "{count, plural, one {# frame number} other {# frame numbers}} out of order{place}; frames were taken as they come"
            ),
            WarningKind::MissingBones => {
                msg!(
                    "{count, plural, one {# frame} other {# frames}}{place} without some of the bones; their pose was held"
                )
            }
            WarningKind::UnknownBones { name } => {
                msg!(
                    "{count, plural, one {# bone} other {# bones}} of the motion{place} not in the skeleton, such as `{name}`; left out"
                )
            }
            WarningKind::ValueCount { name, found, expected } => msg!(
                "{count, plural, one {# bone} other {# bones}}{place} with more or fewer values than the skeleton has degrees of freedom, such as {found} for the {expected} of `{name}`; left at rest"
            ),
            WarningKind::RestingBones { name } => {
                msg!(
                    "{count, plural, one {# bone} other {# bones}} of the skeleton without values in the motion, such as `{name}`; left at rest"
                )
            }
            WarningKind::UnknownInHierarchy { name } => {
                msg!(
                    "{count, plural, one {# name} other {# names}} in the hierarchy{place} without bone, such as `{name}`; left out"
                )
            }
            WarningKind::LooseBones { name } => {
                msg!(
                    "{count, plural, one {# bone} other {# bones}}{place} not below the root, such as `{name}`; left out"
                )
            }
            WarningKind::OffGround { metres } => msg!(
                "the feet never come nearer than {cm:.0} cm {side} the ground; the skeleton may be that of another person",
                cm = metres.abs() * 100.0,
                side = if *metres > 0.0 { "above" } else { "below" }
            ),
            WarningKind::Textures => {
                msg!(
                    "{count, plural, one {# texture} other {# textures}} left out; the plain colour was taken"
                )
            }
            WarningKind::MorphTargets => {
                msg!(
                    "{count, plural, one {# surface} other {# surfaces}} with morph targets; they keep their shape"
                )
            }
            WarningKind::BrokenMesh { why } => {
                msg!(
                    "{count, plural, one {# surface} other {# surfaces}} left out; the first has {why}"
                )
            }
            WarningKind::UncertainUp { up } => {
                let axis = match up {
                    UpAxis::Y => "Y",
                    UpAxis::Z => "Z",
                };
                msg!("the motion does not tell which axis points up; {axis} is taken")
            }
            WarningKind::UnlikelyHeight { metres } => {
                msg!(
                    "the body is {metres} tall: its unit may be another one",
                    metres = length(*metres)
                )
            }
            WarningKind::WildRows { metres, evened: false } => {
                msg!(
                    "{count, plural, one {# row} other {# rows}} with a root that is {metres} away for that row alone",
                    metres = length(*metres)
                )
            }
            WarningKind::WildRows { metres, evened: true } => msg!(
                "{count, plural, one {# row} other {# rows}} with a root that is {metres} away for that row alone; put between its neighbours",
                metres = length(*metres)
            ),
            WarningKind::RootJumps { metres } => {
                msg!(
                    "{count, plural, one {# jump} other {# jumps}} of the root from one frame to the next, up to {metres}",
                    metres = length(*metres)
                )
            }
            WarningKind::FarAway { metres } => {
                msg!("the root goes {metres} away from the origin", metres = length(*metres))
            }
            WarningKind::UnknownUnit => {
                msg!("the size of the skeleton fits no unit of length; centimetres are taken")
            }
        }
    }
}

/// Oddities while they are counted; places are byte offsets until the end.
#[derive(Clone, Debug, Default)]
pub(super) struct Tally {
    entries: Vec<(WarningKind, usize, Option<usize>)>,
}

impl Tally {
    /// Counts one oddity. Those of one kind become one line, which keeps the details and the place
    /// of the first.
    pub(super) fn add(&mut self, kind: WarningKind, at: Option<usize>) {
        let same = |entry: &&mut (WarningKind, usize, Option<usize>)| {
            std::mem::discriminant(&entry.0) == std::mem::discriminant(&kind)
        };
        match self.entries.iter_mut().find(same) {
            Some((_, count, _)) => *count += 1,
            None => self.entries.push((kind, 1, at)),
        }
    }

    pub(super) fn into_warnings(self, text: &[u8]) -> Vec<ImportWarning> {
        let warning = |(kind, count, at): (_, _, Option<usize>)| ImportWarning {
            kind,
            count,
            line: at.map(|at| position(text, at).0),
        };
        self.entries.into_iter().map(warning).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_line_for_each_kind() {
        let mut tally = Tally::default();
        tally.add(WarningKind::MissingSpaces, Some(2));
        tally.add(WarningKind::NoFrames, None);
        tally.add(WarningKind::MissingSpaces, Some(4));
        let lines: Vec<String> =
            tally.into_warnings(b"a\nb\nc").iter().map(ToString::to_string).collect();
        assert_eq!(
            lines,
            [
                "2 missing spaces between numbers (first: line 2); split before the sign",
                "the file holds a skeleton and no motion"
            ]
        );
    }

    #[test]
    fn the_sentences_are_plain() {
        let say = |kind, count, line| ImportWarning { kind, count, line }.to_string();
        let row = WarningKind::TruncatedRow { found: 95, expected: 96 };
        assert_eq!(
            say(row, 1, Some(412)),
            "the last row holds 95 numbers instead of 96 (line 412); dropped"
        );
        let channels = || WarningKind::ChannelCount { declared: "3".into(), named: 6 };
        assert_eq!(
            say(channels(), 1, Some(5)),
            "1 CHANNELS line gives a number that disagrees with the names after it (line 5), such as 3 for 6; the names count"
        );
        assert!(
            say(channels(), 2, Some(5)).starts_with("2 CHANNELS lines give numbers that disagree")
        );
        assert_eq!(
            say(WarningKind::NotFinite, 1, Some(9)),
            "1 value without a number (line 9); the last good value was held"
        );
    }
}
