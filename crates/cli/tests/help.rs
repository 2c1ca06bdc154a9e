//! The help: every command has an example, the documents name every command, and shells complete
//! them.

#![expect(clippy::unwrap_used, reason = "what fails here fails the test")]

mod common;

use common::Folder;

/// Returns the commands that the main help lists.
fn commands(folder: &Folder) -> Vec<String> {
    let help = folder.run_well(&["--help"]).out;
    let list = help.split_once("Commands:\n").unwrap().1.split_once("\n\n").unwrap().0;
    let names = list.lines().filter(|line| line.starts_with("  ") && !line.starts_with("   "));
    let names = names.filter_map(|line| line.split_whitespace().next());
    names.filter(|name| *name != "help").map(str::to_owned).collect()
}

#[test]
fn every_command_teaches_by_an_example() {
    let folder = Folder::new("help");
    let commands = commands(&folder);
    assert!(commands.len() > 15, "{commands:?}");
    for command in &commands {
        let inner: &[&str] = match command.as_str() {
            "graph" => &["walk"],
            "match" => &["bench"],
            "corpus" => &["build"],
            _ => &[],
        };
        let words = [&[command.as_str()], inner, &["--help"]].concat();
        let help = folder.run_well(&words).out;
        assert!(help.contains("Example"), "{words:?}");
        assert!(help.contains(&format!("  segue {command} ")), "{words:?}: {help}");
    }
    let help = folder.run_well(&["--help"]).out;
    assert!(help.contains("Exit codes:") && help.contains("Examples:"), "{help}");
    let blend = folder.run_well(&["blend", "--help"]).out;
    let blend = blend.split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(blend.contains("How long A fades into B."), "{blend}");
    assert!(blend.contains("[1 to 240 frames; default 30]"), "{blend}");
}

#[test]
fn documents_name_every_command() {
    let folder = Folder::new("documents");
    let root = concat!(env!("CARGO_MANIFEST_DIR"), "/../..");
    let text = std::fs::read_to_string(format!("{root}/docs/cli.md")).unwrap();
    for command in commands(&folder) {
        assert!(text.contains(&format!("segue {command}")), "docs/cli.md lacks `{command}`");
    }
}

#[test]
fn completions_name_every_command() {
    let folder = Folder::new("completions");
    for shell in ["bash", "zsh", "fish", "powershell", "elvish"] {
        let script = folder.run_well(&["completions", shell]).out;
        for word in ["convert", "lint", "blend"] {
            assert!(script.contains(word), "{shell}: {word}");
        }
        assert!(script.contains("blend-window"), "{shell}");
    }
    assert_eq!(folder.run(&["completions", "tcsh"]).code, 2);
}

#[test]
fn page_that_is_not_built_is_named() {
    let folder = Folder::new("page");
    folder.put("walk.bvh", "x");
    let run = folder.run(&["open", "walk.bvh", "--page", "nowhere"]);
    assert_eq!(run.code, 3);
    assert!(run.error.contains("cargo xtask serve --dist"), "{}", run.error);
}
