//! Motion carried from its own path to an edited one.

use super::{ArcLengthPath, FittedPath, PathEditError, Waypoint};
use crate::clip::{Clip, Contacts, JointTranslations};
use crate::math::{Planar, curve, quat};
use glam::{Quat, Vec3};
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
    let mut carrying = Carrying::new(*options);
    while carrying.advance(path, edited, usize::MAX) {}
    carrying.finish(path)
}

/// The computation of [`carry`] in slices, for long motions. Every call must be given the same
/// paths.
#[derive(Clone, Debug)]
pub(super) struct Carrying {
    options: CarryOptions,
    /// For the frames of the original that are measured, the distance along the new path, metres;
    /// used by [`Timing::Speed`] alone.
    along: Vec<f64>,
    /// For every frame of the result, the frame of the original; `None` until known.
    frames: Option<Vec<f64>>,
    places: Vec<Waypoint>,
    characters: Vec<Planar>,
    turns: Vec<f64>,
    rotations: Vec<Quat>,
    roots: Vec<Vec3>,
    tracks: Vec<JointTranslations>,
}

impl Carrying {
    pub(super) fn new(options: CarryOptions) -> Self {
        Self {
            options,
            along: Vec::new(),
            frames: None,
            places: Vec::new(),
            characters: Vec::new(),
            turns: Vec::new(),
            rotations: Vec::new(),
            roots: Vec::new(),
            tracks: Vec::new(),
        }
    }

    /// Processes up to `count` more frames. Returns `false` when nothing is left to do.
    pub(super) fn advance(
        &mut self,
        path: &FittedPath,
        edited: &ArcLengthPath,
        count: usize,
    ) -> bool {
        let Some(frames) = self.frames.take() else {
            self.frames = self.prepare_frames(path, edited, count);
            return true;
        };
        let next = self.places.len()..self.places.len().saturating_add(count).min(frames.len());
        for &frame in &frames[next.clone()] {
            self.push_frame(path, edited, frame);
        }
        let is_left = next.end < frames.len();
        self.frames = Some(frames);
        is_left
    }

    /// Measures up to `count` more frames of the original on the new path if timing depends on it.
    /// Once all are measured, allocates the result and returns, for each of its frames, the frame
    /// of the original.
    fn prepare_frames(
        &mut self,
        path: &FittedPath,
        edited: &ArcLengthPath,
        count: usize,
    ) -> Option<Vec<f64>> {
        let clip = path.source().clip();
        let frames = match self.options.timing {
            Timing::Metres | Timing::Duration => {
                (0..clip.frames()).map(|frame| frame as f64).collect()
            }
            Timing::Speed => {
                let left = path.parameters().iter().skip(self.along.len());
                self.along.extend(left.take(count).map(|&u| edited.length_at(u)));
                if self.along.len() < path.parameters().len() {
                    return None;
                }
                at_speed(path, &self.along)
            }
        };
        self.places.reserve_exact(frames.len());
        self.characters.reserve_exact(frames.len());
        self.turns.reserve_exact(frames.len());
        self.rotations.reserve_exact(frames.len() * clip.skeleton().len());
        self.roots.reserve_exact(frames.len());
        let track = |track: &JointTranslations| JointTranslations {
            joint: track.joint,
            values: Vec::with_capacity(frames.len()),
        };
        self.tracks = clip.translations().iter().map(track).collect();
        Some(frames)
    }

    /// Appends a frame of the original, carried to the new path.
    fn push_frame(&mut self, path: &FittedPath, edited: &ArcLengthPath, frame: f64) {
        let (index, part) = path.between(frame);
        let parameter = path.parameter(frame);
        let old = if part == 0.0 { path.places()[index] } else { path.curve().at(parameter) };
        let place = match self.options.timing {
            Timing::Metres if is_behind(edited, &old) => behind(path, edited, &old),
            Timing::Metres => edited.at_length_near(old.along_m, parameter),
            Timing::Speed | Timing::Duration => edited.at(parameter),
        };
        let turned = place.frame.after(&old.frame.inverse());
        let stood = path.character(frame);
        let stands = match self.options.offset {
            Offset::Path => turned.apply_ground(stood.shift),
            Offset::World => stood.shift + (place.frame.shift - old.frame.shift),
        };
        let turn = match self.options.orientation {
            Orientation::Path => Planar::new(turned.yaw, 0.0, 0.0),
            Orientation::World => Planar::IDENTITY,
        };
        let planar = Planar { shift: stands - turn.apply_ground(stood.shift), ..turn };
        self.characters.push(planar.after(&stood));
        self.turns.push(planar.yaw);
        self.places.push(place);
        self.push_pose(path.source().clip(), frame, &planar);
    }

    /// Appends the pose of a frame, moved by `planar`; between frames positions are interpolated
    /// linearly and rotations spherically.
    fn push_pose(&mut self, clip: &Clip, frame: f64, planar: &Planar) {
        let last = clip.frames().saturating_sub(1);
        let before = (frame as usize).min(last);
        let (after, part) = ((before + 1).min(last), frame.fract() as f32);
        let first = self.rotations.len();
        self.rotations.extend_from_slice(clip.rotations(before));
        let mut root = clip.root_translations()[before];
        if part > 0.0 {
            root = root.lerp(clip.root_translations()[after], part);
            for (rotation, &next) in self.rotations[first..].iter_mut().zip(clip.rotations(after)) {
                *rotation = quat::slerp(*rotation, next, part);
            }
        }
        self.rotations[first] = quat::renormalize(planar.rotation() * self.rotations[first]);
        self.roots.push(planar.apply(root));
        for (to, track) in self.tracks.iter_mut().zip(clip.translations()) {
            to.values.push(track.values[before].lerp(track.values[after], part));
        }
    }

    /// Returns the motion. Call it when [`advance`](Self::advance) has returned `false`.
    ///
    /// # Errors
    /// [`PathEditError`] when the result is not a valid clip.
    pub(super) fn finish(self, path: &FittedPath) -> Result<CarriedMotion, PathEditError> {
        let clip = path.source().clip();
        let skeleton = clip.skeleton().clone();
        let moved = Clip::new(clip.name(), skeleton, clip.fps(), self.rotations, self.roots)?;
        Ok(CarriedMotion {
            clip: moved.with_translations(self.tracks)?.with_provenance(clip.provenance()),
            frames: self.frames.unwrap_or_default(),
            places: self.places,
            characters: self.characters,
            turns: self.turns,
        })
    }
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

/// Returns the frames of the original when speed is kept on the edited path, on which `along` are
/// the distances of its frames.
fn at_speed(path: &FittedPath, along: &[f64]) -> Vec<f64> {
    let fps = path.source().clip().fps();
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
