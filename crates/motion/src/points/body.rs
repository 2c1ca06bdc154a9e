//! A body as its points show it: a tree of joints with their tracks.

use super::gaps::{Gaps, Track};
use super::{PointKind, PointSet, PointsError};
use crate::clip::UpAxis;
use crate::skeleton::SkeletonError;
use glam::Vec3;

/// A joint with the track of its point.
pub(super) struct Node {
    /// The index of its point.
    pub(super) point: usize,
    pub(super) parent: Option<usize>,
    pub(super) track: Track,
    pub(super) children: Vec<usize>,
    /// The tracks of its helpers, and where they lie beside the bone ([`PointKind::Helper`]).
    pub(super) helpers: Vec<(Track, Vec3)>,
}

/// The joints of a body that are seen in some frame, Y up.
pub(super) struct Body {
    pub(super) nodes: Vec<Node>,
    pub(super) frames: usize,
    pub(super) fps: f64,
}

/// The child joints and helpers of a joint.
pub(super) struct Members<'a> {
    pub(super) tracks: Vec<&'a Track>,
    /// The number of child joints, which come first.
    pub(super) joints: usize,
}

impl Body {
    /// Returns the body of a set of points; points that are never seen go into `gaps`.
    ///
    /// # Errors
    /// [`PointsError`] when the points are no tree, or no frame shows any of them.
    pub(super) fn of(set: &PointSet<'_>, gaps: &mut Gaps) -> Result<Self, PointsError> {
        let points = set.points.len();
        let Some(root) = set.points.first() else {
            return Err(SkeletonError::Empty.into());
        };
        let not_a_root = |index: usize, name: &str| {
            PointsError::from(SkeletonError::NotOneRoot { index, name: name.to_owned() })
        };
        if root.parent.is_some() || root.kind != PointKind::Joint {
            return Err(not_a_root(0, &root.name));
        }
        if !set.positions.len().is_multiple_of(points) {
            return Err(PointsError::Uneven { positions: set.positions.len(), points });
        }
        let frames = set.positions.len() / points;
        let mut nodes: Vec<Node> = Vec::with_capacity(points);
        // The joint that stands for each point: its own, or the nearest one above that is seen.
        let mut joint_of: Vec<Option<usize>> = Vec::with_capacity(points);
        for (index, point) in set.points.iter().enumerate() {
            let parent = match point.parent {
                None if index == 0 => None,
                None => return Err(not_a_root(index, &point.name)),
                Some(parent) if parent < index => joint_of[parent],
                Some(parent) => {
                    let name = point.name.clone();
                    return Err(SkeletonError::ParentAfterChild { index, name, parent }.into());
                }
            };
            let values = set.positions.iter().skip(index).step_by(points).map(|&v| match set.up {
                UpAxis::Y => v,
                UpAxis::Z => Vec3::new(v.x, v.z, -v.y),
            });
            let Some(track) = Track::of(values, set.fps, gaps) else {
                gaps.unseen.push(point.name.clone());
                joint_of.push(parent);
                continue;
            };
            match (point.kind, parent) {
                (PointKind::Helper { beside }, Some(parent)) => {
                    nodes[parent].helpers.push((track, beside));
                    joint_of.push(Some(parent));
                }
                (PointKind::Helper { .. }, None) => joint_of.push(None),
                (PointKind::Joint, parent) => {
                    // With the root unseen, the first joint below takes its place.
                    let parent = parent.or_else(|| (!nodes.is_empty()).then_some(0));
                    let own = nodes.len();
                    if let Some(parent) = parent {
                        nodes[parent].children.push(own);
                    }
                    joint_of.push(Some(own));
                    nodes.push(Node {
                        point: index,
                        parent,
                        track,
                        children: Vec::new(),
                        helpers: Vec::new(),
                    });
                }
            }
        }
        if nodes.is_empty() || frames == 0 {
            return Err(PointsError::Unseen);
        }
        Ok(Self { nodes, frames, fps: set.fps })
    }

    /// Returns the child joints and helpers of a joint.
    pub(super) fn members(&self, joint: usize) -> Members<'_> {
        let node = &self.nodes[joint];
        let children = node.children.iter().map(|&child| &self.nodes[child].track);
        let joints = node.children.len();
        Members {
            tracks: children.chain(node.helpers.iter().map(|(track, _)| track)).collect(),
            joints,
        }
    }
}
