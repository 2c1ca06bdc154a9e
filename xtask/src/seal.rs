//! The last step of a build: files that belong together get names that rule out mixing versions,
//! the page gets its policy, and the service worker its list of files.
//!
//! `cargo xtask serve` ends with it, and Trunk calls it as a hook (Trunk.toml), so that both make
//! the same folder.

use std::fs;
use std::hash::{DefaultHasher, Hash as _, Hasher as _};
use std::path::{Path, PathBuf};

use crate::shell::{Result, fail};

/// Folders whose files are fetched on request, and cached from then on.
const LATER: [&str; 3] = ["samples/", "lessons/", "lang/"];
/// Folders of the page's scripts that are fetched on request: the workers that compute, which are
/// made for the first long work, what converts files, and what shows a corpus.
const LATER_SCRIPTS: [&str; 3] = ["/compute/", "/convert/", "/corpus/"];
/// The beginning of the names of the app's module with WebGL 2, and of that without it.
const WEBGL2: &str = "segue-";
const WEBGPU: &str = "webgpu-";
/// The page's Content-Security-Policy: it may run the scripts and the WebAssembly beside it and
/// nothing else, and fetch from anywhere, for `src=` and lessons. Pictures and films of its own
/// (`blob:`) may be shown. Only a header of the host can say who may frame it.
const POLICY: &str = "default-src 'none'; script-src 'self' 'wasm-unsafe-eval'; worker-src 'self'; style-src 'self'; img-src 'self' data: blob:; \
                      media-src blob:; manifest-src 'self'; connect-src 'self' https: http:; base-uri 'none'; form-action 'none'";
/// The place of the policy: before everything that it applies to.
const POLICY_PLACE: &str = "<meta charset=\"utf-8\">";
/// The two files from which all others are reached: their names stay the same.
const PAGE: &str = "index.html";
const WORKER: &str = "sw.js";

/// Seals the folder that Trunk is about to hand over.
pub fn run() -> Result<()> {
    let Some(folder) = std::env::var_os("TRUNK_STAGING_DIR") else {
        return fail(
            "`seal` is called by Trunk, after a build: TRUNK_STAGING_DIR names the folder",
        );
    };
    // During development, a worker that caches old pages is in the way, and so is a policy without
    // the script with which Trunk reloads the page.
    let is_release = std::env::var("TRUNK_PROFILE").is_ok_and(|profile| profile == "release");
    seal(Path::new(&folder), is_release)
}

/// Seals the folder of a page that is otherwise complete.
pub fn seal(folder: &Path, is_release: bool) -> Result<()> {
    rename_scripts(folder)?;
    if !is_release {
        return Ok(fs::remove_file(folder.join(WORKER))?);
    }
    write_policy(folder)?;
    let files = files_of(folder)?;
    let version = hash_of(folder, &files)?;
    let page = folder.join(PAGE);
    let html = fs::read_to_string(&page)?;
    let Some((head, body)) = html.split_once("</head>") else {
        return fail("index.html has no head to put the build's name into");
    };
    fs::write(&page, format!("{head}<meta name=\"build\" content=\"{version}\">\n</head>{body}"))?;
    let with = |names: &[&str]| -> Vec<&String> {
        files.iter().filter(|file| names.iter().any(|name| file.starts_with(name))).collect()
    };
    let (mut later, webgl2, webgpu) = (with(&LATER), with(&[WEBGL2]), with(&[WEBGPU]));
    let is_later = |file: &&String| LATER_SCRIPTS.iter().any(|name| file.contains(name));
    later.extend(files.iter().filter(is_later));
    let is_first = |file: &&String| {
        *file != WORKER && ![&later, &webgl2, &webgpu].iter().any(|other| other.contains(file))
    };
    let first: Vec<&String> = files.iter().filter(is_first).collect();
    let worker = folder.join(WORKER);
    let script = fs::read_to_string(&worker)?;
    let lists = [
        ("[/* FILES */]", first),
        ("[/* LATER */]", later),
        ("[/* WEBGL2 */]", webgl2),
        ("[/* WEBGPU */]", webgpu),
    ];
    let mut script = script.replace("\"BUILD\"", &format!("{version:?}"));
    for (mark, files) in lists {
        if !script.contains(mark) {
            return fail(format!("web/{WORKER} has no {mark} to fill in"));
        }
        let files: String = files.iter().map(|file| format!("  {file:?},\n")).collect();
        script = script.replace(mark, &format!("[\n{files}]"));
    }
    Ok(fs::write(worker, script)?)
}

/// Moves the page's own scripts into a folder named by their content: a browser that caches them
/// never combines an old one with a new page.
fn rename_scripts(folder: &Path) -> Result<()> {
    let scripts: Vec<String> =
        files_of(folder)?.into_iter().filter(|file| file.starts_with("js/")).collect();
    if scripts.is_empty() {
        return fail("the build has no folder js/");
    }
    let named = format!("js-{}", hash_of(folder, &scripts)?);
    fs::rename(folder.join("js"), folder.join(&named))?;
    let page = folder.join(PAGE);
    let html = fs::read_to_string(&page)?.replace("/js/", &format!("/{named}/"));
    Ok(fs::write(page, html)?)
}

fn write_policy(folder: &Path) -> Result<()> {
    let page = folder.join(PAGE);
    let html = fs::read_to_string(&page)?;
    let Some((before, after)) = html.split_once(POLICY_PLACE) else {
        return fail(format!("web/{PAGE} has no {POLICY_PLACE} to put its policy behind"));
    };
    let policy = format!("<meta http-equiv=\"Content-Security-Policy\" content=\"{POLICY}\">");
    Ok(fs::write(&page, format!("{before}{POLICY_PLACE}\n  {policy}{after}"))?)
}

/// Returns all files by their paths in the folder, sorted.
pub fn files_of(folder: &Path) -> Result<Vec<String>> {
    fn collect(folder: &Path, prefix: &str, files: &mut Vec<String>) -> Result<()> {
        let mut entries: Vec<PathBuf> = fs::read_dir(folder)?
            .map(|entry| entry.map(|entry| entry.path()))
            .collect::<std::io::Result<_>>()?;
        entries.sort();
        for path in entries {
            let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
            if path.is_dir() {
                collect(&path, &format!("{prefix}{name}/"), files)?;
            } else {
                files.push(format!("{prefix}{name}"));
            }
        }
        Ok(())
    }
    let mut files = Vec::new();
    collect(folder, "", &mut files)?;
    Ok(files)
}

/// Returns a hash of all names and contents.
fn hash_of(folder: &Path, files: &[String]) -> Result<String> {
    let mut hasher = DefaultHasher::new();
    for file in files {
        file.hash(&mut hasher);
        fs::read(folder.join(file))?.hash(&mut hasher);
    }
    Ok(format!("{:016x}", hasher.finish()))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn folder(name: &str, boot: &str) -> PathBuf {
        let folder = std::env::temp_dir().join(format!("segue-seal-{}-{name}", std::process::id()));
        drop(fs::remove_dir_all(&folder));
        fs::create_dir_all(folder.join("js/compute")).unwrap();
        fs::create_dir_all(folder.join("js/corpus")).unwrap();
        fs::create_dir_all(folder.join("samples")).unwrap();
        for (file, text) in [
            (
                "index.html",
                "<html><head><meta charset=\"utf-8\"></head><script src=\"./js/boot.js\"></script></html>",
            ),
            ("js/boot.js", boot),
            ("js/compute/compute_bg.wasm", "\0asm"),
            ("js/corpus/corpus_bg.wasm", "\0asm"),
            ("segue-1.wasm", "\0asm"),
            ("webgpu-2.wasm", "\0asm"),
            ("samples/walk.gz", "packed"),
            (
                "sw.js",
                "const BUILD = \"BUILD\"; const FILES = [/* FILES */]; const WITH = [/* WEBGL2 */]; \
                 const WITHOUT = [/* WEBGPU */]; const LATER = [/* LATER */];",
            ),
        ] {
            fs::write(folder.join(file), text).unwrap();
        }
        folder
    }

    #[test]
    fn seal_renames_files_that_changed() {
        let read = |name: &str, boot: &str| {
            let folder = folder(name, boot);
            seal(&folder, true).unwrap();
            let texts = [PAGE, WORKER].map(|file| fs::read_to_string(folder.join(file)).unwrap());
            let names = files_of(&folder).unwrap();
            fs::remove_dir_all(&folder).unwrap();
            (texts, names)
        };
        let ([page, worker], files) = read("a", "1");
        let scripts = files.iter().find(|file| file.starts_with("js-")).unwrap();
        assert!(
            page.contains(&format!("./{scripts}")) && worker.contains(scripts),
            "{page} {worker}"
        );
        let (first, rest) = worker.split_once("WITH ").unwrap();
        let (webgl2, rest) = rest.split_once("WITHOUT").unwrap();
        let (webgpu, later) = rest.split_once("LATER").unwrap();
        assert!(first.contains("\"index.html\"") && !first.contains("wasm"), "{worker}");
        assert!(webgl2.contains("segue-1.wasm") && !webgl2.contains("webgpu"), "{worker}");
        assert!(webgpu.contains("webgpu-2.wasm") && !webgpu.contains("segue-"), "{worker}");
        assert!(!first.contains("samples") && later.contains("\"samples/walk.gz\""), "{worker}");
        assert!(
            !first.contains("compute") && later.contains("/compute/compute_bg.wasm"),
            "{worker}"
        );
        assert!(later.contains("/corpus/corpus_bg.wasm"), "{worker}");
        assert!(!worker.contains("sw.js"), "{worker}");
        let policy = page.find("Content-Security-Policy").unwrap();
        assert!(
            policy < page.find("<script").unwrap()
                && page.contains("script-src 'self' 'wasm-unsafe-eval';"),
            "{page}"
        );
        assert_eq!(
            read("b", "1"),
            ([page.clone(), worker.clone()], files.clone()),
            "the same again"
        );
        let ([other_page, other_worker], other_files) = read("c", "2");
        assert!(page != other_page && worker != other_worker && files != other_files);
    }

    #[test]
    fn seal_in_development_caches_nothing() {
        let folder = folder("dev", "1");
        seal(&folder, false).unwrap();
        assert!(!folder.join(WORKER).exists());
        let page = fs::read_to_string(folder.join(PAGE)).unwrap();
        assert!(
            !page.contains("name=\"build\"") && !page.contains("Content-Security-Policy"),
            "{page}"
        );
        fs::remove_dir_all(&folder).unwrap();
    }
}
