//! Zip archives: any bytes are unpacked or refused, with no more output than the limit.

#![no_main]

use libfuzzer_sys::fuzz_target;
use segue_formats::archive::{ArchiveLimits, unpack};

fuzz_target!(|bytes: &[u8]| {
    let limits = ArchiveLimits { max_bytes: 1 << 20, ..ArchiveLimits::default() };
    if let Ok(unpacked) = unpack("fuzz.zip", bytes, &limits) {
        let total: usize = unpacked.files.iter().map(|file| file.bytes.len()).sum();
        assert!(!unpacked.files.is_empty() && total <= limits.max_bytes);
        assert!(unpacked.files.is_sorted_by_key(|file| &file.path));
    }
});
