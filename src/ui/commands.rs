//! The commands of the interface in one table: the label, shortcuts and icon of each, when it is
//! enabled, and its effect. The bar, the menu of a phone, the buttons on the stage, the list of
//! shortcuts and the keyboard use it.

mod buttons;
mod help;
mod keys;
mod trigger;

pub(crate) use buttons::{command_button_ui, command_icon_ui, command_item_ui};
pub(crate) use help::help;
#[cfg(all(test, feature = "ui-tests"))]
pub(super) use keys::LAB_KEYS;
pub(crate) use keys::take_keys;

use super::clip_drag::swap_values;
use super::kit::Icon;
use super::labs::toggle_compare;
use super::language::Word;
use super::lessons_panel::{self, toggle_lessons};
use super::out::{Action, Out};
use super::presenter::steps::{go_to_step, toggle_presenter};
use super::stage::framing::frame_everything;
use super::state::UiState;
use super::text;
use super::theme::theme_of;
use eframe::egui::{Key as Keyboard, Ui};
use segue_session::choices::{Camera, Follow, Look};
use segue_session::{Command, Key, Kind, PlaybackCommand, Session, Slot, Value};
use trigger::{COMMAND, COMMAND_SHIFT, Focus, NONE, SHIFT, Trigger};

/// A command of a button, a menu item or a key.
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
    /// Clears the in or out mark.
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
    SwapClips,
    Undo,
    Redo,
    CopyLink,
    /// Copies the link with the look of the page, which otherwise stays the reader's own.
    CopyLinkAsShown,
    CopyReport,
    OpenLibrary,
    /// Opens the panel of conversions.
    ConvertFiles,
    /// Shows the stage alone, or the whole page again.
    Present,
    /// Goes to the next or the previous step of a presenter.
    NextStep,
    PreviousStep,
    ToggleTheme,
    ToggleProjector,
    SwitchLanguage,
    ToggleHelp,
    /// Closes the layer in front.
    Close,
}

/// The label and the shortcuts of a command.
#[derive(Clone, Copy, Debug)]
struct Row {
    /// The label of its button and menu item; empty for a command without either.
    text: Word,
    /// The hint on its button; empty where the label suffices.
    tooltip: Word,
    icon: Option<Icon>,
    triggers: &'static [Trigger],
    focus: Focus,
}

/// The parts of the app that commands work on.
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
            Self::SwapClips => named(text::SWAP_CLIPS, Icon::Swap, &[Keys(NONE, Keyboard::X)]),
            Self::Undo => named(text::UNDO, Icon::Undo, &[Keys(COMMAND, Keyboard::Z)]),
            Self::Redo => named(
                text::REDO,
                Icon::Redo,
                &[Keys(COMMAND_SHIFT, Keyboard::Z), Keys(COMMAND, Keyboard::Y)],
            ),
            Self::CopyLink => named(text::COPY_LINK, Icon::Link, &[Copy]),
            Self::CopyLinkAsShown => named(text::COPY_LINK_AS_SHOWN, Icon::Link, &[]),
            Self::CopyReport => named(text::REPORT, Icon::Report, &[]),
            Self::Present => named(text::PRESENT, Icon::Screen, &[Keys(NONE, Keyboard::P)]),
            Self::NextStep => {
                named(text::NEXT, Icon::ChevronRight, &[Keys(NONE, Keyboard::PageDown)])
            }
            Self::PreviousStep => {
                named(text::PREVIOUS, Icon::ChevronLeft, &[Keys(NONE, Keyboard::PageUp)])
            }
            Self::OpenLibrary => named(text::LIBRARY, Icon::Folder, &[]),
            Self::ConvertFiles => named(text::CONVERT_FILES, Icon::Swap, &[]),
            Self::ToggleTheme => named(text::THEME, Icon::Contrast, &[]),
            Self::ToggleProjector => {
                Row { text: text::LARGER, tooltip: text::PROJECTOR, ..keys(&[], Ignored) }
            }
            Self::SwitchLanguage => named(text::OR_ENGLISH, Icon::Language, &[]),
            Self::ToggleHelp => named(text::HELP, Icon::Help, &[Typed("?")]),
            Self::Close => keys(&[Keys(NONE, Keyboard::Escape)], MenuRespected),
        }
    }

    /// Returns whether the command is enabled.
    fn is_enabled(self, session: &Session, state: &UiState) -> bool {
        match self {
            Self::SwapClips => session.uses(Slot::A) && session.uses(Slot::B),
            Self::Undo => session.can_undo(),
            Self::Redo => session.can_redo(),
            // The arrows steer a driven character.
            Self::StepBack | Self::StepOn | Self::TenBack | Self::TenOn => !session.is_driven(),
            Self::ToggleStrafe => session.is_driven(),
            Self::NextStep | Self::PreviousStep => state.presenter.is_on,
            _ => true,
        }
    }

    /// Returns the name of its button.
    pub(super) fn name(self, state: &UiState) -> Word {
        match self {
            Self::Present if state.presenter.is_on => text::STOP_PRESENTING,
            Self::SwitchLanguage => state.language.next().switch(),
            Self::ToggleProjector => text::PROJECTOR,
            _ => self.row().text,
        }
    }

    /// Returns whether the command's switch is on.
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
            Self::SwapClips => {
                out.commands.push(Command::Set(swap_values(session)));
                out.commands.push(Command::Settle);
            }
            Self::Undo => out.commands.push(Command::Undo),
            Self::Redo => out.commands.push(Command::Redo),
            Self::CopyLink => out.actions.push(Action::CopyLink),
            Self::CopyLinkAsShown => out.actions.push(Action::CopyLinkAsShown),
            Self::CopyReport => out.actions.push(Action::CopyReport),
            Self::Present => toggle_presenter(state, out),
            Self::NextStep => go_to_step(true, session, state, out),
            Self::PreviousStep => go_to_step(false, session, state, out),
            Self::OpenLibrary => state.library_open = true,
            Self::ConvertFiles => state.convert.is_open = true,
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

/// Closes the frontmost of: the search or selection in the library, the layers in front of the
/// lesson, the lesson.
fn close(session: &Session, state: &mut UiState, out: &mut Out) {
    if !state.help_open && std::mem::take(&mut state.convert.is_open) {
        return;
    }
    if !state.help_open && state.library.close() {
        return;
    }
    if state.presenter.is_on && !state.help_open {
        return toggle_presenter(state, out);
    }
    let lies_in_front = state.help_open || state.library_open || state.drawing.is_some();
    if lessons_panel::is_open(session) && !lies_in_front {
        toggle_lessons(session, out);
    }
    (state.help_open, state.library_open) = (false, false);
    state.drawing = None;
}
