use super::Skeleton;

/// Which joint lies below which, answered in constant time: joints are numbered in depth-first
/// order, so that what lies below a joint is a range. Files may hold thousands of joints in one
/// chain.
#[derive(Clone, Debug)]
pub(crate) struct Ancestry {
    /// Place of each joint in depth-first order.
    places: Vec<usize>,
    /// Joints in each subtree, its top included.
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
        let mut places = vec![0; joints.len()];
        // The next free place below each joint.
        let mut free = vec![1; joints.len()];
        for (joint, parent) in joints.iter().map(|j| j.parent).enumerate() {
            if let Some(parent) = parent {
                places[joint] = free[parent];
                free[parent] += sizes[joint];
                free[joint] = places[joint] + 1;
            }
        }
        Self { places, sizes }
    }

    /// Whether `joint` lies below `above` in the tree, and is not that joint itself.
    pub(crate) fn is_below(&self, joint: usize, above: usize) -> bool {
        let (joint, above, size) = (self.places[joint], self.places[above], self.sizes[above]);
        above < joint && joint < above + size
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::skeleton::fixtures;

    #[test]
    fn agrees_with_walking_up_the_tree() {
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
