//! Icons, drawn as strokes: no icon font has to be downloaded, and they take the colour of their
//! widget.

use eframe::egui::{Color32, Painter, Pos2, Rect, Shape, Stroke, StrokeKind, Vec2, pos2, vec2};
use std::f32::consts::{PI, TAU};

/// An icon of the interface.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Icon {
    /// Play.
    Play,
    /// Pause.
    Pause,
    /// One frame forward.
    StepForward,
    /// One frame back.
    StepBack,
    /// Start again at the end.
    Loop,
    /// Dark or light theme.
    Contrast,
    /// Another language: 中.
    Language,
    /// Menu.
    Menu,
    /// Close.
    Close,
    /// Undo.
    Undo,
    /// Redo.
    Redo,
    /// A link to share.
    Link,
    /// Add.
    Plus,
    /// Remove one.
    Minus,
    /// Delete.
    Trash,
    /// Rename.
    Pencil,
    /// The camera follows the body.
    Follow,
    /// Top view.
    Top,
    /// Frame all.
    FrameAll,
    /// Warning.
    Warning,
    /// Success, or the current choice.
    Check,
    /// Information.
    Info,
    /// Opens downward.
    ChevronDown,
    /// Opens upward.
    ChevronUp,
    /// Back by one.
    ChevronLeft,
    /// Forward by one; folded.
    ChevronRight,
    /// Save a picture.
    Picture,
    /// Report.
    Report,
    /// Record a video.
    Record,
    /// Save a file.
    Download,
    /// Help.
    Help,
    /// Library.
    Folder,
    /// Compare, or swap.
    Swap,
    /// Lessons.
    Book,
    /// Details.
    Sliders,
    /// The order of a list.
    Sort,
    /// More commands.
    More,
    /// Present.
    Screen,
}

/// Draws an icon into the square in the middle of `rect`, in strokes of one colour.
pub(crate) fn paint_icon(icon: Icon, rect: Rect, color: Color32, painter: &Painter) {
    let side = rect.width().min(rect.height());
    let pen = Pen {
        origin: Rect::from_center_size(rect.center(), Vec2::splat(side)).min,
        unit: side / 16.0,
        color,
        painter,
    };
    match icon {
        Icon::Play => pen.fill(&[(5.0, 3.0), (13.0, 8.0), (5.0, 13.0)]),
        Icon::Pause => {
            pen.bar(4.2, 3.0, 7.0, 13.0);
            pen.bar(9.0, 3.0, 11.8, 13.0);
        }
        Icon::StepForward => {
            pen.fill(&[(3.5, 3.5), (10.0, 8.0), (3.5, 12.5)]);
            pen.bar(10.8, 3.5, 12.6, 12.5);
        }
        Icon::StepBack => {
            pen.fill(&[(12.5, 3.5), (6.0, 8.0), (12.5, 12.5)]);
            pen.bar(3.4, 3.5, 5.2, 12.5);
        }
        Icon::Loop => {
            pen.stroke(&[(2.5, 7.5), (2.5, 6.2), (3.7, 4.5), (5.5, 4.5), (13.0, 4.5)]);
            pen.stroke(&[(10.8, 2.2), (13.2, 4.5), (10.8, 6.8)]);
            pen.stroke(&[(13.5, 8.5), (13.5, 9.8), (12.3, 11.5), (10.5, 11.5), (3.0, 11.5)]);
            pen.stroke(&[(5.2, 9.2), (2.8, 11.5), (5.2, 13.8)]);
        }
        Icon::Contrast => {
            pen.circle(8.0, 8.0, 5.6);
            let arc = (0..=20_u8).map(|i| {
                let angle = PI / 2.0 + PI * f32::from(i) / 20.0;
                (8.0 + 5.6 * angle.cos(), 8.0 + 5.6 * angle.sin())
            });
            pen.fill(&arc.collect::<Vec<_>>());
        }
        Icon::Language => {
            // A box and an upright line, since fonts may lack the character.
            pen.stroke(&[(2.5, 4.5), (13.5, 4.5), (13.5, 10.3), (2.5, 10.3), (2.5, 4.5)]);
            pen.stroke(&[(8.0, 1.5), (8.0, 14.5)]);
        }
        Icon::Book => {
            // An open book.
            pen.stroke(&[
                (8.0, 4.2),
                (6.2, 3.0),
                (2.0, 3.0),
                (2.0, 12.2),
                (6.2, 12.2),
                (8.0, 13.4),
            ]);
            pen.stroke(&[
                (8.0, 4.2),
                (9.8, 3.0),
                (14.0, 3.0),
                (14.0, 12.2),
                (9.8, 12.2),
                (8.0, 13.4),
                (8.0, 4.2),
            ]);
        }
        Icon::Menu => {
            for y in [4.0, 8.0, 12.0] {
                pen.stroke(&[(2.5, y), (13.5, y)]);
            }
        }
        Icon::Close => {
            pen.stroke(&[(4.0, 4.0), (12.0, 12.0)]);
            pen.stroke(&[(12.0, 4.0), (4.0, 12.0)]);
        }
        Icon::Undo => {
            pen.stroke(&[(6.0, 3.2), (2.8, 6.2), (6.0, 9.2)]);
            pen.stroke(&curve(
                &[(2.8, 6.2), (9.5, 6.2)],
                (9.5, 9.7),
                3.5,
                -PI / 2.0,
                PI / 2.0,
                &[(6.5, 13.2)],
            ));
        }
        Icon::Redo => {
            pen.stroke(&[(10.0, 3.2), (13.2, 6.2), (10.0, 9.2)]);
            pen.stroke(&curve(
                &[(13.2, 6.2), (6.5, 6.2)],
                (6.5, 9.7),
                3.5,
                -PI / 2.0,
                -1.5 * PI,
                &[(9.5, 13.2)],
            ));
        }
        Icon::Link => {
            pen.capsule((5.2, 10.8), 3.4, 2.3);
            pen.capsule((10.8, 5.2), 3.4, 2.3);
        }
        Icon::Plus => {
            pen.stroke(&[(8.0, 3.0), (8.0, 13.0)]);
            pen.stroke(&[(3.0, 8.0), (13.0, 8.0)]);
        }
        Icon::Minus => pen.stroke(&[(3.0, 8.0), (13.0, 8.0)]),
        Icon::Trash => {
            pen.stroke(&[(2.8, 4.5), (13.2, 4.5)]);
            pen.stroke(&[(6.0, 4.2), (6.0, 2.5), (10.0, 2.5), (10.0, 4.2)]);
            pen.stroke(&[(4.2, 4.8), (4.8, 13.5), (11.2, 13.5), (11.8, 4.8)]);
        }
        Icon::Pencil => {
            pen.closed(&[(3.0, 13.0), (3.6, 10.2), (10.8, 3.0), (13.0, 5.2), (5.8, 12.4)]);
            pen.stroke(&[(9.2, 4.6), (11.4, 6.8)]);
        }
        Icon::Follow => {
            pen.circle(8.0, 8.0, 2.0);
            for (x, y) in [(8.0, 1.0), (8.0, 15.0), (1.0, 8.0), (15.0, 8.0)] {
                pen.stroke(&[(x, y), (8.0 + (x - 8.0) * 0.55, 8.0 + (y - 8.0) * 0.55)]);
            }
            pen.circle(8.0, 8.0, 5.0);
        }
        Icon::Top => {
            pen.closed(&[(8.0, 2.2), (14.2, 5.6), (8.0, 9.0), (1.8, 5.6)]);
            pen.stroke(&[(2.2, 8.6), (8.0, 11.8), (13.8, 8.6)]);
            pen.stroke(&[(2.2, 11.4), (8.0, 14.6), (13.8, 11.4)]);
        }
        Icon::FrameAll => {
            for (x, y) in [(2.8, 2.8), (13.2, 2.8), (2.8, 13.2), (13.2, 13.2)] {
                let inward = |at: f32| at + (8.0 - at).signum() * 3.2;
                pen.stroke(&[(inward(x), y), (x, y), (x, inward(y))]);
            }
            pen.disc(8.0, 8.0, 1.6);
        }
        Icon::Warning => {
            pen.closed(&[(8.0, 2.4), (14.4, 13.4), (1.6, 13.4)]);
            pen.stroke(&[(8.0, 6.4), (8.0, 9.4)]);
            pen.disc(8.0, 11.4, 0.9);
        }
        Icon::Check => pen.stroke(&[(3.0, 8.6), (6.4, 12.0), (13.0, 4.4)]),
        Icon::Info => {
            pen.circle(8.0, 8.0, 6.0);
            pen.stroke(&[(8.0, 7.4), (8.0, 11.0)]);
            pen.disc(8.0, 5.0, 0.9);
        }
        Icon::ChevronDown => pen.stroke(&[(4.0, 6.2), (8.0, 10.2), (12.0, 6.2)]),
        Icon::ChevronUp => pen.stroke(&[(4.0, 9.8), (8.0, 5.8), (12.0, 9.8)]),
        Icon::ChevronLeft => pen.stroke(&[(9.8, 4.0), (5.8, 8.0), (9.8, 12.0)]),
        Icon::ChevronRight => pen.stroke(&[(6.2, 4.0), (10.2, 8.0), (6.2, 12.0)]),
        Icon::Picture => {
            pen.closed(&[
                (2.0, 5.0),
                (5.0, 5.0),
                (6.2, 3.2),
                (9.8, 3.2),
                (11.0, 5.0),
                (14.0, 5.0),
                (14.0, 12.8),
                (2.0, 12.8),
            ]);
            pen.circle(8.0, 8.8, 2.3);
        }
        Icon::Report => {
            pen.closed(&[(3.4, 2.2), (12.6, 2.2), (12.6, 13.8), (3.4, 13.8)]);
            for y in [5.4, 8.0, 10.6] {
                pen.stroke(&[(5.8, y), (10.2, y)]);
            }
        }
        Icon::Record => {
            pen.circle(8.0, 8.0, 6.0);
            pen.disc(8.0, 8.0, 3.0);
        }
        Icon::Download => {
            pen.stroke(&[(8.0, 2.5), (8.0, 10.0)]);
            pen.stroke(&[(4.8, 7.0), (8.0, 10.2), (11.2, 7.0)]);
            pen.stroke(&[(2.8, 11.0), (2.8, 13.5), (13.2, 13.5), (13.2, 11.0)]);
        }
        Icon::Help => {
            let hook: Vec<_> = arc((8.0, 6.2), 2.6, -PI, 0.45 * PI)
                .into_iter()
                .chain([(8.0, 9.2), (8.0, 10.2)])
                .collect();
            pen.stroke(&hook);
            pen.disc(8.0, 12.7, 0.95);
        }
        Icon::Folder => pen.closed(&[
            (2.2, 12.8),
            (2.2, 3.6),
            (6.4, 3.6),
            (7.8, 5.4),
            (13.8, 5.4),
            (13.8, 12.8),
        ]),
        Icon::Swap => {
            pen.stroke(&[(2.5, 5.2), (13.0, 5.2)]);
            pen.stroke(&[(10.4, 2.6), (13.2, 5.2), (10.4, 7.8)]);
            pen.stroke(&[(13.5, 10.8), (3.0, 10.8)]);
            pen.stroke(&[(5.6, 8.2), (2.8, 10.8), (5.6, 13.4)]);
        }
        Icon::Screen => {
            pen.stroke(&[(1.8, 2.8), (14.2, 2.8)]);
            pen.stroke(&[(3.0, 3.0), (3.0, 10.4), (13.0, 10.4), (13.0, 3.0)]);
            pen.stroke(&[(8.0, 10.6), (8.0, 12.0)]);
            pen.stroke(&[(5.2, 14.0), (8.0, 11.6), (10.8, 14.0)]);
        }
        Icon::Sliders => {
            for (y, knob) in [(5.0, 10.5), (11.0, 5.5)] {
                pen.stroke(&[(2.5, y), (knob - 1.9, y)]);
                pen.stroke(&[(knob + 1.9, y), (13.5, y)]);
                pen.circle(knob, y, 1.9);
            }
        }
        Icon::Sort => {
            for (y, right) in [(4.0, 13.5), (8.0, 10.5), (12.0, 7.0)] {
                pen.stroke(&[(2.5, y), (right, y)]);
            }
        }
        Icon::More => {
            for x in [3.5, 8.0, 12.5] {
                pen.disc(x, 8.0, 1.2);
            }
        }
    }
}

/// Draws the logo: one line from a warm to a cool colour.
pub(crate) fn paint_logo(rect: Rect, warm: Color32, cool: Color32, painter: &Painter) {
    let wave = |t: f32| {
        let y = 0.5 - 0.32 * (TAU * (t * 0.92 - 0.21)).sin();
        pos2(rect.left() + t * rect.width(), rect.top() + y * rect.height())
    };
    let steps = 40_u8;
    let width = rect.height() * 0.17;
    let at = |i: u8| f32::from(i) / f32::from(steps);
    for i in 0..steps {
        let color = warm.lerp_to_gamma(cool, at(i));
        painter.line_segment([wave(at(i)), wave(at(i + 1))], Stroke::new(width, color));
        painter.circle_filled(wave(at(i)), width / 2.0, color);
    }
    painter.circle_filled(wave(1.0), width / 2.0, cool);
}

/// A painter in a square of 16 × 16 units.
struct Pen<'a> {
    origin: Pos2,
    unit: f32,
    color: Color32,
    painter: &'a Painter,
}

impl Pen<'_> {
    fn at(&self, (x, y): (f32, f32)) -> Pos2 {
        self.origin + self.unit * vec2(x, y)
    }

    fn line(&self) -> Stroke {
        Stroke::new((1.35 * self.unit).max(1.2), self.color)
    }

    fn points(&self, points: &[(f32, f32)]) -> Vec<Pos2> {
        points.iter().map(|&point| self.at(point)).collect()
    }

    /// Draws an open line with round ends.
    fn stroke(&self, points: &[(f32, f32)]) {
        for end in [points.first(), points.last()].into_iter().flatten() {
            self.painter.circle_filled(self.at(*end), self.line().width / 2.0, self.color);
        }
        self.painter.add(Shape::line(self.points(points), self.line()));
    }

    fn closed(&self, points: &[(f32, f32)]) {
        self.painter.add(Shape::closed_line(self.points(points), self.line()));
    }

    fn fill(&self, points: &[(f32, f32)]) {
        self.painter.add(Shape::convex_polygon(self.points(points), self.color, Stroke::NONE));
    }

    fn bar(&self, left: f32, top: f32, right: f32, bottom: f32) {
        self.painter.rect_filled(
            Rect::from_min_max(self.at((left, top)), self.at((right, bottom))),
            0.6 * self.unit,
            self.color,
        );
    }

    fn circle(&self, x: f32, y: f32, radius: f32) {
        self.painter.circle_stroke(self.at((x, y)), radius * self.unit, self.line());
    }

    fn disc(&self, x: f32, y: f32, radius: f32) {
        self.painter.circle_filled(self.at((x, y)), radius * self.unit, self.color);
    }

    /// Draws a link of a chain, leaning up to the right.
    fn capsule(&self, center: (f32, f32), half_length: f32, radius: f32) {
        let size = vec2(2.0 * (half_length + radius * 0.5), 2.0 * radius) * self.unit;
        let rect = Rect::from_center_size(self.at(center), size);
        let shape = eframe::egui::epaint::RectShape::stroke(
            rect,
            radius * self.unit,
            self.line(),
            StrokeKind::Middle,
        );
        self.painter.add(shape.with_angle(-PI / 4.0));
    }
}

fn arc(center: (f32, f32), radius: f32, from: f32, to: f32) -> Vec<(f32, f32)> {
    (0..=14_u8)
        .map(|i| {
            let angle = from + (to - from) * f32::from(i) / 14.0;
            (center.0 + radius * angle.cos(), center.1 + radius * angle.sin())
        })
        .collect()
}

/// Returns the points of a line, an arc and a line.
fn curve(
    before: &[(f32, f32)],
    center: (f32, f32),
    radius: f32,
    from: f32,
    to: f32,
    after: &[(f32, f32)],
) -> Vec<(f32, f32)> {
    before
        .iter()
        .copied()
        .chain(arc(center, radius, from, to))
        .chain(after.iter().copied())
        .collect()
}
