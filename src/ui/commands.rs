//! The commands of the interface in one table: what each is called, which keys and which icon it
//! has, when it can be given, and what it does. The bar, the menu of a phone, the buttons on the
//! stage, the list of shortcuts and the keyboard are made from it.

use super::kit::{self, Button, Icon, MenuItem};
use super::labs::toggle_compare;
use super::language::{Text, Word, say};
use super::lessons_panel::{self, toggle_lessons};
use super::out::{Action, Out};
use super::stage::framing::frame_everything;
use super::state::UiState;
use super::text;
use super::theme::theme_of;
use eframe::egui::{Event, Id, Key as Keyboard, Memory, Modifiers, Popup, Ui};
use segue_session::choices::{Camera, Follow, Look};
use segue_session::{Command, Key, Kind, PlaybackCommand, Session, Value};
use segue_text::Message;

/// Something that a button, a line of a menu or a key asks for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum UiCommand {
    TogglePlay,
    StepBack,
    StepOn,
    TenBack,
    TenOn,
    ToBeginning,
    /// Sets the in or out mark at the playhead.
    Mark(Key),
    /// Takes the in or out mark away.
    ClearMark(Key),
    Slower,
    Faster,
    ToggleLoop,
    ToggleCompare,
    ToggleLessons,
    /// Opens a lab, by its place in the row of tabs.
    OpenLab(usize),
    ToggleTopView,
    FrameEverything,
    ToggleFollow,
    NextLook,
    ToggleStrafe,
    Undo,
    Redo,
    CopyLink,
    CopyReport,
    OpenLibrary,
    ToggleTheme,
    ToggleProjector,
    SwitchLanguage,
    ToggleHelp,
    /// Closes what lies in front.
    Close,
}

/// How the keyboard gives a command.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Trigger {
    Keys(Modifiers, Keyboard),
    /// What the system copies with, so that it works on every keyboard.
    Copy,
    /// A character, wherever it stands on the keyboard.
    Typed(&'static str),
}

/// Whether a key is left to the widget that has the focus.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Focus {
    /// No widget uses the key.
    Ignored,
    /// The key is left to any widget that has the focus.
    Respected,
    /// As [`Self::Respected`], but for widgets that were focused by the pointer: one drags a
    /// slider, and wants to see the motion play.
    RespectedByKeyboard,
    /// The key is left to a menu that is open, which closes itself.
    MenuRespected,
}

/// What a command is called and how it is given.
#[derive(Clone, Copy, Debug)]
struct Row {
    /// The label of its button and of its line in a menu; empty for keys alone.
    text: Word,
    /// What is said over its button, where that is more than its label.
    tooltip: Word,
    icon: Option<Icon>,
    triggers: &'static [Trigger],
    focus: Focus,
}

/// A row of the list of shortcuts.
enum HelpRow {
    /// Commands that are told of together, and what they do.
    Commands(&'static [UiCommand], Word),
    /// The keys of the labs.
    Labs(Word),
    /// What the pointer or held keys do, by the widget that they belong to.
    Gesture(Word, Word),
}

const NONE: Modifiers = Modifiers::NONE;
const SHIFT: Modifiers = Modifiers::SHIFT;
const COMMAND: Modifiers = Modifiers::COMMAND;
const COMMAND_SHIFT: Modifiers = Modifiers::COMMAND.plus(Modifiers::SHIFT);

/// The keys of the labs, from left to right: the row of digits and what stands behind them.
pub(super) const LAB_KEYS: [Keyboard; 12] = [
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
];

/// The commands that the keyboard gives, besides [`UiCommand::OpenLab`].
const WITH_KEYS: [UiCommand; 25] = [
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
    UiCommand::ToggleTopView,
    UiCommand::FrameEverything,
    UiCommand::ToggleFollow,
    UiCommand::NextLook,
];

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
    HelpRow::Commands(&[UiCommand::ToggleTopView], Word::new("top view")),
    HelpRow::Commands(&[UiCommand::FrameEverything], Word::new("frame all")),
    HelpRow::Commands(&[UiCommand::ToggleFollow], Word::new("camera follow on or off")),
    HelpRow::Commands(&[UiCommand::NextLook], Word::new("body, bones, both")),
    HelpRow::Gesture(
        Word::new("W A S D, arrows"),
        Word::new("drive the character of the Match lab; Shift runs, Q strafes"),
    ),
    HelpRow::Commands(&[UiCommand::Undo], Word::new("undo")),
    HelpRow::Commands(&[UiCommand::Redo], Word::new("redo")),
    HelpRow::Commands(
        &[UiCommand::CopyLink],
        Word::new("copy the link, when nothing else is selected"),
    ),
    HelpRow::Commands(&[UiCommand::ToggleHelp], Word::new("this list")),
    HelpRow::Gesture(
        Word::new("drag"),
        Word::new("turn the camera; with Shift or the right button, move it"),
    ),
    HelpRow::Gesture(Word::new("W A S D"), Word::new("the same, except in the Match lab")),
    HelpRow::Gesture(Word::new("wheel, pinch"), Word::new("zoom")),
    HelpRow::Gesture(Word::new("Page up, down"), Word::new("zoom")),
];

/// What commands work on.
struct Target<'a> {
    session: &'a Session,
    state: &'a mut UiState,
    out: &'a mut Out,
    ui: &'a Ui,
}

impl UiCommand {
    fn row(self) -> Row {
        use Focus::{Ignored, MenuRespected, Respected, RespectedByKeyboard};
        use Trigger::{Copy, Keys, Typed};
        let keys = |triggers, focus| Row {
            text: Word::default(),
            tooltip: Word::default(),
            icon: None,
            triggers,
            focus,
        };
        let named =
            |text, icon, triggers| Row { text, icon: Some(icon), ..keys(triggers, Ignored) };
        match self {
            Self::TogglePlay => keys(&[Keys(NONE, Keyboard::Space)], RespectedByKeyboard),
            Self::StepBack => keys(&[Keys(NONE, Keyboard::ArrowLeft)], Respected),
            Self::StepOn => keys(&[Keys(NONE, Keyboard::ArrowRight)], Respected),
            Self::TenBack => keys(&[Keys(SHIFT, Keyboard::ArrowLeft)], Respected),
            Self::TenOn => keys(&[Keys(SHIFT, Keyboard::ArrowRight)], Respected),
            Self::ToBeginning => keys(&[Keys(NONE, Keyboard::Home)], Respected),
            Self::Mark(Key::In) => keys(&[Keys(NONE, Keyboard::I)], Ignored),
            Self::Mark(_) => keys(&[Keys(NONE, Keyboard::O)], Ignored),
            Self::ClearMark(Key::In) => keys(&[Keys(SHIFT, Keyboard::I)], Ignored),
            Self::ClearMark(_) => keys(&[Keys(SHIFT, Keyboard::O)], Ignored),
            Self::Slower => keys(&[Keys(NONE, Keyboard::OpenBracket)], Ignored),
            Self::Faster => keys(&[Keys(NONE, Keyboard::CloseBracket)], Ignored),
            Self::ToggleLoop => keys(&[Keys(NONE, Keyboard::L)], Ignored),
            Self::ToggleCompare => Row {
                tooltip: text::COMPARE_HELP,
                ..named(text::COMPARE, Icon::Swap, &[Keys(NONE, Keyboard::C)])
            },
            Self::ToggleLessons => Row {
                tooltip: text::LESSONS_HELP,
                ..named(text::LESSONS, Icon::Book, &[Keys(NONE, Keyboard::N)])
            },
            Self::OpenLab(_) => keys(&[], Ignored),
            Self::ToggleTopView => named(text::TOP_VIEW, Icon::Top, &[Keys(NONE, Keyboard::T)]),
            Self::FrameEverything => {
                named(text::FRAME_ALL, Icon::FrameAll, &[Keys(NONE, Keyboard::F)])
            }
            Self::ToggleFollow => named(text::FOLLOW, Icon::Follow, &[Keys(NONE, Keyboard::G)]),
            Self::NextLook => keys(&[Keys(NONE, Keyboard::B)], Ignored),
            Self::ToggleStrafe => keys(&[Keys(NONE, Keyboard::Q)], Ignored),
            Self::Undo => named(text::UNDO, Icon::Undo, &[Keys(COMMAND, Keyboard::Z)]),
            Self::Redo => named(
                text::REDO,
                Icon::Redo,
                &[Keys(COMMAND_SHIFT, Keyboard::Z), Keys(COMMAND, Keyboard::Y)],
            ),
            Self::CopyLink => named(text::COPY_LINK, Icon::Link, &[Copy]),
            Self::CopyReport => named(text::REPORT, Icon::Report, &[]),
            Self::OpenLibrary => named(text::LIBRARY, Icon::Folder, &[]),
            Self::ToggleTheme => named(text::THEME, Icon::Contrast, &[]),
            Self::ToggleProjector => {
                Row { text: text::LARGER, tooltip: text::PROJECTOR, ..keys(&[], Ignored) }
            }
            Self::SwitchLanguage => named(text::OR_ENGLISH, Icon::Language, &[]),
            Self::ToggleHelp => named(text::HELP, Icon::Help, &[Typed("?")]),
            Self::Close => keys(&[Keys(NONE, Keyboard::Escape)], MenuRespected),
        }
    }

    /// Returns whether the command can be given now.
    fn is_enabled(self, session: &Session) -> bool {
        match self {
            Self::Undo => session.can_undo(),
            Self::Redo => session.can_redo(),
            // Where a character is driven, the arrows drive it.
            Self::StepBack | Self::StepOn | Self::TenBack | Self::TenOn => !session.is_driven(),
            Self::ToggleStrafe => session.is_driven(),
            _ => true,
        }
    }

    /// Returns whether what the command turns on is on.
    fn is_on(self, session: &Session) -> bool {
        let params = session.params();
        match self {
            Self::ToggleCompare => session.panes().len() > 1,
            Self::ToggleLessons => lessons_panel::is_open(session),
            Self::ToggleFollow => params.choice::<Follow>() != Follow::Off,
            Self::ToggleTopView => params.choice::<Camera>() == Camera::Top,
            Self::ToggleProjector => params.is_on(Key::Projector),
            _ => false,
        }
    }

    fn run(self, target: &mut Target<'_>) {
        let Target { session, state, out, ui } = target;
        let params = session.params();
        match self {
            Self::TogglePlay => out.commands.push(Command::Playback(PlaybackCommand::TogglePlay)),
            Self::StepBack => out.commands.push(Command::Playback(PlaybackCommand::Step(-1))),
            Self::StepOn => out.commands.push(Command::Playback(PlaybackCommand::Step(1))),
            Self::TenBack => out.commands.push(Command::Playback(PlaybackCommand::Step(-10))),
            Self::TenOn => out.commands.push(Command::Playback(PlaybackCommand::Step(10))),
            Self::ToBeginning => {
                out.commands.push(Command::Playback(PlaybackCommand::Seek(session.span().start)));
            }
            Self::Mark(key) => out.set_once(key, Value::Number(session.now_secs())),
            Self::ClearMark(key) => out.commands.push(Command::Reset(key)),
            Self::Slower | Self::Faster => {
                let factor = if self == Self::Slower { 0.5 } else { 2.0 };
                let rate = (params.number(Key::Rate) * factor).clamp(0.05, 4.0);
                out.set_once(Key::Rate, Value::Number(rate));
            }
            Self::ToggleLoop => out.toggle(Key::Loop, params.is_on(Key::Loop)),
            Self::ToggleCompare => toggle_compare(session, out),
            Self::ToggleLessons => toggle_lessons(session, out),
            Self::OpenLab(index) => {
                if let Kind::Choice(labs) = Key::Lab.param().kind
                    && let Some(lab) = labs.get(index)
                {
                    out.set_once(Key::Lab, Value::Choice(lab.key));
                }
            }
            Self::ToggleTopView => {
                let camera = if self.is_on(session) { Camera::Orbit } else { Camera::Top };
                out.set_once(Key::Camera, camera.into());
            }
            Self::FrameEverything => frame_everything(session, state, out),
            Self::ToggleFollow => {
                let follow = if self.is_on(session) { Follow::Off } else { Follow::Result };
                out.set_once(Key::Follow, follow.into());
            }
            Self::NextLook => {
                let next = match params.choice() {
                    Look::Body => Look::Bones,
                    Look::Bones => Look::Both,
                    Look::Limbs | Look::Both => Look::Body,
                };
                out.set_once(Key::Look, next.into());
            }
            Self::ToggleStrafe => out.toggle(Key::Strafe, params.is_on(Key::Strafe)),
            Self::Undo => out.commands.push(Command::Undo),
            Self::Redo => out.commands.push(Command::Redo),
            Self::CopyLink => out.actions.push(Action::CopyLink),
            Self::CopyReport => out.actions.push(Action::CopyReport),
            Self::OpenLibrary => state.library_open = true,
            Self::ToggleTheme => {
                let other = if theme_of(ui).dark { "light" } else { "dark" };
                out.set_once(Key::Theme, Value::Choice(other));
            }
            Self::ToggleProjector => out.toggle(Key::Projector, self.is_on(session)),
            Self::SwitchLanguage => {
                let other = state.language.next();
                out.set_once(Key::Lang, Value::Choice(other.tag()));
            }
            Self::ToggleHelp => state.help_open = !state.help_open,
            Self::Close => close(session, state, out),
        }
    }
}

/// Closes the lesson, or what lies in front of it.
fn close(session: &Session, state: &mut UiState, out: &mut Out) {
    let lies_in_front = state.help_open || state.library_open || state.drawing.is_some();
    if lessons_panel::is_open(session) && !lies_in_front {
        toggle_lessons(session, out);
    }
    (state.help_open, state.library_open) = (false, false);
    state.drawing = None;
}

/// Gives the commands whose keys are pressed, unless text is being typed.
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
        let can = is_free(row.focus) && command.is_enabled(session);
        if can && row.triggers.iter().any(|&trigger| is_pressed(trigger)) {
            command.run(&mut target);
        }
    }
    for (index, key) in LAB_KEYS.into_iter().enumerate() {
        // A map that has the focus is made larger and smaller with these.
        let zooms = matches!(key, Keyboard::Num0 | Keyboard::Minus | Keyboard::Equals);
        let how = if zooms { Focus::Respected } else { Focus::Ignored };
        if is_free(how) && is_pressed(Trigger::Keys(NONE, key)) {
            UiCommand::OpenLab(index).run(&mut target);
        }
    }
}

/// Shows the icon of a command as a button.
pub(crate) fn command_icon_ui(
    command: UiCommand,
    session: &Session,
    state: &mut UiState,
    out: &mut Out,
    ui: &mut Ui,
) {
    let row = command.row();
    let button = match row.icon {
        Some(icon) => Button::icon_only(icon, name_of(command, state)),
        None => Button::new(row.text).quiet(),
    };
    command_button_ui(command, button, session, state, out, ui);
}

/// Shows a button that gives a command. Its tooltip says what it does, and the keys that do it.
pub(crate) fn command_button_ui(
    command: UiCommand,
    button: Button<'_>,
    session: &Session,
    state: &mut UiState,
    out: &mut Out,
    ui: &mut Ui,
) {
    let row = command.row();
    let name = name_of(command, state);
    let button = button.name(name).hint(Text::EMPTY).selected(command.is_on(session));
    let enabled = command.is_enabled(session);
    let response = ui.add_enabled_ui(enabled, |ui| kit::button_ui(button, ui)).inner;
    // Made only while the pointer is over the button.
    let response = response.on_hover_ui(|ui| {
        let what = say(if row.tooltip.is_empty() { name } else { row.tooltip }, ui);
        let keys = keys_of(&[command]);
        ui.label(if keys.is_empty() { what } else { format!("{what} ({})", say(&keys, ui)) });
    });
    if response.clicked() {
        command.run(&mut Target { session, state, out, ui });
    }
}

/// Shows a line of a menu that gives a command.
pub(crate) fn command_item_ui(
    command: UiCommand,
    session: &Session,
    state: &mut UiState,
    out: &mut Out,
    ui: &mut Ui,
) {
    let shortcut = keys_of(&[command]);
    let (text, icon) = (name_of(command, state), command.row().icon);
    let item = MenuItem { text: text.into(), icon, shortcut: (&shortcut).into(), chosen: false };
    let enabled = command.is_enabled(session);
    if ui.add_enabled_ui(enabled, |ui| kit::menu_item_ui(item, ui)).inner.clicked() {
        command.run(&mut Target { session, state, out, ui });
    }
}

/// Returns what a command is called where its label alone does not say it.
fn name_of(command: UiCommand, state: &UiState) -> Word {
    match command {
        UiCommand::SwitchLanguage => state.language.next().switch(),
        UiCommand::ToggleProjector => text::PROJECTOR,
        _ => command.row().text,
    }
}

/// Returns the list of shortcuts: the keys, and what they do.
pub(crate) fn help() -> impl Iterator<Item = (Message, Word)> {
    HELP.iter().map(|row| match row {
        HelpRow::Commands(commands, what) => (keys_of(commands), *what),
        HelpRow::Labs(what) => (Message::data(lab_keys()), *what),
        HelpRow::Gesture(how, what) => ((*how).into(), *what),
    })
}

/// Returns the first keys of commands, one behind the other: `Shift ← →`. Only a key that stands
/// alone has a name to translate, such as `Space`.
fn keys_of(commands: &[UiCommand]) -> Message {
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

/// Returns the keys of the labs: `1 … 9, 0, -, =`.
fn lab_keys() -> String {
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
    fn every_line_of_the_list_names_its_keys() {
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
        assert_eq!(keys("the labs, in order"), "1 … 9, 0, -, =");
        assert!(list.iter().all(|(keys, what)| !keys.is_empty() && !what.is_empty()));
    }

    #[test]
    fn no_two_commands_share_a_key() {
        let mut seen: Vec<Trigger> = LAB_KEYS.iter().map(|&key| Trigger::Keys(NONE, key)).collect();
        for trigger in WITH_KEYS.iter().flat_map(|command| command.row().triggers) {
            assert!(!seen.contains(trigger), "{trigger:?}");
            seen.push(*trigger);
        }
    }
}
