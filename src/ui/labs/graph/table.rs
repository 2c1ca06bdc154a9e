//! The metrics of all panes side by side, and buttons that copy them.

use crate::ui::kit::{self, Button};
use crate::ui::language::{Word, say};
use crate::ui::out::{Action, Out};
use crate::ui::text;
use crate::ui::theme::{Type, palette_of, space, theme_of};
use eframe::egui::{Grid, RichText, Ui};
use segue_session::{NumberTable, Session, digits};
use segue_text::Message;

/// Draws the table, and two buttons that copy it.
pub(crate) fn table_ui(session: &Session, out: &mut Out, ui: &mut Ui) {
    let (theme, palette) = (theme_of(ui), palette_of(ui));
    let table = NumberTable::of(session);
    let small = |words: &Message, color, ui: &Ui| {
        RichText::new(say(words, ui)).font(theme.font(Type::Small)).color(color)
    };
    ui.spacing_mut().interact_size.y = 0.0;
    let grid = Grid::new("numbers").num_columns(table.panes.len() + 1).spacing([space::M, 2.0]);
    grid.show(ui, |ui| {
        ui.label("");
        for pane in &table.panes {
            ui.label(small(pane, palette.text, ui));
        }
        ui.end_row();
        for row in &table.rows {
            ui.label(small(&row.heading(), palette.muted, ui))
                .on_hover_text(say(Word::new(row.metric.row().help), ui));
            let ends = row.ends();
            for (pane, value) in row.values.iter().enumerate() {
                let color = match Some(pane) {
                    of if of == ends.best => palette.good,
                    of if of == ends.worst => palette.bad,
                    _ => palette.text,
                };
                ui.label(small(&Message::data(digits(*value)), color, ui));
            }
            ui.end_row();
        }
    });
    ui.add_space(space::XS);
    ui.horizontal(|ui| {
        for (label, copied) in [
            (text::COPY_MARKDOWN, NumberTable::markdown as fn(&NumberTable) -> String),
            (text::COPY_CSV, NumberTable::csv),
        ] {
            if kit::button_ui(Button::new(label), ui).clicked() {
                out.actions.push(Action::CopyText(copied(&table)));
            }
        }
    });
}
