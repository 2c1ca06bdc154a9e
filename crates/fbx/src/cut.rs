//! A binary file with a part of the keys of its curves, written while it is read.

use crate::curves::{CurveFile, Pick, Piece};
use std::io::{self, Read};

/// A reader that returns the bytes of a file with only some of its keys.
pub(crate) struct Cut<'a> {
    file: &'a CurveFile<'a>,
    /// The keys of a curve, by its index.
    pick: &'a dyn Fn(usize) -> Pick,
    /// Whether meshes, materials and images are written.
    has_meshes: bool,
    ticks_per_sec: f64,
    /// The place in the file of what is written next.
    at: usize,
    /// The number of bytes that were written.
    written: u64,
    /// The next of the file's pieces.
    piece: usize,
    /// Whether the record with the objects has been closed.
    is_closed: bool,
    /// Bytes to be written.
    own: Vec<u8>,
    /// The number of them that were.
    own_at: usize,
    /// Bytes of the file to be written behind them.
    copied: &'a [u8],
}

impl<'a> Cut<'a> {
    pub(crate) fn new(
        file: &'a CurveFile<'a>,
        pick: &'a dyn Fn(usize) -> Pick,
        has_meshes: bool,
        ticks_per_sec: f64,
    ) -> Self {
        let start = crate::records::FIRST;
        Self {
            file,
            pick,
            has_meshes,
            ticks_per_sec,
            at: start,
            written: 0,
            piece: 0,
            is_closed: false,
            own: Vec::new(),
            own_at: 0,
            copied: file.bytes.get(..start).unwrap_or_default(),
        }
    }

    /// Prepares what is written next; `None` if the file is not as it was.
    fn step(&mut self) -> Option<()> {
        let file = self.file;
        self.own.clear();
        self.own_at = 0;
        if let Some(piece) = file.pieces.get(self.piece)
            && self.at == piece.place().start
        {
            self.piece += 1;
            match piece {
                Piece::Curve(place, index) => {
                    let pick = (self.pick)(*index);
                    let curve = file.curves.get(*index)?;
                    curve.write(file, &mut self.own, self.written, &pick, self.ticks_per_sec)?;
                    self.at = place.end;
                    return Some(());
                }
                Piece::MeshData(place) if !self.has_meshes => {
                    self.at = place.end;
                    return Some(());
                }
                Piece::MeshData(_) => {}
            }
        }
        if self.at == file.end {
            // Behind the last record stands the footer.
            self.copied = file.bytes.get(self.at..)?;
            self.at = file.bytes.len();
            return Some(());
        }
        if self.at == file.objects.end && !self.is_closed {
            // The end of this record is far away, so that an empty one has to close it.
            self.is_closed = true;
            self.own.resize(file.form.head(), 0);
            return Some(());
        }
        let Some(record) = file.form.record(file.bytes, self.at)? else {
            self.own.resize(file.form.head(), 0);
            self.at += file.form.head();
            self.is_closed |= self.at == file.objects.end;
            return Some(());
        };
        let end = if record.at == file.objects.at {
            file.form.far()
        } else {
            (record.end - record.at) as u64 + self.written
        };
        file.form.write_head(&mut self.own, end, record.count, record.values.len(), record.name);
        self.copied = record.values;
        self.at = record.inside;
        Some(())
    }
}

impl Read for Cut<'_> {
    fn read(&mut self, to: &mut [u8]) -> io::Result<usize> {
        loop {
            let own = self.own.get(self.own_at..).unwrap_or_default();
            let (from, is_own) = if own.is_empty() { (self.copied, false) } else { (own, true) };
            let count = from.len().min(to.len());
            if let (Some(to), Some(from)) = (to.get_mut(..count), from.get(..count))
                && count > 0
            {
                to.copy_from_slice(from);
                if is_own {
                    self.own_at += count;
                } else {
                    self.copied = self.copied.get(count..).unwrap_or_default();
                }
                self.written += count as u64;
                return Ok(count);
            }
            if to.is_empty() || self.at >= self.file.bytes.len() {
                return Ok(0);
            }
            self.step().ok_or(io::ErrorKind::InvalidData)?;
        }
    }
}
