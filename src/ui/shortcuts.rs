//! Keys that do what buttons do. The list that people read stands in [`super::text::SHORTCUTS`].

use super::labs::toggle_compare;
use super::lessons_panel::{self, toggle_lessons};
use super::out::{Action, Out};
use super::stage_panel::frame_everything;
use super::state::UiState;
use eframe::egui::{Context, Event, Id, Key as Keyboard, Modifiers, Popup};
use segue_session::choices;
use segue_session::{Command, Key, Kind, Session, Value};

/// The labs, from left to right: the row of digits and what stands behind them.
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

/// What the keyboard asks for, unless somebody is typing.
pub(crate) fn shortcuts(session: &Session, state: &mut UiState, out: &mut Out, ctx: &Context) {
    if ctx.text_edit_focused() {
        return;
    }
    let pressed = |modifiers: Modifiers, key: Keyboard| {
        ctx.input_mut(|input| input.consume_key(modifiers, key))
    };
    let (none, shift, command) = (Modifiers::NONE, Modifiers::SHIFT, Modifiers::COMMAND);
    let params = session.params();
    // The longer chord first: an exact match is only asked of what is pressed besides.
    if pressed(command | shift, Keyboard::Z) || pressed(command, Keyboard::Y) {
        out.commands.push(Command::Redo);
    }
    if pressed(command, Keyboard::Z) {
        out.commands.push(Command::Undo);
    }
    if ctx.input(|input| input.events.contains(&Event::Copy)) {
        out.actions.push(Action::CopyLink);
    }
    if ctx.input(|input| {
        input.events.iter().any(|event| matches!(event, Event::Text(text) if text == "?"))
    }) {
        state.help_open = !state.help_open;
    }
    // A menu that is open closes itself.
    if !Popup::is_any_open(ctx) && pressed(none, Keyboard::Escape) {
        if lessons_panel::is_open(session)
            && !state.help_open
            && !state.library_open
            && state.drawing.is_none()
        {
            toggle_lessons(session, out);
        }
        (state.help_open, state.library_open) = (false, false);
        state.drawing = None;
    }
    // A focused slider or tab takes Space and the arrows for itself. What has the focus only
    // because it was dragged or clicked leaves Space to the motion: one drags, and wants to see it
    // play.
    let focus = ctx.memory(eframe::egui::Memory::focused);
    let by_pointer = Id::unique("focused by the pointer");
    if ctx.input(|input| input.pointer.any_down() || input.pointer.any_released()) {
        ctx.data_mut(|data| data.insert_temp(by_pointer, focus));
    }
    let focused = focus.is_some();
    let touched = ctx.data(|data| data.get_temp::<Option<Id>>(by_pointer)).flatten();
    if (!focused || touched == focus) && pressed(none, Keyboard::Space) {
        out.commands.push(Command::TogglePlay);
    }
    if !focused {
        // Where a character is driven, the arrows drive it.
        let steps: &[(Keyboard, i64)] = if session.is_driven() {
            &[]
        } else {
            &[(Keyboard::ArrowLeft, -1), (Keyboard::ArrowRight, 1)]
        };
        for &(key, step) in steps {
            if pressed(shift, key) {
                out.commands.push(Command::Step(10 * step));
            }
            if pressed(none, key) {
                out.commands.push(Command::Step(step));
            }
        }
    }
    if pressed(none, Keyboard::Home) && !focused {
        out.commands.push(Command::Seek(session.span().start));
    }
    for (keyboard, key) in [(Keyboard::I, Key::In), (Keyboard::O, Key::Out)] {
        if pressed(shift, keyboard) {
            out.commands.push(Command::Reset(key));
        }
        if pressed(none, keyboard) {
            out.set_once(key, Value::Number(session.now_secs()));
        }
    }
    for (keyboard, factor) in [(Keyboard::OpenBracket, 0.5), (Keyboard::CloseBracket, 2.0)] {
        if pressed(none, keyboard) {
            out.set_once(
                Key::Rate,
                Value::Number((params.number(Key::Rate) * factor).clamp(0.05, 4.0)),
            );
        }
    }
    if pressed(none, Keyboard::L) {
        out.toggle(Key::Loop, params.is_on(Key::Loop));
    }
    if pressed(none, Keyboard::N) {
        toggle_lessons(session, out);
    }
    if pressed(none, Keyboard::C) {
        toggle_compare(session, out);
    }
    if let Kind::Choice(labs) = Key::Lab.param().kind {
        for (keyboard, lab) in LAB_KEYS.into_iter().zip(labs) {
            // A map that has the focus is made larger and smaller with these two.
            let is_taken =
                focused && matches!(keyboard, Keyboard::Num0 | Keyboard::Minus | Keyboard::Equals);
            if !is_taken && pressed(none, keyboard) {
                out.set_once(Key::Lab, Value::Choice(lab.key));
            }
        }
    }
    if session.is_driven() && pressed(none, Keyboard::Q) {
        out.toggle(Key::Strafe, params.is_on(Key::Strafe));
    }
    if pressed(none, Keyboard::T) {
        out.set_once(
            Key::Camera,
            Value::from(match params.choice() {
                choices::Camera::Top => choices::Camera::Orbit,
                choices::Camera::Orbit => choices::Camera::Top,
            }),
        );
    }
    if pressed(none, Keyboard::F) {
        frame_everything(session, state, out);
    }
    if pressed(none, Keyboard::G) {
        out.set_once(
            Key::Follow,
            Value::from(match params.choice() {
                choices::Follow::Off => choices::Follow::Result,
                _ => choices::Follow::Off,
            }),
        );
    }
    if pressed(none, Keyboard::B) {
        let next = match params.choice::<choices::Look>() {
            choices::Look::Body => choices::Look::Bones,
            choices::Look::Bones => choices::Look::Both,
            choices::Look::Limbs | choices::Look::Both => choices::Look::Body,
        };
        out.set_once(Key::Look, next.into());
    }
}
