//! The clips that labs take.

use segue_session::{Key, Kind, LabId, ListKind, PARAMS};

/// The clips that a lab takes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Clips {
    /// None.
    None,
    /// Each clip gives a result of its own.
    Each,
    /// Clips for the lab's slots, A and B; further ones where the lab takes them.
    Slots,
    /// Any number, as one list.
    List,
}

impl Clips {
    /// Returns the clips that a lab takes: its result is made from the parameters that hold them.
    #[must_use]
    pub fn of(lab: LabId) -> Self {
        let takes = |key: Key| key.param().is_ingredient_of(lab);
        let is_list = |kind: Kind| matches!(kind, Kind::List(ListKind::ClipIds));
        if takes(Key::B) {
            Self::Slots
        } else if takes(Key::A) {
            Self::Each
        } else if PARAMS.iter().any(|param| is_list(param.kind) && takes(param.key)) {
            Self::List
        } else {
            Self::None
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use segue_session::Selected as _;

    #[test]
    fn clips_of_a_lab_are_those_of_its_parameters() {
        for (lab, clips) in [
            ("make", Clips::None),
            ("clean", Clips::Each),
            ("loop", Clips::Each),
            ("edit", Clips::Each),
            ("path", Clips::Each),
            ("view", Clips::Each),
            ("in_place", Clips::Each),
            ("blend", Clips::Slots),
            ("transition", Clips::Slots),
            ("speed", Clips::Slots),
            ("layers", Clips::Slots),
            ("register", Clips::Slots),
            ("graph", Clips::List),
            ("match", Clips::List),
        ] {
            assert_eq!(LabId::from_word(lab).map(Clips::of), Some(clips), "{lab}");
        }
        assert_eq!(LabId::ALL.len(), 14);
    }
}
