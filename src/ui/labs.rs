//! What each lab has on the page: its panel, and what its comparison begins with.

mod blend;
mod break_it;
pub(crate) mod graph;
mod layers;
mod loop_;
mod make;
pub(crate) mod match_;
pub(crate) mod path;
mod register;
mod speed;
mod transition;
mod view;

use super::kit;
use super::out::Out;
use super::rows::{Detail, compare_choice_ui, compare_clips, param_row_ui, slot_row_ui};
use super::state::UiState;
use super::text;
use super::theme::space;
use eframe::egui::Ui;
use graph::seed_detail;
use segue_session::LabId;
use segue_session::{Command, Group, Key, PARAMS, Session, Slot, Value};

/// A lab's part of the page.
struct LabUi {
    /// The rows of its panel.
    panel_ui: fn(&Session, &mut UiState, &mut Out, &mut Ui),
    /// What its comparison begins with.
    compares: Compares,
}

/// What a comparison begins with.
enum Compares {
    /// A parameter: the value that is set, and others.
    Key(Key),
    /// What the lab chooses itself.
    Own(fn(&Session, &mut Out)),
}

/// Returns the part of the page that a lab has.
fn of(lab: LabId) -> LabUi {
    let (panel_ui, compares): (fn(&Session, &mut UiState, &mut Out, &mut Ui), _) = match lab {
        LabId::View => (
            view::view_ui,
            Compares::Own(|session, out| {
                compare_clips(session.params().text(Key::A), session.params().text(Key::B), out);
            }),
        ),
        LabId::Make => (
            make::make_ui,
            Compares::Own(|session, out| {
                out.commands.push(Command::Compare(make::made_number(session)));
            }),
        ),
        LabId::Blend => (blend::blend_ui, Compares::Key(Key::BlendWindow)),
        LabId::Transition => (transition::transition_ui, Compares::Key(Key::HalfLife)),
        LabId::Speed => (speed::speed_ui, Compares::Own(speed::compare_speeds)),
        LabId::Loop => (loop_::loop_ui, Compares::Own(loop_::compare_loops)),
        LabId::Layers => (layers::layers_ui, Compares::Key(Key::LayerWeight)),
        LabId::Register => (register::register_ui, Compares::Own(register::compare_warps)),
        LabId::Path => (path::path_ui, Compares::Own(path::compare_points)),
        LabId::Graph => (graph::graph_ui, Compares::Own(|_, out| graph::compare_windows(out))),
        LabId::Match => (match_::drive_ui, Compares::Own(match_::compare_hysteresis)),
    };
    LabUi { panel_ui, compares }
}

/// Opens "full, half, third" of the lab's first number, or what else the lab has to compare, or
/// goes back to one pane.
pub(crate) fn toggle_compare(session: &Session, out: &mut Out) {
    if session.panes().len() > 1 {
        out.set_once(Key::Compare, Value::Text(String::new()));
        return;
    }
    match of(session.params().lab()).compares {
        Compares::Key(key) => out.commands.push(Command::Compare(key)),
        Compares::Own(compare) => compare(session, out),
    }
}

/// The right panel: one section for the lab, two that fold for stage and camera.
pub(crate) fn lab_panel_ui(session: &Session, state: &mut UiState, out: &mut Out, ui: &mut Ui) {
    (of(session.params().lab()).panel_ui)(session, state, out, ui);
    ui.add_space(space::S);
    compare_choice_ui(session, out, ui);
    ui.add_space(space::L);
    group_ui(text::STAGE, Group::Stage, session, out, ui);
    group_ui(text::CAMERA, Group::Camera, session, out, ui);
}

fn group_ui(title: &str, group: Group, session: &Session, out: &mut Out, ui: &mut Ui) {
    kit::folded_ui(title, ui, |ui| {
        for param in
            PARAMS.iter().filter(|param| param.group == group && !is_handled_elsewhere(param.key))
        {
            param_row_ui(param.key, &Detail::default(), session, out, ui);
        }
    });
}

/// What only the pointer on the stage sets.
fn is_handled_elsewhere(key: Key) -> bool {
    matches!(key, Key::PanX | Key::PanY | Key::PanZ)
}

/// The parameters that an embedding page wants its readers to try: those that its link names,
/// whatever they are by now, and those of the lab that were changed since. Looking around and
/// playing have controls of their own.
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
                    || matches!(key, Key::A | Key::B)))
    })
}

/// Whether the link names a parameter of the lab.
pub(crate) fn has_named_params(session: &Session) -> bool {
    named_params(session).next().is_some()
}

/// Their rows.
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
