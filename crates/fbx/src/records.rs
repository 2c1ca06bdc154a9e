//! Records of binary files, versions 7.0 to 7.7.
//!
//! A record is the place of its end, the number of its values and their bytes (32 bits each, 64
//! from version 7.5), its name, its values, and the records in it, closed by an empty one. The form
//! has no public specification; this is what the programs that read it agree on.

/// The beginning of a file, before the number of its version.
const MAGIC: &[u8] = b"Kaydara FBX Binary  \0\x1a\0";

/// The place of the first record.
pub(crate) const FIRST: usize = MAGIC.len() + 4;

/// The form of a file's records.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Form {
    /// Whether places and sizes have 64 bits.
    is_wide: bool,
}

/// A record, without the records in it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Record<'a> {
    /// The place of the record.
    pub(crate) at: usize,
    pub(crate) name: &'a [u8],
    /// The number of values.
    pub(crate) count: u64,
    pub(crate) values: &'a [u8],
    /// The place behind its values, of the first record in it.
    pub(crate) inside: usize,
    /// The place behind it.
    pub(crate) end: usize,
}

impl Form {
    /// Returns the form of a file; `None` if it is another file, or of a version of which these
    /// rules are not known to hold.
    pub(crate) fn of(bytes: &[u8]) -> Option<Self> {
        let version = bytes.strip_prefix(MAGIC)?.first_chunk::<4>()?;
        let version = u32::from_le_bytes(*version);
        (7000..8000).contains(&version).then_some(Self { is_wide: version >= 7500 })
    }

    /// Returns the size of a record without name and values, bytes; an empty record has that size.
    pub(crate) fn head(self) -> usize {
        if self.is_wide { 25 } else { 13 }
    }

    /// Returns the record at a place: `Some(None)` for an empty one, and `None` if it is broken.
    #[expect(clippy::option_option, reason = "broken, empty, or there")]
    pub(crate) fn record(self, bytes: &[u8], at: usize) -> Option<Option<Record<'_>>> {
        let head = bytes.get(at..)?.get(..self.head())?;
        let (words, name_length) = head.split_at(head.len() - 1);
        let word = |index: usize| {
            if self.is_wide {
                words.as_chunks::<8>().0.get(index).map(|word| u64::from_le_bytes(*word))
            } else {
                words.as_chunks::<4>().0.get(index).map(|word| u32::from_le_bytes(*word).into())
            }
        };
        let ([end, count, length], name_length) =
            ([word(0)?, word(1)?, word(2)?], usize::from(*name_length.first()?));
        if end == 0 && name_length == 0 {
            return Some(None);
        }
        let name_at = at + self.head();
        let values_at = name_at.checked_add(name_length)?;
        let inside = values_at.checked_add(usize::try_from(length).ok()?)?;
        let end = usize::try_from(end).ok()?;
        let name = bytes.get(name_at..values_at)?;
        let values = bytes.get(values_at..inside)?;
        let is_there = inside <= end && end <= bytes.len();
        is_there.then_some(Some(Record { at, name, count, values, inside, end }))
    }

    /// Returns the records in a record, such as a curve; `None` if one of them is broken, or if
    /// there are many more than in a curve.
    pub(crate) fn children<'a>(
        self,
        bytes: &'a [u8],
        parent: &Record<'_>,
    ) -> Option<Vec<Record<'a>>> {
        /// A record of 13 bytes would take 64.
        const MAX_CHILDREN: usize = 64;
        let children = self.iter_children(bytes, parent).take(MAX_CHILDREN + 1);
        let children: Vec<Record<'a>> = children.collect::<Option<_>>()?;
        (children.len() <= MAX_CHILDREN).then_some(children)
    }

    /// Returns the records in a record one by one, which takes no memory for many of them; the last
    /// one is `None` if it is broken.
    pub(crate) fn iter_children<'a>(
        self,
        bytes: &'a [u8],
        parent: &Record<'_>,
    ) -> impl Iterator<Item = Option<Record<'a>>> {
        let (mut at, end) = (parent.inside, parent.end);
        std::iter::from_fn(move || {
            if at >= end {
                return None;
            }
            let child = match self.record(bytes, at) {
                Some(None) => return None,
                Some(Some(child)) if child.end <= end => Some(child),
                _ => None,
            };
            at = child.map_or(end, |child| child.end);
            Some(child)
        })
    }

    /// Writes a record without its values; `end` is the place behind it.
    pub(crate) fn write_head(
        self,
        out: &mut Vec<u8>,
        end: u64,
        count: u64,
        length: usize,
        name: &[u8],
    ) {
        for word in [end, count, length as u64] {
            if self.is_wide {
                out.extend(word.to_le_bytes());
            } else {
                out.extend((word as u32).to_le_bytes());
            }
        }
        out.push(name.len() as u8);
        out.extend(name);
    }

    /// Returns the greatest place of an end, for a record whose end is not known: an empty record
    /// closes it.
    pub(crate) fn far(self) -> u64 {
        if self.is_wide { i64::MAX as u64 } else { u32::MAX.into() }
    }
}

/// An array, the only value of a record.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Array<'a> {
    /// The letter of its type.
    pub(crate) kind: u8,
    /// The number of its numbers.
    pub(crate) count: usize,
    /// Whether its bytes are packed by zlib.
    pub(crate) is_packed: bool,
    pub(crate) bytes: &'a [u8],
}

/// The size of an array before its bytes: its type, their number, how they are packed, their size.
const ARRAY_HEAD: usize = 13;

impl<'a> Array<'a> {
    /// Returns the array of a record that has nothing else.
    pub(crate) fn of(record: &Record<'a>) -> Option<Self> {
        let (head, bytes) = record.values.split_at_checked(ARRAY_HEAD)?;
        let (&kind, words) = head.split_first()?;
        let [count, packing, size] = *words.as_chunks::<4>().0.first_chunk::<3>()?;
        let [count, packing, size] = [count, packing, size].map(u32::from_le_bytes);
        let is_whole = record.count == 1
            && packing <= 1
            && size as usize == bytes.len()
            && record.inside == record.end;
        let (count, is_packed) = (count as usize, packing == 1);
        is_whole.then_some(Self { kind, count, is_packed, bytes })
    }
}

/// Writes an array that is not packed, as the value of a record.
pub(crate) fn write_array(out: &mut Vec<u8>, kind: u8, count: usize, bytes: &[u8]) {
    out.push(kind);
    for word in [count, 0, bytes.len()] {
        out.extend((word as u32).to_le_bytes());
    }
    out.extend(bytes);
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns a record with so many records in it.
    fn record_of(form: Form, children: usize) -> Vec<u8> {
        let child = form.head() + 1;
        let mut bytes = Vec::new();
        let end = form.head() + 1 + children * child;
        form.write_head(&mut bytes, end as u64, 0, 0, b"p");
        for index in 1..=children {
            let end = form.head() + 1 + index * child;
            form.write_head(&mut bytes, end as u64, 0, 0, b"c");
        }
        bytes
    }

    #[test]
    fn children_are_few_and_whole_or_none() {
        for form in [Form { is_wide: false }, Form { is_wide: true }] {
            let found = |bytes: &[u8]| {
                let parent = form.record(bytes, 0).flatten().expect("a record");
                form.children(bytes, &parent).map(|children| children.len())
            };
            assert_eq!(
                [0, 1, 64].map(|count| found(&record_of(form, count))),
                [0, 1, 64].map(Some)
            );
            assert_eq!(found(&record_of(form, 65)), None);
            // The second one goes on behind its parent.
            let mut bytes = record_of(form, 2);
            let second = 2 * (form.head() + 1);
            let end = bytes.len() + 1;
            bytes[second] = end as u8;
            bytes.push(0);
            assert_eq!(found(&bytes), None);
            let parent = form.record(&bytes, 0).flatten().expect("a record");
            let whole = form.iter_children(&bytes, &parent).map(|child| child.is_some());
            assert_eq!(whole.collect::<Vec<_>>(), [true, false]);
        }
    }
}
