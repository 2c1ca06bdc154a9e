//! The metrics of all panes as a table.

use super::labs::Outcome;
use super::metrics::{Ends, METRICS, MetricId, Unit};
use super::outside::markdown;
use super::pane::Pane;
use super::session::Session;
use segue_formats::csv;
use segue_text::{Message, msg};
use std::collections::BTreeSet;
use std::fmt::Write as _;

/// The heading of a result that is not compared with another one.
const RESULT: Message = Message::word("result");

/// The values of a metric, one for each pane.
#[derive(Clone, Debug, PartialEq)]
pub struct NumberRow {
    /// The metric.
    pub metric: MetricId,
    /// The values, pane by pane; `None` if there is nothing to measure.
    pub values: Vec<Option<f64>>,
}

/// The metrics of all panes, for display and for export.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct NumberTable {
    /// The headings of the panes: the value in which each differs.
    pub panes: Vec<Message>,
    /// The numbers.
    pub rows: Vec<NumberRow>,
}

impl NumberTable {
    /// Returns the table of the current panes.
    #[must_use]
    pub fn of(session: &Session) -> Self {
        let panes = session.panes();
        let name = |pane: &Pane| session.variant_name(pane).unwrap_or(RESULT);
        let of_pane = |pane: &Pane, id| pane.result().ok()?.outcome.metric(id)?.value;
        let results = panes.iter().filter_map(|pane| pane.result().ok());
        let row = |metric: MetricId| NumberRow {
            metric,
            values: panes.iter().map(|pane| of_pane(pane, metric)).collect(),
        };
        let listed = listed_metrics(results.map(|made| &**made.outcome));
        let mut rows: Vec<NumberRow> = listed.into_iter().map(row).collect();
        let walk = |pane: &Pane| pane.result().ok()?.outcome.walk().cloned();
        if panes.iter().any(|pane| walk(pane).is_some()) {
            let built =
                panes.iter().map(|pane| session.graph_build_secs(&walk(pane)?.built)).collect();
            rows.push(NumberRow { metric: MetricId::BuildTime, values: built });
        }
        Self { panes: panes.iter().map(name).collect(), rows }
    }

    /// Returns the table in Markdown.
    #[must_use]
    pub fn markdown(&self) -> String {
        let names: Vec<String> =
            self.panes.iter().map(|name| markdown(&name.to_string())).collect();
        let mut out =
            format!("| | {} |\n|---|{}\n", names.join(" | "), "---|".repeat(self.panes.len()));
        for row in &self.rows {
            let values: Vec<String> = row.values.iter().map(|value| digits(*value)).collect();
            let written = writeln!(out, "| {} | {} |", row.heading(), values.join(" | "));
            debug_assert!(written.is_ok(), "a string takes all");
        }
        out
    }

    /// Returns the table as comma-separated values in full precision. Cells are escaped against
    /// evaluation by spreadsheets ([`csv::cell`]).
    #[must_use]
    pub fn csv(&self) -> String {
        let head: Vec<String> = ["", "unit"]
            .into_iter()
            .map(str::to_owned)
            .chain(self.panes.iter().map(|pane| csv::cell(&pane.to_string())))
            .collect();
        let mut out = head.join(",") + "\n";
        for row in &self.rows {
            let values: Vec<String> = row
                .values
                .iter()
                .map(|value| value.map_or_else(String::new, |value| value.to_string()))
                .collect();
            let metric = row.metric.row();
            let (label, unit) = (csv::cell(metric.label), csv::cell(metric.unit.text()));
            let written = writeln!(out, "{label},{unit},{}", values.join(","));
            debug_assert!(written.is_ok(), "a string takes all");
        }
        out
    }
}

impl NumberRow {
    /// Returns the name of the metric with its unit.
    #[must_use]
    pub fn heading(&self) -> Message {
        let metric = self.metric.row();
        match metric.unit {
            Unit::Count => metric.label.into(),
            unit => msg!("{label}, {unit}", label = metric.label, unit = unit.text()),
        }
    }

    /// Returns the panes with the best and the worst value.
    #[must_use]
    pub fn ends(&self) -> Ends {
        self.metric.row().ends(&self.values)
    }
}

/// Returns the metrics that any of some results has, in the order of [`METRICS`].
pub fn listed_metrics<'a>(results: impl IntoIterator<Item = &'a Outcome>) -> Vec<MetricId> {
    let lists = results.into_iter().flat_map(|outcome| &outcome.metrics);
    let had: BTreeSet<MetricId> = lists.map(|metric| metric.id).collect();
    METRICS.iter().map(|row| row.id).filter(|id| had.contains(id)).collect()
}

/// Formats a number with about three digits; a dash for none.
#[must_use]
pub fn digits(value: Option<f64>) -> String {
    let Some(value) = value else {
        return "–".to_owned();
    };
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn number_table_is_written_as_markdown_and_csv() {
        let table = NumberTable {
            panes: vec!["=1+1".into(), "a|b".into()],
            rows: vec![NumberRow { metric: MetricId::Lag, values: vec![Some(0.416), None] }],
        };
        assert_eq!(table.markdown(), "| | =1+1 | a\\|b |\n|---|---|---|\n| Lag, s | 0.42 | – |\n");
        assert_eq!(table.csv(), ",unit,'=1+1,a|b\nLag,s,0.416,\n");
        assert_eq!(
            [digits(Some(-0.5)), digits(Some(123.4)), digits(Some(12.0))],
            ["−0.5", "123", "12"]
        );
    }
}
