//! What retargeting did, and the weights of feet and hands.

use super::{Detail, param_row_ui};
use crate::ui::kit;
use crate::ui::language::say;
use crate::ui::out::Out;
use crate::ui::text;
use crate::ui::theme::{Type, palette_of, space, theme_of};
use eframe::egui::{Color32, Grid, RichText, Ui};
use segue_motion::retarget::{Compared, LimbReach, RetargetErrors, SkatingValues};
use segue_session::{Key, RetargetReport, Session, format_number};
use segue_text::{Message, msg};

/// Draws the rows of the weights, and the errors of the clips that were retargeted, each under its
/// name where there are several.
pub(crate) fn retarget_rows_ui(
    reports: &[(Option<Message>, &RetargetReport)],
    session: &Session,
    out: &mut Out,
    ui: &mut Ui,
) {
    let errors = || reports.iter().map(|(_, report)| &report.errors);
    let limbs: [(Key, bool, Message); 2] = [
        (Key::RetargetFeet, errors().any(|of| of.feet != [None; 2]), text::NO_COMMON_LEGS.into()),
        (Key::RetargetHands, errors().any(|of| of.hands != [None; 2]), text::NO_COMMON_ARMS.into()),
    ];
    for (key, has_any, reason) in limbs {
        if has_any {
            param_row_ui(key, &Detail::default(), session, out, ui);
        } else {
            kit::note_ui(&reason, palette_of(ui).muted, ui);
        }
    }
    kit::folded_ui(text::RETARGET_ERRORS, ui, |ui| {
        kit::note_ui(text::ABOUT_RETARGET_ERRORS, palette_of(ui).muted, ui);
        for (index, (name, report)) in reports.iter().enumerate() {
            if let Some(name) = name {
                kit::note_ui(name, palette_of(ui).text, ui);
            }
            ui.push_id(index, |ui| errors_ui(&report.errors, ui));
        }
    });
}

/// Draws the errors of one clip as a table.
fn errors_ui(errors: &RetargetErrors, ui: &mut Ui) {
    let palette = palette_of(ui);
    let (muted, plain) = (palette.muted, palette.text);
    let small = theme_of(ui).font(Type::Small);
    let cell = |words: &Message, color: Color32, ui: &mut Ui| {
        ui.label(RichText::new(say(words, ui)).font(small.clone()).color(color));
    };
    let limbs = [
        (text::LEFT_FOOT, errors.feet[0]),
        (text::RIGHT_FOOT, errors.feet[1]),
        (text::LEFT_HAND, errors.hands[0]),
        (text::RIGHT_HAND, errors.hands[1]),
    ];
    let grid = Grid::new("errors").num_columns(3).spacing([space::M, 2.0]);
    grid.show(ui, |ui| {
        for head in [text::ERROR_OF, text::BY_DIRECTIONS, text::BY_RESULT] {
            cell(&head.into(), muted, ui);
        }
        ui.end_row();
        let row_ui = |name: Message, [before, after]: [Message; 2], ui: &mut Ui| {
            cell(&name, muted, ui);
            cell(&before, muted, ui);
            cell(&after, plain, ui);
            ui.end_row();
        };
        for (name, reach) in limbs {
            if let Some(Compared { directions, result }) = reach {
                let said = |reach: LimbReach| mean_and_worst(reach.mean_cm, reach.worst_cm);
                row_ui(name.into(), [said(directions), said(result)], ui);
            }
        }
        let Compared { directions, result } = errors.skating;
        if result.stances > 0 {
            let said = |slid: SkatingValues| mean_and_worst(slid.mean_cm, slid.worst_cm);
            let source = said(errors.source_skating);
            row_ui(text::slid_in_clip(source), [said(directions), said(result)], ui);
        }
        if errors.feet != [None; 2] {
            let Compared { directions, result } = errors.penetration_cm;
            let said = |cm: f64| Message::data(format_number(cm, 0.1));
            row_ui(text::DEPTH.into(), [said(directions), said(result)], ui);
        }
        let Compared { directions, result } = errors.beyond_limits;
        let said = |frames: usize| Message::data(frames.to_string());
        row_ui(text::BEYOND_LIMITS.into(), [said(directions), said(result)], ui);
    });
}

fn mean_and_worst(mean_cm: f64, worst_cm: f64) -> Message {
    let [mean, worst] = [mean_cm, worst_cm].map(|cm| format_number(cm, 0.1));
    msg!("{mean}, at most {worst}", mean, worst)
}
