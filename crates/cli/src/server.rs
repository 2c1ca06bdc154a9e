//! A server on this machine alone, for the built page and the files that it opens.

use crate::status::Failure;
use percent_encoding::percent_decode_str;
use std::fs::File;
use std::path::{Component, Path, PathBuf};
use std::thread;
use tiny_http::{Header, Method, Request, Response, ResponseBox, Server};

/// The folder of addresses in which the opened files are.
const OPENED: &str = "/opened/";

/// A page and files, served on 127.0.0.1.
pub(crate) struct PageServer {
    server: Server,
    port: u16,
    page: PathBuf,
    files: Vec<PathBuf>,
}

impl PageServer {
    /// Binds to a free port, or the one that is asked for.
    ///
    /// # Errors
    /// [`Failure`] if there is none.
    pub(crate) fn bind(port: u16, page: PathBuf, files: Vec<PathBuf>) -> Result<Self, Failure> {
        let server = Server::http(("127.0.0.1", port)).map_err(|error| {
            Failure::unreadable(format!("port {port} of this machine cannot be used: {error}"))
        })?;
        let port = server.server_addr().to_ip().map_or(port, |address| address.port());
        Ok(Self { server, port, page, files })
    }

    /// Returns the address of the page.
    pub(crate) fn address(&self) -> String {
        format!("http://127.0.0.1:{}/", self.port)
    }

    /// Returns the addresses of the files, each with the file's name at its end.
    pub(crate) fn file_addresses(&self) -> Vec<String> {
        let address = |(number, path): (usize, &PathBuf)| {
            let name = path.file_name().unwrap_or_default().to_string_lossy();
            let name =
                percent_encoding::utf8_percent_encode(&name, percent_encoding::NON_ALPHANUMERIC);
            // The ending stays readable: the page knows files by it.
            let name = name.to_string().replace("%2E", ".");
            format!("http://127.0.0.1:{}{OPENED}{number}/{name}", self.port)
        };
        self.files.iter().enumerate().map(address).collect()
    }

    /// Answers until the process ends. A request is answered on a thread of its own: a browser
    /// reads a long answer only when it has use for it, and meanwhile asks for other files.
    pub(crate) fn run(&self) {
        thread::scope(|scope| {
            for request in self.server.incoming_requests() {
                scope.spawn(move || {
                    let response = self.respond(&request);
                    // A browser that has left is no error.
                    request.respond(response).ok();
                });
            }
        });
    }

    fn respond(&self, request: &Request) -> ResponseBox {
        // A page elsewhere whose name leads here must not read files.
        let own = [format!("127.0.0.1:{}", self.port), format!("localhost:{}", self.port)];
        let host = request.headers().iter().find(|header| header.field.equiv("Host"));
        if !host.is_some_and(|host| own.iter().any(|own| host.value == own.as_str())) {
            return failed(403, "this server answers to 127.0.0.1 only");
        }
        if !matches!(request.method(), Method::Get | Method::Head) {
            return failed(405, "only GET and HEAD");
        }
        match self.file_of(request.url()).and_then(|path| Some((File::open(&path).ok()?, path))) {
            Some((file, path)) => {
                // With its length, by which the page tells the progress.
                let response = Response::from_file(file).with_chunked_threshold(usize::MAX);
                let headers = [("Content-Type", media_type(&path)), ("Cache-Control", "no-cache")];
                let headers = headers.into_iter().filter_map(|(name, value)| {
                    Header::from_bytes(name.as_bytes(), value.as_bytes()).ok()
                });
                headers.fold(response, Response::with_header).boxed()
            }
            None => failed(404, "not found"),
        }
    }

    /// Returns the file of an address: an opened one, or one of the page, and nothing else.
    fn file_of(&self, url: &str) -> Option<PathBuf> {
        let path = url.split(['?', '#']).next()?;
        if let Some(rest) = path.strip_prefix(OPENED) {
            let number: usize = rest.split('/').next()?.parse().ok()?;
            return self.files.get(number).cloned();
        }
        let path = percent_decode_str(path).decode_utf8().ok()?;
        let relative = Path::new(path.trim_start_matches('/'));
        if !relative.components().all(|part| matches!(part, Component::Normal(_))) {
            return None;
        }
        let file = self.page.join(relative);
        let file = if file.is_dir() { file.join("index.html") } else { file };
        file.is_file().then_some(file)
    }
}

fn failed(status: u16, reason: &str) -> ResponseBox {
    Response::from_string(reason).with_status_code(status).boxed()
}

fn media_type(path: &Path) -> &'static str {
    match path.extension().and_then(|ending| ending.to_str()).unwrap_or_default() {
        "html" => "text/html; charset=utf-8",
        "js" | "mjs" => "text/javascript; charset=utf-8",
        "wasm" => "application/wasm",
        "css" => "text/css; charset=utf-8",
        "json" => "application/json",
        "webmanifest" => "application/manifest+json",
        "svg" => "image/svg+xml",
        "png" => "image/png",
        "gz" => "application/gzip",
        "md" | "txt" | "bvh" => "text/plain; charset=utf-8",
        _ => "application/octet-stream",
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::{Read as _, Write as _};
    use std::net::TcpStream;
    use std::time::Duration;

    #[test]
    fn file_of_an_address_is_one_of_the_page_or_an_opened_one() {
        let page = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
        let opened = PathBuf::from("somewhere/走 路.bvh");
        let server = PageServer::bind(0, page.clone(), vec![opened.clone()]).unwrap();
        let addresses = server.file_addresses();
        let own = format!("{}opened/0/%E8%B5%B0%20%E8%B7%AF.bvh", server.address());
        assert_eq!(addresses, [own]);
        assert_eq!(server.file_of("/opened/0/x.bvh"), Some(opened));
        assert_eq!(server.file_of("/main.rs?lab=blend"), Some(page.join("main.rs")));
        for other in ["/opened/1/x", "/opened/-1", "/../Cargo.toml", "/%2e%2e/Cargo.toml", "/x"] {
            assert_eq!(server.file_of(other), None, "{other}");
        }
    }

    /// As a browser asks for the module of the app, and reads it once its JavaScript is there.
    #[test]
    fn answer_that_nobody_reads_holds_up_no_other() {
        let long = std::env::temp_dir().join(format!("segue-long-{}.bvh", std::process::id()));
        std::fs::write(&long, vec![b' '; 32 << 20]).unwrap();
        let page = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
        let server = PageServer::bind(0, page, vec![long.clone()]).unwrap();
        let port = server.port;
        let ask = move |path: &str| {
            let mut stream = TcpStream::connect(("127.0.0.1", port)).unwrap();
            stream.set_read_timeout(Some(Duration::from_secs(20))).unwrap();
            write!(stream, "GET {path} HTTP/1.1\r\nHost: 127.0.0.1:{port}\r\n\r\n").unwrap();
            stream
        };
        // It runs until the tests end.
        thread::spawn(move || server.run());
        let unread = ask("/opened/0/long.bvh");
        let mut first = [0; 15];
        ask("/main.rs").read_exact(&mut first).unwrap();
        assert_eq!(&first, b"HTTP/1.1 200 OK");
        drop(unread);
        std::fs::remove_file(long).unwrap();
    }
}
