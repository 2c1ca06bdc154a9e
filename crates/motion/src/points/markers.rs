//! Joint centres from optical markers on the skin.

mod centres;
mod labels;
#[cfg(test)]
mod tests;

use super::{BodyPoint, PointKind};
use crate::skeleton::Side;
use centres::Centres;
use glam::Vec3;
use labels::{Site, places};

/// A body whose points were computed from markers, for
/// [`skeleton_from_points`](super::skeleton_from_points).
#[derive(Clone, Debug, PartialEq)]
pub struct MarkerBody {
    /// Joint centres and helpers, the hips first.
    pub points: Vec<BodyPoint>,
    /// Their positions, frame by frame, in the unit of the markers; NaN where markers are missing.
    pub positions: Vec<Vec3>,
    /// The number of markers that the body was made from.
    pub used: usize,
}

/// Returns the body that markers with known labels show: hips and at least one whole leg.
/// `positions` are those of all markers, frame by frame; not finite is a gap.
///
/// Known are Plug-in Gait and the 41 markers of Vicon and CMU (`LASI`, `LFWT`, `LKNE`, …), Helen
/// Hayes and the names of `OpenSim`'s models (`L.ASIS`, `L.Knee.Lat`, `LLFC`, …), and joint centres
/// (`LHJC`, `left_hip`, …), which pose estimators give. Letters' case, signs between words, and the
/// name of a subject before a colon do not count.
///
/// | joint | from |
/// |---|---|
/// | hip | ASIS and PSIS or sacrum: 0.33 of the pelvis' width + 7.3 mm aside, 0.30 of it + 10.9 mm down, 0.24 of its depth + 9.9 mm back (Harrington et al. 2007, "Prediction of the hip joint centre in adults, children, and patients with cerebral palsy based on magnetic resonance imaging", table 4) |
/// | knee, ankle | the middle between lateral and medial marker; with the lateral one alone half a joint's width inwards, at a right angle to the bone (Davis et al. 1991, "A gait analysis data collection and reduction technique") |
/// | shoulder | 17 % of the distance between the acromia below each (Rab et al. 2002, "A method for determination of upper extremity kinematics") |
/// | elbow, wrist | the middle between both markers; with one at the elbow, half its width inwards along the axis about which it bends |
/// | trunk, head | the middle between C7 and clavicle, between T10 and sternum; the mean of the head's markers |
#[must_use]
pub fn body_from_markers(
    labels: &[impl AsRef<str>],
    positions: &[Vec3],
    metres_per_unit: f64,
) -> Option<MarkerBody> {
    let places = places(labels);
    let has = |site: Site| Side::BOTH.map(|side| places.contains_key(&(site, Some(side))));
    let has_pelvis = has(Site::Asis) == [true; 2]
        && (has(Site::Psis) == [true; 2] || places.contains_key(&(Site::Sacrum, None)));
    let has_hips = has(Site::Hip) == [true; 2];
    let has_leg = Side::BOTH.iter().any(|side| {
        let any =
            |sites: &[Site]| sites.iter().any(|site| places.contains_key(&(*site, Some(*side))));
        any(&[Site::Knee, Site::KneeLateral]) && any(&[Site::Ankle, Site::AnkleLateral])
    });
    if !(has_pelvis || has_hips) || !has_leg || labels.is_empty() {
        return None;
    }
    let markers = labels.len();
    let frames = positions.len() / markers;
    let mut centres = Centres::new(&places, positions, markers, metres_per_unit, has_pelvis);
    let mut builder = Builder::default();
    let hips = builder.joint("Hips", None, centres.hips());
    for helper in centres.pelvis_markers() {
        builder.helper(hips, Vec3::ZERO, helper);
    }
    for side in Side::BOTH {
        leg(&mut builder, &mut centres, hips, side);
    }
    upper_body(&mut builder, &mut centres, hips);
    let used = places.len();
    Some(builder.interleaved(frames, used))
}

/// The positions of a point in all frames; NaN where it is not known.
type Column = Vec<Vec3>;

#[derive(Default)]
struct Builder {
    points: Vec<BodyPoint>,
    columns: Vec<Column>,
}

impl Builder {
    fn joint(&mut self, name: &str, parent: Option<usize>, column: Column) -> usize {
        self.points.push(BodyPoint { name: name.to_owned(), parent, kind: PointKind::Joint });
        self.columns.push(column);
        self.points.len() - 1
    }

    fn helper(&mut self, parent: usize, beside: Vec3, column: Column) {
        let kind = PointKind::Helper { beside };
        self.points.push(BodyPoint { name: String::new(), parent: Some(parent), kind });
        self.columns.push(column);
    }

    fn interleaved(self, frames: usize, used: usize) -> MarkerBody {
        let at = |frame: usize| {
            self.columns.iter().map(move |column| column.get(frame).copied().unwrap_or(Vec3::NAN))
        };
        MarkerBody { positions: (0..frames).flat_map(at).collect(), points: self.points, used }
    }
}

fn named(side: Side, part: &str) -> String {
    format!("{}{part}", if side == Side::Left { "Left" } else { "Right" })
}

fn leg(builder: &mut Builder, centres: &mut Centres<'_>, hips: usize, side: Side) {
    let outward = if side == Side::Left { Vec3::X } else { Vec3::NEG_X };
    let Some(hip) = centres.hip(side) else { return };
    let thigh = builder.joint(&named(side, "UpLeg"), Some(hips), hip);
    let Some(knee) = centres.knee(side) else { return };
    if let Some(lateral) = centres.marker(Site::KneeLateral, side) {
        builder.helper(thigh, outward, lateral);
    }
    let shin = builder.joint(&named(side, "Leg"), Some(thigh), knee);
    let Some(ankle) = centres.ankle(side) else { return };
    if let Some(lateral) = centres.marker(Site::AnkleLateral, side) {
        builder.helper(shin, outward, lateral);
    }
    let foot = builder.joint(&named(side, "Foot"), Some(shin), ankle);
    let Some(toe) = centres.toe(side) else { return };
    builder.joint(&named(side, "Toe"), Some(foot), toe);
    if let Some(heel) = centres.marker(Site::Heel, side) {
        builder.helper(foot, Vec3::ZERO, heel);
    }
}

fn upper_body(builder: &mut Builder, centres: &mut Centres<'_>, hips: usize) {
    let Some(neck) = centres.neck() else { return };
    let spine = match centres.lumbar() {
        Some(lumbar) => builder.joint("Spine", Some(hips), lumbar),
        None => hips,
    };
    let chest = builder.joint("Spine1", Some(spine), centres.chest(&neck));
    for helper in centres.trunk_markers() {
        builder.helper(chest, Vec3::ZERO, helper);
    }
    let neck = builder.joint("Neck", Some(chest), neck);
    if let Some(head) = centres.head() {
        let head = builder.joint("Head", Some(neck), head);
        let markers = centres.head_markers();
        // Two markers leave the rotation about their line open.
        if markers.len() > 2 {
            for marker in markers {
                builder.helper(head, Vec3::ZERO, marker);
            }
        }
    }
    for side in Side::BOTH {
        let Some(shoulder) = centres.shoulder(side) else { continue };
        let upper = builder.joint(&named(side, "Arm"), Some(chest), shoulder);
        let Some(elbow) = centres.elbow(side) else { continue };
        let fore = builder.joint(&named(side, "ForeArm"), Some(upper), elbow);
        let Some(wrist) = centres.wrist(side) else { continue };
        let radial = centres.marker(Site::WristRadial, side);
        if let (Some(radial), Some(_)) = (radial, centres.marker(Site::WristUlnar, side)) {
            // With palms down, the thumb's side of the wrist is in front.
            builder.helper(fore, Vec3::Z, radial);
        }
        let hand = builder.joint(&named(side, "Hand"), Some(fore), wrist);
        if let Some(finger) = centres.marker(Site::Finger, side) {
            builder.joint(&named(side, "HandMiddle"), Some(hand), finger);
        }
    }
}
