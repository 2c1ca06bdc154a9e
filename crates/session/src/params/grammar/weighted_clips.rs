//! Clips and their weights: `0.3:run,0.2:fast_walk`.

use super::clip_ids::{all_parts, read_id, write_id};
use super::{Misread, entries, joined};

/// The greatest number of clips that join A and B in a blend.
pub const MAX_WEIGHTED_CLIPS: usize = 6;

pub(super) fn read(text: &str) -> Result<Vec<(String, f64)>, Misread> {
    let parts = all_parts(text)?.into_iter().map(str::trim).filter(|part| !part.is_empty());
    entries(parts, MAX_WEIGHTED_CLIPS, "a weight from 0 to 1 and a clip, as in 0.3:run", |entry| {
        let (weight, id) = entry.split_once(':')?;
        let weight: f64 = weight.trim().parse().ok()?;
        let id = id.trim();
        ((0.0..=1.0).contains(&weight) && !id.is_empty()).then(|| (read_id(id), weight.abs()))
    })
}

pub(super) fn write(clips: &[(String, f64)]) -> String {
    joined(clips, |(id, weight)| format!("{weight}:{}", write_id(id)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn weighted_clips_read_back_as_written() {
        let clips = vec![
            ("blend(a:my%2C walk.bvh,b:run)".to_owned(), 0.25),
            ("a, b: c~0a1b2c3d".to_owned(), 1.0),
            ("run".to_owned(), 0.125),
        ];
        assert_eq!(read(&write(&clips)), Ok(clips));
        for text in ["0.3:run,0.2:fast_walk", "1:blend(a:walk,b:run)", "0.05:a%2C b"] {
            assert_eq!(write(&read(text).unwrap()), text);
        }
    }

    #[test]
    fn invalid_weighted_clip_is_named() {
        for bad in ["run", "2:run", "x:run", "0.5:", "NaN:run", "-1:run"] {
            let error = read(&format!("0.5:walk,{bad}")).unwrap_err().to_string();
            assert!(error.starts_with(&format!("entry 2: found `{bad}`")), "{error}");
        }
        assert!(read("0.1:run(").is_err());
        assert!(read(&["0.1:run"; 7].join(",")).unwrap_err().to_string().contains("6 at most"));
    }
}
