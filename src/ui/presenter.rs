//! The presenter mode: the stage alone, for a class. It is a state of the interface and in no link.

use super::appearance::stage_theme;
use super::commands::{UiCommand, command_button_ui};
use super::kit::{self, Button, Icon};
use super::language::{Text, say};
use super::lessons_panel::go_to;
use super::out::{Action, Out};
use super::stage::{Paint, stage_panel_ui};
use super::state::{Layout, Presenter, UiState};
use super::text;
use super::theme::{Theme, Type, palette_of, space, theme_of};
use super::timeline::scrub_ui;
use eframe::egui::accesskit::Role;
use eframe::egui::{
    self, Align, CentralPanel, Event, Frame, Id, LayerId, Layout as Flow, Margin, Order, Panel,
    Popup, RichText, Stroke, Ui,
};
use segue_session::{Command, Key, Kind, Lesson, PlaybackCommand, Session, Value};
use segue_text::{Message, msg};

/// Seconds until the bar leaves after the last movement.
const SHOWN_SECS: f64 = 2.5;
/// Radius of the ring around the pointer, points.
const HALO: f32 = 30.0;

/// Begins to present, or ends it.
pub(crate) fn toggle(state: &mut UiState, out: &mut Out) {
    let is_on = !state.presenter.is_on;
    state.presenter = Presenter { is_on, ..Presenter::default() };
    (state.help_open, state.library_open) = (false, false);
    out.actions.push(Action::Fullscreen(is_on));
}

/// Goes to the next or the previous lesson where one is open, else to the next pane of a
/// comparison, else to the next lab.
pub(crate) fn go(forward: bool, session: &Session, state: &mut UiState, out: &mut Out) {
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
            // All panes, then each alone.
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

/// Goes one of the steps that were asked for while a lesson was being loaded.
fn go_on(session: &Session, state: &mut UiState, out: &mut Out) {
    let steps = state.presenter.steps_to_go;
    match session.lesson() {
        _ if steps == 0 => {}
        Some(Lesson::Waiting) => {}
        Some(Lesson::Page(_) | Lesson::Contents(_)) => {
            state.presenter.steps_to_go -= steps.signum();
            go(steps > 0, session, state, out);
        }
        Some(Lesson::Failed(_)) | None => state.presenter.steps_to_go = 0,
    }
}

/// Returns the step that is shown: the lesson, the pane, or the lab.
fn step_name(session: &Session, state: &UiState) -> Message {
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

/// Draws the page of a presenter: the stage, and over it a bar while the pointer moves.
pub(crate) fn presenter_ui(
    session: &Session,
    state: &mut UiState,
    out: &mut Out,
    paint: Paint<'_>,
    ui: &mut Ui,
) {
    go_on(session, state, out);
    let is_shown = note_movement(state, ui);
    let opacity = ui.ctx().animate_bool(Id::unique("presenter bar"), is_shown);
    // The room for the bar stays empty without it: over the stage it would cover the numbers.
    let look = stage_theme(session, theme_of(ui)).palette();
    let room = Frame::new()
        .fill(look.stage.sky)
        .inner_margin(Margin::symmetric(space::L as i8, space::S as i8));
    let bar = Panel::bottom("presenter bar").exact_size(bar_height(ui)).frame(room);
    bar.resizable(false).show_separator_line(false).show(ui, |ui| {
        if opacity > 0.0 {
            kit::set_role(Role::Region, text::TIMELINE, ui);
            ui.painter().rect_filled(ui.max_rect().expand(20.0), 0.0, palette_of(ui).panel);
            ui.set_opacity(opacity);
            bar_ui(session, state, out, ui);
        }
    });
    let layout = if state.layout == Layout::Phone { Layout::Phone } else { Layout::Desk };
    let large = Theme { presents: layout != Layout::Phone, ..theme_of(ui) };
    large.within(ui, |ui| {
        CentralPanel::default().frame(Frame::new()).show(ui, |ui| {
            kit::set_role(Role::Main, text::STAGE, ui);
            stage_panel_ui(session, layout, state, out, paint, ui);
        });
    });
    halo_ui(ui);
}

/// Returns whether the bar is shown: for a while after the pointer or a key was used, and as long
/// as the pointer rests on it.
fn note_movement(state: &mut UiState, ui: &Ui) -> bool {
    let presenter = &mut state.presenter;
    let (now, is_moving, pointer) = ui.input(|input| {
        let is_input = |event: &Event| {
            use Event::{Key, MouseWheel, PointerButton, PointerMoved};
            matches!(event, Key { .. } | MouseWheel { .. } | PointerButton { .. } | PointerMoved(_))
        };
        let is_used = input.events.iter().any(is_input) || input.pointer.any_down();
        (input.time, is_used, input.pointer.hover_pos())
    });
    let page = ui.max_rect();
    let bar = page.with_min_y(page.bottom() - bar_height(ui));
    let is_busy = pointer.is_some_and(|at| bar.contains(at)) || Popup::is_any_open(ui.ctx());
    if is_moving || is_busy || presenter.shown_until == f64::INFINITY {
        presenter.shown_until = now + SHOWN_SECS;
    }
    let left = presenter.shown_until - now;
    if left > 0.0 {
        ui.ctx().request_repaint_after(std::time::Duration::from_secs_f64(left));
    }
    left > 0.0
}

fn bar_height(ui: &Ui) -> f32 {
    theme_of(ui).row_height().max(34.0) + 2.0 * space::S
}

/// Draws the bar: play, the time, the way back and forth, and the way out.
fn bar_ui(session: &Session, state: &mut UiState, out: &mut Out, ui: &mut Ui) {
    let (theme, palette) = (theme_of(ui), palette_of(ui));
    ui.horizontal_centered(|ui| {
        let playing = session.params().is_on(Key::Play);
        if kit::play_button_ui(playing, ui) {
            out.commands.push(Command::Playback(PlaybackCommand::TogglePlay));
        }
        let time = format!("{:.2} s", session.now_secs());
        let time = RichText::new(say(Text::Data(&time), ui));
        ui.label(time.font(theme.font(Type::Number)).color(palette.text));
        ui.with_layout(Flow::right_to_left(Align::Center), |ui| {
            for (command, icon) in [
                (UiCommand::Present, Icon::Close),
                (UiCommand::NextStep, Icon::ChevronRight),
                (UiCommand::PreviousStep, Icon::ChevronLeft),
            ] {
                let button = Button::icon_only(icon, command.name(state));
                command_button_ui(command, button, session, state, out, ui);
            }
            let words = RichText::new(say(&step_name(session, state), ui))
                .font(theme.font(Type::Strong))
                .color(palette.text);
            ui.add(egui::Label::new(words).truncate());
            ui.add_space(space::M);
            ui.with_layout(Flow::top_down(Align::Min), |ui| scrub_ui(session, out, ui));
        });
    });
}

/// Draws a ring around the pointer, so that a class sees where it is.
fn halo_ui(ui: &Ui) {
    let Some(at) = ui.input(|input| input.pointer.hover_pos()) else {
        return;
    };
    let palette = palette_of(ui);
    let layer = LayerId::new(Order::Tooltip, Id::unique("presenter halo"));
    ui.ctx().layer_painter(layer).circle(
        at,
        HALO,
        palette.accent.gamma_multiply(0.16),
        Stroke::new(3.0, palette.accent.gamma_multiply(0.7)),
    );
}
