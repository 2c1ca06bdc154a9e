//! A written report of the current state: for homework, bug reports, notes.

use super::labs::{recipe_ingredients, recipe_params};
use super::library::{Entry, Origin};
use super::numbers::NumberTable;
use super::outside::{markdown, markdown_code, markdown_sentence};
use super::pane::NoResult;
use super::params::{Key, Kind, Value, format_number};
use super::session::Session;
use std::fmt::Write as _;

/// Facts for a report that the document does not contain.
#[derive(Clone, Copy, Debug, Default)]
pub struct ReportFacts<'a> {
    /// The address that opens this state.
    pub link: &'a str,
    /// A picture of the stage as an address (`data:image/jpeg;base64,…`); `None` if there is none.
    pub picture: Option<&'a str>,
    /// The graphics backend. The version of Segue is added automatically.
    pub backend: &'a str,
}

/// Returns the state as Markdown: a heading, the picture, the link, the clips, the parameters, the
/// metrics of all panes, and the versions. Panes without a result say why.
///
/// # Errors
/// [`NoResult`] if no pane has a result, and while one of them is computed.
pub fn report(session: &Session, facts: &ReportFacts<'_>) -> Result<String, NoResult> {
    // From here on, nothing is in progress, and every pane shows the current parameters.
    session.first_result()?;
    let params = session.params();
    let lab = Key::Lab.param().spoken(params.get(Key::Lab));
    let mut out = String::new();
    let mut say = |line: String| {
        let written = writeln!(out, "{line}");
        debug_assert!(written.is_ok(), "a string takes all");
    };
    say(format!("## Segue: {lab}\n"));
    if let Some(picture) = facts.picture {
        say(format!("![The stage at {:.2} s]({picture})\n", session.now_secs()));
    }
    say(format!("[Open this state]({})\n", facts.link.replace('(', "%28").replace(')', "%29")));
    say("| setting | value |\n|---|---|".to_owned());
    for key in recipe_ingredients(params.lab()) {
        let param = key.param();
        let value = params.get(key);
        let words = match param.kind {
            Kind::Clip => clip_in_words(session, params.text(key)),
            _ => markdown(&match session.automatic_value(key).filter(|_| *value == Value::Auto) {
                Some(found) => format!("{} {} (found)", format_number(found, 0.01), param.unit),
                None => format!("{} {}", param.spoken(value), param.unit),
            }),
        };
        let note = if *value == param.default_value() { "" } else { " *" };
        if !words.trim().is_empty() {
            say(format!("| {}{note} | {} |", param.label, words.trim()));
        }
    }
    if let Some(compare) = session.compare().filter(|_| session.panes().len() > 1) {
        say(format!("| Compared | {} |", compare.key.param().label));
    }
    say("\n\\* not the default\n".to_owned());
    let table = NumberTable::of(session);
    if table.rows.is_empty() {
        say("There is nothing to measure here.\n".to_owned());
    } else {
        say(table.markdown());
    }
    let backend =
        if facts.backend.is_empty() { String::new() } else { format!(" · {}", facts.backend) };
    for pane in session.panes() {
        if let Err(reason) = pane.result() {
            let name = session.variant_name(pane).unwrap_or_default();
            say(format!(
                "No result for {}: {}\n",
                markdown(&name.to_string()),
                markdown_sentence(&reason.to_string())
            ));
        }
    }
    say(format!("Segue {}{backend}", env!("CARGO_PKG_VERSION")));
    Ok(out)
}

/// Returns a clip's name and what identifies it, as Markdown: the hash of its file, or the recipe.
fn clip_in_words(session: &Session, id: &str) -> String {
    let Some(entry) = session.library().find(id) else {
        return format!("{}, which is not here", markdown_code(id));
    };
    let Entry { name, origin, .. } = &**entry;
    let name = markdown(name);
    match origin {
        Origin::File(file) => {
            format!("{name} (SHA-256 {}…)", file.sha256.get(..12).unwrap_or(&file.sha256))
        }
        Origin::Made if recipe_params(id).is_some() => format!("{name} ({})", markdown_code(id)),
        _ => name,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Command;
    use crate::fixtures::opened;

    #[test]
    fn report_contains_the_state() {
        let session = opened("compare=blend_window:30,15,10&weight_law=linear");
        let report = report(
            &session,
            &ReportFacts {
                link: "https://example.org/?a=run(turn_rate:20)",
                picture: Some("data:image/jpeg;base64,AAAA"),
                backend: "webgpu",
            },
        )
        .unwrap();
        for part in [
            "## Segue: Blend",
            "](data:image/jpeg;base64,AAAA)",
            "(https://example.org/?a=run%28turn_rate:20%29)",
            "| A | Walk |",
            "| Weight law * | linear |",
            "| Compared | Blend window |",
            "| | 30 frames | 15 frames | 10 frames |",
            "| Velocity jump, °/s |",
            concat!("Segue ", env!("CARGO_PKG_VERSION"), " · webgpu"),
        ] {
            assert!(report.contains(part), "{part} is not in\n{report}");
        }
        let found = report.lines().find(|line| line.contains("(found)"));
        assert!(found.is_some_and(|line| line.starts_with("| Leave A")), "{report}");
    }

    #[test]
    fn report_escapes_names() {
        let mut session = opened("lab=view&a=walk");
        let name = "<img src=x> [click](javascript:alert(1)) |";
        session.apply(Command::Rename("walk".into(), name.into())).unwrap();
        let said = report(&session, &ReportFacts::default()).unwrap();
        let row = said.lines().find(|line| line.starts_with("| A")).unwrap();
        assert!(row.contains("\\<img src=x\\> \\[click\\](javascript:alert(1)) \\| |"), "{row}");
        // A missing clip has the name in the link.
        let session = opened("lab=view&a=%60%3Cb%3E%7C");
        let reason = session.panes()[0].problem.clone();
        assert!(reason.is_some());
        assert_eq!(clip_in_words(&session, "`<b>|"), "`'<b>\\|`, which is not here");
    }

    #[test]
    fn report_of_two_clips_has_one_table() {
        let session = opened("lab=view&compare=a:walk,run(turn_rate:20)");
        let report = report(&session, &ReportFacts::default()).unwrap();
        let head = report.lines().find(|line| line.starts_with("| | ")).unwrap();
        assert!(head.starts_with("| | Walk | "), "{head}");
        let slide = report.lines().find(|line| line.starts_with("| Foot slide, cm |")).unwrap();
        assert_eq!(slide.split('|').count(), 5, "{slide}");
        assert!(!slide.contains('–'), "{slide}");
    }
}
