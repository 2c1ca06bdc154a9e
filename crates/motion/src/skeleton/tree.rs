//! Skeletons: trees of joints in topological order.

use super::FoldedChain;
use glam::Vec3;

/// A number per frame that a file has for a joint.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, serde::Serialize, serde::Deserialize)]
#[expect(missing_docs, reason = "the names are the BVH keywords")]
pub enum Channel {
    XPosition,
    YPosition,
    ZPosition,
    XRotation,
    YRotation,
    ZRotation,
}

/// A joint: the end of the bone from its parent, and the pivot of everything below it.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Joint {
    /// The name, as written in the file. Names need not be unique: joints are keyed by index.
    pub name: String,
    /// The index of the parent; smaller than the joint's own. `None` for the root.
    pub parent: Option<usize>,
    /// Rest translation from the parent, in the parent's frame, metres.
    pub offset: Vec3,
    /// The end of the bone in the joint's frame, metres: the tip of a toe, a finger or the head.
    pub end_site: Option<Vec3>,
    /// The channels that the source file has for this joint, in its order. Empty where it has none.
    pub channels: Vec<Channel>,
}

/// Error in a list of joints.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error, segue_text::ToMessage)]
pub enum SkeletonError {
    /// The list is empty.
    #[error("a skeleton needs at least one joint")]
    Empty,
    /// Joint 0 has a parent, or another joint has none.
    #[error("joint {index} (`{name}`): only the first joint may be, and must be, without a parent")]
    NotOneRoot {
        /// The joint's index.
        index: usize,
        /// The joint's name.
        name: String,
    },
    /// A joint stands before its parent.
    #[error("joint {index} (`{name}`) stands before its parent, joint {parent}")]
    ParentAfterChild {
        /// The joint's index.
        index: usize,
        /// The joint's name.
        name: String,
        /// The parent's index.
        parent: usize,
    },
}

/// A tree of joints in topological order: parents first, the root at index 0. In the rest pose
/// every joint's rotation is the identity.
///
/// Two skeletons are equal when their bodies are. The rest offset of the root does not count,
/// because every frame has a root translation, and neither do the joints that a file has above it
/// ([`FoldedChain`]). Both differ between files of one rig.
#[derive(Clone, Debug)]
pub struct Skeleton {
    joints: Vec<Joint>,
    above: Option<Box<FoldedChain>>,
}

impl PartialEq for Skeleton {
    fn eq(&self, other: &Self) -> bool {
        let [(root, body), (other_root, other_body)] =
            [self, other].map(|skeleton| (&skeleton.joints[0], &skeleton.joints[1..]));
        let same_root = root.name == other_root.name
            && root.end_site == other_root.end_site
            && root.channels == other_root.channels;
        same_root && body == other_body
    }
}

impl Skeleton {
    /// Returns the skeleton of `joints`, which must be a tree with its root first and every parent
    /// before its children.
    ///
    /// # Errors
    /// [`SkeletonError`] names the joint that breaks the rule.
    pub fn new(joints: Vec<Joint>) -> Result<Self, SkeletonError> {
        if joints.is_empty() {
            return Err(SkeletonError::Empty);
        }
        for (index, joint) in joints.iter().enumerate() {
            match joint.parent {
                Some(parent) if index > 0 && parent >= index => {
                    return Err(SkeletonError::ParentAfterChild {
                        index,
                        name: joint.name.clone(),
                        parent,
                    });
                }
                Some(_) if index > 0 => {}
                None if index == 0 => {}
                _ => {
                    return Err(SkeletonError::NotOneRoot { index, name: joint.name.clone() });
                }
            }
        }
        Ok(Self { joints, above: None })
    }

    /// Returns the skeleton with the joints that its file has above the root. They are left out
    /// where they do not fit a skeleton of this many joints.
    #[must_use]
    pub fn with_folded_chain(mut self, above: Option<FoldedChain>) -> Self {
        self.above = above.filter(|above| above.fits(self.joints.len())).map(Box::new);
        self
    }

    /// Returns the joints that its file has above the root; `None` where the file's root is the
    /// skeleton's.
    #[must_use]
    pub fn folded_chain(&self) -> Option<&FoldedChain> {
        self.above.as_deref()
    }

    /// Returns all joints, parents first.
    #[must_use]
    pub fn joints(&self) -> &[Joint] {
        &self.joints
    }

    /// Returns the number of joints; at least 1.
    #[must_use]
    #[expect(clippy::len_without_is_empty, reason = "a skeleton is never empty")]
    pub fn len(&self) -> usize {
        self.joints.len()
    }

    /// Returns the index of the parent of `joint`.
    #[must_use]
    pub fn parent(&self, joint: usize) -> Option<usize> {
        self.joints.get(joint).and_then(|j| j.parent)
    }

    /// Returns these joints, all their ancestors and the root, in rising order: the joints that
    /// their kinematics need. Indices out of range are left out.
    #[must_use]
    pub(crate) fn with_ancestors(&self, joints: impl IntoIterator<Item = usize>) -> Vec<usize> {
        let mut needed = vec![false; self.len()];
        for joint in joints.into_iter().chain([0]) {
            let mut next = Some(joint).filter(|&joint| joint < self.len());
            // The ancestors of a joint that is included are included already.
            while let Some(joint) = next.filter(|&joint| !needed[joint]) {
                needed[joint] = true;
                next = self.parent(joint);
            }
        }
        (0..self.len()).filter(|&joint| needed[joint]).collect()
    }

    /// Returns the children of `joint`, in order.
    pub fn children(&self, joint: usize) -> impl Iterator<Item = usize> + '_ {
        (joint + 1..self.joints.len())
            .filter(move |&child| self.joints[child].parent == Some(joint))
    }

    /// Returns the first joint of that name.
    #[must_use]
    pub fn find(&self, name: &str) -> Option<usize> {
        self.joints.iter().position(|j| j.name == name)
    }

    /// Returns the skeleton with all lengths multiplied by `factor`, those of the joints that its
    /// file has above the root included.
    #[must_use]
    pub fn scaled(&self, factor: f32) -> Self {
        let joints = self.joints.iter().map(|joint| Joint {
            offset: joint.offset * factor,
            end_site: joint.end_site.map(|end| end * factor),
            ..joint.clone()
        });
        let above = self.above.as_ref().map(|above| Box::new(above.scaled(factor)));
        Self { joints: joints.collect(), above }
    }

    /// Returns the joints' positions in the rest pose with the root at the origin, metres.
    #[must_use]
    pub fn rest_positions(&self) -> Vec<Vec3> {
        let mut positions: Vec<Vec3> = Vec::with_capacity(self.joints.len());
        for joint in &self.joints {
            positions
                .push(joint.parent.map_or(Vec3::ZERO, |parent| positions[parent] + joint.offset));
        }
        positions
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn joint(parent: Option<usize>) -> Joint {
        Joint { name: "j".into(), parent, offset: Vec3::Y, end_site: None, channels: vec![] }
    }

    #[test]
    fn skeletons_with_other_root_offsets_are_equal() {
        let with = |root: Vec3, child: Vec3| {
            let joints = [(None, root), (Some(0), child)]
                .map(|(parent, offset)| Joint { offset, ..joint(parent) });
            Skeleton::new(joints.to_vec()).unwrap()
        };
        assert_eq!(with(Vec3::ZERO, Vec3::Y), with(Vec3::new(0.8, 93.9, -452.0), Vec3::Y));
        assert_ne!(with(Vec3::ZERO, Vec3::Y), with(Vec3::ZERO, Vec3::X));
    }

    #[test]
    fn skeleton_of_invalid_tree_is_refused() {
        assert_eq!(Skeleton::new(vec![]), Err(SkeletonError::Empty));
        assert!(matches!(
            Skeleton::new(vec![joint(Some(0))]),
            Err(SkeletonError::NotOneRoot { index: 0, .. })
        ));
        assert!(matches!(
            Skeleton::new(vec![joint(None), joint(None)]),
            Err(SkeletonError::NotOneRoot { index: 1, .. })
        ));
        assert!(matches!(
            Skeleton::new(vec![joint(None), joint(Some(1))]),
            Err(SkeletonError::ParentAfterChild { index: 1, .. })
        ));
        let skeleton =
            Skeleton::new(vec![joint(None), joint(Some(0)), joint(Some(0)), joint(Some(1))])
                .unwrap();
        assert_eq!(skeleton.children(0).collect::<Vec<_>>(), [1, 2]);
        assert_eq!(skeleton.rest_positions()[3], Vec3::Y * 2.0);
    }
}
