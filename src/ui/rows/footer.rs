//! The foot of a lab's panel, which is always in sight: the buttons that keep the result in the
//! library and save it as a file.

use super::save::save_options_ui;
use crate::ui::kit::{self, Button, Icon};
use crate::ui::language::{Word, say};
use crate::ui::out::Out;
use crate::ui::state::UiState;
use crate::ui::text;
use crate::ui::theme::{palette_of, space, theme_of};
use eframe::egui::{Id, Rect, Response, ScrollArea, Ui, UiBuilder, vec2};
use segue_session::{Command, NoResult, Pane, Session};
use segue_text::Message;

/// The motion that a lab offers to keep and save.
pub(crate) struct KeepOffer {
    /// The motion that is saved: a clip's id, or `result:1` for the second pane.
    pub(crate) saved: String,
    /// The reason why it cannot be kept, beside that there is no result; empty if it can.
    pub(crate) keep_refused: Word,
    /// The reason why it cannot be saved, beside that there is no result; empty if it can.
    pub(crate) save_refused: Word,
}

impl KeepOffer {
    /// Returns the result of a pane, as it is.
    pub(crate) fn result(pane: usize) -> Self {
        Self {
            saved: format!("result:{pane}"),
            keep_refused: Word::default(),
            save_refused: Word::default(),
        }
    }
}

/// The time for which a result may be computed until the buttons are disabled, seconds: they do not
/// flicker while a slider is dragged.
const PATIENCE_SECS: f64 = 0.4;

/// Draws the buttons, and the reason why one of them cannot be pressed. `kept` returns what is kept
/// and saved of a pane, `most` is the greatest height of the foot, points.
pub(crate) fn footer_ui(
    session: &Session,
    kept: fn(&Session, usize) -> KeepOffer,
    most: f32,
    state: &mut UiState,
    out: &mut Out,
    ui: &mut Ui,
) {
    let panes = session.panes();
    state.saved_pane = state.saved_pane.min(panes.len().saturating_sub(1));
    let names: Vec<Message> =
        panes.iter().map(|pane| session.variant_name(pane).unwrap_or_default()).collect();
    if panes.len() > 1 {
        let options: Vec<(usize, &Message)> = names.iter().enumerate().collect();
        if let Some(pane) = kit::choice_row_ui(text::SAVED_PANE, state.saved_pane, &options, ui) {
            state.saved_pane = pane;
        }
        ui.add_space(space::XS);
    }
    let missing = no_result(state.saved_pane, session, ui);
    let kept = kept(session, state.saved_pane);
    let [not_kept, not_saved] =
        [kept.keep_refused, kept.save_refused].map(|own| missing.unwrap_or(own));
    let can_save = not_saved.is_empty();
    if state.save_open && can_save {
        let others = (if panes.len() > 1 { 2.0 } else { 1.0 }) * theme_of(ui).row_height();
        let room = most - others - 4.0 * space::S;
        scrolled_ui(room, ui, |ui| save_options_ui(&kept.saved, state, out, ui));
        ui.add_space(space::S);
    }
    ui.horizontal_wrapped(|ui| {
        let keep = Button::new(text::KEEP).icon(Icon::Plus).hint(text::KEEP_HELP);
        // Disabled, the colours of the main action would leave no text to read.
        let keep = if not_kept.is_empty() { keep.primary() } else { keep };
        if enabled_ui(keep, not_kept, ui).clicked() {
            out.commands.push(Command::Keep(state.saved_pane));
        }
        let is_open = state.save_open && can_save;
        let sign = if is_open { Icon::ChevronDown } else { Icon::ChevronRight };
        let save = Button::new(text::SAVE_MENU).trailing(sign).hint(text::SAVE_MENU_HELP);
        let save = enabled_ui(save.selected(is_open), not_saved, ui);
        ui.ctx().accesskit_node_builder(save.id, |node| node.set_expanded(is_open));
        if save.clicked() {
            state.save_open = !is_open;
        }
    });
    // One reason stands for both buttons.
    let reasons = [not_kept, not_saved];
    for (index, reason) in reasons.into_iter().enumerate() {
        if !reason.is_empty() && !reasons[..index].contains(&reason) {
            kit::note_ui(reason, palette_of(ui).muted, ui);
        }
    }
}

/// Draws rows, which scroll where they are higher than `most`, points. A panel that sizes itself
/// gives them the height that they had in the last frame, so that it is noted here.
fn scrolled_ui(most: f32, ui: &mut Ui, rows: impl FnOnce(&mut Ui)) {
    let id = Id::unique("height of the save options");
    let needed = ui.data(|data| data.get_temp::<f32>(id)).unwrap_or(most);
    let size = vec2(ui.available_width(), needed.min(most).max(0.0));
    let place = Rect::from_min_size(ui.cursor().min, size);
    let shown = ui.scope_builder(UiBuilder::new().max_rect(place), |ui| {
        ScrollArea::vertical().id_salt("save options").auto_shrink([false, true]).show(ui, rows)
    });
    let height = shown.inner.content_size.y;
    if height != needed {
        ui.data_mut(|data| data.insert_temp(id, height));
        ui.request_repaint();
    }
}

/// Draws a button that is disabled where there is a reason for it, which is its hint then.
fn enabled_ui(button: Button<'_>, reason: Word, ui: &mut Ui) -> Response {
    let response = ui.add_enabled_ui(reason.is_empty(), |ui| kit::button_ui(button, ui)).inner;
    if reason.is_empty() {
        return response;
    }
    response.on_disabled_hover_text(say(reason, ui))
}

/// Returns the reason why a pane has no result; `None` if it has one, and in the first moments in
/// which it is computed.
fn no_result(pane: usize, session: &Session, ui: &Ui) -> Option<Word> {
    let missing = match session.panes().get(pane).map(Pane::result) {
        Some(Ok(_)) => None,
        // The reason is shown on the stage.
        Some(Err(NoResult::Refused(_))) | None => Some(text::NOTHING_TO_KEEP),
        Some(Err(NoResult::Awaited)) => Some(text::STILL_COMPUTED),
    };
    let since_id = Id::unique("result awaited since");
    if missing != Some(text::STILL_COMPUTED) {
        ui.data_mut(|data| data.remove::<f64>(since_id));
        return missing;
    }
    let now = ui.input(|input| input.time);
    let since = ui.data_mut(|data| *data.get_temp_mut_or(since_id, now));
    if now - since < PATIENCE_SECS {
        ui.ctx().request_repaint_after_secs((PATIENCE_SECS - (now - since)) as f32);
        return None;
    }
    missing
}
