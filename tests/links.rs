//! Published links stay valid: every one in the documents, lessons and tests is read, and written
//! again unchanged. `links/published.txt` has those of earlier documents: a line is never removed.

use segue_session::{Key, Kind, Params, link};
use std::fs;
use std::path::{Path, PathBuf};

/// The places of links; in the first three none may be refused.
const PLACES: [&str; 9] = [
    "README.md",
    "docs",
    "assets/lessons",
    "tests",
    "crates/session/src",
    "src/ui",
    "src/render/tests",
    "tools",
    "examples",
];
const DOCUMENTS: usize = 3;
/// Links of earlier documents, one per line.
const PUBLISHED: &str = include_str!("links/published.txt");

/// Returns the text files at or below a path.
fn files(path: PathBuf) -> Vec<PathBuf> {
    if !path.is_dir() {
        let ending = path.extension().and_then(|ending| ending.to_str()).unwrap_or_default();
        return if ["md", "rs", "mjs"].contains(&ending) { vec![path] } else { Vec::new() };
    }
    let entries = fs::read_dir(&path).expect("a folder");
    entries.flat_map(|entry| files(entry.expect("an entry").path())).collect()
}

/// Returns the links in a text, without `?`: from a parameter's name and `=` to the end of an
/// address or a literal.
fn links(text: &str) -> Vec<&str> {
    let ends = |letter: char| letter.is_whitespace() || "\"`<>'|{}\\".contains(letter);
    let parts = text.split(ends).flat_map(|part| part.split("](")).map(|part| {
        let link = part.rsplit_once('?').map_or(part, |(_, link)| link).trim_start_matches('(');
        closed(link.trim_end_matches(['.', ',', ';', ':']))
    });
    let is_link = |link: &&str| {
        let name = link.split_once('=').map(|(name, _)| name);
        name.is_some_and(|name| Key::from_name(name).is_some()) && !link.contains("==")
    };
    parts.filter(is_link).collect()
}

/// Returns the text up to the closing bracket of one that was opened before it.
fn closed(text: &str) -> &str {
    let mut depth = 0_i32;
    let end = text.char_indices().find(|(_, letter)| {
        depth += i32::from(*letter == '(') - i32::from(*letter == ')');
        depth < 0
    });
    end.map_or(text, |(at, _)| &text[..at])
}

/// Returns the change if a link's values are written or read differently than they are.
fn changed(query: &str) -> Option<String> {
    let read = link::read(query);
    let mut params = Params::default();
    for (key, value) in &read.values {
        params.set(*key, value.clone()).expect("links hold checked values");
    }
    let written = link::write(&params);
    let mut again = Params::default();
    for (key, value) in link::read(&written).values {
        again.set(key, value).expect("links hold checked values");
    }
    // The playhead is excluded, because it moves.
    again.set(Key::Time, params.get(Key::Time).clone()).expect("a time");
    if again != params {
        return Some(format!("`{query}` is written as `{written}`, which is another state"));
    }
    // Numbers and switches have several forms; all other values have one.
    let pairs = form_urlencoded::parse(query.as_bytes());
    let other = pairs.into_iter().find(|(name, text)| {
        let param = Key::from_name(name).map(Key::param);
        let param = param.filter(|param| !matches!(param.kind, Kind::Number { .. } | Kind::Switch));
        let found = param.and_then(|param| Some(param.format(&param.parse(text).ok()?)));
        param.is_some_and(|param| param.key != Key::Compare)
            && found.is_some_and(|found| found != *text)
    });
    other.map(|(name, text)| format!("`{query}`: `{name}={text}` is written otherwise"))
}

/// Returns a text without its blocks of Python, whose arguments look like parts of links.
fn without_python(text: &str) -> String {
    let parts = text.split("```python").enumerate();
    let outside = parts.map(|(index, part)| match part.split_once("\n```") {
        Some((_, rest)) if index > 0 => rest,
        _ => part,
    });
    outside.collect()
}

#[test]
fn links_are_written_unchanged() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut wrong = Vec::new();
    let mut count = 0;
    for (place, name) in PLACES.iter().enumerate() {
        for file in files(root.join(name)) {
            let text = without_python(&fs::read_to_string(&file).expect("a text"));
            for query in links(&text) {
                count += 1;
                let problems = link::read(query).problems;
                if let Some(problem) = problems.first().filter(|_| place < DOCUMENTS) {
                    wrong.push(format!("{}: `{query}`: {problem}", file.display()));
                }
                wrong.extend(changed(query).map(|what| format!("{}: {what}", file.display())));
            }
        }
    }
    assert!(count > 400, "only {count} links found");
    assert!(wrong.is_empty(), "\n{}", wrong.join("\n"));
}

#[test]
fn links_of_earlier_documents_still_open() {
    let published: Vec<&str> =
        PUBLISHED.lines().filter(|line| !line.is_empty() && !line.starts_with('#')).collect();
    let mut wrong = Vec::new();
    for query in &published {
        let read = link::read(query);
        let given = form_urlencoded::parse(query.as_bytes()).count();
        if read.values.len() != given {
            wrong.push(format!("`{query}`: {} of {given} values are read", read.values.len()));
        }
        wrong.extend(read.problems.iter().map(|problem| format!("`{query}`: {problem}")));
        wrong.extend(changed(query));
    }
    assert!(published.len() >= 75, "only {} links: none may be removed", published.len());
    assert!(wrong.is_empty(), "\n{}", wrong.join("\n"));
}

#[test]
fn links_are_found_in_documents_and_literals() {
    let text = "[a](?lab=view&a=in_place(a:walk)), `?lab=graph&clips=walk,run`. open(\"t=2&play=off\") x=1";
    assert_eq!(
        links(text),
        ["lab=view&a=in_place(a:walk)", "lab=graph&clips=walk,run", "t=2&play=off"]
    );
}
