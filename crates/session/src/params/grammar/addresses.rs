//! Addresses of files, separated by spaces: `https://a.org/walk.bvh https://a.org/run.bvh`.

use super::{Misread, entries};

/// The greatest number of addresses in a link: more are an accident.
const MAX_ADDRESSES: usize = 256;

pub(super) fn read(text: &str) -> Result<Vec<String>, Misread> {
    let expected = "an address that starts with https://";
    entries(text.split_whitespace(), MAX_ADDRESSES, expected, |address| {
        let is_web = ["https://", "http://"].iter().any(|scheme| address.starts_with(scheme));
        is_web.then(|| address.to_owned())
    })
}

pub(super) fn write(addresses: &[String]) -> String {
    addresses.join(" ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn addresses_read_back_as_written() {
        let text = "https://example.org/a.bvh http://example.org/b,c(d).bvh?x=1";
        assert_eq!(write(&read(text).unwrap()), text);
        assert_eq!(read("  https://x/y \n"), Ok(vec!["https://x/y".to_owned()]));
        assert_eq!(read(" "), Ok(vec![]));
    }

    #[test]
    fn address_of_another_scheme_is_named_with_its_place() {
        for bad in ["ftp://x/b.bvh", "javascript:alert(1)", "file.bvh"] {
            let error = read(&format!("https://example.org/a.bvh {bad}")).unwrap_err().to_string();
            assert_eq!(
                error,
                format!("entry 2: found `{bad}`, expected an address that starts with https://")
            );
        }
        assert!(read(&"https://x ".repeat(257)).unwrap_err().to_string().contains("256 at most"));
    }
}
