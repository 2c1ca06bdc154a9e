//! `segue open`: the server of the page and its files.

#![expect(clippy::unwrap_used, reason = "what fails here fails the test")]

mod common;

use common::{Folder, made};
use segue_motion::synth::Action;
use std::io::{BufRead as _, BufReader, Read as _, Write as _};
use std::net::TcpStream;
use std::process::{Child, Command, Stdio};

/// A running server, ended with the test.
struct Running(Child);

impl Drop for Running {
    fn drop(&mut self) {
        self.0.kill().ok();
        self.0.wait().ok();
    }
}

/// Returns the answer to a request, with its headers.
fn get(host: &str, port: u16, path: &str) -> String {
    let mut stream = TcpStream::connect(("127.0.0.1", port)).unwrap();
    write!(stream, "GET {path} HTTP/1.1\r\nHost: {host}\r\nConnection: close\r\n\r\n").unwrap();
    let mut answer = Vec::new();
    stream.read_to_end(&mut answer).unwrap();
    String::from_utf8_lossy(&answer).into_owned()
}

#[test]
fn page_and_files_are_served_to_this_machine_alone() {
    let folder = Folder::new("open");
    folder.put("page/index.html", "<title>the page</title>");
    folder.put("secret.txt", "secret");
    let path = folder.put_clip("走 路.bvh", &made(Action::Walk, 1.0));
    let mut command = Command::new(env!("CARGO_BIN_EXE_segue"));
    command.args(["open", "走 路.bvh", "--page", "page", "--no-browser", "--query", "?lab=clean"]);
    command.current_dir(&folder.0).stdin(Stdio::null()).stdout(Stdio::piped());
    let mut server = Running(command.stderr(Stdio::null()).spawn().unwrap());
    let mut address = String::new();
    BufReader::new(server.0.stdout.take().unwrap()).read_line(&mut address).unwrap();
    let rest = address.trim().strip_prefix("http://127.0.0.1:").unwrap();
    let (port, query) = rest.split_once("/?").unwrap();
    let own = format!("127.0.0.1:{port}");
    let port: u16 = port.parse().unwrap();
    assert!(query.starts_with("lab=clean&src=http%3A%2F%2F127%2E0%2E0%2E1%3A"), "{query}");

    assert!(get(&own, port, "/").contains("the page"));
    let answer = get(&own, port, "/opened/0/%E8%B5%B0.bvh");
    let (head, body) = answer.split_once("\r\n\r\n").unwrap();
    assert!(head.starts_with("HTTP/1.1 200"), "{head}");
    assert!(head.contains("Content-Length: "), "{head}");
    assert!(body == std::fs::read_to_string(path).unwrap(), "another file");
    for path in ["/opened/1/x.bvh", "/../secret.txt", "/%2e%2e/secret.txt", "/none"] {
        assert!(get(&own, port, path).starts_with("HTTP/1.1 404"), "{path}");
    }
    let answer = get("evil.example:80", port, "/opened/0/x.bvh");
    assert!(answer.starts_with("HTTP/1.1 403") && !answer.contains("HIERARCHY"), "{answer}");
}
