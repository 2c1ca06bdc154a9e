//! Motion carried from its own path to an edited one.

use super::{ArcLengthPath, FittedPath, PathEditError, Waypoint};
use crate::clip::{Clip, Contacts, JointTranslations};
use crate::math::{Planar, curve, quat};
use std::ops::Range;

/// The quantity that is kept when a path becomes longer or shorter.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub enum Timing {
    /// Distance: a frame keeps its distance from the start. Speed, stride and duration are kept. A
    /// motion that is longer than its new path continues on the rest of its own path, or around
    /// again where the new one is closed; one that is shorter ends before the end of the path.
    #[default]
    Metres,
    /// Speed: the motion covers the whole path, and takes longer where the path has become longer.
    /// Strides grow with the path.
    Speed,
    /// Duration: the motion covers the whole path in the same time. Every frame keeps its
    /// parameter, so that nothing changes where the path did not.
    Duration,
}

/// The orientation of the body where the path turns.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub enum Orientation {
    /// The body turns with the path: the angle between body and path is kept.
    #[default]
    Path,
    /// The body keeps its orientation in the world: a walk ahead becomes a walk sideways.
    World,
}

/// The offset of the character from the path where the path turns.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub enum Offset {
    /// The offset turns with the path: sway to the left of the path remains so (Gleicher 2001,
    /// section 4).
    #[default]
    Path,
    /// The offset is kept in the world: on a path that has turned by a quarter, sway to the side
    /// becomes sway ahead. For comparison.
    World,
}

/// Options of carrying a motion to another path.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(default)]
pub struct CarryOptions {
    /// The quantity that is kept.
    pub timing: Timing,
    /// The orientation of the body.
    pub orientation: Orientation,
    /// The offset from the path.
    pub offset: Offset,
}

/// A motion on another path.
#[derive(Clone, Debug, PartialEq)]
pub struct CarriedMotion {
    /// The motion, at the frame rate of the original.
    pub clip: Clip,
    /// For every frame, the frame of the original; integers except for [`Timing::Speed`].
    pub frames: Vec<f64>,
    /// For every frame, the frame of the new path to which it belongs.
    pub places: Vec<Waypoint>,
    /// For every frame, the ground frame of the character.
    pub characters: Vec<Planar>,
    /// For every frame, the yaw by which the whole body was turned, radians.
    pub turns: Vec<f64>,
}

/// Characters above this speed keep it; below it the character is about to stand, and time
/// approaches that of the original, metres per second.
const STEADY_MPS: f64 = 0.3;
/// The greatest factor by which time runs slower or faster.
const MAX_STRETCH: f64 = 10.0;
/// The tolerance within which a frame is a frame of the original.
const WHOLE: f64 = 1e-6;

/// Carries a motion to another path: every frame is moved by
/// `world_from_new_path · path_from_world` (Gleicher, "Motion Path Editing", 2001, section 4).
///
/// The residual of the fit, sway of the hips and the yaw of the body against the path, is kept in
/// the path's frame. Heights and all angles but the root's yaw stay. On the fitted path the motion
/// is reproduced. O(frames × joints).
///
/// # Errors
/// [`PathEditError`] when the path has no length, or the result is not a valid clip.
pub fn carry(
    path: &FittedPath,
    edited: &ArcLengthPath,
    options: &CarryOptions,
) -> Result<CarriedMotion, PathEditError> {
    let clip = path.source().clip();
    let frames = match options.timing {
        Timing::Metres | Timing::Duration => (0..clip.frames()).map(|frame| frame as f64).collect(),
        Timing::Speed => at_speed(path, edited),
    };
    let mut places = Vec::with_capacity(frames.len());
    let (mut moves, mut characters) =
        (Vec::with_capacity(frames.len()), Vec::with_capacity(frames.len()));
    for &frame in &frames {
        let (index, part) = path.between(frame);
        let parameter = path.parameter(frame);
        let old = if part == 0.0 { path.places()[index] } else { path.curve().at(parameter) };
        let place = match options.timing {
            Timing::Metres if is_behind(edited, &old) => behind(path, edited, &old),
            Timing::Metres => edited.at_length_near(old.along_m, parameter),
            Timing::Speed | Timing::Duration => edited.at(parameter),
        };
        let turned = place.frame.after(&old.frame.inverse());
        let stood = path.character(frame);
        let stands = match options.offset {
            Offset::Path => turned.apply_ground(stood.shift),
            Offset::World => stood.shift + (place.frame.shift - old.frame.shift),
        };
        let turn = match options.orientation {
            Orientation::Path => Planar::new(turned.yaw, 0.0, 0.0),
            Orientation::World => Planar::IDENTITY,
        };
        let planar = Planar { shift: stands - turn.apply_ground(stood.shift), ..turn };
        characters.push(planar.after(&stood));
        moves.push(planar);
        places.push(place);
    }
    let clip = moved(clip, &frames, &moves)?;
    Ok(CarriedMotion {
        clip,
        frames,
        places,
        characters,
        turns: moves.iter().map(|planar| planar.yaw).collect(),
    })
}

/// Returns whether a waypoint of the old path is farther from the start than the new path is long;
/// a closed one has no end.
fn is_behind(edited: &ArcLengthPath, old: &Waypoint) -> bool {
    !edited.spline().is_closed() && old.along_m > edited.length_m()
}

/// Returns the waypoint on the rest of the old path, joined to the end of the new one. If the path
/// continued straight, a body that walks ahead would turn with every bend of the old path: fitted
/// paths follow the sway of the hips, above all at their ends.
fn behind(path: &FittedPath, edited: &ArcLengthPath, old: &Waypoint) -> Waypoint {
    let length = edited.length_m();
    let (end, left) = (edited.at_length(length), path.curve().at_length(length));
    Waypoint { frame: end.frame.after(&left.frame.inverse()).after(&old.frame), ..*old }
}

impl CarriedMotion {
    /// Returns the contacts of the result, from those of the original.
    #[must_use]
    pub fn contacts(&self, original: &Contacts) -> Contacts {
        Contacts::of_feet(original.feet(), |foot| {
            self.frames.iter().map(|frame| original.planted(foot, frame.round() as usize)).collect()
        })
    }

    /// Returns the distances from the start of the path that the motion covers, metres.
    #[must_use]
    pub fn taken_m(&self) -> Range<f64> {
        let along = |place: Option<&Waypoint>| place.map_or(0.0, |place| place.along_m);
        along(self.places.first())..along(self.places.last())
    }
}

/// Returns the frames of the original when speed is kept on the edited path.
fn at_speed(path: &FittedPath, edited: &ArcLengthPath) -> Vec<f64> {
    let fps = path.source().clip().fps();
    let along: Vec<f64> = path.parameters().iter().map(|&u| edited.length_at(u)).collect();
    // The time of every frame of the original on the new path, in frames.
    let mut times = vec![0.0];
    let mut time = 0.0;
    for (old, new) in path.places().windows(2).zip(along.windows(2)) {
        let step = old[1].along_m - old[0].along_m;
        let stretch =
            ((new[1] - new[0]) / step.max(1e-12)).max(MAX_STRETCH.recip()).min(MAX_STRETCH);
        let steady = f64::from(curve::smoothstep((step * fps / STEADY_MPS) as f32));
        time += 1.0 + (stretch - 1.0) * steady;
        times.push(time);
    }
    let steps = (time.round() as usize).max(1);
    let mut index = 0;
    (0..=steps)
        .map(|k| {
            let wanted = time * k as f64 / steps as f64;
            while index + 2 < times.len() && times[index + 1] <= wanted {
                index += 1;
            }
            let at = index as f64 + (wanted - times[index]) / (times[index + 1] - times[index]);
            if (at - at.round()).abs() < WHOLE { at.round() } else { at }
        })
        .collect()
}

/// Returns the frames of a clip in this order, each moved over the ground; between frames positions
/// are interpolated linearly and rotations spherically.
fn moved(clip: &Clip, frames: &[f64], moves: &[Planar]) -> Result<Clip, PathEditError> {
    let joints = clip.skeleton().len();
    let last = clip.frames().saturating_sub(1);
    let mut rotations = Vec::with_capacity(frames.len() * joints);
    let mut roots = Vec::with_capacity(frames.len());
    let around = |frame: f64| {
        let before = (frame as usize).min(last);
        (before, (before + 1).min(last), frame.fract() as f32)
    };
    for (&frame, planar) in frames.iter().zip(moves) {
        let (before, after, part) = around(frame);
        let first = rotations.len();
        rotations.extend_from_slice(clip.rotations(before));
        let mut root = clip.root_translations()[before];
        if part > 0.0 {
            root = root.lerp(clip.root_translations()[after], part);
            for (rotation, &next) in rotations[first..].iter_mut().zip(clip.rotations(after)) {
                *rotation = quat::slerp(*rotation, next, part);
            }
        }
        rotations[first] = quat::renormalize(planar.rotation() * rotations[first]);
        roots.push(planar.apply(root));
    }
    let tracks = clip.translations().iter().map(|track| JointTranslations {
        joint: track.joint,
        values: (frames.iter())
            .map(|&frame| {
                let (before, after, part) = around(frame);
                track.values[before].lerp(track.values[after], part)
            })
            .collect(),
    });
    let moved = Clip::new(clip.name(), clip.skeleton().clone(), clip.fps(), rotations, roots)?;
    Ok(moved.with_translations(tracks.collect())?.with_provenance(clip.provenance()))
}
