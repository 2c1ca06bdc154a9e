//! The parts of the page of each lab: its panel, the titles of its panes, the start of its
//! comparison.

mod blend;
mod break_it;
mod clean;
mod edit;
mod graph;
mod in_place;
pub(crate) mod in_time;
mod lab_ui;
mod layers;
mod loop_;
mod make;
mod match_;
pub(crate) mod on_stage;
mod path;
mod register;
mod speed;
pub(crate) mod states;
mod transition;
mod view;

pub(crate) use blend::welcome;
pub(crate) use edit::edit_items_ui;
pub(crate) use lab_ui::{Shown, Title};
pub(crate) use view::compare_clips;

use super::kit;
use super::kit::{Button, Icon};
use super::language::Word;
use super::out::Out;
use super::rows::{Detail, compare_choice_ui, footer_ui, lab_label, param_row_ui, slot_row_ui};
use super::state::UiState;
use super::text;
use super::theme::space;
use eframe::egui::{Align, Layout, Ui, UiBuilder};
use graph::seed_detail;
use lab_ui::LabUi;
use segue_session::{Group, Key, Kind, LabId, Mark, PARAMS, Session, Slot};

/// Returns a lab's part of the page.
fn of(lab: LabId) -> &'static LabUi {
    match lab {
        LabId::View => &view::LAB,
        LabId::Make => &make::LAB,
        LabId::Blend => &blend::LAB,
        LabId::Transition => &transition::LAB,
        LabId::Speed => &speed::LAB,
        LabId::Loop => &loop_::LAB,
        LabId::Layers => &layers::LAB,
        LabId::Register => &register::LAB,
        LabId::Path => &path::LAB,
        LabId::Graph => &graph::LAB,
        LabId::Match => &match_::LAB,
        LabId::InPlace => &in_place::LAB,
        LabId::Edit => &edit::LAB,
        LabId::Clean => &clean::LAB,
    }
}

/// Opens "full, half, third" of the lab's main number, or the lab's own comparison; closes an open
/// comparison.
pub(crate) fn toggle_compare(session: &Session, out: &mut Out) {
    of(session.params().lab()).compares.toggle(session, out);
}

/// Returns the title of a pane without a comparison.
pub(crate) fn title(shown: &Shown<'_>) -> Title {
    (of(shown.params.lab()).title)(shown)
}

/// Returns whether the lab has a panel beside the stage, where there is room for one.
pub(crate) fn has_side_panel(session: &Session) -> bool {
    graph::is_open(session)
}

/// Returns the share of the room beside the parameters that the lab's side panel takes.
pub(crate) fn side_panel_share(session: &Session) -> f32 {
    graph::map_share(session)
}

/// Draws the lab's side panel.
pub(crate) fn side_panel_ui(session: &Session, state: &mut UiState, out: &mut Out, ui: &mut Ui) {
    graph::map_panel_ui(session, state, out, ui);
}

/// Returns whether the lab has a figure among its parameters that a lesson may mention.
pub(crate) fn has_figure(session: &Session) -> bool {
    match session.params().lab() {
        LabId::Register | LabId::Graph => true,
        LabId::Transition => transition::has_ruler(session),
        _ => false,
    }
}

/// Draws the figure that the lab has among its parameters, at most about `room` points high.
pub(crate) fn figure_ui(
    session: &Session,
    room: f32,
    state: &mut UiState,
    out: &mut Out,
    ui: &mut Ui,
) {
    match session.params().lab() {
        LabId::Register => register::map_ui(session, room, state, out, ui),
        LabId::Graph => graph::map_ui(session, room, state, out, ui),
        LabId::Transition if transition::has_ruler(session) => transition::ruler_ui(session, ui),
        _ => {}
    }
}

/// Draws the right panel: one section for the lab, two that fold for stage and camera.
pub(crate) fn lab_panel_ui(session: &Session, state: &mut UiState, out: &mut Out, ui: &mut Ui) {
    let lab = of(session.params().lab());
    head_ui(lab, session, state, ui);
    (lab.panel_ui)(session, state, out, ui);
    ui.add_space(space::S);
    compare_choice_ui(session, out, ui);
    ui.add_space(space::L);
    group_ui(text::STAGE, Group::Stage, session, out, ui);
    group_ui(text::CAMERA, Group::Camera, session, out, ui);
}

/// Draws the lab's name, with the switch of all help texts behind it, and the line about it.
fn head_ui(lab: &LabUi, session: &Session, state: &mut UiState, ui: &mut Ui) {
    let name = lab_label(session);
    let header = kit::section_header_with_button_ui(name, ui);
    let builder = UiBuilder::new()
        .max_rect(header)
        .id_salt("help")
        .layout(Layout::right_to_left(Align::Center));
    ui.scope_builder(builder, |ui| {
        let all = Button::icon_only(Icon::Help, text::ALL_HELP).selected(state.all_help);
        state.all_help ^= kit::button_ui(all, ui).clicked();
    });
    kit::set_all_help(state.all_help, ui.ctx());
    let [about, more] = lab.about;
    kit::about_ui(&text::lab(name), about, more, ui);
}

/// Draws the foot of the right panel, which does not scroll: the buttons that keep and save the
/// result. `most` is its greatest height, points.
pub(crate) fn lab_footer_ui(
    session: &Session,
    most: f32,
    state: &mut UiState,
    out: &mut Out,
    ui: &mut Ui,
) {
    footer_ui(session, of(session.params().lab()).kept, most, state, out, ui);
}

fn group_ui(title: Word, group: Group, session: &Session, out: &mut Out, ui: &mut Ui) {
    kit::folded_ui(title, ui, |ui| {
        for param in
            PARAMS.iter().filter(|param| param.group == group && !param.has(Mark::ByPointer))
        {
            param_row_ui(param.key, &Detail::default(), session, out, ui);
        }
    });
}

/// Returns the parameters that an embedding page offers: those that its link names, whatever their
/// values by now, and those of the lab that were changed since. Camera and playback have controls
/// of their own.
fn named_params(session: &Session) -> impl Iterator<Item = Key> + '_ {
    let compared = session.compare().map(|compare| compare.key);
    PARAMS.iter().map(|param| param.key).filter(move |&key| {
        let (group, named) = (key.param().group, session.names(key));
        let changed =
            group.is_of_lab() && session.params().get(key) != &key.param().default_value();
        changed
            || compared == Some(key)
            || (named
                && (group.is_of_lab()
                    || matches!(group, Group::Stage)
                    || matches!(key.param().kind, Kind::Clip)))
    })
}

/// Returns whether there are parameters for an embedding page to offer.
pub(crate) fn has_named_params(session: &Session) -> bool {
    named_params(session).next().is_some()
}

/// Draws the rows of the parameters that an embedding page offers.
pub(crate) fn named_params_ui(session: &Session, out: &mut Out, ui: &mut Ui) {
    for key in named_params(session) {
        match key {
            Key::A => slot_row_ui(Slot::A, session, out, ui),
            Key::B => slot_row_ui(Slot::B, session, out, ui),
            Key::Seed => param_row_ui(key, &seed_detail(session), session, out, ui),
            _ => param_row_ui(key, &Detail::default(), session, out, ui),
        }
    }
}
