//! Phases of gait cycles, and their alignment.

use crate::skeleton::Side;

/// The phases at which the feet strike and lift in a cycle that begins with the strike of the left
/// foot, in cycles.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Events {
    /// The left foot lifts, above 0 and below 1.
    pub left_lift: f64,
    /// The right foot strikes, above 0 and below 1.
    pub right_strike: f64,
    /// The right foot lifts, after its strike and less than a cycle later; above 1 if it is planted
    /// at the beginning of the cycle, as in a walk.
    pub right_lift: f64,
}

/// The alignment of two gaits in phase.
#[derive(
    Clone, Copy, Debug, Default, PartialEq, Eq, Hash, serde::Serialize, serde::Deserialize,
)]
pub enum PhaseAlignment {
    /// Strikes meet strikes and lifts meet lifts. In a walk a foot lifts after the other one
    /// struck, in a run before, so no single phase fits both legs. Each leg follows its own strikes
    /// and lifts, and the rest of the body the strikes of both feet.
    #[default]
    Feet,
    /// The whole body follows the strikes of both feet; lifts are not aligned.
    Strikes,
    /// No alignment: each cycle runs evenly, and begins with its clip. For comparison: where
    /// strikes meet swings, legs cross.
    None,
}

/// The phase that a joint follows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Part {
    Body,
    Leg(Side),
}

impl Part {
    pub(super) const ALL: [Self; 3] = [Self::Body, Self::Leg(Side::Left), Self::Leg(Side::Right)];

    pub(super) fn index(self) -> usize {
        match self {
            Self::Body => 0,
            Self::Leg(side) => 1 + side.index(),
        }
    }
}

/// The least distance between events, in cycles, even for extrapolated gaits.
const MIN_EVENT_DISTANCE: f64 = 0.05;

impl Events {
    /// The events of a blend, `share` of the way from `self` to `other`.
    ///
    /// The share is that of the second gait in the *stride*, not its weight. A blended foot moves
    /// back relative to the body by the weighted mean of both stances, and the body moves forward
    /// by the weighted mean of both strides; the foot stands still if the duration of its stance is
    /// the quotient of these.
    pub(super) fn between(&self, other: &Self, share: f64) -> Self {
        let mix = |a: f64, b: f64| a + (b - a) * share;
        let right_strike = mix(self.right_strike, other.right_strike)
            .clamp(MIN_EVENT_DISTANCE, 1.0 - MIN_EVENT_DISTANCE);
        let stance =
            mix(self.right_lift - self.right_strike, other.right_lift - other.right_strike);
        Self {
            left_lift: mix(self.left_lift, other.left_lift)
                .clamp(MIN_EVENT_DISTANCE, 1.0 - MIN_EVENT_DISTANCE),
            right_strike,
            right_lift: right_strike + stance.clamp(MIN_EVENT_DISTANCE, 1.0 - MIN_EVENT_DISTANCE),
        }
    }

    /// Returns strike and lift of a foot.
    fn stance(&self, side: Side) -> [f64; 2] {
        match side {
            Side::Left => [0.0, self.left_lift],
            Side::Right => [self.right_strike, self.right_lift],
        }
    }

    /// Returns whether a foot is planted at a phase.
    pub(super) fn planted(&self, side: Side, phase: f64) -> bool {
        let [strike, lift] = self.stance(side);
        (phase - strike).rem_euclid(1.0) < lift - strike
    }

    /// Returns the phase of a cycle with the events `self` that corresponds to `phase` of a cycle
    /// with the events `of`: linear between events, rising, and one more for every cycle.
    pub(super) fn warped(
        &self,
        of: &Self,
        phase: f64,
        part: Part,
        alignment: PhaseAlignment,
    ) -> f64 {
        let ([from, turn], [to_from, to_turn]) = match (alignment, part) {
            (PhaseAlignment::None, _) => return phase,
            (PhaseAlignment::Feet, Part::Leg(side)) => (of.stance(side), self.stance(side)),
            _ => ([0.0, of.right_strike], [0.0, self.right_strike]),
        };
        let cycle = (phase - from).floor();
        let (part, bend, to_bend) = (phase - from - cycle, turn - from, to_turn - to_from);
        let within = if part < bend {
            part * to_bend / bend
        } else {
            to_bend + (part - bend) * (1.0 - to_bend) / (1.0 - bend)
        };
        to_from + cycle + within
    }
}
