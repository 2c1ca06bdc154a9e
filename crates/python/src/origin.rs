//! Origins of clips: what links need to name them.

use rayon::Yield;
use segue_session::file_id;
use segue_session::reading::{PiecewiseSha256, ReadFile, sha256_hex};
use std::sync::{Arc, Mutex, OnceLock, PoisonError, Weak};

/// The number of bytes whose SHA-256 is computed before looking whether there is other work.
const PIECE_BYTES: usize = 1 << 16;

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

/// Goes on with the SHA-256 of a file on a core that has nothing else to do, as long as somebody
/// has the file.
fn hash_later(file: Weak<SourceFile>, mut sha256: PiecewiseSha256, done: usize) {
    rayon::spawn(move || {
        let Some(own) = file.upgrade() else { return };
        let Some(bytes) = own.bytes() else { return };
        let left = bytes.get(done..).unwrap_or_default();
        let piece = left.get(..PIECE_BYTES).unwrap_or(left);
        sha256.update(piece);
        if piece.len() == left.len() {
            own.set_sha256(sha256.hex());
            return;
        }
        let done = done + piece.len();
        drop((own, bytes));
        while rayon::yield_now() == Some(Yield::Executed) {}
        hash_later(file, sha256, done);
    });
}

/// A file that was read. Its SHA-256, which only links need, may be computed later.
// Nothing is locked while it is computed: a process that is forked meanwhile has none of the
// threads that would go on, and would wait for them for ever.
#[derive(Debug)]
pub(crate) struct SourceFile {
    /// The file, perhaps without its SHA-256.
    read: Arc<ReadFile>,
    /// Its bytes, until the SHA-256 is known.
    bytes: Mutex<Option<Arc<Vec<u8>>>>,
    hashed: OnceLock<Arc<ReadFile>>,
}

impl SourceFile {
    /// Returns a file whose SHA-256 is known.
    pub(crate) fn hashed(read: ReadFile) -> Self {
        let read = Arc::new(read);
        Self { hashed: Arc::clone(&read).into(), read, bytes: Mutex::new(None) }
    }

    /// Returns a file whose SHA-256 is that of some bytes. It is computed while nothing else is, or
    /// by the first caller that asks for it before that is done.
    pub(crate) fn of_bytes(read: ReadFile, bytes: Vec<u8>) -> Arc<Self> {
        let own = Arc::new(Self {
            read: Arc::new(read),
            bytes: Mutex::new(Some(Arc::new(bytes))),
            hashed: OnceLock::new(),
        });
        hash_later(Arc::downgrade(&own), PiecewiseSha256::default(), 0);
        own
    }

    /// Returns the file as it was read, perhaps without its SHA-256.
    pub(crate) fn read(&self) -> &ReadFile {
        &self.read
    }

    /// Returns the file with its SHA-256.
    fn file(&self) -> &Arc<ReadFile> {
        if self.hashed.get().is_none()
            && let Some(bytes) = self.bytes()
        {
            self.set_sha256(sha256_hex(&bytes));
        }
        // Without bytes, it is set.
        self.hashed.get_or_init(|| Arc::clone(&self.read))
    }

    /// Returns the bytes, unless the SHA-256 is known.
    fn bytes(&self) -> Option<Arc<Vec<u8>>> {
        self.bytes.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }

    /// Sets the SHA-256, unless it is known, and drops the bytes.
    fn set_sha256(&self, sha256: String) {
        let file = Arc::new(ReadFile { sha256, ..ReadFile::clone(&self.read) });
        self.hashed.get_or_init(|| file);
        self.bytes.lock().unwrap_or_else(PoisonError::into_inner).take();
    }
}
