//! Gzip files, and reading with a limit.

use super::ImportError;
use flate2::read::GzDecoder;
use segue_text::msg;
use std::io::{self, Read};

/// Returns whether the bytes start as those of a gzip file.
pub(super) fn is_gzip(bytes: &[u8]) -> bool {
    bytes.starts_with(&[0x1f, 0x8b])
}

/// Unpacks a gzip file. Bytes that are not a gzip file are returned unchanged: a server may have
/// unpacked them already.
///
/// # Errors
/// [`ImportError`] when it is damaged or unpacks to more than `most` bytes.
pub fn unpack_gzip(name: &str, packed: &[u8], most: usize) -> Result<Vec<u8>, ImportError> {
    if !is_gzip(packed) {
        return Ok(packed.to_vec());
    }
    match read_at_most(GzDecoder::new(packed), most) {
        Ok(Some(bytes)) => Ok(bytes),
        Ok(None) => {
            let found = msg!("more than {mb} MB after unpacking", mb = most >> 20);
            Err(ImportError::whole_file(name, found, "a smaller file"))
        }
        Err(error) if error.kind() == io::ErrorKind::OutOfMemory => Err(no_memory(name)),
        Err(error) => Err(ImportError::whole_file(name, error.to_string(), "a gzip file")),
    }
}

/// Returns the error that there is no memory for the content of the packed file `name`.
pub(super) fn no_memory(name: &str) -> ImportError {
    let found = "more than there is memory for after unpacking";
    ImportError::whole_file(name, found, "a smaller file")
        .with_hint("unpack the archive and open a part of its files")
}

/// Reads to the end, or returns `None` when there is more than `most`. The buffer grows with the
/// data, whatever a header says; where there is no memory for it, the error is of the kind
/// [`io::ErrorKind::OutOfMemory`].
pub(super) fn read_at_most(reader: impl Read, most: usize) -> io::Result<Option<Vec<u8>>> {
    let mut bytes = Vec::new();
    reader.take((most as u64).saturating_add(1)).read_to_end(&mut bytes)?;
    Ok((bytes.len() <= most).then_some(bytes))
}

#[cfg(test)]
mod tests {
    use super::*;
    use flate2::{Compression, write::GzEncoder};
    use std::io::Write as _;

    #[test]
    fn unpack_gzip_of_damaged_data_is_refused() {
        let mut encoder = GzEncoder::new(Vec::new(), Compression::fast());
        encoder.write_all(b"HIERARCHY").unwrap();
        let packed = encoder.finish().unwrap();
        assert_eq!(unpack_gzip("a.gz", &packed, 9).unwrap(), b"HIERARCHY");
        assert_eq!(unpack_gzip("a.gz", b"HIERARCHY", 9).unwrap(), b"HIERARCHY");
        assert!(unpack_gzip("a.gz", &packed, 8).is_err());
        let cut = unpack_gzip("a.gz", &packed[..packed.len() - 4], 9).unwrap_err();
        assert!(cut.to_string().starts_with("a.gz:1:1: found "), "{cut}");
    }
}
