//! The panel of lessons.

use super::*;
use crate::ui::LanguagePack;
use segue_session::Lesson;
use segue_session::lesson::Source;

/// Hands over the requested texts, from the project's folder.
pub(super) fn deliver(session: &mut Session) {
    for request in session.take_requests() {
        if let segue_session::Request::Lesson(source) = request {
            let text = match &source {
                Source::BuiltIn(file) => {
                    let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR"))
                        .join("assets/lessons")
                        .join(file);
                    std::fs::read(path).map_err(|error| error.to_string())
                }
                Source::Web(address) => Err(format!("There is no file at {address} (answer 404).")),
            };
            session.finish_lesson(&source, text.as_deref().map_err(|reason| reason.clone().into()));
        }
    }
    while session.work() {}
}

pub(super) fn lesson(link: &str) -> Page {
    let mut page = page(link);
    deliver(&mut page.session);
    page
}

/// Presses a widget, and hands over the texts that it requests.
fn go(label: &str, harness: &mut Harness<'_, Page>) {
    press(label, harness);
    deliver(&mut harness.state_mut().session);
    harness.run();
}

#[test]
fn lesson_is_read_tried_and_left() {
    let mut harness = harness(DESK, DARK, page("lab=make&gait=run&play=off"));
    go(text::LESSONS.english(), &mut harness);
    picture("lessons-contents", &mut harness);
    go("3. The blend window", &mut harness);
    harness.get_by_label("3 of 15");
    let params = |harness: &Harness<'_, Page>, key: Key| {
        key.param().format(harness.state().session.params().get(key))
    };
    assert_eq!(params(&harness, Key::Lab), "blend");
    assert_eq!(params(&harness, Key::Compare), "blend_window:30,15,10");
    let is_marked = |label: &str, harness: &Harness<'_, Page>| {
        let node = harness.get_by_label(label);
        node.accesskit_node().toggled() == Some(Toggled::True)
    };
    assert!(is_marked("Full, half, a third", &harness) && !is_marked("One frame", &harness));
    go("One frame", &mut harness);
    assert_eq!(params(&harness, Key::Compare), "blend_window:30,1");
    assert!(is_marked("One frame", &harness) && !is_marked("Full, half, a third", &harness));
    harness.state_mut().session.apply(Command::Undo).expect("a step to take back");
    harness.run();
    assert_eq!(params(&harness, Key::Compare), "blend_window:30,15,10");
    assert!(harness.query_by_label_contains("four times the acceleration").is_none());
    press(text::SHOW_ANSWER.english(), &mut harness);
    harness.get_by_label_contains("four times the acceleration");
    picture("lessons-answer", &mut harness);
    go(text::NEXT.english(), &mut harness);
    harness.get_by_label("4 of 15");
    harness.get_by_label(text::SHOW_ANSWER.english());
    go(text::PREVIOUS_PAGE.english(), &mut harness);
    harness.get_by_label("3 of 15");
    harness.key_press(Keyboard::Escape);
    harness.run();
    assert!(harness.state().session.lesson().is_none());
    harness.key_press(Keyboard::N);
    harness.run();
    harness.get_by_label("3. The blend window");
    // The list, the lesson, two pages, closing and undo: each is a step.
    for _ in 0..6 {
        harness.state_mut().session.apply(Command::Undo).expect("a step to take back");
    }
    assert_eq!(params(&harness, Key::Lesson), "");
    assert_eq!(
        (params(&harness, Key::Lab), params(&harness, Key::Gait)),
        ("make".to_owned(), "run".to_owned())
    );
}

#[test]
fn lesson_works_by_keyboard() {
    let mut harness = harness(DESK, LIGHT, lesson("lesson=foot_skate&lab=blend&play=off"));
    let node = harness.get_by_label("Only foot lock");
    node.focus();
    harness.run();
    harness.key_press(Keyboard::Enter);
    harness.run();
    assert!(harness.state().session.params().is_on(Key::FootLock));
    harness.get_by_label(text::SHOW_ANSWER.english()).focus();
    harness.run();
    harness.key_press(Keyboard::Enter);
    harness.run();
    harness.get_by_label_contains("at most and never stretches a leg");
}

#[test]
fn lesson_that_fails_to_load_says_why() {
    let mut harness = harness(PHONE, DARK, lesson("lesson=https://example.org/steps.md"));
    harness.get_by_label_contains("There is no file at https://example.org/steps.md");
    press(text::TRY_AGAIN.english(), &mut harness);
    assert!(matches!(harness.state().session.lesson(), Some(Lesson::Waiting)));
    picture("lessons-waiting", &mut harness);
}

#[test]
fn lessons_are_drawn_in_every_layout_and_language() {
    for (name, size, theme, link) in [
        ("desk-dark", DESK, DARK, "lesson=alignment&play=off&t=2.5"),
        ("desk-light", DESK, LIGHT, "lesson=half_life&play=off&t=2.5"),
        ("desk-graph", DESK, DARK, "lesson=distance_matrix&play=off&t=4"),
        ("desk-path", DESK, LIGHT, "lesson=path_editing&play=off&t=1"),
        ("projector", vec2(1280.0, 720.0), HALL, "lesson=blend_window&play=off&t=2.3"),
        ("projector-1920", vec2(1920.0, 1080.0), HALL, "lesson=slerp&play=off&t=2.3"),
        ("tablet", vec2(900.0, 700.0), LIGHT, "lesson=edge_weights&play=off"),
        ("phone-dark", PHONE, DARK, "lesson=foot_skate&play=off&t=1.4"),
        ("phone-light", PHONE, LIGHT, "lesson=contents&play=off"),
    ] {
        for (language, tag) in [("en", ""), ("zh", "zh-Hant")] {
            let mut page = page("lab=blend");
            if !tag.is_empty() {
                page.session.set_lesson_language("zh-Hant");
            }
            let named = link.split('&').next().unwrap_or_default();
            for link in [named, link] {
                page.session
                    .apply(if link == named {
                        Command::OpenLink(link.into())
                    } else {
                        Command::Set(rest_of(link))
                    })
                    .expect("a page as the tests need it");
                deliver(&mut page.session);
            }
            let mut harness = if tag.is_empty() {
                harness(size, theme, page)
            } else {
                harness_in_chinese(size, theme, page)
            };
            let said = |english: &'static str, chinese: &'static str| {
                if tag.is_empty() { english } else { chinese }
            };
            harness.get_by_label(said(text::CLOSE_LESSONS.english(), "關閉課程"));
            picture(&format!("lessons-{name}-{language}"), &mut harness);
            let show = said(text::SHOW_ANSWER.english(), "顯示解答");
            if harness.query_by_label(show).is_some() {
                press(show, &mut harness);
                picture(&format!("lessons-{name}-{language}-down"), &mut harness);
            }
        }
    }
}

/// Returns a link without its lesson.
fn rest_of(link: &str) -> Vec<(Key, Value)> {
    let values = segue_session::link::read(link).values;
    values.into_iter().filter(|(key, _)| *key != Key::Lesson).collect()
}

/// Shows the page in Chinese. Its font is available from the second frame on.
fn harness_in_chinese(size: Vec2, theme: Theme, page: Page) -> Harness<'static, Page> {
    let file = |name: &str| {
        let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("assets/lang").join(name);
        std::fs::read(path).expect("a language")
    };
    let pack = LanguagePack::read(&file("zh-Hant.json"), Arc::from(file("zh-Hant.otf")))
        .expect("a language");
    let mut harness = harness(size, theme, self::page("lab=make&play=off"));
    pack.install_fonts(&harness.ctx);
    harness.run();
    pack.activate(&harness.ctx);
    *harness.state_mut() = page;
    harness.run();
    harness
}

/// The characters of the Chinese lessons are checked with the translations.
#[test]
fn every_character_of_the_lessons_is_in_the_font() {
    let harness = harness(PHONE, DARK, page("lab=make&play=off"));
    for name in segue_session::lesson::LESSONS {
        let file = segue_session::lesson::file_name(name).expect("a lesson of the list");
        let path = format!("{}/assets/lessons/en/{file}", env!("CARGO_MANIFEST_DIR"));
        let text = std::fs::read_to_string(path).expect("a lesson of the list");
        let font = DARK.font(theme::Type::Reading);
        let missing: String = harness.ctx.fonts_mut(|fonts| {
            text.chars()
                .filter(|letter| !letter.is_control() && !fonts.has_glyph(&font, *letter))
                .collect()
        });
        assert_eq!(missing, "", "{file}");
    }
}

#[test]
fn link_to_the_web_has_its_host_beside_it_and_opens_by_the_platform() {
    let mut page = page("lesson=https://school.example/mine.md");
    let text = "# Mine\n\nSee [https://good.example](https://good.example@evil.example/x).\n\nAnd <https://plain.example/y>.\n";
    let source = Source::Web("https://school.example/mine.md".to_owned());
    page.session.finish_lesson(&source, Ok(text.as_bytes()));
    let mut harness = harness(DESK, DARK, page);
    harness.get_by_label_contains("(evil.example)");
    assert!(
        harness.query_by_label_contains("(plain.example)").is_none(),
        "an address tells its host itself"
    );
    press("https://good.example", &mut harness);
    let asked = &harness.state().out.actions;
    assert_eq!(
        asked.as_slice(),
        [Action::OpenPage("https://good.example@evil.example/x".to_owned())]
    );
}

#[test]
fn lesson_that_is_loading_can_be_stopped() {
    let mut harness = harness(DESK, DARK, page("lesson=https://school.example/mine.md"));
    press(text::STOP_LOADING.english(), &mut harness);
    assert_eq!(harness.state().out.actions.as_slice(), [Action::StopLesson]);
}

#[test]
fn text_of_a_lesson_is_selected_and_copied_across_paragraphs() {
    let mut harness = harness(DESK, DARK, lesson("lesson=half_life&lab=transition&play=off"));
    let rect =
        |words: &str, harness: &Harness<'_, Page>| harness.get_by_label_contains(words).rect();
    let from = rect("A dissolve plays both", &harness).left_top() + vec2(1.0, 8.0);
    let to = rect("The name needs care", &harness).right_bottom() - vec2(2.0, 8.0);
    select(from, to, &mut harness);
    harness.run();
    picture("lessons-selected", &mut harness);
    let text = copied(&mut harness);
    assert!(text.starts_with("A dissolve plays both clips at once."), "{text}");
    // Formulas are copied with their exponents.
    assert!(text.contains("x(t) = e^(−γ t) (x₀ + (v₀ + γ x₀) t)"), "{text}");
    assert!(text.contains("The name needs care."), "{text}");
}

#[test]
fn link_in_a_lesson_is_a_link_to_assistive_technology() {
    let harness = harness(DESK, DARK, lesson("lesson=contents&lab=blend&play=off"));
    assert!(harness.query_all_by_role(Role::Heading).count() > 0);
    let mut page = page("lesson=https://school.example/mine.md");
    let source = Source::Web("https://school.example/mine.md".to_owned());
    page.session.finish_lesson(&source, Ok(b"# Mine\n\nSee [this](https://good.example/x).\n"));
    let harness = self::harness(DESK, DARK, page);
    harness.get_by_role_and_label(Role::Link, "this");
}
