//! Lists of pairs as links carry them: `12-30,50-71`.

/// A link with more pairs is an accident.
const MOST_PAIRS: usize = 64;

/// Reads pairs of frames of A and B that must meet: `12-30,50-71`.
pub(in crate::session) fn read_pins(text: &str) -> Result<Vec<(usize, usize)>, String> {
    read(text, "Pins", "a frame of A and one of B, as in 12-30,50-71", usize::MAX)
}

/// Reads a weight over the course of a blend: per cent of the blend and per cent of B, `0-0,50-100`.
pub(in crate::session) fn read_weights(text: &str) -> Result<Vec<(usize, usize)>, String> {
    read(text, "Weight over time", "per cent of the blend and of B, as in 0-0,50-100", 100)
}

fn read(text: &str, name: &str, expected: &str, most: usize) -> Result<Vec<(usize, usize)>, String> {
    let read = |pair: &str| {
        let (a, b) = pair.split_once('-')?;
        let number = |word: &str| word.trim().parse().ok().filter(|number: &usize| *number <= most);
        Some((number(a)?, number(b)?))
    };
    let words = text.split(',').map(str::trim).filter(|word| !word.is_empty());
    let pairs: Vec<(usize, usize)> = words
        .map(|pair| read(pair).ok_or_else(|| format!("{name}: found `{pair}`, expected {expected}.")))
        .collect::<Result<_, _>>()?;
    if pairs.len() > MOST_PAIRS {
        return Err(format!(
            "{name}: {} are more than can be kept: use at most {MOST_PAIRS}.",
            pairs.len()
        ));
    }
    Ok(pairs)
}

/// Writes pairs as the parameters `pins` and `warp_curve` hold them, as in `12-30,50-71`: in the order of the first, each once.
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
            assert!(read_pins(bad).unwrap_err().contains(&format!("`{bad}`")));
        }
        assert!(read_pins(&"1-1,".repeat(65)).is_err());
        assert_eq!(read_weights("0-0,100-100"), Ok(vec![(0, 0), (100, 100)]));
        assert!(read_weights("0-101").unwrap_err().contains("`0-101`"));
    }
}
