//! Addresses of files, separated by spaces: `https://a.org/walk.bvh https://a.org/run.bvh`.
//!
//! Every word is an entry: the file intake checks each address, so that one that cannot be fetched
//! does not keep the others from being loaded.

use super::Misread;

#[expect(clippy::unnecessary_wraps, reason = "the signature of all grammars")]
pub(super) fn read(text: &str) -> Result<Vec<String>, Misread> {
    Ok(text.split_whitespace().map(str::to_owned).collect())
}

pub(super) fn write(addresses: &[String]) -> String {
    addresses.join(" ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn addresses_read_back_as_written() {
        let text = "https://example.org/a.bvh http://example.org/b,c(d).bvh?x=1 ftp://x/b.bvh";
        assert_eq!(write(&read(text).unwrap()), text);
        assert_eq!(read("  https://x/y \n"), Ok(vec!["https://x/y".to_owned()]));
        assert_eq!(read(" "), Ok(vec![]));
    }
}
