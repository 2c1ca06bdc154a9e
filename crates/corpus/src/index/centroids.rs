//! Centroids in two levels: a group of lists is chosen first, then a list.
//!
//! One level would need as many distances for each moment as there are lists; two need twice the
//! square root. Moments near the border of two groups would be misplaced, so several groups are
//! tried.

use super::squared;
use rand_pcg::Pcg32;
use rand_pcg::rand_core::Rng;

/// The number of groups in which the nearest list is looked for.
const GROUPS_TRIED: usize = 4;
/// Rounds of Lloyd's algorithm.
const ROUNDS: usize = 8;
/// The number of sampled moments for each list.
const SAMPLED_PER_LIST: usize = 64;
/// The seed of samples and of first centroids.
const SEED: u64 = 0x5e60_e5e6;
/// The stream of the generator.
const STREAM: u64 = 0;

/// The centroids of lists.
#[derive(Clone, Debug)]
pub(super) struct Centroids {
    dims: usize,
    /// The centroids of groups.
    groups: Vec<f32>,
    /// The centroids of lists, those of a group together.
    pub(super) lists: Vec<f32>,
    /// The first list of each group, and one past the last of all.
    starts: Vec<usize>,
}

impl Centroids {
    /// Finds the centroids of about `count` lists of rows: k-means of a seeded sample.
    pub(super) fn find(rows: &[f32], dims: usize, count: usize) -> Self {
        let mut random = Pcg32::new(SEED, STREAM);
        let sample = sampled(rows, dims, SAMPLED_PER_LIST.saturating_mul(count), &mut random);
        let number = sample.len() / dims;
        let groups = k_means(&sample, dims, isqrt(count), &mut random);
        let mut members: Vec<Vec<f32>> = vec![Vec::new(); groups.len() / dims];
        for row in sample.chunks_exact(dims) {
            if let Some(group) = nearest(row, &groups, dims) {
                members[group].extend(row);
            }
        }
        let (mut lists, mut starts) = (Vec::new(), vec![0]);
        for (group, own) in members.iter().enumerate() {
            // Each list then has about as many moments as the others.
            let share = (own.len() / dims * count).div_ceil(number.max(1));
            let made = k_means(own, dims, share, &mut random);
            if made.is_empty() {
                lists.extend(&groups[group * dims..(group + 1) * dims]);
            }
            lists.extend(made);
            starts.push(lists.len() / dims);
        }
        Self { dims, groups, lists, starts }
    }

    /// Returns the list of a row; `None` if there is no list.
    pub(super) fn list_of(&self, row: &[f32]) -> Option<usize> {
        let mut groups: [(f32, usize); GROUPS_TRIED] = [(f32::INFINITY, usize::MAX); GROUPS_TRIED];
        for (group, centre) in self.groups.chunks_exact(self.dims).enumerate() {
            let mut own = (squared(row, centre), group);
            for place in &mut groups {
                if own.0 < place.0 {
                    std::mem::swap(&mut own, place);
                }
            }
        }
        let mut best: Option<(f32, usize)> = None;
        for (_, group) in groups {
            let (Some(&start), Some(&end)) =
                (self.starts.get(group), self.starts.get(group.saturating_add(1)))
            else {
                continue;
            };
            let own = &self.lists[start * self.dims..end * self.dims];
            for (list, centre) in own.chunks_exact(self.dims).enumerate() {
                let found = (squared(row, centre), start + list);
                // Of equally near lists the first, in whatever order the groups are tried.
                if best.is_none_or(|best| found.0 < best.0 || found.0 == best.0 && found.1 < best.1)
                {
                    best = Some(found);
                }
            }
        }
        best.map(|(_, list)| list)
    }
}

/// Returns up to `count` different rows, in their order.
fn sampled(rows: &[f32], dims: usize, count: usize, random: &mut Pcg32) -> Vec<f32> {
    let mut left = rows.len() / dims;
    let mut wanted = count.min(left);
    let mut sample = Vec::with_capacity(wanted * dims);
    for row in rows.chunks_exact(dims) {
        // Knuth, "The Art of Computer Programming" 2, algorithm S: each set is as likely.
        if below(random, left) < wanted {
            sample.extend(row);
            wanted -= 1;
        }
        left -= 1;
    }
    sample
}

/// Returns up to `count` centroids of rows (Lloyd 1982), beginning with some of the rows.
fn k_means(rows: &[f32], dims: usize, count: usize, random: &mut Pcg32) -> Vec<f32> {
    let mut centres = sampled(rows, dims, count, random);
    let number = centres.len() / dims;
    if number == 0 || number == rows.len() / dims {
        return centres;
    }
    for _ in 0..ROUNDS {
        let (mut sums, mut counts) = (vec![0.0f64; centres.len()], vec![0usize; number]);
        for row in rows.chunks_exact(dims) {
            let Some(own) = nearest(row, &centres, dims) else { continue };
            counts[own] += 1;
            for (sum, value) in sums[own * dims..].iter_mut().zip(row) {
                *sum += f64::from(*value);
            }
        }
        for ((centre, sum), count) in
            centres.chunks_exact_mut(dims).zip(sums.chunks_exact(dims)).zip(counts)
        {
            // A centroid without members stays where it is.
            for (value, sum) in centre.iter_mut().zip(sum).filter(|_| count > 0) {
                *value = (sum / count as f64) as f32;
            }
        }
    }
    centres
}

/// Returns the first of the nearest centres.
fn nearest(row: &[f32], centres: &[f32], dims: usize) -> Option<usize> {
    let mut best = None;
    let mut least = f32::INFINITY;
    for (own, centre) in centres.chunks_exact(dims).enumerate() {
        let distance = squared(row, centre);
        if distance < least {
            (best, least) = (Some(own), distance);
        }
    }
    best
}

/// Returns the square root, rounded up.
fn isqrt(number: usize) -> usize {
    let root = number.isqrt();
    if root * root < number { root + 1 } else { root }
}

/// Returns a random number from 0 to below `end`; 0 where there is none.
fn below(random: &mut Pcg32, end: usize) -> usize {
    ((u128::from(random.next_u64()) * end as u128) >> 64) as usize
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sample_has_different_rows_and_every_row_can_be_in_it() {
        let rows: Vec<f32> = (0..50u8).map(f32::from).collect();
        let mut seen = [0; 50];
        let mut random = Pcg32::new(1, STREAM);
        for _ in 0..200 {
            let sample = sampled(&rows, 1, 10, &mut random);
            assert_eq!(sample.len(), 10);
            assert!(sample.windows(2).all(|pair| pair[0] < pair[1]));
            for row in sample {
                seen[row as usize] += 1;
            }
        }
        assert!(seen.iter().all(|count| (15..70).contains(count)), "{seen:?}");
        assert_eq!(sampled(&rows, 1, 99, &mut random), rows);
    }

    #[test]
    fn centres_of_separate_clouds_are_their_means() {
        let mut random = Pcg32::new(7, STREAM);
        let noise = |random: &mut Pcg32| below(random, 1000) as f32 / 1000.0 - 0.5;
        let clouds = [[0.0, 0.0], [90.0, 0.0], [0.0, 90.0]];
        let rows: Vec<f32> = (0..600)
            .flat_map(|at| clouds[at % 3].map(|centre: f32| centre + noise(&mut random)))
            .collect();
        // Lloyd's algorithm may end with two centres in one cloud, so that some are to spare.
        let centres = k_means(&rows, 2, 9, &mut random);
        for cloud in clouds {
            let own = centres.chunks_exact(2).filter(|centre| squared(centre, &cloud) < 1.0);
            assert!(own.count() >= 1, "{centres:?}");
        }
        assert!(
            centres
                .chunks_exact(2)
                .all(|centre| { clouds.iter().any(|cloud| squared(centre, cloud) < 1.0) })
        );
    }

    #[test]
    fn list_of_a_row_is_nearly_always_the_nearest() {
        let mut random = Pcg32::new(3, STREAM);
        let rows: Vec<f32> = (0..12_000).map(|_| below(&mut random, 1000) as f32).collect();
        let centroids = Centroids::find(&rows, 3, 100);
        let lists = centroids.lists.len() / 3;
        assert!((80..140).contains(&lists), "{lists}");
        let is_nearest = |row: &&[f32]| centroids.list_of(row) == nearest(row, &centroids.lists, 3);
        let exact = rows.chunks_exact(3).filter(is_nearest).count();
        assert!(exact > 3_900, "{exact} of 4000");
    }

    #[test]
    fn root_is_rounded_up() {
        assert_eq!([0, 1, 2, 4, 5, 9, 10].map(isqrt), [0, 1, 2, 2, 3, 3, 4]);
    }
}
