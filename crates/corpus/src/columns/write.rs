//! Writing of `columns.bin`.

use super::levels::Levels;
use super::{
    DIGITS, Facts, MAP_CODES, MARK, NumberFacts, STATES, VERSION, duration_secs, flags, stem,
    usual_poses_bytes,
};
use crate::bytes::push_u32;
use crate::packed::{push_numbers, push_packed, push_texts, zigzag};
use crate::{CorpusError, CorpusRow, column_rows};
use std::collections::{BTreeMap, BTreeSet};

/// The distance of the levels of metrics: a value is kept to 2 %.
const METRIC_STEP: f64 = 0.04;
/// The distance of the levels of heights: a height is kept to 0.3 %.
const HEIGHT_STEP: f64 = 0.006;

/// The texts of a row that only the builder of a corpus knows.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct RowTexts {
    /// The path of its file below the input.
    pub path: String,
    /// The name of the clip: its own, or that of its file without the ending.
    pub name: String,
    /// Its labels.
    pub labels: Vec<String>,
}

/// Returns the content of `columns.bin`: all that a page shows of the rows at once. `texts` has
/// the texts of each row, in the order of the rows.
///
/// # Errors
/// [`CorpusError::Mismatch`] if there are more or fewer texts than rows; [`CorpusError::TooLarge`].
pub fn write_columns(rows: &[CorpusRow], texts: &[RowTexts]) -> Result<Vec<u8>, CorpusError> {
    if rows.len() != texts.len() {
        let (found, expected) = (texts.len(), rows.len());
        return Err(CorpusError::Mismatch { what: "texts of rows", found, expected });
    }
    let mut clips: Vec<Clip<'_>> = (rows.iter().zip(texts).enumerate())
        .map(|(row, (own, texts))| Clip { row, own, texts })
        .collect();
    clips.sort_by(|a, b| a.texts.path.cmp(&b.texts.path).then(a.row.cmp(&b.row)));
    let ids = ids(rows)?;
    let lists = Lists::of(&clips);
    let mut out = MARK.to_vec();
    push_u32(&mut out, VERSION as usize)?;
    push_u32(&mut out, clips.len())?;
    let numbers = number_columns(&clips);
    let mut facts = lists.facts();
    facts.numbers = numbers.iter().map(|(facts, _)| facts.clone()).collect();
    for (place, clip) in clips.iter().enumerate() {
        if let Some(more) = ids.get(clip.row).filter(|id| !id.more.is_empty()) {
            let place = u32::try_from(place).map_err(|_| CorpusError::TooLarge)?;
            facts.longer.push((place, more.more.clone()));
        }
    }
    push_packed(&mut out, &serde_json::to_vec(&facts)?)?;
    push_texts(&mut out, lists.labels.keys().copied())?;
    let id = |of: fn(&Id) -> u32| -> Vec<u32> {
        clips.iter().map(|clip| ids.get(clip.row).map_or(0, of)).collect()
    };
    push_numbers(&mut out, &id(|id| id.digits))?;
    push_numbers(&mut out, &id(|id| id.number))?;
    push_texts(&mut out, clips.iter().map(|clip| clip.texts.path.as_str()))?;
    let bits: Vec<u8> = clips.iter().map(Clip::flags).collect();
    push_packed(&mut out, &bits)?;
    let named = clips.iter().filter(|clip| clip.is_named());
    push_texts(&mut out, named.map(|clip| clip.texts.name.as_str()))?;
    lists.push(&mut out, &clips)?;
    let frames: Vec<u32> = clips.iter().map(Clip::frames).collect::<Result<_, _>>()?;
    push_numbers(&mut out, &frames)?;
    let poses: Vec<u32> = clips.iter().map(Clip::poses).collect::<Result<_, _>>()?;
    push_numbers(&mut out, &poses)?;
    let thumbnails = clips.iter().map(|clip| clip.own.thumbnail.map_or(0, |slot| slot.length));
    let thumbnails: Vec<u32> = thumbnails.map(number).collect::<Result<_, _>>()?;
    push_numbers(&mut out, &thumbnails)?;
    for axis in 0..2 {
        let codes = clips.iter().map(|clip| map_code(clip.own.map.map(|place| place[axis])));
        push_packed(&mut out, &codes.collect::<Vec<u8>>())?;
    }
    push_numbers(&mut out, &originals(rows, &clips)?)?;
    for (_, codes) in numbers {
        push_packed(&mut out, &codes)?;
    }
    Ok(out)
}

/// A row in the order of paths.
struct Clip<'a> {
    row: usize,
    own: &'a CorpusRow,
    texts: &'a RowTexts,
}

impl Clip<'_> {
    fn is_named(&self) -> bool {
        self.texts.name != stem(&self.texts.path)
    }

    fn flags(&self) -> u8 {
        let status = STATES.iter().position(|status| *status == self.own.row.status);
        let bit = |is_set: bool, bit: u8| if is_set { bit } else { 0 };
        status.unwrap_or(0) as u8
            | bit(self.is_named(), flags::NAMED)
            | bit(self.own.copy_of.is_some(), flags::COPY)
            | bit(self.own.is_mirrored, flags::MIRRORED)
    }

    /// Returns the number of frames plus 1; 0 where it is unknown.
    fn frames(&self) -> Result<u32, CorpusError> {
        self.own.row.frames.map_or(Ok(0), |frames| number(frames.saturating_add(1)))
    }

    /// Returns the difference of the size of poses from its estimate, bytes.
    fn poses(&self) -> Result<u32, CorpusError> {
        let length = self.own.poses.map_or(0, |slot| slot.length);
        let frames = self.own.row.frames.map(number).transpose()?;
        let secs = frames.zip(rate(self));
        let secs = secs.map(|(frames, bits)| duration_secs(frames, f64::from_bits(bits)));
        let usual = secs.map_or(0, usual_poses_bytes);
        zigzag(i64::from(number(length)?) - i64::from(number(usual)?))
    }
}

fn number(number: usize) -> Result<u32, CorpusError> {
    u32::try_from(number).map_err(|_| CorpusError::TooLarge)
}

fn map_code(place: Option<f32>) -> u8 {
    let code = |place: f32| 1.0 + ((place.clamp(-1.0, 1.0) + 1.0) * 0.5 * MAP_CODES).round();
    place.filter(|place| place.is_finite()).map_or(0, |place| code(place) as u8)
}

/// The id of a row: eight digits of the hash, as many more as tell it apart, and the number of the
/// clip in its file.
struct Id {
    digits: u32,
    more: String,
    number: u32,
}

/// Returns the ids of rows, which are sorted by their keys.
fn ids(rows: &[CorpusRow]) -> Result<Vec<Id>, CorpusError> {
    let mut keys: Vec<&str> = rows.iter().map(|row| row.key.as_str()).collect();
    keys.dedup();
    let common = |a: &str, b: &str| a.bytes().zip(b.bytes()).take_while(|(a, b)| a == b).count();
    let mut needed: BTreeMap<&str, usize> = BTreeMap::new();
    for pair in keys.windows(2) {
        let digits = common(pair[0], pair[1]) + 1;
        for key in pair {
            let most = needed.entry(*key).or_default();
            *most = digits.max(*most);
        }
    }
    let id = |row: &CorpusRow| {
        let refused = || CorpusError::Damaged { what: "the key of a record" };
        let (digits, rest) = row.key.split_at_checked(DIGITS).ok_or_else(refused)?;
        let more = needed.get(row.key.as_str()).map_or(0, |digits| digits.saturating_sub(DIGITS));
        Ok(Id {
            digits: u32::from_str_radix(digits, 16).map_err(|_| refused())?,
            more: rest.get(..more).unwrap_or(rest).to_owned(),
            number: number(row.clip)?,
        })
    };
    rows.iter().map(id).collect()
}

/// Returns, for each copy in the order of paths, how many places ahead its original is.
fn originals(rows: &[CorpusRow], clips: &[Clip<'_>]) -> Result<Vec<u32>, CorpusError> {
    let mut places = vec![0usize; clips.len()];
    for (place, clip) in clips.iter().enumerate() {
        places[clip.row] = place;
    }
    let by_id: BTreeMap<&str, usize> =
        rows.iter().enumerate().map(|(row, own)| (own.id.as_str(), row)).collect();
    let copies = clips.iter().filter_map(|clip| Some((clip, clip.own.copy_of.as_deref()?)));
    let ahead = |(clip, of): (&Clip<'_>, &str)| {
        let of = by_id.get(of).copied().unwrap_or(clip.row);
        zigzag(places[of] as i64 - places[clip.row] as i64)
    };
    copies.map(ahead).collect()
}

/// The lists of distinct values.
struct Lists<'a> {
    formats: BTreeMap<&'a str, u32>,
    rigs: BTreeMap<&'a str, u32>,
    /// By their bits: rates are positive.
    rates: BTreeMap<u64, u32>,
    labels: BTreeMap<&'a str, u32>,
    sets: BTreeMap<Vec<u32>, u32>,
    messages: BTreeMap<&'a str, u32>,
}

impl<'a> Lists<'a> {
    fn of(clips: &[Clip<'a>]) -> Self {
        let formats = clips.iter().map(|clip| clip.own.row.format.as_str());
        let rigs = clips.iter().filter_map(|clip| clip.own.row.rig.as_deref());
        let rates = clips.iter().filter_map(|clip| rate(clip));
        let messages = clips.iter().filter_map(|clip| clip.own.row.message.as_deref());
        let labels = clips.iter().flat_map(|clip| &clip.texts.labels).map(String::as_str);
        let labels = numbered(labels);
        let set = |clip: &Clip<'_>| set_of(clip, &labels);
        let sets = numbered(std::iter::once(Vec::new()).chain(clips.iter().map(set)));
        Self {
            formats: numbered(formats),
            rigs: numbered(rigs),
            rates: numbered(rates),
            messages: numbered(messages),
            sets,
            labels,
        }
    }

    fn facts(&self) -> Facts {
        let texts = |own: &BTreeMap<&str, u32>| own.keys().map(|text| (*text).to_owned()).collect();
        Facts {
            formats: texts(&self.formats),
            rigs: texts(&self.rigs),
            rates: self.rates.keys().map(|bits| f64::from_bits(*bits)).collect(),
            labels: self.labels.len(),
            label_sets: self.sets.keys().cloned().collect(),
            messages: texts(&self.messages),
            longer: Vec::new(),
            numbers: Vec::new(),
        }
    }

    /// Appends the numbers of each clip's values in the lists. Those that a clip may lack begin
    /// with 1, and 0 is none.
    fn push(&self, out: &mut Vec<u8>, clips: &[Clip<'_>]) -> Result<(), CorpusError> {
        let after = |known: Option<&u32>| known.map_or(0, |number| number + 1);
        let columns: [&dyn Fn(&Clip<'_>) -> u32; 5] = [
            &|clip| self.formats.get(clip.own.row.format.as_str()).copied().unwrap_or(0),
            &|clip| after(clip.own.row.rig.as_deref().and_then(|rig| self.rigs.get(rig))),
            &|clip| after(rate(clip).and_then(|bits| self.rates.get(&bits))),
            &|clip| self.sets.get(&set_of(clip, &self.labels)).copied().unwrap_or(0),
            &|clip| after(clip.own.row.message.as_deref().and_then(|own| self.messages.get(own))),
        ];
        for column in columns {
            push_numbers(out, &clips.iter().map(column).collect::<Vec<u32>>())?;
        }
        Ok(())
    }
}

/// Returns the bits of a clip's frame rate, whose order is that of the rates.
fn rate(clip: &Clip<'_>) -> Option<u64> {
    clip.own.row.fps.filter(|fps| fps.is_finite() && *fps > 0.0).map(f64::to_bits)
}

fn set_of(clip: &Clip<'_>, labels: &BTreeMap<&str, u32>) -> Vec<u32> {
    clip.texts.labels.iter().filter_map(|label| labels.get(label.as_str()).copied()).collect()
}

/// Returns the numbers of distinct items in their order.
fn numbered<T: Ord>(items: impl Iterator<Item = T>) -> BTreeMap<T, u32> {
    items.collect::<BTreeSet<T>>().into_iter().zip(0..).collect()
}

/// Returns the columns of numbers that any clip has, with their codes.
fn number_columns(clips: &[Clip<'_>]) -> Vec<(NumberFacts, Vec<u8>)> {
    let height = ["height_m", "Height", "m", "The height of the body."];
    let metrics = column_rows().into_iter().map(|row| (row, METRIC_STEP));
    let column = |([name, label, unit, help], step): ([&str; 4], f64)| {
        let of = |clip: &Clip<'_>| match name {
            "height_m" => clip.own.row.height_m,
            _ => clip.own.row.metrics.get(name).copied().flatten(),
        };
        let values: Vec<Option<f64>> = clips.iter().map(of).collect();
        values.iter().any(Option::is_some).then(|| {
            let levels = Levels::spanning(values.iter().flatten().copied(), step);
            let codes = values.iter().map(|value| levels.code(*value)).collect();
            let [name, label, unit, help] = [name, label, unit, help].map(str::to_owned);
            (NumberFacts { name, label, unit, help, levels }, codes)
        })
    };
    std::iter::once((height, HEIGHT_STEP)).chain(metrics).filter_map(column).collect()
}
