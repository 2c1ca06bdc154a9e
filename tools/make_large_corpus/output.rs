//! Shards that are written while their clips are made.

use segue_corpus::SHARD_BYTES;
use std::fs::File;
use std::io::{self, BufWriter, Write as _};
use std::path::{Path, PathBuf};

/// Shards of one kind. Clips come in the order of their keys, so that they lie as a corpus places
/// them.
#[derive(Debug)]
pub(crate) struct Output {
    folder: PathBuf,
    kind: &'static str,
    file: Option<BufWriter<File>>,
    bytes: usize,
    shards: usize,
}

impl Output {
    pub(crate) fn new(folder: &Path, kind: &'static str) -> Self {
        Self { folder: folder.to_owned(), kind, file: None, bytes: 0, shards: 0 }
    }

    /// Writes the bytes of a clip.
    pub(crate) fn add(&mut self, bytes: &[u8]) -> io::Result<()> {
        if bytes.is_empty() {
            return Ok(());
        }
        if self.bytes > 0 && self.bytes + bytes.len() > SHARD_BYTES {
            self.finish()?;
        }
        let file = match &mut self.file {
            Some(file) => file,
            none => {
                let name = format!("{}-{:05}.bin", self.kind, self.shards);
                self.shards += 1;
                none.insert(BufWriter::new(File::create(self.folder.join(name))?))
            }
        };
        self.bytes += bytes.len();
        file.write_all(bytes)
    }

    /// Ends the last shard.
    pub(crate) fn finish(&mut self) -> io::Result<()> {
        self.bytes = 0;
        self.file.take().map_or(Ok(()), |mut file| file.flush())
    }

    /// Returns the number of shards.
    pub(crate) fn shards(&self) -> usize {
        self.shards
    }
}
