//! A motion as the bytes of a file.

mod together;

pub use together::Together;

use super::labs::{CharacterMotion, Outcome, PlacedClip};
use super::motion::{curve_kind, joint_of};
use super::params::{Key, Params};
use segue_formats::bvh::{self, RotationOrder};
use segue_formats::csv::{CsvInputs, CsvOptions, write_csv};
use segue_formats::fbx::{FbxOptions, FbxWriteError, write_fbx};
use segue_formats::gltf::{
    GlbError, GlbOptions, VrmaError, write_character_glb, write_glb, write_vrma,
};
use segue_formats::numpy::write_npz;
use segue_formats::robot_csv::{RobotCsvError, write_robot_csv};
use segue_motion::clip::{Clip, CurveKind, Interpolation, Motion, UpAxis, joint_curve, resample};
use segue_motion::skeleton::Roles;
use segue_motion::skin::Character;
use std::borrow::Cow;
use std::sync::Arc;

/// A file format in which motions are saved.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub enum ExportFormat {
    /// Skeleton and motion as text, which most programs read.
    #[default]
    Bvh,
    /// A scene with the skeleton and its animation, for the programs of film and games.
    Fbx,
    /// A table for spreadsheets and scripts.
    Csv,
    /// A scene with skeleton, body and animation.
    Glb,
    /// The motion of a body for characters of VRM.
    Vrma,
    /// Arrays for `NumPy`.
    Npz,
    /// A table of the hinges of a Unitree G1.
    G1Csv,
}

impl ExportFormat {
    /// All formats.
    pub const ALL: [Self; 7] =
        [Self::Bvh, Self::Fbx, Self::Glb, Self::Vrma, Self::Npz, Self::Csv, Self::G1Csv];

    /// Returns the name in the API.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Bvh => "bvh",
            Self::Fbx => "fbx",
            Self::Csv => "csv",
            Self::Glb => "glb",
            Self::Vrma => "vrma",
            Self::Npz => "npz",
            Self::G1Csv => "g1",
        }
    }

    /// Returns the ending of files.
    #[must_use]
    pub const fn ending(self) -> &'static str {
        match self {
            Self::G1Csv => "csv",
            _ => self.name(),
        }
    }

    /// Returns whether a file can have a root bone above the body.
    #[must_use]
    pub const fn has_root_bones(self) -> bool {
        matches!(self, Self::Bvh | Self::Fbx | Self::Glb | Self::Npz)
    }

    /// Returns whether a file can hold several clips ([`Together`]).
    #[must_use]
    pub const fn holds_several(self) -> bool {
        matches!(self, Self::Fbx | Self::Glb)
    }

    /// Returns the format of a name.
    #[must_use]
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|format| format.name() == name)
    }

    /// Returns the format of a file by its ending, in capitals or not.
    #[must_use]
    pub fn from_ending(ending: &str) -> Option<Self> {
        let ending = ending.to_lowercase();
        Self::from_name(&ending).filter(|format| format.ending() == ending)
    }

    /// Returns the media type.
    #[must_use]
    pub const fn mime(self) -> &'static str {
        match self {
            Self::Bvh => "text/plain",
            Self::Fbx => "application/octet-stream",
            Self::Csv | Self::G1Csv => "text/csv",
            Self::Glb | Self::Vrma => "model/gltf-binary",
            Self::Npz => "application/zip",
        }
    }
}

/// Options of an export. A format uses those that it supports: BVH all but the body, FBX unit, up
/// axis, frame rate and root, GLB frame rate, body and root, CSV the root, the others frame rate
/// and root.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct ExportOptions {
    /// The file format.
    pub format: ExportFormat,
    /// Metres per unit of length; `None` for the unit of the clip's source file, and centimetres in
    /// FBX.
    pub metres_per_unit: Option<f64>,
    /// The up axis; `None` for that of the clip's source file, and Y in FBX.
    pub up: Option<UpAxis>,
    /// One order for the rotations of all joints; `None` for those of the source file.
    pub rotation_order: Option<RotationOrder>,
    /// Frames per second; `None` for the clip's own rate.
    pub fps: Option<f64>,
    /// The body in the file, if the format has bodies.
    pub body: ExportBody,
    /// The joint that has the motion over the ground.
    #[serde(default)]
    pub root: ExportRoot,
}

/// The joint of an exported file that has the motion over the ground.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub enum ExportRoot {
    /// The one that has it in the clip's source file.
    #[default]
    AsIs,
    /// A root bone on the ground ([`Clip::with_ground_root`]), in formats with a skeleton of their
    /// own: BVH, FBX, GLB and NPZ. The others are written as they are.
    Ground,
    /// None: the body stays over the origin ([`Clip::without_ground_motion`]).
    InPlace,
}

impl ExportRoot {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::AsIs, Self::Ground, Self::InPlace];

    /// Returns the name on the command line and in the API.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::AsIs => "as-is",
            Self::Ground => "ground",
            Self::InPlace => "in-place",
        }
    }

    /// Returns the one of a name.
    #[must_use]
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|root| root.name() == name)
    }
}

/// The body in an exported file.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub enum ExportBody {
    /// The body of the character on the stage, on its own skeleton and in its own size; the plain
    /// one if the motion moves none of its joints.
    #[default]
    Character,
    /// A body generated around the clip's own skeleton.
    Plain,
}

impl ExportBody {
    /// Both bodies.
    pub const ALL: [Self; 2] = [Self::Character, Self::Plain];

    /// Returns the name in the API.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Character => "character",
            Self::Plain => "plain",
        }
    }

    /// Returns the body of a name.
    #[must_use]
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|body| body.name() == name)
    }
}

/// The reason why a motion cannot be saved in a format.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error, segue_text::ToMessage)]
pub enum ExportError {
    /// A GLB file cannot hold it.
    #[error(transparent)]
    Glb(#[from] GlbError),
    /// An FBX file cannot hold it.
    #[error(transparent)]
    Fbx(#[from] FbxWriteError),
    /// It is no motion of a body.
    #[error(transparent)]
    Vrma(#[from] VrmaError),
    /// It is no motion of the robot.
    #[error(transparent)]
    G1Csv(#[from] RobotCsvError),
}

/// A column of a table beside the joints: its name and a number per frame.
pub type Column = (String, Vec<f32>);

/// Writes a motion as a file. `columns` are written to tables only. `character` is the character on
/// the stage in place of a plain body: see [`ExportBody`].
///
/// # Errors
/// [`ExportError`] when the format cannot hold the motion.
pub fn export(
    motion: &Motion,
    character: Option<&Character>,
    columns: &[Column],
    options: &ExportOptions,
) -> Result<Vec<u8>, ExportError> {
    let own = || with_root(motion.clip(), motion.roles(), options);
    match options.format {
        ExportFormat::Bvh => {
            let how = bvh::WriteOptions {
                metres_per_unit: options.metres_per_unit,
                rotation_order: options.rotation_order,
                fps: options.fps,
                up: options.up,
            };
            Ok(bvh::write(&own(), &how).into_bytes())
        }
        ExportFormat::Fbx => {
            let ExportOptions { metres_per_unit, up, fps, .. } = *options;
            let how = FbxOptions { metres_per_unit, up, fps };
            Ok(write_fbx(&[&own()], &how)?)
        }
        ExportFormat::Csv => {
            let inputs = CsvInputs { clip: &own(), contacts: Some(motion.contacts()), columns };
            Ok(write_csv(&inputs, &CsvOptions::default()).into_bytes())
        }
        ExportFormat::Vrma => Ok(write_vrma(&own(), motion.roles(), options.fps)?),
        ExportFormat::G1Csv => Ok(write_robot_csv(&own(), options.fps)?.into_bytes()),
        ExportFormat::Npz => {
            let own = own();
            let resampled =
                options.fps.and_then(|fps| resample(&own, fps, Interpolation::default()).ok());
            Ok(write_npz(resampled.as_ref().unwrap_or(&own)))
        }
        ExportFormat::Glb => {
            let how = GlbOptions { fps: options.fps, smooth: true };
            let character = character.filter(|_| options.body == ExportBody::Character);
            let on_character = character.and_then(|character| {
                let moved = CharacterMotion::new(&Arc::new(motion.clone()), character)?;
                Some((moved, character))
            });
            match on_character {
                Some((moved, character)) => {
                    let clip = with_root(moved.clip(), &character.roles, options);
                    write_character_glb(&clip, &character.mesh, &how)
                }
                None => write_glb(&own(), &how),
            }
            .map_err(ExportError::from)
        }
    }
}

/// Returns a clip whose motion over the ground is where the options want it.
fn with_root<'a>(clip: &'a Clip, roles: &Roles, options: &ExportOptions) -> Cow<'a, Clip> {
    match options.root {
        ExportRoot::Ground if options.format.has_root_bones() => {
            Cow::Owned(clip.with_ground_root())
        }
        ExportRoot::InPlace => Cow::Owned(clip.without_ground_motion(roles)),
        _ => Cow::Borrowed(clip),
    }
}

/// Returns the plotted curves of a clip: the chosen quantities of the chosen joint. Empty if the
/// clip has no such joint.
#[must_use]
pub fn plotted_of_clip(motion: &Motion, params: &Params) -> Vec<Column> {
    plotted(motion, "", params)
}

/// Returns the plotted curves of a result: its own, and those of its source clips in the result's
/// time, without values where they do not play.
#[must_use]
pub fn plotted_of_result(outcome: &Outcome, params: &Params) -> Vec<Column> {
    let own = plotted(&outcome.motion, "", params);
    let sources = outcome.sources.iter().flat_map(|source| {
        let curves = plotted(&source.motion, &format!("{} ", source.slot.label()), params);
        let in_time = |(name, values): Column| (name, in_time_of(&outcome.motion, source, &values));
        curves.into_iter().map(in_time)
    });
    own.into_iter().chain(sources).collect()
}

fn plotted(motion: &Motion, whose: &str, params: &Params) -> Vec<Column> {
    let name = params.text(Key::Joint);
    let Some(joint) = joint_of(motion, name) else {
        return Vec::new();
    };
    let column = |curve| {
        let kind = curve_kind(curve);
        let quantity = match kind {
            CurveKind::Speed => "speed_m_per_s",
            CurveKind::Height => "height_m",
            CurveKind::Distance => "distance_m",
            CurveKind::Angle => "angle_deg",
            CurveKind::AngularSpeed => "turn_deg_per_s",
        };
        (format!("{whose}{name}.{quantity}"), joint_curve(motion.clip(), joint, kind))
    };
    params.plotted_curves().into_iter().map(column).collect()
}

/// Resamples the values of a source's frames at the frames of the result.
fn in_time_of(result: &Motion, source: &PlacedClip, values: &[f32]) -> Vec<f32> {
    let fps = source.motion.clip().fps();
    let at = |frame: usize| ((result.clip().time_of(frame) - source.starts_at_secs) * fps).round();
    (0..result.clip().frames())
        .map(|frame| {
            // Cast directly, a negative frame would become 0.
            let inside = Some(at(frame)).filter(|at| *at >= 0.0);
            inside.and_then(|at| values.get(at as usize).copied()).unwrap_or(f32::NAN)
        })
        .collect()
}

/// Returns a file name that every system accepts: letters, digits, spaces and `-_.~`, others
/// replaced by `_`, at most 100 of them before the ending. `motion` if nothing is left.
#[must_use]
pub fn file_name(stem: &str, ending: &str) -> String {
    let plain = |c: char| {
        if c.is_alphanumeric() || matches!(c, '-' | '_' | '.' | ' ' | '~') { c } else { '_' }
    };
    let stem: String = stem.chars().map(plain).take(100).collect();
    let stem = stem.trim().trim_start_matches('.');
    format!("{}.{ending}", if stem.is_empty() { "motion" } else { stem })
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use crate::{Command, Session, Value};
    use segue_formats::{ImportOptions, import};

    pub(crate) fn blend() -> Session {
        let mut session = Session::new();
        session.apply(Command::OpenLink("lab=blend&joint=left%20foot".into())).unwrap();
        while session.work() {}
        session
    }

    fn read_back(bytes: &[u8], name: &str) -> segue_motion::clip::Clip {
        import(name, bytes, &ImportOptions::default()).unwrap().clips.remove(0).clip
    }

    #[test]
    fn export_in_every_format_contains_the_motion() {
        let session = blend();
        let motion = &session.main_outcome().unwrap().motion;
        for format in ExportFormat::ALL {
            assert_eq!(ExportFormat::from_name(format.name()), Some(format));
            let options = ExportOptions { format, ..ExportOptions::default() };
            let bytes = export(motion, None, &[], &options);
            if format == ExportFormat::G1Csv {
                assert_eq!(bytes, Err(RobotCsvError::OtherSkeleton.into()));
                continue;
            }
            let bytes = bytes.unwrap();
            if format == ExportFormat::Csv {
                let text = String::from_utf8(bytes).unwrap();
                assert_eq!(text.lines().count(), motion.clip().frames() + 1);
                assert!(
                    text.lines().next().unwrap().ends_with("left_foot_contact,right_foot_contact")
                );
            } else {
                let clip = read_back(&bytes, &format!("x.{}", format.name()));
                assert_eq!(clip.frames(), motion.clip().frames());
                // Each joint of the built-in body is a bone of VRM, too.
                assert_eq!(clip.skeleton().len(), motion.clip().skeleton().len());
            }
        }
        assert_eq!(ExportFormat::from_name("max"), None);
    }

    #[test]
    fn export_follows_its_options() {
        let session = blend();
        let motion = &session.main_outcome().unwrap().motion;
        let options = ExportOptions {
            metres_per_unit: Some(1.0),
            rotation_order: Some(RotationOrder::Xyz),
            fps: Some(30.0),
            ..ExportOptions::default()
        };
        let text = String::from_utf8(export(motion, None, &[], &options).unwrap()).unwrap();
        assert!(
            text.contains("Xrotation Yrotation Zrotation") && !text.contains("Zrotation Xrotation")
        );
        let clip = read_back(text.as_bytes(), "x.bvh");
        assert_eq!(clip.fps().round(), 30.0);
        assert_eq!(clip.provenance().metres_per_unit, 1.0);
        for format in [ExportFormat::Bvh, ExportFormat::Fbx] {
            let options = ExportOptions { format, up: Some(UpAxis::Z), ..options };
            let bytes = export(motion, None, &[], &options).unwrap();
            let clip = read_back(&bytes, &format!("x.{}", format.name()));
            let source = clip.provenance();
            assert_eq!((source.up, source.metres_per_unit), (UpAxis::Z, 1.0), "{format:?}");
        }
        for format in [ExportFormat::Fbx, ExportFormat::Glb, ExportFormat::Vrma, ExportFormat::Npz]
        {
            let bytes = export(motion, None, &[], &ExportOptions { format, ..options }).unwrap();
            let clip = read_back(&bytes, &format!("x.{}", format.name()));
            assert_eq!(clip.fps().round(), 30.0);
        }
    }

    #[test]
    fn export_as_a_table_contains_the_plotted_curves() {
        let mut session = blend();
        let outcome = session.main_outcome().unwrap().clone();
        let columns = plotted_of_result(&outcome, session.params());
        let names: Vec<&str> = columns.iter().map(|(name, _)| name.as_str()).collect();
        assert_eq!(
            names,
            ["left foot.speed_m_per_s", "A left foot.speed_m_per_s", "B left foot.speed_m_per_s"]
        );
        assert!(columns.iter().all(|(_, values)| values.len() == outcome.motion.clip().frames()));
        let (a, b) = (&columns[1].1, &columns[2].1);
        // Outside the transition the result is the source: B plays to the end, and not before it
        // begins.
        let fps = outcome.motion.clip().fps();
        let transition = outcome.transition.unwrap();
        let before = (transition.start_secs * fps).round() as usize / 2;
        assert!((columns[0].1[before] - a[before]).abs() < 1e-3);
        let last = b.len() - 2;
        assert!((columns[0].1[last] - b[last]).abs() < 1e-3);
        let began = outcome.sources[1].starts_at_secs;
        assert_eq!(b[0].is_nan(), began > 0.0);
        let values = vec![(Key::Curve, Value::Choice("height"))];
        session.apply(Command::Set(values)).unwrap();
        assert_eq!(plotted_of_clip(&outcome.motion, session.params())[0].0, "left foot.height_m");
        session.apply(Command::Set(vec![(Key::Joint, Value::Text("tail".into()))])).unwrap();
        assert_eq!(plotted_of_clip(&outcome.motion, session.params()), []);
    }

    #[test]
    fn file_name_of_any_text_is_plain() {
        assert_eq!(file_name("01_01~3fa9 to ../run", "bvh"), "01_01~3fa9 to .._run.bvh");
        assert_eq!(file_name("  ", "bvh"), "motion.bvh");
    }
}
