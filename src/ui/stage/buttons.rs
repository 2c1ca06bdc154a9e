//! The buttons over the stage.

use crate::ui::commands::{UiCommand, command_icon_ui};
use crate::ui::kit::{self, Button, Icon};
use crate::ui::language::Text;
use crate::ui::out::{Action, Out};
use crate::ui::state::{Filming, UiState};
use crate::ui::text;
use crate::ui::theme::{space, theme_of};
use eframe::egui::{Rect, Ui, UiBuilder, pos2, vec2};
use segue_session::{Key, Session};

/// Draws the button that goes to the next pane: a phone shows one at a time.
pub(super) fn pane_switch_ui(count: usize, stage: Rect, state: &mut UiState, ui: &mut Ui) {
    let rect =
        Rect::from_min_size(pos2(stage.right() - 92.0, stage.top() + 44.0), vec2(84.0, 28.0));
    let label = format!("{} / {count}", state.shown_pane + 1);
    ui.scope_builder(UiBuilder::new().max_rect(rect), |ui| {
        if kit::button_ui(Button::new(Text::Data(&label)).icon(Icon::Swap), ui).clicked() {
            state.shown_pane = (state.shown_pane + 1) % count;
        }
    });
}

/// Draws the buttons of the camera, and below them those for pictures, reports and videos.
pub(super) fn camera_buttons_ui(
    session: &Session,
    stage: Rect,
    state: &mut UiState,
    out: &mut Out,
    ui: &mut Ui,
) {
    let params = session.params();
    let side = (30.0 * theme_of(ui).scale()).round();
    let rect = Rect::from_min_size(
        pos2(stage.right() - side - space::S, stage.top() + 76.0),
        vec2(side, 3.0 * side + 2.0 * space::XS),
    );
    ui.scope_builder(UiBuilder::new().max_rect(rect), |ui| {
        ui.spacing_mut().item_spacing.y = space::XS;
        for command in
            [UiCommand::ToggleFollow, UiCommand::ToggleTopView, UiCommand::FrameEverything]
        {
            command_icon_ui(command, session, state, out, ui);
        }
    });
    if !params.is_on(Key::Embed) {
        let below = Rect::from_min_size(
            rect.left_bottom() + vec2(0.0, space::M),
            vec2(side, 3.0 * side + 2.0 * space::XS),
        );
        filming_ui(state.filming, below, out, ui);
    }
}

/// Draws the buttons for a picture of the stage, a report, and a video of the page; beside a video
/// under way, its length.
fn filming_ui(filming: Filming, rect: Rect, out: &mut Out, ui: &mut Ui) {
    let builder = UiBuilder::new().id_salt("filming").max_rect(rect);
    let recorded = ui.scope_builder(builder, |ui| {
        ui.spacing_mut().item_spacing.y = space::XS;
        if filming.pictures
            && kit::button_ui(Button::icon_only(Icon::Picture, text::SAVE_PICTURE).quiet(), ui)
                .clicked()
        {
            out.actions.push(Action::SavePicture);
        }
        if kit::button_ui(Button::icon_only(Icon::Report, text::COPY_REPORT).quiet(), ui).clicked()
        {
            out.actions.push(Action::CopyReport);
        }
        if !filming.films {
            return None;
        }
        let name = if filming.secs.is_some() { text::STOP_RECORDING } else { text::RECORD };
        let button = kit::button_ui(
            Button::icon_only(Icon::Record, name).quiet().selected(filming.secs.is_some()),
            ui,
        );
        if button.clicked() {
            out.actions.push(Action::Record);
        }
        Some(button.rect)
    });
    if let (Some(button), Some(secs)) = (recorded.inner, filming.secs) {
        kit::recording_ui(text::RECORDING, secs, button.left_center() - vec2(space::XS, 0.0), ui);
    }
}
