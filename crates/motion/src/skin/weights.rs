//! Weights of vertices: initially that of the joint on whose bone the vertex lies, then diffused to
//! neighbours.

use glam::Vec3;

/// Number of diffusion rounds.
const ROUNDS: usize = 20;
/// The greatest share of a vertex's weights that one round replaces by those of its neighbours.
const MAX_RATE: f32 = 0.95;
/// Number of joints that a vertex keeps during diffusion.
const KEPT: usize = 6;

/// The neighbours of each vertex along the edges of triangles.
#[derive(Clone, Debug, Default)]
pub(super) struct Neighbours {
    starts: Vec<u32>,
    neighbours: Vec<u32>,
}

impl Neighbours {
    pub(super) fn of(vertices: usize, triangles: &[[u32; 3]]) -> Self {
        let mut starts = vec![0u32; vertices + 1];
        for triangle in triangles {
            for &corner in triangle {
                starts[corner as usize + 1] += 1;
            }
        }
        for vertex in 0..vertices {
            starts[vertex + 1] += starts[vertex];
        }
        // On a closed surface every edge is in one triangle in each direction: each triangle gives
        // a corner its next one.
        let mut free = starts.clone();
        let mut neighbours = vec![0u32; triangles.len() * 3];
        for &[a, b, c] in triangles {
            for (corner, next) in [(a, b), (b, c), (c, a)] {
                neighbours[free[corner as usize] as usize] = next;
                free[corner as usize] += 1;
            }
        }
        Self { starts, neighbours }
    }

    pub(super) fn of_vertex(&self, vertex: usize) -> &[u32] {
        &self.neighbours[self.starts[vertex] as usize..self.starts[vertex + 1] as usize]
    }
}

/// Weights of joints, the greatest first; unused entries have weight 0.
type Shares = [(u16, f32); KEPT];

/// The diffusion of weights from the joint of each vertex to its neighbours, round by round.
#[derive(Clone, Debug)]
pub(super) struct WeightDiffusion {
    now: Vec<Shares>,
    next: Vec<Shares>,
    /// The share of each vertex's weights that a round replaces by those of its neighbours.
    rates: Vec<f32>,
    rounds: usize,
}

/// Returns the rate at which weights diffuse at each vertex so that they reach as far as `spreads`
/// says (the standard deviation of their transition, metres): on a surface with edges of length
/// `e`, `n` rounds with the rate `r` have a variance of `n r e² / 2`.
pub(super) fn rates(
    positions: &[Vec3],
    neighbours: &Neighbours,
    spreads: impl Iterator<Item = f32>,
) -> Vec<f32> {
    let rate = |(vertex, spread): (usize, f32)| {
        let around = neighbours.of_vertex(vertex);
        let squares = around
            .iter()
            .map(|&other| positions[vertex].distance_squared(positions[other as usize]));
        let edge = squares.sum::<f32>() / around.len().max(1) as f32;
        (2.0 * spread * spread / (ROUNDS as f32 * edge.max(1e-12))).clamp(0.0, MAX_RATE)
    };
    spreads.enumerate().map(rate).collect()
}

impl WeightDiffusion {
    /// Begins with one joint for each vertex. The `rates` are those of [`rates`].
    pub(super) fn new(first: impl Iterator<Item = u16>, rates: Vec<f32>) -> Self {
        let now: Vec<Shares> = first
            .map(|joint| std::array::from_fn(|i| (joint, f32::from(u8::from(i == 0)))))
            .collect();
        Self { next: now.clone(), now, rates, rounds: 0 }
    }

    /// Does one more round; returns `true` when none is left.
    pub(super) fn advance(&mut self, neighbours: &Neighbours) -> bool {
        let now = &self.now;
        let mut sum: Vec<(u16, f32)> = Vec::new();
        for (vertex, out) in self.next.iter_mut().enumerate() {
            let around = neighbours.of_vertex(vertex);
            let own = now[vertex];
            // Far from every joint all weights are equal.
            if own[0].1 == 1.0 && around.iter().all(|&other| now[other as usize][0] == own[0]) {
                *out = own;
                continue;
            }
            sum.clear();
            let mut add = |shares: &Shares, factor: f32| {
                for &(joint, weight) in shares.iter().take_while(|(_, weight)| *weight > 0.0) {
                    match sum.iter_mut().find(|(known, _)| *known == joint) {
                        Some((_, known)) => *known += weight * factor,
                        None => sum.push((joint, weight * factor)),
                    }
                }
            };
            let rate = self.rates.get(vertex).copied().unwrap_or(0.0);
            add(&own, 1.0 - rate);
            for &other in around {
                add(&now[other as usize], rate / around.len() as f32);
            }
            *out = greatest(&mut sum);
        }
        std::mem::swap(&mut self.now, &mut self.next);
        self.rounds += 1;
        self.rounds >= ROUNDS
    }

    /// Returns the four greatest weights of each vertex.
    pub(super) fn shares(&self) -> impl Iterator<Item = ([u16; 4], [f32; 4])> {
        self.now.iter().map(|shares| {
            let joints = std::array::from_fn(|i| shares[i].0);
            let total: f32 = shares[..4].iter().map(|(_, weight)| weight).sum();
            (joints, std::array::from_fn(|i| shares[i].1 / total))
        })
    }
}

/// Returns the greatest weights, scaled to the sum 1.
fn greatest(sum: &mut [(u16, f32)]) -> Shares {
    sum.sort_unstable_by(|(joint, weight), (other, than)| {
        than.total_cmp(weight).then(joint.cmp(other))
    });
    let kept = &sum[..sum.len().min(KEPT)];
    let total: f32 = kept.iter().map(|(_, weight)| weight).sum();
    let spare = kept.first().map_or(0, |(joint, _)| *joint);
    std::array::from_fn(|i| {
        kept.get(i).map_or((spare, 0.0), |&(joint, weight)| (joint, weight / total))
    })
}

/// Smooths a surface without shrinking it (Taubin, "A Signal Processing Approach to Fair Surface
/// Design", 1995): a step towards the neighbours' mean and a longer one back.
pub(super) fn fair(positions: &mut Vec<Vec3>, neighbours: &Neighbours) {
    for step in [0.5, -0.53] {
        *positions = drawn_together(positions, neighbours, step);
    }
}

/// Moves each value by a share towards the mean of its neighbours.
pub(super) fn drawn_together(values: &[Vec3], neighbours: &Neighbours, share: f32) -> Vec<Vec3> {
    let drawn = values.iter().enumerate().map(|(vertex, &own)| {
        let around = neighbours.of_vertex(vertex);
        if around.is_empty() {
            return own;
        }
        let mean =
            around.iter().map(|&other| values[other as usize]).sum::<Vec3>() / around.len() as f32;
        own + (mean - own) * share
    });
    drawn.collect()
}

/// Returns the unit normal of each vertex: the mean of the normals of its triangles, weighted by
/// area.
///
/// # Panics
///
/// Panics if a triangle names a vertex that `positions` does not have.
#[must_use]
pub fn normals(positions: &[Vec3], triangles: &[[u32; 3]]) -> Vec<Vec3> {
    let mut normals = vec![Vec3::ZERO; positions.len()];
    for triangle in triangles {
        let [a, b, c] = triangle.map(|corner| positions[corner as usize]);
        let normal = (b - a).cross(c - a);
        for &corner in triangle {
            normals[corner as usize] += normal;
        }
    }
    for normal in &mut normals {
        *normal = normal.normalize_or(Vec3::Y);
    }
    normals
}
