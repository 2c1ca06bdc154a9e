//! The parameters of graph and walk.

use super::clips::{add_clip, set_clips};
use super::jump::{close_jump, no_way, shows_jump};
use super::{map, table};
use crate::ui::kit::{self, Button, Histogram, Icon};
use crate::ui::language::{Text, Word, say};
use crate::ui::out::{Action, Out};
use crate::ui::rows::{
    Detail, add_clip_ui, clip_list_ui, clip_sets_ui, compare_ui, foot_rows_ui, param_row_ui,
    retarget_rows_ui,
};
use crate::ui::state::UiState;
use crate::ui::text;
use crate::ui::theme::{Type, palette_of, space, theme_of};
use eframe::egui::{Align, Id, Layout as Flow, RichText, Ui};
use petgraph::graph::NodeIndex;
use segue_session::JobKind;
use segue_session::LabId;
use segue_session::choices;
use segue_session::{BuiltGraph, Command, Key, List, Session, Value, link};
use segue_text::{Message, msg};
use std::sync::Arc;

/// Draws the rows of the lab.
pub(crate) fn graph_ui(session: &Session, state: &mut UiState, out: &mut Out, ui: &mut Ui) {
    clip_sets_ui(session, out, ui);
    progress_ui(session, out, ui);
    if shows_jump(session)
        && kit::button_ui(Button::new(text::BACK_TO_WALK).icon(Icon::Undo).outlined(), ui).clicked()
    {
        close_jump(state, out);
    }
    if !state.labs.graph.has_map_panel {
        map::map_ui(session, f32::INFINITY, state, out, ui);
    }
    clips_ui(session, out, ui);
    ui.add_space(space::S);
    construction_ui(session, out, ui);
    ui.add_space(space::M);
    walk_ui(session, out, ui);
    ui.add_space(space::M);
    ways_ui(session, state, out, ui);
    ui.add_space(space::M);
    experiments_ui(session, out, ui);
    ui.add_space(space::M);
    if !state.labs.graph.has_map_panel || session.panes().len() < 2 {
        kit::folded_ui(text::NUMBERS, ui, |ui| table::table_ui(session, out, ui));
    }
    files_ui(session, out, ui);
}

fn progress_ui(session: &Session, out: &mut Out, ui: &mut Ui) {
    if session.graph_is_stopped() {
        if kit::button_ui(Button::new(text::GO_ON).outlined(), ui).clicked() {
            out.commands.push(Command::StopGraph(false));
        }
        return;
    }
    let Some(job) = session.jobs().into_iter().find(|job| job.kind == JobKind::BuildingGraph)
    else {
        return;
    };
    let percent = format!("{:.0} %", 100.0 * job.progress);
    if kit::progress_row_ui(text::GRAPHING, Some(job.progress as f32), Text::Data(&percent), ui) {
        out.commands.push(Command::StopGraph(true));
    }
}

/// Draws the clips, with buttons to remove one and a menu to add one.
fn clips_ui(session: &Session, out: &mut Out, ui: &mut Ui) {
    let palette = palette_of(ui);
    let ids = session.graph_clip_ids();
    let title = msg!("Clips of the graph: {count}", count = ids.len());
    let mut added = None;
    let dropped = clip_list_ui(session, ui, |ui| {
        clip_rows_ui(&title, &ids, session, out, ui);
        added = add_clip_ui(session, |entry| !ids.contains(&entry.id), ui);
    });
    if let Some(id) = added.or(dropped) {
        add_clip(id, session, out);
    }
    if let Some(words) = session.graph_clips().and_then(|graph_clips| {
        text::moved_onto_first(graph_clips, |name| session.clip_title(name))
    }) {
        kit::note_ui(&words, palette.muted, ui);
    }
    if let Some(clips) = session.graph_clips() {
        let moved: Vec<_> = (clips.names().iter().enumerate())
            .filter_map(|(clip, name)| {
                let errors = clips.retargeted(clip)?.errors.as_ref()?;
                Some((Some(session.clip_title(name)), errors))
            })
            .collect();
        retarget_rows_ui(&moved, session, out, ui);
    }
}

/// Draws a row for each clip.
fn clip_rows_ui(title: &Message, ids: &[String], session: &Session, out: &mut Out, ui: &mut Ui) {
    let (theme, palette) = (theme_of(ui), palette_of(ui));
    kit::folded_ui(title, ui, |ui| {
        for id in ids {
            let entry = session.library().find(id);
            let name = entry.map_or_else(|| Message::data(&**id), |entry| entry.title());
            let secs =
                entry.and_then(|entry| entry.facts.as_ref()).map(|facts| facts.duration_secs());
            ui.push_id(id, |ui| {
                ui.horizontal(|ui| {
                    ui.label(
                        RichText::new(say(&name, ui))
                            .font(theme.font(Type::Label))
                            .color(palette.text),
                    );
                    ui.with_layout(Flow::right_to_left(Align::Center), |ui| {
                        let leave_out = text::leave_clip_out(name);
                        if ids.len() > 1
                            && kit::icon_button_ui(Icon::Close, &leave_out, ui).clicked()
                        {
                            let rest: Vec<String> =
                                ids.iter().filter(|other| *other != id).cloned().collect();
                            set_clips(&rest, out);
                        }
                        if let Some(secs) = secs {
                            ui.label(
                                RichText::new(say(&msg!("{secs:.1} s", secs), ui))
                                    .font(theme.font(Type::Small))
                                    .color(palette.muted),
                            );
                        }
                    });
                });
            });
        }
    });
}

fn construction_ui(session: &Session, out: &mut Out, ui: &mut Ui) {
    let params = session.params();
    let palette = palette_of(ui);
    param_row_ui(Key::Construction, &Detail::default(), session, out, ui);
    let longest = session.graph_clips().map(|graph_clips| graph_clips.set().longest() as f64);
    let window = Detail {
        max: longest.map(|longest| (longest - 2.0).max(params.number(Key::BlendWindow))),
        help: Some("How long a transition takes, and the length of the windows that are compared. Longer is smoother but slower to respond; shorter is snappier but pops.".into()),
        ..Detail::default()
    };
    param_row_ui(Key::BlendWindow, &window, session, out, ui);
    compare_ui(Key::BlendWindow, session, out, ui);
    let compared = session.compare().map(|compare| compare.key);
    if params.choice::<choices::Construction>() == choices::Construction::Segments
        || matches!(compared, Some(Key::SegmentSize | Key::Construction))
    {
        let segment = Detail {
            max: longest.map(|longest| longest.max(params.number(Key::SegmentSize))),
            ..Detail::default()
        };
        ui.push_id("segments", |ui| {
            param_row_ui(Key::SegmentSize, &segment, session, out, ui);
            compare_ui(Key::SegmentSize, session, out, ui);
        });
    }
    param_row_ui(Key::EdgeThreshold, &Detail::default(), session, out, ui);
    if let Some(field) = session.graph_field() {
        let histogram = Histogram {
            label: text::ALL_HISTOGRAM,
            counts: field.histogram(),
            bin: field.bin_cm(),
            value: params.number(Key::EdgeThreshold),
            step: 0.1,
            unit: Word::new(Key::EdgeThreshold.param().unit),
        };
        let dragged = kit::histogram_ui(&histogram, ui);
        if let Some(cm) = dragged.changed {
            out.set(Key::EdgeThreshold, Value::Number(cm.min(60.0)));
        }
        if dragged.settled {
            out.commands.push(Command::Settle);
        }
    }
    if let Some(built) = session.graph_built() {
        let walk = session.graph_walk().filter(|walk| Arc::ptr_eq(&walk.built, built));
        kit::note_ui(
            &text::graph_in_words(built, walk.and_then(|walk| walk.run_secs)),
            palette.muted,
            ui,
        );
        if let Some(words) = text::ways_left_out(built) {
            kit::note_ui(&words, palette.warning, ui);
        }
        if built.is_truncated() {
            kit::note_ui(text::GRAPH_LACKS_SOME, palette.warning, ui);
        }
    }
    param_row_ui(Key::Prune, &Detail::default(), session, out, ui);
    param_row_ui(Key::MinJump, &Detail::default(), session, out, ui);
    param_row_ui(Key::MostWaysOut, &Detail::default(), session, out, ui);
}

/// Returns the help of the seed in this lab.
pub(crate) fn seed_detail(session: &Session) -> Detail {
    let is_graph = session.params().lab() == LabId::Graph;
    Detail { help: is_graph.then(|| text::GRAPH_SEED_HELP.into()), ..Detail::default() }
}

fn walk_ui(session: &Session, out: &mut Out, ui: &mut Ui) {
    let params = session.params();
    kit::section_header_ui(text::WALK, ui);
    let plain = Detail::default();
    param_row_ui(Key::Seed, &seed_detail(session), session, out, ui);
    param_row_ui(Key::GoingOn, &plain, session, out, ui);
    let compared = session.compare().map(|compare| compare.key);
    let is_constant = params.choice::<choices::GoingOn>() == choices::GoingOn::Constant;
    if !is_constant || matches!(compared, Some(Key::GoingOn | Key::Continuity)) {
        param_row_ui(Key::Continuity, &plain, session, out, ui);
    }
    if is_constant || matches!(compared, Some(Key::GoingOn | Key::ContinuityWeight)) {
        param_row_ui(Key::ContinuityWeight, &plain, session, out, ui);
    }
    param_row_ui(Key::EdgeWeight, &plain, session, out, ui);
    if params.choice::<choices::EdgeWeight>() == choices::EdgeWeight::Exponential {
        param_row_ui(Key::EdgeSigma, &plain, session, out, ui);
    }
    param_row_ui(Key::VisitedDiscount, &plain, session, out, ui);
    param_row_ui(Key::WalkMethod, &plain, session, out, ui);
    if params.choice::<choices::WalkMethod>() == choices::WalkMethod::Inertialize {
        param_row_ui(Key::HalfLife, &plain, session, out, ui);
    } else {
        param_row_ui(Key::WeightLaw, &plain, session, out, ui);
    }
    param_row_ui(Key::AlignBy, &plain, session, out, ui);
    param_row_ui(Key::RootBlend, &plain, session, out, ui);
    foot_rows_ui(session, out, ui);
    for key in [Key::Transform, Key::Atan] {
        param_row_ui(key, &plain, session, out, ui);
    }
    param_row_ui(Key::WalkSeconds, &plain, session, out, ui);
}

/// Draws the rows that send the walk to a clip, or along a path.
fn ways_ui(session: &Session, state: &mut UiState, out: &mut Out, ui: &mut Ui) {
    let palette = palette_of(ui);
    let visits = session.graph_visits();
    if let Some(graph_clips) = session.graph_clips() {
        let reached = reached(session, ui);
        let titles: Vec<Message> =
            graph_clips.names().iter().map(|name| session.clip_title(name)).collect();
        let options: Vec<(usize, &Message)> = (titles.iter().enumerate())
            .filter(|(clip, _)| reached.get(*clip).copied().unwrap_or(true))
            .collect();
        if let Some(clip) = kit::choice_row_ui(text::GO_TO_CLIP, usize::MAX, &options, ui) {
            go_to(clip, session, out);
        }
    }
    if let Some(walk) = session.graph_walk() {
        for &missed in &walk.missed {
            let words = no_way(&walk.built, missed, session);
            kit::note_ui(&words, palette.warning, ui);
        }
    }
    if !visits.is_empty() && kit::button_ui(Button::new(text::FORGET_VISITS), ui).clicked() {
        out.reset(Key::GoTo);
    }
    let draw = Button::new(text::DRAW_PATH).selected(state.drawing.is_some());
    if kit::button_ui(draw, ui).clicked() && state.drawing.take().is_none() {
        state.drawing = Some(Vec::new());
        // The camera looks from above, far enough away for a path.
        out.commands.push(Command::Set(vec![
            (Key::Camera, choices::Camera::Top.into()),
            (Key::Follow, choices::Follow::Off.into()),
            (Key::CameraDistance, Value::Number(14.0)),
            (Key::Jump, List::Jump(None).into()),
        ]));
    }
    if state.drawing.is_some() {
        kit::note_ui(text::DRAWING, palette.accent_ink, ui);
    }
    if !session.params().ground_path().is_empty() {
        if kit::button_ui(Button::new(text::REMOVE_PATH), ui).clicked() {
            out.reset(Key::WalkPath);
        }
        if let Some(trace) = session.graph_walk().and_then(|walk| walk.followed.as_ref()) {
            kit::note_ui(&text::followed(trace), palette.muted, ui);
        }
    }
    if let Some(walk) = session.graph_walk().filter(|walk| walk.ends) {
        let words = text::dead_end(walk.motion.clip().duration_secs());
        kit::note_ui(&words, palette.warning, ui);
    }
}

/// Returns which clips the walk can reach from its present place; empty without a walk.
fn reached(session: &Session, ui: &Ui) -> Arc<Vec<bool>> {
    let at = session.graph_walk().and_then(|walk| Some((walk, walk.at(session.now_secs())?.place)));
    let Some((walk, place)) = at.filter(|(walk, _)| !walk.is_jump) else {
        return Arc::default();
    };
    // All frames of a stretch reach the same clips, and the search takes long in a large graph.
    let node = walk.built.graph().node_at(place);
    let id = Id::unique("graph reached");
    let known: Option<Reached> = ui.data(|data| data.get_temp(id));
    if let Some(known) =
        known.filter(|known| Arc::ptr_eq(&known.built, &walk.built) && known.node == node)
    {
        return known.clips;
    }
    let clips = Arc::new(walk.built.clips_from(place));
    let found = Reached { built: Arc::clone(&walk.built), node, clips: Arc::clone(&clips) };
    ui.data_mut(|data| data.insert_temp(id, found));
    clips
}

/// The clips that can be reached from a node.
#[derive(Clone)]
struct Reached {
    built: Arc<BuiltGraph>,
    node: Option<NodeIndex>,
    clips: Arc<Vec<bool>>,
}

/// Sends the walk to a clip from its present place. Later visits are dropped.
pub(crate) fn go_to(clip: usize, session: &Session, out: &mut Out) {
    let now = session.now_secs();
    let mut visits = session.graph_visits();
    visits.retain(|(secs, _)| *secs < now);
    visits.push(((now * 10.0).round() / 10.0, clip));
    out.set_once(Key::GoTo, List::Visits(visits).into());
}

fn experiments_ui(session: &Session, out: &mut Out, ui: &mut Ui) {
    kit::section_header_ui(text::EXPERIMENTS, ui);
    let params = session.params();
    for experiment in text::GRAPH_EXPERIMENTS {
        let mut values = link::read(experiment.query).values;
        let on = values.iter().all(|(key, value)| params.get(*key) == value);
        let response =
            kit::button_ui(Button::new(experiment.name).selected(on).hint(experiment.help), ui);
        kit::note_ui(experiment.help, palette_of(ui).muted, ui);
        if response.clicked() {
            if on {
                values = vec![(Key::Compare, Value::Compare(None))];
            } else {
                values.push((Key::Jump, List::Jump(None).into()));
            }
            out.commands.push(Command::Set(values));
            out.commands.push(Command::Settle);
        }
    }
}

/// Compares the blend window with a half and a third of it.
pub(crate) fn compare_windows(out: &mut Out) {
    if let Some(experiment) = text::GRAPH_EXPERIMENTS.first() {
        out.commands.push(Command::Set(link::read(experiment.query).values));
        out.commands.push(Command::Settle);
    }
}

fn files_ui(session: &Session, out: &mut Out, ui: &mut Ui) {
    let Some(walk) = session.graph_walk() else {
        return;
    };
    ui.label(RichText::new(say(text::GRAPH_FILES, ui)).font(theme_of(ui).font(Type::Label)));
    ui.horizontal(|ui| {
        let (graph, choices) = (walk.built.graph(), &walk.choices);
        if kit::button_ui(Button::new(Text::Data("JSON")).icon(Icon::Download), ui).clicked() {
            let text = format!("{:#}\n", graph.to_json(choices));
            out.actions.push(Action::SaveText {
                name: "motion graph.json",
                mime: "application/json",
                text,
            });
        }
        if kit::button_ui(Button::new(Text::Data("DOT")).icon(Icon::Download), ui).clicked() {
            out.actions.push(Action::SaveText {
                name: "motion graph.dot",
                mime: "text/vnd.graphviz",
                text: graph.to_dot(choices),
            });
        }
    });
}
