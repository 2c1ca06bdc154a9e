//! The keyboard shortcuts of commands.

use super::trigger::{COMMAND, Focus, NONE, Trigger};
use super::{Target, UiCommand};
use crate::ui::out::Out;
use crate::ui::state::UiState;
use eframe::egui::{Event, Id, Key as Keyboard, Memory, Popup, Ui};
use segue_session::{Key, Session};
use segue_text::Message;

/// The keys of the labs, from left to right: the digits and the three keys after them.
pub(in crate::ui) const LAB_KEYS: [Keyboard; 14] = [
    Keyboard::Num1,
    Keyboard::Num2,
    Keyboard::Num3,
    Keyboard::Num4,
    Keyboard::Num5,
    Keyboard::Num6,
    Keyboard::Num7,
    Keyboard::Num8,
    Keyboard::Num9,
    Keyboard::Num0,
    Keyboard::Minus,
    Keyboard::Equals,
    Keyboard::Backslash,
    Keyboard::Backtick,
];

/// The commands with shortcuts, besides [`UiCommand::OpenLab`].
const WITH_KEYS: [UiCommand; 29] = [
    UiCommand::Redo,
    UiCommand::Undo,
    UiCommand::CopyLink,
    UiCommand::ToggleHelp,
    UiCommand::Close,
    UiCommand::TogglePlay,
    UiCommand::TenBack,
    UiCommand::TenOn,
    UiCommand::StepBack,
    UiCommand::StepOn,
    UiCommand::ToBeginning,
    UiCommand::ClearMark(Key::In),
    UiCommand::ClearMark(Key::Out),
    UiCommand::Mark(Key::In),
    UiCommand::Mark(Key::Out),
    UiCommand::Slower,
    UiCommand::Faster,
    UiCommand::ToggleLoop,
    UiCommand::ToggleLessons,
    UiCommand::ToggleCompare,
    UiCommand::ToggleStrafe,
    UiCommand::SwapClips,
    UiCommand::ToggleTopView,
    UiCommand::FrameEverything,
    UiCommand::ToggleFollow,
    UiCommand::NextLook,
    UiCommand::Present,
    UiCommand::NextStep,
    UiCommand::PreviousStep,
];

/// Runs the commands whose shortcuts are pressed, unless text is being typed.
pub(crate) fn take_keys(session: &Session, state: &mut UiState, out: &mut Out, ui: &Ui) {
    let ctx = ui.ctx();
    if ctx.text_edit_focused() {
        return;
    }
    let focus = ctx.memory(Memory::focused);
    let by_pointer = Id::unique("focused by the pointer");
    if ctx.input(|input| input.pointer.any_down() || input.pointer.any_released()) {
        ctx.data_mut(|data| data.insert_temp(by_pointer, focus));
    }
    let touched = ctx.data(|data| data.get_temp::<Option<Id>>(by_pointer)).flatten();
    let is_free = |how: Focus| match how {
        Focus::Ignored => true,
        Focus::Respected => focus.is_none(),
        Focus::RespectedByKeyboard => focus.is_none() || touched == focus,
        Focus::MenuRespected => !Popup::is_any_open(ctx),
    };
    let is_pressed = |trigger: Trigger| {
        ctx.input_mut(|input| match trigger {
            Trigger::Keys(modifiers, key) => input.consume_key(modifiers, key),
            Trigger::Copy => input.events.contains(&Event::Copy),
            Trigger::Typed(wanted) => {
                let typed = |event: &Event| matches!(event, Event::Text(text) if text == wanted);
                input.events.iter().any(typed)
            }
        })
    };
    let mut target = Target { session, state, out, ui };
    // [`WITH_KEYS`] has the longer chord of a key first: a key without modifiers takes any.
    for command in WITH_KEYS {
        let row = command.row();
        let can = is_free(row.focus) && command.is_enabled(target.session, target.state);
        if can && row.triggers.iter().any(|&trigger| is_pressed(trigger)) {
            command.run(&mut target);
        }
    }
    for (index, key) in LAB_KEYS.into_iter().enumerate() {
        // These keys zoom a map that has the focus.
        let zooms = matches!(key, Keyboard::Num0 | Keyboard::Minus | Keyboard::Equals);
        let how = if zooms { Focus::Respected } else { Focus::Ignored };
        if is_free(how) && is_pressed(Trigger::Keys(NONE, key)) {
            UiCommand::OpenLab(index).run(&mut target);
        }
    }
}

/// Returns the first shortcut of each command, in one text: `Shift ← →`. Only a single key has a
/// name to translate, such as `Space`.
pub(super) fn keys_of(commands: &[UiCommand]) -> Message {
    let mut words: Vec<&'static str> = Vec::new();
    for command in commands {
        let (modifiers, key) = match command.row().triggers.first() {
            Some(Trigger::Keys(modifiers, key)) => (*modifiers, key.symbol_or_name()),
            Some(Trigger::Copy) => (COMMAND, "C"),
            Some(Trigger::Typed(text)) => (NONE, *text),
            None => continue,
        };
        for (is_held, word) in [(modifiers.command, "Ctrl"), (modifiers.shift, "Shift")] {
            if is_held && !words.contains(&word) {
                words.push(word);
            }
        }
        words.push(match key {
            "⏴" => "←",
            "⏵" => "→",
            key => key,
        });
    }
    match words.as_slice() {
        [] => Message::default(),
        [key] => Message::word(key),
        keys => Message::data(keys.join(" ")),
    }
}

/// Returns the keys of the labs: `1 … 9, 0, -, =, \`.
pub(super) fn lab_keys() -> String {
    let (digits, rest) = LAB_KEYS.split_at(9);
    let ends =
        [digits.first(), digits.last()].map(|key| key.map_or("", |key| key.symbol_or_name()));
    let rest = rest.iter().map(|key| match key {
        Keyboard::Minus => "-",
        key => key.symbol_or_name(),
    });
    std::iter::once(ends.join(" … ")).chain(rest.map(str::to_owned)).collect::<Vec<_>>().join(", ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_two_commands_share_a_key() {
        let mut seen: Vec<Trigger> = LAB_KEYS.iter().map(|&key| Trigger::Keys(NONE, key)).collect();
        for trigger in WITH_KEYS.iter().flat_map(|command| command.row().triggers) {
            assert!(!seen.contains(trigger), "{trigger:?}");
            seen.push(*trigger);
        }
    }
}
