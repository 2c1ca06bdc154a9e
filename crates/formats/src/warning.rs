use super::text::position;
use segue_motion::clip::UpAxis;
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
        why: String,
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
        why: String,
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

/// `1 row` or `3 rows`.
fn number_of(count: usize, thing: &str) -> String {
    if count == 1 { format!("1 {thing}") } else { format!("{count} {thing}s") }
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
        let n = |thing: &str| number_of(self.count, thing);
        let one = self.count == 1;
        let place = match self.line {
            Some(line) if one => format!(" (line {line})"),
            Some(line) => format!(" (first: line {line})"),
            None => String::new(),
        };
        match &self.kind {
            WarningKind::Latin1Names => {
                write!(f, "{} not in UTF-8{place}; read as Latin-1", n("name"))
            }
            WarningKind::ChannelCount { declared, named } => {
                let lines = if one {
                    "1 CHANNELS line gives a number that disagrees"
                } else {
                    "CHANNELS lines give numbers that disagree"
                };
                let lines = if one { lines.to_owned() } else { format!("{} {lines}", self.count) };
                write!(
                    f,
                    "{lines} with the names after it{place}, such as {declared} for {named}; the names count"
                )
            }
            WarningKind::ScaleChannels => write!(f, "{}{place} ignored", n("scale channel")),
            WarningKind::EndSiteChannels => {
                write!(f, "{} of End Sites{place} ignored", n("channel"))
            }
            WarningKind::SeveralEndSites => {
                write!(f, "{} with more than one End Site{place}; one was kept", n("joint"))
            }
            WarningKind::MissingOffset => {
                write!(f, "{} without OFFSET{place}; placed on the parent", n("joint"))
            }
            WarningKind::NoFrames => write!(f, "the file holds a skeleton and no motion"),
            WarningKind::FrameCount { declared, found } => {
                write!(
                    f,
                    "the header says {declared} frames{place}, the file holds {found}; the rows count"
                )
            }
            WarningKind::FrameTime { found: None } => {
                write!(f, "no frame time; 30 frames per second are taken")
            }
            WarningKind::FrameTime { found: Some(found) } => {
                write!(
                    f,
                    "a frame time of {found} is no time{place}; 30 frames per second are taken"
                )
            }
            WarningKind::UnlikelyFrameTime { secs } => {
                write!(
                    f,
                    "a frame time of {secs} s is unlikely{place}; taken as written, the frame rate can be set by hand"
                )
            }
            WarningKind::TruncatedRow { found, expected } => {
                write!(
                    f,
                    "the last row holds {} instead of {expected}{place}; dropped",
                    number_of(*found, "number")
                )
            }
            WarningKind::RowsAcrossLines => write!(
                f,
                "no line holds exactly one frame{place}; the numbers were read one after the other"
            ),
            WarningKind::NotFinite => {
                write!(f, "{} without a number{place}; the last good value was held", n("value"))
            }
            WarningKind::DecimalCommas => {
                write!(f, "the numbers have decimal commas{place}; read as points")
            }
            WarningKind::MissingSpaces => {
                write!(f, "{} between numbers{place}; split before the sign", n("missing space"))
            }
            WarningKind::HiddenFiles => write!(f, "{} of the archive left out", n("hidden file")),
            WarningKind::OtherFiles => {
                write!(f, "{} of the archive without motion left out", n("file"))
            }
            WarningKind::TooManyFiles { most } => {
                write!(f, "{} of the archive left out: the first {most} are read", n("motion file"))
            }
            WarningKind::PathsOutside => write!(
                f,
                "{} of the archive with a path out of it; the rest of the path was taken",
                n("file")
            ),
            WarningKind::UnreadableFiles { path, why } if one => {
                write!(f, "`{path}` in the archive left out: {why}")
            }
            WarningKind::UnreadableFiles { path, why } => {
                write!(f, "{} of the archive left out, the first: `{path}`, {why}", n("file"))
            }
            WarningKind::ScaleAnimation => write!(f, "{} ignored", n("animated scale")),
            WarningKind::UnevenScale => write!(
                f,
                "{} scaled by a different factor along each axis; joints below are exact at rest and near in motion",
                n("node")
            ),
            WarningKind::Resampled { fps } => {
                write!(f, "the keys have no common rate; sampled at {fps} frames per second")
            }
            WarningKind::NotMetres { metres_per_unit } => {
                write!(
                    f,
                    "the body is far too large for metres; units of {metres_per_unit} m are taken"
                )
            }
            WarningKind::RestFromFirstRow => {
                write!(f, "all OFFSETs are zero; the rest pose was taken from the first row")
            }
            WarningKind::TPose { dropped: true } => {
                write!(f, "the first row is a T-pose{place}; dropped")
            }
            WarningKind::TPose { dropped: false } => {
                write!(f, "the first row is a T-pose{place}; kept and marked")
            }
            WarningKind::AssumedFrameRate { fps } => {
                write!(
                    f,
                    "the format has no frame rate; {fps} frames per second are taken, it can be set by hand"
                )
            }
            WarningKind::FrameNumbers => write!(
                f,
                "{} out of order{place}; frames were taken as they come",
                n("frame number")
            ),
            WarningKind::MissingBones => {
                write!(f, "{}{place} without some of the bones; their pose was held", n("frame"))
            }
            WarningKind::UnknownBones { name } => {
                write!(
                    f,
                    "{} of the motion{place} not in the skeleton, such as `{name}`; left out",
                    n("bone")
                )
            }
            WarningKind::ValueCount { name, found, expected } => write!(
                f,
                "{}{place} with more or fewer values than the skeleton has degrees of freedom, such as {found} for the {expected} of `{name}`; \
                 left at rest",
                n("bone")
            ),
            WarningKind::RestingBones { name } => {
                write!(
                    f,
                    "{} of the skeleton without values in the motion, such as `{name}`; left at rest",
                    n("bone")
                )
            }
            WarningKind::UnknownInHierarchy { name } => {
                write!(
                    f,
                    "{} in the hierarchy{place} without bone, such as `{name}`; left out",
                    n("name")
                )
            }
            WarningKind::LooseBones { name } => {
                write!(f, "{}{place} not below the root, such as `{name}`; left out", n("bone"))
            }
            WarningKind::OffGround { metres } => write!(
                f,
                "the feet never come nearer than {:.0} cm {} the ground; the skeleton may be that of another person",
                metres.abs() * 100.0,
                if *metres > 0.0 { "above" } else { "below" }
            ),
            WarningKind::Textures => {
                write!(f, "{} left out; the plain colour was taken", n("texture"))
            }
            WarningKind::MorphTargets => {
                write!(f, "{} with morph targets; they keep their shape", n("surface"))
            }
            WarningKind::BrokenMesh { why } => {
                write!(f, "{} left out; the first has {why}", n("surface"))
            }
            WarningKind::UncertainUp { up } => {
                let axis = match up {
                    UpAxis::Y => "Y",
                    UpAxis::Z => "Z",
                };
                write!(f, "the motion does not tell which axis points up; {axis} is taken")
            }
            WarningKind::UnlikelyHeight { metres } => {
                write!(f, "the body is {} tall: its unit may be another one", length(*metres))
            }
            WarningKind::WildRows { metres, evened: false } => {
                write!(
                    f,
                    "{} with a root that is {} away for that row alone",
                    n("row"),
                    length(*metres)
                )
            }
            WarningKind::WildRows { metres, evened: true } => write!(
                f,
                "{} with a root that is {} away for that row alone; put between its neighbours",
                n("row"),
                length(*metres)
            ),
            WarningKind::RootJumps { metres } => {
                write!(
                    f,
                    "{} of the root from one frame to the next, up to {}",
                    n("jump"),
                    length(*metres)
                )
            }
            WarningKind::FarAway { metres } => {
                write!(f, "the root goes {} away from the origin", length(*metres))
            }
            WarningKind::UnknownUnit => {
                write!(f, "the size of the skeleton fits no unit of length; centimetres are taken")
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
