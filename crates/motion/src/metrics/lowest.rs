//! The lowest point of a pose.

use crate::skeleton::{Skeleton, WorldPose};
use glam::Vec3;

/// The points of a skeleton that can touch the ground: its joints and end sites.
#[derive(Clone, Debug)]
pub(super) struct LowPoints {
    tips: Vec<(usize, Vec3)>,
}

impl LowPoints {
    /// Returns the points of a skeleton.
    pub(super) fn of(skeleton: &Skeleton) -> Self {
        let joints = skeleton.joints().iter().enumerate();
        Self { tips: joints.filter_map(|(joint, j)| j.end_site.map(|end| (joint, end))).collect() }
    }

    /// Returns the height of the lowest point in a pose, metres; `None` without joints.
    pub(super) fn lowest(&self, world: &WorldPose) -> Option<f32> {
        let joints = world.positions.iter().map(|p| p.y);
        let tips = self.tips.iter().map(|&(joint, end)| world.point(joint, end).y);
        joints.chain(tips).min_by(f32::total_cmp)
    }
}
