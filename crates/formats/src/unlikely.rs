//! Detection of implausible motions: bodies of a size that people do not have, joints that jump,
//! positions far from the origin or the parent joint. They are read unchanged, with a warning.

use super::ImportOptions;
use super::measure::Measure;
use super::raw::RawMotion;
use super::warning::{Tally, WarningKind};
use glam::Vec3;

/// Plausible heights of a body, metres: from a seated child to a man on stilts.
const LIKELY_METRES: std::ops::Range<f64> = 0.3..5.0;
/// Heights, metres, for which another unit is suggested.
const PERSON_METRES: std::ops::Range<f64> = 0.9..2.5;
/// A root that moves farther than this within one frame causes a warning, metres. A sprinter moves
/// 0.4 m at 30 frames per second.
const JUMP_METRES: f64 = 5.0;
/// A root farther than this from the origin causes a warning, metres.
const FAR_METRES: f64 = 1000.0;

/// Problems of an imported clip that another import can safely fix.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Mendable {
    /// Metres per unit that make the body as tall as a person: the assumed unit times a power of
    /// ten.
    pub metres_per_unit: Option<f64>,
    /// Whether a joint is far off in single rows, and back in the next one.
    pub wild_rows: bool,
}

impl RawMotion {
    /// Adds warnings about implausible values of a measured motion, and evens out single rows in
    /// which a joint is far off if the options say so.
    pub(super) fn warn_of_unlikely(
        &mut self,
        measure: &Measure,
        options: &ImportOptions,
        tally: &mut Tally,
    ) -> Mendable {
        let mut mendable = Mendable::default();
        let metres = measure.height_metres();
        // A unit that the user gave is not questioned.
        if options.metres_per_unit.is_none() && metres > 0.0 && !LIKELY_METRES.contains(&metres) {
            tally.add(WarningKind::UnlikelyHeight { metres }, None);
            mendable.metres_per_unit = fitting_unit(measure).filter(|unit| self.steps_fit(*unit));
        }
        for _ in 0..self.wild_angles.rows {
            tally.add(WarningKind::WildAngles { degrees: self.wild_angles.degrees }, None);
        }
        let unit = measure.provenance.metres_per_unit;
        let joints = &self.joints;
        let name = |joint: usize| joints.get(joint).map(|joint| joint.name.as_str());
        let others = self.tracks.iter_mut().map(|(joint, way)| (name(*joint), way));
        let ways = std::iter::once((None, &mut self.root_translations)).chain(others);
        mendable.wild_rows = warn_of_ways(ways, unit, options, tally);
        mendable
    }

    /// Returns whether half of the steps from frame to frame are at most [`JUMP_METRES`] in a unit,
    /// metres. If not, the lengths of bones and the positions disagree, and no unit fits both.
    fn steps_fit(&self, metres_per_unit: f64) -> bool {
        let tracks = self.tracks.iter().map(|(_, way)| way);
        std::iter::once(&self.root_translations).chain(tracks).all(|way| {
            let step = |pair: &[Vec3]| match pair {
                [a, b] => (b.as_dvec3() - a.as_dvec3()).length() * metres_per_unit,
                _ => 0.0,
            };
            let short = way.windows(2).filter(|pair| step(pair) <= JUMP_METRES).count();
            2 * short >= way.len().saturating_sub(1)
        })
    }
}

/// Adds warnings about the positions of joints by their names, `None` for the root, and evens out
/// single rows if the options say so. Returns whether there are such rows that were not.
fn warn_of_ways<'a>(
    ways: impl Iterator<Item = (Option<&'a str>, &'a mut Vec<Vec3>)>,
    unit: f64,
    options: &ImportOptions,
    tally: &mut Tally,
) -> bool {
    let evened = options.even_wild_rows;
    let (mut wild, mut others, mut far) = (Worst::default(), Worst::default(), Worst::default());
    for (joint, way) in ways {
        let found = jumps(way, unit);
        wild.take(found.wild_rows.len(), found.wild_metres.unwrap_or(0.0), joint);
        others.take(found.others, found.other_metres, joint);
        if evened {
            for &row in &found.wild_rows {
                even_out(way, row);
            }
        }
        let farthest = way.iter().map(|place| place.as_dvec3().length() * unit).fold(0.0, f64::max);
        far.take(usize::from(farthest > FAR_METRES), farthest, joint);
    }
    for _ in 0..wild.count {
        let (joint, metres) = wild.worst();
        tally.add(WarningKind::WildRows { joint, metres, evened }, None);
    }
    for _ in 0..others.count {
        let (joint, metres) = others.worst();
        tally.add(WarningKind::Jumps { joint, metres }, None);
    }
    if far.count > 0 {
        let (joint, metres) = far.worst();
        tally.add(WarningKind::FarAway { joint, metres }, None);
    }
    wild.count > 0 && !evened
}

/// How often something is found, and where it is worst.
#[derive(Debug, Default)]
struct Worst<'a> {
    count: usize,
    metres: f64,
    joint: Option<&'a str>,
}

impl<'a> Worst<'a> {
    /// Adds what was found at a joint.
    fn take(&mut self, count: usize, metres: f64, joint: Option<&'a str>) {
        self.count += count;
        if count > 0 && metres > self.metres {
            (self.metres, self.joint) = (metres, joint);
        }
    }

    fn worst(&self) -> (Option<String>, f64) {
        (self.joint.map(str::to_owned), self.metres)
    }
}

/// Returns the assumed unit times the power of ten that makes the body as tall as a person.
fn fitting_unit(measure: &Measure) -> Option<f64> {
    let unit = measure.provenance.metres_per_unit;
    // From 1.7 m, the middle of the range, this is the nearest power.
    let power = libm::log10(1.7 / measure.height_metres()).round();
    let fitting = unit * 10_f64.powi(power as i32);
    (fitting.is_finite()
        && fitting > 0.0
        && PERSON_METRES.contains(&(measure.height_units * fitting)))
    .then_some(fitting)
}

#[derive(Debug, Default, PartialEq)]
struct Jumps {
    /// The rows in which the root is far off: it jumps there and back.
    wild_rows: Vec<usize>,
    /// The farthest of these jumps, metres.
    wild_metres: Option<f64>,
    /// The number of jumps after which the root stays.
    others: usize,
    /// The farthest of those, metres.
    other_metres: f64,
}

fn jumps(way: &[Vec3], metres_per_unit: f64) -> Jumps {
    let distance = |from: usize, to: usize| match (way.get(from), way.get(to)) {
        (Some(a), Some(b)) => Some((b.as_dvec3() - a.as_dvec3()).length() * metres_per_unit),
        _ => None,
    };
    let mut found = Jumps::default();
    let mut row = 1;
    while let Some(metres) = distance(row - 1, row) {
        if metres > JUMP_METRES {
            // The last row counts too: nothing shows that the root stays there. The first row may
            // be a body at the origin before the motion begins.
            let is_short = |from, to| distance(from, to).is_none_or(|metres| metres <= JUMP_METRES);
            let returns =
                is_short(row - 1, row + 1) && !(row + 1 < way.len() && is_short(row, row + 1));
            if returns {
                found.wild_rows.push(row);
                found.wild_metres = Some(found.wild_metres.unwrap_or(0.0).max(metres));
                row += 1;
            } else {
                found.others += 1;
                found.other_metres = found.other_metres.max(metres);
            }
        }
        row += 1;
    }
    found
}

/// Moves the root of a row halfway between its neighbours.
fn even_out(way: &mut [Vec3], row: usize) {
    let before = row.checked_sub(1).and_then(|before| way.get(before)).copied();
    let after = way.get(row + 1).copied();
    let between = match (before, after) {
        (Some(before), Some(after)) => Some(before.midpoint(after)),
        (one, other) => one.or(other),
    };
    if let (Some(place), Some(between)) = (way.get_mut(row), between) {
        *place = between;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn walk(places: &[(usize, f32)]) -> Vec<Vec3> {
        let mut way: Vec<Vec3> =
            (0..10).map(|row| Vec3::new(0.0, 1.0, 0.05 * row as f32)).collect();
        for (row, x) in places {
            way[*row].x = *x;
        }
        way
    }

    #[test]
    fn jumps_of_one_row_are_separate_from_jumps_that_stay() {
        assert_eq!(jumps(&walk(&[]), 1.0), Jumps::default());
        let found = jumps(&walk(&[(4, 1e18)]), 1.0);
        assert_eq!((found.wild_rows, found.others), (vec![4], 0));
        assert!((found.wild_metres.unwrap() / 1e18 - 1.0).abs() < 1e-6);
        assert_eq!(jumps(&walk(&[(9, 7.0)]), 1.0).wild_rows, [9]);
        let stays = jumps(&walk(&[(7, 6.0), (8, 6.0), (9, 6.0)]), 1.0);
        assert_eq!((stays.wild_rows, stays.others), (vec![], 1));
        // The same in centimetres is no jump.
        assert_eq!(jumps(&walk(&[(4, 400.0)]), 0.01), Jumps::default());
        assert_eq!(jumps(&[], 1.0), Jumps::default());
    }

    /// As in the files of Bandai-Namco: a root at rest on the ground, and hips that move below it.
    #[test]
    fn positions_of_every_joint_are_checked() {
        let motion = || RawMotion {
            tracks: vec![(1, walk(&[(4, 1e18)])), (2, walk(&[(6, 7.0), (7, 7.0)]))],
            ..RawMotion::default()
        };
        let warned = |options: &ImportOptions, motion: &mut RawMotion| {
            let (mut tally, way) = (Tally::default(), &mut motion.tracks);
            let ways = way
                .iter_mut()
                .map(|(joint, way)| (Some(if *joint == 1 { "hips" } else { "hand" }), way));
            let mendable = warn_of_ways(ways, 1.0, options, &mut tally);
            let sentences = tally.into_warnings(b"").into_iter();
            (mendable, sentences.map(|warning| warning.to_string()).collect::<Vec<_>>())
        };
        let mut read = motion();
        let (mendable, sentences) = warned(&ImportOptions::default(), &mut read);
        assert!(mendable);
        assert!(sentences[0].contains("1 row with a joint") && sentences[0].contains("`hips`"));
        assert!(sentences[1].contains("jumps of joints") && sentences[1].contains("`hand`"));
        assert!(sentences[2].contains("`hips` goes"), "{sentences:?}");
        assert_eq!(read, motion(), "nothing is changed unasked");
        let evened = ImportOptions { even_wild_rows: true, ..ImportOptions::default() };
        let (mendable, sentences) = warned(&evened, &mut read);
        assert!(!mendable && sentences[0].contains("put between"), "{sentences:?}");
        assert!(read.tracks[0].1.iter().all(|place| place.length() < 2.0));
    }

    #[test]
    fn steps_fit_a_unit_that_keeps_most_of_them_short() {
        let of = |root: Vec<Vec3>| RawMotion { root_translations: root, ..RawMotion::default() };
        // Steps of 5 cm, in centimetres; one row is wild.
        let steps = of(walk(&[(4, 1e18)]));
        assert!(steps.steps_fit(1.0) && steps.steps_fit(90.0) && !steps.steps_fit(110.0));
        assert!(of(Vec::new()).steps_fit(1e9) && of(vec![Vec3::ONE]).steps_fit(1e9));
    }

    #[test]
    fn even_out_moves_the_root_between_its_neighbours() {
        let mut way = walk(&[(4, 1e18), (9, 50.0)]);
        for row in [4, 9] {
            even_out(&mut way, row);
        }
        assert!((way[4] - Vec3::new(0.0, 1.0, 0.2)).length() < 1e-6);
        assert_eq!(way[9], way[8]);
    }
}
