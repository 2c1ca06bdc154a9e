//! The places of body parts in the picture. A new part is a row.

use crate::ui::language::Word;
use segue_motion::skeleton::{Role, Side};

/// A slot: a part in the middle or on the left, which stands for its counterpart, too.
struct Slot {
    role: Role,
    /// Its name without its side.
    label: Word,
    /// Its place in the picture of a body that faces the viewer: right of the middle and below the
    /// top of the head, in body heights.
    at: [f32; 2],
    /// Whether contacts, and with them most labs, need it.
    is_needed: bool,
}

/// The slots from the top down, which is their order in each column.
const SLOTS: [Slot; 10] = [
    slot(Role::Head, "head", [0.0, 0.07], false),
    slot(Role::Spine, "spine", [0.0, 0.35], false),
    slot(Role::Hips, "hips", [0.0, 0.47], true),
    slot(Role::LeftUpperArm, "upper arm", [0.1, 0.2], false),
    slot(Role::LeftForearm, "forearm", [0.135, 0.345], false),
    slot(Role::LeftHand, "hand", [0.155, 0.485], false),
    slot(Role::LeftThigh, "thigh", [0.055, 0.53], true),
    slot(Role::LeftShin, "shin", [0.062, 0.74], true),
    slot(Role::LeftFoot, "foot", [0.066, 0.93], true),
    slot(Role::LeftToe, "toe", [0.09, 0.98], false),
];

const fn slot(role: Role, label: &'static str, at: [f32; 2], is_needed: bool) -> Slot {
    Slot { role, label: Word::new(label), at, is_needed }
}

/// Returns the name of a part without its side.
pub(super) fn label_of(role: Role) -> Word {
    slot_of(role).map_or(Word::new(role.name()), |slot| slot.label)
}

/// Returns whether contacts need a part.
pub(super) fn is_needed(role: Role) -> bool {
    slot_of(role).is_some_and(|slot| slot.is_needed)
}

/// Returns the place of a part in the picture; see [`Slot::at`].
pub(super) fn place_of(role: Role) -> [f32; 2] {
    let [x, y] = slot_of(role).map_or([0.0, 0.0], |slot| slot.at);
    // The character's right is the viewer's left.
    [if role.side() == Some(Side::Right) { -x } else { x }, y]
}

/// Returns the parts of a side, or of the middle, from the top down.
pub(super) fn column(side: Option<Side>) -> impl Iterator<Item = Role> {
    SLOTS.iter().map(|slot| slot.role).filter_map(move |role| match side {
        None => role.side().is_none().then_some(role),
        Some(Side::Left) => role.side().is_some().then_some(role),
        Some(Side::Right) => role.side().is_some().then(|| role.mirrored()),
    })
}

fn slot_of(role: Role) -> Option<&'static Slot> {
    SLOTS.iter().find(|slot| slot.role == role || slot.role == role.mirrored())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slots_hold_every_part_once() {
        let columns = [None, Some(Side::Left), Some(Side::Right)];
        let mut parts: Vec<Role> = columns.into_iter().flat_map(column).collect();
        parts.sort_unstable();
        assert_eq!(parts, Role::ALL);
        for role in Role::ALL {
            let ([x, y], [other, below]) = (place_of(role), place_of(role.mirrored()));
            assert_eq!((x, y), (-other, below), "{role:?}");
            assert!(x.abs() < 0.5 && (0.0..1.0).contains(&y), "{role:?}");
            assert_eq!(x > 0.0, role.side() == Some(Side::Left), "{role:?}");
            assert!(role.name().ends_with(label_of(role).english()), "{role:?}");
        }
    }
}
