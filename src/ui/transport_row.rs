//! The row of playback at the top of every bottom panel.

use super::kit::{self, Transport, TransportEvent};
use super::language::Text;
use super::out::Out;
use super::state::Layout;
use eframe::egui::{Response, Ui};
use segue_session::{Command, Key, PlaybackCommand, Session, Value};
use segue_text::Message;

/// The position of the playhead.
#[derive(Clone, Copy, Debug)]
pub(super) struct Playhead {
    pub(super) secs: f64,
    pub(super) frame: usize,
    /// The number of frames.
    pub(super) frames: usize,
}

/// The room behind the caption for the mark of its menu, points.
const MENU_WIDTH: f32 = 16.0;

/// Draws the row, with a caption at its end where there is room.
pub(super) fn transport_row_ui(
    playhead: Playhead,
    caption: &Message,
    layout: Layout,
    session: &Session,
    out: &mut Out,
    ui: &mut Ui,
) -> Response {
    let params = session.params();
    let transport = Transport {
        playing: params.is_on(Key::Play),
        repeat: params.is_on(Key::Loop),
        speed: params.number(Key::Rate),
        now: playhead.secs,
        frame: playhead.frame,
        frames: playhead.frames,
        caption: if layout == Layout::Phone { Text::EMPTY } else { caption.into() },
    };
    let row = ui.horizontal(|ui| {
        if layout != Layout::Phone {
            ui.set_max_width(ui.available_width() - MENU_WIDTH);
        }
        kit::transport_ui(&transport, ui)
    });
    match row.inner {
        Some(TransportEvent::SetPlaying(_)) => {
            out.commands.push(Command::Playback(PlaybackCommand::TogglePlay));
        }
        Some(TransportEvent::SetRepeat(on)) => out.set_once(Key::Loop, Value::Switch(on)),
        Some(TransportEvent::SetSpeed(speed)) => out.set_once(Key::Rate, Value::Number(speed)),
        Some(TransportEvent::Step(frames)) => {
            out.commands.push(Command::Playback(PlaybackCommand::Step(frames.into())));
        }
        None => {}
    }
    row.response
}
