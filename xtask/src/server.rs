//! A static file server for this machine, for `serve` and the browser tests.

use std::fs;
use std::io::{self, BufRead, BufReader, Write};
use std::net::{Ipv4Addr, TcpListener, TcpStream};
use std::path::{Component, Path, PathBuf};
use std::sync::Arc;
use std::time::{Duration, UNIX_EPOCH};

use crate::shell::{Result, fail};

pub struct Server {
    listener: TcpListener,
    folder: Arc<Path>,
}

impl Server {
    /// Binds to the port (0: any free one) on 127.0.0.1.
    pub fn bind(port: u16, folder: PathBuf) -> Result<Self> {
        if !folder.join("index.html").is_file() {
            return fail(format!("{} holds no index.html: build first", folder.display()));
        }
        match TcpListener::bind((Ipv4Addr::LOCALHOST, port)) {
            Ok(listener) => Ok(Self { listener, folder: folder.into() }),
            Err(error) => {
                fail(format!("port {port} cannot be had ({error}); `--port N` takes another"))
            }
        }
    }

    pub fn address(&self) -> String {
        let port = self.listener.local_addr().map_or(0, |address| address.port());
        format!("http://127.0.0.1:{port}/")
    }

    /// Serves until the process ends, each connection on a thread of its own.
    pub fn run(self) -> Result<()> {
        for stream in self.listener.incoming() {
            let Ok(stream) = stream else { continue };
            let folder = Arc::clone(&self.folder);
            std::thread::spawn(move || {
                // A browser that disconnects early is not an error.
                let _ = serve_connection(stream, &folder);
            });
        }
        Ok(())
    }
}

/// Serves one connection, with any number of requests.
fn serve_connection(stream: TcpStream, folder: &Path) -> io::Result<()> {
    stream.set_read_timeout(Some(Duration::from_secs(60)))?;
    stream.set_nodelay(true)?;
    let mut writer = stream.try_clone()?;
    let mut reader = BufReader::new(stream);
    while let Some(request) = Request::read(&mut reader)? {
        let response = respond(&request, folder);
        writer.write_all(&response.encode(&request))?;
    }
    Ok(())
}

#[derive(Default)]
struct Request {
    method: String,
    path: String,
    accepts: String,
    known_tag: String,
}

impl Request {
    fn read(reader: &mut impl BufRead) -> io::Result<Option<Self>> {
        let mut line = String::new();
        if reader.read_line(&mut line)? == 0 {
            return Ok(None);
        }
        let mut words = line.split_whitespace().map(str::to_owned);
        let mut request = Self {
            method: words.next().unwrap_or_default(),
            path: words.next().unwrap_or_default(),
            ..Self::default()
        };
        loop {
            let mut line = String::new();
            if reader.read_line(&mut line)? == 0 || line.trim().is_empty() {
                return Ok(Some(request));
            }
            let Some((name, value)) = line.split_once(':') else {
                continue;
            };
            match name.to_ascii_lowercase().as_str() {
                "accept-encoding" => request.accepts = value.trim().to_owned(),
                "if-none-match" => request.known_tag = value.trim().to_owned(),
                _ => {}
            }
        }
    }

    fn accepts(&self, encoding: &str) -> bool {
        self.accepts
            .split(',')
            .any(|one| one.split(';').next().unwrap_or_default().trim() == encoding)
    }
}

struct Response {
    status: &'static str,
    headers: Vec<(&'static str, String)>,
    body: Vec<u8>,
}

impl Response {
    fn text(status: &'static str) -> Self {
        Self {
            status,
            headers: vec![("Content-Type", "text/plain".to_owned())],
            body: status.as_bytes().to_vec(),
        }
    }

    fn encode(&self, request: &Request) -> Vec<u8> {
        let mut bytes =
            format!("HTTP/1.1 {}\r\nContent-Length: {}\r\n", self.status, self.body.len());
        for (name, value) in &self.headers {
            bytes += &format!("{name}: {value}\r\n");
        }
        bytes += "\r\n";
        let mut bytes = bytes.into_bytes();
        if request.method != "HEAD" {
            bytes.extend_from_slice(&self.body);
        }
        bytes
    }
}

fn respond(request: &Request, folder: &Path) -> Response {
    if request.method != "GET" && request.method != "HEAD" {
        return Response::text("405 Method Not Allowed");
    }
    let Some(file) = resolve(&request.path, folder) else {
        return Response::text("404 Not Found");
    };
    // Compressed files are served as by a public host.
    let packed = [("br", "br"), ("gz", "gzip")]
        .into_iter()
        .filter(|(_, encoding)| request.accepts(encoding))
        .find_map(|(ending, encoding)| {
            let mut name = file.clone().into_os_string();
            name.push(format!(".{ending}"));
            let path = PathBuf::from(name);
            path.is_file().then_some((path, encoding))
        });
    let (path, encoding) =
        packed.map_or((file.clone(), None), |(path, encoding)| (path, Some(encoding)));
    let tag = tag(&path);
    let mut headers = vec![
        ("Content-Type", media_type(&file).to_owned()),
        ("ETag", tag.clone()),
        // The browser may cache it but must revalidate: a rebuild shows at once, and compiled code
        // stays cached.
        ("Cache-Control", "no-cache".to_owned()),
        ("Vary", "Accept-Encoding".to_owned()),
    ];
    headers.extend(encoding.map(|encoding| ("Content-Encoding", encoding.to_owned())));
    if request.known_tag == tag {
        return Response { status: "304 Not Modified", headers, body: Vec::new() };
    }
    match fs::read(&path) {
        Ok(body) => Response { status: "200 OK", headers, body },
        Err(_) => Response::text("404 Not Found"),
    }
}

/// Returns the file of a request's path inside the folder, and nothing outside it.
fn resolve(request: &str, folder: &Path) -> Option<PathBuf> {
    let path = request.split(['?', '#']).next()?;
    let path = percent_decoded(path)?;
    let relative = Path::new(path.trim_start_matches('/'));
    if !relative.components().all(|part| matches!(part, Component::Normal(_))) {
        return None;
    }
    let file = folder.join(relative);
    let file = if file.is_dir() { file.join("index.html") } else { file };
    file.is_file().then_some(file)
}

fn percent_decoded(text: &str) -> Option<String> {
    let mut bytes = Vec::with_capacity(text.len());
    let mut rest = text.as_bytes();
    while let [first, tail @ ..] = rest {
        rest = tail;
        if *first == b'%' {
            let digits = std::str::from_utf8(rest.get(..2)?).ok()?;
            bytes.push(u8::from_str_radix(digits, 16).ok()?);
            rest = &rest[2..];
        } else {
            bytes.push(*first);
        }
    }
    String::from_utf8(bytes).ok()
}

/// Returns an entity tag that changes whenever the file does.
fn tag(path: &Path) -> String {
    let Ok(meta) = fs::metadata(path) else {
        return String::new();
    };
    let written = meta
        .modified()
        .ok()
        .and_then(|time| time.duration_since(UNIX_EPOCH).ok())
        .unwrap_or_default();
    format!("\"{:x}-{:x}\"", meta.len(), written.as_nanos())
}

fn media_type(file: &Path) -> &'static str {
    match file.extension().and_then(|ending| ending.to_str()).unwrap_or_default() {
        "html" => "text/html; charset=utf-8",
        "js" | "mjs" => "text/javascript; charset=utf-8",
        "wasm" => "application/wasm",
        "css" => "text/css; charset=utf-8",
        "json" => "application/json",
        "webmanifest" => "application/manifest+json",
        "svg" => "image/svg+xml",
        "png" => "image/png",
        // Not a content encoding: the page asks for the compressed file and unpacks it itself.
        "gz" => "application/gzip",
        "md" | "txt" | "bvh" => "text/plain; charset=utf-8",
        _ => "application/octet-stream",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn resolve_stays_inside_the_folder() {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
        assert!(resolve("/main.rs", &folder).is_some());
        assert!(resolve("/main.rs?lab=blend", &folder).is_some());
        for path in
            ["/../Cargo.toml", "/%2e%2e/Cargo.toml", "//etc/passwd", "/none.rs", "/%zz", "/%e2%82"]
        {
            assert!(resolve(path, &folder).is_none(), "{path}");
        }
    }

    #[test]
    fn accepts_matches_whole_names() {
        let request = Request { accepts: "gzip;q=0.8, br".to_owned(), ..Request::default() };
        assert!(request.accepts("gzip") && request.accepts("br"));
        assert!(!request.accepts("b"));
    }
}
