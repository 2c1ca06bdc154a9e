//! The input to the handles of the timeline.

use super::contacts;
use crate::ui::kit::TimelineEvent;
use crate::ui::labs::in_time;
use crate::ui::out::Out;
use segue_session::{Command, ContactClip, Key, Outcome, PlaybackCommand, Session, Value};

/// Turns the user's input to the timeline into commands.
pub(super) fn timeline_event(
    event: TimelineEvent,
    clips: &[ContactClip],
    session: &Session,
    outcome: &Outcome,
    out: &mut Out,
) {
    let (params, fps) = (session.params(), outcome.motion.clip().fps());
    let at_end = |end: f64, secs: f64| (secs - end).abs() < 0.5 / fps;
    // The flags do not pass each other.
    let (from, to) = (
        params.optional(Key::In).unwrap_or(0.0),
        params.optional(Key::Out).unwrap_or(session.duration_secs()),
    );
    let event = match event {
        TimelineEvent::SetIn(secs) => TimelineEvent::SetIn(secs.min(to - 1.0 / fps).max(0.0)),
        TimelineEvent::SetOut(secs) => {
            TimelineEvent::SetOut(secs.max(from + 1.0 / fps).min(session.duration_secs()))
        }
        event => event,
    };
    match event {
        // A flag at an end is no mark.
        TimelineEvent::SetIn(secs) if at_end(0.0, secs) => out.set(Key::In, Value::Auto),
        TimelineEvent::SetOut(secs) if at_end(session.duration_secs(), secs) => {
            out.set(Key::Out, Value::Auto);
        }
        TimelineEvent::Seek(secs) => {
            out.commands.push(Command::Playback(PlaybackCommand::Seek(secs)));
        }
        TimelineEvent::ScrubStarted => out.set(Key::Play, Value::Switch(false)),
        TimelineEvent::SetIn(secs) => out.set(Key::In, Value::Number(secs)),
        TimelineEvent::SetOut(secs) => out.set(Key::Out, Value::Number(secs)),
        TimelineEvent::SetTransitionStart(secs) => {
            set_number(in_time::start_value(secs, session, outcome), out);
        }
        TimelineEvent::SetTransitionEnd(secs) => {
            set_number(in_time::end_value(secs, session, outcome), out);
        }
        TimelineEvent::Stance { stripe, event } => {
            if let Some(clip) = clips.get(stripe) {
                contacts::correct(event, clip, session, out);
            }
        }
        TimelineEvent::ScrubEnded | TimelineEvent::EditStarted => {}
        TimelineEvent::EditEnded => out.commands.push(Command::Settle),
    }
}

/// Sets a number, if there is one to set.
fn set_number(value: Option<(Key, f64)>, out: &mut Out) {
    if let Some((key, value)) = value {
        out.set(key, Value::Number(value));
    }
}
