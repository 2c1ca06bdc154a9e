//! Faults that are left alone: `spike-34,gap-120`.

use super::{Misread, between_commas, entries, joined};
use segue_motion::clean::FaultKind;

/// The greatest number of faults; a link with more is an accident.
const MAX_FAULTS: usize = 256;

/// Returns the word of a kind of fault in links.
const fn word(kind: FaultKind) -> &'static str {
    match kind {
        FaultKind::Swap => "swap",
        FaultKind::Gap => "gap",
        FaultKind::Spike => "spike",
        FaultKind::Jitter => "jitter",
        FaultKind::Drift => "drift",
        FaultKind::Ground => "ground",
        FaultKind::Ends => "ends",
        FaultKind::Skating => "skating",
        FaultKind::Rate => "rate",
    }
}

pub(super) fn read(text: &str) -> Result<Vec<(FaultKind, usize)>, Misread> {
    let expected = "a kind of fault and a frame, as in spike-34";
    entries(between_commas(text), MAX_FAULTS, expected, |entry| {
        let (name, frame) = entry.split_once('-')?;
        let kind = FaultKind::ALL.into_iter().find(|&kind| word(kind) == name.trim())?;
        Some((kind, frame.trim().parse().ok()?))
    })
}

pub(super) fn write(faults: &[(FaultKind, usize)]) -> String {
    joined(faults, |(kind, frame)| format!("{}-{frame}", word(*kind)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fault_places_are_read_as_they_are_written() {
        let all: Vec<(FaultKind, usize)> =
            FaultKind::ALL.into_iter().enumerate().map(|(at, kind)| (kind, at * 100)).collect();
        assert_eq!(read(&write(&all)), Ok(all));
        assert_eq!(read(" "), Ok(vec![]));
    }

    #[test]
    fn invalid_fault_place_is_named() {
        for bad in ["spike", "spike-", "hole-3", "spike--4", "gap-1-2"] {
            let error = read(&format!("gap-1,{bad}")).unwrap_err().to_string();
            assert!(error.starts_with(&format!("entry 2: found `{bad}`")), "{error}");
        }
        assert!(read(&"gap-1,".repeat(257)).unwrap_err().to_string().contains("256 at most"));
    }
}
