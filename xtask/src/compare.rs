//! Comparison of the pages that `cargo xtask serve` and Trunk build from the same sources.

use std::fs;
use std::path::Path;

use crate::shell::{Result, command, fail, run, target};
use crate::{dist, seal, tools};

/// Compares `dist/`, as it was built, with Trunk's page if Trunk is installed; otherwise reports
/// that it was not compared.
pub fn with_trunk() -> Result<()> {
    if let Err(reason) = tools::trunk() {
        println!("not compared: {reason}");
        return Ok(());
    }
    let other = target().join("trunk-page");
    let mut trunk = command("trunk", &["build", "--release", "--dist"]);
    // Trunk does not understand `NO_COLOR=1`.
    run(trunk.arg(&other).env_remove("NO_COLOR"))?;
    let differences = differences(&files(&dist::folder())?, &files(&other)?);
    if differences.is_empty() {
        return Ok(());
    }
    fail(format!("{} has another {}", other.display(), differences.join(", ")))
}

/// A path and a content, both without the hashes in names.
type File = (String, Vec<u8>);

fn files(folder: &Path) -> Result<Vec<File>> {
    let mut files = Vec::new();
    for name in seal::files_of(folder)? {
        let content = match String::from_utf8(fs::read(folder.join(&name))?) {
            Ok(text) => without_hashes(&text).into_bytes(),
            Err(binary) => binary.into_bytes(),
        };
        files.push((without_hashes(&name), content));
    }
    Ok(files)
}

/// Returns the paths that only one of the two has, or that differ.
fn differences(one: &[File], other: &[File]) -> Vec<String> {
    let beyond = |one: &[File], other: &[File]| -> Vec<String> {
        let lone = one.iter().filter(|file| !other.contains(file));
        lone.map(|(name, _)| name.clone()).collect()
    };
    let mut names = [beyond(one, other), beyond(other, one)].concat();
    names.sort();
    names.dedup();
    names
}

/// Replaces each run of twelve to sixteen hexadecimal digits by `#`: both write hashes in this way,
/// and Trunk omits leading zeros.
fn without_hashes(text: &str) -> String {
    let is_digit = |byte: &u8| matches!(byte, b'0'..=b'9' | b'a'..=b'f');
    let mut plain = String::new();
    let mut rest = text;
    while let Some(start) = rest.bytes().position(|byte| is_digit(&byte)) {
        let length = rest.as_bytes()[start..].iter().take_while(|byte| is_digit(byte)).count();
        plain.push_str(&rest[..start]);
        plain.push_str(if (12..=16).contains(&length) {
            "#"
        } else {
            &rest[start..start + length]
        });
        rest = &rest[start + length..];
    }
    plain + rest
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn differences_ignore_hashes() {
        let page = |hash: &str, text: &str| -> Vec<File> {
            let name = without_hashes(&format!("app-{hash}.js"));
            vec![(name, without_hashes(&format!("{text} app-{hash}.js")).into_bytes())]
        };
        let one = page("0123456789abcdef", "start");
        for hash in ["fedcba9876543210", "edcba9876543210"] {
            assert!(differences(&one, &page(hash, "start")).is_empty(), "{hash}");
        }
        assert_eq!(differences(&one, &page("fedcba9876543210", "stop")), ["app-#.js"]);
        assert_eq!(differences(&one, &page("fedc", "start")), ["app-#.js", "app-fedc.js"]);
    }
}
