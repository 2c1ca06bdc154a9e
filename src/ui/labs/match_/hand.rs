//! Keys, the stick on the screen and a gamepad become what the character is asked for.

use super::{is_open, shown};
use crate::ui::kit::{self, Button, Chosen};
use crate::ui::out::Out;
use crate::ui::state::{Layout, UiState};
use crate::ui::text;
use crate::ui::theme::{space, theme_of};
use eframe::egui::{Context, Key as Keyboard, Rect, Ui, UiBuilder, Vec2, pos2, vec2};
use glam::DVec2;
use segue_motion::matching::{Control, Place};
use segue_session::{Command, DriveCommand, Key, Session, Value};

/// What a gamepad asks for: sticks from -1 to 1, to the right and up.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Pad {
    /// The left stick.
    pub(crate) walk: [f32; 2],
    /// The right stick.
    pub(crate) look: [f32; 2],
    /// The button to run.
    pub(crate) run: bool,
    /// The button to strafe.
    pub(crate) strafe: bool,
}

/// The hand that drives, remembered between frames.
#[derive(Clone, Debug, Default)]
pub(crate) struct DriveHand {
    /// A gamepad that is there.
    pub(crate) pad: Option<Pad>,
    /// What the stick on the screen asks for; none while it is let go.
    stick: Option<Vec2>,
    /// The stick on the screen runs.
    runs: bool,
    /// Where keys, stick and gamepad push now, for the eye.
    pushed: Vec2,
    /// The candidate that is shown on the stage, by its place in the list.
    pub(super) chosen: Option<usize>,
    /// The stretch of a clip that is to be tagged.
    pub(super) stretch: Option<Chosen>,
    /// The word of one's own that is being typed for it.
    pub(super) word: String,
    /// The candidate under the pointer.
    pub(super) hovered: Option<usize>,
}

/// A stick that is pushed by less rests.
const DEAD: f32 = 0.18;
/// Height of a row of numbers below the stick, points at a desk.
const NUMBERS: f32 = 36.0;
/// How fast a gamepad turns the camera, degrees per second.
const TURN_DPS: f64 = 130.0;

impl DriveHand {
    /// Whether a thumb is on the stick: two fingers do not move the camera then.
    pub(crate) fn is_held(&self) -> bool {
        self.stick.is_some()
    }

    /// The frame that is shown as a ghost.
    pub(crate) fn ghost(&self, session: &Session) -> Option<Place> {
        if !is_open(session) {
            return None;
        }
        let search = shown(session)?.1.search.as_ref()?;
        let candidate = search.candidates.get(self.hovered.or(self.chosen)?)?;
        Some(candidate.place)
    }
}

/// Asks the character for what the hands do, where that is something else than before.
pub(crate) fn steer(session: &Session, state: &mut UiState, out: &mut Out, ctx: &Context) {
    if !session.is_driven() {
        state.drive.stick = None;
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
    let pad = state.drive.pad.unwrap_or_default();
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
        live(state.drive.stick.unwrap_or_default()),
        live(Vec2::from(pad.walk)),
    ];
    // The hand that pushes hardest.
    let push = pushes.into_iter().fold(Vec2::ZERO, |most, push| {
        if push.length_sq() > most.length_sq() { push } else { most }
    });
    let runs = shift || pad.run || (state.drive.runs && state.drive.stick.is_some());
    let speed = params.number(if runs { Key::RunSpeed } else { Key::WalkSpeed });
    let yaw = params.number(Key::CameraYaw).to_radians();
    // Over the ground: away from the camera, and to its right.
    let ahead = DVec2::new(-yaw.sin(), -yaw.cos());
    let right = DVec2::new(-ahead.y, ahead.x);
    let velocity = (right * f64::from(push.x) + ahead * f64::from(push.y)) * speed;
    let strafes = params.is_on(Key::Strafe) != pad.strafe;
    let control = Control::new(velocity, strafes.then(|| ahead.x.atan2(ahead.y)));
    state.drive.pushed = push;
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

/// The stick over the lower left of the stage, above its numbers.
pub(crate) fn stick_on_stage_ui(
    session: &Session,
    stage: Rect,
    layout: Layout,
    state: &mut UiState,
    ui: &mut Ui,
) {
    state.drive.stick = None;
    if !session.is_driven() {
        return;
    }
    let size = kit::stick_size(ui);
    // It must not move under the thumb when a number comes or goes.
    let numbers = if layout == Layout::Phone { 2.0 } else { 1.0 } * NUMBERS + 2.0 * space::M;
    let bottom = stage.bottom() - numbers * theme_of(ui).scale() - space::S;
    let center = pos2(stage.left() + space::L + 0.5 * size, bottom - 0.5 * size);
    // Where there is no room for it, keys and gamepad are left.
    if center.y - 0.5 * size < stage.top() + 40.0 {
        return;
    }
    let shown = state.drive.pushed;
    state.drive.stick = kit::stick_ui(text::STICK, center, shown, ui);
    let height = theme_of(ui).row_height();
    let button = Rect::from_min_size(
        pos2(center.x + 0.5 * size + space::S, bottom - height),
        vec2(120.0 * theme_of(ui).scale(), height),
    );
    if layout == Layout::Phone {
        ui.scope_builder(UiBuilder::new().id_salt("run").max_rect(button), |ui| {
            if kit::button_ui(
                Button::new(text::RUN).hint(text::RUN_HELP).selected(state.drive.runs),
                ui,
            )
            .clicked()
            {
                state.drive.runs = !state.drive.runs;
            }
        });
    }
}
