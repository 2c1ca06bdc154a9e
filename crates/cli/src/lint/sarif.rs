//! Findings as SARIF 2.1.0, which code hosts show beside the files.

use super::checks::CHECKS;
use super::finding::{Checked, Finding, Severity};
use percent_encoding::{AsciiSet, NON_ALPHANUMERIC, utf8_percent_encode};
use serde_json::{Value as Json, json};

/// The characters of a relative path that an address must escape (RFC 3986, section 2.3).
const ESCAPED: &AsciiSet =
    &NON_ALPHANUMERIC.remove(b'/').remove(b'-').remove(b'.').remove(b'_').remove(b'~');

/// The rule of files that cannot be read.
const UNREADABLE: &str = "unreadable";

/// Returns the log of a run.
pub(super) fn log(checked: &[Checked]) -> Json {
    let rule = |word: &str, help: &str| json!({ "id": word, "shortDescription": { "text": help } });
    let mut rules: Vec<Json> = CHECKS.iter().map(|check| rule(check.word, check.help)).collect();
    rules.push(rule(UNREADABLE, "The file cannot be read."));
    let results: Vec<Json> = checked.iter().flat_map(results).collect();
    json!({
        "$schema": "https://json.schemastore.org/sarif-2.1.0.json",
        "version": "2.1.0",
        "runs": [{
            "tool": { "driver": {
                "name": "segue lint",
                "version": env!("CARGO_PKG_VERSION"),
                "rules": rules,
            } },
            "columnKind": "unicodeCodePoints",
            "results": results,
        }],
    })
}

fn results(checked: &Checked) -> Vec<Json> {
    let unreadable = checked.error.iter().map(|error| {
        result(UNREADABLE, Severity::Error, &error.text, &checked.file, error.line, error.column)
    });
    let found = checked.findings.iter().map(|finding| {
        let text = if finding.clip.is_empty() {
            finding.text.clone()
        } else {
            format!("{}: {}", finding.clip, finding.text)
        };
        let mut json =
            result(finding.check, finding.severity, &text, &checked.file, finding.line, None);
        json["properties"] = properties(finding);
        json
    });
    unreadable.chain(found).collect()
}

fn properties(finding: &Finding) -> Json {
    json!({
        "clip": finding.clip,
        "value": finding.value,
        "unit": finding.unit,
        "frames": finding.frames,
        "joints": finding.joints,
    })
}

fn result(
    check: &str,
    severity: Severity,
    text: &str,
    file: &str,
    line: Option<usize>,
    column: Option<usize>,
) -> Json {
    let uri = utf8_percent_encode(file, ESCAPED).to_string();
    let mut place = json!({ "artifactLocation": { "uri": uri } });
    if let Some(line) = line {
        place["region"] = json!({ "startLine": line });
        if let Some(column) = column {
            place["region"]["startColumn"] = Json::from(column);
        }
    }
    json!({
        "ruleId": check,
        "level": severity.word(),
        "message": { "text": text },
        "locations": [{ "physicalLocation": place }],
    })
}
