//! The takes that come with Segue, which a link may name.

use segue_session::Sample;

macro_rules! files {
    ($($name:literal)*) => {
        const FILES: &[(&str, &[u8])] =
            &[$(($name, include_bytes!(concat!("../../../assets/samples/", $name)))),*];
    };
}

files! {
    "01_01.bvh.gz" "01_03.bvh.gz" "run.bvh.gz" "pirouette.bvh.gz" "16_11.bvh.gz" "16_13.bvh.gz"
    "16_15.bvh.gz" "16_17.bvh.gz" "16_19.bvh.gz" "16_22.bvh.gz" "16_33.bvh.gz" "16_55.bvh.gz"
    "16_57.bvh.gz"
}

/// Returns the packed file of a take.
pub(crate) fn packed(sample: &Sample) -> Option<&'static [u8]> {
    FILES.iter().find(|(name, _)| *name == sample.file).map(|(_, bytes)| *bytes)
}

#[cfg(test)]
mod tests {
    use segue_session::Session;

    #[test]
    fn every_take_is_here() {
        let sets = Session::sample_sets().iter().flat_map(|set| set.samples);
        let mut all = Session::samples().iter().chain(sets);
        assert!(all.all(|sample| super::packed(sample).is_some()));
    }
}
