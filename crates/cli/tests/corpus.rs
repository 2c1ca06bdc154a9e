//! `segue corpus`: what the Python package is asked for, and what is said without it.

#![expect(clippy::unwrap_used, reason = "what fails here fails the test")]

mod common;

use common::Folder;

#[test]
fn missing_python_is_named() {
    let folder = Folder::new("no-python");
    let run = folder.run(&["corpus", "build", "takes", "out", "--python", "./none"]);
    assert_eq!(run.code, 3);
    assert!(run.error.contains("`./none` cannot be run"), "{}", run.error);
    assert_eq!(folder.run(&["corpus", "build", "takes"]).code, 2, "no folder for the corpus");
    assert_eq!(folder.run(&["corpus"]).code, 2);
}

#[cfg(unix)]
mod with_a_python {
    use super::Folder;
    use std::os::unix::fs::PermissionsExt as _;

    /// Writes a program in the place of Python.
    fn put_python(folder: &Folder, script: &str) {
        let path = folder.put("python", format!("#!/bin/sh\n{script}\n"));
        std::fs::set_permissions(path, std::fs::Permissions::from_mode(0o755)).unwrap();
    }

    #[test]
    fn missing_package_is_named() {
        let folder = Folder::new("no-package");
        put_python(&folder, "exit 1");
        let run = folder.run(&["corpus", "build", "takes", "out", "--python", "./python"]);
        assert_eq!(run.code, 3);
        assert!(run.error.contains("pip install \"./crates/python[corpus]\""), "{}", run.error);
    }

    #[test]
    fn package_gets_all_options_and_its_exit_code_counts() {
        let folder = Folder::new("package");
        put_python(&folder, "[ \"$1\" = -c ] && exit 0\nprintf '<%s>' \"$@\"\nexit 1");
        let run = |words: &[&str]| {
            folder.run(&[&["corpus", "build", "--python", "./python"], words].concat())
        };
        let plain = run(&["a b", "set.zip", "out"]);
        assert_eq!(plain.out, "<-m><segue.corpus><build><--><a b><set.zip><out>");
        assert_eq!(plain.code, 3);
        let options = ["--ray", "--clean", "--workers", "3", "--labels", "l.csv", "--fresh"];
        let all = run(&[&options[..], &["takes", "out"]].concat());
        let expected = "<--workers=3><--ray><--labels=l.csv><--clean><--fresh><--><takes><out>";
        assert_eq!(all.out, format!("<-m><segue.corpus><build>{expected}"));
        assert!(run(&["--ray=head:6379", "takes", "out"]).out.contains("<--ray=head:6379>"));
    }
}
