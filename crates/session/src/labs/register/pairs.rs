//! Lists of pairs as links carry them: `12-30,50-71`, `0.3:run`.

use crate::labs::LabError;
use crate::labs::recipe::{read_ids, write_ids};
use crate::outside::short;
use crate::params::format_number;

/// A link with more pairs is an accident.
const MOST_PAIRS: usize = 64;

/// Reads pairs of frames of A and B that must meet: `12-30,50-71`.
pub(crate) fn read_pins(text: &str) -> Result<Vec<(usize, usize)>, LabError> {
    read(text, "Pins", "a frame of A and one of B, as in 12-30,50-71", usize::MAX)
}

/// Reads a weight over the course of a blend: per cent of the blend and per cent of B,
/// `0-0,50-100`.
pub(crate) fn read_weights(text: &str) -> Result<Vec<(usize, usize)>, LabError> {
    read(text, "Weight over time", "per cent of the blend and of B, as in 0-0,50-100", 100)
}

/// Most clips that join A and B in a blend.
pub const MOST_ALSO: usize = 6;

/// Reads clips and their weights: `0.3:run,0.2:fast_walk`.
pub(crate) fn read_also(text: &str) -> Result<Vec<(String, f64)>, LabError> {
    let refuse = |found: &str| LabError::MoreClips { found: short(found) };
    if text.trim().is_empty() {
        return Ok(Vec::new());
    }
    let read = |pair: &str| {
        let (weight, id) = pair.split_once(':')?;
        let weight: f64 = weight.trim().parse().ok()?;
        ((0.0..=1.0).contains(&weight) && !id.is_empty()).then(|| (id.to_owned(), weight))
    };
    let pairs = read_ids(text).ok_or_else(|| refuse(text))?;
    if pairs.len() > MOST_ALSO {
        return Err(LabError::TooManyMoreClips { count: pairs.len() });
    }
    pairs.iter().map(|pair| read(pair).ok_or_else(|| refuse(pair))).collect()
}

/// Writes clips and their weights, rounded to hundredths, as the parameter `warp_also` has them.
#[must_use]
pub fn write_also(clips: &[(String, f64)]) -> String {
    let written = |(id, weight): &(String, f64)| {
        format!("{}:{}", format_number(*weight, 0.01), write_ids(std::slice::from_ref(id)))
    };
    clips.iter().map(written).collect::<Vec<_>>().join(",")
}

fn read(
    text: &str,
    what: &'static str,
    expected: &'static str,
    most: usize,
) -> Result<Vec<(usize, usize)>, LabError> {
    let read = |pair: &str| {
        let (a, b) = pair.split_once('-')?;
        let number = |word: &str| word.trim().parse().ok().filter(|number: &usize| *number <= most);
        Some((number(a)?, number(b)?))
    };
    let words = text.split(',').map(str::trim).filter(|word| !word.is_empty());
    let pairs: Vec<(usize, usize)> = words
        .map(|pair| {
            read(pair).ok_or_else(|| LabError::FramePairs { what, found: short(pair), expected })
        })
        .collect::<Result<_, _>>()?;
    if pairs.len() > MOST_PAIRS {
        return Err(LabError::TooMany { what, count: pairs.len(), most: MOST_PAIRS });
    }
    Ok(pairs)
}

/// Writes pairs as the parameters `pins` and `warp_curve` hold them, as in `12-30,50-71`: in the
/// order of the first, each once.
#[must_use]
pub fn write_pairs(pairs: &[(usize, usize)]) -> String {
    let mut pairs = pairs.to_vec();
    pairs.sort_unstable();
    pairs.dedup();
    let words: Vec<String> = pairs.iter().map(|(a, b)| format!("{a}-{b}")).collect();
    words.join(",")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pairs_read_back_as_written() {
        assert_eq!(read_pins(" 50-71 , 12-30,"), Ok(vec![(50, 71), (12, 30)]));
        assert_eq!(write_pairs(&[(50, 71), (12, 30), (50, 71)]), "12-30,50-71");
        assert_eq!(read_pins(""), Ok(vec![]));
        for bad in ["12", "12-", "a-b", "1-2-3", "-4"] {
            assert!(read_pins(bad).unwrap_err().to_string().contains(&format!("`{bad}`")));
        }
        assert!(read_pins(&"1-1,".repeat(65)).is_err());
        let also =
            vec![("blend(a:walk,b:run)".to_owned(), 0.25), ("a, b: c~0a1b2c3d".to_owned(), 1.0)];
        assert_eq!(read_also(&write_also(&also)), Ok(also));
        assert_eq!(read_also(""), Ok(vec![]));
        for bad in ["run", "2:run", "x:run", "0.5:", "NaN:run", "0.1:run("] {
            assert!(read_also(bad).is_err(), "{bad}");
        }
        assert!(
            read_also(&["0.1:run"; 7].join(",")).unwrap_err().to_string().contains("at most 6")
        );
        assert_eq!(read_weights("0-0,100-100"), Ok(vec![(0, 0), (100, 100)]));
        assert!(read_weights("0-101").unwrap_err().to_string().contains("`0-101`"));
    }
}
