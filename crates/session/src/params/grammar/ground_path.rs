//! A line over the ground: x and z in metres, `0:0,1.5:4`.

use super::{Misread, joined, number_pairs};
use glam::DVec2;

pub(super) fn read(text: &str) -> Result<Vec<DVec2>, Misread> {
    let pairs = number_pairs::read(text, "x and z in metres, as in 1.5:4")?;
    Ok(pairs.into_iter().map(DVec2::from).collect())
}

pub(super) fn write(points: &[DVec2]) -> String {
    joined(points, |point| format!("{}:{}", point.x, point.y))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ground_path_reads_back_as_written() {
        for text in ["0:0,1.5:4", "0:-1.25,3.5:4"] {
            assert_eq!(write(&read(text).unwrap()), text);
        }
        let error = read("0:0,1.5").unwrap_err().to_string();
        assert_eq!(error, "entry 2: found `1.5`, expected x and z in metres, as in 1.5:4");
    }
}
