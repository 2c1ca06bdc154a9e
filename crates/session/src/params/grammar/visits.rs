//! Visits of clips: when to set off, seconds, and the clip's index: `12.5:3,40:0`.

use super::{Misread, joined, number_pairs};

pub(super) fn read(text: &str) -> Result<Vec<(f64, usize)>, Misread> {
    let pairs = number_pairs::read(text, "seconds and a clip's place in the list, as in 12.5:3")?;
    // Negative times become zero; `-0` too.
    Ok(pairs.into_iter().map(|(secs, clip)| (secs.max(0.0) + 0.0, clip as usize)).collect())
}

pub(super) fn write(visits: &[(f64, usize)]) -> String {
    joined(visits, |(secs, clip)| format!("{secs}:{clip}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn visits_read_back_as_written() {
        for text in ["12.5:3,40:0", "6.04:1", "40:0,12.5:3"] {
            assert_eq!(write(&read(text).unwrap()), text);
        }
        assert_eq!(read("-2:-1, 3 : 2"), Ok(vec![(0.0, 0), (3.0, 2)]));
        let error = read("1:2,soon:3").unwrap_err().to_string();
        assert!(error.starts_with("entry 2: found `soon:3`"), "{error}");
        assert!(read("1e9:2").is_err() && read("NaN:2").is_err());
    }
}
