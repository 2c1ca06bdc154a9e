//! The sentences about oddities of files.

use super::{ImportWarning, WarningKind};
use segue_motion::clip::UpAxis;
use segue_text::{Message, ToMessage, msg};
use std::fmt;

/// Formats a length of any magnitude with its unit.
fn length(metres: f64) -> String {
    format!("{} m", brief(metres))
}

/// Returns a number with few digits.
fn brief(number: f64) -> String {
    match number {
        0.1..10.0 => format!("{number:.1}"),
        10.0..1e6 => format!("{number:.0}"),
        _ => format!("{number:.1e}"),
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
            WarningKind::NoFrames => msg!("the file has a skeleton but no animation"),
            WarningKind::FrameCount { declared, found } => {
                msg!(
                    "the header says {declared} frames{place}, the file holds {found}; the rows count"
                )
            }
            WarningKind::FrameTime { found: None } => {
                msg!("no frame time; 30 frames per second are assumed")
            }
            WarningKind::FrameTime { found: Some(found) } => {
                msg!(
                    "a frame time of {found} is not a time{place}; 30 frames per second are assumed"
                )
            }
            WarningKind::UnlikelyFrameTime { secs } => {
                msg!(
                    "a frame time of {secs} s is unlikely{place}; used as written, the frame rate can be set by hand"
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
                "{count, plural, one {# file} other {# files}} of the archive with a path that leads out of it; the rest of the path was used"
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
                "{count, plural, one {# node} other {# nodes}} scaled by a different factor along each axis; joints below are exact at rest and approximate in motion"
            ),
            WarningKind::Resampled { fps } => {
                msg!("the keys have no common rate; sampled at {fps} frames per second")
            }
            WarningKind::NotMetres { metres_per_unit } => {
                msg!(
                    "the body is far too large for metres; units of {metres_per_unit} m are assumed"
                )
            }
            WarningKind::UnitOfFile { metres, metres_per_unit } => {
                msg!(
                    "the body would be {metres} tall in the unit of the file; units of {metres_per_unit} m are assumed",
                    metres = length(*metres)
                )
            }
            WarningKind::OutsideTake { secs } => {
                msg!(
                    "{count, plural, one {# take has} other {# takes have}} keys outside of its span, up to {secs:.1} s; left out"
                )
            }
            WarningKind::Constraints => {
                msg!(
                    "{count, plural, one {# constraint} other {# constraints}} not evaluated; bake the animation before the export if limbs stand still"
                )
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
                    "the format has no frame rate; {fps} frames per second are assumed, the rate can be set by hand"
                )
            }
            WarningKind::FrameNumbers => msg!(
                "{count, plural, one {# frame number} other {# frame numbers}} out of order{place}; frames are used in the order of the file"
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
            WarningKind::GenericBody => msg!(
                "the file has no body: the angles are true, the bones are those of a generic one; open the SMPL model (.npz) as well for the true ones"
            ),
            WarningKind::ChangingBones { error_mm } => msg!(
                "the bones change their lengths in the file; with fixed lengths, the joints lie {error_mm:.0} mm from their places on average"
            ),
            WarningKind::NoPath => {
                msg!("the file has no path of the body; it stays in its place")
            }
            WarningKind::UnclearQuaternions => {
                msg!("the values do not show the order of the quaternions; w x y z is assumed")
            }
            WarningKind::Textures => {
                msg!(
                    "imported without {count, plural, one {# texture} other {# textures}}: the plain colour is used"
                )
            }
            WarningKind::MissingImage { name } => msg!(
                "imported without {count, plural, one {# texture} other {# textures}} whose image is not in the file, such as `{name}`: open them together; the plain colour is used"
            ),
            WarningKind::MorphTargets => {
                msg!(
                    "{count, plural, one {# mesh keeps} other {# meshes keep}} one shape: morph targets stay at the weights of the file"
                )
            }
            WarningKind::PackedMesh => msg!(
                "imported without {count, plural, one {# mesh} other {# meshes}} that Draco compressed: save the file without compression"
            ),
            WarningKind::FaceAnimation => msg!(
                "imported without {count, plural, one {# animation} other {# animations}} of expressions or of the eyes"
            ),
            WarningKind::BrokenBoneMap { why } => msg!(
                "the bone map of the file cannot be read ({why}); body parts were found by names and shape"
            ),
            WarningKind::BrokenMesh { why } => {
                msg!(
                    "imported without {count, plural, one {# mesh} other {# meshes}}; the first has {why}"
                )
            }
            WarningKind::UncertainUp { up } => {
                let axis = match up {
                    UpAxis::Y => "Y",
                    UpAxis::Z => "Z",
                };
                msg!("the motion does not show which axis points up; {axis} is assumed")
            }
            WarningKind::UnlikelyHeight { metres } => {
                msg!("the body is {metres} tall: its unit may be wrong", metres = length(*metres))
            }
            WarningKind::WildRows { joint: None, metres, evened: false } => {
                msg!(
                    "{count, plural, one {# row} other {# rows}} with a root that is {metres} away for that row alone",
                    metres = length(*metres)
                )
            }
            WarningKind::WildRows { joint: None, metres, evened: true } => msg!(
                "{count, plural, one {# row} other {# rows}} with a root that is {metres} away for that row alone; put between its neighbours",
                metres = length(*metres)
            ),
            WarningKind::WildRows { joint: Some(joint), metres, evened: false } => msg!(
                "{count, plural, one {# row} other {# rows}} with a joint that is away for that row alone, `{joint}` by {metres}",
                metres = length(*metres)
            ),
            WarningKind::WildRows { joint: Some(joint), metres, evened: true } => msg!(
                "{count, plural, one {# row} other {# rows}} with a joint that is away for that row alone, `{joint}` by {metres}; put between its neighbours",
                metres = length(*metres)
            ),
            WarningKind::WildAngles { degrees } => msg!(
                "{count, plural, one {# row} other {# rows}} with an angle of more than a hundred turns, up to {angle}°",
                angle = brief(*degrees)
            ),
            WarningKind::Jumps { joint: None, metres } => {
                msg!(
                    "{count, plural, one {# jump} other {# jumps}} of the root from one frame to the next, up to {metres}",
                    metres = length(*metres)
                )
            }
            WarningKind::Jumps { joint: Some(joint), metres } => msg!(
                "{count, plural, one {# jump} other {# jumps}} of joints from one frame to the next, `{joint}` by {metres}",
                metres = length(*metres)
            ),
            WarningKind::FarAway { joint: None, metres } => {
                msg!("the root goes {metres} away from the origin", metres = length(*metres))
            }
            WarningKind::FarAway { joint: Some(joint), metres } => {
                msg!("`{joint}` goes {metres} away from its parent joint", metres = length(*metres))
            }
            WarningKind::SkeletonFromPoints { markers, of, error_mm } => msg!(
                "joints were computed from {markers} of {of} points; they lie {error_mm:.1} mm from them on average"
            ),
            WarningKind::PointsOnly { points } => msg!(
                "{points, plural, one {# point} other {# points}} without a known body: the points are shown as they are"
            ),
            WarningKind::FilledGaps { points, filled, held, longest } => msg!(
                "{points, plural, one {# point} other {# points}} with gaps of up to {longest, plural, one {# frame} other {# frames}}: {filled} positions were filled in, {held} held or interpolated"
            ),
            WarningKind::NotNumbers { text } => msg!(
                "{count, plural, one {# cell} other {# cells}} without a number{place}, such as {text}; read as gaps"
            ),
            WarningKind::QuaternionOrder { scalar_first } => {
                let order = if *scalar_first { "w x y z" } else { "x y z w" };
                msg!(
                    "the order of the quaternions is not certain; read as {order}, in the other order the robot faces backwards"
                )
            }
            WarningKind::BeyondLimits { joint, frames, first, degrees } => msg!(
                "{count, plural, one {# hinge} other {# hinges}} beyond the limits, the furthest `{joint}` by {degrees:.1}° in {frames, plural, one {# frame} other {# frames}} from frame {first} on; kept"
            ),
            WarningKind::UnseenPoints { name } => msg!(
                "{count, plural, one {# point} other {# points}} in no frame, such as `{name}`; left out"
            ),
            WarningKind::UnknownUnit => {
                msg!("the size of the skeleton fits no unit of length; centimetres are assumed")
            }
        }
    }
}
