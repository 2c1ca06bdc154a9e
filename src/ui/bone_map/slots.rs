//! The places of body parts in the picture. A new part is a row.

use crate::ui::language::Word;
use segue_motion::skeleton::{BodyPlan, Role, Side};

/// A slot: a part in the middle or on the left, which stands for its counterpart, too.
struct Slot {
    role: Role,
    /// Its name without its side, in a body on two legs and in one on four.
    labels: [Word; 2],
    /// Its place in the picture of a body that faces the viewer: right of the middle and below the
    /// top of the head, in body heights; and in that of a body on four legs, seen from below.
    at: [[f32; 2]; 2],
    /// Whether contacts, and with them most labs, need it.
    is_needed: bool,
}

/// The slots from the top down, which is their order in each column.
const SLOTS: [Slot; 10] = [
    slot(Role::Head, ["head"; 2], [[0.0, 0.07], [0.0, 0.07]], false),
    slot(Role::Spine, ["spine"; 2], [[0.0, 0.35], [0.0, 0.45]], false),
    slot(Role::Hips, ["hips"; 2], [[0.0, 0.47], [0.0, 0.62]], true),
    slot(Role::LeftUpperArm, ["upper arm", "upper foreleg"], [[0.1, 0.2], [0.075, 0.27]], false),
    slot(Role::LeftForearm, ["forearm", "lower foreleg"], [[0.135, 0.345], [0.13, 0.33]], false),
    slot(Role::LeftHand, ["hand", "forefoot"], [[0.155, 0.485], [0.16, 0.21]], false),
    slot(Role::LeftThigh, ["thigh", "hind thigh"], [[0.055, 0.53], [0.07, 0.63]], true),
    slot(Role::LeftShin, ["shin", "hind shin"], [[0.062, 0.74], [0.13, 0.58]], true),
    slot(Role::LeftFoot, ["foot", "hind foot"], [[0.066, 0.93], [0.14, 0.76]], true),
    slot(Role::LeftToe, ["toe", "hind toe"], [[0.09, 0.98], [0.165, 0.69]], false),
];

const fn slot(role: Role, labels: [&'static str; 2], at: [[f32; 2]; 2], is_needed: bool) -> Slot {
    let [on_two, on_four] = labels;
    Slot { role, labels: [Word::new(on_two), Word::new(on_four)], at, is_needed }
}

/// Returns what is given for a body on two legs and for one on four.
const fn of_plan<T: Copy>([on_two, on_four]: [T; 2], plan: BodyPlan) -> T {
    match plan {
        BodyPlan::Biped => on_two,
        BodyPlan::Quadruped => on_four,
    }
}

/// Returns the name of a part of a body without its side.
pub(super) fn label_of(role: Role, plan: BodyPlan) -> Word {
    slot_of(role).map_or(Word::new(role.name_in(plan)), |slot| of_plan(slot.labels, plan))
}

/// Returns whether contacts need a part: of a body on four legs those of its forelegs, too.
pub(super) fn is_needed(role: Role, plan: BodyPlan) -> bool {
    let is_of_foreleg = || Side::BOTH.into_iter().any(|side| Role::arm(side).contains(&role));
    slot_of(role).is_some_and(|slot| slot.is_needed)
        || plan == BodyPlan::Quadruped && is_of_foreleg()
}

/// Returns the place of a part in the picture; see [`Slot::at`].
pub(super) fn place_of(role: Role, plan: BodyPlan) -> [f32; 2] {
    let [x, y] = slot_of(role).map_or([0.0, 0.0], |slot| of_plan(slot.at, plan));
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
            for plan in [BodyPlan::Biped, BodyPlan::Quadruped] {
                let ([x, y], [other, below]) =
                    (place_of(role, plan), place_of(role.mirrored(), plan));
                assert_eq!((x, y), (-other, below), "{role:?}");
                assert!(x.abs() < 0.5 && (0.0..1.0).contains(&y), "{role:?}");
                assert_eq!(x > 0.0, role.side() == Some(Side::Left), "{role:?}");
                let label = label_of(role, plan).english();
                assert!(role.name_in(plan).ends_with(label), "{role:?}");
            }
        }
    }
}
