//! Search of the index by ranges of its files.

use super::build::value;
use super::{MARK, VERSION, list, squared};
use crate::bytes::Reader;
use crate::pack::Placer;
use crate::{CorpusError, Slot};
use std::collections::BTreeSet;
use std::ops::Range;

/// The greatest number of dimensions, and of lists, that is read.
const MAX_DIMS: usize = 1_024;
const MAX_LISTS: usize = 1 << 16;

/// A moment that was found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// The number of the clip's row in the table.
    pub clip: u32,
    /// The number of the moment: a tenth of a second each.
    pub moment: u32,
    /// The distance from the query: the square root of the cost of matching.
    pub distance: f32,
}

/// The place of a list in the files of the index.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ListPlace {
    /// The number of the file.
    pub file: usize,
    /// The first byte.
    pub offset: usize,
    /// The number of bytes; 0 for an empty list.
    pub length: usize,
}

impl ListPlace {
    /// Returns the range of its bytes.
    #[must_use]
    pub fn bytes(&self) -> Range<usize> {
        self.offset..self.offset.saturating_add(self.length)
    }
}

/// The part of an index that is read at once: centroids, and the places of lists.
#[derive(Clone, Debug)]
pub struct Index {
    dims: usize,
    moments: usize,
    centroids: Vec<f32>,
    places: Vec<ListPlace>,
}

impl Index {
    /// Reads `index/centroids.bin`.
    ///
    /// # Errors
    /// [`CorpusError`] if these are not the bytes of one.
    pub fn read(bytes: &[u8]) -> Result<Self, CorpusError> {
        let what = "centroids";
        let mut reader = Reader::new(bytes, what);
        reader.mark(MARK)?;
        match reader.u32()? {
            VERSION => {}
            found => return Err(CorpusError::Version { what, found, expected: VERSION }),
        }
        let [dims, lists, moments] =
            [reader.u32()? as usize, reader.u32()? as usize, reader.u32()? as usize];
        if !(1..=MAX_DIMS).contains(&dims) {
            return Err(CorpusError::Mismatch { what: "dimensions", found: dims, expected: 1 });
        }
        if lists > MAX_LISTS {
            return Err(CorpusError::Mismatch { what: "lists", found: lists, expected: MAX_LISTS });
        }
        let scales = reader.f32s(2 * dims)?;
        let codes: Vec<Vec<u8>> =
            (0..dims).map(|_| reader.packed(lists)).collect::<Result<_, _>>()?;
        let lengths = reader.numbers(lists)?;
        reader.end()?;
        let mut centroids = vec![0.0; lists * dims];
        for (dim, (scale, codes)) in scales.as_chunks().0.iter().zip(codes).enumerate() {
            for (centre, code) in centroids.chunks_exact_mut(dims).zip(codes) {
                centre[dim] = value(*scale, code);
            }
        }
        let mut placer = Placer::default();
        let mut place = |length: &u32| {
            let Slot { shard, offset, length } = placer.add(*length as usize).unwrap_or_default();
            ListPlace { file: shard, offset, length }
        };
        let places = lengths.iter().map(&mut place).collect();
        Ok(Self { dims, moments, centroids, places })
    }

    /// Returns the number of dimensions.
    #[must_use]
    pub fn dims(&self) -> usize {
        self.dims
    }

    /// Returns the number of moments in all lists.
    #[must_use]
    pub fn moments(&self) -> usize {
        self.moments
    }

    /// Returns the number of lists.
    #[must_use]
    pub fn lists(&self) -> usize {
        self.places.len()
    }

    /// Returns the place of a list; `None` if there is no such list.
    #[must_use]
    pub fn place(&self, list: usize) -> Option<ListPlace> {
        self.places.get(list).copied()
    }

    /// Returns the lists that a search with so many probes reads, the nearest first. Empty lists
    /// are left out.
    ///
    /// # Errors
    /// [`CorpusError::Mismatch`] if the query has another number of dimensions.
    pub fn nearest_lists(&self, query: &[f32], probes: usize) -> Result<Vec<usize>, CorpusError> {
        self.check(query)?;
        let mut lists: Vec<(f32, usize)> = self
            .centroids
            .chunks_exact(self.dims)
            .zip(&self.places)
            .enumerate()
            .filter(|(_, (_, place))| place.length > 0)
            .map(|(list, (centre, _))| (squared(query, centre), list))
            .collect();
        lists.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        Ok(lists.into_iter().take(probes).map(|(_, list)| list).collect())
    }

    /// Returns the `count` moments nearest to a query in some lists, given as their numbers and
    /// bytes ([`place`](Self::place)); the nearest first, among equals by clip and moment. With all
    /// lists this is the exhaustive search.
    ///
    /// # Errors
    /// [`CorpusError::Mismatch`] if the query has another number of dimensions, or a list another
    /// number of bytes.
    pub fn search(
        &self,
        query: &[f32],
        lists: &[(usize, &[u8])],
        count: usize,
    ) -> Result<Vec<Hit>, CorpusError> {
        self.check(query)?;
        let mut hits = Vec::new();
        for (list, bytes) in lists {
            let Some(place) = self.places.get(*list) else {
                let (found, expected) = (*list, self.places.len());
                return Err(CorpusError::Mismatch {
                    what: "the number of a list",
                    found,
                    expected,
                });
            };
            if bytes.len() != place.length {
                let (found, expected) = (bytes.len(), place.length);
                return Err(CorpusError::Mismatch { what: "bytes of a list", found, expected });
            }
            self.scan(query, *list, bytes, &mut hits)?;
        }
        hits.sort_by(|a, b| {
            let by_place = || (a.clip, a.moment).cmp(&(b.clip, b.moment));
            a.distance.total_cmp(&b.distance).then_with(by_place)
        });
        hits.truncate(count);
        Ok(hits)
    }

    /// Returns the nearest moment of each clip, as [`search`](Self::search) finds them.
    ///
    /// # Errors
    /// Those of [`search`](Self::search).
    pub fn search_clips(
        &self,
        query: &[f32],
        lists: &[(usize, &[u8])],
        count: usize,
    ) -> Result<Vec<Hit>, CorpusError> {
        let mut hits = self.search(query, lists, usize::MAX)?;
        let mut seen = BTreeSet::new();
        hits.retain(|hit| seen.insert(hit.clip));
        hits.truncate(count);
        Ok(hits)
    }

    /// Adds the moments of a list.
    fn scan(
        &self,
        query: &[f32],
        list: usize,
        bytes: &[u8],
        hits: &mut Vec<Hit>,
    ) -> Result<(), CorpusError> {
        let centre = &self.centroids[list * self.dims..(list + 1) * self.dims];
        let from_centre: Vec<f32> = query.iter().zip(centre).map(|(own, at)| own - at).collect();
        list::decode(bytes, self.dims, |clip, moment, size, steps| {
            let apart = steps.iter().zip(&from_centre).map(|(steps, query)| {
                let value = f32::from(i8::from_le_bytes([*steps])) * size;
                (query - value) * (query - value)
            });
            hits.push(Hit { clip, moment, distance: apart.sum::<f32>().sqrt() });
        })
    }

    fn check(&self, query: &[f32]) -> Result<(), CorpusError> {
        if query.len() == self.dims {
            return Ok(());
        }
        let (found, expected) = (query.len(), self.dims);
        Err(CorpusError::Mismatch { what: "dimensions of a query", found, expected })
    }
}
