//! Metrics as text and as JSON.

use segue_session::metrics::{METRICS, Metric};
use serde_json::{Map, Value as Json, json};

/// Returns metrics as JSON: an object for each by its key in the page's API, with value, unit, and
/// the time of its worst frame.
pub(crate) fn as_json(metrics: &[Metric]) -> Json {
    let rows = metrics.iter().map(|metric| {
        let row = metric.id.row();
        let number =
            json!({ "value": metric.value, "unit": row.unit.text(), "at_s": metric.at_secs });
        (row.name.to_owned(), number)
    });
    Json::Object(rows.collect::<Map<_, _>>())
}

/// Returns the metrics in the order of the page, as names, values and units.
pub(crate) fn as_rows(metrics: &[Metric]) -> Vec<[String; 3]> {
    let listed = METRICS.iter().filter_map(|row| metrics.iter().find(|own| own.id == row.id));
    let row = |metric: &Metric| {
        let row = metric.id.row();
        [row.label.to_owned(), number(metric), row.unit.text().to_owned()]
    };
    listed.map(row).collect()
}

/// Returns the metrics in the order of the page, on one line.
pub(crate) fn on_one_line(metrics: &[Metric]) -> String {
    let rows = as_rows(metrics).into_iter();
    let words = rows.map(|[label, value, unit]| {
        let space = if unit.is_empty() || unit.starts_with('°') { "" } else { " " };
        format!("{} {value}{space}{unit}", label.to_lowercase())
    });
    words.collect::<Vec<_>>().join(", ")
}

/// Returns the number of a metric with the decimals that are read at a glance; a dash for none.
pub(crate) fn number(metric: &Metric) -> String {
    metric.value.map_or_else(
        || "–".to_owned(),
        |value| {
            let text = format!("{value:.*}", metric.id.row().unit.decimals(value));
            // A small negative number is not written as minus zero.
            if text.trim_start_matches('-').chars().all(|digit| "0.".contains(digit)) {
                text.trim_start_matches('-').to_owned()
            } else {
                text
            }
        },
    )
}
