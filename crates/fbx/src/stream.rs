//! Reading of a scene from a stream of bytes.
//!
//! ufbx takes a `Box<dyn Read>` that may live for ever, and the stream borrows the file. ufbx
//! therefore gets a [`LentReader`], which has no lifetime: it shares a slot with a [`Loan`], and
//! the slot has a pointer to the stream only while the loan borrows it. Afterwards the reader is at
//! its end, so that nothing depends on when ufbx drops it.

#![expect(unsafe_code, reason = "the lifetime of a stream is checked when it is read")]

use crate::OpenError;
use std::cell::Cell;
use std::io::{self, Read};
use std::marker::PhantomData;
use std::ptr::NonNull;
use std::rc::Rc;
use ufbx::{LoadOpts, SceneRoot, Stream};

/// Reads a scene from a stream.
pub(crate) fn load(mut stream: impl Read, options: LoadOpts<'_>) -> Result<SceneRoot, OpenError> {
    let loan = Loan::of(&mut stream);
    Ok(ufbx::load_stream(Stream::Read(Box::new(loan.reader())), options)?)
}

/// A pointer to a stream, and the function that reads it.
#[derive(Clone, Copy)]
struct Pointer {
    stream: NonNull<()>,
    /// `read_stream` for the type of the stream.
    read: unsafe fn(NonNull<()>, &mut [u8]) -> io::Result<usize>,
}

/// Reads from a stream.
///
/// # Safety
/// The pointer is that of an `R` which is alive, and which nothing else uses during the call.
unsafe fn read_stream<R: Read>(stream: NonNull<()>, to: &mut [u8]) -> io::Result<usize> {
    // SAFETY: the caller vouches for it.
    unsafe { stream.cast::<R>().as_mut() }.read(to)
}

/// The exclusive borrow of a stream for readers without a lifetime.
struct Loan<'a> {
    slot: Rc<Cell<Option<Pointer>>>,
    stream: PhantomData<&'a mut ()>,
}

impl<'a> Loan<'a> {
    fn of<R: Read>(stream: &'a mut R) -> Self {
        let pointer = Pointer { stream: NonNull::from(stream).cast(), read: read_stream::<R> };
        Self { slot: Rc::new(Cell::new(Some(pointer))), stream: PhantomData }
    }

    fn reader(&self) -> LentReader {
        LentReader(Rc::clone(&self.slot))
    }
}

impl Drop for Loan<'_> {
    fn drop(&mut self) {
        self.slot.set(None);
    }
}

/// A reader of a stream for as long as its loan lasts, and at its end from then on. It cannot be
/// sent to another thread, because its `Rc` cannot.
struct LentReader(Rc<Cell<Option<Pointer>>>);

impl Read for LentReader {
    fn read(&mut self, to: &mut [u8]) -> io::Result<usize> {
        // While a stream is read, its slot is empty: it could not be read within its own call.
        let Some(pointer) = self.0.take() else { return Ok(0) };
        // SAFETY: the loan empties the slot when it is dropped, and is only made by `load` and by
        // the tests, which do not leak it. Until then the stream is alive and borrowed by the loan
        // alone.
        let count = unsafe { (pointer.read)(pointer.stream, to) };
        self.0.set(Some(pointer));
        count
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn reader_ends_with_its_loan() {
        let bytes = vec![1, 2, 3, 4];
        let mut stream = bytes.as_slice();
        let loan = Loan::of(&mut stream);
        let mut reader = loan.reader();
        let mut to = [0; 2];
        assert_eq!((reader.read(&mut to).unwrap(), to), (2, [1, 2]));
        drop(loan);
        assert_eq!((stream, reader.read(&mut to).unwrap()), (&[3, 4][..], 0));
        drop(bytes);
        assert_eq!(reader.read(&mut to).unwrap(), 0);
    }

    #[test]
    fn reader_without_its_stream_ends() {
        let reader = |bytes: &[u8]| {
            let mut stream = bytes;
            Loan::of(&mut stream).reader()
        };
        assert_eq!(reader(&[1, 2]).read(&mut [0; 2]).unwrap(), 0);
    }
}
