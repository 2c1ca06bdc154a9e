//! The types of a lab's part of the page.

use crate::ui::language::Word;
use crate::ui::out::Out;
use crate::ui::rows::KeepOffer;
use crate::ui::state::UiState;
use eframe::egui::Ui;
use glam::DVec2;
use segue_session::{Command, Key, Pane, Params, Session};
use segue_text::Message;

/// A lab's part of the page; each lab's own file has one, as `LAB`.
pub(crate) struct LabUi {
    /// The rows of its panel.
    pub(crate) panel_ui: fn(&Session, &mut UiState, &mut Out, &mut Ui),
    /// The line about it, and its help text.
    pub(crate) about: [Word; 2],
    /// The motion of a pane that is kept and saved.
    pub(crate) kept: fn(&Session, usize) -> KeepOffer,
    /// The start of its comparison.
    pub(crate) compares: Compares,
    /// The title of a pane.
    pub(crate) title: fn(&Shown<'_>) -> Title,
    /// The hint over the stage.
    pub(crate) hint: fn(&Session) -> Option<Word>,
    /// Handles a line that was drawn on the ground; `None` where none can be drawn.
    pub(crate) take_line: Option<TakeLine>,
}

/// Takes a line over the ground, x and z in metres.
pub(crate) type TakeLine = fn(&[DVec2], &Session, &mut UiState, &mut Out);

/// The start of a comparison.
pub(crate) enum Compares {
    /// A parameter: the value that is set, and others.
    Key(Key),
    /// A comparison of the lab's own.
    Own(fn(&Session, &mut Out)),
}

impl Compares {
    /// Opens the comparison, or goes back to one pane.
    pub(crate) fn toggle(&self, session: &Session, out: &mut Out) {
        match self {
            _ if session.panes().len() > 1 => out.compare(None),
            Self::Key(key) => out.commands.push(Command::Compare(*key)),
            Self::Own(compare) => compare(session, out),
        }
    }
}

/// The content of a pane.
pub(crate) struct Shown<'a> {
    pub(crate) pane: &'a Pane,
    /// The parameters of the result on the stage; without one, the present ones.
    pub(crate) params: &'a Params,
    pub(crate) session: &'a Session,
}

impl Shown<'_> {
    /// Returns the name of the clip in A or B.
    pub(crate) fn name(&self, key: Key) -> Message {
        self.name_of(self.params.text(key)).unwrap_or_default()
    }

    /// Returns the name of a clip of the library; `None` for one that is not there.
    pub(crate) fn name_of(&self, id: &str) -> Option<Message> {
        self.session.library().find(id).map(|entry| entry.title())
    }

    /// Returns the text on screen for a parameter's value.
    pub(crate) fn spoken(&self, key: Key) -> Message {
        key.param().spoken(self.params.get(key))
    }
}

/// The title of a pane.
#[derive(Default)]
pub(crate) struct Title {
    pub(crate) strong: Message,
    pub(crate) text: Message,
    pub(crate) secondary: Message,
}

/// An end of the transition on the timeline.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Edge {
    /// The start.
    Start,
    /// The end.
    End,
}
