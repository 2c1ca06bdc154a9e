//! The bundled takes. Each is a file of its own, fetched on request.

/// A bundled take.
#[derive(Debug, PartialEq, Eq)]
pub struct Sample {
    /// Its id in the library and in links.
    pub id: &'static str,
    /// Its name on screen.
    pub label: &'static str,
    /// Its file, packed with gzip, in the folder of samples.
    pub file: &'static str,
}

/// A set of bundled takes that are loaded together.
#[derive(Debug, PartialEq, Eq)]
pub struct SampleSet {
    /// Its name on screen.
    pub label: &'static str,
    /// The takes, in the order of the library. The first two are offered as A and B.
    pub samples: &'static [Sample],
}

const fn sample(id: &'static str, label: &'static str, file: &'static str) -> Sample {
    Sample { id, label, file }
}

/// Single takes of different actors.
pub(super) static SINGLES: [Sample; 4] = [
    sample("cmu_jump", "CMU 01_01 · forward jumps", "01_01.bvh.gz"),
    sample("cmu_climb", "CMU 01_03 · climb", "01_03.bvh.gz"),
    sample("cmu_run", "CMU · run", "run.bvh.gz"),
    sample("cmu_pirouette", "CMU · pirouette", "pirouette.bvh.gz"),
];

/// Walks and runs of one actor.
pub(super) static SUBJECT_16: [Sample; 9] = [
    sample("cmu16_walk", "CMU 16 · walk", "16_15.bvh.gz"),
    sample("cmu16_run", "CMU 16 · run", "16_55.bvh.gz"),
    sample("cmu16_fast_walk", "CMU 16 · fast walk", "16_22.bvh.gz"),
    sample("cmu16_veer_left", "CMU 16 · veer left", "16_11.bvh.gz"),
    sample("cmu16_veer_right", "CMU 16 · veer right", "16_13.bvh.gz"),
    sample("cmu16_turn_left", "CMU 16 · turn left", "16_17.bvh.gz"),
    sample("cmu16_turn_right", "CMU 16 · turn right", "16_19.bvh.gz"),
    sample("cmu16_stop", "CMU 16 · slow walk, stop", "16_33.bvh.gz"),
    sample("cmu16_run_stop", "CMU 16 · run, stop", "16_57.bvh.gz"),
];

/// All sets.
pub(super) static SETS: [SampleSet; 1] =
    [SampleSet { label: "CMU 16 · nine walks and runs", samples: &SUBJECT_16 }];

/// The credit of the bundled takes.
pub const SAMPLES_CREDIT: &str = "The data used in this project was obtained from mocap.cs.cmu.edu. The database was created with funding from NSF EIA-0196217.";

/// Returns all takes, including those of sets.
pub(super) fn all() -> impl Iterator<Item = &'static Sample> {
    SINGLES.iter().chain(SETS.iter().flat_map(|set| set.samples))
}
