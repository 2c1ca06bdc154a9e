//! The input of keys, the stick on the screen and a gamepad to the character.

use super::present::{is_open, shown};
use crate::ui::kit::{self, Button};
use crate::ui::out::Out;
use crate::ui::state::{Layout, UiState};
use crate::ui::text;
use crate::ui::theme::{space, theme_of};
use eframe::egui::{Context, Key as Keyboard, Rect, Ui, UiBuilder, Vec2, pos2, vec2};
use glam::DVec2;
use segue_motion::matching::{Control, Place};
use segue_session::{Command, DriveCommand, Key, Session, Value};

/// The push below which a stick is at rest.
const DEAD: f32 = 0.18;
/// The speed at which a gamepad turns the camera, degrees per second.
const TURN_DPS: f64 = 130.0;

/// Returns the frame that is shown as a ghost.
pub(crate) fn candidate(session: &Session, state: &UiState) -> Option<Place> {
    if !is_open(session) {
        return None;
    }
    let search = shown(session)?.1.search.as_ref()?;
    let state = &state.labs.match_;
    Some(search.candidates.get(state.hovered.or(state.chosen)?)?.place)
}

/// Steers the character when the input has changed.
pub(crate) fn steer(session: &Session, state: &mut UiState, out: &mut Out, ctx: &Context) {
    if !session.is_driven() {
        state.labs.match_.stick = None;
        return;
    }
    let params = session.params();
    let typing = ctx.text_edit_focused();
    let focused = ctx.memory(|memory| memory.focused().is_some());
    let (keys, shift) = ctx.input(|input| {
        let free = !typing && !input.modifiers.command && !input.modifiers.alt;
        let down = |letter: Keyboard, arrow: Keyboard| {
            free && (input.key_down(letter) || (!focused && input.key_down(arrow)))
        };
        let axis = |more: bool, less: bool| f32::from(i8::from(more) - i8::from(less));
        let keys = vec2(
            axis(down(Keyboard::D, Keyboard::ArrowRight), down(Keyboard::A, Keyboard::ArrowLeft)),
            axis(down(Keyboard::W, Keyboard::ArrowUp), down(Keyboard::S, Keyboard::ArrowDown)),
        );
        (keys, free && input.modifiers.shift)
    });
    let pad = state.gamepad.unwrap_or_default();
    let live = |push: Vec2| {
        let length = push.length();
        if length < DEAD {
            Vec2::ZERO
        } else {
            push / length * ((length.min(1.0) - DEAD) / (1.0 - DEAD))
        }
    };
    let pushes = [
        keys.normalized(),
        live(state.labs.match_.stick.unwrap_or_default()),
        live(Vec2::from(pad.walk)),
    ];
    // The strongest push counts.
    let push = pushes.into_iter().fold(Vec2::ZERO, |most, push| {
        if push.length_sq() > most.length_sq() { push } else { most }
    });
    let runs = shift || pad.run || (state.labs.match_.runs && state.labs.match_.stick.is_some());
    let speed = params.number(if runs { Key::RunSpeed } else { Key::WalkSpeed });
    let yaw = params.number(Key::CameraYaw).to_radians();
    // Directions over the ground: away from the camera, and to its right.
    let ahead = DVec2::new(-yaw.sin(), -yaw.cos());
    let right = DVec2::new(-ahead.y, ahead.x);
    let velocity = (right * f64::from(push.x) + ahead * f64::from(push.y)) * speed;
    let strafes = params.is_on(Key::Strafe) != pad.strafe;
    let control = Control::new(velocity, strafes.then(|| ahead.x.atan2(ahead.y)));
    state.labs.match_.pushed = push;
    if control != session.control() {
        out.commands.push(Command::Drive(DriveCommand::Steer(control)));
    }
    let look = live(Vec2::from(pad.look));
    if look != Vec2::ZERO {
        let dt = f64::from(ctx.input(|input| input.stable_dt)).min(0.1);
        let yaw = params.number(Key::CameraYaw) - f64::from(look.x) * TURN_DPS * dt;
        let pitch = params.number(Key::CameraPitch) - f64::from(look.y) * 0.5 * TURN_DPS * dt;
        out.commands.push(Command::Set(vec![
            (Key::CameraYaw, Value::Number((yaw + 180.0).rem_euclid(360.0) - 180.0)),
            (Key::CameraPitch, Value::Number(pitch.clamp(-10.0, 89.0))),
        ]));
    }
}

/// Draws the stick at the lower left of `free`. Returns its place.
pub(crate) fn stick_on_stage_ui(
    session: &Session,
    free: Rect,
    layout: Layout,
    state: &mut UiState,
    ui: &mut Ui,
) -> Rect {
    state.labs.match_.stick = None;
    if !session.is_driven() {
        return Rect::NOTHING;
    }
    let size = kit::stick_size(ui);
    let bottom = free.bottom() - space::M;
    let center = pos2(free.left() + space::L + 0.5 * size, bottom - 0.5 * size);
    // Without room for the stick, keys and gamepad remain.
    if center.y - 0.5 * size < free.top() {
        return Rect::NOTHING;
    }
    let shown = state.labs.match_.pushed;
    state.labs.match_.stick = kit::stick_ui(text::STICK, center, shown, ui);
    let stick = Rect::from_center_size(center, vec2(size, size));
    if layout != Layout::Phone {
        return stick;
    }
    let height = theme_of(ui).row_height();
    let button = Rect::from_min_size(
        pos2(stick.right() + space::S, bottom - height),
        vec2(120.0 * theme_of(ui).scale(), height),
    );
    ui.scope_builder(UiBuilder::new().id_salt("run").max_rect(button), |ui| {
        if kit::button_ui(
            Button::new(text::RUN).hint(text::RUN_HELP).selected(state.labs.match_.runs),
            ui,
        )
        .clicked()
        {
            state.labs.match_.runs = !state.labs.match_.runs;
        }
    });
    stick.union(button)
}
