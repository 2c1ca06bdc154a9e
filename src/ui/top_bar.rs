//! The bar at the top: which lab, and what concerns the whole page.

use super::kit::{self, Button, Icon, MenuItem};
use super::labs::toggle_compare;
use super::language::{Language, tr};
use super::lessons_panel::{lessons_button_ui, toggle_lessons};
use super::out::{Action, Out};
use super::state::{Layout, UiState};
use super::text;
use super::theme::{Type, palette_of, space, theme_of};
use eframe::egui::{Align, Layout as Flow, RectAlign, RichText, Sense, Ui, vec2};
use segue_session::{Command, Key, Kind, Session, Value};

/// The whole bar.
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
    ui.label(RichText::new(tr(text::APP, ui)).font(theme.font(Type::Title)).color(palette.text));
    ui.add_space(space::S);
}

fn lab_tabs_ui(session: &Session, ui: &mut Ui) -> Option<&'static str> {
    let Kind::Choice(labs) = Key::Lab.param().kind else {
        return None;
    };
    let options: Vec<(&'static str, &str)> = labs.iter().map(|lab| (lab.key, lab.label)).collect();
    let chosen = session.params().lab().word();
    kit::tabs_ui(
        [Key::Lab.param().label, text::MORE_LABS],
        chosen,
        &options,
        ui.available_width(),
        ui,
    )
}

/// From right to left: the link, the theme, and what the width leaves room for; the rest is in a
/// menu.
fn actions_ui(session: &Session, layout: Layout, state: &mut UiState, out: &mut Out, ui: &mut Ui) {
    let link = if layout == Layout::Phone { text::LINK } else { text::COPY_LINK };
    if kit::button_ui(Button::new(link).primary().icon(Icon::Link), ui).clicked() {
        out.actions.push(Action::CopyLink);
    }
    if layout == Layout::Phone {
        let opener = kit::icon_button_ui(Icon::Menu, text::MENU, ui);
        kit::menu_ui(&opener, RectAlign::BOTTOM_END, |ui| page_menu_ui(session, state, out, ui));
        return;
    }
    if kit::icon_button_ui(Icon::Help, text::HELP, ui).clicked() {
        state.help_open = !state.help_open;
    }
    if kit::icon_button_ui(Icon::Contrast, text::THEME, ui).clicked() {
        out.set_once(Key::Theme, other_theme(ui));
    }
    let (language, words) = language_switch(state.language);
    let switch = Button::new(text::OR_ENGLISH).name(words).hint(words).icon(Icon::Language).quiet();
    if kit::button_ui(switch, ui).clicked() {
        out.set_once(Key::Lang, language);
    }
    let projector = session.params().is_on(Key::Projector);
    if kit::button_ui(
        Button::new(text::LARGER)
            .name(text::PROJECTOR)
            .hint(text::PROJECTOR)
            .quiet()
            .selected(projector),
        ui,
    )
    .clicked()
    {
        out.toggle(Key::Projector, projector);
    }
    for (icon, name, can, command) in [
        (Icon::Redo, text::REDO, session.can_redo(), Command::Redo),
        (Icon::Undo, text::UNDO, session.can_undo(), Command::Undo),
    ] {
        if ui.add_enabled_ui(can, |ui| kit::icon_button_ui(icon, name, ui)).inner.clicked() {
            out.commands.push(command);
        }
    }
    let panes = session.panes().len();
    let label =
        if panes > 1 { format!("{} · {panes}", text::COMPARE) } else { text::COMPARE.to_owned() };
    if kit::button_ui(Button::new(&label).hint(text::COMPARE_HELP).selected(panes > 1), ui)
        .clicked()
    {
        toggle_compare(session, out);
    }
    lessons_button_ui(session, layout, out, ui);
}

/// What a phone has no room for in the bar.
fn page_menu_ui(session: &Session, state: &mut UiState, out: &mut Out, ui: &mut Ui) {
    let item = |text, icon| MenuItem { text, icon: Some(icon), ..MenuItem::default() };
    if kit::menu_item_ui(item(text::LIBRARY, Icon::Folder), ui).clicked() {
        state.library_open = true;
    }
    if kit::menu_item_ui(item(text::LESSONS, Icon::Book), ui).clicked() {
        toggle_lessons(session, out);
    }
    if kit::menu_item_ui(item(text::COMPARE, Icon::Swap), ui).clicked() {
        toggle_compare(session, out);
    }
    if kit::menu_item_ui(item(text::UNDO, Icon::Undo), ui).clicked() {
        out.commands.push(Command::Undo);
    }
    if kit::menu_item_ui(item(text::REDO, Icon::Redo), ui).clicked() {
        out.commands.push(Command::Redo);
    }
    if kit::menu_item_ui(item(text::REPORT, Icon::Report), ui).clicked() {
        out.actions.push(Action::CopyReport);
    }
    if kit::menu_item_ui(item(text::THEME, Icon::Contrast), ui).clicked() {
        out.set_once(Key::Theme, other_theme(ui));
    }
    let (language, words) = language_switch(state.language);
    if kit::menu_item_ui(item(words, Icon::Language), ui).clicked() {
        out.set_once(Key::Lang, language);
    }
    if kit::menu_item_ui(item(text::HELP, Icon::Help), ui).clicked() {
        state.help_open = true;
    }
}

fn other_theme(ui: &Ui) -> Value {
    Value::Choice(if theme_of(ui).dark { "light" } else { "dark" })
}

/// The language that the switch leads to, and what it says.
fn language_switch(present: Language) -> (Value, &'static str) {
    let (other, words) = match present {
        Language::English => (Language::Chinese, text::IN_CHINESE),
        Language::Chinese => (Language::English, text::IN_ENGLISH),
    };
    (Value::Choice(other.tag()), words)
}
