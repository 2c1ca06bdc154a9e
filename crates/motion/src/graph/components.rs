//! Strongly connected components.

use super::grouped::grouped;

/// Marks a node that was not reached yet.
const UNSEEN: usize = usize::MAX;

/// Returns the strongly connected components of a graph of so many nodes with these edges (from,
/// to), each with its nodes in rising order. An edge from one component to another leads to an
/// earlier one.
///
/// Tarjan, "Depth-First Search and Linear Graph Algorithms", 1972, without recursion, because a
/// clip is a chain of thousands of nodes, and in flat arrays: in a graph of linked edges, which are
/// scattered in memory, it takes five times as long. O(nodes + edges).
pub(super) fn components(
    nodes: usize,
    edges: impl Iterator<Item = (usize, usize)> + Clone,
) -> Vec<Vec<usize>> {
    let (ends, order) = grouped(nodes, edges.clone().map(|(from, _)| from));
    let targets: Vec<usize> = edges.map(|(_, to)| to).collect();
    let start = |node: usize| node.checked_sub(1).map_or(0, |before| ends[before]);
    // The number of each node in the order of discovery, and the smallest number of a node on the
    // stack that is known to be reached from it.
    let (mut numbers, mut lowest) = (vec![UNSEEN; nodes], vec![UNSEEN; nodes]);
    let (mut stack, mut is_on_stack) = (Vec::new(), vec![false; nodes]);
    // The nodes on the way from the root, each with its next edge.
    let mut path: Vec<(usize, usize)> = Vec::new();
    let (mut found, mut discovered) = (Vec::new(), 0);
    for root in 0..nodes {
        let mut next = (numbers[root] == UNSEEN).then_some(root);
        loop {
            if let Some(node) = next.take() {
                (numbers[node], lowest[node]) = (discovered, discovered);
                discovered += 1;
                stack.push(node);
                is_on_stack[node] = true;
                path.push((node, start(node)));
            }
            let Some((node, edge)) = path.last_mut() else { break };
            let node = *node;
            if *edge < ends[node] {
                let target = targets[order[*edge]];
                *edge += 1;
                if numbers[target] == UNSEEN {
                    next = Some(target);
                } else if is_on_stack[target] {
                    lowest[node] = lowest[node].min(numbers[target]);
                }
                continue;
            }
            path.pop();
            if let Some(&(before, _)) = path.last() {
                lowest[before] = lowest[before].min(lowest[node]);
            }
            if lowest[node] == numbers[node] {
                let first = stack.iter().rposition(|on_stack| *on_stack == node).unwrap_or(0);
                let mut component = stack.split_off(first);
                for &member in &component {
                    is_on_stack[member] = false;
                }
                component.sort_unstable();
                found.push(component);
            }
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;
    use petgraph::algo::kosaraju_scc;
    use petgraph::graph::{DiGraph, NodeIndex};
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn components_are_those_of_another_algorithm(
            nodes in 1_usize..20,
            edges in prop::collection::vec((0_usize..20, 0_usize..20), 0..60),
        ) {
            let edges: Vec<(usize, usize)> =
                edges.into_iter().map(|(from, to)| (from % nodes, to % nodes)).collect();
            let found = components(nodes, edges.iter().copied());
            let mut graph = DiGraph::<(), ()>::new();
            for _ in 0..nodes {
                graph.add_node(());
            }
            for &(from, to) in &edges {
                graph.add_edge(NodeIndex::new(from), NodeIndex::new(to), ());
            }
            let sorted = |mut all: Vec<Vec<usize>>| {
                for component in &mut all {
                    component.sort_unstable();
                }
                all.sort_unstable();
                all
            };
            let expected = kosaraju_scc(&graph).into_iter();
            let expected = expected.map(|all| all.into_iter().map(NodeIndex::index).collect());
            prop_assert_eq!(sorted(found.clone()), sorted(expected.collect()));
            let of = |node: usize| found.iter().position(|all| all.contains(&node)).unwrap();
            prop_assert!(edges.iter().all(|&(from, to)| of(to) <= of(from)));
            prop_assert!(found.iter().all(|component| component.is_sorted()));
        }
    }

    #[test]
    fn long_chains_need_no_recursion() {
        let nodes = 300_000;
        let chain = (1..nodes).map(|node| (node - 1, node));
        assert_eq!(components(nodes, chain.clone()).len(), nodes);
        assert_eq!(components(nodes, chain.chain([(nodes - 1, 0)])).len(), 1);
        assert!(components(0, std::iter::empty()).is_empty());
    }
}
