//! Tests of the table of parameters.

use super::*;
use proptest::prelude::*;

#[test]
fn rows_of_the_table_are_consistent() {
    for (index, param) in PARAMS.iter().enumerate() {
        assert_eq!(param.key as usize, index);
        assert_eq!(Key::from_name(param.name), Some(param.key), "{} is there twice", param.name);
        assert_eq!(
            param.check(param.default_value()).as_ref(),
            Ok(&param.default_value()),
            "{}",
            param.name
        );
        let is_place = param.has(Mark::PlaceInA) || param.has(Mark::PlaceInB);
        let default = param.format(&param.default_value());
        assert!(!is_place || default == "auto" || default.is_empty(), "{}", param.name);
        let is_of_lab = param.group.is_of_lab();
        let outside =
            [Mark::State, Mark::NoUndo, Mark::Compare, Mark::ByPointer, Mark::PlaceInResult];
        for &mark in param.marks {
            assert_eq!(is_of_lab, !outside.contains(&mark), "{}: {mark:?}", param.name);
        }
        assert!(param.help.ends_with('.') && !param.label.is_empty(), "{}", param.name);
        assert!(param.name.bytes().all(|b| b.is_ascii_lowercase() || b == b'_'), "{}", param.name);
    }
}

#[test]
fn invalid_values_are_named() {
    let window = Key::BlendWindow.param();
    assert_eq!(
        window.parse("many").unwrap_err().to_string(),
        "blend_window: found `many`, expected a number of frames"
    );
    assert_eq!(
        window.parse("0").unwrap_err().to_string(),
        "blend_window: found 0, expected 1 to 240 frames"
    );
    assert_eq!(Key::LeaveA.param().parse("auto"), Ok(Value::Auto));
    assert!(Key::Lab.param().parse("cook").unwrap_err().to_string().contains("view, make, blend"));
    assert!(window.parse("inf").is_err() && window.parse("NaN").is_err());
}

proptest! {
    #[test]
    fn numbers_read_back_as_written(row in 0..PARAMS.len(), part in 0.0f64..=1.0) {
        let param = &PARAMS[row];
        if let Kind::Number { min, max, .. } = param.kind {
            let value = param.check(Value::Number(min + (max - min) * part)).unwrap();
            prop_assert_eq!(param.parse(&param.format(&value)), Ok(value));
        }
    }
}
