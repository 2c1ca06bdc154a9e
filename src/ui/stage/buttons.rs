//! The buttons over the stage.

use crate::ui::commands::{UiCommand, command_icon_ui};
use crate::ui::kit::{self, Button, Icon};
use crate::ui::out::{Action, Out};
use crate::ui::state::{Filming, Layout, UiState};
use crate::ui::text;
use crate::ui::theme::{space, theme_of};
use eframe::egui::{Rect, Ui, UiBuilder, pos2, vec2};
use segue_session::{Key, Session};

/// Draws the buttons of the camera at the right of `free`, and below them those for pictures,
/// reports and videos, which a phone has in its menu; on a low stage beside them. Returns their
/// place.
pub(super) fn camera_buttons_ui(
    session: &Session,
    free: Rect,
    layout: Layout,
    state: &mut UiState,
    out: &mut Out,
    ui: &mut Ui,
) -> Rect {
    let params = session.params();
    let theme = theme_of(ui);
    let side = (30.0 * theme.scale()).max(theme.row_height()).round();
    let size = vec2(side, 3.0 * side + 2.0 * space::XS);
    let rect =
        Rect::from_min_size(pos2(free.right() - side - space::S, free.top() + space::S), size);
    ui.scope_builder(UiBuilder::new().max_rect(rect), |ui| {
        ui.spacing_mut().item_spacing.y = space::XS;
        for command in
            [UiCommand::ToggleFollow, UiCommand::ToggleTopView, UiCommand::FrameEverything]
        {
            command_icon_ui(command, session, state, out, ui);
        }
    });
    if params.is_on(Key::Embed) || layout == Layout::Phone {
        return rect;
    }
    let below = rect.translate(vec2(0.0, size.y + space::M));
    let is_low = below.bottom() > free.bottom();
    let filming = if is_low { rect.translate(vec2(-side - space::XS, 0.0)) } else { below };
    filming_ui(state.filming, filming, out, ui);
    rect.union(filming)
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
