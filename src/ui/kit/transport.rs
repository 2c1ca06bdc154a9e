//! The row above the timeline: play, position and speed.

use super::assistive::{describe, readable_ui};
use super::button::{Button, button_ui, icon_button_ui};
use super::icon::{Icon, paint_icon};
use super::menu::{MenuItem, menu_item_ui, menu_ui};
use super::paint::{Run, focus_ring, line_of, put};
use super::words;
use crate::ui::language::{Text, say};
use crate::ui::theme::{Type, palette_of, space, theme_of};
use eframe::egui::{
    Align, Align2, CursorIcon, Layout, RectAlign, Role, Sense, Ui, UiBuilder, WidgetInfo, pos2,
    vec2,
};

/// The speeds in the menu.
const SPEEDS: [f64; 7] = [0.05, 0.1, 0.25, 0.5, 1.0, 2.0, 4.0];

/// The state of playback.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Transport<'a> {
    /// Whether it plays.
    pub(crate) playing: bool,
    /// Whether it starts again at the end.
    pub(crate) repeat: bool,
    /// The speed; 1 is real time.
    pub(crate) speed: f64,
    /// The playhead, in seconds.
    pub(crate) now: f64,
    /// The frame at the playhead, from 0.
    pub(crate) frame: usize,
    /// The number of frames.
    pub(crate) frames: usize,
    /// The caption at the right end, such as the quantity of the curves below: `right foot · speed
    /// m/s`.
    pub(crate) caption: Text<'a>,
}

/// The user's input to playback.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum TransportEvent {
    /// Play or pause.
    SetPlaying(bool),
    /// Start again at the end, or not.
    SetRepeat(bool),
    /// Set the speed.
    SetSpeed(f64),
    /// Go on by frames (negative: back), and pause.
    Step(i32),
}

/// Draws play, steps, speed, the time and the frame, and the caption at the right where there is
/// room.
pub(crate) fn transport_ui(transport: &Transport<'_>, ui: &mut Ui) -> Option<TransportEvent> {
    let (theme, palette) = (theme_of(ui), palette_of(ui));
    let scale = theme.scale();
    let height = transport_height(ui);
    let width = ui.available_width();
    // A phone has no room for the steps: the timeline itself can be scrubbed.
    let narrow = width < 520.0 * scale;
    let (_, row) = ui.allocate_space(vec2(width, height));
    let mut event = None;
    let builder = UiBuilder::new()
        .id_salt("transport")
        .max_rect(row)
        .layout(Layout::left_to_right(Align::Center));
    let right_end = {
        let ui = &mut ui.new_child(builder);
        ui.spacing_mut().item_spacing.x = 2.0;
        if play_button_ui(transport.playing, ui) {
            event = Some(TransportEvent::SetPlaying(!transport.playing));
        }
        ui.add_space(space::XS);
        if !narrow {
            if icon_button_ui(Icon::StepBack, words::STEP_BACK, ui).clicked() {
                event = Some(TransportEvent::Step(-1));
            }
            if icon_button_ui(Icon::StepForward, words::STEP_FORWARD, ui).clicked() {
                event = Some(TransportEvent::Step(1));
            }
            if button_ui(
                Button::icon_only(Icon::Loop, words::REPEAT).selected(transport.repeat),
                ui,
            )
            .clicked()
            {
                event = Some(TransportEvent::SetRepeat(!transport.repeat));
            }
        }
        if let Some(speed) = speed_ui(transport.speed, ui) {
            event = Some(TransportEvent::SetSpeed(speed));
        }
        ui.add_space(space::XS);
        let time = format!("{:.2} s", transport.now);
        let frame = format!("{} {} / {}", say(words::FRAME, ui), transport.frame, transport.frames);
        let mut runs = vec![Run::new(Text::Data(&time), Type::Strong, palette.text)];
        if !narrow {
            runs.push(Run::new(Text::Data(&frame), Type::Body, palette.muted).after(space::M));
        }
        let galley = line_of(&runs, f32::INFINITY, ui);
        // As wide as with the last frame: what stands behind it does not move while it plays.
        let font = theme.font(Type::Body);
        let figure = ui.fonts_mut(|fonts| fonts.glyph_width(&font, '0'));
        let missing = figures(transport.frames).saturating_sub(figures(transport.frame));
        let missing = if narrow { 0.0 } else { missing as f32 * figure };
        let (id, rect) = ui.allocate_space(vec2((galley.size().x + missing).round(), height));
        readable_ui(&format!("{time}, {frame}"), rect, id, ui);
        put(ui.painter(), rect.left_center(), Align2::LEFT_CENTER, galley);
        rect.right()
    };
    let left = right_end + space::L;
    let caption =
        line_of(&[Run::new(transport.caption, Type::Body, palette.muted)], row.right() - left, ui);
    put(ui.painter(), pos2(row.right(), row.center().y), Align2::RIGHT_CENTER, caption);
    event
}

/// Returns the number of figures of a number.
fn figures(number: usize) -> u32 {
    number.checked_ilog10().unwrap_or(0) + 1
}

/// Returns the height of [`transport_ui`].
pub(crate) fn transport_height(ui: &Ui) -> f32 {
    let theme = theme_of(ui);
    (36.0 * theme.scale()).max(theme.hit()).round()
}

/// Draws the round button that plays and pauses. Returns whether it was pressed.
pub(crate) fn play_button_ui(playing: bool, ui: &mut Ui) -> bool {
    let palette = palette_of(ui);
    let theme = theme_of(ui);
    let side = (34.0 * theme.scale()).max(theme.hit()).round();
    let (rect, response) = ui.allocate_exact_size(vec2(side, side), Sense::click());
    let response = response.on_hover_cursor(CursorIcon::PointingHand);
    let hot = ui.ctx().animate_bool(response.id, response.hovered() || response.has_focus());
    let fill = palette.handle.lerp_to_gamma(palette.accent, 0.25 * hot);
    ui.painter().circle_filled(rect.center(), side / 2.0 - 0.5 + hot * 0.5, fill);
    let icon = if playing { Icon::Pause } else { Icon::Play };
    // The centroid of a triangle lies left of the middle of its box.
    let nudge = if playing { 0.0 } else { 0.02 * side };
    paint_icon(
        icon,
        rect.shrink(side * 0.27).translate(vec2(nudge, 0.0)),
        palette.on_handle,
        ui.painter(),
    );
    focus_ring(rect, (side / 2.0) as u8, &response, ui);
    let name = if playing { words::PAUSE } else { words::PLAY };
    describe(&response, &WidgetInfo::labeled(Role::Button, ui.is_enabled(), say(name, ui)));
    let clicked = response.clicked();
    response.on_hover_text(say(name, ui));
    clicked
}

fn speed_ui(speed: f64, ui: &mut Ui) -> Option<f64> {
    let said = format!("{speed}×");
    let name = format!("{}: {said}", say(words::SPEED, ui));
    let button = Button::new(Text::Data(&said)).quiet();
    let opener = button_ui(button.name(Text::Data(&name)).hint(words::SPEED), ui);
    let mut picked = None;
    menu_ui(&opener, RectAlign::TOP_START, |ui| {
        for value in SPEEDS {
            if menu_item_ui(
                MenuItem {
                    text: Text::Data(&format!("{value}×")),
                    chosen: Some(value == speed),
                    ..MenuItem::default()
                },
                ui,
            )
            .clicked()
            {
                picked = Some(value);
            }
        }
    });
    picked.filter(|&value| value != speed)
}
