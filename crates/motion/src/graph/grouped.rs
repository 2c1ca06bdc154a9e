//! Groups of items in flat arrays.

use petgraph::graph::NodeIndex;

/// Groups items by `of`: returns the end of each group, and the indices of the items in that order,
/// stable within a group. Three passes over flat arrays: with very many edges, lists of lists would
/// take most of the time.
pub(super) fn grouped(
    groups: usize,
    of: impl Iterator<Item = NodeIndex> + Clone,
) -> (Vec<usize>, Vec<usize>) {
    let mut next = vec![0; groups + 1];
    let mut count = 0;
    for group in of.clone() {
        next[group.index() + 1] += 1;
        count += 1;
    }
    for group in 0..groups {
        next[group + 1] += next[group];
    }
    let mut order = vec![0; count];
    for (item, group) in of.enumerate() {
        order[next[group.index()]] = item;
        next[group.index()] += 1;
    }
    next.pop();
    (next, order)
}
