//! The presenter mode: the stage alone, for a class. It is a state of the interface and in no link.

pub(crate) mod steps;

use super::appearance::stage_theme;
use super::commands::{UiCommand, command_button_ui};
use super::kit::{self, Button, Icon};
use super::language::{Text, say};
use super::out::Out;
use super::stage::{Paint, stage_panel_ui};
use super::state::{Layout, UiState};
use super::text;
use super::theme::{Theme, Type, palette_of, space, theme_of};
use super::timeline::scrub_ui;
use eframe::egui::accesskit::Role;
use eframe::egui::{
    self, Align, CentralPanel, Event, Frame, Id, LayerId, Layout as Flow, Margin, Order, Panel,
    Popup, RichText, Stroke, Ui,
};
use segue_session::{Command, Key, PlaybackCommand, Session};
use steps::{step_name, take_requested_step};

/// Seconds from the last movement until the bar hides.
const SHOWN_SECS: f64 = 2.5;
/// Radius of the ring around the pointer, points.
const HALO: f32 = 30.0;

/// Draws the page of a presenter: the stage, and over it a bar while the pointer moves.
pub(crate) fn presenter_ui(
    session: &Session,
    state: &mut UiState,
    out: &mut Out,
    paint: Paint<'_>,
    ui: &mut Ui,
) {
    take_requested_step(session, state, out);
    let is_shown = note_movement(state, ui);
    let opacity = ui.ctx().animate_bool(Id::unique("presenter bar"), is_shown);
    // The room for the bar stays reserved while it is hidden: over the stage it would cover the
    // numbers.
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

/// Returns whether the bar is shown: for a while after input of the pointer or a key, and while the
/// pointer is over it.
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

/// Draws the bar: play, the time, the previous and next step, and the button that ends the mode.
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
