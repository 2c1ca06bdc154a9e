//! Panels that stand still while a motion plays.

use super::*;
use crate::ui::still;
use eframe::egui::epaint::{Primitive, Vertex};
use eframe::egui::{Context, Event, Pos2, RawInput};
use lessons::lesson;

const LINK: &str = "lab=blend&compare=blend_window:30,15,10&play=off&t=2.9";

/// A page that is shown in frames of a twentieth of a second, as a window without a screen reader
/// shows it.
struct Frames {
    ctx: Context,
    page: Page,
    secs: f64,
}

impl Frames {
    fn new(page: Page) -> Self {
        let ctx = Context::default();
        DARK.install(&ctx);
        let mut frames = Self { ctx, page, secs: 0.0 };
        // Sizes settle in the first ones.
        for _ in 0..4 {
            frames.next(vec![Event::WindowFocused(true)]);
        }
        frames
    }

    /// Runs a frame with these events, and returns the corners of its triangles in order.
    fn next(&mut self, events: Vec<Event>) -> Vec<Vertex> {
        self.secs += 0.05;
        let input = RawInput {
            screen_rect: Some(Rect::from_min_size(Pos2::ZERO, DESK)),
            time: Some(self.secs),
            focused: true,
            events,
            ..RawInput::default()
        };
        let Page { session, state, curves, out, .. } = &mut self.page;
        let mut output = self.ctx.run_ui(input, |ui| {
            state.stillness.begin(true, ui.ctx());
            let mut paint = |_: Rect, _: &[(usize, Rect)], _: &mut Ui| {};
            let heard = show(session, state, curves, &mut paint, ui);
            out.commands.extend(heard.commands);
        });
        let shapes = std::mem::take(&mut output.shapes);
        output.drop_without_applying_deltas();
        let primitives = self.ctx.tessellate(shapes, 1.0);
        let corners = primitives.into_iter().flat_map(|primitive| match primitive.primitive {
            Primitive::Mesh(mesh) => {
                mesh.indices.iter().map(|index| mesh.vertices[*index as usize]).collect()
            }
            Primitive::Callback(_) => Vec::new(),
        });
        corners.collect()
    }

    /// Runs frames until panels stand still, and returns what the last one before shows, and the
    /// first one of those.
    fn stand_still(&mut self) -> [Vec<Vertex>; 2] {
        let mut before = Vec::new();
        for _ in 0..40 {
            let now = self.next(Vec::new());
            if self.page.state.stillness.is_still() {
                return [before, now];
            }
            before = now;
        }
        panic!("no panel stands still after two seconds without an event");
    }
}

/// Returns the place of what has this label on the page of a link.
fn place_of(label: &str, link: &str) -> Rect {
    harness(DESK, DARK, page(link)).get_by_label(label).rect()
}

#[test]
fn panels_that_stand_still_look_as_drawn() {
    let check = |name: &str, page: Page| {
        let [drawn, still] = Frames::new(page).stand_still();
        assert_eq!(drawn.len(), still.len(), "{name}");
        assert!(drawn == still, "{name}");
    };
    check("three panes", page(LINK));
    check("a result that is refused", page("lab=graph&play=off"));
    check("the map of a graph", page("lab=graph&a=walk&b=run&play=off"));
    check("a lesson", lesson("lesson=half_life&lab=transition&play=off"));
}

#[test]
fn click_on_a_panel_that_stands_still_reaches_its_button() {
    let at = place_of("Loop", LINK).center();
    let mut frames = Frames::new(page(LINK));
    for _ in 0..3 {
        frames.stand_still();
        frames.next(Vec::new());
        frames.page.out = Out::default();
        frames.next(vec![Event::PointerMoved(at), button(at, true)]);
        assert!(!frames.page.state.stillness.is_still());
        frames.next(vec![button(at, false), Event::PointerGone]);
        frames.next(Vec::new());
        let lab = vec![(Key::Lab, Value::Choice("loop"))];
        assert_eq!(frames.page.out.commands.first(), Some(&Command::Set(lab)));
    }
}

#[test]
fn panel_that_changes_unnoticed_is_drawn_again_soon() {
    let row = place_of("Blend window · 1", LINK);
    let of_row = |corners: Vec<Vertex>| -> Vec<Vertex> {
        corners.into_iter().filter(|corner| row.contains(corner.pos)).collect()
    };
    let mut frames = Frames::new(page(LINK));
    let [_, still] = frames.stand_still().map(of_row);
    let link = LINK.replace("30,15,10", "44,15,10");
    frames.page.session.apply(Command::OpenLink(link)).expect("a page as the tests need it");
    while frames.page.session.work() {}
    assert!(of_row(frames.next(Vec::new())) == still);
    let changed = (0..64).map(|_| frames.next(Vec::new())).last().map(of_row);
    assert!(changed.is_some_and(|changed| !changed.is_empty() && changed != still));
    assert!(frames.page.state.stillness.is_still(), "the others");
}

#[test]
fn nothing_stands_still_for_a_screen_reader() {
    let mut frames = Frames::new(page(LINK));
    frames.stand_still();
    frames.ctx.enable_accesskit();
    for _ in 0..100 {
        frames.next(Vec::new());
        assert!(!frames.page.state.stillness.is_still());
    }
    assert!(still::is_expected(&frames.ctx), "the outline need not be told of the next frame");
}

#[test]
fn selected_text_stays_selected() {
    const LINK: &str = "lab=speed&play=off";
    let note = place_of("A: 1.41 m/s · B: 3.50 m/s", LINK);
    let mut frames = Frames::new(page(LINK));
    frames.stand_still();
    let (from, to) = (note.left_center() + vec2(1.0, 0.0), note.right_center());
    frames.next(vec![Event::PointerMoved(from)]);
    frames.next(vec![button(from, true)]);
    frames.next(vec![Event::PointerMoved(to)]);
    frames.next(vec![button(to, false)]);
    for _ in 0..100 {
        frames.next(Vec::new());
        assert!(!frames.page.state.stillness.is_still());
    }
}

#[test]
fn open_menu_keeps_all_panels_drawn() {
    let at = place_of(text::SHARE.english(), LINK).center();
    let mut frames = Frames::new(page(LINK));
    frames.stand_still();
    frames.next(vec![Event::PointerMoved(at), button(at, true)]);
    frames.next(vec![button(at, false)]);
    for _ in 0..100 {
        frames.next(Vec::new());
        assert!(!frames.page.state.stillness.is_still());
    }
}
