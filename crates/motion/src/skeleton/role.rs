//! Sides of the body, its feet, and the roles that joints have in it.

/// One side of the body, as the character itself calls it: a character that faces +Z has its left
/// at +X.
#[derive(
    Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, serde::Serialize, serde::Deserialize,
)]
#[expect(missing_docs, reason = "the names say it")]
pub enum Side {
    Left,
    Right,
}

impl Side {
    /// Left, then right.
    pub const BOTH: [Self; 2] = [Self::Left, Self::Right];

    /// Returns the other side.
    #[must_use]
    pub const fn other(self) -> Self {
        match self {
            Self::Left => Self::Right,
            Self::Right => Self::Left,
        }
    }

    /// Returns 0 for left, 1 for right: the index into an array of two.
    #[must_use]
    pub const fn index(self) -> usize {
        self as usize
    }

    const fn pick(self, left: Role, right: Role) -> Role {
        match self {
            Self::Left => left,
            Self::Right => right,
        }
    }
}

/// The number of legs on which a body stands.
#[derive(
    Clone, Copy, Debug, Default, PartialEq, Eq, Hash, serde::Serialize, serde::Deserialize,
)]
pub enum BodyPlan {
    /// On two legs, as people and birds do.
    #[default]
    Biped,
    /// On four legs. The roles of arms are those of the forelegs, the roles of legs those of the
    /// hind legs.
    Quadruped,
}

/// The pair that a foot belongs to.
#[derive(
    Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, serde::Serialize, serde::Deserialize,
)]
pub enum FootPair {
    /// The feet of a body on two legs, and the hind feet of one on four.
    Hind,
    /// The forefeet of a body on four legs.
    Fore,
}

impl FootPair {
    /// The hind feet, then the forefeet.
    pub const BOTH: [Self; 2] = [Self::Hind, Self::Fore];
}

/// A foot that can stand on the ground.
///
/// A [`Side`] alone is a hind foot: of a body on two legs, its left or right foot.
#[derive(
    Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, serde::Serialize, serde::Deserialize,
)]
#[expect(missing_docs, reason = "the names say it")]
pub struct Foot {
    pub pair: FootPair,
    pub side: Side,
}

impl Foot {
    /// The feet of a body on four legs, each at its [`index`](Self::index): hind left, hind right,
    /// fore left, fore right. The first two are the feet of a body on two legs.
    pub const ALL: [Self; 4] = [
        Self { pair: FootPair::Hind, side: Side::Left },
        Self { pair: FootPair::Hind, side: Side::Right },
        Self { pair: FootPair::Fore, side: Side::Left },
        Self { pair: FootPair::Fore, side: Side::Right },
    ];

    /// Returns the feet of a body.
    #[must_use]
    pub const fn of(plan: BodyPlan) -> &'static [Self] {
        let (on_two, _) = Self::ALL.split_at(2);
        match plan {
            BodyPlan::Biped => on_two,
            BodyPlan::Quadruped => &Self::ALL,
        }
    }

    /// Returns the index in [`Foot::ALL`].
    #[must_use]
    pub const fn index(self) -> usize {
        self.side.index()
            + match self.pair {
                FootPair::Hind => 0,
                FootPair::Fore => 2,
            }
    }

    /// Returns the foot on the other side.
    #[must_use]
    pub const fn mirrored(self) -> Self {
        Self { pair: self.pair, side: self.side.other() }
    }

    /// Returns the roles of the leg on this foot, from the trunk outwards: thigh, shin and foot, or
    /// upper arm, forearm and hand.
    #[must_use]
    pub const fn leg(self) -> [Role; 3] {
        match self.pair {
            FootPair::Hind => {
                [Role::thigh(self.side), Role::shin(self.side), Role::foot(self.side)]
            }
            FootPair::Fore => Role::arm(self.side),
        }
    }
}

impl From<Side> for Foot {
    fn from(side: Side) -> Self {
        Self { pair: FootPair::Hind, side }
    }
}

/// The function of a joint, in any rig.
///
/// A joint is named for the bone that *starts* at it: `LeftThigh` is the joint whose rotation
/// swings the left thigh (the hip joint), `LeftShin` is the knee, `LeftFoot` the ankle, `LeftToe`
/// the ball of the foot, `LeftForearm` the elbow, `LeftHand` the wrist. `Spine` is the lowest joint
/// of the back, next above `Hips`.
///
/// Of a body on four legs ([`BodyPlan::Quadruped`]) the roles of legs are those of the hind legs,
/// whose ankle is the hock, and the roles of arms those of the forelegs: `LeftUpperArm` is the
/// shoulder joint, `LeftForearm` the elbow, `LeftHand` the joint above the forefoot.
#[derive(
    Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, serde::Serialize, serde::Deserialize,
)]
#[expect(missing_docs, reason = "the type's text explains the names")]
pub enum Role {
    Hips,
    Spine,
    Head,
    LeftThigh,
    LeftShin,
    LeftFoot,
    LeftToe,
    RightThigh,
    RightShin,
    RightFoot,
    RightToe,
    LeftUpperArm,
    LeftForearm,
    LeftHand,
    RightUpperArm,
    RightForearm,
    RightHand,
}

impl Role {
    /// The number of roles.
    pub const COUNT: usize = 17;

    /// Every role, in the order of declaration.
    pub const ALL: [Self; Self::COUNT] = [
        Self::Hips,
        Self::Spine,
        Self::Head,
        Self::LeftThigh,
        Self::LeftShin,
        Self::LeftFoot,
        Self::LeftToe,
        Self::RightThigh,
        Self::RightShin,
        Self::RightFoot,
        Self::RightToe,
        Self::LeftUpperArm,
        Self::LeftForearm,
        Self::LeftHand,
        Self::RightUpperArm,
        Self::RightForearm,
        Self::RightHand,
    ];

    /// Returns the index in [`Role::ALL`].
    #[must_use]
    pub const fn index(self) -> usize {
        self as usize
    }

    /// Returns the name on screen.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Hips => "hips",
            Self::Spine => "spine",
            Self::Head => "head",
            Self::LeftThigh => "left thigh",
            Self::LeftShin => "left shin",
            Self::LeftFoot => "left foot",
            Self::LeftToe => "left toe",
            Self::RightThigh => "right thigh",
            Self::RightShin => "right shin",
            Self::RightFoot => "right foot",
            Self::RightToe => "right toe",
            Self::LeftUpperArm => "left upper arm",
            Self::LeftForearm => "left forearm",
            Self::LeftHand => "left hand",
            Self::RightUpperArm => "right upper arm",
            Self::RightForearm => "right forearm",
            Self::RightHand => "right hand",
        }
    }

    /// Returns the name on screen in a body: of one on four legs, arms are forelegs and legs are
    /// hind legs.
    #[must_use]
    pub const fn name_in(self, plan: BodyPlan) -> &'static str {
        match (plan, self) {
            (BodyPlan::Biped, _) => self.name(),
            (BodyPlan::Quadruped, role) => match role {
                Self::Hips | Self::Spine | Self::Head => role.name(),
                Self::LeftThigh => "left hind thigh",
                Self::LeftShin => "left hind shin",
                Self::LeftFoot => "left hind foot",
                Self::LeftToe => "left hind toe",
                Self::RightThigh => "right hind thigh",
                Self::RightShin => "right hind shin",
                Self::RightFoot => "right hind foot",
                Self::RightToe => "right hind toe",
                Self::LeftUpperArm => "left upper foreleg",
                Self::LeftForearm => "left lower foreleg",
                Self::LeftHand => "left forefoot",
                Self::RightUpperArm => "right upper foreleg",
                Self::RightForearm => "right lower foreleg",
                Self::RightHand => "right forefoot",
            },
        }
    }

    /// Returns the side of the body; `None` in the middle.
    #[must_use]
    pub const fn side(self) -> Option<Side> {
        match self {
            Self::Hips | Self::Spine | Self::Head => None,
            Self::LeftThigh
            | Self::LeftShin
            | Self::LeftFoot
            | Self::LeftToe
            | Self::LeftUpperArm
            | Self::LeftForearm
            | Self::LeftHand => Some(Side::Left),
            _ => Some(Side::Right),
        }
    }

    /// Returns the counterpart of this role on the other side; roles in the middle are their own.
    #[must_use]
    pub const fn mirrored(self) -> Self {
        match self {
            Self::Hips | Self::Spine | Self::Head => self,
            Self::LeftThigh => Self::RightThigh,
            Self::LeftShin => Self::RightShin,
            Self::LeftFoot => Self::RightFoot,
            Self::LeftToe => Self::RightToe,
            Self::RightThigh => Self::LeftThigh,
            Self::RightShin => Self::LeftShin,
            Self::RightFoot => Self::LeftFoot,
            Self::RightToe => Self::LeftToe,
            Self::LeftUpperArm => Self::RightUpperArm,
            Self::LeftForearm => Self::RightForearm,
            Self::LeftHand => Self::RightHand,
            Self::RightUpperArm => Self::LeftUpperArm,
            Self::RightForearm => Self::LeftForearm,
            Self::RightHand => Self::LeftHand,
        }
    }

    /// Returns the hip joint, which swings the thigh.
    #[must_use]
    pub const fn thigh(side: Side) -> Self {
        side.pick(Self::LeftThigh, Self::RightThigh)
    }

    /// Returns the knee, which swings the shin.
    #[must_use]
    pub const fn shin(side: Side) -> Self {
        side.pick(Self::LeftShin, Self::RightShin)
    }

    /// Returns the ankle.
    #[must_use]
    pub const fn foot(side: Side) -> Self {
        side.pick(Self::LeftFoot, Self::RightFoot)
    }

    /// Returns the ball of the foot.
    #[must_use]
    pub const fn toe(side: Side) -> Self {
        side.pick(Self::LeftToe, Self::RightToe)
    }

    /// Returns the shoulder joint, which swings the upper arm.
    #[must_use]
    pub const fn upper_arm(side: Side) -> Self {
        side.pick(Self::LeftUpperArm, Self::RightUpperArm)
    }

    /// Returns the elbow, which swings the forearm.
    #[must_use]
    pub const fn forearm(side: Side) -> Self {
        side.pick(Self::LeftForearm, Self::RightForearm)
    }

    /// Returns the wrist.
    #[must_use]
    pub const fn hand(side: Side) -> Self {
        side.pick(Self::LeftHand, Self::RightHand)
    }

    /// Returns thigh, shin, foot and toe of one side, from the hips outwards.
    #[must_use]
    pub const fn leg(side: Side) -> [Self; 4] {
        [Self::thigh(side), Self::shin(side), Self::foot(side), Self::toe(side)]
    }

    /// Returns upper arm, forearm and hand of one side, from the chest outwards.
    #[must_use]
    pub const fn arm(side: Side) -> [Self; 3] {
        [Self::upper_arm(side), Self::forearm(side), Self::hand(side)]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn role_list_is_complete_and_its_mirror_is_itself() {
        for (index, role) in Role::ALL.into_iter().enumerate() {
            assert_eq!(role.index(), index);
            assert_eq!(role.mirrored().mirrored(), role);
            assert_eq!(role.mirrored().side(), role.side().map(Side::other));
            assert_eq!(role.side().is_none(), role.mirrored() == role);
        }
        for side in Side::BOTH {
            for role in Role::leg(side).into_iter().chain(Role::arm(side)) {
                assert_eq!(role.side(), Some(side));
                for plan in [BodyPlan::Biped, BodyPlan::Quadruped] {
                    assert!(role.name_in(plan).starts_with(if side == Side::Left {
                        "left "
                    } else {
                        "right "
                    }));
                }
            }
        }
    }

    #[test]
    fn feet_are_at_their_indices_and_their_mirror_is_itself() {
        for (index, foot) in Foot::ALL.into_iter().enumerate() {
            assert_eq!(foot.index(), index);
            assert_eq!((foot.mirrored().mirrored(), foot.mirrored().pair), (foot, foot.pair));
            assert!(foot.leg().iter().all(|role| role.side() == Some(foot.side)));
        }
        assert_eq!(Foot::of(BodyPlan::Biped), Side::BOTH.map(Foot::from));
        assert_eq!(Foot::of(BodyPlan::Quadruped), Foot::ALL);
    }
}
