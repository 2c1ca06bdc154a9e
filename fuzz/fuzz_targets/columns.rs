//! The files of a corpus: any bytes are read or refused in bounded memory, and what was read can be
//! shown.

#![no_main]

use libfuzzer_sys::fuzz_target;
use segue_corpus::{Filter, Index, StandardBody, Table, decode_poses};

fuzz_target!(|bytes: &[u8]| {
    if let Ok(table) = Table::read(bytes) {
        assert!(table.columns().len() >= 9);
        for row in table.select(&Filter::default()).unwrap_or_default() {
            assert!(table.cells(row).is_some());
        }
    }
    if let Ok(index) = Index::read(bytes) {
        let query = vec![0.0; index.dims()];
        assert!(index.nearest_lists(&query, 3).is_ok());
    }
    if let Ok(body) = StandardBody::new() {
        decode_poses("fuzz", bytes, body.skeleton()).ok();
    }
});
