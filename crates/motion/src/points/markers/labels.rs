//! The places on the body that the labels of markers name.

use crate::skeleton::Side;
use std::collections::BTreeMap;

/// A place on the body.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Site {
    Asis,
    Psis,
    Sacrum,
    ThighWand,
    KneeLateral,
    KneeMedial,
    AnkleLateral,
    AnkleMedial,
    Heel,
    Toe,
    ToeLateral,
    ToeMedial,
    Acromion,
    ElbowLateral,
    ElbowMedial,
    WristRadial,
    WristUlnar,
    Finger,
    Hip,
    Knee,
    Ankle,
    Shoulder,
    Elbow,
    Wrist,
    C7,
    T10,
    Clavicle,
    Sternum,
    HeadFront,
    HeadBack,
    HeadTop,
    Head,
    Nose,
    Neck,
    MidHip,
}

/// The words for places that a body has on both sides, after the letter or word for the side: of
/// Plug-in Gait and the 41 markers of Vicon Blade and the CMU database, Helen Hayes, `OpenSim`'s
/// models and C3D samples, and the joint centres of pose estimators.
const SIDED: [(Site, &[&str]); 28] = [
    (Site::Asis, &["asi", "asis", "fwt", "eias", "ias"]),
    (Site::Psis, &["psi", "psis", "bwt", "eips", "ips"]),
    (Site::ThighWand, &["thi", "thigh"]),
    (Site::KneeLateral, &["kne", "kneelat", "kneelateral", "knelat", "lfc", "fle", "lk"]),
    (Site::KneeMedial, &["kneemed", "kneemedial", "knemed", "kneein", "knein", "mfc", "fme", "mk"]),
    (Site::AnkleLateral, &["ank", "anklelat", "anklelateral", "anklat", "lmal", "fal", "la"]),
    (
        Site::AnkleMedial,
        &["anklemed", "anklemedial", "ankmed", "ankin", "mmal", "mal", "tam", "ma"],
    ),
    (Site::Heel, &["hee", "heel", "cal", "calc", "calca", "fcc"]),
    (Site::Toe, &["toe", "toetip", "bigtoe", "mt2"]),
    (Site::ToeLateral, &["mt5", "toelat", "fm5", "smalltoe", "footlateral", "footlat"]),
    (Site::ToeMedial, &["mt1", "toemed", "fm1", "footmedial", "footmed"]),
    (Site::Acromion, &["sho", "acr", "acromion", "acromium", "acro", "ac", "cai"]),
    (Site::ElbowLateral, &["elb", "elbowlat", "elblat", "lel", "hle", "epilat", "le"]),
    (Site::ElbowMedial, &["elbowmed", "elbmed", "mel", "hme", "epimed", "me"]),
    (Site::WristRadial, &["wra", "wri", "wristrad", "wristlat", "faradius", "rsp", "lw"]),
    (Site::WristUlnar, &["wrb", "wristuln", "wristulna", "wristmed", "faulna", "usp"]),
    (Site::Finger, &["fin", "hand", "finger", "hand2"]),
    (Site::Hip, &["hip", "hjc", "hipcenter", "hipcentre", "upleg"]),
    (Site::Knee, &["knee", "kjc"]),
    (Site::Ankle, &["ankle", "ajc"]),
    (Site::Shoulder, &["shoulder", "sjc"]),
    (Site::Elbow, &["elbow", "ejc"]),
    (Site::Wrist, &["wrist", "wjc"]),
    (Site::Clavicle, &["clav", "clavicle", "scl"]),
    (Site::HeadFront, &["fhd", "temple"]),
    (Site::HeadBack, &["bhd"]),
    (Site::Head, &["ear", "head"]),
    (Site::Sacrum, &["sacrum"]),
];

/// The words for places in the middle.
const MIDDLE: [(Site, &[&str]); 10] = [
    (Site::Sacrum, &["sacr", "sacral", "vsacral", "vsac", "sacrum", "s2"]),
    (Site::C7, &["c7"]),
    (Site::T10, &["t10", "t8"]),
    (Site::Clavicle, &["clav", "ij", "cla"]),
    (Site::Sternum, &["strn", "sternum", "stern", "px", "xiph"]),
    (Site::HeadTop, &["tophead", "headtop", "vertex"]),
    (Site::Head, &["head"]),
    (Site::Nose, &["nose"]),
    (Site::Neck, &["neck"]),
    (Site::MidHip, &["hips", "hip", "chip", "midhip", "pelvis"]),
];

/// The index of the marker at each place.
pub(super) type Places = BTreeMap<(Site, Option<Side>), usize>;

/// Returns the places that labels name; of several markers at one place the first.
pub(super) fn places(labels: &[impl AsRef<str>]) -> Places {
    let mut places = Places::new();
    for (index, label) in labels.iter().enumerate() {
        if let Some(place) = place(label.as_ref()) {
            places.entry(place).or_insert(index);
        }
    }
    places
}

/// Returns the place that a label names: `LASI`, `Subject:L.ASIS`, `left_asis`, `ASISl`.
fn place(label: &str) -> Option<(Site, Option<Side>)> {
    let own = label.rsplit(':').next().unwrap_or(label);
    let word: String =
        own.chars().filter(char::is_ascii_alphanumeric).map(|c| c.to_ascii_lowercase()).collect();
    if let Some((site, _)) = MIDDLE.iter().find(|(_, words)| words.contains(&word.as_str())) {
        return Some((*site, None));
    }
    let sides =
        [("left", Side::Left), ("right", Side::Right), ("l", Side::Left), ("r", Side::Right)];
    let cores = sides.into_iter().flat_map(|(mark, side)| {
        let cut = [word.strip_prefix(mark), word.strip_suffix(mark)];
        cut.into_iter().flatten().map(move |core| (core, side))
    });
    cores.into_iter().find_map(|(core, side)| {
        let (site, _) = SIDED.iter().find(|(_, words)| words.contains(&core))?;
        Some((*site, Some(side)))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn place_of_every_spelling_is_found() {
        let left = Some(Side::Left);
        let right = Some(Side::Right);
        for (label, expected) in [
            ("LASI", Some((Site::Asis, left))),
            ("Anna:RASI", Some((Site::Asis, right))),
            ("L.ASIS", Some((Site::Asis, left))),
            ("ASISr", Some((Site::Asis, right))),
            ("RLFC", Some((Site::KneeLateral, right))),
            ("LLFC", Some((Site::KneeLateral, left))),
            ("R.Knee.Med", Some((Site::KneeMedial, right))),
            ("left_knee", Some((Site::Knee, left))),
            ("LMAL", Some((Site::AnkleMedial, left))),
            ("RLMAL", Some((Site::AnkleLateral, right))),
            ("V.Sacral", Some((Site::Sacrum, None))),
            ("C7", Some((Site::C7, None))),
            ("STRN", Some((Site::Sternum, None))),
            ("LBHD", Some((Site::HeadBack, left))),
            ("RHJC", Some((Site::Hip, right))),
            ("Marker 12", None),
            ("", None),
            ("*17", None),
            ("LHipAngles", None),
        ] {
            assert_eq!(place(label), expected, "{label}");
        }
    }
}
