//! Origins of clips: what links need to name them.

use segue_session::file_id;
use segue_session::reading::{ReadFile, sha256_hex};
use std::sync::{Arc, Mutex, OnceLock, PoisonError};

/// The origin of a clip: what a session needs to have it.
#[derive(Clone, Debug, Default)]
pub(crate) struct Origin {
    /// Its id in links; `None` if no link can say it.
    pub(crate) id: Option<String>,
    /// The files that the id names.
    pub(crate) files: Vec<Arc<ReadFile>>,
}

/// The origin of a clip, known or computed on demand.
#[derive(Debug)]
pub(crate) enum Source {
    /// It is known.
    Known(Origin),
    /// A clip of a file, by its index there.
    File(Arc<SourceFile>, usize),
}

impl Source {
    /// Returns the origin. For the first clip of a large file it may wait for the file's SHA-256.
    pub(crate) fn origin(&self) -> Origin {
        match self {
            Self::Known(origin) => origin.clone(),
            Self::File(source, index) => {
                let file = source.file();
                let id = Some(file_id(&file.name, &file.sha256, *index));
                Origin { id, files: vec![Arc::clone(file)] }
            }
        }
    }
}

/// A file that was read. Its SHA-256, which only links need, may be computed later.
#[derive(Debug)]
pub(crate) struct SourceFile {
    /// The file, perhaps without its SHA-256.
    read: Arc<ReadFile>,
    /// Its bytes, until the SHA-256 is known.
    bytes: Mutex<Option<Vec<u8>>>,
    hashed: OnceLock<Arc<ReadFile>>,
}

impl SourceFile {
    /// Returns a file whose SHA-256 is known.
    pub(crate) fn hashed(read: ReadFile) -> Self {
        let read = Arc::new(read);
        Self { hashed: Arc::clone(&read).into(), read, bytes: Mutex::new(None) }
    }

    /// Returns a file whose SHA-256 is that of some bytes. It is computed on a core that has
    /// nothing else to do, or by the first caller that asks for it, and the bytes are dropped.
    pub(crate) fn of_bytes(read: ReadFile, bytes: Vec<u8>) -> Arc<Self> {
        let (read, bytes) = (Arc::new(read), Mutex::new(Some(bytes)));
        let own = Arc::new(Self { read, bytes, hashed: OnceLock::new() });
        let later = Arc::clone(&own);
        rayon::spawn(move || {
            later.file();
        });
        own
    }

    /// Returns the file as it was read, perhaps without its SHA-256.
    pub(crate) fn read(&self) -> &ReadFile {
        &self.read
    }

    /// Returns the file with its SHA-256.
    fn file(&self) -> &Arc<ReadFile> {
        self.hashed.get_or_init(|| {
            let bytes = self.bytes.lock().unwrap_or_else(PoisonError::into_inner).take();
            let sha256 = sha256_hex(&bytes.unwrap_or_default());
            Arc::new(ReadFile { sha256, ..ReadFile::clone(&self.read) })
        })
    }
}
