//! Every sentence on screen has a Chinese one in `assets/lang/zh-Hant.json`, and every entry there
//! is used by the program. The sentences are read from the sources, so that a new one cannot be
//! forgotten.

use segue_session::metrics::METRICS;
use segue_session::{Kind, PARAMS};
use segue_text::{Table, text_of_template};
use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::Path;

/// Sources without sentences for the screen: names for graphics tools, keywords of files and
/// reports, and the page's API and its test programs, whose messages are English.
const NOT_SHOWN: [&str; 18] = [
    "crates/session/src/jobs/parcel.rs",
    "crates/session/src/jobs/error.rs",
    "crates/formats/src/fbx/write/records.rs",
    "crates/session/src/report.rs",
    "src/app/api.rs",
    "src/app/api/error.rs",
    "crates/formats/src/bvh/write.rs",
    "crates/motion/src/graph/export.rs",
    "crates/motion/src/lib.rs",
    "src/main.rs",
    "src/platform/file_bytes.rs",
    "src/platform/native/reader.rs",
    "src/platform/web/pool.rs",
    "src/web_api.rs",
    "src/render/pipelines.rs",
    "src/render/pipelines/stage.rs",
    "src/render/renderer.rs",
    "src/render/targets.rs",
];

/// Sources in which single words are texts; elsewhere a word without a space is taken for a key,
/// unless it is made a `Word`.
const WORDS: [&str; 2] = ["src/ui/text/", "src/ui/kit/words.rs"];

/// The tables whose rows are data: they are read as such, not from their sources.
const TABLES: [&str; 3] = [
    "crates/session/src/params/table.rs",
    "crates/session/src/metrics/table.rs",
    "crates/session/src/params/choices.rs",
];

/// Code before a literal that users do not see: reasons for programmers, the log, names of widgets.
const UNSEEN: [&str; 18] = [
    "reason = ",
    "expect(",
    "unreachable!(",
    "debug_assert!(",
    "assert!(",
    "Id::unique(",
    "Id::unique((",
    "Id::new(",
    "Grid::new(",
    "Plot::new(",
    "Panel::top(",
    "Panel::left(",
    "Panel::right(",
    "Panel::bottom(",
    "id_salt(",
    "label: Some(",
    "feature = ",
    "include_str!(",
];

/// Literals that look like sentences and are not: names of files, of joints and of widgets' memory,
/// errors that the page's scripts get, and texts that only the tests of a library read.
const NO_SENTENCE: [&str; 37] = [
    "Lcl Rotation",
    "Lcl Translation",
    "{} and {}",
    "{} and {} registered",
    "{} loop",
    "{} in place",
    "{} clean",
    "{} edited",
    "{} with root motion",
    "{} to {}",
    "{} on a path",
    "node {index}",
    "(prefers-reduced-motion: reduce)",
    "try it",
    "End Site",
    "Library/Application Support",
    "motion graph.json",
    "motion graph.dot",
    "graph drawn",
    "held pin",
    "matrix tiles",
    "curve menu",
    "Inter SemiBold",
    "Noto Sans TC",
    "segue outline",
    "segue pacing",
    "(pointer: coarse)",
    "LargeFile({} bytes)",
    "WebGPU: {}. WebGL 2: {}",
    "the WebGL context was lost",
    "the browser provides no working WebGL context",
    "a joint that this skeleton does not have",
    "no joint was found for the {}: choose one by hand",
    "`{name}` is the {}: chosen by hand",
    "`{name}` is the {}: by its name",
    "`{name}` is the {}: by where it lies in the body, its name does not tell",
    "frames {} to {} turn by up to {turn_dps:.0}°/s, and the original by {limit_dps:.0}°/s: widen the bend or slow down",
];

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// Returns the text of the translations, and its entries.
fn catalogue() -> (String, BTreeMap<String, String>) {
    let text = fs::read_to_string(root().join("assets/lang/zh-Hant.json"))
        .expect("the catalogue is there");
    let sections: BTreeMap<String, BTreeMap<String, String>> =
        serde_json::from_str(&text).expect("the catalogue is JSON");
    (text, sections.into_values().flatten().collect())
}

/// A string literal, with the code before and after it.
struct Literal<'a> {
    before: &'a str,
    text: String,
    after: &'a str,
}

/// Returns the string literals of a source, without those of comments and tests.
fn literals(source: &str) -> Vec<Literal<'_>> {
    let mut found = Vec::new();
    let bytes = source.as_bytes();
    let mut at = 0;
    while at < bytes.len() {
        let rest = &source[at..];
        if rest.starts_with("//") {
            at += rest.find('\n').unwrap_or(rest.len());
        } else if bytes[at] == b'"' {
            let (text, end) = quoted(source, at + 1);
            found.push(Literal { before: &source[..at], text, after: &source[end..] });
            at = end;
        } else if bytes[at] == b'\'' {
            // A character literal, not a lifetime.
            let letter = rest[1..].chars().next();
            let closes = |skip: usize| rest[skip..].find('\'').filter(|&close| close <= 10);
            at += match letter {
                Some('\\') => {
                    2 + closes(2)
                        .map_or(0, |close| close + usize::from(rest[2..].starts_with('\'')) + 1)
                }
                Some(letter) if rest[1 + letter.len_utf8()..].starts_with('\'') => {
                    2 + letter.len_utf8()
                }
                _ => 1,
            };
        } else {
            at += rest.chars().next().map_or(1, char::len_utf8);
        }
    }
    found
}

/// Returns the text of the literal that begins at a byte, and the position of its end.
fn quoted(source: &str, from: usize) -> (String, usize) {
    let mut text = String::new();
    let mut letters = source[from..].char_indices();
    while let Some((at, letter)) = letters.next() {
        match letter {
            '"' => return (text, from + at + 1),
            '\\' => match letters.next().map(|(_, letter)| letter) {
                Some('\n') => {
                    while letters.clone().next().is_some_and(|(_, letter)| letter.is_whitespace()) {
                        letters.next();
                    }
                }
                Some('n') => text.push('\n'),
                Some(letter) => text.push(letter),
                None => break,
            },
            letter => text.push(letter),
        }
    }
    panic!("a literal without an end at byte {from}");
}

/// Returns a source without its items for tests; its other lines stay the same.
fn without_tests(source: &str) -> String {
    let mut code = String::new();
    let mut end: Option<String> = None;
    let mut for_tests = false;
    for line in source.lines() {
        let item = line.trim_start();
        if let Some(last) = &end {
            if line == last {
                end = None;
            }
        } else if item.starts_with("#[cfg(test)]") || item.starts_with("#[cfg(all(test,") {
            for_tests = true;
        } else if for_tests {
            if !item.starts_with("#[") {
                for_tests = false;
                end =
                    line.ends_with('{').then(|| format!("{}}}", &line[..line.len() - item.len()]));
            }
        } else {
            code.push_str(line);
            code.push('\n');
        }
    }
    code
}

/// Returns the sources of the program, by their paths, without those for tests.
fn sources() -> Vec<(String, String)> {
    let mut open = ["src", "crates/motion/src", "crates/formats/src", "crates/session/src"]
        .map(|folder| root().join(folder))
        .to_vec();
    let mut found = Vec::new();
    while let Some(folder) = open.pop() {
        for entry in fs::read_dir(folder).expect("a folder of sources") {
            let path = entry.expect("an entry").path();
            let name = path
                .strip_prefix(root())
                .expect("below the root")
                .to_string_lossy()
                .replace('\\', "/");
            if path.is_dir() {
                if !["tests", "fixtures"].iter().any(|part| name.ends_with(part)) {
                    open.push(path);
                }
            } else if !["tests.rs", "fixtures.rs", "gallery.rs", ".wgsl"]
                .iter()
                .any(|end| name.ends_with(end))
            {
                found.push((
                    name,
                    without_tests(&fs::read_to_string(&path).expect("a source is text")),
                ));
            }
        }
    }
    found.sort();
    found
}

fn is_two_letters(text: &str) -> bool {
    text.as_bytes().windows(2).any(|pair| pair.iter().all(u8::is_ascii_alphabetic))
}

/// Returns the sentences and words of a source that are shown on screen.
fn shown(path: &str, source: &str) -> Vec<String> {
    let words = WORDS.iter().any(|folder| path.starts_with(folder));
    literals(source)
        .into_iter()
        .filter_map(|literal| {
            let text = literal.text.clone();
            let before = literal.before.trim_end();
            let is_key = || {
                let next = literal.after.trim_start();
                next.starts_with("=>") || next.starts_with('|') || before.ends_with('|')
            };
            let is_error = before.ends_with("#[error(");
            let is_sentence = text.trim().contains(' ') || is_error;
            let is_query =
                text.contains(['_', '=', '&', '\n']) || text.contains(':') && !text.contains(' ');
            let is_word = before.ends_with("Word::new(") || words && !is_query && !is_key();
            let unseen = || {
                let start = before.len()
                    - before
                        .char_indices()
                        .rev()
                        .take(24)
                        .last()
                        .map_or(0, |(at, _)| before.len() - at);
                let near = &literal.before[start..];
                UNSEEN.iter().any(|sign| near.ends_with(sign) || near.trim_end().ends_with(sign))
                    || in_log(literal.before)
            };
            let seen =
                is_two_letters(&text_of_template(&text)) && (is_sentence || is_word) && !unseen();
            (seen && !NO_SENTENCE.contains(&text.as_str())).then_some(text)
        })
        .collect()
}

/// Returns whether the code that follows is inside a call of the log or of an assertion.
fn in_log(before: &str) -> bool {
    let statement = before.rfind([';', '{', '}']).map_or(before, |at| &before[at..]);
    ["log::", "debug_assert"].iter().any(|call| statement.contains(call))
}

#[test]
fn every_sentence_has_its_translation() {
    let (_, entries) = catalogue();
    let keys: BTreeSet<&str> = entries.keys().map(String::as_str).collect();
    let mut missing = BTreeSet::new();
    let mut seen = 0;
    for (path, source) in sources().iter().filter(|(path, _)| !NOT_SHOWN.contains(&path.as_str())) {
        // The rows of the tables and the words of choices are checked below.
        if TABLES.contains(&path.as_str()) {
            continue;
        }
        for text in shown(path, source) {
            seen += 1;
            if !keys.contains(text.as_str()) {
                missing.insert(format!("{path}: {text:?}"));
            }
        }
    }
    for param in PARAMS {
        let choices = if let Kind::Choice(choices) = param.kind { choices } else { &[] };
        let texts = [param.label, param.help, param.unit].into_iter();
        for text in texts.chain(choices.iter().map(|choice| choice.label)) {
            if is_two_letters(text) && !keys.contains(text) {
                missing.insert(format!("{}: {text:?}", param.name));
            }
        }
    }
    for metric in METRICS {
        for text in [metric.label, metric.short, metric.help, metric.good] {
            if is_two_letters(text) && !keys.contains(text) {
                missing.insert(format!("{}: {text:?}", metric.name));
            }
        }
    }
    assert!(seen > 700, "only {seen} sentences found");
    assert!(
        missing.is_empty(),
        "{} of them:\n{}",
        missing.len(),
        missing.into_iter().collect::<Vec<_>>().join("\n")
    );
}

#[test]
fn every_translation_is_used() {
    let (text, entries) = catalogue();
    let mut said: BTreeSet<String> = BTreeSet::new();
    for (_, source) in sources() {
        said.extend(literals(&source).into_iter().map(|literal| literal.text));
    }
    // Texts that are composed of several literals.
    said.extend(MADE.map(str::to_owned));
    let unused: Vec<&String> = entries.keys().filter(|key| !said.contains(*key)).collect();
    assert!(unused.is_empty(), "nothing says {unused:#?}");
    let forgotten: Vec<&&str> = MADE.iter().filter(|key| !entries.contains_key(**key)).collect();
    assert!(forgotten.is_empty(), "no entries: {forgotten:?}");
    let lines = text.lines().filter(|line| line.starts_with("    \"")).count();
    assert_eq!(lines, entries.len(), "an entry stands in two sections");
}

/// Names of keys, which egui has, and a sentence in a script.
const MADE: [&str; 3] = ["Home", "Space", "there is no memory to read it"];

#[test]
fn arguments_of_a_text_are_the_same_in_both_languages() {
    let (_, entries) = catalogue();
    for (english, translation) in entries {
        assert_eq!(Table::check(&english, &translation), Ok(()), "{english:?}");
    }
}

/// Characters and words of Simplified Chinese, or of usage in mainland China, which is unusual in
/// Taiwan.
#[test]
fn translation_follows_taiwanese_usage() {
    const ELSEWHERE: [&str; 26] = [
        "幀",
        "鼠標",
        "文件夾",
        "加載",
        "鏈接",
        "默認",
        "設置",
        "窗口",
        "屏幕",
        "質量",
        "項目",
        "插值",
        "優化",
        "數據",
        "視頻",
        "信息",
        "軟件",
        "网",
        "动",
        "为",
        "这",
        "过",
        "时",
        "数据",
        "实时",
        "菜單",
    ];
    let (_, entries) = catalogue();
    for (english, translation) in entries {
        let found = ELSEWHERE.iter().find(|word| translation.contains(**word));
        assert_eq!(found, None, "{english:?} is translated as {translation:?}");
    }
}

/// Checks that code that lays out text by itself asks for the translation; the kit translates all
/// that it is given.
#[test]
fn every_shown_text_is_translated() {
    let sinks = [
        "RichText::new(",
        "on_hover_text(",
        "hint_text(",
        "LayoutJob::single_section(",
        "LayoutJob::simple(",
        "on_disabled_hover_text(",
    ];
    let mut slips = Vec::new();
    for (path, source) in sources().iter().filter(|(path, _)| path.starts_with("src/ui")) {
        // Lessons are written in every language.
        if path == "src/ui/lessons_panel/prose.rs" {
            continue;
        }
        for sink in sinks {
            for (at, _) in source.match_indices(sink) {
                let after = source[at + sink.len()..].trim_start();
                if !after.starts_with("say(") && after != ")" {
                    let line = source[..at].matches('\n').count() + 1;
                    slips.push(format!("{path}, about line {line}: `{sink}` without `say(`"));
                }
            }
        }
        for (at, _) in source.match_indices("painter.text(") {
            if !source[at..].split(';').next().is_some_and(|call| call.contains("say(")) {
                slips.push(format!("{path}: `painter.text(` without `say(`"));
            }
        }
        if source.contains("ui.button(")
            || source.contains("ui.heading(")
            || source.contains("ui.checkbox(")
        {
            slips.push(format!("{path}: a widget of egui's own, which knows no language"));
        }
    }
    assert!(slips.is_empty(), "{}", slips.join("\n"));
}

#[test]
fn missing_translations_are_found() {
    let source = "/// \"A comment.\"\n#[error(\"lost: {0}\")]\nfn f() { log::warn!(\"not shown at all\"); say(\"It is \\\n    so {much:.1}.\"); g('\"', \"x\") }\n#[cfg(test)]\nmod tests {\n    \"In a test.\"\n}\n";
    assert_eq!(shown("src/a.rs", &without_tests(source)), ["lost: {0}", "It is so {much:.1}."]);
    assert_eq!(
        shown(
            "src/ui/text/a.rs",
            "const A: &str = \"Word\"; match a { \"key\" => \"a_key\", _ => \"p:1\" }"
        ),
        ["Word"]
    );
    assert_eq!(shown("src/ui/a.rs", "f(Word::new(\"Word\"), \"key\")"), ["Word"]);
}
