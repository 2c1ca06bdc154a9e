//! Tests of the long run of a random walk.

use super::super::long_run::{LongRun, Step};
use petgraph::graph::NodeIndex;
use proptest::prelude::*;

fn step(from: usize, to: usize, probability: f64) -> Step {
    Step { from: NodeIndex::new(from), to: NodeIndex::new(to), probability }
}

fn shares(nodes: usize, steps: &[Step]) -> Vec<f64> {
    let mut run = LongRun::new(nodes, steps.to_vec());
    while !run.advance(1) {}
    run.shares().collect()
}

/// Returns the distribution after 2⁴⁰ steps from all nodes, by squaring the matrix of the steps.
/// Half of the probability stays in place, so that a walk of a fixed period converges, too.
fn by_squaring(nodes: usize, steps: &[Step]) -> Vec<f64> {
    let mut matrix = vec![vec![0.0; nodes]; nodes];
    for step in steps {
        matrix[step.from.index()][step.to.index()] += 0.5 * step.probability;
    }
    for (node, row) in matrix.iter_mut().enumerate() {
        row[node] += 1.0 - row.iter().sum::<f64>();
    }
    for _ in 0..40 {
        let mut squared = vec![vec![0.0; nodes]; nodes];
        for (row, from) in squared.iter_mut().zip(&matrix) {
            for (&p, through) in from.iter().zip(&matrix) {
                for (cell, q) in row.iter_mut().zip(through) {
                    *cell += p * q;
                }
            }
            // Rounding would grow with each square.
            let all: f64 = row.iter().sum();
            for cell in row.iter_mut() {
                *cell /= all;
            }
        }
        matrix = squared;
    }
    (0..nodes).map(|to| matrix.iter().map(|row| row[to]).sum::<f64>() / nodes as f64).collect()
}

fn assert_near(found: &[f64], expected: &[f64]) {
    let near = found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-9);
    assert!(near && found.len() == expected.len(), "{found:?} {expected:?}");
}

#[test]
fn visits_of_a_cycle_with_two_ways_back_settle() {
    // Sweeps of whole steps would exchange the visits of two nodes for ever.
    let steps =
        [step(0, 2, 1.0), step(2, 2, 0.5), step(2, 1, 0.5), step(1, 3, 1.0), step(3, 0, 1.0)];
    assert_near(&shares(4, &steps), &[0.2, 0.2, 0.4, 0.2]);
}

#[test]
fn walks_end_up_in_the_parts_that_they_cannot_leave() {
    // From 0, a third goes to the cycle of 1 and 2, and two thirds stay at 3, where walks end.
    let steps = [
        step(0, 0, 0.7),
        step(0, 1, 0.1),
        step(0, 3, 0.2),
        step(1, 2, 1.0),
        step(2, 1, 0.5),
        step(2, 2, 0.5),
    ];
    let cycle = 0.25 * (2.0 + 1.0 / 3.0);
    let expected = [0.0, cycle / 3.0, cycle * 2.0 / 3.0, 0.25 * (1.0 + 2.0 / 3.0)];
    assert_near(&shares(4, &steps), &expected);
    assert_near(&by_squaring(4, &steps), &expected);
    assert!(shares(0, &[]).is_empty());
    assert_eq!(shares(1, &[step(0, 0, 1.0)]), [1.0]);
}

proptest! {
    #[test]
    fn shares_are_those_after_very_many_steps(
        nodes in 1_usize..9,
        ways in prop::collection::vec((0_usize..9, 0_usize..9, 1_u32..9), 0..24),
    ) {
        let weights = |from| {
            let of_one = ways.iter().filter(move |(node, ..)| node % nodes == from);
            of_one.map(|&(.., weight)| f64::from(weight)).sum::<f64>()
        };
        let steps: Vec<Step> = ways
            .iter()
            .map(|&(from, to, weight)| {
                let from = from % nodes;
                step(from, to % nodes, f64::from(weight) / weights(from))
            })
            .collect();
        assert_near(&shares(nodes, &steps), &by_squaring(nodes, &steps));
    }
}
