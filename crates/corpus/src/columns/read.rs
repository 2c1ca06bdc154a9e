//! Reading of `columns.bin`.

use super::{
    Coded, Columns, Facts, Ids, Lists, MAP_CODES, MARK, NOT_NAMED, NumberFacts, Original, STATES,
    VERSION, WHAT, flags, usual_poses_bytes,
};
use crate::bytes::Reader;
use crate::pack::Placer;
use crate::packed::{MAX_ROWS, Texts, unzigzag};
use crate::{CorpusError, Slot};

const DAMAGED: CorpusError = CorpusError::Damaged { what: WHAT };
/// The greatest number of columns of numbers; a few bytes can be packed as millions of rows each.
const MAX_COLUMNS: usize = 256;

/// Reads `columns.bin`.
///
/// # Errors
/// [`CorpusError`] if these are not the bytes of one.
pub(crate) fn read(bytes: &[u8]) -> Result<Columns, CorpusError> {
    let mut reader = Reader::new(bytes, WHAT);
    reader.mark(MARK)?;
    match reader.u32()? {
        VERSION => {}
        found => return Err(CorpusError::Version { what: WHAT, found, expected: VERSION }),
    }
    let count = reader.u32()? as usize;
    if count > MAX_ROWS {
        return Err(CorpusError::Mismatch { what: "rows", found: count, expected: MAX_ROWS });
    }
    let facts: Facts = serde_json::from_str(&reader.packed_text()?)?;
    if facts.labels > MAX_ROWS {
        return Err(DAMAGED);
    }
    let labels = reader.texts(facts.labels)?;
    let ids = Ids {
        digits: reader.numbers(count)?,
        numbers: reader.numbers(count)?,
        longer: facts.longer.iter().cloned().collect(),
    };
    let order = Order::of(&ids)?;
    let paths = reader.texts(count)?;
    let bits = reader.packed(count)?;
    if bits.iter().any(|bits| bits & !flags::ALL != 0) {
        return Err(DAMAGED);
    }
    let (names, named) = names(&mut reader, &bits)?;
    // 0 stands for none where a clip may be without: rig, rate and message.
    let formats = listed(&mut reader, count, facts.formats.len())?;
    let rigs = listed(&mut reader, count, facts.rigs.len() + 1)?;
    let rates = listed(&mut reader, count, facts.rates.len() + 1)?;
    let label_sets = listed(&mut reader, count, facts.label_sets.len())?;
    let messages = listed(&mut reader, count, facts.messages.len() + 1)?;
    let lists = Lists {
        formats: facts.formats,
        rigs: facts.rigs,
        rates: facts.rates,
        labels,
        label_sets: facts.label_sets,
        messages: facts.messages,
    };
    lists.check()?;
    let frames = reader.numbers(count)?;
    let secs = frames.iter().zip(&rates).map(|(frames, rate)| lists.secs(*frames, *rate));
    let poses = pose_bytes(&reader.numbers(count)?, secs)?;
    let thumbnails = reader.numbers(count)?;
    let axes = [reader.packed(count)?, reader.packed(count)?];
    let originals = originals(&mut reader, &bits, &order)?;
    if facts.numbers.len() > MAX_COLUMNS {
        return Err(DAMAGED);
    }
    let mut coded = Vec::new();
    for NumberFacts { name, label, unit, help, levels } in facts.numbers {
        let codes = order.by_row(&reader.packed(count)?);
        coded.push(Coded { name, label, unit, help, values: levels.values()?, codes });
    }
    reader.end()?;
    let states: Option<Vec<_>> =
        bits.iter().map(|bits| STATES.get(usize::from(bits & flags::STATUS)).copied()).collect();
    let map: Vec<[f32; 2]> =
        axes[0].iter().zip(&axes[1]).map(|(x, y)| [map_place(*x), map_place(*y)]).collect();
    let longer = ids.longer.iter().filter_map(|(place, digits)| {
        Some((order.row_of.get(*place as usize).copied()?, digits.clone()))
    });
    Ok(Columns {
        ids: Ids {
            digits: order.by_row(&ids.digits),
            numbers: order.by_row(&ids.numbers),
            longer: longer.collect(),
        },
        paths,
        names,
        named: order.by_row(&named),
        lists,
        formats: order.by_row(&formats),
        rigs: order.by_row(&rigs),
        rates: order.by_row(&rates),
        label_sets: order.by_row(&label_sets),
        messages: order.by_row(&messages),
        frames: order.by_row(&frames),
        states: order.by_row(&states.ok_or(DAMAGED)?),
        poses: slots(&order.by_row(&poses)),
        thumbnails: slots(&order.by_row(&thumbnails)),
        map: order.by_row(&map),
        originals: order.by_row(&originals),
        coded,
        row_of: order.row_of,
        place_of: order.place_of,
    })
}

/// The order of the table: that of the ids.
struct Order {
    row_of: Vec<u32>,
    place_of: Vec<u32>,
}

impl Order {
    fn of(ids: &Ids) -> Result<Self, CorpusError> {
        let mut place_of: Vec<u32> = (0..).take(ids.digits.len()).collect();
        place_of.sort_by(|a, b| ids.key(*a).cmp(&ids.key(*b)));
        if place_of.windows(2).any(|pair| ids.key(pair[0]) == ids.key(pair[1])) {
            return Err(DAMAGED);
        }
        let mut row_of = vec![0; place_of.len()];
        for (row, place) in (0..).zip(&place_of) {
            row_of[*place as usize] = row;
        }
        Ok(Self { row_of, place_of })
    }

    /// Returns the values of rows, given those in the order of paths.
    fn by_row<T: Copy>(&self, by_place: &[T]) -> Vec<T> {
        self.place_of.iter().filter_map(|place| by_place.get(*place as usize).copied()).collect()
    }
}

/// Returns the names that are not those of files, and for each place the number of its name.
fn names(reader: &mut Reader<'_>, bits: &[u8]) -> Result<(Texts, Vec<u32>), CorpusError> {
    let mut count = 0;
    let mut next = |bits: &u8| {
        if bits & flags::NAMED == 0 {
            return NOT_NAMED;
        }
        count += 1;
        count - 1
    };
    let named: Vec<u32> = bits.iter().map(&mut next).collect();
    Ok((reader.texts(count as usize)?, named))
}

/// Returns numbers that are below a limit.
fn listed(reader: &mut Reader<'_>, count: usize, end: usize) -> Result<Vec<u32>, CorpusError> {
    let numbers = reader.numbers(count)?;
    if numbers.iter().all(|number| (*number as usize) < end) { Ok(numbers) } else { Err(DAMAGED) }
}

/// Returns the sizes of poses, bytes, given their differences from the estimates.
fn pose_bytes(
    differences: &[u32],
    secs: impl Iterator<Item = Option<f64>>,
) -> Result<Vec<u32>, CorpusError> {
    let of = |(difference, secs): (&u32, Option<f64>)| {
        let length = secs.map_or(0, usual_poses_bytes) as i64 + unzigzag(*difference);
        u32::try_from(length).map_err(|_| DAMAGED)
    };
    differences.iter().zip(secs).map(of).collect()
}

/// Returns the places of bytes in the shards, given their numbers by row.
fn slots(lengths: &[u32]) -> Vec<Option<Slot>> {
    let mut placer = Placer::default();
    lengths.iter().map(|length| placer.add(*length as usize)).collect()
}

/// Returns the place of a code on an axis of the map; NaN for none.
fn map_place(code: u8) -> f32 {
    if code == 0 { f32::NAN } else { f32::from(code - 1) / MAP_CODES * 2.0 - 1.0 }
}

/// Returns the original of each copy, in the order of paths.
fn originals(
    reader: &mut Reader<'_>,
    bits: &[u8],
    order: &Order,
) -> Result<Vec<Option<Original>>, CorpusError> {
    let count = bits.iter().filter(|bits| *bits & flags::COPY != 0).count();
    let mut ahead = reader.numbers(count)?.into_iter();
    let mut of = |(place, bits): (i64, &u8)| {
        if bits & flags::COPY == 0 {
            return Ok(None);
        }
        let place = usize::try_from(place + unzigzag(ahead.next().unwrap_or(0)));
        let row = place.ok().and_then(|place| order.row_of.get(place).copied()).ok_or(DAMAGED)?;
        Ok(Some(Original { row, is_mirrored: bits & flags::MIRRORED != 0 }))
    };
    (0..).zip(bits).map(&mut of).collect()
}
