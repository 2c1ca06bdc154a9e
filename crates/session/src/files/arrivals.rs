//! The files on their way into the library.

/// The files that were to join the library since none was being read.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Arrivals {
    pub(super) files: usize,
    /// The number of their bytes.
    pub(super) bytes: u64,
}

impl Arrivals {
    /// Adds a file of so many bytes, which may be the first since none was being read.
    pub(super) fn add(&mut self, size: u64, is_first: bool) {
        if is_first {
            *self = Self::default();
        }
        self.files += 1;
        self.bytes = self.bytes.saturating_add(size);
    }

    /// Takes back a file of so many bytes that is read once more.
    pub(super) fn take_back(&mut self, size: u64) {
        self.files = self.files.saturating_sub(1);
        self.bytes = self.bytes.saturating_sub(size);
    }
}
