//! A list of the index as bytes.
//!
//! Number of moments; for each of them the step of its clip's row from the one before; its moment,
//! or the step from the one before if that is of the same clip; all these as numbers of 7 bits a
//! byte. Then for each of them the size of its steps (a byte), then its differences from the
//! centroid in such steps (a signed byte per dimension).

use crate::CorpusError;
use crate::bytes::{Reader, push_varint};

/// A moment, and where its features are.
#[derive(Clone, Copy, Debug)]
pub(super) struct Member<'a> {
    /// The number of the clip's row in the table.
    pub(super) clip: u32,
    /// The number of the moment in the clip.
    pub(super) moment: u32,
    /// Its scaled features.
    pub(super) row: &'a [f32],
}

/// The exponent of the least size of steps: sizes are from 2⁻²⁴ to 240, three digits of a binary
/// fraction each.
const LEAST_EXPONENT: i32 = -24;
/// Bits of a size's fraction.
const FRACTION_BITS: u32 = 3;
/// The difference of a size's code from the upper bits of the number.
const BIAS: i32 = (127 + LEAST_EXPONENT) << FRACTION_BITS;
/// The bits of a number that a code has not.
const LOWER_BITS: u32 = 23 - FRACTION_BITS;

/// Returns the code of the least size of steps that is not below a number.
fn size_code(size: f32) -> u8 {
    if size <= 0.0 || size.is_nan() {
        return 0;
    }
    let bits = size.to_bits();
    let is_above = bits.trailing_zeros() < LOWER_BITS;
    let upper = (bits >> LOWER_BITS) as i32 + i32::from(is_above);
    (upper - BIAS).clamp(1, 255) as u8
}

/// Returns the size of steps of a code.
fn size_of(code: u8) -> f32 {
    if code == 0 { 0.0 } else { f32::from_bits(((i32::from(code) + BIAS) as u32) << LOWER_BITS) }
}

/// Returns the bytes of a list whose members are sorted by clip and moment.
pub(super) fn encode(centre: &[f32], members: &[Member<'_>]) -> Result<Vec<u8>, CorpusError> {
    let mut out = Vec::with_capacity(members.len() * (centre.len() + 4));
    if members.is_empty() {
        return Ok(out);
    }
    push_varint(&mut out, u32::try_from(members.len()).map_err(|_| CorpusError::TooLarge)?);
    let before = || std::iter::once(None).chain(members.iter().map(Some));
    for (before, own) in before().zip(members) {
        push_varint(&mut out, own.clip - before.map_or(0, |before| before.clip));
    }
    for (before, own) in before().zip(members) {
        let before = before.filter(|before| before.clip == own.clip);
        push_varint(&mut out, own.moment - before.map_or(0, |before| before.moment));
    }
    let mut codes = Vec::with_capacity(members.len() * centre.len());
    for own in members {
        let apart = || own.row.iter().zip(centre).map(|(value, centre)| value - centre);
        let most = apart().fold(0.0f32, |most, apart| most.max(apart.abs()));
        let code = size_code(most / 127.0);
        let size = size_of(code);
        out.push(code);
        codes.extend(apart().map(|apart| {
            let steps = if size > 0.0 { (apart / size).round().clamp(-127.0, 127.0) } else { 0.0 };
            (steps as i8).to_le_bytes()[0]
        }));
    }
    out.extend(codes);
    Ok(out)
}

/// Calls `visit` with clip, moment, size of steps and steps of each member of a list.
///
/// # Errors
/// [`CorpusError`] if these are not the bytes of one.
pub(super) fn decode(
    bytes: &[u8],
    dims: usize,
    mut visit: impl FnMut(u32, u32, f32, &[u8]),
) -> Result<(), CorpusError> {
    let what = "a list";
    if bytes.is_empty() {
        return Ok(());
    }
    let mut reader = Reader::new(bytes, what);
    let count = reader.varint()? as usize;
    // Each of them has that many bytes at least.
    if count > bytes.len() / (dims + 3) {
        return Err(CorpusError::Truncated { what });
    }
    let damaged = CorpusError::Damaged { what };
    let mut clips: Vec<u32> = Vec::with_capacity(count);
    for _ in 0..count {
        let step = reader.varint()?;
        let Some(clip) = clips.last().copied().unwrap_or(0).checked_add(step) else {
            return Err(damaged);
        };
        clips.push(clip);
    }
    let mut moments: Vec<u32> = Vec::with_capacity(count);
    for own in 0..count {
        let step = reader.varint()?;
        let is_same = own > 0 && clips[own - 1] == clips[own];
        let before = if is_same { moments.last().copied().unwrap_or(0) } else { 0 };
        let Some(moment) = before.checked_add(step) else { return Err(damaged) };
        moments.push(moment);
    }
    let sizes = reader.take(count)?;
    let steps = reader.take_items(count, dims)?;
    reader.end()?;
    let places = clips.into_iter().zip(moments).zip(sizes);
    for (((clip, moment), size), steps) in places.zip(steps.chunks_exact(dims)) {
        visit(clip, moment, size_of(*size), steps);
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn size_of_a_code_is_little_above_the_number(exponent in -20i32..6, part in 1.0f32..2.0) {
            let size = part * 2.0f32.powi(exponent);
            let read = size_of(size_code(size));
            prop_assert!(read >= size && read <= size * 1.126, "{} {}", size, read);
        }

        #[test]
        fn any_list_is_read_or_refused(bytes in prop::collection::vec(any::<u8>(), 0..80)) {
            decode(&bytes, 3, |_, _, size, steps| {
                assert!(size.is_finite() && steps.len() == 3);
            }).ok();
        }
    }

    #[test]
    fn list_is_read_back() {
        let rows = [[1.0, 2.0], [1.5, 2.5], [-3.0, 2.0], [1.0, 2.0]];
        let places = [(3, 7), (3, 9), (3, 300), (70_000, 2)];
        let members: Vec<Member<'_>> = (rows.iter().zip(places))
            .map(|(row, (clip, moment))| Member { clip, moment, row })
            .collect();
        let centre = [1.0, 2.0];
        let bytes = encode(&centre, &members).unwrap();
        let mut read = Vec::new();
        decode(&bytes, 2, |clip, moment, size, steps| {
            let value = |at: usize| centre[at] + f32::from(i8::from_le_bytes([steps[at]])) * size;
            read.push(((clip, moment), [value(0), value(1)]));
        })
        .unwrap();
        assert_eq!(read.len(), 4);
        for ((place, row), (expected, own)) in read.iter().zip(places.iter().zip(&rows)) {
            assert_eq!(place, expected);
            assert!(row.iter().zip(own).all(|(a, b)| (a - b).abs() < 0.02), "{row:?}");
        }
        for end in 1..bytes.len() {
            assert!(decode(&bytes[..end], 2, |_, _, _, _| ()).is_err(), "{end}");
        }
        assert!(decode(&[bytes.as_slice(), &[0]].concat(), 2, |_, _, _, _| ()).is_err());
    }
}
