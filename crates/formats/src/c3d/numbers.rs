//! Numbers as the three processors write them.

/// The processor that wrote a file, as the fourth byte of the parameter section names it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Processor {
    /// Little-endian, IEEE floats.
    Intel,
    /// Little-endian, the floats of VAX and PDP-11.
    Dec,
    /// Big-endian, IEEE floats.
    Mips,
}

impl Processor {
    pub(super) fn of(byte: u8) -> Option<Self> {
        match byte {
            84 => Some(Self::Intel),
            85 => Some(Self::Dec),
            86 => Some(Self::Mips),
            _ => None,
        }
    }

    pub(super) fn u16(self, bytes: [u8; 2]) -> u16 {
        match self {
            Self::Mips => u16::from_be_bytes(bytes),
            _ => u16::from_le_bytes(bytes),
        }
    }

    pub(super) fn i16(self, bytes: [u8; 2]) -> i16 {
        self.u16(bytes) as i16
    }

    /// Returns a float. One of VAX has its two halves swapped and an exponent that is two larger,
    /// and is a quarter of the IEEE number of the same bits.
    pub(super) fn f32(self, [a, b, c, d]: [u8; 4]) -> f32 {
        match self {
            Self::Intel => f32::from_le_bytes([a, b, c, d]),
            Self::Mips => f32::from_be_bytes([a, b, c, d]),
            Self::Dec => f32::from_le_bytes([c, d, a, b]) / 4.0,
        }
    }

    /// Returns the number at an offset; `None` beyond the end.
    pub(super) fn u16_at(self, bytes: &[u8], at: usize) -> Option<u16> {
        Some(self.u16(bytes.get(at..at.checked_add(2)?)?.try_into().ok()?))
    }

    /// Returns the number at an offset; `None` beyond the end.
    pub(super) fn f32_at(self, bytes: &[u8], at: usize) -> Option<f32> {
        Some(self.f32(bytes.get(at..at.checked_add(4)?)?.try_into().ok()?))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_of_every_processor_are_the_same() {
        // 1 and -37.25 of a VAX: 0x0000_4080, 0x0000_C315.
        assert_eq!(Processor::Dec.f32([0x80, 0x40, 0, 0]), 1.0);
        assert_eq!(Processor::Dec.f32([0x15, 0xc3, 0, 0]), -37.25);
        assert_eq!(Processor::Dec.f32([0, 0, 0, 0]), 0.0);
        assert_eq!(Processor::Intel.f32([0, 0, 0x80, 0x3f]), 1.0);
        assert_eq!(Processor::Mips.f32([0x3f, 0x80, 0, 0]), 1.0);
        assert_eq!(Processor::Mips.i16([0xff, 0xfe]), -2);
        assert_eq!(Processor::Dec.i16([0xfe, 0xff]), -2);
        assert_eq!(Processor::Intel.f32_at(&[0; 3], 0), None);
        assert_eq!(Processor::Intel.u16_at(&[0; 3], usize::MAX), None);
    }
}
