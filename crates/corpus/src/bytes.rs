//! Numbers in bytes, little-endian.

use crate::CorpusError;

/// A checked reader of bytes from outside.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Reader<'a> {
    bytes: &'a [u8],
    what: &'static str,
}

impl<'a> Reader<'a> {
    /// Returns a reader; `what` names the bytes in errors.
    pub(crate) const fn new(bytes: &'a [u8], what: &'static str) -> Self {
        Self { bytes, what }
    }

    /// Returns the name of the bytes in errors.
    pub(crate) const fn what(&self) -> &'static str {
        self.what
    }

    /// Returns the next bytes.
    pub(crate) fn take(&mut self, count: usize) -> Result<&'a [u8], CorpusError> {
        let (taken, rest) =
            self.bytes.split_at_checked(count).ok_or(CorpusError::Truncated { what: self.what })?;
        self.bytes = rest;
        Ok(taken)
    }

    /// Returns the bytes of `count` items of `size` bytes each.
    pub(crate) fn take_items(
        &mut self,
        count: usize,
        size: usize,
    ) -> Result<&'a [u8], CorpusError> {
        self.take(count.checked_mul(size).ok_or(CorpusError::Truncated { what: self.what })?)
    }

    fn array<const N: usize>(&mut self) -> Result<[u8; N], CorpusError> {
        let taken = self.take(N)?;
        taken.try_into().map_err(|_| CorpusError::Truncated { what: self.what })
    }

    pub(crate) fn u32(&mut self) -> Result<u32, CorpusError> {
        Ok(u32::from_le_bytes(self.array()?))
    }

    /// Returns a number of [`push_varint`].
    pub(crate) fn varint(&mut self) -> Result<u32, CorpusError> {
        let mut value = 0;
        for shift in (0..u32::BITS).step_by(7) {
            let [byte] = self.array()?;
            let bits = u32::from(byte & 0x7f);
            if bits.leading_zeros() < shift {
                break;
            }
            value |= bits << shift;
            if byte & 0x80 == 0 {
                return Ok(value);
            }
        }
        Err(CorpusError::Damaged { what: self.what })
    }

    pub(crate) fn f32(&mut self) -> Result<f32, CorpusError> {
        Ok(f32::from_le_bytes(self.array()?))
    }

    pub(crate) fn f32s(&mut self, count: usize) -> Result<Vec<f32>, CorpusError> {
        Ok(f32s(self.take_items(count, 4)?).collect())
    }

    /// Checks that the next bytes are the mark of a kind of file.
    pub(crate) fn mark(&mut self, mark: [u8; 4]) -> Result<(), CorpusError> {
        if self.array::<4>()? == mark {
            Ok(())
        } else {
            Err(CorpusError::OtherKind { what: self.what })
        }
    }

    /// Checks that nothing follows.
    pub(crate) fn end(&self) -> Result<(), CorpusError> {
        if self.bytes.is_empty() { Ok(()) } else { Err(CorpusError::Surplus { what: self.what }) }
    }
}

/// Returns the numbers of bytes; an incomplete last one is left out.
pub(crate) fn f32s(bytes: &[u8]) -> impl Iterator<Item = f32> + '_ {
    words(bytes).map(f32::from_le_bytes)
}

/// Returns the numbers of bytes; an incomplete last one is left out.
pub(crate) fn i32s(bytes: &[u8]) -> impl Iterator<Item = i32> + '_ {
    words(bytes).map(i32::from_le_bytes)
}

fn words(bytes: &[u8]) -> impl Iterator<Item = [u8; 4]> + '_ {
    bytes.chunks_exact(4).map(|word| {
        let mut array = [0; 4];
        array.copy_from_slice(word);
        array
    })
}

/// Appends a number as a `u32`.
pub(crate) fn push_u32(out: &mut Vec<u8>, value: usize) -> Result<(), CorpusError> {
    let value = u32::try_from(value).map_err(|_| CorpusError::TooLarge)?;
    out.extend(value.to_le_bytes());
    Ok(())
}

/// Appends numbers.
pub(crate) fn push_f32s(out: &mut Vec<u8>, values: impl IntoIterator<Item = f32>) {
    out.extend(values.into_iter().flat_map(f32::to_le_bytes));
}

/// Appends a number in as many bytes as it needs: seven bits each, the lowest first, and a bit that
/// says whether another byte follows.
pub(crate) fn push_varint(out: &mut Vec<u8>, mut value: u32) {
    while value >= 0x80 {
        out.push((value & 0x7f) as u8 | 0x80);
        value >>= 7;
    }
    out.push(value as u8);
}
