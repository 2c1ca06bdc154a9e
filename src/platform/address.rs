//! Parsing of addresses and their queries.

use super::motion_files::last_part;
use percent_encoding::percent_decode_str;
use segue_session::outside;

/// The key in a query that selects the graphics backend. It belongs to the page, not to the state.
const BACKEND: &str = "backend";
/// The value of `backend=` with which the page loads itself again when WebGPU has failed: it draws
/// with WebGL 2, and the address does not keep it.
const FALLBACK: &str = "backend=fallback";

/// Returns the value of `backend=` in a query.
#[cfg_attr(
    not(target_arch = "wasm32"),
    expect(dead_code, reason = "a window has no backend to choose by its address")
)]
pub(super) fn backend_of(query: &str) -> Option<String> {
    form_urlencoded::parse(bare(query).as_bytes())
        .find(|(key, _)| key == BACKEND)
        .map(|(_, value)| value.into_owned())
}

/// Returns `query` with the `backend=` of `old`, except [`FALLBACK`].
#[cfg_attr(
    not(any(target_arch = "wasm32", test)),
    expect(dead_code, reason = "a window has no address to keep it in")
)]
pub(super) fn with_backend_of(query: &str, old: &str) -> String {
    let kept = bare(old).split('&').find(|pair| pair.split('=').next() == Some(BACKEND));
    match kept.filter(|&pair| pair != FALLBACK) {
        Some(pair) if query.is_empty() => pair.to_owned(),
        Some(pair) => format!("{query}&{pair}"),
        None => query.to_owned(),
    }
}

/// Returns a query without its question mark and without `backend=`.
pub(super) fn state_of(query: &str) -> String {
    let pairs: Vec<&str> = bare(query)
        .split('&')
        .filter(|pair| !pair.is_empty() && pair.split('=').next() != Some(BACKEND))
        .collect();
    pairs.join("&")
}

/// Returns a query without its question mark.
fn bare(query: &str) -> &str {
    query.strip_prefix('?').unwrap_or(query)
}

/// Returns the name of the file at an address.
pub(crate) fn file_name_of(address: &str) -> String {
    let path = address.split(['?', '#']).next().unwrap_or(address);
    let path = path.split_once("://").map_or(path, |(_, rest)| rest);
    // A host without a path names no file.
    let name = path.split_once('/').map_or("", |(_, path)| last_part(path));
    let name = percent_decode_str(name).decode_utf8_lossy();
    if name.is_empty() { "download".to_owned() } else { outside::file_name(&name) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn backend_in_a_query_is_not_part_of_the_state() {
        assert_eq!(state_of("?lab=blend&backend=webgl2&t=1"), "lab=blend&t=1");
        assert_eq!(state_of(""), "");
        assert_eq!(state_of("?backend=webgpu"), "");
    }

    #[test]
    fn backend_of_an_address_is_kept_unless_it_is_a_fallback() {
        assert_eq!(with_backend_of("lab=loop", "?backend=webgl2&t=1"), "lab=loop&backend=webgl2");
        assert_eq!(with_backend_of("", "?t=1&backend=webgpu"), "backend=webgpu");
        assert_eq!(with_backend_of("lab=loop", "?t=1&backend=fallback"), "lab=loop");
        assert_eq!(with_backend_of("", "?backend=fallback"), "");
    }

    #[test]
    fn file_name_of_an_address_is_decoded_and_cleaned() {
        for (address, name) in [
            ("https://a.org/x/01%20walk.bvh?raw=1#top", "01 walk.bvh"),
            ("https://a.org/x/", "x"),
            ("https://a.org/walk%E2%80%AEhvb%00.exe%0A", "walkhvb.exe"),
            ("https://a.org", "download"),
            ("https://a.org/?file=x.bvh", "download"),
        ] {
            assert_eq!(file_name_of(address), name, "{address}");
        }
    }
}
