//! Arrays as they lie in the file, and views of them.

use super::header::{Dtype, ElementKind, Header};
use crate::error::Fault;
use crate::warning::{Tally, WarningKind};
use glam::Vec3;
use segue_text::msg;
use std::borrow::Cow;

/// The greatest share of values that are not numbers; with more, a file is refused.
const MAX_SHARE_NOT_FINITE: f64 = 0.01;

/// The least size of values that are taken for faults: no unit makes a body of them.
const MAX_VALUE: f32 = 1e18;

/// An array of a file. Its elements stay as the file has them and are converted when they are read.
#[derive(Clone, Debug)]
pub(super) struct Array<'a> {
    dtype: Dtype,
    shape: Vec<usize>,
    fortran: bool,
    data: Cow<'a, [u8]>,
}

impl<'a> Array<'a> {
    /// Reads a whole `.npy` file.
    pub(super) fn read(bytes: Cow<'a, [u8]>) -> Result<Self, Fault> {
        let header = Header::read(&bytes)?;
        let data = match bytes {
            Cow::Borrowed(bytes) => Cow::Borrowed(bytes.get(header.data_at..).unwrap_or_default()),
            Cow::Owned(mut bytes) => Cow::Owned(bytes.split_off(header.data_at.min(bytes.len()))),
        };
        Self::new(header.dtype, header.shape, header.fortran, data)
    }

    /// Returns an array of a type and shape over its bytes, which may be followed by others.
    pub(super) fn new(
        dtype: Dtype,
        shape: Vec<usize>,
        fortran: bool,
        data: Cow<'a, [u8]>,
    ) -> Result<Self, Fault> {
        let count = shape.iter().try_fold(1_usize, |count, size| count.checked_mul(*size));
        let count = if shape.contains(&0) { Some(0) } else { count };
        let needed = count.and_then(|count| count.checked_mul(dtype.size));
        // Pickled objects have no size of their own.
        // Empty texts take no bytes: one is read, a long list of them is not.
        let is_bounded = dtype.size > 0 || count.is_some_and(|count| count <= 1);
        let fits = dtype.kind == ElementKind::Object
            || is_bounded && needed.is_some_and(|needed| needed <= data.len());
        if fits {
            return Ok(Self { dtype, shape, fortran, data });
        }
        let found = msg!(
            "an array of shape {shape} with {bytes} bytes",
            shape = shape_text(&shape),
            bytes = data.len()
        );
        let expected = match needed {
            Some(needed) => msg!("{needed} bytes", needed),
            None => "an array that fits into memory".into(),
        };
        Err(Fault::new(0, found, expected).with_hint("the file may be cut off: copy it again"))
    }

    /// Returns an array of a single number.
    pub(super) fn of_number(value: f64) -> Self {
        let dtype = Dtype { kind: ElementKind::Float, size: 8, big_endian: false };
        let data = Cow::Owned(value.to_le_bytes().to_vec());
        Self { dtype, shape: Vec::new(), fortran: false, data }
    }

    /// Returns an array of texts.
    pub(super) fn of_texts(texts: &[String]) -> Self {
        let widest = texts.iter().map(|text| text.chars().count()).max().unwrap_or(0);
        let mut data = Vec::with_capacity(4 * widest * texts.len());
        for text in texts {
            let padding = std::iter::repeat('\0');
            for c in text.chars().chain(padding).take(widest) {
                data.extend(u32::from(c).to_le_bytes());
            }
        }
        let dtype = Dtype { kind: ElementKind::Unicode, size: 4 * widest, big_endian: false };
        Self { dtype, shape: vec![texts.len()], fortran: false, data: Cow::Owned(data) }
    }

    pub(super) fn shape(&self) -> &[usize] {
        &self.shape
    }

    pub(super) fn is_number(&self) -> bool {
        self.dtype.is_number()
    }

    /// Returns the pickled bytes of an array of objects.
    pub(super) fn pickled(&self) -> Option<&[u8]> {
        (self.dtype.kind == ElementKind::Object).then_some(&self.data)
    }

    /// Returns a view of the whole array.
    pub(super) fn view(&self) -> View<'_> {
        let mut strides = vec![1_usize; self.shape.len()];
        let mut step = 1;
        let mut set = |axis: usize| {
            strides[axis] = step;
            step = step.saturating_mul(self.shape[axis]);
        };
        if self.fortran {
            (0..self.shape.len()).for_each(&mut set);
        } else {
            (0..self.shape.len()).rev().for_each(&mut set);
        }
        View { dtype: self.dtype, data: &self.data, first: 0, shape: self.shape.clone(), strides }
    }

    /// Returns the texts of the array in the order of its indices.
    pub(super) fn texts(&self) -> Vec<String> {
        if !matches!(self.dtype.kind, ElementKind::Unicode | ElementKind::Bytes) {
            return Vec::new();
        }
        let view = self.view();
        view.places().map(|place| view.text(place)).collect()
    }

    /// Returns the vectors of an array whose last axis has three elements; `None` for those with a
    /// value that is no number.
    pub(super) fn vectors_with_gaps(&self) -> Vec<Option<Vec3>> {
        let view = self.view();
        let values: Vec<f32> = view.places().map(|place| view.value(place) as f32).collect();
        let vectors = values.chunks_exact(3).map(Vec3::from_slice);
        vectors
            .map(|vector| {
                Some(vector).filter(|vector| vector.to_array().into_iter().all(is_usable))
            })
            .collect()
    }

    /// Returns the number of an array with a single element.
    pub(super) fn single(&self) -> Option<f64> {
        let view = self.view();
        (self.is_number() && view.len() == 1).then(|| view.value(0))
    }
}

/// Returns whether a value can be calculated with: the square of its length is finite.
fn is_usable(value: f32) -> bool {
    value.abs() < MAX_VALUE
}

/// Returns the number of elements of a shape. Sizes beside one of 0 may be of any size.
fn elements(shape: &[usize]) -> usize {
    shape.iter().fold(1, |count: usize, size| count.saturating_mul(*size))
}

/// Returns a shape as Python writes it.
pub(super) fn shape_text(shape: &[usize]) -> String {
    let sizes: Vec<String> = shape.iter().map(ToString::to_string).collect();
    format!("({})", sizes.join(", "))
}

/// A part of an array, with its axes in any order.
#[derive(Clone, Debug)]
pub(super) struct View<'a> {
    dtype: Dtype,
    data: &'a [u8],
    first: usize,
    shape: Vec<usize>,
    /// In elements.
    strides: Vec<usize>,
}

impl View<'_> {
    pub(super) fn shape(&self) -> &[usize] {
        &self.shape
    }

    /// Returns the number of elements.
    pub(super) fn len(&self) -> usize {
        elements(&self.shape)
    }

    /// Returns the part at an index of an axis, without this axis; empty where there is none.
    pub(super) fn at(&self, axis: usize, index: usize) -> Self {
        let mut part = self.clone();
        if axis >= part.shape.len() {
            return part;
        }
        let (size, stride) = (part.shape.remove(axis), part.strides.remove(axis));
        if index < size {
            part.first += index * stride;
        } else {
            part.shape = vec![0];
            part.strides = vec![1];
        }
        part
    }

    /// Returns the view with its axes in another order, which names each of them once.
    pub(super) fn reordered(&self, axes: &[usize]) -> Self {
        let mut all = axes.to_vec();
        all.sort_unstable();
        if all.into_iter().ne(0..self.shape.len()) {
            return self.clone();
        }
        Self {
            shape: axes.iter().map(|axis| self.shape[*axis]).collect(),
            strides: axes.iter().map(|axis| self.strides[*axis]).collect(),
            ..self.clone()
        }
    }

    /// Returns a range of an axis, as far as the axis goes.
    pub(super) fn part(&self, axis: usize, range: std::ops::Range<usize>) -> Self {
        let mut part = self.clone();
        if let Some(size) = part.shape.get_mut(axis) {
            let start = range.start.min(*size);
            *size = range.end.min(*size).saturating_sub(start);
            part.first += start * part.strides[axis];
        }
        part
    }

    /// Returns the numbers in the order of the indices, the last one fastest. Values that are not
    /// numbers repeat the value of the index before on the first axis.
    ///
    /// # Errors
    /// [`Fault`] when the elements are no numbers, when more than 1 % of them are not usable, and
    /// when there is no memory.
    pub(super) fn numbers(&self, tally: &mut Tally) -> Result<Vec<f32>, Fault> {
        if !self.dtype.is_number() {
            return Err(Fault::new(0, "an array of texts or objects", "an array of numbers"));
        }
        let mut numbers: Vec<f32> = Vec::new();
        numbers.try_reserve_exact(self.len()).map_err(|_| {
            let found = "an array for which there is no memory";
            Fault::new(0, found, "a motion that fits into memory")
        })?;
        let row = elements(self.shape.get(1..).unwrap_or_default());
        let mut bad = 0_usize;
        for place in self.places() {
            let value = self.value(place) as f32;
            if is_usable(value) {
                numbers.push(value);
                continue;
            }
            bad += 1;
            tally.add(WarningKind::NotFinite, None);
            let before = numbers.len().checked_sub(row).and_then(|at| numbers.get(at));
            numbers.push(before.copied().unwrap_or(0.0));
        }
        if bad as f64 > MAX_SHARE_NOT_FINITE * numbers.len() as f64 {
            let found =
                msg!("{bad} of {count} values without a number", bad, count = numbers.len());
            return Err(Fault::new(0, found, "numbers"));
        }
        Ok(numbers)
    }

    /// Returns the places of the elements in the order of the indices.
    fn places(&self) -> impl Iterator<Item = usize> + '_ {
        let mut index = vec![0_usize; self.shape.len()];
        let mut place = self.first;
        (0..self.len()).map(move |_| {
            let here = place;
            for axis in (0..index.len()).rev() {
                index[axis] += 1;
                place += self.strides[axis];
                if index[axis] < self.shape[axis] {
                    break;
                }
                place -= index[axis] * self.strides[axis];
                index[axis] = 0;
            }
            here
        })
    }

    fn element(&self, place: usize) -> &[u8] {
        let start = place * self.dtype.size;
        self.data.get(start..start + self.dtype.size).unwrap_or_default()
    }

    fn value(&self, place: usize) -> f64 {
        let mut bytes = [0_u8; 8];
        let element = self.element(place);
        let size = element.len().min(8);
        for (to, from) in bytes.iter_mut().zip(element) {
            *to = *from;
        }
        if self.dtype.big_endian {
            bytes[..size].reverse();
        }
        let bits = u64::from_le_bytes(bytes);
        let unused = 64 - 8 * size as u32;
        match (self.dtype.kind, size) {
            (ElementKind::Bool, _) => f64::from(u8::from(bits != 0)),
            (ElementKind::Int, 1..) => ((bits << unused).cast_signed() >> unused) as f64,
            (ElementKind::Uint, _) => bits as f64,
            (ElementKind::Float, 2) => half(bits as u16),
            (ElementKind::Float, 4) => f64::from(f32::from_bits(bits as u32)),
            (ElementKind::Float, 8) => f64::from_bits(bits),
            _ => f64::NAN,
        }
    }

    fn text(&self, place: usize) -> String {
        let element = self.element(place);
        let text: String = match self.dtype.kind {
            ElementKind::Unicode => (element.chunks_exact(4))
                .map(|c| {
                    let code: [u8; 4] = std::array::from_fn(|i| c[i]);
                    let code = if self.dtype.big_endian {
                        u32::from_be_bytes(code)
                    } else {
                        u32::from_le_bytes(code)
                    };
                    char::from_u32(code).unwrap_or('\u{fffd}')
                })
                .collect(),
            ElementKind::Bytes => String::from_utf8_lossy(element).into_owned(),
            _ => String::new(),
        };
        text.trim_end_matches('\0').to_owned()
    }
}

/// Returns the value of a number of half precision (IEEE 754 binary16).
fn half(bits: u16) -> f64 {
    let sign = if bits & 0x8000 == 0 { 1.0 } else { -1.0 };
    let (exponent, fraction) = (i32::from(bits >> 10 & 0x1f), f64::from(bits & 0x3ff));
    sign * match exponent {
        0 => fraction * 2.0_f64.powi(-24),
        31 if fraction == 0.0 => f64::INFINITY,
        31 => f64::NAN,
        _ => (1.0 + fraction / 1024.0) * 2.0_f64.powi(exponent - 15),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn array(code: &str, shape: &[usize], fortran: bool, data: Vec<u8>) -> Array<'static> {
        let dtype = Dtype::parse(code).unwrap();
        Array::new(dtype, shape.to_vec(), fortran, Cow::Owned(data)).unwrap()
    }

    fn numbers(view: &View<'_>) -> Vec<f32> {
        view.numbers(&mut Tally::default()).unwrap()
    }

    #[test]
    fn numbers_of_every_type_are_read() {
        for (code, data, expected) in [
            ("<f4", 1.5_f32.to_le_bytes().to_vec(), 1.5),
            (">f4", 1.5_f32.to_be_bytes().to_vec(), 1.5),
            ("<f8", (-0.25_f64).to_le_bytes().to_vec(), -0.25),
            (">f8", (-0.25_f64).to_be_bytes().to_vec(), -0.25),
            ("<f2", vec![0x00, 0xc1], -2.5),
            (">f2", vec![0x00, 0x01], 2.0_f32.powi(-24)),
            ("|b1", vec![1], 1.0),
            ("|i1", vec![0xfe], -2.0),
            ("<i2", vec![0xff, 0xff], -1.0),
            (">i4", vec![0xff, 0xff, 0xff, 0xfd], -3.0),
            ("<i8", (-7_i64).to_le_bytes().to_vec(), -7.0),
            ("|u1", vec![0xfe], 254.0),
            (">u2", vec![1, 0], 256.0),
            ("<u8", 9_u64.to_le_bytes().to_vec(), 9.0),
        ] {
            let array = array(code, &[], false, data);
            assert_eq!(array.single(), Some(f64::from(expected)), "{code}");
        }
        assert_eq!(Dtype::parse("<f16"), None);
    }

    #[test]
    fn view_of_either_order_has_the_same_elements() {
        let of = |fortran| array("|u1", &[2, 3], fortran, vec![0, 1, 2, 3, 4, 5]);
        assert_eq!(numbers(&of(false).view()), [0.0, 1.0, 2.0, 3.0, 4.0, 5.0]);
        assert_eq!(numbers(&of(true).view()), [0.0, 2.0, 4.0, 1.0, 3.0, 5.0]);
        let array = of(false);
        let view = array.view();
        assert_eq!(numbers(&view.reordered(&[1, 0])), [0.0, 3.0, 1.0, 4.0, 2.0, 5.0]);
        assert_eq!(numbers(&view.at(0, 1)), [3.0, 4.0, 5.0]);
        assert_eq!(numbers(&view.at(1, 2)), [2.0, 5.0]);
        assert_eq!(numbers(&view.part(1, 1..9)), [1.0, 2.0, 4.0, 5.0]);
        assert!(numbers(&view.at(0, 2)).is_empty());
    }

    #[test]
    fn numbers_that_are_missing_repeat_the_frame_before() {
        let with = |bad: usize| {
            let fault = |i: usize| if i.is_multiple_of(2) { f32::NAN } else { 1e30 };
            let value = |i: usize| if (2..2 + bad).contains(&i) { fault(i) } else { i as f32 };
            let data = (0..400).flat_map(|i| value(i).to_le_bytes()).collect();
            array("<f4", &[200, 2], false, data)
        };
        let mut tally = Tally::default();
        let read = with(3).view().numbers(&mut tally).unwrap();
        assert_eq!(read[..6], [0.0, 1.0, 0.0, 1.0, 0.0, 5.0]);
        assert_eq!(tally.into_warnings(b"")[0].count, 3);
        assert!(with(5).view().numbers(&mut Tally::default()).is_err());
    }

    #[test]
    fn texts_are_without_their_padding() {
        let letters =
            ["L", "R", "\0", "人", "\0", "\0"].map(|c| u32::from(c.chars().next().unwrap()));
        let data = letters.into_iter().flat_map(u32::to_be_bytes).collect();
        let unicode = array(">U3", &[2], false, data);
        assert_eq!(unicode.texts(), ["LR", "人"]);
        assert_eq!(array("|S4", &[1], false, b"ab\0\0".to_vec()).texts(), ["ab"]);
        assert_eq!(Array::of_texts(&["a".into(), "人人".into()]).texts(), ["a", "人人"]);
    }

    #[test]
    fn array_longer_than_its_bytes_is_refused() {
        let new = |code: &str, shape: &[usize]| {
            let dtype = Dtype::parse(code).unwrap();
            Array::new(dtype, shape.to_vec(), false, Cow::Owned(vec![0; 12]))
        };
        assert!(new("<f4", &[3]).is_ok() && new("<f4", &[4]).is_err());
        assert!(new("<f4", &[usize::MAX, 8]).is_err() && new("<U0", &[usize::MAX]).is_err());
        // Without elements there is nothing to read.
        let empty = new("<f4", &[0, usize::MAX, 4]).unwrap();
        assert!(numbers(&empty.view()).is_empty());
    }
}
