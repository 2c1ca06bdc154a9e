//! Overlays of the whole page: notices, the list of shortcuts, a clip that is dragged, and the hint
//! while files are held over the window.

use super::clip_drag::dragged_clip_ui;
use super::commands;
use super::convert_panel::convert_ui;
use super::kit;
use super::language::{Text, say};
use super::notices::notices_ui;
use super::out::Out;
use super::state::UiState;
use super::text;
use super::theme::{Type, palette_of, radius, space, theme_of};
use eframe::egui::{self, Align, Align2, Layout, RichText, Stroke, StrokeKind, Ui, vec2};
use segue_session::Session;

/// Draws the overlays.
pub(crate) fn overlays_ui(session: &Session, state: &mut UiState, out: &mut Out, ui: &mut Ui) {
    notices_ui(session, state, out, ui);
    if state.help_open {
        help_ui(state, ui);
    }
    convert_ui(session, state, out, ui);
    drop_ui(state, ui);
    dragged_clip_ui(session, ui);
}

fn help_ui(state: &mut UiState, ui: &mut Ui) {
    let (theme, palette) = (theme_of(ui), palette_of(ui));
    let rows: Vec<(String, String)> =
        commands::help().map(|(keys, what)| (say(&keys, ui), say(what, ui))).collect();
    // Measured before the first frame: a window that grows with its contents would first cut them.
    let width_of = |text: &str, step: Type, ui: &Ui| {
        let run = kit::paint::Run::new(Text::Data(text), step, palette.text);
        kit::paint::line_of(&[run], f32::INFINITY, ui).size().x.ceil()
    };
    let widest = |widths: Vec<f32>| widths.into_iter().fold(0.0, f32::max);
    let keys = widest(rows.iter().map(|row| width_of(&row.0, Type::Strong, ui)).collect());
    let what = widest(rows.iter().map(|row| width_of(&row.1, Type::Body, ui)).collect());
    let width = (keys + space::L + what + space::L).min(kit::max_dialog_width(ui));
    // On a phone the keys take more lines, too.
    let keys = keys.min((0.4 * width).round());
    let contents = |ui: &mut Ui| {
        ui.spacing_mut().item_spacing = vec2(space::L, space::XS);
        for (key, sentence) in &rows {
            ui.horizontal_top(|ui| {
                let column = vec2(keys, 0.0);
                ui.allocate_ui_with_layout(column, Layout::top_down(Align::Min), |ui| {
                    ui.set_width(keys);
                    let key = RichText::new(say(Text::Data(key), ui));
                    let key = key.font(theme.font(Type::Strong)).color(palette.text);
                    ui.add(egui::Label::new(key).wrap());
                });
                let words = RichText::new(say(Text::Data(sentence), ui));
                let words = words.font(theme.font(Type::Body)).color(palette.muted);
                ui.add(egui::Label::new(words).wrap());
            });
        }
    };
    let open = kit::dialog_ui(text::HELP, width, contents, ui);
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
