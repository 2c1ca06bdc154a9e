//! Phases of clips from foot strikes.

use crate::clip::Contacts;
use crate::math::sort::sort_by_key;
use crate::skeleton::Side;

/// Returns the phase of every frame of a clip, in cycles, by the strikes of its feet: a whole
/// number where the left foot strikes, `right_strike` (above 0 and below 1,
/// [`super::Events::right_strike`]) more where the right one does, linear between. It keeps another
/// gait in step with the clip.
///
/// Before the first strike and after the last one the phase is extrapolated. Where a foot strikes
/// twice in a row, the other one was missed and a whole cycle has passed. A foot that is planted in
/// the first frame has not struck there. `None` where there are fewer than two strikes.
#[must_use]
pub fn strike_phases(contacts: &Contacts, right_strike: f64) -> Option<Vec<f64>> {
    let strikes_of = |side: Side| {
        let stances = contacts.intervals(side).into_iter().map(|stance| stance.start);
        let phase = if side == Side::Left { 0.0 } else { right_strike };
        stances.filter(|&at| at > 0).map(move |at| (at, phase))
    };
    let mut strikes: Vec<(usize, f64)> = Side::BOTH.into_iter().flat_map(strikes_of).collect();
    sort_by_key(&mut strikes, |&(at, _)| at);
    strikes.dedup_by_key(|&mut (at, _)| at);
    for index in 1..strikes.len() {
        let (before, here) = (strikes[index - 1].1, strikes[index].1);
        let way = (here - before).rem_euclid(1.0);
        strikes[index].1 = before + if way > 1e-6 { way } else { 1.0 };
    }
    if strikes.len() < 2 {
        return None;
    }
    let phase = |frame: usize| {
        let next = strikes.partition_point(|&(at, _)| at <= frame).clamp(1, strikes.len() - 1);
        let ((from, start), (to, end)) = (strikes[next - 1], strikes[next]);
        start + (end - start) * (frame as f64 - from as f64) / (to - from) as f64
    };
    Some((0..contacts.frames()).map(phase).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn contacts(left: &[usize], right: &[usize], frames: usize) -> Contacts {
        Contacts::from_flags([left, right].map(|strikes| {
            let stands = |frame: usize| strikes.iter().any(|&at| (at..at + 4).contains(&frame));
            (0..frames).map(stands).collect()
        }))
    }

    #[test]
    fn strike_phases_at_strikes_are_whole_or_right_strike() {
        let phases = strike_phases(&contacts(&[0, 20, 42], &[10, 31], 60), 0.4).unwrap();
        assert_eq!(phases.len(), 60);
        // The foot that is planted at the beginning is not counted: the first strike is the right
        // one's.
        for (frame, phase) in
            [(10, 0.4), (20, 1.0), (31, 1.4), (42, 2.0), (0, -0.2), (15, 0.7), (53, 2.6)]
        {
            assert!((phases[frame] - phase).abs() < 1e-9, "{frame} {}", phases[frame]);
        }
        assert!(phases.windows(2).all(|pair| pair[0] < pair[1]));
    }

    #[test]
    fn strike_phases_at_a_missed_strike_advance_by_a_cycle() {
        let phases = strike_phases(&contacts(&[10, 30], &[], 40), 0.5).unwrap();
        assert!((phases[30] - phases[10] - 1.0).abs() < 1e-9);
        assert_eq!(strike_phases(&contacts(&[10], &[], 40), 0.5), None);
        // Simultaneous strikes of both feet count as one.
        assert_eq!(strike_phases(&contacts(&[10], &[10], 40), 0.5), None);
    }
}
