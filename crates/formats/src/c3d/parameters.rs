//! The parameter section: groups, and their parameters by name.

use super::BLOCK;
use super::numbers::Processor;
use std::collections::BTreeMap;

/// A parameter: its type and its bytes, which are inside the file.
#[derive(Clone, Copy, Debug)]
pub(super) struct Parameter<'a> {
    /// −1 text, 1 bytes, 2 integers, 4 floats.
    kind: i8,
    /// The first dimension: the length of a text.
    width: usize,
    bytes: &'a [u8],
    processor: Processor,
}

impl Parameter<'_> {
    /// Returns the numbers of a parameter; empty for text. With `unsigned`, integers are unsigned,
    /// as frame counts are.
    fn numbers(&self, unsigned: bool) -> Vec<f64> {
        match self.kind {
            1 => self.bytes.iter().map(|byte| f64::from(*byte)).collect(),
            2 => self
                .bytes
                .chunks_exact(2)
                .filter_map(|pair| pair.try_into().ok())
                .map(|pair| {
                    if unsigned {
                        f64::from(self.processor.u16(pair))
                    } else {
                        f64::from(self.processor.i16(pair))
                    }
                })
                .collect(),
            4 => self
                .bytes
                .chunks_exact(4)
                .filter_map(|four| four.try_into().ok())
                .map(|four| f64::from(self.processor.f32(four)))
                .collect(),
            _ => Vec::new(),
        }
    }

    /// Returns the texts of a parameter, without trailing spaces.
    fn texts(&self) -> Vec<String> {
        if self.kind != -1 || self.width == 0 {
            return Vec::new();
        }
        let text = |bytes: &[u8]| {
            let (text, _) = crate::text::name(bytes);
            text.trim_matches(|c: char| c.is_whitespace() || c == '\0').to_owned()
        };
        self.bytes.chunks(self.width).map(text).collect()
    }
}

/// The parameters of a file by `GROUP:NAME`, in capitals.
#[derive(Debug, Default)]
pub(super) struct Parameters<'a> {
    by_name: BTreeMap<String, Parameter<'a>>,
}

impl<'a> Parameters<'a> {
    /// Reads the section at the offset `start`, up to the first damaged entry.
    pub(super) fn read(bytes: &'a [u8], start: usize, processor: Processor) -> Self {
        // Some programs write a wrong number of blocks, so the links between parameters decide
        // where the section ends.
        let section = bytes.get(start + 4..).unwrap_or_default();
        let mut groups: BTreeMap<i8, String> = BTreeMap::new();
        let mut members: Vec<(i8, String, Parameter<'a>)> = Vec::new();
        let mut at = 0;
        while let Some(entry) = Entry::at(section, at, processor) {
            let name = crate::text::name(entry.name).0.trim().to_ascii_uppercase();
            if entry.group < 0 {
                groups.insert(-entry.group.max(-i8::MAX), name);
            } else if let Some(parameter) = entry.parameter(processor) {
                members.push((entry.group, name, parameter));
            }
            match entry.next {
                // Offsets increase from entry to entry, so the loop terminates.
                Some(next) if next > at => at = next,
                _ => break,
            }
        }
        let mut by_name = BTreeMap::new();
        for (group, name, parameter) in members {
            if let Some(group) = groups.get(&group) {
                by_name.entry(format!("{group}:{name}")).or_insert(parameter);
            }
        }
        Self { by_name }
    }

    /// Returns the first number of a parameter.
    pub(super) fn number(&self, name: &str) -> Option<f64> {
        self.by_name.get(name)?.numbers(false).first().copied()
    }

    /// Returns the first number of a parameter with unsigned integers.
    pub(super) fn count(&self, name: &str) -> Option<f64> {
        self.by_name.get(name)?.numbers(true).first().copied()
    }

    /// Returns a number of frames: one float, one integer, or two integers of 16 bits, the lower
    /// first.
    pub(super) fn frame(&self, name: &str) -> Option<f64> {
        match self.by_name.get(name)?.numbers(true).as_slice() {
            [low, high, ..] => Some(low + high * 65536.0),
            [one] => Some(*one),
            [] => None,
        }
    }

    /// Returns a text.
    pub(super) fn text(&self, name: &str) -> Option<String> {
        self.by_name.get(name)?.texts().into_iter().next().filter(|text| !text.is_empty())
    }

    /// Returns the texts of a parameter, and of those that continue it: `LABELS`, `LABELS2`, ….
    pub(super) fn texts(&self, name: &str) -> Vec<String> {
        let mut all = Vec::new();
        for number in 1.. {
            let own = if number == 1 { name.to_owned() } else { format!("{name}{number}") };
            match self.by_name.get(&own) {
                Some(parameter) => all.extend(parameter.texts()),
                None => break,
            }
        }
        all
    }
}

/// A group or a parameter in the section.
struct Entry<'a> {
    /// Negative for a group, positive for a parameter of that group.
    group: i8,
    name: &'a [u8],
    /// The bytes after the name and the offset of the next entry.
    data: &'a [u8],
    /// The offset of the next entry; `None` for the last.
    next: Option<usize>,
}

impl<'a> Entry<'a> {
    fn at(section: &'a [u8], at: usize, processor: Processor) -> Option<Self> {
        let length = usize::from((*section.get(at)? as i8).unsigned_abs());
        let group = *section.get(at + 1)? as i8;
        if length == 0 || group == 0 {
            return None;
        }
        let link = at + 2 + length;
        let name = section.get(at + 2..link)?;
        let distance = usize::from(processor.u16_at(section, link)?);
        Some(Self {
            group,
            name,
            data: section.get(link + 2..)?,
            next: (distance > 0).then_some(link + distance),
        })
    }

    fn parameter(&self, processor: Processor) -> Option<Parameter<'a>> {
        let kind = *self.data.first()? as i8;
        let dimensions = usize::from(*self.data.get(1)?);
        let sizes = self.data.get(2..2 + dimensions)?;
        let mut count = 1_usize;
        for size in sizes {
            count = count.checked_mul(usize::from(*size))?;
        }
        let bytes = count.checked_mul(usize::from(kind.unsigned_abs()))?;
        let rest = self.data.get(2 + dimensions..)?;
        Some(Parameter {
            kind,
            width: sizes.first().map_or(1, |size| usize::from(*size)),
            // A truncated section ends inside a parameter.
            bytes: rest.get(..bytes).unwrap_or(rest),
            processor,
        })
    }
}

/// Returns the offset of the parameter section: the one in the header, otherwise the end of the
/// header.
pub(super) fn section_start(bytes: &[u8]) -> usize {
    usize::from(bytes.first().copied().unwrap_or(2).max(1)).saturating_sub(1) * BLOCK
}
