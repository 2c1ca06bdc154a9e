//! What each lab has on the page: its panel, the titles of its panes, what its comparison begins
//! with.

pub(crate) mod blend;
mod break_it;
pub(crate) mod graph;
mod in_place;
mod layers;
mod loop_;
pub(crate) mod make;
pub(crate) mod match_;
pub(crate) mod path;
mod register;
mod speed;
pub(crate) mod transition;
pub(crate) mod view;

use super::kit;
use super::out::Out;
use super::rows::{Detail, compare_choice_ui, param_row_ui, slot_row_ui};
use super::state::UiState;
use super::text;
use super::theme::space;
use eframe::egui::Ui;
use glam::DVec2;
use graph::seed_detail;
use segue_session::LabId;
use segue_session::{Command, Group, Key, Kind, Mark, PARAMS, Pane, Params, Session, Slot};
use segue_text::Message;

/// A lab's part of the page; each lab's own file has it, as `LAB`.
struct LabUi {
    /// The rows of its panel.
    panel_ui: fn(&Session, &mut UiState, &mut Out, &mut Ui),
    /// What its comparison begins with.
    compares: Compares,
    /// What stands above a pane.
    title: fn(&Shown<'_>) -> Title,
    /// What to look at on the stage, in one line.
    hint: fn(&Session) -> Option<&'static str>,
    /// Takes a line that was drawn over the ground; `None` where none can be drawn.
    take_line: Option<TakeLine>,
}

/// Takes a line over the ground, x and z in metres.
type TakeLine = fn(&[DVec2], &Session, &mut UiState, &mut Out);

/// What a comparison begins with.
enum Compares {
    /// A parameter: the value that is set, and others.
    Key(Key),
    /// What the lab chooses itself.
    Own(fn(&Session, &mut Out)),
}

/// What a pane shows.
pub(crate) struct Shown<'a> {
    pub(crate) pane: &'a Pane,
    /// The parameters of what is on the stage; without anything there, of what is asked for.
    pub(crate) params: &'a Params,
    pub(crate) session: &'a Session,
}

impl Shown<'_> {
    /// Returns the name of the clip in A or B.
    fn name(&self, key: Key) -> Message {
        self.name_of(self.params.text(key)).unwrap_or_default()
    }

    /// Returns the name of a clip of the library; `None` for one that is not there.
    fn name_of(&self, id: &str) -> Option<Message> {
        self.session.library().find(id).map(|entry| entry.title())
    }

    /// Returns the word on screen of a parameter's value.
    fn spoken(&self, key: Key) -> Message {
        key.param().spoken(self.params.get(key))
    }
}

/// What stands above a pane.
#[derive(Default)]
pub(crate) struct Title {
    pub(crate) strong: Message,
    pub(crate) text: Message,
    pub(crate) secondary: Message,
}

/// Returns the part of the page that a lab has.
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
    }
}

/// Returns what a pane says of itself, where it is compared with no other.
pub(crate) fn title(shown: &Shown<'_>) -> Title {
    (of(shown.params.lab()).title)(shown)
}

/// Returns what to look at, in one line.
pub(crate) fn hint(session: &Session) -> Option<&'static str> {
    (of(session.params().lab()).hint)(session)
}

/// Returns whether a line can be drawn over the ground.
pub(crate) fn takes_lines(session: &Session) -> bool {
    of(session.params().lab()).take_line.is_some()
}

/// Hands a line that was drawn over the ground to the lab that is open.
pub(crate) fn take_line(points: &[DVec2], session: &Session, state: &mut UiState, out: &mut Out) {
    if let Some(take_line) = of(session.params().lab()).take_line {
        take_line(points, session, state, out);
    }
}

/// Opens "full, half, third" of the lab's first number, or what else the lab has to compare, or
/// goes back to one pane.
pub(crate) fn toggle_compare(session: &Session, out: &mut Out) {
    if session.panes().len() > 1 {
        out.compare(None);
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
            PARAMS.iter().filter(|param| param.group == group && !param.has(Mark::ByPointer))
        {
            param_row_ui(param.key, &Detail::default(), session, out, ui);
        }
    });
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
                    || matches!(key.param().kind, Kind::Clip)))
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
