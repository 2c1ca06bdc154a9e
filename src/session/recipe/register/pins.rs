/// A link with more pins is an accident.
const MOST_PINS: usize = 64;

/// Reads pairs of frames: `12-30,50-71`.
pub(in crate::session) fn read_pins(text: &str) -> Result<Vec<(usize, usize)>, String> {
    let read = |pin: &str| {
        let (a, b) = pin.split_once('-')?;
        Some((a.trim().parse().ok()?, b.trim().parse().ok()?))
    };
    let words = text.split(',').map(str::trim).filter(|word| !word.is_empty());
    let pins: Vec<(usize, usize)> = words
        .map(|pin| read(pin).ok_or_else(|| format!("Pins: found `{pin}`, expected a frame of A and one of B, as in 12-30,50-71.")))
        .collect::<Result<_, _>>()?;
    if pins.len() > MOST_PINS {
        return Err(format!("{} pins are more than can be kept: use at most {MOST_PINS}.", pins.len()));
    }
    Ok(pins)
}

/// Writes pins as [`read_pins`] reads them, in the order of A.
#[must_use]
pub fn write_pins(pins: &[(usize, usize)]) -> String {
    let mut pins = pins.to_vec();
    pins.sort_unstable();
    pins.dedup();
    let words: Vec<String> = pins.iter().map(|(a, b)| format!("{a}-{b}")).collect();
    words.join(",")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pins_read_back_as_written() {
        assert_eq!(read_pins(" 50-71 , 12-30,"), Ok(vec![(50, 71), (12, 30)]));
        assert_eq!(write_pins(&[(50, 71), (12, 30), (50, 71)]), "12-30,50-71");
        assert_eq!(read_pins(""), Ok(vec![]));
        for bad in ["12", "12-", "a-b", "1-2-3", "-4"] {
            assert!(read_pins(bad).unwrap_err().contains(&format!("`{bad}`")));
        }
        assert!(read_pins(&"1-1,".repeat(65)).is_err());
    }
}
