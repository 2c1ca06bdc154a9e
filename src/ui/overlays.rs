//! Overlays of the whole page: notices, the list of shortcuts, a clip that is dragged, and the hint
//! while files are held over the window.

use super::clip_drag::dragged_clip_ui;
use super::commands;
use super::kit;
use super::language::say;
use super::notices::notices_ui;
use super::out::Out;
use super::state::UiState;
use super::text;
use super::theme::{Type, palette_of, radius, space, theme_of};
use eframe::egui::{self, Align2, Grid, RichText, Stroke, StrokeKind, Ui};
use segue_session::Session;

/// Draws the overlays.
pub(crate) fn overlays_ui(session: &Session, state: &mut UiState, out: &mut Out, ui: &mut Ui) {
    notices_ui(session, state, out, ui);
    if state.help_open {
        help_ui(state, ui);
    }
    drop_ui(state, ui);
    dragged_clip_ui(session, ui);
}

fn help_ui(state: &mut UiState, ui: &mut Ui) {
    let (theme, palette) = (theme_of(ui), palette_of(ui));
    let mut open = true;
    egui::Window::new(RichText::new(say(text::HELP, ui)).font(theme.font(Type::Title)))
        .anchor(Align2::CENTER_CENTER, [0.0, 0.0])
        .collapsible(false)
        .resizable(false)
        .open(&mut open)
        .show(ui.ctx(), |ui| {
            Grid::new("shortcuts").num_columns(2).spacing([space::L, space::XS]).show(ui, |ui| {
                for (keys, what) in commands::help() {
                    ui.label(
                        RichText::new(say(&keys, ui))
                            .font(theme.font(Type::Strong))
                            .color(palette.text),
                    );
                    ui.label(
                        RichText::new(say(what, ui))
                            .font(theme.font(Type::Body))
                            .color(palette.muted),
                    );
                    ui.end_row();
                }
            });
        });
    state.help_open &= open;
}

/// Draws the hint over the whole page while files are held over the window.
fn drop_ui(state: &UiState, ui: &Ui) {
    if ui.input(|input| input.raw.hovered_files.is_empty()) {
        return;
    }
    let (theme, palette) = (theme_of(ui), palette_of(ui));
    let screen = ui.ctx().content_rect();
    let painter = ui
        .ctx()
        .layer_painter(egui::LayerId::new(egui::Order::Foreground, egui::Id::unique("drop")));
    painter.rect_filled(screen, 0.0, palette.ground.gamma_multiply(0.7));
    painter.rect_stroke(
        screen.shrink(space::M),
        radius::L,
        Stroke::new(2.0, palette.accent),
        StrokeKind::Inside,
    );
    let words = painter.text(
        screen.center(),
        Align2::CENTER_CENTER,
        say(text::DROP_NOW, ui),
        theme.font(Type::Title),
        palette.text,
    );
    if state.host_reads {
        let warning = kit::paint::paragraph(
            text::HOST_READS,
            Type::Body,
            palette.warning,
            screen.width() - 4.0 * space::L,
            ui,
        );
        let place = Align2::CENTER_TOP
            .anchor_size(words.center_bottom() + egui::vec2(0.0, space::M), warning.size());
        painter.galley(place.min, warning, palette.warning);
    }
}
