//! The uses of the motions of files.

use std::collections::BTreeMap;

/// The uses of the motions of files, and the memory for those that are not used.
#[derive(Debug)]
pub(super) struct MotionUses {
    /// The number of the present round of use.
    pub(super) round: u64,
    /// The round in which a clip was used last, by its id; a clip that was never used has none.
    pub(super) last: BTreeMap<String, u64>,
    /// The most memory of motions that are not used, bytes.
    pub(super) max_idle_bytes: u64,
}

impl Default for MotionUses {
    fn default() -> Self {
        Self { round: 1, last: BTreeMap::new(), max_idle_bytes: u64::MAX }
    }
}
