//! The joint centres of trunk, head and arms.

use super::super::Column;
use super::super::labels::Site;
use super::Centres;
use crate::skeleton::Side;
use glam::Vec3;

/// Half the width of an elbow with the radius of a marker, metres, for the same leg.
const HALF_ELBOW_M: f32 = 0.042;
/// Sines of an elbow's bend between which its axis replaces the usual one: 6° and 20°.
const BEND: (f32, f32) = (0.1, 0.35);

impl Centres<'_> {
    /// Returns the middle of the pelvis at the height of its markers, where the back begins.
    pub(in crate::points::markers) fn lumbar(&self) -> Option<Column> {
        self.has_pelvis.then(|| {
            self.column(|frame| Some(self.pelvis[frame]?.origin.midpoint(self.pelvis_back(frame)?)))
        })
    }

    fn middle(&self, front: Site, back: Site, frame: usize) -> Option<Vec3> {
        let sided = || {
            let [left, right] = Side::BOTH.map(|side| self.at(front, Some(side), frame));
            Some(left?.midpoint(right?))
        };
        let front_at = self.at(front, None, frame).or_else(sided);
        match (front_at, self.at(back, None, frame)) {
            (Some(front), Some(back)) => Some(front.midpoint(back)),
            _ => None,
        }
    }

    /// Returns the base of the neck: between clavicle and C7, otherwise between the shoulders.
    pub(in crate::points::markers) fn neck(&mut self) -> Option<Column> {
        let between_shoulders = |frame: usize| {
            let at = |side| {
                self.at(Site::Acromion, Some(side), frame)
                    .or_else(|| self.at(Site::Shoulder, Some(side), frame))
            };
            let [left, right] = Side::BOTH.map(at);
            Some(left?.midpoint(right?))
        };
        let has_both = (0..self.frames).any(|f| self.middle(Site::Clavicle, Site::C7, f).is_some());
        let neck = if has_both {
            self.column(|frame| self.middle(Site::Clavicle, Site::C7, frame))
        } else if self.places.contains_key(&(Site::Neck, None)) {
            self.column(|frame| self.at(Site::Neck, None, frame))
        } else {
            self.column(between_shoulders)
        };
        let neck = neck.iter().any(|at| at.is_finite()).then_some(neck);
        self.neck.clone_from(&neck);
        neck
    }

    /// Returns the middle of the chest: between sternum and T10, otherwise between hips and neck.
    pub(in crate::points::markers) fn chest(&self, neck: &Column) -> Column {
        let hips = self.hips();
        let has_both = (0..self.frames).any(|f| self.middle(Site::Sternum, Site::T10, f).is_some());
        self.column(|frame| {
            if has_both {
                self.middle(Site::Sternum, Site::T10, frame)
            } else {
                Some(Self::known(&hips, frame)?.lerp(Self::known(neck, frame)?, 0.6))
            }
        })
    }

    pub(in crate::points::markers) fn trunk_markers(&self) -> Vec<Column> {
        [Site::C7, Site::T10, Site::Clavicle, Site::Sternum]
            .into_iter()
            .filter(|site| self.places.contains_key(&(*site, None)))
            .map(|site| self.column(|frame| self.at(site, None, frame)))
            .collect()
    }

    pub(in crate::points::markers) fn head_markers(&self) -> Vec<Column> {
        let sided = [Site::HeadFront, Site::HeadBack, Site::Head]
            .into_iter()
            .flat_map(|site| Side::BOTH.map(|side| self.marker(site, side)));
        let middle = [Site::HeadTop, Site::Nose]
            .into_iter()
            .filter(|site| self.places.contains_key(&(*site, None)))
            .map(|site| Some(self.column(|frame| self.at(site, None, frame))));
        sided.chain(middle).flatten().collect()
    }

    /// Returns the middle of the head: its own point, otherwise the mean of its markers in the
    /// frames that show all of them.
    pub(in crate::points::markers) fn head(&self) -> Option<Column> {
        if self.places.contains_key(&(Site::Head, None)) {
            return Some(self.column(|frame| self.at(Site::Head, None, frame)));
        }
        let markers = self.head_markers();
        let count = markers.len() as f32;
        (!markers.is_empty()).then(|| {
            // NaN in one of them makes the mean a gap.
            self.column(|frame| {
                Some(markers.iter().map(|marker| marker[frame]).sum::<Vec3>() / count)
            })
        })
    }

    pub(in crate::points::markers) fn shoulder(&mut self, side: Side) -> Option<Column> {
        let acromion = |side: Side, frame: usize| {
            self.at(Site::Acromion, Some(side), frame)
                .or_else(|| self.at(Site::Shoulder, Some(side), frame))
        };
        let is_centre = !self.has_pelvis && self.places.contains_key(&(Site::Shoulder, Some(side)));
        let width = self.median(|frame| {
            Some(acromion(Side::Left, frame)?.distance(acromion(Side::Right, frame)?))
        });
        let hips = self.hips();
        let shoulder = self.column(|frame| {
            let at = acromion(side, frame)?;
            if is_centre {
                return Some(at);
            }
            let up = Self::known(self.neck.as_ref()?, frame)? - Self::known(&hips, frame)?;
            Some(at - up.try_normalize()? * (0.17 * width))
        });
        let shoulder = shoulder.iter().any(|at| at.is_finite()).then_some(shoulder);
        self.shoulders[side.index()].clone_from(&shoulder);
        shoulder
    }

    pub(in crate::points::markers) fn elbow(&mut self, side: Side) -> Option<Column> {
        let has = |site: Site| self.places.contains_key(&(site, Some(side)));
        let elbow = if !self.has_pelvis && has(Site::Elbow) {
            self.marker(Site::Elbow, side)?
        } else {
            let outer = if has(Site::ElbowLateral) { Site::ElbowLateral } else { Site::Elbow };
            let half = HALF_ELBOW_M * self.size(side) * self.units;
            self.column(|frame| {
                let outer = self.at(outer, Some(side), frame)?;
                match self.at(Site::ElbowMedial, Some(side), frame) {
                    Some(inner) => Some(outer.midpoint(inner)),
                    None => Some(outer + self.elbow_inward(side, outer, frame, half)?),
                }
            })
        };
        let elbow = elbow.iter().any(|at| at.is_finite()).then_some(elbow);
        self.elbows[side.index()].clone_from(&elbow);
        elbow
    }

    /// Returns the way from the outer side of an elbow to its centre, `half` long: along the axis
    /// about which it bends; that of a straight arm points to the body and down.
    fn elbow_inward(&self, side: Side, outer: Vec3, frame: usize, half: f32) -> Option<Vec3> {
        let shoulder = Self::known(self.shoulders[side.index()].as_ref()?, frame)?;
        let along = (outer - shoulder).try_normalize()?;
        let sign = if side == Side::Left { -1.0 } else { 1.0 };
        let pelvis = self.pelvis.get(frame).copied().flatten()?;
        let usual =
            (pelvis.left * sign - pelvis.up).reject_from_normalized(along).try_normalize()?;
        let Some(wrist) = self.wrist_at(side, frame) else { return Some(usual * half) };
        let mut inward = usual;
        // The axis follows from the centre, and the centre from the axis.
        for _ in 0..3 {
            let centre = outer + inward * half;
            let upper = (centre - shoulder).normalize_or_zero();
            let axis = upper.cross((wrist - centre).normalize_or_zero()) * -sign;
            let bent = ((axis.length() - BEND.0) / (BEND.1 - BEND.0)).clamp(0.0, 1.0);
            inward = usual.lerp(axis.normalize_or_zero(), bent).try_normalize()?;
        }
        Some(inward * half)
    }

    fn wrist_at(&self, side: Side, frame: usize) -> Option<Vec3> {
        let at = |site: Site| self.at(site, Some(side), frame);
        match (at(Site::WristRadial), at(Site::WristUlnar)) {
            (Some(radial), Some(ulnar)) => Some(radial.midpoint(ulnar)),
            _ if self.places.contains_key(&(Site::WristRadial, Some(side)))
                && self.places.contains_key(&(Site::WristUlnar, Some(side))) =>
            {
                None
            }
            (one, other) => at(Site::Wrist).or(one).or(other),
        }
    }

    pub(in crate::points::markers) fn wrist(&self, side: Side) -> Option<Column> {
        let wrist = self.column(|frame| self.wrist_at(side, frame));
        wrist.iter().any(|at| at.is_finite()).then_some(wrist)
    }
}
