//! The clips that come with Segue, as entries of the library.

use crate::library::{Entry, Origin};
use crate::samples::{self, Sample};
use segue_motion::synth;

/// Returns the entries of the presets, which the library holds at first.
pub(crate) fn preset_entries() -> impl Iterator<Item = Entry> {
    synth::presets().into_iter().map(|preset| Entry::new(preset.id, preset.title, Origin::Preset))
}

/// Returns the entries of all that comes with Segue: the presets, and the bundled takes, which join
/// the library when they are asked for.
pub(crate) fn built_in_entries() -> impl Iterator<Item = Entry> {
    preset_entries().chain(samples::all().map(sample_entry))
}

/// Returns the entry of a bundled take without its motion.
pub(crate) fn sample_entry(sample: &'static Sample) -> Entry {
    Entry::new(sample.id, sample.label, Origin::Sample(sample))
}
