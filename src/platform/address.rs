//! Parsing of addresses and their queries.

use super::motion_files::last_part;
use percent_encoding::percent_decode_str;
use segue_session::outside;

/// The key in a query that selects the graphics backend. It belongs to the page, not to the state.
const BACKEND: &str = "backend";
/// The key that sets the number of workers, for tests and measurements. It, too, belongs to the
/// page.
const POOL: &str = "pool";
/// The value of `backend=` with which the page loads itself again when WebGPU has failed: it draws
/// with WebGL 2, and the address does not keep it.
const FALLBACK: &str = "backend=fallback";

/// Returns the value of `backend=` in a query.
#[cfg_attr(
    not(target_arch = "wasm32"),
    expect(dead_code, reason = "a window has no backend to choose by its address")
)]
pub(super) fn backend_of(query: &str) -> Option<String> {
    value_of(query, BACKEND)
}

/// Returns the value of `pool=` in a query.
#[cfg_attr(
    not(target_arch = "wasm32"),
    expect(dead_code, reason = "a window has no address to set it in")
)]
pub(super) fn pool_of(query: &str) -> Option<String> {
    value_of(query, POOL)
}

fn value_of(query: &str, wanted: &str) -> Option<String> {
    form_urlencoded::parse(bare(query).as_bytes())
        .find(|(key, _)| key == wanted)
        .map(|(_, value)| value.into_owned())
}

/// Returns whether a pair of a query belongs to the page, not to the state.
fn is_of_page(pair: &str) -> bool {
    matches!(pair.split('=').next(), Some(BACKEND | POOL))
}

/// Returns `query` with the keys of the page in `old`, except [`FALLBACK`].
#[cfg_attr(
    not(any(target_arch = "wasm32", test)),
    expect(dead_code, reason = "a window has no address to keep it in")
)]
pub(super) fn with_page_keys_of(query: &str, old: &str) -> String {
    let kept = bare(old).split('&').filter(|pair| is_of_page(pair) && *pair != FALLBACK);
    let pairs: Vec<&str> =
        Some(query).filter(|query| !query.is_empty()).into_iter().chain(kept).collect();
    pairs.join("&")
}

/// Returns a query without its question mark and without the keys of the page.
pub(super) fn state_of(query: &str) -> String {
    let pairs: Vec<&str> =
        bare(query).split('&').filter(|pair| !pair.is_empty() && !is_of_page(pair)).collect();
    pairs.join("&")
}

/// Returns a query without its question mark.
fn bare(query: &str) -> &str {
    query.strip_prefix('?').unwrap_or(query)
}

/// Returns the part of a clip's address in a corpus that names the clip, such as `3fa9c1d2@1.5-4`;
/// `None` if it is not the address of such a clip.
pub(crate) fn corpus_clip_of(address: &str) -> Option<&str> {
    let (file, clip) = address.split_once('#')?;
    let path = file.split('?').next().unwrap_or(file);
    (path.ends_with("/corpus.json") && !clip.is_empty()).then_some(clip)
}

/// Returns the name of the file at an address. That of a clip of a corpus is known when it is read:
/// until then it is the clip's id.
pub(crate) fn file_name_of(address: &str) -> String {
    if let Some(clip) = corpus_clip_of(address) {
        let id = clip.split('@').next().unwrap_or(clip);
        return outside::file_name(&format!("{}.npz", id.replace('/', " ")));
    }
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
        assert_eq!(state_of("?pool=off&lab=blend"), "lab=blend");
    }

    #[test]
    fn backend_of_an_address_is_kept_unless_it_is_a_fallback() {
        assert_eq!(with_page_keys_of("lab=loop", "?backend=webgl2&t=1"), "lab=loop&backend=webgl2");
        assert_eq!(with_page_keys_of("", "?t=1&backend=webgpu"), "backend=webgpu");
        assert_eq!(with_page_keys_of("lab=loop", "?t=1&backend=fallback"), "lab=loop");
        assert_eq!(with_page_keys_of("", "?backend=fallback"), "");
        assert_eq!(with_page_keys_of("t=1", "?pool=2&backend=webgpu"), "t=1&pool=2&backend=webgpu");
    }

    #[test]
    fn file_name_of_an_address_is_decoded_and_cleaned() {
        for (address, name) in [
            ("https://a.org/x/01%20walk.bvh?raw=1#top", "01 walk.bvh"),
            ("https://a.org/x/", "x"),
            ("https://a.org/walk%E2%80%AEhvb%00.exe%0A", "walkhvb.exe"),
            ("https://a.org", "download"),
            ("https://a.org/?file=x.bvh", "download"),
            ("https://a.org/takes/corpus.json#3fa9c1d2-0@1.5-4", "3fa9c1d2-0.npz"),
            ("https://a.org/takes/corpus.json#../x", ".. x.npz"),
            ("https://a.org/takes/corpus.json", "corpus.json"),
            ("https://a.org/takes/corpus.jsonx#3fa9c1d2", "corpus.jsonx"),
        ] {
            assert_eq!(file_name_of(address), name, "{address}");
        }
    }
}
