//! Frames of A and B that must meet: `12-30,50-71`.

use super::{Misread, frame_pairs};

pub(super) fn read(text: &str) -> Result<Vec<(usize, usize)>, Misread> {
    frame_pairs::read(text, usize::MAX, "a frame of A and one of B, as in 12-30")
}

pub(super) use super::frame_pairs::write;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pins_keep_their_order() {
        assert_eq!(read(" 50-71 , 12-30,"), Ok(vec![(50, 71), (12, 30)]));
        assert_eq!(write(&[(50, 71), (12, 30)]), "50-71,12-30");
        assert_eq!(read(" "), Ok(vec![]));
    }

    #[test]
    fn invalid_pin_is_named() {
        for bad in ["12", "12-", "a-b", "1-2-3", "-4"] {
            let error = read(&format!("1-2,{bad}")).unwrap_err().to_string();
            assert_eq!(
                error,
                format!("entry 2: found `{bad}`, expected a frame of A and one of B, as in 12-30")
            );
        }
        assert!(read(&"1-1,".repeat(65)).unwrap_err().to_string().contains("64 at most"));
    }
}
