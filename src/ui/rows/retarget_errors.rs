//! The errors of retargeting, in words.

use crate::ui::kit;
use crate::ui::language::Word;
use crate::ui::text;
use crate::ui::theme::palette_of;
use eframe::egui::Ui;
use segue_motion::retarget::{Compared, LimbReach, RetargetErrors, SkatingValues};
use segue_session::{Session, format_number};
use segue_text::{Message, msg};

/// Draws the errors of the results on the skeleton of the chosen character, each under the value
/// of its pane where values are compared. Nothing without a character, or for one of the same rig.
pub(crate) fn character_errors_ui(session: &Session, ui: &mut Ui) {
    let on_character = session.panes().iter().filter_map(|pane| {
        let moved = session.on_character(&pane.outcome.as_ref()?.motion)?;
        Some((session.variant_name(pane), moved.errors()?))
    });
    let on_character: Vec<_> = on_character.collect();
    if !on_character.is_empty() {
        let named: Vec<_> =
            on_character.iter().map(|(name, errors)| (name.as_ref(), *errors)).collect();
        folded_errors_ui(text::CHARACTER_ERRORS, &named, ui);
    }
}

/// Draws errors behind a title that unfolds them, each under its name.
pub(super) fn folded_errors_ui(
    title: Word,
    of: &[(Option<&Message>, &RetargetErrors)],
    ui: &mut Ui,
) {
    kit::folded_ui(title, ui, |ui| {
        kit::note_ui(text::ABOUT_RETARGET_ERRORS, palette_of(ui).muted, ui);
        for (index, (name, errors)) in of.iter().enumerate() {
            if let Some(name) = name {
                kit::note_ui(*name, palette_of(ui).text, ui);
            }
            ui.push_id(index, |ui| errors_ui(errors, ui));
        }
    });
}

/// Draws the errors of one clip, each in a line.
fn errors_ui(errors: &RetargetErrors, ui: &mut Ui) {
    let limbs = [
        (text::LEFT_FOOT, errors.feet[0]),
        (text::RIGHT_FOOT, errors.feet[1]),
        (text::LEFT_HAND, errors.hands[0]),
        (text::RIGHT_HAND, errors.hands[1]),
    ];
    let mut lines: Vec<Message> = Vec::new();
    for (limb, reach) in limbs {
        if let Some(Compared { directions, result }) = reach {
            let said = |reach: LimbReach| mean_and_worst(reach.mean_cm, reach.worst_cm);
            lines.push(text::limb_error(limb, said(result), said(directions)));
        }
    }
    let Compared { directions, result } = errors.skating;
    if result.stances > 0 {
        let said = |slid: SkatingValues| mean_and_worst(slid.mean_cm, slid.worst_cm);
        let source = said(errors.source_skating);
        lines.push(text::feet_slide(said(result), said(directions), source));
    }
    if errors.feet != [None; 2] {
        let Compared { directions, result } = errors.penetration_cm;
        lines.push(text::penetration(result, directions));
    }
    let Compared { directions, result } = errors.beyond_limits;
    lines.push(text::beyond_limits(result, directions));
    for line in lines {
        kit::note_ui(&line, palette_of(ui).text, ui);
    }
}

fn mean_and_worst(mean_cm: f64, worst_cm: f64) -> Message {
    let [mean, worst] = [mean_cm, worst_cm].map(|cm| format_number(cm, 0.1));
    msg!("{mean} cm, at most {worst} cm", mean, worst)
}
