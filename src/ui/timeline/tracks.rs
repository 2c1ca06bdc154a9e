//! The content of the timeline from the results: tracks, stripes, moments, and their names.

use crate::ui::kit::{Moment, Part, Stripe, Track};
use crate::ui::language::Text;
use crate::ui::state::Layout;
use crate::ui::text;
use eframe::egui::Color32;
use segue_session::{CycleMade, Outcome, Pane, Session, Slot};
use segue_text::{Message, msg};
use std::sync::Arc;

/// Returns the name of the cycle that loops.
pub(super) fn round_name(outcome: &Outcome, [a, b]: &[Message; 2]) -> Message {
    match outcome.cycle.map(|cycle| cycle.made) {
        Some(CycleMade::Gait { facts, .. }) => {
            msg!("{a} ~ {b} · {mps:.2} m/s", a, b, mps = facts.speed_mps)
        }
        Some(CycleMade::Cut { .. }) => a.clone(),
        None => Message::default(),
    }
}

/// Returns where each further cycle begins.
pub(super) fn seams(outcome: &Outcome, color: Color32) -> Vec<Moment> {
    let Some(cycle) = outcome.cycle.filter(|cycle| cycle.secs > 0.0) else {
        return Vec::new();
    };
    let count = (outcome.duration_secs() / cycle.secs).round() as usize;
    let seam =
        |round: usize| Moment { time: round as f64 * cycle.secs, color, name: text::CYCLE_BEGINS };
    (1..count).map(seam).collect()
}

/// Returns where the path turns harder than the motion can.
pub(super) fn hard_turns(outcome: &Outcome, color: Color32) -> impl Iterator<Item = Moment> {
    let fps = outcome.motion.clip().fps();
    let turns = outcome.path().into_iter().flat_map(|path| &path.hard_turns);
    turns.map(move |turn| Moment { time: turn.worst as f64 / fps, color, name: text::HARD_MOMENT })
}

/// Returns the labels of the stripes of each pane's feet: A, B, result. A phone has room for one
/// pane.
pub(super) fn feet_names(session: &Session, layout: Layout) -> Vec<[Message; 3]> {
    let panes = session.panes();
    let shown = if layout == Layout::Phone { 1 } else { panes.len() };
    let names = |pane: &Pane| {
        let value = pane
            .variant
            .as_ref()
            .filter(|_| panes.len() > 1)
            .map(|(key, value)| key.param().spoken(value));
        [text::FEET_OF_A, text::FEET_OF_B, text::FEET_OF_RESULT].map(|of| {
            value.as_ref().map_or_else(|| of.into(), |value| msg!("{of} · {value}", of, value))
        })
    };
    panes.iter().take(shown).map(names).collect()
}

/// Returns the feet of A, of B and of the result under each other, in the result's time; pane by
/// pane.
pub(super) fn stripes<'a>(session: &Session, names: &'a [[Message; 3]]) -> Vec<Stripe<'a>> {
    let of = [(Part::A, Some(Slot::A)), (Part::B, Some(Slot::B)), (Part::Result, None)];
    let panes = session.panes().iter().zip(names);
    let registered =
        panes.filter_map(|(pane, names)| Some((pane.outcome.as_ref()?.registered()?, names)));
    registered
        .flat_map(|(registered, names)| {
            of.into_iter().zip(names).map(|((part, slot), label)| Stripe {
                part,
                label: label.into(),
                feet: (registered.steps.feet().iter())
                    .map(|&foot| registered.stances(slot, foot))
                    .collect(),
                edit: None,
            })
        })
        .collect()
}

/// Returns the track of a clip that lasts as long as the result.
pub(super) fn whole_track<'a>(part: Part, name: &'a Message, outcome: &Outcome) -> Track<'a> {
    Track {
        part,
        label: Text::EMPTY,
        name: name.into(),
        start: 0.0,
        end: outcome.duration_secs(),
        fade_in: 0.0,
        fade_out: 0.0,
    }
}

/// Returns the tracks of A and B.
pub(super) fn tracks<'a>(outcome: &Outcome, names: &'a [Message; 2]) -> Vec<Track<'a>> {
    let duration = outcome.duration_secs();
    let Some(transition) = outcome.transition else {
        let a = whole_track(Part::A, &names[0], outcome);
        if outcome.layer().is_none() {
            return vec![a];
        }
        let b = whole_track(Part::B, &names[1], outcome);
        return vec![Track { label: Text::Data("A"), ..a }, Track { label: Text::Data("B"), ..b }];
    };
    let fade = transition.end_secs - transition.start_secs;
    let track = |part, name: &'a Message, start, end, fade_in, fade_out| Track {
        part,
        label: Text::EMPTY,
        name: name.into(),
        start,
        end,
        fade_in,
        fade_out,
    };
    vec![
        Track {
            label: Text::Data("A"),
            ..track(Part::A, &names[0], 0.0, transition.end_secs, 0.0, fade)
        },
        Track {
            label: Text::Data("B"),
            ..track(Part::B, &names[1], transition.start_secs, duration, fade, 0.0)
        },
    ]
}

/// Returns the results of all panes, with the names that tell them apart.
pub(super) fn named_outcomes(session: &Session) -> Vec<(Message, &Arc<Outcome>)> {
    let named = session.panes().iter().filter_map(|pane| {
        let name = session.variant_name(pane).unwrap_or_else(|| text::RESULT.into());
        Some((name, pane.outcome.as_ref()?))
    });
    named.collect()
}
