//! Tests of marks, one line for each rule. Expected values are those of the `CommonMark` spec, or
//! say why not.

use super::parse::parse;
use super::{Block, Page, Span, Target};
use proptest::prelude::*;

fn page(text: &str) -> Page {
    parse(format!("# L\n\n{text}").as_bytes()).unwrap().remove(0)
}

/// Writes spans as a line: `<b|bold>`, `<i|italic>`, `<c|code>`, `<?query|link>`.
fn line(spans: &[Span]) -> String {
    let mut line = String::new();
    for span in spans {
        let mut look = String::new();
        for (is, sign) in [(span.strong, 'b'), (span.emphasis, 'i'), (span.code, 'c')] {
            look.extend(is.then_some(sign));
        }
        match &span.target {
            Some(Target::State(query)) => look.extend(["?", query]),
            Some(Target::Web(address)) => look.push_str(address),
            None => {}
        }
        if look.is_empty() {
            line.push_str(&span.text);
        } else {
            line.extend(["<", &look, "|", &span.text, ">"]);
        }
    }
    line
}

/// Writes the blocks of a text as lines: `= heading`, `- item`, `1. item`, two spaces for each
/// surrounding list, `| code`.
fn lines(text: &str) -> Vec<String> {
    let as_line = |block: &Block| match block {
        Block::Heading(words) => format!("= {words}"),
        Block::Paragraph(spans) => line(spans),
        Block::Item { depth, number, spans } => {
            let mark = number.map_or("-".to_owned(), |number| format!("{number}."));
            format!("{}{mark} {}", "  ".repeat(*depth), line(spans))
        }
        Block::Code(code) => format!("| {}", code.replace('\n', " | ")),
    };
    page(text).body.iter().map(as_line).collect()
}

#[track_caller]
fn check(cases: &[(&str, &str)]) {
    for (text, expected) in cases {
        // A word before it, because a paragraph that is only a link would be the page's state.
        let found = lines(&format!("So {text}"));
        assert_eq!(found, [format!("So {expected}")], "{text}");
    }
}

#[test]
fn stars_in_pairs_are_bold_and_italic() {
    check(&[
        ("**bold** and *italic*", "<b|bold> and <i|italic>"),
        ("**bold *and italic* bold**", "<b|bold ><bi|and italic><b| bold>"),
        ("*italic **and bold***", "<i|italic ><bi|and bold>"),
        ("***both** italic*", "<bi|both><i| italic>"),
        ("***both***", "<bi|both>"),
        ("**F**orward **K**inematics", "<b|F>orward <b|K>inematics"),
        ("*a**b*", "<i|a**b>"),
        ("**two\nlines**", "<b|two lines>"),
        ("****four****", "<b|four>"),
        ("*a [b*](?c)", "*a <?c|b*>"),
        ("**[b](?c)**", "<b?c|b>"),
        ("*(a)*, *\"b\"*.", "<i|(a)>, <i|\"b\">."),
    ]);
}

#[test]
fn stars_without_a_pair_stay() {
    check(&[
        ("a * b", "a * b"),
        ("a lone *", "a lone *"),
        ("*", "*"),
        ("*open", "*open"),
        ("**half*", "*<i|half>"),
        ("2 * 3 * 4", "2 * 3 * 4"),
        // CommonMark would set the 3 in italics and lose both stars.
        ("2*3*4 and a*b*c", "2*3*4 and a*b*c"),
        ("x** y **", "x** y **"),
        ("\\*a\\* and \\**b*", "*a* and *<i|b>"),
        ("** **", "** **"),
    ]);
}

#[test]
fn stars_beside_chinese_letters_are_bold() {
    check(&[
        ("這是*重點*嗎", "這是<i|重點>嗎"),
        ("**接縫**必須閉合", "<b|接縫>必須閉合"),
        // CommonMark has no bold here: full-width punctuation is not a space.
        ("方法**「精確」**很好", "方法<b|「精確」>很好"),
        ("方法**（精確）**，很好", "方法<b|（精確）>，很好"),
    ]);
}

#[test]
fn underscores_stay() {
    check(&[
        ("blend_window and half_life", "blend_window and half_life"),
        ("_a_ and __init__", "_a_ and __init__"),
        ("**blend_window**", "<b|blend_window>"),
    ]);
}

#[test]
fn code_stays_unchanged() {
    check(&[
        ("`a * b * c`", "<c|a * b * c>"),
        ("`` a`b ``", "<c|a`b>"),
        ("` `` `", "<c|``>"),
        ("`\\`", "<c|\\>"),
        ("`&amp; <b> [a](?b)`", "<c|&amp; <b> [a](?b)>"),
        ("``open `shut`", "``open <c|shut>"),
        ("open ` only", "open ` only"),
        ("`two\nlines`", "<c|two lines>"),
        ("*a `b*` c*", "<i|a ><ic|b*><i| c>"),
        ("\\`a`", "`a`"),
        ("` `", "<c| >"),
    ]);
}

#[test]
fn links_of_every_form_have_their_target() {
    check(&[
        ("[a](?a=run(turn_rate:20)&x=1)", "<?a=run(turn_rate:20)&x=1|a>"),
        ("[a](?a=run\\(&x=1)", "<?a=run(&x=1|a>"),
        ("[a](<?x=1 2>)", "<?x=1 2|a>"),
        ("[a](?x=1 \"title\") b", "<?x=1|a> b"),
        ("[a]( ?x=1\n'title' )", "<?x=1|a>"),
        ("[a](?x=1&amp;y=2)", "<?x=1&y=2|a>"),
        ("[a](?x=1&lt=2)", "<?x=1&lt=2|a>"),
        ("[a `b` *c*](?d)", "<?d|a ><c?d|b><?d| ><i?d|c>"),
        ("[a [b] c](?d)", "<?d|a [b] c>"),
        ("[a [b](?c) d](?e)", "[a <?c|b> d](?e)"),
        ("<https://a.org/?b=1&c=2>", "<https://a.org/?b=1&c=2|https://a.org/?b=1&c=2>"),
        ("[loops](05-loops.md)：x", "<?lesson=loops|loops>：x"),
        ("[a](mailto:b)", "a (mailto:b)"),
        ("![a *b*](c.png) d", "a <i|b> d"),
        ("[![a](b.png)](?c)", "<?c|a>"),
        ("![a [b](?c)](d.png)", "a <?c|b>"),
    ]);
}

#[test]
fn brackets_without_a_target_stay() {
    check(&[
        ("[a]", "[a]"),
        ("[a] (?b)", "[a] (?b)"),
        ("[a](?b", "[a](?b"),
        ("[a](?b c)", "[a](?b c)"),
        ("[a](?b(c)", "[a](?b(c)"),
        ("a] [b", "a] [b"),
        ("\\[a](?b)", "[a](?b)"),
        ("[0, 1]", "[0, 1]"),
        ("wow! [a", "wow! [a"),
    ]);
}

#[test]
fn entities_backslashes_and_line_ends_are_decoded() {
    check(&[
        ("&amp; &lt;b&gt; &quot;c&quot; 5&nbsp;m", "& <b> \"c\" 5\u{a0}m"),
        ("&amp &unknown; &", "&amp &unknown; &"),
        ("a\\_b \\\\ \\a \\", "a_b \\ \\a \\"),
        ("soft \nline", "soft line"),
        ("hard  \nline", "hard\nline"),
        ("hard\\\nline", "hard\nline"),
        ("1.2\nm, 5 cm", "1.2\u{a0}m, 5\u{a0}cm"),
        ("動作\nA\n圖", "動作A圖"),
    ]);
}

#[test]
fn html_is_removed() {
    check(&[
        ("a<br/>b <i class=\"x > y\">c</i>", "ab c"),
        ("a <!-- b <i> --> c", "a  c"),
        ("a < b and c > d, a <3", "a < b and c > d, a <3"),
        ("a <b, c> d", "a <b, c> d"),
        ("a <!-- b", "a <!-- b"),
    ]);
    let blocks = "<div class=\"x\">\ngone\n</div>\n\n<script>\n\nalert(1)\n</script>\n<!-- a\n\nb -->\n<b>Here</b> is text\n\n<b>\ngone\n\nend";
    assert_eq!(lines(blocks), ["Here is text", "end"]);
}

#[test]
fn blocks_of_every_kind_are_recognised() {
    let cases: [(&str, &[&str]); 16] = [
        ("a\nb\n\nc", &["a b", "c"]),
        ("## A ##\n### B # C\n#no\n#### D", &["= A", "= B # C", "#no", "= D"]),
        ("a\n---\nb\n* * *\nc", &["a", "b", "c"]),
        ("- a\n  b\nc\n- d\n\n- e\n\nf", &["- a b c", "- d", "- e", "f"]),
        ("- a\n\n  b\n- c", &["- a", "b", "- c"]),
        ("3. a\n3. b\n7) c", &["3. a", "4. b", "7. c"]),
        ("in\n2026. was\n1. one", &["in 2026. was", "1. one"]),
        ("- a\n  - b\n    1. c\n- d", &["- a", "  - b", "    1. c", "- d"]),
        ("* a\n+ b\n-c", &["- a", "- b -c"]),
        ("```rust\na\n\n  *b*\n```\nc", &["| a |  |   *b*", "c"]),
        ("- a\n  ~~~\n  b\n   c\n  ~~~\n- d", &["- a", "| b |  c", "- d"]),
        ("    a\n\n      b\nc", &["| a |  |   b", "c"]),
        ("a\n    b", &["a b"]),
        ("> a\n> b\nc\n\n> - d\n>   e", &["a b c", "- d e"]),
        ("- > a\n  > b\n- c", &["- a b", "- c"]),
        ("    > a\n\n>     b", &["| > a", "| b"]),
    ];
    for (text, expected) in cases {
        assert_eq!(lines(text), expected, "{text}");
        assert_eq!(lines(&text.replace('\n', "\r\n")), expected, "{text}, with carriage returns");
    }
    assert_eq!(lines("```\nopen\n"), ["| open"]);
    assert_eq!(lines("-\tone\n\n\ttwo\n-\n\n- three"), ["- one", "two", "- three"]);
}

/// If the cost of one mark grew with the text, these would take minutes, or all memory.
#[test]
fn marks_without_end_are_read_in_linear_time() {
    let times = 50 * 1024;
    let pieces = [
        "*a ",
        "a* ",
        "*a_ ",
        "a**b*",
        "*a**b ",
        "[a](",
        "[a](b",
        "[a](<b",
        "[a](b \"",
        "[a](b 'c\"",
        "![",
        "[a](?b) ",
        "![[a](?b)",
        "]",
        "[]",
        "<a b=\"",
        "<a b='\" ",
        "<!--",
        "<https://",
        "``a`",
        "\\",
        "&",
        "&amp;",
        "> ",
        "- a ",
        "1. ",
        "* * a ",
        "\n> - ",
        "\n- ",
        "\n  - a",
        "\n\t",
        "(",
        "`a` ",
        "\n<div>",
        "\n```",
        "\n#",
        "> \t",
    ];
    for piece in pieces {
        let fill = piece.repeat(times / piece.len());
        for text in [
            format!("{fill}a"),
            format!("[{fill}](?b)"),
            format!("**{fill}**"),
            format!("- {fill}"),
        ] {
            assert!(page(&text).body.len() <= 400, "{piece}");
        }
    }
    // No number of backticks occurs twice.
    let ticks: String = (1..600).map(|len| "`".repeat(len) + "a").collect();
    assert_eq!(lines(&ticks), [ticks]);
    let address = "x".repeat(100_000);
    let text = format!("[{}](?{address})", "`a`b".repeat(30_000));
    assert!(page(&text).state.is_some_and(|state| state.label.len() == 60_000));
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(128))]

    #[test]
    fn text_without_marks_is_unchanged(words in "[a-z對，.;:?(){}=+/%$^~_ ]{1,60}") {
        let words = format!("a{}", words.trim_end());
        let plain: String = lines(&words).concat();
        prop_assert_eq!(plain.replace('\u{a0}', " "), words);
    }

    #[test]
    fn letters_with_any_marks_are_kept_once(text in "(\\*{1,3}|[\\[\\]!(`\\\\\n ]|\\]\\(|- |> ?|x|對){0,60}") {
        // Without `)` there are no links whose addresses are hidden.
        let count = |text: &str| text.matches(['x', '對']).count();
        let shown: usize = lines(&text).iter().map(|line| count(line)).sum();
        let state = page(&text).state.map_or(0, |state| count(&state.label));
        prop_assert_eq!(shown + state, count(&text), "{}", text);
    }
}
