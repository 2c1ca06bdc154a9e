//! The curves of a binary file, found without reading the scene: their keys in the few bytes that
//! they have in the file.

use crate::OpenError;
use crate::records::{Array, FIRST, Form, Record, write_array};
use flate2::{Decompress, FlushDecompress, Status};
use std::collections::HashMap;
use std::ops::{Deref, Range};
use std::sync::Arc;

/// The size of a key in a scene of ufbx, bytes.
pub(crate) const KEY_BYTES: usize = size_of::<ufbx::Keyframe>();
/// Flags of a key: the tangents of a spline decide its curve.
const IS_CUBIC: i32 = 8;
/// The number of keys before a time, and behind it, on which the curve at that time depends: those
/// around it, and those around them for their tangents.
const NEIGHBOURS: usize = 3;
/// The record of a curve.
const CURVE: &[u8] = b"AnimationCurve";
/// The records of meshes, materials and images.
const MESH_DATA: [&[u8]; 6] =
    [b"Geometry", b"Video", b"Texture", b"Material", b"Deformer", b"Pose"];
/// The records with the keys of a curve.
const TIMES: &[u8] = b"KeyTime";
const VALUES: &[u8] = b"KeyValueFloat";
const FLAGS: &[u8] = b"KeyAttrFlags";
const TANGENTS: &[u8] = b"KeyAttrDataFloat";
const RUNS: &[u8] = b"KeyAttrRefCount";
/// The records with the curve before its first key and behind its last one.
const EXTRAPOLATIONS: [&[u8]; 2] = [b"Pre-Extrapolation", b"Post-Extrapolation"];
/// The size of all arrays of curves as a multiple of the file's beyond which it is refused: few
/// of them may be kept, but unpacking them would take hours. Those of recordings are about ten
/// times as large as their files, and a thousand times is what zlib packs.
const MAX_UNPACKED_RATIO: usize = 64;
/// The size of all arrays of curves that is never refused for that, bytes.
const MIN_UNPACKED: usize = 64 << 20;
/// The size of the tangents of a run of keys, bytes.
const TANGENT_BYTES: usize = 16;

/// A file with the places of its curves.
pub(crate) struct CurveFile<'a> {
    pub(crate) bytes: &'a [u8],
    pub(crate) form: Form,
    /// The record with the objects.
    pub(crate) objects: Record<'a>,
    /// The place behind all records.
    pub(crate) end: usize,
    /// The objects that are written in another way, in the order of the file.
    pub(crate) pieces: Vec<Piece>,
    pub(crate) curves: Vec<Curve<'a>>,
    /// The memory that the curves take, bytes.
    pub(crate) memory: usize,
}

/// An object that is written in another way.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum Piece {
    /// A curve, by its index.
    Curve(Range<usize>, usize),
    /// A part of a mesh, a material or an image, which no transform depends on.
    MeshData(Range<usize>),
}

impl Piece {
    pub(crate) fn place(&self) -> &Range<usize> {
        match self {
            Self::Curve(place, _) | Self::MeshData(place) => place,
        }
    }
}

/// Numbers, in the file or unpacked.
enum Numbers<'a> {
    File(&'a [u8]),
    Own(Arc<[u8]>),
}

impl Deref for Numbers<'_> {
    type Target = [u8];

    fn deref(&self) -> &[u8] {
        match self {
            Self::File(bytes) => bytes,
            Self::Own(bytes) => bytes,
        }
    }
}

/// A curve.
pub(crate) struct Curve<'a> {
    record: Record<'a>,
    /// Its keys, if they can be taken apart.
    keys: Option<Keys<'a>>,
}

/// The keys of a curve, in order of time.
struct Keys<'a> {
    count: usize,
    /// Ticks, of 64 bits.
    times: Numbers<'a>,
    /// One if all are equal.
    values: Numbers<'a>,
    /// The size of a value: of single or double precision.
    value_bytes: usize,
    flags: Array<'a>,
    tangents: Array<'a>,
    /// For each pair of flags and tangents the number of keys that have them.
    runs: Array<'a>,
    /// The keys with the least and the greatest value.
    ends: [usize; 2],
    /// Whether all values are equal.
    is_level: bool,
    /// Whether tangents decide the curve.
    is_cubic: bool,
}

/// The keys of a curve that are written.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Pick {
    /// Those with the least and the greatest value: nodes depend on whether their scales are
    /// constant.
    Ends,
    /// All.
    All,
    /// Those that decide the curve in a span of time, seconds, and [`Pick::Ends`].
    Span(Range<f64>),
}

/// The variation of a curve, as far as its keys show it without their tangents.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Shape {
    /// It has no keys.
    Empty,
    /// It has the same value for all times.
    Constant,
    /// Its keys have different values.
    Varied,
    /// Its keys have the same value, and tangents that may leave it between them.
    Level,
    /// Its keys cannot be taken apart, and are always written.
    Unknown,
}

impl<'a> CurveFile<'a> {
    /// Finds the curves of a file that has more than `most` keys; `None` for other files than
    /// binary ones from version 7.0, for those that are broken, and where too many curves cannot be
    /// taken apart.
    ///
    /// # Errors
    /// [`OpenError::Keys`] if the curves take more than `max_memory` bytes, or unpack to many times
    /// the size of the file.
    pub(crate) fn of(
        bytes: &'a [u8],
        most: usize,
        max_memory: usize,
    ) -> Result<Option<Self>, OpenError> {
        let mut unpacker = Unpacker {
            most: max_memory,
            most_unpacked: bytes.len().saturating_mul(MAX_UNPACKED_RATIO).max(MIN_UNPACKED),
            ..Unpacker::default()
        };
        let found = Self::find(bytes, most, &mut unpacker);
        if unpacker.is_full { Err(OpenError::Keys) } else { Ok(found) }
    }

    /// Finds the curves as [`CurveFile::of`] does; `None` also if the unpacker is full.
    fn find(bytes: &'a [u8], most: usize, unpacker: &mut Unpacker<'a>) -> Option<Self> {
        let form = Form::of(bytes)?;
        let (mut end, mut objects) = (FIRST, None);
        while let Some(record) = form.record(bytes, end)? {
            if record.name == b"Objects" && objects.replace(record).is_some() {
                return None;
            }
            end = record.end;
        }
        let objects = objects?;
        let (mut keys, mut curve_count, mut piece_count) = (0_usize, 0_usize, 0_usize);
        for record in form.iter_children(bytes, &objects) {
            let record = record?;
            if record.name == CURVE {
                curve_count += 1;
                let mut children = form.iter_children(bytes, &record).flatten();
                let times = children.find(|child| child.name == TIMES);
                let times = times.as_ref().and_then(Array::of);
                keys = keys.saturating_add(times.map_or(0, |times| times.count));
            }
            piece_count += usize::from(record.name == CURVE || MESH_DATA.contains(&record.name));
        }
        if keys <= most {
            return None;
        }
        unpacker.keep(curve_count.saturating_mul(size_of::<Curve<'_>>()))?;
        unpacker.keep(piece_count.saturating_mul(size_of::<Piece>()))?;
        let mut pieces = Vec::with_capacity(piece_count);
        let mut curves = Vec::with_capacity(curve_count);
        for record in form.iter_children(bytes, &objects) {
            let record = record?;
            let place = record.at..record.end;
            if record.name == CURVE {
                let read = Keys::read(bytes, form, &record, unpacker);
                if unpacker.is_full {
                    return None;
                }
                if read.is_some() {
                    pieces.push(Piece::Curve(place, curves.len()));
                }
                curves.push(Curve { record, keys: read });
            } else if MESH_DATA.contains(&record.name) {
                pieces.push(Piece::MeshData(place));
            }
        }
        // The others are in each part.
        let taken_apart: usize = curves.iter().map(Curve::len).sum();
        let is_worth_it = keys.saturating_sub(taken_apart) <= most / 4;
        let memory = unpacker.kept;
        is_worth_it.then_some(Self { bytes, form, objects, end, pieces, curves, memory })
    }
}

impl Curve<'_> {
    pub(crate) fn shape(&self) -> Shape {
        let Some(keys) = &self.keys else { return Shape::Unknown };
        match keys.count {
            0 => Shape::Empty,
            1 => Shape::Constant,
            _ if !keys.is_level => Shape::Varied,
            _ if keys.is_cubic => Shape::Level,
            _ => Shape::Constant,
        }
    }

    /// Returns the number of keys.
    pub(crate) fn len(&self) -> usize {
        self.keys.as_ref().map_or(0, |keys| keys.count)
    }

    /// Returns the times of the keys, ticks.
    pub(crate) fn ticks(&self) -> impl Iterator<Item = i64> {
        let times = self.keys.as_ref().map(|keys| keys.times.as_chunks::<8>().0);
        times.unwrap_or_default().iter().map(|time| i64::from_le_bytes(*time))
    }

    /// Returns whether [`Pick::Ends`] are so many keys, of which the first has this value.
    pub(crate) fn begins_with(&self, count: usize, value: f64) -> bool {
        let Some(keys) = &self.keys else { return true };
        let picked = keys.picked(&Pick::Ends, 1.0);
        let first = picked.first().map(|first| keys.value(first.start));
        count == picked.iter().map(Range::len).sum::<usize>()
            && first.is_none_or(|first| first == value)
    }

    /// Writes the record with a part of its keys. `at` is the place of `out`'s first byte, and
    /// `ticks_per_sec` the unit of times.
    pub(crate) fn write(
        &self,
        file: &CurveFile<'_>,
        out: &mut Vec<u8>,
        at: u64,
        pick: &Pick,
        ticks_per_sec: f64,
    ) -> Option<()> {
        let form = file.form;
        let children = form.children(file.bytes, &self.record)?;
        let parts = self.keys.as_ref()?.parts(pick, ticks_per_sec)?;
        let start = out.len();
        let head = |out: &mut Vec<u8>, end: u64| {
            let Record { count, values, name, .. } = self.record;
            form.write_head(out, end, count, values.len(), name);
        };
        head(out, 0);
        out.extend(self.record.values);
        for child in children {
            let part = parts.iter().find(|part| part.name == child.name);
            let values = part.map_or(child.values, |part| &part.array);
            let size = form.head() + child.name.len() + values.len();
            // Extrapolations: those of a constant value, the default.
            if child.inside < child.end {
                continue;
            }
            let end = at + (out.len() + size) as u64;
            form.write_head(out, end, child.count, values.len(), child.name);
            out.extend(values);
        }
        out.extend(std::iter::repeat_n(0, form.head()));
        let end = at + out.len() as u64;
        let mut again = Vec::new();
        head(&mut again, end);
        out.get_mut(start..start + again.len())?.copy_from_slice(&again);
        Some(())
    }
}

/// An array of the record that is written.
struct Part {
    name: &'static [u8],
    array: Vec<u8>,
}

impl<'a> Keys<'a> {
    /// Reads the keys of a curve; `None` where a part of them would not give the curve between
    /// them, or something is not as expected.
    fn read(
        bytes: &'a [u8],
        form: Form,
        record: &Record<'a>,
        unpacker: &mut Unpacker<'a>,
    ) -> Option<Self> {
        let children = form.children(bytes, record)?;
        let array = |name: &[u8], kinds: &[u8]| {
            let mut named = children.iter().filter(|child| child.name == name);
            let array = Array::of(named.next()?)?;
            (named.next().is_none() && kinds.contains(&array.kind)).then_some(array)
        };
        let mut nested = children.iter().filter(|child| child.inside < child.end);
        if !nested
            .all(|child| EXTRAPOLATIONS.contains(&child.name) && is_constant(bytes, form, child))
        {
            return None;
        }
        let (times, values) = (array(TIMES, b"l")?, array(VALUES, b"fd")?);
        let (flags, tangents) = (array(FLAGS, b"i")?, array(TANGENTS, b"fi")?);
        let runs = array(RUNS, b"i")?;
        let count = times.count;
        let is_even = values.count == count
            && runs.count <= count
            && flags.count == runs.count
            && tangents.count == 4 * runs.count;
        if !is_even {
            return None;
        }
        let value_bytes = if values.kind == b'f' { 4 } else { 8 };
        // These three are unpacked together, and again when a part is written.
        let sizes = [&runs, &flags, &tangents].map(|array| unpacked_bytes(array, 4));
        let [runs_size, flags_size, tangents_size] = sizes;
        let together = runs_size?.saturating_add(flags_size?).saturating_add(tangents_size?);
        unpacker.check(together)?;
        let [times_size, values_size] =
            [unpacked_bytes(&times, size_of::<i64>())?, unpacked_bytes(&values, value_bytes)?];
        unpacker.unpack(together.saturating_add(times_size).saturating_add(values_size))?;
        let mut left = count;
        for run in integers(&unpacked(&runs, size_of::<i32>())?) {
            left = left.saturating_sub(usize::try_from(run).ok().filter(|run| *run > 0)?);
        }
        let is_cubic = integers(&unpacked(&flags, size_of::<i32>())?).any(|f| f & IS_CUBIC != 0);
        let mut keys = Self {
            count,
            times: unpacker.times(&times)?,
            values: unpacker.numbers(&values, value_bytes)?,
            value_bytes,
            flags,
            tangents,
            runs,
            ends: [0; 2],
            is_level: true,
            is_cubic,
        };
        if left > 0 || !(1..count).all(|key| keys.time(key - 1) <= keys.time(key)) {
            return None;
        }
        let first = if count > 0 { keys.value(0) } else { 0.0 };
        let [mut least, mut greatest] = [first; 2];
        for key in 0..count {
            let value = keys.value(key);
            if !value.is_finite() {
                return None;
            }
            keys.is_level &= value == first;
            if value < least {
                (least, keys.ends[0]) = (value, key);
            }
            if value > greatest {
                (greatest, keys.ends[1]) = (value, key);
            }
        }
        if keys.is_level {
            // One stands for all.
            let one = keys.values.get(..value_bytes.min(keys.values.len()))?;
            keys.values = Numbers::Own(one.into());
        }
        unpacker.keep_own(&keys.values)?;
        Some(keys)
    }

    /// Returns the time of a key, ticks.
    fn time(&self, key: usize) -> i64 {
        let time = self.times.as_chunks::<8>().0.get(key);
        time.map_or(0, |time| i64::from_le_bytes(*time))
    }

    fn value(&self, key: usize) -> f64 {
        let key = if self.values.len() == self.value_bytes { 0 } else { key };
        if self.value_bytes == 4 {
            let value = self.values.as_chunks::<4>().0.get(key);
            value.map_or(0.0, |value| f32::from_le_bytes(*value).into())
        } else {
            let value = self.values.as_chunks::<8>().0.get(key);
            value.map_or(0.0, |value| f64::from_le_bytes(*value))
        }
    }

    /// Returns the number of keys up to a time, seconds.
    fn until(&self, secs: f64, ticks_per_sec: f64) -> usize {
        let (mut from, mut to) = (0, self.count);
        while from < to {
            let middle = usize::midpoint(from, to);
            if self.time(middle) as f64 / ticks_per_sec <= secs {
                from = middle + 1;
            } else {
                to = middle;
            }
        }
        from
    }

    /// Returns the keys that are written, in order and without overlaps.
    fn picked(&self, pick: &Pick, ticks_per_sec: f64) -> Vec<Range<usize>> {
        let span = match pick {
            Pick::All => 0..self.count,
            Pick::Ends => 0..0,
            Pick::Span(span) => {
                let first = self.until(span.start, ticks_per_sec).saturating_sub(NEIGHBOURS);
                let last = self.until(span.end, ticks_per_sec) + NEIGHBOURS;
                first..last.min(self.count)
            }
        };
        let mut picked = vec![span.clone()];
        picked.extend(self.ends.map(|end| end..end + 1));
        picked.retain(|range| !range.is_empty() && range.end <= self.count);
        picked.retain(|range| *range == span || !span.contains(&range.start));
        picked.sort_by_key(|range| range.start);
        picked.dedup();
        picked
    }

    /// Returns the arrays with a part of the keys.
    fn parts(&self, pick: &Pick, ticks_per_sec: f64) -> Option<Vec<Part>> {
        let picked = self.picked(pick, ticks_per_sec);
        let part = |name: &'static [u8], kind: u8, count: usize, bytes: &[u8]| {
            let mut array = Vec::with_capacity(bytes.len() + 16);
            write_array(&mut array, kind, count, bytes);
            Part { name, array }
        };
        let keys: usize = picked.iter().map(Range::len).sum();
        let of = |bytes: &[u8], size: usize| {
            let mut all = Vec::with_capacity(keys * size);
            for range in &picked {
                all.extend_from_slice(bytes.get(range.start * size..range.end * size)?);
            }
            Some(all)
        };
        let times = of(&self.times, 8)?;
        let values = if self.values.len() == self.value_bytes {
            self.values.repeat(keys)
        } else {
            of(&self.values, self.value_bytes)?
        };
        let all_flags = unpacked(&self.flags, size_of::<i32>())?;
        let all_tangents = unpacked(&self.tangents, size_of::<f32>())?;
        let all_runs = unpacked(&self.runs, size_of::<i32>())?;
        let (mut flags, mut tangents, mut runs) = (Vec::new(), Vec::new(), Vec::new());
        let mut ranges = picked.iter().cloned().peekable();
        let mut start = 0;
        for ((run, flag), tangent) in integers(&all_runs)
            .zip(all_flags.as_chunks::<4>().0)
            .zip(all_tangents.as_chunks::<TANGENT_BYTES>().0)
        {
            let end = start + usize::try_from(run).ok()?;
            // The keys of this run.
            let mut count = 0;
            while let Some(range) = ranges.peek() {
                count += range.end.min(end).saturating_sub(range.start.max(start));
                if range.end > end {
                    break;
                }
                ranges.next();
            }
            if count > 0 {
                flags.extend(flag);
                tangents.extend(tangent);
                runs.extend((count as i32).to_le_bytes());
            }
            start = end;
        }
        let count = runs.len() / size_of::<i32>();
        Some(vec![
            part(TIMES, b'l', keys, &times),
            part(VALUES, if self.value_bytes == 4 { b'f' } else { b'd' }, keys, &values),
            part(FLAGS, b'i', count, &flags),
            part(TANGENTS, self.tangents.kind, 4 * count, &tangents),
            part(RUNS, b'i', count, &runs),
        ])
    }
}

/// Returns whether an extrapolation is that of a constant value.
fn is_constant(bytes: &[u8], form: Form, record: &Record<'_>) -> bool {
    let Some(children) = form.children(bytes, record) else { return false };
    let kind = children.iter().find(|child| child.name == b"Type").map(|child| child.values);
    matches!(kind, None | Some([b'C', b'C'] | [b'I', b'C', 0, 0, 0]))
}

/// Returns 32-bit integers.
fn integers(bytes: &[u8]) -> impl Iterator<Item = i32> {
    bytes.as_chunks::<4>().0.iter().map(|value| i32::from_le_bytes(*value))
}

/// Returns the memory for an array of numbers of `size` bytes, bytes: none if it is not packed;
/// `None` if it cannot have that many numbers.
fn unpacked_bytes(array: &Array<'_>, size: usize) -> Option<usize> {
    /// The most that zlib packs into one byte, bytes.
    const MAX_RATIO: usize = 1032;
    let length = array.count.checked_mul(size)?;
    if array.is_packed {
        (length <= array.bytes.len().saturating_mul(MAX_RATIO)).then_some(length)
    } else {
        (length == array.bytes.len()).then_some(0)
    }
}

/// Returns the numbers of an array, of `size` bytes each. There has to be memory for them
/// ([`Unpacker::check`]).
fn unpacked<'a>(array: &Array<'a>, size: usize) -> Option<Numbers<'a>> {
    let length = unpacked_bytes(array, size)?;
    if !array.is_packed {
        return Some(Numbers::File(array.bytes));
    }
    let mut bytes: Arc<[u8]> = std::iter::repeat_n(0, length).collect();
    let own = Arc::get_mut(&mut bytes)?;
    let mut stream = Decompress::new(true);
    let status = stream.decompress(array.bytes, own, FlushDecompress::Finish).ok()?;
    let is_whole = status == Status::StreamEnd && stream.total_out() == length as u64;
    is_whole.then_some(Numbers::Own(bytes))
}

/// Unpacks arrays, and counts the memory for them before it is allocated.
#[derive(Default)]
struct Unpacker<'a> {
    /// The times so far by their packed bytes: most curves share theirs.
    times: HashMap<&'a [u8], Arc<[u8]>>,
    /// The greatest memory, bytes.
    most: usize,
    /// The memory that is taken, bytes.
    kept: usize,
    /// The greatest size of all arrays, bytes, whether they are kept or not.
    most_unpacked: usize,
    /// Their size so far, bytes.
    unpacked: usize,
    /// Whether more was asked for.
    is_full: bool,
}

impl<'a> Unpacker<'a> {
    /// Counts arrays of so many bytes.
    fn unpack(&mut self, bytes: usize) -> Option<()> {
        self.unpacked = self.unpacked.saturating_add(bytes);
        self.is_full |= self.unpacked > self.most_unpacked;
        (!self.is_full).then_some(())
    }

    /// Returns whether there are so many bytes for a while.
    fn check(&mut self, bytes: usize) -> Option<()> {
        self.is_full |= bytes > self.most.saturating_sub(self.kept);
        (!self.is_full).then_some(())
    }

    /// Takes so many bytes for good.
    fn keep(&mut self, bytes: usize) -> Option<()> {
        self.check(bytes)?;
        self.kept = self.kept.saturating_add(bytes);
        Some(())
    }

    /// Takes the memory of numbers that are not those in the file.
    fn keep_own(&mut self, numbers: &Numbers<'_>) -> Option<()> {
        match numbers {
            Numbers::File(_) => Some(()),
            Numbers::Own(own) => self.keep(own.len()),
        }
    }

    fn times(&mut self, array: &Array<'a>) -> Option<Numbers<'a>> {
        if let Some(times) = self.times.get(array.bytes).filter(|_| array.is_packed) {
            return (times.len() == 8 * array.count).then(|| Numbers::Own(Arc::clone(times)));
        }
        let times = self.numbers(array, size_of::<i64>())?;
        if let Numbers::Own(own) = &times {
            self.keep(own.len())?;
            self.times.insert(array.bytes, Arc::clone(own));
        }
        Some(times)
    }

    /// Returns the numbers of an array, of `size` bytes each. Their memory is not taken yet.
    fn numbers(&mut self, array: &Array<'a>, size: usize) -> Option<Numbers<'a>> {
        self.check(unpacked_bytes(array, size)?)?;
        unpacked(array, size)
    }
}
