//! A transition of a graph, by clips and frames: `0:52-3:14`.

use super::Misread;
use segue_motion::graph::Place;

pub(super) fn read(text: &str) -> Result<Option<[Place; 2]>, Misread> {
    if text.trim().is_empty() {
        return Ok(None);
    }
    let place = |text: &str| {
        let (clip, frame) = text.split_once(':')?;
        Some(Place { clip: clip.trim().parse().ok()?, frame: frame.trim().parse().ok()? })
    };
    let ends = text.split_once('-').and_then(|(leave, enter)| Some([place(leave)?, place(enter)?]));
    ends.map(Some).ok_or_else(|| Misread::Text {
        found: text.to_owned(),
        expected: "the clip and the frame that are left and those that are entered, as in 0:52-3:14",
    })
}

#[expect(clippy::ref_option, reason = "writers of all lists take a reference to their value")]
pub(super) fn write(jump: &Option<[Place; 2]>) -> String {
    jump.as_ref().map_or_else(String::new, |[leave, enter]| {
        format!("{}:{}-{}:{}", leave.clip, leave.frame, enter.clip, enter.frame)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn jump_reads_back_as_written() {
        assert_eq!(write(&read("0:52-3:14").unwrap()), "0:52-3:14");
        assert_eq!(read(" "), Ok(None));
        for bad in ["0:52", "0:52-3", "0:52-3:-1", "a:1-b:2"] {
            assert!(read(bad).unwrap_err().to_string().contains(&format!("`{bad}`")));
        }
    }
}
