//! The list of shortcuts.

use super::UiCommand;
use super::keys::{keys_of, lab_keys};
use crate::ui::language::Word;
use segue_session::Key;
use segue_text::Message;

/// A row of the list of shortcuts.
enum HelpRow {
    /// Commands that share a row, and what they do.
    Commands(&'static [UiCommand], Word),
    /// The keys of the labs.
    Labs(Word),
    /// A gesture of the pointer or of held keys, and what it does.
    Gesture(Word, Word),
}

const HELP: &[HelpRow] = &[
    HelpRow::Commands(&[UiCommand::TogglePlay], Word::new("play or pause")),
    HelpRow::Commands(
        &[UiCommand::StepBack, UiCommand::StepOn],
        Word::new("one frame back or forward"),
    ),
    HelpRow::Commands(
        &[UiCommand::TenBack, UiCommand::TenOn],
        Word::new("ten frames back or forward"),
    ),
    HelpRow::Commands(&[UiCommand::ToBeginning], Word::new("to the beginning")),
    HelpRow::Commands(
        &[UiCommand::Mark(Key::In), UiCommand::Mark(Key::Out)],
        Word::new("set the in or out mark here; Shift clears it"),
    ),
    HelpRow::Commands(&[UiCommand::Slower, UiCommand::Faster], Word::new("slower, faster")),
    HelpRow::Commands(&[UiCommand::ToggleLoop], Word::new("loop")),
    HelpRow::Commands(&[UiCommand::ToggleCompare], Word::new("compare full, half, third")),
    HelpRow::Commands(&[UiCommand::ToggleLessons], Word::new("lessons; Esc closes them")),
    HelpRow::Labs(Word::new("the labs, in order")),
    HelpRow::Commands(&[UiCommand::Present], Word::new("present: the stage alone; Esc ends it")),
    HelpRow::Commands(
        &[UiCommand::NextStep, UiCommand::PreviousStep],
        Word::new("next or previous lesson, pane or lab while presenting"),
    ),
    HelpRow::Commands(&[UiCommand::ToggleTopView], Word::new("top view")),
    HelpRow::Commands(&[UiCommand::FrameEverything], Word::new("frame all")),
    HelpRow::Commands(&[UiCommand::ToggleFollow], Word::new("camera follow on or off")),
    HelpRow::Commands(&[UiCommand::NextLook], Word::new("body, bones, both")),
    HelpRow::Gesture(
        Word::new("W A S D, arrows"),
        Word::new("in the Match lab: drive; Shift runs, Q strafes"),
    ),
    HelpRow::Commands(&[UiCommand::SwapClips], Word::new("swap A and B")),
    HelpRow::Gesture(
        Word::new("Shift, Ctrl + click"),
        Word::new("select several clips of the library"),
    ),
    HelpRow::Commands(&[UiCommand::Undo], Word::new("undo")),
    HelpRow::Commands(&[UiCommand::Redo], Word::new("redo")),
    HelpRow::Commands(
        &[UiCommand::CopyLink],
        Word::new("copy the link, when nothing else is selected"),
    ),
    HelpRow::Commands(&[UiCommand::ToggleHelp], Word::new("this list")),
    HelpRow::Gesture(
        Word::new("drag, W A S D"),
        Word::new("turn the camera; with Shift or the right button, move it"),
    ),
    HelpRow::Gesture(Word::new("wheel, pinch, Page up or down"), Word::new("zoom")),
];

/// Returns the list of shortcuts: the keys, and what they do.
pub(crate) fn help() -> impl Iterator<Item = (Message, Word)> {
    HELP.iter().map(|row| match row {
        HelpRow::Commands(commands, what) => (keys_of(commands), *what),
        HelpRow::Labs(what) => (Message::data(lab_keys()), *what),
        HelpRow::Gesture(how, what) => ((*how).into(), *what),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shortcut_list_names_the_keys_of_every_line() {
        let list: Vec<(String, &str)> =
            help().map(|(keys, what)| (keys.to_string(), what.english())).collect();
        let keys = |what: &str| {
            let line = list.iter().find(|(_, sentence)| *sentence == what);
            line.map(|(keys, _)| keys.as_str()).unwrap()
        };
        assert_eq!(keys("play or pause"), "Space");
        assert_eq!(keys("ten frames back or forward"), "Shift ← →");
        assert_eq!(keys("one frame back or forward"), "← →");
        assert_eq!(keys("slower, faster"), "[ ]");
        assert_eq!(keys("redo"), "Ctrl Shift Z");
        assert_eq!(keys("copy the link, when nothing else is selected"), "Ctrl C");
        assert_eq!(keys("this list"), "?");
        assert_eq!(keys("the labs, in order"), "1 … 9, 0, -, =, \\, `");
        assert!(list.iter().all(|(keys, what)| !keys.is_empty() && !what.is_empty()));
    }
}
