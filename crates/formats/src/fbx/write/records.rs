//! The binary form of FBX, version 7.4: a tree of records with typed properties.
//!
//! A record is the place of its end, the number of its properties and their bytes (32 bits each),
//! its name, its properties, and the records in it, closed by [`NONE`]. Numbers are little-endian.
//! The form has no public specification; this is what the programs that read it agree on.

/// The version that the header and the footer state.
pub(super) const VERSION: u32 = 7400;

const MAGIC: &[u8; 23] = b"Kaydara FBX Binary  \0\x1A\0";
/// The record that ends a list of records.
const NONE: [u8; 13] = [0; 13];
/// The number that stands for [`CREATION_TIME`] at the end of the file.
const FOOTER_ID: [u8; 16] = *b"\xFA\xBC\xAB\x09\xD0\xC8\xD4\x66\xB1\x76\xFB\x83\x1C\xF7\x26\x7E";
const FOOTER_MAGIC: [u8; 16] = *b"\xF8\x5A\x8C\x6A\xDE\xF5\xD9\x7E\xEC\xE9\x0C\xE3\x75\x8F\x29\x0B";
const FOOTER_ZEROS: usize = 120;

/// The number that stands for [`CREATION_TIME`] at the beginning of the file. Programs of Autodesk
/// check that both numbers belong to the time, by a rule that is not published.
pub(super) const FILE_ID: [u8; 16] =
    *b"\x28\xB3\x2A\xEB\xB6\x24\xCC\xC2\xBF\xC8\xB0\x2A\xA9\x2B\xFC\xF1";
/// A time whose numbers are known. It is the same in all files, so that the same motion gives the
/// same bytes.
pub(super) const CREATION_TIME: &str = "1970-01-01 10:00:00:000";

/// A typed value of a record.
#[derive(Clone, Copy, Debug)]
pub(super) enum Property<'a> {
    Bool(bool),
    Int(i32),
    Long(i64),
    Double(f64),
    Text(&'a str),
    Raw(&'a [u8]),
    Ints(&'a [i32]),
    Longs(&'a [i64]),
    Floats(&'a [f32]),
}

/// A file that is written record by record.
pub(super) struct RecordWriter {
    bytes: Vec<u8>,
}

impl RecordWriter {
    /// Begins a file of about that many bytes.
    pub(super) fn new(capacity: usize) -> Self {
        let mut bytes = Vec::with_capacity(capacity);
        bytes.extend(MAGIC);
        bytes.extend(VERSION.to_le_bytes());
        Self { bytes }
    }

    /// Writes a record without records in it.
    pub(super) fn leaf(&mut self, name: &str, properties: &[Property<'_>]) {
        let at = self.begin(name, properties);
        self.end(at);
    }

    /// Writes a record, and with `inner` the records in it.
    pub(super) fn record(
        &mut self,
        name: &str,
        properties: &[Property<'_>],
        inner: impl FnOnce(&mut Self),
    ) {
        let at = self.begin(name, properties);
        inner(self);
        self.bytes.extend(NONE);
        self.end(at);
    }

    /// Writes the end of the file and returns its bytes; `None` if they are more than 32 bits can
    /// address.
    pub(super) fn finish(mut self) -> Option<Vec<u8>> {
        self.bytes.extend(NONE);
        self.bytes.extend(FOOTER_ID);
        self.bytes.extend([0; 4]);
        // At least one byte, up to a multiple of 16.
        let padded = (self.bytes.len() + 1).next_multiple_of(16);
        self.bytes.resize(padded, 0);
        self.bytes.extend(VERSION.to_le_bytes());
        self.bytes.extend([0; FOOTER_ZEROS]);
        self.bytes.extend(FOOTER_MAGIC);
        u32::try_from(self.bytes.len()).ok()?;
        Some(self.bytes)
    }

    /// Returns the place of the record.
    fn begin(&mut self, name: &str, properties: &[Property<'_>]) -> usize {
        let at = self.bytes.len();
        self.bytes.extend([0; 4]);
        self.bytes.extend((properties.len() as u32).to_le_bytes());
        let size_at = self.bytes.len();
        self.bytes.extend([0; 4]);
        self.bytes.push(name.len() as u8);
        self.bytes.extend(name.as_bytes());
        let first = self.bytes.len();
        for property in properties {
            self.property(*property);
        }
        let size = (self.bytes.len() - first) as u32;
        self.bytes[size_at..size_at + 4].copy_from_slice(&size.to_le_bytes());
        at
    }

    fn end(&mut self, at: usize) {
        // A file for which 32 bits are too few is refused by `finish`.
        let end = (self.bytes.len() as u32).to_le_bytes();
        self.bytes[at..at + 4].copy_from_slice(&end);
    }

    fn property(&mut self, property: Property<'_>) {
        match property {
            Property::Bool(value) => self.bytes.extend([b'C', u8::from(value)]),
            Property::Int(value) => self.scalar(b'I', value.to_le_bytes()),
            Property::Long(value) => self.scalar(b'L', value.to_le_bytes()),
            Property::Double(value) => self.scalar(b'D', value.to_le_bytes()),
            Property::Text(text) => self.counted(b'S', text.as_bytes()),
            Property::Raw(bytes) => self.counted(b'R', bytes),
            Property::Ints(values) => self.array(b'i', values.iter().map(|v| v.to_le_bytes())),
            Property::Longs(values) => self.array(b'l', values.iter().map(|v| v.to_le_bytes())),
            Property::Floats(values) => self.array(b'f', values.iter().map(|v| v.to_le_bytes())),
        }
    }

    fn scalar<const N: usize>(&mut self, code: u8, bytes: [u8; N]) {
        self.bytes.push(code);
        self.bytes.extend(bytes);
    }

    fn counted(&mut self, code: u8, bytes: &[u8]) {
        self.bytes.push(code);
        self.bytes.extend((bytes.len() as u32).to_le_bytes());
        self.bytes.extend(bytes);
    }

    /// Writes an array that is not compressed.
    fn array<const N: usize>(&mut self, code: u8, values: impl ExactSizeIterator<Item = [u8; N]>) {
        self.bytes.push(code);
        for number in [values.len() as u32, 0, (values.len() * N) as u32] {
            self.bytes.extend(number.to_le_bytes());
        }
        self.bytes.extend(values.flatten());
    }
}
