//! The bar at the top: the labs, and the commands for the whole page.

use super::commands::{UiCommand, command_button_ui, command_icon_ui, command_item_ui};
use super::kit::{self, Button, Icon, MenuItem};
use super::language::{Word, say};
use super::out::{Action, Out};
use super::state::{Filming, Layout, UiState};
use super::text;
use super::theme::{Type, palette_of, space, theme_of};
use eframe::egui::{Align, Layout as Flow, RectAlign, RichText, Sense, Ui, vec2};
use segue_session::{Key, Kind, Session, Value};
use segue_text::msg;

/// Draws the bar.
pub(crate) fn top_bar_ui(
    session: &Session,
    layout: Layout,
    state: &mut UiState,
    out: &mut Out,
    ui: &mut Ui,
) {
    ui.horizontal_centered(|ui| {
        ui.spacing_mut().item_spacing.x = space::S;
        logo_ui(layout, ui);
        ui.with_layout(Flow::right_to_left(Align::Center), |ui| {
            actions_ui(session, layout, state, out, ui);
            ui.with_layout(Flow::left_to_right(Align::Center), |ui| {
                if let Some(lab) = lab_tabs_ui(session, ui) {
                    out.set_once(Key::Lab, Value::Choice(lab));
                }
            });
        });
    });
}

fn logo_ui(layout: Layout, ui: &mut Ui) {
    let (theme, palette) = (theme_of(ui), palette_of(ui));
    let side = 22.0 * theme.scale();
    if layout != Layout::Phone {
        let (rect, _) = ui.allocate_exact_size(vec2(side, side), Sense::hover());
        kit::paint_logo(rect, palette.a, palette.b, ui.painter());
    }
    ui.label(RichText::new(say(text::APP, ui)).font(theme.font(Type::Title)).color(palette.text));
    ui.add_space(space::S);
}

fn lab_tabs_ui(session: &Session, ui: &mut Ui) -> Option<&'static str> {
    let Kind::Choice(labs) = Key::Lab.param().kind else {
        return None;
    };
    let options: Vec<(&'static str, Word)> =
        labs.iter().map(|lab| (lab.key, Word::new(lab.label))).collect();
    let chosen = session.params().lab().word();
    kit::tabs_ui(
        [Word::new(Key::Lab.param().label), text::MORE_LABS],
        chosen,
        &options,
        ui.available_width(),
        ui,
    )
}

/// Draws the buttons, from right to left: the link, the theme, and others as the width allows. On a
/// phone they are in a menu.
fn actions_ui(session: &Session, layout: Layout, state: &mut UiState, out: &mut Out, ui: &mut Ui) {
    let link = if layout == Layout::Phone { text::LINK } else { text::COPY_LINK };
    let button = Button::new(link).primary().icon(Icon::Link);
    if layout != Layout::Phone {
        // Drawn before the button at its left: the bar is drawn from its right end.
        let more = Button::icon_only(Icon::ChevronDown, text::SHARE);
        let opener = kit::button_ui(more, ui);
        kit::menu_ui(&opener, RectAlign::BOTTOM_END, |ui| share_menu_ui(session, state, out, ui));
    }
    command_button_ui(UiCommand::CopyLink, button, session, state, out, ui);
    if layout == Layout::Phone {
        let opener = kit::icon_button_ui(Icon::Menu, text::MENU, ui);
        kit::menu_ui(&opener, RectAlign::BOTTOM_END, |ui| page_menu_ui(session, state, out, ui));
        return;
    }
    for command in [UiCommand::ToggleHelp, UiCommand::ToggleTheme] {
        command_icon_ui(command, session, state, out, ui);
    }
    let language = Button::new(text::OR_ENGLISH).icon(Icon::Language).quiet();
    command_button_ui(UiCommand::SwitchLanguage, language, session, state, out, ui);
    for command in [UiCommand::ToggleProjector, UiCommand::Redo, UiCommand::Undo] {
        command_icon_ui(command, session, state, out, ui);
    }
    let panes = session.panes().len();
    let label = if panes > 1 { msg!("Compare · {panes}", panes) } else { text::COMPARE.into() };
    command_button_ui(UiCommand::ToggleCompare, Button::new(&label), session, state, out, ui);
    let lessons = match layout {
        Layout::Desk => Button::new(text::LESSONS).icon(Icon::Book),
        Layout::Tablet | Layout::Phone => Button::icon_only(Icon::Book, text::LESSONS),
    };
    command_button_ui(UiCommand::ToggleLessons, lessons, session, state, out, ui);
}

/// Draws the menu behind the button that copies the link.
fn share_menu_ui(session: &Session, state: &mut UiState, out: &mut Out, ui: &mut Ui) {
    for command in [
        UiCommand::CopyLinkAsShown,
        UiCommand::CopyReport,
        UiCommand::ConvertFiles,
        UiCommand::Present,
    ] {
        command_item_ui(command, session, state, out, ui);
    }
}

/// Draws the menu of a phone, with the commands that have no room in the bar.
fn page_menu_ui(session: &Session, state: &mut UiState, out: &mut Out, ui: &mut Ui) {
    for command in [
        UiCommand::OpenLibrary,
        UiCommand::ToggleLessons,
        UiCommand::ToggleCompare,
        UiCommand::Undo,
        UiCommand::Redo,
        UiCommand::CopyLinkAsShown,
        UiCommand::CopyReport,
        UiCommand::ConvertFiles,
        UiCommand::Present,
        UiCommand::ToggleTheme,
        UiCommand::SwitchLanguage,
        UiCommand::ToggleHelp,
    ] {
        command_item_ui(command, session, state, out, ui);
    }
    // On the stage of a phone they would cover the motion.
    let Filming { pictures, films, secs } = state.filming;
    let recording = if secs.is_some() { text::STOP_RECORDING } else { text::RECORD };
    for (is_there, icon, name, action) in [
        (pictures, Icon::Picture, text::SAVE_PICTURE, Action::SavePicture),
        (films, Icon::Record, recording, Action::Record),
    ] {
        let item = MenuItem { text: name.into(), icon: Some(icon), ..MenuItem::default() };
        if is_there && kit::menu_item_ui(item, ui).clicked() {
            out.actions.push(action);
        }
    }
}
