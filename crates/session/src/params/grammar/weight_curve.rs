//! A weight over the course of a blend, in per cent of the blend and of B: `0-0,50-100`.

use super::{Misread, frame_pairs};

pub(super) fn read(text: &str) -> Result<Vec<(usize, usize)>, Misread> {
    frame_pairs::read(text, 100, "per cent of the blend and of B, as in 50-100")
}

pub(super) use super::frame_pairs::write;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn weight_beyond_all_of_b_is_named() {
        assert_eq!(read("0-0,100-100"), Ok(vec![(0, 0), (100, 100)]));
        assert!(read("0-101").unwrap_err().to_string().contains("`0-101`"));
    }
}
