//! Pickles that no program of good will writes, and those of old ones.

use super::read;

/// Returns the array `a` of a pickle as numbers.
fn numbers(pickle: &[u8]) -> Option<Vec<f32>> {
    let bundles = read(pickle).ok()?;
    let array = bundles.first()?.get("a")?;
    array.view().numbers(&mut crate::warning::Tally::default()).ok()
}

/// A dictionary `{'a': value}`.
fn dictionary(value: &[u8]) -> Vec<u8> {
    [b"\x80\x02}X\x01\0\0\0a".as_slice(), value, b"s."].concat()
}

#[test]
fn numbers_of_every_operation_are_read() {
    for (value, expected) in [
        (b"K\x07".as_slice(), 7.0),
        (b"M\x01\x02", 513.0),
        (b"J\xfe\xff\xff\xff", -2.0),
        (b"I12\n", 12.0),
        (b"L-3L\n", -3.0),
        (b"\x8a\x01\xff", -1.0),
        (b"\x8b\x02\0\0\0\0\x01", 256.0),
        (b"F0.5\n", 0.5),
        (b"G\x3f\xe0\0\0\0\0\0\0", 0.5),
        (b"\x88", 1.0),
        (b"I00\n", 0.0),
    ] {
        assert_eq!(numbers(&dictionary(value)), Some(vec![expected]), "{value:?}");
    }
}

#[test]
fn call_of_an_unknown_function_is_not_made() {
    // os.system('true'), and an instance of a class with a state.
    for call in [
        b"cos\nsystem\n(X\x04\0\0\0truetR".as_slice(),
        b"cposix\nsystem\nX\x04\0\0\0true\x85R",
        b"c__main__\nThing\n)\x81}b",
    ] {
        assert_eq!(numbers(&dictionary(call)), None);
        // The values beside it are still read.
        let mut both = b"\x80\x02}(X\x01\0\0\0b".to_vec();
        both.extend(call);
        both.extend(b"X\x01\0\0\0aK\x05u.");
        assert_eq!(numbers(&both), Some(vec![5.0]));
    }
}

#[test]
fn operation_that_is_not_known_is_refused() {
    let fault = read(b"\x80\x02P1\n.").unwrap_err();
    assert!(fault.found.to_string().contains("0x50 at byte 2"), "{fault:?}");
}

#[test]
fn pickle_of_any_depth_and_length_is_bounded() {
    let million = 1_100_000;
    let refused = |bytes: Vec<u8>| read(&bytes).unwrap_err().found.to_string();
    assert!(refused(vec![b']'; million]).contains("too many parts"));
    assert!(refused([b"]".as_slice(), &vec![b'2'; million]].concat()).contains("too many parts"));
    // A list in a list, 500,000 times.
    let nested = [vec![b']'; 500_000], vec![b'a'; 499_999], b".".to_vec()].concat();
    assert!(read(&nested).is_err());
    // A list that contains itself, a thousand times.
    let mut looped = b"]q\0(".to_vec();
    looped.extend(b"h\0".repeat(1000));
    looped.extend(b"e.");
    assert!(read(&looped).is_err());
    // A long text that is encoded again and again.
    let text = vec![b'x'; 4000];
    let mut copies = [b"X\xa0\x0f\0\0", text.as_slice(), b"q\x01c_codecs\nencode\nq\x02"].concat();
    copies.extend(b"h\x02h\x01\x85R".repeat(100_000));
    assert!(refused(copies).contains("too many parts"));
}

#[test]
fn array_of_a_length_that_it_has_not_is_refused() {
    let mut pickle =
        b"\x80\x02}X\x01\0\0\0acnumpy.core.multiarray\n_reconstruct\n)R(K\x01".to_vec();
    pickle.extend(b"J\xff\xff\xff\x7f\x85cnumpy\ndtype\nX\x02\0\0\0f4\x85R\x89C\x04\0\0\0\0tbs.");
    let fault = read(&pickle).unwrap_err();
    assert!(fault.found.to_string().contains("(2147483647) with 4 bytes"), "{fault:?}");
}
