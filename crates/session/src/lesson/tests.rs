//! Tests of lessons and their sources.

use super::parse::{LessonError, MAX_BYTES, parse};
use super::*;
use proptest::prelude::*;

const LESSON: &str = "\
Left out.

# Steps

[Begin](?lab=blend&a=walk)

Watch the **right** foot,
at `t = 1.2 s`.

- one
  - two
1. three

## More

    y = 2x

## Try

- [Short](?blend_window=10): It *bursts*.
- no link

## Question

Why?

## Answer

Because. See [half-life](04-half_life.md) or [the paper](https://example.org/a_(b)).

# Second
";

fn plain(spans: &[Span]) -> String {
    spans.iter().map(|span| span.text.as_str()).collect()
}

#[test]
fn parse_of_a_lesson_gives_its_pages() {
    let pages = parse(LESSON.as_bytes()).unwrap();
    let [page, second] = pages.as_slice() else { panic!("{pages:?}") };
    assert_eq!((page.title.as_str(), second.title.as_str()), ("Steps", "Second"));
    let state = page.state.as_ref().unwrap();
    assert_eq!((state.label.as_str(), state.query.as_str()), ("Begin", "lab=blend&a=walk"));
    let [
        Block::Paragraph(watch),
        one,
        two,
        three,
        Block::Heading(more),
        Block::Code(code),
        no_link,
    ] = page.body.as_slice()
    else {
        panic!("{:?}", page.body)
    };
    assert_eq!(plain(watch), "Watch the right foot, at t = 1.2\u{a0}s.");
    assert!(watch.iter().any(|span| span.strong && span.text == "right"));
    assert!(watch.iter().any(|span| span.code && span.text == "t = 1.2\u{a0}s"));
    let item = |block: &Block| match block {
        Block::Item { depth, number, spans } => (*depth, *number, plain(spans)),
        other => panic!("{other:?}"),
    };
    assert_eq!(
        [one, two, three, no_link].map(item),
        [
            (0, None, "one".to_owned()),
            (1, None, "two".to_owned()),
            (0, Some(1), "three".to_owned()),
            (0, None, "no link".to_owned())
        ]
    );
    assert_eq!((more.as_str(), code.as_str()), ("More", "y = 2x"));
    let [short] = page.tries.as_slice() else { panic!("{:?}", page.tries) };
    assert_eq!((short.label.as_str(), short.query.as_str()), ("Short", "blend_window=10"));
    assert_eq!(plain(&short.about), "It bursts.");
    assert_eq!(page.question.len(), 1);
    let [Block::Paragraph(answer)] = page.answer.as_slice() else { panic!("{:?}", page.answer) };
    let targets: Vec<&Target> = answer.iter().filter_map(|span| span.target.as_ref()).collect();
    assert_eq!(
        targets,
        [
            &Target::State("lesson=half_life".to_owned()),
            &Target::Web("https://example.org/a_(b)".to_owned())
        ]
    );
}

#[test]
fn parse_joins_chinese_lines_without_a_space() {
    let pages = parse(
        "# 對齊\n\n兩段動作\n沒有關係，A\nand B。\n\n## 想一想\n\n為什麼？\n\n## 解答\n\n因為。"
            .as_bytes(),
    )
    .unwrap();
    let [Block::Paragraph(text)] = pages[0].body.as_slice() else { panic!("{:?}", pages[0].body) };
    assert_eq!(plain(text), "兩段動作沒有關係，A and B。");
    assert_eq!((pages[0].question.len(), pages[0].answer.len()), (1, 1));
}

#[test]
fn parse_of_forbidden_links_gives_text() {
    let text = "# L\n\n[a](javascript:alert(1)) [b](data:text/html,x) ![p](https://example.org/p.png) <script>x</script> [c](//evil)";
    let pages = parse(text.as_bytes()).unwrap();
    let [Block::Paragraph(spans)] = pages[0].body.as_slice() else { panic!("{:?}", pages[0].body) };
    assert!(spans.iter().all(|span| span.target.is_none()), "{spans:?}");
    assert_eq!(plain(spans), "a (javascript:alert(1)) b (data:text/html,x) p x c (//evil)");
}

#[test]
fn parse_of_other_files_is_refused() {
    assert_eq!(parse(b"no title"), Err(LessonError::NoTitle));
    assert_eq!(parse(b"# \xff"), Err(LessonError::NotText));
    let found = MAX_BYTES + 1;
    assert_eq!(parse(&vec![b'#'; found]), Err(LessonError::TooLarge { found }));
}

#[test]
fn parse_of_huge_lessons_is_limited() {
    let fill = |piece: &str, times: usize| {
        parse(format!("# L\n\n{}", piece.repeat(times)).as_bytes()).unwrap()
    };
    for (piece, times) in [
        ("> ", 100_000),
        ("[", 200_000),
        ("**a", 60_000),
        ("- ", 100_000),
        ("![](", 50_000),
        ("<a ", 60_000),
        ("`", 200_000),
    ] {
        assert_eq!(fill(piece, times).len(), 1, "{piece}");
    }
    assert!(fill("- a\n", 60_000)[0].body.len() <= 400);
    assert!(fill("# L\n", 60_000).len() <= 200);
}

#[test]
fn source_of_names_and_addresses_is_found() {
    let built_in = |file: &str| Source::BuiltIn(file.to_owned());
    assert_eq!(source_of("contents", "en"), Ok((built_in("en/index.md"), 0)));
    assert_eq!(source_of("slerp", "zh-Hant"), Ok((built_in("zh-Hant/02-slerp.md"), 0)));
    let web = Source::Web("https://a.org/x.md".to_owned());
    assert_eq!(source_of("https://a.org/x.md", "en"), Ok((web.clone(), 0)));
    assert_eq!(source_of("https://a.org/x.md#3", "en"), Ok((web.clone(), 2)));
    assert_eq!(source_of("https://a.org/x.md#top", "en"), Ok((web, 0)));
    assert!(
        source_of("cooking", "en")
            .unwrap_err()
            .to_string()
            .contains("expected contents, alignment, slerp")
    );
    assert_eq!(sources::lesson_of_file("02-slerp.md"), Some("slerp"));
    assert_eq!(sources::lesson_of_file("03-slerp.md"), None);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn parse_of_any_text_never_panics(text in "(# |## Try|## Answer|\n|- |\\[a\\]\\(\\?|\\)|\\*\\*|`|>|對|\\PC){0,80}") {
        if let Ok(pages) = parse(text.as_bytes()) {
            prop_assert!(!pages.is_empty());
        }
    }

    #[test]
    fn parse_of_any_bytes_never_panics(bytes in proptest::collection::vec(any::<u8>(), 0..400)) {
        let _pages = parse(&bytes);
    }
}
