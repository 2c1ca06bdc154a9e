use crate::skeleton::Side;

/// When the feet meet and leave the ground in a cycle that begins with the strike of the left foot;
/// in cycles.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Events {
    /// The left foot leaves the ground, above 0 and below 1.
    pub left_lift: f64,
    /// The right foot meets the ground, above 0 and below 1.
    pub right_strike: f64,
    /// The right foot leaves it, after its strike and less than a cycle later; above 1 where it
    /// stands at the beginning of the cycle, as in a walk.
    pub right_lift: f64,
}

/// How two gaits are laid on one phase.
#[derive(
    Clone, Copy, Debug, Default, PartialEq, Eq, Hash, serde::Serialize, serde::Deserialize,
)]
pub enum PhaseAlignment {
    /// Strikes meet strikes and lifts meet lifts. In a walk a foot lifts after the other one
    /// struck, in a run before: no one phase holds for both legs. So each leg follows its own
    /// strikes and lifts, and the rest of the body the strikes of both feet.
    #[default]
    Feet,
    /// The whole body follows the strikes of both feet; lifts fall where they fall.
    Strikes,
    /// Not at all: each cycle runs evenly, and begins where its clip does. For comparison: with
    /// strikes against swings legs cross.
    None,
}

/// What a joint's phase follows.
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

/// No event comes nearer to another one than this, in cycles, however far is extrapolated.
const LEAST: f64 = 0.05;

impl Events {
    /// The events of a blend, `share` of the way from `self` to `other`.
    ///
    /// The share is that of the second gait in the *stride*, not its weight: a blended foot goes
    /// back under the body by the weighted mean of both stances' ways, and the body goes on by the
    /// weighted mean of both strides; the foot stands still if its stance takes the quotient of
    /// these.
    pub(super) fn between(&self, other: &Self, share: f64) -> Self {
        let mix = |a: f64, b: f64| a + (b - a) * share;
        let right_strike = mix(self.right_strike, other.right_strike).clamp(LEAST, 1.0 - LEAST);
        let stance =
            mix(self.right_lift - self.right_strike, other.right_lift - other.right_strike);
        Self {
            left_lift: mix(self.left_lift, other.left_lift).clamp(LEAST, 1.0 - LEAST),
            right_strike,
            right_lift: right_strike + stance.clamp(LEAST, 1.0 - LEAST),
        }
    }

    /// Strike and lift of a foot.
    fn stance(&self, side: Side) -> [f64; 2] {
        match side {
            Side::Left => [0.0, self.left_lift],
            Side::Right => [self.right_strike, self.right_lift],
        }
    }

    /// Whether a foot is on the ground at a phase.
    pub(super) fn planted(&self, side: Side, phase: f64) -> bool {
        let [strike, lift] = self.stance(side);
        (phase - strike).rem_euclid(1.0) < lift - strike
    }

    /// The phase of a cycle with the events `self` that belongs to `phase` of a cycle with the
    /// events `of`: linear between events, rising, and one more for every cycle.
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
