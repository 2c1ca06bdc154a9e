//! Lessons: any bytes are pages or refused, and all links in them lead to a state or to the web.

#![no_main]

use libfuzzer_sys::fuzz_target;
use segue_session::lesson::{Block, Span, Target, parse};

fuzz_target!(|bytes: &[u8]| {
    let Ok(pages) = parse(bytes) else { return };
    assert!(!pages.is_empty());
    for page in &pages {
        for block in page.body.iter().chain(&page.question).chain(&page.answer) {
            if let Block::Paragraph(spans) | Block::Item { spans, .. } = block {
                assert!(spans.iter().all(is_harmless));
            }
        }
        assert!(page.tries.iter().all(|link| link.about.iter().all(is_harmless)));
    }
});

fn is_harmless(span: &Span) -> bool {
    match &span.target {
        Some(Target::Web(address)) => {
            address.starts_with("https://") || address.starts_with("http://")
        }
        Some(Target::State(_)) | None => {
            !span.text.contains(|letter: char| letter.is_control() && letter != '\n')
        }
    }
}
