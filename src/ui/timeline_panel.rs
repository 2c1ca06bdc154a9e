//! The bottom panel: what happens in time.

use super::kit::{self, Curves, Moment, Part, Series, Stripe, Timeline, TimelineEvent, Track};
use super::labs::make::made_name;
use super::labs::match_::drive_panel_ui;
use super::labs::transition;
use super::language::say;
use super::out::Out;
use super::state::{Layout, UiState};
use super::text;
use super::theme::palette_of;
use super::transport_row::{Playhead, transport_row_ui};
use eframe::egui::{Color32, RectAlign, Ui};
use segue_motion::clip::{Motion, joint_curve};
use segue_motion::skeleton::{Role, Side};
use segue_session::choices;
use segue_session::{
    Command, CycleMade, Key, Kind, Outcome, Pane, PlacedClip, PlaybackCommand, Registered, Session,
    Slot, Value, curve_kind, frame_at, joint_of,
};
use segue_text::{Message, msg};
use std::sync::Arc;

/// The curves of the chosen joint, of every pane over each other, kept until a result or the choice
/// changes.
#[derive(Debug, Default)]
pub(crate) struct CurveCache {
    panes: Vec<(String, Arc<Outcome>)>,
    what: (String, Option<choices::Curve>),
    lines: Vec<Curve>,
}

#[derive(Debug)]
struct Curve {
    of: CurveOf,
    points: Vec<[f64; 2]>,
}

#[derive(Debug)]
enum CurveOf {
    /// One of the clips that a result was made from.
    Source(Part),
    /// The result of a pane, by its number and its name.
    Pane(usize, String),
}

/// More points than a screen is wide only cost time.
const CURVE_POINTS: usize = 900;

/// The whole panel.
pub(crate) fn timeline_panel_ui(
    session: &Session,
    layout: Layout,
    cache: &mut CurveCache,
    state: &mut UiState,
    out: &mut Out,
    ui: &mut Ui,
) {
    let params = session.params();
    let Some(outcome) = session.main_outcome() else {
        return kit::note_ui(text::EMPTY_PANE, palette_of(ui).muted, ui);
    };
    if let Some(driven) = outcome.driven() {
        return drive_panel_ui(session, outcome, driven, layout, state, out, ui);
    }
    let clip = outcome.motion.clip();
    let (joint, quantity) = (params.text(Key::Joint), params.choice::<choices::Curve>());
    let unit = unit_of(quantity);
    let role = Role::ALL.into_iter().find(|role| role.name() == joint);
    let joint_title = role.map_or_else(|| Message::data(joint), |role| role.name().into());
    let quantity_label = quantity.label();
    let caption = msg!("{joint} · {what} {unit}", joint = joint_title, what = quantity_label, unit);
    let caption = say(&caption, ui);
    let playhead = Playhead {
        secs: session.now_secs(),
        frame: frame_at(&outcome.motion, session.now_secs()),
        frames: clip.frames(),
    };
    let row = transport_row_ui(playhead, &caption, layout, session, out, ui);
    if layout != Layout::Phone {
        curve_menu_ui(outcome, &row, out, ui);
    }

    let panes = named_outcomes(session, |name| say(name, ui));
    cache.update(outcome, &panes, joint, quantity);
    let palette = palette_of(ui);
    let series: Vec<Series<'_>> = cache
        .lines
        .iter()
        .map(|Curve { of, points }| match of {
            CurveOf::Source(part) => Series {
                name: of.name(),
                color: part.fill(palette).0,
                ink: part.ink(palette),
                strong: false,
                points,
            },
            CurveOf::Pane(index, _) => Series {
                name: of.name(),
                // The first is the result that everything else on the page shows; two more are told
                // apart by light, the last by a colour that neither clip has.
                color: [palette.accent, palette.text, palette.muted, palette.others[1]][index % 4],
                ink: [palette.accent_ink, palette.text, palette.muted, palette.others[1]]
                    [index % 4],
                strong: *index == 0,
                points,
            },
        })
        .collect();
    let made_from = session.panes().first().and_then(Pane::made_from).unwrap_or(params);
    let names = [Key::A, Key::B].map(|key| {
        session
            .library()
            .find(made_from.text(key))
            .map_or_else(String::new, |entry| say(&entry.title(), ui))
    });
    let names = match outcome.walk() {
        Some(walk) => [0, 1].map(|part: usize| {
            let clip = walk.passed.get(part).map(|passed| passed.stay.clip);
            clip.and_then(|clip| walk.built.cast().names().get(clip))
                .map_or_else(String::new, |name| say(&session.clip_title(name), ui))
        }),
        None => names,
    };
    let made = made_name(made_from).map(|name| say(&name, ui));
    let round = round_name(outcome, &names);
    let tracks = if outcome.registered().is_some() {
        // The feet of both say more than their bars.
        Vec::new()
    } else if let Some(made) = &made {
        vec![whole_track(Part::Result, made, outcome)]
    } else if outcome.cycle.is_some() {
        vec![whole_track(Part::Result, &round, outcome)]
    } else {
        tracks(outcome, &names)
    };
    let curves = Curves {
        title: quantity.label(),
        unit,
        decimals: 2,
        include: (quantity != choices::Curve::Turn).then_some(0.0),
        series: &series,
    };
    let mut seams = seams(outcome, palette.accent);
    seams.extend(hard_turns(outcome, palette.warning));
    let feet = feet_names(session, layout, ui);
    let stripes = stripes(session, &feet);
    let timeline = Timeline {
        duration: session.duration_secs(),
        now: session.now_secs(),
        fps: clip.fps(),
        tracks: &tracks,
        stripes: &stripes,
        transition: outcome.transition.map(|transition| transition.start_secs..transition.end_secs),
        transition_editable: session.panes().len() == 1 && outcome.walk().is_none(),
        // Left to Segue they stand at the ends, to be taken hold of.
        in_point: Some(params.optional(Key::In).unwrap_or(0.0)),
        out_point: Some(params.optional(Key::Out).unwrap_or(session.duration_secs())),
        moments: &seams,
        curves: (layout != Layout::Phone).then_some(curves),
    };
    for event in kit::timeline_ui(&timeline, ui) {
        timeline_event(event, session, outcome, out);
    }
}

fn timeline_event(event: TimelineEvent, session: &Session, outcome: &Outcome, out: &mut Out) {
    let (params, fps) = (session.params(), outcome.motion.clip().fps());
    let in_transition = transition::is_open(session);
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
        // At the ends they mark nothing.
        TimelineEvent::SetIn(secs) if at_end(0.0, secs) => out.set(Key::In, Value::Auto),
        TimelineEvent::SetOut(secs) if at_end(session.duration_secs(), secs) => {
            out.set(Key::Out, Value::Auto);
        }
        TimelineEvent::Seek(secs) => {
            out.commands.push(Command::Playback(PlaybackCommand::Seek(secs)))
        }
        TimelineEvent::ScrubStarted => out.set(Key::Play, Value::Switch(false)),
        TimelineEvent::SetIn(secs) => out.set(Key::In, Value::Number(secs)),
        TimelineEvent::SetOut(secs) => out.set(Key::Out, Value::Number(secs)),
        TimelineEvent::SetTransitionStart(secs) if outcome.registered().is_some() => {
            out.set(Key::WarpFrom, Value::Number(secs.max(0.0)));
        }
        TimelineEvent::SetTransitionEnd(secs) if outcome.registered().is_some() => {
            // The end is a time of A, whose clock is bent until then.
            if let Some(beat) = outcome.registered().and_then(|registered| registered.beat_at(secs))
            {
                out.set(Key::WarpTo, Value::Number((beat.frames[0] / fps).max(0.0)));
            }
        }
        TimelineEvent::SetTransitionStart(secs) if in_transition => {
            out.set(Key::MixFrameA, Value::Number((secs * fps).round().max(0.0)));
        }
        TimelineEvent::SetTransitionStart(secs) => {
            // The result runs on A's time up to the window.
            out.set(Key::LeaveA, Value::Number(secs.max(0.0)));
        }
        TimelineEvent::SetTransitionEnd(secs) => {
            let (start, end) =
                outcome.transition.map_or((0.0, 0.0), |found| (found.start_secs, found.end_secs));
            let wanted = secs - start;
            // What sets how long it takes depends on the method.
            let (key, value) = match params.choice::<choices::TransitionMethod>() {
                _ if !in_transition => (Key::BlendWindow, wanted * fps),
                choices::TransitionMethod::Cubic
                | choices::TransitionMethod::Quintic
                | choices::TransitionMethod::Dead => (Key::BlendTime, wanted),
                choices::TransitionMethod::Inertialize => (
                    Key::HalfLife,
                    params.number(Key::HalfLife) * wanted / (end - start).max(1.0 / fps),
                ),
                choices::TransitionMethod::Cut => return,
                choices::TransitionMethod::Smooth | choices::TransitionMethod::Linear => {
                    (Key::BlendWindow, wanted * fps)
                }
            };
            if let Kind::Number { min, max, .. } = key.param().kind {
                out.set(key, Value::Number(value.clamp(min, max)));
            }
        }
        TimelineEvent::ScrubEnded | TimelineEvent::EditStarted => {}
        TimelineEvent::EditEnded => out.commands.push(Command::Settle),
    }
}

/// What goes round, in a word.
fn round_name(outcome: &Outcome, [a, b]: &[String; 2]) -> String {
    match outcome.cycle.map(|cycle| cycle.made) {
        Some(CycleMade::Gait { facts, .. }) => format!("{a} ~ {b} · {:.2} m/s", facts.speed_mps),
        Some(CycleMade::Cut { .. }) => a.clone(),
        None => String::new(),
    }
}

/// Where each further cycle begins.
fn seams(outcome: &Outcome, color: Color32) -> Vec<Moment<'static>> {
    let Some(cycle) = outcome.cycle.filter(|cycle| cycle.secs > 0.0) else {
        return Vec::new();
    };
    let count = (outcome.duration_secs() / cycle.secs).round() as usize;
    let seam =
        |round: usize| Moment { time: round as f64 * cycle.secs, color, name: text::CYCLE_BEGINS };
    (1..count).map(seam).collect()
}

/// Where the path turns harder than the motion can.
fn hard_turns(outcome: &Outcome, color: Color32) -> impl Iterator<Item = Moment<'static>> {
    let fps = outcome.motion.clip().fps();
    let turns = outcome.path().into_iter().flat_map(|path| &path.hard_turns);
    turns.map(move |turn| Moment { time: turn.worst as f64 / fps, color, name: text::HARD_MOMENT })
}

/// What stands before the stripes of each pane's feet: A, B, result. A phone has room for one pane.
fn feet_names(session: &Session, layout: Layout, ui: &Ui) -> Vec<[String; 3]> {
    let panes = session.panes();
    let shown = if layout == Layout::Phone { 1 } else { panes.len() };
    let names = |pane: &Pane| {
        let value = pane
            .variant
            .as_ref()
            .filter(|_| panes.len() > 1)
            .map(|(key, value)| key.param().spoken(value));
        [text::FEET_OF_A, text::FEET_OF_B, text::FEET_OF_RESULT].map(|of| {
            let name = match &value {
                Some(value) => msg!("{of} · {value}", of, value = value.clone()),
                None => of.into(),
            };
            say(&name, ui)
        })
    };
    panes.iter().take(shown).map(names).collect()
}

/// The feet of A, of B and of the result under each other, in the result's time; pane by pane.
fn stripes<'a>(session: &Session, names: &'a [[String; 3]]) -> Vec<Stripe<'a>> {
    let of = [(Part::A, Some(Slot::A)), (Part::B, Some(Slot::B)), (Part::Result, None)];
    let panes = session.panes().iter().zip(names);
    let registered =
        panes.filter_map(|(pane, names)| Some((pane.outcome.as_ref()?.registered()?, names)));
    registered
        .flat_map(|(registered, names)| {
            of.into_iter().zip(names).map(|((part, slot), label)| Stripe {
                part,
                label,
                feet: Side::BOTH.map(|side| registered.stances(slot, side)),
            })
        })
        .collect()
}

/// One clip that is all there is.
fn whole_track<'a>(part: Part, name: &'a str, outcome: &Outcome) -> Track<'a> {
    Track {
        part,
        label: "",
        name,
        start: 0.0,
        end: outcome.duration_secs(),
        fade_in: 0.0,
        fade_out: 0.0,
    }
}

fn tracks<'a>(outcome: &Outcome, names: &'a [String; 2]) -> Vec<Track<'a>> {
    let duration = outcome.duration_secs();
    let Some(transition) = outcome.transition else {
        let a = whole_track(Part::A, &names[0], outcome);
        if outcome.layer().is_none() {
            return vec![a];
        }
        let b = whole_track(Part::B, &names[1], outcome);
        return vec![Track { label: "A", ..a }, Track { label: "B", ..b }];
    };
    let fade = transition.end_secs - transition.start_secs;
    let track = |part, name, start, end, fade_in, fade_out| Track {
        part,
        label: "",
        name,
        start,
        end,
        fade_in,
        fade_out,
    };
    vec![
        Track {
            label: "A",
            ..track(Part::A, names[0].as_str(), 0.0, transition.end_secs, 0.0, fade)
        },
        Track {
            label: "B",
            ..track(Part::B, names[1].as_str(), transition.start_secs, duration, fade, 0.0)
        },
    ]
}

/// The results of all panes, with what tells them apart.
fn named_outcomes(
    session: &Session,
    say: impl Fn(&Message) -> String,
) -> Vec<(String, &Arc<Outcome>)> {
    let named = session.panes().iter().filter_map(|pane| {
        let name = session.variant_name(pane).unwrap_or_else(|| text::RESULT.into());
        Some((say(&name), pane.outcome.as_ref()?))
    });
    named.collect()
}

impl CurveOf {
    /// Its name beside the plot.
    fn name(&self) -> &str {
        match self {
            Self::Source(part) => part.letter(),
            Self::Pane(_, name) => name,
        }
    }
}

impl CurveCache {
    fn update(
        &mut self,
        main: &Arc<Outcome>,
        panes: &[(String, &Arc<Outcome>)],
        joint: &str,
        quantity: choices::Curve,
    ) {
        let shown = panes.iter().map(|(name, outcome)| (name, *outcome));
        let known = self.panes.iter().map(|(name, outcome)| (name, outcome));
        let same = shown.len() == known.len()
            && shown.zip(known).all(|(a, b)| a.0 == b.0 && Arc::ptr_eq(a.1, b.1));
        if same && self.what.0 == joint && self.what.1 == Some(quantity) {
            return;
        }
        self.panes =
            panes.iter().map(|(name, outcome)| (name.clone(), Arc::clone(outcome))).collect();
        self.what = (joint.to_owned(), Some(quantity));
        self.lines.clear();
        let end = main.duration_secs();
        for source in &main.sources {
            let part = if source.slot == Slot::A { Part::A } else { Part::B };
            if let Some(registered) = main.registered() {
                self.lines.push(Curve {
                    of: CurveOf::Source(part),
                    points: registered_curve(source, registered, joint, quantity),
                });
                continue;
            }
            // Sources are shown where they can be compared with the result.
            let window = main.transition.map_or(0.0..end, |transition| {
                let margin = (transition.end_secs - transition.start_secs).max(0.25);
                transition.start_secs - margin..transition.end_secs + margin
            });
            let mut points = curve(&source.motion, joint, quantity, source.starts_at_secs);
            points.retain(|point| window.contains(&point[0]) && (0.0..=end).contains(&point[0]));
            self.lines.push(Curve { of: CurveOf::Source(part), points });
        }
        let results = panes.iter().enumerate().map(|(index, (name, outcome))| Curve {
            of: CurveOf::Pane(index, name.clone()),
            points: curve(&outcome.motion, joint, quantity, 0.0),
        });
        self.lines.extend(results);
    }
}

fn curve(
    motion: &Motion,
    joint: &str,
    quantity: choices::Curve,
    starts_at_secs: f64,
) -> Vec<[f64; 2]> {
    let Some(joint) = joint_of(motion, joint) else {
        return Vec::new();
    };
    let values = joint_curve(motion.clip(), joint, curve_kind(quantity));
    let stride = values.len().div_ceil(CURVE_POINTS).max(1);
    let fps = motion.clip().fps();
    values
        .iter()
        .enumerate()
        .step_by(stride)
        .map(|(frame, &value)| [starts_at_secs + frame as f64 / fps, f64::from(value)])
        .collect()
}

/// The curve of a source in the result's time: what it has in the frames that the result is made
/// of.
fn registered_curve(
    source: &PlacedClip,
    registered: &Registered,
    joint: &str,
    quantity: choices::Curve,
) -> Vec<[f64; 2]> {
    let Some(joint) = joint_of(&source.motion, joint) else {
        return Vec::new();
    };
    let values = joint_curve(source.motion.clip(), joint, curve_kind(quantity));
    let (fps, clip) = (registered.map.fps(), usize::from(source.slot == Slot::B));
    let stride = registered.beats.len().div_ceil(CURVE_POINTS).max(1);
    let beats = registered.beats.iter().enumerate().step_by(stride);
    beats
        .filter(|(_, beat)| beat.frames[clip] > -0.5)
        .filter_map(|(frame, beat)| {
            let value = values.get(beat.frames[clip].round() as usize)?;
            Some([frame as f64 / fps, f64::from(*value)])
        })
        .collect()
}

fn unit_of(quantity: choices::Curve) -> &'static str {
    match quantity {
        choices::Curve::Height => "m",
        choices::Curve::Angle => "°",
        choices::Curve::Turn => "°/s",
        choices::Curve::Speed => "m/s",
    }
}

/// Which joint and what of it: a menu on the caption.
fn curve_menu_ui(outcome: &Outcome, row: &eframe::egui::Response, out: &mut Out, ui: &mut Ui) {
    let rect = eframe::egui::Rect::from_min_max(
        eframe::egui::pos2(row.rect.right() - 220.0, row.rect.top()),
        row.rect.max,
    );
    let opener = ui.interact(rect, ui.scope_id().with("curve menu"), eframe::egui::Sense::click());
    opener.widget_info(|| {
        eframe::egui::WidgetInfo::labeled(eframe::egui::Role::ComboBox, true, text::CURVES)
    });
    kit::menu_ui(&opener, RectAlign::TOP_END, |ui| {
        if let Kind::Choice(choices) = Key::Curve.param().kind {
            for choice in choices {
                if kit::menu_item_ui(
                    kit::MenuItem { text: choice.label, ..kit::MenuItem::default() },
                    ui,
                )
                .clicked()
                {
                    out.set_once(Key::Curve, Value::Choice(choice.key));
                }
            }
        }
        kit::menu_line_ui(ui);
        eframe::egui::ScrollArea::vertical().max_height(320.0).show(ui, |ui| {
            for role in
                Role::ALL.into_iter().filter(|&role| outcome.motion.roles().get(role).is_some())
            {
                if kit::menu_item_ui(
                    kit::MenuItem { text: role.name(), ..kit::MenuItem::default() },
                    ui,
                )
                .clicked()
                {
                    out.set_once(Key::Joint, Value::Text(role.name().to_owned()));
                }
            }
        });
    });
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_results_of_all_panes_are_drawn_over_each_other() {
        let mut session = Session::new();
        session
            .apply(Command::OpenLink(
                "lab=transition&compare=method:inertialize,smooth,dead".into(),
            ))
            .unwrap();
        while session.work() {}
        let panes = named_outcomes(&session, Message::to_string);
        let mut cache = CurveCache::default();
        cache.update(session.main_outcome().unwrap(), &panes, "right foot", choices::Curve::Angle);
        let names: Vec<&str> = cache.lines.iter().map(|line| line.of.name()).collect();
        assert_eq!(names, ["A", "B", "inertialize", "dissolve, smooth", "dead blend"]);
        let results = &cache.lines[2..];
        let length = |line: &Curve| line.points.len();
        assert!(results.iter().all(|line| length(line) > 100));
        // They part in the transition, and nowhere before.
        assert_eq!(results[0].points[..20], results[1].points[..20]);
        assert!(
            results[0]
                .points
                .iter()
                .zip(&results[1].points)
                .any(|(a, b)| (a[1] - b[1]).abs() > 1.0)
        );
    }
}
