//! Compressed columns: raw deflate (RFC 1951) with the lengths before and after it.
//!
//! `miniz_oxide` is used directly: which encoder `flate2` uses depends on the program around it,
//! and so would the bytes of a corpus.

use crate::CorpusError;
use crate::bytes::{Reader, push_u32};
use miniz_oxide::deflate::compress_to_vec;
use miniz_oxide::inflate::decompress_to_vec_with_limit;

/// The greatest number of rows that are read.
pub(crate) const MAX_ROWS: usize = 1 << 22;
/// The greatest number of bytes of all texts of a list that are read.
const MAX_TEXT: usize = 1 << 28;
/// The effort of the compression, of 10.
const LEVEL: u8 = 9;
/// The bytes that a text can have in common with the one before.
const MAX_COMMON: usize = 255;

/// Appends compressed bytes: their number, the number before the compression, the bytes.
pub(crate) fn push_packed(out: &mut Vec<u8>, plain: &[u8]) -> Result<(), CorpusError> {
    let packed = compress_to_vec(plain, LEVEL);
    push_u32(out, packed.len())?;
    push_u32(out, plain.len())?;
    out.extend(packed);
    Ok(())
}

/// Appends numbers byte by byte: the number of bytes that any of them needs (`u8`), then all lowest
/// bytes, compressed, and so on. Bytes of one place are more alike than those of one number.
pub(crate) fn push_numbers(out: &mut Vec<u8>, numbers: &[u32]) -> Result<(), CorpusError> {
    let most = numbers.iter().copied().max().unwrap_or(0);
    let planes = (32 - most.leading_zeros()).div_ceil(8);
    out.push(planes as u8);
    for plane in 0..planes {
        let bytes: Vec<u8> = numbers.iter().map(|number| (number >> (8 * plane)) as u8).collect();
        push_packed(out, &bytes)?;
    }
    Ok(())
}

/// Appends texts, each as the number of bytes that it begins with like the one before, and the
/// others: all first numbers (`u8`), the lengths of the others, the others.
pub(crate) fn push_texts<'a>(
    out: &mut Vec<u8>,
    texts: impl IntoIterator<Item = &'a str>,
) -> Result<(), CorpusError> {
    let (mut common, mut lengths, mut rest) = (Vec::new(), Vec::new(), Vec::new());
    let mut before: &[u8] = &[];
    for text in texts {
        let text = text.as_bytes();
        let same = before.iter().zip(text).take(MAX_COMMON).take_while(|(a, b)| a == b).count();
        common.push(same as u8);
        lengths.push(u32::try_from(text.len() - same).map_err(|_| CorpusError::TooLarge)?);
        rest.extend(&text[same..]);
        before = text;
    }
    push_packed(out, &common)?;
    push_numbers(out, &lengths)?;
    push_packed(out, &rest)
}

/// Returns a signed number as one without a sign: those near 0 are small.
pub(crate) fn zigzag(number: i64) -> Result<u32, CorpusError> {
    let number = i32::try_from(number).map_err(|_| CorpusError::TooLarge)?;
    Ok(((number << 1) ^ (number >> 31)) as u32)
}

/// Returns the number of [`zigzag`].
pub(crate) fn unzigzag(number: u32) -> i64 {
    i64::from((number >> 1) as i32 ^ -((number & 1) as i32))
}

/// Many texts in one.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(crate) struct Texts {
    all: String,
    ends: Vec<usize>,
}

impl Texts {
    /// Returns a text; an empty one if there is none of this number.
    pub(crate) fn get(&self, number: usize) -> &str {
        let start = number.checked_sub(1).map_or(Some(0), |before| self.ends.get(before).copied());
        let range = start.zip(self.ends.get(number));
        range.and_then(|(start, end)| self.all.get(start..*end)).unwrap_or("")
    }

    /// Returns the number of texts.
    pub(crate) fn len(&self) -> usize {
        self.ends.len()
    }

    /// Adds a text.
    pub(crate) fn push(&mut self, text: &str) {
        self.all.push_str(text);
        self.ends.push(self.all.len());
    }
}

impl Reader<'_> {
    /// Returns compressed bytes, of which there are up to `most`.
    fn packed_up_to(&mut self, most: usize) -> Result<Vec<u8>, CorpusError> {
        let (packed, plain) = (self.u32()? as usize, self.u32()? as usize);
        let packed = self.take(packed)?;
        let what = self.what();
        if plain > most {
            return Err(CorpusError::Mismatch { what, found: plain, expected: most });
        }
        let plain_bytes = decompress_to_vec_with_limit(packed, plain);
        let bytes = plain_bytes.map_err(|_| CorpusError::Damaged { what })?;
        if bytes.len() == plain { Ok(bytes) } else { Err(CorpusError::Damaged { what }) }
    }

    /// Returns compressed bytes, of which there are `count`.
    pub(crate) fn packed(&mut self, count: usize) -> Result<Vec<u8>, CorpusError> {
        let bytes = self.packed_up_to(count)?;
        if bytes.len() == count {
            return Ok(bytes);
        }
        Err(CorpusError::Mismatch { what: self.what(), found: bytes.len(), expected: count })
    }

    /// Returns a compressed text.
    pub(crate) fn packed_text(&mut self) -> Result<String, CorpusError> {
        let what = self.what();
        let bytes = self.packed_up_to(MAX_TEXT)?;
        String::from_utf8(bytes).map_err(|_| CorpusError::Damaged { what })
    }

    /// Returns `count` numbers ([`push_numbers`]).
    pub(crate) fn numbers(&mut self, count: usize) -> Result<Vec<u32>, CorpusError> {
        let planes = u32::from(self.take(1)?.first().copied().unwrap_or(0));
        if planes > 4 {
            let found = planes as usize;
            return Err(CorpusError::Mismatch { what: self.what(), found, expected: 4 });
        }
        if planes == 0 {
            return Ok(vec![0; count]);
        }
        let mut numbers: Vec<u32> = Vec::new();
        for plane in 0..planes {
            let bytes = self.packed(count)?;
            numbers.resize(count, 0);
            for (number, byte) in numbers.iter_mut().zip(bytes) {
                *number |= u32::from(byte) << (8 * plane);
            }
        }
        Ok(numbers)
    }

    /// Returns `count` texts ([`push_texts`]).
    pub(crate) fn texts(&mut self, count: usize) -> Result<Texts, CorpusError> {
        let damaged = CorpusError::Damaged { what: self.what() };
        let common = self.packed(count)?;
        let lengths = self.numbers(count)?;
        let rest = self.packed_up_to(MAX_TEXT)?;
        let mut rest = rest.as_slice();
        let (mut all, mut ends, mut start) = (Vec::new(), Vec::with_capacity(count), 0);
        for (common, length) in common.into_iter().zip(lengths) {
            let Some((own, others)) = rest.split_at_checked(length as usize) else {
                return Err(damaged);
            };
            rest = others;
            let (before, end) = (start, all.len());
            let same = before..before + usize::from(common);
            if same.end > end || end + same.len() + own.len() > MAX_TEXT {
                return Err(damaged);
            }
            start = end;
            all.extend_from_within(same);
            all.extend(own);
            ends.push(all.len());
        }
        let Ok(all) = String::from_utf8(all) else { return Err(damaged) };
        if !rest.is_empty() || ends.iter().any(|end| !all.is_char_boundary(*end)) {
            return Err(damaged);
        }
        Ok(Texts { all, ends })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn numbers_are_read_back(numbers in prop::collection::vec(any::<u32>(), 0..50), bits in 0u32..32) {
            let numbers: Vec<u32> = numbers.into_iter().map(|number| number >> bits).collect();
            let mut bytes = Vec::new();
            push_numbers(&mut bytes, &numbers).unwrap();
            let mut reader = Reader::new(&bytes, "numbers");
            prop_assert_eq!(reader.numbers(numbers.len()).unwrap(), numbers);
            reader.end().unwrap();
        }

        #[test]
        fn texts_are_read_back(mut texts in prop::collection::vec("[a-c😀/]{0,6}", 0..30)) {
            texts.sort();
            let mut bytes = Vec::new();
            push_texts(&mut bytes, texts.iter().map(String::as_str)).unwrap();
            let mut reader = Reader::new(&bytes, "texts");
            let read = reader.texts(texts.len()).unwrap();
            reader.end().unwrap();
            let back: Vec<&str> = (0..read.len()).map(|number| read.get(number)).collect();
            prop_assert_eq!(back, texts);
        }

        #[test]
        fn small_signed_numbers_stay_small(number in any::<i32>()) {
            let number = i64::from(number);
            let folded = zigzag(number).unwrap();
            prop_assert_eq!(unzigzag(folded), number);
            prop_assert!(i64::from(folded) <= 2 * number.abs() + 1);
        }

        #[test]
        fn any_bytes_are_read_or_refused(bytes in prop::collection::vec(any::<u8>(), 0..60)) {
            Reader::new(&bytes, "texts").texts(3).ok();
            Reader::new(&bytes, "numbers").numbers(3).ok();
            Reader::new(&bytes, "text").packed_text().ok();
        }
    }

    #[test]
    fn packed_bytes_that_are_more_than_they_say_are_refused() {
        let mut bytes = Vec::new();
        push_packed(&mut bytes, &[7; 1000]).unwrap();
        assert!(Reader::new(&bytes, "bytes").packed(1000).is_ok());
        assert!(Reader::new(&bytes, "bytes").packed(999).is_err());
        bytes[4..8].copy_from_slice(&999u32.to_le_bytes());
        assert!(Reader::new(&bytes, "bytes").packed(999).is_err());
    }
}
