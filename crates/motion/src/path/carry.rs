use super::{FittedPath, PathEditError, Road, Waypoint};
use crate::clip::{Clip, Contacts, JointTranslations};
use crate::math::{Planar, curve, quat};
use crate::skeleton::Side;
use std::ops::Range;

/// What stays when a path becomes longer or shorter.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub enum Timing {
    /// Every metre: what was so many metres behind the start still is. Speed, stride and duration
    /// stay. A motion that is longer than its new path goes on behind it on the rest of its own
    /// path, or round again where the new one is closed; one that is shorter ends on the way.
    #[default]
    Metres,
    /// The speed: the motion takes the whole path, and where the path has become longer time runs
    /// slower. Strides grow with the path.
    Speed,
    /// The duration: the motion takes the whole path in the same time. Every frame stays at its own
    /// place of the path, so that nothing changes where the path did not.
    Duration,
}

/// What the body does where the path turns.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub enum Orientation {
    /// It turns with the path: the angle between body and path stays.
    #[default]
    Path,
    /// It faces as it did in the world, and is only moved: walking sideways comes out of walking
    /// ahead.
    World,
}

/// What becomes of the way from the path to the character where the path turns.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub enum Offset {
    /// It turns with the path: what swayed to the left of the path still does (Gleicher 2001,
    /// section 4).
    #[default]
    Path,
    /// It stays as it was in the world: on a path that has turned by a quarter, sway to the side
    /// becomes a surge ahead. The naive way, for comparison.
    World,
}

/// How a motion is laid on another path.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(default)]
pub struct CarryOptions {
    /// What stays.
    pub timing: Timing,
    /// What the body does.
    pub orientation: Orientation,
    /// What the way from the path to the character does.
    pub offset: Offset,
}

/// A motion on another path.
#[derive(Clone, Debug, PartialEq)]
pub struct Carried {
    /// The motion, at the frame rate of the original.
    pub clip: Clip,
    /// For every frame of it the frame of the original that it shows; whole numbers but for
    /// [`Timing::Speed`].
    pub frames: Vec<f64>,
    /// For every frame of it the frame of the new path that it rides in.
    pub places: Vec<Waypoint>,
    /// For every frame of it where the character stands and what it faces.
    pub characters: Vec<Planar>,
    /// For every frame of it by how much it turned the whole body, radians.
    pub turns: Vec<f64>,
}

/// Steadily moving characters keep their speed; one that is slower than this is about to stand, and
/// time runs more and more as it did, metres per second.
const STEADY_MPS: f64 = 0.3;
/// Time runs at most so many times slower or faster.
const MAX_STRETCH: f64 = 10.0;
/// A frame this near to a frame of the original is that frame.
const WHOLE: f64 = 1e-6;

/// Lays a motion on another path: `world_from_new_path · path_from_world` of every frame (Gleicher,
/// Motion Path Editing, 2001, section 4).
///
/// What the fit left over, sway of the hips and the yaw of the body against the path, stays as it
/// was in the path's frame. Heights and all angles but the root's yaw stay. On the path that was
/// fitted the motion comes out as it is. O(frames × joints).
///
/// # Errors
/// [`PathEditError`] when the path has no length, or the result is no clip.
pub fn carry(
    path: &FittedPath,
    edited: &Road,
    options: &CarryOptions,
) -> Result<Carried, PathEditError> {
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
        let old = if part == 0.0 { path.places()[index] } else { path.road().at(parameter) };
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
    Ok(Carried {
        clip,
        frames,
        places,
        characters,
        turns: moves.iter().map(|planar| planar.yaw).collect(),
    })
}

/// Whether a place of the old path is farther from the start than the new one is long; a closed one
/// has no end.
fn is_behind(edited: &Road, old: &Waypoint) -> bool {
    !edited.spline().is_closed() && old.along_m > edited.length_m()
}

/// The rest of the old path, joined to the end of the new one. Straight on instead, a body that
/// goes ahead would turn with every bend of the old path: fitted paths follow the sway of the hips
/// in hooks, above all at their ends.
fn behind(path: &FittedPath, edited: &Road, old: &Waypoint) -> Waypoint {
    let length = edited.length_m();
    let (end, left) = (edited.at_length(length), path.road().at_length(length));
    Waypoint { frame: end.frame.after(&left.frame.inverse()).after(&old.frame), ..*old }
}

impl Carried {
    /// The contacts of the result, from those of the original.
    #[must_use]
    pub fn contacts(&self, original: &Contacts) -> Contacts {
        let planted = |side| {
            self.frames.iter().map(|frame| original.planted(side, frame.round() as usize)).collect()
        };
        Contacts::from_flags(Side::BOTH.map(planted))
    }

    /// Metres of the path that the motion takes, from the first frame to the last.
    #[must_use]
    pub fn taken_m(&self) -> Range<f64> {
        let along = |place: Option<&Waypoint>| place.map_or(0.0, |place| place.along_m);
        along(self.places.first())..along(self.places.last())
    }
}

/// The frames of the original that are shown when it keeps its speed on the edited path.
fn at_speed(path: &FittedPath, edited: &Road) -> Vec<f64> {
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

/// The frames of a clip in this order, each moved over the ground; between frames, positions are on
/// the straight line and rotations on the great circle.
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
