//! Conversion of rows of values to rotations and translations.

use super::asf::Dof;
use super::skeleton::{AcclaimSkeleton, Motor};
use crate::bvh::{FIRST_ROWS, MEMORY_FLOOR, MEMORY_PER_BYTE};
use crate::error::Fault;
use crate::raw::RawMotion;
use glam::{DQuat, DVec3, Quat, Vec3};
use segue_text::msg;

/// A collector of rows as rotations, in file units and file axes.
pub(super) struct Converter<'s> {
    skeleton: &'s AcclaimSkeleton,
    /// Whether the values of rotations are radians.
    pub(super) radians: bool,
    raw: RawMotion,
    /// The root's orientation: the frame of reference of the whole motion.
    orientation: DQuat,
    bytes_per_row: u64,
    /// The number of rows for which memory is reserved.
    room: usize,
    bytes: u64,
    limit: u64,
}

impl<'s> Converter<'s> {
    /// Returns a converter. `bytes` is the length of the file and bounds the allocation.
    pub(super) fn new(skeleton: &'s AcclaimSkeleton, bytes: usize) -> Self {
        let stretches = |joint: usize| {
            skeleton.motors.get(joint).is_some_and(|motor| motor.dofs.contains(&Dof::Stretch))
        };
        let moves = |joint: usize| {
            let own = skeleton.motors.get(joint);
            let own =
                own.is_some_and(|motor| motor.dofs.iter().any(|dof| matches!(dof, Dof::Move(_))));
            let parent = skeleton.joints.get(joint).and_then(|joint| joint.parent);
            own || parent.is_some_and(stretches)
        };
        let moving = (1..skeleton.joints.len()).filter(|&joint| moves(joint));
        let raw = RawMotion {
            joints: skeleton.joints.clone(),
            tracks: moving.map(|joint| (joint, Vec::new())).collect(),
            ..RawMotion::default()
        };
        let bytes_per_row = (raw.joints.len() * size_of::<Quat>()
            + (raw.tracks.len() + 1) * size_of::<Vec3>()) as u64;
        Self {
            skeleton,
            radians: skeleton.radians,
            orientation: skeleton
                .motors
                .first()
                .map_or(DQuat::IDENTITY, |root| DQuat::from_mat3(&root.axes)),
            raw,
            bytes_per_row,
            room: 0,
            bytes: 0,
            limit: MEMORY_FLOOR.saturating_add(MEMORY_PER_BYTE.saturating_mul(bytes as u64)),
        }
    }

    /// Appends one row: the values of all joints, joint after joint.
    ///
    /// A rotation M about the bone's own axes C is C · M · C⁻¹ in the frame of its parent, which is
    /// the joint's rotation.
    pub(super) fn row(&mut self, values: &[f64]) -> Result<(), Fault> {
        self.bytes += self.bytes_per_row;
        if self.bytes > self.limit {
            let found = msg!(
                "a motion of more than {mb} MB, most of it in bones without values",
                mb = self.limit >> 20
            );
            return Err(Fault::new(0, found, "a motion that fits into memory")
                .with_hint("cut the motion into parts"));
        }
        if self.raw.frames() == self.room {
            let fits = (self.limit / self.bytes_per_row.max(1)) as usize;
            let rows = (self.room / 2).max(FIRST_ROWS).min(fits).max(1);
            self.raw.reserve(rows)?;
            self.room += rows;
        }
        let mut largest: f64 = 0.0;
        let mut tracks = self.raw.tracks.iter_mut().peekable();
        for (joint, motor) in self.skeleton.motors.iter().enumerate() {
            let own = values.get(motor.first_value..).unwrap_or_default();
            let (turn, angle) = turn(motor, own, self.radians);
            largest = largest.max(angle);
            let rotation = if joint == 0 {
                self.orientation * turn
            } else {
                let v = motor.axes * DVec3::new(turn.x, turn.y, turn.z);
                DQuat::from_xyzw(v.x, v.y, v.z, turn.w)
            };
            self.raw.rotations.push(rotation.as_quat());
            let place = || {
                let parent = self.skeleton.joints.get(joint).and_then(|joint| joint.parent);
                let above = parent.and_then(|parent| self.skeleton.motors.get(parent));
                let stretch = above.map_or(DVec3::ZERO, |motor| {
                    let own = values.get(motor.first_value..).unwrap_or_default();
                    motor.direction * value(motor, own, Dof::Stretch)
                });
                let moved =
                    DVec3::from_array([0, 1, 2].map(|axis| value(motor, own, Dof::Move(axis))));
                (motor.offset + motor.axes * moved + stretch).as_vec3()
            };
            if joint == 0 {
                self.raw.root_translations.push(place());
            } else if let Some((_, track)) = tracks.next_if(|(moving, _)| *moving == joint) {
                track.push(place());
            }
        }
        self.raw.wild_angles.add_row(largest.to_degrees());
        Ok(())
    }

    /// Returns the motion, in file units and file axes.
    pub(super) fn finish(self) -> RawMotion {
        self.raw
    }
}

fn value(motor: &Motor, own: &[f64], dof: Dof) -> f64 {
    let place = motor.dofs.iter().position(|other| *other == dof);
    place.and_then(|place| own.get(place).copied()).unwrap_or_default()
}

/// Returns M, the product of a bone's rotations about fixed axes, and its largest angle, radians.
fn turn(motor: &Motor, own: &[f64], radians: bool) -> (DQuat, f64) {
    let turns = motor.dofs.iter().zip(own).filter_map(|(dof, &value)| {
        let angle = if radians { value } else { value.to_radians() };
        match dof {
            Dof::Turn(axis) => Some((DVec3::AXES[*axis], angle)),
            _ => None,
        }
    });
    turns.fold((DQuat::IDENTITY, 0.0), |(before, largest), (axis, angle)| {
        (DQuat::from_axis_angle(axis, angle) * before, largest.max(angle.abs()))
    })
}
