//! The header of an array: its type, order and shape, written as a Python dictionary.

use crate::error::Fault;
use segue_text::{Message, msg};

/// The first bytes of a `.npy` file.
const MAGIC: &[u8] = b"\x93NUMPY";

/// The greatest number of dimensions, that of `NumPy`.
const MAX_DIMENSIONS: usize = 64;

/// The greatest depth of lists in a header: a structured type has two.
const MAX_DEPTH: usize = 8;

/// The type of an array's elements.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Dtype {
    pub(super) kind: ElementKind,
    /// The number of bytes of an element.
    pub(super) size: usize,
    pub(super) big_endian: bool,
}

/// The kind of an element.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum ElementKind {
    Bool,
    Int,
    Uint,
    Float,
    /// Characters of four bytes, padded with zeros.
    Unicode,
    /// Characters of one byte, padded with zeros.
    Bytes,
    /// Pickled Python objects.
    Object,
}

impl Dtype {
    /// Returns the type of a code such as `<f4`.
    pub(super) fn parse(code: &str) -> Option<Self> {
        let (big_endian, rest) = match code.as_bytes().first()? {
            b'>' => (true, code.get(1..)?),
            b'<' | b'|' | b'=' => (false, code.get(1..)?),
            _ => (false, code),
        };
        let kind = match rest.get(..1)? {
            "b" | "?" => ElementKind::Bool,
            "i" => ElementKind::Int,
            "u" => ElementKind::Uint,
            "f" => ElementKind::Float,
            "U" => ElementKind::Unicode,
            "S" | "a" => ElementKind::Bytes,
            "O" => ElementKind::Object,
            _ => return None,
        };
        let count = match rest.get(1..)? {
            "" if kind == ElementKind::Bool => 1,
            "" if kind == ElementKind::Object => 8,
            digits => digits.parse::<usize>().ok()?,
        };
        let size = if kind == ElementKind::Unicode { count.checked_mul(4)? } else { count };
        let is_known = match kind {
            ElementKind::Bool => size == 1,
            ElementKind::Int | ElementKind::Uint => matches!(size, 1 | 2 | 4 | 8),
            ElementKind::Float => matches!(size, 2 | 4 | 8),
            _ => true,
        };
        is_known.then_some(Self { kind, size, big_endian })
    }

    /// Returns whether the elements are numbers.
    pub(super) fn is_number(self) -> bool {
        matches!(
            self.kind,
            ElementKind::Bool | ElementKind::Int | ElementKind::Uint | ElementKind::Float
        )
    }
}

/// The header of an array.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Header {
    pub(super) dtype: Dtype,
    /// Whether the first index runs fastest.
    pub(super) fortran: bool,
    pub(super) shape: Vec<usize>,
    /// The place of the first element.
    pub(super) data_at: usize,
}

/// Returns whether the bytes start as those of a `.npy` file.
pub(crate) fn is_npy(bytes: &[u8]) -> bool {
    bytes.starts_with(MAGIC)
}

impl Header {
    /// Reads the header of versions 1 to 3.
    pub(super) fn read(bytes: &[u8]) -> Result<Self, Fault> {
        let broken = |found: &'static str| {
            Fault::new(0, Message::word(found), "the header of a NumPy array")
        };
        if !is_npy(bytes) {
            return Err(broken("no NumPy array"));
        }
        let cut_off = || broken("a NumPy array that was cut off");
        let version = *bytes.get(MAGIC.len()).ok_or_else(cut_off)?;
        let length_at = MAGIC.len() + 2;
        let (text_at, length) = match version {
            1 => {
                let b = bytes.get(length_at..length_at + 2).ok_or_else(cut_off)?;
                (length_at + 2, usize::from(b[0]) | usize::from(b[1]) << 8)
            }
            2 | 3 => {
                let b = bytes.get(length_at..length_at + 4).ok_or_else(cut_off)?;
                let length = b.iter().rev().fold(0, |sum, byte| sum << 8 | usize::from(*byte));
                (length_at + 4, length)
            }
            _ => {
                let found = msg!("a NumPy array of version {version}", version);
                return Err(Fault::new(0, found, "a NumPy array of version 1, 2 or 3"));
            }
        };
        let data_at = text_at.checked_add(length).ok_or_else(cut_off)?;
        let text = String::from_utf8_lossy(bytes.get(text_at..data_at).ok_or_else(cut_off)?);
        let mut parser = Parser { rest: &text };
        let Some(Literal::Dictionary(items)) = parser.literal(0) else {
            return Err(broken("a header that cannot be read"));
        };
        let item = |key: &str| items.iter().find(|(own, _)| own == key).map(|(_, value)| value);
        let dtype = match item("descr") {
            Some(Literal::Text(code)) => Dtype::parse(code).ok_or_else(|| {
                let found = msg!("a NumPy array of type {code}", code = code.clone());
                Fault::new(0, found, "an array of numbers")
            })?,
            Some(Literal::List(_)) => return Err(broken("a NumPy array of records")),
            _ => return Err(broken("a header that cannot be read")),
        };
        let Some(Literal::Bool(fortran)) = item("fortran_order") else {
            return Err(broken("a header that cannot be read"));
        };
        let Some(Literal::List(sizes)) = item("shape") else {
            return Err(broken("a header that cannot be read"));
        };
        let size = |literal: &Literal| match literal {
            Literal::Number(size) => usize::try_from(*size).ok(),
            _ => None,
        };
        let shape: Option<Vec<usize>> = sizes.iter().map(size).collect();
        let shape = shape
            .filter(|shape| shape.len() <= MAX_DIMENSIONS)
            .ok_or_else(|| broken("a header that cannot be read"))?;
        Ok(Self { dtype, fortran: *fortran, shape, data_at })
    }
}

/// A Python literal, as far as headers have them.
#[derive(Debug)]
enum Literal {
    Text(String),
    Number(u64),
    Bool(bool),
    /// A list or a tuple.
    List(Vec<Literal>),
    Dictionary(Vec<(String, Literal)>),
}

struct Parser<'a> {
    rest: &'a str,
}

impl Parser<'_> {
    fn literal(&mut self, depth: usize) -> Option<Literal> {
        if depth > MAX_DEPTH {
            return None;
        }
        self.skip_space();
        match self.rest.chars().next()? {
            quote @ ('\'' | '"') => self.text(quote).map(Literal::Text),
            '(' => self.list(')', depth).map(Literal::List),
            '[' => self.list(']', depth).map(Literal::List),
            '{' => self.dictionary(depth),
            'T' => self.take("True").then_some(Literal::Bool(true)),
            'F' => self.take("False").then_some(Literal::Bool(false)),
            c if c.is_ascii_digit() => {
                let digits = self.rest.bytes().take_while(u8::is_ascii_digit).count();
                let (number, rest) = self.rest.split_at_checked(digits)?;
                let number = number.parse().ok()?;
                // Python 2 wrote long numbers with an L.
                self.rest = rest.strip_prefix('L').unwrap_or(rest);
                Some(Literal::Number(number))
            }
            _ => None,
        }
    }

    fn text(&mut self, quote: char) -> Option<String> {
        let inside = self.rest.get(1..)?;
        let end = inside.find(quote)?;
        let text = inside.get(..end)?.to_owned();
        self.rest = inside.get(end + 1..)?;
        Some(text)
    }

    fn list(&mut self, close: char, depth: usize) -> Option<Vec<Literal>> {
        self.rest = self.rest.get(1..)?;
        let mut items = Vec::new();
        loop {
            self.skip_space();
            if self.take_char(close) {
                return Some(items);
            }
            items.push(self.literal(depth + 1)?);
            self.skip_space();
            if !self.take_char(',') {
                return self.take_char(close).then_some(items);
            }
        }
    }

    fn dictionary(&mut self, depth: usize) -> Option<Literal> {
        self.rest = self.rest.get(1..)?;
        let mut items = Vec::new();
        loop {
            self.skip_space();
            if self.take_char('}') {
                return Some(Literal::Dictionary(items));
            }
            let Some(Literal::Text(key)) = self.literal(depth + 1) else { return None };
            self.skip_space();
            if !self.take_char(':') {
                return None;
            }
            items.push((key, self.literal(depth + 1)?));
            self.skip_space();
            if !self.take_char(',') {
                return self.take_char('}').then_some(Literal::Dictionary(items));
            }
        }
    }

    fn skip_space(&mut self) {
        self.rest = self.rest.trim_start();
    }

    fn take(&mut self, word: &str) -> bool {
        let after = self.rest.strip_prefix(word);
        self.rest = after.unwrap_or(self.rest);
        after.is_some()
    }

    fn take_char(&mut self, c: char) -> bool {
        let after = self.rest.strip_prefix(c);
        self.rest = after.unwrap_or(self.rest);
        after.is_some()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn file(version: u8, text: &str) -> Vec<u8> {
        let mut bytes = [MAGIC, &[version, 0]].concat();
        match version {
            1 => bytes.extend(u16::try_from(text.len()).unwrap().to_le_bytes()),
            _ => bytes.extend(u32::try_from(text.len()).unwrap().to_le_bytes()),
        }
        bytes.extend(text.as_bytes());
        bytes
    }

    #[test]
    fn header_of_every_version_is_read() {
        let text = "{'descr': '>f8', 'fortran_order': True, 'shape': (3, 4L, ), } \n";
        for version in [1, 2, 3] {
            let header = Header::read(&file(version, text)).unwrap();
            assert_eq!(header.shape, [3, 4]);
            assert!(header.fortran && header.dtype.big_endian && header.dtype.size == 8);
            assert_eq!(header.data_at, file(version, text).len());
        }
        let scalar = "{\"shape\": (), \"fortran_order\": False, \"descr\": \"<U6\"}";
        let header = Header::read(&file(1, scalar)).unwrap();
        assert_eq!((header.shape.len(), header.dtype.size), (0, 24));
        assert!(!header.dtype.is_number());
    }

    #[test]
    fn header_that_is_broken_is_refused() {
        let whole = "{'descr': '<f4', 'fortran_order': False, 'shape': (3,)}";
        for (text, found) in [
            ("{'descr': '<f4', 'fortran_order': False}", "cannot be read"),
            ("{'descr': '<f4', 'shape': (3,)}", "cannot be read"),
            ("{'descr': '<c8', 'fortran_order': False, 'shape': ()}", "of type <c8"),
            ("{'descr': [('a', '<f4')], 'fortran_order': False, 'shape': ()}", "of records"),
            ("{'descr': '<f4', 'fortran_order': False, 'shape': (-1,)}", "cannot be read"),
            (&format!("{}{}", "[".repeat(99), whole), "cannot be read"),
        ] {
            let fault = Header::read(&file(1, text)).unwrap_err();
            assert!(fault.found.to_string().contains(found), "{fault:?}");
        }
        assert!(Header::read(&file(9, whole)).is_err());
        let bytes = file(1, whole);
        for end in 0..bytes.len() {
            assert!(Header::read(&bytes[..end]).is_err());
        }
    }

    proptest! {
        #[test]
        fn header_of_any_text_never_panics(text in "[{}()\\[\\]', :a-z0-9<>TrueFalse]{0,80}") {
            let bytes = file(2, &text);
            if let Ok(header) = Header::read(&bytes) {
                prop_assert_eq!(header.data_at, bytes.len());
            }
        }

        #[test]
        fn header_of_any_shape_is_read_back(
            shape in prop::collection::vec(0_usize..5000, 0..6),
            fortran: bool,
            code in prop::sample::select(vec!["<f4", ">f8", "|b1", "<i2", ">u8", "<U7", "|S3"]),
        ) {
            let order = if fortran { "True" } else { "False" };
            let sizes: Vec<String> = shape.iter().map(|size| format!("{size},")).collect();
            let sizes = sizes.concat();
            let text =
                format!("{{'descr': '{code}', 'fortran_order': {order}, 'shape': ({sizes}), }}");
            let header = Header::read(&file(1, &text)).unwrap();
            prop_assert_eq!(header.shape, shape);
            prop_assert_eq!(header.fortran, fortran);
            prop_assert_eq!(Some(header.dtype), Dtype::parse(code));
        }
    }
}
