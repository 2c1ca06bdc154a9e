//! The numbers of all panes side by side, to be read and to be copied.

use crate::ui::kit::{self, Button};
use crate::ui::lab_panel::value_in_words;
use crate::ui::language::tr;
use crate::ui::out::{Action, Out};
use crate::ui::text;
use crate::ui::theme::{Type, palette_of, space, theme_of};
use eframe::egui::{Grid, RichText, Ui};
use segue::metrics::Better;
use segue::session::Session;
use std::fmt::Write as _;

/// A row of numbers, one for each pane.
struct Row {
    label: &'static str,
    unit: &'static str,
    help: &'static str,
    better: Better,
    values: Vec<Option<f64>>,
}

struct Table {
    panes: Vec<String>,
    rows: Vec<Row>,
}

impl Table {
    fn of(session: &Session) -> Self {
        let panes = session.panes();
        let name = |index: usize| {
            panes[index]
                .variant
                .as_ref()
                .map_or_else(|| text::RESULT.to_owned(), value_in_words)
        };
        let first = panes.iter().find_map(|pane| pane.outcome.as_ref());
        let of_pane = |pane: &segue::session::Pane, id: &str| {
            let outcome = pane.outcome.as_ref().filter(|_| pane.problem.is_none())?;
            outcome.metrics.iter().find(|metric| metric.id == id)?.value
        };
        let mut rows: Vec<Row> = first
            .map(|outcome| outcome.metrics.as_slice())
            .unwrap_or_default()
            .iter()
            .map(|metric| Row {
                label: metric.label,
                unit: metric.unit,
                help: metric.help,
                better: metric.better,
                values: panes.iter().map(|pane| of_pane(pane, metric.id)).collect(),
            })
            .collect();
        let built = panes.iter().map(|pane| {
            let walk = pane.outcome.as_ref()?.walk.as_ref()?;
            session.graph_build_secs(&walk.built)
        });
        rows.push(Row {
            label: text::BUILD_TIME,
            unit: "s",
            help: "What it took here to compare the clips, as far as that was not done before, and to make the graph.",
            better: Better::Neutral,
            values: built.collect(),
        });
        Self {
            panes: (0..panes.len()).map(name).collect(),
            rows,
        }
    }

    fn heading(row: &Row) -> String {
        if row.unit.is_empty() {
            row.label.to_owned()
        } else {
            format!("{}, {}", row.label, row.unit)
        }
    }

    fn markdown(&self) -> String {
        let mut out = format!("| | {} |\n|---|{}\n", self.panes.join(" | "), "---|".repeat(self.panes.len()));
        for row in &self.rows {
            let values: Vec<String> = row.values.iter().map(|value| digits(*value)).collect();
            let written = writeln!(out, "| {} | {} |", Self::heading(row), values.join(" | "));
            debug_assert!(written.is_ok(), "a string takes all");
        }
        out
    }

    fn csv(&self) -> String {
        let quoted = |text: &str| format!("\"{}\"", text.replace('"', "\"\""));
        let head: Vec<String> = ["", "unit"]
            .into_iter()
            .map(str::to_owned)
            .chain(self.panes.iter().map(|pane| quoted(pane)))
            .collect();
        let mut out = head.join(",") + "\n";
        for row in &self.rows {
            let values: Vec<String> = row
                .values
                .iter()
                .map(|value| value.map_or_else(String::new, |value| value.to_string()))
                .collect();
            let written = writeln!(out, "{},{},{}", quoted(row.label), quoted(row.unit), values.join(","));
            debug_assert!(written.is_ok(), "a string takes all");
        }
        out
    }
}

fn digits(value: Option<f64>) -> String {
    let Some(value) = value else { return "–".to_owned() };
    let decimals = match value.abs() {
        large if large >= 100.0 => 0,
        middle if middle >= 10.0 => 1,
        _ => 2,
    };
    let digits = format!("{value:.decimals$}");
    let digits = if digits.contains('.') {
        digits.trim_end_matches('0').trim_end_matches('.')
    } else {
        &digits
    };
    digits.replace('-', "−")
}

/// The table, and two buttons that copy it.
pub(super) fn table_ui(session: &Session, out: &mut Out, ui: &mut Ui) {
    let (theme, palette) = (theme_of(ui), palette_of(ui));
    let table = Table::of(session);
    let small = |words: &str, color, ui: &Ui| RichText::new(tr(words, ui)).font(theme.font(Type::Small)).color(color);
    ui.spacing_mut().interact_size.y = 0.0;
    let grid = Grid::new("numbers").num_columns(table.panes.len() + 1).spacing([space::M, 2.0]);
    grid.show(ui, |ui| {
        ui.label("");
        for pane in &table.panes {
            ui.label(small(pane, palette.text, ui));
        }
        ui.end_row();
        for row in &table.rows {
            ui.label(small(&Table::heading(row), palette.muted, ui))
                .on_hover_text(tr(row.help, ui));
            let [best, worst] = ends(row);
            for value in &row.values {
                let color = match value {
                    Some(value) if Some(*value) == best => palette.good,
                    Some(value) if Some(*value) == worst => palette.bad,
                    _ => palette.text,
                };
                ui.label(small(&digits(*value), color, ui));
            }
            ui.end_row();
        }
    });
    ui.add_space(space::XS);
    ui.horizontal(|ui| {
        for (label, copied) in [
            (text::COPY_MARKDOWN, Table::markdown as fn(&Table) -> String),
            (text::COPY_CSV, Table::csv),
        ] {
            if kit::button_ui(Button::new(label), ui).clicked() {
                out.actions.push(Action::CopyText(copied(&table)));
            }
        }
    });
}

/// The best and the worst value; none where they are alike, and where none is better.
fn ends(row: &Row) -> [Option<f64>; 2] {
    let values = || row.values.iter().flatten().copied();
    let (low, high) = (values().min_by(f64::total_cmp), values().max_by(f64::total_cmp));
    match (low, high, row.better) {
        (Some(low), Some(high), Better::Lower) if high - low > 0.05 * high.abs() => [Some(low), Some(high)],
        (Some(low), Some(high), Better::Higher) if high - low > 0.05 * high.abs() => [Some(high), Some(low)],
        _ => [None, None],
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_table_is_written_twice() {
        let table = Table {
            panes: vec!["30 frames".into(), "10 frames".into()],
            rows: vec![Row {
                label: "Drag",
                unit: "s",
                help: "",
                better: Better::Lower,
                values: vec![Some(0.416), None],
            }],
        };
        assert_eq!(
            table.markdown(),
            "| | 30 frames | 10 frames |\n|---|---|---|\n| Drag, s | 0.42 | – |\n"
        );
        assert_eq!(table.csv(), ",unit,\"30 frames\",\"10 frames\"\n\"Drag\",\"s\",0.416,\n");
        assert_eq!([digits(Some(-0.5)), digits(Some(123.4)), digits(Some(12.0))], ["−0.5", "123", "12"]);
    }
}
