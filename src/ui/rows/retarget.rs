//! The weights of feet and hands in retargeting, with its errors.

use super::retarget_errors::folded_errors_ui;
use super::{Detail, param_row_ui};
use crate::ui::kit;
use crate::ui::out::Out;
use crate::ui::text;
use crate::ui::theme::palette_of;
use eframe::egui::Ui;
use segue_motion::retarget::RetargetErrors;
use segue_session::{Key, Session};
use segue_text::Message;

/// The weights of both feet, or of the left one, and of the right one.
const FEET: [Key; 2] = [Key::RetargetFeet, Key::RetargetRightFoot];
/// The weights of both hands, or of the left one, and of the right one.
const HANDS: [Key; 2] = [Key::RetargetHands, Key::RetargetRightHand];

/// Draws the rows of the weights, and the errors of the clips that were retargeted, each under its
/// name where there are several. Nothing without any: clips of one rig have none.
pub(crate) fn retarget_rows_ui(
    reports: &[(Option<Message>, &RetargetErrors)],
    session: &Session,
    out: &mut Out,
    ui: &mut Ui,
) {
    if reports.is_empty() {
        return;
    }
    let errors = || reports.iter().map(|(_, errors)| errors);
    if errors().any(|of| of.is_across_plans) {
        kit::note_ui(text::OTHER_PLAN, palette_of(ui).warning, ui);
    }
    let limbs: [(_, bool, Message); 2] = [
        (FEET, errors().any(|of| of.feet != [None; 2]), text::NO_COMMON_LEGS.into()),
        (HANDS, errors().any(|of| of.hands != [None; 2]), text::NO_COMMON_ARMS.into()),
    ];
    for (keys, has_any, reason) in limbs {
        if has_any {
            for key in keys {
                param_row_ui(key, &Detail::default(), session, out, ui);
            }
        } else {
            kit::note_ui(&reason, palette_of(ui).muted, ui);
        }
    }
    let named: Vec<_> = reports.iter().map(|(name, errors)| (name.as_ref(), *errors)).collect();
    folded_errors_ui(text::RETARGET_ERRORS, &named, ui);
}
