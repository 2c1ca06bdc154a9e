//! Writing of PNG with at most 16 colours (ISO/IEC 15948).

use crate::CorpusError;
use flate2::write::ZlibEncoder;
use flate2::{Compression, Crc};
use std::io::Write as _;

/// Returns a picture of pixels by the numbers of their colours, at most 16, as PNG.
pub(super) fn encode(
    [width, height]: [usize; 2],
    pixels: &[u8],
    palette: &[[u8; 4]],
) -> Result<Vec<u8>, CorpusError> {
    let size = |length: usize| u32::try_from(length).map_err(|_| CorpusError::TooLarge);
    let mut rows = ZlibEncoder::new(Vec::new(), Compression::best());
    for row in pixels.chunks_exact(width.max(1)).take(height) {
        // No filter: neighbours are equal, or differ by an edge.
        rows.write_all(&[0])?;
        let packed = row.chunks(2).map(|pair| (pair[0] << 4) | (pair.get(1).unwrap_or(&0) & 15));
        rows.write_all(&packed.collect::<Vec<u8>>())?;
    }
    let mut header = [size(width)?, size(height)?].map(u32::to_be_bytes).concat();
    // Four bits a pixel, a palette, and the only methods that there are.
    header.extend([4, 3, 0, 0, 0]);
    let colors: Vec<u8> = palette.iter().flat_map(|color| [color[0], color[1], color[2]]).collect();
    let opacities: Vec<u8> = palette.iter().map(|color| color[3]).collect();
    let rows = rows.finish()?;
    let mut out = b"\x89PNG\r\n\x1a\n".to_vec();
    let parts: [(&[u8; 4], &[u8]); 5] = [
        (b"IHDR", &header),
        (b"PLTE", &colors),
        (b"tRNS", &opacities),
        (b"IDAT", &rows),
        (b"IEND", &[]),
    ];
    for (kind, content) in parts {
        out.extend(size(content.len())?.to_be_bytes());
        let mut sum = Crc::new();
        for part in [kind.as_slice(), content] {
            sum.update(part);
            out.extend(part);
        }
        out.extend(sum.sum().to_be_bytes());
    }
    Ok(out)
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use flate2::read::ZlibDecoder;
    use std::io::Read as _;

    /// Reads a picture that [`encode`] wrote: its size, and the numbers of its colours.
    pub(in crate::thumbnail) fn decode(bytes: &[u8]) -> ([usize; 2], Vec<u8>) {
        let mut rest = bytes.strip_prefix(b"\x89PNG\r\n\x1a\n").expect("a PNG");
        let (mut size, mut data) = ([0; 2], Vec::new());
        while !rest.is_empty() {
            let length = u32::from_be_bytes(rest[..4].try_into().unwrap()) as usize;
            let (kind, content) = (&rest[4..8], &rest[8..8 + length]);
            let mut sum = Crc::new();
            sum.update(&rest[4..8 + length]);
            assert_eq!(rest[8 + length..12 + length], sum.sum().to_be_bytes());
            match kind {
                b"IHDR" => {
                    let number = |at: usize| content[at..at + 4].try_into().unwrap();
                    size = [0, 4].map(|at| u32::from_be_bytes(number(at)) as usize);
                    assert_eq!(content[8..], [4, 3, 0, 0, 0]);
                }
                b"IDAT" => {
                    ZlibDecoder::new(content).read_to_end(&mut data).unwrap();
                }
                _ => {}
            }
            rest = &rest[12 + length..];
        }
        let stride = size[0].div_ceil(2) + 1;
        assert_eq!(data.len(), stride * size[1]);
        let pixels = data.chunks_exact(stride).flat_map(|row| {
            assert_eq!(row[0], 0);
            let pairs = row[1..].iter().flat_map(|pair| [pair >> 4, pair & 15]);
            pairs.take(size[0]).collect::<Vec<u8>>()
        });
        (size, pixels.collect())
    }

    #[test]
    fn picture_of_odd_width_is_read_back() {
        let pixels = [0, 1, 2, 15, 14, 13, 7, 0, 7];
        let bytes = encode([3, 3], &pixels, &[[9; 4]; 16]).unwrap();
        assert_eq!(decode(&bytes), ([3, 3], pixels.to_vec()));
    }
}
