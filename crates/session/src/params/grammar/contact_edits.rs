//! Contacts that are corrected by hand: `walk:L12-30;-R40-52,run:R3-9`. `L` and `R` are the feet of
//! a body on two legs and the hind feet of one on four, whose forefeet are `LF` and `RF`.

use super::clip_ids::{all_parts, read_id, write_id};
use super::{Misread, entries, joined};
use segue_motion::clip::{ContactCorrection, ContactCorrections};
use segue_motion::skeleton::Foot;

/// The words for feet, by [`Foot::index`].
const FEET: [&str; 4] = ["L", "R", "LF", "RF"];
/// The greatest number of clips, and of corrections of one clip; a link with more is an accident.
const MAX_CLIPS: usize = 200;
const MAX_CORRECTIONS: usize = 1000;
/// The last frame that can be corrected.
const MAX_FRAME: usize = 1_000_000;

/// The contacts of a clip that are corrected by hand.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ClipContacts {
    /// The clip's id.
    pub clip: String,
    /// The corrections.
    pub corrections: ContactCorrections,
}

pub(super) fn read(text: &str) -> Result<Vec<ClipContacts>, Misread> {
    let parts = all_parts(text)?.into_iter().map(str::trim).filter(|part| !part.is_empty());
    let expected = "a clip, and feet with their first and last frames, as in walk:L12-30;-R40-52";
    entries(parts, MAX_CLIPS, expected, |entry| {
        let (clip, list) = entry.rsplit_once(':')?;
        let clip = clip.trim();
        let corrections: Vec<ContactCorrection> =
            list.split(';').map(|text| read_correction(text.trim())).collect::<Option<_>>()?;
        (!clip.is_empty() && corrections.len() <= MAX_CORRECTIONS).then(|| ClipContacts {
            clip: read_id(clip),
            corrections: corrections.into_iter().collect(),
        })
    })
}

fn read_correction(text: &str) -> Option<ContactCorrection> {
    let (text, planted) = text.strip_prefix('-').map_or((text, true), |text| (text, false));
    let of_foot = |(foot, word): (Foot, &str)| Some((foot, text.strip_prefix(word)?));
    // The longer words first: they begin with the shorter ones.
    let (foot, frames) = Foot::ALL.into_iter().zip(FEET).rev().find_map(of_foot)?;
    let (first, last) = frames.split_once('-')?;
    let number = |text: &str| text.trim().parse().ok().filter(|frame| *frame <= MAX_FRAME);
    let (first, last): (usize, usize) = (number(first)?, number(last)?);
    (first <= last).then(|| ContactCorrection { foot, frames: first..last + 1, planted })
}

pub(super) fn write(clips: &[ClipContacts]) -> String {
    joined(clips, |ClipContacts { clip, corrections }| {
        let written = corrections.list().iter().map(|correction| {
            let sign = if correction.planted { "" } else { "-" };
            let foot = FEET[correction.foot.index()];
            let frames = &correction.frames;
            format!("{sign}{foot}{}-{}", frames.start, frames.end - 1)
        });
        format!("{}:{}", write_id(clip), written.collect::<Vec<_>>().join(";"))
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use segue_motion::skeleton::Side;

    #[test]
    fn contact_edits_read_back_as_written() {
        for text in [
            "walk:L12-30;-R40-52,run:R3-3",
            "blend(a:walk,b:run):L0-9",
            "fox:L1-2;-LF3-4;RF5-6;-R7-8",
            "a%2C b%3A c~0a1b2c3d:-L1000000-1000000",
        ] {
            assert_eq!(write(&read(text).unwrap()), text);
        }
        let [walk] = &read(" walk : L1-2 ; -R3-4 ").unwrap()[..] else { panic!("one clip") };
        assert_eq!((walk.clip.as_str(), walk.corrections.list().len()), ("walk", 2));
        assert_eq!(walk.corrections.planted(Side::Left, 2), Some(true));
        assert_eq!(walk.corrections.planted(Side::Left, 3), None);
        assert_eq!(walk.corrections.planted(Side::Right, 4), Some(false));
        assert_eq!(read(" "), Ok(vec![]));
    }

    #[test]
    fn invalid_contact_edit_is_named() {
        for bad in [
            "walk",
            "walk:",
            "walk:L",
            "walk:L1",
            "walk:L3-1",
            "walk:X1-2",
            "walk:F1-2",
            "walk:FL1-2",
            "walk:L1-2;",
            "walk:--L1-2",
            ":L1-2",
            "walk:L1-1000001",
            "walk:L1-2;é",
            "walk:L-1-2",
        ] {
            let error = read(&format!("run:L0-1,{bad}")).unwrap_err().to_string();
            assert!(error.starts_with(&format!("entry 2: found `{bad}`")), "{error}");
        }
        assert!(read("walk(:L0-1").is_err());
        let many = format!("walk:{}", vec!["L1-2"; MAX_CORRECTIONS + 1].join(";"));
        assert!(read(&many).is_err());
    }
}
