//! Rules that the crates cannot enforce: the order of the folders inside `segue-motion` and the
//! app, things that the libraries never use, and that nothing unfinished is merged. They are
//! checked on the text of the sources, so that a violation is reported with its line.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

/// The folders of `segue-motion`, each with the others that its code may use.
const MOTION: [(&str, &str); 16] = [
    ("math", ""),
    ("skeleton", "math"),
    ("clip", "math skeleton"),
    ("skin", "math skeleton clip"),
    ("points", "math skeleton clip"),
    ("synth", "math skeleton clip"),
    ("registration", "math skeleton clip"),
    ("transition", "math skeleton clip registration blend"),
    ("blend", "math skeleton clip registration"),
    ("metrics", "math skeleton clip blend"),
    ("gait", "math skeleton clip registration blend transition"),
    ("clean", "math skeleton clip registration transition metrics"),
    ("retarget", "math skeleton clip registration transition metrics"),
    ("graph", BELOW),
    ("path", BELOW),
    ("matching", BELOW),
];

const BELOW: &str = "math skeleton clip synth registration transition gait blend metrics retarget";

/// The folders of the app, and the worker that reads files, with the folders and crates that each
/// may use.
const APP: [(&str, &str); 8] = [
    ("render", "segue_scene segue_motion"),
    ("ui", "segue_scene segue_motion segue_formats segue_session"),
    ("platform", "segue_formats segue_session"),
    ("app", "render ui platform segue_scene segue_motion segue_formats segue_session"),
    ("outline", "ui"),
    ("web_api", "app outline platform segue_session"),
    ("main", "app platform render ui"),
    ("bin", "segue_session"),
];

/// The crates of the workspace that are libraries.
const CRATES: [&str; 5] =
    ["segue_motion", "segue_fbx", "segue_formats", "segue_session", "segue_scene"];

/// The crates whose results have the same bits on every machine.
const EXACT_CRATES: [&str; 5] =
    ["crates/motion", "crates/fbx", "crates/formats", "crates/session", "crates/corpus"];

/// Methods of numbers that call the machine's C library, and `slerp` of glam, which has another
/// formula for each kind of processor.
const INEXACT: [&str; 22] = [
    "sin", "cos", "tan", "sin_cos", "asin", "acos", "atan", "atan2", "sinh", "cosh", "tanh", "exp",
    "exp2", "exp_m1", "ln", "ln_1p", "log", "log2", "log10", "powf", "hypot", "slerp",
];

/// Names that the libraries never use: screens, the browser, files, clock and threads.
const OUTSIDE: [&str; 12] = [
    "egui",
    "eframe",
    "wgpu",
    "web_sys",
    "js_sys",
    "wasm_bindgen",
    "std::fs",
    "std::env",
    "std::net",
    "std::thread",
    "std::time::Instant",
    "std::time::SystemTime",
];

/// The programs beside the app, and what they share: they have files and threads.
const PROGRAMS: [&str; 3] = ["crates/batch", "crates/cli", "crates/python"];

/// Names that those programs never use: they have no screen, and need no GPU.
const SCREENS: [&str; 4] = ["egui", "eframe", "wgpu", "segue_scene"];

/// The folders of all Rust sources.
const ALL_SOURCES: [&str; 8] =
    ["src", "crates", "tests", "examples", "tools", "fuzz/src", "fuzz/fuzz_targets", "xtask/src"];

/// The greatest width of a comment, columns; rows of tables and links may be wider.
const MAX_COMMENT_COLUMNS: usize = 100;

/// Marks of unfinished code, in halves so that this file does not contain them.
const UNFINISHED: [&str; 4] = [
    concat!("#[ign", "ore"),
    concat!("to", "do!"),
    concat!("unimple", "mented!"),
    concat!("FIX", "ME"),
];

#[test]
fn dependencies_follow_the_order_of_folders() {
    let sources: Vec<_> = ["src", "crates"].into_iter().flat_map(sources).collect();
    let tests = test_modules(&sources);
    let mut violations_found = Vec::new();
    for (path, text) in
        sources.iter().filter(|(path, _)| is_production(path) && !is_test_file(path, &tests))
    {
        violations_found.extend(violations(path, text));
    }
    assert!(sources.len() > 100, "only {} sources found", sources.len());
    assert!(violations_found.is_empty(), "\n{}", violations_found.join("\n"));
}

/// The places that may name labs: their own files, the list of choices, and the table of
/// parameters, whose rows belong to them.
const NAMES_LABS: [&str; 6] = [
    "crates/session/src/labs.rs",
    "crates/session/src/labs/",
    "crates/session/src/params/choices.rs",
    "crates/session/src/params/table.rs",
    "src/ui/labs.rs",
    "src/ui/labs/",
];

#[test]
fn labs_are_named_in_their_own_files_only() {
    let sources: Vec<_> = ["src", "crates"].into_iter().flat_map(sources).collect();
    let tests = test_modules(&sources);
    let mut violations_found = Vec::new();
    let mut known = 0;
    for (path, text) in
        sources.iter().filter(|(path, _)| is_production(path) && !is_test_file(path, &tests))
    {
        let found = named_labs(path, text);
        if NAMES_LABS.iter().any(|own| path.to_string_lossy().starts_with(own)) {
            known += found.len();
        } else {
            violations_found.extend(found);
        }
    }
    assert!(known > 20, "only {known} names found where labs are");
    assert!(violations_found.is_empty(), "\n{}", violations_found.join("\n"));
}

#[test]
fn sources_contain_nothing_unfinished() {
    let sources: Vec<_> = ALL_SOURCES.into_iter().flat_map(sources).collect();
    let tests = test_modules(&sources);
    let mut violations_found = Vec::new();
    for (path, text) in &sources {
        violations_found.extend(unfinished(path, text));
        if is_production(path) && !is_test_file(path, &tests) {
            violations_found.extend(unwraps(path, text));
        }
    }
    assert!(violations_found.is_empty(), "\n{}", violations_found.join("\n"));
}

/// The same motion gives the same bits natively and in the page only if both compute with the same
/// functions: those of `libm`, and not those of the machine's C library.
#[test]
fn libraries_compute_with_the_functions_of_libm() {
    let sources: Vec<_> = EXACT_CRATES.into_iter().flat_map(sources).collect();
    let tests = test_modules(&sources);
    let mut violations_found = Vec::new();
    for (path, text) in &sources {
        if is_production(path) && !is_test_file(path, &tests) {
            violations_found.extend(inexact(path, text));
        }
    }
    assert!(sources.len() > 200, "only {} sources found", sources.len());
    assert!(violations_found.is_empty(), "\n{}", violations_found.join("\n"));
}

#[test]
fn sources_begin_with_a_module_line_and_have_narrow_comments() {
    let sources: Vec<_> = ALL_SOURCES.into_iter().flat_map(sources).collect();
    let violations_found: Vec<_> =
        sources.iter().flat_map(|(path, text)| unreadable(path, text)).collect();
    assert!(sources.len() > 300, "only {} sources found", sources.len());
    assert!(violations_found.is_empty(), "\n{}", violations_found.join("\n"));
}

#[test]
fn unreadable_sources_are_reported() {
    let found = |text: &str| unreadable(Path::new("src/a.rs"), text);
    let wide = "x ".repeat(50);
    assert_eq!(found("//! Summary.\n\nfn a() {}\n"), [""; 0]);
    assert_eq!(found("#![no_main]\n//! Summary.\n"), [""; 0]);
    assert_eq!(found("fn a() {}\n"), ["src/a.rs:1: does not begin with a `//!` line"]);
    let comment = format!("//! Summary.\n    /// {wide}\n");
    assert_eq!(found(&comment), ["src/a.rs:2: a comment of 108 columns"]);
    let allowed = format!("//! | {wide} |\n//! [a]: https://example.org/{}\n", "x".repeat(90));
    assert_eq!(found(&allowed), [""; 0]);
}

#[test]
fn violations_are_reported() {
    let found = |path: &str, text: &str| violations(Path::new(path), text);
    assert_eq!(
        found("crates/motion/src/clip/storage.rs", "use crate::math::quat;\nuse super::Clip;\n"),
        [""; 0]
    );
    assert_eq!(
        found("crates/motion/src/clip/storage.rs", "\nuse crate::graph::Walk;\n"),
        ["crates/motion/src/clip/storage.rs:2: `clip` names `graph`"]
    );
    assert_eq!(
        found("crates/motion/src/math/quat.rs", "fn f() { crate::clip::g(); }"),
        ["crates/motion/src/math/quat.rs:1: `math` names `clip`"]
    );
    assert_eq!(
        found(
            "crates/motion/src/blend.rs",
            "use crate::{\n    clip::{Clip, graph},\n    path,\n};"
        ),
        ["crates/motion/src/blend.rs:1: `blend` names `path`"]
    );
    assert_eq!(
        found("src/render/light.rs", "use super::super::ui;"),
        ["src/render/light.rs:1: `super` leaves `render`"]
    );
    assert_eq!(
        found("src/render/frame.rs", "use segue_session::Session;\nuse segue_scene::Pane;"),
        ["src/render/frame.rs:1: `render` names `segue_session`"]
    );
    assert_eq!(
        found("crates/session/src/link.rs", "use egui::Ui;"),
        ["crates/session/src/link.rs:1: a library names `egui`"]
    );
    assert_eq!(found("crates/cli/src/read.rs", "use std::fs;"), [""; 0]);
    assert_eq!(
        found("crates/cli/src/info.rs", "use segue_scene::Stage;"),
        ["crates/cli/src/info.rs:1: a program without a screen names `segue_scene`"]
    );
    assert_eq!(found("src/attic/old.rs", ""), ["src/attic/old.rs:1: `attic` has no row here"]);
    // Comments and tests may use any name, but after the tests comes code again.
    let tested =
        "// crate::ui\n#[cfg(test)]\nmod tests {\n    use crate::ui;\n}\nuse crate::app;\n";
    assert_eq!(
        found("src/render/light.rs", tested),
        ["src/render/light.rs:6: `render` names `app`"]
    );

    let code = "fn f() {\n    g().unwrap();\n}\n#[cfg(test)]\nmod tests {\n    fn f() {\n        g().unwrap();\n    }\n}\n";
    assert_eq!(unwraps(Path::new("src/a.rs"), code), ["src/a.rs:2: `unwrap` outside of tests"]);
    let code = "fn f(x: f64) {\n    x.sin() + x.sqrt() + libm::cos(x)\n}\n";
    assert_eq!(
        inexact(Path::new("src/a.rs"), code),
        ["src/a.rs:2: `sin` differs between machines: use libm"]
    );
    for mark in UNFINISHED {
        assert_eq!(
            unfinished(Path::new("src/a.rs"), &format!("\n{mark}")),
            [format!("src/a.rs:2: `{mark}`")]
        );
    }

    let named = "fn f(lab: LabId) -> bool {\n    lab == LabId::View || LabId::ALL.is_empty()\n}\n";
    assert_eq!(named_labs(Path::new("src/app.rs"), named), ["src/app.rs:2: names a lab"]);

    let parent = (
        PathBuf::from("crates/motion/src/skeleton.rs"),
        "#[cfg(any(test, feature = \"fixtures\"))]\n#[expect(\n    clippy::unwrap_used,\n    reason = \"for tests\"\n)]\npub mod fixtures;\nmod tree;\n"
            .to_owned(),
    );
    let tests = test_modules(&[parent]);
    assert!(is_test_file(Path::new("crates/motion/src/skeleton/fixtures/rigs.rs"), &tests));
    assert!(!is_test_file(Path::new("crates/motion/src/skeleton/tree.rs"), &tests));
}

/// Returns the Rust files below a folder of the repository, by their paths in it.
fn sources(folder: &str) -> Vec<(PathBuf, String)> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut open = vec![root.join(folder)];
    let mut found = Vec::new();
    while let Some(folder) = open.pop() {
        for entry in fs::read_dir(&folder).expect("a folder of sources") {
            let path = entry.expect("an entry").path();
            if path.is_dir() {
                open.push(path);
            } else if path.extension().is_some_and(|extension| extension == "rs") {
                let text = fs::read_to_string(&path).expect("a source is text");
                found.push((path.strip_prefix(root).expect("below the root").to_owned(), text));
            }
        }
    }
    found.sort();
    found
}

/// Returns whether a file belongs to a crate's `src`, not to its tests, benches or examples.
fn is_production(path: &Path) -> bool {
    path.starts_with("src") || path.iter().nth(2).is_some_and(|folder| folder == "src")
}

/// Returns the modules of a path below `src`, outermost first: `src/a/b.rs` and `src/a/b/mod.rs`
/// are both `a`, `b`.
fn modules(path: &Path) -> Vec<String> {
    let path = path.with_extension("");
    let mut names: Vec<String> =
        path.iter().map(|name| name.to_string_lossy().into_owned()).collect();
    let source = names.iter().position(|name| name == "src").map_or(0, |at| at + 1);
    names.drain(..source);
    if names.last().is_some_and(|name| name == "mod" || (names.len() == 1 && name == "lib")) {
        names.pop();
    }
    names
}

/// Returns the folder of a path's crate and its modules.
fn located(path: &Path) -> Vec<String> {
    let folder: Vec<_> = path.iter().take_while(|name| *name != "src").collect();
    let folder = folder.into_iter().collect::<PathBuf>().display().to_string();
    std::iter::once(folder).chain(modules(path)).collect()
}

/// Returns the modules in files of their own that are compiled for tests only.
fn test_modules(sources: &[(PathBuf, String)]) -> BTreeSet<Vec<String>> {
    let mut found = BTreeSet::new();
    for (path, text) in sources {
        let mut for_tests = false;
        let mut file = None;
        let mut in_attribute = false;
        for line in text.lines().map(str::trim) {
            let is_attribute = continues_attribute(line, &mut in_attribute);
            if is_for_tests(line) {
                for_tests = true;
            } else if let (true, Some(name)) = (
                for_tests,
                line.strip_prefix("#[path = \"").and_then(|rest| rest.strip_suffix(".rs\"]")),
            ) {
                file = Some(name);
            } else if !is_attribute {
                let name = line
                    .strip_suffix(';')
                    .and_then(|item| item.rsplit_once("mod "))
                    .map(|(_, name)| name);
                if let (true, Some(name)) = (for_tests, name) {
                    let mut module = located(path);
                    if file.is_some() && !path.ends_with("mod.rs") {
                        module.pop();
                    }
                    module.push(file.unwrap_or(name).to_owned());
                    found.insert(module);
                }
                (for_tests, file) = (false, None);
            }
        }
    }
    found
}

fn is_test_file(path: &Path, tests: &BTreeSet<Vec<String>>) -> bool {
    let modules = located(path);
    tests.iter().any(|test| modules.starts_with(test))
}

fn is_for_tests(line: &str) -> bool {
    ["#[cfg(test)]", "#[cfg(all(test,", "#[cfg(any(test,"]
        .iter()
        .any(|start| line.starts_with(start))
}

/// Returns whether a line begins or continues an attribute. `is_open` says whether the attribute
/// continues on the next line.
fn continues_attribute(line: &str, is_open: &mut bool) -> bool {
    let belongs = *is_open || line.starts_with("#[");
    *is_open = belongs && !line.trim_end().ends_with(']');
    belongs
}

/// Returns the text without comments and without items for tests; its line numbers stay the same.
fn code(text: &str) -> String {
    let mut code = String::new();
    // The line that ends the open item for tests.
    let mut end: Option<String> = None;
    let mut for_tests = false;
    let mut in_attribute = false;
    for line in text.lines() {
        let item = line.trim_start();
        let is_attribute = continues_attribute(item, &mut in_attribute);
        if let Some(last) = &end {
            if line == last {
                end = None;
            }
        } else if is_for_tests(item) {
            for_tests = true;
        } else if for_tests {
            if !is_attribute {
                for_tests = false;
                let opens = line.ends_with('{');
                end = opens.then(|| format!("{}}}", &line[..line.len() - item.len()]));
            }
        } else {
            code.push_str(line.split("//").next().unwrap_or_default());
        }
        code.push('\n');
    }
    code
}

/// Returns the positions of `word` in `code` as a whole word.
fn places<'a>(code: &'a str, word: &'a str) -> impl Iterator<Item = usize> + 'a {
    let is_name = |c: char| c.is_alphanumeric() || c == '_';
    code.match_indices(word).map(|(at, _)| at).filter(move |at| {
        let before = code[..*at].chars().next_back();
        let after = code[at + word.len()..].chars().next();
        !before.is_some_and(is_name) && !after.is_some_and(is_name)
    })
}

/// Returns the first names of a path that continues with `rest`: one name, or those of a group.
fn heads(rest: &str) -> Vec<&str> {
    let name =
        |text: &'_ str| text.find(|c: char| !c.is_alphanumeric() && c != '_').unwrap_or(text.len());
    let Some(group) = rest.strip_prefix('{') else {
        return vec![&rest[..name(rest)]];
    };
    let mut depth = 0;
    let mut names = Vec::new();
    let mut start = Some(0);
    for (at, c) in group.char_indices() {
        match c {
            '{' => depth += 1,
            '}' if depth == 0 => break,
            '}' => depth -= 1,
            ',' if depth == 0 => start = Some(at + 1),
            c if depth == 0 && start.is_some() && !c.is_whitespace() => {
                names.push(&group[at..at + name(&group[at..])]);
                start = None;
            }
            _ => {}
        }
    }
    names
}

/// Returns the uses in a source that violate the order, a sentence each.
fn violations(path: &Path, text: &str) -> Vec<String> {
    let code = code(text);
    let modules = modules(path);
    let mut found = Vec::new();
    let line = |at: usize| code[..at].matches('\n').count() + 1;
    let mut tell = |at: usize, what: String| {
        found.push((at, format!("{}:{}: {what}", path.display(), line(at))));
    };
    let in_app = path.starts_with("src");
    let rows: &[(&str, &str)] = match path.starts_with("crates/motion") {
        true => &MOTION,
        false if in_app => &APP,
        false => &[],
    };
    if let Some(own) = modules.first().filter(|_| !rows.is_empty()) {
        let row = rows.iter().find(|(name, _)| name == own);
        if row.is_none() {
            tell(0, format!("`{own}` has no row here"));
        }
        let allowed = row.map_or("", |(_, allowed)| allowed);
        let is_allowed = |name: &str| name == own || allowed.split(' ').any(|other| other == name);
        for at in places(&code, "crate") {
            let Some(rest) = code[at + "crate".len()..].strip_prefix("::") else {
                continue;
            };
            for name in heads(rest).into_iter().filter(|name| !is_allowed(name)) {
                tell(at, format!("`{own}` names `{name}`"));
            }
        }
        for name in CRATES.into_iter().filter(|name| in_app && !is_allowed(name)) {
            for at in places(&code, name) {
                tell(at, format!("`{own}` names `{name}`"));
            }
        }
        for at in places(&code, "super") {
            let chain = code[at..].split("::").take_while(|part| *part == "super").count();
            if !code[..at].ends_with("super::") && chain >= modules.len() && own != "main" {
                tell(at, format!("`super` leaves `{own}`"));
            }
        }
    }
    let is_program = PROGRAMS.iter().any(|folder| path.starts_with(folder));
    let is_library = !in_app && !is_program;
    for outside in OUTSIDE.iter().filter(|_| is_library) {
        for at in places(&code, outside) {
            tell(at, format!("a library names `{outside}`"));
        }
    }
    for screen in SCREENS.iter().filter(|_| is_program) {
        for at in places(&code, screen) {
            tell(at, format!("a program without a screen names `{screen}`"));
        }
    }
    found.sort();
    found.into_iter().map(|(_, slip)| slip).collect()
}

/// Returns the places where a source names a lab, a sentence each.
fn named_labs(path: &Path, text: &str) -> Vec<String> {
    let code = code(text);
    let found = places(&code, "LabId").filter(|at| {
        let rest = code[at + "LabId".len()..].strip_prefix("::");
        rest.is_some_and(|rest| rest.starts_with(|c: char| c.is_uppercase() || c == '{'))
    });
    // `LabId::ALL` and other constants do not name a lab.
    let is_lab = |at: &usize| {
        let rest = &code[at + "LabId::".len()..];
        rest.chars().nth(1).is_none_or(|c| !c.is_uppercase())
    };
    found
        .filter(is_lab)
        .map(|at| {
            let line = code[..at].matches('\n').count() + 1;
            format!("{}:{line}: names a lab", path.display())
        })
        .collect()
}

fn unwraps(path: &Path, text: &str) -> Vec<String> {
    let code = code(text);
    let lines = code.lines().enumerate().filter(|(_, line)| line.contains(".unwrap()"));
    lines
        .map(|(index, _)| format!("{}:{}: `unwrap` outside of tests", path.display(), index + 1))
        .collect()
}

fn inexact(path: &Path, text: &str) -> Vec<String> {
    let mut found = Vec::new();
    for (index, line) in code(text).lines().enumerate() {
        for method in INEXACT {
            if line.contains(&format!(".{method}(")) {
                let (path, line) = (path.display(), index + 1);
                found.push(format!("{path}:{line}: `{method}` differs between machines: use libm"));
            }
        }
    }
    found
}

fn unfinished(path: &Path, text: &str) -> Vec<String> {
    let mut found = Vec::new();
    for (index, line) in text.lines().enumerate() {
        for mark in UNFINISHED.iter().filter(|mark| line.contains(**mark)) {
            found.push(format!("{}:{}: `{mark}`", path.display(), index + 1));
        }
    }
    found
}

/// Returns the violations of a source against the form of files: a `//!` line at the beginning, and
/// narrow comments.
fn unreadable(path: &Path, text: &str) -> Vec<String> {
    let mut found = Vec::new();
    let first = text.lines().find(|line| !line.starts_with("#!["));
    if !first.is_some_and(|line| line.starts_with("//! ")) {
        found.push(format!("{}:1: does not begin with a `//!` line", path.display()));
    }
    for (index, line) in text.lines().enumerate() {
        let (line, columns) = (line.trim_start(), line.chars().count());
        let words = line.trim_start_matches(['/', '!']).trim_start();
        let may_be_wide = words.starts_with('|') || words.contains("://");
        if line.starts_with("//") && columns > MAX_COMMENT_COLUMNS && !may_be_wide {
            let path = path.display();
            found.push(format!("{path}:{}: a comment of {columns} columns", index + 1));
        }
    }
    found
}
