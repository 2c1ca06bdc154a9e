//! The page's folder, built from web/index.html as Trunk builds it: files that the page's
//! `data-trunk` links name are copied, and Trunk.toml determines how the app starts. Both files are
//! read here, so that `trunk serve` and `cargo xtask serve` build the same page.

use std::fs;
use std::hash::{DefaultHasher, Hash as _, Hasher as _};
use std::path::{Path, PathBuf};

use crate::shell::{Result, fail};

/// The name of the app's module that draws with WebGPU alone, with which its files' names begin.
pub const WEBGPU: &str = "webgpu";
/// The ends of the names of the app's files, as `segue-bindgen` writes them; the last is that of
/// the rest of a module that is divided.
const JS: &str = ".js";
const WASM: &str = "_bg.wasm";
const REST: &str = "_rest.wasm";

/// Builds the folder of the page `html`, whose files are beside it. `bindgen` writes the JavaScript
/// and the WebAssembly of a binary into a folder. `has_webgpu` adds the module [`WEBGPU`], which
/// the page then prefers where the browser has WebGPU.
pub fn make(
    html: &Path,
    trunk: &str,
    folder: &Path,
    has_webgpu: bool,
    bindgen: &mut dyn FnMut(&str, &Path) -> Result<()>,
) -> Result<()> {
    fs::create_dir_all(folder)?;
    let mut page = fs::read_to_string(html)?;
    let beside = html.parent().unwrap_or(Path::new(""));
    let base = setting(trunk, "public_url")?;
    let mut preload = String::new();
    while let Some(start) = page.find("<link data-trunk ") {
        let Some(length) = page[start..].find('>') else {
            return fail(format!("{}: a `<link data-trunk` has no end", html.display()));
        };
        let link = Link(&page[start..=start + length]);
        let text = match link.attribute("rel")? {
            "css" => {
                let path = beside.join(link.attribute("href")?);
                let bytes = fs::read(&path)?;
                let name = path.file_stem().unwrap_or_default().to_string_lossy();
                let name = format!("{name}-{}.css", hash_of(std::slice::from_ref(&bytes)));
                fs::write(folder.join(&name), bytes)?;
                let href = link.attribute("href")?;
                link.0
                    .replace("data-trunk rel=\"css\"", "rel=\"stylesheet\"")
                    .replace(&format!("href=\"{href}\""), &format!("href=\"{base}{name}\""))
                    .replace('>', "/>")
            }
            "copy-file" => {
                let path = beside.join(link.attribute("href")?);
                fs::copy(&path, folder.join(path.file_name().unwrap_or_default()))?;
                String::new()
            }
            "copy-dir" => {
                let path = beside.join(link.attribute("href")?).canonicalize()?;
                copy_folder(&path, &folder.join(path.file_name().unwrap_or_default()))?;
                String::new()
            }
            "rust" if link.0.contains("data-type=\"worker\"") => {
                let place = folder.join(link.attribute("data-target-path")?);
                fs::create_dir_all(&place)?;
                bindgen(link.attribute("data-bin")?, &place)?;
                String::new()
            }
            "rust" => {
                let app = App::write(link.attribute("data-bin")?, folder, bindgen)?;
                preload = app.fill(&setting(trunk, "pattern_preload")?, &base);
                let script = app.fill(&setting(trunk, "pattern_script")?, &base);
                // Trunk's pattern has the names of a module that is whole.
                let mut names = Vec::new();
                if let Some(rest) = &app.rest {
                    names.push(format!("data-rest=\"{base}{rest}\""));
                }
                if has_webgpu {
                    let webgpu = App::write(WEBGPU, folder, bindgen)?;
                    names.push(format!("data-webgpu-js=\"{base}{}\"", webgpu.js));
                    names.push(format!("data-webgpu-wasm=\"{base}{}\"", webgpu.wasm));
                    if let Some(rest) = &webgpu.rest {
                        names.push(format!("data-webgpu-rest=\"{base}{rest}\""));
                    }
                }
                names.push("data-js=".to_owned());
                script.replacen("data-js=", &names.join(" "), 1)
            }
            other => {
                return fail(format!(
                    "{}: only Trunk knows rel=\"{other}\"; teach xtask/src/page.rs",
                    html.display()
                ));
            }
        };
        page.replace_range(start..=start + length, &text);
    }
    let Some((head, body)) = page.split_once("</head>") else {
        return fail(format!("{} has no head", html.display()));
    };
    Ok(fs::write(folder.join("index.html"), format!("{head}{preload}</head>{body}"))?)
}

/// A `<link data-trunk …>`.
struct Link<'a>(&'a str);

impl<'a> Link<'a> {
    fn attribute(&self, name: &str) -> Result<&'a str> {
        let value = self
            .0
            .split_once(&format!(" {name}=\""))
            .and_then(|(_, rest)| rest.split_once('"').map(|(value, _)| value));
        value.map_or_else(|| fail(format!("`{}` has no {name}=\"…\"", self.0)), Ok)
    }
}

/// The names of the app's files, which change with their content.
struct App {
    js: String,
    wasm: String,
    /// The rest of a module that is divided.
    rest: Option<String>,
}

impl App {
    fn write(
        bin: &str,
        folder: &Path,
        bindgen: &mut dyn FnMut(&str, &Path) -> Result<()>,
    ) -> Result<Self> {
        bindgen(bin, folder)?;
        let made = |end: &str| folder.join(format!("{bin}{end}"));
        let has_rest = made(REST).exists();
        let ends = if has_rest { &[JS, WASM, REST][..] } else { &[JS, WASM] };
        let mut contents = Vec::new();
        for end in ends {
            contents.push(fs::read(made(end))?);
        }
        let hash = hash_of(&contents);
        let name = |end: &str| format!("{bin}-{hash}{end}");
        for end in ends {
            fs::rename(made(end), folder.join(name(end)))?;
        }
        Ok(Self { js: name(JS), wasm: name(WASM), rest: has_rest.then(|| name(REST)) })
    }

    fn fill(&self, pattern: &str, base: &str) -> String {
        pattern.replace("{base}", base).replace("{js}", &self.js).replace("{wasm}", &self.wasm)
    }
}

/// Returns a string of Trunk.toml, in quotes or, over several lines, in three apostrophes.
fn setting(trunk: &str, key: &str) -> Result<String> {
    let rest = trunk.split_once(&format!("\n{key} = ")).map_or("", |(_, rest)| rest);
    let value = ["'''", "\""].into_iter().find_map(|quote| {
        rest.strip_prefix(quote)?.split_once(quote).map(|(value, _)| value.to_owned())
    });
    value.map_or_else(|| fail(format!("Trunk.toml has no text `{key}`")), Ok)
}

fn copy_folder(from: &Path, to: &Path) -> Result<()> {
    fs::create_dir_all(to)?;
    for entry in fs::read_dir(from)? {
        let path: PathBuf = entry?.path();
        let copy = to.join(path.file_name().unwrap_or_default());
        if path.is_dir() {
            copy_folder(&path, &copy)?;
        } else {
            fs::copy(&path, copy)?;
        }
    }
    Ok(())
}

fn hash_of(parts: &[Vec<u8>]) -> String {
    let mut hasher = DefaultHasher::new();
    parts.hash(&mut hasher);
    format!("{:016x}", hasher.finish())
}

#[cfg(test)]
mod tests {
    use super::*;

    const TRUNK: &str = "[build]\npublic_url = \"./\"\npattern_script = '''<script src=\"{base}{js}\" data-js=\"{js}\"></script>'''\n\
                         pattern_preload = '''<link href=\"{base}{wasm}\">\n'''\n";

    /// Builds the page of these links in a folder of its own; returns its HTML and its files.
    fn made(name: &str, links: &str, has_webgpu: bool) -> Result<(String, Vec<String>)> {
        made_of(name, links, has_webgpu, &[".js", "_bg.wasm"])
    }

    /// Builds a page like [`made`], of binaries that consist of files with these ends.
    fn made_of(
        name: &str,
        links: &str,
        has_webgpu: bool,
        ends: &[&str],
    ) -> Result<(String, Vec<String>)> {
        let sources =
            std::env::temp_dir().join(format!("segue-page-{}-{name}", std::process::id()));
        drop(fs::remove_dir_all(&sources));
        fs::create_dir_all(sources.join("web/js"))?;
        fs::write(sources.join("web/page.css"), "body {}")?;
        fs::write(sources.join("web/js/boot.js"), "boot")?;
        let html = sources.join("web/index.html");
        fs::write(&html, format!("<head>{links}</head><body></body>"))?;
        let folder = sources.join("made");
        let outcome = make(&html, TRUNK, &folder, has_webgpu, &mut |bin, place| {
            for end in ends {
                fs::write(place.join(format!("{bin}{end}")), end)?;
            }
            Ok(())
        });
        let made = outcome.and_then(|()| {
            let html = fs::read_to_string(folder.join("index.html"))?;
            Ok((html, crate::seal::files_of(&folder)?))
        });
        fs::remove_dir_all(&sources)?;
        made
    }

    #[test]
    fn make_replaces_links_for_trunk() {
        let (html, files) = made(
            "all",
            "<link data-trunk rel=\"css\" href=\"page.css\" data-integrity=\"none\">\
             <link data-trunk rel=\"rust\" href=\"../Cargo.toml\" data-bin=\"app\">\
             <link data-trunk rel=\"rust\" href=\"../Cargo.toml\" data-bin=\"reader\" data-type=\"worker\" data-target-path=\"js/read\">\
             <link data-trunk rel=\"copy-dir\" href=\"js\">",
            false,
        )
        .unwrap();
        let [script, app_js, app_wasm, reader_js, reader_wasm, css] = [
            "js/boot.js",
            "app-",
            "_bg.wasm",
            "js/read/reader.js",
            "js/read/reader_bg.wasm",
            "page-",
        ]
        .map(|part| files.iter().find(|file| file.contains(part)).unwrap());
        assert_eq!(files.len(), 7, "with index.html: {files:?} {script} {reader_js} {reader_wasm}");
        assert_eq!(
            html,
            format!(
                "<head><link rel=\"stylesheet\" href=\"./{css}\" data-integrity=\"none\"/><script src=\"./{app_js}\" data-js=\"{app_js}\"></script>\
                 <link href=\"./{app_wasm}\">\n</head><body></body>"
            )
        );
    }

    #[test]
    fn make_with_a_module_for_webgpu_names_both() {
        let link = "<link data-trunk rel=\"rust\" href=\"../Cargo.toml\" data-bin=\"app\">";
        let (html, files) = made("two", link, true).unwrap();
        let file = |start: &str, end: &str| {
            files.iter().find(|file| file.starts_with(start) && file.ends_with(end)).unwrap()
        };
        assert_eq!(files.len(), 5, "with index.html: {files:?}");
        let named = format!(
            "data-webgpu-js=\"./{}\" data-webgpu-wasm=\"./{}\" data-js=\"{}\"",
            file("webgpu-", ".js"),
            file("webgpu-", ".wasm"),
            file("app-", ".js"),
        );
        assert!(html.contains(&named), "{html}");
    }

    #[test]
    fn make_with_divided_modules_names_all_parts() {
        let link = "<link data-trunk rel=\"rust\" href=\"../Cargo.toml\" data-bin=\"app\">";
        let (html, files) =
            made_of("parts", link, true, &[".js", "_bg.wasm", "_rest.wasm"]).unwrap();
        assert_eq!(files.len(), 7, "with index.html: {files:?}");
        let names =
            ["data-rest", "data-webgpu-js", "data-webgpu-wasm", "data-webgpu-rest", "data-js"];
        for (name, file) in names.iter().zip(["app-", "webgpu-", "webgpu-", "webgpu-", "app-"]) {
            assert!(html.contains(&format!(" {name}=\"")), "{name} in {html}");
            assert!(html.contains(file), "{file} in {html}");
        }
        let rest =
            files.iter().find(|file| file.starts_with("app-") && file.ends_with("_rest.wasm"));
        assert!(html.contains(&format!("data-rest=\"./{}\"", rest.unwrap())), "{html}");
    }

    #[test]
    fn make_with_an_unknown_link_is_refused() {
        let error =
            made("sass", "<link data-trunk rel=\"sass\" href=\"page.scss\">", false).unwrap_err();
        assert!(error.to_string().contains("rel=\"sass\""), "{error}");
    }
}
