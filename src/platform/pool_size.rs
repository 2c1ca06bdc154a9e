//! The number of workers that compute, and what they have done.

use serde::Serialize;

/// The greatest number of workers.
const MAX_WORKERS: usize = 8;

/// The counts of a pool.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub(crate) struct PoolStats {
    /// The number of workers that are running.
    pub(crate) running: usize,
    /// The number of jobs that they have answered.
    pub(crate) jobs: u64,
    /// The number of workers that ended before their answer, and were replaced.
    pub(crate) replaced: u64,
}

/// The number of workers that an address asks for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum PoolSize {
    /// None: the page computes everything.
    Off,
    /// That many.
    Workers(usize),
    /// As many as the processor has room for.
    OfCores,
}

impl PoolSize {
    /// Returns the number of workers beside the app on a processor with that many cores.
    pub(super) fn for_cores(cores: usize) -> usize {
        cores.saturating_sub(1).clamp(1, MAX_WORKERS)
    }
}

/// Returns the number of workers for the value of `pool=` in an address: `off`, or a number. It is
/// for tests and measurements.
#[cfg_attr(
    not(any(test, target_arch = "wasm32")),
    expect(dead_code, reason = "a window has no address to set it in")
)]
pub(super) fn pool_size(asked: Option<&str>) -> PoolSize {
    match asked {
        Some("off" | "0") => PoolSize::Off,
        Some(number) => number.parse().map_or(PoolSize::OfCores, |workers: usize| {
            PoolSize::Workers(workers.min(MAX_WORKERS))
        }),
        None => PoolSize::OfCores,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pool_size_leaves_a_core_to_the_app() {
        assert_eq!([0, 1, 2, 4, 64].map(PoolSize::for_cores), [1, 1, 1, 3, 8]);
        assert_eq!(pool_size(None), PoolSize::OfCores);
        assert_eq!(pool_size(Some("off")), PoolSize::Off);
        assert_eq!(pool_size(Some("2")), PoolSize::Workers(2));
        assert_eq!(pool_size(Some("100")), PoolSize::Workers(8));
        assert_eq!(pool_size(Some("many")), PoolSize::OfCores);
    }
}
