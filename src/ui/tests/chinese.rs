//! The interface in Chinese: every lab, and texts that have stayed English.

use super::clips::{loaded, with_file};
use super::*;
use segue_session::choices;
use segue_text::text_of_template;
use std::collections::BTreeSet;
use std::fs;

const HALL_SIZE: Vec2 = vec2(1280.0, 720.0);

/// Names, units and keys that are the same in Chinese.
const AS_IT_IS: [&str; 44] = [
    "EN", "Enter", "Segue", "VRMA", "BVH", "ASF", "AMC", "FBX", "NPZ", "GLB", "C3D", "TRC", "CSV",
    "CMU", "zip", "fps", "Hz", "cm", "ms", "Aa", "Shift", "Ctrl", "Home", "Esc", "Delete", "Tab",
    "atan", "atan2", "exp", "json", "JSON", "DOT", "Markdown", "MB", "mocap", "cmu", "edu", "cs",
    "NSF", "EIA", "XYZ", "ZXY", "YXZ", "English",
];

pub(super) fn pack() -> LanguagePack {
    let file = |name: &str| {
        fs::read(concat!(env!("CARGO_MANIFEST_DIR"), "/assets/lang/").to_owned() + name)
            .expect("a file of the language")
    };
    LanguagePack::read(&file("zh-Hant.json"), Arc::from(file("zh-Hant.otf"))).expect("a language")
}

/// Returns the language of the pack.
pub(super) fn language() -> Language {
    Language::of_tag("zh-Hant").expect("a language")
}

/// Returns a page in Chinese.
pub(super) fn chinese(
    size: Vec2,
    theme: Theme,
    link: &str,
    pack: &LanguagePack,
) -> Harness<'static, Page> {
    let mut page = page(link);
    page.state.language = language();
    let mut harness = harness(size, theme, page);
    pack.install_fonts(&harness.ctx);
    harness.run();
    pack.activate(&harness.ctx);
    harness.run();
    harness
}

/// Returns the words of a text that are neither Chinese nor the same everywhere.
fn english_in(text: &str) -> Vec<&str> {
    // An example of a link, `0.3:run,0.2:walk`, is one word.
    let words = text
        .split(|letter: char| !letter.is_ascii_graphic())
        .filter(|word| !word.contains([':', '=']));
    words
        .flat_map(|word| word.split(|letter: char| !letter.is_ascii_alphanumeric()))
        .filter(|word| {
            word.bytes().filter(u8::is_ascii_alphabetic).count() > 1 && !AS_IT_IS.contains(word)
        })
        .collect()
}

#[test]
fn every_lab_is_in_chinese() {
    let pack = pack();
    let rich = "lab=graph&play=off&t=12";
    for (name, size, theme, link) in [
        ("zh-view", DESK, DARK, "lab=view&play=off&t=1"),
        ("zh-make", DESK, LIGHT, "lab=make&play=off&t=1"),
        ("zh-blend", DESK, DARK, "lab=blend&play=off&t=1&compare=blend_window:30,15,10"),
        ("zh-transition", DESK, LIGHT, "lab=transition&play=off&t=1&mistake=hemisphere"),
        ("zh-speed", DESK, DARK, "lab=speed&play=off&t=1&speed=5"),
        ("zh-loop", DESK, LIGHT, "lab=loop&play=off&t=1"),
        ("zh-layers", DESK, DARK, "lab=layers&play=off&t=1&layer_mode=additive"),
        ("zh-register", DESK, LIGHT, "lab=register&play=off&t=1"),
        ("zh-path", DESK, DARK, "lab=path&play=off&t=1"),
        ("zh-clean", HALL_SIZE, LIGHT, "lab=clean&a=walk&clean_faults=4&play=off&t=1"),
        ("zh-phone-clean", PHONE, DARK, "lab=clean&a=walk&clean_faults=4&play=off&t=1"),
        ("zh-graph", DESK, LIGHT, rich),
        ("zh-match", DESK, DARK, "lab=match&scenario=left&play=off&t=2"),
        ("zh-hall-blend", HALL_SIZE, HALL, "lab=blend&play=off&t=1"),
        ("zh-hall-match", HALL_SIZE, HALL, "lab=match&scenario=left&play=off&t=2"),
        ("zh-phone-blend", PHONE, DARK, "lab=blend&play=off&t=1"),
        ("zh-phone-transition", PHONE, LIGHT, "lab=transition&play=off&t=1"),
        ("zh-phone-register", PHONE, DARK, "lab=register&play=off&t=1"),
        ("zh-phone-path", PHONE, LIGHT, "lab=path&play=off&t=1"),
        ("zh-phone-match", PHONE, DARK, "lab=match&scenario=left&play=off&t=2"),
        ("zh-phone-graph", PHONE, LIGHT, rich),
    ] {
        let mut harness = chinese(size, theme, link, &pack);
        picture(name, &mut harness);
    }
    let left: BTreeSet<String> = (pack.shown().into_iter())
        .filter_map(|(text, found)| {
            let shown = text_of_template(found.as_deref().unwrap_or(&text));
            let words = english_in(&shown);
            (!words.is_empty()).then(|| format!("{words:?} in {shown:?}, of {text:?}"))
        })
        .collect();
    assert!(left.is_empty(), "{}", left.into_iter().collect::<Vec<_>>().join("\n"));
}

#[test]
fn language_switch_asks_for_the_other_language() {
    let pack = pack();
    let mut harness = chinese(DESK, DARK, "lab=blend&play=off", &pack);
    harness.get_by_label("複製連結");
    harness.get_by_label("介面改用英文").click();
    harness.run();
    assert_eq!(harness.state().session.params().choice::<choices::PageLanguage>().word(), "en");
    crate::ui::activate_english(&harness.ctx);
    harness.state_mut().state.language = Language::default();
    harness.run();
    harness.get_by_label(text::COPY_LINK.english());
    harness.get_by_label(language().switch().english()).click();
    harness.run();
    assert_eq!(
        harness.state().session.params().choice::<choices::PageLanguage>().word(),
        "zh-Hant"
    );
}

/// The words "Walk" and "walk" have translations; names of the user's clips are not translated.
#[test]
fn name_of_a_users_clip_that_is_also_a_word_is_not_translated() {
    let pack = pack();
    for name in ["Walk", "walk"] {
        let mut page = with_file("lab=view&play=off");
        let id = loaded(&page).id.clone();
        for command in [Command::Rename(id.clone(), name.into()), Command::Assign(Slot::A, id)] {
            page.session.apply(command).expect("a clip of the library");
        }
        while page.session.work() {}
        page.state.language = language();
        let mut harness = harness(DESK, DARK, page);
        pack.install_fonts(&harness.ctx);
        harness.run();
        pack.activate(&harness.ctx);
        harness.run();
        let row = format!("{name}, ");
        let rows =
            harness.get_all_by_role(Role::Button).filter_map(|row| row.accesskit_node().label());
        assert_eq!(rows.filter(|label| label.starts_with(&row)).count(), 1, "the library");
        harness.get_by_role_and_label(Role::Button, &format!("{name} 作為 A"));
        let choice = harness.get_by_role_and_label(Role::ComboBox, Slot::A.label());
        assert_eq!(choice.value().as_deref(), Some(name), "the menu of clips");
        let headings = harness
            .get_all_by_role(Role::Heading)
            .filter_map(|title| title.accesskit_node().label());
        assert_eq!(
            headings.filter(|label| label.trim() == name).count(),
            1,
            "the title of the pane"
        );
        // The built-in walk is a word of the program.
        let built_in =
            harness.get_all_by_role(Role::Button).filter_map(|row| row.accesskit_node().label());
        assert_eq!(built_in.filter(|label| label.starts_with("走路, ")).count(), 1);
    }
}

/// The characters of the translations and of the lessons are in one of the fonts.
#[test]
fn every_character_is_in_the_fonts() {
    let root = concat!(env!("CARGO_MANIFEST_DIR"), "/assets/");
    let mut texts =
        vec![fs::read_to_string(root.to_owned() + "lang/zh-Hant.json").expect("the catalogue")];
    for entry in fs::read_dir(root.to_owned() + "lessons/zh-Hant").into_iter().flatten().flatten() {
        texts.push(fs::read_to_string(entry.path()).expect("a lesson is text"));
    }
    let mut harness = chinese(PHONE, DARK, "lab=view&play=off", &pack());
    harness.run();
    let missing: BTreeSet<char> = harness.ctx.fonts_mut(|fonts| {
        let font = DARK.font(theme::Type::Body);
        let letters =
            texts.iter().flat_map(|text| text.chars()).filter(|letter| !letter.is_control());
        letters.filter(|&letter| !fonts.has_glyph(&font, letter)).collect()
    });
    assert!(missing.is_empty(), "run assets/fonts/subset_zh.py again for {missing:?}");
    let bytes = fs::metadata(root.to_owned() + "lang/zh-Hant.otf").expect("the font").len();
    assert!(bytes <= 300 * 1024, "{bytes} bytes");
}
