//! The texts of the Blend, Transition and Layers labs.

use super::{BY_HAND, FOUND};
use crate::ui::language::Word;
use segue_session::choices::Mistake;
use segue_session::{LayerFacts, LayerFit, RetargetReport, Transition, format_number};
use segue_text::{Message, msg};

/// The line about the Blend lab.
pub(crate) const BLEND_ABOUT: Word = Word::new("Fades from A to B over a blend window.");
/// The help text of the Blend lab.
pub(crate) const BLEND_DETAILS: Word = Word::new(
    "Compare full, half and a third of the window: longer is smoother, shorter is snappier but pops.",
);
/// The line about the Transition lab.
pub(crate) const TRANSITION_ABOUT: Word = Word::new("Goes from A to B by one of several methods.");
/// The help text of the Transition lab.
pub(crate) const TRANSITION_DETAILS: Word = Word::new(
    "Inertialization plays B alone and lets the difference from A decay; a dissolve plays both clips during the window.",
);
/// The line about the Layers lab.
pub(crate) const LAYERS_ABOUT: Word = Word::new("Plays B on a part of A's body.");
/// The help text of the Layers lab.
pub(crate) const LAYERS_DETAILS: Word =
    Word::new("The mask chooses the part of the body, and the weight how strongly B moves it.");

/// Returns how the place of a transition was found, and the distance of the clips there.
/// `automatic`: whether A's frame and B's are left to Segue.
pub(crate) fn place_found(transition: &Transition, automatic: [bool; 2]) -> Message {
    let by_hand = automatic == [false, false];
    let Some(search) = transition.search.filter(|_| transition.distance_cm.is_finite()) else {
        return if by_hand { BY_HAND.into() } else { Message::from(FOUND).sentence() };
    };
    let cm = transition.distance_cm;
    let mut said = match (by_hand, search.by_pose) {
        (true, true) => vec![BY_HAND.into(), msg!("The poses are {cm:.1} cm apart.", cm)],
        (true, false) => vec![BY_HAND.into(), msg!("The windows are {cm:.1} cm apart.", cm)],
        (false, true) => {
            vec![msg!("Found automatically: best match of two poses, {cm:.1} cm.", cm)]
        }
        (false, false) => {
            vec![msg!("Found automatically: best match of both windows, {cm:.1} cm.", cm)]
        }
    };
    match automatic {
        _ if search.is_widened => {
            said.push(
                "A clip is too short to search one half only: all of it was searched.".into(),
            );
        }
        [true, true] => said.push("Searched: A's second half and B's first half.".into()),
        [true, false] => said.push("Searched: A's second half.".into()),
        [false, true] => said.push("Searched: B's first half.".into()),
        [false, false] => {}
    }
    if search.is_shortened && !search.by_pose {
        said.push(msg!(
            "Only {frames, plural, one {# frame is} other {# frames are}} compared: the clip ends there.",
            frames = search.window_frames
        ));
    }
    Message::joined(said, " ")
}

/// Says that B was retargeted to A's skeleton, and which joints were not matched.
pub(crate) fn retargeted(retargeted: &RetargetReport) -> Message {
    /// The greatest number of joints that are named.
    const NAMED: usize = 4;
    let unmatched = &retargeted.unmatched;
    let count = unmatched.len();
    let names: Vec<String> = unmatched.iter().take(NAMED).cloned().collect();
    match count {
        0 => "B is retargeted to A's skeleton.".into(),
        1..=NAMED => msg!("B is retargeted to A's skeleton; not matched: {names}.", names),
        _ => msg!(
            "B is retargeted to A's skeleton; not matched: {names}, … ({count}).",
            names,
            count
        ),
    }
}

/// Says that B was resampled to A's rate.
pub(crate) fn resampled(from: f64, to: f64) -> Message {
    let [from, to] = [from, to].map(|fps| format_number(fps, 0.01));
    msg!(
        "B is resampled from {from} to {to} frames per second, the rate of A and of the result.",
        from,
        to
    )
}

/// Returns what a mistake of the Transition lab looks like; empty for none.
pub(crate) fn mistake(key: Mistake) -> Word {
    Word::new(match key {
        Mistake::Hemisphere => {
            "Limbs rotate the long way round: half of B's quaternions have the opposite sign, which is the same rotation, and the shorter arc was not chosen."
        }
        Mistake::Euler => {
            "Limbs twist and flip, forearms first: Euler angles interpolated one by one leave the rotation from A to B."
        }
        Mistake::Degrees => {
            "Limbs whirl: an angle in degrees used as radians is 57 times too large."
        }
        Mistake::Atan => {
            "B enters turned by 180° and moves off backwards: atan cannot tell a direction from its opposite."
        }
        Mistake::TransformDegrees => {
            "B moves off in a wrong direction: its angle in degrees was used as radians."
        }
        Mistake::Facing => {
            "B turns to where the hips tilt: the root's Y axis points up, and its projection on the ground is not the facing."
        }
        Mistake::Alignment => {
            "B was not aligned to A, so that the character jumps to B's recorded position."
        }
        Mistake::Velocity => {
            "All motion stops dead at the seam and starts again: the velocities are thousands of times too small."
        }
        Mistake::WorldRoot => {
            "Feet slide and the speed surges: the positions of A and B are blended, not their velocities."
        }
        Mistake::None => "",
    })
}

/// The description of the mistake `velocity` for a dissolve, which has no other velocity.
pub(crate) const VELOCITY_IN_DISSOLVE: Word = Word::new(
    "The character steps on the spot during the window, then moves on: its root velocity is thousands of times too small.",
);
/// The note for a method in which the mistake cannot be made.
pub(crate) const MISTAKE_IDLE: Word =
    Word::new("A cut blends nothing, so the bug has no effect: choose another method.");
/// The button that compares the mistake with the right way.
pub(crate) const RIGHT_AND_WRONG: Word = Word::new("Compare with and without the bug");

/// Returns how B's time is fitted to A's in a layer.
pub(crate) fn fit(layer: &LayerFacts) -> Message {
    let how = Message::word(match layer.fit {
        LayerFit::InStep => "One cycle of B is synchronised with A.",
        LayerFit::Looped => "B loops, with its ends blended.",
        LayerFit::Once => "B is long enough to play once.",
        LayerFit::Held => "B holds its last frame at its end.",
    });
    if layer.has_no_steps {
        Message::joined(vec!["There are no steps to synchronise with.".into(), how], " ")
    } else {
        how
    }
}

/// The button that compares methods on the same transition.
pub(crate) const SHOOT_OUT: Word = Word::new("Compare methods");
/// The comparison that [`SHOOT_OUT`] opens.
pub(crate) const SHOOT_OUT_QUERY: &str = "method:inertialize,smooth,dead";
/// The row of the half-life ruler for one half.
pub(crate) const HALF_LEFT: Word = Word::new("50 % remains after");
/// The row of the half-life ruler for one tenth.
pub(crate) const TENTH_LEFT: Word = Word::new("10 %");
/// The row of the half-life ruler for one hundredth.
pub(crate) const HUNDREDTH_LEFT: Word = Word::new("1 %");
/// The row of the half-life ruler for the dissolve with as much of A in it.
pub(crate) const ALIKE_WINDOW: Word = Word::new("Equivalent blend window");

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn unmatched_joints_are_named_and_counted() {
        let told = |names: &[&str]| {
            retargeted(&RetargetReport {
                unmatched: names.iter().map(|name| (*name).to_owned()).collect(),
                ..RetargetReport::default()
            })
            .to_string()
        };
        assert_eq!(told(&[]), "B is retargeted to A's skeleton.");
        assert_eq!(told(&["Tail"]), "B is retargeted to A's skeleton; not matched: Tail.");
        assert_eq!(
            told(&["a", "b", "c", "d", "e"]),
            "B is retargeted to A's skeleton; not matched: a, b, c, d, … (5)."
        );
    }
}
