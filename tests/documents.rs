//! The documents agree with the project: the table of parameters in `docs/parameters.md` is
//! generated from the program (`cargo xtask docs`), links have targets, and files that a text names
//! exist.

use segue_session::{Kind, PARAMS, Param};
use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};

const BEGIN: &str = "<!-- parameters -->\n";
const END: &str = "<!-- /parameters -->";

fn row(param: &Param) -> String {
    let values = match param.kind {
        Kind::Number { min, max, auto, .. } => {
            let unit =
                if param.unit.is_empty() { String::new() } else { format!(" {}", param.unit) };
            format!("{min} to {max}{unit}{}", if auto { ", or `auto`" } else { "" })
        }
        Kind::Switch => "`on`, `off`".to_owned(),
        Kind::Choice(choices) => {
            choices.iter().map(|choice| format!("`{}`", choice.key)).collect::<Vec<_>>().join(", ")
        }
        Kind::Clip => "a clip's id".to_owned(),
        Kind::Compare => "`key:value,value`".to_owned(),
        Kind::Joint => "a body part or a joint's name".to_owned(),
        Kind::Character => "a clip's id, or empty".to_owned(),
        Kind::Text => "text".to_owned(),
        Kind::List(_) => "a list".to_owned(),
    };
    let default = param.format(&param.default_value());
    let default = if default.is_empty() { String::new() } else { format!("`{default}`") };
    let shared: Vec<&str> = param.shared_with.iter().map(|lab| lab.word()).collect();
    format!(
        "| `{}` | {} | {} | {values} | {default} | {} |\n",
        param.name,
        param.group.name(),
        shared.join(", "),
        param.help
    )
}

fn table() -> String {
    let mut table =
        "| key | part | used by, too | values | default | what it does |\n|---|---|---|---|---|---|\n".to_owned();
    for param in PARAMS {
        table.push_str(&row(param));
    }
    table
}

/// Folders of the repository by which a code span is recognised as a path.
const FOLDERS: [&str; 10] =
    [".ci", ".github", "assets", "crates", "docs", "examples", "fuzz", "src", "tests", "tools"];

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// Returns the Markdown files of the repository that describe it, by their paths in it.
fn documents() -> Vec<PathBuf> {
    let mut folders = vec![PathBuf::new(), "docs".into()];
    for parent in ["crates", "assets"] {
        let entries = fs::read_dir(root().join(parent)).expect("a folder");
        folders.extend(
            entries.map(|entry| Path::new(parent).join(entry.expect("an entry").file_name())),
        );
    }
    let mut found = Vec::new();
    for folder in folders.iter().filter(|folder| !folder.ends_with("lessons")) {
        let Ok(entries) = fs::read_dir(root().join(folder)) else {
            continue;
        };
        for entry in entries {
            let path = folder.join(entry.expect("an entry").file_name());
            if path.extension().is_some_and(|extension| extension == "md") {
                found.push(path);
            }
        }
    }
    found.sort();
    found
}

/// Returns the numbered lines of a Markdown text outside of code blocks.
fn prose(text: &str) -> impl Iterator<Item = (usize, &str)> {
    let mut is_code = false;
    (1..).zip(text.lines()).filter(move |(_, line)| {
        let is_fence = line.trim_start().starts_with("```");
        is_code ^= is_fence;
        !is_code && !is_fence
    })
}

/// Returns the anchor that GitHub gives a heading.
fn anchor(heading: &str) -> String {
    let kept = heading.trim().chars().filter(|c| c.is_alphanumeric() || " -_".contains(*c));
    kept.collect::<String>().to_lowercase().replace(' ', "-")
}

/// Returns the links of a document that lead nowhere. `read` returns the text of a file, and an
/// empty one for a folder.
fn broken_links(
    document: &Path,
    text: &str,
    read: impl Fn(&Path) -> Option<String>,
) -> Vec<String> {
    let mut broken = Vec::new();
    for (line, content) in prose(text) {
        let markdown = content.split("](").skip(1).filter_map(|rest| rest.split_once(')'));
        let html = ["href=\"", "src=\""].into_iter().flat_map(|start| content.split(start).skip(1));
        let html = html.filter_map(|rest| rest.split_once('"'));
        for target in markdown.chain(html).map(|(target, _)| target) {
            if target.starts_with('?') || target.contains("://") || target.contains('…') {
                continue;
            }
            let (file, section) = target.split_once('#').unwrap_or((target, ""));
            let path = match file {
                "" => document.to_owned(),
                _ => document.parent().unwrap_or(Path::new("")).join(file),
            };
            let leads = match read(&path) {
                Some(_) if section.is_empty() => true,
                Some(text) => prose(&text).any(|(_, line)| {
                    line.starts_with('#') && anchor(line.trim_start_matches('#')) == section
                }),
                None => false,
            };
            if !leads {
                broken.push(format!("{}:{line}: `{target}` leads nowhere", document.display()));
            }
        }
    }
    broken
}

/// Returns the code spans of a document that are paths of the repository and do not exist. Patterns
/// such as `tests/*.rs` are left out.
fn missing_paths(document: &Path, text: &str, exists: impl Fn(&str) -> bool) -> Vec<String> {
    let mut missing = Vec::new();
    for (line, content) in prose(text) {
        for span in content.split('`').skip(1).step_by(2) {
            let is_path = FOLDERS
                .iter()
                .any(|folder| span.strip_prefix(folder).is_some_and(|rest| rest.starts_with('/')));
            let is_plain = !span.contains(|c: char| " *<>{}…".contains(c));
            if is_path && is_plain && !exists(span) {
                missing.push(format!("{}:{line}: `{span}` does not exist", document.display()));
            }
        }
    }
    missing
}

#[test]
fn parameter_table_is_that_of_the_program() {
    let path = root().join("docs/parameters.md");
    let text = fs::read_to_string(&path).expect("the document exists");
    let (before, rest) =
        text.split_once(BEGIN).expect("the document has the mark where the table begins");
    let (old, after) =
        rest.split_once(END).expect("the document has the mark where the table ends");
    let table = table();
    if std::env::var_os("SEGUE_WRITE_DOCS").is_some() {
        let mut new = String::new();
        write!(new, "{before}{BEGIN}{table}{END}{after}").expect("writing to a string works");
        fs::write(path, new).expect("the document can be written");
    } else {
        assert!(old == table, "the table is not that of the program: run `cargo xtask docs`");
    }
}

#[test]
fn documents_name_only_what_exists() {
    let documents = documents();
    assert!(documents.len() > 12, "{documents:?}");
    let mut wrong = Vec::new();
    for document in &documents {
        let text = fs::read_to_string(root().join(document)).expect("a document is text");
        wrong.extend(broken_links(document, &text, |path| {
            let path = root().join(path);
            if path.is_dir() {
                return Some(String::new());
            }
            let bytes = fs::read(path).ok()?;
            Some(String::from_utf8_lossy(&bytes).into_owned())
        }));
        // Those of the assets name files of the places that they come from.
        if !document.starts_with("assets") {
            wrong.extend(missing_paths(document, &text, |path| root().join(path).exists()));
        }
    }
    assert!(wrong.is_empty(), "\n{}", wrong.join("\n"));
}

#[test]
fn glossary_chinese_terms_are_those_on_screen() {
    let read = |path: &str| fs::read_to_string(root().join(path)).expect("the file exists");
    let catalogue = read("assets/lang/zh-Hant.json");
    let glossary = read("docs/glossary.md");
    let cells: Vec<Vec<&str>> = (glossary.lines())
        .map(|line| line.trim_matches('|').split('|').map(str::trim).collect::<Vec<_>>())
        .filter(|cells| {
            cells.len() == 4 && !cells[3].is_empty() && !["繁體中文", "---"].contains(&cells[3])
        })
        .collect();
    let terms = cells.iter().flat_map(|cells| cells[3].split('、'));
    let lessons: String = (segue_session::lesson::LESSONS.iter())
        .filter_map(|lesson| segue_session::lesson::file_name(lesson))
        .map(|file| read(&format!("assets/lessons/zh-Hant/{file}")))
        .collect();
    let unknown: Vec<&str> =
        terms.filter(|term| !catalogue.contains(term) && !lessons.contains(term)).collect();
    assert!(cells.len() > 40, "only {} terms found", cells.len());
    assert!(unknown.is_empty(), "not on screen: {unknown:?}");
}

#[test]
fn broken_links_and_missing_paths_are_found() {
    let text = "# A title: two\n[a](b.md) [c](d.md#two-words) [e](#a-title-two) <img src=\"f.png\">\n```\n[g](h.md)\n```\n[i](?lab=x)\n";
    let read = |path: &Path| {
        (path == Path::new("x/y.md") || path == Path::new("x/d.md"))
            .then(|| text.replace(": ", " "))
    };
    assert_eq!(
        broken_links(Path::new("x/y.md"), text, read),
        [
            "x/y.md:2: `b.md` leads nowhere",
            "x/y.md:2: `d.md#two-words` leads nowhere",
            "x/y.md:2: `f.png` leads nowhere"
        ]
    );
    let text = "`src/a.rs` `src/*.rs` `cargo test` `crates/b`\n";
    assert_eq!(
        missing_paths(Path::new("y.md"), text, |path| path == "crates/b"),
        ["y.md:1: `src/a.rs` does not exist"]
    );
}
