//! C3D: any bytes are read or refused in bounded memory, and what was read is a valid motion.

#![no_main]

use libfuzzer_sys::fuzz_target;
use segue_formats::ImportOptions;
use segue_formats::c3d::read;
use segue_fuzz::{assert_valid, most_bytes};

fuzz_target!(|bytes: &[u8]| {
    let options = ImportOptions::default();
    if let Ok(found) = read("fuzz.c3d", bytes, &options) {
        assert_valid(&found.clips, most_bytes(bytes));
    }
});
