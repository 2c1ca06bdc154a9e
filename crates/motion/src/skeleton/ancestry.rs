//! Constant-time ancestor tests.

use super::Skeleton;

/// Ancestor tests in constant time: joints are numbered in depth-first order, so that the joints
/// below a joint form a range. Files may hold thousands of joints in one chain.
#[derive(Clone, Debug)]
pub(crate) struct Ancestry {
    /// Index of each joint in depth-first order.
    order: Vec<usize>,
    /// Number of joints in each subtree, its top included.
    sizes: Vec<usize>,
}

impl Ancestry {
    pub(crate) fn of(skeleton: &Skeleton) -> Self {
        let joints = skeleton.joints();
        let mut sizes = vec![1; joints.len()];
        for (joint, parent) in joints.iter().map(|j| j.parent).enumerate().rev() {
            if let Some(parent) = parent {
                sizes[parent] += sizes[joint];
            }
        }
        let mut order = vec![0; joints.len()];
        // The next free depth-first index below each joint.
        let mut free = vec![1; joints.len()];
        for (joint, parent) in joints.iter().map(|j| j.parent).enumerate() {
            if let Some(parent) = parent {
                order[joint] = free[parent];
                free[parent] += sizes[joint];
                free[joint] = order[joint] + 1;
            }
        }
        Self { order, sizes }
    }

    /// Returns whether `joint` lies below `above` in the tree, and is not that joint itself.
    pub(crate) fn is_below(&self, joint: usize, above: usize) -> bool {
        let (joint, above, size) = (self.order[joint], self.order[above], self.sizes[above]);
        above < joint && joint < above + size
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::skeleton::fixtures;

    #[test]
    fn is_below_agrees_with_walking_up_the_tree() {
        for (rig, skeleton, _) in fixtures::all() {
            for seed in 0..4 {
                let (skeleton, _) = fixtures::shuffled(&skeleton, seed);
                let ancestry = Ancestry::of(&skeleton);
                for joint in 0..skeleton.len() {
                    for above in 0..skeleton.len() {
                        let walked =
                            std::iter::successors(skeleton.parent(joint), |&j| skeleton.parent(j))
                                .any(|j| j == above);
                        assert_eq!(
                            ancestry.is_below(joint, above),
                            walked,
                            "{rig}: {joint} below {above}"
                        );
                    }
                }
            }
        }
    }
}
