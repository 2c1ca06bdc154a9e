//! The Make lab: a motion from parameters.

use crate::ui::labs::lab_ui::{Compares, LabUi, Shown, Title};
use crate::ui::out::Out;
use crate::ui::rows::{Detail, KeepOffer, compare_ui, foot_rows_ui, param_row_ui};
use crate::ui::state::UiState;
use crate::ui::text;
use eframe::egui::Ui;
use segue_session::choices::MadeAction;
use segue_session::{Command, Group, Key, LabId, PARAMS, Params, Session};
use segue_text::Message;

/// The lab's part of the page.
pub(super) const LAB: LabUi = LabUi {
    panel_ui: make_ui,
    about: [text::MAKE_ABOUT, text::MAKE_DETAILS],
    kept: |_, pane| KeepOffer::result(pane),
    compares: Compares::Own(|session, out| {
        out.commands.push(Command::Compare(made_number(session)));
    }),
    title,
    hint: |_| None,
    take_line: None,
};

fn title(shown: &Shown<'_>) -> Title {
    Title { strong: action(shown.params), ..Title::default() }
}

fn action(params: &Params) -> Message {
    params.choice::<MadeAction>().word().into()
}

/// Returns the name of a motion that was made from these parameters; `None` for a result of another
/// lab.
pub(crate) fn made_name(params: &Params) -> Option<Message> {
    (params.lab() == LabId::Make).then(|| action(params))
}

pub(super) fn make_ui(session: &Session, _: &mut UiState, out: &mut Out, ui: &mut Ui) {
    for param in PARAMS.iter().filter(|param| param.group == Group::Lab(LabId::Make)) {
        // Parameters that the chosen motion does not have are left out.
        if session.made_motion_has(param.key) {
            param_row_ui(param.key, &Detail::default(), session, out, ui);
        }
        if param.key == made_number(session) {
            compare_ui(param.key, session, out, ui);
        }
    }
    foot_rows_ui(session, out, ui);
}

/// Returns the parameter of a made motion that is compared: standing and turning on the spot have
/// no speed.
pub(crate) fn made_number(session: &Session) -> Key {
    if session.made_motion_has(Key::GaitSpeed) { Key::GaitSpeed } else { Key::BodyHeight }
}
