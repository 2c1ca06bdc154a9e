//! Motions that nobody has made: bodies of no size that people have, roots that jump, places far
//! from everything. They are read as they are, and told.

use super::ImportOptions;
use super::measure::Measure;
use super::raw::RawMotion;
use super::warning::{Tally, WarningKind};
use glam::Vec3;

/// Bodies of another height are told, metres: from a child that sits to a man on stilts.
const LIKELY_METRES: std::ops::Range<f64> = 0.3..5.0;
/// A unit is offered that makes a body as tall as a person, metres.
const PERSON_METRES: std::ops::Range<f64> = 0.9..2.5;
/// A root that moves farther from one frame to the next is told, metres. A sprinter makes 0.4 m at
/// 30 frames per second.
const JUMP_METRES: f64 = 5.0;
/// A root that goes farther from the origin is told, metres.
const FAR_METRES: f64 = 1000.0;

/// What could be mended in how a clip was read, where that is safe.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Mendable {
    /// Metres per unit that make the body as tall as a person: the power of ten of the unit that
    /// was taken.
    pub metres_per_unit: Option<f64>,
    /// Whether the root is elsewhere in single rows, and where it was in the row after them.
    pub wild_rows: bool,
}

impl RawMotion {
    /// Tells what is unlikely of a motion that was measured, and evens out the rows in which the
    /// root is elsewhere where the options say so.
    pub(super) fn tell_unlikely(
        &mut self,
        measure: &Measure,
        options: &ImportOptions,
        tally: &mut Tally,
    ) -> Mendable {
        let mut mendable = Mendable::default();
        let metres = measure.height_metres();
        // What was said by hand is known by whoever said it.
        if options.metres_per_unit.is_none() && metres > 0.0 && !LIKELY_METRES.contains(&metres) {
            tally.add(WarningKind::UnlikelyHeight { metres }, None);
            mendable.metres_per_unit = fitting_unit(measure);
        }
        let unit = measure.provenance.metres_per_unit;
        let found = jumps(&self.root_translations, unit);
        if let Some(metres) = found.wild_metres {
            let evened = options.even_wild_rows;
            for _ in &found.wild_rows {
                tally.add(WarningKind::WildRows { metres, evened }, None);
            }
            mendable.wild_rows = !evened;
            if evened {
                for &row in &found.wild_rows {
                    even_out(&mut self.root_translations, row);
                }
            }
        }
        for _ in 0..found.others {
            let metres = found.other_metres;
            tally.add(WarningKind::RootJumps { metres }, None);
        }
        let farthest = self
            .root_translations
            .iter()
            .map(|place| place.as_dvec3().length() * unit)
            .fold(0.0, f64::max);
        if farthest > FAR_METRES {
            tally.add(WarningKind::FarAway { metres: farthest }, None);
        }
        mendable
    }
}

/// The power of ten of a unit that makes the body as tall as a person.
fn fitting_unit(measure: &Measure) -> Option<f64> {
    let unit = measure.provenance.metres_per_unit;
    // From 1.7 m, the middle of the range, it is the nearest power.
    let power = (1.7 / measure.height_metres()).log10().round();
    let fitting = unit * 10_f64.powi(power as i32);
    (fitting.is_finite()
        && fitting > 0.0
        && PERSON_METRES.contains(&(measure.height_units * fitting)))
    .then_some(fitting)
}

#[derive(Debug, Default, PartialEq)]
struct Jumps {
    /// The rows in which the root is elsewhere: it jumps there and back.
    wild_rows: Vec<usize>,
    /// The farthest of these jumps, metres.
    wild_metres: Option<f64>,
    /// How many jumps there are besides.
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
            // In the last row, too: nothing says that the root stays there. In the first one it may
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

/// Puts the root of a row between its neighbours.
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
    fn row_that_is_elsewhere_is_told_from_a_jump_that_stays() {
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

    #[test]
    fn wild_row_is_put_between_its_neighbours() {
        let mut way = walk(&[(4, 1e18), (9, 50.0)]);
        for row in [4, 9] {
            even_out(&mut way, row);
        }
        assert!((way[4] - Vec3::new(0.0, 1.0, 0.2)).length() < 1e-6);
        assert_eq!(way[9], way[8]);
    }
}
