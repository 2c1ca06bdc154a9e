//! A motion between a file and a [`Clip`]: in the file's units and axes, unchecked.

use super::error::Fault;
use glam::{Quat, Vec3};
use segue_motion::clip::{Clip, ClipError, JointTranslations, Provenance, UpAxis};
use segue_motion::skeleton::{
    Joint, Role, Roles, Skeleton, SkeletonError, WorldPose, world_pose_into,
};
use segue_text::msg;
use std::sync::Arc;

/// Distance from the rest offset, metres, below which a translation is equal to it.
const SAME_PLACE: f32 = 1e-6;

/// A motion as in the file: joints, rotations (frame-major), the translations of the root, and
/// those of other joints by index.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct RawMotion {
    pub(super) joints: Vec<Joint>,
    pub(super) rotations: Vec<Quat>,
    pub(super) root_translations: Vec<Vec3>,
    pub(super) tracks: Vec<(usize, Vec<Vec3>)>,
    pub(super) wild_angles: WildAngles,
}

/// Angles of so many turns that the rotation left of them is noise.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct WildAngles {
    /// The rows with such an angle.
    pub(super) rows: usize,
    /// The largest of them, degrees.
    pub(super) degrees: f64,
}

impl WildAngles {
    /// The largest angle that causes no warning, degrees: a hundred turns. Angles of a recording
    /// may go on counting where a dancer spins.
    pub(super) const LIKELY_DEGREES: f64 = 36_000.0;

    /// Adds a row by its largest angle, degrees.
    pub(super) fn add_row(&mut self, degrees: f64) {
        if degrees > Self::LIKELY_DEGREES {
            self.rows += 1;
            self.degrees = self.degrees.max(degrees);
        }
    }

    /// Adds the rows of a part.
    #[cfg(feature = "parallel")]
    pub(super) fn add(&mut self, part: Self) {
        self.rows += part.rows;
        self.degrees = self.degrees.max(part.degrees);
    }
}

/// An error converting a motion to a clip. The readers rule out both cases.
#[derive(Clone, Debug, PartialEq, thiserror::Error, segue_text::ToMessage)]
pub(super) enum RawError {
    #[error(transparent)]
    Skeleton(#[from] SkeletonError),
    #[error(transparent)]
    Clip(#[from] ClipError),
}

impl RawMotion {
    pub(super) fn frames(&self) -> usize {
        self.root_translations.len()
    }

    /// Returns the translations of the root, then those of each track.
    pub(super) fn translations_mut(&mut self) -> impl Iterator<Item = &mut Vec<Vec3>> {
        std::iter::once(&mut self.root_translations)
            .chain(self.tracks.iter_mut().map(|(_, values)| values))
    }

    /// Reserves memory for `frames` more frames.
    pub(super) fn reserve(&mut self, frames: usize) -> Result<(), Fault> {
        let joints = self.joints.len();
        let mut taken = self.rotations.try_reserve_exact(frames.saturating_mul(joints));
        for track in self.translations_mut() {
            taken = taken.and_then(|()| track.try_reserve_exact(frames));
        }
        taken.map_err(|_| no_memory(self.frames()))
    }

    /// Makes the motion `frames` frames long. Those that are new are all zeros.
    #[cfg(feature = "parallel")]
    pub(super) fn lengthen(&mut self, frames: usize) -> Result<(), Fault> {
        let (before, joints) = (self.frames(), self.joints.len());
        let mut taken = lengthen(&mut self.rotations, frames.saturating_mul(joints));
        for track in self.translations_mut() {
            taken = taken.and_then(|()| lengthen(track, frames));
        }
        taken.ok_or_else(|| no_memory(before))
    }

    /// Returns the local rotations of a frame; empty if there is no such frame.
    pub(super) fn pose(&self, frame: usize) -> &[Quat] {
        let joints = self.joints.len();
        self.rotations.get(frame * joints..(frame + 1) * joints).unwrap_or_default()
    }

    /// Takes the first frame as the rest pose if all OFFSETs are zero and position channels carry
    /// the skeleton. Returns whether it did.
    pub(super) fn rest_from_first_frame(&mut self) -> bool {
        let degenerate = self.joints.len() > 1
            && self.joints.iter().skip(1).all(|joint| joint.offset == Vec3::ZERO);
        let mut changed = false;
        for (joint, values) in &self.tracks {
            if let (true, Some(joint), Some(&first)) =
                (degenerate, self.joints.get_mut(*joint), values.first())
            {
                changed |= first != Vec3::ZERO;
                joint.offset = first;
            }
        }
        changed
    }

    /// Removes the first frame.
    pub(super) fn drop_first_frame(&mut self) {
        self.rotations.drain(..self.joints.len().min(self.rotations.len()));
        for values in self.translations_mut() {
            values.drain(..1.min(values.len()));
        }
    }

    /// Returns joints and end sites in the rest pose, with the root at the origin, in file units.
    pub(super) fn rest_points(&self) -> Vec<Vec3> {
        let mut world = WorldPose::default();
        for joint in &self.joints {
            let position = joint
                .parent
                .and_then(|parent| world.positions.get(parent))
                .map_or(Vec3::ZERO, |&parent| parent + joint.offset);
            world.positions.push(position);
        }
        world.rotations = vec![Quat::IDENTITY; world.positions.len()];
        with_end_sites(&self.joints, world)
    }

    /// Returns joints and end sites in a frame, in file units and axes.
    pub(super) fn world_points(&self, skeleton: &Skeleton, frame: usize) -> Vec<Vec3> {
        let mut world = WorldPose::default();
        let root = self.root_translations.get(frame).copied().unwrap_or_default();
        let moved =
            self.tracks.iter().filter_map(|(joint, values)| Some((*joint, *values.get(frame)?)));
        world_pose_into(skeleton, root, self.pose(frame), moved, &mut world);
        with_end_sites(&self.joints, world)
    }

    /// Converts the motion to a clip in metres with Y up, whose first joint is the one that carries
    /// the body ([`Clip::folded`]).
    pub(super) fn into_clip(
        self,
        name: String,
        fps: f64,
        provenance: Provenance,
    ) -> Result<Clip, RawError> {
        Ok(self.into_unfolded(name, fps, provenance)?.folded()?)
    }

    /// Converts the motion as [`into_clip`](Self::into_clip) does, where the file states the roles
    /// of some joints; the roles returned are those of the clip's joints
    /// ([`Roles::detect_beside`]).
    pub(super) fn into_clip_with_roles(
        self,
        name: String,
        fps: f64,
        provenance: Provenance,
        stated: &[(Role, usize)],
    ) -> Result<(Clip, Roles), RawError> {
        let clip = self.into_unfolded(name, fps, provenance)?;
        let roles = Roles::detect_beside(clip.skeleton(), stated);
        let clip = clip.folded_by(&roles)?;
        let roles = match clip.skeleton().folded_chain() {
            Some(above) => roles.renumbered(&above.from_file()),
            None => roles,
        };
        Ok((clip, roles))
    }

    fn into_unfolded(
        mut self,
        name: String,
        fps: f64,
        provenance: Provenance,
    ) -> Result<Clip, RawError> {
        let Provenance { metres_per_unit, up } = provenance;
        let length = |v: Vec3| {
            let v = (v.as_dvec3() * metres_per_unit).as_vec3();
            match up {
                UpAxis::Y => v,
                UpAxis::Z => y_up_from_z_up(v),
            }
        };
        for joint in &mut self.joints {
            joint.offset = length(joint.offset);
            joint.end_site = joint.end_site.map(length);
        }
        self.translations_mut().flatten().for_each(|v| *v = length(*v));
        if up == UpAxis::Z {
            for q in &mut self.rotations {
                let v = y_up_from_z_up(Vec3::new(q.x, q.y, q.z));
                *q = Quat::from_xyzw(v.x, v.y, v.z, q.w);
            }
        }
        let joints = &self.joints;
        self.tracks.retain(|(joint, values)| {
            let rest = joints.get(*joint).map_or(Vec3::ZERO, |joint| joint.offset);
            values.iter().any(|v| (*v - rest).abs().max_element() > SAME_PLACE)
        });
        let tracks = self
            .tracks
            .into_iter()
            .map(|(joint, values)| JointTranslations { joint, values })
            .collect();
        let skeleton = Arc::new(Skeleton::new(self.joints)?);
        let clip = Clip::new(name, skeleton, fps, self.rotations, self.root_translations)?;
        Ok(clip.with_translations(tracks)?.with_provenance(provenance))
    }
}

fn no_memory(frames: usize) -> Fault {
    let found = msg!("a motion for which there is no memory after {frames} frames", frames);
    Fault::new(0, found, "a motion that fits into memory").with_hint("cut the motion into parts")
}

/// Appends zeros up to a length; `None` if there is no memory for them.
#[cfg(feature = "parallel")]
fn lengthen<T: bytemuck::Pod>(values: &mut Vec<T>, length: usize) -> Option<()> {
    let before = values.len();
    if before > length / 2 {
        values.try_reserve_exact(length.saturating_sub(before)).ok()?;
        values.resize(length, T::zeroed());
        return Some(());
    }
    // Memory that the system hands out is zero, and is handed out where it is first written: by all
    // cores.
    let mut longer = bytemuck::allocation::try_zeroed_vec(length).ok()?;
    longer.get_mut(..before)?.copy_from_slice(values);
    *values = longer;
    Some(())
}

/// Rotates a vector by -90° about X: +Z becomes +Y, and -Y, which a Z-up character faces by
/// convention, becomes +Z.
fn y_up_from_z_up(v: Vec3) -> Vec3 {
    Vec3::new(v.x, v.z, -v.y)
}

/// The rotation of [`y_up_from_z_up`].
pub(super) const Y_UP_FROM_Z_UP: Quat =
    Quat::from_xyzw(-std::f32::consts::FRAC_1_SQRT_2, 0.0, 0.0, std::f32::consts::FRAC_1_SQRT_2);

fn with_end_sites(joints: &[Joint], world: WorldPose) -> Vec<Vec3> {
    let ends = joints
        .iter()
        .enumerate()
        .filter_map(|(index, joint)| Some(world.point(index, joint.end_site?)));
    let ends: Vec<Vec3> = ends.collect();
    let mut points = world.positions;
    points.extend(ends);
    points
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn reserve_beyond_memory_is_refused() {
        let joint = Joint {
            name: "root".into(),
            parent: None,
            offset: Vec3::ZERO,
            end_site: None,
            channels: Vec::new(),
        };
        let mut raw = RawMotion { joints: vec![joint], ..RawMotion::default() };
        for frames in [usize::MAX, usize::MAX / 64] {
            let refused = raw.reserve(frames).unwrap_err();
            assert!(refused.found.to_string().contains("no memory"), "{refused:?}");
        }
        raw.reserve(100).unwrap();
        assert!(raw.rotations.capacity() >= 100 && raw.root_translations.capacity() >= 100);
    }
}
