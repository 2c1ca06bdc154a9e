//! Groups of items in flat arrays.

/// Groups items by `of`, the number of the group of each: returns the end of each group, and the
/// indices of the items in that order, stable within a group. Three passes over flat arrays: with
/// very many edges, lists of lists would take most of the time.
pub(super) fn grouped(
    groups: usize,
    of: impl Iterator<Item = usize> + Clone,
) -> (Vec<usize>, Vec<usize>) {
    let mut next = vec![0; groups + 1];
    let mut count = 0;
    for group in of.clone() {
        next[group + 1] += 1;
        count += 1;
    }
    for group in 0..groups {
        next[group + 1] += next[group];
    }
    let mut order = vec![0; count];
    for (item, group) in of.enumerate() {
        order[next[group]] = item;
        next[group] += 1;
    }
    next.pop();
    (next, order)
}
