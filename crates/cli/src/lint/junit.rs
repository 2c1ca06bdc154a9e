//! Findings as JUnit's XML, which CI systems show as tests: a suite for each file, a test for each
//! clip.

use super::finding::{Checked, Finding, Severity};
use std::fmt::Write as _;

/// Returns the report of a run.
pub(super) fn report(checked: &[Checked]) -> String {
    let tests: usize = checked.iter().map(|file| file.clips.len().max(1)).sum();
    let errors = checked.iter().filter(|file| file.error.is_some()).count();
    let failures: usize = checked.iter().map(failures).sum();
    let mut xml = format!(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<testsuites name=\"segue lint\" tests=\"{tests}\" failures=\"{failures}\" errors=\"{errors}\">\n"
    );
    for file in checked {
        suite(&mut xml, file);
    }
    xml.push_str("</testsuites>\n");
    xml
}

/// Returns the tests of a file: its clips by name, and its findings. Those about the file belong to
/// the first.
fn tests(file: &Checked) -> Vec<(&str, Vec<&Finding>)> {
    let names: Vec<&str> = match file.clips.as_slice() {
        [] => vec![file.file.as_str()],
        clips => clips.iter().map(String::as_str).collect(),
    };
    let first = names.first().copied().unwrap_or_default();
    let owner = |finding: &Finding| {
        names.iter().copied().find(|name| *name == finding.clip).unwrap_or(first).to_owned()
    };
    names
        .iter()
        .map(|&name| {
            let own = file
                .findings
                .iter()
                .filter(|finding| finding.severity == Severity::Error && owner(finding) == name);
            (name, own.collect())
        })
        .collect()
}

fn failures(file: &Checked) -> usize {
    tests(file).iter().filter(|(_, findings)| !findings.is_empty()).count()
}

fn suite(xml: &mut String, file: &Checked) {
    let tests = tests(file);
    let name = escaped(&file.file);
    // Writing to a string cannot fail.
    writeln!(
        xml,
        "  <testsuite name=\"{name}\" tests=\"{}\" failures=\"{}\" errors=\"{}\">",
        tests.len(),
        failures(file),
        usize::from(file.error.is_some())
    )
    .ok();
    for (place, (clip, findings)) in tests.into_iter().enumerate() {
        writeln!(xml, "    <testcase classname=\"{name}\" name=\"{}\">", escaped(clip)).ok();
        if let Some(error) = file.error.as_ref().filter(|_| place == 0) {
            let text = escaped(&error.text);
            writeln!(xml, "      <error type=\"unreadable\" message=\"{text}\"/>").ok();
        }
        if let Some(first) = findings.first() {
            let all = findings.iter().map(|finding| format!("{}: {}", finding.check, finding.text));
            let all: Vec<String> = all.map(|line| escaped(&line)).collect();
            let (check, text) = (first.check, all.join("\n"));
            let message = all.first().map_or("", String::as_str);
            writeln!(xml, "      <failure type=\"{check}\" message=\"{message}\">{text}</failure>")
                .ok();
        }
        xml.push_str("    </testcase>\n");
    }
    xml.push_str("  </testsuite>\n");
}

/// Escapes a text for XML, without the characters that XML 1.0 does not have.
fn escaped(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for letter in text.chars() {
        match letter {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            '\n' => out.push_str("&#10;"),
            letter if letter.is_control() || matches!(letter, '\u{fffe}' | '\u{ffff}') => {}
            letter => out.push(letter),
        }
    }
    out
}

#[cfg(test)]
mod escape_tests {
    #[test]
    fn escaped_text_is_valid() {
        assert_eq!(super::escaped("a<b> & \"c\"\u{1}\u{1b}走"), "a&lt;b&gt; &amp; &quot;c&quot;走");
    }
}
