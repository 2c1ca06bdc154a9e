//! The regressions of joint centres, in the unit of the markers: pelvis and legs.

mod upper;

use super::Column;
use super::labels::{Places, Site};
use crate::math::stats;
use crate::skeleton::Side;
use glam::Vec3;

/// Half the width of a knee between its epicondyles, and of an ankle between its malleoli, with the
/// radius of a marker; metres, for a leg of [`LEG_M`] from hip to ankle.
const HALF_KNEE_M: f32 = 0.058;
const HALF_ANKLE_M: f32 = 0.044;
/// The length of an adult's leg from hip joint to ankle, metres.
const LEG_M: f32 = 0.86;
/// A marker on the thigh defines the knee's direction from this distance beside the bone on,
/// metres.
const MIN_WAND_M: f32 = 0.02;

/// The pelvis in a frame: the middle between the ASIS, and its axes to the left, up and forward.
#[derive(Clone, Copy)]
struct Pelvis {
    origin: Vec3,
    left: Vec3,
    up: Vec3,
    forward: Vec3,
}

/// The joint centres of a body.
pub(super) struct Centres<'a> {
    places: &'a Places,
    positions: &'a [Vec3],
    markers: usize,
    frames: usize,
    /// Units per metre.
    units: f32,
    /// Whether the pelvis has markers; otherwise labels name centres of joints.
    has_pelvis: bool,
    pelvis: Vec<Option<Pelvis>>,
    hips: [Option<Column>; 2],
    knees: [Option<Column>; 2],
    shoulders: [Option<Column>; 2],
    elbows: [Option<Column>; 2],
    neck: Option<Column>,
}

impl<'a> Centres<'a> {
    pub(super) fn new(
        places: &'a Places,
        positions: &'a [Vec3],
        markers: usize,
        metres_per_unit: f64,
        has_pelvis: bool,
    ) -> Self {
        let frames = positions.len() / markers.max(1);
        let mut centres = Self {
            places,
            positions,
            markers,
            frames,
            units: (1.0 / metres_per_unit) as f32,
            has_pelvis,
            pelvis: Vec::new(),
            hips: [None, None],
            knees: [None, None],
            shoulders: [None, None],
            elbows: [None, None],
            neck: None,
        };
        if has_pelvis {
            centres.pelvis = (0..frames).map(|frame| centres.pelvis_in(frame)).collect();
        }
        centres.hips = Side::BOTH.map(|side| centres.hip_centre(side));
        centres
    }

    fn at(&self, site: Site, side: Option<Side>, frame: usize) -> Option<Vec3> {
        let marker = self.places.get(&(site, side))?;
        self.positions.get(frame * self.markers + marker).copied().filter(|at| at.is_finite())
    }

    fn column(&self, value: impl Fn(usize) -> Option<Vec3>) -> Column {
        (0..self.frames).map(|frame| value(frame).unwrap_or(Vec3::NAN)).collect()
    }

    fn known(column: &Column, frame: usize) -> Option<Vec3> {
        column.get(frame).copied().filter(|at| at.is_finite())
    }

    /// Returns the positions of a marker; `None` where there is none.
    pub(super) fn marker(&self, site: Site, side: Side) -> Option<Column> {
        self.places
            .contains_key(&(site, Some(side)))
            .then(|| self.column(|frame| self.at(site, Some(side), frame)))
    }

    fn median(&self, length: impl Fn(usize) -> Option<f32>) -> f32 {
        let lengths: Vec<f32> = (0..self.frames).filter_map(length).collect();
        stats::percentile(&lengths, 0.5).unwrap_or(0.0)
    }

    fn pelvis_back(&self, frame: usize) -> Option<Vec3> {
        let [left, right] = Side::BOTH.map(|side| self.at(Site::Psis, Some(side), frame));
        left.zip(right)
            .map(|(left, right)| left.midpoint(right))
            .or_else(|| self.at(Site::Sacrum, None, frame))
    }

    fn pelvis_in(&self, frame: usize) -> Option<Pelvis> {
        let [left, right] = Side::BOTH.map(|side| self.at(Site::Asis, Some(side), frame));
        let (left, right) = (left?, right?);
        let origin = left.midpoint(right);
        let across = (left - right).try_normalize()?;
        let forward = (origin - self.pelvis_back(frame)?).reject_from_normalized(across);
        let forward = forward.try_normalize()?;
        Some(Pelvis { origin, left: across, up: forward.cross(across), forward })
    }

    fn hip_centre(&self, side: Side) -> Option<Column> {
        // A marker called `hip` beside those of the pelvis lies on the trochanter.
        if !self.has_pelvis {
            return self.marker(Site::Hip, side);
        }
        let width = self.median(|frame| {
            let [left, right] = Side::BOTH.map(|side| self.at(Site::Asis, Some(side), frame));
            Some(left?.distance(right?))
        });
        let depth = self
            .median(|frame| Some(self.pelvis[frame]?.origin.distance(self.pelvis_back(frame)?)));
        let outward = if side == Side::Left { 1.0 } else { -1.0 };
        let aside = outward * (0.33 * width + 0.0073 * self.units);
        let down = 0.30 * width + 0.0109 * self.units;
        let back = 0.24 * depth + 0.0099 * self.units;
        Some(self.column(|frame| {
            let pelvis = self.pelvis[frame]?;
            Some(pelvis.origin + pelvis.left * aside - pelvis.up * down - pelvis.forward * back)
        }))
    }

    pub(super) fn hip(&self, side: Side) -> Option<Column> {
        self.hips[side.index()].clone()
    }

    /// Returns the middle between the hip joints.
    pub(super) fn hips(&self) -> Column {
        self.column(|frame| {
            let [left, right] = [0, 1]
                .map(|side| self.hips[side].as_ref().and_then(|column| Self::known(column, frame)));
            Some(left?.midpoint(right?))
        })
    }

    pub(super) fn pelvis_markers(&self) -> Vec<Column> {
        if !self.has_pelvis {
            return Vec::new();
        }
        let sided = [Site::Asis, Site::Psis];
        let mut markers: Vec<Column> = sided
            .into_iter()
            .flat_map(|site| Side::BOTH.map(|side| self.marker(site, side)))
            .flatten()
            .collect();
        if self.places.contains_key(&(Site::Sacrum, None)) {
            markers.push(self.column(|frame| self.at(Site::Sacrum, None, frame)));
        }
        markers
    }

    /// Returns the ratio of the leg's length to that of an adult, for the widths of joints.
    fn size(&self, side: Side) -> f32 {
        let of = |site: Site, word: Site, frame: usize| {
            self.at(site, Some(side), frame).or_else(|| self.at(word, Some(side), frame))
        };
        let length = self.median(|frame| {
            let hip = Self::known(self.hips[side.index()].as_ref()?, frame)?;
            let knee = of(Site::KneeLateral, Site::Knee, frame)?;
            let ankle = of(Site::AnkleLateral, Site::Ankle, frame)?;
            Some(hip.distance(knee) + knee.distance(ankle))
        });
        let ratio = length / (LEG_M * self.units);
        if (0.3..2.0).contains(&ratio) { ratio } else { 1.0 }
    }

    /// Returns the centre of a joint of the leg: between both markers, or inwards of the lateral
    /// one.
    fn leg_joint(
        &self,
        side: Side,
        [centre, lateral, medial]: [Site; 3],
        half_m: f32,
        above: &Column,
        inward: impl Fn(usize, Vec3) -> Option<Vec3>,
    ) -> Option<Column> {
        let has = |site: Site| self.places.contains_key(&(site, Some(side)));
        if !self.has_pelvis && has(centre) {
            return self.marker(centre, side);
        }
        // Beside a pelvis with markers, a bare `knee` is the marker on its outer side.
        let outer = if has(lateral) { lateral } else { centre };
        if !has(outer) {
            return None;
        }
        let half = half_m * self.size(side) * self.units;
        Some(self.column(|frame| {
            let outer = self.at(outer, Some(side), frame)?;
            if let Some(inner) = self.at(medial, Some(side), frame) {
                return Some(outer.midpoint(inner));
            }
            let to_above = Self::known(above, frame)? - outer;
            let distance = to_above.length();
            let along = to_above.try_normalize()?;
            let inward = inward(frame, along)?.reject_from_normalized(along).try_normalize()?;
            // The centre sees the joint above and the marker at a right angle.
            let cosine = (half / distance).min(1.0);
            Some(outer + (along * cosine + inward * (1.0 - cosine * cosine).sqrt()) * half)
        }))
    }

    pub(super) fn knee(&mut self, side: Side) -> Option<Column> {
        let hip = self.hip(side)?;
        let sign = if side == Side::Left { -1.0 } else { 1.0 };
        let inward = |frame: usize, along: Vec3| {
            let wand = self.at(Site::ThighWand, Some(side), frame).and_then(|wand| {
                let outer = self
                    .at(Site::KneeLateral, Some(side), frame)
                    .or_else(|| self.at(Site::Knee, Some(side), frame))?;
                let beside = (wand - outer).reject_from_normalized(along);
                (beside.length() > MIN_WAND_M * self.units).then_some(-beside)
            });
            let across = self.pelvis.get(frame).copied().flatten().map(|pelvis| pelvis.left * sign);
            match (wand, across) {
                // A marker in front of or behind the thigh does not show its side.
                (Some(wand), Some(across)) if wand.dot(across) > 0.7 * wand.length() => Some(wand),
                (_, across) => across,
            }
        };
        let sites = [Site::Knee, Site::KneeLateral, Site::KneeMedial];
        let knee = self.leg_joint(side, sites, HALF_KNEE_M, &hip, inward);
        self.knees[side.index()].clone_from(&knee);
        knee
    }

    pub(super) fn ankle(&self, side: Side) -> Option<Column> {
        let knee = self.knees[side.index()].as_ref()?;
        let inward = |frame: usize, _: Vec3| {
            let outer = self
                .at(Site::KneeLateral, Some(side), frame)
                .or_else(|| self.at(Site::Knee, Some(side), frame))?;
            Some(Self::known(knee, frame)? - outer)
        };
        let sites = [Site::Ankle, Site::AnkleLateral, Site::AnkleMedial];
        self.leg_joint(side, sites, HALF_ANKLE_M, knee, inward)
    }

    pub(super) fn toe(&self, side: Side) -> Option<Column> {
        let at = |site: Site, frame: usize| self.at(site, Some(side), frame);
        let between =
            |frame: usize| Some(at(Site::ToeMedial, frame)?.midpoint(at(Site::ToeLateral, frame)?));
        let toes = [Site::Toe, Site::ToeMedial, Site::ToeLateral];
        let has = toes.map(|site| self.places.contains_key(&(site, Some(side))));
        match has {
            [_, true, true] => Some(self.column(between)),
            [true, ..] => self.marker(Site::Toe, side),
            [_, true, _] => self.marker(Site::ToeMedial, side),
            [.., true] => self.marker(Site::ToeLateral, side),
            _ => None,
        }
    }
}
