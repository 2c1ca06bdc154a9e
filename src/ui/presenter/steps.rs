//! The steps of the presenter mode: lessons, panes and labs.

use crate::ui::lessons_panel::go_to;
use crate::ui::out::{Action, Out};
use crate::ui::state::{Presenter, UiState};
use crate::ui::text;
use segue_session::{Command, Key, Kind, Lesson, Session, Value};
use segue_text::{Message, msg};

/// Starts or ends the presenter mode.
pub(crate) fn toggle_presenter(state: &mut UiState, out: &mut Out) {
    let is_on = !state.presenter.is_on;
    state.presenter = Presenter::new(is_on);
    (state.help_open, state.library_open) = (false, false);
    out.actions.push(Action::Fullscreen(is_on));
}

/// Goes to the next or the previous lesson where one is open, else to the next pane of a
/// comparison, else to the next lab.
pub(crate) fn go_to_step(forward: bool, session: &Session, state: &mut UiState, out: &mut Out) {
    state.presenter.shown_until = f64::INFINITY;
    let count = session.panes().len();
    match session.lesson() {
        Some(Lesson::Page(page)) => {
            if let Some(to) = if forward { page.next } else { page.previous } {
                go_to(&to, out);
            }
        }
        Some(Lesson::Contents(page)) => {
            if let Some(first) = page.entries().next().filter(|_| forward) {
                out.commands.push(Command::Try(first.query));
            }
        }
        Some(Lesson::Waiting) => state.presenter.steps_to_go += if forward { 1 } else { -1 },
        Some(Lesson::Failed(_)) => {}
        None if count > 1 => {
            // First all panes, then each alone.
            let at = state.presenter.pane_alone(count).map_or(0, |pane| pane + 1);
            let next = if forward { at + 1 } else { at + count } % (count + 1);
            state.presenter.pane = next.checked_sub(1);
        }
        None => {
            let Kind::Choice(labs) = Key::Lab.param().kind else { return };
            let open = session.params().lab().word();
            let at = labs.iter().position(|lab| lab.key == open).unwrap_or_default();
            let next = if forward { Some(at + 1) } else { at.checked_sub(1) };
            if let Some(lab) = next.and_then(|next| labs.get(next)) {
                out.set_once(Key::Lab, Value::Choice(lab.key));
            }
        }
    }
}

/// Takes one of the steps that were requested while a lesson was being loaded.
pub(super) fn take_requested_step(session: &Session, state: &mut UiState, out: &mut Out) {
    let steps = state.presenter.steps_to_go;
    match session.lesson() {
        _ if steps == 0 => {}
        Some(Lesson::Waiting) => {}
        Some(Lesson::Page(_) | Lesson::Contents(_)) => {
            state.presenter.steps_to_go -= steps.signum();
            go_to_step(steps > 0, session, state, out);
        }
        Some(Lesson::Failed(_)) | None => state.presenter.steps_to_go = 0,
    }
}

/// Returns the name of the present step: the lesson, the pane, or the lab.
pub(super) fn step_name(session: &Session, state: &UiState) -> Message {
    let panes = session.panes();
    match session.lesson() {
        Some(Lesson::Page(page)) => msg!(
            "{number} / {of} · {title}",
            number = page.number,
            of = page.of,
            title = page.page.title.clone()
        ),
        Some(Lesson::Contents(page)) => Message::data(page.title.clone()),
        _ if panes.len() > 1 => state
            .presenter
            .pane_alone(panes.len())
            .and_then(|pane| session.variant_name(panes.get(pane)?))
            .unwrap_or_else(|| text::ALL_PANES.into()),
        _ => Key::Lab.param().spoken(session.params().get(Key::Lab)),
    }
}
