//! The README's table of parameters is made from the one table of parameters. `cargo xtask docs` writes it.

use segue_session::{Kind, PARAMS, Param};
use std::fmt::Write as _;

const BEGIN: &str = "<!-- parameters -->\n";
const END: &str = "<!-- /parameters -->";

fn row(param: &Param) -> String {
    let values = match param.kind {
        Kind::Number { min, max, auto, .. } => {
            let unit = if param.unit.is_empty() {
                String::new()
            } else {
                format!(" {}", param.unit)
            };
            format!("{min} to {max}{unit}{}", if auto { ", or `auto`" } else { "" })
        }
        Kind::Switch => "`on`, `off`".to_owned(),
        Kind::Choice(choices) => choices
            .iter()
            .map(|choice| format!("`{}`", choice.key))
            .collect::<Vec<_>>()
            .join(", "),
        Kind::Clip => "a clip's id".to_owned(),
        Kind::Compare => "`key:value,value`".to_owned(),
        Kind::Text => "text".to_owned(),
    };
    let default = param.format(&param.default_value());
    let default = if default.is_empty() {
        String::new()
    } else {
        format!("`{default}`")
    };
    format!(
        "| `{}` | {} | {values} | {default} | {} |\n",
        param.name,
        param.group.name(),
        param.help
    )
}

fn table() -> String {
    let mut table = "| key | part | values | default | what it does |\n|---|---|---|---|---|\n".to_owned();
    for param in PARAMS {
        table.push_str(&row(param));
    }
    table
}

#[test]
fn the_table_of_parameters_is_the_programs() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/README.md");
    let readme = std::fs::read_to_string(path).expect("the README is there");
    let (before, rest) = readme.split_once(BEGIN).expect("the README has the mark where the table begins");
    let (old, after) = rest.split_once(END).expect("the README has the mark where the table ends");
    let table = table();
    if std::env::var_os("SEGUE_WRITE_DOCS").is_some() {
        let mut new = String::new();
        write!(new, "{before}{BEGIN}{table}{END}{after}").expect("writing to a string works");
        std::fs::write(path, new).expect("the README can be written");
    } else {
        assert!(
            old == table,
            "the README's table is not that of the program: run `cargo xtask docs`"
        );
    }
}
