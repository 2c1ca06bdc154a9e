//! FBX: any bytes are read or refused in bounded memory; a file that was read is a valid motion
//! with a consistent mesh.

#![no_main]

use libfuzzer_sys::fuzz_target;
use segue_formats::ImportOptions;
use segue_formats::fbx::read;
use segue_fuzz::assert_valid;

fuzz_target!(|bytes: &[u8]| {
    let options = ImportOptions { max_bytes: 16 << 20, ..ImportOptions::default() };
    if let Ok(found) = read("fuzz.fbx", bytes, &options) {
        assert_valid(&found.clips, options.max_bytes);
    }
});
