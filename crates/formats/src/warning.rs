//! Warnings about oddities of files that were read.

mod sentences;

use super::text::position;
use segue_motion::clip::UpAxis;
use segue_text::Message;

/// A kind of oddity in a file that could be read nevertheless, or a note on how it was read.
#[derive(Clone, Debug, PartialEq)]
pub enum WarningKind {
    /// Names that are not UTF-8.
    Latin1Names,
    /// A CHANNELS line with another number of channels than names. The names count.
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
    /// A joint with more than one End Site: the first one that is not at the joint itself is kept.
    SeveralEndSites,
    /// A joint without an OFFSET line.
    MissingOffset,
    /// A file without a MOTION section, or without rows in it.
    NoFrames,
    /// A number at `Frames:` that is not the number of rows. The rows count.
    FrameCount {
        /// The number in the header.
        declared: String,
        /// The number of rows.
        found: usize,
    },
    /// A `Frame Time:` that is missing or not a time. 30 frames per second are assumed.
    FrameTime {
        /// The text in the header; `None` where there is none.
        found: Option<String>,
    },
    /// A `Frame Time:` that is longer than a second or shorter than a ten-thousandth of one. It is
    /// used unchanged.
    UnlikelyFrameTime {
        /// Seconds.
        secs: f64,
    },
    /// A truncated last row: dropped.
    TruncatedRow {
        /// The number of its values.
        found: usize,
        /// The number of values of a complete row.
        expected: usize,
    },
    /// No line with exactly one frame: the numbers are read one after the other.
    RowsAcrossLines,
    /// Values that are not numbers: each repeats the last good value of its channel.
    NotFinite,
    /// Numbers with a decimal comma.
    DecimalCommas,
    /// Two numbers without a space between them: split before the sign.
    MissingSpaces,
    /// Hidden files of an archive, and metadata that macOS adds: left out.
    HiddenFiles,
    /// Files of an archive without motion: left out.
    OtherFiles,
    /// More motion files in an archive than the limit: left out.
    TooManyFiles {
        /// The limit.
        most: usize,
    },
    /// Files of an archive with a path that leads out of it: the rest of the path is used.
    PathsOutside,
    /// Files of an archive that cannot be read: left out.
    UnreadableFiles {
        /// The first of them.
        path: String,
        /// Why it cannot be read.
        why: Message,
    },
    /// Animated scales: the scale at rest is used.
    ScaleAnimation,
    /// Nodes with a different scale along each axis: the joints below them are exact at rest, and
    /// nearly so in motion.
    UnevenScale,
    /// Keys of an animation that fit no common frame rate: the animation is resampled.
    Resampled {
        /// Frames per second.
        fps: f64,
    },
    /// A body whose size does not fit the unit of its format, metres.
    NotMetres {
        /// Metres per unit.
        metres_per_unit: f64,
    },
    /// A unit that the file states and that does not fit the body: another is used.
    UnitOfFile {
        /// The height of the body in the stated unit, metres.
        metres: f64,
        /// Metres per unit, as used.
        metres_per_unit: f64,
    },
    /// Keys outside of the span of their take: left out.
    OutsideTake {
        /// Seconds, of the first such take.
        secs: f64,
    },
    /// Constraints of an animation program: not evaluated.
    Constraints,
    /// OFFSETs that are all zero: the rest pose is taken from the position channels of the first
    /// row.
    RestFromFirstRow,
    /// A T-pose in the first row, in front of the motion.
    TPose {
        /// Whether it was left out.
        dropped: bool,
    },
    /// A format without a frame rate: this one is assumed.
    AssumedFrameRate {
        /// Frames per second.
        fps: f64,
    },
    /// Frame numbers that are not consecutive. Frames are used in the order of the file.
    FrameNumbers,
    /// Frames without bones that earlier frames have: their pose is held.
    MissingBones,
    /// Bones of the motion that the skeleton does not have: left out.
    UnknownBones {
        /// The first of them.
        name: String,
    },
    /// Bones whose number of values is not their number of degrees of freedom: they stay at rest.
    ValueCount {
        /// The first of them.
        name: String,
        /// Its values in the motion.
        found: usize,
        /// Its degrees of freedom.
        expected: usize,
    },
    /// Bones of the skeleton that can move but have no values in the motion: they stay at rest.
    RestingBones {
        /// The first of them.
        name: String,
    },
    /// Names in the hierarchy that belong to no bone: left out.
    UnknownInHierarchy {
        /// The first of them.
        name: String,
    },
    /// Bones that are not connected to the root: left out.
    LooseBones {
        /// The first of them.
        name: String,
    },
    /// Feet far from the ground: the skeleton may be that of another person.
    OffGround {
        /// The height of the feet over the ground, metres.
        metres: f32,
    },
    /// A body of a size that people do not have.
    UnlikelyHeight {
        /// Its height, metres.
        metres: f64,
    },
    /// Single rows in which a joint is far from its positions before and after.
    WildRows {
        /// The joint, or the one that is farthest away of several; `None` for the root.
        joint: Option<String>,
        /// The farthest jump, metres.
        metres: f64,
        /// Whether these positions were replaced by positions between their neighbours.
        evened: bool,
    },
    /// Rows with an angle of more than a hundred turns.
    WildAngles {
        /// The largest angle, degrees.
        degrees: f64,
    },
    /// A joint that jumps from one frame to the next and stays there.
    Jumps {
        /// The joint, or the one that jumps farthest of several; `None` for the root.
        joint: Option<String>,
        /// The farthest jump, metres.
        metres: f64,
    },
    /// A root far from the origin, or a joint far from its parent.
    FarAway {
        /// The joint, or the farthest of several; `None` for the root.
        joint: Option<String>,
        /// The greatest distance, metres.
        metres: f64,
    },
    /// A skeleton that is the size of a person in no unit of length: centimetres are assumed.
    UnknownUnit,
    /// An up axis that neither the limbs nor the floor determine, as for a lying body: this one is
    /// assumed.
    UncertainUp {
        /// The assumed axis.
        up: UpAxis,
    },
    /// Joints that were computed from the labelled points of the file.
    SkeletonFromPoints {
        /// The number of points used.
        markers: usize,
        /// The number of points in the file.
        of: usize,
        /// The mean distance between joints and their points, millimetres.
        error_mm: f64,
    },
    /// Points whose labels show no body: each is a joint without bone.
    PointsOnly {
        /// Their number.
        points: usize,
    },
    /// Points that are missing in some frames.
    FilledGaps {
        /// The number of such points.
        points: usize,
        /// Positions in short gaps, put between their neighbours.
        filled: usize,
        /// Positions in long gaps, where the pose was interpolated or held.
        held: usize,
        /// The longest gap, frames.
        longest: usize,
    },
    /// Cells of a table that are no numbers: gaps.
    NotNumbers {
        /// The first of them, quoted.
        text: String,
    },
    /// Quaternions without names, in which the robot stands upright with the scalar first and last.
    QuaternionOrder {
        /// Whether they were read with the scalar first.
        scalar_first: bool,
    },
    /// Hinges beyond their limits: kept.
    BeyondLimits {
        /// The one that goes furthest.
        joint: String,
        /// The number of frames in which it does.
        frames: usize,
        /// The first of them.
        first: usize,
        /// How far it goes, degrees.
        degrees: f64,
    },
    /// Points that are missing in every frame: left out.
    UnseenPoints {
        /// The first of them.
        name: String,
    },
    /// A motion without a body: bones of a generic length are used.
    GenericBody,
    /// Places of joints between which the bones change their lengths.
    ChangingBones {
        /// The mean distance of the joints from their places, millimetres.
        error_mm: f64,
    },
    /// A motion without a path: the body stays in its place.
    NoPath,
    /// Quaternions whose order the values do not show: the scalar is taken as the first component.
    UnclearQuaternions,
    /// Images of materials that cannot be read: ignored, the base colour is used.
    Textures,
    /// Images of materials that are neither in the file nor beside it: the base colour is used.
    MissingImage {
        /// The name of the first of them.
        name: String,
    },
    /// Meshes with morph targets: they keep the shape that the file's weights give them.
    MorphTargets,
    /// Meshes that are compressed by Draco: left out.
    PackedMesh,
    /// Animated expressions and directions of the eyes: left out.
    FaceAnimation,
    /// A bone map of a humanoid that is not as specified: the joints are found by their names.
    BrokenBoneMap {
        /// The reason.
        why: String,
    },
    /// Meshes whose skin cannot be read: left out.
    BrokenMesh {
        /// The reason for the first of them.
        why: Message,
    },
}

/// One line about one kind of oddity.
#[derive(Clone, Debug, PartialEq)]
pub struct ImportWarning {
    /// The kind, with the details of the first occurrence.
    pub kind: WarningKind,
    /// The number of occurrences; at least 1.
    pub count: usize,
    /// The line of the first occurrence, from 1; `None` where it concerns the whole file.
    pub line: Option<usize>,
}

/// Counts of oddities while a file is read; places are byte offsets until the end.
#[derive(Clone, Debug, Default)]
pub(super) struct Tally {
    entries: Vec<(WarningKind, usize, Option<usize>)>,
}

impl Tally {
    /// Counts one oddity. Those of one kind become one line, with the details and the place of the
    /// first.
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
    fn tally_of_one_kind_is_one_line() {
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
                "the file has a skeleton but no animation"
            ]
        );
    }

    #[test]
    fn warning_displays_as_a_sentence() {
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
