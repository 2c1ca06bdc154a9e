//! A page of the kit's widgets that computes nothing.

use crate::ui::kit::timeline::Moment;
use crate::ui::kit::*;
use crate::ui::language::{Text, Word};
use crate::ui::theme::{Palette, Type, palette_of, space, theme_of};
use eframe::egui::{
    self, Align, CentralPanel, Frame, Layout, Margin, Panel, Rect, RectAlign, ScrollArea, Shape,
    Stroke, Ui, Vec2, pos2, vec2,
};
use segue_text::Message;

/// The state of the mock between frames.
#[derive(Clone, Debug)]
#[expect(
    clippy::struct_excessive_bools,
    reason = "switches that have nothing to do with each other"
)]
pub(super) struct Mock {
    lab: usize,
    mode: usize,
    curve: usize,
    pub(super) window: f64,
    leave: f64,
    half_life: f64,
    align: bool,
    now: f64,
    playing: bool,
    space: usize,
    pub(super) caption: bool,
    pub(super) notices: bool,
    transition: (f64, f64),
    events: Vec<TimelineEvent>,
}

impl Default for Mock {
    fn default() -> Self {
        Self {
            lab: 2,
            mode: 1,
            curve: 0,
            window: 30.0,
            leave: 2.93,
            half_life: 0.27,
            align: true,
            now: 2.93,
            playing: false,
            space: 0,
            caption: true,
            notices: false,
            transition: (2.6, 3.5),
            events: Vec::new(),
        }
    }
}

const LABS: [(usize, Word); 10] = [
    (0, Word::new("View")),
    (1, Word::new("Make")),
    (2, Word::new("Blend")),
    (3, Word::new("Transition")),
    (4, Word::new("Speed")),
    (5, Word::new("Loop")),
    (6, Word::new("Warp")),
    (7, Word::new("Graph")),
    (8, Word::new("Path")),
    (9, Word::new("Match")),
];

const CLIPS: [(&str, &str, Part, &str); 5] = [
    ("walk", "3.9 s · 120 fps · 30 joints", Part::A, ""),
    ("run", "1.4 s · 120 fps · 30 joints", Part::B, ""),
    ("walk, turn left", "4.3 s · 120 fps", Part::None, ""),
    ("idle", "3.3 s · 60 fps", Part::None, ""),
    (
        "pirouette",
        "4.9 s · 120 fps · T-pose dropped",
        Part::None,
        "The first frame is a T-pose and was left out.",
    ),
];

pub(super) fn lab_ui(mock: &mut Mock, ui: &mut Ui) {
    let theme = theme_of(ui);
    let phone = ui.available_width() < 600.0;
    let plain = |p: &Palette| Frame::new().fill(p.panel);
    let p = theme.palette();
    Panel::top("top")
        .frame(plain(p).inner_margin(Margin::symmetric(16, 8)))
        .show_separator_line(true)
        .show(ui, |ui| top_ui(mock, phone, ui));
    if phone {
        Panel::bottom("params").exact_size(300.0).frame(plain(p).inner_margin(16)).show(ui, |ui| {
            ScrollArea::vertical().show(ui, |ui| parameters_ui(mock, ui));
        });
        Panel::bottom("time")
            .exact_size(152.0)
            .frame(plain(p).inner_margin(Margin::symmetric(16, 10)))
            .show(ui, |ui| time_ui(mock, phone, ui));
    } else {
        let height = 232.0 * theme.scale();
        let frame = plain(p).inner_margin(Margin { left: 16, right: 16, top: 10, bottom: 12 });
        Panel::bottom("time")
            .exact_size(height)
            .frame(frame)
            .show(ui, |ui| time_ui(mock, phone, ui));
        let library = plain(p).inner_margin(Margin::symmetric(8, 12));
        Panel::left("library")
            .exact_size(232.0 * theme.scale())
            .resizable(false)
            .frame(library)
            .show(ui, |ui| ScrollArea::vertical().show(ui, |ui| library_ui(mock, ui)));
        let parameters = plain(p).inner_margin(Margin::symmetric(16, 12));
        Panel::right("parameters")
            .exact_size(292.0 * theme.scale())
            .resizable(false)
            .frame(parameters)
            .show(ui, |ui| {
                ScrollArea::vertical().show(ui, |ui| parameters_ui(mock, ui));
            });
    }
    CentralPanel::default()
        .frame(Frame::new().fill(p.ground))
        .show(ui, |ui| stage_ui(mock, phone, ui));
}

fn top_ui(mock: &mut Mock, phone: bool, ui: &mut Ui) {
    let p = palette_of(ui);
    ui.horizontal(|ui| {
        let scale = theme_of(ui).scale();
        let (_, logo) = ui.allocate_space(vec2(22.0, 18.0) * scale);
        paint_logo(logo, p.a, p.b, ui.painter());
        let name =
            paint::line_of(&[paint::Run::new(Word::new("Segue"), Type::Title, p.text)], 200.0, ui);
        let (_, at) = ui.allocate_space(name.size());
        paint::put(ui.painter(), at.left_center(), egui::Align2::LEFT_CENTER, name);
        ui.add_space(space::S);
        let buttons = if phone { 130.0 } else { 430.0 * scale };
        let width = ui.available_width() - buttons;
        if let Some(lab) =
            tabs_ui([Word::new("Lab"), Word::new("More labs")], mock.lab, &LABS, width, ui)
        {
            mock.lab = lab;
        }
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            button_ui(
                Button::new(Text::Data(if phone { "Link" } else { "Copy link" }))
                    .primary()
                    .icon(Icon::Link),
                ui,
            );
            if phone {
                icon_button_ui(Icon::Menu, Word::new("Menu"), ui);
            } else {
                icon_button_ui(Icon::Contrast, Word::new("Dark or light"), ui);
                icon_button_ui(Icon::Redo, Word::new("Redo"), ui);
                icon_button_ui(Icon::Undo, Word::new("Undo"), ui);
                button_ui(Button::new(Word::new("Lessons")), ui);
                let compare = button_ui(
                    Button::new(Word::new("Compare · 3")).trailing(Icon::ChevronDown),
                    ui,
                );
                menu_ui(&compare, RectAlign::BOTTOM_END, |ui| {
                    menu_item_ui(
                        MenuItem {
                            text: Word::new("Three windows").into(),
                            chosen: Some(true),
                            ..MenuItem::default()
                        },
                        ui,
                    );
                    menu_item_ui(
                        MenuItem {
                            text: Word::new("Three methods").into(),
                            shortcut: Word::new("⇧3").into(),
                            ..MenuItem::default()
                        },
                        ui,
                    );
                    menu_line_ui(ui);
                    menu_item_ui(
                        MenuItem {
                            text: Word::new("Only one pane").into(),
                            icon: Some(Icon::Close),
                            ..MenuItem::default()
                        },
                        ui,
                    );
                });
            }
        });
    });
}

fn library_ui(_mock: &mut Mock, ui: &mut Ui) {
    ui.spacing_mut().item_spacing.y = 2.0;
    ui.horizontal(|ui| {
        ui.add_space(space::S);
        ui.vertical(|ui| section_header_ui(Word::new("Library"), ui));
    });
    let actions = [(Icon::Pencil, Word::new("Rename")), (Icon::Trash, Word::new("Remove"))];
    for (index, (name, detail, part, warning)) in CLIPS.into_iter().enumerate() {
        let names = ["A", "B"].map(|slot| format!("Use {name} as {slot}"));
        let letter = |slot: Part, name| SlotLetter { part: slot, held: part == slot, name };
        let letters =
            [letter(Part::A, Text::Data(&names[0])), letter(Part::B, Text::Data(&names[1]))];
        clip_row_ui(
            ClipRow {
                name: Text::Data(name),
                detail: Text::Data(detail),
                more: Text::EMPTY,
                letters: &letters,
                warning: Text::Data(warning),
                open: index == 2,
                picked: index == 3,
                actions: &actions,
            },
            ui,
        );
    }
    ui.add_space(space::M);
    ui.scope(|ui| {
        drop_zone_ui(
            Word::new("Drop BVH, ASF + AMC, GLB"),
            &[&[
                DropButton { text: Word::new("Open files…"), is_main: true, is_open: false },
                DropButton { text: Word::new("Samples"), is_main: false, is_open: false },
            ]],
            false,
            ui,
        );
    });
    ui.add_space(space::M);
    progress_row_ui(Word::new("Distance matrix"), Some(0.62), Word::new("1,240 of 2,000"), ui);
}

fn parameters_ui(mock: &mut Mock, ui: &mut Ui) {
    ui.spacing_mut().item_spacing.y = space::S;
    section_header_ui(Word::new("Blend"), ui);
    if let Some(mode) = segmented_ui(
        Word::new("Method"),
        mock.mode,
        &[(0, Word::new("cut")), (1, Word::new("dissolve")), (2, Word::new("inertialize"))],
        ui,
    ) {
        mock.mode = mode;
    }
    ui.add_space(space::XS);
    let seconds = format!("{:.2} s", mock.window / 60.0);
    let p = palette_of(ui);
    let marks = [Mark { value: 15.0, color: p.muted }, Mark { value: 10.0, color: p.muted }];
    let row = SliderRow::new(Word::new("Blend window"), 1.0..=60.0, 15.0)
        .whole()
        .unit(Word::new("frames"))
        .secondary(&seconds)
        .marks(&marks);
    let row = row.help(Word::new("How long A fades into B. Longer is smoother but slower to respond; shorter is snappier but pops."));
    mock.window = slider_row_ui(mock.window, &row, ui).changed.unwrap_or(mock.window);
    let row =
        SliderRow::new(Word::new("Leave A at"), 0.0..=3.9, 2.0).step(0.01).unit(Word::new("s"));
    mock.leave = slider_row_ui(mock.leave, &row, ui).changed.unwrap_or(mock.leave);
    let row = SliderRow::new(Word::new("Enter B at"), 0.0..=1.4, 0.2)
        .step(0.01)
        .unit(Word::new("s"))
        .source(Source::Auto);
    slider_row_ui(
        0.13,
        &row.help(Word::new("Found automatically: best match of both windows, 4.1 cm.")),
        ui,
    );
    let row = SliderRow::new(Word::new("Half-life"), 0.02..=2.0, 0.2)
        .step(0.01)
        .unit(Word::new("s"))
        .log();
    mock.half_life = slider_row_ui(mock.half_life, &row, ui).changed.unwrap_or(mock.half_life);
    if let Some(curve) = segmented_ui(
        Word::new("Curve"),
        mock.curve,
        &[(0, Word::new("smooth")), (1, Word::new("linear")), (2, Word::new("smoother"))],
        ui,
    ) {
        mock.curve = curve;
    }
    ui.add_space(space::XS);
    ui.spacing_mut().item_spacing.y = 2.0;
    if let Some(on) = switch_row_ui(Word::new("Align to A"), mock.align, ui) {
        mock.align = on;
    }
    switch_row_ui(Word::new("Blend root by velocity"), true, ui);
    switch_row_ui(Word::new("Foot lock"), false, ui);
    ui.add_space(space::XS);
    if let Some(space) = choice_row_ui(
        Word::new("Blend in"),
        mock.space,
        &[
            (0, Word::new("joint rotations")),
            (1, Word::new("world space")),
            (2, Word::new("exponential map")),
        ],
        ui,
    ) {
        mock.space = space;
    }
    ui.add_space(space::S);
    ui.horizontal(|ui| {
        button_ui(Button::new(Word::new("Swap")).icon(Icon::Swap), ui);
        button_ui(Button::new(Word::new("Reset")).quiet().icon(Icon::Undo), ui);
        button_ui(Button::icon_only(Icon::Trash, Word::new("Remove")).quiet(), ui);
    });
}

fn stage_ui(mock: &Mock, phone: bool, ui: &mut Ui) {
    let p = palette_of(ui);
    let stage = ui.available_rect_before_wrap();
    let panes = [
        ("30", "0.50 s", Word::new("smoothest"), Mood::Good),
        ("15", "0.25 s", Word::default(), Mood::Plain),
        ("10", "0.17 s", Word::new("roughest"), Mood::Bad),
    ];
    let count = if phone { 1 } else { 3 };
    let width = (stage.width() / count as f32).floor();
    for (index, (strong, secondary, chip, mood)) in panes.into_iter().take(count).enumerate() {
        let pane = Rect::from_min_size(
            pos2(stage.left() + index as f32 * width, stage.top()),
            vec2(width, stage.height()),
        );
        mock_picture(pane, ui);
        if index > 0 {
            ui.painter().vline(pane.left(), pane.y_range(), Stroke::new(1.0, p.line));
        }
        let (strong, secondary) = (Message::data(strong), Message::data(secondary));
        let text = Message::word("frames");
        let title = PaneTitle { strong: &strong, text: &text, secondary: &secondary, chip, mood };
        pane_header_ui(&title, pane, ui);
        let rank = [Rank::Best, Rank::Middle, Rank::Worst][index];
        let metric = |value: &'static str, unit, name, rank| Metric {
            value,
            unit: Word::new(unit),
            name: Word::new(name),
            short: Word::new(name),
            rank,
            ..Metric::default()
        };
        let metrics = [
            metric(["41", "126", "214"][index], "°/s", "Velocity jump", rank),
            metric(["0.6", "0.9", "1.8"][index], "cm", "Foot slide", Rank::Middle),
            metric(["0.38", "0.19", "0.12"][index], "s", "Lag", Rank::Middle),
            metric("0°", "", "Spin", Rank::Middle),
        ];
        let names = metrics.map(|metric| (metric.short, metric.unit));
        let room = GridRoom {
            width: width - 2.0 * space::M,
            rows: 2,
            is_ranked: count > 1,
            least_height: 0.0,
        };
        let grid = MetricGrid::new(&names, room, ui);
        let strip = pane.with_min_y(pane.bottom() - grid.height() - 2.0 * space::S);
        ui.painter().rect_filled(strip, 0.0, p.panel);
        for (at, metric) in metrics.iter().take(grid.shown).enumerate() {
            let rect = grid.place(at, strip.min + vec2(space::M, space::S));
            metric_cell_ui(metric, rect, ui.scope_id().with((index, at)), ui);
        }
    }
    if mock.caption && !phone {
        let free = stage.with_min_y(stage.top() + pane_header_height(ui) + space::S);
        caption_ui(
            Word::new(
                "Same walk, same instant. Watch the right foot: the shorter the window, the harder the burst into the run.",
            ),
            free,
            ui,
        );
    }
    if mock.notices {
        let read = Message::word("walk.bvh was read: 470 frames.");
        let long = "pirouette.bvh: 3 of 4,712 numbers could not be read and were taken from the frame before. The rest is as it was recorded.";
        let long = Message::word(long);
        let notices = [
            Notice { text: &read, mood: Mood::Good, action: Word::default() },
            Notice { text: &long, mood: Mood::Warning, action: Word::new("Show the lines") },
        ];
        let chip = NoticeChip {
            text: &Message::word("2 notes"),
            mood: Mood::Warning,
            news: &long,
            is_alert: true,
            row: Rect::from_min_size(stage.min, vec2(220.0, 24.0)),
            heading_end: stage.left(),
        };
        notices_ui(&chip, &notices, ui);
    }
}

/// Draws a rough ground and body below the overlays.
fn mock_picture(pane: Rect, ui: &Ui) {
    let stage = &palette_of(ui).stage;
    let painter = ui.painter().with_clip_rect(pane);
    painter.add(Shape::gradient_rect(pane, egui::Direction::TopDown, [stage.sky, stage.horizon]));
    let horizon = pane.top() + 0.55 * pane.height();
    for i in -8..=8_i8 {
        let x = pane.center().x + f32::from(i) * 30.0;
        let far = pos2(x, horizon);
        let near = pos2(pane.center().x + f32::from(i) * 120.0, pane.bottom());
        painter.line_segment([far, near], Stroke::new(1.0, stage.grid));
    }
    let limb = |from: Vec2, to: Vec2, radius: f32, color| {
        let at = |v: Vec2| pane.center() + v * pane.height() / 560.0;
        painter.line_segment([at(from), at(to)], Stroke::new(2.0 * radius, color));
        painter.circle_filled(at(from), radius, color);
        painter.circle_filled(at(to), radius, color);
    };
    for (dx, color) in [
        (90.0, palette_of(ui).a.gamma_multiply(0.4)),
        (-120.0, palette_of(ui).b.gamma_multiply(0.4)),
        (0.0, stage.clay),
    ] {
        let d = vec2(dx, 0.0);
        limb(d + vec2(0.0, -150.0), d + vec2(4.0, -130.0), 20.0, color);
        limb(d + vec2(4.0, -90.0), d + vec2(8.0, 0.0), 26.0, color);
        limb(d + vec2(8.0, 10.0), d + vec2(40.0, 90.0), 15.0, color);
        limb(d + vec2(40.0, 90.0), d + vec2(90.0, 170.0), 11.0, color);
        limb(d + vec2(0.0, 10.0), d + vec2(-40.0, 100.0), 15.0, color);
        limb(d + vec2(-40.0, 100.0), d + vec2(-50.0, 190.0), 11.0, color);
    }
}

fn time_ui(mock: &mut Mock, phone: bool, ui: &mut Ui) {
    let p = palette_of(ui);
    ui.spacing_mut().item_spacing.y = space::S;
    let transport = Transport {
        playing: mock.playing,
        repeat: true,
        speed: 0.25,
        now: mock.now,
        frame: (mock.now * 120.0).round() as usize,
        frames: 612,
        caption: if phone {
            Word::new("A walk → B run").into()
        } else {
            Word::new("right foot · speed").into()
        },
    };
    match transport_ui(&transport, ui) {
        Some(TransportEvent::SetPlaying(playing)) => mock.playing = playing,
        Some(TransportEvent::Step(frames)) => mock.now += f64::from(frames) / 120.0,
        _ => {}
    }
    let (from, to) = mock.transition;
    let tracks = [
        Track {
            part: Part::A,
            label: Word::new("A walk").into(),
            name: Word::new("walk").into(),
            start: 0.0,
            end: to,
            fade_in: 0.0,
            fade_out: to - from,
        },
        Track {
            part: Part::B,
            label: Word::new("B run").into(),
            name: Word::new("run").into(),
            start: from,
            end: 5.8,
            fade_in: to - from,
            fade_out: 0.0,
        },
    ];
    let wave = |rate: f64, phase: f64, range: std::ops::Range<f64>| -> Vec<[f64; 2]> {
        (0..=580_u32)
            .map(|i| f64::from(i) / 100.0)
            .filter(|t| range.contains(t))
            .map(|t| [t, 1.4 + (t * rate + phase).sin()])
            .collect()
    };
    let (a, b) = (wave(4.3, 0.4, 0.0..to), wave(6.6, 1.2, from..6.0));
    let mix = |t: f64| ((t - from) / (to - from)).clamp(0.0, 1.0);
    let blend = |&[t, _]: &[f64; 2]| {
        let (one, other) = (1.4 + (t * 4.3 + 0.4).sin(), 1.4 + (t * 6.6 + 1.2).sin());
        [t, one + mix(t) * (other - one)]
    };
    let result: Vec<[f64; 2]> = wave(1.0, 0.0, 0.0..6.0).iter().map(blend).collect();
    let series = [
        Series {
            name: Word::new("A").into(),
            color: p.a,
            ink: p.a_ink,
            strong: false,
            is_source: true,
            points: &a,
            values: None,
        },
        Series {
            name: Word::new("B").into(),
            color: p.b,
            ink: p.b_ink,
            strong: false,
            is_source: true,
            points: &b,
            values: None,
        },
        Series {
            name: Word::new("result").into(),
            color: p.accent,
            ink: p.accent_ink,
            strong: true,
            is_source: false,
            points: &result,
            values: None,
        },
    ];
    let moments = [
        Moment { time: 1.2, color: p.muted, name: Word::new("foot planted") },
        Moment { time: 3.05, color: p.bad, name: Word::new("foot slides") },
    ];
    let curves = Curves {
        title: Word::new("speed"),
        unit: Word::new("m/s"),
        decimals: 2,
        include: Some(0.0),
        series: &series,
        ..Curves::default()
    };
    let curves = [curves];
    let timeline = Timeline {
        duration: 5.8,
        now: mock.now,
        fps: 120.0,
        tracks: &tracks,
        stripes: &[],
        transition: Some(from..to),
        transition_editable: true,
        in_point: None,
        out_point: None,
        moments: &moments,
        curves: if phone { &[] } else { &curves },
    };
    for event in timeline_ui(&timeline, ui).events {
        match event {
            TimelineEvent::Seek(time) => mock.now = time,
            TimelineEvent::SetTransitionStart(time) => mock.transition.0 = time,
            TimelineEvent::SetTransitionEnd(time) => mock.transition.1 = time,
            _ => {}
        }
        mock.events.push(event);
    }
}
