//! TRC: any text is read or refused in bounded memory, and what was read is a valid motion.

#![no_main]

use libfuzzer_sys::fuzz_target;
use segue_formats::ImportOptions;
use segue_formats::trc::read;
use segue_fuzz::{assert_valid, most_bytes};

fuzz_target!(|bytes: &[u8]| {
    let options = ImportOptions::default();
    if let Ok(found) = read("fuzz.trc", bytes, &options) {
        assert_valid(&found.clips, most_bytes(bytes));
    }
});
